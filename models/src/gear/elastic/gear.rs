//! The elastic gear as a gear model.

use super::body::Elastic;
use super::kernels;
use crate::Vec3;
use crate::gear::body::MeshedBody;
use crate::gear::capabilities::{CoupledMass, FlankNodes, FlankSurface, LinearMotion};
use crate::gear::flank_displacement::FlankDisplacement;
use crate::gear::hub_body::{HubBody, HubState};
use crate::gear::model::GearModel;
use crate::geometry::Flanks;
use crate::kinematics::{Locus, Motion, Point, Pose, Row, Wrench};
use crate::spec::Freedom;
use gearbench_integrators::system::{Coeffs, Energy, Power, Singular, StateView};
use std::sync::Arc;

impl FlankDisplacement for Elastic {
    fn near_field(&self) -> Option<&Arc<Vec<Vec<f64>>>> {
        self.data.near_field.as_ref()
    }

    fn displacements(&self, x: &[f64], nodes: &[u32], out: &mut [f64]) {
        kernels::gather(nodes, |k| self.data.shapes_at(k), &x[self.own..], out);
    }

    fn apply_nodal_forces(&self, nodes: &[u32], forces: &[f64], f: &mut [f64]) {
        let f = &mut f[self.own..];
        kernels::scatter(nodes, forces, |k| self.data.shapes_at(k), f);
    }

    fn add_mobility(&self, weights: &[f64], nodes: &[u32], out: &mut [f64]) {
        let weights = &weights[self.own..];
        let n = nodes.len();
        let mut scratch = self.mobility.borrow_mut();
        let (scaled, row) = &mut *scratch;
        row.resize(n, 0.0);
        for (k, &node) in nodes.iter().enumerate() {
            scaled.clear();
            let of_node = self.data.shapes_at(node).iter().zip(weights);
            scaled.extend(of_node.map(|(b, w)| b * w));
            let row = &mut row[..=k];
            kernels::gather(&nodes[..=k], |l| self.data.shapes_at(l), scaled, row);
            for (l, y) in row.iter().enumerate() {
                out[k * n + l] += y;
                if l < k {
                    out[l * n + k] += y;
                }
            }
        }
    }

    fn along_profile(&self) -> Option<u32> {
        self.data.along_profile.then_some(self.data.nodes() as u32)
    }

    fn mode_frequencies(&self) -> &[f64] {
        &self.data.omega
    }

    fn is_compliant(&self) -> bool {
        self.data.residual.is_some()
    }

    fn compliance(&self, nodes: &[u32], out: &mut [f64]) {
        match self.correction.borrow().flanks(&self.data) {
            Some(flanks) if self.data.along_profile => {
                let rows: Vec<u32> = nodes.iter().map(|k| self.data.row_of(*k)).collect();
                flanks.gather(&rows, self.data.rows(), out);
            }
            Some(flanks) => flanks.gather(nodes, self.data.nodes(), out),
            None => out.fill(0.0),
        }
    }

    fn hub_compliance(&self, nodes: &[u32], out: &mut [f64]) {
        for (c, &node) in out.iter_mut().zip(nodes) {
            *c = self
                .data
                .residual
                .as_ref()
                .map_or(0.0, |r| r.hub[self.data.row_of(node) as usize]);
        }
    }

    fn largest_hub_compliance(&self) -> f64 {
        self.hub_reach
    }

    fn hub_residual_compliance(&self) -> f64 {
        self.data.residual.as_ref().map_or(0.0, |r| r.hub_hub)
    }

    fn bound(&self, at: StateView<'_>) -> f64 {
        (self.softest * kernels::squares(&self.omega, at.q)).sqrt()
    }
}

impl GearModel for Elastic {
    fn hub(&self) -> &HubBody {
        &self.hub
    }

    fn hub_mut(&mut self) -> &mut HubBody {
        &mut self.hub
    }

    fn row(&self, at: StateView<'_>, p: &Point, n: &Vec3, row: &mut Row) -> f64 {
        let prescribed = self.hub.row(at, &p.x, n, row);
        let (corners, weights) = match p.locus {
            Locus::Quadrature { face, xi } => (self.data.flanks.corners(face), Flanks::weights(xi)),
            Locus::Node(node) => ([node; 4], [1.0, 0.0, 0.0, 0.0]),
            Locus::Flank { .. } => return prescribed,
        };
        // Displacements are outward: they count with the sign of the normal.
        let pose = self.pose(at);
        let outward = pose.turn(&self.data.normals[corners[0] as usize]);
        let sign = outward.dot(n).signum();
        let shapes = corners.map(|k| self.data.shapes_at(k));
        row.push_span(
            self.own,
            (0..self.data.modes()).map(|i| {
                sign * shapes
                    .iter()
                    .zip(weights)
                    .map(|(b, w)| w * b[i])
                    .sum::<f64>()
            }),
        );
        prescribed
    }

