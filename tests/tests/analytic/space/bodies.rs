//! Bodies that spin freely.

use super::*;
use gearbench_integrators::{Resolution, TimePlan};
use gearbench_models::spec::Modelling;

/// A free asymmetric body that tumbles about an axis beside its own, its centre of mass off the hub.
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
        gears: vec![body],
        meshes: vec![],
    }
}

/// Momentum and angular momentum about the origin of a rigid gear.
fn momenta(scene: &Scene, s: &State) -> [Vec3; 2] {
    let hub = &scene.gears()[0].model.hub().hub;
    let m = hub.motion(s.t, &s.q, &s.v);
    let body = &hub.lateral.as_ref().unwrap().body;
    let rx = nalgebra::Rotation3::from_axis_angle(&Vec3::x_axis(), m.x[3]);
    let ry = nalgebra::Rotation3::from_axis_angle(&Vec3::y_axis(), m.x[4]);
    let rz = nalgebra::Rotation3::from_axis_angle(&Vec3::z_axis(), m.x[5]);
    let spin = m.v[3] * Vec3::x() + rx * (m.v[4] * Vec3::y()) + rx * (ry * (m.v[5] * Vec3::z()));
    let turned = (rx * ry * rz).into_inner();
    let c = turned * body.centre;
    let velocity = Vec3::new(m.v[0], m.v[1], m.v[2]) + spin.cross(&c);
    let place = Vec3::new(m.x[0], m.x[1], m.x[2]) + c;
    let own = turned * body.inertia * turned.transpose() * spin;
    let momentum = body.mass * velocity;
    [momentum, place.cross(&momentum) + own]
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
            let before = momenta(&scene, &s);
            let end = run_from(
                &mut scene,
                s,
                id,
                &TimePlan::new(0.2, Resolution::Step(step)),
            );
            end.result.unwrap();
            let mut out = Outputs::default();
            scene.output(end.state.at(), &mut out);
            let after = momenta(&scene, &end.state);
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
