use super::*;
use crate::context::Context;
use crate::experiment::configuration::Configuration;
use crate::experiment::runner::Runner;
use crate::models::models;
use crate::scene_file::{Origin, SceneFile};
use crate::studies::compare::{Plan, compare};
use crate::studies::test_scene::{coarse, coarse_rack};
use gearbench_integrators::table::{DOPRI5, TRIGONOMETRIC};
use gearbench_reports::record::{ContactSnapshot, Run};

fn run_of(scene: &SceneFile, method: gearbench_integrators::Scheme) -> Run {
    let choices: Vec<_> = scene.models.iter().collect();
    let plan = Plan::of(scene, &choices, &[]).with_methods(vec![method]);
    compare(&plan, &Runner::default()).unwrap().runs.remove(0)
}

fn force_of(picture: &ContactSnapshot) -> f64 {
    let sum = |k: usize| picture.contacts.iter().map(|c| c.force[k]).sum::<f64>();
    sum(0).hypot(sum(1))
}

/// Elastic flanks: pressures times areas of the points sum up to the force, and the points are within the face.
#[test]
fn patches_of_elastic_flanks_bear_the_force() {
    let run = run_of(
        &coarse(&[("modes", 4.0.into())]),
        TRIGONOMETRIC.at_step(1e-6),
    );
    let picture = run.contacts.as_ref().unwrap();
    let [load] = &picture.flanks[..] else {
        panic!("one mesh touches on one side")
    };
    assert_eq!(
        (load.value, load.side.as_str()),
        (FlankValue::Pressure, "left")
    );
    let force: f64 = load.patches.iter().map(|p| p.force_n).sum();
    assert!((force / force_of(picture) - 1.0).abs() < 1e-3, "{force}");
    // The base radius of 18 teeth of 2 mm.
    let r_base = 18e-3 * 20_f64.to_radians().cos();
    for p in &load.patches {
        let area = p.size_m[0] * p.roll_m / r_base * p.size_m[1];
        assert!((p.value * area / p.force_n - 1.0).abs() < 1e-9, "{p:?}");
        assert!(
            p.height_m.abs() + 0.5 * p.size_m[1] < 3e-3 * (1.0 + 1e-9),
            "{p:?}"
        );
    }
    let grid = load.over_run.as_ref().unwrap();
    let greatest = load.patches.iter().map(|p| p.value).fold(0.0, f64::max);
    let over_run = grid.values.iter().copied().fold(0.0, f64::max);
    assert!(grid.instants > 10 && over_run >= 0.999 * greatest);
}

/// Rigid flanks: forces per width times the widths of the slices sum up to the force.
#[test]
fn slices_of_rigid_flanks_bear_the_force() {
    let text = r#"
schema = 1
name = "slices"
duration_s = 1e-4
[gears.a]
teeth = 18
module_m = 0.002
face_width_m = 0.006
speed_rad_s = 20.0
helix_angle_deg = 12.0
[gears.b]
teeth = 24
module_m = 0.002
face_width_m = 0.008
helix_angle_deg = -12.0
[[meshes]]
gears = ["a", "b"]
backlash_m = 80e-6
start = { flank = "left", gap_m = 1e-6 }
[[models]]
model = "rigid"
contact = { stiffness = "iso6336", slices = 10 }
"#;
    let scene = SceneFile::unbuilt(
        &Context::default(),
        "slices.toml",
        text,
        Origin::Shipped,
        false,
    )
    .unwrap();
    let run = run_of(&scene, DOPRI5.at_tolerance(1e-6));
    let picture = run.contacts.as_ref().unwrap();
    let load = &picture.flanks[0];
    assert_eq!(load.value, FlankValue::LineLoad);
    let sum: f64 = load.patches.iter().map(|p| p.value * p.size_m[1]).sum();
    let forces: f64 = load.patches.iter().map(|p| p.force_n).sum();
    assert!((sum / forces - 1.0).abs() < 1e-12);
    // In the transverse plane it is less by the cosine of the base helix angle.
    let cos = 0.980_729;
    assert!((force_of(picture) / forces / cos - 1.0).abs() < 1e-3);
    assert!(
        load.patches
            .iter()
            .all(|p| (p.size_m[1] - 6e-4).abs() < 1e-12)
    );
    assert_eq!(load.over_run.as_ref().unwrap().columns, 10);
    assert!(picture.deformed.is_empty());
}

/// Deformed sections of teeth under a static load agree with the displacement of the mesh, from the contact to the
/// tips. (Their normals are chords of the grid, with errors of a few degrees near its ends.)
#[test]
fn sections_yield_as_the_body_does() {
    yields_as_the_body(&coarse(&[("modes", 6.0.into())]));
    yields_as_the_body(&coarse_rack(&[("modes", 6.0.into())]));
}

fn yields_as_the_body(file: &SceneFile) {
    let of = Configuration::of(file, &file.models[0]);
    let mut scene = Scene::build(&of.scene, &of.modelling, models()).unwrap();
    let mut state = scene.initial();
    // Five micrometres into each other, at rest.
    let r_base = 18e-3 * 20_f64.to_radians().cos();
    state.q[0] += 6e-6 / r_base;
    state.v.fill(0.0);
    let pressed: f64 = (scene.contact_forces(state.at()).iter())
        .map(|f| f.normal_force)
        .sum();
    assert!(pressed > 50.0, "{pressed}");
    // The picture of the run has both gears of the mesh.
    let drawn = deformed_sections(&of.scene, &mut scene, &state);
    for gear in ["a", "b"] {
        assert!(drawn.iter().any(|section| section.gear == gear), "{gear}");
    }
    let bodies = scene.bodies(&of.scene).unwrap();
    for (gear, body) in bodies.iter().enumerate() {
        let found = scene.displaced(state.at(), gear, body).unwrap();
        let teeth: Vec<u32> = (0..18).collect();
        let sections = scene.deformed_flanks(state.at(), gear, &teeth, 0.0);
        let lengths = || sections.iter().flat_map(|s| &s.displacement);
        let most = lengths().map(|d| d.norm()).fold(0.0, f64::max);
        assert!(most > 1e-7, "{most:e}");
        let (mut compared, mut tips) = (0, 0);
        for section in &sections {
            let rows = section.with_hub.iter().zip(&section.displacement);
            for (row, (x, d)) in rows.enumerate() {
                let near = (found.rigid.iter().zip(&found.displacement))
                    .find(|(place, _)| (*place - x).norm() < 1e-9);
                let (_, u) = near.expect("a node of the mesh");
                if d.norm() > 0.1 * most {
                    let along = u.dot(d) / d.norm();
                    assert!(
                        (along - d.norm()).abs() < 0.1 * most,
                        "{along:e} {:e}",
                        d.norm()
                    );
                    compared += 1;
                    tips += usize::from(row + 1 == section.with_hub.len());
                }
            }
        }
        assert!(compared >= 3 && tips > 0, "{compared} {tips}");
    }
}
