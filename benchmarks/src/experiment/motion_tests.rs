use super::add_tooth_motion;
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::run::{Job, run};
use crate::scene_file::{Origin, SceneFile};
use crate::studies::test_scene::coarse;
use gearbench_integrators::Scheme;
use gearbench_integrators::table::{DOPRI5, TRIGONOMETRIC};
use gearbench_reports::record::Run;

fn run_of(scene: &SceneFile, method: &Scheme) -> Run {
    let of = Configuration::of(scene, scene.models.first().unwrap());
    let conditions = Conditions {
        repeats: 0,
        ..Conditions::of(scene)
    };
    let grid = conditions.grid();
    let job = Job {
        histories: true,
        motion: true,
        ..conditions.job((&of.scene, &of.modelling), method, &grid)
    };
    run(&job).unwrap()
}

/// A pair without contact at the start, with a model and the helix angle of its first gear.
fn pair(model: &str, helix_deg: f64) -> SceneFile {
    let text = format!(
        r#"
schema = 1
name = "moving"
duration_s = 2e-4
[gears.a]
teeth = 18
module_m = 0.002
face_width_m = 0.006
speed_rad_s = 20.0
helix_angle_deg = {helix_deg}
[gears.b]
teeth = 24
module_m = 0.002
face_width_m = 0.006
helix_angle_deg = -{helix_deg}
[[meshes]]
gears = ["a", "b"]
backlash_m = 80e-6
start = {{ flank = "left", gap_m = 1e-6 }}
{model}"#
    );
    SceneFile::unbuilt(
        &Context::default(),
        "moving.toml",
        &text,
        Origin::Shipped,
        false,
    )
    .unwrap()
}

const RIGID: &str = r#"[[models]]
model = "rigid"
contact = { stiffness = "iso6336", slices = 10 }
"#;
const MOVABLE: &str = r#"[[models]]
model = "movable-teeth"
parameters = { tooth_stiffness_n_per_m = 2e8, tooth_mass_kg = 1e-3 }
contact = { stiffness = "iso6336" }
"#;

/// Compares the frames at times of recorded rows with these rows: rotations of both gears and the force of the mesh.
fn agrees_with_history(run: &Run) {
    let (motion, series) = (run.motion.as_ref().unwrap(), run.series.as_ref().unwrap());
    let turns: Vec<Vec<f64>> = (motion.paths.iter())
        .map(|p| p.turn_rad.values().unwrap())
        .collect();
    let forces = motion.contacts.forces_n.values().unwrap();
    let step = motion.contacts.forces_n.step;
    let first = |name: &str| (series.column(name).unwrap(), name.to_owned());
    let angles = ["a", "b"].map(|g| first(&format!("hub_angle_{g}_rad")).0);
    let (mut begin, mut compared, mut loaded) = (0, 0, 0);
    for (i, t) in motion.time_s.iter().enumerate() {
        let own = begin..begin + motion.contacts.counts[i];
        begin = own.end;
        let Some(row) = series.time_s.iter().position(|x| x == t) else {
            continue;
        };
        compared += 1;
        for (turn, angle) in turns.iter().zip(angles) {
            let found = turn[i] - turn[0];
            let start = series
                .time_s
                .iter()
                .position(|x| *x == motion.time_s[0])
                .unwrap();
            assert!((found - (angle[row] - angle[start])).abs() < 2e-8, "{t}");
        }
        let sum = |k: usize| own.clone().map(|n| forces[3 * n + k]).sum::<f64>();
        let found = sum(0).hypot(sum(1)).hypot(sum(2));
        let force = series.contact_force()[row];
        let slack = (own.len() as f64 + 1.0) * step + 1e-9 * force;
        assert!((found - force).abs() <= slack, "{t}: {found} {force}");
        loaded += usize::from(force > 0.0);
    }
    assert!(compared > 10 && loaded > 5, "{compared} {loaded}");
}

#[test]
fn frames_of_rigid_gears_are_the_recorded_history() {
    for helix in [0.0, 12.0] {
        let run = run_of(&pair(RIGID, helix), &DOPRI5.at_tolerance(1e-8));
        agrees_with_history(&run);
        let motion = run.motion.unwrap();
        assert_eq!(motion.is_plane(), helix == 0.0);
        assert!(motion.teeth.is_empty() && motion.time_s.len() <= 128 + 48 + 1);
        // Of a section all slices are one contact, in space there is one for each.
        let most = motion.contacts.counts.iter().max().unwrap();
        assert_eq!(*most >= 10, helix != 0.0, "{most}");
    }
}

