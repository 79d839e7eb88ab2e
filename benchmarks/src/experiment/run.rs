//! Run of one model under one integrator, as a row of the record. A failed run is a row as well.

use super::contact_log::ContactLog;
pub use super::error::RunError;
use super::flanks::{deformed_sections, flank_loads};
use super::history::History;
use super::key::Key;
use super::machine::cpu_time;
use super::monitored_observer::MonitoredObserver;
use super::motion::motion_of_run;
use super::parameters::parameters;
use super::paths::{has_train, torque_paths};
use super::pictures::Pictures;
use super::record::{
    histories, ledger_record, momenta, reduction, sampled_impulse, snapshot, time_series,
};
use super::status::RunMonitor;
use crate::context::Context;
use crate::small_signals::{Patience, assemble};
use gearbench_integrators::modal::resonance::{resonances, safe_step};
use gearbench_integrators::system::{SecondOrderSystem, State};
use gearbench_integrators::{NullSink, Scheme, Sink, StepError, TimePlan, Work, integration_time};
use gearbench_models::error::BuildError;
use gearbench_models::scene::{Channel, Scene};
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reference::limits;
use gearbench_reports::record::{ContactSnapshot, Run};
use std::time::{Duration, Instant};

/// Processor time [s] above which a run is not repeated without observers: their cost is then relatively small.
const LONG: f64 = 1.0;
/// Largest number of timed repeats of a short run.
const MOST_REPEATS: usize = 300;

/// Number of dense matrices that such a method stores at a time: Jacobian, Newton matrix, its factors and intermediate
/// matrices.
const DENSE_COPIES: f64 = 4.0;

/// Name of the setting that lists omitted pairs of model and integrator.
pub const LEFT_OUT: &str = "left out";

/// Time bound of a run without bound: it ends at its final time or at its number of steps.
pub const NO_BOUND: Duration = Duration::from_secs(1_000_000_000);

/// Input of one run: scene, models, integrator, sampling and bounds.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// The scene to simulate.
    pub scene: &'a SceneSpec,
    /// Models of gears and contacts.
    pub modelling: &'a Modelling,
    /// The context of the scene.
    pub context: &'a Context,
    /// Integration method with its step or tolerance.
    pub method: &'a Scheme,
    /// End of the simulated time [s].
    pub t_end: f64,
    /// Sampling times of the histories [s].
    pub grid: &'a [f64],
    /// True if accepted steps in contact are recorded as well.
    pub also_steps: bool,
    /// True if the components of contact and bearing forces are recorded.
    pub forces: bool,
    /// True if torques of gears, and motions and torques of bodies, are recorded, which references may contain besides
    /// forces and the motion of gears.
    pub measurable: bool,
    /// True if the paths of torque and power are computed, also of a pair without shafts.
    pub paths: bool,
    /// True if the data of the history files are stored.
    pub histories: bool,
    /// True if the motion of the gears is stored for the report; needs `histories`.
    pub motion: bool,
    /// Frames for ParaView, if requested.
    pub pictures: Option<&'a Pictures>,
    /// True if contact events are located.
    pub events: bool,
    /// Number of timed repeats.
    pub repeats: u32,
    /// Bound on the processor time of one run, with the recording of its histories.
    pub timeout: Duration,
    /// Bound on the number of steps, rejected ones included; unlike a timeout it does not depend on the machine.
    pub max_steps: u64,
}

impl Job<'_> {
    /// Hash of everything that the result depends on, apart from measured times.
    pub fn key(&self) -> Key {
        Key::new("run")
            .and_scene(self.scene, self.modelling)
            .and(&(self.method, self.t_end, self.grid, self.also_steps))
            .and(&(self.forces, self.measurable, self.paths, self.histories))
            .and(&self.motion)
            .and(&self.pictures)
            .and(&(self.events, self.repeats))
            .and(&(self.timeout, self.max_steps))
    }

    /// Assembles the scene of the job in its initial state; a search for a loaded state is bounded as the run is.
    ///
    /// # Errors
    /// [`BuildError`], also of a scene without such a state.
    pub fn assemble(&self) -> Result<Scene, BuildError> {
        let patience = Patience::of(&self.context.interruption, self.timeout);
        assemble(self.scene, self.modelling, &self.context.models, &patience)
    }

    fn plan(&self) -> TimePlan<'_> {
        TimePlan {
            t_end: self.t_end,
            resolution: self.method.resolution,
            events: self.events,
            max_steps: self.max_steps,
            time_limit: (self.timeout < NO_BOUND).then_some(self.timeout),
            cancel: Some(self.context.interruption.flag()),
        }
    }
}

