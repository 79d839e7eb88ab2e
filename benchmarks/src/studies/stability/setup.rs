//! Effect of the parameters of a map on a scene, its models and its integrator, and the scene's own value of each.

use super::axis::Axis;
use gearbench_integrators::{METHODS, MethodSpec};
use gearbench_models::error::{BuildError, MeshPart};
use gearbench_models::gear::movable_teeth::{MovableTeethParameters, PerTooth};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::law::Damping;
use gearbench_models::spec::{
    ContactSpec, FlankContact, GearSpec, Modelling, Mount, SceneSpec, mesh_layout, stiffness_curve,
};
use gearbench_models::stiffness::{Ends, Interpolation, PairStiffness};
use gearbench_reference::full_order::FullOrderParameters;
use gearbench_reference::reduction::ElasticParameters;

/// Points at which a computed stiffness is sampled before it is scaled.
const SAMPLES: usize = 97;

/// Scene, models and integrator of one run.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Gears and meshes of the scene.
    pub scene: SceneSpec,
    /// Gear models and contacts.
    pub modelling: Modelling,
    /// Integrator, `id` or `id(name=value)`.
    pub method: MethodSpec,
}

/// Reason why a parameter cannot be varied for a model or a method.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AxisError {
    /// The model or the method has no such parameter.
    #[error("{0}")]
    Without(String),
    /// The stiffness to be scaled cannot be computed.
    #[error(transparent)]
    Build(#[from] BuildError),
}

fn without<T>(why: impl Into<String>) -> Result<T, AxisError> {
    Err(AxisError::Without(why.into()))
}

impl Axis {
    /// Returns the value of the parameter in a set-up.
    ///
    /// # Errors
    /// [`AxisError::Without`] with the reason why the set-up does not have the parameter.
    pub fn own(self, setup: &Setup) -> Result<f64, AxisError> {
        let gears = &setup.modelling.gears;
        let elastic = gears.iter().find_map(ElasticParameters::of);
        match self {
            Axis::Speed => {
                let moves = |g: &GearSpec| g.speed != 0.0 || matches!(g.mount, Mount::Driven(_));
                if setup.scene.gears.iter().any(moves) {
                    Ok(1.0)
                } else {
                    without("no gear of the scene has a speed")
                }
            }
            Axis::ContactStiffness => {
                let none =
                    |c: &ContactSpec| c.flanks == FlankContact::HalfSpace || c.flanks.is_hard();
                if setup.modelling.contacts.iter().any(none) {
                    return without("hard contact and half-spaces have no stiffness to choose");
                }
                Ok(1.0)
            }
            Axis::ToothStiffness => match gears.iter().find_map(MovableTeethParameters::of) {
                None => without("its teeth have no springs"),
                Some(p) => match p
                    .tooth_stiffness_n_per_m
                    .as_ref()
                    .and_then(PerTooth::common)
                {
                    Some(k) => Ok(k),
                    None => without("its teeth have stiffnesses of their own"),
                },
            },
            Axis::Damping if elastic.is_some() => match elastic {
                Some(p) if p.rayleigh.is_some() => {
                    without("its modes have Rayleigh damping instead of a damping ratio")
                }
                p => Ok(p.and_then(|p| p.damping_ratio).unwrap_or(0.0)),
            },
            Axis::Damping if gears.iter().any(|g| g.id() == FullOrderParameters::MODEL) => {
                without("full finite elements have no damping ratio")
            }
            Axis::Damping => {
                let mut ratios = setup.modelling.contacts.iter().map(|c| match c.damping {
                    _ if c.exponent != 1.0 || c.normal_force.is_some() => None,
                    Damping::None => Some(0.0),
                    Damping::KelvinVoigtRatio { ratio } | Damping::RatioAtLoad { ratio } => {
                        Some(ratio)
                    }
                    _ => None,
                });
                match ratios.next() {
                    Some(Some(ratio)) if ratios.all(|r| r == Some(ratio)) => Ok(ratio),
                    _ => without(
                        "the damping of its contact is not given as a ratio of critical damping",
                    ),
                }
            }
            Axis::Modes => match elastic {
                None => without("it has no modes"),
                Some(p) => match p.most_modes() {
                    Some(n) => Ok(n as f64),
                    None => without(
                        "its modes follow from `target_error` or `max_frequency_hz`, or its reduction cannot be read",
                    ),
                },
            },
            Axis::RhoInf => of_method(setup.method, "rho_inf"),
            Axis::HhtAlpha => of_method(setup.method, "alpha"),
        }
    }

