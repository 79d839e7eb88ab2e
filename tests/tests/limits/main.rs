//! Largest stable step of methods on the models of the shipped scenes: theory compared with stepping.
//!
//! The table: `cargo test --release -p gearbench-tests --test limits -- --nocapture`.
#![allow(clippy::print_stdout)]

use gearbench::context::Context;
use gearbench::experiment::configuration::Configuration;
use gearbench::models::models;
use gearbench::scene_file::{Selection, load_for};
use gearbench::studies::stability::limits::table::{Case, StepLimit, table};
use gearbench_integrators::MethodSpec;

mod dashpots;
mod in_the_scene;

/// Returns an entry of a shipped scene.
fn entry(scene: &str, label: &str) -> Configuration {
    let scene = load_for(&Context::default(), scene, Selection::Labels(Some(label)))
        .unwrap_or_else(|e| panic!("{e:?}"));
    Configuration::of(&scene, scene.model(label).unwrap())
}

fn with_modes(mut entry: Configuration, modes: u32) -> Configuration {
    for gear in &mut entry.modelling.gears {
        gear.set("modes", modes).unwrap();
    }
    entry.label = format!("{}, {modes} modes", entry.label);
    entry
}

/// Prints limits and compares them with theory.
fn hold(entries: &[Configuration], methods: &[&str], bound: f64) -> Vec<StepLimit> {
    let cases: Vec<Case> = entries.iter().map(Case::of).collect();
    let methods: Vec<MethodSpec> = methods.iter().map(|m| m.parse().unwrap()).collect();
    let rows = table(&cases, models(), &methods, |_| {}).unwrap();
    for r in &rows {
        println!(
            "{:24} {:22} {:28} {:.4e} s {:.4e} s {:.4}",
            r.model,
            r.integrator,
            r.damping,
            r.theory_s,
            r.found_s,
            r.ratio()
        );
    }
    for r in &rows {
        assert!((r.ratio() - 1.0).abs() <= bound, "{r:?}: {}", r.ratio());
    }
    rows
}

/// Explicit methods at fixed steps.
const EXPLICIT: [&str; 4] = ["semi-implicit-euler", "velocity-verlet", "rk4", "dopri5"];

#[test]
fn explicit_limits_of_elastic_gears_are_those_of_theory() {
    let entries = [0, 35].map(|n| with_modes(entry("spur_impact", "elastic"), n));
    // What modes couple is told by long runs, to a per cent or two.
    let rows = hold(&entries, &EXPLICIT, 0.02);
    // Every model and method, without and with damping.
    assert_eq!(rows.len(), 2 * 4 * 2);
}

#[test]
#[ignore = "half a minute: the amplification of two hundred coupled coordinates"]
fn explicit_limits_of_elastic_gears_with_many_modes_are_those_of_theory() {
    let rows = hold(&[entry("spur_impact", "elastic")], &EXPLICIT, 0.02);
    assert_eq!(rows.len(), 4 * 2);
}

#[test]
fn explicit_limits_of_rigid_gears_and_movable_teeth_are_those_of_theory() {
    let entries = [
        entry("spur_impact", "rigid"),
        entry("spur_impact", "movable-teeth"),
        entry("loaded_mesh", "rigid"),
        entry("spur_rotation", "movable-teeth-3.6e9"),
    ];
    let methods = [&EXPLICIT[..], &["newmark(beta=0.1)"]].concat();
    let rows = hold(&entries, &methods, 0.01);
    assert_eq!(rows.len(), 4 * 5 * 2);
}

#[test]
fn the_trigonometric_limit_is_that_of_the_softened_contact() {
    let mut truncated = entry("spur_impact", "elastic-truncated");
    truncated = with_modes(truncated, 40);
    let entries = [
        entry("spur_impact", "rigid"),
        with_modes(entry("spur_impact", "elastic"), 0),
        truncated,
    ];
    let rows = hold(
        &entries,
        &["trigonometric", "trigonometric(filter=0)"],
        0.01,
    );
    assert!(rows.len() >= 4, "{}", rows.len());
}
