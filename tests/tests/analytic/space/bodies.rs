//! Bodies that spin freely.

use super::*;
use gearbench_integrators::{Resolution, TimePlan};
use gearbench_models::spec::{ContactSpec, Modelling, Mount, Profile};

/// Returns a free asymmetric body that rotates about an axis other than its own, with its centre of mass off the hub.
fn tumbling() -> SceneSpec {
    let mut body = gear("body", spur(20), 0.0, 60.0);
    let mut lateral = afloat();
    if let Some(l) = &mut lateral {
        l.spin = SpinTerms::On;
        l.mass = Some(0.8);
        l.inertia = Some(nalgebra::Matrix3::new(
            6e-4, 5e-5, -8e-5, 5e-5, 3e-4, 4e-5, -8e-5, 4e-5, 9e-4,
        ));
        l.centre_of_mass = Vec3::new(2e-3, -1e-3, 3e-3);
    }
    body.lateral = lateral;
    SceneSpec {
        duration: f64::INFINITY,
        gears: vec![body],
        meshes: vec![],
        shafts: vec![],
        stages: Vec::new(),
    }
}

/// Returns momentum and angular momentum about the origin of a rigid gear.
fn momenta_of(scene: &Scene, s: &State, gear: usize) -> [Vec3; 2] {
    let g = &scene.gears()[gear];
    let hub = &g.model.hub().hub;
    let own = g.at(s.at());
    let m = hub.motion(s.t, own.q, own.v);
    let [e0, e1, e2] = hub.axes;
    let axes = nalgebra::Matrix3::from_columns(&[e0, e1, e2]);
    let body = &hub.lateral.as_ref().unwrap().body;
    let rx = nalgebra::Rotation3::from_axis_angle(&Vec3::x_axis(), m.x[3]);
    let ry = nalgebra::Rotation3::from_axis_angle(&Vec3::y_axis(), m.x[4]);
    let rz = nalgebra::Rotation3::from_axis_angle(&Vec3::z_axis(), m.x[5]);
    let spin = m.v[3] * Vec3::x() + rx * (m.v[4] * Vec3::y()) + rx * (ry * (m.v[5] * Vec3::z()));
    let turned = (rx * ry * rz).into_inner();
    let c = turned * body.centre;
    let velocity = Vec3::new(m.v[0], m.v[1], m.v[2]) + spin.cross(&c);
    let place = hub.centre + axes * (Vec3::new(m.x[0], m.x[1], m.x[2]) + c);
    let own = turned * body.inertia * turned.transpose() * spin;
    let momentum = axes * (body.mass * velocity);
    [momentum, place.cross(&momentum) + axes * own]
}

#[test]
fn a_free_asymmetric_body_keeps_momentum_and_energy_to_the_order_of_the_method() {
    let spec = tumbling();
    for (id, order) in [("rk4", 4.0), ("generalised-alpha", 2.0)] {
        let (mut steps, mut of_energy, mut of_momentum) = (vec![], vec![], vec![]);
        for step in [1e-3, 5e-4, 2.5e-4] {
            let mut scene = Scene::build(
                &spec,
                &Modelling {
                    gears: vec![rigid()],
                    contacts: vec![],
                },
                &models(),
            )
            .unwrap();
            let mut s = scene.initial();
            s.v.copy_from_slice(&[60.0, 0.1, -0.2, 0.05, 3.0, -2.0]);
            let mut start = Outputs::default();
            scene.output(s.at(), &mut start);
            let before = momenta_of(&scene, &s, 0);
            let end = run_from(
                &mut scene,
                s,
                id,
                &TimePlan::new(0.2, Resolution::Step(step)),
            );
            end.result.unwrap();
            let mut out = Outputs::default();
            scene.output(end.state.at(), &mut out);
            let after = momenta_of(&scene, &end.state, 0);
            let tilt = end.state.q[4].hypot(end.state.q[5]);
            assert!(tilt > 0.02 && tilt < 1.0, "the body tilts by {tilt}");
            steps.push(step);
            of_energy.push((out.energy.kinetic / start.energy.kinetic - 1.0).abs());
            let off = (0..2).map(|k| (after[k] - before[k]).norm() / before[k].norm());
            of_momentum.push(off.fold(0.0, f64::max));
        }
        let orders = [&of_energy, &of_momentum].map(|of| slope(&steps, of));
        println!("{id}: energy {of_energy:?}, momentum {of_momentum:?}, orders {orders:?}");
        assert!(
            orders[1] > order - 0.3,
            "{id}: momentum of order {}",
            orders[1]
        );
        // Its sign changes on the way, so that no order can be fitted to it.
        assert!(of_energy[2] < 1e-6, "{id}: energy off by {}", of_energy[2]);
    }
}

/// Returns a pair in an impact while both bodies float, including spin terms.
fn striking_afloat() -> SceneSpec {
    let mut spec = helical_pair(0.25, 1e-6, false);
    tilt(&mut spec, 0, 4e-4, -2e-4);
    for gear in &mut spec.gears {
        gear.lateral = afloat();
        if let Some(l) = &mut gear.lateral {
            l.spin = SpinTerms::On;
        }
    }
    spec
}