/// Time that an integration took without its observers [s].
#[derive(Clone, Copy, Debug)]
struct Cost {
    wall: f64,
    /// Processor time; wall time if the system reports no processor time.
    processor: f64,
}

/// The clocks at the start of an integration.
struct Stopwatch {
    wall: Instant,
    processor: Option<f64>,
}

impl Stopwatch {
    fn start() -> Stopwatch {
        Stopwatch {
            wall: Instant::now(),
            processor: cpu_time(),
        }
    }

    /// Cost since the start, without the wall time of the observers.
    fn read(&self, observers: Duration) -> Cost {
        let processor = (self.processor.zip(cpu_time())).map(|(from, to)| to - from);
        let (wall, observed) = (self.wall.elapsed().as_secs_f64(), observers.as_secs_f64());
        Cost {
            wall: (wall - observed).max(0.0),
            processor: integration_time(processor.unwrap_or(wall), observed, wall),
        }
    }
}

/// Memory of the dense matrices of a method in first-order form, with twice the coordinates [bytes].
fn dense_bytes(coordinates: usize) -> f64 {
    DENSE_COPIES * 8.0 * (2.0 * coordinates as f64).powi(2)
}

/// Memory per number of a history while its run is recorded, journalled and written to a table [bytes].
const RECORDED: f64 = 26.0;
/// Memory of a number of a history where no history files are written [bytes].
const MEASURED: f64 = 14.0;

/// Checks the memory of the histories of a run before it is made.
fn check_histories(job: &Job<'_>, scene: &Scene) -> Result<(), RunError> {
    let samples = job.grid.len();
    let columns = scene.channel_count() + 1;
    let bytes = if job.histories { RECORDED } else { MEASURED };
    let what = format!("a run with {samples} samples of {columns} histories");
    let way_out =
        "use fewer `samples` (table [study] of the scene), or fewer models and integrators";
    Ok(limits::check(
        what,
        bytes * samples as f64 * columns as f64,
        way_out,
    )?)
}

/// Runs a job and returns its row; the caller adds model names and metrics.
pub fn run(job: &Job<'_>) -> Result<Run, RunError> {
    run_timed(job, Duration::ZERO)
}

/// Runs a job and repeats a short run until the timed repeats took `together` in sum: the median of three times of some
/// microseconds is too noisy.
pub fn run_timed(job: &Job<'_>, together: Duration) -> Result<Run, RunError> {
    let started = Instant::now();
    let mut scene = job.assemble()?;
    let setup = started.elapsed();
    timed_in(job, &mut scene, setup, together)
}

/// Runs a job as [`run`] does, in a scene that was already built from the job within the time `setup`.
pub fn run_in(job: &Job<'_>, scene: &mut Scene, setup: Duration) -> Result<Run, RunError> {
    timed_in(job, scene, setup, Duration::ZERO)
}

fn timed_in(
    job: &Job<'_>,
    scene: &mut Scene,
    setup: Duration,
    together: Duration,
) -> Result<Run, RunError> {
    let mut state = scene.initial();
    timed_from(job, scene, &mut state, (setup, together), None)
}

/// Runs a job as [`run_in`] does, from a given state of the scene, which becomes the final state.
pub fn run_from(
    job: &Job<'_>,
    scene: &mut Scene,
    state: &mut State,
    setup: Duration,
) -> Result<Run, RunError> {
    timed_from(job, scene, state, (setup, Duration::ZERO), None)
}

/// Runs a job as [`run_in`] does, with one more observer.
pub fn run_with_observer(
    job: &Job<'_>,
    scene: &mut Scene,
    setup: Duration,
    observer: &mut dyn Sink,
) -> Result<Run, RunError> {
    let mut state = scene.initial();
    let times = (setup, Duration::ZERO);
    timed_from(job, scene, &mut state, times, Some(observer))
}

