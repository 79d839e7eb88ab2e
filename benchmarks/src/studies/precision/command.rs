//! `gearbench precision SCENE`: accuracy against cost.

use super::arguments::Precision;
use super::{Asked, Plan, metrics_of, study};
use crate::cli::terminal::{Refusal, refuse_run, say, stored_reference, with_progress, write};
use crate::experiment::conditions::Conditions;
use crate::experiment::settings::settings;
use crate::scene_file::{self, SceneError, Selection};
use gearbench_reports::numbers::{percent, quantity, short};
use gearbench_reports::precision::{Cost, LEVELS, Precision as Told, family, rung};
use gearbench_reports::record::Results;
use std::process::ExitCode;
use std::time::Duration;

/// Short runs are timed until their repeats together take this long.
const TIMED: Duration = Duration::from_millis(25);

/// Runs the study and writes its folder.
pub fn run(args: &Precision, command: &str) -> Result<ExitCode, Refusal> {
    let refused = |reason: String| {
        Refusal::from(SceneError::plain(
            reason,
            "`gearbench precision --help` shows what can be asked for",
        ))
    };
    let asked = Asked {
        integrators: args.integrators.clone(),
        metrics: match &args.metric {
            Some(text) => metrics_of(text).map_err(refused)?,
            None => Vec::new(),
        },
        against: args.against.clone(),
        modes: args.modes.iter().map(|n| *n as usize).collect(),
        steps: args.steps.clone(),
        rtols: args.rtols.clone(),
    };
    let scene = scene_file::load_for(&args.scene, Selection::Precision(args.models.as_deref()))?;
    let choices = scene.select_precision(args.models.as_deref())?;
    let reference = stored_reference(&scene)?;
    let plan = Plan::of(&scene, &choices, reference.as_ref(), &asked).map_err(refused)?;
    // What was simulated stands first, then what it was held against.
    let mut told = settings(&scene, &choices, false);
    told.retain(|(what, _)| {
        what != "integrators of the scene" && what != "converged solution (self)"
    });
    for row in told.iter_mut().filter(|(what, _)| what == "simulated time") {
        row.1 = format!("{} ms", short(plan.conditions.duration * 1e3, 4));
    }
    let plan = Plan {
        timed: TIMED,
        conditions: Conditions {
            command: command.to_string(),
            settings: [told, plan.conditions.settings].concat(),
            repeats: args.repeats,
            timeout: Duration::from_secs_f64(args.timeout),
            ..plan.conditions
        },
        ..plan
    };
    let results =
        with_progress(plan.len(), |progress| study(&plan, progress)).map_err(refuse_run)?;

    write(&results, (&args.out, &scene.name), summarise)?;
    Ok(ExitCode::SUCCESS)
}

/// The front against every reference, and who leads.
fn summarise(results: &Results) {
    let told = Told::of(results);
    for id in &told.references {
        let cloud = told.cloud(id, told.headline(), Cost::Wall);
        if cloud.shown.is_empty() {
            continue;
        }
        say(&format!("Pareto front against {id}, {}", told.headline()));
        for i in cloud.front(|_| true) {
            let s = &cloud.shown[i];
            let fitted = if s.is_fitted() { ", fitted to it" } else { "" };
            say(&format!(
                "  {:>10} %  {:>9}  {} ({}){fitted}",
                percent(s.point.error, 3),
                quantity(s.run.wall_s, "s", 3),
                family(s.run),
                rung(s.run)
            ));
        }
        for fitted_too in [false, true] {
            if fitted_too && !cloud.has_fitted() {
                continue;
            }
            let which = match (cloud.has_fitted(), fitted_too) {
                (false, _) => "cheapest within a limit",
                (true, false) => "cheapest within a limit, nothing fitted",
                (true, true) => "cheapest within a limit, fitted models included",
            };
            let lines: Vec<String> = (LEVELS.iter())
                .filter_map(|l| cloud.standing(*l, fitted_too))
                .map(|s| {
                    format!(
                        "{} {}: {}; {}",
                        s.level(),
                        s.own(),
                        s.beside_next(),
                        s.beside_other()
                    )
                })
                .collect();
            if !lines.is_empty() {
                say(&format!("{which}:\n  {}", lines.join("\n  ")));
            }
        }
    }
    let failed = (results.runs.iter())
        .filter(|r| r.status.is_failure())
        .count();
    say(&format!(
        "{} runs, {failed} of them failed and recorded as such",
        results.runs.len()
    ));
}
