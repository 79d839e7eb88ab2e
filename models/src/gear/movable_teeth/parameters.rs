//! Parameters of the movable-teeth model, and the construction of a gear.

use super::springs::{RadiusStiffness, ToothSprings};
use super::teeth::{MovableTeeth, ToothSelection};
use crate::declare_parameters;
use crate::error::BuildError;
use crate::gear::hub_body::HubBody;
use crate::gear::model::GearModel;
use crate::gear::parameters::{ModelParameters, number};
use crate::gear::row::GearContext;
use crate::spec::Body;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// A number for all teeth, or one per tooth.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum PerTooth {
    /// One number for all teeth.
    All(f64),
    /// A number for each tooth.
    Each(Vec<f64>),
}

// Implemented by hand, because the error of an untagged enum does not describe the value that was found.
impl<'de> Deserialize<'de> for PerTooth {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct Numbers;
        impl<'de> Visitor<'de> for Numbers {
            type Value = PerTooth;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or a list with one per tooth")
            }

            fn visit_f64<E>(self, x: f64) -> Result<PerTooth, E> {
                Ok(PerTooth::All(x))
            }

            fn visit_u64<E>(self, x: u64) -> Result<PerTooth, E> {
                Ok(PerTooth::All(x as f64))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut all: A) -> Result<PerTooth, A::Error> {
                let mut each = Vec::new();
                while let Some(x) = all.next_element()? {
                    each.push(x);
                }
                Ok(PerTooth::Each(each))
            }
        }
        d.deserialize_any(Numbers)
    }
}

impl PerTooth {
    /// Returns the number of all teeth, or `None` if they differ.
    pub fn common(&self) -> Option<f64> {
        match self {
            PerTooth::All(x) => Some(*x),
            PerTooth::Each(_) => None,
        }
    }

    /// Returns the largest number of all teeth.
    pub fn greatest(&self) -> Option<f64> {
        self.reduced(f64::max)
    }

    /// Returns the smallest number of all teeth.
    pub fn least(&self) -> Option<f64> {
        self.reduced(f64::min)
    }

    fn reduced(&self, of: fn(f64, f64) -> f64) -> Option<f64> {
        match self {
            PerTooth::All(x) => Some(*x),
            PerTooth::Each(x) => x.iter().copied().reduce(of),
        }
    }
}

/// Selection of the teeth that are integrated individually.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Integrate {
    /// Teeth near a mesh are integrated.
    #[default]
    Active,
    /// All teeth are integrated.
    All,
}

declare_parameters! {
    /// Parameters of the model.
    pub struct MovableTeethParameters model "movable-teeth" {
        /// tangential spring k of a tooth on the radius r_d; a list gives one per tooth
        tooth_stiffness_n_per_m: PerTooth,
        /// mass m_t of a tooth; a list gives one per tooth
        tooth_mass_kg: PerTooth,
        /// damper c of a tooth on the radius r_d; a list gives one per tooth; default 0
        tooth_damping_ns_per_m: PerTooth,
        /// radius r_d of spring and damper; default the root (dedendum) radius
        #[serde(deserialize_with = "number")]
        spring_radius_m: f64,
        /// contact radii of a table k(r), ascending; with stiffness_at_radius_n_per_m
        stiffness_radius_m: Vec<f64>,
        /// values of the table k(r); out of contact a tooth keeps the first
        stiffness_at_radius_n_per_m: Vec<f64>,
        /// "active" or "all": teeth near a mesh one by one and the rest in closed form (default), or all one by one
        integrate: Integrate,
    }
    required(tooth_stiffness_n_per_m, tooth_mass_kg)
}

/// Identifier of the model.
const MODEL: &str = MovableTeethParameters::MODEL;

fn positive(key: &str, x: &[f64], zero_allowed: bool) -> Result<(), BuildError> {
    let bad = x
        .iter()
        .find(|x| !x.is_finite() || **x < 0.0 || (**x == 0.0 && !zero_allowed));
    match bad {
        Some(x) => Err(BuildError::parameter(
            MODEL,
            key,
            (
                format!(
                    "{x} is not {}",
                    if zero_allowed {
                        "zero or positive"
                    } else {
                        "positive"
                    }
                ),
                "give a value in SI units",
            ),
        )),
        None => Ok(()),
    }
}

