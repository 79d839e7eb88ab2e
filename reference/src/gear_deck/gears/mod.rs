//! From a deck to its toothed bodies: each connected body with a bore becomes a [`GearMesh`] in its own frame.
//!
//! - A body is what elements with common nodes make up. Its bore is the node set `bore` or `bore1`, `bore2`, ...
//!   on it: nodes on a circle about z make a gear, nodes in a plane parallel to z a rack.
//! - What no set names is recognised from the surface ([`crate::recognise`]): the axis, whatever its direction, the bore,
//!   the flanks, the back of a rack. Flanks whose faces are no structured grid touch at points tied to them. Properties that
//!   the user specifies ([`SpecifiedBody`]) take precedence, and the recognised ones have to agree with them.
//! - Flanks are the node sets `flank_3l` or `flank1_3l` (gear 1, tooth 3, left), or surfaces of these names with
//!   an `s` in front. Their grids are found from the faces, whatever the labels. Teeth are numbered by where they
//!   stand, counter-clockwise from the tooth called 1; sides have to be called what they are.
//! - Tooth 0's centreline is the mean polar angle of its two flanks at equal radii in the middle of the width;
//!   of the nodes of the tooth where there are no two flanks (exact on a tooth meshed symmetrically).
//! - A rack's reference line is where its tooth is half a pitch thick: a thinned tooth counts as one cut deeper.

mod bodies;
mod body;
mod circle;
mod groups;
mod names;
mod patch;
mod rack;
mod recognised_body;
mod spur;

use crate::deck::{Deck, DeckError, DeckErrorKind};
use crate::gear_mesh::GearMesh;
use crate::mesh::{Face, Mesh};
use crate::recognise::{RecognisedBody, SpecifiedBody, across};
use crate::vector::{snapped, turned};
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;
use gearbench_models::stiffness::Material;
use std::collections::HashMap;

/// Kind of a toothed body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyShape {
    /// A gear with a bore.
    Gear,
    /// A rack, whose own x axis is at this angle in the deck [rad].
    Rack {
        /// Angle of the x axis [rad].
        direction: f64,
    },
}

/// A toothed body of a deck: its mesh in its own frame, and how the deck has it placed.
#[derive(Clone, Debug, PartialEq)]
pub struct DeckGear {
    /// Element set it was read from, or `gear1`, `gear2`, ... in the deck's order.
    pub name: String,
    /// Kind of the body: gear or rack.
    pub shape: BodyShape,
    /// Mesh in its own frame.
    pub mesh: GearMesh,
    /// Material of the body.
    pub material: Material,
    /// Direction of the axis in the deck; its own z axis. The own x axis, before it is turned by `phase`, is the first of
    /// [`Axis::across`](crate::recognise::Axis::across): x of the deck where this is z.
    pub axis: Vec3,
    /// Point of the axis at half the width [m]; for a rack the point of its reference line next to the origin of the
    /// deck.
    pub centre: Vec3,
    /// Angle of tooth 0's centreline [rad]; of a rack its distance from `centre` along the rack's own y [m].
    pub phase: f64,
    /// The deck's number of each node.
    pub nodes: Vec<u32>,
    /// The deck's number of each element.
    pub elements: Vec<u32>,
    /// Index of the rigid body of the deck that is tied to the bore.
    pub rigid_body: Option<usize>,
    /// Result of the recognition, where no sets name the flanks.
    pub found: Option<RecognisedBody>,
    /// Flanks that cannot touch though the body should have them, a sentence each.
    pub missing: Vec<String>,
}

impl DeckGear {
    /// Rotation from the axes of the gear to those of the deck.
    pub fn rotation(&self) -> nalgebra::Matrix3<f64> {
        let zero = Vec3::zeros();
        let own = |x: Vec3| {
            // The phase of a rack is a displacement.
            let [at, from] =
                [x, zero].map(|x| placed(self.shape, [zero, self.axis], self.phase, x));
            at - from
        };
        nalgebra::Matrix3::from_columns(&[own(Vec3::x()), own(Vec3::y()), own(Vec3::z())])
    }
}

/// `the left flank of tooth 3`, counted from 1.
fn flank_words(tooth: u32, side: Side) -> String {
    let side = match side {
        Side::Left => "left",
        Side::Right => "right",
    };
    format!("the {side} flank of tooth {}", tooth + 1)
}

