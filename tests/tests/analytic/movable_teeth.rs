//! Movable teeth against the equations of seed 001 (Ebrahimi, Eberhard 2006) and against themselves with all
//! teeth integrated.

use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{
    AcceptedStep, Control, Outputs, Resolution, SecondOrderSystem, Sink, State, TimePlan, Work,
};
use gearbench_models::contact::law::Damping;
use gearbench_models::geometry::{Gear, Side};
use gearbench_models::load::{Load, Profile};
use gearbench_models::mount::Mount;
use gearbench_models::scene::Scene;
use gearbench_models::scene::spec::{ContactSpec, MeshSpec, ModelSpec, SceneSpec, Value};
use gearbench_tests::*;

const K: f64 = 5.3e8;
const M: f64 = 4.8e-3;

/// Records momentum, energy, hub motion and force of a scene at the ends of accepted steps on a grid.
struct Watch {
    out: Outputs,
    every: f64,
    next: f64,
    rows: Vec<Vec<f64>>,
    /// Largest relative jump of momenta and energy where coordinates were handed over.
    jump: f64,
    handovers: usize,
}

impl Watch {
    fn every(every: f64) -> Self {
        Watch { out: Outputs::default(), every, next: 0.0, rows: Vec::new(), jump: 0.0, handovers: 0 }
    }
}

impl Sink for Watch {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        while self.next <= step.to.t {
            let h = step.to.t - step.from.t;
            let mut s = step.from.clone();
            step.dense.eval((self.next - step.from.t) / h, &mut s.q, &mut s.v);
            s.t = self.next;
            sys.output(s.at(), &mut self.out);
            let mut row = vec![self.out.energy.total()];
            row.extend(&self.out.channels);
            self.rows.push(row);
            self.next += self.every;
        }
        Control::Continue
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        if before.q == after.q {
            return;
        }
        self.handovers += 1;
        sys.output(before.at(), &mut self.out);
        let (e, momenta) = (self.out.energy.total(), self.out.channels.clone());
        sys.output(after.at(), &mut self.out);
        self.jump = self.jump.max((self.out.energy.total() / e - 1.0).abs());
        for (a, b) in momenta.iter().zip(&self.out.channels).skip(4) {
            // Speeds, travels and torques of the gears.
            self.jump = self.jump.max((a - b).abs() / (1.0 + a.abs()));
        }
    }
}

fn watch(spec: &SceneSpec, models: &[ModelSpec], contact: &ContactSpec, t_end: f64, rtol: f64) -> (Watch, State, Scene) {
    let mut scene = build(spec, models, contact);
    let mut s = scene.initial();
    let mut w = Watch::every(t_end / 400.0);
    let (_, mut method) = gearbench_integrators::method("dopri5").unwrap();
    let plan = TimePlan::new(t_end, Resolution::Tolerance(rtol));
    method.run(&mut scene, &mut s, &plan, &mut w, &mut Work::default()).unwrap();
    (w, s, scene)
}

/// Largest difference of two records, channel by channel, over the largest value of the channel.
fn difference(a: &Watch, b: &Watch) -> f64 {
    assert_eq!(a.rows.len(), b.rows.len());
    let columns = a.rows[0].len();
    (0..columns)
        .map(|c| {
            let size = a.rows.iter().fold(1e-9_f64, |m, r| m.max(r[c].abs()));
            a.rows.iter().zip(&b.rows).fold(0.0_f64, |m, (x, y)| m.max((x[c] - y[c]).abs())) / size
        })
        .fold(0.0, f64::max)
}

/// The pinion drives against a load on the wheel, in either direction of turning.
fn loaded(direction: f64, speed: f64, torque: f64) -> SceneSpec {
    let side = if direction > 0.0 { Side::Left } else { Side::Right };
    let mut spec = case_a(0.0);
    spec.meshes[0].start = start(side, 2e-6);
    spec.gears[0].speed = direction * speed;
    spec.gears[1].speed = -direction * speed / 1.5;
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(direction * torque))];
    spec.gears[1].loads = vec![Load::Applied(Profile::Constant(direction * torque * 1.5))];
    spec
}

