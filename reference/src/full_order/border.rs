//! Newton corrections where the hub moves in several directions: that of the nodes on a held hub, bordered by the hub's.
//!
//! In the frame the nodes have the constant matrix `A = c_m M_ff + c_k K_ff` ([`super::correction`]) and are coupled
//! to the six unit motions of the tied nodes by the constant `B = c_m M_f6 + c_k K_f6`. With the unit motions `V` by
//! the present hub coordinates, and the matrix `H` of the hub (mass of the rigid body, bearing, damping),
//!
//! ```text
//! Y = A^-1 B,   S = H + V^T (c_k K_66 - B^T Y) V,   P = S^-1
//! x_h = P (b_h - V^T Y^T b_f),   x_f = A^-1 b_f - Y V x_h
//! ```
//!
//! `Y` is computed once for a step size. The inverse over some coordinates is that of the nodes on a fixed hub plus `r
//! P r^T`, with `r = -Y V` at nodes and the unit at the hub. Spin terms are left out of `A`, in addition to the terms
//! that [`super::correction`] leaves out.

use super::correction::{Correction, Weights, same};
use super::frame::Frame;
use super::frame_pose::FramePose;
use super::kinematics::node3;
use super::tied_nodes::TiedNodes;
use gearbench_integrators::system::{Coeffs, Singular, StateView};
use gearbench_models::Vec3;
use gearbench_models::gear::HubBody;
use gearbench_models::kinematics::{Motion, OutOfPlane};
use nalgebra::Matrix6;

type Vector6 = nalgebra::Vector6<f64>;

/// Solutions `Y` and `B^T Y` for one set of weights.
#[derive(Debug)]
struct Factor {
    key: [f64; 2],
    /// Six columns over the nodes, in the frame.
    y: Vec<f64>,
    carried: Matrix6<f64>,
}

/// Corrections of nodes and hub.
#[derive(Debug)]
pub struct Border {
    /// Coordinates of the nodes.
    n: usize,
    /// Coordinates of the hub.
    own: usize,
    /// As many as the nodes' correction keeps.
    factors: Vec<Factor>,
    /// The hub without spin terms.
    plain: OutOfPlane,
    inner: Vec<u32>,
    forces: Vec<f64>,
    block: Vec<f64>,
}

/// The hub's part at a state: `V`, `P`, the frame.
struct BorderState {
    frame: Frame,
    unit: Matrix6<f64>,
    inverse: Matrix6<f64>,
}

impl Border {
    /// Of a gear with so many coordinates of its nodes.
    pub fn new(hub: &HubBody, n: usize) -> Option<Self> {
        let lateral = hub.lateral.as_ref()?;
        Some(Border {
            n,
            own: hub.coordinates(),
            factors: Vec::new(),
            plain: OutOfPlane {
                spins: false,
                ..(**lateral).clone()
            },
            inner: Vec::new(),
            forces: Vec::new(),
            block: Vec::new(),
        })
    }

    /// Makes `Y` for weights the first of `factors`.
    fn prepare(
        &mut self,
        nodes: &mut Correction,
        held: &TiedNodes,
        c: Coeffs,
    ) -> Result<(), Singular> {
        let key = [c.m, c.k];
        if let Some(i) = self.factors.iter().position(|f| same(&f.key, &key)) {
            self.factors.swap(0, i);
            return Ok(());
        }
        let mut factor = match self.factors.len() {
            0 | 1 => Factor {
                key,
                y: vec![0.0; 6 * self.n],
                carried: Matrix6::zeros(),
            },
            _ => self.factors.swap_remove(1),
        };
        factor.key = key;
        factor.y.fill(0.0);
        let (k, m) = (c.k, c.m);
        for (row, [stiffness, mass]) in &held.coupling {
            for p in 0..6 {
                factor.y[p * self.n + *row as usize] = k * stiffness[p] + m * mass[p];
            }
        }
        for column in factor.y.chunks_exact_mut(self.n) {
            nodes.solve(Frame::Moved(Vec3::zeros()), Weights::of_body(c), column)?;
        }
        factor.carried = Matrix6::zeros();
        for (row, [stiffness, mass]) in &held.coupling {
            for (p, q) in (0..6).flat_map(|p| (0..6).map(move |q| (p, q))) {
                let b = k * stiffness[p] + m * mass[p];
                factor.carried[(p, q)] += b * factor.y[q * self.n + *row as usize];
            }
        }
        self.factors.insert(0, factor);
        Ok(())
    }

