//! Tests of the scene format: what is read, what is refused and in which words, what never panics.

mod contacts;
mod precision;
mod refusals;
mod refused_gears;
mod refused_models;
mod robustness;
mod shipped_scenes;
mod stability;
mod values;

use super::{Origin, SceneError, SceneFile};
use miette::{GraphicalReportHandler, GraphicalTheme};

/// A small sound scene that the tests change.
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

fn parse(text: &str) -> Result<SceneFile, SceneError> {
    SceneFile::parse("test.toml", text, Origin::Shipped, true)
}

/// The base scene with one piece of text replaced.
fn changed(from: &str, to: &str) -> String {
    assert!(BASE.contains(from), "`{from}` is not in the base scene");
    BASE.replacen(from, to, 1)
}

fn read(from: &str, to: &str) -> SceneFile {
    parse(&changed(from, to)).unwrap_or_else(|e| panic!("{}", render(&e)))
}

/// The page about the format names every key, and its example is a sound scene.
#[test]
fn the_format_is_described() {
    let page = include_str!("../../../scenes/README.md");
    let tables = [
        super::SCENE,
        super::gear::GEAR,
        super::gear::RACK,
        super::gear::RELIEF,
        super::gear::ELASTIC,
        super::mesh::MESH,
        super::mesh::START,
        super::model::MODEL,
        super::model::OF_GEAR,
        super::calibrated::CALIBRATION,
        super::contact::CONTACT,
        super::stiffness::CONSTANT,
        super::stiffness::ISO,
        super::stiffness::COMPLIANCE,
        super::stiffness::TABLE,
        super::contact::KELVIN_VOIGT,
        super::contact::RATIO,
        super::contact::RESTITUTION,
        super::contact::FRICTION,
        super::contact_points::POINTS,
        super::study_plan::STUDY,
        super::study_plan::INTEGRATOR,
        super::study_plan::TOLERANCE,
        super::stability::STABILITY,
        super::stability::SPAN,
        super::stability::AXIS,
    ];
    let tables = tables.into_iter().chain(super::profile::tables());
    let whole = |text: &str, key: &str| {
        text.match_indices(key).any(|(i, _)| {
            let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
            !text[..i].ends_with(part) && !text[i + key.len()..].starts_with(part)
        })
    };
    for key in tables.flatten() {
        assert!(whole(page, key.name), "`{}` is not described", key.name);
        assert!(!key.meaning.is_empty());
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

/// What a user sees, without colours and on wide lines.
fn render(error: &SceneError) -> String {
    let mut text = String::new();
    GraphicalReportHandler::new_themed(GraphicalTheme::none())
        .with_width(400)
        .render_report(&mut text, error)
        .unwrap();
    text
}

/// Refusal of the base scene with a piece replaced: its line, and words of the rendered text.
fn refused(from: &str, to: &str, line: usize, words: &[&str]) {
    let text = changed(from, to);
    let error = match parse(&text) {
        Ok(_) => panic!("`{to}` was accepted"),
        Err(e) => e,
    };
    let shown = render(&error);
    assert_eq!(error.line(), Some(line), "\n{shown}");
    assert!(
        shown.contains(&format!("test.toml:{line}:")),
        "no line {line} in\n{shown}"
    );
    for word in words {
        assert!(shown.contains(word), "no `{word}` in\n{shown}");
    }
    assert!(error.help_text().is_some(), "no way out in\n{shown}");
}
