//! The elastic gear in free flight: modes that oscillate about their static deflection under the load, in closed form.
//!
//! About `q_s = g / omega^2` under steady loads `g` the modes keep, with damping lose, the energy
//! `E = sum (v^2 + omega^2 (q - q_s)^2) / 2`, so that by Cauchy and Schwarz
//!
//! ```text
//! |B q + r T| <= sqrt(2 c E) + sqrt(c sum omega^2 q_s^2) + max |r| |T|,   c = max over the nodes of sum b^2 / omega^2
//! ```
//!
//! bounds how far a node stands off its rigid flank for the whole flight.

use super::body::Elastic;
use crate::gear::capabilities::{LinearMotion, Oscillators};
use crate::gear::free_flight::FreeFlight;
use crate::gear::model::GearModel;
use gearbench_integrators::FlightPath;
use gearbench_integrators::system::StateView;

impl Elastic {
    /// Returns the modal loads of a steady load on the hub, or of its prescribed acceleration.
    fn modal_loads(&self, t: f64, load: f64) -> impl Iterator<Item = f64> + '_ {
        let (shapes, factor) = if self.turns() {
            (&self.data.hub, load)
        } else {
            (
                &self.data.participation,
                -self.hub.prescribed_acceleration(t),
            )
        };
        shapes.iter().map(move |s| s * factor)
    }

    /// Returns twice the energy of the oscillation about the static deflection, and twice that of the deflection.
    fn energies(&self, at: StateView<'_>, load: f64) -> [f64; 2] {
        let (mut swinging, mut resting) = (0.0, 0.0);
        let state = at.q[self.own..].iter().zip(&at.v[self.own..]);
        for ((w, (q, v)), g) in
            (self.omega[self.own..].iter().zip(state)).zip(self.modal_loads(at.t, load))
        {
            let stretch = w * (q - g / (w * w));
            swinging += stretch * stretch + v * v;
            resting += (g / w).powi(2);
        }
        [swinging, resting]
    }
}

impl Elastic {
    /// Adds the inertia forces of a prescribed hub acceleration on the modes.
    pub(super) fn add_modal_inertia(&self, t: f64, f: &mut [f64]) {
        let acceleration = self.hub.prescribed_acceleration(t);
        if acceleration == 0.0 {
            return;
        }
        for (f, l) in f[self.own..].iter_mut().zip(&self.data.participation) {
            *f -= acceleration * l;
        }
    }
}

impl LinearMotion for Elastic {
    fn oscillators(&self) -> Option<Oscillators<'_>> {
        // Coriolis forces couple the modes.
        let [omega, zeta] = self.swings.as_ref()?;
        self.spinning()
            .is_none()
            .then_some(Oscillators { omega, zeta })
    }

    fn spins(&self) -> bool {
        self.spinning().is_some()
    }

    fn add_other_forces(&self, at: StateView<'_>, f: &mut [f64]) {
        self.add_modal_inertia(at.t, f);
        self.add_bearing(at, false, f);
    }

    fn set_quasi_static_correction(&self, missing: Option<&[f64]>) {
        self.correct_by(missing);
    }

    fn free_flight(&self, at: StateView<'_>, load: f64) -> Option<FreeFlight> {
        // How far flanks are apart is linear in one displacement alone.
        if self.spinning().is_some() || self.hub.lateral.is_some() {
            return None;
        }
        let [swinging, resting] = self.energies(at, load);
        let outward = (self.softest * swinging).sqrt() + (self.softest * resting).sqrt();
        Some(FreeFlight {
            frame: self.hub.frame(at, load),
            outward: outward + (self.hub_reach * load).abs(),
            displacement: 0.0,
        })
    }

    fn add_to_path(&self, at: StateView<'_>, load: f64, first: usize, path: &mut FlightPath) {
        self.hub.add_to_path(at, load, first, path);
        for (i, g) in (self.own..).zip(self.modal_loads(at.t, load)) {
            path.oscillator(self.omega[i], self.zeta[i], [at.q[i], at.v[i]], g);
            path.moves(first + i, 1.0);
        }
    }

    /// Returns the work of a prescribed acceleration on the modes, in addition to that of loads.
    fn steady_work(&self, from: StateView<'_>, to: StateView<'_>, load: f64) -> f64 {
        if self.turns() {
            return load * (self.hub_state(to).displacement - self.hub_state(from).displacement);
        }
        let moved: f64 = (self.data.participation.iter().zip(from.q).zip(to.q))
            .map(|((l, a), b)| l * (b - a))
            .sum();
        -self.hub.prescribed_acceleration(from.t) * moved
    }
}