/// The largest displacement of a tooth on a spring is its recorded deflection times the radius of its tip.
#[test]
fn displaced_teeth_are_those_of_the_springs() {
    let run = run_of(&pair(MOVABLE, 0.0), &DOPRI5.at_tolerance(1e-8));
    agrees_with_history(&run);
    let (motion, series) = (run.motion.unwrap(), run.series.unwrap());
    let deflection = series.column("tooth_deflection_a_rad").unwrap();
    let teeth = motion.teeth.iter().find(|t| t.body == 0).unwrap();
    assert!(!teeth.is_elastic);
    let values = teeth.displacements_m.values().unwrap();
    let tip = *teeth.rows_m.last().unwrap();
    let rows = teeth.rows_m.len();
    let mut begin = 0;
    let mut compared = 0;
    for (i, t) in motion.time_s.iter().enumerate() {
        let own = begin..begin + teeth.counts[i];
        begin = own.end;
        let Some(row) = series.time_s.iter().position(|x| x == t) else {
            continue;
        };
        let wanted = deflection[row].abs() * tip;
        if wanted == 0.0 {
            continue;
        }
        let of = |n: usize| {
            let at = n * 4 * rows + 2 * (rows - 1);
            values[at].hypot(values[at + 1])
        };
        let nearest = own
            .map(|n| (of(n) - wanted).abs())
            .fold(f64::INFINITY, f64::min);
        assert!(
            nearest < 2.0 * teeth.displacements_m.step,
            "{t}: {nearest} {wanted}"
        );
        compared += 1;
    }
    assert!(compared > 5, "{compared}");
}

/// Displacements of elastic flanks at the peak are those of the picture of deformed teeth.
#[test]
fn displaced_flanks_are_those_of_the_deformed_sections() {
    let run = run_of(
        &coarse(&[("modes", 4.0.into())]),
        &TRIGONOMETRIC.at_step(1e-6),
    );
    let (motion, picture) = (run.motion.unwrap(), run.contacts.unwrap());
    let frame = motion.nearest(picture.time_s).unwrap();
    assert_eq!(motion.time_s[frame], picture.time_s);
    let teeth = &motion.teeth[0];
    assert!(teeth.is_elastic && teeth.rows_m.len() > 2);
    let values = teeth.displacements_m.values().unwrap();
    let begin: usize = teeth.counts[..frame].iter().sum();
    let pose = motion.paths[teeth.body].poses().unwrap()[frame];
    let rows = teeth.rows_m.len();
    let name = &motion.bodies[teeth.body].gear;
    let mut compared = 0;
    for section in picture.deformed.iter().filter(|d| d.gear == *name) {
        let own = begin..begin + teeth.counts[frame];
        let n = own
            .into_iter()
            .find(|n| i64::from(teeth.teeth[*n]) + 1 == section.tooth)
            .unwrap();
        let side = usize::from(section.side == "right");
        let angle = f64::from(teeth.teeth[n]) * motion.bodies[teeth.body].pitch;
        let (sin, cos) = angle.sin_cos();
        for (row, (place, displacement)) in section
            .points
            .iter()
            .zip(&section.displacements)
            .enumerate()
        {
            let at = n * 4 * rows + 2 * (side * rows + row);
            let own = [values[at], values[at + 1]];
            // The place of the node itself: a point of the undeformed flank and its displacement.
            let turned = [
                cos * own[0] - sin * own[1],
                sin * own[0] + cos * own[1],
                0.0,
            ];
            let by = pose.turn(turned);
            // Nodes at rest have no place in the record; their radius and that of the picture agree.
            let target = [0, 1].map(|k| place[k] + displacement[k]);
            let origin = pose.origin_m;
            let radius = (target[0] - by[0] - origin[0]).hypot(target[1] - by[1] - origin[1]);
            assert!(
                (radius - teeth.rows_m[row]).abs() < 2.0 * teeth.displacements_m.step + 2e-9,
                "{row}"
            );
            compared += 1;
        }
    }
    assert!(compared > 10);
}

