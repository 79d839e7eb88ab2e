//! Validity of identified constants at other speeds. Rigid gears and movable teeth are fitted to full finite elements
//! at one speed, and compared with them at a third and at three times that speed; the fitted stiffnesses are compared
//! with published, standard, computed and static ones.
//!
//! Finite elements run under the conditions of their scene. Their history is cut at the separation of the gears,
//! because at another speed they reach the other flanks at another time.

use crate::validate::ValidationError;
use gearbench::context::Context;
use gearbench::experiment::conditions::even;
use gearbench::experiment::key::Key;
use gearbench::experiment::run::history_on_grid;
use gearbench::experiment::runner::Runner;
use gearbench::models::models;
use gearbench::scene_file::calibration::Constants;
use gearbench::scene_file::{self, ModelChoice, SceneFile, Selection};
use gearbench::studies::identify::{
    DataSet, FitOptions, FitPlan, Identification, IdentifyError, apply, identify,
};
use gearbench_models::gear::table::properties_of;
use gearbench_models::scene::{Channel, OfMesh, Scene};
use gearbench_models::spec::{
    ContactSpec, ModelSpec, Modelling, SceneSpec, effective_radius, mesh_layout,
};
use gearbench_models::stiffness::{Foundation, Hertz, IsoVariation, PairStiffness, ToothModel};
use gearbench_reference::statics::{Load, LoadedPair, MeshCycle};
use std::fmt::Display;

mod fit_specs;
mod tables;

use fit_specs::{FitSpec, WANTED, of_gears};
pub use tables::markdown;

/// Speeds relative to that of the scene; constants are fitted to the first.
const SPEEDS: [f64; 3] = [1.0, 1.0 / 3.0, 3.0];
/// Number of times of a history over the duration of the scene.
const TIMES: usize = 320;
/// Static load per face width [N/m].
const LOAD: f64 = 100e3;
/// Number of static positions over a mesh cycle.
const POSITIONS: usize = 24;
/// Tooth stiffnesses of S. Ebrahimi, P. Eberhard, SIMPACK User Meeting 2006 [N/m].
const PUBLISHED: [f64; 2] = [5.6e7, 3.6e9];
/// Conversion of a stiffness per face width from N/(mm um) to N/m^2.
const N_PER_MM_UM: f64 = 1e9;

/// A model fitted to finite elements.
pub struct FittedModel {
    /// Name of the fit: model and free constants.
    pub name: &'static str,
    /// Result of the identification, with the held-out speeds.
    pub found: Identification,
    /// The model without its constants.
    modelling: Modelling,
}

/// A row of the table of stiffnesses.
pub struct Stiffness {
    /// Source of the value.
    pub source: String,
    /// Definition of the stiffness that the source states.
    pub convention: &'static str,
    /// The stated value in that convention, with its unit.
    pub stated: String,
    /// Largest stiffness of one tooth pair along the line of action per face width, and mean of the mesh [N/m^2].
    pub pair_and_mesh: Option<[f64; 2]>,
}

/// Results of one scene: fits and stiffnesses.
pub struct SceneFits {
    /// Name of the scene.
    pub scene: String,
    /// The fitted models of the scene.
    pub fits: Vec<FittedModel>,
    /// The rows of the table of stiffnesses.
    pub stiffnesses: Vec<Stiffness>,
}

fn other(e: &dyn Display) -> ValidationError {
    ValidationError::Other(e.to_string())
}

/// Returns a gear of a model whose constants are not yet known.
fn without_constants(model: &str) -> Result<ModelSpec, ValidationError> {
    let row = models().iter().find(|m| m.id == model);
    let row = row.ok_or_else(|| other(&format!("there is no model `{model}`")))?;
    row.spec::<&str, f64>([]).map_err(|e| other(&e))
}

