//! `gearbench compare SCENE`.

use super::arguments::Compare;
use super::{Plan, compare};
use crate::cli::terminal::{
    Refusal, exit_code, refuse_run, say, stored_reference, with_progress, write,
};
use crate::experiment::conditions::Conditions;
use crate::experiment::run::{LEFT_OUT, RunError};
use crate::experiment::settings::settings;
use crate::scene_file::{self, Selection};
use gearbench_integrators::Scheme;
use gearbench_reports::numbers::short;
use gearbench_reports::record::{Results, Status};

use std::process::ExitCode;
use std::time::Duration;

/// Runs the comparison and writes its folder.
pub fn run(args: &Compare, command: &str) -> Result<ExitCode, Refusal> {
    let scene = scene_file::load_for(&args.scene, Selection::Labels(args.models.as_deref()))?;
    let choices = scene.select(args.models.as_deref())?;
    let reference = stored_reference(&scene)?;
    let plan = Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: settings(&scene, &choices, args.no_events),
            repeats: args.repeats.max(1),
            events: scene.study.events && !args.no_events,
            timeout: Duration::from_secs_f64(args.timeout),
            ..Conditions::of(&scene)
        },
        ..Plan::of(&scene, &choices, reference.as_ref())
    };
    let plan = match &args.integrators {
        // What the command line asks for goes for all models.
        Some(text) => plan.with_methods(
            Scheme::list(text, &scene.study.integrators)
                .map_err(RunError::from)
                .map_err(refuse_run)?,
        ),
        None => plan,
    };
    let results =
        with_progress(plan.len(), |progress| compare(&plan, progress)).map_err(refuse_run)?;

    write(&results, (&args.out, &scene.name), summarise)?;
    Ok(exit_code(&results))
}

/// One line per run, failures with their reason.
fn summarise(results: &Results) {
    let against = results.references.first().map_or("self", |r| r.id.as_str());
    say(&format!(
        "{:<24} {:<30} {:>9} {:>9} {:>8}  force error against {against}",
        "model", "integrator", "step/rtol", "wall", "steps"
    ));
    for r in &results.runs {
        let resolution = r
            .step
            .or(r.rtol)
            .map_or(String::new(), |x| format!("{x:.0e}"));
        let wall = if r.wall_s < 1e-3 {
            format!("{:.0} us", r.wall_s * 1e6)
        } else if r.wall_s < 1.0 {
            format!("{:.1} ms", r.wall_s * 1e3)
        } else {
            format!("{:.2} s", r.wall_s)
        };
        let outcome = match (
            r.status,
            r.against(against).and_then(|m| m.force_l2_aligned),
        ) {
            (Status::Converged, Some(e)) => format!("{} %", short(100.0 * e, 3)),
            (Status::Converged, None) => "converged".into(),
            (status, _) => format!(
                "{status}: {}",
                r.message.as_deref().unwrap_or("no reason given")
            ),
        };
        say(&format!(
            "{:<24} {:<30} {:>9} {:>9} {:>8}  {}",
            r.model_label(),
            r.integrator,
            resolution,
            wall,
            r.steps,
            outcome
        ));
    }
    for (what, pair) in results.settings.iter().filter(|(what, _)| what == LEFT_OUT) {
        say(&format!("{what}: {pair}"));
    }
    let failed = results
        .runs
        .iter()
        .filter(|r| r.status.is_failure())
        .count();
    if failed > 0 {
        say(&format!(
            "{failed} of {} runs failed; they are recorded as failures",
            results.runs.len()
        ));
    }
}
