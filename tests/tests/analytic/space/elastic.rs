//! Elastic gears on bearings and on axes that are not parallel.

use super::*;
use gearbench_integrators::SecondOrderSystem;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{Coeffs, StateView};
use gearbench_models::spec::{ContactSpec, FlankContact, ModelSpec, PointContact};

/// Returns the artificial elastic gear with nodes over the width.
pub fn toy() -> ModelSpec {
    model_of(
        "elastic-toy",
        [
            ("rows", 11.0),
            ("columns", 5.0),
            ("modes", 6.0),
            ("residual_m_per_n", 2e-9),
        ],
    )
}

pub fn on_points(damping: f64) -> ContactSpec {
    ContactSpec {
        flanks: FlankContact::Points(PointContact::new(1e15).damped(damping)),
        ..contact(1.5e10)
    }
}

/// Returns pairs in loaded contact on bearings, with both axes tilted, with descriptions.
fn pressed() -> Vec<(&'static str, Scene, State)> {
    let mut all = Vec::new();
    let teeth = || movable(5.3e8, 4.8e-3, 0.0);
    for (name, helix, models, damping, spins) in [
        ("spur", 0.0, [toy(), toy()], 0.0, false),
        ("helical", 0.25, [toy(), toy()], 0.0, false),
        ("helical with dashpots", 0.25, [toy(), toy()], 2e8, false),
        ("helical with spin terms", 0.25, [toy(), toy()], 0.0, true),
        ("on a rigid gear", 0.25, [toy(), rigid()], 0.0, false),
        ("on movable teeth", 0.25, [teeth(), toy()], 0.0, false),
        ("conical", 0.0, [reduced(), reduced()], 0.0, false),
    ] {
        let mut spec = match name {
            "conical" => conical::seed_pair(1e-5, 5e-6),
            _ => helical_pair(helix, 0.0, true),
        };
        tilt(&mut spec, 0, 4e-4, -2e-4);
        tilt(&mut spec, 1, -3e-4, 3e-4);
        for gear in &mut spec.gears {
            gear.lateral = on_bearings();
            if let Some(l) = &mut gear.lateral {
                l.spin = if spins { SpinTerms::On } else { SpinTerms::Off };
            }
        }
        let scene = build(&spec, &models, &on_points(damping));
        let mut numbers = Numbers::new(5);
        let mut s = displaced(&scene, &spec, 0.05, &mut numbers);
        for g in scene.gears() {
            let first = g.range().start + g.model.hub().first();
            let elastic = g.id.starts_with("elastic");
            for i in first..g.range().end {
                if elastic {
                    s.q[i] = 3e-6 * numbers.draw() / 1e2;
                }
                s.v[i] = 1e-2 * numbers.draw();
            }
        }
        all.push((name, scene, s));
    }
    all
}

fn force(scene: &mut Scene, at: StateView<'_>) -> Vec<f64> {
    let mut f = vec![0.0; at.q.len()];
    scene.force(at, &mut f);
    f
}

/// Returns the largest difference relative to the typical force of its coordinate.
fn off(scene: &Scene, found: &[f64], expected: &[f64]) -> f64 {
    let (scale, _) = scales(scene);
    let weighted = |x: &[f64]| {
        let all = x.iter().zip(&scale).map(|(x, s)| (x * s).abs());
        all.fold(0.0_f64, f64::max)
    };
    let difference: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
    weighted(&difference) / weighted(expected)
}

#[test]
fn forces_in_space_derive_from_one_potential() {
    for (name, mut scene, s) in pressed() {
        if name.contains("dashpots") {
            continue;
        }
        let still = vec![0.0; s.v.len()];
        let at = StateView {
            v: &still,
            ..s.at()
        };
        let f = force(&mut scene, at);
        let (scale, _) = scales(&scene);
        let mut slopes = vec![0.0; f.len()];
        for i in 0..f.len() {
            let h = 1e-4 * scale[i];
            let mut energy = |by: f64| {
                let mut q = s.q.clone();
                q[i] += by;
                let mut out = Outputs::default();
                scene.output(StateView { q: &q, ..at }, &mut out);
                out.energy.strain + out.energy.contact
            };
            slopes[i] = (energy(-h) - energy(h)) / (2.0 * h);
        }
        let off = off(&scene, &f, &slopes);
        let touching = scene.contact_forces(at).len();
        println!("{name}: {touching} points, forces beside slopes of the energy {off:.1e}");
        assert!(touching > 3, "{name}: {touching} points touch");
        assert!(off < 2e-5, "{name}: {off:.2e}");
    }
}

#[test]
fn tangents_in_space_are_slopes_of_the_forces() {
    for (name, mut scene, s) in pressed() {
        let (scale, rates) = scales(&scene);
        let mut numbers = Numbers::new(9);
        // Apart, bearings and spin terms are all there is; under contact directions that turn with the state are left out.
        let mut apart = s.clone();
        let back = if name == "conical" { 2e-3 } else { 8e-4 };
        apart.q[scene.gears()[0].range().start] -= back;
        let touching = [apart, s].map(|s| (scene.contact_forces(s.at()).len(), s));
        // Movable teeth have places of their own and stay.
        let parts = !name.contains("movable");
        assert!((touching[0].0 == 0 || !parts) && touching[1].0 > 3);
        for (points, s) in touching {
            let mut worst = 0.0_f64;
            for _ in 0..4 {
                let dq: Vec<f64> = scale.iter().map(|x| x * numbers.draw()).collect();
                let dv: Vec<f64> = rates.iter().map(|x| x * numbers.draw()).collect();
                let h = 1e-5;
                let mut moved = |by: f64| {
                    let q: Vec<f64> = s.q.iter().zip(&dq).map(|(q, d)| q + by * d).collect();
                    let v: Vec<f64> = s.v.iter().zip(&dv).map(|(v, d)| v + by * d).collect();
                    force(
                        &mut scene,
                        StateView {
                            q: &q,
                            v: &v,
                            ..s.at()
                        },
                    )
                };
                let (up, down) = (moved(h), moved(-h));
                let slopes: Vec<f64> = (up.iter().zip(&down))
                    .map(|(a, b)| (a - b) / (2.0 * h))
                    .collect();
                let mut tangent = vec![0.0; slopes.len()];
                scene.tangent_times(s.at(), &dq, &dv, &mut tangent);
                worst = worst.max(off(&scene, &tangent, &slopes));
            }
            println!("{name}, {points} points: tangent beside differences {worst:.1e}");
            let limit = if points == 0 { 1e-6 } else { 2e-2 };
            assert!(worst < limit, "{name}: {worst:.2e}");
        }
    }
}