fn timed_from(
    job: &Job<'_>,
    scene: &mut Scene,
    state: &mut State,
    (setup, together): (Duration, Duration),
    observer: Option<&mut dyn Sink>,
) -> Result<Run, RunError> {
    let info = job.method.method.info();
    let mut method = job.method.method.build();
    if info.linear_part && scene.modal().is_none() {
        return Err(RunError::no_linear_part(info.id, scene, job.scene));
    }
    if info.dense_matrices {
        let n = scene.layout().n;
        let what = format!("{} for {n} coordinates", info.id);
        let way_out =
            "use a method that solves with the matrices of the model, for example hht or newmark";
        limits::check(what, dense_bytes(n), way_out)?;
    }
    check_histories(job, scene)?;
    if job.context.interruption.is_requested() {
        return Err(RunError::Interrupted);
    }

    let mut monitor =
        RunMonitor::new(job.scene, scene, job.grid.to_vec(), job.also_steps).under(&job.plan());
    // Whoever looks at the components of forces looks at settled running, which the grid begins with.
    if job.forces {
        monitor.history.pieces_from = job.grid.first().copied().unwrap_or(0.0);
    }
    if job.histories {
        monitor.history.contacts = Some(ContactLog::new(job.scene, scene));
    }
    // Refused before it runs, not after.
    let mut bodies = Vec::new();
    if let Some(pictures) = job.pictures {
        bodies = scene.bodies(job.scene)?;
        monitor.history.frames = pictures.begin(scene)?;
    }
    let start = state.clone();
    let start_momenta = momenta(scene, state);
    let mut work = Work::default();
    let begin = Stopwatch::start();
    let plan = job.plan();
    let outcome = match observer {
        None => method.run(scene, state, &plan, &mut monitor, &mut work),
        Some(observer) => {
            let mut both = MonitoredObserver {
                monitor: &mut monitor,
                observer,
            };
            method.run(scene, state, &plan, &mut both, &mut work)
        }
    };
    // What watching costs is no cost of the method.
    let observed = begin.read(monitor.spent);
    match &outcome {
        Err(StepError::Unsupported { .. }) if scene.layout().n == 0 => {
            let why = "every gear is fixed or driven, so that there is nothing to integrate; free one of them, or use a method with fixed steps";
            return Err(RunError::Unsupported(why.into()));
        }
        Err(e @ StepError::Unsupported { .. }) => return Err(RunError::Unsupported(e.to_string())),
        Err(StepError::Interrupted { .. }) => return Err(RunError::Interrupted),
        _ => {}
    }

    let (status, mut message) = monitor.status(scene, state, &outcome);
    let RunMonitor {
        history, ledger, ..
    } = &monitor;
    if let Some(pictures) = job.pictures {
        pictures.write(job.scene, scene, (&bodies, &history.frames.states))?;
    }
    let series = time_series(job, scene, history);
    let end_momenta = momenta(scene, state);

    if message.is_none() {
        message = resonance_note(job, scene, info.linear_part);
    }

    // Timings come from runs without observers, but for long ones. A failed run is not repeated: its time is no
    // cost.
    let repeats = if status.is_failure() || observed.processor > LONG {
        0
    } else {
        job.repeats
    };
    let mut times: Vec<Cost> = Vec::new();
    let more = |times: &[Cost]| {
        let spent: f64 = times.iter().map(|t| t.processor).sum();
        let short = times.len() < MOST_REPEATS && spent < together.as_secs_f64();
        times.len() < repeats as usize || (repeats > 0 && short)
    };
    while more(&times) {
        let mut s = start.clone();
        let plan = job.plan();
        let begin = Stopwatch::start();
        let _ = method.run(scene, &mut s, &plan, &mut NullSink, &mut Work::default());
        times.push(begin.read(Duration::ZERO));
    }
    // A repeat that was cut short is no time.
    if job.context.interruption.is_requested() {
        return Err(RunError::Interrupted);
    }
    let repeats = times.len() as u32;
    if times.is_empty() {
        times.push(observed);
    }
    let sorted = |of: fn(&Cost) -> f64| {
        let mut all: Vec<f64> = times.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let [walls, processors] = [sorted(|t| t.wall), sorted(|t| t.processor)];
    let middle = times.len() / 2;

    Ok(Run {
        parameters: parameters(job.scene, job.modelling),
        integrator: job.method.method.to_string(),
        implicit: info.implicit,
        exact_linear: info.linear_part,
        step: job.method.resolution.step(),
        rtol: job.method.resolution.tolerance(),
        status,
        message,
        wall_s: walls[middle],
        cpu_s: processors[middle],
        wall_spread_s: Some([walls[0], walls[walls.len() - 1]]),
        repeats,
        setup_s: setup.as_secs_f64(),
        simulated_s: state.t,
        end_s: Some(job.t_end),
        steps: work.steps,
        rejected: work.rejected,
        force_evaluations: work.force_evaluations,
        newton_iterations: work.newton_iterations,
        factorisations: work.factorisations,
        events: work.events,
        dofs: scene.layout().n,
        ledger: ledger_record(
            job,
            ledger,
            history
                .pieces
                .as_ref()
                .and_then(|p| p.meshes.iter().map(|mesh| mesh.impulse).reduce(f64::max))
                .unwrap_or_else(|| sampled_impulse(job.scene, &series)),
            scene
                .on_lines_of_action()
                .then_some([start_momenta, end_momenta]),
        ),
        contacts: history.peak_state.as_ref().map(|s| ContactSnapshot {
            flanks: match job.histories {
                true => flank_loads(job, scene, s, &history.instants.states),
                false => Vec::new(),
            },
            deformed: match job.histories {
                true => deformed_sections(job.scene, scene, s),
                false => Vec::new(),
            },
            ..snapshot(job.scene, scene, s)
        }),
        motion: (job.motion && job.histories).then(|| motion_of_run(job.scene, scene, history)),
        series: Some(series),
        histories: job.histories.then(|| histories(job, scene, history)),
        paths: (job.paths || (job.histories && has_train(job.scene)))
            .then(|| torque_paths(job.scene, scene, history, ledger))
            .flatten(),
        ..reduction(scene, job.modelling)
    })
}

/// Returns a function that integrates a job without observers from the start, for timings.
pub fn bare<'j>(job: &'j Job<'_>, scene: &'j mut Scene) -> impl FnMut() + 'j {
    let mut method = job.method.method.build();
    let start = scene.initial();
    move || {
        let (mut state, mut work) = (start.clone(), Work::default());
        let _ = method.run(scene, &mut state, &job.plan(), &mut NullSink, &mut work);
    }
}

