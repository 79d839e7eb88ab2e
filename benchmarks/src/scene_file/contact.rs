//! `contact = { .. }` of a model: stiffness along the path, law, damping, friction, slices.
//!
//! ```toml
//! contact = { stiffness = { kind = "constant", stiffness_n_per_m2 = 1.4e10 }, damping = { law = "flores", e = 0.9 } }
//! contact = { stiffness = "iso6336", exponent = 1.0, friction = { mu = 0.05, v_ref_m_s = 0.01 } }
//! contact = { penalty_pa_per_m = 1e15, points = { along = 8, across = 2 }, surface = "smooth" }
//! ```

use super::contact_points;
use super::error::SceneError;
use super::reader::{Entry, Key, Section, in_order, key};
use super::stiffness::stiffness;
use gearbench_models::error::Reason;
use gearbench_models::law::{Damping, Friction, Law, LawError};
use gearbench_models::spec::ContactSpec;
use gearbench_models::stiffness::{IsoVariation, PairStiffness};

pub(super) static CONTACT: &[Key] = &[
    key(
        "stiffness",
        "\"iso6336\", or { kind = \"constant\" | \"iso6336\" | \"compliance\" | \"table\", .. }",
    ),
    key(
        "exponent",
        "exponent of the penetration from 1 to 3, default 1",
    ),
    key(
        "damping",
        "\"none\" (default), or { law = \"kelvin-voigt\" | \"flores\" | .., .. }",
    ),
    key("friction", "{ mu, v_ref_m_s }; left out, none"),
    key(
        "slices",
        "slices over the face width; left out, 1 for spur gears and 16 for helical or crowned ones",
    ),
    key(
        "penalty_pa_per_m",
        "models with flank points: pressure over penetration, for steel for example 1e15",
    ),
    key(
        "penalty_n_per_m",
        "in place of penalty_pa_per_m: force of a node over its penetration, with points = \"nodes\", for example 3.5e7",
    ),
    key(
        "law",
        "of flank points: \"penalty\" (default), or \"hard\": no penalty, for elastic gears with residual compliance",
    ),
    key(
        "points",
        "\"quadrature\" (default), \"nodes\", or { along, across }; with law = \"hard\" \"mortar\" (default) or \"nodes\"",
    ),
    key(
        "surface",
        "between the nodes of a flank: \"smooth\" (default) or \"faceted\"",
    ),
    key(
        "passes",
        "whose points touch the other's surface: \"first\", \"second\" or \"both\"; left out, those of the first gear with flanks",
    ),
    key(
        "damping_ns_per_m3",
        "dashpot per area of flank in N s/m per m2, default 0",
    ),
    key(
        "reach_m",
        "gap of the undeformed flanks up to which they are looked at, default a fiftieth of the base pitch",
    ),
];

pub(super) static NONE: &[Key] = &[LAW];
const LAW: Key = key("law", "name of the damping law");
pub(super) static KELVIN_VOIGT: &[Key] = &[
    LAW,
    key("damping_ns_per_m", "damper in N s/m, zero or more"),
];
pub(super) static RATIO: &[Key] = &[
    LAW,
    key("ratio", "damping over critical damping, for example 0.05"),
];
pub(super) static RESTITUTION: &[Key] =
    &[LAW, key("e", "coefficient of restitution, above 0 up to 1")];
pub(super) static FRICTION: &[Key] = &[
    key("mu", "coefficient of friction, zero or more"),
    key(
        "v_ref_m_s",
        "sliding speed in m/s over which the force is smoothed, for example 0.01",
    ),
];

/// Reads a contact. The stiffness may be left out when a calibration brings it.
pub(super) fn contact(entry: &Entry<'_>, calibrated: bool) -> Result<ContactSpec, SceneError> {
    let s = entry.section("`contact`", CONTACT)?;
    let points = contact_points::points(&s)?;
    let stiffness = match s.get("stiffness") {
        Some(e) => stiffness(&e)?,
        // Flank points bring their own; meshes without flanks beside them take the norm's.
        None if calibrated || points.is_some() => PairStiffness::Iso6336 {
            variation: IsoVariation::default(),
        },
        None => return Err(s.missing("stiffness")),
    };
    let exponent = s.number_or("exponent", 1.0)?;
    let damping = s
        .get("damping")
        .map_or(Ok(Damping::None), |e| damping(&e))?;
    check_law(&s, exponent, damping)?;
    let slices = match s.get("slices") {
        None => None,
        Some(e) => match e.whole()? {
            n @ 1..=1000 => Some(n as usize),
            n => {
                return Err(e.error(
                    format!("`slices` is {n}"),
                    "expected 1 to 1000",
                    "leave it out to let the toothing decide",
                ));
            }
        },
    };
    Ok(ContactSpec {
        stiffness,
        exponent,
        damping,
        friction: s.get("friction").map(|e| friction(&e)).transpose()?,
        slices,
        points,
    })
}

