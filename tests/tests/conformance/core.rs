//! Properties of every model of the joined table under every method that supports it: an impact conserves the energy,
//! gears receive the impulse of their contact torques, tangents are derivatives of forces, and Newton corrections
//! invert them.

use gearbench_integrators::observers::Tee;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{
    Coeffs, METHODS, Method, MethodInfo, Resolution, SecondOrderSystem, Stepping, TimePlan,
};
use gearbench_models::scene::Scene;
use gearbench_tests::*;
use std::collections::BTreeSet;

/// End after the impact, before the opposite flanks touch, and initial gap.
const T_END: f64 = 1.5e-4;
const GAP: f64 = 3.1e-6;

/// Returns true if a gear has so many coordinates that a single method is tested: implicit, with few steps.
fn is_large(scene: &Scene) -> bool {
    scene.gears().iter().any(|g| g.model.large().is_some())
}

fn stands_for_all(info: &MethodInfo) -> bool {
    info.implicit && info.stepping == Stepping::Fixed && !info.dissipative
}

/// Returns the resolution, and the largest relative change of the energy under a method without dissipation.
fn resolution_of(info: &MethodInfo, large: bool) -> (Resolution, f64) {
    match (info.stepping, info.order) {
        _ if large => (Resolution::Step(2e-6), 5e-3),
        _ if info.linear_part => (Resolution::Step(2e-7), 2e-5),
        (Stepping::Adaptive, _) => (Resolution::Tolerance(1e-6), 1e-4),
        (_, 0 | 1) => (Resolution::Step(4e-9), 1e-4),
        (_, 2) => (Resolution::Step(5e-8), 2e-5),
        _ => (Resolution::Step(1e-7), 2e-5),
    }
}

fn keeps_energy_and_momentum(name: &str, scene: &mut Scene, method: &Method) {
    let info = method.info;
    let what = format!("{name} under {}", info.id);
    let large = is_large(scene);
    let (resolution, limit) = resolution_of(info, large);
    let start = scene.initial();
    let (mut ledger, mut impulse) = (Ledger::default(), Impulse::new(scene, &start));
    let plan = TimePlan::new(T_END, resolution);
    let mut sinks = Tee(vec![&mut ledger, &mut impulse]);
    let (s, _) = watched(scene, start, info.id, &plan, &mut sinks);
    assert!(impulse.peak > 100.0, "{what}: {} N", impulse.peak);
    assert_eq!(ledger.end.contact, 0.0, "{what}: still in contact");
    let energy = ledger.end.total() / ledger.start.unwrap().total() - 1.0;
    let momentum = impulse.error(scene, &s);
    println!("{what}, {resolution:?}: energy {energy:+.1e}, impulse off by {momentum:.1e}");
    if !info.dissipative {
        assert!(energy.abs() < limit, "{what}: energy {energy:.1e}");
    }
    let limit = match resolution {
        Resolution::Step(_) => 1e-5,
        // Steps under a tolerance are as long as an impact: the rule itself is coarse.
        Resolution::Tolerance(_) => 5e-2,
    };
    assert!(momentum < limit, "{what}: impulse off by {momentum:.1e}");
}

#[test]
fn impacts_keep_energy_and_momentum_under_every_method() {
    let mut held = BTreeSet::new();
    for subject in subjects() {
        let mut scene = subject.scene(GAP);
        let large = is_large(&scene);
        let split = scene.modal().is_some();
        for method in METHODS {
            if (large && !stands_for_all(method.info)) || (method.info.linear_part && !split) {
                continue;
            }
            keeps_energy_and_momentum(&subject.name, &mut scene, method);
            held.insert((subject.model.id, method.info.id));
        }
    }
    for model in &*joined().models {
        let methods = held.iter().filter(|(id, _)| *id == model.id).count();
        let least = if model.properties.full_order {
            1
        } else {
            METHODS.len() - usize::from(!model.properties.modes)
        };
        assert!(methods >= least, "{} under {methods} methods", model.id);
    }
}

/// Returns a subject with overlapping flanks and displaced own coordinates.
fn overlapping(subject: &Subject) -> (Scene, gearbench_integrators::State) {
    let mut scene = subject.scene(-8e-6);
    let mut s = scene.initial();
    let (sq, _) = scales(&scene);
    let mut numbers = Numbers::new(11);
    for g in scene.gears() {
        for i in g.range().skip(1) {
            s.q[i] += 0.05 * sq[i] * numbers.draw();
        }
    }
    assert!(!scene.contact_forces(s.at()).is_empty(), "{}", subject.name);
    (scene, s)
}

/// Tangents agree with central differences of the force along random directions, in work relative to the largest of a
/// gear.
#[test]
fn tangents_are_derivatives_of_forces() {
    for subject in subjects() {
        let (mut scene, s) = overlapping(&subject);
        let (sq, sv) = scales(&scene);
        let mut numbers = Numbers::new(5);
        let n = s.q.len();
        let small = 1e-9 / scene.magnitudes().deflection;
        let gears: Vec<_> = scene.gears().iter().map(|g| g.range()).collect();
        let mut worst = 0.0_f64;
        for _ in 0..6 {
            let (dq, dv) = (numbers.vector(&sq), numbers.vector(&sv));
            let mut df = vec![0.0; n];
            scene.tangent_times(s.at(), &dq, &dv, &mut df);
            let slopes = force_slope(&mut scene, &s, [&dq, &dv], small);
            for range in &gears {
                let work = |i: usize, x: f64| (x * sq[i]).abs();
                let size = range.clone().fold(1e-12_f64, |m, i| m.max(work(i, df[i])));
                for i in range.clone() {
                    worst = worst.max(work(i, slopes[i] - df[i]) / size);
                }
            }
        }
        println!("{}: tangent off by {worst:.1e}", subject.name);
        assert!(worst < 3e-3, "{}: {worst:.1e}", subject.name);
    }
}

/// The Newton matrix times the correction of a random right-hand side equals that right-hand side.
#[test]
fn corrections_invert_the_newton_matrix() {
    for subject in subjects() {
        let (mut scene, s) = overlapping(&subject);
        let (sq, _) = scales(&scene);
        let (m, k) = (1.0, 2.5e-13);
        let rhs = Numbers::new(11).vector(&vec![1.0; sq.len()]);
        let rhs: Vec<f64> = rhs.iter().zip(&sq).map(|(r, s)| r / s).collect();
        let mut x = rhs.clone();
        scene
            .correct(s.at(), Coeffs { m, d: 0.0, k }, &mut x)
            .unwrap();
        let (mut mass, mut df) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        scene.apply_mass(s.at(), &x, &mut mass);
        scene.tangent_times(s.at(), &x, &vec![0.0; x.len()], &mut df);
        let off = (0..x.len()).map(|i| ((m * mass[i] - k * df[i] - rhs[i]) * sq[i]).abs());
        let worst = off.fold(0.0, f64::max);
        println!("{}: correction off by {worst:.1e}", subject.name);
        // Full finite elements leave out what the turning frame brings, of the order of the strain.
        let limit = if is_large(&scene) { 5e-2 } else { 1e-8 };
        assert!(worst < limit, "{}: {worst:.1e}", subject.name);
    }
}
