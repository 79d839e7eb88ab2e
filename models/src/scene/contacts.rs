//! Evaluation of all contacts of a scene at one state.

use super::active::{Active, fill_rows, parts, slide, sliding_of};
use super::assembled::Scene;
use super::members::gear_states;
use crate::Vec3;
use crate::contact::CandidateSelection;
use crate::contact::nodal::NodalPoint;
use crate::contact::pairs::{LinePressure, LinesOfAction, all_open};
use crate::geometry::Side;
use crate::kinematics::Tooth;
use crate::law::{FrictionForce, LawForce, retarded};
use gearbench_integrators::system::{MemberContact, SprungMember, StateView};
use std::collections::BTreeMap;

/// Contact force at a point, for figures and reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// Index of the mesh.
    pub mesh: usize,
    /// Teeth of both gears, counted on over turns.
    pub teeth: [Tooth; 2],
    /// Flank side that is in contact.
    pub side: Side,
    /// Position of the contact [m].
    pub x: Vec3,
    /// Force on the second gear of the mesh [N].
    pub force: Vec3,
    /// Normal force [N].
    pub normal_force: f64,
    /// Friction [N], positive where it drives the second gear along the normal rotated by 90 degrees
    /// counter-clockwise.
    pub friction: f64,
    /// Generalised force on the hubs of both gears: torque about the axis [N m], or force along the motion of a rack
    /// [N]. A tip edge in contact off the line of action has a lever other than that of the force, and the parametric
    /// term of the potential along the path contributes.
    pub on_hubs: [f64; 2],
    /// Gap of the contact [m].
    pub gap: f64,
    /// Hertzian pressure of a line contact.
    pub pressure: Option<LinePressure>,
    /// Extent of the flank that the contact represents.
    pub extent: ContactExtent,
}

/// Extent of a flank that a contact represents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactExtent {
    /// Share of the common face width, for a slice of lines of action or a line between flanks.
    Width(f64),
    /// Area [m^2]; 1 for nodes with unit areas.
    Area(f64),
}

impl Scene {
    /// Fills `work.active` and its rows with the contacts at a state.
    #[inline]
    pub(super) fn evaluate_contacts(&mut self, at: StateView<'_>) {
        if self.fields {
            self.evaluate_with_fields(at);
            return;
        }
        self.work.active.clear();
        self.work.candidates.clear();
        let located = at.discrete[0] != 0.0;
        for m in 0..self.meshes.len() {
            if !(located && all_open(&at.discrete[self.meshes[m].modes()])) {
                self.evaluate_mesh(at, m, located);
            }
        }
    }

    /// Adds the forces of all contacts at a state; the contacts are stored only where the forces need that.
    #[inline]
    pub(super) fn add_contacts(&mut self, at: StateView<'_>, f: &mut [f64]) {
        if self.fields {
            self.evaluate_with_fields(at);
        } else {
            self.work.active.clear();
            self.work.candidates.clear();
            let located = at.discrete[0] != 0.0;
            for m in 0..self.meshes.len() {
                let open = located && all_open(&at.discrete[self.meshes[m].modes()]);
                if !(open || self.add_forces_directly(at, m, f)) {
                    self.evaluate_mesh(at, m, located);
                }
            }
        }
        self.add_contact_forces(f);
    }

