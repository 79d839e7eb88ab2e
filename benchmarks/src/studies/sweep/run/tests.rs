//! Sweeps whose results are known in closed form or from a static solution.

use super::*;
use crate::experiment::conditions::Conditions;
use crate::experiment::runner::Runner;
use crate::scene_file::{Origin, SceneFile};
use crate::studies::test_scene::waves as scene;
use gearbench_models::spec::{Load, Mount, Profile, mesh_layout};
use std::f64::consts::TAU;

mod backlash;
mod continuation;

fn plan(scene: &SceneFile, frequencies: Vec<f64>, cycles: usize, settle: f64) -> Plan {
    Plan {
        conditions: Conditions {
            events: true,
            repeats: 0,
            ..Conditions::of(scene)
        },
        entries: vec![Configuration::of(scene, &scene.models[0])],
        standing: Vec::new(),
        method: gearbench_integrators::table::DOPRI5.at_tolerance(1e-7),
        frequencies,
        branches: vec![Branch::Fresh],
        cycles,
        settle,
        positions: 16,
    }
}

/// `x'' + 2 zeta w x' + w^2 (1 + e cos(W t)) x = w^2 d`: to first order in e the error vibrates about d with
/// `e d / sqrt((1 - r^2)^2 + (2 zeta r)^2)`, r = W / w.
#[test]
fn a_stiffness_wave_answers_as_an_oscillator_does() {
    let (depth, ratio) = (0.01, 0.05);
    let scene = scene(depth, ratio, 15.0);
    let still = plan(&scene, Vec::new(), 4, 4e-3);
    let fn_hz = mesh_resonance(&still, &still.entries[0]).unwrap().unwrap();
    let pair = Pair::in_scene("wave", &scene.spec).unwrap();
    let deflection = pair.own_force() / 1e8;
    let orders = [0.25, 0.8, 1.0, 1.25];
    let plan = plan(&scene, orders.map(|r| r * fn_hz).to_vec(), 4, 8e-3);
    let results = sweep(&plan, &Runner::default()).unwrap();
    for (run, r) in results.runs.iter().zip(orders) {
        assert!(!run.status.is_failure(), "{:?}", run.message);
        let s = run.steady.as_ref().unwrap();
        assert!((s.mesh_frequency_hz / (r * fn_hz) - 1.0).abs() < 1e-5);
        let expected =
            depth * deflection / ((1.0 - r * r).powi(2) + (2.0 * ratio * r).powi(2)).sqrt();
        let found = s.error_harmonics_m[0];
        assert!(
            (found / expected - 1.0).abs() < 0.03,
            "r = {r}: {found} {expected}"
        );
        assert!((s.error_mean_m / deflection - 1.0).abs() < 0.02);
        assert!(
            (s.force_mean_n / pair.own_force() - 1.0).abs() < 1e-3,
            "{}",
            s.force_mean_n
        );
        assert_eq!(s.separated, 0.0);
        // Rigid gears hand the force on.
        let b = &s.bearings[0];
        assert!(!b.own_inertia && (b.mean_n / s.force_mean_n - 1.0).abs() < 1e-6);
    }
    let still = &results.statics()[0];
    assert!((still.error_peak_to_peak_m / (2.0 * depth * deflection) - 1.0).abs() < 0.01);
}

/// With heavy damping, slow running follows the static transmission error.
#[test]
fn slow_running_comes_to_the_static_limit() {
    let scene = scene(0.2, 0.7, 15.0);
    let plan = plan(&scene, vec![60.0], 1, 1e-3);
    let results = sweep(&plan, &Runner::default()).unwrap();
    let s = results.runs[0].steady.as_ref().unwrap();
    let still = &results.statics()[0];
    assert!((s.error_peak_to_peak_m / still.error_peak_to_peak_m - 1.0).abs() < 0.02);
    // Both are evaluated at the same positions.
    for (p, e) in still.position.iter().zip(&still.error_m) {
        let near = |q: &f64| (q - p).abs();
        let i = (0..s.position.len())
            .min_by(|a, b| near(&s.position[*a]).total_cmp(&near(&s.position[*b])))
            .unwrap();
        let off = (s.error_cycle_m[i] - e).abs() / still.error_peak_to_peak_m;
        assert!(off < 0.03, "at {p}: {} {e}", s.error_cycle_m[i]);
    }
}

