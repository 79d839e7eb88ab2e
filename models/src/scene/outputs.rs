//! Reports of a scene: energies, powers, and the values of [`Channel`](super::Channel).

use super::active::sliding_of;
use super::assembled::Scene;
use super::channels::{OfGear, OfMesh};
use super::members::SceneGear;
use crate::Vec3;
use crate::kinematics::Wrench;
use gearbench_integrators::system::{Energy, Outputs, Power, StateView};

/// Number of channels of a mesh.
const PER_MESH: usize = OfMesh::ALL.len();
/// Number of channels of a gear.
const PER_GEAR: usize = OfGear::ALL.len();
/// Positions of single quantities among the channels of a gear.
const TRAVEL: usize = OfGear::Displacement as usize;
const CONTACT_TORQUE: usize = OfGear::ContactTorque as usize;
/// Positions of the torques on both gears among the channels of a mesh.
const TORQUES: [usize; 2] = [OfMesh::FirstTorque as usize, OfMesh::SecondTorque as usize];

/// Adds the force of a contact on the second gear.
fn add_contact(of_mesh: &mut [f64], force: Vec3, normal: f64) {
    of_mesh[OfMesh::X as usize] += force.x;
    of_mesh[OfMesh::Y as usize] += force.y;
    of_mesh[OfMesh::Z as usize] += force.z;
    let least = &mut of_mesh[OfMesh::LeastNormal as usize];
    *least = least.min(normal);
}

impl Scene {
    /// Returns the work of the loads on hubs between two states of a step: mean load times displacement, which is
    /// valid however the hub vibrates in between.
    pub(super) fn loads_between(&self, from: StateView<'_>, to: StateView<'_>) -> f64 {
        let loaded = |g: &&SceneGear| !g.loads.is_empty() && g.model.hub().is_free();
        let work = |g: &SceneGear| {
            let [a, b] = [from, to].map(|at| g.model.hub_state(g.at(at)));
            let load = 0.5 * (g.load(from.t, a.speed) + g.load(to.t, b.speed));
            load * (b.displacement - a.displacement)
        };
        self.gears.iter().filter(loaded).map(work).sum()
    }

    /// Evaluates the contacts at a state once for all observers, because contact may take a solve. Meshes on lines of
    /// action share their candidates with event functions, and are cheap.
    fn evaluate_reported(&mut self, at: StateView<'_>) {
        if self.work.reported.is(at) {
            return;
        }
        self.with_carrier_state(at, |scene, carrier_state| {
            scene.evaluate_contacts(carrier_state)
        });
        if self.fields && self.meshes.iter().all(|m| m.nodal) {
            self.work.reported.keep(at);
        }
    }

    /// Computes the forces of the loads on all coordinates.
    pub fn loads(&self, at: StateView<'_>, forces: &mut Vec<f64>) {
        forces.clear();
        forces.resize(self.n, 0.0);
        for g in &self.gears {
            if !g.loads.is_empty() && g.model.hub().is_free() {
                let hub = g.model.hub();
                let load = g.load(at.t, hub.load_speed(g.at(at)));
                hub.add_load(load, &mut forces[g.range()]);
            }
        }
    }

    /// Computes the channels at a state; with `books` the energies and powers of the gears as well.
    pub(super) fn fill_output(&mut self, at: StateView<'_>, out: &mut Outputs, books: bool) {
        self.evaluate_reported(at);
        let mut energy = Energy::default();
        let mut power = Power::default();
        out.channels.clear();
        out.channels.resize(self.channels.len(), 0.0);
        let per_gear = PER_MESH * self.meshes.len();

        for (i, g) in self.gears.iter().enumerate() {
            let own = g.at(at);
            if books {
                let e = g.model.energy(own);
                energy.kinetic += e.kinetic;
                let p = g.model.powers(own);
                power.external += p.external;
                if !self.carriers.carries(i) {
                    energy.strain += e.strain;
                    power.dissipated += p.dissipated;
                }
            }
            let hub = g.model.hub_state(own);
            if g.model.hub().is_free() {
                let by_load = g.load(at.t, hub.speed) * hub.speed;
                power.external += by_load;
                power.loads += by_load;
            }
            let c = &mut out.channels[per_gear + PER_GEAR * i..][..PER_GEAR];
            c[0] = hub.momentum / g.model.hub().inertia;
            c[1] = hub.speed;
            c[2] = hub.displacement;
        }
        self.add_shaft_books(at, &mut energy, &mut power);
        self.with_carrier_state(at, |scene, carrier_state| {
            scene.add_contact_output(carrier_state, out, (&mut energy, &mut power), books);
        });
        for m in 0..self.meshes.len() {
            let of_mesh = &mut out.channels[PER_MESH * m..][..PER_MESH];
            let places = [OfMesh::X, OfMesh::Y, OfMesh::Z].map(|c| c as usize);
            let force = self
                .carriers
                .direction(m, at, places.map(|c| of_mesh[c]).into());
            let [x, y, z]: [f64; 3] = force.into();
            places
                .iter()
                .zip([x, y, z])
                .for_each(|(c, x)| of_mesh[*c] = x);
            let axis = &self.meshes[m].axis;
            let transverse = match axis.z == 1.0 {
                true => x.hypot(y),
                false => Vec3::new(x, y, z).cross(axis).norm(),
            };
            of_mesh[OfMesh::Transverse as usize] = transverse;
            of_mesh[OfMesh::Force as usize] = match axis.z == 1.0 {
                true => transverse.hypot(z),
                false => Vec3::new(x, y, z).norm(),
            };
        }
        self.fill_reactions(at, &mut out.channels);
        power.external += self.power_of_grounds(at.t);
        out.energy = energy;
        out.power = power;
    }