/// Law and damping as the model will build them; a ratio stands for a coefficient that is not known yet.
fn check_law(s: &Section<'_>, exponent: f64, damping: Damping) -> Result<(), SceneError> {
    let result = damping
        .resolved(exponent, 1.0, 1.0)
        .and_then(|d| Law::new(exponent, d));
    let Err(e) = result else { return Ok(()) };
    let key = match &e {
        LawError::Exponent { .. } => "exponent",
        _ => "damping",
    };
    let Reason { cause, help } = e.reason();
    match s.get(key) {
        Some(at) => Err(at.error(cause, "this value", help)),
        None => Err(s.error(cause, "here", help)),
    }
}

/// The key `tag` of a table, read before the keys that depend on it.
pub(super) fn tag<T: Clone>(
    entry: &Entry<'_>,
    tag: &str,
    known: &[(&str, T)],
) -> Result<T, SceneError> {
    match in_order(entry.source(), entry.raw_table()?)
        .into_iter()
        .find(|e| e.name == tag)
    {
        Some(e) => e.word(known),
        None => Err(entry.error(
            format!("`{tag}` is missing in `{}`", entry.name),
            "here",
            format!(
                "add `{tag}`, one of {}",
                known.iter().map(|(k, _)| *k).collect::<Vec<_>>().join(", ")
            ),
        )),
    }
}

/// One of several words; left out, the first.
pub(super) fn word_or<T: Clone>(
    s: &Section<'_>,
    name: &str,
    known: &[(&str, T)],
) -> Result<T, SceneError> {
    s.get(name)
        .map_or_else(|| Ok(known[0].1.clone()), |e| e.word(known))
}

fn damping(entry: &Entry<'_>) -> Result<Damping, SceneError> {
    if let Some(word) = entry.as_text() {
        return match word {
            "none" => Ok(Damping::None),
            known if Damping::IDS.contains(&known) => Err(entry.error(
                format!("the damping \"{word}\" needs its value"),
                "expected a table",
                match word {
                    "kelvin-voigt" => {
                        "for example { law = \"kelvin-voigt\", damping_ns_per_m = 500.0 }"
                            .to_owned()
                    }
                    "kelvin-voigt-ratio" => {
                        "for example { law = \"kelvin-voigt-ratio\", ratio = 0.05 }".to_owned()
                    }
                    _ => format!("for example {{ law = \"{word}\", e = 0.9 }}"),
                },
            )),
            other => Err(entry.unknown_word(other, &Damping::IDS)),
        };
    }
    let known = Damping::IDS.map(|id| (id, id));
    let law = tag(entry, "law", &known)?;
    Ok(match law {
        "none" => {
            entry.section("`damping`", NONE)?;
            Damping::None
        }
        "kelvin-voigt" => Damping::KelvinVoigt {
            c: entry
                .section("`damping`", KELVIN_VOIGT)?
                .number("damping_ns_per_m")?,
        },
        "kelvin-voigt-ratio" => Damping::KelvinVoigtRatio {
            ratio: entry.section("`damping`", RATIO)?.number("ratio")?,
        },
        _ => {
            let e = entry.section("`damping`", RESTITUTION)?.number("e")?;
            Damping::of_restitution(law, e).ok_or_else(|| entry.unknown_word(law, &Damping::IDS))?
        }
    })
}

fn friction(entry: &Entry<'_>) -> Result<Friction, SceneError> {
    let s = entry.section("`friction`", FRICTION)?;
    let (mu, v_ref) = (s.number("mu")?, s.number("v_ref_m_s")?);
    Friction::new(mu, v_ref).map_err(|e| {
        let Reason { cause, help } = e.reason();
        entry.error(cause, "this friction", help)
    })
}
