//! A gear or a rack recognised from its surface alone: axis, bore, teeth, flanks, and the involute through their nodes.
//!
//! | part | owns |
//! |---|---|
//! | `skin` | faces at the surface, their normals, pieces that hang together |
//! | `axis` | axis of rotation from end faces, hull, tip and bore |
//! | `specified_body` | the properties of a body that the user specifies, compared with the recognised ones |
//! | `teeth` | toothed shell, bore, number of teeth |
//! | `flanks` | which faces are flanks |
//! | [`rack`] | a rack: planes of flanks, pitch, back |
//! | [`involute`] | least squares over flank nodes: base radius, base helix, base thickness, phase |
//! | [`tied`] | grids of points on flanks whose faces are no grid |
//! | [`standard`] | module, pressure angle and profile shift that these may stand for |
//!
//! Only corners of elements are used: mid-side nodes may lie on chords. A flank consists of the faces on the fitted
//! involute; material removed from the tip by relief or crowning is tolerated within a fiftieth of the tooth height.

mod axis;
mod flanks;
pub mod involute;
pub mod rack;
mod skin;
mod specified_body;
pub mod standard;
mod teeth;
#[cfg(test)]
pub(crate) mod tests;
pub mod tied;

pub(crate) use axis::across;
pub use axis::{Axis, Cylinder};
pub use involute::{FlankPoint, Involute};
pub use rack::RecognisedRack;
pub use skin::{Facet, Skin};
pub use specified_body::{Misfit, SpecifiedBody};
pub use standard::{ToolCandidate, ToolSpec};

use flanks::Flanks;
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;
use teeth::Polar;

/// Part of the tooth's height that is fitted first: above fillets, below most reliefs.
const CORE: [f64; 2] = [0.45, 0.75];

/// Inclination to the circle above which a face belongs to a flank.
const ACROSS: f64 = 0.3;

/// Nodes nearer to the involute than this part of the tooth's height are on it: digits of decks.
const FINE: f64 = 1e-5;

/// Largest part removed by a tip relief, relative to the tooth height.
const RELIEF: f64 = 0.02;

/// A flank: its faces, all of whose corners lie on the involute.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Tooth, from 0, counter-clockwise.
    pub tooth: u32,
    /// Side of the flank.
    pub side: Side,
    /// Faces, by their place in the surface.
    pub faces: Vec<u32>,
}

impl Patch {
    /// The flanks of so many teeth without faces yet, tooth by tooth, left before right.
    fn of_teeth(teeth: u32) -> Vec<Patch> {
        (0..teeth)
            .flat_map(|tooth| Side::BOTH.map(|side| (tooth, side)))
            .map(|(tooth, side)| Patch {
                tooth,
                side,
                faces: Vec::new(),
            })
            .collect()
    }
}

/// A gear as its surface shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct RecognisedGear {
    /// Axis of rotation; its point lies in the middle of the flanks' width.
    pub axis: Axis,
    /// The involute: angles from the first of [`Axis::across`], heights from the point of the axis.
    pub fit: Involute,
    /// Cylinder of the tips.
    pub tip: Cylinder,
    /// Root cylinder: the lowest node of each tooth space.
    pub root: Cylinder,
    /// Cylinder of the bore.
    pub bore: Cylinder,
    /// All nodes of the bore, mid-side nodes too.
    pub bore_nodes: Vec<u32>,
    /// Least and greatest radius of flank nodes [m].
    pub active: [f64; 2],
    /// Width of the flanks [m].
    pub width: f64,
    /// Flanks, tooth by tooth, left before right.
    pub flanks: Vec<Patch>,
}

impl RecognisedGear {
    /// Position in the gear's own frame: axis z through the origin in the middle of the width, tooth 0 on +x.
    pub fn own(&self, x: &Vec3) -> Vec3 {
        crate::vector::turned(self.axis.seen(x), -self.fit.phase)
    }

    /// Returns the relative uncertainty of the base pitch: its standard error, and the effect of a slope of the
    /// profile within the residual.
    pub fn uncertainty(&self) -> f64 {
        let run = self.fit.roll(self.active[1]) - self.fit.roll(self.active[0]);
        let slope = 2.0 * self.fit.residual[0] / run;
        (3.0 * self.fit.errors[0] / self.fit.base_radius)
            .max(slope)
            .max(1e-4)
    }

    /// Tools that fit, the likeliest first.
    pub fn readings(&self, given: ToolSpec) -> Vec<ToolCandidate> {
        let radii = [self.tip.radius, self.root.radius];
        standard::readings(&self.fit, radii, self.uncertainty(), given)
    }
}

/// A toothed body as its surface shows it.
#[derive(Clone, Debug, PartialEq)]
pub enum RecognisedBody {
    /// A recognised gear.
    Gear(Box<RecognisedGear>),
    /// A recognised rack.
    Rack(Box<RecognisedRack>),
}

impl RecognisedBody {
    /// Returns the gear, if it is one.
    pub fn gear(&self) -> Option<&RecognisedGear> {
        match self {
            RecognisedBody::Gear(gear) => Some(gear),
            RecognisedBody::Rack(_) => None,
        }
    }

    /// Returns the rack, if it is one.
    pub fn rack(&self) -> Option<&RecognisedRack> {
        match self {
            RecognisedBody::Gear(_) => None,
            RecognisedBody::Rack(rack) => Some(rack),
        }
    }

    /// Returns the nodes that are tied to the hub: of the bore, or of the back, including mid-side nodes.
    pub fn held(&self) -> &[u32] {
        match self {
            RecognisedBody::Gear(gear) => &gear.bore_nodes,
            RecognisedBody::Rack(rack) => &rack.back_nodes,
        }
    }