#[test]
fn the_newton_correction_is_the_inverse_of_mass_and_tangent() {
    let c = Coeffs {
        m: 1.0,
        d: 5e-7,
        k: 2.5e-13,
    };
    for (name, mut scene, s) in pressed() {
        let n = s.q.len();
        let mut numbers = Numbers::new(3);
        let (scale, _) = scales(&scene);
        let rhs: Vec<f64> = scale.iter().map(|x| numbers.draw() / x).collect();
        let mut x = rhs.clone();
        scene.correct(s.at(), c, &mut x).unwrap();
        let mut a = vec![0.0; n * n];
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            let mut mass = vec![0.0; n];
            scene.apply_mass(s.at(), &unit, &mut mass);
            let (mut dq, mut dv) = (unit.clone(), unit);
            (dq[j], dv[j]) = (c.k, c.d);
            let mut df = vec![0.0; n];
            scene.tangent_times(s.at(), &dq, &dv, &mut df);
            for i in 0..n {
                a[i * n + j] = c.m * mass[i] - df[i];
            }
        }
        let mut expected = rhs;
        solve_in_place(&mut a, &mut expected).unwrap();
        let largest = |v: &[f64]| {
            v.iter()
                .zip(&scale)
                .fold(0.0_f64, |m, (x, s)| m.max((x / s).abs()))
        };
        let difference: Vec<f64> = x.iter().zip(&expected).map(|(a, b)| a - b).collect();
        let off = largest(&difference) / largest(&expected);
        println!("{name}: correction {off:.1e}");
        assert!(off < 1e-5, "{name}: {off:.2e}");
    }
}

/// Returns reduced gears from coarse meshes.
pub fn reduced() -> ModelSpec {
    model_of(
        "elastic",
        [
            ("flank_elements", 5),
            ("fillet_elements", 2),
            ("across_elements", 4),
            ("rim_elements", 2),
            ("width_elements", 3),
            ("modes", 20),
        ],
    )
}

/// On no bearing forces on both gears are one wrench; on one, all that the ground exerts goes through it.
#[test]
fn contact_of_elastic_gears_adds_no_momentum() {
    for (name, models) in [
        ("made-up", [toy(), toy()]),
        ("reduced", [reduced(), reduced()]),
        ("on a rigid gear", [reduced(), rigid()]),
        ("conical", [reduced(), reduced()]),
        ("conical on a rigid gear", [reduced(), rigid()]),
    ] {
        for bearing in [false, true] {
            let mut spec = match name.starts_with("conical") {
                true => conical::seed_pair(1e-5, 5e-6),
                false => helical_pair(0.25, 0.0, true),
            };
            tilt(&mut spec, 0, 4e-4, -2e-4);
            for gear in &mut spec.gears {
                gear.lateral = if bearing { on_bearings() } else { afloat() };
                if let Some(l) = &mut gear.lateral {
                    l.spin = SpinTerms::Off;
                }
            }
            let mut scene = build(&spec, &models, &on_points(0.0));
            let mut numbers = Numbers::new(3);
            let mut worst = 0.0_f64;
            for place in 0..6 {
                let mut s = displaced(&scene, &spec, 0.08 * f64::from(place) - 0.25, &mut numbers);
                for g in scene.gears() {
                    let modes = g.range().start + g.model.hub().first()..g.range().end;
                    s.q[modes]
                        .iter_mut()
                        .for_each(|q| *q = 1e-7 * numbers.draw());
                }
                let mut f = force(&mut scene, s.at());
                assert!(scene.contact_forces(s.at()).len() > 3);
                for g in scene.gears().iter().filter(|_| bearing) {
                    // What the bearing exerts on the hub where the modes have brought it, taken as one wrench there.
                    let (hub, own) = (&g.model.hub().hub, g.at(s.at()));
                    let lateral = hub.lateral.as_ref().unwrap();
                    let at_hub = g.model.hub_motion(own);
                    let frame = hub.motion(own.t, own.q, own.v);
                    let exerted = lateral.bearing_forces(&at_hub);
                    let first = g.range().start;
                    for (k, d) in hub.free_directions().enumerate() {
                        f[first + k] -= exerted[d];
                    }
                    // The hub stands off the frame: its force and its moments turn with it.
                    let off = |d: usize| at_hub.x[d] - frame.x[d];
                    f[first] -= off(0) * exerted[1] - off(1) * exerted[0];
                    f[first] -= off(3) * exerted[4] - off(4) * exerted[3];
                }
                worst = worst.max(work_of_rigid_motions(&scene, &s, &f));
            }
            println!("{name}, bearing {bearing}: momentum within {worst:.1e}");
            assert!(worst < 1e-9, "{name}: {worst:.2e}");
        }
    }
}
