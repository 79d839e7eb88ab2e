//! `gearbench truncation SCENE`: error of the elastic model by number of modes.

use super::arguments::Truncation;
use super::{COUNTS, Plan, Side, study};
use crate::cli::terminal::{Refusal, refuse_run, say, stored_reference, with_progress, write};
use crate::experiment::conditions::Conditions;
use crate::experiment::external::external;
use crate::experiment::run::RunError;
use crate::experiment::settings::settings;
use crate::scene_file::{self, ModelChoice, SceneError, SceneFile};
use gearbench_integrators::Resolution;
use gearbench_integrators::table::{NEWMARK, TRIGONOMETRIC, VELOCITY_VERLET};
use gearbench_integrators::{MethodSpec, Scheme};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_reference::full_order::FullOrderParameters;
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reports::numbers::percent;
use gearbench_reports::record::Results;
use gearbench_reports::truncation::{LIMITS, Way, counts, ways};
use std::process::ExitCode;
use std::time::Duration;

/// Model whose modes are counted.
const ELASTIC: &str = ElasticParameters::MODEL;
/// Model it is held against.
const FULL: &str = FullOrderParameters::MODEL;
/// Step of the full model over that of the scene.
const FINER: f64 = 0.2;
/// Steps when the scene's model has no fixed one [s].
const STEP: f64 = 1e-6;
const FULL_STEP: f64 = 5e-7;
const TRUNCATED_STEP: f64 = 2e-8;

/// Runs the study and writes its folder.
pub fn run(args: &Truncation, command: &str) -> Result<ExitCode, Refusal> {
    let scene = scene_file::load(&args.scene)?;
    let (elastic, full) = sides(&scene, args)?;
    let reference = stored_reference(&scene)?;
    let mut tried: Vec<usize> = args.counts.iter().map(|n| *n as usize).collect();
    if tried.is_empty() {
        tried = COUNTS.to_vec();
    }
    tried.sort_unstable();
    tried.dedup();
    let plan = Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: settings(&scene, &[elastic, full], false),
            events: true,
            repeats: args.repeats,
            timeout: Duration::from_secs_f64(args.timeout),
            ..Conditions::of(&scene)
        },
        model: ELASTIC.into(),
        elastic: side(&scene, elastic, first(elastic, TRIGONOMETRIC, STEP)),
        truncated: truncated(&scene, elastic),
        full: side(&scene, full, full_method(&scene, full, args)?),
        counts: tried,
        refine: !args.no_refine,
        external: reference.as_ref().map(external),
    };
    let results = with_progress(1, |progress| study(&plan, progress)).map_err(refuse_run)?;

    write(&results, (&args.out, &scene.name), summarise)?;
    Ok(ExitCode::SUCCESS)
}

/// The elastic and the full model of a scene.
fn sides<'s>(
    scene: &'s SceneFile,
    args: &Truncation,
) -> Result<(&'s ModelChoice, &'s ModelChoice), Refusal> {
    let named = match &args.models {
        Some(text) => scene.select(Some(text))?,
        None => scene.models.iter().collect(),
    };
    let of = |id: &str| {
        let mut all = named.iter().filter(|m| m.model == id);
        all.find(|m| !is_truncated(m)).copied().ok_or_else(|| {
            Refusal::from(SceneError::plain(
                format!("the scene `{}` offers no model of the kind `{id}` here", scene.name),
                format!(
                    "the study holds `{ELASTIC}` against `{FULL}` on the same mesh; add a [[models]] with model = \"{id}\""
                ),
            ))
        })
    };
    Ok((of(ELASTIC)?, of(FULL)?))
}

fn is_truncated(choice: &ModelChoice) -> bool {
    let mut gears = choice.modelling.gears.iter();
    gears.any(|g| ElasticParameters::of(g).is_some_and(|p| !p.keeps_residual()))
}

fn side(scene: &SceneFile, choice: &ModelChoice, method: Scheme) -> Side {
    Side {
        scene: scene.spec_for(choice),
        modelling: choice.modelling.clone(),
        method,
    }
}

/// The first integrator of a model, or one that fits it.
fn first(choice: &ModelChoice, usual: MethodSpec, step: f64) -> Scheme {
    let own = choice.integrators.as_ref().and_then(|m| m.first());
    own.copied().unwrap_or(usual.at_step(step))
}

/// The integrator of plain truncation: that of a truncated model of the scene.
fn truncated(scene: &SceneFile, elastic: &ModelChoice) -> Scheme {
    let own = (scene.models.iter()).find(|m| m.model == ELASTIC && is_truncated(m));
    own.map_or_else(
        || Scheme {
            resolution: Resolution::Step(TRUNCATED_STEP),
            ..first(elastic, TRIGONOMETRIC, STEP)
        },
        |m| first(m, VELOCITY_VERLET, TRUNCATED_STEP),
    )
}

fn full_method(
    scene: &SceneFile,
    full: &ModelChoice,
    args: &Truncation,
) -> Result<Scheme, Refusal> {
    if let Some(text) = &args.reference_integrator {
        let methods = Scheme::list(text, &scene.study.integrators)
            .map_err(RunError::from)
            .map_err(refuse_run)?;
        if let Some(method) = methods.into_iter().next() {
            return Ok(method);
        }
    }
    let own = first(full, NEWMARK, FULL_STEP);
    let step = match own.resolution {
        Resolution::Step(h) => h,
        Resolution::Tolerance(_) => FULL_STEP,
    };
    Ok(NEWMARK.at_step(FINER * step))
}

/// The table of errors and the fewest modes.
fn summarise(results: &Results) {
    let all = ways(results);
    let heads: Vec<String> = all.iter().map(|w| format!("{:>31}", w.label)).collect();
    say("force-history error against full finite elements [%]");
    say(&format!("{:>6}{}", "modes", heads.join("")));
    for n in counts(&all) {
        let cell = |w: &Way<'_>| {
            let text = w.with(n).map_or(String::new(), |r| {
                let error = r.against(FULL).and_then(|m| m.force_l2);
                match error {
                    _ if r.status.is_failure() => r.status.as_str().to_string(),
                    Some(e) => percent(e, 3),
                    None => String::new(),
                }
            });
            format!("{text:>31}")
        };
        let cells: Vec<String> = all.iter().map(cell).collect();
        say(&format!("{n:>6}{}", cells.join("")));
    }
    for limit in LIMITS {
        let found: Vec<String> = (all.iter().filter(|w| w.residual))
            .map(|w| {
                let modes = w.fewest(FULL, limit).and_then(|r| r.modes);
                let modes = modes.map_or("none tried".into(), |n| n.to_string());
                format!("{modes} {}", w.label)
            })
            .collect();
        say(&format!(
            "fewest modes for {} %: {}",
            100.0 * limit,
            found.join(", ")
        ));
    }
}
