//! The full-order gear on a hub that moves in several directions, or about a tilted axis.
//!
//! Generalised coordinates are those of the hub, its own first, then the displacements `d` of the free nodes in space. With the
//! frame at `x = c + s + R (X + u)` ([`super::frame_pose`]), places `y = R (X + u)` and elastic forces `h = R K u`,
//!
//! ```text
//! M_ff d'' + M_fb x_b'' = -h + contact
//! v_d . (M_bf d'' + M_bb x_b'') + added = sum_free v_d(y) . h + bearing + load
//! x_b'' = sum_d x_d'' v_d + w_b x y + w x (w x y)
//! ```
//!
//! The held nodes among themselves and what is added are one rigid body ([`super::tied_nodes`]), whose spin terms, with those of
//! prescribed accelerations, and the bearing are those of every hub ([`gearbench_models::kinematics::OutOfPlane`]). Gyroscopic,
//! centrifugal and Coriolis forces of the others follow from absolute coordinates: they cannot be switched off.
//!
//! As for rigid gears, kinetic energy counts the free directions of the hub; drives of the others do work against
//! elasticity, and through spin terms.

use super::FullOrder;
use super::frame_pose::FramePose;
use super::gear::Nodal;
use super::kinematics::{add3, node3};
use super::tied_nodes::TiedNodes;
use crate::assembly::tie::Tie;
use crate::vector::dot;
use gearbench_integrators::system::{Energy, Power, StateView};
use gearbench_models::Vec3;
use gearbench_models::gear::HubState;
use gearbench_models::kinematics::{Hub, OutOfPlane, Row, Wrench};
use gearbench_models::spec::{Bearing, Freedom};
use std::sync::Arc;

/// Force, and its moment about the hub.
#[derive(Clone, Copy, Debug, Default)]
struct Load {
    force: Vec3,
    moment: Vec3,
}

/// Returns the hub with the rigid body of the nodes tied to it.
pub(super) fn hub_with(hub: Hub, held: &TiedNodes) -> Hub {
    let (directions, bearing) = match &hub.lateral {
        Some(l) => (l.directions.clone(), l.bearing),
        None => ([const { Freedom::Fixed }; 6], Bearing::default()),
    };
    Hub {
        lateral: Some(Arc::new(OutOfPlane {
            directions,
            bearing,
            body: held.body,
            spins: true,
        })),
        ..hub
    }
}

#[inline]
fn vec3(x: &[f64], node: usize) -> Vec3 {
    node3(x, node).into()
}

impl FullOrder {
    /// Returns the coupling of the tied nodes, where the hub moves in several directions.
    #[inline]
    pub(super) fn held(&self) -> Option<&TiedNodes> {
        self.body.held.as_ref()
    }

    #[inline]
    pub(super) fn frame_pose(&self, at: StateView<'_>) -> FramePose {
        FramePose::of(&self.hub, at)
    }

    /// Elastic forces of the free nodes on the hub, in space.
    fn elastic_load(&self, frame_pose: &FramePose, u: &[f64], g: &[f64]) -> Load {
        let mut sum = Load::default();
        for &node in &self.body.free {
            let node = node as usize;
            let (y, force) = (self.body.position[node] + vec3(u, node), vec3(g, node));
            sum.force += force;
            sum.moment += y.cross(&force);
        }
        Load {
            force: frame_pose.turn * sum.force,
            moment: frame_pose.turn * sum.moment,
        }
    }

