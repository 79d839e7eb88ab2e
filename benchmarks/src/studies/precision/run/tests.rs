//! Tests of the study of accuracy against cost on small scenes.

use super::*;
use crate::context::Context;
use crate::experiment::journal::{JOURNAL, Journal, Subject};
use crate::experiment::runner::Runner;
use crate::scene_file::{Selection, load_for};
use crate::studies::precision::arguments::PrecisionOptions;
use crate::studies::precision::plan::COUNTS;
use gearbench_reports::Metric;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The study of some models of a scene, with its stored reference or without.
fn plan(scene: &str, labels: &str, stored: bool, asked: &PrecisionOptions) -> Result<Plan, String> {
    let scene = load_for(&Context::default(), scene, Selection::None).unwrap();
    let choices = scene.select(Some(labels)).unwrap();
    let references = match stored {
        true => scene.clone().load_own_references(true).unwrap(),
        false => Vec::new(),
    };
    Plan::of(&scene, &choices, &references, asked)
}

/// The rigid gears of the impact, a few resolutions.
fn small(asked: &PrecisionOptions) -> Results {
    let plan = plan("spur_impact", "rigid,rigid-iso6336", true, asked).unwrap();
    let total = plan.len();
    let last = AtomicUsize::new(0);
    let progress = |done, all, _: &str| {
        assert!(done >= last.swap(done, Ordering::Relaxed) && done <= total && all == total);
    };
    let folder = tempfile::tempdir().unwrap();
    let journal = Journal::open(&folder.path().join(JOURNAL), &Subject::default(), true).unwrap();
    let results = study(&plan, &Runner::new(Context::default(), journal, &progress)).unwrap();
    assert_eq!(last.into_inner(), total);
    results
}

/// Returns the ids of the references that a model is compared with.
fn against(plan: &Plan, label: &str) -> String {
    let mut of = plan.variants.iter().filter(|v| v.entry.label == label);
    of.next().unwrap().against.join(" ")
}

#[test]
fn every_resolution_is_a_row_with_both_errors() {
    let asked = PrecisionOptions {
        integrators: Some("velocity-verlet,dopri5,rk4@1us".into()),
        steps: vec![1e-4, 2e-6, 5e-7],
        rtols: vec![1e-3, 1e-6],
        ..PrecisionOptions::default()
    };
    let results = small(&asked);
    assert_eq!(results.runs.len(), 2 * (3 + 2 + 1));
    assert!(matches!(
        &results.part,
        Part::Precision(part) if part.metrics[0] == Metric::ForceL2Aligned
    ));
    assert_eq!(results.references[0].id, "calculix");
    assert!(results.validate().is_ok());
    let of = |variant: Option<&str>, integrator: &str| -> Vec<&Run> {
        let mine = |r: &&Run| r.variant.as_deref() == variant && r.integrator == integrator;
        results.runs.iter().filter(mine).collect()
    };
    for variant in [None, Some("iso6336")] {
        // Only the fitted model states the data of its fit.
        let fitted = variant.is_none().then(|| "calculix".to_owned());
        let verlet = of(variant, "velocity-verlet");
        assert!(verlet.iter().all(|r| r.fitted_to == fitted));
        let steps: Vec<_> = verlet.iter().map(|r| r.step.unwrap()).collect();
        assert_eq!(steps, [1e-4, 2e-6, 5e-7]);
        // The integration error falls with the square of the step, the model's error stays.
        let error = |r: &Run, id: &str| r.against(id).and_then(|m| m.force_l2).unwrap();
        let ratio = error(verlet[1], "self") / error(verlet[2], "self");
        assert!((8.0..32.0).contains(&ratio), "{ratio}");
        let (coarse, fine) = (error(verlet[1], "calculix"), error(verlet[2], "calculix"));
        assert!((coarse - fine).abs() < 0.05 * fine, "{coarse} {fine}");
        assert!(error(verlet[2], "self") < 0.01 * fine);
        let adaptive = of(variant, "dopri5");
        assert!(error(adaptive[1], "self") < 1e-4);
    }
    let own = |r: &&Run| {
        r.against("calculix")
            .and_then(|m| m.force_l2_aligned)
            .unwrap()
    };
    let errors = [of(None, "dopri5"), of(Some("iso6336"), "dopri5")].map(|r| own(&r[1]));
    assert!(errors[0] < 0.06 && errors[1] > errors[0], "{errors:?}");
    // Timed more than once, and without histories.
    assert!(
        results
            .runs
            .iter()
            .all(|r| r.series.is_none() && r.contacts.is_none())
    );
}

