//! Error of modal reduction: elastic gears compared with full finite elements on the same mesh and contact, on random
//! scenes.
//!
//! Gears under load are run for one mesh cycle, with the shorter of a 500th of the cycle and a 100th of an impact as
//! step; an impact is run completely, with a 500th of its duration as step, and hammering gears up to the end of their
//! first impact.
//!
//! Full finite elements and elastic gears with 150 modes are run under HHT-alpha at the same step, so that their
//! difference is the error of the reduction; the elastic gears are also run under the trigonometric method, which is
//! their usual one. The integration error of the finite elements is estimated by a run at twice the step: the step
//! itself has a third of that error if it resolves the vibrations, and as much if teeth vibrate undamped and out of
//! phase.
//!
//! For a fair comparison three things are made equal:
//!
//! - Modes have no modal damping, as finite elements have none.
//! - Gears under load start at first contact of their flanks, and the load is ramped up within the mesh cycle. Where
//!   the exact flanks touch, the flanks through the nodes overlap by the error of their splines (0.2 um at 3 mm module
//!   with eight elements). Nodes without mass follow that at once, nodes of finite elements with their mass: the shock
//!   excites the frequency of a node on its penalty, which a step of a 500th of a mesh cycle does not resolve (error of
//!   the force under Newmark's method 20 % at 3 us, 15 % at 1 us, and 9 % under HHT-alpha; none of it from the
//!   reduction). If the whole load acts at once, without damping, the teeth separate and collide again, and the
//!   integration error grows from one impact to the next, in either model (3 % at 1 us, 2 % at 0.3 us).
//! - The method damps vibrations that the step does not resolve: truncated modes follow their loads quasi-statically,
//!   while those of finite elements vibrate for ever under an energy-conserving method.
//!
//! Undamped gears under load are compared below 30 kHz.
//!
//! With `--mesh-ratio` gears under load have damping proportional to their stiffness in both models instead, which is the
//! same for them ([`StatedDamping`]), and contact on half-spaces. Only scenes under load are then run, at a quarter of the step: finite elements at the step above change by 5 to 8 % when it is doubled. The elastic gears
//! under the method of the finite elements then have their spin terms, as these have: at 900 rad/s they stretch the teeth of
//! a gear of 72 mm, which is 2 % of the transmission error.
//!
//! The remaining error is not due to the modes alone. Elastic gears use displacements along the flank normals, which do
//! not distinguish points that leave over a tip from undeformed ones: static transmission errors agree with those of
//! finite elements within 1e-3 (22 and 33 teeth, 48 positions), except for an error of 1.6e-2 (0.8e-2 with 16 elements)
//! at the one position where a pair leaves contact. Undamped teeth vibrate from there on: at 0.25 us such a run has an
//! error of 1.4 % with 150 and with 1,200 modes, which agree within 0.4 %.

use crate::sampling::{Kind, Set, one_impact, sample};
use crate::validate::{ValidationError, grid, outcome};
use gearbench::experiment::runner::Runner;
use gearbench::small_signals::stated_damping::StatedDamping;
use gearbench::studies::choose::plan::{elastic, full};
use gearbench::studies::choose::problem::Problem;
use gearbench::studies::choose::trial::Outcome;
use gearbench_integrators::table::{HHT_ALPHA, TRIGONOMETRIC};
use gearbench_models::gear::elastic::SpinTerms;
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Body, FlankContact, Load, Profile, mesh_layout};
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reports::Metric;
use gearbench_reports::series::CONTACT_FORCE;
use std::f64::consts::{LN_2, TAU};
use std::fmt::Write as _;
use std::sync::Arc;

/// Number of modes of each elastic gear.
const MODES: usize = 150;
/// Parameter of the numerical damping of HHT-alpha.
const ALPHA: f64 = 0.05;
/// Number of steps of a mesh cycle, and of an impact.
const STEPS: f64 = 500.0;
/// Least number of steps of an impact within a mesh cycle; see [`STEPS`].
const RESOLVED: f64 = 100.0;
/// Division of the step for damped gears: their finite elements are a judge of 1 % only at a quarter of it.
const FINER: f64 = 4.0;
/// Gap at which the flanks of the gears do not overlap, relative to the module; bisection from there finds the gap of
/// first contact.
const APART: f64 = 5e-4;
/// Number of bisections of the gap; see [`APART`].
const HALVINGS: u32 = 10;
/// Largest allowed relative L2 error of the force history.
pub const LIMIT: f64 = 0.01;
/// Frequency below which the forces of undamped gears under load are compared [Hz]: their teeth vibrate at 50 kHz and
/// above for ever, with a phase that the step of the finite elements does not keep.
const CUT_OFF: f64 = 30e3;
/// Largest allowed relative L2 error of the transmission error of gears under load.
pub const LIMIT_OF_TRANSMISSION_ERROR: f64 = 0.02;

