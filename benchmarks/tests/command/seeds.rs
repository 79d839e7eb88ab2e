//! The examples of the publications that the models come from, within the axes and numbers that these print.

use super::Folder;
use gearbench_reports::metrics::Metric;
use gearbench_reports::record::{Results, Run};

/// The record of a command, which ends with code 0.
fn record(arguments: &str) -> Results {
    let folder = Folder::new();
    folder.ends(&format!("{arguments} --out here"), 0);
    super::as_documented(&folder.at("here"));
    gearbench_reports::load_results(&folder.at("here")).unwrap()
}

/// The run of a model, by what sets it apart from others of its kind.
fn run_of<'a>(record: &'a Results, model: &str, variant: Option<&str>) -> &'a Run {
    let of = |r: &&Run| r.model == model && r.variant.as_deref() == variant;
    let found = record.runs.iter().find(of);
    found.unwrap_or_else(|| panic!("no run of {model} {variant:?}"))
}

/// A quantity of a run.
fn metric(run: &Run, metric: Metric) -> f64 {
    let found = run.metrics.iter().find_map(|m| m.get(metric));
    found.unwrap_or_else(|| panic!("{}: no {metric:?}", run.model_label()))
}

/// Ebrahimi and Eberhard 2006, Example 1: plots of the contact force over 0.25 s end at 600 N for rigid gears, at 200 N for
/// k = 5.6e7 N/m and at 600 N for k = 3.6e9 N/m. Every peak lies in the upper half of its axis.
#[test]
fn example_1_fills_the_published_axes() {
    let record = record("compare spur_rotation --integrators dopri5@1e-6 --repeats 1");
    let peaks = [
        ("rigid", None, 600.0),
        ("movable-teeth", Some("5.6e7"), 200.0),
        ("movable-teeth", Some("3.6e9"), 600.0),
    ];
    let peaks = peaks.map(|(model, variant, axis)| {
        let run = run_of(&record, model, variant);
        let peak = metric(run, Metric::PeakForce);
        assert!(
            peak > 0.5 * axis && peak < axis,
            "{model} {variant:?}: {peak} N on an axis to {axis} N"
        );
        assert_eq!(run.simulated_s, 0.25);
        peak
    });
    // The force depends on the stiffness: soft teeth make it a third, stiff ones leave it within 10 %.
    assert!(peaks[1] < 0.4 * peaks[0], "{peaks:?}");
    assert!((peaks[2] / peaks[0] - 1.0).abs() < 0.1, "{peaks:?}");
}
