//! Tests of the coupled parts against the whole system: orders, theoretical limit, energy, and exact cases.

#![allow(clippy::print_stdout)] // measured numbers belong to the log of a test run

mod study;

use super::exchange::{Bounds, CoupledRun, CouplingScheme, End, exchange};
use super::frames::{Frame, PrescribedScene, frames};
use super::step_polynomial::StepPolynomial;
use super::study::ALLOWED;
use super::{stiffness, theory};
use crate::context::Context;
use crate::experiment::configuration::Configuration;
use crate::experiment::history::History;
use crate::models::models;
use crate::scene_file::{Origin, SceneFile};
use crate::studies::coupling::step_polynomial::{Extrapolation, Motion};
use crate::studies::test_scene::coarse;
use gearbench_integrators::system::{Outputs, SecondOrderSystem, State};
use gearbench_integrators::table::{RK4, TRIGONOMETRIC, VELOCITY_VERLET};
use gearbench_integrators::{NullSink, Scheme, TimePlan, Work};
use gearbench_models::scene::Scene;

/// Two gears at rest whose torques load their contact, with one spring and a damper.
fn pressed(more: &str, model: &str) -> SceneFile {
    let text = format!(
        r#"
schema = 1
name = "own"
duration_s = 2e-4

[gears.pinion]
teeth = 20
module_m = 0.004
face_width_m = 0.01
{more}
loads = [{{ torque_nm = 20.0 }}]

[gears.wheel]
teeth = 30
module_m = 0.004
face_width_m = 0.01
loads = [{{ torque_nm = 30.0 }}]

[[meshes]]
gears = ["pinion", "wheel"]
centre_distance_m = 0.1001
start = {{ flank = "left", gap_m = 0.0 }}

[[models]]
{model}
"#
    );
    SceneFile::unbuilt(
        &Context::default(),
        "own.toml",
        &text,
        Origin::Shipped,
        false,
    )
    .expect("a scene")
}

fn rigid(damping: f64) -> SceneFile {
    let damping = match damping > 0.0 {
        true => {
            format!(", damping = {{ law = \"kelvin-voigt\", damping_ns_per_m = {damping:?} }}")
        }
        false => String::new(),
    };
    let model = format!(
        "model = \"rigid\"\ncontact = {{ stiffness = {{ kind = \"constant\", stiffness_n_per_m2 = 1.4e10, of = \"mesh\" }}{damping} }}"
    );
    pressed("", &model)
}

/// A model of a scene, built.
struct BuiltModel {
    entry: Configuration,
    scene: Scene,
    frames: Vec<Frame>,
}

fn built(file: &SceneFile) -> BuiltModel {
    let entry = Configuration::of(file, &file.models[0]);
    let mut scene = Scene::build(&entry.scene, &entry.modelling, models()).expect("a model");
    let frames = frames(&entry.scene, &mut scene).expect("hubs");
    BuiltModel {
        entry,
        scene,
        frames,
    }
}

impl BuiltModel {
    fn coupled(&mut self, method: &Scheme, manner: CouplingScheme, t_end: f64) -> CoupledRun {
        let bounds = Bounds {
            cancel: &std::sync::atomic::AtomicBool::new(false),
            t_end,
            events: true,
            max_steps: u64::MAX,
            timeout: None,
            hopeless: f64::MAX,
        };
        let mut history = History::new(&self.scene, vec![0.0, t_end]);
        let BuiltModel { scene, frames, .. } = self;
        exchange(scene, frames, method, manner, bounds, &mut history)
    }

    /// Places and speeds of the frames at the end of a run as one system.
    fn whole(&mut self, method: &Scheme, t_end: f64) -> Vec<[f64; 2]> {
        let mut s = self.scene.initial();
        let plan = TimePlan::new(t_end, method.resolution);
        let mut integrator = method.method.build();
        let mut work = Work::default();
        (integrator.run(&mut self.scene, &mut s, &plan, &mut NullSink, &mut work)).expect("a run");
        let at = |f: &Frame| [f.mean(&s.q), f.mean(&s.v)];
        self.frames.iter().map(at).collect()
    }
}

/// Largest deviation of speeds over the largest speed.
fn off(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let size = b.iter().map(|x| x[1].abs()).fold(0.0, f64::max);
    let apart = a.iter().zip(b).map(|(a, b)| (a[1] - b[1]).abs());
    apart.fold(0.0, f64::max) / size
}

fn shown(errors: &[f64]) -> String {
    let all: Vec<String> = errors.iter().map(|e| format!("{e:.1e}")).collect();
    all.join(", ")
}

