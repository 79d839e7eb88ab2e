//! Fit of a model to its data.

use super::estimate::{Estimate, Problem, estimate};
use super::explanation::undetermined;
use super::fit_parameters::{Clock, FitParameters};
use super::parameters::choose;
use super::plan::{
    Data, DataSet, FitPlan, Identification, IdentifyError, StaticTarget, apply, default_method,
    scene_with, size,
};
use crate::experiment::conditions::Conditions;
use crate::experiment::decimation::decimate;
use crate::experiment::key::Key;
use crate::experiment::reference_series::channel_of;
use crate::experiment::run::{Job, RunError, history_on_grid, run};
use crate::experiment::runner::Runner;
use crate::scene_file::calibration::Constants;
use crate::scene_file::changes::KeyPath;
use crate::scene_file::{ModelChoice, SceneFile};
use crate::small_signals::{Patience, assemble};
use gearbench_reference::data::Quantity;
use gearbench_reports::identify::{
    ConstantSet, DataKind, DataRecord, FitHistory, FitRecord, Outcome, ParameterRecord,
    ProfileRecord,
};

/// Steps after which a trial is given up: parameters that need more are far from any tooth.
const MAX_STEPS: u64 = 50_000;
/// Sums of squares this close are one minimum.
const SAME: f64 = 1e-3;

/// Computes the values of a model with given constants at the sample points of the data.
///
/// # Errors
/// [`IdentifyError`] where it cannot be built, or does not reach the end.
pub fn modelled(
    plan: &FitPlan,
    set: &DataSet,
    constants: &Constants,
    clock: Clock,
) -> Result<Vec<f64>, IdentifyError> {
    let (mut spec, mut modelling) = (set.spec.clone(), plan.modelling.clone());
    apply(constants, plan.model(), &mut spec, &mut modelling)?;
    if constants.gap.is_some() {
        (spec.meshes.iter_mut()).for_each(|m| m.start.gap += set.further_gap);
    }
    match &set.data {
        Data::History { quantity, time, .. } => {
            let shifted: Vec<f64> = time.iter().map(|t| clock.scene_time(*t)).collect();
            // Before its start a scene is at rest there, without force.
            let before = shifted.partition_point(|t| *t < 0.0);
            let context = &plan.scene.context;
            let patience = Patience::until(&context.interruption);
            let mut scene = assemble(&spec, &modelling, &context.models, &patience)?;
            let grid = &shifted[before..];
            let no_channel = || IdentifyError::NoForce(set.name.clone());
            let channel = channel_of(*quantity).ok_or_else(no_channel)?;
            let found = history_on_grid(
                &plan.scene.context,
                &mut scene,
                &plan.method,
                MAX_STEPS,
                (grid, channel),
            )?;
            let first = match quantity {
                Quantity::Force(_) => 0.0,
                _ => found.first().copied().unwrap_or(0.0),
            };
            match found.len() == grid.len() {
                true => Ok([vec![first; before], found].concat()),
                false => Err(IdentifyError::Short(set.name.clone())),
            }
        }
        Data::Statics(wanted) => {
            let count = wanted.compliance.len();
            let own = StaticTarget::of(
                (&spec, &modelling),
                &plan.scene.context.models,
                wanted.force,
                count,
            );
            Ok(own?.compliance)
        }
    }
}

