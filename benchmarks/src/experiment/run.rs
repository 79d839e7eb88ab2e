//! One model under one integrator: a row of the record. A run that fails is a row as well.

use super::history::History;
use super::parameters::parameters;
use super::status::RunMonitor;
use gearbench_integrators::modal::resonance::{resonances, safe_step};
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::system::{Outputs, Report, SecondOrderSystem};
use gearbench_integrators::{
    Integrator, MethodError, NullSink, Resolution, Scheme, Sink, State, StepError, TimePlan, Work,
};
use gearbench_models::error::BuildError;
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::table::Model;
use gearbench_models::geometry::Side;
use gearbench_models::scene::{Channel, OfGear, OfMesh, Scene};
use gearbench_models::spec::{Body, Modelling, SceneSpec, effective_radius};
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reports::metrics::TRANSMISSION_ERROR;
use gearbench_reports::record::{self, ContactPoint, ContactSnapshot, Outline, Run, finite};
use gearbench_reports::series::{Column, TimeSeries};
use std::time::{Duration, Instant};

/// A run that took longer [s] is not repeated without observers: what they cost is small beside it.
const LONG: f64 = 1.0;
/// Timed repeats of a run at most, however short it is.
const MOST_REPEATS: usize = 300;

/// The setting that names pairs of a model and an integrator that cannot run it.
pub const LEFT_OUT: &str = "left out: needs a linear part";

/// No bound of wall-clock time: what ends such a run is its end, or the number of its steps.
pub const NO_BOUND: Duration = Duration::from_secs(1_000_000_000);

/// What a run needs to know.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// The scene.
    pub scene: &'a SceneSpec,
    /// Its models.
    pub modelling: &'a Modelling,
    /// Table of models.
    pub models: &'a [Model],
    /// Integrator.
    pub method: &'a Scheme,
    /// End [s].
    pub t_end: f64,
    /// Times to record at [s].
    pub grid: &'a [f64],
    /// Record accepted steps in contact as well.
    pub also_steps: bool,
    /// Record the components of contact and bearing forces.
    pub forces: bool,
    /// Locate events.
    pub events: bool,
    /// Timed repeats.
    pub repeats: u32,
    /// Wall-clock bound of one integration.
    pub timeout: Duration,
    /// Bound on its steps, rejected ones included: a timeout that does not depend on the machine.
    pub max_steps: u64,
}

impl Job<'_> {
    fn plan(&self) -> TimePlan<'_> {
        TimePlan {
            t_end: self.t_end,
            resolution: self.method.resolution,
            events: self.events,
            max_steps: self.max_steps,
            deadline: Some(Instant::now() + self.timeout),
            cancel: None,
        }
    }
}

/// Why a run could not even start, or was stopped by the user.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The scene cannot be assembled.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The integrator is not known or its parameters are wrong.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The integrator cannot do what is asked.
    #[error("{0}")]
    Unsupported(String),
    /// The integrator needs a linear part to be exact for, which not every model has.
    #[error(
        "`{0}` needs gears whose coordinates are oscillators, as those of rigid and elastic gears are; name another integrator for this model, for example velocity-verlet or dopri5"
    )]
    NoLinearPart(String),
    /// A run that others are to be held against did not reach the end.
    #[error("{0}")]
    Reference(String),
}

/// Runs a job and fills a row; model names and metrics are the caller's.
pub fn run(job: &Job<'_>) -> Result<Run, RunError> {
    run_timed(job, Duration::ZERO)
}

/// The same, with further repeats of a short run until those that are timed took this long together: the median of
/// three times of some microseconds says little.
pub fn run_timed(job: &Job<'_>, together: Duration) -> Result<Run, RunError> {
    let started = Instant::now();
    let mut scene = Scene::build(job.scene, job.modelling, job.models)?;
    let setup = started.elapsed();
    timed_in(job, &mut scene, setup, together)
}

/// [`run`] in a scene that has been built from the job's scene and models already, which took `setup`.
pub fn run_in(job: &Job<'_>, scene: &mut Scene, setup: Duration) -> Result<Run, RunError> {
    timed_in(job, scene, setup, Duration::ZERO)
}