    fn forces(&mut self, at: StateView<'_>, f: &mut [f64]) {
        let own = self.own..self.omega.len();
        let omega = self.omega[own.clone()].iter().zip(&self.zeta[own.clone()]);
        let state = at.q[own.clone()].iter().zip(&at.v[own.clone()]);
        for ((f, (w, z)), (q, v)) in f[own].iter_mut().zip(omega).zip(state) {
            *f -= w * (w * q + 2.0 * z * v);
        }
        self.add_modal_inertia(at.t, f);
        self.add_bearing(at, true, f);
        if let Some(integrals) = self.spinning() {
            self.add_spin_force(integrals, at, self.hub.prescribed_acceleration(at.t), f);
        }
    }

    fn tangent(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        for i in self.own..self.omega.len() {
            let (w, z) = (self.omega[i], self.zeta[i]);
            df[i] -= w * (w * dq[i] + 2.0 * z * dv[i]);
        }
        if let Some(integrals) = self.spinning() {
            let acceleration = self.hub.prescribed_acceleration(at.t);
            self.add_spin_tangent(integrals, at, acceleration, [dq, dv], df);
        }
        self.add_bearing_tangent(at, [dq, dv], df);
    }

    fn correct(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        if self.hub.lateral.is_some() {
            return self.correct_on_bearing(at, c, hub_damping, rhs_to_x);
        }
        let entry = |i: usize| {
            let (w, z) = (self.omega[i], self.zeta[i]);
            let (mass, hub) = if i < self.own {
                (self.hub.inertia, 1.0)
            } else {
                (1.0, self.data.hub[i - self.own])
            };
            (hub, c.m * mass + c.d * 2.0 * z * w + c.k * w * w)
        };
        // A viscous load sees the speed of the hub, frame and modes: one more rank (Sherman and Morrison).
        let damping = c.d * hub_damping * self.own as f64;
        let (mut response, mut flow) = (0.0, 0.0);
        for (i, x) in rhs_to_x.iter_mut().enumerate() {
            let (hub, diagonal) = entry(i);
            if diagonal == 0.0 {
                return Err(Singular);
            }
            *x /= diagonal;
            if damping != 0.0 {
                response += hub * hub / diagonal;
                flow += hub * *x;
            }
        }
        if damping == 0.0 {
            return Ok(());
        }
        let y = damping * flow / (1.0 + damping * response);
        for (i, x) in rhs_to_x.iter_mut().enumerate() {
            let (hub, diagonal) = entry(i);
            *x -= y * hub / diagonal;
        }
        Ok(())
    }

    fn energy(&self, at: StateView<'_>) -> Energy {
        let squares = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        let frame = if self.hub.lateral.is_some() {
            2.0 * self.hub.kinetic(at)
        } else if self.turns() {
            self.hub.inertia * at.v[0].powi(2)
        } else {
            0.0
        };
        let [of_bearing, ..] = self.bearing_books(at);
        let strain: f64 = (at.q.iter().zip(&self.omega))
            .map(|(q, w)| (w * q).powi(2))
            .sum();
        let turning = match self.spinning() {
            Some(integrals) if self.turns() => self.spin_energy(integrals, at),
            _ => 0.0,
        };
        Energy {
            kinetic: 0.5 * (frame + squares(&at.v[self.own..])) + turning,
            strain: 0.5 * strain + of_bearing,
            contact: 0.0,
        }
    }

    fn powers(&self, at: StateView<'_>) -> Power {
        let [_, taken, driven] = self.bearing_books(at);
        Power {
            dissipated: self.dissipated(at) + taken,
            external: self.driven_power(at) + driven,
            ..Power::default()
        }
    }

    fn hub_state(&self, at: StateView<'_>) -> HubState {
        let speed = self.hub.speed(at.t, at.v);
        HubState {
            displacement: self.hub.displacement(at.t, at.q) + self.hub.over_shapes(at.q),
            speed: speed + self.hub.over_shapes(at.v),
            momentum: self.hub.inertia * speed
                + self.over_modes(&self.data.participation, at.v)
                + self.spinning().map_or(0.0, |i| self.spin_momentum(i, at)),
        }
    }

    fn hub_motion(&self, at: StateView<'_>) -> Motion {
        self.hub_motion_on_frame(at)
    }

