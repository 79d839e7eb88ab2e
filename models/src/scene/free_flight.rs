//! Free flight of a scene: its duration and its motion.
//!
//! **Duration.** Under steady loads gears in flight move as their frames do ([`FreeFlight`]), `theta = theta_0 +
//! theta' t + theta'' t^2 / 2`, and the gap between facing flanks of rigid gears is at least `c + p . theta`
//! ([`LineClearance`](crate::contact::LineClearance)). The flanks deviate from these by `B q + r T` of elastic gears
//! and by the displacements of movable teeth relative to their frames, both bounded for the whole flight by the energy
//! `E` of the vibration. No contact can be earlier than the first zero of the clearance less these bounds.
//!
//! **Where.** Frames and oscillators are known in closed form: a free flight over the flight, whatever swings in it,
//! has no error but rounding. Viscous and ramped loads, unequal or overdamped teeth, gears whose modes are coupled by
//! their spin, full finite elements, and elastic gears against movable teeth have no such form or no such bound: they
//! are stepped through as before.

use super::assembled::Scene;
use crate::contact::LineClearance;
use crate::gear::{FreeFlight, work_on_hub};
use gearbench_integrators::FlightPath;
use gearbench_integrators::system::{Events, StateView};

/// Returns the first positive zero of `c + b t + a t^2 / 2` for `c > 0`, or infinity.
fn first_zero(c: f64, b: f64, a: f64) -> f64 {
    // c + b t + a t^2/2 = 0 with u = 1/t: c u^2 + b u + a/2 = 0, whose largest root is the first zero.
    let disc = b * b - 2.0 * a * c;
    if disc < 0.0 {
        return f64::INFINITY;
    }
    let root = disc.sqrt();
    let u = if b <= 0.0 {
        (root - b) / (2.0 * c)
    } else {
        -a / (b + root)
    };
    if u > 0.0 { 1.0 / u } else { f64::INFINITY }
}

/// Returns the clearance of the frames on a line, its rate and acceleration.
fn clearance(line: &LineClearance, frames: [&FreeFlight; 2]) -> [f64; 3] {
    let [a, b] = line.per_displacement;
    let along = |d: usize| a * frames[0].frame[d] + b * frames[1].frame[d];
    [line.assembled + along(0), along(1), along(2)]
}

impl Scene {
    /// Returns a time until which no contact closes and all loads are steady, or `at.t` where no bound is known. The
    /// flights of the gears remain in `self.flights` where the time is later.
    pub(super) fn flight_until(&mut self, at: StateView<'_>) -> f64 {
        let open = |m: &super::SceneMesh| {
            let modes = at.discrete[m.modes()].chunks_exact(2);
            !m.clearances.is_empty() && modes.into_iter().all(|mode| mode[0] == 0.0)
        };
        // Gears on a shaft or a carrier have no closed-form flight.
        let alone = self.shafts.is_empty() && self.carriers.is_empty();
        if !alone || !self.meshes.iter().all(open) {
            return at.t;
        }
        self.flights.clear();
        for g in &self.gears {
            let load = g.steady_load(at.t);
            let Some(flight) = load.and_then(|load| g.model.linear()?.free_flight(g.at(at), load))
            else {
                return at.t;
            };
            self.flights.push(flight);
        }
        let lasts = self.flight_lasts();
        if lasts > 0.0 {
            self.next_breakpoint(at.t).min(at.t + lasts)
        } else {
            at.t
        }
    }

    /// Returns the duration without contact from the flights of the gears [s].
    fn flight_lasts(&self) -> f64 {
        let mut shortest = f64::INFINITY;
        for mesh in &self.meshes {
            let frames = mesh.gears.map(|i| &self.flights[i]);
            let outward: f64 = frames.iter().map(|f| f.outward).sum();
            for line in &mesh.clearances {
                let [gap, rate, acceleration] = clearance(line, frames);
                let beside: f64 = (line.per_displacement.iter().zip(frames))
                    .map(|(p, f)| p.abs() * f.displacement)
                    .sum();
                let gap = gap - outward - beside - mesh.gap_bound;
                if gap <= 0.0 {
                    return 0.0;
                }
                shortest = shortest.min(first_zero(gap, rate, acceleration));
            }
        }
        // Margin for the rounding error of the root.
        shortest * (1.0 - 1e-9)
    }

    /// Computes [`SecondOrderSystem::flight_path`] of the scene.
    pub(super) fn path_from(
        &mut self,
        at: StateView<'_>,
        later: f64,
        path: &mut FlightPath,
    ) -> f64 {
        let until = self.flight_until(at);
        if until > later {
            path.begin(at.t);
            for g in &self.gears {
                let load = g.steady_load(at.t).unwrap_or(0.0);
                if let Some(linear) = g.model.linear() {
                    linear.add_to_path(g.at(at), load, g.offset, path);
                }
            }
        }
        until
    }

    /// Computes [`SecondOrderSystem::steady_work`] of the scene.
    pub(super) fn work_of_flight(&self, from: StateView<'_>, to: StateView<'_>) -> Option<f64> {
        let mut work = 0.0;
        for g in &self.gears {
            let load = g.steady_load(from.t)?;
            work += match g.model.linear() {
                Some(linear) => linear.steady_work(g.at(from), g.at(to), load),
                None => work_on_hub(g.model.as_ref(), g.at(from), g.at(to), load),
            };
        }
        Some(work)
    }
}
