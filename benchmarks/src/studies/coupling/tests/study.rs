//! Tests of the study of coupling: labels, refined limits, truncated models, default steps, refusals.

use super::rigid;
use crate::cli::study_command::StudyCommand;
use crate::cli::{Cli, Command};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::runner::Runner;
use crate::models::models;
use crate::scene_file::{Origin, SceneFile};
use crate::studies::coupling::frames::{HostError, frames};
use crate::studies::coupling::study::{WHOLE, default_steps, keeps_residual, truncated};
use crate::studies::tabular::{self, TabularStudy};
use crate::studies::test_scene::coarse;
use clap::Parser;
use gearbench_integrators::table::RK4;
use gearbench_integrators::{Resolution, Scheme};
use gearbench_models::scene::Scene;
use gearbench_reports::record::{Part, Results, Status};
use serde::Deserialize;

/// The study of one model by its command line.
fn study(file: &SceneFile, options: &str) -> Results {
    let all = ["gearbench", "coupling", "own.toml"].into_iter();
    let parsed = Cli::try_parse_from(all.chain(options.split_whitespace())).expect("arguments");
    let Some(Command::Study(StudyCommand::Coupling(args))) = parsed.command else {
        panic!("no coupling");
    };
    let cells = args.cells(file).unwrap_or_else(|_| panic!("cells"));
    let conditions = Conditions::of(file);
    tabular::study(
        &args,
        &conditions,
        (file, Vec::new()),
        cells,
        &Runner::default(),
    )
    .expect("a record")
}

/// A row of the table.
#[derive(Deserialize)]
struct Row {
    manner: Option<String>,
    communication_step_s: Option<f64>,
    status: Status,
    force_l2: Option<f64>,
    energy_error_j: Option<f64>,
    energy_error_rel: Option<f64>,
    theory_step_s: Option<f64>,
    message: Option<String>,
}

#[test]
fn a_study_labels_its_runs() {
    let file = rigid(400.0);
    let options =
        "--steps 1e-6:5e-5:2 --extrapolations linear,quadratic --integrator rk4@2.5e-7 --threads";
    let results = study(&file, &format!("{options} 2"));
    let Part::Tabular(table) = &results.part else {
        panic!("{:?}", results.part)
    };
    let rows: Vec<Row> = table.rows_as().unwrap();
    assert!(results.runs[0].against(WHOLE).is_some() && rows[0].status.holds());
    assert!(rows[0].communication_step_s.is_none() && rows[0].force_l2.is_none());
    let energy = |r: &Row| r.energy_error_j.unwrap() / r.energy_error_rel.unwrap();
    for manner in ["linear", "quadratic"] {
        let of = |r: &&Row| r.manner.as_deref() == Some(manner);
        let all: Vec<&Row> = rows.iter().filter(of).collect();
        let (small, large) = (all[0], all[all.len() - 1]);
        assert_eq!(small.communication_step_s, Some(1e-6));
        assert_eq!(small.status, Status::Converged);
        assert!(small.force_l2.unwrap() < 0.01 && small.energy_error_rel.unwrap().abs() < 0.01);
        // Beyond theory hubs and teeth drive each other apart.
        assert!(small.theory_step_s.unwrap() < 5e-5 && large.status.is_failure());
        assert_eq!(large.communication_step_s, Some(5e-5));
        assert!(large.message.is_some());
        // Closed in on.
        let failed = all.iter().position(|r| r.status.is_failure()).unwrap();
        let [held, failed] = [failed - 1, failed].map(|i| all[i].communication_step_s.unwrap());
        assert!(failed < 1.06 * held && all.len() > 4, "{held} {failed}");
        let scale = energy(small) / energy(all[1]);
        assert!((scale - 1.0).abs() < 1e-12, "{scale}");
    }
    let limits = &table.summaries[0];
    assert_eq!(limits.rows.len(), 2);
    assert!(
        table.finding[0].contains("rigid up to"),
        "{:?}",
        table.finding
    );
    // The result does not depend on the number of threads.
    let again = study(&file, &format!("{options} 1"));
    assert_eq!(again.part, results.part);
}

#[test]
fn a_twin_by_plain_truncation_has_the_lowest_modes_alone() {
    let file = coarse(&[("modes", 12.0.into())]);
    let of = Configuration::of(&file, &file.models[0]);
    let twin = truncated(&of);
    assert_eq!(
        (keeps_residual(&of), keeps_residual(&twin)),
        (Some(true), Some(false))
    );
    assert_eq!(twin.label, "elastic-truncated");
    assert_eq!(twin.variant().as_deref(), Some("truncated"));
}

#[test]
fn usual_steps_double_from_that_of_the_gears() {
    let steps = default_steps(&RK4.at_step(1e-6), Some([1e5, 0.0]), 1.0);
    assert!(steps.windows(2).all(|h| h[1] == 2.0 * h[0]) && steps[0] == 1e-6);
    assert!((2e-5..8e-5).contains(steps.last().unwrap()));
    // Never longer than a run, and there is always one.
    let short = default_steps(&RK4.at_step(1e-3), None, 1e-4);
    assert!(short.iter().all(|h| *h <= 1e-4) && !short.is_empty());
    let adaptive = Scheme {
        method: RK4,
        resolution: Resolution::Tolerance(1e-6),
    };
    assert!(default_steps(&adaptive, None, 1e-3).len() > 5);
}

#[test]
fn scenes_that_a_host_cannot_have_are_refused() {
    let held = rigid(0.0)
        .text()
        .replace("teeth = 20", "teeth = 20\nmount = \"fixed\"");
    let held = held.replace("teeth = 30", "teeth = 30\nmount = \"fixed\"");
    let file = SceneFile::unbuilt(
        &Context::default(),
        "own.toml",
        &held,
        Origin::Shipped,
        false,
    )
    .expect("a scene");
    let entry = Configuration::of(&file, &file.models[0]);
    let mut scene = Scene::build(&entry.scene, &entry.modelling, models()).expect("a model");
    assert_eq!(
        frames(&entry.scene, &mut scene).unwrap_err(),
        HostError::NoneFree
    );
    assert!(!HostError::NoneFree.help().is_empty());
}