    /// Sets the parameter of a set-up to a value; the set-up's own value leaves it unchanged, bit for bit.
    pub fn apply(self, value: f64, setup: &mut Setup) -> Result<(), AxisError> {
        if self.own(setup)? == value {
            return Ok(());
        }
        let Setup {
            scene,
            modelling,
            method,
        } = setup;
        let with_modes = (modelling.gears.iter()).any(|g| g.id() == ElasticParameters::MODEL);
        match self {
            Axis::ContactStiffness => return stiffen(value, scene, modelling),
            Axis::ToothStiffness => MovableTeethParameters::change(modelling, |p| {
                p.tooth_stiffness_n_per_m = Some(PerTooth::All(value));
            }),
            Axis::Modes => {
                ElasticParameters::change(modelling, |p| p.modes = Some(value as usize));
            }
            Axis::Damping if with_modes => {
                ElasticParameters::change(modelling, |p| p.damping_ratio = Some(value));
            }
            Axis::Damping => {
                for contact in &mut modelling.contacts {
                    contact.damping = match contact.damping {
                        _ if value == 0.0 => Damping::None,
                        Damping::RatioAtLoad { .. } => Damping::RatioAtLoad { ratio: value },
                        _ => Damping::KelvinVoigtRatio { ratio: value },
                    };
                }
            }
            Axis::Speed => {
                for gear in &mut scene.gears {
                    gear.speed *= value;
                    if let Mount::Driven(profile) = &mut gear.mount {
                        *profile = profile.scaled(value);
                    }
                }
            }
            Axis::RhoInf => *method = with_parameter(*method, "rho_inf", value)?,
            Axis::HhtAlpha => *method = with_parameter(*method, "alpha", value)?,
        }
        Ok(())
    }
}

/// Multiplies all contact stiffnesses and penalties.
fn stiffen(factor: f64, scene: &SceneSpec, modelling: &mut Modelling) -> Result<(), AxisError> {
    for (contact, mesh) in modelling.contacts.iter_mut().zip(&scene.meshes) {
        if let Some(stiffness) = contact.flanks.penalty_mut() {
            *stiffness *= factor;
        }
        match &mut contact.stiffness {
            PairStiffness::Constant { per_width, .. }
            | PairStiffness::Parabola { per_width, .. } => *per_width *= factor,
            PairStiffness::Table { k, .. } => k.iter_mut().for_each(|k| *k *= factor),
            // Flank points have a penalty; a stiffness of a norm does not apply to them.
            _ if contact.flanks != FlankContact::Toothing => {}
            _ => {
                let [a, b] = mesh.gears.map(|i| &scene.gears[i]);
                contact.stiffness = scaled_table(factor, a, b, contact)?;
            }
        }
    }
    Ok(())
}

/// A computed stiffness, sampled and scaled.
fn scaled_table(
    factor: f64,
    a: &GearSpec,
    b: &GearSpec,
    contact: &ContactSpec,
) -> Result<PairStiffness, BuildError> {
    let layout = mesh_layout(a, b)?;
    let curve = stiffness_curve(a, b, &layout, contact)
        .map_err(|e| BuildError::mesh([&a.name, &b.name], MeshPart::Stiffness, &e))?;
    let [start, end] = layout.path;
    let last = SAMPLES - 1;
    let s: Vec<f64> = (0..=last)
        .map(|i| start + (end - start) * i as f64 / last as f64)
        .collect();
    Ok(PairStiffness::Table {
        k: s.iter().map(|s| factor * curve.eval(*s).0).collect(),
        s,
        of: curve.of(),
        ends: Ends::Clamped,
        interpolation: Interpolation::Cubic,
    })
}

/// The value of a method's parameter, given or default.
fn of_method(method: MethodSpec, name: &str) -> Result<f64, AxisError> {
    method.parameter(name).map_or_else(
        || {
            let owners = METHODS.iter().map(|m| m.info);
            let owners = owners.filter(|m| m.parameters.iter().any(|p| p.name == name));
            let ids: Vec<&str> = owners.map(|m| m.id).collect();
            without(format!("{name} is a parameter of {}", ids.join(", ")))
        },
        Ok,
    )
}

