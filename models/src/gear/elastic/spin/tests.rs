//! Properties of the spin terms for any integrals: momentum and energy are conserved, tangents are derivatives.

use super::*;
use crate::Vec3;
use crate::gear::capabilities::{CoupledMass, LinearMotion};
use crate::gear::elastic::reduced::Reduced;
use crate::gear::model::GearModel;
use crate::geometry::{FlankGrid, Flanks, Side};
use crate::kinematics::{Hub, Placement, Wrench};
use crate::spec::Profile;
use std::sync::Arc;

const MODES: usize = 4;
const INERTIA: f64 = 2e-4;

/// Returns repeatable pseudo-random numbers.
fn noise(n: usize, seed: f64) -> Vec<f64> {
    (0..n)
        .map(|i| ((i as f64 * 12.9898 + seed).sin() * 43_758.545_3).fract())
        .collect()
}

/// Builds integrals of realistic size: shapes of unit mass move all of it in the plane.
fn integrals() -> Integrals {
    let (g, c) = (noise(MODES * MODES, 1.0), noise(MODES * MODES, 2.0));
    let mut planar = vec![0.0; MODES * MODES];
    let mut gyroscopic = planar.clone();
    for i in 0..MODES {
        for j in 0..MODES {
            let (a, b) = (i * MODES + j, j * MODES + i);
            planar[a] = 0.1 * (g[a] + g[b]) + f64::from(u8::from(i == j)) * 0.7;
            gyroscopic[a] = 0.3 * (c[a] - c[b]);
        }
    }
    Integrals {
        translation: vec![0.0; 3 * MODES],
        rotation: vec![0.0; 3 * MODES],
        radial: noise(MODES, 3.0).iter().map(|x| 0.01 * x).collect(),
        planar,
        gyroscopic,
        ..Integrals::default()
    }
}

fn gear(mount: Mount, terms: SpinTerms) -> Elastic {
    let free = matches!(mount, Mount::Revolute);
    let positions: Vec<Vec3> = [(0.03, -1.0), (0.03, 1.0), (0.035, -1.0), (0.035, 1.0)]
        .map(|(x, z)| Vec3::new(x, 0.001, 0.005 * z))
        .to_vec();
    let grid = FlankGrid {
        tooth: 0,
        side: Side::Left,
        rows: 2,
        columns: 2,
        nodes: vec![0, 1, 2, 3],
        positions,
    };
    let data = Reduced {
        near_field: None,
        flanks: Flanks::new(vec![grid]),
        normals: vec![Vec3::y(); 4],
        along_profile: false,
        free,
        inertia: INERTIA,
        omega: vec![8e3, 8e3, 1.1e4, 1.7e4],
        damping: vec![0.0; MODES],
        shapes: noise(4 * MODES, 4.0),
        hub: vec![0.0; MODES],
        participation: if free {
            vec![0.0; MODES]
        } else {
            noise(MODES, 5.0).iter().map(|x| 0.01 * x).collect()
        },
        residual: None,
        momentum: vec![[0.0; 2]; MODES],
        unbalance: [0.0; 2],
        integrals: Some(integrals()),
        lateral: None,
    };
    let hub = Hub::new(mount, Vec3::zeros(), None, 1.0);
    let placement = Placement::new(&hub, 0.0);
    Elastic::new(hub, 0.03, placement, Arc::new(data))
        .unwrap()
        .with_spin_terms(terms)
        .unwrap()
}

fn at<'a>(t: f64, q: &'a [f64], v: &'a [f64]) -> StateView<'a> {
    StateView {
        t,
        q,
        v,
        discrete: &[],
    }
}

fn acceleration(gear: &mut Elastic, t: f64, q: &[f64], v: &[f64]) -> Vec<f64> {
    let mut f = vec![0.0; q.len()];
    gear.forces(at(t, q, v), &mut f);
    // Modes have unit masses.
    if let Some(mass) = gear.coupled_mass() {
        mass.solve(at(t, q, v), &mut f);
    }
    f
}

/// Integrates with the classical Runge-Kutta method of order four.
fn run(gear: &mut Elastic, q: &mut [f64], v: &mut [f64], end: f64, steps: usize) {
    let h = end / steps as f64;
    let shifted = |x: &[f64], d: &[f64], h: f64| -> Vec<f64> {
        x.iter().zip(d).map(|(x, d)| x + h * d).collect()
    };
    for step in 0..steps {
        let t = h * step as f64;
        let a1 = acceleration(gear, t, q, v);
        let (q2, v2) = (shifted(q, v, 0.5 * h), shifted(v, &a1, 0.5 * h));
        let a2 = acceleration(gear, t + 0.5 * h, &q2, &v2);
        let (q3, v3) = (shifted(q, &v2, 0.5 * h), shifted(v, &a2, 0.5 * h));
        let a3 = acceleration(gear, t + 0.5 * h, &q3, &v3);
        let (q4, v4) = (shifted(q, &v3, h), shifted(v, &a3, h));
        let a4 = acceleration(gear, t + h, &q4, &v4);
        for i in 0..q.len() {
            q[i] += h / 6.0 * (v[i] + 2.0 * v2[i] + 2.0 * v3[i] + v4[i]);
            v[i] += h / 6.0 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i]);
        }
    }
}

