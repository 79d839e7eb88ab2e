//! The line of `elastic` in the table of gear models.

use super::choose::{self, Choice, Criterion, ModalDamping};
use super::estimate::Impacts;
use super::parameters::ElasticParameters;
use super::recovery::{MeshExtent, MeshRecovery};
use super::{Basis, ModeSelection, ReductionError, open, shared};
use crate::mesh_source::{MeshParameters, Reader, Source};
use gearbench_models::error::BuildError;
use gearbench_models::gear::GearModel;
use gearbench_models::gear::elastic::Elastic;
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::properties::Properties;
use gearbench_models::gear::table::{GearContext, Model};
use gearbench_models::spec::Body as Toothing;
use std::path::Path;
use std::sync::{Arc, OnceLock};

const MODEL: &str = ElasticParameters::MODEL;

/// Row of the model in the table.
pub const ROW: Model = Model::of::<ElasticParameters>(
    "reduced finite elements: a few modes and the static compliance of the others",
    Properties {
        modes: true,
        ..Properties::NONE
    },
    build,
);

/// Largest number of requested modes.
const MOST_MODES: usize = 5000;
/// Step that the modes shall bear by default [s].
const STEP: f64 = 1e-6;
/// So many of the lowest modes are looked at, at least; twice as many as are kept.
const LEAST_CANDIDATES: usize = 400;
/// Lowest modes of a gear of equal teeth of which those of the teeth in mesh are made. Gears of many teeth need as many
/// to reach the frequencies at which a loaded tooth vibrates. Other meshes, whose modes are found without symmetry, have
/// [`LEAST_CANDIDATES`].
const CANDIDATES_IN_MESH: usize = 1000;
/// Time within which modes made for the teeth in mesh are more accurate than as many eigenmodes, in times that a shear wave
/// takes for one module. Later the vibrations have spread over the body.
const SHORT: f64 = 500.0;

fn damping(reader: &Reader<'_>, given: &ElasticParameters) -> Result<ModalDamping, BuildError> {
    let [alpha, beta] = reader.rayleigh(given.rayleigh)?;
    let ratio = reader.not_negative("damping_ratio", given.damping_ratio)?;
    if ratio >= 1.0 {
        return Err(reader.error(
            "damping_ratio",
            (
                format!("is {ratio}: no mode would vibrate"),
                "damp less: 0.02 are 2 % of critical",
            ),
        ));
    }
    Ok(ModalDamping { ratio, alpha, beta })
}

/// Contact lies evenly over the face width of a spur toothing without crowning whose hub does not move sideways.
fn even_over_width(context: &GearContext<'_>) -> bool {
    if context.hub.lateral.is_some() {
        return false;
    }
    match context.body {
        Toothing::Gear(g) => !g.varies_over_width(),
        Toothing::Rack(r) => r.params().helix_angle == 0.0,
    }
}

/// Returns the criterion of the choice. By default modes are made for the teeth in mesh where no other teeth follow, the
/// time is short, and a number of modes limits the choice.
fn criterion(context: &GearContext<'_>, given: &ElasticParameters) -> Criterion {
    let limited = match given.modes {
        Some(_) => true,
        None => given.max_frequency_hz.is_none() && given.reduction.is_none(),
    };
    let made = limited && given.keeps_residual() && given.target_error.is_none();
    let of_waves = context.body.module() / context.material.shear_wave_speed();
    match given.choose {
        Some(criterion) => criterion,
        None if made && context.time_of_first_teeth < SHORT * of_waves => Criterion::TeethInMesh,
        None => Criterion::FlankCompliance,
    }
}

/// Requested number of modes.
struct ModeRequest {
    by: Criterion,
    count: Option<usize>,
    /// Largest frequency [Hz].
    max_frequency: Option<f64>,
    /// True if a target for the error determines the number.
    target: bool,
}

/// A basis, how many of its modes may be kept, and among how many of the lowest; the mesh it is of.
type BasisResult = (Arc<Basis>, usize, usize, Option<MeshRecovery>);

/// The basis of the mesh that the parameters name.
fn computed(
    reader: &Reader<'_>,
    given: &ElasticParameters,
    asked: &ModeRequest,
) -> Result<BasisResult, BuildError> {
    let of = super::of_gear(MODEL, reader.context, &given.mesh)?;
    let least = match asked.by {
        Criterion::TeethInMesh if of.sector => CANDIDATES_IN_MESH,
        _ => LEAST_CANDIDATES,
    };
    // A frequency alone keeps all modes below it; a target may take any number.
    let (count, wanted) = match (asked.count, asked.max_frequency) {
        (None, Some(f)) => (usize::MAX, ModeSelection::UpTo(f)),
        (None, None) if asked.target => (usize::MAX, ModeSelection::Count(least)),
        (count, _) => {
            let count = count.unwrap_or(ElasticParameters::MODES);
            (count, ModeSelection::Count(least.max(2 * count)))
        }
    };
    let basis = shared::basis_of(&of.request(reader.context.material, wanted))
        .map_err(|e| reader.error("mesh", e.to_string()).of_model())?;
    let candidates = shared::lowest(&basis, wanted);
    let whole = match Source::read(reader, &given.mesh)? {
        Source::Generated(params) if of.sector => {
            MeshExtent::Generated(Box::new((reader.context.body.clone(), *params)))
        }
        _ => MeshExtent::AtHand,
    };
    let mesh = MeshRecovery {
        mesh: of.mesh,
        whole,
        material: reader.context.material,
        mounting: of.mounting,
        basis: basis.clone(),
        kept: Vec::new(),
        made: None,
        residual: true,
        strips: reader.context.lines,
        found: OnceLock::new(),
    };
    Ok((basis, count, candidates, Some(mesh)))
}

