//! Frequency responses compared with a closed form, and with simulations of running gears.
#![allow(clippy::print_stdout, reason = "observed figures")]

use super::plan::FrequencyGrid;
use super::run::response;
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::runner::Runner;
use crate::models::models;
use crate::scene_file::{Origin, SHIPPED, SceneFile};
use crate::studies::sweep;
use crate::studies::test_scene::waves;
use gearbench_integrators::Scheme;
use gearbench_reports::record::Steady;
use gearbench_reports::response::{GroupResponse, ResponsePoint};
use gearbench_reports::sweep::Branch;

/// The response of a model of a scene from one frequency [Hz] to another.
fn respond(
    scene: &SceneFile,
    label: &str,
    range: Option<[f64; 2]>,
    points: usize,
) -> GroupResponse {
    let entry = Configuration::of(scene, scene.model(label).unwrap());
    let wanted = FrequencyGrid {
        range,
        points,
        ..FrequencyGrid::default()
    };
    let found = response(
        label,
        (&entry.scene, &entry.modelling),
        models(),
        &wanted,
        &|_| false,
    );
    let mut found = found.unwrap();
    assert!(found.message.is_empty(), "{}", found.message);
    found.groups.remove(0)
}

/// Returns the steady states of gears that run under load at mesh frequencies [Hz].
fn run(scene: &SceneFile, label: &str, method: Scheme, frequencies: &[f64]) -> Vec<Steady> {
    let entry = Configuration::of(scene, scene.model(label).unwrap());
    run_entry(scene, entry, method, frequencies)
}

/// Returns the steady states of a configuration of a scene.
fn run_entry(
    scene: &SceneFile,
    entry: Configuration,
    method: Scheme,
    frequencies: &[f64],
) -> Vec<Steady> {
    let plan = sweep::Plan {
        conditions: Conditions {
            repeats: 0,
            ..Conditions::of(scene)
        },
        entries: vec![entry],
        standing: Vec::new(),
        method,
        frequencies: frequencies.to_vec(),
        branches: vec![Branch::Fresh],
        cycles: 6,
        settle: 8e-3,
        positions: 16,
    };
    let results = sweep::sweep(&plan, &Runner::default()).unwrap();
    let settled = |r: gearbench_reports::record::Run| {
        assert!(!r.status.is_failure(), "{:?}", r.message);
        r.steady.unwrap()
    };
    results.runs.into_iter().map(settled).collect()
}

fn at(group: &GroupResponse, frequency: f64) -> &ResponsePoint {
    let off = |p: &&ResponsePoint| (p.mesh_frequency_hz - frequency).abs();
    let nearest = group.points.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.filter(|p| off(p) < 1e-6 * frequency).unwrap()
}

/// `x'' + 2 zeta w x' + w^2 (1 + e cos(W t)) x = w^2 d`: to first order in e an amplitude of
/// `e d / sqrt((1 - r^2)^2 + (2 zeta r)^2)`, r = W / w.
#[test]
fn a_stiffness_wave_answers_as_an_oscillator_does() {
    let (depth, ratio) = (1e-4, 0.05);
    let scene = waves(depth, ratio, 15.0);
    let fn_hz = respond(&scene, "rigid", None, 2).resonance_hz.unwrap();
    let group = respond(&scene, "rigid", Some([0.1 * fn_hz, 1.9 * fn_hz]), 19);
    let limit = &group.meshes[0];
    let deflection = limit.force_n / 1e8;
    assert!((limit.error_harmonics_m[0] / (depth * deflection) - 1.0).abs() < 2e-3);
    let mut worst = 0.0_f64;
    for p in &group.points {
        let r = p.mesh_frequency_hz / fn_hz;
        let exact = depth * deflection / ((1.0 - r * r).powi(2) + (2.0 * ratio * r).powi(2)).sqrt();
        worst = worst.max((p.meshes[0].error_harmonics_m[0] / exact - 1.0).abs());
    }
    println!("a wave of 1e-4: within {worst:.1e} of an oscillator");
    assert!(worst < 2e-3, "{worst:e}");
}

