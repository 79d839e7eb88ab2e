//! Stability limits in the scene itself, whose contacts open and close. With movable teeth of the published 3.6e9 N/m,
//! explicit methods fail beyond their limit; implicit ones run with steps ten times as long.

use super::entry;
use gearbench::context::Context;
use gearbench::experiment::configuration::Configuration;
use gearbench::experiment::run::{Job, NO_BOUND, run};
use gearbench::models::models;
use gearbench::studies::stability::limits::{LineKind, Linearised};
use gearbench_integrators::Resolution;
use gearbench_integrators::Scheme;
use gearbench_reports::record::Run;

fn run_with(entry: &Configuration, text: &str, step: f64, t_end: f64) -> Run {
    let grid: Vec<f64> = (0..=200).map(|i| t_end * f64::from(i) / 200.0).collect();
    run(&Job {
        scene: &entry.scene,
        modelling: &entry.modelling,
        context: &Context::default(),
        method: &Scheme {
            method: text.parse().unwrap(),
            resolution: Resolution::Step(step),
        },
        t_end,
        grid: &grid,
        also_steps: false,
        forces: false,
        measurable: false,
        paths: false,
        histories: false,
        motion: false,
        pictures: None,
        events: true,
        repeats: 0,
        timeout: NO_BOUND,
        max_steps: 1_000_000,
    })
    .unwrap()
}

#[test]
fn explicit_methods_fail_where_implicit_ones_hold() {
    let e = entry("spur_rotation", "movable-teeth-3.6e9");
    let mut linearised = Linearised::new(&e.scene, &e.modelling, models()).unwrap();
    let t_end = 2e-3;
    for text in ["velocity-verlet", "rk4", "dopri5"] {
        let lines = linearised.lines(text.parse().unwrap()).unwrap();
        let h = (lines.iter().find(|l| l.kind == LineKind::Stability))
            .unwrap()
            .step_s;
        let (below, above) = (
            run_with(&e, text, 0.9 * h, t_end),
            run_with(&e, text, 1.1 * h, t_end),
        );
        println!(
            "{text:34} {:.3e} s: {}, {:.3e} s: {} at {:.2e} s",
            0.9 * h,
            below.status,
            1.1 * h,
            above.status,
            above.simulated_s
        );
        assert!(below.status.holds(), "{text}: {:?}", below.message);
        assert!(above.status.is_failure(), "{text}: {:?}", above.message);
    }
    for text in ["newmark", "hht-alpha", "generalised-alpha(rho_inf=0.8)"] {
        let step = 5e-6;
        let held = run_with(&e, text, step, t_end);
        println!("{text:34} {step:.3e} s: {}", held.status);
        assert!(held.status.holds(), "{text}: {:?}", held.message);
    }
}

/// Thirty-five undamped modes in the scene itself that no contact supports any more still grow beyond the limit.
#[test]
fn elastic_gears_fail_in_the_scene_where_theory_says() {
    let e = super::with_modes(entry("spur_impact", "elastic"), 35);
    let mut linearised = Linearised::new(&e.scene, &e.modelling, models()).unwrap();
    for text in ["velocity-verlet", "rk4"] {
        let lines = linearised.lines(text.parse().unwrap()).unwrap();
        let h = (lines.iter().find(|l| l.kind == LineKind::Stability))
            .unwrap()
            .step_s;
        let (below, above) = (
            run_with(&e, text, 0.95 * h, 1.5e-4),
            run_with(&e, text, 1.05 * h, 1.5e-4),
        );
        println!(
            "{text:34} {:.3e} s: {}, {:.3e} s: {} at {:.2e} s",
            0.95 * h,
            below.status,
            1.05 * h,
            above.status,
            above.simulated_s
        );
        assert!(below.status.holds(), "{text}: {:?}", below.message);
        assert!(above.status.is_failure(), "{text}: {:?}", above.message);
    }
}