/// Builds a gear with movable teeth.
pub fn build(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let teeth = match context.body {
        Body::Gear(g) => g.teeth() as usize,
        Body::Rack(r) => r.teeth() as usize,
    };
    let given = context.parameters::<MovableTeethParameters>()?.clone();
    let per_tooth = |key: &str, value: Option<PerTooth>| match value {
        None => Ok(None),
        Some(PerTooth::All(x)) => Ok(Some(vec![x])),
        Some(PerTooth::Each(x)) if x.len() == teeth => Ok(Some(x)),
        Some(PerTooth::Each(x)) => Err(BuildError::parameter(
            MODEL,
            key,
            (
                format!("{} values for {teeth} teeth", x.len()),
                "give one number or one per tooth",
            ),
        )),
    };

    let radius = match (given.stiffness_radius_m, given.stiffness_at_radius_n_per_m) {
        (None, None) => None,
        (Some(r), Some(k)) => {
            if r.len() != k.len()
                || r.len() < 2
                || r.windows(2)
                    .any(|w| w[1].partial_cmp(&w[0]) != Some(std::cmp::Ordering::Greater))
            {
                return Err(BuildError::parameter(
                    MODEL,
                    "stiffness_radius_m",
                    "needs at least two ascending radii and as many stiffnesses",
                ));
            }
            positive("stiffness_at_radius_n_per_m", &k, false)?;
            positive("stiffness_radius_m", &r, true)?;
            Some(RadiusStiffness::new(r, k))
        }
        _ => {
            return Err(BuildError::parameter(
                MODEL,
                "stiffness_radius_m",
                "a table k(r) needs both stiffness_radius_m and stiffness_at_radius_n_per_m",
            ));
        }
    };
    let stiffness = match (
        per_tooth("tooth_stiffness_n_per_m", given.tooth_stiffness_n_per_m)?,
        &radius,
    ) {
        (Some(k), _) => k,
        (None, Some(table)) => vec![table.rest()],
        (None, None) => {
            return Err(BuildError::missing(
                MODEL,
                "tooth_stiffness_n_per_m",
                "`gearbench identify` finds it against a reference, a tooth of steel has about 5e8 N/m per 10 mm of width",
            ));
        }
    };
    let mass = per_tooth("tooth_mass_kg", given.tooth_mass_kg)?.ok_or_else(|| {
        BuildError::missing(
            MODEL,
            "tooth_mass_kg",
            "`gearbench identify` finds it against a reference",
        )
    })?;
    let damping = per_tooth("tooth_damping_ns_per_m", given.tooth_damping_ns_per_m)?
        .unwrap_or_else(|| vec![0.0]);
    positive("tooth_stiffness_n_per_m", &stiffness, false)?;
    positive("tooth_mass_kg", &mass, false)?;
    positive("tooth_damping_ns_per_m", &damping, true)?;

    let r_d = match (given.spring_radius_m, context.body) {
        (Some(r), Body::Gear(_)) => r,
        (None, Body::Gear(g)) => g.r_root(),
        (_, Body::Rack(_)) => 1.0,
    };
    positive("spring_radius_m", &[r_d], false)?;

    let uniform = stiffness.len() == 1 && mass.len() == 1 && damping.len() == 1;
    let springs = if uniform {
        ToothSprings {
            uniform,
            stiffness,
            damping,
            mass,
            radius_squared: r_d * r_d,
            radius,
        }
    } else {
        let spread = |x: Vec<f64>| if x.len() == 1 { vec![x[0]; teeth] } else { x };
        ToothSprings {
            uniform,
            stiffness: spread(stiffness),
            damping: spread(damping),
            mass: spread(mass),
            radius_squared: r_d * r_d,
            radius,
        }
    };
    let taken: f64 = (0..teeth)
        .map(|i| springs.mass[if uniform { 0 } else { i }])
        .sum::<f64>()
        * r_d
        * r_d;
    let body = context.hub.inertia - taken;
    if body <= 0.0 && context.hub.is_free() {
        return Err(BuildError::parameter(
            MODEL,
            "tooth_mass_kg",
            (
                format!(
                    "{teeth} teeth have an inertia of {taken:.4e}, more than the {:.4e} of gear `{}`",
                    context.hub.inertia, context.name
                ),
                "use a smaller tooth mass",
            ),
        ));
    }
    let lightest = springs.mass.iter().copied().fold(f64::INFINITY, f64::min);
    let hub = HubBody {
        contact_mass: lightest * springs.radius_squared / context.effective_radius.powi(2),
        characteristic_time: springs.shortest_time(),
        ..HubBody::new(context.hub.clone(), context.effective_radius)
    };
    let mut gear = MovableTeeth {
        hub,
        teeth,
        body,
        springs,
        all_wanted: given.integrate == Some(Integrate::All),
        integrated: ToothSelection::All,
        views: context.meshes.to_vec(),
        slots: 0,
        constant: Vec::new(),
    };
    gear.lay_out();
    Ok(Box::new(gear))
}