/// Integrates without timing and status, and returns a channel at the sampling times, for fits, in SI units.
pub fn history_on_grid(
    context: &Context,
    scene: &mut Scene,
    method: &Scheme,
    max_steps: u64,
    (grid, channel): (&[f64], Channel),
) -> Result<Vec<f64>, StepError> {
    let mut history = History::new(scene, grid.to_vec());
    let mut state = scene.initial();
    let end = grid.last().copied().unwrap_or(0.0);
    let plan = TimePlan {
        max_steps,
        cancel: Some(context.interruption.flag()),
        ..TimePlan::new(end, method.resolution)
    };
    let sink: &mut dyn Sink = &mut history;
    let mut method = method.method.build();
    method.run(scene, &mut state, &plan, sink, &mut Work::default())?;
    Ok((scene.channel(channel)).map_or_else(Vec::new, |index| history.column(index)))
}

/// A note on modes that resonate with the fixed step of a method that integrates modes exactly.
fn resonance_note(job: &Job<'_>, scene: &mut Scene, linear_part: bool) -> Option<String> {
    let h = job.method.resolution.step()?;
    let n = scene.layout().n;
    let (mut omega, mut zeta) = (vec![0.0; n], vec![0.0; n]);
    scene
        .modal()
        .filter(|_| linear_part)?
        .oscillators(&mut omega, &mut zeta);
    let number = resonances(&omega, h).len();
    (number > 0).then(|| {
        format!(
            "{number} of {n} modes resonate with the step (omega h near a multiple of pi); a step below {:.2e} s has none",
            safe_step(&omega)
        )
    })
}