fn timed_in(
    job: &Job<'_>,
    scene: &mut Scene,
    setup: Duration,
    together: Duration,
) -> Result<Run, RunError> {
    let info = job.method.method.info();
    let mut method = job.method.method.build();
    if info.linear_part && scene.modal().is_none() {
        return Err(RunError::NoLinearPart(info.id.into()));
    }

    let mut monitor = RunMonitor::new(job.scene, scene, job.grid.to_vec(), job.also_steps);
    let mut state = scene.initial();
    let start_momenta = momenta(scene, &state);
    let mut work = Work::default();
    let begin = Instant::now();
    let outcome = method.run(scene, &mut state, &job.plan(), &mut monitor, &mut work);
    let observed = begin.elapsed().as_secs_f64();
    if let Err(StepError::Unsupported { .. }) = outcome {
        return Err(RunError::Unsupported(outcome.unwrap_err().to_string()));
    }

    let (status, mut message) = monitor.status(scene, &state, &outcome);
    let RunMonitor {
        history, ledger, ..
    } = &monitor;
    let series = time_series(job, scene, history);
    let end_momenta = momenta(scene, &state);

    if message.is_none() {
        message = resonance_note(job, scene, info.linear_part);
    }

    // Timings come from runs without observers, but for long ones. A failed run is not repeated: its time is no
    // cost.
    let repeats = if status.is_failure() || observed > LONG {
        0
    } else {
        job.repeats
    };
    let mut walls: Vec<f64> = Vec::new();
    let more = |walls: &[f64]| {
        let short =
            walls.len() < MOST_REPEATS && walls.iter().sum::<f64>() < together.as_secs_f64();
        walls.len() < repeats as usize || (repeats > 0 && short)
    };
    while more(&walls) {
        let mut s = scene.initial();
        let plan = job.plan();
        let begin = Instant::now();
        let _ = method.run(scene, &mut s, &plan, &mut NullSink, &mut Work::default());
        walls.push(begin.elapsed().as_secs_f64());
    }
    let repeats = walls.len() as u32;
    if walls.is_empty() {
        walls.push(observed);
    }
    walls.sort_by(f64::total_cmp);
    let wall_s = walls[walls.len() / 2];

    let reduction = reduction(scene, job.modelling);
    let (step, rtol) = match job.method.resolution {
        Resolution::Step(h) => (Some(h), None),
        Resolution::Tolerance(r) => (None, Some(r)),
    };
    Ok(Run {
        parameters: parameters(job.scene, job.modelling),
        integrator: job.method.method.to_string(),
        implicit: info.implicit,
        exact_linear: info.linear_part,
        step,
        rtol,
        status,
        message,
        wall_s,
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
        modes: reduction.modes,
        residual: reduction.residual,
        choose: reduction.choose,
        highest_hz: reduction.highest_hz,
        ledger: ledger_record(
            job,
            ledger,
            &series,
            scene
                .on_lines_of_action()
                .then_some([start_momenta, end_momenta]),
        ),
        contacts: history
            .peak_state
            .as_ref()
            .map(|s| snapshot(job.scene, scene, s)),
        series: Some(series),
        ..Run::default()
    })
}

/// What a record says of the modes of elastic gears.
#[derive(Default)]
struct Reduction {
    modes: Option<usize>,
    residual: Option<bool>,
    choose: Option<String>,
    highest_hz: Option<f64>,
}

fn reduction(scene: &Scene, modelling: &Modelling) -> Reduction {
    let mut found = Reduction::default();
    for (gear, spec) in scene.gears().iter().zip(&modelling.gears) {
        let Some(field) = gear.model.displacement() else {
            continue;
        };
        let kept = gear.model.hub().own;
        // The characteristic time of such a gear is that of its fastest mode.
        let highest = (std::f64::consts::TAU * gear.model.hub().characteristic_time).recip();
        found.modes = found.modes.max(Some(kept));
        found.residual = Some(found.residual.unwrap_or(false) || field.is_compliant());
        if kept > 0 {
            found.highest_hz = Some(found.highest_hz.unwrap_or(0.0).max(highest));
        }
        if let Some(way) = ElasticParameters::of(spec).and_then(|p| p.choose) {
            found.choose = Some(way.id().into());
        }
    }
    found
}

/// Integrates without timing or judging and returns the force at the grid times: for fits.
pub fn force_on_grid(
    scene: &mut Scene,
    method: &mut dyn Integrator,
    resolution: Resolution,
    max_steps: u64,
    grid: &[f64],
) -> Result<Vec<f64>, StepError> {
    let mut history = History::new(scene, grid.to_vec(), false);
    let mut state = scene.initial();
    let end = grid.last().copied().unwrap_or(0.0);
    let plan = TimePlan {
        max_steps,
        ..TimePlan::new(end, resolution)
    };
    let sink: &mut dyn Sink = &mut history;
    method.run(scene, &mut state, &plan, sink, &mut Work::default())?;
    Ok(history.force())
}