/// Errors of the elastic model in one scene against full finite elements.
#[derive(Clone, Debug)]
pub struct Row {
    pub scene: String,
    pub kind: String,
    /// Gears under load without damping.
    pub rings_on: bool,
    pub duration_s: f64,
    pub step_s: f64,
    /// Status of the runs of finite elements, of elastic gears, and of elastic gears under the trigonometric method.
    pub status: [String; 3],
    /// Relative L2 error of the force history, if all runs ended: under the same method, and under the trigonometric
    /// one.
    pub error: [Option<f64>; 2],
    /// Relative L2 error of the force history below [`CUT_OFF`] under the same method.
    pub low_passed: Option<f64>,
    /// Relative L2 error of the transmission error under the same method; `None` where it has none.
    pub transmission_error: Option<f64>,
    /// Change of the force history of the finite elements under twice the step, relative L2 norm.
    pub integration: Option<f64>,
    /// Unexplained energy of each run (negative if lost), relative to the largest vibration energy.
    pub residual: [Option<f64>; 3],
}

impl Row {
    /// True if all runs reached their end.
    pub fn ended(&self) -> bool {
        self.error.iter().all(Option::is_some)
    }

    /// True if the error of the reduction is within [`LIMIT`]; that of undamped gears under load below [`CUT_OFF`].
    pub fn is_within(&self) -> bool {
        let of_path = self.transmission_error.unwrap_or(0.0);
        let force = match self.rings_on {
            true => self.low_passed,
            false => self.error[0],
        };
        force.is_some_and(|e| e <= LIMIT) && of_path <= LIMIT_OF_TRANSMISSION_ERROR
    }
}

/// Runs a scene of a set with both models, with a damping ratio of their mesh mode or undamped; the runner stores every
/// finished run. `None` for a scene without loads, whose mesh mode is not defined.
///
/// # Errors
/// [`ValidationError`]: a sampling that fails, a run that cannot start.
pub fn compare(
    set: &Set,
    number: usize,
    mesh_ratio: Option<f64>,
    runner: &Arc<Runner<'static>>,
) -> Result<Option<Row>, ValidationError> {
    let sample = sample(set, number)?;
    let mut problem = Problem {
        runner: runner.clone(),
        ..Problem::of(&sample.scene)
    };
    for gear in &mut problem.flexible.gears {
        gear.damping_ratio = None;
    }
    let mut step = sample.contact_time / STEPS;
    if let Some(ratio) = mesh_ratio {
        if !matches!(sample.kind, Kind::Load) {
            return Ok(None);
        }
        give_damping(&mut problem, ratio)?;
    }
    match sample.kind {
        Kind::Impact => {}
        Kind::Hammer => {
            let (gap, duration) = one_impact(&sample)?;
            problem.scene.meshes[0].start.gap = gap;
            problem.duration = duration;
            problem.scene.duration = duration;
        }
        Kind::Load => {
            if let Some((cycle, module)) = mesh_cycle(&problem) {
                start_gently(&mut problem, cycle, module)?;
                problem.duration = problem.duration.min(cycle);
                step = (cycle / STEPS).min(sample.contact_time / RESOLVED);
                if mesh_ratio.is_some() {
                    step /= FINER;
                }
            }
        }
    }
    let times = grid(problem.duration, sample.contact_time);
    let method = HHT_ALPHA.with_value(ALPHA);
    let finite = full(&problem.flexible);
    let truth = outcome(&problem, &finite, &method.at_step(step), &times)?;
    let coarse = outcome(&problem, &finite, &method.at_step(2.0 * step), &times)?;
    // The implicit method takes modes of any frequency, the trigonometric one those that its step resolves.
    let mut alike = elastic(&problem.flexible, MODES, None);
    if mesh_ratio.is_some() {
        ElasticParameters::change(&mut alike, |p| p.spin_terms = Some(SpinTerms::Full));
    }
    let alike = outcome(&problem, &alike, &method.at_step(step), &times)?;
    let reduced = elastic(&problem.flexible, MODES, Some(step));
    let reduced = outcome(&problem, &reduced, &TRIGONOMETRIC.at_step(step), &times)?;
    let error = [&alike, &reduced, &coarse].map(|run| {
        (truth.usable() && run.usable())
            .then(|| run.error(Metric::ForceL2, &truth))
            .filter(|e| e.is_finite())
    });
    let low_passed = (truth.usable() && alike.usable())
        .then(|| low_passed(&alike).error(Metric::ForceL2, &low_passed(&truth)));
    let loaded = matches!(sample.kind, Kind::Load);
    let under_load = loaded && truth.usable() && alike.usable();
    let of_path = under_load.then(|| alike.error(Metric::TransmissionError, &truth));
    Ok(Some(Row {
        scene: sample.scene.name.clone(),
        kind: sample.kind.as_str().into(),
        rings_on: loaded && mesh_ratio.is_none(),
        duration_s: problem.duration,
        step_s: step,
        status: [&truth, &alike, &reduced].map(|o| o.row.status.to_string()),
        error: [error[0], error[1]],
        integration: error[2],
        low_passed: low_passed.filter(|e| e.is_finite()),
        residual: [&truth, &alike, &reduced]
            .map(|o| Some(o.ledger.residual_j? / o.ledger.vibrating_j?)),
        transmission_error: of_path.filter(|e| e.is_finite()),
    }))
}

