//! Frequency responses of models of a scene.

use super::plan::{FrequencyGrid, Plan};
use crate::experiment::error::StudyError;
use crate::experiment::key::Key;
use crate::experiment::linear_models::mesh_modes;
use crate::experiment::run::RunError;
use crate::experiment::runner::Runner;
use crate::small_signals::cycle::{MeshPhase, running};
use crate::small_signals::grounds::grounds;
use crate::small_signals::response::{GroupVibration, Response, spectrum};
use crate::small_signals::{LoadedStateError, MOST, Patience, has_loads, settled};
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_models::error::{BuildError, Fault};
use gearbench_models::gear::table::Model;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reference::statics::StaticsError;
use gearbench_reports::record::{Part, Results};
use gearbench_reports::response::{
    GroupResponse, MeshLimit, MeshPoint, ModelResponse, MountPoint, ResponsePoint, ResponseRecord,
};

/// Largest number of harmonics in the record.
const HARMONICS: usize = 24;
/// Default range of mesh frequencies over that of the resonance, lowest and highest [-].
const RANGE: [f64; 2] = [0.05, 1.6];

fn mean(x: impl Iterator<Item = f64>, n: usize) -> f64 {
    x.sum::<f64>() / n as f64
}

fn rms(x: &[f64]) -> f64 {
    let m = mean(x.iter().copied(), x.len());
    mean(x.iter().map(|x| (x - m).powi(2)), x.len()).sqrt()
}

fn ends(x: &[f64]) -> [f64; 2] {
    let ends = [f64::INFINITY, f64::NEG_INFINITY];
    (x.iter()).fold(ends, |[a, b], x| [a.min(*x), b.max(*x)])
}

fn harmonics(x: &[f64]) -> Vec<f64> {
    let kept = HARMONICS.min((x.len() - 1) / 2);
    spectrum(x, kept).iter().map(|c| c.norm()).collect()
}

/// Cosine of the base helix angle of a mesh: an approach along the normal of its flanks over that in the transverse plane.
fn normal_over_transverse(spec: &SceneSpec, mesh: usize) -> f64 {
    let [first, _] = spec.meshes[mesh].gears;
    spec.gears[first].body.base_helix_angle().cos()
}

/// A mesh that runs slowly.
fn limit(scene: &Scene, spec: &SceneSpec, mesh: usize, phases: &[MeshPhase]) -> MeshLimit {
    let [a, b] = scene.meshes()[mesh]
        .gears
        .map(|i| scene.gears()[i].name.as_str());
    let cos = normal_over_transverse(spec, mesh);
    let error: Vec<f64> = phases.iter().map(|p| p.closing / cos).collect();
    let stiffness: Vec<f64> = phases.iter().map(|p| cos * cos / p.compliance).collect();
    let [low, high] = ends(&error);
    MeshLimit {
        name: format!("{a} - {b}"),
        force_n: mean(phases.iter().map(|p| p.force), phases.len()),
        stiffness_n_per_m: mean(stiffness.iter().copied(), phases.len()),
        stiffness_range_n_per_m: ends(&stiffness),
        error_rms_m: rms(&error),
        error_peak_to_peak_m: high - low,
        error_harmonics_m: harmonics(&error),
    }
}

fn point(answer: &GroupVibration, spec: &SceneSpec) -> ResponsePoint {
    let meshes = answer.meshes.iter().map(|m| {
        let cos = normal_over_transverse(spec, m.mesh);
        let error: Vec<f64> = m.error.iter().map(|e| e / cos).collect();
        let ([low, high], [least, greatest]) = (ends(&error), ends(&m.force));
        MeshPoint {
            error_rms_m: rms(&error),
            error_peak_to_peak_m: high - low,
            error_harmonics_m: harmonics(&error),
            force_rms_n: rms(&m.force),
            force_least_n: least,
            force_greatest_n: greatest,
        }
    });
    let mounts = answer.grounds.iter().map(|[x, y]| {
        let both = harmonics(x).into_iter().zip(harmonics(y));
        MountPoint {
            rms_n: rms(x).hypot(rms(y)),
            harmonics_n: both.map(|(x, y)| x.hypot(y)).collect(),
        }
    });
    ResponsePoint {
        mesh_frequency_hz: answer.frequency,
        meshes: meshes.collect(),
        mounts: mounts.collect(),
    }
}