/// Fits the models of a scene to full finite elements.
///
/// # Errors
/// [`ValidationError`] where the scene has no finite elements, or a run or a fit fails.
pub fn carry(
    name: &str,
    runner: &Runner<'_>,
    print: &dyn Fn(&str),
) -> Result<SceneFits, ValidationError> {
    let scene = scene_file::load_uncalibrated(&Context::default(), name, Selection::None)
        .map_err(|e| other(&e.to_text()))?;
    let full = |c: &&ModelChoice| properties_of(models(), &c.model).full_order;
    // A model with the label `fe` takes precedence over other full finite elements, whose labels name a variant of the
    // contact.
    let named = scene.model("fe").filter(full);
    let fe = named.or_else(|| scene.models.iter().find(full));
    let rigid = scene.models.iter().find(|c| c.model == "rigid");
    let (Some(fe), Some(rigid)) = (fe, rigid) else {
        let why = format!("{name} lacks a model of finite elements or a rigid one");
        return Err(ValidationError::Other(why));
    };
    let mut data = Vec::new();
    for factor in SPEEDS {
        let set = history(&scene, fe, factor, runner)?;
        print(&format!("{name}: {}", set.name));
        data.push(set);
    }
    let mut fits = Vec::new();
    for FitSpec {
        name: label,
        model,
        keys,
        held,
    } in WANTED
    {
        let mut modelling = rigid.modelling.clone();
        for gear in &mut modelling.gears {
            *gear = without_constants(model)?;
        }
        let fit = keys.map(|keys| keys.iter().flat_map(|key| of_gears(key, &scene)).collect());
        let held = held
            .iter()
            .map(|(key, x)| ((*key).to_owned(), *x))
            .collect();
        let plan = FitPlan {
            data: data[..1].to_vec(),
            held_out: data[1..].to_vec(),
            wishes: FitOptions {
                fit,
                held,
                ..FitOptions::default()
            },
            ..FitPlan::new(scene.clone(), label, &modelling)
        };
        let found = identify(&plan, runner, |_, _| {}).map_err(|e: IdentifyError| other(&e))?;
        print(&format!(
            "{name}: {label} fitted, {} trials",
            found.record.evaluations
        ));
        fits.push(FittedModel {
            name: label,
            found,
            modelling,
        });
    }
    let stiffnesses = stiffnesses(&scene, fe, rigid, &fits)?;
    Ok(SceneFits {
        scene: name.into(),
        fits,
        stiffnesses,
    })
}

/// Contact force of full finite elements at a multiple of the scene's speed, up to the separation of the gears.
fn history(
    scene: &SceneFile,
    fe: &ModelChoice,
    factor: f64,
    runner: &Runner<'_>,
) -> Result<DataSet, ValidationError> {
    let mut spec = scene.spec_for(fe);
    let scheme = fe.integrators.as_ref().and_then(|all| all.first());
    let scheme = scheme.or(scene.study.integrators.first());
    let scheme = scheme.ok_or_else(|| other(&"the finite elements have no integrator"))?;
    // A slower gear takes longer to touch; facets stand back about as far as the gap.
    let approach: f64 = (spec.gears.iter())
        .map(|g| (g.speed * effective_radius(&g.body)).abs())
        .sum();
    let gap = spec.meshes.first().map_or(0.0, |m| m.start.gap);
    let later = 2.0 * gap / approach * (1.0 / factor - 1.0);
    let time = even(TIMES, scene.duration + later.max(0.0));
    for gear in &mut spec.gears {
        gear.speed *= factor;
    }
    let key = Key::new("history of finite elements")
        .and_scene(&spec, &fe.modelling)
        .and(&(scheme, time.as_slice()));
    let force = runner.piece(key, || -> Result<Vec<f64>, ValidationError> {
        let mut built = Scene::build(&spec, &fe.modelling, models()).map_err(|e| other(&e))?;
        history_on_grid(
            &scene.context,
            &mut built,
            scheme,
            u64::MAX,
            (&time, Channel::Mesh(0, OfMesh::Force)),
        )
        .map_err(|e| other(&e))
    })?;
    // Parted is what stays apart for a fiftieth of the history.
    let still = TIMES / 50;
    let touched = force.iter().position(|f| *f > 0.0).unwrap_or(0);
    let parted = (touched..force.len())
        .find(|&i| force[i..].iter().take(still).all(|f| *f == 0.0))
        .unwrap_or(force.len());
    let n = (parted + still).min(force.len());
    let mut set = DataSet::history(
        &format!("`{}` at {:.4} times the speed", fe.label, factor),
        &spec,
        &time[..n],
        &force[..n],
    );
    // The fitted models start with a gap of their own.
    set.spec = spec;
    Ok(set)
}

/// Static stiffness of a tooth pair and of the mesh per face width [N/m^2].
fn at_rest(spec: &SceneSpec, modelling: &Modelling, force: f64) -> Option<[f64; 2]> {
    let mut pair = LoadedPair::new(spec, modelling, models()).ok()?;
    let cycle = MeshCycle::solve(&mut pair, Load::Force(force), POSITIONS, |_| {}).ok()?;
    Some([cycle.single_stiffness(), cycle.mesh_stiffness()])
}

