//! Run-ups with known results: chirps, and a pair compared with speed sweep and natural frequencies.
#![allow(clippy::print_stdout, reason = "observed figures")]

use super::*;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::runner::Runner;
use crate::scene_file::SceneFile;
use crate::studies::modes::{ModesSettings, vibrations};
use crate::studies::sweep;
use crate::studies::test_scene::waves;
use gearbench_integrators::table::DOPRI5;
use gearbench_reports::run_up::{ModelRunUp, strongest};
use gearbench_reports::sweep::Branch;
use std::f64::consts::TAU;
use windows::{SampledRecording, follow, map};

/// Turns of a gear that runs up evenly, and a history of sines at fixed orders on a mean that drifts.
fn chirp(samples: usize, orders: &[(f64, f64)]) -> (f64, Vec<f64>, Vec<f64>) {
    let apart = 1.0 / samples as f64;
    let turns: Vec<f64> = (0..samples)
        .map(|i| i as f64 * apart)
        .map(|t| 20.0 * t + 100.0 * t * t)
        .collect();
    let history = (turns.iter().enumerate())
        .map(|(i, n)| {
            let sines = orders
                .iter()
                .map(|(a, o)| a * (TAU * o * n + 0.4 * o).sin());
            8e-6 + 3e-6 * i as f64 * apart + sines.sum::<f64>()
        })
        .collect();
    (apart, turns, history)
}

/// A chirp of 1 um reads 1 um at its order in every window, whatever the speed does, between bins as well where it is followed;
/// its spectrum has it at its frequency, smeared by what that moves in a window.
#[test]
fn a_chirp_reads_its_amplitude() {
    let orders = [(1e-6, 16.0), (2e-7, 31.3)];
    let (apart, turns, history) = chirp(1 << 17, &orders);
    let cut = SampledRecording {
        time: [0.0, apart],
        turns: &turns,
    };
    let windows = cut.by_turns(40.0, Some(2.0)).unwrap();
    let histories = [history];
    let found = follow(&cut, &windows, &histories, &orders.map(|o| o.1));
    for (line, (amplitude, order)) in found.iter().zip(&orders) {
        let worst = line
            .iter()
            .map(|a| (a / amplitude - 1.0).abs())
            .fold(0.0, f64::max);
        assert!(worst < 2e-3, "{order}: {worst}");
    }
    let of_orders = map(&cut, &windows, &histories, 40.0);
    for row in &of_orders.amplitudes {
        let at = |order: f64| row[of_orders.lines.iter().position(|l| *l == order).unwrap()];
        assert!((at(16.0) / 1e-6 - 1.0).abs() < 2e-3, "{}", at(16.0));
        // Nothing stands where nothing is: neither the mean nor the other orders.
        assert!(
            at(8.0) < 2e-9 && at(24.0) < 2e-9 && at(2.0) < 1e-8,
            "{row:?}"
        );
    }
    // 20 + 200 t turns a second, 16 times that.
    let rising = 16.0 * 200.0;
    let windows = cut.by_time(rising).unwrap();
    let spectra = map(&cut, &windows, &histories, 4500.0);
    for ((row, speed), time) in (spectra.amplitudes.iter())
        .zip(&windows.speed)
        .zip(&windows.time)
    {
        assert!(
            (speed / TAU - 20.0 - 200.0 * time).abs() < 1e-6,
            "{speed} {time}"
        );
        let wanted = 16.0 * speed / TAU;
        let near = |f: f64| (f - wanted).abs() < 3.0 / windows.span;
        let lines = spectra.lines.iter().zip(row).filter(|l| near(*l.0));
        let (at, most) = lines.fold((0.0, 0.0), |m, l| if *l.1 > m.1 { (*l.0, *l.1) } else { m });
        assert!((at - wanted).abs() <= 1.0 / windows.span, "{at} {wanted}");
        assert!((0.75e-6..1.01e-6).contains(&most), "{most} at {at} Hz");
    }
}