#[test]
fn one_tooth_deflects_by_its_torque_over_its_spring() {
    // A held hub, the wheel pressed against one tooth: k r_d^2 (S - phi) = T, and T_i = F_t r.
    let mut spec = case_a(0.0);
    spec.gears[1].mount = Mount::Fixed;
    let r_d = 0.035;
    let teeth = with(movable(K, M, 0.0), "spring_radius_m", Value::Number(r_d));
    // Both hubs are held; the loaded teeth settle where spring and contact agree.
    spec.gears[0].mount = Mount::Fixed;
    spec.meshes[0].start = start(Side::Left, -5e-6);
    let mut scene = build(&spec, &[rigid(), all_teeth(teeth)], &contact(1e11));
    let mut s = scene.initial();
    scene.begin(&mut s, false);
    for _ in 0..20 {
        let mut f = vec![0.0; s.q.len()];
        scene.force(s.at(), &mut f);
        let c = gearbench_integrators::Coeffs { m: 0.0, d: 0.0, k: 1.0 };
        scene.correct(s.at(), c, &mut f).unwrap();
        s.q.iter_mut().zip(&f).for_each(|(q, d)| *q += d);
    }
    let loaded: Vec<_> = scene.contact_forces(s.at());
    assert!(!loaded.is_empty());
    for contact in loaded {
        let tooth = contact.teeth[1].index.rem_euclid(30) as usize;
        // The tangential part of the force at its radius.
        let x = contact.x - scene.gears()[1].model.hub().centre;
        let (r, tangent) = (x.norm(), gearbench_models::Vec3::new(-x.y, x.x, 0.0) / x.norm());
        let torque = contact.force.dot(&tangent) * r;
        let want = torque / (K * r_d * r_d);
        assert!((s.q[tooth] / want - 1.0).abs() < 1e-9, "{} {want}", s.q[tooth]);
        // |T_i| = N r_b.
        let rb = gearbench_models::scene::build::lever(&spec.gears[1].body);
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
        let mut scene = build(&spec, &[all_teeth(movable(K, M, c)), rigid()], &contact(1e10));
        let mut s = scene.initial();
        s.q[7] = 1e-4;
        let omega = (K / M).sqrt();
        let (a, t) = (0.5 * c / M, 40.0 / omega);
        let wd = (omega * omega - a * a).sqrt();
        let plan = TimePlan::new(t, Resolution::Tolerance(1e-11));
        let o = run_from(&mut scene, s, "dopri5", &plan).unwrap("free tooth");
        let want = 1e-4 * (-a * t).exp() * ((wd * t).cos() + a / wd * (wd * t).sin());
        assert!((o.state.q[7] - want).abs() < 1e-12, "{} {want}", o.state.q[7]);
        assert!(o.ledger.residual_relative().abs() < 1e-9);
    }
}

#[test]
fn active_teeth_equal_all_teeth_over_an_impact() {
    for damping in [0.0, 60.0] {
        let teeth = movable(K, M, damping);
        let (few, s, _) = watch(&case_a(3.3e-6), &[teeth.clone(), teeth.clone()], &contact(5e10), 3e-4, 1e-10);
        let all = all_teeth(teeth);
        let (every, t, _) = watch(&case_a(3.3e-6), &[all.clone(), all], &contact(5e10), 3e-4, 1e-10);
        assert!(s.q.len() < 20 && t.q.len() == 52, "{} and {} coordinates", s.q.len(), t.q.len());
        let d = difference(&few, &every);
        assert!(d < 1e-6, "damping {damping}: histories differ by {d:.2e}");
    }
}

/// A contact damped so that motion under load forgets its past: two runs can be compared for long.
fn damped(per_width: f64) -> ContactSpec {
    ContactSpec { damping: Damping::KelvinVoigtRatio { ratio: 0.1 }, ..contact(per_width) }
}

