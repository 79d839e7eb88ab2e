//! Charts of error over cost, on made-up runs of a former record whose front is known.

use crate::{contents, has_only_numbers, holds, written};
use gearbench_reports::store::PAGE;
use gearbench_reports::{
    Metrics, Part, RECORD, ReferenceSeries, Results, Run, Status, StudyHeader, TimeSeries,
    load_results, write_results,
};
use serde_json::json;

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
    let record = Results {
        header: StudyHeader {
            scene: "made_up".into(),
            title: "A made-up impact".into(),
            command: "gearbench precision made_up".into(),
            ..StudyHeader::default()
        },
        references: vec![ReferenceSeries {
            id: "fe".into(),
            title: "full finite elements".into(),
            source: "made up".into(),
            series: TimeSeries::default(),
            ..ReferenceSeries::default()
        }],
        runs,
        ..Results::default()
    };
    former(&record)
}

/// Reads a record as one of a former version, whose study had metrics and runs alone.
fn former(record: &Results) -> Results {
    let mut value = serde_json::to_value(record).unwrap();
    value["study"] = json!("precision");
    value["metrics"] = json!(["force_l2_aligned", "peak_force_rel"]);
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join(RECORD), value.to_string()).unwrap();
    load_results(dir.path()).unwrap()
}

#[test]
fn a_former_record_is_a_table_with_fronts() {
    let results = results();
    assert_eq!(
        (results.study_name(), results.runs.len()),
        ("precision", 14)
    );
    let Part::Tabular(table) = &results.part else {
        panic!("{:?}", results.part)
    };
    assert_eq!(table.rows.len(), 2 * 14);
    let files = written(&results);
    holds(
        &files,
        &[
            "precision.svg",
            "precision_2.svg",
            "precision.csv",
            "runs.csv",
        ],
    );
    assert_eq!(files["precision.csv"].lines().count(), 1 + 2 * 14);
    assert_eq!(files["runs.csv"].lines().count(), 1 + 14);
    let chart = &files["precision.svg"];
    // The front is named; the point at 0.5 us is as accurate as that at 1 us, and dearer.
    assert!(
        chart.contains(">trigonometric, 100 modes, 1\u{a0}\u{b5}s<"),
        "{chart}"
    );
    assert!(!chart.contains(">trigonometric, 100 modes, 500\u{a0}ns<"));
    // Models that were fitted to the reference have a front of their own.
    assert!(chart.contains("rigid (fitted to fe)") && chart.contains("front of all"));
    // Every run that ended has a point, which says what it is; the failed ones are crosses at the edge.
    assert!(chart.contains("elastic, trigonometric, 100 modes, 1\u{a0}\u{b5}s: 0.800\u{a0}%"));
    assert_eq!(chart.matches("class=\"point\"").count(), 12);
    assert_eq!(chart.matches("class=\"upright\"").count(), 2);
    assert!(files[PAGE].contains("gone at t = 2 us"));
}

#[test]
fn without_fits_there_is_one_front() {
    let mut all = results();
    all.runs.iter_mut().for_each(|r| r.fitted_to = None);
    let chart = &written(&former(&all))["precision.svg"];
    assert!(!chart.contains("fitted") && !chart.contains("front of all"));
}

#[test]
fn numbers_that_are_none_reach_no_file() {
    let dir = tempfile::tempdir().unwrap();
    let mut broken = results();
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
    write_results(dir.path(), &former(&Results::default())).unwrap();
    assert!(!contents(dir.path()).contains_key("precision.svg"));
    // Runs that all failed have no chart.
    let mut own = results();
    own.runs.iter_mut().for_each(|r| r.status = Status::Timeout);
    write_results(dir.path(), &former(&own)).unwrap();
    assert!(!contents(dir.path()).contains_key("precision.svg"));
    // Drawn again from the record it is the same to the byte.
    write_results(dir.path(), &results()).unwrap();
    let before = contents(dir.path());
    assert!(before.contains_key("precision.svg"));
    gearbench_reports::report_from(dir.path()).unwrap();
    assert_eq!(before, contents(dir.path()));
}
