//! Mounts, loads and trains: motions in closed form, power through prescribed motions, statics.

use gearbench_integrators::{
    AcceptedStep, Control, Resolution, SecondOrderSystem, Sink, State, TimePlan,
};
use gearbench_models::geometry::Side;
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, ContactSpec, Load, Mount, Profile, effective_radius, mesh_layout,
};
use gearbench_models::stiffness::{IsoVariation, PairStiffness};
use gearbench_tests::*;

/// Builds a pair with open flanks on both sides, for motions without contact.
fn free(load: Load) -> Scene {
    let mut spec = case_a(30e-6);
    spec.gears[0].speed = 0.0;
    spec.gears[0].loads = vec![load.clone()];
    // The wheel turns along, so that the flanks stay apart however far the pinion goes.
    spec.gears[1].inertia = spec.gears[0].inertia.map(|j| j * 1.5 * 1.5);
    spec.gears[1].loads = vec![match &load {
        Load::Applied(profile) => Load::Applied(profile.scaled(-1.5)),
        Load::Viscous(c) => Load::Viscous(2.25 * c),
    }];
    build(&spec, &[rigid(), rigid()], &contact(1e10))
}

/// Sink that records the times of the ends of accepted steps.
#[derive(Default)]
struct Times(Vec<f64>);

impl Sink for Times {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        self.0.push(step.to.t);
        Control::Continue
    }
}

