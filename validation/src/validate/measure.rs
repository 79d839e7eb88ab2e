//! A model that is ready to run through a whole scene: its history on a given grid, and its time without observers.

use super::ValidationError;
use gearbench::experiment::machine::cpu_time;
use gearbench::experiment::run::{Job, RunError, run_in};
use gearbench::studies::choose::situation::Situation;
use gearbench::studies::choose::wish::Metric;
use gearbench_integrators::Scheme;
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_integrators::{AcceptedStep, Control, Sink, TimePlan, Work};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reports::metrics::Finished;
use gearbench_reports::record::{Ledger, Status};
use gearbench_reports::series::TimeSeries;
use std::time::{Duration, Instant};

/// Bound of one integration of a reference.
pub const PATIENCE: Duration = Duration::from_secs(600);
/// Time on a processor from which the ticks of its clock do not matter [s].
const TICKS: f64 = 0.05;
/// Time that a batch of repeats takes at least [s].
const BATCH: f64 = 2e-3;

/// Times at which histories are compared: so many per contact time, within bounds.
pub fn grid(duration: f64, contact_time: f64) -> Vec<f64> {
    const SAMPLES: f64 = 64.0;
    const BOUNDS: [f64; 2] = [400.0, 8000.0];
    let n = (SAMPLES * duration / contact_time).clamp(BOUNDS[0], BOUNDS[1]);
    let n = n.ceil() as u32;
    (0..=n)
        .map(|i| duration * f64::from(i) / f64::from(n))
        .collect()
}

/// Ends a run whose numbers have no meaning any more [rad/s, m/s]: an unstable one would go on for ever, as teeth that
/// spin that fast pass by the thousand in every step. Costs nothing beside a step.
const MEANINGLESS: f64 = 1e6;

/// Watches a timed run for that alone.
#[derive(Default)]
struct Guard {
    lost: bool,
}

impl Sink for Guard {
    fn accepted(&mut self, _: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let sound = |v: &f64| v.abs() < MEANINGLESS;
        if step.to.v.iter().all(sound) {
            return Control::Continue;
        }
        self.lost = true;
        Control::Stop
    }
}

/// What a run gave.
#[derive(Clone, Debug)]
pub struct Observed {
    /// Its history.
    pub series: TimeSeries,
    /// Its energy.
    pub ledger: Ledger,
    /// Time that it reached and time that it was to reach [s].
    pub times_s: [f64; 2],
    /// How it ended.
    pub status: Status,
    /// Why.
    pub message: Option<String>,
}

impl Observed {
    /// Error against a reference; `None` where the run failed or one of the two has not the quantity.
    pub fn error(&self, metric: Metric, reference: &Observed) -> Option<f64> {
        if self.status.is_failure() || reference.status.is_failure() {
            return None;
        }
        let run = Finished::reached(&self.series, &self.ledger, self.times_s).ok()?;
        let error = metric.error(run, (&reference.series, &reference.ledger));
        error.filter(|e| e.is_finite())
    }
}

/// A model that is set up.
pub struct Ready<'a> {
    situation: &'a Situation,
    spec: &'a SceneSpec,
    modelling: &'a Modelling,
    scene: Scene,
}

impl<'a> Ready<'a> {
    /// Sets a model up.
    ///
    /// # Errors
    /// A scene that cannot be assembled.
    pub fn new(
        situation: &'a Situation,
        spec: &'a SceneSpec,
        modelling: &'a Modelling,
    ) -> Result<Self, ValidationError> {
        let scene = Scene::build(spec, modelling, situation.models).map_err(RunError::from)?;
        Ok(Ready {
            situation,
            spec,
            modelling,
            scene,
        })
    }

    /// Runs through the scene and records at the times of the grid.
    ///
    /// # Errors
    /// A method that the model does not take, or an interruption; a run that fails is a result.
    pub fn observe(
        &mut self,
        method: &Scheme,
        grid: &[f64],
        timeout: Duration,
    ) -> Result<Observed, ValidationError> {
        let job = Job {
            scene: self.spec,
            modelling: self.modelling,
            models: self.situation.models,
            method,
            t_end: self.situation.duration,
            grid,
            // The grid is fine enough, and the same for all.
            also_steps: false,
            forces: false,
            events: true,
            repeats: 0,
            timeout,
            max_steps: u64::MAX,
        };
        let mut row = run_in(&job, &mut self.scene, Duration::ZERO)?;
        Ok(Observed {
            series: row.series.take().unwrap_or_default(),
            ledger: row.ledger,
            times_s: [row.simulated_s, job.t_end],
            status: row.status,
            message: row.message,
        })
    }

    /// Time of one run through the scene [s]: the shortest of a batch of repeats, on a processor where it is long
    /// enough to be told from ticks. `None` when it failed or took longer than `limit`.
    ///
    /// # Errors
    /// A method that is not known.
    pub fn time(
        &mut self,
        method: &Scheme,
        limit: Duration,
    ) -> Result<Option<f64>, ValidationError> {
        let mut integrator = method.method.build();
        let mut shortest = f64::INFINITY;
        let begin = Instant::now();
        loop {
            let mut state = self.scene.initial();
            let plan = TimePlan {
                deadline: Some(Instant::now() + limit),
                ..TimePlan::new(self.situation.duration, method.resolution)
            };
            let (one, start) = (Instant::now(), cpu_time());
            let mut work = Work::default();
            let mut guard = Guard::default();
            let ended = integrator.run(&mut self.scene, &mut state, &plan, &mut guard, &mut work);
            let wall = one.elapsed().as_secs_f64();
            if ended.is_err() || guard.lost {
                return Ok(None);
            }
            let on_processor = match (start, cpu_time()) {
                (Some(a), Some(b)) if b - a >= TICKS => (b - a).min(wall),
                _ => wall,
            };
            shortest = shortest.min(on_processor);
            if begin.elapsed().as_secs_f64() >= BATCH {
                return Ok(Some(shortest));
            }
        }
    }
}

/// Times of two models under their methods [s], measured in turn so that the machine is the same for both: the medians.
///
/// # Errors
/// As [`Ready::time`].
pub fn side_by_side(
    a: (&mut Ready<'_>, &Scheme),
    b: (&mut Ready<'_>, &Scheme),
) -> Result<[Option<f64>; 2], ValidationError> {
    const ROUNDS: usize = 7;
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..ROUNDS {
        times[0].extend(a.0.time(a.1, PATIENCE)?);
        times[1].extend(b.0.time(b.1, PATIENCE)?);
        // Long runs need no repeats: a second on a processor is known well.
        if times.iter().flatten().sum::<f64>() > 4.0 {
            break;
        }
    }
    Ok(times.map(|t| gearbench_reports::choice_check::quantile(&t, 0.5)))
}
