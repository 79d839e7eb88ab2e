//! The key `contact` of a model: stiffness along the path, force law, damping, friction, slices.
//!
//! ```toml
//! contact = { stiffness = { kind = "constant", stiffness_n_per_m2 = 1.4e10 }, damping = { law = "flores", e = 0.9 } }
//! contact = { stiffness = "iso6336", exponent = 1.0, friction = { mu = 0.05, v_ref_m_s = 0.01 } }
//! contact = { penalty_pa_per_m = 1e15, points = { along = 8, across = 2 }, surface = "smooth" }
//! ```

use super::contact_points::{LawWord, LocalContact, PointsChoice, flanks, of_flanks};
use super::error::SceneError;
use super::reading::keys::keys;
use super::reading::values::{Count, ForceLawName, is_default};
use super::reading::{Place, suggest};
use super::stiffness::{StiffnessTable, stiffness};
use gearbench_models::error::Reason;
use gearbench_models::law::{Damping, Film, ForceLaw, Friction, FrictionForm, Law, LawError};
use gearbench_models::spec::{ContactSpec, FlankContact, Passes, SurfaceKind};
use gearbench_models::stiffness::{IsoVariation, PairStiffness};
use std::sync::Arc;

keys! {
    /// The contact of a mesh.
    #[derive(Default)]
    struct ContactTable {
        /// "iso6336", or { kind = "constant" | "parabola" | "iso6336" | "compliance" | "table", .. }
        stiffness: Option<StiffnessTable>,
        /// exponent of the penetration from 1 to 3, default 1
        exponent: Option<f64>,
        /// "none" (default), or { law = "kelvin-voigt" | "flores" | .., .. }
        #[serde(default, skip_serializing_if = "is_default")]
        damping: Damping,
        /// name of a contact law of one's own in Rust or Python, in place of exponent and damping
        normal_force: Option<ForceLawName>,
        /// { mu | film, v_ref_m_s | stick_m }; left out, none
        friction: Option<FrictionTable>,
        /// slices over the face width; left out, 1 for spur gears and 16 for helical or crowned ones
        slices: Option<Count<1, 1000>>,
        /// models with flank points: pressure over penetration, for steel for example 1e15
        penalty_pa_per_m: Option<f64>,
        /// in place of penalty_pa_per_m: force of a node over its penetration, with points = "nodes", for example
        /// 3.5e7
        penalty_n_per_m: Option<f64>,
        /// of flank points: "penalty" (default), or "hard": no penalty, for elastic gears with residual compliance
        law: Option<LawWord>,
        /// compliance next to the contact: "mesh" (default), the elements, with a penalty; or "half-space", Hertz's
        /// approach in their place, for elastic gears
        local: Option<LocalContact>,
        /// "quadrature" (default), "nodes", or { along, across }; with law = "hard" "mortar" (default) or "nodes"
        points: Option<PointsChoice>,
        /// between the nodes of a flank: "smooth" (default) or "faceted"
        surface: Option<SurfaceKind>,
        /// whose points touch the other's surface: "first", "second" or "both"; left out, those of the first gear with
        /// flanks
        passes: Option<Passes>,
        /// dashpot per area of flank in N s/m per m2, default 0
        damping_ns_per_m3: Option<f64>,
        /// gap of the undeformed flanks up to which they are looked at, default a fiftieth of the base pitch
        reach_m: Option<f64>,
    }

    /// Friction of a contact.
    #[derive(Default)]
    struct FrictionTable {
        /// coefficient of friction, zero or more
        mu: Option<f64>,
        /// in place of mu: { viscosity_pa_s, roughness_m, lubricant_factor }, the mean coefficient of a lubricated mesh
        film: Option<FilmTable>,
        /// sliding speed in m/s over which the force is smoothed, for example 0.01
        v_ref_m_s: Option<f64>,
        /// in place of v_ref_m_s: elastic displacement in m of sticking contacts, for example 1e-6
        stick_m: Option<f64>,
    }

    /// A lubricated contact.
    struct FilmTable {
        /// dynamic viscosity of the oil at its temperature, for example 0.04
        viscosity_pa_s: f64,
        /// arithmetic mean roughness of the flanks, for example 4e-7
        roughness_m: f64,
        /// X_L of ISO/TR 14179-2: 1 for mineral oil (default), 0.8 for polyalphaolefins and esters
        #[serde(default = "mineral")]
        lubricant_factor: f64,
    }
}