#[test]
fn applied_loads_are_integrated_exactly_and_steps_land_on_breakpoints() {
    let j = case_a(0.0).gears[0].inertia.unwrap();
    let ramp = Profile::Ramp {
        from: 0.1,
        to: -0.3,
        start: 1.33e-3,
        end: 2.71e-3,
    };
    let table = Profile::table(vec![0.7e-3, 1.9e-3, 3.3e-3], vec![0.0, 0.5, -0.2]);
    for (profile, breakpoints) in [
        (Profile::Constant(0.4), vec![]),
        (ramp, vec![1.33e-3, 2.71e-3]),
        (table, vec![0.7e-3, 1.9e-3, 3.3e-3]),
    ] {
        for method in methods_of(&mut free(Load::Applied(profile.clone()))) {
            let mut scene = free(Load::Applied(profile.clone()));
            let (id, start) = (method.info.id, scene.initial());
            let mut times = Times::default();
            let plan = TimePlan::new(5e-3, resolution(method.info, 1e-4, 1e-6));
            let (s, _) = watched(&mut scene, start, id, &plan, &mut times);
            for breakpoint in &breakpoints {
                assert!(
                    times.0.contains(breakpoint),
                    "{id} does not land on the breakpoint at {breakpoint} s"
                );
            }
            // A torque that is linear between the breakpoints is integrated exactly by order two and above.
            let (got, want) = (s.v[0], profile.integral(5e-3) / j);
            let tolerance = if method.info.order > 1 { 1e-3 } else { 0.1 };
            assert!(
                (got - want).abs() < tolerance * (0.1 + want.abs()),
                "{id}: speed {got}, exact {want}"
            );
            if matches!(id, "velocity-verlet" | "newmark" | "rk4") {
                assert!(
                    (got - want).abs() < 1e-12 * (1.0 + want.abs()),
                    "{id}: speed {got}, exact {want}"
                );
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
    spec.gears[1].loads = vec![
        Load::Applied(Profile::Constant(-1.5 * torque)),
        Load::Viscous(2.25 * c),
    ];
    for (t, tolerance) in [(2.0 * j / c, 1e-8), (40.0 * j / c, 1e-12)] {
        let mut scene = build(&spec, &[rigid(), rigid()], &contact(1e10));
        let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-12), t).unwrap("viscous");
        let want = torque / c * (1.0 - (-c * t / j).exp());
        assert!(
            (o.state.v[0] / want - 1.0).abs() < tolerance,
            "{} {want}",
            o.state.v[0]
        );
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
        assert!(
            (o.state.v[0] + before).abs() < 1e-7 * before,
            "{} from {before}",
            o.state.v[0]
        );
        assert!(o.ledger.residual_relative().abs() < 1e-8);
        assert!(
            o.ledger.external.abs() < 1e-14,
            "a gear at rest does no work"
        );
    }
}

#[test]
fn driven_gears_put_their_power_into_the_ledger() {
    let profiles = [
        Profile::Constant(60.0),
        Profile::Ramp {
            from: 0.0,
            to: 80.0,
            start: 0.0,
            end: 2e-3,
        },
        Profile::table(vec![0.0, 1e-3, 2.5e-3], vec![20.0, 70.0, 40.0]),
    ];
    let iso = PairStiffness::Iso6336 {
        variation: IsoVariation::IsoMean,
    };
    let teeth = movable(1e8, 4.8e-3, 50.0);
    for driven in 0..2 {
        for profile in &profiles {
            for stiffness in [contact(1.5e10).stiffness, iso.clone()] {
                for model in [rigid(), teeth.clone(), web(0.02)] {
                    if driven == 1 && model.id() != "rigid" {
                        continue;
                    }
                    let mut spec = case_a(2e-6);
                    let other = 1 - driven;
                    let sign = if driven == 0 { 1.0 } else { -1.0 };
                    spec.gears[driven].mount = Mount::Driven(profile.scaled(sign));
                    if driven == 1 {
                        // The wheel drives with its other flanks.
                        spec.meshes[0].start = start(Side::Right, 2e-6);
                    }
                    spec.gears[other].speed = 0.0;
                    spec.gears[other].loads = vec![Load::Viscous(0.05)];
                    let models = if driven == 0 {
                        [model.clone(), rigid()]
                    } else {
                        [rigid(), rigid()]
                    };
                    let damping = Damping::KelvinVoigtRatio { ratio: 0.05 };
                    let contact = ContactSpec {
                        stiffness: stiffness.clone(),
                        damping,
                        ..contact(1.0)
                    };
                    let mut scene = build(&spec, &models, &contact);
                    let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-9), 3e-3)
                        .unwrap("driven");
                    let what = format!(
                        "gear {driven} driven by {profile:?}, {}, {}",
                        models[0].id(),
                        stiffness.id()
                    );
                    assert!(
                        o.ledger.external > 1e-3,
                        "{what}: external work {:e}",
                        o.ledger.external
                    );
                    let residual = o.ledger.residual_relative();
                    assert!(
                        residual.abs() < 2e-6,
                        "{what}: {residual:.2e} of the energy is not explained"
                    );
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
            let mut spec = pair_of(
                gear("pinion", spur(20), 0.0, 4.0 * side.sign()),
                rack("rack", 40, 0.0401, 0.0),
                start(side, 3e-6),
            );
            spec.gears[1].inertia = Some(0.4);
            // In the middle of where one pair alone touches, and gently: edges of tips would turn the force.
            let at = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
            spec.meshes[0].start.path_coordinate = Some(0.5 * (at.path[0] + at.path[1]));
            let effective_radii = [0, 1].map(|i| effective_radius(&spec.gears[i].body));
            let mut scene = build(&spec, &[model.clone(), model.clone()], &contact(2e10));
            let inertia = [0, 1].map(|i| scene.gears()[i].model.hub().inertia);
            let momenta = |scene: &mut Scene, s: &State| {
                let names = ["speed:pinion", "speed:rack"];
                [0, 1].map(|i| channel(scene, s, names[i]) * inertia[i] / effective_radii[i])
            };
            let s = scene.initial();
            let before = momenta(&mut scene, &s);
            // At the height of the impact the contact loads both as one force on the line of action.
            let mid = run(&mut scene, "dopri5", Resolution::Tolerance(1e-9), 6e-5)
                .unwrap("rack")
                .state;
            let t = channel(&mut scene, &mid, "contact_torque:pinion");
            let f = channel(&mut scene, &mid, "contact_torque:rack");
            let force = channel(&mut scene, &mid, "force:0");
            assert!(force > 100.0);
            assert!((t.abs() / (force * effective_radii[0]) - 1.0).abs() < 1e-9);
            assert!(
                (t / f + effective_radii[0] / effective_radii[1]).abs() < 1e-9 * effective_radii[0],
                "T/F is {}",
                t / f
            );
            let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-9), 1.3e-4).unwrap("rack");
            let after = momenta(&mut scene, &o.state);
            let impulse = after[0] - before[0];
            assert!(impulse.abs() > 0.02, "{before:?} {after:?}");
            // Gear and rack go along: the sum is kept.
            let drift = (after[0] + after[1] - before[0] - before[1]) / impulse;
            assert!(
                drift.abs() < 1e-10,
                "{side:?} {}: momentum drifts by {drift:.2e}",
                model.id()
            );
            let energy = o.ledger.end.total() / o.ledger.start.unwrap().total() - 1.0;
            assert!(energy.abs() < 1e-6, "energy {energy:.2e}");
            assert!(channel(&mut scene, &o.state, "hub_speed:rack") * side.sign() > 0.1);
        }
    }
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
