//! Where the nodes of a full-order gear are and how they move: positions and velocities from the generalised
//! coordinates, effective base radius arms, points between nodes.

use super::frame::{Frame, unit_motion};
use super::gear::{FullOrder, Nodal};
use crate::assembly::tie::Tie;
use crate::vector::dot;
use gearbench_integrators::system::StateView;
use gearbench_models::Vec3;
use gearbench_models::error::Reason;
use gearbench_models::gear::{BodyLoad, DisplacedNodes, FlankNodes, MeshedBody};
use gearbench_models::geometry::Flanks;
use gearbench_models::geometry::swept::Cells;
use gearbench_models::kinematics::{Locus, Point};
use std::sync::Arc;

impl FullOrder {
    #[inline]
    pub(super) fn slide(&self) -> Option<&Vec3> {
        self.hub.slide.as_ref()
    }

    pub(super) fn frame(&self, at: StateView<'_>) -> Frame {
        if self.held().is_some() {
            return self.frame_pose(at).frame();
        }
        Frame::at(self.hub.displacement(at.t, at.q), self.slide())
    }

    /// Elastic displacements of all nodes in the frame.
    pub(super) fn elastic(&self, frame: Frame, q: &[f64], u: &mut [f64]) {
        let d = &q[self.own..];
        for (k, &node) in self.body.free.iter().enumerate() {
            let node = node as usize;
            let e = frame.elastic(&self.body.position[node], &d[3 * k..3 * k + 3]);
            u[3 * node..][..3].copy_from_slice(&e);
        }
        for (node, &place) in self.body.place.iter().enumerate() {
            if place == Tie::HELD {
                u[3 * node..][..3].fill(0.0);
            }
        }
    }

    /// Elastic displacements `u` of all nodes in the frame, the displacements `w = u + beta u'` with the retardation
    /// time of the body, and their forces `g = K w`.
    pub(super) fn strained(&self, at: StateView<'_>, nodal: &mut Nodal) {
        let Nodal { u, w, g, .. } = nodal;
        self.elastic(self.frame(at), at.q, u);
        let beta = self.hub.retardation;
        if beta == 0.0 {
            w.copy_from_slice(u);
        } else {
            self.strain_rates(at, u, w);
            for (w, u) in w.iter_mut().zip(&*u) {
                *w = u + beta * *w;
            }
        }
        self.body.assembly.stiffness.apply(w, g);
    }

    /// Rates of the elastic displacements `u` of all nodes in the frame.
    pub(super) fn strain_rates(&self, at: StateView<'_>, u: &[f64], rates: &mut [f64]) {
        rates.fill(0.0);
        let v = &at.v[self.own..];
        if self.held().is_some() {
            let pose = self.frame_pose(at);
            for (k, &node) in self.body.free.iter().enumerate() {
                let node = node as usize;
                let place = pose.turn * (self.body.position[node] + Vec3::from(node3(u, node)));
                let rate = Vec3::from(node3(v, k)) - pose.velocity(&place);
                rates[3 * node..][..3].copy_from_slice(pose.turn.tr_mul(&rate).as_slice());
            }
            return;
        }
        let (frame, speed) = (self.frame(at), self.hub.speed(at.t, at.v));
        for (k, &node) in self.body.free.iter().enumerate() {
            let node = node as usize;
            let (own, arm) = (frame.to_frame(node3(v, k)), self.arm(node, u));
            for axis in 0..3 {
                rates[3 * node + axis] = own[axis] - speed * arm[axis];
            }
        }
    }

    /// Returns the power that the damping of the body takes [W].
    pub(super) fn damping_power(&self, at: StateView<'_>) -> f64 {
        let beta = self.hub.retardation;
        if beta == 0.0 {
            return 0.0;
        }
        let mut nodal = self.scratch.borrow_mut();
        let Nodal { u, w, g, .. } = &mut *nodal;
        self.elastic(self.frame(at), at.q, u);
        self.strain_rates(at, u, w);
        self.body.assembly.stiffness.apply(w, g);
        beta * dot(w, g)
    }

