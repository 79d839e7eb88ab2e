//! `[study] precision`: what is read, and what is refused at which line.

use super::{changed, parse, refused};
use gearbench_integrators::table::RK4;
use gearbench_reports::Metric;

#[test]
fn values_and_defaults() {
    let none = parse(&changed("title", "title")).unwrap();
    assert_eq!(none.study.precision, Default::default());
    let text = "[study]\nprecision = { models = [\"rigid\"], integrators = [{ method = \"rk4\", step_s = 2e-6 }], \
                modes = [0, 35], factors = [4, 0.5], rtols = [1e-3], metrics = [\"peak\", \"force-aligned\"], duration_s = 5e-5 }";
    let scene = parse(&changed("[study]", text)).unwrap();
    let p = &scene.study.precision;
    assert_eq!(p.models, ["rigid"]);
    let rk4 = RK4.at_step(2e-6);
    assert_eq!(p.integrators, [rk4]);
    assert_eq!(
        (p.modes.as_slice(), p.factors.as_slice()),
        (&[0, 35][..], &[4.0, 0.5][..])
    );
    assert_eq!((p.rtols.as_slice(), p.duration), (&[1e-3][..], Some(5e-5)));
    assert_eq!(p.metrics, [Metric::PeakForceRel, Metric::ForceL2Aligned]);
    let labels = |choices: Vec<&crate::scene_file::ModelChoice>| -> Vec<String> {
        choices.iter().map(|c| c.label.clone()).collect()
    };
    assert_eq!(labels(scene.select_precision(None).unwrap()), ["rigid"]);
    let asked = scene.select_precision(Some("movable-teeth")).unwrap();
    assert_eq!(labels(asked), ["movable-teeth"]);
    assert_eq!(
        labels(none.select_precision(None).unwrap()),
        ["rigid", "movable-teeth"]
    );
}

#[test]
fn refusals() {
    let of = |inside: &str, words: &[&str]| {
        let text = format!("[study]\nprecision = {{ {inside} }}");
        refused("[study]", &text, 36, words);
    };
    of("stepps = [1]", &["unknown key `stepps`", "steps_s"]);
    of("models = [\"rigd\"]", &["rigd", "rigid"]);
    of("modes = [10, -1]", &["-1", "whole number"]);
    of("modes = [10, 5000]", &["`modes` holds 5000", "0 to 2000"]);
    of("modes = 10", &["`modes`"]);
    of("factors = [1.0, 0]", &["`factors` holds 0", "more than 0"]);
    of("steps_s = [-1e-6]", &["`steps_s` holds", "more than 0"]);
    of("rtols = [1e-3, 2.0]", &["`rtols` holds 2", "less than 1"]);
    of("rtols = []", &["is empty"]);
    of("metrics = [\"farce\"]", &["farce", "force"]);
    of("duration_s = 0", &["`duration_s` is 0", "more than 0"]);
    of(
        "integrators = [{ method = \"rk4\", rtol = 1e-3 }]",
        &["rk4 has fixed steps"],
    );
    of(
        "factors = [1.0], steps_s = [1e-6]",
        &["steps are given twice", "give one"],
    );
}
