//! Runs over the speed.

use super::plan::Plan;
use super::steady::{Histories, measure};
use crate::experiment::configuration::Configuration;
use crate::experiment::error::StudyError;
use crate::experiment::key::Key;
use crate::experiment::run::{Job, run};
use crate::experiment::runner::Runner;
use gearbench_integrators::Scheme;
use gearbench_models::gear::table::{Model, properties_of};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, Load, MeshLayout, Mount, Profile, SceneSpec, effective_radius, mesh_layout,
};
use gearbench_reference::statics::{Load as StaticLoad, LoadedPair, MeshCycle};
use gearbench_reports::Part;
use gearbench_reports::numbers::short;
use gearbench_reports::record::{self, Results, Run, StaticCycle, Status};
use gearbench_reports::series::TimeSeries;
use gearbench_reports::sweep::SweepRecord;
use std::f64::consts::TAU;

#[cfg(test)]
mod tests;

/// Samples of a mesh cycle in the histories.
const SAMPLES: f64 = 256.0;
/// Part of the settling time in which the loads rise.
const RISE: f64 = 1.0 / 3.0;
/// Mesh cycles of settling at least.
const LEAST_CYCLES: f64 = 4.0;
/// Imbalance of the loads' power, over the larger one, that keeps a speed.
const BALANCE: f64 = 1e-6;
/// What does not repeat, over what does, beyond which a run counts as unsettled.
const UNSETTLED: f64 = 0.2;

/// The mesh that is swept.
struct Pair {
    layout: MeshLayout,
    /// Effective base radii of both gears [m].
    effective_radii: [f64; 2],
    teeth: f64,
    /// Of the flank in contact, as the first gear turns.
    sign: f64,
    /// Path coordinate of the reference pair at zero displacement [m].
    start: f64,
    /// Force along the line of action [N].
    force: f64,
}

/// Constant torque on a hub [N m].
fn torque(loads: &[Load]) -> f64 {
    let of = |l: &Load| match l {
        Load::Applied(p) => p.value(f64::INFINITY),
        Load::Viscous(_) => 0.0,
    };
    loads.iter().map(of).sum()
}

impl Pair {
    fn of(spec: &SceneSpec) -> Result<Self, String> {
        let ([a, b], [mesh]) = (spec.gears.as_slice(), spec.meshes.as_slice()) else {
            return Err(format!(
                "a sweep is of one mesh of two gears, but the scene has {} gears and {} meshes",
                spec.gears.len(),
                spec.meshes.len()
            ));
        };
        let (Body::Gear(first), Body::Gear(_)) = (&a.body, &b.body) else {
            return Err("a sweep is of two gears; a rack comes to its end".into());
        };
        let layout = mesh_layout(a, b).map_err(|e| e.to_string())?;
        let sign = mesh.start.side.sign();
        let effective_radii = [effective_radius(&a.body), effective_radius(&b.body)];
        let loads = [torque(&a.loads), torque(&b.loads)];
        let driven = [a, b].map(|g| matches!(g.mount, Mount::Driven(_)));
        // Both torques press the flanks together along the line of action.
        let forces = [
            sign * loads[0] / effective_radii[0],
            sign * loads[1] / effective_radii[1],
        ];
        let force = match driven {
            [true, true] => return Err("both gears are driven: nothing can vibrate".into()),
            [true, false] => forces[1],
            [false, true] => forces[0],
            [false, false] => {
                let off = (forces[0] - forces[1]).abs();
                if off > BALANCE * forces[0].abs().max(forces[1].abs()) {
                    let brake = [a, b]
                        .iter()
                        .any(|g| g.loads.iter().any(|l| matches!(l, Load::Viscous(_))));
                    return Err(format!(
                        "the constant torques {} and {} N m do not balance, the speed would drift; {} N m on `{}` needs {} N m on `{}`{}",
                        short(loads[0], 5),
                        short(loads[1], 5),
                        short(loads[0], 5),
                        a.name,
                        short(loads[0] * effective_radii[1] / effective_radii[0], 8),
                        b.name,
                        if brake {
                            ". Viscous loads do not count: their torque changes with the speed that is swept"
                        } else {
                            ""
                        }
                    ));
                }
                forces[0]
            }
        };
        if force <= 0.0 {
            return Err(format!(
                "the loads press {force:.4} N on the flank of the mesh's start; a sweep needs constant torques that press it"
            ));
        }
        Ok(Pair {
            start: mesh.start.path_coordinate.unwrap_or(layout.pitch_point),
            layout,
            effective_radii,
            teeth: f64::from(first.teeth()),
            sign,
            force,
        })
    }

    /// That of a model, or why there is none.
    fn of_entry(plan: &Plan<'_>, entry: &Configuration) -> Result<Self, StudyError> {
        Pair::in_scene(&plan.conditions.name, &entry.scene)
    }

