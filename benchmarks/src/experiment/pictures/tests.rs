//! Frames are read back and compared with their run.

use super::*;
use crate::context::Context;
use crate::experiment::runner::Runner;
use crate::scene_file::{Origin, SceneFile};
use crate::studies::compare::{FramePlan, Plan, compare};
use crate::studies::test_scene::{coarse, coarse_full};
use gearbench_integrators::Scheme;
use gearbench_integrators::table::{DOPRI5, NEWMARK, TRIGONOMETRIC, VELOCITY_VERLET};
use gearbench_models::spec::Body;
use gearbench_reports::record::Run;
use std::collections::HashMap;

/// Contents of the file of a frame: arrays of numbers by name.
struct FrameFile {
    arrays: HashMap<String, Vec<f64>>,
}

impl FrameFile {
    fn of(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap();
        let mark = b"<AppendedData encoding=\"raw\">\n_";
        let head = bytes.windows(mark.len()).position(|w| w == mark).unwrap();
        let (text, data) = bytes.split_at(head + mark.len());
        let text = std::str::from_utf8(text).unwrap();
        let mut arrays = HashMap::new();
        for element in text.split("<DataArray ").skip(1) {
            let value = |key: &str| {
                let from = element.split_once(&format!("{key}=\"")).unwrap().1;
                from.split_once('"').unwrap().0
            };
            let offset: usize = value("offset").parse().unwrap();
            let length = u64::from_le_bytes(data[offset..offset + 8].try_into().unwrap()) as usize;
            let values = &data[offset + 8..][..length];
            let numbers: Vec<f64> = match value("type") {
                "Float64" => (values.chunks_exact(8))
                    .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
                    .collect(),
                "Int32" => (values.chunks_exact(4))
                    .map(|b| f64::from(i32::from_le_bytes(b.try_into().unwrap())))
                    .collect(),
                "UInt8" => values.iter().map(|b| f64::from(*b)).collect(),
                other => panic!("{other}"),
            };
            arrays.insert(value("Name").to_owned(), numbers);
        }
        let read = FrameFile { arrays };
        // Cells end where their nodes do, and have nodes of the file alone.
        let nodes = read.of_name("Points").len() / 3;
        let (ends, cells) = (read.of_name("offsets"), read.of_name("connectivity"));
        assert_eq!(ends.last().copied(), Some(cells.len() as f64));
        assert!(ends.windows(2).all(|w| w[0] < w[1]));
        assert!(cells.iter().all(|n| (0.0..nodes as f64).contains(n)));
        assert_eq!(ends.len(), read.of_name("types").len());
        read
    }

    fn of_name(&self, name: &str) -> &[f64] {
        &self.arrays[name]
    }

    fn vectors(&self, name: &str) -> Vec<Vec3> {
        let of = self.of_name(name).chunks_exact(3);
        of.map(Vec3::from_column_slice).collect()
    }

    /// Nodes of a gear, from 1.
    fn nodes(&self, gear: usize) -> Vec<usize> {
        let of = self.of_name("gear");
        (0..of.len()).filter(|n| of[*n] == gear as f64).collect()
    }
}

/// A run with frames, and these with their times from the collection.
fn pictured(scene: &SceneFile, method: Scheme, frames: usize) -> (Run, Vec<(f64, FrameFile)>) {
    let folder = tempfile::tempdir().unwrap();
    let choices: Vec<_> = scene.models.iter().collect();
    let plan = Plan {
        pictures: Some(FramePlan {
            folder: folder.path().to_owned(),
            frames,
            window: [0.0, scene.duration],
        }),
        ..Plan::of(scene, &choices, &[]).with_methods(vec![method])
    };
    let run = compare(&plan, &Runner::default()).unwrap().runs.remove(0);
    let mut collections = std::fs::read_dir(folder.path()).unwrap();
    let name = collections.find_map(|e| {
        let path = e.unwrap().path();
        path.extension().is_some_and(|e| e == "pvd").then_some(path)
    });
    let text = std::fs::read_to_string(name.unwrap()).unwrap();
    let read = text.split("timestep=\"").skip(1).map(|set| {
        let (time, rest) = set.split_once('"').unwrap();
        let file = rest
            .split_once("file=\"")
            .unwrap()
            .1
            .split_once('"')
            .unwrap()
            .0;
        let read = FrameFile::of(&folder.path().join(file));
        let time: f64 = time.parse().unwrap();
        assert_eq!(read.of_name("TimeValue"), [time]);
        (time, read)
    });
    let read: Vec<_> = read.collect();
    assert_eq!(read.len(), frames);
    for (i, (time, _)) in read.iter().enumerate() {
        let expected = scene.duration * i as f64 / (frames - 1) as f64;
        assert!((time - expected).abs() < 1e-12 * scene.duration);
    }
    (run, read)
}