    /// The hub's part of the matrix at a state.
    fn now(
        &self,
        hub: &HubBody,
        held: &TiedNodes,
        at: StateView<'_>,
        weights: Weights,
    ) -> Result<BorderState, Singular> {
        let Weights {
            body,
            hub: c,
            hub_damping,
        } = weights;
        let frame_pose = FramePose::of(hub, at);
        let mut unit = Matrix6::zeros();
        for (k, d) in hub.free_directions().enumerate() {
            let axis = frame_pose.turn.tr_mul(&frame_pose.axes[d]);
            let first = if d < 3 { 0 } else { 3 };
            unit.fixed_view_mut::<3, 1>(first, k).copy_from(&axis);
        }
        let mass = self.plain.mass_matrix(&frame_pose.motion.x);
        let inner = unit.transpose() * (body.k * held.stiffness - self.factors[0].carried) * unit;
        let mut matrix = inner;
        for (j, dj) in hub.free_directions().enumerate() {
            let mut along = Motion::default();
            (along.x[dj], along.v[dj]) = (c.k, c.d);
            let change = self.plain.force_change(&frame_pose.motion, &along);
            for (i, di) in hub.free_directions().enumerate() {
                matrix[(i, j)] += c.m * mass[di][dj] - change[di];
            }
        }
        for k in self.own..6 {
            matrix[(k, k)] = 1.0;
        }
        if hub.is_free() {
            matrix[(0, 0)] += c.d * hub_damping;
        }
        // Rounding of the condensed matrix leaves its inverse symmetric.
        let matrix = 0.5 * (matrix + matrix.transpose());
        Ok(BorderState {
            frame: frame_pose.frame(),
            unit,
            inverse: matrix.try_inverse().ok_or(Singular)?,
        })
    }

    /// `x <- A^-1 x` for coordinates in space, the hub's first.
    pub fn solve(
        &mut self,
        nodes: &mut Correction,
        (hub, held): (&HubBody, &TiedNodes),
        at: StateView<'_>,
        weights: Weights,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        self.prepare(nodes, held, weights.body)?;
        let now = self.now(hub, held, at, weights)?;
        let (of_hub, of_nodes) = x.split_at_mut(self.own);
        nodes.solve(now.frame, Weights::of_body(weights.body), of_nodes)?;
        // B^T z, with z = A^-1 b_f in the frame.
        let mut pulled = Vector6::zeros();
        for (row, [stiffness, mass]) in &held.coupling {
            let (node, axis) = (*row as usize / 3, *row as usize % 3);
            let z = now.frame.to_frame(node3(of_nodes, node))[axis];
            for p in 0..6 {
                pulled[p] += (weights.body.k * stiffness[p] + weights.body.m * mass[p]) * z;
            }
        }
        let mut right = -now.unit.tr_mul(&pulled);
        for (k, b) in of_hub.iter().enumerate() {
            right[k] += b;
        }
        self.respond(&now, right, of_hub, of_nodes, true)
    }