    /// Appends the contacts of a mesh.
    #[inline(never)]
    pub(super) fn evaluate_mesh(&mut self, at: StateView<'_>, m: usize, located: bool) {
        let Scene {
            gears,
            meshes,
            work,
            ..
        } = self;
        let mesh = &meshes[m];
        let friction = (mesh.friction.as_ref()).map(|f| (f, f.at(gears, mesh, at)));
        let (a, b) = gear_states(gears, mesh, at);
        let first = work.candidates.len();
        let discrete = &at.discrete[mesh.search_discrete()];
        let selection = if located {
            CandidateSelection::Closed(&at.discrete[mesh.modes()])
        } else {
            CandidateSelection::Touching(0.0)
        };
        mesh.search
            .candidates(a, b, discrete, selection, &mut work.candidates);
        for (k, c) in work.candidates.iter().enumerate().skip(first) {
            let i = work.active.len();
            if i == work.rows.len() {
                work.rows.push(Default::default());
            }
            let rows = &mut work.rows[i];
            let prescribed = fill_rows(gears, mesh, [&a, &b], c, rows);
            let rate = rows[0].dot(at.v) + prescribed.gap;
            let impact_speed = mesh.impact_speed(at.discrete, c.slot, rate);
            let law = mesh.law.shared(c.share);
            let force = if mesh.search.points().is_some() {
                let (seen, by) = retarded(c.gap, [c.gap, rate], mesh.retardation);
                let force = law.at_point(seen, rate, c.stiffness);
                LawForce {
                    dn_dg: force.dn_dg * by.gap,
                    dn_dgdot: force.dn_dgdot + force.dn_dg * by.rate,
                    ..force
                }
            } else if located {
                law.smooth_in_mode(
                    mesh.mode(at.discrete, c.slot),
                    c.gap,
                    rate,
                    impact_speed,
                    c.stiffness,
                )
            } else {
                law.clipped(c.gap, rate, impact_speed, c.stiffness)
            };
            // A damped point that parts without force still has the energy of its overlap.
            let parts_without_force = mesh.is_damped() && mesh.search.points().is_some();
            if !located && force.n == 0.0 && !(parts_without_force && c.gap < 0.0) {
                continue;
            }
            let (on, along) = parts(&law, c, c.gap, force.n);
            work.active.push(Active {
                mesh: m,
                candidate: k,
                gap: c.gap,
                rate,
                impact_speed,
                force,
                on,
                along,
                friction: FrictionForce::default(),
                sliding: 0.0,
                prescribed,
            });
            if friction.is_some() {
                let (teeth, side) = mesh.search.flank_of(c);
                let place = (teeth[0], side, c.points[0].x.z);
                let friction = friction.map(|(f, law)| f.here(law, place, at));
                slide(friction, at, rows, &mut work.active[i]);
            }
        }
        if mesh.search.pairs().is_some_and(LinesOfAction::couples) {
            self.add_coupling_along_path(m);
        }
    }

    /// Adds `N w + F t` of all active contacts to `f`.
    #[inline]
    pub(super) fn add_contact_forces(&self, f: &mut [f64]) {
        for (c, rows) in self.work.active.iter().zip(&self.work.rows) {
            rows[0].add_parts_to(c.on, f);
            if c.along != 0.0 {
                // By half for either gear.
                rows[3].add_to(-2.0 * c.along, f);
            }
            if self.meshes[c.mesh].friction.is_some() {
                rows[1].add_to(c.friction.f, f);
            }
        }
        if self.fields {
            self.work.nodal.add_forces(&self.gears, f);
        }
    }

    /// Returns the contact forces at a state, for figures and reports.
    pub fn contact_forces(&mut self, at: StateView<'_>) -> Vec<ContactForce> {
        let mut found = self.with_carrier_state(at, Self::carrier_frame_forces);
        if !self.carriers.is_empty() {
            for contact in &mut found {
                contact.x = self.carriers.place(contact.mesh, at, contact.x);
                contact.force = self.carriers.direction(contact.mesh, at, contact.force);
            }
        }
        found
    }

