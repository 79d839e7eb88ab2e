//! Tests of the plan of the study, and of what it leaves out.

use super::arguments::{Precision, PrecisionOptions};
use super::converged::short_of;
use super::plan::{COUNTS, External, Plan};
use super::study::{Resolution, TOO_FINE};
use crate::cli::study_command::StudyCommand;
use crate::cli::{Cli, Command};
use crate::context::Context;
use crate::experiment::converged::exact_for_modes;
use crate::experiment::reference_series::recorded;
use crate::scene_file::{SceneFile, Selection, load_for};
use crate::studies::tabular::{Cell, Measured, TabularStudy};
use clap::Parser;
use gearbench_integrators::Scheme;
use gearbench_reports::Metric;
use gearbench_reports::record::{ConvergedSettings, Metrics, ReferenceSeries, Run, SELF, Status};

fn scene(name: &str) -> SceneFile {
    load_for(&Context::default(), name, Selection::None).unwrap()
}

/// The plan for some models of a scene with its stored references.
fn plan(name: &str, labels: &str, asked: &PrecisionOptions) -> Result<Plan, String> {
    let scene = scene(name);
    let choices = scene.select(Some(labels)).unwrap();
    let references = scene.clone().load_own_references(true).unwrap();
    let references = references.iter().map(|r| recorded(r, &scene.spec));
    let references: Vec<ReferenceSeries> = references.collect();
    Plan::of(&scene, &choices, &references, asked)
}

/// Returns the ids of the references that a model is compared with.
fn against(plan: &Plan, label: &str) -> String {
    let mut of = plan.variants.iter().filter(|v| v.entry.label == label);
    of.next().unwrap().against.join(" ")
}

/// The study of rigid gears under methods of Runge and Kutta.
fn rigid() -> (Precision, Vec<Cell<Resolution>>) {
    let command = "gearbench precision spur_impact --models rigid --integrators rk4,dopri5 --steps 1us,100ns,10ns --rtols 1e-3,1e-5";
    let cli = Cli::try_parse_from(command.split(' ')).unwrap();
    let Some(Command::Study(StudyCommand::Precision(mut study))) = cli.command else {
        panic!("{command}")
    };
    let mut scene = scene("spur_impact");
    study.prepare(&mut scene, &[]).unwrap();
    let cells = study.cells(&scene).unwrap();
    (study, cells)
}

#[test]
fn a_series_ends_where_a_run_takes_too_long() {
    let (study, cells) = rigid();
    let described = |cells: &[&Cell<Resolution>]| -> Vec<String> {
        cells.iter().map(|c| c.name.clone()).collect()
    };
    assert_eq!(cells.len(), 5);
    let rows = |status: Status| {
        let run = Run {
            status,
            ..Run::default()
        };
        [Measured {
            cell: cells[1].clone(),
            run,
            row: Vec::new(),
        }]
    };
    let left_out = |rows: &[Measured<Precision>]| -> Vec<&Cell<Resolution>> {
        let later = cells.iter().skip(2);
        later
            .filter(|c| study.leaves_out(c, rows).is_some())
            .collect()
    };
    assert_eq!(described(&left_out(&rows(Status::BlowUp))), [""; 0]);
    // The finest step is left out, tolerances of another method are not.
    assert_eq!(
        described(&left_out(&rows(Status::Timeout))),
        [cells[2].name.as_str()]
    );
    let (what, text) = study.leaves_out(&cells[2], &rows(Status::Timeout)).unwrap();
    assert_eq!(
        (what, text.as_str()),
        (TOO_FINE, "rigid under rk4, finer steps")
    );
}

