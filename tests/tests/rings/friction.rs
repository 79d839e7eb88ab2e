//! Friction on internal flanks: an elastic pair that runs under load loses what rigid gears lose on the path of contact.

use super::*;
use gearbench_integrators::Resolution;
use gearbench_models::law::Friction;
use gearbench_models::spec::{Load, Profile};
use gearbench_tests::{rigid, run};

/// Returns a pair for some mesh cycles in equilibrium of its loads.
fn loaded() -> SceneSpec {
    let mut spec = pair(0.0);
    let ratio = 22.0 / 61.0;
    for (g, [speed, torque]) in
        (spec.gears.iter_mut()).zip([[400.0, 100.0], [400.0 * ratio, -100.0 / ratio]])
    {
        g.speed = speed;
        g.loads = vec![Load::Applied(Profile::Constant(torque))];
    }
    spec
}

#[test]
fn an_elastic_ring_loses_what_a_rigid_one_loses() {
    let rubbing = |contact: ContactSpec| ContactSpec {
        friction: Some(Friction::new(0.05, 0.02).unwrap()),
        ..contact
    };
    let end = 2e-3;
    let mut lost = Vec::new();
    for (name, model, contact) in [
        ("rigid", rigid(), contact(1.5e10)),
        (
            "points",
            elastic([8.0, 1.0], 20.0),
            touching(PointContact::new(1e15), None),
        ),
        (
            "half-spaces",
            elastic([8.0, 1.0], 20.0),
            touching(FlankContact::HalfSpace, Some(1)),
        ),
    ] {
        let spec = loaded();
        let mut scene = built(&spec, &model, &rubbing(contact));
        let out = run(&mut scene, "dopri5", Resolution::Tolerance(1e-7), end).unwrap(name);
        let ledger = &out.ledger;
        let off = ledger.residual() / ledger.dissipated;
        println!(
            "{name}: {:.4} J lost of {:.2} J that the pinion passed on, {off:.1e} of it unexplained",
            ledger.dissipated,
            100.0 * 400.0 * end
        );
        assert!(off.abs() < 1e-3, "{name}: {off:.1e}");
        lost.push(ledger.dissipated);
    }
    assert!(
        lost[0] > 0.0 && lost.iter().all(|x| (x / lost[0] - 1.0).abs() < 0.1),
        "{lost:?}"
    );
}
