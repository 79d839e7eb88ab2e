//! Forces and event functions of tooth pairs between two rigid bodies that move in space.
//!
//! A contact acts on both bodies along one line: the forces of all pairs on gear b are one wrench, those on gear a its
//! opposite, and gap rates are those of two points that move with the twist of gear b relative to gear a,
//!
//! ```text
//! F = sum N n,    M = sum (x - o) x N n,    dg/dt = n . (v + w x (x - o))
//! ```
//!
//! No candidates and no rows are made: each body takes one wrench, however many slices and pairs press. Candidates give the
//! same forces of the same pairs with all that pictures, tangents and friction need.

use super::lines::{Line, LinesOfAction, MeshedGears, PairState, ZONE_EVENTS, all_open};
use super::spatial::NearestPoints;
use crate::Vec3;
use crate::contact::gear_state::GearState;
use crate::law::{Law, OPEN, touch_speed};

/// Velocity and angular velocity of gear b relative to gear a.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Twist {
    /// Reference point of the velocity [m].
    pub(crate) origin: Vec3,
    /// Velocity of the reference point [m/s].
    pub(crate) velocity: Vec3,
    /// Angular velocity [rad/s].
    pub(crate) spin: Vec3,
}

/// A mesh of rigid bodies at a state with event location.
pub(crate) struct MeshedBodies<'a> {
    pub(crate) law: &'a Law,
    pub(crate) gears: [GearState<'a>; 2],
    pub(crate) twist: Twist,
    /// Discrete state of the search.
    pub(crate) discrete: &'a [f64],
    /// Per slot `(mode, impact speed)`.
    pub(crate) modes: &'a [f64],
}

/// A tooth pair whose force is evaluated.
struct LoadedPair {
    touch: NearestPoints,
    rate: f64,
    /// Impact speed [m/s] of the damping law.
    speed: f64,
    stiffness: f64,
    stiffness_s: f64,
}

impl LinesOfAction {
    fn contact(
        &self,
        mesh: &MeshedBodies<'_>,
        line: &Line,
        slot: usize,
        p: &PairState,
    ) -> LoadedPair {
        let touch = p
            .touch
            .unwrap_or_else(|| unreachable!("flanks in space touch at a point"));
        let Twist {
            origin,
            velocity,
            spin,
        } = &mesh.twist;
        let rate = (touch.normal).dot(&(velocity + spin.cross(&(touch.x - origin))));
        let (k, k_s) = self.stiffness.eval(self.middle(p.s));
        let weight = self.slices[line.slice].weight;
        LoadedPair {
            touch,
            rate,
            speed: touch_speed(mesh.modes[2 * slot + 1], rate),
            stiffness: k * weight,
            stiffness_s: k_s * weight,
        }
    }

    /// Returns the force and the moment about the origin of the twist that the closed pairs exert on gear b.
    pub(crate) fn wrench_on_second(&self, mesh: &MeshedBodies<'_>) -> [Vec3; 2] {
        let gears = &MeshedGears::new(&mesh.gears[0], &mesh.gears[1]);
        let (mut force, mut moment) = (Vec3::zeros(), Vec3::zeros());
        for (l, line) in self.lines.iter().enumerate() {
            if all_open(&mesh.modes[2 * l * self.pairs..][..2 * self.pairs]) {
                continue;
            }
            let law = mesh.law.shared(self.slices[line.slice].weight);
            let range = self.pairs_of(l, gears, mesh.discrete, true);
            self.each_pair(l, range, gears, |slot, pair, s| {
                let mode = mesh.modes[2 * slot];
                if mode == OPEN {
                    return;
                }
                let p = self.pair(line, gears, pair, s);
                let c = self.contact(mesh, line, slot, &p);
                let n = law.force_in_mode(mode, p.gap, c.rate, c.speed, c.stiffness);
                let mut on_second = n * c.touch.normal;
                if c.stiffness_s != 0.0 {
                    // What the potential changes by along the path.
                    let along = -law.d_potential_dk(p.gap, c.stiffness) * c.stiffness_s;
                    let [by_velocity, by_spin] = c.touch.path;
                    on_second += along * by_velocity;
                    moment += along * by_spin;
                }
                force += on_second;
                moment += (c.touch.x - mesh.twist.origin).cross(&on_second);
            });
        }
        [force, moment]
    }

    /// Computes the event functions of the discrete state: of the zone, and of each pair in it by slot, in metres.
    /// Others are not changed.
    pub(crate) fn watch_bodies(
        &self,
        mesh: &MeshedBodies<'_>,
        zones: &mut [f64],
        slots: &mut [f64],
    ) {
        let gears = &MeshedGears::for_gaps(&mesh.gears[0], &mesh.gears[1]);
        let dissipates = mesh.law.is_dissipative();
        for (l, line) in self.lines.iter().enumerate() {
            if !self.whole_mesh {
                let zone = &mut zones[ZONE_EVENTS * l..][..ZONE_EVENTS];
                self.watch_zone(l, gears, mesh.discrete, zone);
            }
            let law = mesh.law.shared(self.slices[line.slice].weight);
            let range = self.pairs_of(l, gears, mesh.discrete, true);
            let modes = &mesh.modes[2 * l * self.pairs..][..2 * self.pairs];
            if all_open(modes) && self.clearly_open(line, gears, 0.0) {
                // The number of separated pairs does not matter until one approaches.
                self.each_pair(l, range, gears, |slot, _, _| {
                    slots[slot] = self.mesh.base_pitch
                });
                continue;
            }
            self.each_pair(l, range, gears, |slot, pair, s| {
                let p = self.pair(line, gears, pair, s);
                let mode = mesh.modes[2 * slot];
                let open = mode == OPEN;
                slots[slot] = if !dissipates || (open && p.gap > 0.0) {
                    // Gaps are all that open contacts and contacts without damping need.
                    if open { p.gap } else { -p.gap }
                } else {
                    let c = self.contact(mesh, line, slot, &p);
                    match open {
                        true => law.until_it_pushes(p.gap, c.rate, c.speed, c.stiffness),
                        false => law.valid_for(mode, p.gap, c.rate, c.speed, c.stiffness),
                    }
                };
            });
        }
    }
}
