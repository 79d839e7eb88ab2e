//! Comparison of the theoretical stability limit with the one found by stepping, for each model and method.

use super::LimitError;
use super::linear::Linear;
use super::linearised::Linearised;
use super::stepped_limit::step_limit;
use crate::experiment::configuration::Configuration;
use gearbench_integrators::MethodSpec;
use gearbench_models::gear::movable_teeth::{MovableTeethParameters, PerTooth};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::table::Model;
use gearbench_models::law::Damping;
use gearbench_models::spec::{ContactSpec, FlankContact, ModelSpec, Modelling, SceneSpec};
use gearbench_reference::reduction::ElasticParameters;

/// Damping ratio of the modes, contacts and teeth of a model that has no damping of its own.
pub const RATIO: f64 = 0.02;

/// The largest stable step of a method on a model.
#[derive(Clone, Debug, PartialEq)]
pub struct StepLimit {
    /// Label of the model in the scene.
    pub model: String,
    /// Integrator in the notation of a scene.
    pub integrator: String,
    /// Description of the damping of the model.
    pub damping: String,
    /// Largest stable step by linear theory [s].
    pub theory_s: f64,
    /// Largest stable step found by stepping the linear system [s].
    pub found_s: f64,
}

impl StepLimit {
    /// Returns the largest stable step found by stepping, over that of the theory [-].
    pub fn ratio(&self) -> f64 {
        self.found_s / self.theory_s
    }
}

/// Model of the table, with damping.
#[derive(Clone, Debug)]
pub struct Case {
    /// Label of the model in the scene.
    pub label: String,
    /// Description of the damping of the model.
    pub damping: String,
    /// Gears and meshes of the scene.
    pub scene: SceneSpec,
    /// Gear models and contacts, with damping.
    pub modelling: Modelling,
}

impl Case {
    /// Creates the case of a model with its own damping; one without any gets [`RATIO`] in its modes, teeth, or
    /// contacts.
    pub fn of(entry: &Configuration) -> Case {
        let mut modelling = entry.modelling.clone();
        let own = modelling.gears.iter().any(damps) || modelling.contacts.iter().any(dissipates);
        let mut given = Vec::new();
        if !own {
            for gear in &mut modelling.gears {
                given.extend(damp(gear));
            }
            if given.is_empty() {
                for contact in &mut modelling.contacts {
                    given.extend(damp_contact(contact));
                }
            }
            given.dedup();
        }
        Case {
            label: entry.label.clone(),
            damping: if own {
                "its own".into()
            } else {
                format!("{} % of critical in {}", 100.0 * RATIO, given.join(", "))
            },
            scene: entry.scene.clone(),
            modelling,
        }
    }
}

fn damps(gear: &ModelSpec) -> bool {
    let teeth = MovableTeethParameters::of(gear)
        .and_then(|p| p.tooth_damping_ns_per_m.as_ref()?.greatest());
    let modes = ElasticParameters::of(gear).map(|p| {
        let [alpha, beta] = p.rayleigh.unwrap_or_default();
        p.damping_ratio.unwrap_or(0.0).max(alpha).max(beta)
    });
    teeth.or(modes).is_some_and(|x| x > 0.0)
}

fn dissipates(contact: &ContactSpec) -> bool {
    let dashpot = contact.flanks.penalty().map_or(0.0, |[_, dashpot]| dashpot);
    let own = (contact.normal_force.as_ref()).is_some_and(|law| !law.is_elastic());
    dashpot > 0.0 || own || contact.damping != Damping::None
}

fn damp(gear: &mut ModelSpec) -> Option<&'static str> {
    if let Some(mut p) = ElasticParameters::of(gear).cloned() {
        p.damping_ratio = Some(RATIO);
        *gear = p.spec();
        return Some("its modes");
    }
    let mut p = MovableTeethParameters::of(gear)?.clone();
    let k = p.tooth_stiffness_n_per_m.as_ref()?.greatest()?;
    let m = p.tooth_mass_kg.as_ref()?.greatest()?;
    p.tooth_damping_ns_per_m = Some(PerTooth::All(2.0 * RATIO * (k * m).sqrt()));
    *gear = p.spec();
    Some("its teeth")
}

fn damp_contact(contact: &mut ContactSpec) -> Option<&'static str> {
    let power = contact.exponent == 1.0 && contact.normal_force.is_none();
    if contact.flanks != FlankContact::Toothing || !power {
        return None;
    }
    contact.damping = Damping::KelvinVoigtRatio { ratio: RATIO };
    Some("its contact")
}

/// Limits of methods on models, without dampers and with those of the case. Methods and models without a limit have no
/// row, nor have scenes too large to be stepped for it; the trigonometric method has rows without dampers only.
/// `progress` receives descriptions of the steps.
pub fn table(
    cases: &[Case],
    models: &[Model],
    methods: &[MethodSpec],
    mut progress: impl FnMut(&str),
) -> Result<Vec<StepLimit>, LimitError> {
    let mut rows = Vec::new();
    for case in cases {
        progress(&case.label);
        let mut linearised = Linearised::new(&case.scene, &case.modelling, models)?;
        for &method in methods {
            let stability = method.stability();
            let exact = method.info().linear_part;
            for damped in [false, true] {
                if damped && exact {
                    continue;
                }
                let theory = if exact {
                    linearised.largest_step(&stability)?
                } else {
                    match linearised.linear()? {
                        Linear::Dense(x) if !damped => {
                            Linear::Dense(x.undamped()).largest_step(&stability)?
                        }
                        other => other.largest_step(&stability)?,
                    }
                };
                let Some(theory_s) = theory else { continue };
                let Some(found_s) = step_limit(&mut linearised, method, damped)? else {
                    continue;
                };
                rows.push(StepLimit {
                    model: case.label.clone(),
                    integrator: method.to_string(),
                    damping: if damped {
                        case.damping.clone()
                    } else {
                        "none".into()
                    },
                    theory_s,
                    found_s,
                });
            }
        }
    }
    Ok(rows)
}
