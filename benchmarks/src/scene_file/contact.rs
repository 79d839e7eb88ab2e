//! The key `contact` of a model: stiffness along the path, force law, damping, friction, slices.
//!
//! ```toml
//! contact = { stiffness = { kind = "constant", stiffness_n_per_m2 = 1.4e10 }, damping = { law = "flores", e = 0.9 } }
//! contact = { stiffness = "iso6336", exponent = 1.0, friction = { mu = 0.05, v_ref_m_s = 0.01 } }
//! contact = { penalty_pa_per_m = 1e15, points = { along = 8, across = 2 }, surface = "smooth" }
//! ```

use super::contact_points::{PointLaw, PointsChoice, points};
use super::error::SceneError;
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::Count;
use super::stiffness::{StiffnessKeys, stiffness};
use gearbench_models::error::Reason;
use gearbench_models::law::{Damping, Film, Friction, FrictionForm, Law, LawError};
use gearbench_models::spec::{ContactSpec, LocalContact, Passes, SurfaceKind};
use gearbench_models::stiffness::{IsoVariation, PairStiffness};
use serde::Deserialize;

keys! {
    pub(super) struct ContactKeys {
        /// "iso6336", or { kind = "constant" | "parabola" | "iso6336" | "compliance" | "table", .. }
        stiffness: Option<StiffnessKeys>,
        /// exponent of the penetration from 1 to 3, default 1
        exponent: Option<f64>,
        /// "none" (default), or { law = "kelvin-voigt" | "flores" | .., .. }
        #[serde(default)]
        damping: DampingKeys,
        /// { mu | film, v_ref_m_s | stick_m }; left out, none
        friction: Option<FrictionKeys>,
        /// slices over the face width; left out, 1 for spur gears and 16 for helical or crowned ones
        slices: Option<Count<1, 1000>>,
        /// models with flank points: pressure over penetration, for steel for example 1e15
        pub(super) penalty_pa_per_m: Option<f64>,
        /// in place of penalty_pa_per_m: force of a node over its penetration, with points = "nodes", for example
        /// 3.5e7
        pub(super) penalty_n_per_m: Option<f64>,
        /// of flank points: "penalty" (default), or "hard": no penalty, for elastic gears with residual compliance
        pub(super) law: Option<PointLaw>,
        /// compliance next to the contact: "mesh" (default), the elements, with a penalty; or "half-space", Hertz's
        /// approach in their place, for elastic gears
        pub(super) local: Option<LocalContact>,
        /// "quadrature" (default), "nodes", or { along, across }; with law = "hard" "mortar" (default) or "nodes"
        pub(super) points: Option<PointsChoice>,
        /// between the nodes of a flank: "smooth" (default) or "faceted"
        pub(super) surface: Option<SurfaceKind>,
        /// whose points touch the other's surface: "first", "second" or "both"; left out, those of the first gear with
        /// flanks
        pub(super) passes: Option<Passes>,
        /// dashpot per area of flank in N s/m per m2, default 0
        pub(super) damping_ns_per_m3: Option<f64>,
        /// gap of the undeformed flanks up to which they are looked at, default a fiftieth of the base pitch
        pub(super) reach_m: Option<f64>,
    }

    pub(super) struct DamperKeys {
        /// damper in N s/m, zero or more, for example { law = "kelvin-voigt", damping_ns_per_m = 500.0 }
        damping_ns_per_m: f64,
    }

    pub(super) struct RatioKeys {
        /// damping over critical damping, for example { law = "kelvin-voigt-ratio", ratio = 0.05 }
        ratio: f64,
    }

    pub(super) struct RestitutionKeys {
        /// coefficient of restitution, above 0 up to 1, for example { law = "flores", e = 0.9 }
        e: f64,
    }

    pub(super) struct FrictionKeys {
        /// coefficient of friction, zero or more
        mu: Option<f64>,
        /// in place of mu: { viscosity_pa_s, roughness_m, lubricant_factor }, the mean coefficient of a lubricated mesh
        film: Option<FilmKeys>,
        /// sliding speed in m/s over which the force is smoothed, for example 0.01
        v_ref_m_s: Option<f64>,
        /// in place of v_ref_m_s: elastic displacement in m of sticking contacts, for example 1e-6
        stick_m: Option<f64>,
    }

    pub(super) struct FilmKeys {
        /// dynamic viscosity of the oil at its temperature, for example 0.04
        viscosity_pa_s: f64,
        /// arithmetic mean roughness of the flanks, for example 4e-7
        roughness_m: f64,
        /// X_L of ISO/TR 14179-2: 1 for mineral oil (default), 0.8 for polyalphaolefins and esters
        #[serde(default = "mineral")]
        lubricant_factor: f64,
    }
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename = "<law>", rename_all = "kebab-case")]
enum DampingKeys {
    #[default]
    None,
    KelvinVoigt(DamperKeys),
    KelvinVoigtBounded(DamperKeys),
    KelvinVoigtRatio(RatioKeys),
    RatioAtLoad(RatioKeys),
    HuntCrossley(RestitutionKeys),
    LankaraniNikravesh(RestitutionKeys),
    Flores(RestitutionKeys),
    Gonthier(RestitutionKeys),
}