#[test]
fn what_cannot_be_swept_is_said() {
    let of = |s: &SceneFile| Pair::in_scene("wave", &s.spec).err().unwrap().to_string();
    assert!(of(&scene(0.1, 0.1, 14.0)).contains("not balanced"));
    let mut turned = scene(0.1, 0.1, 15.0);
    for g in &mut turned.spec.gears {
        let Load::Applied(torque) = &g.loads[0] else {
            panic!("a torque");
        };
        g.loads = vec![Load::Applied(torque.scaled(-1.0))];
    }
    assert!(of(&turned).contains("load this flank"));
    let mut driven = scene(0.1, 0.1, 15.0);
    for g in &mut driven.spec.gears {
        g.mount = Mount::Driven(Profile::Constant(1.0));
    }
    assert!(of(&driven).contains("no gear can vibrate"));
    driven.spec.gears[1].mount = Mount::Revolute;
    assert!(Pair::in_scene("wave", &driven.spec).is_ok());
}

/// In a pair of free gears with a brake on one, the other gets the torque that keeps the speed, and the contact force
/// is that of the brake at this speed.
#[test]
fn viscous_loads_count_at_the_speed_that_is_swept() {
    let mut scene = scene(0.01, 0.2, 0.0);
    scene.spec.gears[1].loads = vec![Load::Viscous(0.05)];
    let pair = Pair::in_scene("wave", &scene.spec).unwrap();
    let plan = plan(&scene, vec![300.0, 600.0], 2, 4e-3);
    let results = sweep(&plan, &Runner::default()).unwrap();
    for (run, f) in results.runs.iter().zip([300.0, 600.0]) {
        let s = run.steady.as_ref().unwrap();
        let brake = 0.05 * TAU * f / 30.0 / pair.base_radii[1];
        assert!(
            (s.force_mean_n / brake - 1.0).abs() < 1e-3,
            "{} {brake}",
            s.force_mean_n
        );
        assert!((s.mesh_frequency_hz / f - 1.0).abs() < 1e-4);
    }
}

/// Free vibrations of the gears within a slow mesh cycle are resolved: a step in the stiffness excites the resonance,
/// and its peak does not depend on the speed.
#[test]
fn the_peak_at_low_speed_does_not_depend_on_the_samples() {
    let mut scene = scene(0.0, 0.05, 15.0);
    let [a, b] = [&scene.spec.gears[0], &scene.spec.gears[1]];
    let l = mesh_layout(a, b).unwrap();
    let (mut at, mut k) = (Vec::new(), Vec::new());
    for (u, of) in [
        (-0.5, 1e8),
        (0.0, 1e8),
        (1e-4, 1.5e8),
        (0.49, 1.5e8),
        (0.5, 1e8),
    ] {
        at.push(l.pitch_point + u * l.base_pitch);
        k.push(of);
    }
    scene.models[0].modelling.contacts[0].stiffness =
        gearbench_models::stiffness::PairStiffness::Table {
            s: at,
            k,
            of: gearbench_models::stiffness::PairOrMesh::Mesh,
            ends: gearbench_models::stiffness::Ends::Periodic,
            interpolation: gearbench_models::stiffness::Interpolation::Linear,
        };
    let plan = plan(&scene, vec![10.0, 20.0, 40.0], 1, 1e-3);
    let results = sweep(&plan, &Runner::default()).unwrap();
    let peaks: Vec<f64> = (results.runs.iter())
        .map(|r| r.steady.as_ref().unwrap().force_peak_n)
        .collect();
    // The stiffness rises within a hundredth of a period of the resonance: half as much force for a moment.
    let pair = Pair::in_scene("wave", &scene.spec).unwrap();
    for p in &peaks {
        assert!((p / peaks[0] - 1.0).abs() < 0.03, "{peaks:?}");
        assert!(p / pair.own_force() > 1.3, "{peaks:?}");
    }
}
