//! The full-order gear: every node moves.
//!
//! Generalised coordinates: the hub's displacement `theta` where the mount leaves it free, then per free node its
//! displacement `d` in space from the assembled position. With absolute displacements the mass matrix of
//! the nodes is constant and there are no Coriolis terms; elasticity is linear in the frame on the hub
//! ([`super::frame`]): `u = R^T (X + d) - X`, strain energy `U = u^T K u / 2`,
//!
//! ```text
//! M_ff d'' + M_fb x_b''(theta) = -R K w + contact,    w = u + beta u'
//! J theta'' + (dx_b/dtheta)^T M_bf d'' = sum_free (z x (X + u)) . K w + T
//! ```
//!
//! `beta` is the retardation time of a body with damping proportional to its stiffness.
//! `b` are the nodes that the hub holds rigidly. Strain energy depends on neither the place nor the turn of the
//! whole gear, so its momenta are conserved by construction. This is the floating frame of reference (A. A.
//! Shabana, *Dynamics of Multibody Systems*, ch. 5) written in absolute coordinates; large turns, small strains.

use super::body::Body;
use super::border::Border;
use super::correction::Correction;
use super::floating::hub_with;
use super::frame::unit_motion;
use super::kinematics::{add3, dot3, node3};
use super::lines::Lines;
use crate::assembly::tie::{MassKind, Tie};
use crate::vector::dot;
use gearbench_integrators::system::{Coeffs, Energy, Power, Singular, StateView};
use gearbench_models::Vec3;
use gearbench_models::gear::{
    CoupledMass, DeformedLines, FlankSurface, GearModel, HubBody, HubState, LargeGear, MeshedBody,
};
use gearbench_models::kinematics::{Hub, Point, Row, Wrench};
use gearbench_models::spec::Mount;
use std::cell::RefCell;

/// Buffers over all nodes, three components each.
#[derive(Debug)]
pub(super) struct Nodal {
    /// Elastic displacement in the frame, or a velocity; entries of tied nodes are not changed.
    pub(super) u: Vec<f64>,
    /// Elastic displacement with retardation, or its rate.
    pub(super) w: Vec<f64>,
    /// Product of stiffness or mass with one of them.
    pub(super) g: Vec<f64>,
    /// A second direction, for tangents.
    pub(super) du: Vec<f64>,
    pub(super) dg: Vec<f64>,
    /// Momentum over the coordinates.
    pub(super) momentum: Vec<f64>,
}

/// A gear with all its nodal displacements.
#[derive(Debug)]
pub struct FullOrder {
    pub(super) hub: HubBody,
    pub(super) body: Body,
    /// Number of hub coordinates, 0 or 1 where it moves in at most one direction; those of the nodes follow.
    pub(super) own: usize,
    pub(super) scratch: RefCell<Nodal>,
    pub(super) correction: RefCell<Correction>,
    pub(super) border: RefCell<Option<Border>>,
    pub(super) lines: Lines,
}

impl FullOrder {
    /// Creates a body on its hub with its base radius [m], or `cos(alpha)` for a rack. The inertia of the hub becomes
    /// that of the mesh plus that added.
    pub fn new(mut hub: Hub, effective_base_radius: f64, body: Body) -> Self {
        hub.inertia = body.inertia;
        if let Some(held) = &body.held {
            hub = hub_with(hub, held);
        }
        let n = 3 * body.position.len();
        let zeros = || vec![0.0; n];
        let own = hub.coordinates();
        let count = 3 * body.free.len();
        let of_hub = HubBody::new(hub, effective_base_radius);
        let masses = if body.mass == MassKind::Lumped {
            let of_nodes = body
                .free
                .iter()
                .map(|&node| body.assembly.lumped[node as usize]);
            let of_nodes = of_nodes.flat_map(|m| [m; 3]);
            let hub = match body.held {
                None => vec![body.hub_inertia; own],
                Some(_) => of_hub.masses.clone(),
            };
            hub.into_iter().chain(of_nodes).collect()
        } else {
            Vec::new()
        };
        let scales = match body.held {
            None => vec![effective_base_radius; own],
            Some(_) => of_hub.scales.clone(),
        };
        let hub = HubBody {
            own: count,
            scales: (scales.into_iter())
                .chain(std::iter::repeat_n(1.0, count))
                .collect(),
            masses,
            conservative: true,
            // The bearing holds the body that stands on the hub, not the few nodes that the hub holds.
            characteristic_time: f64::INFINITY,
            ..of_hub
        };
        // Where the hub borders the nodes, these are corrected as on a held one.
        let border = body.held.as_ref().and_then(|_| Border::new(&hub, count));
        let inner = if border.is_some() { 0 } else { own };
        FullOrder {
            own,
            correction: RefCell::new(Correction::new(&body.reduced, inner)),
            border: RefCell::new(border),
            hub,
            body,
            lines: Lines::default(),
            scratch: RefCell::new(Nodal {
                u: zeros(),
                w: zeros(),
                g: zeros(),
                du: zeros(),
                dg: zeros(),
                momentum: Vec::new(),
            }),
        }
    }