    /// Flanks, tooth by tooth, left before right.
    pub fn flanks(&self) -> &[Patch] {
        match self {
            RecognisedBody::Gear(gear) => &gear.flanks,
            RecognisedBody::Rack(rack) => &rack.flanks,
        }
    }

    /// Axis of its own z axis.
    pub fn axis(&self) -> Axis {
        match self {
            RecognisedBody::Gear(gear) => gear.axis,
            RecognisedBody::Rack(rack) => Axis {
                direction: rack.axes[2],
                point: Vec3::zeros(),
            },
        }
    }
}

/// Recognises the toothed body whose surface this is, a gear or else a rack.
///
/// # Errors
/// What was looked for and not found, or what is not as it is said.
pub fn body(skin: &Skin<'_>, known: &SpecifiedBody) -> Result<RecognisedBody, Misfit> {
    let gear = match recognise(skin, known) {
        Err(Misfit::Missing(why)) => why,
        found => return found.map(|g| RecognisedBody::Gear(Box::new(g))),
    };
    match rack::recognise(skin, known) {
        Ok(found) => Ok(RecognisedBody::Rack(Box::new(found))),
        Err(Misfit::Missing(why)) => Err(Misfit::Missing(format!("{gear}; {why}"))),
        Err(against) => Err(against),
    }
}

/// Recognises the gear whose surface this is.
///
/// # Errors
/// What was looked for and not found, or what is not as it is said.
pub fn recognise(skin: &Skin<'_>, known: &SpecifiedBody) -> Result<RecognisedGear, Misfit> {
    let corners = skin.corner_nodes();
    let mut refused = None;
    let said = known.unit_axis();
    for direction in said.into_iter().chain(axis::directions(skin)) {
        match about(skin, &corners, direction, known) {
            Ok(found) => {
                let height = found.tip.radius - found.root.radius;
                known.same_axis(&found.axis.direction)?;
                known.same_point(&found.axis, height)?;
                let active = (!found.flanks.is_empty()).then_some(found.active);
                known.same_flanks(active, height)?;
                return Ok(found);
            }
            // Of several refusals the one at the later stage of recognition is reported.
            Err(e) => refused = refused.max(Some(e)),
        }
    }
    let why = refused.map(|(_, why)| why);
    Err(Misfit::Missing(
        why.unwrap_or_else(|| "a body without a surface".to_owned()),
    ))
}

/// Why a direction is no axis, behind how far it was followed.
type Refusal = (u8, String);

fn about(
    skin: &Skin<'_>,
    corners: &[u32],
    direction: Vec3,
    known: &SpecifiedBody,
) -> Result<RecognisedGear, Refusal> {
    let no = |far: u8, why: &str| (far, why.to_owned());
    let round = axis::along(skin, corners, direction).map(|(axis, _)| axis);
    let axis = round.or_else(|| known.point.map(|point| Axis { direction, point }));
    let axis = axis.ok_or_else(|| {
        no(
            0,
            "no direction along which the outermost nodes lie on a circle",
        )
    })?;
    let (mut axis, mut polar, shells) =
        sharpened(skin, axis, known.bore_radius).ok_or_else(|| {
            no(
                1,
                "a toothed outside, but no bore: no cylinder within it about the same axis",
            )
        })?;
    if known.axis.is_some_and(|a| a.dot(&axis.direction) < 0.0) {
        axis.direction = -axis.direction;
        polar = teeth::polar(&axis, skin.nodes);
    }
    let shell = &shells[0];
    let inner = &shells[1..];
    let (bore_faces, bore) = teeth::bore(skin, &axis, &polar, inner, known.bore_radius)
        .ok_or_else(|| no(1, "a toothed outside, but no bore"))?;
    let teeth = teeth::count(skin, &polar, shell, known.teeth).map_err(|why| (2, why))?;
    let found = |given| Flanks::found(skin, &axis, &polar, shell, &teeth, given);
    // If no flank lies between the given radii, the flanks that are found without them name the correct radii.
    let flanks = found(known.flanks)
        .or_else(|| known.flanks.and_then(|_| found(None)))
        .ok_or_else(|| no(3, "teeth whose sides are no involutes about the axis"))?;
    Ok(flanks.told(
        skin,
        axis,
        &polar,
        shell,
        bore,
        skin.nodes_of(&bore_faces, true),
    ))
}

/// The axis made sharp on the tip and the bore, the nodes about it, and the pieces of the surface along it.
fn sharpened(
    skin: &Skin<'_>,
    mut axis: Axis,
    bore_radius: Option<f64>,
) -> Option<(Axis, Polar, Vec<Vec<u32>>)> {
    for near in [5e-3, 5e-4] {
        let polar = teeth::polar(&axis, skin.nodes);
        let shells = teeth::shells(skin, &axis, &polar)?;
        let (_, bore) = teeth::bore(skin, &axis, &polar, &shells[1..], bore_radius)?;
        let nodes = skin.nodes_of(&shells[0], false);
        let [low, high] = extent(nodes.iter().map(|&n| polar[n as usize][0]));
        let within = near * (high - low);
        let tip = nodes
            .into_iter()
            .filter(|&n| polar[n as usize][0] > high - within);
        let tip: Vec<u32> = tip.collect();
        let round = bore.nodes.iter().copied();
        let round = round.filter(|&n| (polar[n as usize][0] - bore.radius).abs() < within);
        let round: Vec<u32> = round.collect();
        axis = axis.sharpened(skin.nodes, [&tip, &round]);
    }
    let polar = teeth::polar(&axis, skin.nodes);
    let shells = teeth::shells(skin, &axis, &polar)?;
    Some((axis, polar, shells))
}

pub(crate) fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::MAX, f64::MIN], |e, v| [e[0].min(v), e[1].max(v)])
}

/// Returns the upper median of the finite values.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
