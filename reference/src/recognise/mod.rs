//! A gear recognised from its surface alone: axis, bore, teeth, flanks, and the involute through their nodes.
//!
//! | part | owns |
//! |---|---|
//! | `skin` | faces at the surface, their normals, pieces that hang together |
//! | `axis` | axis of rotation from end faces, hull, tip and bore |
//! | `teeth` | toothed shell, bore, number of teeth |
//! | [`involute`] | least squares over flank nodes: base radius, base helix, base thickness, phase |
//! | [`tied`] | grids of points on flanks whose faces are no grid |
//! | [`standard`] | module, pressure angle and profile shift that these may stand for |
//!
//! Only corners of elements are measured: mid-side nodes may lie on chords. A flank is what lies on the fitted
//! involute; what the tip has lost by relief or crowning still belongs to it, within a fiftieth of the tooth's height.

mod axis;
pub mod involute;
mod skin;
pub mod standard;
mod teeth;
#[cfg(test)]
pub(crate) mod tests;
pub mod tied;

pub use axis::{Axis, Cylinder};
pub use involute::{FlankPoint, Involute};
pub use skin::{Facet, Skin};
pub use standard::{Given, Reading};

use gearbench_models::Vec3;
use gearbench_models::geometry::Side;
use std::collections::HashSet;
use teeth::{Polar, Teeth, wrapped};

/// Part of the tooth's height that is fitted first: above fillets, below most reliefs.
const CORE: [f64; 2] = [0.45, 0.75];

/// A face of a flank stands across the circle by more than this.
const ACROSS: f64 = 0.3;

/// Nodes nearer to the involute than this part of the tooth's height are on it: digits of decks.
const FINE: f64 = 1e-5;

/// What the tip's relief may take away, over the tooth's height.
const RELIEF: f64 = 0.02;

/// A flank: its faces, all of whose corners lie on the involute.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Tooth, from 0, counter-clockwise.
    pub tooth: u32,
    /// Which flank.
    pub side: Side,
    /// Faces, by their place in the surface.
    pub faces: Vec<u32>,
}

/// A gear as its surface shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Recognised {
    /// Axis of rotation; its point lies in the middle of the flanks' width.
    pub axis: Axis,
    /// The involute: angles from the first of [`Axis::across`], heights from the point of the axis.
    pub fit: Involute,
    /// Tip cylinder.
    pub tip: Cylinder,
    /// Root cylinder: the lowest node of each tooth space.
    pub root: Cylinder,
    /// Bore.
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

impl Recognised {
    /// Position in the gear's own frame: axis z through the origin in the middle of the width, tooth 0 on +x.
    pub fn own(&self, x: &Vec3) -> Vec3 {
        crate::vector::turned(self.axis.seen(x), -self.fit.phase)
    }

    /// By which part the base pitch may be off: its standard error, and what a slope of the profile within the residual
    /// makes of it.
    pub fn uncertainty(&self) -> f64 {
        let run = self.fit.roll(self.active[1]) - self.fit.roll(self.active[0]);
        let slope = 2.0 * self.fit.residual[0] / run;
        (3.0 * self.fit.errors[0] / self.fit.base_radius)
            .max(slope)
            .max(1e-4)
    }

    /// Tools that fit, the likeliest first.
    pub fn readings(&self, given: Given) -> Vec<Reading> {
        let radii = [self.tip.radius, self.root.radius];
        standard::readings(&self.fit, radii, self.uncertainty(), given)
    }
}

/// Recognises the gear whose surface this is; `teeth` is the number that it should have, where somebody knows. The error
/// says what was looked for and not found.
pub fn recognise(skin: &Skin<'_>, teeth: Option<u32>) -> Result<Recognised, String> {
    let corners = skin.corner_nodes();
    let mut refused = None;
    for direction in axis::directions(skin) {
        match about(skin, &corners, direction, teeth) {
            Ok(found) => return Ok(found),
            // What was said of a direction where more was found counts for more.
            Err(e) => refused = refused.max(Some(e)),
        }
    }
    let why = refused.map(|(_, why)| why);
    Err(why.unwrap_or_else(|| "a body without a surface".to_owned()))
}

/// Why a direction is no axis, behind how far it was followed.
type Refusal = (u8, String);