    /// Returns the gear with damping proportional to its stiffness, of body and flanks, with a retardation time [s].
    #[must_use]
    pub fn with_retardation(mut self, retardation: f64) -> Self {
        self.hub.retardation = retardation;
        self.hub.conservative &= retardation == 0.0;
        self
    }

    /// Returns the gear with contact along lines of its flanks.
    #[must_use]
    pub fn with_lines(self, lines: Lines) -> Self {
        FullOrder { lines, ..self }
    }

    /// Returns the finite-element body.
    pub fn body(&self) -> &Body {
        &self.body
    }
}

impl GearModel for FullOrder {
    fn hub(&self) -> &HubBody {
        &self.hub
    }

    fn hub_mut(&mut self) -> &mut HubBody {
        &mut self.hub
    }

    fn initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64], _discrete: &mut [f64]) {
        if self.held().is_some() {
            return self.floating_initialise(speed, q, v);
        }
        q.fill(0.0);
        v[..self.own].fill(speed);
        for (k, &node) in self.body.free.iter().enumerate() {
            let unit = unit_motion(&self.body.position[node as usize].into(), self.slide());
            for axis in 0..3 {
                v[self.own + 3 * k + axis] = speed * unit[axis];
            }
        }
    }

    fn row(&self, at: StateView<'_>, p: &Point, n: &Vec3, row: &mut Row) -> f64 {
        let Some((corners, weights)) = self.corners(p) else {
            return 0.0;
        };
        // The nodes describe the motion of a point except for its height above their face, which rotates with the hub.
        let mut prescribed = 0.0;
        if self.held().is_some() {
            let bulge = self.bulge(at, p, &corners, &weights);
            prescribed = self.floating_row(at, &bulge, n, row);
        } else if self.slide().is_none() {
            let bulge = self.bulge(at, p, &corners, &weights);
            let along = dot3(unit_motion(&bulge.into(), None), n.as_slice());
            if self.own == 0 {
                prescribed = self.hub.speed(at.t, at.v) * along;
            } else if along != 0.0 {
                row.push(0, along);
            }
        }
        for (node, w) in corners.into_iter().zip(weights) {
            let place = self.body.place[node as usize];
            if w != 0.0 && place != Tie::HELD {
                row.push_span(self.own + 3 * place as usize, [w * n.x, w * n.y, w * n.z]);
            }
        }
        prescribed
    }

    fn forces(&mut self, at: StateView<'_>, f: &mut [f64]) {
        if let Some(held) = self.held() {
            return self.floating_forces(held, at, f);
        }
        let frame = self.frame(at);
        let mut nodal = self.scratch.borrow_mut();
        self.strained(at, &mut nodal);
        let Nodal { u, g, .. } = &*nodal;
        if self.own > 0 {
            f[0] += self.torque(u, g);
        }
        for (k, &node) in self.body.free.iter().enumerate() {
            let node = node as usize;
            let force = frame.to_space(node3(g, node));
            add3(f, self.own + 3 * k, force.map(|x| -x));
        }
        let speed = self.hub.speed(at.t, at.v);
        for &(k, pull) in &self.body.pull {
            let force = frame.to_space(pull).map(|x| speed * speed * x);
            add3(f, self.own + 3 * k as usize, force);
        }
    }

    fn tangent(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        if let Some(held) = self.held() {
            return self.floating_tangent(held, at, [dq, dv], df);
        }
        let frame = self.frame(at);
        let mut nodal = self.scratch.borrow_mut();
        self.strained(at, &mut nodal);
        let Nodal {
            u, w, g, du, dg, ..
        } = &mut *nodal;
        let (beta, spin) = (self.hub.retardation, self.hub.speed(at.t, at.v));
        let (dhub, dspeed) = if self.own > 0 {
            (dq[0], dv[0])
        } else {
            (0.0, 0.0)
        };
        du.fill(0.0);
        for (k, &node) in self.body.free.iter().enumerate() {
            let node = node as usize;
            let own = frame.to_frame(node3(&dq[self.own..], k));
            let arm = self.arm(node, u);
            for axis in 0..3 {
                du[3 * node + axis] = own[axis] - dhub * arm[axis];
            }
        }
        let turning = self.slide().is_none();
        if beta == 0.0 {
            w.copy_from_slice(du);
        } else {
            for (k, &node) in self.body.free.iter().enumerate() {
                let node = node as usize;
                let own = frame.to_frame(node3(&dv[self.own..], k));
                let arm = self.arm(node, u);
                let mut rate = [0, 1, 2].map(|axis| own[axis] - dspeed * arm[axis]);
                if turning {
                    // The velocity turns with the frame, the arm with the displacement.
                    let v = frame.to_frame(node3(&at.v[self.own..], k));
                    let turned = [0, 1].map(|axis| dhub * v[axis] + spin * du[3 * node + axis]);
                    rate[0] += turned[1];
                    rate[1] -= turned[0];
                }
                for axis in 0..3 {
                    w[3 * node + axis] = du[3 * node + axis] + beta * rate[axis];
                }
            }
        }
        self.body.assembly.stiffness.apply(w, dg);
        let mut torque = 0.0;
        for (k, &node) in self.body.free.iter().enumerate() {
            let node = node as usize;
            let (force, mut change) = (node3(g, node), node3(dg, node));
            torque += dot3(self.arm(node, u), &change);
            if turning {
                torque += force[1] * du[3 * node] - force[0] * du[3 * node + 1];
                change[0] -= dhub * force[1];
                change[1] += dhub * force[0];
            }
            let change = frame.to_space(change);
            add3(df, self.own + 3 * k, change.map(|x| -x));
        }
        if self.own == 0 {
            return;
        }
        df[0] += torque;
        let speed = at.v[0];
        for &(k, pull) in &self.body.pull {
            let turned = unit_motion(&pull, None);
            let along = frame.to_space(pull);
            let across = frame.to_space(turned);
            for axis in 0..3 {
                df[self.own + 3 * k as usize + axis] +=
                    2.0 * speed * dspeed * along[axis] + speed * speed * dhub * across[axis];
            }
        }
    }

    fn correct(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        FullOrder::solve(self, at, (c, hub_damping), rhs_to_x)
    }

    fn energy(&self, at: StateView<'_>) -> Energy {
        if let Some(held) = self.held() {
            return self.floating_energy(held, at);
        }
        let frame = self.frame(at);
        let speed = self.hub.speed(at.t, at.v);
        let mut nodal = self.scratch.borrow_mut();
        let Nodal { u, g, .. } = &mut *nodal;
        self.velocities(frame, speed, at.v, u);
        self.body.apply_nodal_mass(u, g);
        let kinetic = 0.5 * (dot(u, g) + self.body.added_inertia * speed * speed);
        self.elastic(frame, at.q, u);
        self.body.assembly.stiffness.apply(u, g);
        Energy {
            kinetic,
            strain: 0.5 * dot(u, g),
            contact: 0.0,
        }
    }

    fn powers(&self, at: StateView<'_>) -> Power {
        if self.held().is_some() {
            return self.floating_powers(at);
        }
        Power {
            dissipated: self.damping_power(at),
            external: self.driven_power(at),
            ..Power::default()
        }
    }

    fn hub_state(&self, at: StateView<'_>) -> HubState {
        if self.held().is_some() {
            return self.floating_state(at);
        }
        let frame = self.frame(at);
        let (displacement, speed) = (
            self.hub.displacement(at.t, at.q),
            self.hub.speed(at.t, at.v),
        );
        let mut nodal = self.scratch.borrow_mut();
        let Nodal { u, g, du, .. } = &mut *nodal;
        self.velocities(frame, speed, at.v, u);
        self.body.apply_nodal_mass(u, g);
        self.elastic(frame, at.q, du);
        let mut momentum = self.body.added_inertia * speed;
        for node in 0..self.body.position.len() {
            let arm = frame.to_space(self.arm(node, du));
            momentum += dot3(arm, &g[3 * node..3 * node + 3]);
        }
        HubState {
            displacement,
            speed,
            momentum,
        }
    }

    /// Returns the reaction from the elastic forces on the nodes tied to the hub and the inertia of these. Where their
    /// mass is coupled to that of their neighbours (consistent mass, no drive), the neighbours are assumed to move
    /// rigidly in this: the share of one layer of elements in the acceleration of the rest is neglected.
    fn mount_reaction(&self, at: StateView<'_>, _forces: &[f64], _contact: &Wrench) -> Wrench {
        if self.held().is_some() {
            return self.floating_reaction(at);
        }
        let frame = self.frame(at);
        let speed = self.hub.speed(at.t, at.v);
        let prescribed = self.hub.prescribed_acceleration(at.t);
        let mut nodal = self.scratch.borrow_mut();
        self.strained(at, &mut nodal);
        let Nodal { u, w, g, .. } = &*nodal;
        let mut pull = [0.0; 3];
        for (place, k) in &self.body.grip {
            let node = self.body.free[*place as usize] as usize;
            for (i, pull) in pull.iter_mut().enumerate() {
                *pull += dot3(node3(w, node), &k[3 * i..3 * i + 3]);
            }
        }
        let mut force = Vec3::from(frame.to_space(pull));
        match self.slide() {
            None => {
                let x = self.body.held_moment;
                let inertia = prescribed * Vec3::new(-x.y, x.x, 0.0) - speed * speed * x;
                force += Vec3::from(frame.to_space(inertia.into()));
            }
            Some(e) if self.own > 0 => force -= force.dot(e) * e,
            Some(e) => force += prescribed * self.body.held_mass * e,
        }
        let mut torque = 0.0;
        if self.own == 0 {
            torque = self.body.hub_inertia * prescribed - self.torque(u, g);
        }
        Wrench { force, torque }
    }

    fn surface(&self) -> Option<FlankSurface<'_>> {
        Some(FlankSurface {
            flanks: &self.body.flanks,
            nodes: self,
            displacement: None,
        })
    }

    fn body(&self) -> Option<&dyn MeshedBody> {
        Some(self)
    }

    fn deformed_lines(&self) -> Option<&dyn DeformedLines> {
        (!self.lines.is_empty()).then_some(self)
    }

    fn large(&self) -> Option<&dyn LargeGear> {
        Some(self)
    }

    fn coupled_mass(&self) -> Option<&dyn CoupledMass> {
        (self.body.mass != MassKind::Lumped || self.held().is_some()).then_some(self)
    }
}

impl FullOrder {
    /// Power that a prescribed motion puts into the nodes [W].
    pub(super) fn driven_power(&self, at: StateView<'_>) -> f64 {
        if !matches!(self.hub.mount, Mount::Driven(_)) {
            return 0.0;
        }
        let mut nodal = self.scratch.borrow_mut();
        self.strained(at, &mut nodal);
        let Nodal { u, g, .. } = &*nodal;
        let inertia = self.body.hub_inertia * self.hub.prescribed_acceleration(at.t);
        self.hub.speed(at.t, at.v) * (inertia - self.torque(u, g))
    }
}
