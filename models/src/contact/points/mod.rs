//! Contact between flanks given as structured grids of nodes: points of one flank against the surface of the
//! other.
//!
//! Each point represents a reference area `A` of its flank; it is projected on the other gear's deformed flank, and
//! the gap `g` along that flank's unit normal gives the force `N = p A <-g>` with the penalty `p` [Pa/m]. Deflected
//! teeth touch off the line of action, so that it is not presumed: path coordinates of the undeformed involutes only
//! select the flanks of the search. Gear models without flanks get them from their geometry, rigid with each tooth, so
//! that any gear can mesh with any other.
//!
//! Flanks of one side touch: left flanks of one gear touch left flanks of the other, also of a rack, and of an
//! internal gear by the sides as seen from the roots.
//!
//! Steps of the search, after the gear train module of P. Ziegler and P. Eberhard (2011): teeth about the line
//! of centres, the flanks they face on both sides, points of these. Where tooth numbers do not tell the first two, boxes
//! about the flanks do (`coarse`).

mod chords;
mod coarse_phase;
mod cone;
mod corners;
mod flanked;
mod generated;
mod involute;
mod mesh_flanks;
mod narrow_phase;
mod patch;
mod poses;
mod profile;
mod projection;
mod quadrature;
mod rule;
mod search;
mod search_gear;
mod sections;
mod spline;
mod spur;
mod spur_face;
mod surface;
mod twisted;
mod twisted_pair;

pub use search::FlankPoints;
pub use search_gear::SearchGear;

use crate::Vec3;
use crate::geometry::{Flanks, Tips};
use crate::spec::{PointRule, SurfaceKind};
use rule::Rule;
use surface::Shape;

/// Returns the reference areas [m^2] of the points of a rule on grid `grid`: nodes row by row, or faces row by row
/// with their points along the profile, then over the width.
pub fn reference_areas(flanks: &Flanks, grid: usize, rule: PointRule) -> Vec<f64> {
    let rule = Rule::new(rule);
    let shape = Shape::new(flanks, grid, SurfaceKind::Smooth, &rule, Tips::Outwards);
    let mut areas = Vec::new();
    shape.points(&rule, |_, _| true, |p| areas.push(p.area));
    areas
}

/// Returns the outward unit normals of the smooth surface through the undeformed nodes of grid `grid`, at these nodes,
/// row by row: `t_z x t_r` of the spline tangents over the width and along the profile, directed out of the tooth.
pub fn nodal_normals(flanks: &Flanks, grid: usize) -> Vec<Vec3> {
    // Normals ask for no heights.
    let (kind, rule) = (SurfaceKind::Smooth, Rule::default());
    Shape::new(flanks, grid, kind, &rule, Tips::Outwards).nodal_normals()
}
