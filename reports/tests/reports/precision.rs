//! The report of accuracy against cost, on made-up runs whose front is known.

use crate::{contents, finding, has_only_numbers, holds, written};
use gearbench_reports::precision::{Cost, Precision, PrecisionRecord};
use gearbench_reports::store::PAGE;
use gearbench_reports::{
    Metric, Metrics, Part, ReferenceSeries, Results, Run, Status, StudyHeader, TimeSeries,
    load_results, write_results,
};

/// Makes a run from model, integrator, step, wall time [ms], and errors against the reference and its own solution [%].
fn run(model: &str, integrator: &str, step: f64, wall_ms: f64, error: f64, own: f64) -> Run {
    let metrics = |against: &str, percent: f64| Metrics {
        force_l2_aligned: Some(0.01 * percent),
        peak_force_rel: Some(-0.005 * percent),
        energy_drift_rel: Some(0.0),
        against: against.into(),
        ..Metrics::default()
    };
    let wall_s = 1e-3 * wall_ms;
    Run {
        model: model.into(),
        integrator: integrator.into(),
        implicit: integrator == "newmark",
        exact_linear: integrator == "trigonometric",
        step: Some(step),
        wall_s,
        wall_spread_s: Some([0.9 * wall_s, 1.2 * wall_s]),
        repeats: 9,
        setup_s: 0.01,
        simulated_s: 1.6e-4,
        steps: (1.6e-4 / step) as u64,
        force_evaluations: (1.6e-4 / step) as u64,
        dofs: 2,
        metrics: vec![metrics("fe", error), metrics("self", own)],
        ..Run::default()
    }
}

fn part() -> PrecisionRecord {
    PrecisionRecord {
        metrics: vec![Metric::ForceL2Aligned, Metric::PeakForceRel],
    }
}

/// Makes a record of three families and a fitted one, whose common front is known by construction.
pub fn results() -> Results {
    let mut runs = Vec::new();
    for (step, wall, error) in [(4e-6, 0.005, 14.0), (1e-6, 0.02, 4.0), (5e-7, 0.04, 4.1)] {
        let mut r = run(
            "rigid",
            "velocity-verlet",
            step,
            wall,
            error,
            1e11 * step * step * 1e2,
        );
        r.fitted_to = Some("fe".into());
        runs.push(r);
    }
    for (step, wall, error) in [(4e-6, 0.005, 22.0), (1e-6, 0.02, 19.0)] {
        runs.push(run(
            "rigid-iso",
            "rk4",
            step,
            wall,
            error,
            3e11 * step * step,
        ));
    }
    for (modes, step, wall, error) in [
        (35, 2e-6, 0.4, 2.6),
        (100, 2e-6, 0.6, 1.2),
        (100, 1e-6, 1.0, 0.8),
        (100, 5e-7, 2.0, 0.8),
    ] {
        let mut r = run(
            "elastic",
            "trigonometric",
            step,
            wall,
            error,
            1e11 * step * step,
        );
        r.modes = Some(modes);
        r.residual = Some(true);
        runs.push(r);
    }
    let mut slow = run("elastic", "velocity-verlet", 1e-7, 10.0, 0.9, 0.05);
    slow.modes = Some(100);
    slow.residual = Some(true);
    runs.push(slow);
    runs.push(run("fe", "newmark", 1e-6, 800.0, 1.1, 1.0));
    runs.push(run("fe", "newmark", 5e-7, 1600.0, 0.2, 0.2));
    // Failures look cheap and accurate.
    for (status, message) in [
        (Status::BlowUp, "gone at t = 2 us"),
        (Status::Timeout, "too long"),
    ] {
        let mut r = run("rigid-iso", "rk4", 1e-4, 1e-4, 1e-3, 1e-3);
        r.status = status;
        r.message = Some(message.into());
        runs.push(r);
    }
    Results {
        header: StudyHeader {
            scene: "made_up".into(),
            title: "A made-up impact".into(),
            command: "gearbench precision made_up".into(),
            ..StudyHeader::default()
        },
        part: Part::Precision(part()),
        references: vec![ReferenceSeries {
            id: "fe".into(),
            title: "full finite elements".into(),
            source: "made up".into(),
            series: TimeSeries::default(),
            ..ReferenceSeries::default()
        }],
        runs,
        ..Results::default()
    }
}

#[test]
fn files_and_finding() {
    let files = written(&results());
    holds(
        &files,
        &[
            "precision_model.svg",
            "precision_integration.svg",
            "precision_families.svg",
            "precision_work.svg",
            "precision_metric_2.svg",
            "precision.csv",
        ],
    );
    let text = finding(&files[PAGE]);
    // What is named was not fitted; the fit is named as one, with the error that it leaves.
    assert!(text.contains("among what was not fitted to it"), "{text}");
    assert!(text.contains("within 1\u{a0}% <b>elastic</b>"), "{text}");
    assert!(
        text.contains("Rigid was fitted to this very history: down to 4.00"),
        "{text}"
    );
    assert!(
        text.contains("the rest of a fit, not a prediction"),
        "{text}"
    );
    // 1 % costs 1 ms; elastic under Verlet keeps it in 10 ms, fe needs 1600.
    assert!(
        files[PAGE].contains("\u{d7} 10 faster than elastic under velocity-verlet"),
        "{}",
        files[PAGE]
    );
    assert!(text.contains("2 of 14 runs failed"), "{text}");
    let csv = &files["precision.csv"];
    assert_eq!(csv.lines().count(), 1 + 2 * 14);
    let on_front = csv.lines().filter(|l| l.contains(",fe,true,")).count();
    assert_eq!(on_front, 2 + 3 + 1, "{csv}");
}

