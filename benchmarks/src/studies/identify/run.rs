//! The fit.

use super::levenberg_marquardt::{Fit, fit};
use super::plan::{Identification, Identified, IdentifyError, StaticTarget, Target, apply};
use crate::experiment::key::Key;
use crate::experiment::run::force_on_grid;
use crate::experiment::runner::Runner;
use crate::scene_file::calibration::{GAP, STIFFNESS};
use gearbench_integrators::Resolution;
use gearbench_integrators::table::DOPRI5;
use gearbench_models::gear::properties;
use gearbench_models::gear::table::{Model, properties_of};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Modelling, SceneSpec};

/// Tolerance of the integration inside the fit: well below what the fit can tell apart.
const RTOL: f64 = 1e-6;
/// Steps after which a trial is given up: parameters that need more are far from any tooth.
const MAX_STEPS: u64 = 20_000;
/// Stiffness of a tooth pair that fits start from [N/m per m].
const PAIR: f64 = 1.5e10;

/// Fits a model (its id in all gears of `modelling`) to a target.
///
/// Statics alone cannot tell springs in series apart, nor masses and gaps: then only the stiffness of a tooth pair is
/// fitted, and all other constants stay as they are.
pub fn identify(
    spec: &SceneSpec,
    modelling: &Modelling,
    models: &[Model],
    target: &Target<'_>,
    runner: &Runner<'_>,
    mut progress: impl FnMut(u32, f64),
) -> Result<Identification, IdentifyError> {
    let size = |y: &[f64]| y.iter().map(|y| y * y).sum::<f64>().sqrt();
    let (time, force) = target.history.unwrap_or_default();
    let force_size = size(force);
    if target.history.is_some() && !(force_size > 0.0 && force_size.is_finite()) {
        return Err(IdentifyError::NoForce);
    }
    let model = modelling.gears.first().map_or("", |g| g.id.as_str());
    let fit_of = properties_of(models, model).fit.ok_or_else(|| {
        let known = models.iter().filter(|m| m.properties.fit.is_some());
        IdentifyError::Model(model.into(), known.map(|m| m.id).collect())
    })?;
    let keys: Vec<&'static str> = match target.history {
        Some(_) => [&[STIFFNESS], fit_of.parameters, &[GAP]].concat(),
        None => vec![STIFFNESS],
    };

    let mut count = 0;
    let mut why = String::new();
    let mut residuals = |x: &[f64]| -> Option<Vec<f64>> {
        let (mut spec, mut modelling) = (spec.clone(), modelling.clone());
        let values: Vec<(&str, f64)> = keys.iter().copied().zip(x.iter().copied()).collect();
        apply(&values, model, &mut spec, &mut modelling);
        let key = Key::new("trial of a fit")
            .and_scene(&spec, &modelling)
            .and(&(time, &target.statics));
        let run = runner.piece(key, || -> Result<Vec<f64>, String> {
            let mut found = Vec::new();
            if target.history.is_some() {
                let mut scene =
                    Scene::build(&spec, &modelling, models).map_err(|e| e.to_string())?;
                let mut dopri5 = DOPRI5.build();
                let resolution = Resolution::Tolerance(RTOL);
                found = force_on_grid(&mut scene, dopri5.as_mut(), resolution, MAX_STEPS, time)
                    .map_err(|e| e.to_string())?;
                if found.len() != force.len() {
                    return Err("the run does not reach the end of the reference".into());
                }
            }
            if let Some(wanted) = &target.statics {
                let count = wanted.compliance.len();
                let own = StaticTarget::of((&spec, &modelling), models, wanted.force, count);
                found.extend(own.map_err(|e| e.to_string())?.compliance);
            }
            Ok(found)
        });
        match run {
            Ok(found) => {
                let (f, e) = found.split_at(force.len().min(found.len()));
                let mut r: Vec<f64> = (f.iter().zip(force))
                    .map(|(a, b)| (a - b) / force_size)
                    .collect();
                if let Some(wanted) = &target.statics {
                    let whole = size(&wanted.compliance);
                    r.extend(
                        e.iter()
                            .zip(&wanted.compliance)
                            .map(|(a, b)| (a - b) / whole),
                    );
                }
                count += 1;
                progress(count, size(&r));
                Some(r)
            }
            Err(e) => {
                why = e;
                None
            }
        }
    };

    let mut best: Option<Fit> = None;
    for mut start in starts(spec, &fit_of) {
        start.truncate(keys.len());
        if let Some(f) = fit(&mut residuals, &start)
            && best.as_ref().is_none_or(|b| f.sum < b.sum)
        {
            best = Some(f);
        }
    }
    let left = best.as_ref().and_then(|best| residuals(&best.x));
    let (Some(best), Some(left)) = (best, left) else {
        return Err(IdentifyError::Failed(why));
    };
    let (f, e) = left.split_at(force.len());
    let parameters = keys
        .iter()
        .zip(best.x.iter().zip(&best.relative_95))
        .map(|(&key, (&value, &relative_95))| Identified {
            key,
            value,
            relative_95,
        })
        .collect();
    Ok(Identification {
        parameters,
        force_l2: target.history.map(|_| size(f)),
        static_l2: target.statics.as_ref().map(|_| size(e)),
        evaluations: count,
    })
}

/// Starting points in the order of the keys: one pair of steel teeth has about 14 N/(um mm) whatever the module.
fn starts(spec: &SceneSpec, fit: &properties::Fit) -> Vec<Vec<f64>> {
    let gap = spec.meshes.first().map_or(1e-6, |m| m.start.gap.max(1e-7));
    let Some(gear) = spec.gears.first() else {
        return Vec::new();
    };
    (fit.starts)(PAIR, gear)
        .iter()
        .map(|s| [&[s.contact], &s.parameters[..], &[gap]].concat())
        .collect()
}