/// A value of a run at a time of its series.
fn at(run: &Run, values: &[f64], time: f64) -> f64 {
    let t = &run.series.as_ref().unwrap().time_s;
    let i = t.partition_point(|x| *x < time).clamp(1, t.len() - 1);
    let part = (time - t[i - 1]) / (t[i] - t[i - 1]);
    values[i - 1] + part * (values[i] - values[i - 1])
}

/// Checks that the forces on both gears are opposite, and sum up to the force of the run.
fn bears_the_force(run: &Run, frames: &[(f64, FrameFile)], within: f64) {
    let series = run.series.as_ref().unwrap();
    let peak = series.contact_force().iter().copied().fold(0.0, f64::max);
    let mut most = 0.0_f64;
    for (time, read) in frames {
        let forces = read.vectors("contact_force");
        let [a, b] = [1, 2].map(|gear| read.nodes(gear).iter().map(|n| forces[*n]).sum::<Vec3>());
        assert!((a + b).norm() < 1e-9 * peak);
        let expected = at(run, series.contact_force(), *time);
        assert!(
            (a.norm() - expected).abs() < within * peak,
            "{} {expected}",
            a.norm()
        );
        most = most.max(a.norm());
        let pressed = read.of_name("contact_pressure");
        assert!(pressed.iter().all(|p| *p >= 0.0));
    }
    assert!(most > 0.5 * peak, "no frame shows the contact");
}

const RIGID: &str = r#"
schema = 1
name = "pictured"
duration_s = 1e-4
[gears.a]
teeth = 18
module_m = 0.002
face_width_m = 0.006
bore_radius_m = 0.007
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
"#;

fn scene(model: &str) -> SceneFile {
    let text = format!("{RIGID}{model}");
    SceneFile::unbuilt(
        &Context::default(),
        "pictured.toml",
        &text,
        Origin::Shipped,
        false,
    )
    .unwrap()
}

/// Rigid gears rotate by the angles of their hubs, and their tip radii are kept.
#[test]
fn rigid_gears_turn_with_their_hubs() {
    let scene = scene("model = \"rigid\"\ncontact = { stiffness = \"iso6336\" }");
    let (run, frames) = pictured(&scene, DOPRI5.at_tolerance(1e-8), 11);
    bears_the_force(&run, &frames, 2e-3);
    let (_, first) = &frames[0];
    let places = first.vectors("Points");
    let series = run.series.as_ref().unwrap();
    for (gear, of) in (1..).zip(&scene.spec.gears) {
        let Body::Gear(body) = &of.body else { panic!() };
        let name = format!("hub_angle_{}_rad", of.name);
        let angles = series.columns.iter().find(|c| c.name == name).unwrap();
        let centre: Vec3 = of.position.into();
        let radius = |x: &Vec3| (x - centre).xy().norm();
        let of_gear = first.nodes(gear);
        let radii = of_gear.iter().map(|n| radius(&places[*n]));
        let tip = radii.fold(0.0, f64::max);
        assert!((tip - body.r_tip()).abs() < 1e-12);
        for (time, read) in &frames {
            let moved = read.vectors("Points");
            assert!(read.vectors("displacement").iter().all(|u| u.norm() == 0.0));
            let (sin, cos) = at(&run, &angles.values, *time).sin_cos();
            for &n in &of_gear {
                let x = places[n] - centre;
                let turned = Vec3::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, x.z);
                let off = (moved[n] - centre - turned).norm();
                assert!(off < 1e-9, "{off:e}");
            }
        }
    }
}

