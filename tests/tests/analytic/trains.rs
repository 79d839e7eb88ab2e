//! Trains of three gears: statics, motion under load.

use gearbench_integrators::{Coeffs, Events, Resolution, SecondOrderSystem, State, TimePlan};
use gearbench_models::geometry::Side;
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    ContactSpec, Load, ModelSpec, Mount, Profile, SceneSpec, effective_radius,
};
use gearbench_tests::*;

/// Settles a damped scene in static equilibrium, by Newton's method with a small mass, which fixed rigid gears permit.
fn settle(scene: &mut Scene) -> State {
    let mut s = scene.initial();
    s.v.fill(0.0);
    scene.begin(&mut s, false);
    for _ in 0..200 {
        let mut f = vec![0.0; s.q.len()];
        scene.force(s.at(), &mut f);
        scene
            .correct(
                s.at(),
                Coeffs {
                    m: 1e4,
                    d: 0.0,
                    k: 1.0,
                },
                &mut f,
            )
            .unwrap();
        s.q.iter_mut().zip(&f).for_each(|(q, d)| *q += d);
    }
    s
}

/// Returns first gear, idler and last gear; `side` is the flank of the idler on the last gear.
fn train(models: [ModelSpec; 3], mounts: [Mount; 3], torques: [f64; 2], side: Side) -> Scene {
    let [first_torque, idler_torque] = torques;
    let mut first = gear("first", spur(20), 0.0, 0.0);
    first.loads = vec![Load::Applied(Profile::Constant(first_torque))];
    let mut idler = gear("idler", spur(30), 0.1001, 0.0);
    idler.loads = vec![Load::Applied(Profile::Constant(idler_torque))];
    let mut last = gear("last", spur(24), 0.1001, 0.0);
    last.position = [0.1001, 0.1081, 0.0];
    let mut gears = vec![first, idler, last];
    for (g, mount) in gears.iter_mut().zip(mounts) {
        g.mount = mount;
    }
    let meshes = vec![
        mesh([0, 1], start(Side::Left, -1e-7)),
        mesh([1, 2], start(side, -1e-7)),
    ];
    let spec = SceneSpec {
        duration: f64::INFINITY,
        gears,
        meshes,
        shafts: vec![],
        stages: Vec::new(),
    };
    build(&spec, &models, &contact(2e10))
}

#[test]
fn torques_pass_a_train_with_the_ratio_of_its_ends() {
    let held = [Mount::Revolute, Mount::Revolute, Mount::Fixed];
    for models in [
        [rigid(), rigid(), rigid()],
        [rigid(), web(0.0), rigid()],
        [movable(5e8, 2e-3, 0.0), movable(5e8, 2e-3, 0.0), rigid()],
    ] {
        let id = models[1].id();
        let mut scene = train(models, held.clone(), [30.0, 0.0], Side::Right);
        let s = settle(&mut scene);
        let t = ["first", "idler", "last"]
            .map(|n| channel(&mut scene, &s, &format!("contact_torque:{n}")));
        assert!((t[0] + 30.0).abs() < 1e-8, "{id}: {t:?}");
        assert!(t[1].abs() < 1e-8, "{id}: the idler is not balanced, {t:?}");
        // Three gears: the idler's number of teeth does not matter, and the direction is the first's again.
        assert!((t[2] - 30.0 * 24.0 / 20.0).abs() < 1e-8, "{id}: {t:?}");
        let forces = [0, 1].map(|m| channel(&mut scene, &s, &format!("force:{m}")));
        assert!(
            (forces[0] / forces[1] - 1.0).abs() < 1e-9,
            "{id}: forces {forces:?}"
        );
    }
}

#[test]
fn a_train_carries_its_load_in_motion() {
    // Driven at one end, viscous load at the other: the mean torques have the ratio of the tooth numbers.
    let held = [
        Mount::Driven(Profile::Constant(50.0)),
        Mount::Revolute,
        Mount::Revolute,
    ];
    let mut first = gear("first", spur(20), 0.0, 0.0);
    first.mount = held[0].clone();
    let idler = gear("idler", spur(30), 0.1001, -50.0 / 1.5);
    let mut last = gear("last", spur(24), 0.1001, 50.0 / 1.2);
    last.position = [0.1001, 0.1081, 0.0];
    last.loads = vec![Load::Viscous(0.4)];
    let meshes = vec![
        mesh([0, 1], start(Side::Left, 0.0)),
        mesh([1, 2], start(Side::Right, 0.0)),
    ];
    let spec = SceneSpec {
        duration: f64::INFINITY,
        gears: vec![first, idler, last],
        meshes,
        shafts: vec![],
        stages: Vec::new(),
    };
    let damping = Damping::KelvinVoigtRatio { ratio: 0.15 };
    let contact = ContactSpec {
        damping,
        ..contact(1.5e10)
    };
    let mut scene = build(&spec, &[rigid(), rigid(), rigid()], &contact);
    let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-8), 0.05).unwrap("train");
    // Speeds follow the tooth numbers, transmission errors aside.
    assert!(
        (o.state.v[1] * 24.0 / (50.0 * 20.0) - 1.0).abs() < 2e-3,
        "{:?}",
        o.state.v
    );
    // Over the last pitches: mean force times base radius is the viscous torque.
    let rb = effective_radius(&spec.gears[2].body);
    let plan = TimePlan::new(
        0.05 + 6.0 * std::f64::consts::TAU / 20.0 / 50.0,
        Resolution::Tolerance(1e-8),
    );
    let t0 = o.state.t;
    let o = run_from(&mut scene, o.state, "dopri5", &plan).unwrap("train");
    let mean = o.impulse / (o.state.t - t0);
    let want = 0.4 * 50.0 / 1.2 / rb;
    assert!(
        (mean / want - 1.0).abs() < 5e-3,
        "mean force {mean} N, the load asks for {want} N"
    );
    assert!(o.ledger.residual_relative().abs() < 1e-5);
}
