//! Conservation laws of the methods: energy over long runs where declared, linear invariants always.

use crate::problems::*;
use gearbench_integrators::{AcceptedStep, Control, METHODS, SecondOrderSystem, Sink};

/// Largest deviation of the chain's energy in the first and the last tenth of a run.
struct EnergyBand<'a> {
    chain: &'a Chain,
    t_end: f64,
    start: f64,
    first: f64,
    last: f64,
}

impl Sink for EnergyBand<'_> {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let deviation = (self.chain.energy(step.to) / self.start - 1.0).abs();
        if step.to.t < 0.1 * self.t_end {
            self.first = self.first.max(deviation);
        } else if step.to.t > 0.9 * self.t_end {
            self.last = self.last.max(deviation);
        }
        Control::Continue
    }
}

#[test]
fn symplectic_methods_hold_energy_on_long_runs() {
    for id in ["velocity-verlet", "semi-implicit-euler"] {
        let mut chain = Chain {
            masses: vec![1.0, 2.0],
            damping: 0.0,
        };
        let s = state(&[0.0, 0.3], &[0.4, -0.1]);
        let watched = Chain {
            masses: chain.masses.clone(),
            damping: 0.0,
        };
        let t_end = 2e4;
        let mut band = EnergyBand {
            start: watched.energy(&s),
            chain: &watched,
            t_end,
            first: 0.0,
            last: 0.0,
        };
        watch(id, &mut chain, s, &steps(t_end, 1e6), &mut band);
        println!(
            "{id:20} energy within {:.2e} early, {:.2e} late",
            band.first, band.last
        );
        // The band is as wide in the end as in the beginning, after eight thousand periods.
        assert!(
            band.last < 1.02 * band.first + 1e-12,
            "{id}: {:.3e} {:.3e}",
            band.first,
            band.last
        );
    }
}

#[test]
fn every_method_conserves_momentum_to_rounding() {
    for method in METHODS {
        let mut chain = Chain {
            masses: vec![1.0, 2.7],
            damping: 0.2,
        };
        let s = state(&[0.0, 0.7], &[1.3, -0.4]);
        let before = chain.momentum(&s.v);
        let plan = plan_of(method, 50.0, 5000.0, 1e-6);
        let (s, _) = solve(method, &mut chain, s, &plan);
        let drift = (chain.momentum(&s.v) / before - 1.0).abs();
        println!("{:20} momentum drift {drift:.1e}", method.info.id);
        assert!(drift <= 1e-12, "{}: {drift:.1e}", method.info.id);
    }
}

#[test]
fn every_method_keeps_the_gears_invariant_through_impacts() {
    for method in METHODS {
        let mut hammer = Hammer::gears(0.05);
        let s = hammer.start();
        let before = hammer.momentum(&s.v);
        let plan = plan_of(method, 0.05, 20_000.0, 1e-7);
        let (s, work) = solve(method, &mut hammer, s, &plan);
        let drift = (hammer.momentum(&s.v) / before - 1.0).abs();
        assert!(
            work.events >= 10,
            "{}: {} events",
            method.info.id,
            work.events
        );
        assert!(drift <= 1e-12, "{}: {drift:.1e}", method.info.id);
    }
}

#[test]
fn dissipated_energy_of_an_elastic_impact_falls_with_the_order() {
    let hammer = Hammer::one_impact(0.0);
    let t_end = after_impact(&hammer);
    let energy = |v: &[f64]| hammer.inertia[0] * v[0] * v[0] + hammer.inertia[1] * v[1] * v[1];
    for method in fixed_step() {
        let info = method.info;
        let loss: Vec<(f64, f64)> = (0..8)
            .map(|i| {
                let n = (200.0 * f64::powf(1.25, f64::from(i))).round();
                let (s, _) = solve(
                    method,
                    &mut hammer.clone(),
                    hammer.start(),
                    &steps(t_end, n),
                );
                let change = energy(&s.v) / energy(&hammer.start().v) - 1.0;
                (t_end / n, change.abs().max(1e-16))
            })
            .collect();
        let finest = loss[7].1;
        // Either at rounding or falling at least as fast as the order.
        let observed = slope(&loss);
        println!(
            "{:20} energy error {finest:.1e}, order {observed:.2}",
            info.id
        );
        assert!(
            finest < 1e-12 || observed > f64::from(info.order) - 0.3,
            "{}: {observed:.2} {loss:?}",
            info.id
        );
    }
}
