//! First and second time derivatives of outputs, for hosts that extrapolate.
//!
//! Outputs are evaluated shortly before and after the present state, `y(t - d)`, `y(t)`, `y(t + d)`, for central
//! differences. These states are classical Runge-Kutta steps on the present branch of the contacts, so that inputs,
//! velocities and dampers contribute in all orders. With `d` a small share of the time scale of the forces, both
//! truncation, `(w d)^2`, and rounding stay near 1e-6.

use crate::instance::{CallResult, Instance, Kind, fail};
use gearbench::fmu::interface::Role;
use gearbench_integrators::system::Report;
use gearbench_integrators::{Outputs, SecondOrderSystem, State, StateView};
use gearbench_models::scene::Scene;

/// Step of the difference quotient, relative to the characteristic time.
const PART: f64 = 3e-3;
/// Step of the difference quotient for scenes without a characteristic time [s].
const SLOW: f64 = 1e-3;

/// The state at a later time on the same branch of the contact law.
fn later(scene: &mut Scene, s: &State, h: f64) -> State {
    let n = s.q.len();
    let mut rate = |c: f64, q: &[f64], v: &[f64]| {
        let t = s.t + c * h;
        let discrete = &s.discrete;
        let at = StateView { t, q, v, discrete };
        let mut a = vec![0.0; n];
        scene.force(at, &mut a);
        scene.solve_mass(at, &mut a);
        (v.to_vec(), a)
    };
    let moved = |x: &[f64], c: f64, dx: &[f64]| -> Vec<f64> {
        x.iter().zip(dx).map(|(x, dx)| x + c * h * dx).collect()
    };
    let mut rates = vec![rate(0.0, &s.q, &s.v)];
    for c in [0.5, 0.5, 1.0] {
        let (dq, dv) = &rates[rates.len() - 1];
        let (q, v) = (moved(&s.q, c, dq), moved(&s.v, c, dv));
        rates.push(rate(c, &q, &v));
    }
    let mut to = s.clone();
    to.t += h;
    for ((dq, dv), weight) in rates.iter().zip([1.0, 2.0, 2.0, 1.0]) {
        to.q = moved(&to.q, weight / 6.0, dq);
        to.v = moved(&to.v, weight / 6.0, dv);
    }
    to
}

impl Instance {
    /// Returns the first or second time derivative of an output.
    ///
    /// # Errors
    /// The order is not one or two, or the variable is not an output.
    pub fn slope(&mut self, reference: u32, order: i32) -> CallResult<f64> {
        self.running(Kind::CoSimulation)?;
        let variable = self.coupled.interface.variables.get(reference as usize);
        let Some(&Role::Output(channel)) = variable.map(|v| &v.role) else {
            return fail(format!("variable {reference} is no output"));
        };
        match order {
            1 | 2 => Ok(self.slopes()[order as usize - 1][channel]),
            _ => fail(format!(
                "a derivative of order {order}; there are those of orders 1 and 2"
            )),
        }
    }

    fn slopes(&mut self) -> &[Vec<f64>; 2] {
        self.settle();
        let (scene, s) = (&mut self.coupled.scene, &self.memory.state);
        self.known.slopes.get_or_insert_with(|| {
            let time = scene.characteristic_time(s.at());
            let d = PART * if time.is_finite() { time } else { SLOW };
            let [before, here, after] = [-d, 0.0, d].map(|h| {
                let mut out = Outputs::default();
                let there = match h == 0.0 {
                    true => s.clone(),
                    false => later(scene, s, h),
                };
                scene.sample(there.at(), &mut out);
                out.channels
            });
            let all = 0..here.len();
            [
                all.clone()
                    .map(|i| (after[i] - before[i]) / (2.0 * d))
                    .collect(),
                all.map(|i| (after[i] - 2.0 * here[i] + before[i]) / (d * d))
                    .collect(),
            ]
        })
    }
}
