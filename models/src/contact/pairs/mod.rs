//! Contact on the lines of action: all tooth pairs in the contact zone, both flanks, sliced over the width.
//!
//! In the transverse plane the flanks of a pair touch on the line of action, the common tangent of the base
//! circles. With the path coordinate `s_a` of gear a's flank from its tangent point towards gear b and `s_b`
//! of gear b's flank from the other end, the gap along the line is
//!
//! ```text
//! g = L - s_a - s_b + e_a(s_a) + e_b(s_b),   s = r_b (sign * theta + alpha_w + chi)
//! ```
//!
//! with `theta` the angle of the tooth from the line of centres, `chi` its half angle on the base circle, `L`
//! the length between the tangent points, `e` the [separation](Separation) of modified flanks and of tip edges beyond the path of
//! contact. Stiffness follows the middle of both path coordinates, `s = (s_a + L - s_b)/2`, which is the path coordinate
//! of the contact whichever gear comes first. Pairs are looked at while an edge may touch, before, on and behind the path
//! of contact. This is the six-step search of Ebrahimi and Eberhard (2006: tooth of gear 1 in
//! the contact region, its neighbours, their partners, intersection with the line of action, relative angle;
//! the same for the other flank) with each tooth's own angle, so it serves rigid gears, movable teeth, and
//! elastic gears whose points stay on the line.
//!
//! An internal gear has a negative base radius, half angle and path coordinate, and its mate's flank of the side `sign` touches
//! its other flank: both go by the side of the external gear. `delta` is the direction of the pitch point, which lies beyond
//! the mate, and the tangent points lie on one side of it, `L` being negative.
//!
//! The line's normal, for flank sign +1 (left) or -1 and direction of centres `delta`: angle
//! `delta + sign (pi/2 - alpha_w)`, tangent point at angle `delta - sign alpha_w`.

mod assembly;
mod bodies;
mod coupling;
mod direct;
mod flank_lines;
mod lines;
mod planar;
mod search;
mod separation;
mod spatial;
mod walk;

pub(crate) use bodies::{MeshedBodies, Twist};
pub(crate) use coupling::MOST_ON_LINE;
pub(crate) use direct::{LoadedPair, Mesh, PRESCRIBED, PairList};
pub use flank_lines::{FlankLines, LineGear, LinePressure};
pub(crate) use lines::all_open;
pub use lines::{LinesOfAction, MeshGeometry, Slice};
pub use separation::{Engagement, Separation};
pub use spatial::{FlankForm, Helicoid, NearestPoints, Plane, Spatial, SpatialGeometry};