/// A run that is close to the reference, but not to its own converged solution, has not the accuracy of its model.
#[test]
fn errors_that_cancel_are_not_counted() {
    let (mut study, cells) = rigid();
    study.plan.metrics = vec![Metric::ForceL2];
    // Errors against the reference and of integration, and the cost; the first two runs are close by chance.
    let runs = [(0.004, 0.03, 1.0), (0.04, 0.06, 2.0), (0.03, 0.002, 3.0)];
    let rows: Vec<Measured<Precision>> = (cells.iter().zip(runs))
        .map(|(cell, (error, integration, cost))| {
            let metrics = |against: &str, error: f64| Metrics {
                against: against.into(),
                force_l2: Some(error),
                ..Metrics::default()
            };
            Measured {
                cell: cell.clone(),
                run: Run {
                    status: Status::Converged,
                    model: "rigid".into(),
                    integrator: cell.name.clone(),
                    wall_s: cost,
                    cpu_s: cost,
                    metrics: vec![metrics("calculix", error), metrics(SELF, integration)],
                    ..Run::default()
                },
                row: Vec::new(),
            }
        })
        .collect();
    let rows: Vec<&Measured<Precision>> = rows.iter().collect();
    let said = |study: &Precision| study.sentences(&rows).join(" ").replace('\u{a0}', " ");
    let name = |i: usize| format!("rigid under {} (", cells[i].name);
    study.plan.external = vec![External {
        id: "calculix".into(),
        own_error: None,
    }];
    let text = said(&study);
    assert!(
        text.contains("calculix, whose own error is not stated,"),
        "{text}"
    );
    assert!(text.contains(&format!("within 5 % {}", name(0))), "{text}");
    assert!(text.contains("within 1 % nothing"), "{text}");
    assert!(
        text.contains("One run is closer to calculix than 1 %"),
        "{text}"
    );
    // With an own error of 2.5 % the third run may be 5.5 % off, the first 2.9 %; of 1 % nothing is decided.
    study.plan.external[0].own_error = Some(0.025);
    let text = said(&study);
    assert!(text.contains("own error is stated as 2.5 %"), "{text}");
    assert!(text.contains("within 1 % nothing is decided"), "{text}");
    let tables = study.tables(&rows);
    let cheapest = (tables.iter()).find(|t| t.title.starts_with("Cheapest run of each"));
    assert!(cheapest.is_some_and(|t| {
        t.remark
            .replace('\u{a0}', " ")
            .contains("own error of the reference of 2.5 %")
    }));
}

#[test]
fn references_go_with_their_contact() {
    let all = "rigid,elastic,elastic-nodes,elastic-nodes-hard,fe";
    let impact = plan("spur_impact", all, &PrecisionOptions::default()).unwrap();
    for label in ["rigid", "elastic", "elastic-nodes"] {
        assert_eq!(against(&impact, label), "calculix calculix-one-mesh fe");
    }
    assert_eq!(against(&impact, "elastic-nodes-hard"), "");
    let counts: Vec<_> = (impact.variants.iter())
        .filter(|v| v.entry.label == "elastic")
        .map(|v| v.modes.unwrap())
        .collect();
    assert_eq!(counts, COUNTS);

    // The rack has two contacts that have nothing to do with each other.
    let all = "elastic-nodes,elastic,rigid,fe,fe-nodes";
    let rack = plan("rack_pinion", all, &PrecisionOptions::default()).unwrap();
    assert_eq!(against(&rack, "elastic-nodes"), "fe-nodes");
    assert_eq!(against(&rack, "elastic"), "calculix fe");
    assert_eq!(against(&rack, "rigid"), "calculix fe");

    // A reference named on the command line applies to all models; the settings state where its contact differs.
    let named = |id: &str| {
        let against = vec![id.to_owned()];
        let asked = PrecisionOptions {
            against,
            ..PrecisionOptions::default()
        };
        plan("rack_pinion", all, &asked)
    };
    let fe = named("fe").unwrap();
    assert!(fe.variants.iter().all(|v| v.against == ["fe"]) && fe.external.is_empty());
    for (label, said) in [("elastic", "fe"), ("elastic-nodes", "fe (another contact)")] {
        let row = (format!("reference of model {label}"), said.to_owned());
        assert!(fe.settings.contains(&row), "{row:?}");
    }
    let e = named("abaqus").unwrap_err();
    assert!(e.contains("calculix") && e.contains("fe-nodes"), "{e}");
}

#[test]
fn without_finite_elements_the_densest_elastic_model_is_the_reference() {
    let scene = scene("hammer");
    let choices = scene.select(None).unwrap();
    let plan_of =
        |choices: &[_]| Plan::of(&scene, choices, &[], &PrecisionOptions::default()).unwrap();
    let plan = plan_of(&choices);
    let ids: Vec<_> = plan.fulls.iter().map(|f| f.id.as_str()).collect();
    assert_eq!(ids, ["elastic"]);
    let most = plan.variants.iter().filter_map(|v| v.modes).max().unwrap();
    assert!(plan.fulls[0].title.contains(&format!("{most} modes")));
    assert!(plan.variants.iter().all(|v| v.against == ["elastic"]));
    // Rigid gears without a reference are compared with their own converged solution only.
    let plan = plan_of(&scene.select(Some("rigid")).unwrap());
    assert!(plan.fulls.is_empty() && plan.variants.iter().all(|v| v.against.is_empty()));
}

/// A solution that is coarser than the finest tolerance for gears with modes is named with both.
#[test]
fn a_coarse_solution_is_named() {
    let of = |scheme: Scheme| {
        short_of(&ConvergedSettings {
            integrator: scheme.method.to_string(),
            step: scheme.resolution.step(),
            rtol: scheme.resolution.tolerance(),
            steps: 100,
        })
    };
    assert_eq!(of(exact_for_modes(1e-6)), None);
    assert_eq!(
        of(exact_for_modes(1e-3)).as_deref(),
        Some("1e-3 in place of 1e-6")
    );
}