/// What a reader must know of modes that resonate with a fixed step of a method that is exact for them.
fn resonance_note(job: &Job<'_>, scene: &mut Scene, linear_part: bool) -> Option<String> {
    let Resolution::Step(h) = job.method.resolution else {
        return None;
    };
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

fn time_series(job: &Job<'_>, scene: &Scene, history: &History) -> TimeSeries {
    let spec = job.scene;
    let values =
        |channel: Channel| (scene.channel(channel)).map_or_else(Vec::new, |c| history.column(c));
    let of_gear = |g: usize, what: OfGear| values(Channel::Gear(g, what));
    let mut series = TimeSeries {
        time_s: history.time.clone(),
        contact_force_n: history.force(),
        omega1_rad_s: turning(spec, 0, of_gear(0, OfGear::Speed)),
        omega2_rad_s: turning(spec, 1, of_gear(1, OfGear::Speed)),
        columns: Vec::new(),
    };
    let mut put = |name: String, values: Vec<f64>| series.columns.push(Column { name, values });
    let column = |channel: Channel| (channel.column(spec), values(channel));
    let (gears, meshes) = (0..spec.gears.len(), 0..spec.meshes.len());
    let mut add = |channel: Channel| {
        let (name, values) = column(channel);
        put(name, values);
    };
    gears
        .clone()
        .for_each(|g| add(Channel::Gear(g, OfGear::Displacement)));
    if let Some(values) = transmission_error(spec, |g| of_gear(g, OfGear::Displacement)) {
        put(TRANSMISSION_ERROR.into(), values);
    }
    let mut add = |channel: Channel| {
        let (name, values) = column(channel);
        put(name, values);
    };
    if job.forces {
        for (force, bearing) in [(OfMesh::X, OfGear::BearingX), (OfMesh::Y, OfGear::BearingY)] {
            meshes.clone().for_each(|m| add(Channel::Mesh(m, force)));
            gears.clone().for_each(|g| add(Channel::Gear(g, bearing)));
        }
    }
    for m in meshes {
        if m > 0 {
            add(Channel::Mesh(m, OfMesh::Force));
        }
        add(Channel::Mesh(m, OfMesh::Transverse));
    }
    // The first two gears have columns of their own, but in [rad/s].
    for (g, gear) in spec.gears.iter().enumerate() {
        if g > 1 || matches!(gear.body, Body::Rack(_)) {
            add(Channel::Gear(g, OfGear::Speed));
        }
    }
    series.finite_prefix()
}

/// Speeds of a gear [rad/s]; of a rack its speed over the reference radius of the first gear that it meshes with.
fn turning(scene: &SceneSpec, gear: usize, mut speed: Vec<f64>) -> Vec<f64> {
    let Some(Body::Rack(_)) = scene.gears.get(gear).map(|g| &g.body) else {
        return speed;
    };
    let mate = scene.meshes.iter().find_map(|m| match m.gears {
        [a, b] if a == gear => Some(b),
        [a, b] if b == gear => Some(a),
        _ => None,
    });
    if let Some(Body::Gear(mate)) = mate.map(|i| &scene.gears[i].body) {
        speed.iter_mut().for_each(|v| *v /= mate.r_reference());
    }
    speed
}

/// How far the flanks of the first mesh that were placed have moved into each other along the line of action since
/// rigid ones would have touched [m].
fn transmission_error(
    scene: &SceneSpec,
    displacement: impl Fn(usize) -> Vec<f64>,
) -> Option<Vec<f64>> {
    let mesh = scene.meshes.first()?;
    let approach = approach(mesh.start.side, mesh.gears.map(|i| &scene.gears[i].body));
    let [x, y] = mesh.gears.map(displacement);
    let error = |(x, y): (&f64, &f64)| approach(*x, *y) - mesh.start.gap;
    Some(x.iter().zip(&y).map(error).collect())
}

/// Approach of the flanks of one side by the displacements of two gears [m].
pub(super) fn approach(side: Side, [a, b]: [&Body; 2]) -> impl Fn(f64, f64) -> f64 {
    let along_b = if matches!(b, Body::Gear(_)) {
        1.0
    } else {
        -1.0
    };
    let [pa, pb] = [
        side.sign() * effective_radius(a),
        side.sign() * along_b * effective_radius(b),
    ];
    move |x, y| pa * x + pb * y
}

/// Momentum of each gear along its line of action, `L / r_b` [N s].
fn momenta(scene: &mut Scene, state: &State) -> Vec<f64> {
    let mut out = Outputs::default();
    scene.output(state.at(), &mut out);
    scene
        .gears()
        .iter()
        .map(|g| g.model.hub_state(g.at(state.at())).momentum)
        .collect()
}

fn ledger_record(
    job: &Job<'_>,
    ledger: &Ledger,
    series: &TimeSeries,
    momenta: Option<[Vec<f64>; 2]>,
) -> record::Ledger {
    // Momenta lie along the lines of action in the transverse plane, and so does their exchange.
    let name = Channel::Mesh(0, OfMesh::Transverse).column(job.scene);
    let transverse = series.columns.iter().find(|c| c.name == name);
    let transverse = transverse.map_or(&[][..], |c| &c.values);
    let impulse: f64 = series
        .time_s
        .windows(2)
        .zip(transverse.windows(2))
        .map(|(t, f)| 0.5 * (t[1] - t[0]) * (f[0] + f[1]))
        .sum();
    // Without loads a mesh of two free gears keeps L1/r1 - L2/r2 (both counter-clockwise positive) as long as
    // its forces stay on the lines of action.
    let two_free = job.scene.gears.len() == 2
        && job.scene.gears.iter().all(|g| {
            g.loads.is_empty()
                && matches!(
                    g.mount,
                    gearbench_models::spec::Mount::Revolute
                        | gearbench_models::spec::Mount::Prismatic
                )
        });
    let drift = momenta.filter(|_| two_free).map(|[start, end]| {
        let r = [
            effective_radius(&job.scene.gears[0].body),
            effective_radius(&job.scene.gears[1].body),
        ];
        let sign = if matches!(job.scene.gears[1].body, Body::Gear(_)) {
            -1.0
        } else {
            1.0
        };
        let change: Vec<f64> = start.iter().zip(&end).map(|(a, b)| b - a).collect();
        let moved = (change[0] / r[0]).abs().max(f64::MIN_POSITIVE);
        (change[0] / r[0] + sign * change[1] / r[1]) / moved
    });
    let e = ledger.end;
    record::Ledger {
        energy_start_j: ledger.start.and_then(|e| finite(e.total())),
        energy_end_j: finite(e.total()),
        kinetic_j: finite(e.kinetic),
        strain_j: finite(e.strain),
        contact_j: finite(e.contact),
        external_work_j: finite(ledger.external),
        // What a damper leaves in the contact when it lets go is lost there and then.
        dissipated_j: finite(ledger.dissipated - ledger.jumps),
        parametric_work_j: finite(ledger.parametric),
        residual_j: finite(ledger.residual()),
        residual_rel: finite(ledger.residual_relative()),
        impulse_ns: finite(impulse),
        invariant_drift_rel: drift.and_then(finite),
    }
}

/// The mesh at one state: outlines turned and placed, contacts with their forces.
fn snapshot(spec: &SceneSpec, scene: &mut Scene, state: &State) -> ContactSnapshot {
    let phases = scene.phases().to_vec();
    let mut outlines = Vec::new();
    for ((g, s), phase) in spec.gears.iter().zip(scene.gears()).zip(&phases) {
        let displacement = s.model.hub_state(s.at(state.at())).displacement;
        let (turn, shift, points) = match &g.body {
            Body::Gear(gear) => (phase + displacement, 0.0, gear.outline(24)),
            Body::Rack(rack) => {
                // Outline: teeth towards -x, travel along +y.
                (
                    g.facing + std::f64::consts::PI,
                    phase + displacement,
                    rack.outline(24),
                )
            }
        };
        let (sin, cos) = turn.sin_cos();
        let points = points
            .into_iter()
            .map(|[x, y]| {
                let y = y + shift;
                [
                    g.position[0] + cos * x - sin * y,
                    g.position[1] + sin * x + cos * y,
                ]
            })
            .collect();
        outlines.push(Outline {
            gear: g.name.clone(),
            points,
        });
    }
    let forces = scene.contact_forces(state.at());
    let line = forces.first().and_then(|f| scene.line_of_action(f));
    let contacts = forces
        .iter()
        .map(|f| ContactPoint {
            point: [f.x.x, f.x.y],
            force: [f.force.x, f.force.y],
            pair: pair_name(spec, f),
        })
        .collect();
    ContactSnapshot {
        time_s: state.t,
        outlines,
        line_of_action: line,
        contacts,
    }
}

/// Teeth of a contact, counted from 1 within each gear.
fn pair_name(spec: &SceneSpec, f: &gearbench_models::scene::ContactForce) -> String {
    let gears = spec.meshes[f.mesh].gears;
    let name = |k: usize| {
        let teeth = match &spec.gears[gears[k]].body {
            Body::Gear(g) => i64::from(g.teeth()),
            Body::Rack(r) => i64::from(r.teeth()),
        };
        f.teeth[k].index.rem_euclid(teeth) + 1
    };
    format!("{}-{}", name(0), name(1))
}