/// The outline of the record is that of the geometry, and contacts lie on it.
#[test]
fn contacts_lie_on_the_outlines() {
    let run = run_of(&pair(RIGID, 0.0), &DOPRI5.at_tolerance(1e-8));
    let motion = run.motion.unwrap();
    let outline = motion.bodies[0].outline(0).unwrap();
    let poses = motion.paths[0].poses().unwrap();
    let points = motion.contacts.points_m.values().unwrap();
    let frame = motion.contacts.counts.iter().position(|n| *n > 0).unwrap();
    let own = [points[0], points[1]];
    let distance = |a: [f64; 2], b: [f64; 2]| {
        let (d, p) = ([b[0] - a[0], b[1] - a[1]], [own[0] - a[0], own[1] - a[1]]);
        let t = ((p[0] * d[0] + p[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
        (p[0] - t * d[0]).hypot(p[1] - t * d[1])
    };
    let placed: Vec<[f64; 2]> = (outline.iter())
        .map(|[x, y]| {
            let p = poses[frame].point([*x, *y, 0.0]);
            [p[0], p[1]]
        })
        .collect();
    let edges = placed.iter().zip(placed.iter().cycle().skip(1));
    let off = edges
        .map(|(a, b)| distance(*a, *b))
        .fold(f64::INFINITY, f64::min);
    // Rigid flanks overlap by micrometres in contact.
    assert!(off < 3e-6, "{off}");
}

/// A loaded pair on bearings, with a motor on the shaft of the first gear.
const ON_SHAFTS: &str = r#"
schema = 1
name = "mechanism"
duration_s = 1e-3
[gears.a]
teeth = 18
module_m = 0.002
face_width_m = 0.006
bore_radius_m = 0.005
[gears.b]
teeth = 24
module_m = 0.002
face_width_m = 0.006
bore_radius_m = 0.005
bearing = { stiffness = [1e8, 2e8, 0.0, 0.0, 0.0, 0.0] }
loads = [{ torque_nm = 8.0 }]
[[shafts]]
name = "input"
carries = [
    { body = "motor", at_m = 0.02, inertia_kgm2 = 1e-3, loads = [{ torque_nm = 6.0 }] },
    { gear = "a", at_m = 0.1 },
]
sections = [
    { length_m = 0.08, diameter_m = 0.01 },
    { length_m = 0.02, stiffness_nm_per_rad = 1e4 },
]
[[meshes]]
gears = ["a", "b"]
backlash_m = 80e-6
[[models]]
model = "rigid"
contact = { stiffness = "iso6336" }
"#;

fn unbuilt(text: &str) -> SceneFile {
    SceneFile::unbuilt(&Context::default(), "of.toml", text, Origin::Shipped, false).unwrap()
}

fn modes_of(scene: &SceneFile, model: usize) -> gearbench_reports::modes::ModelModes {
    let of = Configuration::of(scene, &scene.models[model]);
    let wanted = crate::studies::modes::ModesSettings::default();
    let models = &scene.context.models;
    let scene = (&of.scene, &of.modelling);
    crate::studies::modes::vibrations("it", scene, models, &wanted).unwrap()
}

/// The frames of modes move hubs as the shapes of the record, which come from the coordinates alone.
#[test]
fn amplitudes_of_modes_are_those_of_the_shapes() {
    let found = modes_of(&unbuilt(ON_SHAFTS), 0);
    let motion = found.motion.as_ref().unwrap();
    assert!(motion.is_of_modes() && motion.time_s.is_empty());
    assert_eq!(motion.frames(), found.modes.len() + 1);
    assert!(found.modes.len() >= 5, "{}", found.modes.len());
    assert_eq!(motion.contacts.counts, vec![0; motion.frames()]);
    let mut moved = [false; 2];
    for (i, path) in motion.paths.iter().enumerate() {
        let turns = path.turn_rad.values().unwrap();
        let poses = path.poses().unwrap();
        for (k, mode) in found.modes.iter().enumerate() {
            let wanted = &mode.shape[i];
            let turn = turns[k + 1] - turns[0];
            assert!(
                (turn - wanted.turn_rad).abs() < 2e-8,
                "{i} {k}: {turn} {wanted:?}"
            );
            let [from, to] = [&poses[0], &poses[k + 1]];
            let shift = [0, 1, 2].map(|n| to.origin_m[n] - from.origin_m[n]);
            // The axes of the hubs of this scene are those of space.
            assert!(
                (shift[0] - wanted.x_m).abs() < 2e-9,
                "{i} {k}: {shift:?} {wanted:?}"
            );
            assert!(
                (shift[1] - wanted.y_m).abs() < 2e-9,
                "{i} {k}: {shift:?} {wanted:?}"
            );
            moved[0] |= turn.abs() > 1e-6;
            moved[1] |= shift[0].abs() > 1e-8;
        }
    }
    assert_eq!(moved, [true; 2]);
}

/// Poses of shafts are where the scene has them: along the axis, at the distances of their stations.
#[test]
fn shafts_and_bearings_are_those_of_the_scene() {
    let motion = modes_of(&unbuilt(ON_SHAFTS), 0).motion.unwrap();
    assert_eq!((motion.bodies.len(), motion.paths.len()), (2, 3));
    assert_eq!(motion.plain_bodies[0].name, "motor");
    assert_eq!(motion.bearings, [1]);
    let shaft = &motion.shafts[0];
    assert_eq!(
        (&*shaft.members, &*shaft.places_m),
        (&[2, 0][..], &[0.02, 0.1][..])
    );
    let sections: Vec<_> = (shaft.sections.iter())
        .map(|s| (s.length_m, s.diameter_m))
        .collect();
    assert_eq!(sections, [(0.08, Some(0.01)), (0.02, None)]);
    let [motor, gear] = [2, 0].map(|i| motion.paths[i].poses().unwrap()[0]);
    let off = [0, 1, 2].map(|k| gear.origin_m[k] - motor.origin_m[k]);
    let along: f64 = (0..3).map(|k| off[k] * gear.axes[2][k]).sum();
    let length = off.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!(
        (along - 0.08).abs() < 1e-12 && (length - 0.08).abs() < 1e-12,
        "{off:?}"
    );
    assert!(motion.is_spatial());
}

/// Planets are on their carrier at every frame: their distance from its axis is that of the start.
#[test]
fn a_carrier_has_its_planets_at_every_frame() {
    let context = Context::default();
    let mut scene = crate::scene_file::load_unbuilt(&context, "planetary").unwrap();
    scene.models.truncate(1);
    let motion = modes_of(&scene, 0).motion.unwrap();
    let carrier = motion.bodies.len();
    assert_eq!(motion.plain_bodies[0].planets, [1, 2, 3]);
    // A carrier on pins alone has no shaft between members.
    assert!(motion.shafts.is_empty() && motion.is_spatial());
    let centre = motion.paths[carrier].poses().unwrap();
    let turned = motion.paths[carrier].turn_rad.values().unwrap();
    let mut moved = false;
    for planet in 1..4 {
        let poses = motion.paths[planet].poses().unwrap();
        let arm = |k: usize| [0, 1].map(|n| poses[k].origin_m[n] - centre[k].origin_m[n]);
        for (k, turn) in turned.iter().enumerate() {
            let ([x, y], [x0, y0]) = (arm(k), arm(0));
            let angle = (x0 * y - y0 * x).atan2(x0 * x + y0 * y);
            assert!(
                (angle - (turn - turned[0])).abs() < 5e-8,
                "{planet} {k}: {angle} {turn}"
            );
            assert!((x.hypot(y) - 0.081).abs() < 5e-9);
            moved |= angle.abs() > 5e-7;
        }
    }
    assert!(moved);
}

/// All teeth of elastic gears have displacements in modes, and none at rest.
#[test]
fn all_teeth_of_elastic_gears_move_in_modes() {
    let found = modes_of(&coarse(&[("modes", 4.0.into())]), 0);
    let motion = found.motion.unwrap();
    let all: Vec<u32> = motion.bodies.iter().map(|b| b.teeth).collect();
    for teeth in &motion.teeth {
        assert!(teeth.is_elastic);
        assert_eq!(teeth.counts[0], 0);
        assert!((teeth.counts[1..].iter()).all(|n| *n == all[teeth.body] as usize));
        let values = teeth.displacements_m.values().unwrap();
        let largest = values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!((1e-9..1e-4).contains(&largest), "{largest}");
    }
    assert!(!motion.teeth.is_empty());
}

/// A rigid motion of a tooth is found from its normal displacements, and other normal displacements are kept.
#[test]
fn tooth_motions_follow_from_normal_displacements() {
    let rows = 6;
    let flank = |side: f64| {
        move |k: usize| {
            let part = k as f64 / (rows - 1) as f64;
            [
                0.036 + 0.009 * part,
                side * (4.2e-3 - 2.4e-3 * part - 8e-4 * part * part),
            ]
        }
    };
    let places: Vec<[f64; 2]> = (0..rows)
        .map(flank(1.0))
        .chain((0..rows).map(flank(-1.0)))
        .collect();
    let moved = |[x, y]: [f64; 2]| [3e-6 - 2e-5 * y, -1e-6 + 2e-5 * x];
    let normal = |i: usize| {
        let (flank, row) = (i / rows * rows, i % rows);
        let [a, b] = [row.saturating_sub(1), (row + 1).min(rows - 1)].map(|r| places[flank + r]);
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        [(b[1] - a[1]) / length, (a[0] - b[0]) / length]
    };
    let mut section: Vec<f64> = (0..2 * rows)
        .flat_map(|i| {
            let (n, d) = (normal(i), moved(places[i]));
            n.map(|x| x * (n[0] * d[0] + n[1] * d[1]))
        })
        .collect();
    add_tooth_motion(&mut section, &places);
    for (i, place) in places.iter().enumerate() {
        let wanted = moved(*place);
        for k in 0..2 {
            assert!((section[2 * i + k] - wanted[k]).abs() < 1e-14, "{i} {k}");
        }
    }
    // A single node that is pressed in keeps its normal displacement.
    let mut dent = vec![0.0; 4 * rows];
    let n = normal(2);
    dent[4..6].copy_from_slice(&n.map(|x| 1e-6 * x));
    let before = dent.clone();
    add_tooth_motion(&mut dent, &places);
    for i in 0..2 * rows {
        let n = normal(i);
        let out = |d: &[f64]| d[2 * i] * n[0] + d[2 * i + 1] * n[1];
        assert!((out(&dent) - out(&before)).abs() < 1e-18, "{i}");
    }
}