    /// Adds the contributions of contacts, and of gears on carriers by their pins and teeth, at the carrier-frame
    /// state.
    fn add_contact_output(
        &mut self,
        at: StateView<'_>,
        out: &mut Outputs,
        (energy, power): (&mut Energy, &mut Power),
        books: bool,
    ) {
        let per_gear = PER_MESH * self.meshes.len();
        for (i, g) in self.gears.iter().enumerate() {
            if books && self.carriers.carries(i) {
                energy.strain += g.model.energy(g.at(at)).strain;
                power.dissipated += g.model.powers(g.at(at)).dissipated;
            }
        }
        for (a, rows) in self.work.active.iter().zip(&self.work.rows) {
            let mesh = &self.meshes[a.mesh];
            let c = &self.work.candidates[a.candidate];
            let elastic = mesh.law.force(a.gap, 0.0, a.impact_speed, c.stiffness);
            energy.contact += mesh.law.potential(a.gap, c.stiffness);
            power.dissipated -= (a.force.n - elastic) * a.rate;
            let on = [a.on[0] * c.scale[0], a.on[1] * c.scale[1]];
            power.external += on[0] * a.prescribed.points[0] - on[1] * a.prescribed.points[1];
            power.external += 2.0 * a.along * a.prescribed.path;
            let mut force = a.force.n * c.direction();
            if mesh.friction.is_some() {
                power.dissipated -= a.friction.f * a.sliding;
                power.external -= a.friction.f * (a.sliding - rows[1].dot(at.v));
                force += a.friction.f * sliding_of(c);
            }
            let of_mesh = &mut out.channels[PER_MESH * a.mesh..][..PER_MESH];
            add_contact(of_mesh, force, a.force.n);
            for (k, &i) in mesh.gears.iter().enumerate() {
                let torque = self.on_hub(at, a, k);
                out.channels[per_gear + PER_GEAR * i + CONTACT_TORQUE] += torque;
                out.channels[PER_MESH * a.mesh + TORQUES[k]] += torque;
            }
        }
        self.each_coupling(|_, _, [c, _], [n, o]| energy.contact += c * n * o);
        if self.fields && books {
            let nodal = &self.work.nodal;
            power.dissipated += nodal.dissipated(&self.gears, &self.meshes, at);
        }
        if self.fields {
            self.add_nodal_output(at, out, energy, power);
        }
    }

