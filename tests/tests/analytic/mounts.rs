//! Mounts, loads and trains: motions in closed form, power through prescribed motions, statics.

use gearbench_integrators::{
    AcceptedStep, Coeffs, Control, Resolution, SecondOrderSystem, Sink, State, TimePlan, Work,
};
use gearbench_models::contact::law::Damping;
use gearbench_models::geometry::Side;
use gearbench_models::load::{Load, Profile};
use gearbench_models::mount::Mount;
use gearbench_models::scene::Scene;
use gearbench_models::scene::build::{lever, mesh_layout};
use gearbench_models::scene::spec::{Body, ContactSpec, MeshSpec, ModelSpec, SceneSpec, Value};
use gearbench_models::stiffness::{IsoVariation, PairStiffness};
use gearbench_tests::*;

/// A pair with its teeth apart on both flanks, for motions without contact.
fn free(load: Load) -> Scene {
    let mut spec = case_a(30e-6);
    spec.gears[0].speed = 0.0;
    spec.gears[0].loads = vec![load.clone()];
    // The wheel turns along, so that the flanks stay apart however far the pinion goes.
    spec.gears[1].inertia = spec.gears[0].inertia.map(|j| j * 1.5 * 1.5);
    spec.gears[1].loads = vec![match load {
        Load::Applied(Profile::Table { time, value }) => {
            Load::Applied(Profile::Table { time, value: value.iter().map(|x| -1.5 * x).collect() })
        }
        Load::Applied(Profile::Ramp { from, to, start, end }) => {
            Load::Applied(Profile::Ramp { from: -1.5 * from, to: -1.5 * to, start, end })
        }
        Load::Applied(Profile::Constant(x)) => Load::Applied(Profile::Constant(-1.5 * x)),
        Load::Viscous(c) => Load::Viscous(2.25 * c),
    }];
    build(&spec, &[rigid(), rigid()], &contact(1e10))
}

/// Times of the ends of accepted steps.
#[derive(Default)]
struct Times(Vec<f64>);

impl Sink for Times {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        self.0.push(step.to.t);
        Control::Continue
    }
}

#[test]
fn applied_loads_are_integrated_exactly_and_steps_land_on_knots() {
    let j = case_a(0.0).gears[0].inertia.unwrap();
    let ramp = Profile::Ramp { from: 0.1, to: -0.3, start: 1.33e-3, end: 2.71e-3 };
    let table = Profile::Table { time: vec![0.7e-3, 1.9e-3, 3.3e-3], value: vec![0.0, 0.5, -0.2] };
    for (profile, knots) in [
        (Profile::Constant(0.4), vec![]),
        (ramp, vec![1.33e-3, 2.71e-3]),
        (table, vec![0.7e-3, 1.9e-3, 3.3e-3]),
    ] {
        for method in methods() {
            let mut scene = free(Load::Applied(profile.clone()));
            let mut s = scene.initial();
            let mut times = Times::default();
            let plan = TimePlan::new(5e-3, resolution(method, 1e-4, 1e-6));
            method.build().run(&mut scene, &mut s, &plan, &mut times, &mut Work::default()).unwrap();
            let id = method.info.id;
            for knot in &knots {
                assert!(times.0.contains(knot), "{id} does not land on the knot at {knot} s");
            }
            // A torque that is linear between the knots is integrated exactly by order two and above.
            let (got, want) = (s.v[0], profile.integral(5e-3) / j);
            let tolerance = if method.info.order > 1 { 1e-3 } else { 0.1 };
            assert!((got - want).abs() < tolerance * (0.1 + want.abs()), "{id}: speed {got}, exact {want}");
            if matches!(id, "velocity-verlet" | "newmark" | "rk4") {
                assert!((got - want).abs() < 1e-12 * (1.0 + want.abs()), "{id}: speed {got}, exact {want}");
            }
        }
    }
}