    fn in_scene(name: &str, spec: &SceneSpec) -> Result<Self, StudyError> {
        Pair::of(spec).map_err(|why| {
            let why = format!("the scene `{name}` cannot be swept: {why}");
            let help = "`gearbench init pair` writes a scene that can be swept, with comments";
            StudyError::Scene(why, help)
        })
    }

    /// Speeds of both gears at a mesh frequency [rad/s].
    fn speeds(&self, frequency: f64) -> [f64; 2] {
        let first = self.sign * TAU * frequency / self.teeth;
        [
            first,
            -first * self.effective_radii[0] / self.effective_radii[1],
        ]
    }

    /// The scene at a speed, its loads rising until `rise` [s], the teeth touching.
    fn scene(&self, spec: &SceneSpec, frequency: f64, rise: f64) -> SceneSpec {
        let mut spec = spec.clone();
        spec.meshes[0].start.gap = 0.0;
        for (g, speed) in spec.gears.iter_mut().zip(self.speeds(frequency)) {
            g.speed = speed;
            if matches!(g.mount, Mount::Driven(_)) {
                g.mount = Mount::Driven(Profile::Constant(speed));
            }
            let full = torque(&g.loads);
            g.loads.retain(|l| matches!(l, Load::Viscous(_)));
            if full != 0.0 {
                g.loads.push(Load::Applied(Profile::Ramp {
                    from: 0.0,
                    to: full,
                    start: 0.0,
                    end: rise,
                }));
            }
        }
        spec
    }

    /// What a run settled to.
    fn steady(
        &self,
        gears: [(&str, bool); 2],
        series: &TimeSeries,
        cycles: usize,
    ) -> Option<record::Steady> {
        let column = |name: String| {
            let found = series.columns.iter().find(|c| c.name == name);
            found.map(|c| c.values.as_slice())
        };
        let displacement = |k: usize| column(format!("hub_angle_{}_rad", gears[k].0));
        let (first, second) = (displacement(0)?, displacement(1)?);
        let [ra, rb] = self.effective_radii;
        let error: Vec<f64> = (first.iter().zip(second))
            .map(|(a, b)| self.sign * (ra * a + rb * b))
            .collect();
        let pitch = self.layout.base_pitch;
        let position: Vec<f64> = (second.iter())
            .map(|b| (self.start - self.sign * rb * b - self.layout.pitch_point) / pitch)
            .collect();
        let bearings = gears
            .iter()
            .filter_map(|(name, vibrates)| {
                let own = |d: &str| column(format!("bearing_{name}_{d}_n"));
                let (x, y, inertia) = match (own("x"), own("y")) {
                    (Some(x), Some(y)) => (x, y, *vibrates),
                    _ => (
                        column("force_x_n".into())?,
                        column("force_y_n".into())?,
                        false,
                    ),
                };
                Some(((*name).to_string(), inertia, x, y))
            })
            .collect();
        measure(
            &Histories {
                time: &series.time_s,
                position: &position,
                error: &error,
                force: &series.contact_force_n,
                speed: &series.omega1_rad_s,
                bearings,
            },
            cycles,
        )
    }
}

/// Frequency of two gears against each other on a stiffness along the line of action [Hz].
fn resonance(entry: &Configuration, models: &[Model], stiffness: f64) -> Option<f64> {
    let scene = Scene::build(&entry.scene, &entry.modelling, models).ok()?;
    // Whole gears: a model's contact mass may be that of a tooth.
    let compliance: f64 = (scene.gears().iter().zip(&entry.scene.gears))
        .map(|(g, spec)| {
            let hub = g.model.hub();
            hub.coordinates() as f64 * effective_radius(&spec.body).powi(2) / hub.inertia
        })
        .sum();
    (compliance > 0.0).then(|| (stiffness * compliance).sqrt() / TAU)
}

/// Equilibria over one base pitch under the force of the loads.
fn standing(plan: &Plan<'_>, entry: &Configuration) -> Result<StaticCycle, StudyError> {
    let fail = |e| StudyError::Statics(entry.label.clone(), e);
    let pair = Pair::of_entry(plan, entry)?;
    let mut loaded =
        LoadedPair::new(&entry.scene, &entry.modelling, plan.conditions.models).map_err(fail)?;
    let load = StaticLoad::Force(pair.force);
    let cycle = MeshCycle::solve(&mut loaded, load, plan.positions, |_| {}).map_err(fail)?;
    let tangent = cycle.mesh_tangent() * cycle.face_width;
    Ok(StaticCycle {
        label: entry.model_label(),
        force_n: pair.force,
        position: (cycle.positions.iter())
            .map(|p| (p.s - cycle.pitch_point) / cycle.base_pitch)
            .collect(),
        error_m: cycle.positions.iter().map(|p| p.approach).collect(),
        error_mean_m: cycle.mean_error(),
        error_peak_to_peak_m: cycle.peak_to_peak(),
        tangent_n_per_m: tangent,
        resonance_hz: resonance(entry, plan.conditions.models, tangent),
    })
}