#[test]
fn failures_are_on_their_edge_and_nowhere_else() {
    let files = written(&results());
    for chart in ["precision_model.svg", "precision_work.svg"] {
        for reason in ["blow-up (1)", "timeout (1)"] {
            assert!(files[chart].contains(reason), "{reason} in {chart}");
        }
    }
    assert!(files[PAGE].contains("gone at t = 2 us"));
    let results = results();
    let study = Precision::of(&results);
    let cloud = study.cloud("fe", study.headline(), Cost::Processor);
    assert_eq!((cloud.shown.len(), cloud.failed.len()), (12, 2));
    assert!(
        cloud
            .front(|_| true)
            .iter()
            .all(|i| !cloud.shown[*i].run.status.is_failure())
    );
}

#[test]
fn fitted_models_are_marked_and_set_apart() {
    let dir = tempfile::tempdir().unwrap();
    write_results(dir.path(), &results()).unwrap();
    let files = contents(dir.path());
    let chart = &files["precision_model.svg"];
    assert!(chart.contains("rigid (fitted)"));
    // One table shows the leading run; the effect of fits has rows of its own.
    let lead = files[PAGE].split("Residual compliance against").nth(1);
    let lead = lead.and_then(|t| t.split("</section>").next()).unwrap();
    assert!(
        lead.contains("nothing fitted") && lead.contains("fits included"),
        "{lead}"
    );
    assert!(lead.contains("\u{d7} 10 faster"), "{lead}");
    let results = results();
    let study = Precision::of(&results);
    let cloud = study.cloud("fe", study.headline(), Cost::Processor);
    let names = |fitted_too: bool| -> Vec<&str> {
        let front = cloud.front(|s| fitted_too || !s.is_fitted());
        front
            .iter()
            .map(|i| cloud.shown[*i].run.model.as_str())
            .collect()
    };
    assert_eq!(
        names(true),
        ["rigid", "rigid", "elastic", "elastic", "elastic", "fe"]
    );
    assert_eq!(
        names(false),
        [
            "rigid-iso",
            "rigid-iso",
            "elastic",
            "elastic",
            "elastic",
            "fe"
        ]
    );
    let without = Results {
        runs: results
            .runs
            .iter()
            .filter(|r| r.fitted_to.is_none())
            .cloned()
            .collect(),
        ..results.clone()
    };
    assert!(!written(&without)["precision_model.svg"].contains("fitted"));
}

#[test]
fn numbers_that_are_none_reach_no_file() {
    let dir = tempfile::tempdir().unwrap();
    let mut broken = results();
    broken.runs[0].metrics[0].force_l2_aligned = Some(f64::NAN);
    broken.runs[1].metrics[0].force_l2_aligned = Some(f64::INFINITY);
    broken.runs[3].wall_s = f64::NAN;
    broken.runs[4].wall_s = f64::INFINITY;
    broken.runs[5].wall_spread_s = Some([f64::NAN, 1.0]);
    broken.runs[6].metrics[1].force_l2_aligned = Some(0.0);
    broken.runs[7].metrics.clear();
    write_results(dir.path(), &broken).unwrap();
    has_only_numbers(&contents(dir.path()));
    assert_eq!(
        load_results(dir.path()).unwrap().runs.len(),
        broken.runs.len()
    );
}

#[test]
fn bare_records_make_a_page() {
    let dir = tempfile::tempdir().unwrap();
    let bare = Results {
        part: Part::Precision(part()),
        ..Results::default()
    };
    write_results(dir.path(), &bare).unwrap();
    // Without a reference there is the integration error alone.
    let mut own = results();
    own.references.clear();
    for r in &mut own.runs {
        r.metrics.retain(|m| m.against == "self");
    }
    write_results(dir.path(), &own).unwrap();
    let files = contents(dir.path());
    assert!(!files.contains_key("precision_model.svg"));
    assert!(
        files.contains_key("precision_integration.svg") && files.contains_key("precision_work.svg")
    );
    assert!(finding(&files[PAGE]).contains("No run is compared with a reference"));
    for r in &mut own.runs {
        r.status = Status::Timeout;
    }
    write_results(dir.path(), &own).unwrap();
    assert!(!contents(dir.path()).contains_key("precision_integration.svg"));
    // Drawn again from the record it is the same to the byte.
    let before = contents(dir.path());
    gearbench_reports::report_from(dir.path()).unwrap();
    assert_eq!(before, contents(dir.path()));
}