    /// Returns the contact forces in the carrier-frame state.
    fn carrier_frame_forces(&mut self, at: StateView<'_>) -> Vec<ContactForce> {
        self.evaluate_contacts(at);
        let nodal = self.work.nodal.active.iter().filter(|a| a.force.n > 0.0);
        let nodal = nodal.map(|a| {
            let p = &self.work.nodal.found.points[a.point];
            let hubs = self.meshes[p.mesh as usize].gears;
            ContactForce {
                mesh: p.mesh as usize,
                teeth: p.teeth,
                side: p.side(),
                x: p.x,
                force: a.on_second(p),
                normal_force: a.force.n,
                friction: a.sliding.force.f,
                on_hubs: [0, 1].map(|k| {
                    let gear = &self.gears[hubs[k]];
                    let lines = &self.work.nodal.found.lines;
                    a.on_hub((p, lines), (gear.model.hub(), gear.at(at)), k)
                }),
                gap: a.gap,
                pressure: self.pressure(p, a.force.n),
                extent: match p.line {
                    Some(_) => ContactExtent::Width(p.share),
                    None => ContactExtent::Area(p.share),
                },
            }
        });
        self.work
            .active
            .iter()
            .filter(|c| c.force.n > 0.0)
            .map(|c| {
                let candidate = &self.work.candidates[c.candidate];
                let (teeth, side) = self.meshes[c.mesh].search.flank_of(candidate);
                let direction = candidate.direction();
                ContactForce {
                    mesh: c.mesh,
                    teeth,
                    side,
                    x: candidate.points[0].x,
                    force: c.force.n * direction + c.friction.f * sliding_of(candidate),
                    normal_force: c.force.n,
                    friction: c.friction.f,
                    on_hubs: [0, 1].map(|k| self.on_hub(at, c, k)),
                    gap: c.gap,
                    pressure: None,
                    extent: match self.meshes[c.mesh].search.pairs() {
                        Some(_) => ContactExtent::Width(candidate.share),
                        None => ContactExtent::Area(candidate.share),
                    },
                }
            })
            .chain(nodal)
            .collect()
    }

    /// Returns the Hertzian pressure at a point under a normal force [N], if it is a line contact.
    pub(super) fn pressure(&self, p: &NodalPoint, force: f64) -> Option<LinePressure> {
        let line = &self.work.nodal.found.lines[p.line? as usize];
        let lines = self.meshes[p.mesh as usize].search.lines()?;
        Some(lines.pressure(line.radius, p.share, force))
    }

    /// Returns the generalised force of an active contact on the hub of one of its gears: torque about the axis [N m],
    /// or force along the motion of a rack [N].
    pub(super) fn on_hub(&self, at: StateView<'_>, a: &Active, k: usize) -> f64 {
        let mesh = &self.meshes[a.mesh];
        let c = &self.work.candidates[a.candidate];
        let sign = if k == 0 { -1.0 } else { 1.0 };
        let gear = &self.gears[mesh.gears[k]];
        let (hub, own) = (&gear.model.hub().hub, gear.at(at));
        let x = &c.points[k].x;
        let radius = |n: &Vec3| hub.effective_radius_at(own.t, own.q, x, &(sign * n));
        let mut on =
            a.on[k] * c.scale[k] * radius(&c.direction()) + a.friction.f * radius(&sliding_of(c));
        if let (Some([force, moment]), true) = (&c.along, hub.slide.is_none()) {
            let axis = hub.frame(own.t, own.q).axes[2];
            on -= 2.0 * a.along * (radius(force) + sign * axis.dot(moment));
        }
        on
    }