/// Returns the basis of a stored reduction, compared with the gear and the request.
fn stored(reader: &Reader<'_>, path: &str, asked: &ModeRequest) -> Result<BasisResult, BuildError> {
    let given = reader.context.model.values();
    let mut own = MeshParameters::KEYS.iter().map(|p| p.key);
    if let Some(key) = own.find(|k| given.contains_key(*k)) {
        return Err(reader.error(
            key,
            (
                "is given with `reduction`, which contains its own mesh",
                "remove one of them",
            ),
        ));
    }
    let error = |message: String| reader.error("reduction", message);
    let stored = open::open(Path::new(path)).map_err(|e| error(e.to_string()))?;
    if let Some(misfit) = open::misfit(&stored, reader.context) {
        return Err(error(format!("{path}: {misfit}")));
    }
    let modes = stored.basis.omega.len();
    if let Some(n) = asked.count.filter(|n| *n > modes) {
        return Err(reader.error(
            "modes",
            (
                format!("{n} modes are requested, but {path} contains {modes}"),
                format!("use fewer, or reduce the gear with `--modes {n}`"),
            ),
        ));
    }
    let highest = stored.basis.omega.last().copied().unwrap_or(0.0) / std::f64::consts::TAU;
    match asked.max_frequency {
        Some(f) if f > highest && asked.count.is_none() => Err(reader.error(
            "max_frequency_hz",
            (
                format!(
                    "modes up to {f} Hz are requested, but {path} contains modes up to {highest:.0} Hz"
                ),
                format!(
                    "reduce the gear with \
                 `--max-frequency {f}`"
                ),
            ),
        )),
        _ => Ok((
            stored.basis.clone(),
            asked.count.unwrap_or(modes),
            modes,
            None,
        )),
    }
}

/// Returns the selected eigenmodes; with a target for the error of the force history, the smallest number that meets
/// it.
fn kept_of(
    reader: &Reader<'_>,
    basis: &Basis,
    choice: &Choice,
    target: Option<f64>,
) -> Result<Vec<usize>, BuildError> {
    let Some(target) = target else {
        return Ok(choose::choose(basis, choice));
    };
    let radius = reader.context.effective_radius;
    Impacts::new(basis, radius, choice.even_over_width)
        .fewest(choice, target)
        .map_err(|e| reader.error("target_error", e.to_string()))
}