/// Orders between errors at halved steps.
fn orders(errors: &[f64]) -> Vec<f64> {
    errors
        .windows(2)
        .map(|e| (e[0] / e[1]).abs().log2())
        .collect()
}

#[test]
fn runs_in_two_parts_come_to_the_whole_with_the_order_of_extrapolation() {
    // From rest, pressed: the force begins with its second derivative, which the first steps, with fewer values, bear.
    let fine = RK4.at_step(2.5e-7);
    for (damping, motion, extrapolation, order) in [
        (200.0, Motion::Cubic, Extrapolation::Constant, 1.0),
        (200.0, Motion::Cubic, Extrapolation::Linear, 2.0),
        // A damper's force begins with its slope, which costs the first step an order.
        (0.0, Motion::Cubic, Extrapolation::Quadratic, 3.0),
        (0.0, Motion::Linear, Extrapolation::Quadratic, 3.0),
    ] {
        let mut pair = built(&rigid(damping));
        let t_end = 2e-4;
        let exact = pair.whole(&RK4.at_step(1e-7), t_end);
        let steps = [4e-6, 2e-6, 1e-6, 5e-7];
        let runs = steps.map(|step| {
            let manner = CouplingScheme {
                extrapolation,
                motion,
                step,
            };
            pair.coupled(&fine, manner, t_end)
        });
        let errors = runs.each_ref().map(|r| off(&r.hubs, &exact));
        let energies = runs.each_ref().map(|r| r.largest);
        let (of_speed, of_energy) = (orders(&errors), orders(&energies));
        println!(
            "{extrapolation}, {motion} motion: {} {of_speed:.2?}; energy {} {of_energy:.2?}",
            shown(&errors),
            shown(&energies)
        );
        assert!((of_speed[2] - order).abs() < 0.25, "{of_speed:?}");
        // The energy of one step: an order more. On springs alone gears give the same along a line, for their work is one of
        // places.
        let of_step = order + 1.0;
        assert!((of_energy[2] - of_step).abs() < 0.4, "{of_energy:?}");
    }
}

#[test]
fn the_coupling_fails_where_theory_says() {
    // On one spring and damper that stay closed the pair is the oscillator of theory. Long after the start its vibration has
    // decayed, or grown.
    let mut pair = built(&rigid(400.0));
    let BuiltModel { entry, frames, .. } = &pair;
    let found = stiffness::oscillator(&entry.scene, &entry.modelling, models(), frames);
    let [omega, zeta] = found.expect("matrices").expect("contact");
    assert!(zeta > 0.02 && zeta < 0.2, "{zeta}");
    let method = RK4.at_step(0.1 / omega);
    let t_end = 2000.0 / omega;
    // Torques in balance press the teeth: vibration is about the place where it has decayed.
    let rest = pair.whole(&method, t_end)[0];
    let start = rest[0].abs();
    assert!(rest[1].abs() < 1e-3 * omega * start);
    for extrapolation in Extrapolation::ALL {
        let limit =
            theory::limit(extrapolation, [omega, zeta], 1e3 * t_end, ALLOWED).expect("a limit");
        let mut grows = |step: f64| {
            let manner = CouplingScheme {
                extrapolation,
                motion: Motion::Cubic,
                step,
            };
            let run = pair.coupled(&method, manner, t_end);
            let [place, speed] = run.hubs[0];
            let amplitude = (place - rest[0]).hypot((speed - rest[1]) / omega);
            !(run.end == End::Reached && amplitude < start)
        };
        let (mut low, mut high) = (0.5 * limit, 2.0 * limit);
        assert!(!grows(low) && grows(high), "{extrapolation}");
        while high > 1.005 * low {
            let middle = (low * high).sqrt();
            match grows(middle) {
                true => high = middle,
                false => low = middle,
            }
        }
        println!(
            "{extrapolation}: theory omega h = {:.3}, found {:.3}",
            omega * limit,
            omega * low
        );
        assert!(
            (low / limit - 1.0).abs() < 0.02,
            "{extrapolation}: {low:.3e} {limit:.3e}"
        );
    }
}

#[test]
fn without_contact_a_coupling_has_no_error() {
    let apart = rigid(0.0).text().replace("gap_m = 0.0", "gap_m = 3e-5");
    let file = SceneFile::unbuilt(
        &Context::default(),
        "own.toml",
        &apart,
        Origin::Shipped,
        false,
    )
    .expect("a scene");
    let mut pair = built(&file);
    let method = RK4.at_step(1e-6);
    let exact = pair.whole(&method, 5e-5);
    for motion in Motion::ALL {
        let manner = CouplingScheme {
            extrapolation: Extrapolation::Quadratic,
            motion,
            step: 7e-6,
        };
        let run = pair.coupled(&method, manner, 5e-5);
        assert_eq!(
            (run.energy, run.largest, run.end.clone()),
            (0.0, 0.0, End::Reached)
        );
        assert_eq!(run.exchanges, 8);
        assert!(
            off(&run.hubs, &exact) < 1e-12,
            "{:.1e}",
            off(&run.hubs, &exact)
        );
    }
}

