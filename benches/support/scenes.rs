//! Shipped scenes, runs of them, and figures that are stored.

use super::ratio::seconds;
use gearbench::context::Context;
use gearbench::experiment::machine;
use gearbench::scene_file::{self, SceneFile};
use gearbench_integrators::{Integrator, Resolution, Sink, State, TimePlan, Work};
use gearbench_models::scene::Scene;
use gearbench_models::spec::Modelling;
use serde_json::json;

/// Loads a shipped scene, or one at a path from the root of the repository.
pub fn file(name: &str) -> SceneFile {
    scene_file::load(&Context::default(), name).unwrap_or_else(|e| panic!("{e:?}"))
}

/// Builds a model of a scene with modified modelling.
pub fn changed(file: &SceneFile, label: &str, change: impl FnOnce(&mut Modelling)) -> Scene {
    let choice = file
        .model(label)
        .unwrap_or_else(|| panic!("no model {label}"));
    let mut modelling = choice.modelling.clone();
    change(&mut modelling);
    let spec = file.spec_for(choice);
    Scene::build(&spec, &modelling, gearbench::models::models()).unwrap_or_else(|e| panic!("{e}"))
}

/// Builds a model of a scene with given parameters of its gears.
pub fn built(file: &SceneFile, label: &str, parameters: &[(&str, f64)]) -> Scene {
    changed(file, label, |modelling| {
        for gear in &mut modelling.gears {
            for (key, x) in parameters {
                gear.set(key, *x).unwrap_or_else(|e| panic!("{e}"));
            }
        }
    })
}

/// Makes one run from the beginning: returns the last state, the work, and the wall time [s] of the integration alone.
pub fn run(
    scene: &mut Scene,
    method: &mut dyn Integrator,
    plan: &TimePlan<'_>,
    sink: &mut dyn Sink,
) -> (State, Work, f64) {
    let (mut state, mut work) = (scene.initial(), Work::default());
    let wall = seconds(|| {
        let done = method.run(scene, &mut state, plan, sink, &mut work);
        done.unwrap_or_else(|e| panic!("{e}"));
    });
    (state, work, wall)
}

/// Builds a method from its text.
pub fn method(text: &str) -> Box<dyn Integrator> {
    gearbench_integrators::method(text).unwrap_or_else(|e| panic!("{e}"))
}

/// Formats a resolution for tables.
pub fn resolution(resolution: Resolution) -> String {
    match resolution {
        Resolution::Step(h) => format!("h {h:.1e} s"),
        Resolution::Tolerance(r) => format!("rtol {r:.1e}"),
    }
}

/// Returns the argument that follows a word of the command line.
pub fn after(word: &str) -> Option<String> {
    std::env::args().skip_while(|w| w != word).nth(1)
}

/// Writes figures with the command, machine, commit and date to the file after `--store`, if one is given.
pub fn store(command: &str, mut figures: serde_json::Value) {
    let Some(file) = after("--store") else {
        return;
    };
    sign(&mut figures, command);
    std::fs::write(&file, format!("{figures:#}\n")).unwrap_or_else(|e| panic!("{file}: {e}"));
}

/// Adds the command, machine, commit and date to figures.
pub fn sign(figures: &mut serde_json::Value, command: &str) {
    figures["command"] = json!(command);
    figures["machine"] = json!(machine::machine());
    figures["date"] = json!(machine::now());
    figures["commit"] = json!(machine::commit_of_checkout());
}