fn build(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let reader = Reader {
        model: MODEL,
        context,
    };
    let given = context.parameters::<ElasticParameters>()?;
    let count = reader.count("modes", given.modes, 0, MOST_MODES)?;
    let residual = given.keeps_residual();
    let step = reader.positive("step_s", given.step_s)?.unwrap_or(STEP);
    let max_frequency = reader.positive("max_frequency_hz", given.max_frequency_hz)?;
    let target = reader.positive("target_error", given.target_error)?;
    if target.is_some() && !residual {
        return Err(reader.error(
            "target_error",
            (
                "is estimated for modes with the static compliance of the others",
                "leave out `residual = false`",
            ),
        ));
    }
    let damping = damping(&reader, given)?;
    let asked = ModeRequest {
        by: criterion(context, given),
        count,
        max_frequency,
        target: target.is_some(),
    };
    let (basis, count, candidates, mesh) = match &given.reduction {
        Some(path) => stored(&reader, path, &asked)?,
        None => computed(&reader, given, &asked)?,
    };
    let highest = choose::highest_for_step(step)
        .min(max_frequency.map_or(f64::INFINITY, |f| std::f64::consts::TAU * f));
    let choice = Choice {
        by: asked.by,
        count,
        highest,
        candidates,
        time: context.time_of_first_teeth,
        even_over_width: even_over_width(context),
    };
    let teeth = match choice.by {
        Criterion::TeethInMesh => choose::in_mesh(context),
        Criterion::Frequency | Criterion::FlankCompliance => Vec::new(),
    };
    if target.is_some() && !teeth.is_empty() {
        return Err(reader.error(
            "target_error",
            (
                "is estimated for a choice of eigenmodes, but these are made for the teeth in mesh",
                "give `modes`, or leave `choose` out",
            ),
        ));
    }
    let failed = |e: ReductionError| reader.error("modes", e.to_string()).of_model();
    let (reduced, kept, made) = if teeth.is_empty() {
        let kept = kept_of(&reader, &basis, &choice, target)?;
        let reduced = choose::reduced(&basis, &kept, &damping, residual);
        (reduced, kept, None)
    } else {
        let made = choose::made_for(&basis, &teeth, &choice).map_err(failed)?;
        let of_span = made.span.len() / made.basis.omega.len().max(1);
        let used = |i: &usize| {
            let count = made.basis.omega.len();
            made.span[i * count..(i + 1) * count]
                .iter()
                .any(|v| *v != 0.0)
        };
        let last = (0..of_span).rev().find(used).map_or(0, |i| i + 1);
        (
            made.reduced(&damping, residual),
            (0..last).collect(),
            Some(made),
        )
    };
    let mut reduced = reduced.map_err(failed)?;
    if let Toothing::Gear(gear) = context.body {
        reduced.flanks.deviate(gear);
    }
    if let Some(strips) = context.lines {
        reduced = reduced
            .over_lines(strips)
            .map_err(|e| reader.error("mesh", e).of_model())?;
    }
    let gear = Elastic::new(
        context.hub.clone(),
        context.effective_radius,
        context.placement,
        Arc::new(reduced),
    );
    let mut gear = gear.map_err(|e| reader.error("mesh", e))?;
    if let Some(mesh) = mesh {
        gear = gear.with_recovery(Arc::new(MeshRecovery {
            kept,
            made,
            residual,
            ..mesh
        }));
    }
    let gear = gear.with_retardation(damping.beta);
    let gear = gear.with_spin_terms(given.spin_terms.unwrap_or_default());
    let mut gear = gear.map_err(|e| reader.error("spin_terms", e))?;
    gear.decide_spin_terms(context.speed);
    Ok(Box::new(gear))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support;
    use gearbench_models::spec::Mount;
    use serde_json::Value;

    fn built(mount: Mount, parameters: &[(&str, Value)]) -> Result<usize, BuildError> {
        let gear = test_support::gear(18, 2e-3, |p| {
            p.face_width = 5e-3;
            p.bore_radius = 6e-3;
        });
        let radius = gear.r_base();
        let (body, hub) = (Toothing::Gear(gear), test_support::hub(mount, None));
        let mesh = [
            ("flank_elements", 3),
            ("fillet_elements", 2),
            ("across_elements", 6),
            ("rim_elements", 2),
            ("width_elements", 1),
        ];
        let mesh = mesh.map(|(key, n)| (key, Value::from(n)));
        let model = ROW.spec(mesh.into_iter().chain(parameters.iter().cloned()))?;
        let context = GearContext {
            slides: false,
            lines: None,
            effective_radius: radius,
            ..test_support::context(&body, &hub, &model)
        };
        (ROW.build)(&context).map(|g| g.hub().own)
    }

    #[test]
    fn parameters_say_which_modes() {
        let number = |x: f64| Value::from(x);
        let word = |x: &str| Value::from(x);
        let modes = built(Mount::Revolute, &[("modes", number(30.0))]).unwrap();
        assert!((29..=30).contains(&modes));
        let held = built(Mount::Fixed, &[("modes", number(0.0))]).unwrap();
        assert_eq!(held, 0);
        let below = [
            ("max_frequency_hz", number(2e5)),
            ("residual", Value::from(false)),
        ];
        let below = built(Mount::Revolute, &below).unwrap();
        assert!(below > 20);
        // A longer step carries fewer.
        let slow = [("max_frequency_hz", number(2e5)), ("step_s", number(8e-6))];
        assert!(built(Mount::Revolute, &slow).unwrap() < below);
        let coarse = built(Mount::Revolute, &[("target_error", number(0.03))]).unwrap();
        let fine = built(
            Mount::Revolute,
            &[("target_error", number(0.01)), ("step_s", number(4e-7))],
        )
        .unwrap();
        assert!(0 < coarse && coarse < fine);
        for (parameters, message) in [
            (vec![("choose", word("best"))], "unknown variant `best`"),
            (vec![("rayleigh", number(1.0))], "[alpha, beta]"),
            (
                vec![("target_error", number(1e-9)), ("modes", number(20.0))],
                "allow more modes",
            ),
            (
                vec![
                    ("target_error", number(0.1)),
                    ("residual", Value::from(false)),
                ],
                "leave out",
            ),
            (vec![("damping_ratio", number(1.5))], "damp less"),
            (vec![("modes", number(1.5))], "whole number"),
            (vec![("spin_terms", word("some"))], "expected one of `auto`"),
        ] {
            let e = built(Mount::Revolute, &parameters).unwrap_err().to_string();
            assert!(e.contains(message), "{e}");
        }
    }
}
