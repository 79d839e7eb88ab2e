//! Springs of movable teeth compared with the equations of Ebrahimi and Eberhard (2006), total inertia, and stiffness
//! over the contact radius.

use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{
    Coeffs, Events, Outputs, Report, Resolution, SecondOrderSystem, State, TimePlan,
};
use gearbench_models::geometry::{Gear, Side};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{ModelSpec, Mount, Profile};
use gearbench_tests::*;

use crate::movable_teeth::loaded;

const K: f64 = 5.3e8;
const M: f64 = 4.8e-3;

#[test]
fn one_tooth_deflects_by_its_torque_over_its_spring() {
    // A held hub, the wheel pressed against one tooth: k r_d^2 (S - phi) = T, and T_i = F_t r.
    let mut spec = case_a(0.0);
    spec.gears[1].mount = Mount::Fixed;
    let r_d = 0.035;
    let teeth = with(movable(K, M, 0.0), "spring_radius_m", r_d);
    // Both hubs are held; the loaded teeth settle where spring and contact agree.
    spec.gears[0].mount = Mount::Fixed;
    spec.meshes[0].start = start(Side::Left, -5e-6);
    let mut scene = build(&spec, &[rigid(), all_teeth(teeth)], &contact(1e11));
    let mut s = scene.initial();
    scene.begin(&mut s, false);
    for _ in 0..20 {
        let mut f = vec![0.0; s.q.len()];
        scene.force(s.at(), &mut f);
        let c = Coeffs {
            m: 0.0,
            d: 0.0,
            k: 1.0,
        };
        scene.correct(s.at(), c, &mut f).unwrap();
        s.q.iter_mut().zip(&f).for_each(|(q, d)| *q += d);
    }
    let loaded: Vec<_> = scene.contact_forces(s.at());
    assert!(!loaded.is_empty());
    for contact in loaded {
        let tooth = contact.teeth[1].index.rem_euclid(30) as usize;
        // The tangential part of the force at its radius.
        let x = contact.x - scene.gears()[1].model.hub().centre;
        let (r, tangent) = (
            x.norm(),
            gearbench_models::Vec3::new(-x.y, x.x, 0.0) / x.norm(),
        );
        let torque = contact.force.dot(&tangent) * r;
        let want = torque / (K * r_d * r_d);
        assert!(
            (s.q[tooth] / want - 1.0).abs() < 1e-9,
            "{} {want}",
            s.q[tooth]
        );
        // |T_i| = N r_b.
        let rb = gearbench_models::spec::effective_radius(&spec.gears[1].body);
        assert!((torque.abs() / (contact.normal_force * rb) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_tooth_on_a_held_body_swings_with_its_own_frequency() {
    let c = 4.0;
    for held in [Mount::Fixed, Mount::Driven(Profile::Constant(0.0))] {
        let mut spec = case_a(30e-6);
        spec.gears[0].mount = held;
        spec.gears[1].mount = Mount::Fixed;
        let mut scene = build(
            &spec,
            &[all_teeth(movable(K, M, c)), rigid()],
            &contact(1e10),
        );
        let mut s = scene.initial();
        s.q[7] = 1e-4;
        let omega = (K / M).sqrt();
        let (a, t) = (0.5 * c / M, 40.0 / omega);
        let wd = (omega * omega - a * a).sqrt();
        let plan = TimePlan::new(t, Resolution::Tolerance(1e-11));
        let o = run_from(&mut scene, s, "dopri5", &plan).unwrap("free tooth");
        let want = 1e-4 * (-a * t).exp() * ((wd * t).cos() + a / wd * (wd * t).sin());
        assert!(
            (o.state.q[7] - want).abs() < 1e-12,
            "{} {want}",
            o.state.q[7]
        );
        assert!(o.ledger.residual_relative().abs() < 1e-9);
    }
}

#[test]
fn total_inertia_is_held() {
    // A rigid turn of hub and teeth carries the momentum and energy of the given inertia; so does its mass.
    for teeth in [movable(K, M, 0.0), all_teeth(movable(K, M, 0.0))] {
        let mut spec = case_a(30e-6);
        spec.gears[1].loads = vec![];
        let mut scene = build(&spec, &[teeth, rigid()], &contact(1e10));
        let s = scene.initial();
        let mut out = Outputs::default();
        scene.output(s.at(), &mut out);
        let j = spec.gears[0].inertia.unwrap();
        assert!((out.energy.kinetic / (0.5 * j * 400.0) - 1.0).abs() < 1e-14);
        assert!((channel(&mut scene, &s, "speed:pinion") / 20.0 - 1.0).abs() < 1e-14);
        let n = scene.gears()[0].range().len();
        let mut x = vec![0.0; s.q.len()];
        x[..n].fill(1.0);
        let mut y = vec![0.0; s.q.len()];
        scene.apply_mass(s.at(), &x, &mut y);
        assert!((y.iter().sum::<f64>() / j - 1.0).abs() < 1e-14);
        let mut back = y.clone();
        scene.solve_mass(s.at(), &mut back);
        for (a, b) in back.iter().zip(&x) {
            assert!((a - b).abs() < 1e-14);
        }
    }
}

#[test]
fn teeth_start_with_their_driven_hub() {
    let mut spec = case_a(30e-6);
    spec.gears[0].mount = Mount::Driven(Profile::Constant(25.0));
    spec.gears[0].speed = 0.0;
    let mut scene = build(&spec, &[movable(K, M, 0.0), rigid()], &contact(1e10));
    let s = scene.initial();
    assert!(
        s.v[..scene.gears()[0].range().len()]
            .iter()
            .all(|&v| v == 25.0)
    );
    let mut out = Outputs::default();
    scene.output(s.at(), &mut out);
    assert_eq!(out.energy.strain, 0.0);
}

/// Returns a model whose `k(r)` falls from root to tip.
fn by_radius(damping: f64) -> ModelSpec {
    let gear = Gear::new(spur(20)).unwrap();
    let r = [gear.r_form(), gear.r_reference(), gear.r_tip()];
    let model = with(movable(6e8, M, damping), "stiffness_radius_m", r.to_vec());
    let model = with(
        model,
        "stiffness_at_radius_n_per_m",
        vec![6e8, 4.5e8, 2.5e8],
    );
    let mut model = model;
    model.unset("tooth_stiffness_n_per_m").unwrap();
    model
}

#[test]
fn stiffness_over_the_radius_has_a_potential_and_books_its_jumps() {
    // Under load over several pitches: teeth enter and leave, each time between k0 and k(r).
    for model in [by_radius(60.0), all_teeth(by_radius(60.0))] {
        let spec = loaded(1.0, 60.0, 20.0);
        let mut scene = build(&spec, &[model.clone(), rigid()], &contact(5e10));
        let (start, mut ledger) = (scene.initial(), Ledger::default());
        let plan = TimePlan::new(0.01, Resolution::Tolerance(1e-9));
        let (s, work) = watched(&mut scene, start, "dopri5", &plan, &mut ledger);
        assert!(work.events > 10, "{} events", work.events);
        assert!(ledger.jumps.abs() > 1e-7, "jumps {:e}", ledger.jumps);
        let residual = ledger.residual_relative();
        assert!(
            residual.abs() < 1e-6,
            "{residual:.2e} of the energy is not explained"
        );
        // A tooth that has left carries k0 again: as many teeth are engaged as contacts are closed.
        let engaged = engaged_teeth(&scene, &s);
        let closed = scene.contact_forces(s.at()).len();
        assert_eq!(engaged, closed, "teeth with k(r) and contacts");
    }
}

#[test]
fn a_run_that_starts_anew_lets_go_of_old_contacts() {
    let mut spec = case_a(0.0);
    spec.meshes[0].start = start(Side::Left, -3e-6);
    let mut scene = build(&spec, &[by_radius(0.0), rigid()], &contact(5e10));
    let mut s = scene.initial();
    scene.begin(&mut s, true);
    assert_eq!(
        engaged_teeth(&scene, &s),
        scene.contact_forces(s.at()).len()
    );
    assert!(engaged_teeth(&scene, &s) > 0);
    let wheel = scene.gears()[1].range().start;
    s.q[wheel] -= 3e-4;
    scene.begin(&mut s, true);
    assert_eq!(engaged_teeth(&scene, &s), 0);
}

/// Returns the number of teeth of the first gear that use `k(r)`: those whose spring stiffness differs from that
/// without contact.
fn engaged_teeth(scene: &Scene, s: &State) -> usize {
    let gear = &scene.gears()[0];
    let own = gear.at(s.at());
    let n = own.q.len();
    // Strain energy of one tooth moved alone tells its stiffness.
    let strain = |i: Option<usize>| {
        let mut q = vec![own.q[0]; n];
        if let Some(i) = i {
            q[i] = own.q[i] + 1e-4;
        }
        let at = gearbench_integrators::StateView { q: &q, ..own };
        gear.model.energy(at).strain
    };
    let rest = strain(None);
    let of = |i: usize| (strain(Some(i)) - rest) / (own.q[i] + 1e-4 - own.q[0]).powi(2);
    // The first coordinate after the hub is the mean of many teeth where not all are integrated.
    let all = n == 21;
    let first = if all { 1 } else { 2 };
    let k0 = (first..n).map(of).fold(0.0, f64::max);
    (first..n).filter(|&i| of(i) < 0.999 * k0).count()
}