#[test]
fn a_free_gear_that_spins_and_vibrates_keeps_momentum_and_energy() {
    let start = || {
        let mut q = noise(1 + MODES, 6.0);
        let mut v = noise(1 + MODES, 7.0);
        for (q, v) in q[1..].iter_mut().zip(&mut v[1..]) {
            (*q, *v) = (*q * 1e-3, *v * 3.0);
        }
        v[0] = 900.0;
        (q, v)
    };
    // Momentum and energy after a time, over those at the start.
    let drift = |terms: SpinTerms, steps: usize| {
        let mut gear = gear(Mount::Revolute, terms);
        let (mut q, mut v) = start();
        let of = |g: &Elastic, q: &[f64], v: &[f64]| {
            let state = at(0.0, q, v);
            (g.hub_state(state).momentum, g.energy(state).total())
        };
        let before = of(&gear, &q, &v);
        run(&mut gear, &mut q, &mut v, 2e-3, steps);
        let after = of(&gear, &q, &v);
        let hub = (v[0] / 900.0 - 1.0).abs();
        (
            (after.0 / before.0 - 1.0).abs(),
            (after.1 / before.1 - 1.0).abs(),
            hub,
        )
    };
    let (coarse, fine) = (drift(SpinTerms::Full, 200), drift(SpinTerms::Full, 400));
    // The effect of the deformation on the speed of the hub is far larger than the error of the method.
    assert!(fine.2 > 1e-3, "{fine:?}");
    assert!(fine.0 < 1e-6 && fine.1 < 1e-5, "{fine:?}");
    // Order four or better.
    assert!(
        coarse.0 > 12.0 * fine.0 && coarse.1 > 12.0 * fine.1,
        "{coarse:?} {fine:?}"
    );
    // Without the terms the hub's speed does not change at all.
    assert_eq!(drift(SpinTerms::None, 100).2, 0.0);
}

fn ramp() -> Mount {
    Mount::Driven(Profile::Ramp {
        from: 100.0,
        to: 900.0,
        start: 0.0,
        end: 1e-2,
    })
}

#[test]
fn tangent_is_the_derivative_of_the_force() {
    for mount in [Mount::Revolute, ramp()] {
        let mut gear = gear(mount, SpinTerms::Full);
        let n = gear.hub().len();
        let q: Vec<f64> = noise(n, 6.0).iter().map(|x| 1e-3 * x).collect();
        let v: Vec<f64> = noise(n, 7.0).iter().map(|x| 500.0 * x).collect();
        let dq: Vec<f64> = noise(n, 8.0).iter().map(|x| 1e-5 * x).collect();
        let dv = noise(n, 9.0);
        let mut exact = vec![0.0; n];
        gear.tangent(at(4e-3, &q, &v), &dq, &dv, &mut exact);
        let mut side = |sign: f64| {
            let shift = |x: &[f64], d: &[f64]| -> Vec<f64> {
                x.iter().zip(d).map(|(x, d)| x + sign * 1e-3 * d).collect()
            };
            let mut f = vec![0.0; n];
            gear.forces(at(4e-3, &shift(&q, &dq), &shift(&v, &dv)), &mut f);
            f
        };
        let (plus, minus) = (side(1.0), side(-1.0));
        let largest = exact.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for i in 0..n {
            let difference = 500.0 * (plus[i] - minus[i]);
            assert!(
                (difference - exact[i]).abs() < 1e-8 * largest,
                "{i}: {difference} {}",
                exact[i]
            );
        }
    }
}

#[test]
fn mass_solves_what_mass_makes_and_is_the_kinetic_energy() {
    let gear = gear(Mount::Revolute, SpinTerms::Full);
    let n = 1 + MODES;
    let q: Vec<f64> = noise(n, 6.0).iter().map(|x| 1e-3 * x).collect();
    let v = noise(n, 7.0);
    let mut f = vec![0.0; n];
    CoupledMass::apply(&gear, at(0.0, &q, &v), &v, &mut f);
    let twice: f64 = f.iter().zip(&v).map(|(f, v)| f * v).sum();
    let kinetic = gear.energy(at(0.0, &q, &v)).kinetic;
    assert!((0.5 * twice / kinetic - 1.0).abs() < 1e-12);
    // The momentum is that of the turn.
    assert!((gear.hub_state(at(0.0, &q, &v)).momentum / f[0] - 1.0).abs() < 1e-12);
    CoupledMass::solve(&gear, at(0.0, &q, &v), &mut f);
    for (a, b) in f.iter().zip(&v) {
        assert!((a - b).abs() < 1e-12);
    }
}