fn stiffnesses(
    scene: &SceneFile,
    fe: &ModelChoice,
    rigid: &ModelChoice,
    fits: &[FittedModel],
) -> Result<Vec<Stiffness>, ValidationError> {
    let spec = scene.spec_for(rigid);
    let [a, b] = spec.meshes[0].gears.map(|i| &spec.gears[i]);
    let width = mesh_layout(a, b).map_err(|e| other(&e))?.face_width;
    let force = LOAD * width;
    let with = |stiffness: PairStiffness| {
        let mut modelling = rigid.modelling.clone();
        for contact in &mut modelling.contacts {
            *contact = ContactSpec {
                stiffness: stiffness.clone(),
                ..contact.clone()
            };
        }
        modelling
    };
    let iso = with(PairStiffness::Iso6336 {
        variation: IsoVariation::default(),
    });
    let analytic = with(PairStiffness::Compliance {
        tooth: ToothModel::WeberBanaschek,
        foundation: Foundation::Ring,
        hertz: Hertz::WeberBanaschek {
            reference_load: None,
        },
    });
    let per_width = |x: f64| format!("{:.2} N/(mm um)", x / N_PER_MM_UM);
    let mut all = Vec::new();
    for k in PUBLISHED {
        let mut modelling = iso.clone();
        for gear in &mut modelling.gears {
            *gear = without_constants("movable-teeth")?;
        }
        let constants = Constants::of([("tooth_stiffness_n_per_m", k), ("tooth_mass_kg", 1e-4)]);
        let names = [a.name.as_str(), b.name.as_str()];
        (constants.apply("movable-teeth", &names, &mut modelling)).map_err(|e| other(&e))?;
        all.push(Stiffness {
            source: "published (Ebrahimi, Eberhard 2006)".into(),
            convention: "tangential spring of one tooth on the dedendum circle, whole width; contact of ISO 6336-1 in series",
            stated: format!("{k:.1e} N/m"),
            pair_and_mesh: at_rest(&spec, &modelling, force),
        });
    }
    for (source, convention, modelling) in [
        ("ISO 6336-1", "c' of a pair over the width, secant", iso),
        (
            "analytic (Weber, Banaschek; ring)",
            "tooth, body and Hertz in series, secant at 100 N/mm",
            analytic,
        ),
    ] {
        let found = at_rest(&spec, &modelling, force);
        all.push(Stiffness {
            source: source.into(),
            convention,
            stated: found.map_or_else(|| "-".into(), |[pair, _]| per_width(pair)),
            pair_and_mesh: found,
        });
    }
    let found = at_rest(&scene.spec_for(fe), &fe.modelling, force);
    all.push(Stiffness {
        source: "finite elements at rest".into(),
        convention: "force over approach at 100 N/mm, bodies included",
        stated: found.map_or_else(|| "-".into(), |[pair, _]| per_width(pair)),
        pair_and_mesh: found,
    });
    for fit in fits {
        let model = fit.modelling.gears.first().map_or("", |g| g.id());
        let (mut spec, mut modelling) = (spec.clone(), fit.modelling.clone());
        apply(&fit.found.all, model, &mut spec, &mut modelling).map_err(|e| other(&e))?;
        let told = fit.found.record.parameters.iter().filter_map(|p| {
            let wanted = p.key.contains("stiffness");
            Some(format!("{:.3e} {}", p.value.filter(|_| wanted)?, p.unit))
        });
        let told: Vec<String> = told.collect();
        all.push(Stiffness {
            source: format!("identified from one impact: {}", fit.name),
            convention: match model {
                "rigid" => "contact of a pair over the width, in the middle of the path",
                _ => "contact of a pair over the width; tangential spring of one tooth on the dedendum circle",
            },
            stated: match told.is_empty() {
                true => "not identifiable".into(),
                false => told.join("; "),
            },
            pair_and_mesh: at_rest(&spec, &modelling, force),
        });
    }
    Ok(all)
}

/// Limits for movable teeth: relative errors of force, peak and impulse at the fitted speed, and of the force at the
/// other speeds.
pub const BARS: [f64; 4] = [0.04, 0.03, 0.005, 0.08];

/// True if the errors of a fit are within [`BARS`].
pub fn is_within_bars(fit: &FittedModel) -> bool {
    fit.found.record.data.iter().all(|d| {
        let within = |x: Option<f64>, bar: f64| x.is_none_or(|x| x.abs() <= bar);
        match d.validation {
            true => d.l2 <= BARS[3],
            false => {
                d.l2 <= BARS[0] && within(d.peak_rel, BARS[1]) && within(d.impulse_rel, BARS[2])
            }
        }
    })
}
