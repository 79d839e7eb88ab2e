//! Tests of the scene format: accepted values, refusals with their messages, and robustness.

mod axes;
mod contacts;
mod format;
mod lengths;
mod modifications;
mod motion;
mod plausibility;
mod precision;
mod referenced;
mod refusals;
mod refused_models;
mod robustness;
mod shipped_scenes;
mod stability;
mod values;

use super::reading::keys::tables;
use super::{Origin, SceneError, SceneFile};
use crate::context::Context;
use gearbench_models::geometry::Gear;
use gearbench_models::spec::Body;
use miette::{GraphicalReportHandler, GraphicalTheme};

/// A small valid scene that the tests modify.
const BASE: &str = r#"schema = 1
name = "test"
title = "A test"
duration_s = 1e-4
reference = "calculix/case-a-fine"
tolerance = 0.05

[gears.pinion]
teeth = 20
module_m = 0.004
face_width_m = 0.01
speed_rad_s = 20.0
loads = [{ torque_nm = 10.0 }]

[gears.wheel]
teeth = 30
module_m = 0.004
face_width_m = 0.01
mount = "revolute"

[[meshes]]
gears = ["pinion", "wheel"]
centre_distance_m = 0.1001
start = { flank = "left", gap_m = 1e-6 }

[[models]]
model = "rigid"
contact = { stiffness = { kind = "constant", stiffness_n_per_m2 = 1.4e10 }, damping = { law = "flores", e = 0.9 } }

[[models]]
model = "movable-teeth"
contact = { stiffness = "iso6336" }
parameters = { tooth_stiffness_n_per_m = 5.3e8, tooth_mass_kg = 4.8e-3 }

[study]
integrators = [{ method = "dopri5", rtol = 1e-6 }, { method = "rk4", step_s = 1e-6 }]
"#;

/// Conical gears on intersecting axes.
const SHIPPED_BEVELOID: &str = include_str!("../../../scenes/beveloid.toml");

/// A set of maps of stability, to be appended to the base scene.
const STABILITY: &str = r#"
[[study.stability]]
models = ["rigid"]
integrators = ["rk4", "generalised-alpha(rho_inf=0.5)"]
duration_s = 5e-5
step_s = { from = 1e-7, to = 1e-5, points = 5 }
axes = [{ axis = "damping", values = [0.2, 0.0] }, { axis = "speed", from = 0.5, to = 2.0, points = 3 }]
max_steps = 1000
"#;

fn parse(text: &str) -> Result<SceneFile, SceneError> {
    SceneFile::parse(
        &Context::default(),
        "test.toml",
        text,
        Origin::Shipped,
        true,
    )
}

/// The base scene with one piece of text replaced.
fn changed(from: &str, to: &str) -> String {
    assert!(BASE.contains(from), "`{from}` is not in the base scene");
    BASE.replacen(from, to, 1)
}

fn read(from: &str, to: &str) -> SceneFile {
    parse(&changed(from, to)).unwrap_or_else(|e| panic!("{}", render(&e)))
}

/// The toothing of a gear that is no rack.
fn toothing_of(scene: &SceneFile, gear: usize) -> Gear {
    match &scene.spec.gears[gear].body {
        Body::Gear(toothing) => toothing.clone(),
        Body::Rack(_) => panic!("a gear"),
    }
}

/// The page about the format names every key, and its example is a sound scene.
#[test]
fn the_format_is_described() {
    let page = include_str!("../../../scenes/README.md");
    let whole = |text: &str, key: &str| {
        text.match_indices(key).any(|(i, _)| {
            let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
            !text[..i].ends_with(part) && !text[i + key.len()..].starts_with(part)
        })
    };
    for table in tables() {
        for (key, meaning) in table.keys {
            assert!(
                whole(page, key),
                "`{key}` of {} is not described",
                table.name
            );
            assert!(!meaning.is_empty(), "{key}");
        }
        let same = tables().filter(|t| t.name == table.name).count();
        assert_eq!(same, 1, "{} stands for two tables", table.name);
    }
    let example = page
        .split("```toml\n")
        .nth(1)
        .unwrap()
        .split("```")
        .next()
        .unwrap();
    let scene = parse(example).unwrap_or_else(|e| panic!("{}", render(&e)));
    assert_eq!(scene.models.len(), 1);
}

/// Renders an error as the user sees it, without colours and with wide lines.
fn render(error: &SceneError) -> String {
    let mut text = String::new();
    GraphicalReportHandler::new_themed(GraphicalTheme::none())
        .with_width(400)
        .render_report(&mut text, error)
        .unwrap();
    text
}