#[test]
fn active_teeth_equal_all_teeth_over_revolutions_under_load() {
    for direction in [1.0, -1.0] {
        let mut spec = loaded(direction, 300.0, 80.0);
        // The pinion is driven, so the load cannot run away.
        spec.gears[0].mount = Mount::Driven(Profile::Constant(direction * 300.0));
        let t_end = 2.3 * std::f64::consts::TAU / 300.0;
        let teeth = movable(1e8, M, 150.0);
        let run = |m: ModelSpec, rtol: f64| watch(&spec, &[m.clone(), m], &damped(5e9), t_end, rtol);
        let (few, s, scene) = run(teeth.clone(), 1e-9);
        let (every, _, _) = run(all_teeth(teeth.clone()), 1e-9);
        let (again, _, _) = run(teeth, 1e-10);
        let (d, own) = (difference(&few, &every), difference(&few, &again));
        println!("direction {direction}: {} handovers, jump {:.1e}, active to all {d:.2e}, own error {own:.2e}", few.handovers, few.jump);
        // 46 of the pinion and as many of the wheel.
        assert!(few.handovers > 80, "{} handovers", few.handovers);
        assert!(few.jump < 1e-12, "momentum or energy jumps by {:.2e} at a handover", few.jump);
        assert!(d < 10.0 * own.max(1e-8) && d < 1e-4, "histories differ by {d:.2e}, own error {own:.2e}");
        let wheel = s.q[scene.gears()[1].range().start];
        assert!(-wheel * direction > 1.5 * std::f64::consts::TAU, "{wheel}");
    }
}

/// An idler between two gears, driven by the first against a load on the last.
fn train(torque: f64) -> SceneSpec {
    let mut first = gear("first", spur(20), 0.0, 200.0);
    first.loads = vec![Load::Applied(Profile::Constant(torque))];
    let idler = gear("idler", spur(30), 0.1001, -200.0 / 1.5);
    let mut last = gear("last", spur(20), 0.1001, 200.0);
    last.position = [0.1001, 0.1001];
    last.loads = vec![Load::Applied(Profile::Constant(-torque))];
    SceneSpec {
        gears: vec![first, idler, last],
        meshes: vec![
            MeshSpec { gears: [0, 1], start: start(Side::Left, 2e-6) },
            MeshSpec { gears: [1, 2], start: start(Side::Right, 2e-6) },
        ],
    }
}

#[test]
fn an_idler_has_two_windows() {
    let t_end = 0.01;
    let run = |m: ModelSpec, rtol: f64| {
        watch(&train(20.0), &[m.clone(), m.clone(), m], &damped(5e9), t_end, rtol)
    };
    // Little damping: teeth still ring when they leave their window.
    let teeth = movable(1e8, M, 30.0);
    let (few, s, scene) = run(teeth.clone(), 1e-9);
    let (every, _, _) = run(all_teeth(teeth.clone()), 1e-9);
    let (again, _, _) = run(teeth, 1e-10);
    let idler = scene.gears()[1].range().len();
    assert!(idler < 20, "{idler} coordinates of the idler");
    assert!(few.handovers > 8 && few.jump < 1e-12, "{} handovers, jump {:.2e}", few.handovers, few.jump);
    let (d, own) = (difference(&few, &every), difference(&few, &again));
    println!("idler: active to all {d:.2e}, own error {own:.2e}");
    assert!(d < 10.0 * own.max(1e-8), "histories differ by {d:.2e} over {:.3} rad, own error {own:.2e}", s.q[0]);
}