/// Transforms a point from the frame of a body to the deck: rotation about z by its phase, rotation of z to the axis,
/// translation to the centre.
pub(super) fn placed(shape: BodyShape, [centre, axis]: [Vec3; 2], phase: f64, x: Vec3) -> Vec3 {
    let x = match shape {
        BodyShape::Gear => turned(x, phase),
        BodyShape::Rack { direction } => turned(x + Vec3::new(0.0, phase, 0.0), direction),
    };
    if axis == Vec3::z() {
        return centre + x;
    }
    let [e, f] = across(axis);
    centre + x.x * e + x.y * f + x.z * axis
}

/// Faces at the surface of a mesh, by their corner nodes in ascending order.
pub(super) fn surface_faces(mesh: &Mesh) -> HashMap<[u32; 4], Face> {
    let quads = patch::boundary(&mesh.blocks);
    let sorted = |mut corners: [u32; 4]| {
        corners.sort_unstable();
        corners
    };
    quads.iter().map(|q| (sorted(q.corners), q.face)).collect()
}

pub(super) use groups::count as bodies_of;
pub(super) use names::{flank_name, is_bore_name};

/// Coordinate axis that a set's nodes lie around: `x`, `y` or `z`; nodes in a plane along z count as `z`, for
/// they are the back of a rack.
pub(super) fn bore_axis(deck: &Deck, set: &str) -> Option<char> {
    // Mid-side nodes on chords would spoil the circle.
    let mut corner = vec![false; deck.nodes.len()];
    for block in &deck.blocks {
        for element in block.connectivity.chunks_exact(block.kind.nodes()) {
            element[..block.kind.corners()]
                .iter()
                .for_each(|&n| corner[n as usize] = true);
        }
    }
    let members = deck.node_sets.get(set)?.iter();
    let points: Vec<Vec3> = members
        .filter(|&&n| corner[n as usize])
        .map(|&n| deck.nodes[n as usize])
        .collect();
    let turned = |axis: char, p: &Vec3| match axis {
        'x' => Vec3::new(p.y, p.z, p.x),
        'y' => Vec3::new(p.z, p.x, p.y),
        _ => *p,
    };
    // A bore along x is also a plane along z when it is a single ring: circles first.
    let shapes = ['z', 'x', 'y'].map(|axis| {
        let points: Vec<Vec3> = points.iter().map(|p| turned(axis, p)).collect();
        (axis, circle::shape(&points))
    });
    let circles = shapes
        .iter()
        .find(|(_, s)| matches!(s, circle::Shape::Circle { .. }));
    let planes = || {
        shapes
            .first()
            .filter(|(_, s)| matches!(s, circle::Shape::Plane { .. }))
    };
    circles.or_else(planes).map(|(axis, _)| *axis)
}

/// Splits a deck into its toothed bodies, in the order of their first elements.
pub fn gears(deck: &Deck) -> Result<Vec<DeckGear>, DeckError> {
    gears_with(deck, None)
}

/// Returns the gears of a deck as [`gears`]; missing values of a material are those of `other`.
pub fn gears_with(deck: &Deck, other: Option<Material>) -> Result<Vec<DeckGear>, DeckError> {
    gears_known(deck, other, &SpecifiedBody::default())?
        .into_iter()
        .collect()
}

/// Returns each body of a deck as [`gears_with`] makes it, or the reason why it is not a gear; `known` specifies one
/// of them.
///
/// # Errors
/// A deck that is no set of bodies.
pub fn gears_known(
    deck: &Deck,
    other: Option<Material>,
    known: &SpecifiedBody,
) -> Result<Vec<Result<DeckGear, DeckError>>, DeckError> {
    let bodies = bodies::split(deck, other)?;
    if bodies.is_empty() {
        return Err(decline(
            deck,
            "",
            "at least one element",
            "none",
            "the deck needs *ELEMENT with solid elements",
        ));
    }
    let bodies = bodies.into_iter();
    Ok(bodies.map(|b| b.into_gear(deck, known)).collect())
}

/// An angle in (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    PI - (PI - angle).rem_euclid(TAU)
}

/// Declines a mesh, at the line of a set when it names one.
fn decline(
    deck: &Deck,
    set: &str,
    expected: impl Into<String>,
    found: impl Into<String>,
    help: impl Into<String>,
) -> DeckError {
    let context = match set.is_empty() {
        true => String::new(),
        false => format!("set `{set}`"),
    };
    let refused = DeckError::new(DeckErrorKind::Gear, context, expected, found, help);
    match deck.defined.get(set) {
        Some(place) => refused.at(&place.file, place.line),
        None => refused.at(&deck.name, 0),
    }
}

#[cfg(test)]
mod tests;
