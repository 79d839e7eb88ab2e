//! Rigid shafts: their members move as one body, for all models and methods.

use super::*;
use gearbench_integrators::{Events, Resolution};
use gearbench_models::geometry::Side;
use gearbench_models::spec::{Freedom, GearSpec, Load, Mount, Profile};

const FLYWHEEL: f64 = 2e-3;

/// Returns the impact of case A with a flywheel on the pinion: on a rigid shaft, or added to its hub.
fn with_flywheel(on_shaft: bool) -> SceneSpec {
    let mut spec = case_of_body(1e-6);
    if on_shaft {
        let mut flywheel = body(0.1, "flywheel", FLYWHEEL);
        if let StationMember::Body(b) = &mut flywheel.carries {
            b.speed = spec.gears[0].speed;
        }
        spec.shafts = vec![shaft("rigid", vec![on(0.0, 0), flywheel], vec![])];
    } else {
        spec.gears[0].added_inertia = FLYWHEEL;
    }
    spec
}

#[test]
fn a_rigid_shaft_is_one_body() {
    let time = 1.2e-4;
    for subject in subjects() {
        // The example has a share of all inertia in its rim, what is added at the hub too.
        if ["fe", "elastic-web"].contains(&subject.model.id) {
            continue;
        }
        let mut one = of_subject(&with_flywheel(false), &subject);
        let mut two = of_subject(&with_flywheel(true), &subject);
        let wheel = one.gears()[1].range().start;
        let flywheel = two.gears()[2].range().start;
        for method in methods_of(&mut two) {
            let id = method.info.id;
            let resolution = resolution(method.info, 1e-7, 1e-8);
            let a = run(&mut one, id, resolution, time).unwrap(id);
            let b = run(&mut two, id, resolution, time).unwrap(id);
            let off = (a.state.v[wheel] - b.state.v[wheel]).abs() / a.state.v[wheel].abs();
            let apart = (b.state.v[flywheel] - b.state.v[0]).abs();
            println!(
                "{} {id}: wheel {off:.1e} off, shaft {apart:.1e} rad/s",
                subject.name
            );
            // Few modes of a free hub stand for one with a flywheel.
            let bound = if subject.flanks { 5e-2 } else { 2e-3 };
            assert!(off < bound, "{} {id}: {off}", subject.name);
            assert!(b.ledger.residual_relative().abs() < 1e-2);
        }
    }
}

/// Rigid bodies: nothing but rounding between one body and two on a shaft.
#[test]
fn rigid_gears_on_a_rigid_shaft_differ_by_rounding() {
    for id in [
        "rk4",
        "velocity-verlet",
        "generalised-alpha",
        "bdf",
        "trigonometric(filter=0)",
    ] {
        let resolution = match id {
            "bdf" => Resolution::Tolerance(1e-9),
            _ => Resolution::Step(1e-6),
        };
        let both = [rigid(), rigid()];
        let ends = [false, true].map(|on_shaft| {
            let mut scene = build(&with_flywheel(on_shaft), &both, &contact(1.5e10));
            run(&mut scene, id, resolution, 3e-4).unwrap(id).state
        });
        let off = (ends[0].v[1] / ends[1].v[1] - 1.0).abs();
        let apart = (ends[1].v[2] - ends[1].v[0]).abs() / ends[1].v[0].abs();
        println!("{id}: wheel {off:.1e} off, shaft {apart:.1e}");
        assert!(
            apart < 1e-12 && off < if id == "bdf" { 1e-5 } else { 1e-9 },
            "{id}"
        );
    }
}

/// Returns two stages with both gears in the middle on one rigid shaft.
pub fn two_stages() -> SceneSpec {
    let at = |mut g: GearSpec, x: f64, y: f64| {
        g.position = [x, y, 0.0];
        g
    };
    let mut first = gear("first", spur(20), 0.0, 0.0);
    first.loads = vec![Load::Applied(Profile::Constant(20.0))];
    let wheel = gear("wheel", spur(30), 0.1001, 0.0);
    let pinion = gear("pinion", spur(20), 0.1001, 0.0);
    let mut last = at(gear("last", spur(40), 0.0, 0.0), 0.1001, 0.1201);
    last.mount = Mount::Fixed;
    SceneSpec {
        duration: f64::INFINITY,
        gears: vec![first, wheel, pinion, last],
        meshes: vec![
            mesh([0, 1], start(Side::Left, -1e-7)),
            mesh([2, 3], start(Side::Right, -1e-7)),
        ],
        shafts: vec![shaft("middle", vec![on(0.0, 1), on(0.05, 2)], vec![])],
        stages: Vec::new(),
    }
}