#[test]
fn all_teeth_are_integrated_where_windows_do_not_fit() {
    let coordinates = |spec: &SceneSpec, models: &[ModelSpec], i: usize| {
        build(spec, models, &contact(1e10)).gears()[i].range().len()
    };
    let teeth = movable(K, M, 0.0);
    let pair = [teeth.clone(), teeth.clone()];
    assert!(coordinates(&case_a(3e-6), &pair, 0) < 10);
    // Unequal teeth.
    let mut k = vec![K; 20];
    k[3] *= 0.5;
    let cracked = with(teeth.clone(), "tooth_stiffness_n_per_m", Value::List(k));
    assert_eq!(coordinates(&case_a(3e-6), &[cracked, rigid()], 0), 21);
    // Two meshes side by side on a small idler: the windows would overlap.
    let mut close = train(0.0);
    close.gears[0] = gear("first", spur(30), 0.0, 0.0);
    close.gears[1] = gear("idler", spur(14 + 6), 0.1001, 0.0);
    let angle = 100f64.to_radians();
    close.gears[2] = gear("last", spur(30), 0.0, 0.0);
    close.gears[2].position = [0.1001 - 0.1001 * angle.cos(), 0.1001 * angle.sin()];
    let three = [teeth.clone(), with(teeth.clone(), "tooth_mass_kg", Value::Number(1e-3)), teeth];
    let n = coordinates(&close, &three, 1);
    let small = 0.1001 - 0.1001 * 40f64.to_radians().cos();
    close.gears[2].position = [small, 0.1001 * 40f64.to_radians().sin()];
    let tight = coordinates(&close, &three, 1);
    assert!(n < 21 && tight == 21, "{n} coordinates apart, {tight} close together");
}

#[test]
fn the_cost_does_not_grow_with_the_number_of_teeth() {
    let n = |z: u32| {
        let params = spur(z);
        let x = 0.5 * 4e-3 * f64::from(z + 30) + 1e-4;
        let spec = pair_of(gear("a", params, 0.0, 1.0), gear("b", spur(30), x, 0.0), start(Side::Left, 3e-6));
        let small = movable(K, 1e-4, 0.0);
        build(&spec, &[small.clone(), small], &contact(1e10)).gears()[0].range().len()
    };
    assert!(n(200) <= n(25) + 2, "{} against {}", n(200), n(25));
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
    assert!(s.v[..scene.gears()[0].range().len()].iter().all(|&v| v == 25.0));
    let mut out = Outputs::default();
    scene.output(s.at(), &mut out);
    assert_eq!(out.energy.strain, 0.0);
}

/// `k(r)` falls from root to tip.
fn by_radius(damping: f64) -> ModelSpec {
    let gear = Gear::new(spur(20)).unwrap();
    let r = [gear.r_form(), gear.r_reference(), gear.r_tip()];
    let model = with(movable(6e8, M, damping), "stiffness_radius_m", Value::List(r.to_vec()));
    let model = with(model, "stiffness_at_radius_n_per_m", Value::List(vec![6e8, 4.5e8, 2.5e8]));
    let mut model = model;
    model.parameters.remove("tooth_stiffness_n_per_m");
    model
}

#[test]
fn stiffness_over_the_radius_books_its_jumps_and_work() {
    // Under load over several pitches: teeth enter and leave, each time between k0 and k(r).
    for model in [by_radius(60.0), all_teeth(by_radius(60.0))] {
        let spec = loaded(1.0, 60.0, 20.0);
        let mut scene = build(&spec, &[model.clone(), rigid()], &contact(5e10));
        let mut s = scene.initial();
        let mut ledger = Ledger::default();
        let plan = TimePlan::new(0.01, Resolution::Tolerance(1e-9));
        let (_, mut method) = gearbench_integrators::method("dopri5").unwrap();
        let mut work = Work::default();
        method.run(&mut scene, &mut s, &plan, &mut ledger, &mut work).unwrap();
        assert!(work.events > 10, "{} events", work.events);
        assert!(ledger.parametric.abs() > 1e-7, "parametric {:e}", ledger.parametric);
        assert!(ledger.jumps.abs() > 1e-7, "jumps {:e}", ledger.jumps);
        let residual = ledger.residual_relative();
        assert!(residual.abs() < 1e-6, "{residual:.2e} of the energy is not explained");
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
    assert_eq!(engaged_teeth(&scene, &s), scene.contact_forces(s.at()).len());
    assert!(engaged_teeth(&scene, &s) > 0);
    let wheel = scene.gears()[1].range().start;
    s.q[wheel] -= 3e-4;
    scene.begin(&mut s, true);
    assert_eq!(engaged_teeth(&scene, &s), 0);
}

/// Teeth of the first gear that use `k(r)`: those whose spring answers with another stiffness than at rest.
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
        let at = gearbench_integrators::At { q: &q, ..own };
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
