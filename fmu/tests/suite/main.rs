//! Tests of FMUs through the functions of the standard, declared here as in `fmi3Functions.h` and
//! `fmi2Functions.h`.

#![allow(missing_docs)]
#![allow(clippy::print_stdout)] // measured numbers belong to the log of a test run

mod convergence;
mod equal;
mod exchange;
mod fmi2;
// The one place of these tests that calls C.
#[allow(unsafe_code)]
mod host;
// Likewise for FMI 2.
#[allow(unsafe_code)]
mod host2;
mod refusals;
mod rollback;

use gearbench::context::Context;
use gearbench::fmu::description::FmiVersion;
use gearbench::fmu::package::Package;
use gearbench::scene_file::{Origin, SceneFile, Selection, load_for};
use gearbench_integrators::Scheme;

/// Loads a shipped scene by name, with a model that is to run.
fn shipped(name: &str, model: &str) -> SceneFile {
    load_for(&Context::default(), name, Selection::Labels(Some(model)))
        .unwrap_or_else(|e| panic!("{name}: {}", e.to_text()))
}

/// A scene of these tests.
fn scene(text: &str) -> SceneFile {
    let origin = Origin::File("nowhere/own.toml".into());
    SceneFile::unbuilt(&Context::default(), "own.toml", text, origin, true)
        .unwrap_or_else(|e| panic!("{}", e.to_text()))
}

fn scheme(text: &str) -> Scheme {
    Scheme::list(text, &[]).unwrap()[0]
}

/// A model of a scene under a method, with hubs that the host moves.
fn packed(file: &SceneFile, model: &str, method: &str, moved: &[&str]) -> Package {
    packed_as(FmiVersion::Three, file, model, method, moved)
}

/// Packs a model in a version of the standard.
fn packed_as(
    version: FmiVersion,
    file: &SceneFile,
    model: &str,
    method: &str,
    moved: &[&str],
) -> Package {
    let moved: Vec<String> = moved.iter().map(|name| (*name).to_owned()).collect();
    let choice = file.model(model).unwrap();
    Package::of(file, choice, scheme(method), &moved, version)
        .unwrap_or_else(|e| panic!("{}", e.to_text()))
}
