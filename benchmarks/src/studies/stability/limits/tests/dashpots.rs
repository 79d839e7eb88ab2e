//! Tests that dashpots at flanks of elastic gears do not limit velocity Verlet, which treats them implicitly: theory
//! against the amplification of the step itself, in the scene.

#![allow(clippy::print_stdout)]

use super::{entry, line, linearised};
use crate::experiment::configuration::Configuration;
use crate::studies::stability::limits::LineKind;
use crate::studies::stability::limits::linear::{Linear, eigenvalues};
use faer::Mat;
use gearbench_integrators::linear_stability::Stability;
use gearbench_integrators::table::VELOCITY_VERLET;
use gearbench_integrators::{NullSink, Resolution, SecondOrderSystem, State, TimePlan, Work};
use gearbench_models::scene::Scene;

/// Undamped elastic gears of sixty modes with dashpots [N s/m^3].
fn damped(dashpots: f64) -> Configuration {
    let mut entry = entry("spur_impact", "elastic");
    for gear in &mut entry.modelling.gears {
        gear.set("modes", 60).unwrap();
    }
    for contact in &mut entry.modelling.contacts {
        if let Some(points) = contact.flanks.points_mut() {
            *points = points.damped(dashpots);
        }
    }
    entry
}

/// Spectral radius of a step from a state, by differences of steps from states on either side of it.
fn radius(scene: &mut Scene, s: &State, h: f64) -> f64 {
    let n = s.q.len();
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    scene.scales(&mut q, &mut v);
    let scale: Vec<f64> = q.into_iter().chain(v).map(|x| 1e-6 * x).collect();
    let plan = TimePlan::new(s.t + h, Resolution::Step(h));
    let mut after = |j: usize, sign: f64| {
        let mut from = s.clone();
        match j < n {
            true => from.q[j] += sign * scale[j],
            false => from.v[j - n] += sign * scale[j],
        }
        let mut method = VELOCITY_VERLET.build();
        (method.run(scene, &mut from, &plan, &mut NullSink, &mut Work::default())).unwrap();
        [from.q, from.v].concat()
    };
    // In units of the scales: entries of size one.
    let mut amplification = Mat::zeros(2 * n, 2 * n);
    for j in 0..2 * n {
        let [ahead, behind] = [1.0, -1.0].map(|sign| after(j, sign));
        for i in 0..2 * n {
            amplification[(i, j)] = (ahead[i] - behind[i]) / (2.0 * scale[i]);
        }
    }
    let values = eigenvalues(&amplification).unwrap();
    values.iter().fold(0.0, |m, z| z[0].hypot(z[1]).max(m))
}

/// Largest rate at which neighbouring motions may depart from each other without an unstable step [1/s].
const LARGEST_DEPARTURE: f64 = 1e3;

#[test]
fn dashpots_at_flanks_do_not_limit_the_step() {
    let (mut without, mut least) = (None, f64::INFINITY);
    for dashpots in [0.0, 4e9, 1.6e10, 1.6e11] {
        let mut linearised = linearised(&damped(dashpots));
        let lines = linearised.lines(VELOCITY_VERLET).unwrap();
        let theory = line(&lines, LineKind::Stability).unwrap();
        // Were they explicit.
        let Linear::Dense(mut dense) = linearised.linear().unwrap() else {
            panic!("sixty modes are few")
        };
        assert_eq!(dense.at_ends.is_some(), dashpots > 0.0);
        dense.at_ends = None;
        let Stability::Flip(flip) = VELOCITY_VERLET.stability() else {
            panic!("velocity Verlet flips")
        };
        let explicit = Linear::Dense(dense).largest_step(&Stability::Flip(flip));
        let explicit = explicit.unwrap().unwrap();
        let s = linearised.closed().unwrap().clone();
        let scene = linearised.scene();
        let (mut low, mut high) = (0.5 * theory, 1.5 * theory);
        // The gears move, and how dashpots press the flanks changes with it: a neighbouring motion departs from this one by
        // itself, in proportion to the step.
        let departs = (radius(scene, &s, 0.2 * theory) - 1.0).max(0.0) / (0.2 * theory);
        assert!(departs < LARGEST_DEPARTURE, "{departs:e}");
        for _ in 0..10 {
            let h = 0.5 * (low + high);
            // Hubs that turn freely are a double eigenvalue of one, which rounding splits.
            match radius(scene, &s, h) > 1.0 + 1e-4 + 2.0 * departs * h {
                true => high = h,
                false => low = h,
            }
        }
        println!(
            "{dashpots:.1e} N s/m3: theory {theory:.4e} s, step {low:.4e} s, ratio {:.4}; explicit dashpots {explicit:.4e} s",
            low / theory
        );
        assert!((low / theory - 1.0).abs() < 0.02, "{low:e} {theory:e}");
        let undamped: f64 = *without.get_or_insert(theory);
        assert!(
            (theory / undamped - 1.0).abs() < 0.05,
            "{theory:e} {undamped:e}"
        );
        least = f64::min(explicit / theory, least);
    }
    // Explicit dashpots would limit it.
    assert!(least < 0.6, "{least}");
}