#[test]
fn a_compound_train_passes_its_torque() {
    use gearbench_integrators::{EquilibriumOptions, equilibrium};
    for model in [rigid(), movable(5e8, 2e-3, 0.0)] {
        let mut scene = build(&two_stages(), &vec![model.clone(); 4], &contact(2e10));
        let mut s = scene.initial();
        equilibrium(&mut scene, &mut s, &EquilibriumOptions::default()).unwrap();
        let torque = channel(&mut scene, &s, "shaft_torque:0");
        let held = channel(&mut scene, &s, "mount_torque:last");
        println!("{}: shaft {torque}, last gear {held} N m", model.id());
        assert!((torque.abs() - 30.0).abs() < 1e-6, "{torque}");
        assert!((held.abs() - 60.0).abs() < 1e-6, "{held}");
        let middle = [1, 2].map(|i| s.q[scene.gears()[i].range().start]);
        assert!((middle[0] - middle[1]).abs() < 1e-12 * middle[0].abs());
    }
}

#[test]
fn corrections_with_rigid_shafts_invert_tangents() {
    for subject in subjects() {
        let mut spec = with_flywheel(true);
        spec.meshes[0].start = start(Side::Left, -1e-6);
        let mut scene = of_subject(&spec, &subject);
        let mut s = scene.initial();
        scene.begin(&mut s, false);
        for (d, k) in [(0.0, 1e-13), (1e-6, 1e-12), (1e-4, 1e-9)] {
            corrects(&mut scene, &s, Coeffs { m: 1.0, d, k }, true, &subject.name);
        }
    }
}

#[test]
fn shafts_that_cannot_be_are_refused() {
    let refused = |spec: &SceneSpec, words: &[&str]| {
        let models = vec![rigid(); spec.gears.len()];
        let told = try_build(spec, &models, &contact(1e10))
            .err()
            .unwrap()
            .to_string();
        assert!(words.iter().all(|w| told.contains(w)), "{told}");
    };
    let with = |s: ShaftSpec| {
        let mut spec = case_a(0.0);
        spec.shafts = vec![s];
        spec
    };
    let one = |stations, sections| with(shaft("s", stations, sections));
    refused(
        &one(vec![on(0.0, 0), on(0.1, 1)], vec![]),
        &["shaft `s`", "is not on the axis"],
    );
    refused(&one(vec![on(0.0, 0)], vec![]), &["joins at least two"]);
    refused(
        &one(vec![on(0.0, 0), on(0.1, 0)], vec![]),
        &["is already on the shaft `s`"],
    );
    refused(
        &one(
            vec![on(0.0, 0), body(0.5, "b", 1.0)],
            vec![coupling(0.2, 1e3)],
        ),
        &["is not on the shaft"],
    );
    refused(
        &one(
            vec![on(0.0, 0), body(0.2, "b", 0.0)],
            vec![coupling(0.2, 1e3)],
        ),
        &["there is no inertia", "give the body an inertia"],
    );
    refused(
        &one(
            vec![on(0.0, 0), body(0.2, "wheel", 1.0)],
            vec![coupling(0.2, 1e3)],
        ),
        &["has the name `wheel`"],
    );
    refused(
        &one(vec![on(0.0, 0), body(0.2, "b", 1.0)], vec![]),
        &["starts at 20 rad/s", "the same speed"],
    );
    refused(
        &one(vec![on(0.1, 0), body(0.0, "b", 1.0)], vec![]),
        &["ascending order"],
    );
    refused(
        &one(
            vec![on(0.0, 0), body(0.2, "b", 1.0)],
            vec![coupling(0.2, -1.0)],
        ),
        &["section 1", "is not positive"],
    );
    let mut pushed = body(0.2, "b", 1.0);
    if let StationMember::Body(b) = &mut pushed.carries {
        b.speed = 20.0;
        let mut lateral = Box::new(gearbench_models::spec::OutOfPlaneSpec::default());
        lateral.directions[0] = Freedom::Driven(Profile::Constant(1e-3));
        b.lateral = Some(lateral);
    }
    refused(
        &one(vec![on(0.0, 0), pushed], vec![]),
        &["a direction of `b` is driven", "sections"],
    );
}
