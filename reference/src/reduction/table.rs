//! The line of `elastic` in the table of gear models.

use super::choose::{self, Choice, Criterion, ModalDamping};
use super::{Mounting, Wanted, shared};
use crate::mesh_source::{self, Reader, Source};
use gearbench_models::gear::GearModel;
use gearbench_models::gear::elastic::Elastic;
use gearbench_models::gear::table::{GearContext, Model, ParameterInfo};
use gearbench_models::scene::spec::{Body as Toothing, BuildError, Value};
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
static PARAMETERS: [ParameterInfo; 14] = mesh_source::with_own(&[
    optional(
        "modes",
        "most modes to keep; default 100 (all where `max_frequency_hz` is given), 0 is quasi-static",
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

    let source = Source::read(&reader)?;
    let free = context.hub.coordinates() > 0;
    let mounting = match context.body {
        Toothing::Gear(_) => Mounting::gear(free, context.added_inertia),
        Toothing::Rack(_) => Mounting::rack(free, context.added_inertia),
    };
    // A frequency alone keeps all modes below it.
    let (count, wanted) = match (count, max_frequency) {
        (None, Some(f)) => (usize::MAX, Wanted::UpTo(f)),
        (count, _) => {
            let count = count.unwrap_or(MODES);
            (count, Wanted::Count(LEAST_CANDIDATES.max(2 * count)))
        }
    };
    let (mesh, sector) = match source.sector(&reader)? {
        Some(sector) => (sector, true),
        None => (source.whole(&reader)?, false),
    };
    let basis = shared::basis_of(&mesh, sector, &context.material, &mounting, wanted)
        .map_err(|e| reader.error("mesh", e.to_string()))?;
    let highest = choose::highest_for_step(step)
        .min(max_frequency.map_or(f64::INFINITY, |f| std::f64::consts::TAU * f));
    let kept = choose::choose(
        &basis,
        &Choice {
            by,
            count,
            highest,
            candidates: shared::lowest(&basis, wanted),
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