#[test]
fn viscous_loads_decay_and_reach_their_terminal_speed() {
    let (c, torque) = (0.05, 0.4);
    let mut spec = case_a(30e-6);
    let j = spec.gears[0].inertia.unwrap();
    spec.gears[0].speed = 0.0;
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(torque)), Load::Viscous(c)];
    spec.gears[1].inertia = Some(j * 2.25);
    spec.gears[1].loads = vec![Load::Applied(Profile::Constant(-1.5 * torque)), Load::Viscous(2.25 * c)];
    for (t, tolerance) in [(2.0 * j / c, 1e-8), (40.0 * j / c, 1e-12)] {
        let mut scene = build(&spec, &[rigid(), rigid()], &contact(1e10));
        let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-12), t).unwrap("viscous");
        let want = torque / c * (1.0 - (-c * t / j).exp());
        assert!((o.state.v[0] / want - 1.0).abs() < tolerance, "{} {want}", o.state.v[0]);
        assert!(o.ledger.residual_relative().abs() < 1e-9);
    }
}

#[test]
fn a_fixed_gear_turns_the_other_back() {
    for fixed in 0..2 {
        let mut spec = case_a(3e-6);
        spec.gears[0].speed = 0.0;
        spec.gears[1 - fixed].speed = if fixed == 0 { 5.0 } else { 20.0 };
        spec.gears[fixed].mount = Mount::Fixed;
        let mut scene = build(&spec, &[rigid(), rigid()], &contact(1.5e10));
        assert_eq!(scene.layout().n, 1);
        let before = scene.initial().v[0];
        let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-10), 2e-4).unwrap("fixed");
        assert!((o.state.v[0] + before).abs() < 1e-7 * before, "{} from {before}", o.state.v[0]);
        assert!(o.ledger.residual_relative().abs() < 1e-8);
        assert!(o.ledger.external.abs() < 1e-14, "a gear at rest does no work");
    }
}

#[test]
fn driven_gears_put_their_power_into_the_ledger() {
    let profiles = [
        Profile::Constant(60.0),
        Profile::Ramp { from: 0.0, to: 80.0, start: 0.0, end: 2e-3 },
        Profile::Table { time: vec![0.0, 1e-3, 2.5e-3], value: vec![20.0, 70.0, 40.0] },
    ];
    let iso = PairStiffness::Iso6336 { variation: IsoVariation::IsoMean };
    let teeth = movable(1e8, 4.8e-3, 50.0);
    for driven in 0..2 {
        for profile in &profiles {
            for stiffness in [contact(1.5e10).stiffness, iso.clone()] {
                for model in [rigid(), teeth.clone(), elastic(20, 0.02, 0.0, 0.0), elastic(20, 0.02, 2e-9, 0.3)] {
                    if driven == 1 && model.id != "rigid" {
                        continue;
                    }
                    let mut spec = case_a(2e-6);
                    let other = 1 - driven;
                    spec.gears[driven].mount = Mount::Driven(match (driven, profile) {
                        (0, p) => p.clone(),
                        (_, Profile::Constant(x)) => Profile::Constant(-x),
                        (_, Profile::Ramp { to, start, end, .. }) => {
                            Profile::Ramp { from: 0.0, to: -to, start: *start, end: *end }
                        }
                        (_, Profile::Table { time, value }) => Profile::Table {
                            time: time.clone(),
                            value: value.iter().map(|x| -x).collect(),
                        },
                    });
                    if driven == 1 {
                        // The wheel drives with its other flanks.
                        spec.meshes[0].start = start(Side::Right, 2e-6);
                    }
                    spec.gears[other].speed = 0.0;
                    spec.gears[other].loads = vec![Load::Viscous(0.05)];
                    let models = if driven == 0 { [model.clone(), rigid()] } else { [rigid(), rigid()] };
                    let damping = Damping::KelvinVoigtRatio { ratio: 0.05 };
                    let contact = ContactSpec { stiffness: stiffness.clone(), damping, ..contact(1.0) };
                    let mut scene = build(&spec, &models, &contact);
                    let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-9), 3e-3).unwrap("driven");
                    let what = format!("gear {driven} driven by {profile:?}, {}, {}", models[0].id, stiffness.id());
                    assert!(o.ledger.external > 1e-3, "{what}: external work {:e}", o.ledger.external);
                    let residual = o.ledger.residual_relative();
                    assert!(residual.abs() < 2e-6, "{what}: {residual:.2e} of the energy is not explained");
                }
            }
        }
    }
}