    /// Response of hub and nodes to a load on the hub's condensed matrix, set or added at the hub, added at the nodes.
    fn respond(
        &self,
        now: &BorderState,
        load: Vector6,
        hub: &mut [f64],
        nodes: &mut [f64],
        set: bool,
    ) -> Result<(), Singular> {
        let moved = now.inverse * load;
        for (k, x) in hub.iter_mut().enumerate() {
            *x = if set { moved[k] } else { *x + moved[k] };
        }
        let along = now.unit * moved;
        let y = &self.factors[0].y;
        for (k, x) in nodes.chunks_exact_mut(3).enumerate() {
            let own = [0, 1, 2].map(|axis| {
                let at = |p: usize| y[p * self.n + 3 * k + axis] * along[p];
                -(0..6).map(at).sum::<f64>()
            });
            for (x, y) in x.iter_mut().zip(now.frame.to_space(own)) {
                *x += y;
            }
        }
        let sound = hub.iter().chain(nodes.iter()).all(|x| x.is_finite());
        if sound { Ok(()) } else { Err(Singular) }
    }

    /// Row of a coordinate towards the hub, `r`.
    fn towards(&self, now: &BorderState, coordinate: u32) -> Vector6 {
        let Some(i) = (coordinate as usize).checked_sub(self.own) else {
            let mut unit = Vector6::zeros();
            unit[coordinate as usize] = 1.0;
            return unit;
        };
        let (node, axis) = (i / 3, i % 3);
        let mut direction = [0.0; 3];
        direction[axis] = 1.0;
        let own = now.frame.to_frame(direction);
        let y = &self.factors[0].y;
        let mut along = Vector6::zeros();
        for p in 0..6 {
            along[p] = -(0..3)
                .map(|a| own[a] * y[p * self.n + 3 * node + a])
                .sum::<f64>();
        }
        now.unit.tr_mul(&along)
    }

    /// Flexibility of some coordinates, row-major.
    pub fn flexibility(
        &mut self,
        nodes: &mut Correction,
        (hub, held): (&HubBody, &TiedNodes),
        at: StateView<'_>,
        weights: Weights,
        (coordinates, g): (&[u32], &mut [f64]),
    ) -> Result<(), Singular> {
        self.prepare(nodes, held, weights.body)?;
        let now = self.now(hub, held, at, weights)?;
        let n = coordinates.len();
        let own = self.own as u32;
        self.inner.clear();
        self.inner
            .extend(coordinates.iter().filter(|i| **i >= own).map(|i| i - own));
        let m = self.inner.len();
        self.block.clear();
        self.block.resize(m * m, 0.0);
        nodes.flexibility(
            now.frame,
            Weights::of_body(weights.body),
            &self.inner,
            &mut self.block,
        )?;
        let mut row = 0;
        for (i, &a) in coordinates.iter().enumerate() {
            let of_a = now.inverse.tr_mul(&self.towards(&now, a));
            let mut column = 0;
            for (j, &b) in coordinates.iter().enumerate() {
                g[i * n + j] = of_a.dot(&self.towards(&now, b));
                if a >= own && b >= own {
                    g[i * n + j] += self.block[row * m + column];
                }
                column += usize::from(b >= own);
            }
            row += usize::from(a >= own);
        }
        Ok(())
    }

    /// `x += A^-1 E f` for forces at some coordinates.
    pub fn add_response(
        &mut self,
        nodes: &mut Correction,
        (hub, held): (&HubBody, &TiedNodes),
        at: StateView<'_>,
        weights: Weights,
        (coordinates, forces): (&[u32], &[f64]),
        x: &mut [f64],
    ) -> Result<(), Singular> {
        self.prepare(nodes, held, weights.body)?;
        let now = self.now(hub, held, at, weights)?;
        let own = self.own as u32;
        self.inner.clear();
        self.forces.clear();
        let mut load = Vector6::zeros();
        for (&i, f) in coordinates.iter().zip(forces) {
            load += *f * self.towards(&now, i);
            if i >= own {
                self.inner.push(i - own);
                self.forces.push(*f);
            }
        }
        let (of_hub, of_nodes) = x.split_at_mut(self.own);
        nodes.add_response(
            now.frame,
            Weights::of_body(weights.body),
            &self.inner,
            &self.forces,
            of_nodes,
        )?;
        self.respond(&now, load, of_hub, of_nodes, false)
    }
}
