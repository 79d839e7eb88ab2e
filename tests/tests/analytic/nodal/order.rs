//! Exchanging the gears of a mesh changes nothing: both passes are the default.

use super::*;
use gearbench_integrators::Resolution;

/// Returns force and speeds at the end of an impact, by name of the gears.
fn end_of(spec: &SceneSpec, model: &ModelSpec, damping: f64, id: &str, step: f64) -> Vec<f64> {
    let points = PointContact::new(1e15).damped(damping);
    let mut scene = build(spec, &[model.clone(), model.clone()], &with_points(points));
    let outcome = run(&mut scene, id, Resolution::Step(step), 3e-5).unwrap(id);
    let mut found = vec![outcome.peak, outcome.impulse];
    for name in ["pinion", "wheel"] {
        found.push(channel(
            &mut scene,
            &outcome.state,
            &format!("speed:{name}"),
        ));
    }
    found
}

#[test]
fn the_order_of_the_gears_does_not_matter() {
    let mut spec = case_a(-1e-6);
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(20.0))];
    let mut exchanged = spec.clone();
    exchanged.gears.reverse();
    for (model, damping, id, step) in [
        (toy(13, 3, 0, 2e-9), 0.0, "trigonometric", 5e-7),
        (toy(13, 3, 12, 2e-9), 0.0, "trigonometric", 5e-7),
        (toy(13, 3, 12, 2e-9), 4e9, "trigonometric", 5e-7),
        (toy(13, 3, 12, 2e-9), 4e9, "newmark", 5e-7),
        (nodes_on_springs(9), 0.0, "newmark", 5e-7),
        (nodes_on_springs(9), 4e9, "newmark", 5e-7),
    ] {
        let (a, b) = (
            end_of(&spec, &model, damping, id, step),
            end_of(&exchanged, &model, damping, id, step),
        );
        for (x, y) in a.iter().zip(&b) {
            assert!(
                (x - y).abs() <= 1e-9 * x.abs(),
                "{} {id}: {a:?} {b:?}",
                model.id()
            );
        }
    }
}
