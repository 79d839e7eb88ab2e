//! The shipped pair under load, original and with tip relief: the transmission error falls, at rest and running.

use gearbench::scene_file::{self, SceneFile};
use gearbench_integrators::{
    AcceptedStep, Control, Outputs, Resolution, SecondOrderSystem, Sink, TimePlan,
};
use gearbench_models::scene::{OfGear, OfMesh, Scene};
use gearbench_models::spec::effective_radius;
use gearbench_reference::statics::{Load, LoadedPair, MeshCycle};
use gearbench_tests::watched;

const TORQUE: f64 = 1500.0;

fn load(name: &str) -> SceneFile {
    scene_file::load(name).unwrap_or_else(|e| panic!("{e:?}"))
}

/// Static transmission error, peak to peak [m].
fn at_rest(scene: &SceneFile, label: &str) -> f64 {
    let modelling = &scene.model(label).unwrap().modelling;
    let models = gearbench::models::models();
    let mut pair = LoadedPair::new(&scene.spec, modelling, models).unwrap();
    let force = TORQUE / effective_radius(&scene.spec.gears[0].body);
    let cycle = MeshCycle::solve(&mut pair, Load::Force(force), 24, |_| {}).unwrap();
    cycle.peak_to_peak()
}

/// Least and largest transmission error from a time on.
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

/// Transmission error over the last mesh cycle of a run, peak to peak [m].
fn running(file: &SceneFile, label: &str) -> f64 {
    let modelling = &file.model(label).unwrap().modelling;
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
    watched(&mut scene, start, "velocity-verlet", &plan, &mut error);
    error.found[1] - error.found[0]
}

#[test]
fn tip_relief_makes_conical_gears_steadier() {
    let [original, corrected] = ["beveloid", "beveloid_corrected"].map(load);
    for label in ["rigid", "movable-teeth"] {
        let still = [&original, &corrected].map(|scene| at_rest(scene, label));
        let moving = [&original, &corrected].map(|scene| running(scene, label));
        println!(
            "{label}: peak to peak at rest {:.2e}, corrected {:.2e} m; running {:.2e}, {:.2e} m",
            still[0], still[1], moving[0], moving[1]
        );
        assert!(still[1] < 0.3 * still[0], "{label}: {still:.2?}");
        assert!(moving[1] < 0.6 * moving[0], "{label}: {moving:.2?}");
    }
}
