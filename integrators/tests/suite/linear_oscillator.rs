//! Amplification on `x'' = -omega^2 x`: stability limits, spectral radius at infinite frequency.
//!
//! One step from unit vectors gives the columns of the amplification matrix. The generalised-alpha family
//! carries accelerations from step to step, so its matrix is three by three and its growth is measured on
//! a run instead.

use crate::problems::*;
use gearbench_integrators::{METHODS, Method, NullSink};

/// Returns the spectral radius of the one-step map of a self-starting method at `omega h`.
fn spectral_radius(m: &Method, omega_h: f64) -> f64 {
    let mut sys = Oscillator { omega: omega_h };
    let [a, b] = [[1.0, 0.0], [0.0, omega_h]].map(|[x, v]| {
        let (s, _) = solve(m, &mut sys, state(&[x], &[v]), &steps(1.0, 1.0));
        [s.q[0], s.v[0] / omega_h]
    });
    let (trace, det) = (a[0] + b[1], a[0] * b[1] - b[0] * a[1]);
    let disc = 0.25 * trace * trace - det;
    if disc < 0.0 {
        det.sqrt()
    } else {
        0.5 * trace.abs() + disc.sqrt()
    }
}

/// Returns the largest `omega h` up to which no step grows, by bisection.
fn stability_limit(m: &Method) -> f64 {
    let stable = |x: f64| spectral_radius(m, x) <= 1.0 + 1e-9;
    let (mut lo, mut hi) = (0.05, 4.0);
    for _ in 0..60 {
        let mid = 0.5 * (lo + hi);
        if stable(mid) {
            lo = mid;
        } else {
            hi = mid;
        }
    }
    lo
}

#[test]
fn explicit_methods_have_their_stability_limits() {
    for (id, limit) in [
        ("velocity-verlet", 2.0),
        ("semi-implicit-euler", 2.0),
        ("rk4", 8f64.sqrt()),
    ] {
        let observed = stability_limit(by_id(id));
        assert!((observed - limit).abs() < 1e-6, "{id}: {observed}");
    }
}

/// The boundary of Dormand-Prince crosses the imaginary axis close to one: |R(i y)| leaves one from below
/// before, so the limit is where it grows past one.
#[test]
fn dormand_prince_is_stable_to_one_on_the_imaginary_axis() {
    let m = by_id("dopri5");
    // |R(iy)|^2 of the fifth-order polynomial with its sixth-order term 1/600.
    let exact = |y: f64| {
        let y2 = y * y;
        let re = 1.0 - y2 / 2.0 + y2 * y2 / 24.0 - y2 * y2 * y2 / 600.0;
        let im = y * (1.0 - y2 / 6.0 + y2 * y2 / 120.0);
        re.hypot(im)
    };
    for y in [0.3, 0.9, 1.0, 1.5, 3.0] {
        let observed = spectral_radius(m, y);
        assert!(
            (observed - exact(y)).abs() < 1e-12,
            "{y}: {observed} {}",
            exact(y)
        );
    }
    let limit = stability_limit(m);
    assert!((0.9..1.1).contains(&limit), "{limit}");
}

/// Returns the amplitude after a number of unit steps.
fn amplitude(text: &str, sys: &mut Oscillator, n: f64) -> f64 {
    let start = state(&[1.0], &[0.0]);
    let (s, _) = watch(text, sys, start, &steps(n, n), &mut NullSink);
    s.q[0].hypot(s.v[0] / sys.omega)
}

/// Returns the decay per step of a stiff oscillator after the initial transient.
fn decay(text: &str, omega_h: f64) -> f64 {
    let mut sys = Oscillator { omega: omega_h };
    let mut norm = |n: f64| amplitude(text, &mut sys, n);
    // A double root grows linearly beside its power, so compare over many steps.
    let (n, m) = (2000.0, 1000.0);
    (norm(n) / norm(m)).powf(1.0 / (n - m))
}

#[test]
fn spectral_radius_at_infinity_is_the_declared_one() {
    for rho in [0.95, 0.98, 0.99] {
        let observed = decay(&format!("generalised-alpha(rho_inf={rho})"), 1e6);
        assert!((observed - rho).abs() < 3e-3, "rho_inf {rho}: {observed}");
    }
    for alpha in [0.0, 0.01, 0.02] {
        let observed = decay(&format!("hht-alpha(alpha={alpha})"), 1e6);
        let declared = (1.0 - alpha) / (1.0 + alpha);
        assert!(
            (observed - declared).abs() < 3e-3,
            "alpha {alpha}: {observed}"
        );
    }
    let observed = decay("newmark", 1e6);
    assert!((observed - 1.0).abs() < 3e-3, "newmark: {observed}");
}

/// Small spectral radii are measured early in the run, because the motion vanishes before a thousand steps.
#[test]
fn strong_damping_dies_out_within_a_few_steps() {
    for rho in [0.0, 0.3, 0.5, 0.7] {
        let text = format!("generalised-alpha(rho_inf={rho})");
        let left = |n: f64| amplitude(&text, &mut Oscillator { omega: 1e6 }, n);
        // A triple root grows with the square of the number of steps beside its power.
        let decay = (left(24.0) / left(12.0)).powf(1.0 / 12.0);
        let bound = rho * 4f64.powf(1.0 / 12.0) + 0.05;
        assert!(
            decay < bound || left(24.0) < 1e-12,
            "rho_inf {rho}: {decay:.3} above {bound:.3}"
        );
    }
}

#[test]
fn declared_dissipation_is_seen() {
    for m in METHODS {
        // A step that every method is stable at; the loss is compared over whole periods.
        let t_end = 40.0 * std::f64::consts::PI;
        let plan = plan_of(m, t_end, 800.0, 1e-4);
        let mut sys = Oscillator { omega: 1.0 };
        let (s, _) = solve(m, &mut sys, state(&[1.0], &[0.0]), &plan);
        let loss = 1.0 - (s.q[0].powi(2) + s.v[0].powi(2));
        println!("{:20} loses {loss:.2e} over 20 periods", m.info.id);
        if m.info.dissipative {
            assert!(loss > 1e-9, "{}: {loss:.2e}", m.info.id);
        } else {
            // Symplectic methods oscillate by O(h); none of them drains.
            assert!(loss.abs() < 3e-2, "{}: {loss:.2e}", m.info.id);
        }
    }
}
