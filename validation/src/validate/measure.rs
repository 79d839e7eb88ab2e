//! Measurements on whole scenes: times of the histories, errors, computing time of a run without observers.

use super::ValidationError;
use gearbench::experiment::machine::timed;
use gearbench::experiment::run::NO_BOUND;
use gearbench::studies::choose::problem::Problem;
use gearbench::studies::choose::trial::{Outcome, WindowModel};
use gearbench_integrators::Scheme;
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_integrators::{AcceptedStep, Control, Sink, TimePlan, Work};
use gearbench_models::spec::Modelling;
use gearbench_reports::Metric;
use std::time::Duration;

/// Bound on the time of one integration of a reference.
pub const PATIENCE: Duration = Duration::from_secs(600);
/// Least processor time of a batch of repeats [s].
const BATCH: f64 = 2e-3;

/// Times at which histories are compared: a fixed number per contact time, within bounds.
pub fn grid(duration: f64, contact_time: f64) -> Vec<f64> {
    const SAMPLES: f64 = 64.0;
    const BOUNDS: [f64; 2] = [400.0, 8000.0];
    let n = (SAMPLES * duration / contact_time).clamp(BOUNDS[0], BOUNDS[1]);
    let n = n.ceil() as u32;
    (0..=n)
        .map(|i| duration * f64::from(i) / f64::from(n))
        .collect()
}

/// Velocity from which on a run is stopped as meaningless [rad/s, m/s]: an unstable run would never end, as teeth at
/// such speeds pass by the thousand in every step.
const MEANINGLESS: f64 = 1e6;

/// Stops a timed run with such speeds.
#[derive(Default)]
struct SpeedBound {
    lost: bool,
}

impl Sink for SpeedBound {
    fn accepted(&mut self, _: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let sound = |v: &f64| v.abs() < MEANINGLESS;
        if step.to.v.iter().all(sound) {
            return Control::Continue;
        }
        self.lost = true;
        Control::Stop
    }
}

/// Runs a scene of a problem with given models to any status, without a time bound: the result must not depend on the
/// load of the machine.
///
/// # Errors
/// [`ValidationError`]: the run cannot start.
pub fn outcome(
    problem: &Problem,
    modelling: &Modelling,
    method: &Scheme,
    times: &[f64],
) -> Result<Outcome, ValidationError> {
    let mut trial = WindowModel::new(problem, &problem.scene, modelling)?;
    Ok(trial.observe(method, (problem.duration, times), false, NO_BOUND)?)
}

/// Error of a run against a reference; `None` if one of them failed or does not have the quantity.
pub fn error(run: &Outcome, metric: Metric, reference: &Outcome) -> Option<f64> {
    let error = (reference.usable()).then(|| run.error(metric, reference));
    error.filter(|e| e.is_finite())
}

/// Processor time of one run through the scene [s]: the shortest of a batch of repeats. `None` if the run failed or took longer than `limit`.
pub fn time(
    trial: &mut WindowModel<'_>,
    method: &Scheme,
    duration: f64,
    limit: Duration,
) -> Option<f64> {
    let mut integrator = method.method.build();
    let mut shortest = f64::INFINITY;
    let mut batch = 0.0;
    loop {
        let mut state = trial.scene.initial();
        let plan = TimePlan {
            time_limit: Some(limit),
            ..TimePlan::new(duration, method.resolution)
        };
        let mut work = Work::default();
        let mut guard = SpeedBound::default();
        let (ended, spent) =
            timed(|| integrator.run(&mut trial.scene, &mut state, &plan, &mut guard, &mut work));
        if ended.is_err() || guard.lost {
            return None;
        }
        shortest = shortest.min(spent);
        batch += spent;
        if batch >= BATCH {
            return Some(shortest);
        }
    }
}

/// Times of two models under their methods [s]: medians of alternating runs, so that the machine is in the same state
/// for both.
pub fn side_by_side(
    a: (&mut WindowModel<'_>, &Scheme),
    b: (&mut WindowModel<'_>, &Scheme),
    duration: f64,
) -> [Option<f64>; 2] {
    const ROUNDS: usize = 7;
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..ROUNDS {
        times[0].extend(time(a.0, a.1, duration, PATIENCE));
        times[1].extend(time(b.0, b.1, duration, PATIENCE));
        // Long runs need no repeats: a second on a processor is known well.
        if times.iter().flatten().sum::<f64>() > 4.0 {
            break;
        }
    }
    times.map(|t| gearbench_reports::numbers::quantile(&t, 0.5))
}
