//! Contact of gears whose flank nodes stand off the rigid flank: gap, forces on nodes, effective base radii.
//!
//! The flanks of a gear with a [`FlankDisplacement`] move rigidly with its frame; outward displacements `a` of their
//! nodes reduce the gap of a point, with the bilinear weights `W` of the faces that it lies on (slave) and is projected
//! to (master):
//!
//! ```text
//! g = g_rigid - W_s a_s - W_m a_m,      a = B q + r T + u,      u = -R F,      F = sum_p W_p N_p
//! ```
//!
//! `T` is the applied load on the hub; a viscous load is left out of `r T`, because gaps would otherwise depend on
//! speeds. All of this derives from one potential of displacements and modal coordinates,
//!
//! ```text
//! Pi = min_u  u^T R^-1 u / 2 + sum_p phi(g_p)
//! ```
//!
//! so generalised forces are `-dPi/dq` and energy is conserved however points move. A point that moves by `dx` against
//! the master's frame slides along the master by `d(a, b) = (e_a . dx, e_b . dx)`, `e = X M^-1` with the tangents `X`
//! and `M = X^T X - X'' . (x - X)`; with the weights the displacement `w(a, b) = W_m a_m` of the master's surface
//! changes, so the normal force acts along the normal of the deformed master,
//!
//! ```text
//! dg = d . dx,    d = n - w_a e_a - w_b e_b
//! ```
//!
//! Friction acts along the profile of the rigid flank, on the nodes by the same weights and on the hubs; how nodes move that
//! way is linear as `a` is.
//!
//! A point that leaves over the tip fades out: its gap, with all that it is made of, takes a factor `m(x)`, so that
//! `d(m g) = m d . dx + g grad m . dx`; the last part, by the motion of the slave alone, is the slave's.
//!
//! The solve for `u` works on the nodes, of which there are fewer than points ([`NodalSolve`]): the massless residual
//! compliance is condensed with the contact as in quasi-static mode acceleration.

mod compliance;
mod descent;
mod dissipative;
mod hard;
mod nodes;
mod point_based;
mod points;
mod solve;
mod spring;

pub use compliance::Block;
pub use dissipative::{DissipativeSolve, PortDirection, PortPoint, Ports};
pub use hard::{HardSolve, Share};
pub use nodes::{GearNodes, weighted};
pub use point_based::PointBasedSolve;
pub use points::{
    GapBound, LineMotion, LineSlope, LineTerms, NodalGearState, NodalPoint, NodalPoints,
    RelativeMotion,
};
pub use solve::NodalSolve;
pub use spring::{Spring, UNUSED, deepest};