/// Speeds are found in either sense and their windows overlap; a run too short for a window is none.
#[test]
fn windows_cover_the_run() {
    let (apart, turns, _) = chirp(1 << 14, &[]);
    let cut = SampledRecording {
        time: [0.5, apart],
        turns: &turns,
    };
    let windows = cut.by_turns(20.0, None).unwrap();
    assert_eq!(windows.span, 1.0);
    let (first, last) = (windows.time[0], windows.time[windows.time.len() - 1]);
    assert!(first < 0.53 && last > 1.49, "{first} {last}");
    assert!(windows.speed.windows(2).all(|w| w[1] > w[0]));
    assert!(cut.by_turns(20.0, Some(100.0)).is_none());
}

/// Gears whose mesh has a spring `k0 (1 + depth cos)` of one wave per base pitch, so little that their teeth stay in contact.
fn pair() -> SceneFile {
    let mut scene = waves(DEPTH, 0.05, 15.0);
    scene.duration = 0.25;
    scene
}

/// Relative amplitude of the stiffness variation.
const DEPTH: f64 = 0.05;

fn conditions(scene: &SceneFile) -> Conditions {
    Conditions {
        repeats: 0,
        samples: 500,
        ..Conditions::of(scene)
    }
}

fn run_up_of(scene: &SceneFile, ramp: Option<Ramp>, duration: f64) -> ModelRunUp {
    let plan = Plan {
        conditions: Conditions {
            duration,
            ..conditions(scene)
        },
        entries: vec![Configuration::of(scene, &scene.models[0])],
        method: DOPRI5.at_tolerance(1e-7),
        ramp,
        look: EvaluationSettings {
            gear: 0,
            multiples: 3,
            turns: None,
            onset: 0.02 * duration,
            samples: 1 << 16,
        },
    };
    let results = study(&plan, &Runner::default()).unwrap();
    assert!(
        !results.runs[0].status.is_failure(),
        "{:?}",
        results.runs[0].message
    );
    let [found] = results.run_ups() else {
        panic!("{:?}", results.run_ups());
    };
    found.validate().unwrap();
    found.clone()
}

/// Returns the place of the maximum of a line sampled at ascending places: the vertex of the parabola through three of
/// them.
fn peak(x: &[f64], y: &[f64]) -> f64 {
    let i = (1..y.len() - 1)
        .max_by(|a, b| y[*a].total_cmp(&y[*b]))
        .unwrap();
    let (a, b, c) = (y[i - 1], y[i], y[i + 1]);
    let [left, right] = [x[i] - x[i - 1], x[i + 1] - x[i]];
    let (down, up) = ((b - a) / left, (c - b) / right);
    let curvature = 2.0 * (up - down) / (left + right);
    let slope = (down * right + up * left) / (left + right);
    x[i] - slope / curvature
}