/// Fits a model to data. Every trial is a piece of the runner's, so that an interrupted fit goes on.
///
/// # Errors
/// [`IdentifyError`].
pub fn identify(
    plan: &FitPlan,
    runner: &Runner<'_>,
    mut progress: impl FnMut(u32, f64),
) -> Result<Identification, IdentifyError> {
    for set in plan.data.iter().chain(&plan.held_out) {
        let size = set.size();
        if !(size > 0.0 && size.is_finite()) {
            return Err(IdentifyError::NoForce(set.name.clone()));
        }
    }
    let Some(first) = plan.data.first() else {
        return Err(IdentifyError::Failed("there are no data".into()));
    };
    let scene = (&first.spec, &plan.modelling, &*plan.scene.context.models);
    let chosen = choose(scene, plan)?;
    let factors: Vec<Vec<f64>> = plan.data.iter().map(DataSet::factors).collect();
    let mut count = 0;
    let mut why = String::new();
    let mut residuals = |z: &[f64]| -> Option<Vec<f64>> {
        let values = super::estimate::coordinates::values(&chosen.coordinates, z);
        let (constants, keys) = (chosen.constants(&values), chosen.keys(&values));
        let mut all = Vec::new();
        for (i, set) in plan.data.iter().enumerate() {
            let clock = chosen.clock(&values, i);
            let found = trial(plan, set, (&constants, &keys), clock, runner);
            match found {
                Ok(found) => {
                    let pairs = found.iter().zip(set.values()).zip(&factors[i]);
                    all.extend(pairs.map(|((a, b), over)| over * (a - b)));
                }
                Err(e) => {
                    why = e.to_string();
                    return None;
                }
            }
        }
        count += 1;
        progress(count, size(&all));
        Some(all)
    };
    let problem = Problem {
        coordinates: chosen.coordinates.clone(),
        free: chosen.free.clone(),
        blocks: plan.data.iter().map(|d| d.values().len()).collect(),
        starts: chosen.starts.clone(),
        courses: chosen.courses(),
        profiles: plan.wishes.profiles,
    };
    let Some(found) = estimate(&problem, &mut residuals) else {
        return Err(IdentifyError::Failed(why));
    };
    let values: Vec<f64> = (found.values.iter().zip(&chosen.held))
        .map(|(value, held)| held.unwrap_or(value.0))
        .collect();
    let (all, keys) = (chosen.constants(&values), chosen.keys(&values));
    let mut data = Vec::new();
    let clock = |i: usize| chosen.clock(&values, i);
    for (i, set) in plan.data.iter().enumerate() {
        let model = trial(plan, set, (&all, &keys), clock(i), runner)?;
        let noise = found.known.noise.get(i).and_then(|n| n.as_ref());
        data.push(DataRecord {
            correlation_lag1: noise.map(|n| n.correlation(1)),
            noise_order: noise.map(|n| n.a.len()),
            ..against(set, model, false)
        });
    }
    for set in &plan.held_out {
        let model = trial(plan, set, (&all, &keys), Clock::default(), runner)?;
        data.push(against(set, model, true));
    }
    let record = record(plan, &chosen, &found, data);
    let known = |key: &KeyPath| {
        let key = key.to_string();
        (record.parameters.iter()).any(|p| p.key == key && p.value.is_some())
    };
    Ok(Identification {
        keys: keys
            .into_iter()
            .map(|(key, x)| (key.clone(), x, known(&key)))
            .collect(),
        record,
        all,
        chosen,
        data: (plan.data.iter())
            .map(|d| (d.name.clone(), d.key()))
            .collect(),
    })
}

/// A trial, made now unless it is finished.
fn trial(
    plan: &FitPlan,
    set: &DataSet,
    (constants, keys): (&Constants, &[(KeyPath, f64)]),
    clock: Clock,
    runner: &Runner<'_>,
) -> Result<Vec<f64>, IdentifyError> {
    let changed = match keys {
        [] => None,
        keys => Some(plan.changed(set, keys)?),
    };
    let (plan, set) = changed
        .as_ref()
        .map_or((plan, set), |(plan, set)| (plan, set));
    let (time, force, quantity) = match &set.data {
        Data::History { time, quantity, .. } => (time.as_slice(), 0.0, Some(*quantity)),
        Data::Statics(target) => (&[][..], target.force, None),
    };
    let key = Key::new("trial of a fit")
        .and_scene(&set.spec, &plan.modelling)
        .and(&(
            constants,
            (clock.offset, clock.scale),
            (time, force),
            set.values().len(),
            set.further_gap,
            quantity,
            plan.method,
        ));
    runner.piece(key, || modelled(plan, set, constants, clock))
}

/// Returns the kind of a quantity in records.
fn kind_of(quantity: Quantity) -> DataKind {
    match quantity {
        Quantity::Force(_) | Quantity::TransmissionError(_) => DataKind::Force,
        Quantity::Speed(_) => DataKind::Speed,
        Quantity::Angle(_) => DataKind::Angle,
        Quantity::Torque(_) | Quantity::MountTorque(_) | Quantity::ShaftTorque(_) => {
            DataKind::Torque
        }
    }
}

/// Compares the model with data: errors of the history, of its peak and its impulse.
fn against(set: &DataSet, model: Vec<f64>, validation: bool) -> DataRecord {
    let data = set.values();
    let off: Vec<f64> = model.iter().zip(data).map(|(a, b)| a - b).collect();
    let (kind, abscissa, of_force) = match &set.data {
        Data::History { time, quantity, .. } => {
            let kind = kind_of(*quantity);
            (kind, time.clone(), kind == DataKind::Force)
        }
        Data::Statics(_) => {
            let n = data.len().max(1) as f64;
            let places = (0..data.len()).map(|i| i as f64 / n).collect();
            (DataKind::Compliance, places, false)
        }
    };
    let peak = |y: &[f64]| y.iter().copied().fold(0.0, f64::max);
    let impulse = |y: &[f64]| {
        let steps = abscissa.windows(2).zip(y.windows(2));
        steps
            .map(|(t, y)| 0.5 * (t[1] - t[0]) * (y[0] + y[1]))
            .sum::<f64>()
    };
    let relative = |of: &dyn Fn(&[f64]) -> f64| {
        let (a, b) = (of(&model), of(data));
        (of_force && b != 0.0).then(|| a / b - 1.0)
    };
    DataRecord {
        name: set.name.clone(),
        validation,
        kind,
        weight: set.weight,
        l2: size(&off) / set.size(),
        peak_rel: relative(&peak),
        impulse_rel: relative(&impulse),
        correlation_lag1: None,
        noise_order: None,
        abscissa: abscissa.clone(),
        data: data.to_vec(),
        model,
    }
}

