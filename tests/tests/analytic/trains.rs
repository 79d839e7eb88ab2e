//! Trains of three gears: statics, motion under load, an idler whose compliance couples its meshes.

use gearbench_integrators::{Coeffs, Events, Resolution, SecondOrderSystem, State, TimePlan};
use gearbench_models::geometry::Side;
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, ContactSpec, Load, MeshSpec, ModelSpec, Mount, Profile, SceneSpec, Value, lever,
};
use gearbench_tests::*;

/// Settles a damped scene in static equilibrium: Newton with a little mass, that held rigid gears allow.
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

/// First gear, idler and last gear; `side` is the flank of the idler on the last gear.
fn train(models: [ModelSpec; 3], mounts: [Mount; 3], torques: [f64; 2], side: Side) -> Scene {
    let [first_torque, idler_torque] = torques;
    let mut first = gear("first", spur(20), 0.0, 0.0);
    first.loads = vec![Load::Applied(Profile::Constant(first_torque))];
    let mut idler = gear("idler", spur(30), 0.1001, 0.0);
    idler.loads = vec![Load::Applied(Profile::Constant(idler_torque))];
    let mut last = gear("last", spur(24), 0.1001, 0.0);
    last.position = [0.1001, 0.1081];
    let mut gears = vec![first, idler, last];
    for (g, mount) in gears.iter_mut().zip(mounts) {
        g.mount = mount;
    }
    let meshes = vec![
        MeshSpec {
            gears: [0, 1],
            start: start(Side::Left, -1e-7),
        },
        MeshSpec {
            gears: [1, 2],
            start: start(side, -1e-7),
        },
    ];
    build(&SceneSpec { gears, meshes }, &models, &contact(2e10))
}

#[test]
fn torques_pass_a_train_with_the_ratio_of_its_ends() {
    let held = [Mount::Revolute, Mount::Revolute, Mount::Fixed];
    for models in [
        [rigid(), rigid(), rigid()],
        [rigid(), elastic(30, 0.0, 2e-9, 0.5), rigid()],
        [movable(5e8, 2e-3, 0.0), movable(5e8, 2e-3, 0.0), rigid()],
    ] {
        let id = models[1].id.clone();
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
    last.position = [0.1001, 0.1081];
    last.loads = vec![Load::Viscous(0.4)];
    let meshes = vec![
        MeshSpec {
            gears: [0, 1],
            start: start(Side::Left, 0.0),
        },
        MeshSpec {
            gears: [1, 2],
            start: start(Side::Right, 0.0),
        },
    ];
    let spec = SceneSpec {
        gears: vec![first, idler, last],
        meshes,
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
    let rb = lever(&spec.gears[2].body);
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

#[test]
fn an_elastic_idler_couples_its_meshes_through_its_compliance() {
    // Idler pressed against two held gears: N_i = k (-g0_i - sum_j C_ij N_j), C across both meshes.
    let (c0, rho) = (6e-9, 0.8);
    let held = [Mount::Fixed, Mount::Revolute, Mount::Fixed];
    let idler = |rho: f64| {
        let stiff = elastic_test_gear::harmonic_modes(30, &[1e6], 0.0, 0.0);
        let model = ModelSpec {
            id: "elastic-test".into(),
            parameters: stiff,
        };
        let model = with(model, "compliance_m_per_n", Value::Number(c0));
        with(model, "compliance_coupling", Value::Number(rho))
    };
    let k = 2e8;
    let mut turned = Vec::new();
    for rho in [0.0, rho] {
        let mut scene = train(
            [rigid(), idler(rho), rigid()],
            held.clone(),
            [0.0, 40.0],
            Side::Left,
        );
        let s = settle(&mut scene);
        let forces = scene.contact_forces(s.at());
        assert!(forces.iter().any(|f| f.mesh == 0) && forces.iter().any(|f| f.mesh == 1));
        let sum: f64 = forces.iter().map(|f| f.normal_force).sum();
        let rb = match &case_a(0.0).gears[1].body {
            Body::Gear(g) => g.r_base(),
            Body::Rack(_) => unreachable!("a gear"),
        };
        assert!((sum * rb / 40.0 - 1.0).abs() < 1e-9, "{sum} N");
        let all = candidates(&scene, &s);
        for f in &forces {
            let (_, c) = all
                .iter()
                .find(|(m, c)| *m == f.mesh && c.points[0].x == f.x)
                .unwrap();
            // All forces push the idler the same way round, so their deflections add.
            let side = |m: usize| if m == 0 { 1 } else { 0 };
            let deflection: f64 = forces
                .iter()
                .map(|g| {
                    let apart =
                        (f.teeth[side(f.mesh)].index - g.teeth[side(g.mesh)].index).rem_euclid(30);
                    let apart = apart.min(30 - apart) as i32;
                    let c = if apart == 0 { c0 } else { c0 * rho.powi(apart) };
                    c * g.normal_force
                })
                .sum();
            let want = -k * (c.gap + deflection);
            assert!(
                (f.normal_force / want - 1.0).abs() < 1e-9,
                "{} {want}",
                f.normal_force
            );
        }
        turned.push(s.q[0]);
    }
    let [apart, coupled] = turned[..] else {
        unreachable!("two runs")
    };
    assert!(
        coupled.abs() > 1.02 * apart.abs(),
        "coupling turns the idler from {apart} to {coupled}"
    );
}