fn about(
    skin: &Skin<'_>,
    corners: &[u32],
    direction: Vec3,
    wished: Option<u32>,
) -> Result<Recognised, Refusal> {
    let no = |far: u8, why: &str| (far, why.to_owned());
    let (axis, _) = axis::along(skin, corners, direction).ok_or_else(|| {
        no(
            0,
            "no direction along which the outermost nodes lie on a circle",
        )
    })?;
    let (axis, polar, shells) = sharpened(skin, axis).ok_or_else(|| {
        no(
            1,
            "a toothed outside, but no bore: no cylinder within it about the same axis",
        )
    })?;
    let shell = &shells[0];
    let (bore_faces, bore) = teeth::bore(skin, &axis, &polar, &shells[1..])
        .ok_or_else(|| no(1, "a toothed outside, but no bore"))?;
    let teeth = teeth::count(skin, &polar, shell, wished).map_err(|why| (2, why))?;
    let flanks = Flanks::found(skin, &axis, &polar, shell, &teeth)
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
fn sharpened(skin: &Skin<'_>, mut axis: Axis) -> Option<(Axis, Polar, Vec<Vec<u32>>)> {
    for near in [5e-3, 5e-4] {
        let polar = teeth::polar(&axis, skin.nodes);
        let shells = teeth::shells(skin, &axis, &polar)?;
        let (_, bore) = teeth::bore(skin, &axis, &polar, &shells[1..])?;
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

fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::MAX, f64::MIN], |e, v| [e[0].min(v), e[1].max(v)])
}

/// The upper median of the finite ones among values.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// The involute and the corner nodes that lie on it.
struct Flanks {
    fit: Involute,
    /// Side of each face of the shell that stands across the circle.
    sides: Vec<(u32, Side)>,
    /// Node and flank of what belongs to the flanks.
    members: HashSet<(u32, u32, Side)>,
}

impl Flanks {
    fn found(
        skin: &Skin<'_>,
        axis: &Axis,
        polar: &Polar,
        shell: &[u32],
        teeth: &Teeth,
    ) -> Option<Self> {
        let [low, high] =
            extent((skin.nodes_of(shell, false).iter()).map(|&n| polar[n as usize][0]));
        let height = high - low;
        let mut sides = Vec::new();
        let mut guesses = [Vec::new(), Vec::new()];
        let mut core = [Vec::new(), Vec::new()];
        for &f in shell {
            let [out, round, along] = teeth::turned_normal(skin, axis, f as usize);
            if round.abs() < ACROSS {
                continue;
            }
            let side = if round > 0.0 { Side::Left } else { Side::Right };
            sides.push((f, side));
            let Some(tooth) = teeth.of_face[f as usize] else {
                continue;
            };
            let corners = skin.facets[f as usize].corners();
            let radius = corners.iter().map(|&n| polar[n as usize][0]).sum::<f64>();
            let radius = radius / corners.len() as f64;
            if radius > low + CORE[0] * height {
                guesses[0].push(radius * round.abs() / round.hypot(out));
                guesses[1].push(-along / (radius * round));
            }
            for &n in corners {
                let part = (polar[n as usize][0] - low) / height;
                let point = point(polar, n, tooth, side);
                if part >= CORE[0] {
                    core[1].push((n, point));
                    if part <= CORE[1] {
                        core[0].push((n, point));
                    }
                }
            }
        }
        let [base, twist] = guesses.map(median);
        let mut start = Involute::guess(teeth.count, base?, twist?);
        start.phase = teeth.first;
        let [inner, wide] = core.map(|mut points| {
            points.sort_by_key(|(n, p)| (*n, p.tooth, p.side));
            points.dedup_by_key(|(n, p)| (*n, p.tooth, p.side));
            points.into_iter().map(|p| p.1).collect::<Vec<FlankPoint>>()
        });
        let [a, b] = extent(inner.iter().map(|p| p.radius));
        let enough = b - a > 0.1 * height;
        let fine = FINE * height;
        let mut fit = start.fitted_to_most(if enough { &inner } else { &wide }, fine)?;
        // Sides of teeth that are no involutes are refused, not fitted.
        if fit.residual[0] > 0.01 * height || fit.base_radius > high {
            return None;
        }
        // Then all that lies on it, down to the fillet and up to the tip.
        let mut members = HashSet::new();
        for _ in 0..6 {
            let near = (8.0 * fit.residual[0]).max(fine);
            let mut found = HashSet::new();
            let mut points = Vec::new();
            for &(f, side) in &sides {
                for &n in skin.facets[f as usize].corners() {
                    let place = polar[n as usize];
                    if place[0] < fit.base_radius * (1.0 - 1e-9) {
                        continue;
                    }
                    let p = point(polar, n, nearest(&fit, place, side), side);
                    let off = fit.distance(&p);
                    let on = off.abs() <= near;
                    // What a relief takes away lies within the tooth.
                    let upper = place[0] > low + CORE[1] * height;
                    let relieved = upper && off < 0.0 && -off < RELIEF * height;
                    if !(on || relieved) {
                        continue;
                    }
                    if found.insert((n, p.tooth, side)) && on {
                        points.push(p);
                    }
                }
            }
            let same = found == members;
            members = found;
            fit = fit.fitted(&points)?;
            if same {
                break;
            }
        }
        Some(Flanks {
            fit,
            sides,
            members,
        })
    }