impl From<&DampingKeys> for Damping {
    fn from(keys: &DampingKeys) -> Self {
        match keys {
            DampingKeys::None => Damping::None,
            DampingKeys::KelvinVoigt(keys) => Damping::KelvinVoigt {
                c: keys.damping_ns_per_m,
            },
            DampingKeys::KelvinVoigtBounded(keys) => Damping::KelvinVoigtBounded {
                c: keys.damping_ns_per_m,
            },
            DampingKeys::KelvinVoigtRatio(keys) => Damping::KelvinVoigtRatio { ratio: keys.ratio },
            DampingKeys::RatioAtLoad(keys) => Damping::RatioAtLoad { ratio: keys.ratio },
            DampingKeys::HuntCrossley(keys) => Damping::HuntCrossley { e: keys.e },
            DampingKeys::LankaraniNikravesh(keys) => Damping::LankaraniNikravesh { e: keys.e },
            DampingKeys::Flores(keys) => Damping::Flores { e: keys.e },
            DampingKeys::Gonthier(keys) => Damping::Gonthier { e: keys.e },
        }
    }
}

/// Checks a contact. The stiffness may be missing if a calibration supplies it.
pub(super) fn contact(
    keys: &ContactKeys,
    calibrated: bool,
    at: &Place<'_>,
) -> Result<ContactSpec, SceneError> {
    let points = points(keys, at)?;
    let stiffness = match &keys.stiffness {
        Some(keys) => stiffness(keys, &at.key("stiffness"))?,
        // Flank points bring their own; meshes without flanks beside them take the norm's.
        None if calibrated || points.is_some() => PairStiffness::Iso6336 {
            variation: IsoVariation::default(),
        },
        None => return Err(at.missing("stiffness", &ContactKeys::TABLE)),
    };
    let exponent = keys.exponent.unwrap_or(1.0);
    let damping = Damping::from(&keys.damping);
    check_law(exponent, damping, at)?;
    let friction = keys.friction.as_ref().map(|keys| friction(keys, at));
    Ok(ContactSpec {
        stiffness,
        exponent,
        damping,
        friction: friction.transpose()?,
        slices: keys.slices.map(|n| n.0),
        points,
    })
}

fn mineral() -> f64 {
    1.0
}

/// Reads friction; one key selects the coefficient and one the form of the law.
fn friction(keys: &FrictionKeys, at: &Place<'_>) -> Result<Friction, SceneError> {
    let error =
        |cause: String, help: String| at.key("friction").error(cause, "this friction", help);
    let form = match (keys.v_ref_m_s, keys.stick_m) {
        (Some(v), None) => FrictionForm::Regularised(v),
        (None, Some(l)) => FrictionForm::StickSlip(l),
        (given, _) => {
            return Err(error(
                format!(
                    "friction has {} of `v_ref_m_s` and `stick_m`",
                    if given.is_some() { "both" } else { "none" }
                ),
                "give one: `v_ref_m_s = 0.01` smooths friction over a sliding velocity, `stick_m = 1e-6` permits sticking".into(),
            ));
        }
    };
    let friction = match (keys.mu, &keys.film) {
        (Some(mu), None) => Friction::of_form(mu, form),
        (None, Some(keys)) => {
            let film = Film {
                viscosity: keys.viscosity_pa_s,
                roughness: keys.roughness_m,
                lubricant: keys.lubricant_factor,
            };
            Friction::of_film(film, form)
        }
        (given, _) => {
            return Err(error(
                format!(
                    "friction has {} of `mu` and `film`",
                    if given.is_some() { "both" } else { "none" }
                ),
                "give one: `mu = 0.05`, or `film = { viscosity_pa_s = 0.04, roughness_m = 4e-7 }`"
                    .into(),
            ));
        }
    };
    friction.map_err(|e| {
        let Reason { cause, help } = e.reason();
        error(cause, help)
    })
}

/// Checks law and damping as the model will build them; for a damping ratio a placeholder coefficient is used, as the
/// true one is unknown yet.
fn check_law(exponent: f64, damping: Damping, at: &Place<'_>) -> Result<(), SceneError> {
    let result = damping
        .resolved(exponent, 1.0, 1.0)
        .and_then(|d| Law::new(exponent, d));
    result.map(|_| ()).map_err(|e| {
        let key = match &e {
            LawError::Exponent { .. } => "exponent",
            _ => "damping",
        };
        let Reason { cause, help } = e.reason();
        at.first(&[key]).error(cause, "this value", help)
    })
}