    /// Adds the contributions of contacts of gears with fields. Energy of the residual compliance counts as that of
    /// contact; a changing load does work on the rotation of the hub by that compliance.
    fn add_nodal_output(
        &self,
        at: StateView<'_>,
        out: &mut Outputs,
        energy: &mut Energy,
        power: &mut Power,
    ) {
        let nodal = &self.work.nodal;
        let per_gear = PER_MESH * self.meshes.len();
        for a in &nodal.active {
            let p = &nodal.found.points[a.point];
            let mesh = &self.meshes[p.mesh as usize];
            // Energy of the contact law, and of the residual compliance.
            let of_law = if mesh.hard {
                0.0
            } else {
                mesh.law.shared(p.share).potential(a.elastic.0, p.stiffness)
            };
            energy.contact += of_law + 0.5 * a.elastic.1 * (a.elastic.0 - p.gap0);
            if a.force.n == 0.0 {
                continue;
            }
            power.external -= a.force.n
                * match a.of_line {
                    // The hub force includes the change of the potential along the path.
                    Some(of_line) => self.line_drift(a, &of_line, at),
                    None => self.nodal_drift(a, (a.direction, a.tapered_gap), at),
                };
            if mesh.friction.is_some() {
                let along = (a.sliding.direction, 0.0);
                power.external -= a.sliding.force.f * self.nodal_drift(a, along, at);
            }
            let of_mesh = &mut out.channels[PER_MESH * p.mesh as usize..][..PER_MESH];
            add_contact(of_mesh, a.on_second(p), a.force.n);
            if let Some(pressure) = self.pressure(p, a.force.n)
                && pressure.peak > of_mesh[OfMesh::Pressure as usize]
            {
                of_mesh[OfMesh::Pressure as usize] = pressure.peak;
                of_mesh[OfMesh::HalfWidth as usize] = pressure.half_width;
            }
            for (k, &i) in mesh.gears.iter().enumerate() {
                let of_hub = (self.gears[i].model.hub(), self.gears[i].at(at));
                let torque = a.on_hub((p, &nodal.found.lines), of_hub, k);
                out.channels[per_gear + PER_GEAR * i + CONTACT_TORQUE] += torque;
                out.channels[PER_MESH * p.mesh as usize + TORQUES[k]] += torque;
            }
        }
        for (i, (g, nodes)) in self.gears.iter().zip(&nodal.gears).enumerate() {
            let Some(field) = g.model.displacement() else {
                continue;
            };
            let mut pressed = 0.0;
            let mut add = |number: u32, force: f64| {
                let mut r = [0.0];
                field.hub_compliance(&[number], &mut r);
                pressed += r[0] * force;
            };
            let outwards = nodes.nodes.iter().zip(&nodes.force);
            for (&number, &force) in outwards.chain(nodes.along.iter().zip(&nodes.friction_force)) {
                add(number, force);
            }
            out.channels[per_gear + PER_GEAR * i + TRAVEL] +=
                field.hub_residual_compliance() * nodes.load - pressed;
            if g.model.hub().is_free() {
                power.external += pressed * g.applied_rate(at.t);
            }
        }
    }

    /// Computes the reactions of the mounts from the channels of contact forces and torques.
    fn fill_reactions(&mut self, at: StateView<'_>, channels: &mut [f64]) {
        let mut forces = std::mem::take(&mut self.work.rhs);
        self.loads(at, &mut forces);
        self.relative_forces(at, &mut forces, |scene, _, f| scene.add_contact_forces(f));
        self.evaluate_links(at, &forces);
        let (of_meshes, others) = channels.split_at_mut(PER_MESH * self.meshes.len());
        let (of_gears, of_shafts) = others.split_at_mut(PER_GEAR * self.gears.len());
        self.fill_shaft_torques(of_shafts);
        let mut relative = std::mem::take(&mut self.work.relative);
        self.carriers.to_carrier_frame(at, &mut relative);
        let (q, v) = (&relative.q, &relative.v);
        let carrier_state = StateView { q, v, ..at };
        let of_gears = of_gears.chunks_exact_mut(PER_GEAR);
        for (i, (g, c)) in self.gears.iter().zip(of_gears).enumerate() {
            let mut contact = Wrench {
                torque: c[CONTACT_TORQUE],
                ..Wrench::default()
            };
            for (mesh, f) in self.meshes.iter().zip(of_meshes.chunks_exact(PER_MESH)) {
                for (k, sign) in [(0, -1.0), (1, 1.0)] {
                    if mesh.gears[k] == i {
                        let of_mesh = [OfMesh::X, OfMesh::Y, OfMesh::Z].map(|c| f[c as usize]);
                        contact.force += sign * Vec3::from(of_mesh);
                    }
                }
            }
            self.add_links_on(i, &mut forces, &mut contact);
            // Pin forces are relative to the carrier, bearing forces relative to the ground.
            let pinned = self.carriers.carries(i);
            let own = g.at(if pinned { carrier_state } else { at });
            if pinned {
                contact.force = self.carriers.direction_at(i, at, contact.force, -1.0);
            }
            let mut r = g.model.mount_reaction(own, &forces[g.range()], &contact);
            if pinned {
                r.force = self.carriers.direction_at(i, at, r.force, 1.0);
            }
            let hub = g.model.hub();
            let along = self.force_of_guide(i);
            r.torque += self.torque_of_ground(i) + along;
            r.force += hub.slide.map_or(Vec3::zeros(), |slide| along * slide);
            let mut x = [0.0; 6];
            if hub.lateral.is_some() {
                x = g.model.hub_motion(own).x;
            }
            let of_mount = [r.force.x, r.force.y, r.torque, r.force.z];
            let [all, shifts, tilts] = [&of_mount[..], &x[..3], &x[3..5]];
            let values = all.iter().chain(shifts).chain(tilts);
            for (c, value) in c[CONTACT_TORQUE + 1..].iter_mut().zip(values) {
                *c = *value;
            }
        }
        self.work.rhs = forces;
        self.work.relative = relative;
    }
}