    /// The gear with its flanks in order.
    fn told(
        self,
        skin: &Skin<'_>,
        mut axis: Axis,
        polar: &Polar,
        shell: &[u32],
        bore: Cylinder,
        bore_nodes: Vec<u32>,
    ) -> Recognised {
        let Flanks {
            mut fit,
            sides,
            members,
        } = self;
        // The tooth next to the first direction across the axis is number 0.
        let pitch = fit.pitch_angle();
        let own = |place: [f64; 3]| wrapped(place[1] - fit.twist * place[2]);
        let shift = (-fit.phase / pitch).round();
        let zero = (shift as i64).rem_euclid(i64::from(fit.teeth)) as u32;
        let renumbered = |tooth: u32| (tooth + fit.teeth - zero) % fit.teeth;
        let mut patches: Vec<Patch> = (0..fit.teeth)
            .flat_map(|tooth| [Side::Left, Side::Right].map(|side| (tooth, side)))
            .map(|(tooth, side)| Patch {
                tooth,
                side,
                faces: Vec::new(),
            })
            .collect();
        for &(f, side) in &sides {
            let corners = skin.facets[f as usize].corners();
            let tooth = nearest(&fit, polar[corners[0] as usize], side);
            if corners.iter().all(|&n| members.contains(&(n, tooth, side))) {
                let place = 2 * renumbered(tooth) as usize + usize::from(side == Side::Right);
                patches[place].faces.push(f);
            }
        }
        patches.retain(|p| !p.faces.is_empty());
        let all: Vec<u32> = patches
            .iter()
            .flat_map(|p| p.faces.iter().copied())
            .collect();
        let on = skin.nodes_of(&all, false);
        let active = extent(on.iter().map(|&n| polar[n as usize][0]));
        let [back, front] = extent(on.iter().map(|&n| polar[n as usize][2]));

        let nodes = skin.nodes_of(shell, false);
        let spaces = |lowest: bool| {
            let mut best: Vec<Option<u32>> = vec![None; fit.teeth as usize];
            for &n in &nodes {
                let place = polar[n as usize];
                // Teeth about their centres, spaces between them.
                let turns = (own(place) - fit.phase) / pitch + if lowest { 0.0 } else { 0.5 };
                let k = (turns.floor() as i64).rem_euclid(i64::from(fit.teeth)) as usize;
                let better = |m: u32| (polar[m as usize][0] < place[0]) != lowest;
                if best[k].is_none_or(better) {
                    best[k] = Some(n);
                }
            }
            best.into_iter().flatten().collect::<Vec<u32>>()
        };
        let highest = spaces(false);
        let tops = highest.iter().map(|&n| polar[n as usize][0]);
        let top = median(tops).unwrap_or(active[1]);
        let within = 1e-4 * (top - active[0]);
        let tip = nodes.iter().copied();
        let tip = tip.filter(|&n| (polar[n as usize][0] - top).abs() < within);
        let tip = axis.cylinder(skin.nodes, tip.collect());
        let root = axis.cylinder(skin.nodes, spaces(true));

        let middle = 0.5 * (back + front);
        fit.phase += shift * pitch + fit.twist * middle;
        fit.phase = snapped(wrapped(fit.phase), 1.0);
        axis.point += middle * axis.direction;
        let size = active[1];
        axis.point = axis.point.map(|x| snapped(x, size));
        Recognised {
            axis,
            fit,
            tip,
            root,
            bore,
            bore_nodes,
            active,
            width: front - back,
            flanks: patches,
        }
    }
}

/// A value that differs from 0 only by the digits that decks print of positions of this size counts as 0.
fn snapped(value: f64, size: f64) -> f64 {
    if value.abs() <= 1e-10 * size {
        0.0
    } else {
        value
    }
}

fn point(polar: &Polar, node: u32, tooth: u32, side: Side) -> FlankPoint {
    let [radius, angle, height] = polar[node as usize];
    FlankPoint {
        radius,
        angle,
        height,
        tooth,
        side,
    }
}

/// The tooth whose flank of this side is next to a place.
fn nearest(fit: &Involute, [radius, angle, height]: [f64; 3], side: Side) -> u32 {
    let half = fit.half_angle_at(fit.roll(radius));
    let from = angle - fit.phase - fit.twist * height - side.sign() * half;
    let turns = (from / fit.pitch_angle()).round() as i64;
    turns.rem_euclid(i64::from(fit.teeth)) as u32
}