const TEETH: &str = "model = \"movable-teeth\"\ncontact = { stiffness = { kind = \"constant\", stiffness_n_per_m2 = 2.68e10 } }\n\
                     parameters = { tooth_stiffness_n_per_m = 8.0e8, tooth_mass_kg = 8e-3 }";

#[test]
fn frames_hold_the_momentum_of_gears() {
    let elastic = coarse(&[("modes", 12.0.into())]);
    for file in [rigid(0.0), pressed("", TEETH), elastic] {
        let mut of = built(&file);
        let s = of.scene.initial();
        let n = s.q.len();
        for (frame, gear) in of.frames.iter().zip(of.scene.gears()) {
            assert!((frame.inertia / gear.model.hub().inertia - 1.0).abs() < 1e-9);
            // Any motion has the momentum of its frame.
            let v: Vec<f64> = (0..n).map(|i| (1.0 + i as f64).sin()).collect();
            let at = State {
                v: v.clone(),
                ..s.clone()
            };
            let momentum = gear.model.hub_state(gear.at(at.at())).momentum;
            assert!(
                (momentum / (frame.inertia * frame.mean(&v)) - 1.0).abs() < 1e-6,
                "{}",
                frame.name
            );
            let mut moved = v.clone();
            frame.move_to(&mut moved, 3.0);
            assert!((frame.mean(&moved) - 3.0).abs() < 1e-12);
        }
        // A led gear has the acceleration of its course, and is deformed as it would be.
        let frames = of.frames.clone();
        let mut free = vec![0.0; n];
        let mut pushed = s.clone();
        pushed
            .q
            .iter_mut()
            .enumerate()
            .for_each(|(i, q)| *q += 1e-6 * (i as f64).cos());
        of.scene.force(pushed.at(), &mut free);
        of.scene.solve_mass(pushed.at(), &mut free);
        let mut led = PrescribedScene::new(&mut of.scene, &frames);
        led.courses = vec![
            StepPolynomial {
                from: 0.0,
                c: [0.0, 0.0, 50.0, 0.0]
            };
            frames.len()
        ];
        let mut a = vec![0.0; n];
        led.force(pushed.at(), &mut a);
        led.solve_mass(pushed.at(), &mut a);
        for frame in &frames {
            assert!((frame.mean(&a) - 100.0).abs() < 1e-6);
            let (by, first) = (frame.mean(&free) - 100.0, frame.moves[0].0);
            assert!((free[first] - by - a[first]).abs() <= 1e-9 * free[first].abs().max(1e3));
        }
        let mut out = Outputs::default();
        (&mut led as &mut dyn SecondOrderSystem).output(pushed.at(), &mut out);
        assert_eq!(out.channels.len(), frames.len());
    }
}

#[test]
fn every_model_comes_to_its_whole() {
    let speed = "speed_rad_s = 5.0";
    let cases: [(SceneFile, Scheme, f64); 3] = [
        (pressed(speed, TEETH), RK4.at_step(1e-7), 8e-5),
        (
            coarse(&[("modes", 12.0.into())]),
            TRIGONOMETRIC.at_step(2.5e-7),
            8e-5,
        ),
        (
            coarse(&[
                ("modes", 12.0.into()),
                ("residual", false.into()),
                ("choose", "frequency".into()),
            ]),
            VELOCITY_VERLET.at_step(2.5e-8),
            8e-5,
        ),
    ];
    for (file, method, t_end) in cases {
        let mut of = built(&file);
        let exact = of.whole(&method, t_end);
        let errors = [4e-6, 2e-6, 1e-6, 5e-7].map(|step| {
            let manner = CouplingScheme {
                extrapolation: Extrapolation::Quadratic,
                motion: Motion::Linear,
                step,
            };
            off(&of.coupled(&method, manner, t_end).hubs, &exact)
        });
        println!("{}: {}", of.entry.label, shown(&errors));
        // Lines between places are of second order. The error of modes made for the teeth in mesh is as small at four microseconds
        // as that of eigenmodes at one, and falls unevenly from there.
        assert!(
            errors[3] < 4e-3 && errors[3] < (0.06 * errors[0]).max(2e-3),
            "{errors:?}"
        );
    }
}
