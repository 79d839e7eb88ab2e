//! A model that is assembled once and runs on the window under one method after the other.

use super::pilot::Window;
use super::problem::Problem;
use super::requirement;
use crate::experiment::budget::ProcessorClock;
use crate::experiment::key::Key;
use crate::experiment::machine::timed;
use crate::experiment::run::{Job, RunError, run_in};
use crate::small_signals::{Patience, assemble};
use gearbench_integrators::Scheme;
use gearbench_integrators::{NullSink, TimePlan, Work};
use gearbench_models::gear::table::properties_of;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reports::Metric;
use gearbench_reports::metrics::FinishedRun;
use gearbench_reports::record::{Ledger, Run, Status};
use gearbench_reports::series::TimeSeries;
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// Time after which a run is not repeated further [s].
const LONG_ENOUGH: f64 = 0.04;

/// Returns the reason why a model cannot run, if the error concerns this model alone; `None` for one that ends the
/// study.
pub fn cannot_run(e: &RunError) -> Option<String> {
    match e {
        RunError::Interrupted | RunError::Journal(_) | RunError::Picture(_) => None,
        other => Some(other.to_string()),
    }
}

/// Model that is assembled for runs on the window.
pub struct WindowModel<'a> {
    spec: &'a SceneSpec,
    modelling: &'a Modelling,
    problem: &'a Problem,
    /// The assembled scene.
    pub scene: Scene,
    /// No gear has coordinates but its hub's.
    rigid: bool,
    /// Processor time of the set-up, with the caches as they were.
    pub setup: Duration,
}

/// Result of a run on the window.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Outcome {
    /// Recorded histories over time.
    pub series: TimeSeries,
    /// Energy balance of the run.
    pub ledger: Ledger,
    /// Row of the record, without its history.
    pub row: Run,
    /// Intended end of the run [s].
    pub end_s: f64,
}

impl Outcome {
    /// True if the run reached its end and its results are usable.
    pub fn usable(&self) -> bool {
        !self.row.status.is_failure()
    }

    /// Computes the error against another run; infinite where it cannot be evaluated.
    pub fn error(&self, metric: Metric, reference: &Outcome) -> f64 {
        let times = [self.row.simulated_s, self.end_s];
        (self.usable().then_some(()))
            .and_then(|()| FinishedRun::reached(&self.series, &self.ledger, times).ok())
            .and_then(|run| requirement::error(metric, run, (&reference.series, &reference.ledger)))
            .unwrap_or(f64::INFINITY)
    }
}

impl<'a> WindowModel<'a> {
    /// Assembles a scene with a model for runs on the window.
    pub fn new(
        problem: &'a Problem,
        spec: &'a SceneSpec,
        modelling: &'a Modelling,
    ) -> Result<WindowModel<'a>, RunError> {
        let clock = ProcessorClock::start();
        let patience = Patience::until(&problem.context.interruption);
        let scene = assemble(spec, modelling, &problem.context.models, &patience)?;
        let key = Key::new("set-up").and_scene(spec, modelling);
        let setup_s =
            (problem.runner).piece(key, || Ok::<_, RunError>(clock.elapsed().as_secs_f64()))?;
        Ok(WindowModel {
            spec,
            modelling,
            problem,
            rigid: (modelling.gears.iter())
                .all(|g| properties_of(&problem.context.models, g.id()).rigid),
            scene,
            setup: Duration::from_secs_f64(setup_s),
        })
    }

    /// Runs a method to the end of a window.
    pub fn run(&mut self, method: &Scheme, window: &Window) -> Result<Outcome, RunError> {
        // The characteristic time of modes and of movable teeth is far finer than any jump of a dashpot asks for.
        let timeout = self.problem.timeout;
        self.observe(method, (window.end, &window.grid), self.rigid, timeout)
    }

    /// Runs a method to an end [s] and records at the times of a grid, with accepted steps in contact or without.
    ///
    /// # Errors
    /// A method that the model does not take; a run that fails is a result.
    pub fn observe(
        &mut self,
        method: &Scheme,
        (t_end, grid): (f64, &[f64]),
        also_steps: bool,
        timeout: Duration,
    ) -> Result<Outcome, RunError> {
        let job = Job {
            scene: self.spec,
            modelling: self.modelling,
            context: &self.problem.context,
            method,
            t_end,
            grid,
            also_steps,
            forces: false,
            measurable: false,
            paths: false,
            histories: false,
            motion: false,
            pictures: None,
            events: true,
            repeats: 0,
            timeout,
            max_steps: u64::MAX,
        };
        let runner = &self.problem.runner;
        let key = job.key();
        if let Some(found) = runner.finished(key)? {
            return Ok(found);
        }
        // A run that the budget cuts short is no finished piece: another start may have more time for it.
        let bounded = timeout.min(runner.budget().left());
        let job = Job {
            timeout: bounded,
            ..job
        };
        let mut row = run_in(&job, &mut self.scene, self.setup)?;
        row.contacts = None;
        let outcome = Outcome {
            series: row.series.take().unwrap_or_default(),
            ledger: row.ledger.clone(),
            row,
            end_s: t_end,
        };
        if bounded < timeout && outcome.row.status == Status::Timeout {
            return Ok(outcome);
        }
        runner.piece(key, || Ok(outcome))
    }

    /// Measures the processor time of a method to the end of a window without observers [s]: the shortest of `repeats`.
    /// Measurements of an earlier start are reused.
    ///
    /// # Errors
    /// Those of the journal.
    pub fn cost(&mut self, method: &Scheme, end: f64, repeats: usize) -> Result<f64, RunError> {
        let key = Key::new("cost")
            .and_scene(self.spec, self.modelling)
            .and(&(method, end, repeats));
        let runner = &self.problem.runner;
        runner.piece(key, || Ok(self.measure_cost(method, end, repeats)))
    }

    fn measure_cost(&mut self, method: &Scheme, end: f64, repeats: usize) -> f64 {
        let mut integrator = method.method.build();
        let mut shortest = f64::INFINITY;
        let begin = Instant::now();
        let mut runs = 0;
        while runs < repeats.min(2)
            || (runs < repeats && begin.elapsed().as_secs_f64() < LONG_ENOUGH)
        {
            let mut state = self.scene.initial();
            let plan = TimePlan {
                time_limit: Some(
                    self.problem
                        .timeout
                        .min(self.problem.runner.budget().left()),
                ),
                ..TimePlan::new(end, method.resolution)
            };
            let mut work = Work::default();
            // How it ended is known from the observed run.
            let (_, spent) = timed(|| {
                integrator.run(&mut self.scene, &mut state, &plan, &mut NullSink, &mut work)
            });
            shortest = shortest.min(spent);
            runs += 1;
        }
        shortest
    }
}
