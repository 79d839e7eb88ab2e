//! Order and tolerance through contact: impacts compared with exact piecewise solutions.

use crate::problems::*;
use gearbench_integrators::TimePlan;

/// Measures the order over one impact, with steps from a tenth of a radian of the contact vibration downwards.
fn impact_order(method: &gearbench_integrators::Method, zeta: f64, events: bool) -> f64 {
    let hammer = Hammer::one_impact(zeta);
    let t_end = after_impact(&hammer);
    let first = match method.info.order {
        1 => 800.0,
        2 => 100.0,
        _ => 30.0,
    };
    let points: Vec<(f64, f64)> = (0..12)
        .map(|i| {
            // Steps without a common divisor: where the impact falls within a step must average out.
            let n = (first * f64::powf(1.25, f64::from(i))).round();
            let plan = TimePlan {
                events,
                ..steps(t_end, n)
            };
            let (s, _) = solve(method, &mut hammer.clone(), hammer.start(), &plan);
            (t_end / n, hammer.error(&s).max(1e-17))
        })
        .collect();
    slope(&points)
}

#[test]
fn fixed_step_methods_keep_their_order_through_events() {
    println!("order through one impact: elastic, Kelvin-Voigt; in brackets without events");
    for method in fixed_step() {
        let [elastic, damped] = [0.0, 0.05].map(|zeta| impact_order(method, zeta, true));
        let [clipped, clipped_damped] = [0.0, 0.05].map(|zeta| impact_order(method, zeta, false));
        println!(
            "{:20} {elastic:.2} {damped:.2} [{clipped:.2} {clipped_damped:.2}]",
            method.info.id
        );
        for order in [elastic, damped] {
            assert!(
                order >= f64::from(method.info.order) - 0.3,
                "{}: order {order:.2} through events, declared {}",
                method.info.id,
                method.info.order
            );
        }
    }
}

#[test]
fn without_events_damped_contact_costs_high_order() {
    let rk4 = impact_order(by_id("rk4"), 0.05, false);
    assert!(rk4 < 2.0, "{rk4:.2}");
}

/// Measures the slope of the error over the tolerance, with the work in the log.
fn tolerance_slope(
    method: &gearbench_integrators::Method,
    hammer: &Hammer,
    t_end: f64,
    tolerances: impl Iterator<Item = f64>,
) -> f64 {
    let points: Vec<(f64, f64)> = tolerances
        .map(|rtol| {
            let (e, work) = speed_error(method, hammer, &tolerance(t_end, rtol), 4001.0);
            println!(
                "  {:10} {rtol:.1e} error {e:.2e}, {} steps, {} rejected, {} forces, {} events",
                method.info.id, work.steps, work.rejected, work.force_evaluations, work.events
            );
            (rtol, e)
        })
        .collect();
    slope(&points)
}

#[test]
fn adaptive_methods_follow_their_tolerance_through_an_impact() {
    for zeta in [0.0, 0.05] {
        let hammer = Hammer::one_impact(zeta);
        for method in adaptive() {
            let tolerances = (0..11).map(|i| 10f64.powf(-5.0 - 0.5 * f64::from(i)));
            let observed = tolerance_slope(method, &hammer, after_impact(&hammer), tolerances);
            let declared = method.info.tolerance_slope;
            println!(
                "{:20} slope {observed:.3}, declared {declared:.3}",
                method.info.id
            );
            assert!(
                (observed - declared).abs() <= 0.15,
                "{}: error falls with rtol^{observed:.3}, declared {declared}",
                method.info.id,
            );
        }
    }
}

/// Over 24 impacts in a quarter of a second, four turns of the pinion, the slope holds until rounding of the angles
/// ends it at an error of about 1e-10.
#[test]
fn adaptive_methods_follow_their_tolerance_through_24_impacts() {
    let hammer = Hammer::gears(0.05);
    let t_end = 0.25;
    assert_eq!(hammer.exact(t_end).2, 24);
    for method in adaptive() {
        let tolerances = (0..9).map(|i| 10f64.powf(-5.0 - 0.5 * f64::from(i)));
        let observed = tolerance_slope(method, &hammer, t_end, tolerances);
        let declared = method.info.tolerance_slope;
        println!(
            "{:20} slope {observed:.3}, declared {declared:.3}",
            method.info.id
        );
        assert!(
            (observed - declared).abs() <= 0.2,
            "{}: error falls with rtol^{observed:.3}, declared {declared}",
            method.info.id,
        );
    }
}