/// A deep wave, where harmonics excite each other: the same as running gears, on both sides of the resonances.
#[test]
fn a_deep_wave_answers_as_gears_that_run() {
    let scene = waves(0.3, 0.05, 15.0);
    let fn_hz = respond(&scene, "rigid", None, 2).resonance_hz.unwrap();
    let group = respond(&scene, "rigid", Some([0.2 * fn_hz, 1.8 * fn_hz]), 9);
    let frequencies: Vec<f64> = group
        .points
        .iter()
        .filter(|p| p.is_linear())
        .map(|p| p.mesh_frequency_hz)
        .collect();
    assert!(frequencies.len() >= 6, "{frequencies:?}");
    let method = gearbench_integrators::table::DOPRI5.at_tolerance(1e-8);
    for steady in run(&scene, "rigid", method, &frequencies) {
        let f = frequencies.iter().copied().min_by(|a, b| {
            (a - steady.mesh_frequency_hz)
                .abs()
                .total_cmp(&(b - steady.mesh_frequency_hz).abs())
        });
        let m = &at(&group, f.unwrap()).meshes[0];
        let of_error = m.error_rms_m / steady.error_rms_m - 1.0;
        let of_force = m.force_greatest_n / steady.force_peak_n - 1.0;
        println!(
            "a deep wave, {:.3} fn: error {of_error:.1e}, greatest force {of_force:.1e}",
            steady.mesh_frequency_hz / fn_hz
        );
        assert!(of_error.abs() < 3e-3 && of_force.abs() < 3e-3);
    }
}

/// The scene `loaded_mesh` with the damping of a model.
fn loaded_mesh(label: &str) -> SceneFile {
    let shipped = SHIPPED.iter().find(|s| s.name == "loaded_mesh").unwrap();
    let context = Context::default();
    let mut scene =
        SceneFile::unbuilt(&context, shipped.name, shipped.text, Origin::Shipped, true).unwrap();
    scene.damp_unbuilt(&[label]).unwrap();
    scene
}

/// Responses agree with runs of gears under load, near and away from the resonances of harmonics, as long as no flanks
/// separate.
#[test]
fn gears_under_load_answer_as_they_run() {
    let everywhere = &[2500.0, 4000.0, 8500.0][..];
    // At 4000 Hz movable teeth that start unloaded go on parting.
    for (label, frequencies, bound) in [
        ("rigid", everywhere, 0.01),
        ("movable-teeth", &[2500.0, 8500.0][..], 0.02),
        ("elastic", everywhere, 0.05),
    ] {
        let scene = loaded_mesh(label);
        let choice = scene.model(label).unwrap();
        let own = choice.integrators.as_ref().and_then(|m| m.first()).cloned();
        let method =
            own.unwrap_or_else(|| gearbench_integrators::table::VELOCITY_VERLET.at_step(2e-7));
        let group = respond(&scene, label, Some([2500.0, 8500.0]), 5);
        for (steady, f) in run(&scene, label, method, frequencies)
            .iter()
            .zip(frequencies.iter().copied())
        {
            let p = at(&group, f);
            let m = &p.meshes[0];
            let off = m.error_rms_m / steady.error_rms_m - 1.0;
            let peak = m.error_peak_to_peak_m / steady.error_peak_to_peak_m - 1.0;
            println!(
                "{label} at {f} Hz: transmission error rms {:.3} um, {:.2} %, peak to peak {:.2} %",
                1e6 * steady.error_rms_m,
                100.0 * off,
                100.0 * peak
            );
            assert!(off.abs() < bound, "{label} {f}: {off}");
            // Rigid gears hand the force on to their mounts.
            if label == "rigid" {
                let mount = p.mounts[0].rms_n / steady.bearings[0].rms_n - 1.0;
                assert!(mount.abs() < 0.02, "{mount}");
            }
        }
    }
}

/// Elastic gears with the static compliance of the modes that were cut, damped as the modes are, run as gears of which
/// more modes are kept. Peaks of the force are printed only: they contain vibrations above the first cut frequency.
#[test]
fn damped_static_compliance_replaces_the_modes_that_were_cut() {
    let scene = loaded_mesh("elastic");
    let with = |modes: f64| {
        let mut entry = Configuration::of(&scene, scene.model("elastic").unwrap());
        for gear in &mut entry.modelling.gears {
            gear.set("modes", modes).unwrap();
        }
        let choice = scene.model("elastic").unwrap();
        let method = choice.integrators.as_ref().unwrap()[0];
        run_entry(
            &scene,
            entry,
            method,
            &[1000.0, 2000.0, 3000.0, 4000.0, 8500.0],
        )
    };
    let full = with(200.0);
    for modes in [20.0, 60.0] {
        for (found, full) in with(modes).iter().zip(&full) {
            let error = found.error_rms_m / full.error_rms_m - 1.0;
            let force = found.force_peak_n / full.force_peak_n - 1.0;
            println!(
                "{modes} of 200 modes at {:.0} Hz: transmission error {:.2} %, greatest force {:.2} %",
                full.mesh_frequency_hz,
                100.0 * error,
                100.0 * force
            );
            assert!(error.abs() < 0.01, "{modes} {error}");
        }
    }
}