#[test]
fn rack_and_pinion_exchange_momentum() {
    // L r_b^-1 of the pinion and p / cos(alpha) of the rack: one impulse N, and T / F is the pitch radius.
    for side in Side::BOTH {
        for model in [rigid(), movable(5e8, 5e-3, 0.0)] {
            let mut spec =
                pair_of(gear("pinion", spur(20), 0.0, 20.0 * side.sign()), rack("rack", 40, 0.0401, 0.0), start(side, 3e-6));
            spec.gears[1].inertia = Some(0.4);
            let levers = [0, 1].map(|i| lever(&spec.gears[i].body));
            let mut scene = build(&spec, &[model.clone(), model.clone()], &contact(2e10));
            let inertia = [0, 1].map(|i| scene.gears()[i].model.hub().inertia);
            let momenta = |scene: &mut Scene, s: &State| {
                let names = ["speed:pinion", "speed:rack"];
                [0, 1].map(|i| channel(scene, s, names[i]) * inertia[i] / levers[i])
            };
            let s = scene.initial();
            let before = momenta(&mut scene, &s);
            // At the height of the impact the contact loads both as one force on the line of action.
            let mid = run(&mut scene, "dopri5", Resolution::Tolerance(1e-9), 6e-5).unwrap("rack").state;
            let t = channel(&mut scene, &mid, "contact_torque:pinion");
            let f = channel(&mut scene, &mid, "contact_torque:rack");
            let force = channel(&mut scene, &mid, "force:0");
            assert!(force > 100.0);
            assert!((t.abs() / (force * levers[0]) - 1.0).abs() < 1e-9);
            assert!((t / f + levers[0] / levers[1]).abs() < 1e-9 * levers[0], "T/F is {}", t / f);
            let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-9), 1.3e-4).unwrap("rack");
            let after = momenta(&mut scene, &o.state);
            let impulse = after[0] - before[0];
            assert!(impulse.abs() > 0.1, "{before:?} {after:?}");
            // Gear and rack go along: the sum is kept.
            let drift = (after[0] + after[1] - before[0] - before[1]) / impulse;
            assert!(drift.abs() < 1e-10, "{side:?} {}: momentum drifts by {drift:.2e}", model.id);
            let energy = o.ledger.end.total() / o.ledger.start.unwrap().total() - 1.0;
            assert!(energy.abs() < 1e-6, "energy {energy:.2e}");
            assert!(channel(&mut scene, &o.state, "hub_speed:rack") * side.sign() > 0.5);
        }
    }
}

/// Settles a damped scene in static equilibrium: Newton with a little mass, that held rigid gears allow.
fn settle(scene: &mut Scene) -> State {
    let mut s = scene.initial();
    s.v.fill(0.0);
    scene.begin(&mut s, false);
    for _ in 0..200 {
        let mut f = vec![0.0; s.q.len()];
        scene.force(s.at(), &mut f);
        scene.correct(s.at(), Coeffs { m: 1e4, d: 0.0, k: 1.0 }, &mut f).unwrap();
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
        MeshSpec { gears: [0, 1], start: start(Side::Left, -1e-7) },
        MeshSpec { gears: [1, 2], start: start(side, -1e-7) },
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
        let t = ["first", "idler", "last"].map(|n| channel(&mut scene, &s, &format!("contact_torque:{n}")));
        assert!((t[0] + 30.0).abs() < 1e-8, "{id}: {t:?}");
        assert!(t[1].abs() < 1e-8, "{id}: the idler is not balanced, {t:?}");
        // Three gears: the idler's number of teeth does not matter, and the direction is the first's again.
        assert!((t[2] - 30.0 * 24.0 / 20.0).abs() < 1e-8, "{id}: {t:?}");
        let forces = [0, 1].map(|m| channel(&mut scene, &s, &format!("force:{m}")));
        assert!((forces[0] / forces[1] - 1.0).abs() < 1e-9, "{id}: forces {forces:?}");
    }
}

