//! Identification: stiffness, tooth mass and touch time fitted to the force history of a reference impact.
//!
//! The residuals are the differences of the contact force on the reference's own time grid, so the fit
//! minimises the relative L2 error that reports show. The touch time is fitted as the initial gap: a
//! faceted finite-element flank touches later than the exact involute. What is fitted:
//!
//! | model | parameters |
//! |---|---|
//! | `rigid` | stiffness of a tooth pair per width, gap |
//! | `movable-teeth` | stiffness of a tooth pair per width, tooth stiffness, tooth mass, gap |

pub mod arguments;
pub mod command;
pub mod levenberg_marquardt;

use crate::experiment::run::force_on_grid;
use crate::scene_file::calibration::{Constants, GAP, STIFFNESS};
use gearbench_integrators::Resolution;
use gearbench_integrators::table::DOPRI5;
use gearbench_models::error::BuildError;
use gearbench_models::gear::properties;
use gearbench_models::gear::table::{Model, properties_of};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Modelling, SceneSpec};
use levenberg_marquardt::{Fit, fit};

/// Tolerance of the integration inside the fit: well below what the fit can tell apart.
const RTOL: f64 = 1e-6;
/// Stiffness of a tooth pair that fits start from [N/m per m].
const PAIR: f64 = 1.5e10;
/// Steps after which a trial is given up: parameters that need more are far from any tooth.
const MAX_STEPS: u64 = 20_000;

/// An identified parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Identified {
    /// Key as written in scenes.
    pub key: &'static str,
    /// Value in SI units.
    pub value: f64,
    /// Half width of the 95 % confidence interval, relative.
    pub relative_95: f64,
}

/// The result of an identification.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// Parameters.
    pub parameters: Vec<Identified>,
    /// Relative L2 error of the force history with them.
    pub force_l2: f64,
    /// Integrations done.
    pub evaluations: u32,
}

/// Why nothing could be identified.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// The scene cannot be assembled.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// There is no recipe for the model.
    #[error("there is nothing to identify for the model `{0}`; {known} have stiffness to fit", known = .1.join(" and "))]
    Model(String, Vec<&'static str>),
    /// The reference has no force.
    #[error("the reference has no contact force to fit to")]
    NoForce,
    /// No start led to a fit.
    #[error("the fit failed from every start: {0}")]
    Failed(String),
}

/// Puts identified values into a scene and its models, as a calibration with them would be.
pub fn apply(values: &[(&str, f64)], model: &str, spec: &mut SceneSpec, modelling: &mut Modelling) {
    let constants = Constants::of(values.iter().copied());
    constants.apply(model, modelling);
    if let Some(gap) = constants.gap {
        for m in &mut spec.meshes {
            m.start.gap = gap;
        }
    }
}

/// Fits a model (its id in all gears of `modelling`) to a force history.
pub fn identify(
    spec: &SceneSpec,
    modelling: &Modelling,
    models: &[Model],
    reference: (&[f64], &[f64]),
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
        let built = Scene::build(&spec, &modelling, models).map_err(|e| e.to_string());
        let run = built.and_then(|mut scene| {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene_file::{Selection, load_for};
    use gearbench_models::stiffness::{PairOrMesh, PairStiffness};

    /// What is fitted is what a calibration with the same constants is: one spring of the mesh stays one.
    #[test]
    fn constants_mean_the_same_in_a_fit_and_in_a_calibration() {
        let scene = load_for("spur_impact", Selection::None).unwrap();
        let mut modelling = scene.model("rigid").unwrap().modelling.clone();
        modelling.contacts[0].stiffness = PairStiffness::Constant {
            per_width: 1e10,
            of: PairOrMesh::Mesh,
        };
        let (mut fitted, mut spec) = (modelling.clone(), scene.spec.clone());
        let values = [(STIFFNESS, 2e10), (GAP, 3e-6)];
        apply(&values, "rigid", &mut spec, &mut fitted);
        Constants::of(values).apply("rigid", &mut modelling);
        let expected = PairStiffness::Constant {
            per_width: 2e10,
            of: PairOrMesh::Mesh,
        };
        assert_eq!(fitted.contacts[0].stiffness, expected);
        assert_eq!(modelling.contacts[0].stiffness, expected);
        assert_eq!(spec.meshes[0].start.gap, 3e-6);
    }
}