/// Two free gears that torques bring up: the first multiple of the mesh has at each speed what steady running has there, within
/// what changes in a window, and its resonance stands where the sweep and the natural frequency have it. Found are 0.02 % off
/// resonance, 3.6 % on its flanks, which stand 0.8 % late: the mesh frequency rises by 16 kHz a second, and the answer takes
/// `1/(zeta w) = 0.8` ms. The natural frequency is that of the stiffness at the start, 2.5 % below that of the mean.
#[test]
fn a_run_up_meets_the_resonance_that_sweep_and_modes_have() {
    let scene = pair();
    let entry = Configuration::of(&scene, &scene.models[0]);
    let of = (&entry.scene, &entry.modelling);
    let natural = vibrations(
        "rigid",
        of,
        crate::models::models(),
        &ModesSettings::default(),
    )
    .unwrap();
    let natural = natural.modes.last().unwrap().frequency_hz;
    // Mesh frequencies from 0.4 to 1.4 of it.
    let speed = |f: f64| TAU * f / 20.0;
    let ramp = Ramp {
        from: speed(0.4 * natural),
        to: speed(1.4 * natural),
        over: 0.25,
    };
    let found = run_up_of(&scene, Some(ramp), ramp.over);
    let first = &found.orders[0];
    assert!((first.order - 20.0).abs() < 1e-4, "{first:?}");
    let mesh: Vec<f64> = found
        .by_turns
        .speed_rad_s
        .iter()
        .map(|s| s * 20.0 / TAU)
        .collect();
    let error = &found.channels[0].orders[0];
    let frequencies: Vec<f64> = (0..=16)
        .map(|i| natural * (0.5 + 0.05 * f64::from(i)))
        .collect();
    let plan = sweep::Plan {
        conditions: conditions(&scene),
        entries: vec![entry.clone()],
        standing: Vec::new(),
        method: DOPRI5.at_tolerance(1e-7),
        frequencies,
        branches: vec![Branch::Fresh],
        cycles: 6,
        settle: 6e-3,
        positions: 12,
    };
    let swept = sweep::sweep(&plan, &Runner::default()).unwrap();
    let (mut at, mut steady) = (Vec::new(), Vec::new());
    for run in &swept.runs {
        assert!(!run.status.is_failure(), "{:?}", run.message);
        let s = run.steady.as_ref().unwrap();
        assert_eq!(s.separated, 0.0);
        let i = mesh.partition_point(|f| *f < s.mesh_frequency_hz);
        let part = (s.mesh_frequency_hz - mesh[i - 1]) / (mesh[i] - mesh[i - 1]);
        let here = error[i - 1] + part * (error[i] - error[i - 1]);
        let wanted = s.error_harmonics_m[0];
        println!(
            "{:.3} of the natural frequency: order off by {:.4} %",
            s.mesh_frequency_hz / natural,
            100.0 * (here / wanted - 1.0)
        );
        assert!(
            (here / wanted - 1.0).abs() < 0.05,
            "{} Hz",
            s.mesh_frequency_hz
        );
        at.push(s.mesh_frequency_hz);
        steady.push(wanted);
    }
    let (run_up, sweep, statics) = (
        peak(&mesh, error),
        peak(&at, &steady),
        swept.statics()[0].resonance_hz.unwrap(),
    );
    println!(
        "resonance of run-up {run_up:.1} Hz, of sweep {sweep:.1} Hz, of statics {statics:.1} Hz"
    );
    for (other, within) in [(sweep, 0.015), (statics, 0.015), (natural, 0.04)] {
        assert!((run_up / other - 1.0).abs() < within, "{run_up} {other}");
    }
    // The strongest order is that of the mesh, whose peak is reported.
    let told = strongest(&found, 1);
    assert!(told[0].order.of_mesh && (told[0].frequency_hz() / run_up - 1.0).abs() < 0.02);
    // Spectra and orders agree on the amplitude at the peak, within what the frequency moves.
    let most = |rows: &[Vec<f64>]| rows.iter().flatten().copied().fold(0.0, f64::max);
    let (spectra, orders) = (
        most(&found.channels[0].spectra),
        most(&found.channels[0].order_spectra),
    );
    assert!(
        (0.75..1.02).contains(&(spectra / orders)),
        "{spectra} {orders}"
    );
}

/// A constant speed is refused with the reason that it is no run-up.
#[test]
fn a_constant_speed_is_refused_with_a_way_out() {
    let scene = pair();
    let found = {
        let plan = Plan {
            conditions: Conditions {
                duration: 0.4,
                ..conditions(&scene)
            },
            entries: vec![Configuration::of(&scene, &scene.models[0])],
            method: DOPRI5.at_tolerance(1e-6),
            ramp: None,
            look: EvaluationSettings {
                gear: 0,
                multiples: 2,
                turns: None,
                onset: 0.01,
                samples: 1 << 14,
            },
        };
        study(&plan, &Runner::default()).unwrap()
    };
    let message = &found.run_ups()[0].message;
    assert!(
        message.contains("not a run-up") && message.contains("--from"),
        "{message}"
    );
}