#[test]
fn a_train_carries_its_load_in_motion() {
    // Driven at one end, viscous load at the other: the mean torques have the ratio of the tooth numbers.
    let held = [Mount::Driven(Profile::Constant(50.0)), Mount::Revolute, Mount::Revolute];
    let mut first = gear("first", spur(20), 0.0, 0.0);
    first.mount = held[0].clone();
    let idler = gear("idler", spur(30), 0.1001, -50.0 / 1.5);
    let mut last = gear("last", spur(24), 0.1001, 50.0 / 1.2);
    last.position = [0.1001, 0.1081];
    last.loads = vec![Load::Viscous(0.4)];
    let meshes = vec![
        MeshSpec { gears: [0, 1], start: start(Side::Left, 0.0) },
        MeshSpec { gears: [1, 2], start: start(Side::Right, 0.0) },
    ];
    let spec = SceneSpec { gears: vec![first, idler, last], meshes };
    let damping = Damping::KelvinVoigtRatio { ratio: 0.15 };
    let contact = ContactSpec { damping, ..contact(1.5e10) };
    let mut scene = build(&spec, &[rigid(), rigid(), rigid()], &contact);
    let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-8), 0.05).unwrap("train");
    // Speeds follow the tooth numbers, transmission errors aside.
    assert!((o.state.v[1] * 24.0 / (50.0 * 20.0) - 1.0).abs() < 2e-3, "{:?}", o.state.v);
    // Over the last pitches: mean force times base radius is the viscous torque.
    let rb = lever(&spec.gears[2].body);
    let plan = TimePlan::new(0.05 + 6.0 * std::f64::consts::TAU / 20.0 / 50.0, Resolution::Tolerance(1e-8));
    let t0 = o.state.t;
    let o = run_from(&mut scene, o.state, "dopri5", &plan).unwrap("train");
    let mean = o.impulse / (o.state.t - t0);
    let want = 0.4 * 50.0 / 1.2 / rb;
    assert!((mean / want - 1.0).abs() < 5e-3, "mean force {mean} N, the load asks for {want} N");
    assert!(o.ledger.residual_relative().abs() < 1e-5);
}

#[test]
fn an_elastic_idler_couples_its_meshes_through_its_compliance() {
    // Idler pressed against two held gears: N_i = k (-g0_i - sum_j C_ij N_j), C across both meshes.
    let (c0, rho) = (6e-9, 0.8);
    let held = [Mount::Fixed, Mount::Revolute, Mount::Fixed];
    let idler = |rho: f64| {
        let stiff = elastic_test_gear::harmonic_modes(30, &[1e6], 0.0, 0.0);
        let model = ModelSpec { id: "elastic-test".into(), parameters: stiff };
        let model = with(model, "compliance_m_per_n", Value::Number(c0));
        with(model, "compliance_coupling", Value::Number(rho))
    };
    let k = 2e8;
    let mut turned = Vec::new();
    for rho in [0.0, rho] {
        let mut scene = train([rigid(), idler(rho), rigid()], held.clone(), [0.0, 40.0], Side::Left);
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
            let (_, c) = all.iter().find(|(m, c)| *m == f.mesh && c.points[0].x == f.x).unwrap();
            // All forces push the idler the same way round, so their deflections add.
            let side = |m: usize| if m == 0 { 1 } else { 0 };
            let deflection: f64 = forces
                .iter()
                .map(|g| {
                    let apart = (f.teeth[side(f.mesh)].index - g.teeth[side(g.mesh)].index).rem_euclid(30);
                    let apart = apart.min(30 - apart) as i32;
                    let c = if apart == 0 { c0 } else { c0 * rho.powi(apart) };
                    c * g.normal_force
                })
                .sum();
            let want = -k * (c.gap + deflection);
            assert!((f.normal_force / want - 1.0).abs() < 1e-9, "{} {want}", f.normal_force);
        }
        turned.push(s.q[0]);
    }
    let [apart, coupled] = turned[..] else { unreachable!("two runs") };
    assert!(coupled.abs() > 1.02 * apart.abs(), "coupling turns the idler from {apart} to {coupled}");
}

#[test]
fn added_inertia_counts() {
    let mut spec = case_a(30e-6);
    spec.gears[0].inertia = None;
    let own = match &spec.gears[0].body {
        Body::Gear(g) => g.mass_properties(spec.gears[0].material.density).izz,
        Body::Rack(_) => unreachable!("a gear"),
    };
    spec.gears[0].added_inertia = 2e-3;
    let scene = build(&spec, &[rigid(), rigid()], &contact(1e10));
    assert!((scene.gears()[0].model.hub().inertia - own - 2e-3).abs() < 1e-15);
    let l = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
    assert!(l.contact_ratio > 1.5 && l.backlash > 60e-6);
}