    /// Returns the reaction from modes and frame together: the centre of mass is at `R(theta) (s + sum_i p_i q_i) / m`
    /// with the unbalance `s`. Truncated modes follow their loads without inertia.
    fn mount_reaction(&self, at: StateView<'_>, forces: &[f64], contact: &Wrench) -> Wrench {
        let d = &*self.data;
        let mut reaction = self.hub.reaction(at.t, contact);
        let prescribed = self.hub.prescribed_acceleration(at.t);
        let speed = self.hub.speed(at.t, at.v);
        let spinning = self.spinning();
        let accelerations = spinning.map(|i| self.spin_accelerations(i, at, forces, prescribed));
        // Place, momentum and its rate in the own frame, as sums over the modes; torque of held hubs.
        let mut own = [d.unbalance, [0.0; 2], [0.0; 2]];
        let mut turning = 0.0;
        for (i, (p, along)) in d.momentum.iter().zip(&d.participation).enumerate() {
            let k = self.own + i;
            let (w, z, q, v) = (self.omega[k], self.zeta[k], at.q[k], at.v[k]);
            let a = match &accelerations {
                Some(all) => all[k],
                None => forces[k] - w * (w * q + 2.0 * z * v) - prescribed * along,
            };
            for (sum, x) in own.iter_mut().zip([q, v, a]) {
                sum[0] += x * p[0];
                sum[1] += x * p[1];
            }
            turning += a * along;
        }
        let [place, momentum, rate] = own.map(|x| Vec3::new(x[0], x[1], 0.0));
        let pose = self.pose(at);
        let Some(slide) = &self.hub.slide else {
            let acceleration = match &accelerations {
                _ if !self.turns() => prescribed,
                Some(all) => all[0],
                None => forces[0] / self.hub.inertia,
            };
            if let (Some(i), Some(all), false) = (spinning, &accelerations, self.turns()) {
                turning += self.spin_torque(i, at, prescribed, all);
            }
            let across = |x: Vec3| Vec3::new(-x.y, x.x, 0.0);
            let total = rate + across(2.0 * speed * momentum + acceleration * place)
                - speed * speed * place;
            reaction.force += pose.turn(&total);
            if !self.turns() {
                reaction.torque += turning;
            }
            return self.with_bearing(at, reaction);
        };
        let mut force = pose.turn(&rate);
        if self.turns() {
            // Its modes hold no momentum along a free slide, up to rounding.
            force -= force.dot(slide) * slide;
        } else {
            reaction.torque += turning;
        }
        reaction.force += force;
        self.with_bearing(at, reaction)
    }

    fn surface(&self) -> Option<FlankSurface<'_>> {
        Some(FlankSurface {
            flanks: &self.data.flanks,
            nodes: self,
            displacement: Some(self),
        })
    }

    fn body(&self) -> Option<&dyn MeshedBody> {
        self.recovery.is_some().then_some(self)
    }

    fn linear(&self) -> Option<&dyn LinearMotion> {
        Some(self)
    }

    fn coupled_mass(&self) -> Option<&dyn CoupledMass> {
        let spins = self.hub.lateral.as_ref().is_some_and(|l| l.spins);
        (spins || (self.turns() && self.spinning().is_some())).then_some(self)
    }
}

impl Elastic {
    #[inline]
    pub(super) fn pose(&self, at: StateView<'_>) -> Pose {
        let displacement = self.hub.displacement(at.t, at.q);
        (self.placement).pose_at(&self.hub, at.t, at.q, displacement)
    }

    /// Adds the bearing forces along the free directions to a reaction.
    fn with_bearing(&self, at: StateView<'_>, mut reaction: Wrench) -> Wrench {
        if let Some(lateral) = &self.hub.lateral {
            let exerted = self.bearing_on_hub(at);
            for d in (0..3).filter(|d| lateral.directions[*d] == Freedom::Free) {
                let axis = &self.hub.axes[d];
                reaction.force += (exerted[d] - reaction.force.dot(axis)) * axis;
            }
        }
        reaction
    }

    fn dissipated(&self, at: StateView<'_>) -> f64 {
        (self.omega.iter().zip(&self.zeta).zip(at.v))
            .map(|((w, z), v)| 2.0 * z * w * v * v)
            .sum()
    }

    pub(super) fn driven_power(&self, at: StateView<'_>) -> f64 {
        if self.turns() {
            return 0.0;
        }
        let acceleration = self.hub.prescribed_acceleration(at.t);
        let turning = (self.spinning()).map_or(0.0, |i| self.spin_power(i, at, acceleration));
        turning - acceleration * self.over_modes(&self.data.participation, at.v)
    }
}

impl FlankNodes for Elastic {
    fn positions(&self, at: StateView<'_>, nodes: &[u32], out: &mut [Vec3]) {
        let pose = self.pose(at);
        for (x, &node) in out.iter_mut().zip(nodes) {
            *x = pose.point(&self.positions[node as usize]);
        }
    }
}

impl CoupledMass for Elastic {
    fn solve(&self, at: StateView<'_>, f_to_a: &mut [f64]) {
        // Regular but where the tilt is singular, which must not pass for an acceleration.
        if self.solve_mass(at, f_to_a).is_err() {
            f_to_a.fill(f64::NAN);
        }
    }

    fn apply(&self, at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        self.apply_mass(at, x, y);
    }
}
