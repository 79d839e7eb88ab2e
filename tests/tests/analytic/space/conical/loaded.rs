//! The shipped pair under load, original and with tip relief: the transmission error falls, at rest and running.

use gearbench::context::Context;
use gearbench::scene_file::{self, SceneFile};
use gearbench_integrators::{
    AcceptedStep, Control, Outputs, Resolution, SecondOrderSystem, Sink, TimePlan,
};
use gearbench_models::scene::{OfGear, OfMesh, Scene};
use gearbench_models::spec::{Load, Modelling, Profile, effective_radius};
use gearbench_reference::statics::{self, LoadedPair, MeshCycle};
use gearbench_tests::watched;

const TORQUE: f64 = 1500.0;

fn load(name: &str) -> SceneFile {
    scene_file::load(&Context::default(), name).unwrap_or_else(|e| panic!("{e:?}"))
}

/// Returns the static transmission error at a number of positions, peak to peak [m].
fn at_rest(scene: &SceneFile, modelling: &Modelling, places: usize) -> f64 {
    let models = gearbench::models::models();
    let mut pair = LoadedPair::new(&scene.spec, modelling, models).unwrap();
    let force = TORQUE / effective_radius(&scene.spec.gears[0].body);
    let cycle = MeshCycle::solve(&mut pair, statics::Load::Force(force), places, |_| {}).unwrap();
    cycle.peak_to_peak()
}

fn modelling<'a>(scene: &'a SceneFile, label: &str) -> &'a Modelling {
    &scene.model(label).unwrap().modelling
}

/// Sink that records the smallest and largest transmission error from a time on.
struct Error {
    radii: [f64; 2],
    after: f64,
    found: [f64; 2],
    out: Outputs,
}

impl Sink for Error {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        if step.to.t > self.after {
            sys.output(step.to.at(), &mut self.out);
            let at = |gear: usize| {
                let first = OfMesh::ALL.len() + OfGear::ALL.len() * gear;
                self.radii[gear] * self.out.channels[first + OfGear::Displacement as usize]
            };
            let error = at(0) + at(1);
            self.found = [self.found[0].min(error), self.found[1].max(error)];
        }
        Control::Continue
    }
}

/// Returns the transmission error over the last mesh cycle of a run, peak to peak [m].
fn running(file: &SceneFile, modelling: &Modelling, method: &str) -> f64 {
    let mut scene = Scene::build(&file.spec, modelling, gearbench::models::models()).unwrap();
    let cycle = std::f64::consts::TAU / (35.0 * file.spec.gears[0].speed);
    let mut error = Error {
        radii: [0, 1].map(|k| effective_radius(&file.spec.gears[k].body)),
        after: file.duration - cycle,
        found: [f64::INFINITY, f64::NEG_INFINITY],
        out: Outputs::default(),
    };
    let plan = TimePlan::new(file.duration, Resolution::Step(2e-6));
    let start = scene.initial();
    watched(&mut scene, start, method, &plan, &mut error);
    error.found[1] - error.found[0]
}

#[test]
fn tip_relief_makes_conical_gears_steadier() {
    let [original, corrected] = ["beveloid", "beveloid_corrected"].map(load);
    for label in ["rigid", "movable-teeth"] {
        let both = [&original, &corrected];
        let still = both.map(|scene| at_rest(scene, modelling(scene, label), 24));
        let moving = both.map(|scene| running(scene, modelling(scene, label), "velocity-verlet"));
        println!(
            "{label}: peak to peak at rest {:.2e}, corrected {:.2e} m; running {:.2e}, {:.2e} m",
            still[0], still[1], moving[0], moving[1]
        );
        assert!(still[1] < 0.3 * still[0], "{label}: {still:.2?}");
        assert!(moving[1] < 0.6 * moving[0], "{label}: {moving:.2?}");
    }
}

/// Returns the gears of the scene on a coarser mesh.
fn meshed(scene: &SceneFile, label: &str) -> Modelling {
    let mut coarse = modelling(scene, label).clone();
    let counts = [
        ("flank_elements", 6.0),
        ("width_elements", 8.0),
        ("rim_elements", 2.0),
    ];
    for gear in &mut coarse.gears {
        for (key, n) in counts {
            gear.set(key, n).unwrap();
        }
    }
    coarse
}

#[test]
fn tip_relief_makes_meshed_cones_steadier_at_rest() {
    let both = ["beveloid", "beveloid_corrected"].map(load);
    let [original, corrected] = both
        .each_ref()
        .map(|scene| at_rest(scene, &meshed(scene, "elastic"), 10));
    println!("elastic: peak to peak at rest {original:.2e}, corrected {corrected:.2e} m");
    assert!(corrected < 0.7 * original, "{corrected:.2e} {original:.2e}");
}

/// Returns the scene at a tenth of its speed, with its load applied over fourteen periods of the gears on their teeth.
/// The compliance of the truncated modes of elastic gears, between their modes and their contact, is undamped, so that
/// at full speed its vibration persists through the run whatever the flanks are.
fn slowly(mut file: SceneFile) -> SceneFile {
    for gear in &mut file.spec.gears {
        gear.speed *= 0.1;
        for load in &mut gear.loads {
            if let Load::Applied(Profile::Ramp { end, .. }) = load {
                *end = 0.01;
            }
        }
    }
    file.duration = 0.03;
    file
}

#[test]
#[ignore = "a minute"]
fn tip_relief_makes_running_meshed_cones_steadier() {
    let both = ["beveloid", "beveloid_corrected"].map(|name| slowly(load(name)));
    let [original, corrected] = both
        .each_ref()
        .map(|scene| running(scene, &meshed(scene, "elastic"), "trigonometric"));
    println!("elastic: peak to peak running {original:.2e}, corrected {corrected:.2e} m");
    assert!(corrected < 0.8 * original, "{corrected:.2e} {original:.2e}");
}
