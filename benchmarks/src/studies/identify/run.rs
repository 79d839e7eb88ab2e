//! The fit.

use super::levenberg_marquardt::{Fit, fit};
use super::plan::{Identification, Identified, IdentifyError, apply};
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

/// Fits a model (its id in all gears of `modelling`) to a force history.
pub fn identify(
    spec: &SceneSpec,
    modelling: &Modelling,
    models: &[Model],
    reference: (&[f64], &[f64]),
    runner: &Runner<'_>,
    mut progress: impl FnMut(u32, f64),
) -> Result<Identification, IdentifyError> {
    let (time, force) = reference;
    let size: f64 = force.iter().map(|f| f * f).sum::<f64>().sqrt();
    if size <= 0.0 || !size.is_finite() {
        return Err(IdentifyError::NoForce);
    }
    let model = modelling.gears.first().map_or("", |g| g.id.as_str());
    let fit_of = properties_of(models, model).fit.ok_or_else(|| {
        let known = models.iter().filter(|m| m.properties.fit.is_some());
        IdentifyError::Model(model.into(), known.map(|m| m.id).collect())
    })?;
    let keys: Vec<&'static str> = [&[STIFFNESS], fit_of.parameters, &[GAP]].concat();

    let mut count = 0;
    let mut why = String::new();
    let mut residuals = |x: &[f64]| -> Option<Vec<f64>> {
        let (mut spec, mut modelling) = (spec.clone(), modelling.clone());
        let values: Vec<(&str, f64)> = keys.iter().copied().zip(x.iter().copied()).collect();
        apply(&values, model, &mut spec, &mut modelling);
        let key = Key::new("trial of a fit")
            .and_scene(&spec, &modelling)
            .and(&time);
        let run = runner.piece(key, || {
            let mut scene = Scene::build(&spec, &modelling, models).map_err(|e| e.to_string())?;
            let mut dopri5 = DOPRI5.build();
            force_on_grid(
                &mut scene,
                dopri5.as_mut(),
                Resolution::Tolerance(RTOL),
                MAX_STEPS,
                time,
            )
            .map_err(|e| e.to_string())
        });
        match run {
            Ok(f) if f.len() == force.len() => {
                let r: Vec<f64> = f.iter().zip(force).map(|(a, b)| (a - b) / size).collect();
                count += 1;
                progress(count, r.iter().map(|r| r * r).sum::<f64>().sqrt());
                Some(r)
            }
            Ok(_) => None,
            Err(e) => {
                why = e;
                None
            }
        }
    };

    let mut best: Option<Fit> = None;
    for start in starts(spec, &fit_of) {
        if let Some(f) = fit(&mut residuals, &start)
            && best.as_ref().is_none_or(|b| f.sum < b.sum)
        {
            best = Some(f);
        }
    }
    let Some(best) = best else {
        return Err(IdentifyError::Failed(why));
    };
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
        force_l2: best.sum.sqrt(),
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
