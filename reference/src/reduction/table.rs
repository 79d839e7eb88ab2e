//! The line of `elastic` in the table of gear models.

use super::choose::{self, Choice, Criterion, ModalDamping};
use super::{Basis, Wanted, open, shared};
use crate::mesh_source::{self, Reader};
use gearbench_models::gear::GearModel;
use gearbench_models::gear::elastic::Elastic;
use gearbench_models::gear::table::{GearContext, Model, ParameterInfo};
use gearbench_models::scene::spec::{Body as Toothing, BuildError, Value};
use std::path::Path;
use std::sync::Arc;

const MODEL: &str = "elastic";

const fn optional(key: &'static str, meaning: &'static str) -> ParameterInfo {
    ParameterInfo {
        key,
        meaning,
        required: false,
    }
}

/// Parameters of the model.
static PARAMETERS: [ParameterInfo; 15] = mesh_source::with_own(&[
    optional(
        "reduction",
        "path of a stored reduction (.npz, made by `gearbench reduce`) in place of a mesh",
    ),
    optional(
        "modes",
        "most modes to keep; default 100 (all of a stored reduction, or where `max_frequency_hz` is given), 0 is quasi-static",
    ),
    optional("max_frequency_hz", "highest frequency of a mode to keep"),
    optional(
        "choose",
        "\"flank-compliance\" (default): the modes that yield most at the flanks; \"frequency\": the lowest",
    ),
    optional(
        "residual",
        "true (default): modes that are cut stay as static compliance; false: plain truncation",
    ),
    optional("damping_ratio", "damping ratio of all modes; default 0"),
    optional(
        "rayleigh",
        "[alpha, beta] of the damping alpha M + beta K, in 1/s and s",
    ),
    optional(
        "step_s",
        "longest step that shall carry the modes: those above 0.64 pi / step are cut; default 1e-6",
    ),
]);

/// Its row.
pub const ROW: Model = Model {
    id: MODEL,
    title: "reduced finite elements: a few modes and the static compliance of the others",
    parameters: &PARAMETERS,
    build,
};

/// Modes kept by default.
const MODES: usize = 100;
/// Most modes that are asked for.
const MOST_MODES: usize = 5000;
/// Step that the modes shall bear by default [s].
const STEP: f64 = 1e-6;
/// So many of the lowest modes are looked at, at least; twice as many as are kept.
const LEAST_CANDIDATES: usize = 400;

fn damping(reader: &Reader<'_>) -> Result<ModalDamping, BuildError> {
    let (alpha, beta) = match reader.context.parameters.get("rayleigh") {
        None => (0.0, 0.0),
        Some(Value::List(x)) if x.len() == 2 && x.iter().all(|x| x.is_finite() && *x >= 0.0) => {
            (x[0], x[1])
        }
        Some(_) => {
            return Err(reader.error(
                "rayleigh",
                "expected two numbers of 0 or more: [alpha, beta]",
            ));
        }
    };
    Ok(ModalDamping {
        ratio: reader.number("damping_ratio", Some(0.0))?.unwrap_or(0.0),
        alpha,
        beta,
    })
}

/// Contact lies evenly over the face width of a spur toothing without crowning.
fn even_over_width(body: &Toothing) -> bool {
    match body {
        Toothing::Gear(g) => {
            let p = g.params();
            p.helix_angle == 0.0 && p.modifications.lead_crowning == 0.0
        }
        Toothing::Rack(r) => r.params().helix_angle == 0.0,
    }
}

/// The basis of a stored reduction, held against the gear and what is asked of it.
fn stored(
    reader: &Reader<'_>,
    path: &str,
    count: Option<usize>,
    max_frequency: Option<f64>,
) -> Result<Arc<Basis>, BuildError> {
    let own = mesh_source::PARAMETERS.iter().map(|p| p.key);
    if let Some(key) = own
        .into_iter()
        .find(|k| reader.context.parameters.contains_key(*k))
    {
        return Err(reader.error(
            key,
            "stands beside `reduction`, which brings its own mesh; leave one of them out",
        ));
    }
    let error = |message: String| reader.error("reduction", message);
    let stored = open::open(Path::new(path)).map_err(|e| error(e.to_string()))?;
    if let Some(misfit) = open::misfit(&stored, reader.context) {
        return Err(error(format!("{path}: {misfit}")));
    }
    let modes = stored.basis.omega.len();
    if let Some(n) = count.filter(|n| *n > modes) {
        return Err(reader.error(
            "modes",
            format!(
                "{n} modes are asked for, but {path} holds {modes}; ask for fewer, or reduce the gear with `--modes {n}`"
            ),
        ));
    }
    let highest = stored.basis.omega.last().copied().unwrap_or(0.0) / std::f64::consts::TAU;
    match max_frequency {
        Some(f) if f > highest && count.is_none() => Err(reader.error(
            "max_frequency_hz",
            format!(
                "modes up to {f} Hz are asked for, but those of {path} end at {highest:.0} Hz; reduce the gear with \
                 `--max-frequency {f}`"
            ),
        )),
        _ => Ok(stored.basis.clone()),
    }
}

fn build(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let reader = Reader {
        model: MODEL,
        context,
    };
    let count = reader.count("modes", 0, MOST_MODES)?;
    let by = match reader.text("choose")? {
        None | Some("flank-compliance") => Criterion::FlankCompliance,
        Some("frequency") => Criterion::Frequency,
        Some(other) => {
            return Err(reader.error(
                "choose",
                format!("\"{other}\" is not known; expected \"flank-compliance\" or \"frequency\""),
            ));
        }
    };
    let residual = reader.flag("residual")?.unwrap_or(true);
    let step = reader.number("step_s", None)?.unwrap_or(STEP);
    let max_frequency = reader.number("max_frequency_hz", None)?;
    let damping = damping(&reader)?;

    let (basis, count, candidates) = match reader.text("reduction")? {
        Some(path) => {
            let basis = stored(&reader, path, count, max_frequency)?;
            let all = basis.omega.len();
            (basis, count.unwrap_or(all), all)
        }
        None => {
            // A frequency alone keeps all modes below it.
            let (count, wanted) = match (count, max_frequency) {
                (None, Some(f)) => (usize::MAX, Wanted::UpTo(f)),
                (count, _) => {
                    let count = count.unwrap_or(MODES);
                    (count, Wanted::Count(LEAST_CANDIDATES.max(2 * count)))
                }
            };
            let of = super::of_gear(MODEL, context)?;
            let basis = shared::basis_of(
                &of.mesh,
                of.sector,
                &context.material,
                &of.mounting,
                wanted,
                residual,
            )
            .map_err(|e| reader.error("mesh", e.to_string()))?;
            let candidates = shared::lowest(&basis, wanted);
            (basis, count, candidates)
        }
    };
    let highest = choose::highest_for_step(step)
        .min(max_frequency.map_or(f64::INFINITY, |f| std::f64::consts::TAU * f));
    let kept = choose::choose(
        &basis,
        &Choice {
            by,
            count,
            highest,
            candidates,
            even_over_width: even_over_width(context.body),
        },
    );
    let reduced = choose::reduced(&basis, &kept, &damping, residual)
        .map_err(|e| reader.error("residual", e.to_string()))?;
    let gear = Elastic::new(
        context.hub.clone(),
        context.lever,
        context.placement,
        Arc::new(reduced),
    );
    Ok(Box::new(gear.map_err(|e| reader.error("mesh", e))?))
}
