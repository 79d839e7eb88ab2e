//! Movable teeth in free flight, in closed form.
//!
//! With equal teeth (`m`, `c`, `k` about the hub) and nothing that touches, the whole gear's momentum mean `theta`, the
//! mean stretch `x = mean(S_i) - phi` and the deviations `d_i = S_i - mean(S_i)` go their own ways:
//!
//! ```text
//! theta'' = T / J,    x'' + c/m J/J_b x' + k/m J/J_b x = -T/J_b,    d_i'' + c/m d_i' + k/m d_i = 0
//! phi = theta - z m / J x,    S_i = theta + J_b / J x + d_i
//! ```
//!
//! and on a hub whose motion is prescribed `theta = phi`, `x'' + c/m x' + k/m x = -phi''`. So teeth in flight are not
//! integrated at all. The deviations of teeth outside the windows from their mean are in closed form already.

use super::teeth::MovableTeeth;
use crate::gear::capabilities::LinearMotion;
use crate::gear::free_flight::FreeFlight;
use gearbench_integrators::FlightPath;
use gearbench_integrators::system::StateView;

/// Decomposition of the gear into a frame and oscillators.
#[derive(Clone, Copy, Debug)]
struct Parts {
    /// Displacement, speed and acceleration of the momentum mean, or of the prescribed hub.
    frame: [f64; 3],
    /// Mean displacement of the teeth, and its rate.
    mean: [f64; 2],
    /// Mean deflection of the springs and its rate, its frequency, damping ratio and load.
    stretch: [f64; 2],
    omega: f64,
    zeta: f64,
    load: f64,
    /// Frequency and damping ratio of the deviations.
    own_omega: f64,
    own_zeta: f64,
    /// Shares of the mean deflection in the motion of the hub and of the teeth.
    shares: [f64; 2],
}

impl Parts {
    /// Returns the static deflection under the steady load.
    fn resting(&self) -> f64 {
        self.load / (self.omega * self.omega)
    }
}

/// Computes `(v^2 + omega^2 x^2)`, twice the energy per unit of inertia.
fn doubled(omega: f64, x: f64, v: f64) -> f64 {
    v * v + (omega * x).powi(2)
}

impl MovableTeeth {
    /// Returns the decomposition, or `None` for unequal or overdamped teeth, and while a tooth has the stiffness of
    /// its contact.
    fn parts(&self, at: StateView<'_>, load: f64) -> Option<Parts> {
        let p = &self.springs;
        let slots = self.engaged_cell(0)..self.head();
        let engaged = p.radius.is_some() && at.discrete[slots].iter().any(|x| *x != 0.0);
        if !p.uniform || engaged || self.hub.lateral.is_some() {
            return None;
        }
        let first = self.first();
        let number = self.teeth as f64;
        let (m, k, c) = (
            p.mass[0] * p.radius_squared,
            p.stiffness[0] * p.radius_squared,
            p.damping[0] * p.radius_squared,
        );
        let mut mean = [0.0; 2];
        for i in 0..at.q.len() - first {
            mean[0] += self.count(i) * at.q[first + i];
            mean[1] += self.count(i) * at.v[first + i];
        }
        let mean = mean.map(|x| x / number);
        let (phi, speed) = (
            self.hub.displacement(at.t, at.q),
            self.hub.speed(at.t, at.v),
        );
        let stretch = [mean[0] - phi, mean[1] - speed];
        let own_omega = (k / m).sqrt();
        let own_zeta = 0.5 * c / (k * m).sqrt();
        let parts = if self.hub.is_free() {
            let total = self.body + number * m;
            let of_teeth = number * m / total;
            let stiffer = (total / self.body).sqrt();
            Parts {
                frame: [
                    phi + of_teeth * stretch[0],
                    speed + of_teeth * stretch[1],
                    load / total,
                ],
                mean,
                stretch,
                omega: own_omega * stiffer,
                zeta: own_zeta * stiffer,
                load: -load / self.body,
                own_omega,
                own_zeta,
                shares: [-of_teeth, self.body / total],
            }
        } else {
            let slope = self.hub.prescribed_acceleration(at.t);
            Parts {
                frame: [phi, speed, slope],
                mean,
                stretch,
                omega: own_omega,
                zeta: own_zeta,
                load: -slope,
                own_omega,
                own_zeta,
                shares: [0.0, 1.0],
            }
        };
        (parts.zeta < 1.0).then_some(parts)
    }