#[test]
fn short_runs_are_repeated_until_their_times_count() {
    let asked = PrecisionOptions {
        integrators: Some("rk4@2us".into()),
        ..PrecisionOptions::default()
    };
    let mut plan = plan("spur_impact", "rigid", false, &asked).unwrap();
    plan.conditions.repeats = 2;
    // Far more than the most repeats take.
    plan.timed = std::time::Duration::from_secs(1);
    let results = study(&plan, &Runner::default()).unwrap();
    let run = &results.runs[0];
    assert!(run.repeats > 2, "{}", run.repeats);
    assert!(f64::from(run.repeats) * run.wall_spread_s.unwrap()[1] >= 0.8 || run.repeats == 300);
}

#[test]
fn a_series_ends_where_a_run_takes_too_long() {
    let asked = PrecisionOptions {
        integrators: Some("rk4".into()),
        steps: vec![1e-6, 1e-8, 1e-9, 1e-10],
        ..PrecisionOptions::default()
    };
    let mut plan = plan("spur_impact", "rigid", false, &asked).unwrap();
    plan.conditions.max_steps = 1000;
    let results = study(&plan, &Runner::default()).unwrap();
    let statuses: Vec<Status> = results.runs.iter().map(|r| r.status).collect();
    assert!(
        statuses[0].holds() && statuses[1] == Status::Timeout,
        "{statuses:?}"
    );
    let said = results.settings.iter().find(|(w, _)| w == TOO_FINE);
    assert!(
        said.is_some_and(|(_, t)| t.contains("rigid under rk4")),
        "{said:?}"
    );
}

#[test]
fn references_go_with_their_contact() {
    let all = "rigid,elastic,elastic-nodes,elastic-nodes-hard,fe";
    let impact = plan("spur_impact", all, true, &PrecisionOptions::default()).unwrap();
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
    let rack = plan("rack_pinion", all, true, &PrecisionOptions::default()).unwrap();
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
        plan("rack_pinion", all, true, &asked)
    };
    let fe = named("fe").unwrap();
    assert!(fe.variants.iter().all(|v| v.against == ["fe"]) && fe.external.is_empty());
    for (label, said) in [("elastic", "fe"), ("elastic-nodes", "fe (another contact)")] {
        let row = (format!("reference of model {label}"), said.to_owned());
        assert!(fe.conditions.settings.contains(&row), "{row:?}");
    }
    let e = named("abaqus").unwrap_err();
    assert!(e.contains("calculix") && e.contains("fe-nodes"), "{e}");
}

#[test]
fn without_finite_elements_the_densest_elastic_model_is_the_reference() {
    let scene = load_for(&Context::default(), "hammer", Selection::None).unwrap();
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
    let solution = |scheme: Scheme| Converged {
        by: ConvergedSettings {
            integrator: scheme.method.to_string(),
            step: scheme.resolution.step(),
            rtol: scheme.resolution.tolerance(),
            steps: 100,
        },
        series: TimeSeries::default(),
    };
    let of = |scheme| short_of(&solution(scheme), "the reference elastic");
    let [(finest, _), .., (coarsest, _)] = EXACT_MODES;
    assert_eq!(of(exact_for_modes(finest)), None);
    let note = of(exact_for_modes(coarsest)).unwrap();
    let words = format!("the reference elastic with {coarsest:.0e} in place of {finest:.0e}");
    assert!(note.contains(&words), "{note}");
}
