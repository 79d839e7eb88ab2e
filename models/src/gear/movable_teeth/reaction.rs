//! Reaction force of the mount on a gear with movable teeth.
//!
//! The body's centre of mass lies on the axis, each tooth is a mass `m_t` on the radius `r_d`:
//!
//! ```text
//! R = sum_i m_t r_d (S_i'' t_i - S_i'^2 e_i) - F
//! ```
//!
//! with the radial and tangential directions `e_i`, `t_i` of a tooth and the contact forces `F`. Equal teeth outside
//! the windows are the mean, whose sum over a whole gear vanishes, and their free deviations `d`. The torque of a
//! fixed mount is that of the springs on the body.

use super::teeth::{MovableTeeth, ToothSelection};
use crate::Vec3;
use crate::kinematics::Wrench;
use crate::spec::Mount;
use gearbench_integrators::system::StateView;

impl MovableTeeth {
    pub(super) fn reaction(&self, at: StateView<'_>, forces: &[f64], contact: &Wrench) -> Wrench {
        let mut reaction = self.hub.reaction_at(at, contact);
        let first = self.first();
        let (phi, speed) = (
            self.hub.displacement(at.t, at.q),
            self.hub.speed(at.t, at.v),
        );
        let torque = |i: usize| {
            let (s, v) = (at.q[first + i], at.v[first + i]);
            let p = self.spring(at, i, s);
            p.k * (s - phi) + p.c * (v - speed)
        };
        let own = at.q.len() - first;
        if !self.hub.is_free() {
            let pull = match &self.hub.mount {
                Mount::Driven(speed) => self.body * speed.slope(at.t),
                _ => 0.0,
            };
            reaction.torque = pull - (0..own).map(torque).sum::<f64>();
        }
        if let Some(slide) = &self.hub.slide {
            // Teeth of a rack move along the slide, like its body.
            if !self.hub.is_free() {
                reaction.force += (reaction.torque - reaction.force.dot(slide)) * slide;
            }
            return reaction;
        }
        if self.hub.lateral.is_some() {
            // The spring and damper of the bearing determine its force.
            return reaction;
        }
        let acceleration = |i: usize| {
            let stretch = at.q[first + i] - phi;
            let along = 0.5 * self.spring(at, i, at.q[first + i]).dk * stretch * stretch;
            (forces[first + i] - torque(i) - along) / self.tooth_inertia(i)
        };
        let (assembled, pitch) = match self.views.first() {
            Some(view) => (view.assembled, view.pitch),
            None => return reaction,
        };
        let effective_radius = self.springs.radius_squared.sqrt();
        let mass = |slot: usize| {
            let tooth = if self.springs.uniform { 0 } else { slot };
            self.springs.mass[tooth]
        };
        let mut rate = Vec3::zeros();
        let mut add = |mass: f64, (sin, cos): (f64, f64), v2: f64, a: f64| {
            rate.x += mass * effective_radius * (-a * sin - v2 * cos);
            rate.y += mass * effective_radius * (a * cos - v2 * sin);
        };
        let windows = match &self.integrated {
            ToothSelection::All => {
                for i in 0..own {
                    let angle = assembled + i as f64 * pitch + at.q[first + i];
                    let v = at.v[first + i];
                    add(mass(i), angle.sin_cos(), v * v, acceleration(i));
                }
                reaction.force += rate;
                return reaction;
            }
            ToothSelection::Windows(windows) => windows,
        };
        let (mean, mean_v, mean_a) = (at.q[first], at.v[first], acceleration(0));
        for (mesh, w) in windows.iter().enumerate() {
            for local in 0..w.len() as usize {
                let i = w.base - first + local;
                let tooth = self.tooth_of_slot(at.discrete, mesh, w.slot + local);
                let base = assembled + tooth as f64 * pitch;
                let (s, v) = (at.q[first + i], at.v[first + i]);
                add(mass(0), (base + s).sin_cos(), v * v, acceleration(i));
                // The mean of all teeth would add up to nothing; these places are not its own.
                add(-mass(0), (base + mean).sin_cos(), mean_v * mean_v, mean_a);
            }
        }
        let (mut sin, mut cos) = (assembled + mean).sin_cos();
        let (step_sin, step_cos) = pitch.sin_cos();
        let mut at_tooth = 0;
        let free = &at.discrete[self.head()..];
        self.deviations()
            .each(&self.springs, at.t, free, |tooth, [d, v, a]| {
                while at_tooth < tooth {
                    (sin, cos) = (
                        sin * step_cos + cos * step_sin,
                        cos * step_cos - sin * step_sin,
                    );
                    at_tooth += 1;
                }
                // A deviation is a small angle: its sine and cosine to rounding.
                let d2 = d * d;
                let (small_sin, small_cos) = (d * (1.0 - d2 / 6.0), 1.0 - d2 * (0.5 - d2 / 24.0));
                let own = (
                    sin * small_cos + cos * small_sin,
                    cos * small_cos - sin * small_sin,
                );
                add(mass(0), own, (mean_v + v).powi(2), mean_a + a);
                add(-mass(0), (sin, cos), mean_v * mean_v, mean_a);
            });
        reaction.force += rate;
        reaction
    }
}