fn solve(
    scene: &mut Scene,
    spec: &SceneSpec,
    wanted: &FrequencyGrid,
    report: &dyn Fn(&str) -> bool,
) -> Result<Vec<GroupResponse>, LoadedStateError> {
    if !has_loads(spec, 0.0) {
        return Err(LoadedStateError::Matrices(
            "it has no loads, and nothing presses its flanks together",
        ));
    }
    let running = running(scene, spec, wanted.phases, &Patience::ENDLESS)?;
    let grounds = grounds(scene, &running);
    let mut groups = Vec::new();
    // Meshes of other frequencies turn along.
    let first = running.cycles.first().map_or(1.0, |c| c.frequency);
    let mut range = wanted.range;
    for cycle in &running.cycles {
        let resonance = cycle.resonance();
        let response = Response::new(scene, &running, cycle, &grounds)?;
        let usual =
            resonance.map(|r| RANGE.map(|part| part * r.frequency * first / cycle.frequency));
        let [from, to] = *range.get_or_insert(usual.unwrap_or([0.1 * first, 10.0 * first]));
        let ratio = cycle.frequency / first;
        let last = (wanted.points - 1) as f64;
        let mut points = Vec::new();
        for i in 0..wanted.points {
            if report("frequencies") {
                return Err(LoadedStateError::Interrupted);
            }
            let f = ratio * (from + (to - from) * i as f64 / last);
            let answer = response.at(f);
            let answer = answer.ok_or(LoadedStateError::Matrices(
                "its harmonic balance has no solution",
            ))?;
            points.push(point(&answer, spec));
        }
        let phases = cycle.meshes.iter().zip(&cycle.phases);
        groups.push(GroupResponse {
            own_frequency_hz: cycle.frequency,
            meshes: phases
                .map(|(m, phases)| limit(scene, spec, *m, phases))
                .collect(),
            mounts: grounds
                .iter()
                .map(|g| scene.gears()[g.gear].name.clone())
                .collect(),
            resonance_hz: resonance.map(|r| r.frequency),
            resonance_range_hz: resonance.map(|r| r.range),
            points,
        });
    }
    Ok(groups)
}

/// Computes the response of a model of a scene; if there is none the record has the reason.
///
/// # Errors
/// [`BuildError`] where the scene cannot be assembled.
pub fn response(
    label: &str,
    (spec, modelling): (&SceneSpec, &Modelling),
    models: &[Model],
    wanted: &FrequencyGrid,
    interrupted: &dyn Fn(&str) -> bool,
) -> Result<ModelResponse, BuildError> {
    let spec = settled(spec);
    let mut scene = Scene::build(&spec, modelling, models)?;
    let n = scene.layout().n;
    let found = match n {
        0 => Err(LoadedStateError::Matrices("nothing in it can move")),
        n if n > MOST => Err(LoadedStateError::TooLarge(n)),
        _ => solve(&mut scene, &spec, wanted, interrupted),
    };
    let (groups, message) = match found {
        Ok(groups) => (groups, String::new()),
        Err(why) => (Vec::new(), why.to_string()),
    };
    Ok(ModelResponse {
        label: label.to_owned(),
        message,
        coordinates: n,
        groups,
    })
}

/// Computes the frequency responses of all models.
///
/// # Errors
/// [`StudyError`]; models without a response are rows.
pub fn study(plan: &Plan, runner: &Runner<'_>) -> Result<Results, StudyError> {
    let mut responses: Vec<ModelResponse> = Vec::new();
    let mut wanted = plan.wanted;
    for (done, entry) in plan.entries.iter().enumerate() {
        runner.report_progress(done, plan.entries.len(), &entry.label);
        let scene = (&entry.scene, &entry.modelling);
        let label = entry.model_label();
        let key = (Key::new("response").and_scene(scene.0, scene.1)).and(&(&label, &wanted));
        let made = runner.piece(key, || {
            let found = response(
                &label,
                scene,
                &plan.conditions.context.models,
                &wanted,
                &|_| runner.is_interrupted(),
            );
            match runner.is_interrupted() {
                true => Err(RunError::Interrupted.into()),
                false => match found {
                    Err(e) if e.fault == Fault::Model => Ok(ModelResponse {
                        label: label.clone(),
                        message: e.to_string(),
                        ..ModelResponse::default()
                    }),
                    found => found.map_err(|e| {
                        StudyError::Statics(entry.label.clone(), StaticsError::Build(e))
                    }),
                },
            }
        });
        let found = match made {
            // After an interruption the finished part is reported.
            Err(_) if runner.is_interrupted() => break,
            made => made?,
        };
        // All models at the frequencies of the first.
        let points = found.groups.first().map(|g| &g.points);
        let ends = points.and_then(|p| Some([p.first()?, p.last()?]));
        wanted.range = (wanted.range).or(ends.map(|e| e.map(|p| p.mesh_frequency_hz)));
        responses.push(found);
    }
    runner.report_progress(plan.entries.len(), plan.entries.len(), "report");
    let part = ResponseRecord { responses };
    Ok(Results {
        mesh_modes: mesh_modes(&plan.entries, &plan.conditions.context.models, runner, true)?,
        ..plan.conditions.record(Part::Response(part))
    })
}
