use super::*;
use crate::context::Context;
use crate::experiment::configuration::Configuration;
use crate::models::models;
use crate::scene_file::{Selection, load_for};
use gearbench_integrators::table::{RK4, VELOCITY_VERLET};

mod dashpots;

fn entry(scene: &str, label: &str) -> Configuration {
    let scene = load_for(&Context::default(), scene, Selection::Labels(Some(label)))
        .unwrap_or_else(|e| panic!("{e:?}"));
    let choice = scene
        .select(Some(label))
        .unwrap_or_else(|e| panic!("{e:?}"))[0];
    Configuration::of(&scene, choice)
}

fn linearised(e: &Configuration) -> Linearised {
    Linearised::new(&e.scene, &e.modelling, models()).unwrap()
}

fn line(lines: &[StepLine], kind: LineKind) -> Option<f64> {
    lines.iter().find(|l| l.kind == kind).map(|l| l.step_s)
}

/// Rigid gears on one spring vibrate with `sqrt(k/m)`, so that both lines are one; two tooth pairs are stiffer than one,
/// and a damper lowers the limit of velocity Verlet.
#[test]
fn rigid_gears_have_the_limit_of_their_spring() {
    let e = entry("spur_impact", "rigid");
    let mut f = linearised(&e);
    let closed = f.closed().unwrap().clone();
    assert!(closed.t > 2e-5 && closed.t < 1e-4, "{}", closed.t);
    let omega = f.penalty_frequency().unwrap();
    for (method, x) in [(VELOCITY_VERLET, 2.0), (RK4, 8.0_f64.sqrt())] {
        let lines = f.lines(method).unwrap();
        for kind in [LineKind::Stability, LineKind::Penalty] {
            let h = line(&lines, kind).unwrap();
            assert!((h * omega / x - 1.0).abs() < 1e-6, "{method}: {h:e}");
        }
    }
    let e = entry("loaded_mesh", "rigid");
    let mut f = linearised(&e);
    let closed = f.closed().unwrap().clone();
    assert_eq!(f.scene().contact_forces(closed.at()).len(), 2);
    let h = line(&f.lines(VELOCITY_VERLET).unwrap(), LineKind::Stability).unwrap();
    assert!(h < 1.9 / f.linear().unwrap().highest());
}

#[test]
fn methods_without_a_fixed_step_have_no_lines() {
    let mut f = linearised(&entry("spur_impact", "rigid"));
    let mut of = |text: &str| f.lines(text.parse().unwrap()).unwrap();
    for method in ["bdf", "tsit45", "hht-alpha", "newmark"] {
        assert_eq!(of(method), [], "{method}");
    }
    assert!(of("newmark(beta=0.1)").len() == 2);
}
