//! Reading of the table `[study] precision`.

use super::{changed, parse};
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