    pub(super) fn floating_initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64]) {
        q.fill(0.0);
        v.fill(0.0);
        if self.hub.is_free() {
            v[0] = speed;
        }
        let at = StateView {
            t: 0.0,
            q,
            v,
            discrete: &[],
        };
        let frame_pose = self.frame_pose(at);
        for (k, &node) in self.body.free.iter().enumerate() {
            let velocity =
                frame_pose.velocity(&(frame_pose.turn * self.body.position[node as usize]));
            v[self.own + 3 * k..][..3].copy_from_slice(velocity.as_slice());
        }
    }

    /// Returns the row of the part that moves with the hub, at `bulge` from the nodes of a face.
    pub(super) fn floating_row(
        &self,
        at: StateView<'_>,
        bulge: &Vec3,
        n: &Vec3,
        row: &mut Row,
    ) -> f64 {
        if *bulge == Vec3::zeros() {
            return 0.0;
        }
        let frame_pose = self.frame_pose(at);
        let mut rates = frame_pose.motion.v;
        for (k, d) in self.hub.free_directions().enumerate() {
            rates[d] = 0.0;
            if d >= 3 {
                row.push(k, frame_pose.unit(d, bulge).dot(n));
            }
        }
        (3..6)
            .map(|d| rates[d] * frame_pose.unit(d, bulge).dot(n))
            .sum()
    }

    pub(super) fn floating_forces(&self, held: &TiedNodes, at: StateView<'_>, f: &mut [f64]) {
        let frame_pose = self.frame_pose(at);
        let mut nodal = self.scratch.borrow_mut();
        self.strained(at, &mut nodal);
        let Nodal { u, g, .. } = &*nodal;
        let load = self.elastic_load(&frame_pose, u, g);
        for (f, d) in f.iter_mut().zip(self.hub.free_directions()) {
            *f += frame_pose.component(d, &load.force, &load.moment);
        }
        for (k, &node) in self.body.free.iter().enumerate() {
            let force = -(frame_pose.turn * vec3(g, node as usize));
            add3(f, self.own + 3 * k, force.into());
        }
        let [spin, second] = frame_pose.spin();
        for (k, _, moment) in &held.mass {
            let y = frame_pose.turn * moment;
            let pull = -(second.cross(&y) + spin.cross(&spin.cross(&y)));
            add3(f, self.own + 3 * *k as usize, pull.into());
        }
        self.hub.add_lateral_forces(at, f);
    }

    pub(super) fn floating_tangent(
        &self,
        held: &TiedNodes,
        at: StateView<'_>,
        [dq, dv]: [&[f64]; 2],
        df: &mut [f64],
    ) {
        let frame_pose = self.frame_pose(at);
        let mut nodal = self.scratch.borrow_mut();
        self.strained(at, &mut nodal);
        let Nodal {
            u, w, g, du, dg, ..
        } = &mut *nodal;
        let (mut dx, mut rates) = ([0.0; 6], [0.0; 6]);
        for (k, d) in self.hub.free_directions().enumerate() {
            (dx[d], rates[d]) = (dq[k], dv[k]);
        }
        let along = frame_pose.along(&dx);
        // How the rate of the strain turns with the frame is left out.
        let rate = frame_pose.along(&rates);
        let [turning, shifting] = [rate.turn, rate.shift].map(|x| frame_pose.turn.tr_mul(&x));
        let beta = self.hub.retardation;
        w.fill(0.0);
        let [turned, shifted] = [along.turn, along.shift].map(|x| frame_pose.turn.tr_mul(&x));
        du.fill(0.0);
        for (k, &node) in self.body.free.iter().enumerate() {
            let node = node as usize;
            let y = self.body.position[node] + vec3(u, node);
            let own = frame_pose.turn.tr_mul(&vec3(&dq[self.own..], k));
            let change = own - shifted - turned.cross(&y);
            du[3 * node..][..3].copy_from_slice(change.as_slice());
            let own = frame_pose.turn.tr_mul(&vec3(&dv[self.own..], k));
            let with_rate = change + beta * (own - shifting - turning.cross(&y));
            w[3 * node..][..3].copy_from_slice(with_rate.as_slice());
        }
        self.body.assembly.stiffness.apply(w, dg);
        let load = self.elastic_load(&frame_pose, u, g);
        let mut change = Load::default();
        for (k, &node) in self.body.free.iter().enumerate() {
            let node = node as usize;
            let (force, mut of_force) = (vec3(g, node), vec3(dg, node));
            let y = self.body.position[node] + vec3(u, node);
            change.force += of_force;
            change.moment += vec3(du, node).cross(&force) + y.cross(&of_force);
            of_force += turned.cross(&force);
            add3(df, self.own + 3 * k, (-(frame_pose.turn * of_force)).into());
        }
        // The sums turn with the frame.
        let force = frame_pose.turn * change.force + along.turn.cross(&load.force);
        let moment = frame_pose.turn * change.moment + along.turn.cross(&load.moment);
        for (df, d) in df.iter_mut().zip(self.hub.free_directions()) {
            *df += frame_pose.component(d, &force, &moment);
            if d >= 3 {
                *df += along.axes[d - 3].dot(&load.moment);
            }
        }
        let ([spin, second], [dspin, dsecond]) =
            (frame_pose.spin(), frame_pose.spin_change(&along, &rates));
        for (k, _, moment) in &held.mass {
            let y = frame_pose.turn * moment;
            let dy = along.turn.cross(&y);
            let pull = dsecond.cross(&y)
                + second.cross(&dy)
                + dspin.cross(&spin.cross(&y))
                + spin.cross(&(dspin.cross(&y) + spin.cross(&dy)));
            add3(df, self.own + 3 * *k as usize, (-pull).into());
        }
        self.hub.add_lateral_tangent(at, [dq, dv], df);
    }

    /// Multiplies by the mass matrix: `y = M x`.
    pub(super) fn floating_mass(
        &self,
        held: &TiedNodes,
        at: StateView<'_>,
        x: &[f64],
        y: &mut [f64],
    ) {
        let frame_pose = self.frame_pose(at);
        let (hub, nodes) = x.split_at(self.own);
        let mut rates = [0.0; 6];
        for (d, x) in self.hub.free_directions().zip(hub) {
            rates[d] = *x;
        }
        let along = frame_pose.along(&rates);
        let mut nodal = self.scratch.borrow_mut();
        let Nodal { u, g, .. } = &mut *nodal;
        u.fill(0.0);
        for (k, &node) in self.body.free.iter().enumerate() {
            u[3 * node as usize..][..3].copy_from_slice(&nodes[3 * k..][..3]);
        }
        self.body.apply_nodal_mass(u, g);
        for (k, &node) in self.body.free.iter().enumerate() {
            y[self.own + 3 * k..][..3].copy_from_slice(&g[3 * node as usize..][..3]);
        }
        // Between free and held nodes, both ways.
        let mut load = Load::default();
        for (k, mass, moment) in &held.mass {
            let place = frame_pose.turn * moment;
            let moved = *mass * along.shift + along.turn.cross(&place);
            add3(y, self.own + 3 * *k as usize, moved.into());
            let a = vec3(nodes, *k as usize);
            load.force += *mass * a;
            load.moment += place.cross(&a);
        }
        let Some(lateral) = &self.hub.lateral else {
            return;
        };
        let mass = lateral.mass_matrix(&frame_pose.motion.x);
        for (y, i) in y.iter_mut().zip(self.hub.free_directions()) {
            let own: f64 = (0..6).map(|j| mass[i][j] * rates[j]).sum();
            *y = own + frame_pose.component(i, &load.force, &load.moment);
        }
    }

    pub(super) fn floating_energy(&self, held: &TiedNodes, at: StateView<'_>) -> Energy {
        let mut momentum = std::mem::take(&mut self.scratch.borrow_mut().momentum);
        momentum.resize(at.v.len(), 0.0);
        self.floating_mass(held, at, at.v, &mut momentum);
        let kinetic = 0.5 * dot(&momentum, at.v);
        let mut nodal = self.scratch.borrow_mut();
        nodal.momentum = momentum;
        let Nodal { u, g, .. } = &mut *nodal;
        self.elastic(self.frame(at), at.q, u);
        self.body.assembly.stiffness.apply(u, g);
        Energy {
            kinetic,
            strain: 0.5 * dot(u, g) + self.hub.bearing_energy(at)[0],
            contact: 0.0,
        }
    }

    pub(super) fn floating_powers(&self, at: StateView<'_>) -> Power {
        let frame_pose = self.frame_pose(at);
        let mut driven = frame_pose.motion.v;
        for d in self.hub.free_directions() {
            driven[d] = 0.0;
        }
        let mut external = self.hub.driven_power(at);
        if driven.iter().any(|v| *v != 0.0) {
            let mut nodal = self.scratch.borrow_mut();
            self.strained(at, &mut nodal);
            let Nodal { u, g, .. } = &*nodal;
            let load = self.elastic_load(&frame_pose, u, g);
            let of = |d: usize| driven[d] * frame_pose.component(d, &load.force, &load.moment);
            external -= (0..6).map(of).sum::<f64>();
        }
        Power {
            dissipated: self.hub.bearing_energy(at)[1] + self.damping_power(at),
            external,
            ..Power::default()
        }
    }

    /// Linear momentum [kg m/s] and angular momentum about the hub's origin [kg m^2/s] of the whole gear.
    pub fn momenta(&self, at: StateView<'_>) -> [Vec3; 2] {
        let frame_pose = self.frame_pose(at);
        let mut nodal = self.scratch.borrow_mut();
        let Nodal { u, g, du, .. } = &mut *nodal;
        let frame = frame_pose.frame();
        for (node, &place) in self.body.place.iter().enumerate() {
            let velocity = match place {
                Tie::HELD => frame_pose.velocity(&(frame_pose.turn * self.body.position[node])),
                place => vec3(&at.v[self.own..], place as usize),
            };
            u[3 * node..][..3].copy_from_slice(velocity.as_slice());
        }
        self.body.apply_nodal_mass(u, g);
        self.elastic(frame, at.q, du);
        let (mut linear, mut angular) = (Vec3::zeros(), Vec3::zeros());
        for node in 0..self.body.position.len() {
            let (y, p) = (self.body.position[node] + vec3(du, node), vec3(g, node));
            linear += p;
            angular += (frame_pose.turn * y).cross(&p);
        }
        // The added mass is at the origin of the frame.
        let [spin, _] = frame_pose.spin();
        let axes = self.hub.axes.map(|a| frame_pose.turn * a);
        linear += self.body.added.0 * frame_pose.velocity(&Vec3::zeros());
        for (axis, inertia) in axes.iter().zip(self.body.added.1.iter()) {
            angular += *inertia * axis.dot(&spin) * axis;
        }
        [linear, angular]
    }

    pub(super) fn floating_state(&self, at: StateView<'_>) -> HubState {
        let own = self.hub.moving();
        let frame_pose = self.frame_pose(at);
        let [linear, angular] = self.momenta(at);
        HubState {
            displacement: frame_pose.motion.x[own],
            speed: frame_pose.motion.v[own],
            momentum: frame_pose.component(own, &linear, &angular),
        }
    }

    /// Returns the reaction: the bearing forces in the free directions; in the others the elastic forces on the tied
    /// nodes, and the inertia of these without accelerations of the free directions.
    pub(super) fn floating_reaction(&self, at: StateView<'_>) -> Wrench {
        let Some(lateral) = &self.hub.lateral else {
            return Wrench::default();
        };
        let frame_pose = self.frame_pose(at);
        let mut pull = Vec3::zeros();
        let mut nodal = self.scratch.borrow_mut();
        self.strained(at, &mut nodal);
        for (place, k) in &self.body.grip {
            let node = self.body.free[*place as usize] as usize;
            for i in 0..3 {
                pull[i] += super::kinematics::dot3(node3(&nodal.w, node), &k[3 * i..3 * i + 3]);
            }
        }
        let [spin, second] = frame_pose.spin();
        let prescribed = frame_pose.along(&frame_pose.motion.prescribed);
        let y = frame_pose.turn * self.body.held_moment;
        let second = second + prescribed.turn;
        let inertia = (self.body.held_mass + self.body.added.0) * prescribed.shift
            + second.cross(&y)
            + spin.cross(&spin.cross(&y));
        let mut force = frame_pose.turn * pull + inertia;
        let exerted = lateral.bearing_forces(&frame_pose.motion);
        let own = self.hub.moving();
        for free in self.hub.free_directions().filter(|d| *d < 3) {
            let axis = &self.hub.axes[free];
            let by_bearing = if free == own { 0.0 } else { exerted[free] };
            force += (by_bearing - force.dot(axis)) * axis;
        }
        let mut torque = 0.0;
        if !self.hub.is_free() && own >= 3 {
            let Nodal { u, g, .. } = &*nodal;
            let load = self.elastic_load(&frame_pose, u, g);
            let spins = lateral.spin_forces(&frame_pose.motion)[own];
            torque = -spins - frame_pose.component(own, &load.force, &load.moment);
        } else if !self.hub.is_free() {
            torque = force.dot(&self.hub.axes[own]);
        }
        Wrench { force, torque }
    }
}