impl From<&Friction> for FrictionTable {
    fn from(friction: &Friction) -> Self {
        let (v_ref_m_s, stick_m) = match friction.form() {
            FrictionForm::Regularised(v) => (Some(v), None),
            FrictionForm::StickSlip(l) => (None, Some(l)),
        };
        let film = friction.film().map(|film| FilmTable {
            viscosity_pa_s: film.viscosity,
            roughness_m: film.roughness,
            lubricant_factor: film.lubricant,
        });
        FrictionTable {
            mu: film.is_none().then(|| friction.mu()),
            film,
            v_ref_m_s,
            stick_m,
        }
    }
}

impl From<&ContactSpec> for ContactTable {
    fn from(spec: &ContactSpec) -> Self {
        ContactTable {
            stiffness: Some(StiffnessTable::from(&spec.stiffness)),
            exponent: Some(spec.exponent).filter(|x| *x != 1.0),
            damping: spec.damping,
            normal_force: (spec.normal_force.as_ref()).map(|law| law.name().into()),
            friction: spec.friction.as_ref().map(FrictionTable::from),
            slices: spec.slices.map(Count),
            ..of_flanks(&spec.flanks)
        }
    }
}

/// Checks a contact. The stiffness may be missing if a calibration supplies it.
pub(super) fn contact(
    keys: &ContactTable,
    calibrated: bool,
    laws: &[Arc<dyn ForceLaw>],
    at: &Place<'_>,
) -> Result<ContactSpec, SceneError> {
    let flanks = flanks(keys, at)?;
    let stiffness = match &keys.stiffness {
        Some(keys) => stiffness(keys, &at.key("stiffness"))?,
        // Flank points bring their own; meshes without flanks beside them take the norm's.
        None if calibrated || flanks != FlankContact::Toothing => PairStiffness::Iso6336 {
            variation: IsoVariation::default(),
        },
        None => return Err(at.missing("stiffness", &ContactTable::TABLE)),
    };
    let exponent = keys.exponent.unwrap_or(1.0);
    let damping = keys.damping;
    check_law(exponent, damping, at)?;
    let normal_force = (keys.normal_force.as_ref())
        .map(|name| normal_force(&name.0, laws, &at.key("normal_force")))
        .transpose()?;
    let friction = keys.friction.as_ref().map(|keys| friction(keys, at));
    Ok(ContactSpec {
        stiffness,
        exponent,
        damping,
        normal_force,
        friction: friction.transpose()?,
        slices: keys.slices.map(|n| n.0),
        flanks,
    })
}

/// Finds a law of the program by its name.
fn normal_force(
    name: &str,
    laws: &[Arc<dyn ForceLaw>],
    at: &Place<'_>,
) -> Result<Arc<dyn ForceLaw>, SceneError> {
    if let Some(law) = laws.iter().find(|law| law.name() == name) {
        return Ok(law.clone());
    }
    let names: Vec<&str> = laws.iter().map(|law| law.name()).collect();
    let help = match names.is_empty() {
        true => "a law of one's own is a function of a program: `Context::with_law` in Rust, `gb.Contact(normal_force=...)` in Python; a scene file alone has `exponent` and `damping`".into(),
        false => suggest::there_are(name, &names),
    };
    at.refuse(
        format!("this program has no contact law `{name}`"),
        "unknown name",
        help,
    )
}

fn mineral() -> f64 {
    1.0
}

/// Reads friction; one key selects the coefficient and one the form of the law.
fn friction(keys: &FrictionTable, at: &Place<'_>) -> Result<Friction, SceneError> {
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