    /// Lists the closed contacts of the last evaluation by mesh and tooth pair, at the carrier-frame state.
    pub(super) fn fill_touches(&self, at: StateView<'_>, out: &mut Vec<MemberContact>) {
        out.clear();
        let mut sums: BTreeMap<(usize, [i64; 2]), (Vec3, MemberContact)> = BTreeMap::new();
        let mut add = |group: usize, teeth: [Tooth; 2], points: [Vec3; 2], force: Vec3| {
            let members = teeth.map(|t| t.index);
            let (sum, touch) = sums.entry((group, members)).or_insert_with(|| {
                let sprung = [0, 1].map(|k| self.sprung_tooth(at, group, k, teeth[k]));
                let touch = MemberContact {
                    group,
                    members,
                    force: 0.0,
                    sprung,
                };
                (Vec3::zeros(), touch)
            });
            *sum += force;
            for (k, sign) in [(0, -1.0), (1, 1.0)] {
                if let Some(tooth) = &mut touch.sprung[k] {
                    let [radial, tangential] = self.tooth_directions(at, group, k, points[k]);
                    tooth.radial += sign * force.dot(&radial);
                    tooth.tangential += sign * force.dot(&tangential);
                }
            }
        };
        for c in self.work.active.iter().filter(|c| c.force.n != 0.0) {
            let candidate = &self.work.candidates[c.candidate];
            let (teeth, _) = self.meshes[c.mesh].search.flank_of(candidate);
            add(
                c.mesh,
                teeth,
                [0, 1].map(|k| candidate.points[k].x),
                c.force.n * candidate.direction() + c.friction.f * sliding_of(candidate),
            );
        }
        for a in self.work.nodal.active.iter().filter(|a| a.force.n > 0.0) {
            let p = &self.work.nodal.found.points[a.point];
            add(p.mesh as usize, p.teeth, [p.x; 2], a.on_second(p));
        }
        out.extend(sums.into_values().map(|(force, touch)| MemberContact {
            force: force.norm(),
            ..touch
        }));
    }

    /// Returns a movable tooth without the contact force.
    fn sprung_tooth(
        &self,
        at: StateView<'_>,
        mesh: usize,
        k: usize,
        tooth: Tooth,
    ) -> Option<SprungMember> {
        let gear = &self.gears[self.meshes[mesh].gears[k]];
        let spring = gear.model.teeth()?.spring(gear.at(at), tooth)?;
        Some(SprungMember {
            spring: spring.force,
            deflection: spring.deflection,
            ..SprungMember::default()
        })
    }

    /// Returns the radial and tangential direction of a gear at a point, perpendicular to its axis; for a rack out of
    /// its teeth and along its motion.
    fn tooth_directions(&self, at: StateView<'_>, mesh: usize, k: usize, x: Vec3) -> [Vec3; 2] {
        let gear = &self.gears[self.meshes[mesh].gears[k]];
        let (hub, own) = (&gear.model.hub().hub, gear.at(at));
        let frame = hub.frame(own.t, own.q);
        let axis = frame.axes[2];
        if let Some(slide) = hub.slide {
            return [axis.cross(&slide), slide];
        }
        let from_axis = x - frame.origin;
        let radial = (from_axis - axis.dot(&from_axis) * axis).normalize();
        [radial, axis.cross(&radial)]
    }

    /// Evaluates the contacts of a scene with displacement fields.
    pub(super) fn evaluate_with_fields(&mut self, at: StateView<'_>) {
        self.work.reported.forget();
        self.work.active.clear();
        self.work.candidates.clear();
        for m in 0..self.meshes.len() {
            if !self.meshes[m].nodal {
                self.evaluate_mesh(at, m, false);
            }
        }
        self.work.nodal.evaluate(&self.gears, &self.meshes, at);
    }

    /// Returns the flank nodes of a gear with a field that were loaded in the last evaluation.
    pub fn pressed_nodes(&self, gear: usize) -> Vec<u32> {
        let nodes = &self.work.nodal.gears[gear];
        let pressed = nodes.nodes.iter().zip(&nodes.force);
        let pressed = pressed.filter(|(_, f)| **f != 0.0);
        pressed.map(|(node, _)| *node).collect()
    }

    /// Returns the ends of the line of action of a contact [m], in the transverse plane.
    pub fn line_of_action(&self, contact: &ContactForce) -> Option<[[f64; 2]; 2]> {
        let ends = self.meshes.get(contact.mesh)?.search.line(contact.side)?;
        Some(ends.map(|p| self.in_plane(&p)))
    }

    /// Projects a position or direction along the axis of the first gear, in its axes.
    pub fn in_plane(&self, x: &Vec3) -> [f64; 2] {
        let first = self.gears.first().map(|g| &g.model.hub().axes);
        let [a, b, _] = first.unwrap_or(&crate::spec::UPRIGHT);
        [a.dot(x), b.dot(x)]
    }
}