/// Whether a scene can be swept at all, before any of its models is built.
///
/// # Errors
/// [`StudyError`] when it is no loaded pair.
pub fn check(name: &str, spec: &SceneSpec) -> Result<(), StudyError> {
    Pair::in_scene(name, spec).map(|_| ())
}

/// Mesh resonance of a model at the loads of its scene [Hz]: for the choice of speeds.
///
/// # Errors
/// [`StudyError`] when there is no static contact.
pub fn mesh_resonance(plan: &Plan<'_>, entry: &Configuration) -> Result<Option<f64>, StudyError> {
    Ok(standing(plan, entry)?.resonance_hz)
}

/// Runs the sweep.
///
/// # Errors
/// [`StudyError`] when the scene is no loaded pair, a model cannot be built, or the user interrupts. Runs that fail
/// are rows.
pub fn sweep(plan: &Plan<'_>, runner: &Runner<'_>) -> Result<Results, StudyError> {
    let mut statics = Vec::new();
    let total = plan.frequencies.len() * plan.entries.len();
    for entry in plan.entries.iter().chain(&plan.standing) {
        runner.tell(0, total, &format!("{}, at rest", entry.label));
        let key = Key::new("static cycle")
            .and_scene(&entry.scene, &entry.modelling)
            .and(&plan.positions);
        statics.push(runner.piece(key, || standing(plan, entry))?);
    }
    let mut runs = Vec::new();
    for entry in &plan.entries {
        let pair = Pair::of_entry(plan, entry)?;
        let method = (entry.methods.as_ref())
            .and_then(|m| m.first())
            .unwrap_or(&plan.method);
        for &frequency in &plan.frequencies {
            let what = format!("{}, mesh frequency {frequency:.0} Hz", entry.label);
            runner.tell(runs.len(), total, &what);
            runs.push(one(plan, runner, entry, &pair, method, frequency)?);
        }
    }
    runner.tell(runs.len(), total, "report");
    Ok(Results {
        runs,
        ..plan.conditions.record(Part::Sweep(SweepRecord { statics }))
    })
}

fn one(
    plan: &Plan<'_>,
    runner: &Runner<'_>,
    entry: &Configuration,
    pair: &Pair,
    method: &Scheme,
    frequency: f64,
) -> Result<Run, StudyError> {
    let period = frequency.recip();
    let settle = plan.settle.max(LEAST_CYCLES * period);
    // One cycle more: whole cycles begin where a pair's do.
    let t_end = settle + (plan.cycles as f64 + 1.2) * period;
    let scene = pair.scene(&entry.scene, frequency, RISE * settle);
    let count = (SAMPLES * (t_end - settle) / period).ceil();
    let grid: Vec<f64> = (0..=count as usize)
        .map(|i| settle + (t_end - settle) * i as f64 / count)
        .collect();
    let job = Job {
        t_end,
        also_steps: false,
        forces: true,
        ..plan
            .conditions
            .job((&scene, &entry.modelling), method, &grid)
    };
    let mut row = runner.row(job.key().and(&plan.cycles), method, || {
        let row = run(&job)?;
        Ok::<_, StudyError>(settled(plan, entry, pair, frequency, settle, row))
    })?;
    entry.sign(&mut row);
    Ok(row)
}

/// The row of a run with what it settled to in place of its histories.
fn settled(
    plan: &Plan<'_>,
    entry: &Configuration,
    pair: &Pair,
    frequency: f64,
    settle: f64,
    mut row: Run,
) -> Run {
    row.contacts = None;
    // Rigid gears hand the contact force on; others have inertia of their own vibration.
    let gears = [0, 1].map(|i| {
        let vibrates = !properties_of(plan.conditions.models, &entry.modelling.gears[i].id).rigid;
        (entry.scene.gears[i].name.as_str(), vibrates)
    });
    let series = row.series.take().unwrap_or_default();
    match pair.steady(gears, &series, plan.cycles) {
        Some(steady) if !row.status.is_failure() => {
            if steady.irregular > UNSETTLED {
                row.status = Status::Inaccurate;
                row.message = Some(format!(
                    "{:.0} % of the transmission error at a mesh frequency of {frequency:.0} Hz does not repeat from cycle to cycle: subharmonic, or not settled after {:.1} ms",
                    100.0 * steady.irregular,
                    1e3 * settle
                ));
            }
            row.steady = Some(steady);
        }
        // The place on the axis, for the failures.
        _ => {
            if !row.status.is_failure() {
                row.status = Status::Timeout;
                row.message = Some("too few whole mesh cycles to measure".into());
            }
            row.steady = Some(record::Steady {
                mesh_frequency_hz: frequency,
                ..record::Steady::default()
            });
        }
    }
    row
}