    /// Velocities of all nodes in space.
    pub(super) fn velocities(&self, frame: Frame, speed: f64, v: &[f64], out: &mut [f64]) {
        let d = &v[self.own..];
        for (node, &place) in self.body.place.iter().enumerate() {
            let of_node = &mut out[3 * node..][..3];
            if place == Tie::HELD {
                let unit = unit_motion(&self.body.position[node].into(), self.slide());
                for (o, w) in of_node.iter_mut().zip(frame.to_space(unit)) {
                    *o = speed * w;
                }
            } else {
                of_node.copy_from_slice(&d[3 * place as usize..][..3]);
            }
        }
    }

    /// Moment (or force along the slide) of the elastic forces `g` at the free nodes on the hub.
    pub(super) fn torque(&self, u: &[f64], g: &[f64]) -> f64 {
        self.body
            .free
            .iter()
            .map(|&node| {
                let node = node as usize;
                dot3(self.arm(node, u), &g[3 * node..3 * node + 3])
            })
            .sum()
    }

    /// Corner nodes and weights of a point; a point of the smooth flank without its element has none.
    pub(super) fn corners(&self, p: &Point) -> Option<([u32; 4], [f64; 4])> {
        match p.locus {
            Locus::Quadrature { face, xi } => {
                Some((self.body.flanks.corners(face), Flanks::weights(xi)))
            }
            Locus::Node(node) => Some(([node; 4], [1.0, 0.0, 0.0, 0.0])),
            Locus::Flank { .. } => None,
        }
    }

    /// Returns the offset of a point from the face between its nodes [m]: the rise of the smooth flank, which rotates
    /// with the frame; zero on a faceted flank.
    pub(super) fn bulge(
        &self,
        at: StateView<'_>,
        p: &Point,
        corners: &[u32; 4],
        weights: &[f64; 4],
    ) -> Vec3 {
        let mut x = [Vec3::zeros(); 4];
        self.positions(at, corners, &mut x);
        let on_face: Vec3 = x.iter().zip(weights).map(|(x, w)| *w * x).sum();
        let bulge = p.x - on_face;
        // Rounding of a position is no bulge.
        if bulge.norm_squared() < 1e-28 {
            Vec3::zeros()
        } else {
            bulge
        }
    }

    /// `z x (X + u)` or the slide, for a node.
    #[inline]
    pub(super) fn arm(&self, node: usize, u: &[f64]) -> [f64; 3] {
        let x = &self.body.position[node];
        let place = [
            x.x + u[3 * node],
            x.y + u[3 * node + 1],
            x.z + u[3 * node + 2],
        ];
        unit_motion(&place, self.slide())
    }
}

impl FlankNodes for FullOrder {
    fn positions(&self, at: StateView<'_>, nodes: &[u32], out: &mut [Vec3]) {
        let frame = self.frame(at);
        let d = &at.q[self.own..];
        for (&node, x) in nodes.iter().zip(out) {
            let place = self.body.place[node as usize];
            let reference = &self.body.position[node as usize];
            let moved = if place == Tie::HELD {
                Vec3::from(frame.carried(reference))
            } else {
                Vec3::from_column_slice(&d[3 * place as usize..][..3])
            };
            *x = self.hub.centre + reference + moved;
        }
    }
}

impl MeshedBody for FullOrder {
    fn cells(&self) -> Result<Arc<Cells>, Reason> {
        Ok(self.body.cells.clone())
    }

    fn displaced(&self, at: StateView<'_>, _: &BodyLoad) -> Result<DisplacedNodes, Reason> {
        let frame = self.frame(at);
        let nodes: Vec<u32> = (0..self.body.position.len() as u32).collect();
        let mut x = vec![Vec3::zeros(); nodes.len()];
        self.positions(at, &nodes, &mut x);
        let rigid: Vec<Vec3> = (self.body.position.iter())
            .map(|p| self.hub.centre + p + Vec3::from(frame.carried(p)))
            .collect();
        Ok(DisplacedNodes {
            displacement: x.iter().zip(&rigid).map(|(x, rigid)| x - rigid).collect(),
            rigid,
        })
    }
}

#[inline]
pub(super) fn dot3(a: [f64; 3], b: &[f64]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The three components of a node.
#[inline]
pub(super) fn node3(x: &[f64], node: usize) -> [f64; 3] {
    [x[3 * node], x[3 * node + 1], x[3 * node + 2]]
}

/// Adds three components from a place on.
#[inline]
pub(super) fn add3(y: &mut [f64], from: usize, x: [f64; 3]) {
    for (y, x) in y[from..from + 3].iter_mut().zip(x) {
        *y += x;
    }
}