/// The method with one parameter at another value.
fn with_parameter(method: MethodSpec, name: &str, value: f64) -> Result<MethodSpec, AxisError> {
    (method.with(name, value)).or_else(|e| without(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Context;
    use crate::experiment::conditions::logarithmic;
    use crate::scene_file::{Selection, load_for};
    use gearbench_integrators::table::NEWMARK;
    use gearbench_models::scene::Scene;

    fn setup(scene: &str, label: &str, method: &str) -> Setup {
        let file = load_for(&Context::default(), scene, Selection::Labels(Some(label))).unwrap();
        let choice = file.model(label).unwrap();
        Setup {
            scene: file.spec_for(choice),
            modelling: choice.modelling.clone(),
            method: method.parse().unwrap(),
        }
    }

    #[test]
    fn every_axis_reads_back_what_it_wrote() {
        let cases = [
            (
                "spur_rotation",
                "movable-teeth-3.6e9",
                Axis::ToothStiffness,
                3.6e9,
            ),
            ("spur_rotation", "movable-teeth-3.6e9", Axis::Damping, 0.02),
            ("hammer", "rigid", Axis::Damping, 0.05),
            ("hammer", "rigid", Axis::Speed, 1.0),
            ("spur_impact", "rigid", Axis::ContactStiffness, 1.0),
            ("spur_impact", "rigid", Axis::RhoInf, 0.8),
        ];
        for (scene, label, axis, own) in cases {
            let before = setup(scene, label, "generalised-alpha(rho_inf=0.8)");
            assert_eq!(axis.own(&before), Ok(own), "{scene} {label} {axis:?}");
            let text = format!("{before:?}");
            let mut after = before.clone();
            axis.apply(own, &mut after).unwrap();
            assert_eq!(format!("{after:?}"), text, "its own value changes nothing");
            axis.apply(0.3, &mut after).unwrap();
            assert_ne!(format!("{after:?}"), text);
            if !matches!(axis, Axis::ContactStiffness | Axis::Speed) {
                assert_eq!(axis.own(&after), Ok(0.3), "{axis:?}");
            }
        }
    }

    /// A factor on the stiffness of a norm is the factor on the force at a small penetration.
    #[test]
    fn a_computed_stiffness_is_scaled_point_by_point() {
        let before = setup("spur_rotation", "rigid", "rk4");
        let mut after = before.clone();
        Axis::ContactStiffness.apply(7.0, &mut after).unwrap();
        let curve = |s: &Setup| {
            let [a, b] = s.scene.meshes[0].gears.map(|i| &s.scene.gears[i]);
            let l = mesh_layout(a, b).unwrap();
            (
                l.path,
                stiffness_curve(a, b, &l, &s.modelling.contacts[0]).unwrap(),
            )
        };
        let ((path, soft), (_, stiff)) = (curve(&before), curve(&after));
        for i in 0..=50 {
            let s = path[0] + (path[1] - path[0]) * f64::from(i) / 50.0;
            let ratio = stiff.eval(s).0 / soft.eval(s).0;
            assert!((ratio - 7.0).abs() < 7e-4, "{ratio} at {i}");
        }
        Scene::build(&after.scene, &after.modelling, crate::models::models()).unwrap();
    }

    #[test]
    fn what_does_not_go_says_why() {
        let rigid = setup("spur_impact", "rigid", "rk4");
        for (axis, word) in [
            (Axis::ToothStiffness, "springs"),
            (Axis::Modes, "no modes"),
            (Axis::RhoInf, "generalised-alpha"),
            (Axis::HhtAlpha, "hht-alpha"),
        ] {
            let e = axis.own(&rigid).unwrap_err().to_string();
            assert!(e.contains(word), "{axis:?}: {e}");
        }
    }

    #[test]
    fn parameters_of_methods() {
        let newmark = with_parameter(NEWMARK, "beta", 0.3).unwrap();
        assert_eq!(newmark.to_string(), "newmark(beta=0.3)");
        assert_eq!(
            of_method("hht-alpha(alpha=0.1)".parse().unwrap(), "alpha"),
            Ok(0.1)
        );
        for axis in Axis::ALL {
            let [low, high] = axis.range();
            let values = axis.defaults();
            assert!(values.iter().all(|x| (low..=high).contains(x)), "{axis:?}");
            assert!(values.windows(2).all(|w| w[0] < w[1]), "{axis:?}");
        }
        let s = logarithmic(1e-8, 1e-5, 4);
        assert!((s[1] / 1e-7 - 1.0).abs() < 1e-12 && s[3] == 1e-5);
    }
}