/// Teeth in contact deflect, up to their tips; roots and other teeth follow the hub.
#[test]
fn movable_teeth_yield() {
    let scene = scene(
        "model = \"movable-teeth\"\ncontact = { stiffness = \"iso6336\" }\nparameters = { tooth_stiffness_n_per_m = 5e8, tooth_mass_kg = 2e-4 }",
    );
    let (run, frames) = pictured(&scene, VELOCITY_VERLET.at_step(2e-7), 21);
    bears_the_force(&run, &frames, 2e-2);
    let most = |read: &FrameFile| {
        let all = read.vectors("displacement");
        all.iter().map(|u| u.norm()).fold(0.0, f64::max)
    };
    let peak = frames.iter().map(|(_, f)| most(f)).fold(0.0, f64::max);
    let force = run.series.as_ref().unwrap().contact_force().iter().copied();
    // The spring of a tooth, and what inertia adds.
    let by_spring = force.fold(0.0, f64::max) / 5e8;
    assert!(
        (0.3..2.0).contains(&(peak / by_spring)),
        "{peak:e} {by_spring:e}"
    );
    let moved = frames
        .iter()
        .max_by(|a, b| most(&a.1).total_cmp(&most(&b.1)));
    let all = moved.unwrap().1.vectors("displacement");
    let still = all.iter().filter(|u| u.norm() < 0.1 * peak).count();
    assert!(4 * still > 3 * all.len(), "{still} of {}", all.len());
}

/// The displacements of meshes of elastic gears in contact agree with the sections of the report: the sections use
/// displacements along the normals of the model's own flanks, the meshes the modes and the stiffness of the mesh.
#[test]
fn elastic_gears_show_their_displacement() {
    let scene = coarse(&[("modes", 6.0.into())]);
    let (run, frames) = pictured(&scene, TRIGONOMETRIC.at_step(1e-6), 13);
    bears_the_force(&run, &frames, 2e-2);
    let series = run.series.as_ref().unwrap();
    let moved = frames.iter().max_by(|a, b| {
        let force = |f: &&(f64, FrameFile)| at(&run, series.contact_force(), f.0);
        force(a).total_cmp(&force(b))
    });
    let all = moved.unwrap().1.vectors("displacement");
    let most = all.iter().map(|u| u.norm()).fold(0.0, f64::max);
    // Steel teeth yield by some tens of micrometres under 1 kN/mm.
    let per_width = series.contact_force().iter().copied().fold(0.0, f64::max) / 6e-3;
    assert!((5e-12..1.5e-10).contains(&(most / per_width)), "{most:e}");
}

/// In full finite elements, nodes of the bore follow the hub, and the others deflect.
#[test]
fn full_finite_elements_show_their_nodes() {
    // Steps of a microsecond make a peak of their own between two frames.
    let (run, frames) = pictured(&coarse_full(), NEWMARK.at_step(2e-7), 13);
    bears_the_force(&run, &frames, 5e-2);
    for (_, read) in &frames {
        let (places, off) = (read.vectors("Points"), read.vectors("displacement"));
        let mut held = 0;
        for n in read.nodes(1) {
            if places[n].xy().norm() < 7e-3 * (1.0 + 1e-9) {
                assert!(off[n].norm() < 1e-15);
                held += 1;
            }
        }
        assert!(held > 10);
    }
}

#[test]
fn names_of_files_are_plain() {
    assert_eq!(
        file_name("elastic (half-space) hht-alpha(alpha=0.05) 5e-7"),
        "elastic-half-space-hht-alpha-alpha-0-05-5e-7"
    );
}