/// Returns a run with the contact force below [`CUT_OFF`]: its samples are averaged with the weights of a normal
/// distribution in time, whose frequency response has fallen to half its power there.
fn low_passed(of: &Outcome) -> Outcome {
    let mut out = of.clone();
    // What has no samples at jumps is compared at those of the grid.
    out.series.forces.clear();
    let deviation = LN_2.sqrt() / (TAU * CUT_OFF);
    let times = &of.series.time_s;
    for column in &mut out.series.columns {
        if CONTACT_FORCE.subject(&column.name).is_none() {
            continue;
        }
        let averaged = times.iter().map(|t| {
            let weights = (times.iter()).map(|s| (-0.5 * ((s - t) / deviation).powi(2)).exp());
            let [mut sum, mut total] = [0.0; 2];
            for (weight, x) in weights.zip(&column.values) {
                sum += weight * x;
                total += weight;
            }
            sum / total
        });
        column.values = averaged.collect();
    }
    out
}

/// Gives both models contact on half-spaces, and the damping that is proportional to their stiffness, by the mesh mode of
/// the elastic gears in the equilibrium of the loads.
fn give_damping(problem: &mut Problem, ratio: f64) -> Result<(), ValidationError> {
    for contact in &mut problem.flexible.contacts {
        contact.damping = Damping::None;
        contact.flanks = FlankContact::HalfSpace;
    }
    let mut modelling = elastic(&problem.flexible, MODES, None);
    let models = &problem.context.models;
    StatedDamping::MeshRatio(ratio)
        .give(&problem.scene, &mut modelling, models)
        .map_err(gearbench::experiment::run::RunError::from)?;
    let damped = modelling.gears.iter().filter_map(ElasticParameters::of);
    for (gear, damped) in problem.flexible.gears.iter_mut().zip(damped) {
        gear.rayleigh = damped.rayleigh;
    }
    Ok(())
}

/// Ramps the loads up over one mesh cycle, and starts the gears at first contact.
fn start_gently(problem: &mut Problem, cycle: f64, module: f64) -> Result<(), ValidationError> {
    for gear in &mut problem.scene.gears {
        for load in &mut gear.loads {
            let to = match load {
                Load::Applied(profile) => profile.settled(),
                Load::Viscous(c) => -*c * gear.speed,
            };
            *load = Load::Applied(Profile::Ramp {
                from: 0.0,
                to,
                start: 0.0,
                end: cycle,
            });
        }
    }
    let modelling = elastic(&problem.flexible, MODES, None);
    let mut touches = |gap: f64| -> Result<bool, ValidationError> {
        problem.scene.meshes[0].start.gap = gap;
        let mut scene = Scene::build(&problem.scene, &modelling, &problem.context.models)
            .map_err(gearbench::experiment::run::RunError::from)?;
        let state = scene.initial();
        let forces = scene.contact_forces(state.at());
        Ok(forces.iter().any(|f| f.normal_force > 0.0))
    };
    let [mut low, mut high] = [0.0, APART * module];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if touches(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    problem.scene.meshes[0].start.gap = high;
    Ok(())
}

/// Period of the mesh cycle [s] and module [m] of a scene with running gears.
fn mesh_cycle(problem: &Problem) -> Option<(f64, f64)> {
    let spec = &problem.scene;
    let [a, b] = spec.meshes.first()?.gears.map(|i| &spec.gears[i]);
    let Body::Gear(gear) = &a.body else {
        return None;
    };
    let base_pitch = mesh_layout(a, b).ok()?.base_pitch;
    Some((
        base_pitch / (gear.r_base() * a.speed.abs()),
        gear.params().module,
    ))
}

/// All rows as CSV.
pub fn csv(rows: &[Row]) -> String {
    let mut out = String::from(
        "scene,kind,duration_s,step_s,fe,elastic,elastic_trigonometric,force_l2,force_l2_trigonometric,\
         fe_force_l2_of_twice_the_step,force_l2_below_30_khz,transmission_error_l2,fe_residual_rel,elastic_residual_rel,elastic_trigonometric_residual_rel\n",
    );
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.3e}"));
    for r in rows {
        let others = [&r.integration, &r.low_passed, &r.transmission_error];
        let numbers = (r.error.iter().chain(others).chain(&r.residual)).map(|x| number(*x));
        let numbers: Vec<String> = numbers.collect();
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{},{},{:.6e},{:.6e},{},{}",
            r.scene,
            r.kind,
            r.duration_s,
            r.step_s,
            r.status.join(","),
            numbers.join(",")
        );
    }
    out
}