/// Returns momentum and angular momentum about the origin of all gears.
fn all_momenta(scene: &Scene, s: &State) -> [Vec3; 2] {
    let mut sum = [Vec3::zeros(); 2];
    for i in 0..scene.gears().len() {
        let [p, l] = momenta_of(scene, s, i);
        sum[0] += p;
        sum[1] += l;
    }
    sum
}

#[test]
fn an_impact_of_floating_gears_keeps_their_momentum() {
    let spec = striking_afloat();
    let mut on_slices = contact(1.5e10);
    on_slices.stiffness = weber_banaschek();
    on_slices.slices = Some(6);
    let elastic = elastic::toy();
    for (name, models, law) in [
        ("rigid", [rigid(), rigid()], on_slices),
        (
            "elastic",
            [elastic.clone(), elastic],
            elastic::on_points(0.0),
        ),
    ] {
        let (mut steps, mut offs) = (vec![], vec![]);
        for step in [4e-7, 2e-7] {
            let mut scene = build(&spec, &models, &law);
            let s = scene.initial();
            let before = all_momenta(&scene, &s);
            let end = run_from(
                &mut scene,
                s,
                "rk4",
                &TimePlan::new(8e-5, Resolution::Step(step)),
            );
            end.result.unwrap();
            assert!(end.peak > 100.0, "a peak of {} N is no impact", end.peak);
            let after = all_momenta(&scene, &end.state);
            // What a gear hands over, as impulse and about the origin.
            let handed = end.impulse;
            let linear = (after[0] - before[0]).norm() / handed;
            let angular = (after[1] - before[1]).norm() / (0.1 * handed);
            println!(
                "{name}, step {step:.0e}: momentum {linear:.1e}, angular momentum {angular:.1e} of what is handed over"
            );
            assert!(linear < 1e-9, "momentum: {linear:.2e}");
            steps.push(step);
            offs.push(angular);
        }
        assert!(offs[1] < 1e-9, "angular momentum: {:.2e}", offs[1]);
    }
}

/// A stiffness that varies along the path does work on a drive, also where flanks meet in space.
#[test]
fn drives_of_gears_on_bearings_put_their_power_into_the_ledger() {
    let constant = contact(1.5e10);
    let varying = ContactSpec {
        stiffness: weber_banaschek(),
        ..constant.clone()
    };
    let teeth = movable(5.3e8, 4.8e-3, 0.0);
    for (driven, helix, model) in [
        (0, 0.0, rigid()),
        (0, 0.25, rigid()),
        (1, 0.25, rigid()),
        (0, 0.25, teeth),
    ] {
        for (what, law) in [("constant", &constant), ("varying", &varying)] {
            let law = ContactSpec {
                slices: (helix > 0.0).then_some(6),
                ..law.clone()
            };
            let mut spec = helical_pair(helix, 1e-6, false);
            for (k, speed) in [(driven, [20.0, 15.0][driven]), (1 - driven, 0.0)] {
                spec.gears[k].lateral = on_bearings();
                spec.gears[k].speed = speed;
            }
            let speed = std::mem::take(&mut spec.gears[driven].speed);
            spec.gears[driven].mount = Mount::Driven(Profile::Constant(speed));
            let mut scene = build(&spec, &[model.clone(), model.clone()], &law);
            let end = run(&mut scene, "rk4", Resolution::Step(1e-7), 1e-4);
            end.result.unwrap();
            assert!(end.peak > 100.0, "a peak of {} N is no impact", end.peak);
            let work = end.ledger.external;
            let residual = end.ledger.residual_relative();
            println!(
                "gear {driven} driven, helix {helix}, {what}: {work:.3e} J, residual {residual:.1e}"
            );
            assert!(work > 1e-3, "{work} J");
            assert!(residual.abs() < 1e-6, "{what}: {residual:.2e}");
        }
    }
}

#[test]
fn the_trigonometric_method_takes_bearings_as_oscillators() {
    let mut spec = helical_pair(0.25, 1e-6, false);
    for gear in &mut spec.gears {
        gear.lateral = on_bearings();
        if let Some(l) = &mut gear.lateral {
            l.spin = SpinTerms::Off;
        }
    }
    let mut law = contact(1.5e10);
    law.slices = Some(4);
    let end = |id: &str, step: f64| {
        let mut scene = build(&spec, &[rigid(), rigid()], &law);
        let s = scene.initial();
        let end = run_from(
            &mut scene,
            s,
            id,
            &TimePlan::new(2e-4, Resolution::Step(step)),
        );
        end.result.unwrap();
        end.state
    };
    let exact = end("rk4", 1e-7);
    let off = |s: &State| {
        let pairs = s.v.iter().zip(&exact.v);
        let largest = exact.v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        pairs.fold(0.0_f64, |m, (x, y)| m.max((x - y).abs())) / largest
    };
    let errors = [4e-7, 2e-7, 1e-7].map(|step| off(&end("trigonometric", step)));
    println!("speeds off by {errors:?} of the largest");
    assert!(errors[2] < 1e-4, "{errors:?}");
    assert!(errors[0] > 3.0 * errors[1], "no second order: {errors:?}");
}
