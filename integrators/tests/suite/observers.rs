//! Tests of the energy ledger and the recorder.

use crate::modes::Modes;
use crate::problems::*;
use gearbench_integrators::observers::Tee;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::observers::recorder::Recorder;
use gearbench_integrators::{METHODS, Stepping};

#[test]
fn the_ledger_closes_through_damped_impacts() {
    for method in METHODS {
        let mut hammer = Hammer::gears(0.05);
        let (start, mut ledger) = (hammer.start(), Ledger::default());
        let (plan, allowed) = match method.info.stepping {
            Stepping::Adaptive => (tolerance(0.05, 1e-9), 1e-6),
            Stepping::Both => (tolerance(0.05, 1e-9), 1e-9),
            Stepping::Fixed => (
                steps(0.05, 100_000.0),
                if method.info.order == 1 { 1e-4 } else { 1e-6 },
            ),
        };
        watch(method.info.id, &mut hammer, start, &plan, &mut ledger);
        let residual = ledger.residual_relative();
        println!(
            "{:20} residual {residual:.1e}, lost {:.3e} J",
            method.info.id, ledger.dissipated
        );
        assert!(
            residual.abs() < allowed,
            "{}: {residual:.1e}",
            method.info.id
        );
        assert!(ledger.dissipated > 0.0);
    }
}

/// The ledger evaluates each state of a second-order method once, because the method is no more accurate than its
/// states. This saves time where contact takes a solve.
#[test]
fn a_ledger_looks_once_at_each_state_of_a_method_of_second_order() {
    for (id, looks) in [("velocity-verlet", 1.0), ("rk4", 4.0)] {
        let mut hammer = Hammer::gears(0.05);
        let (start, mut ledger) = (hammer.start(), Ledger::default());
        let (_, work) = watch(id, &mut hammer, start, &steps(0.05, 1e4), &mut ledger);
        let found = hammer.looks as f64 / work.steps as f64;
        assert!(
            (found / looks - 1.0).abs() < 0.05,
            "{id}: {found} looks a step"
        );
    }
}

/// A damped contact without adhesion opens while its spring is still compressed; the ledger books that energy as a
/// jump at the switch.
#[test]
fn the_ledger_books_the_energy_left_at_a_release() {
    let mut hammer = Hammer::one_impact(0.05);
    let (start, mut ledger) = (hammer.start(), Ledger::default());
    let plan = tolerance(after_impact(&hammer), 1e-10);
    watch("dopri5", &mut hammer, start, &plan, &mut ledger);
    assert!(ledger.jumps < 0.0, "{:.3e}", ledger.jumps);
    let start = ledger.start.unwrap().total();
    let lost = start - ledger.end.total();
    assert!((lost - (ledger.dissipated - ledger.jumps)).abs() < 1e-10 * start);
}

/// A body strikes a stop and excites an oscillator with damping that is stiff for the step. The unexplained energy is
/// that of the undamped oscillator and falls at least with the square of the step. With the trapezoidal rule on the
/// powers at the ends of the steps, before the second half impulse of the oscillator, it was up to 2.7 %.
#[test]
fn stiffly_damped_oscillators_close_the_ledger() {
    for (phase, zeta) in [(0.8, 0.05), (1.5, 0.6), (1.9, 0.95)] {
        let h = 1.0 / 64.0;
        let mut modes = Modes {
            stop: 4.0,
            wall: 0.0,
            ..Modes::linear(&[0.0, phase / h], &[0.0, zeta], &[0.0; 2])
        };
        let (start, mut ledger) = (state(&[-0.1, 0.0], &[1.0, 0.0]), Ledger::default());
        watch(
            "trigonometric",
            &mut modes,
            start,
            &steps(3.0, 192.0),
            &mut ledger,
        );
        let residual = ledger.residual() / ledger.peak;
        println!(
            "{phase} {zeta}: residual {residual:.1e}, lost {:.1e}",
            ledger.dissipated
        );
        assert!(ledger.dissipated > 0.0);
        assert!(residual.abs() < 2.5e-4, "{phase} {zeta}: {residual:e}");
    }
}

#[test]
fn the_recorder_reads_the_grid_from_dense_output() {
    let mut sys = Oscillator { omega: 1.0 };
    let grid: Vec<f64> = (0..=100).map(|i| 0.1 * f64::from(i)).collect();
    let mut recorder = Recorder::on(grid.clone()).with_peak_of(1);
    let mut ledger = Ledger::default();
    let (start, plan) = (state(&[1.0], &[0.0]), tolerance(10.0, 1e-10));
    let mut sinks = Tee(vec![&mut recorder, &mut ledger]);
    watch("dopri5", &mut sys, start, &plan, &mut sinks);
    let q = recorder.column(0);
    assert_eq!(q.len(), grid.len());
    for (t, q) in grid.iter().zip(q) {
        assert!((q - t.cos()).abs() < 1e-8, "{t}: {q}");
    }
    let peak = recorder.peak_state.unwrap();
    assert!((peak.v[0].abs() - 1.0).abs() < 2e-3, "{peak:?}");
    assert!(ledger.residual_relative().abs() < 1e-9);
}

#[test]
fn a_recorder_of_a_run_that_ends_early_is_short() {
    let mut sys = Oscillator { omega: 1.0 };
    let mut recorder = Recorder::on((0..=10).map(f64::from).collect());
    let start = state(&[1.0], &[0.0]);
    watch("rk4", &mut sys, start, &steps(4.5, 450.0), &mut recorder);
    assert_eq!(recorder.rows.len(), 5);
}
