//! Without inputs an FMU reproduces the run of its scene, for any communication points.

use crate::host::Fmu;
use crate::{packed, scheme, shipped};
use gearbench::models::models;
use gearbench::scene_file::SceneFile;
use gearbench_integrators::system::Report;
use gearbench_integrators::{NullSink, Outputs, TimePlan, Work};
use gearbench_models::scene::{Channel, OfGear, Scene};

/// Runs the scene without an FMU and returns its channels.
fn run(file: &SceneFile, model: &str, method: &str, t_end: f64) -> (Scene, Vec<f64>) {
    let choice = file.model(model).unwrap();
    let mut scene = Scene::build(&file.spec_for(choice), &choice.modelling, models()).unwrap();
    let scheme = scheme(method);
    let mut state = scene.initial();
    let plan = TimePlan {
        events: file.study.events,
        ..TimePlan::new(t_end, scheme.resolution)
    };
    let mut integrator = scheme.method.build();
    let mut work = Work::default();
    integrator
        .run(&mut scene, &mut state, &plan, &mut NullSink, &mut work)
        .unwrap();
    let mut out = Outputs::default();
    scene.sample(state.at(), &mut out);
    (scene, out.channels)
}

/// Largest relative difference of speeds and angles between FMU and scene.
fn difference(name: &str, model: &str, method: &str, [step, steps]: [f64; 2], start: f64) -> f64 {
    let file = shipped(name, model);
    let fmu = Fmu::stepping(&packed(&file, model, method, &[]));
    fmu.initialise(start);
    let mut worst = 0.0_f64;
    let steps = steps as usize;
    for i in 0..steps {
        fmu.step(start + i as f64 * step, step);
        if i + 1 != steps && i + 1 != steps / 3 {
            continue;
        }
        let (scene, channels) = run(&file, model, method, (i + 1) as f64 * step);
        for name in &fmu.outputs {
            let (member, what) = name.rsplit_once('.').unwrap_or_default();
            let what = match what {
                "speed" => OfGear::HubSpeed,
                "angle" => OfGear::Displacement,
                _ => continue,
            };
            let g = scene.gears().iter().position(|g| g.name == member);
            let channel = scene.channel(Channel::Gear(g.unwrap(), what)).unwrap();
            let (here, there) = (fmu.get(name), channels[channel]);
            worst = worst.max((here - there).abs() / there.abs());
        }
    }
    worst
}

#[test]
fn an_fmu_is_the_run_of_its_scene() {
    // Impacts with dampers, gears under load, drivelines; methods with and without memory, steps cut by communication.
    for (scene, model, method, steps) in [
        ("hammer", "rigid", "velocity-verlet@1us", [2e-5, 600.0]),
        ("hammer", "rigid", "rk4@2us", [2e-5, 600.0]),
        ("hammer", "rigid", "trigonometric@2us", [2e-5, 600.0]),
        (
            "hammer",
            "rigid",
            "generalised-alpha(rho_inf=0.8)@1us",
            [1e-5, 900.0],
        ),
        (
            "hammer",
            "movable-teeth",
            "velocity-verlet@1us",
            [1e-5, 300.0],
        ),
        (
            "loaded_mesh",
            "rigid",
            "velocity-verlet@400ns",
            [4e-6, 400.0],
        ),
        (
            "driveline",
            "rigid",
            "semi-implicit-euler@400ns",
            [4e-6, 400.0],
        ),
        ("spur_impact", "elastic", "trigonometric@1us", [2e-6, 80.0]),
        (
            "spur_impact",
            "elastic",
            "velocity-verlet@500ns",
            [5e-6, 32.0],
        ),
        (
            "spur_impact",
            "elastic-half-space",
            "trigonometric@1us",
            [1e-6, 150.0],
        ),
    ] {
        let worst = difference(scene, model, method, steps, 0.0);
        println!("{scene} {model} {method}: {worst:.1e}");
        assert!(worst < 1e-12, "{scene} {model} {method}: {worst:e}");
    }
}

#[test]
fn a_start_time_shifts_the_scene() {
    let worst = difference("hammer", "rigid", "velocity-verlet@1us", [2e-5, 300.0], 0.5);
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn a_method_under_tolerance_ends_within_it() {
    let worst = difference("hammer", "rigid", "dopri5@1e-9", [1.3e-5, 400.0], 0.0);
    assert!(worst < 1e-8, "{worst:e}");
}

#[test]
fn reset_starts_again() {
    let file = shipped("hammer", "rigid");
    let fmu = Fmu::stepping(&packed(&file, "rigid", "rk4@2us", &[]));
    let run = || {
        fmu.initialise(0.0);
        let at = |i: i32| f64::from(i) * 1e-4;
        (0..40).for_each(|i| fmu.step(at(i), 1e-4));
        fmu.look()
    };
    let first = run();
    fmu.reset();
    fmu.set("pinion.torque", 0.0);
    assert_eq!(first, run());
}