/// Runs the scene with a fitted model, once with the constants that the fit started from and once with those that it found;
/// measured curves are compared with both. A run that fails has the reason in place of a history.
///
/// # Errors
/// [`RunError`] when a model cannot be built with its constants.
pub fn histories(
    scene: &SceneFile,
    choice: &ModelChoice,
    found: &Identification,
    runner: &Runner<'_>,
) -> Result<Vec<Result<FitHistory, String>>, RunError> {
    let conditions = Conditions {
        measurable: true,
        repeats: 0,
        ..Conditions::of(scene)
    };
    let (method, grid) = (default_method(), conditions.grid());
    let sets = [
        (ConstantSet::Initial, found.chosen.initial()),
        (ConstantSet::Identified, Some(found.all.clone())),
    ];
    let mut all = Vec::new();
    for (set, constants) in sets {
        let Some(constants) = constants else { continue };
        // Keys of the scene have their own values at the start.
        let keys: Vec<_> = (found.keys.iter())
            .filter(|_| set == ConstantSet::Identified)
            .map(|(key, x, _)| (key.clone(), *x))
            .collect();
        let changed = match keys.is_empty() {
            true => Ok(None),
            false => scene_with(scene, &choice.label, &keys).map(Some),
        };
        let changed = match changed {
            Ok(changed) => changed,
            Err(why) => {
                all.push(Err(why));
                continue;
            }
        };
        let scene = changed.as_ref().unwrap_or(scene);
        let choice = scene.model(&choice.label).unwrap_or(choice);
        let (mut spec, mut modelling) = (scene.spec_for(choice), choice.modelling.clone());
        if let Err(why) = apply(&constants, &choice.model, &mut spec, &mut modelling) {
            all.push(Err(why.to_string()));
            continue;
        }
        let job = Job {
            max_steps: MAX_STEPS,
            ..conditions.job((&spec, &modelling), &method, &grid)
        };
        let row = runner.row(job.key(), &method, || run(&job))?;
        let series = row.series.as_ref().filter(|_| !row.status.is_failure());
        let history = series.map(|series| FitHistory {
            label: choice.label.clone(),
            constants: set,
            series: decimate(series, |_| false),
        });
        all.push(history.ok_or_else(|| {
            let why = row.message.clone();
            format!(
                "`{}` with {set} constants is not compared with measured curves: {}",
                choice.label,
                why.unwrap_or_else(|| row.status.to_string())
            )
        }));
    }
    Ok(all)
}

fn record(
    plan: &FitPlan,
    chosen: &FitParameters,
    found: &Estimate,
    data: Vec<DataRecord>,
) -> FitRecord {
    let parameters = (chosen.parameters.iter().enumerate()).map(|(j, p)| {
        let (value, [low, high]) = found.values[j];
        let value = chosen.held[j].unwrap_or(value);
        let outcome = if !chosen.free[j] {
            Outcome::Held
        } else if found.minimum.at_bound[j] {
            Outcome::AtBound
        } else if found.unknown[j] {
            Outcome::NotIdentifiable
        } else {
            Outcome::Identified
        };
        let identified = outcome == Outcome::Identified;
        let end = |x: f64| Some(x).filter(|x| identified && x.is_finite());
        ParameterRecord {
            key: p.key(&plan.data),
            name: p.name(&plan.data),
            unit: p.unit(),
            outcome,
            value: Some(value).filter(|_| outcome != Outcome::NotIdentifiable),
            low: end(low),
            high: end(high),
            freedom: end(found.known.freedom[j]),
            by_profile: identified && found.profiles[j].as_ref().is_some_and(|p| p.bent),
        }
    });
    let free: Vec<usize> = (0..chosen.free.len()).filter(|&j| chosen.free[j]).collect();
    let correlation = (free.iter())
        .map(|&i| {
            let of = |&j: &usize| if i == j { 1.0 } else { found.correlation(i, j) };
            free.iter().map(of).collect()
        })
        .collect();
    let profiles = (found.profiles.iter().enumerate()).filter_map(|(j, profile)| {
        let profile = profile.as_ref()?;
        let c = chosen.coordinates[j];
        Some(ProfileRecord {
            key: chosen.parameters[j].key(&plan.data),
            value: profile.z.iter().map(|&z| c.value(z)).collect(),
            deviation: profile.deviation.clone(),
            quantile: profile.quantile,
        })
    });
    // The deepest is gone down further than the others: what they reached is compared among them.
    let reached = || found.starts.iter().flatten();
    let least = reached().copied().fold(f64::INFINITY, f64::min);
    let agreed = reached().filter(|s| **s <= least * (1.0 + SAME) + f64::MIN_POSITIVE);
    FitRecord {
        label: plan.label.clone(),
        parameters: parameters.collect(),
        correlation,
        condition: Some(found.condition()).filter(|c| c.is_finite()),
        undetermined: undetermined(found, chosen, &plan.data),
        data,
        profiles: profiles.collect(),
        evaluations: found.evaluations,
        starts: found.starts.len(),
        starts_agreed: agreed.count(),
    }
}
