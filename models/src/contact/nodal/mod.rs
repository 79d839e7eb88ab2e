//! Contact of gears whose flank nodes stand off the rigid flank: gap, forces on nodes, levers.
//!
//! The flanks of a gear with a [`NormalField`] move rigidly with its frame; outward displacements `a` of their nodes
//! reduce the gap of a point, with the bilinear weights `W` of the faces that it lies on (slave) and is projected to
//! (master):
//!
//! ```text
//! g = g_rigid - W_s a_s - W_m a_m,      a = B q + r T + u,      u = -R F,      F = sum_p W_p N_p
//! ```
//!
//! `T` is what loads apply to the hub; a viscous load is left out of `r T`, or gaps would know speeds. All of this
//! derives from one potential of travels and modal coordinates,
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
//! and so does the area `A` of a point that leaves over the tip: `d` gains `-(phi / N) (A' / A) e_a`.
//!
//! The solve for `u` works on the nodes, of which there are fewer than points ([`NodalSolve`]): the massless residual
//! compliance is condensed with the contact as in quasi-static mode acceleration.

mod nodes;
mod solve;

pub use nodes::{GearNodes, weighted};
pub use solve::{Block, NodalSolve, Spring, UNUSED};

use super::candidate::Point;
use super::search::Party;
use crate::Vec3;
use crate::gear::elastic::NormalField;

/// A gear of a mesh in the search for nodal points.
pub struct NodalParty<'a> {
    /// The gear and its state.
    pub party: Party<'a>,
    /// Its field, where it has one.
    pub field: Option<&'a dyn NormalField>,
    /// Its active nodes; empty without a field.
    pub nodes: &'a mut GearNodes,
}

/// A point of one flank held against the other, with the nodes that both lie on.
#[derive(Clone, Copy, Debug)]
pub struct NodalPoint {
    /// Mesh of the scene.
    pub mesh: usize,
    /// A mark of its flank side, as [`Candidate::slot`](super::candidate::Candidate).
    pub slot: usize,
    /// Which gear of the mesh the point belongs to; the other is the master.
    pub slave: usize,
    /// Points on the first and second gear of the mesh, undeformed where the gear has a field.
    pub points: [Point; 2],
    /// Unit normal of the rigid master, out of its tooth.
    pub normal: Vec3,
    /// How the place on the master's face answers to the point's motion [1/m].
    pub answer: [Vec3; 2],
    /// Place on the master's face, 0 to 1.
    pub place: [f64; 2],
    /// Corners of the faces among the [`GearNodes`] of both gears; [`UNUSED`] without a field.
    pub slots: [[u32; 4]; 2],
    /// Their weights.
    pub weights: [[f64; 4]; 2],
    /// Gap of the rigid flanks [m].
    pub rigid_gap: f64,
    /// Gap before residual compliance [m].
    pub gap0: f64,
    /// Stiffness of the law, [N/m] for a linear law.
    pub stiffness: f64,
    /// What the law's damper per area is multiplied by [m^2].
    pub share: f64,
    /// `A' / A`: relative change of the area with the first place on the master.
    pub fading: f64,
}

impl NodalPoint {
    /// Slope of the master's outward displacements `a` at the corners of the face, by the place on it [m].
    #[inline]
    #[must_use]
    pub fn slope(&self, a: [f64; 4]) -> [f64; 2] {
        let [s, t] = self.place;
        [
            (1.0 - t) * (a[1] - a[0]) + t * (a[2] - a[3]),
            (1.0 - s) * (a[3] - a[0]) + s * (a[2] - a[1]),
        ]
    }

    /// Direction `d` of the force on the slave, for displacements `a` of the master's corners.
    #[inline]
    #[must_use]
    pub fn direction(&self, a: [f64; 4]) -> Vec3 {
        let [s, t] = self.slope(a);
        self.normal - s * self.answer[0] - t * self.answer[1]
    }
}