#[test]
fn the_power_of_a_drive_is_what_the_energy_changes_by() {
    let mut gear = gear(ramp(), SpinTerms::Full);
    let mut q: Vec<f64> = noise(MODES, 6.0).iter().map(|x| 1e-3 * x).collect();
    let mut v = noise(MODES, 7.0);
    let (steps, end) = (4000, 1e-3);
    let h = end / steps as f64;
    let energy = |g: &Elastic, q: &[f64], v: &[f64]| g.energy(at(0.0, q, v)).total();
    let before = energy(&gear, &q, &v);
    let mut work = 0.0;
    for step in 0..steps {
        // The trapezoidal rule over a step of the run.
        let t = h * step as f64;
        work += 0.5 * h * gear.driven_power(at(t, &q, &v));
        let (mut q1, mut v1) = (q.clone(), v.clone());
        step_of(&mut gear, t, h, &mut q1, &mut v1);
        work += 0.5 * h * gear.driven_power(at(t + h, &q1, &v1));
        (q, v) = (q1, v1);
    }
    let change = energy(&gear, &q, &v) - before;
    assert!(
        (change - work).abs() < 2e-4 * change.abs(),
        "{change} {work}"
    );
}

/// The torque of a drive equals the rate of the momentum.
#[test]
fn the_torque_of_a_drive_is_the_rate_of_the_momentum() {
    let mut gear = gear(ramp(), SpinTerms::Full);
    let q: Vec<f64> = noise(MODES, 6.0).iter().map(|x| 1e-3 * x).collect();
    let v = noise(MODES, 7.0);
    let (t, h) = (4e-3, 1e-7);
    let none = vec![0.0; MODES];
    let torque = gear
        .mount_reaction(at(t, &q, &v), &none, &Wrench::default())
        .torque;
    let mut momentum = |h: f64| {
        let (mut q, mut v) = (q.clone(), v.clone());
        step_of(&mut gear, t, h, &mut q, &mut v);
        gear.hub_state(at(t + h, &q, &v)).momentum
    };
    let rate = (momentum(h) - momentum(-h)) / (2.0 * h);
    assert!((torque / rate - 1.0).abs() < 1e-5, "{torque} {rate}");
}

/// Makes one step from time `t`, in two halves.
fn step_of(gear: &mut Elastic, t: f64, h: f64, q: &mut [f64], v: &mut [f64]) {
    let h = 0.5 * h;
    for half in 0..2 {
        let t = t + h * f64::from(half);
        let a = acceleration(gear, t, q, v);
        let qm: Vec<f64> = q.iter().zip(&*v).map(|(q, v)| q + 0.5 * h * v).collect();
        let vm: Vec<f64> = v.iter().zip(&a).map(|(v, a)| v + 0.5 * h * a).collect();
        let a = acceleration(gear, t + 0.5 * h, &qm, &vm);
        for i in 0..q.len() {
            q[i] += h * vm[i];
            v[i] += h * a[i];
        }
    }
}

#[test]
fn terms_enter_by_themselves_beyond_the_limit() {
    let lowest = 8e3;
    for (part, spins) in [(0.9, false), (1.1, true), (-1.1, true)] {
        let mut gear = gear(Mount::Revolute, SpinTerms::Auto);
        gear.decide_spin_terms(part * AUTO_LIMIT * lowest);
        assert_eq!(gear.spinning().is_some(), spins);
        assert_eq!(gear.oscillators().is_none(), spins);
        assert_eq!(gear.coupled_mass().is_some(), spins);
    }
    // A driven hub is judged by its fastest.
    let mut driven = gear(ramp(), SpinTerms::Auto);
    driven.decide_spin_terms(0.0);
    assert!(driven.spinning().is_some());
    let mut still = gear(Mount::Fixed, SpinTerms::Full);
    still.decide_spin_terms(0.0);
    assert!(still.spinning().is_none());
    // Requested terms are refused if the reduction does not contain them.
    let mut bare = gear(Mount::Revolute, SpinTerms::None);
    bare.decide_spin_terms(1e6);
    assert!(bare.spinning().is_none());
    let mut data = bare.data().clone();
    data.integrals = None;
    let hub = bare.hub().hub.clone();
    let placement = Placement::new(&hub, 0.0);
    let without = Elastic::new(hub, 0.03, placement, Arc::new(data)).unwrap();
    let e = without.with_spin_terms(SpinTerms::Full).unwrap_err();
    assert!(e.cause.contains("inertia integrals"), "{e}");
}