    /// Returns the deviation of coordinate `first() + i` from the mean, and its rate; zero where it is within the
    /// rounding of angles.
    fn deviation(&self, at: StateView<'_>, parts: &Parts, i: usize) -> [f64; 2] {
        let i = self.first() + i;
        let [d, v] = [at.q[i] - parts.mean[0], at.v[i] - parts.mean[1]];
        let rounding = 4.0 * f64::EPSILON * at.q[i].abs();
        let rests = d.abs() <= rounding
            && v.abs() <= parts.own_omega * rounding + 4.0 * f64::EPSILON * at.v[i].abs();
        if rests { [0.0; 2] } else { [d, v] }
    }
}

impl LinearMotion for MovableTeeth {
    fn free_flight(&self, at: StateView<'_>, load: f64) -> Option<FreeFlight> {
        let parts = self.parts(at, load)?;
        let resting = parts.resting();
        let stretched = doubled(parts.omega, parts.stretch[0] - resting, parts.stretch[1]);
        let mut widest = 0.0_f64;
        for i in 0..at.q.len() - self.first() {
            let [d, v] = self.deviation(at, &parts, i);
            widest = widest.max(doubled(parts.own_omega, d, v));
        }
        let mut displacement = parts.shares[1] * (resting.abs() + stretched.sqrt() / parts.omega)
            + widest.sqrt() / parts.own_omega;
        if self.slots > 0 {
            // A tooth may enter a window with the deviation that it has outside.
            let (dd, vv) =
                self.deviations()
                    .squares(&self.springs, at.t, &at.discrete[self.head()..]);
            let twice = vv + parts.own_omega.powi(2) * dd;
            displacement += twice.sqrt() / parts.own_omega;
        }
        Some(FreeFlight {
            frame: parts.frame,
            outward: 0.0,
            displacement,
        })
    }

    fn add_to_path(&self, at: StateView<'_>, load: f64, first: usize, path: &mut FlightPath) {
        let Some(parts) = self.parts(at, load) else {
            return;
        };
        let own = self.first();
        let teeth = first + own..first + at.q.len();
        let [displacement, speed, acceleration] = parts.frame;
        path.oscillator(0.0, 0.0, [displacement, speed], acceleration);
        if own > 0 {
            path.moves(first, 1.0);
        }
        teeth.clone().for_each(|i| path.moves(i, 1.0));
        path.oscillator(parts.omega, parts.zeta, parts.stretch, parts.load);
        if own > 0 {
            path.moves(first, parts.shares[0]);
        }
        teeth.clone().for_each(|i| path.moves(i, parts.shares[1]));
        for (i, coordinate) in teeth.enumerate() {
            let start = self.deviation(at, &parts, i);
            if start != [0.0; 2] {
                path.oscillator(parts.own_omega, parts.own_zeta, start, 0.0);
                path.moves(coordinate, 1.0);
            }
        }
    }

    /// Returns the work on the gear; on a prescribed hub the springs receive `sum m S''` from it.
    fn steady_work(&self, from: StateView<'_>, to: StateView<'_>, load: f64) -> f64 {
        if self.hub.is_free() {
            return load
                * (self.hub.displacement(to.t, to.q) - self.hub.displacement(from.t, from.q));
        }
        let slope = self.hub.prescribed_acceleration(from.t);
        let [before, after] = [from, to].map(|at| self.hub.speed(at.t, at.v));
        (0..from.q.len())
            .map(|i| {
                let gained = to.v[i] * after - from.v[i] * before;
                self.tooth_inertia(i) * (gained - slope * (to.q[i] - from.q[i]))
            })
            .sum()
    }
}
