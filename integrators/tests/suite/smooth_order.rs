//! Order of convergence on a smooth nonlinear problem with an exact solution.

use crate::problems::*;

/// Largest deviation of the fitted order from the declared one.
const BAND: f64 = 0.1;

#[test]
fn fixed_step_methods_have_their_declared_order() {
    for method in fixed_step() {
        let info = method.info;
        // Coarse enough that rounding stays away, fine enough that the leading term rules.
        let first = match info.order {
            1 => 3200.0,
            2 => 400.0,
            4 => 80.0,
            _ => 120.0,
        };
        let points: Vec<(f64, f64)> = (0..5)
            .map(|i| {
                let n = first * f64::powi(1.4, i);
                let plan = steps(5.0, n.round());
                let (s, work) = solve(method, &mut Duffing, Duffing::start(), &plan);
                assert_eq!(work.steps as f64, n.round(), "{}", info.id);
                assert_eq!(s.t, 5.0);
                (5.0 / n.round(), Duffing::error(&s))
            })
            .collect();
        let order = slope(&points);
        println!(
            "{:20} order {order:.3}, declared {}, errors {:.1e} .. {:.1e}",
            info.id, info.order, points[0].1, points[4].1
        );
        assert!(
            (order - f64::from(info.order)).abs() <= BAND,
            "{}: observed order {order:.3}, declared {}: {points:?}",
            info.id,
            info.order
        );
    }
}

#[test]
fn adaptive_methods_follow_their_tolerance() {
    for method in adaptive() {
        let info = method.info;
        let points: Vec<(f64, f64)> = (0..13)
            .map(|i| {
                let rtol = 10f64.powf(-4.0 - 0.5 * f64::from(i));
                let (s, _) = solve(
                    method,
                    &mut Duffing,
                    Duffing::start(),
                    &tolerance(20.0, rtol),
                );
                (rtol, Duffing::error(&s))
            })
            .collect();
        let observed = slope(&points);
        println!(
            "{:20} slope {observed:.3}, declared {:.3}: {:.1e} .. {:.1e}",
            info.id, info.tolerance_slope, points[0].1, points[12].1
        );
        assert!(
            (observed - info.tolerance_slope).abs() <= 0.2,
            "{}: error falls with rtol^{observed:.3}, declared {}: {points:?}",
            info.id,
            info.tolerance_slope
        );
    }
}
