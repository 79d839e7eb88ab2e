//! Reports of natural frequencies.

use crate::{finding, has_only_numbers, holds, made_up, written};
use gearbench_reports::modes::{
    LinearisedState, MemberPlace, MemberShape, MeshState, ModeRecord, ModelModes, ModesRecord,
};
use gearbench_reports::record::{
    FrameContacts, GearMotion, MeshMode, PlainBody, Quantised, ShaftShape,
};
use gearbench_reports::{Part, Results};

fn member(name: &str, x_m: f64) -> MemberPlace {
    MemberPlace {
        name: name.into(),
        x_m,
        radius_m: 0.04,
        toothed: true,
        in_plane: true,
        ..MemberPlace::default()
    }
}

fn mode(frequency_hz: f64, name: &str, strain: Vec<f64>, turns: [f64; 2]) -> ModeRecord {
    let shape = turns.map(|turn_rad| MemberShape {
        turn_rad,
        x_m: 0.1 * turn_rad * 0.04,
        ..MemberShape::default()
    });
    ModeRecord {
        frequency_hz,
        multiplicity: 1,
        damping_ratio: (frequency_hz > 0.0).then_some(0.021),
        damped_frequency_hz: None,
        name: name.into(),
        kinetic: vec![0.25, 0.75],
        strain,
        shape: shape.to_vec(),
    }
}

pub fn of_models() -> Results {
    let pair = ModelModes {
        label: "rigid".into(),
        about: LinearisedState::Loaded,
        coordinates: 2,
        steps: 7,
        residual_rel: 1e-16,
        frequencies: 3,
        highest_hz: 4321.5,
        meshes: vec![MeshState {
            name: "pinion - wheel".into(),
            force_n: 1520.0,
        }],
        members: vec![member("pinion", 0.0), member("wheel", 0.1)],
        springs: vec!["mesh pinion - wheel".into(), "torsion of <output>".into()],
        modes: vec![
            mode(0.0, "rigid motion", vec![], [2.5e-5, -1.6e-5]),
            mode(
                177.3,
                "torsion of <output>",
                vec![0.02, 0.98],
                [2.5e-5, -1.2e-5],
            ),
            mode(
                4321.5,
                "mesh pinion - wheel",
                vec![0.99, 0.01],
                [2.5e-5, 1.6e-5],
            ),
        ],
        ..ModelModes::default()
    };
    let lost = ModelModes {
        label: "elastic".into(),
        about: LinearisedState::NotFound,
        message: "no equilibrium under its loads was found".into(),
        ..ModelModes::default()
    };
    Results {
        part: Part::Modes(ModesRecord {
            vibrations: vec![pair, lost],
        }),
        ..Results::default()
    }
}

#[test]
fn natural_frequencies_are_told_with_where_their_energy_lies() {
    let files = written(&of_models());
    holds(
        &files,
        &[
            "modes.csv",
            "modes_energy.csv",
            "modes_shapes.csv",
            "modes_energy_rigid.svg",
            "modes_shapes_rigid.svg",
        ],
    );
    has_only_numbers(&files);
    let page = &files["index.html"];
    let found = finding(page);
    for words in ["177.30", "torsion of &lt;output&gt;", "no equilibrium"] {
        assert!(found.contains(words), "{words} in {found}");
    }
    assert!(
        page.contains("mesh pinion - wheel 99") && page.contains("2.10"),
        "shares and damping"
    );
    assert_eq!(files["modes_shapes.csv"].lines().count(), 1 + 3 * 2);
    assert_eq!(files["modes_energy.csv"].lines().count(), 1 + 3 * 2 + 2 * 2);
}

/// The motion of the pair of `of_models`: at rest, and two modes.
fn moving() -> Results {
    let mut results = of_models();
    let Part::Modes(part) = &mut results.part else {
        unreachable!("modes")
    };
    let none = || Quantised::of(&[], 0.0);
    part.vibrations[0].motion = Some(GearMotion {
        time_s: Vec::new(),
        contacts: FrameContacts {
            counts: vec![0; 3],
            points_m: none(),
            forces_n: none(),
            widths_m: none(),
            half_widths_m: none(),
            values: none(),
            ..FrameContacts::default()
        },
        ..made_up::motion(0.0)
    });
    results
}

/// Modes with a motion are in the viewer, with their names and largest displacements; a third one without a frame is not.
#[test]
fn modes_with_a_motion_move() {
    let files = written(&moving());
    let page = &files["index.html"];
    let data = page
        .split_once("<script type=\"application/json\">")
        .unwrap()
        .1;
    let data = data.split_once("</script>").unwrap().0;
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    let modes = data["models"][0]["modes"].as_array().unwrap();
    let names: Vec<&str> = modes.iter().map(|m| m["name"].as_str().unwrap()).collect();
    assert_eq!(
        names,
        ["1: rigid motion", "2: 177.3\u{a0}Hz, torsion of <output>"]
    );
    assert_eq!(
        [&modes[0]["is_rigid"], &modes[1]["is_rigid"]],
        [true, false]
    );
    // The second gear, with a reach of 64 mm, turns by 1.2 mrad; the first, of 44 mm, by 2 mrad.
    let largest = modes[1]["largest_m"].as_f64().unwrap();
    assert!((largest - 0.044 * 2e-3).abs() < 1e-9, "{largest}");
    assert_eq!(data["start_s"], 0.25);
    assert!(page.contains("Of rigid the first 2 modes move."), "caption");
    assert!(files["modes_moving.svg"].matches("<polygon").count() > 100);
    let still = written(&of_models());
    assert!(
        !still.contains_key("modes_moving.svg") && !still["index.html"].contains("class=\"gears\"")
    );
}

/// The mesh mode of any study moves on its page.
#[test]
fn mesh_modes_with_a_motion_move() {
    let Part::Modes(part) = moving().part else {
        unreachable!("modes")
    };
    let mut motion = part.vibrations[0].motion.clone().unwrap();
    motion.contacts.counts.truncate(2);
    for path in &mut motion.paths {
        path.turn_rad = Quantised::of(&[0.0, 1e-3], 1e-9);
    }
    motion.teeth.clear();
    let results = Results {
        mesh_modes: vec![MeshMode {
            label: "rigid".into(),
            frequency_hz: Some(4321.5),
            motion: Some(motion),
            ..MeshMode::default()
        }],
        ..of_models()
    };
    let page = &written(&results)["index.html"];
    assert!(page.contains("mesh mode, 4.322\u{a0}kHz"));
}

#[test]
fn motions_of_modes_that_break_their_rules_are_refused() {
    let broken = |change: fn(&mut GearMotion)| {
        let mut results = moving();
        let Part::Modes(part) = &mut results.part else {
            unreachable!("modes")
        };
        part.vibrations[0].motion.as_mut().map(change);
        results.validate().unwrap_err()
    };
    for (error, expected) in [
        (
            broken(|m| m.time_s = vec![0.0, 1.0, 2.0]),
            "3 times and 3 frames",
        ),
        (broken(|m| m.contacts.counts.push(0)), "numbers, expected 4"),
        (broken(|m| m.bearings = vec![2]), "bearings has a member"),
        (
            broken(|m| m.plain_bodies = vec![PlainBody::default()]),
            "paths has 2 entries, expected 3",
        ),
        (
            broken(|m| {
                m.shafts = vec![ShaftShape {
                    members: vec![0, 5],
                    places_m: vec![0.0, 0.1],
                    ..ShaftShape::default()
                }];
            }),
            "shafts[0].has a member without a path",
        ),
    ] {
        assert!(
            error.contains("motion.") || error.contains("motion has"),
            "{error}"
        );
        assert!(error.contains(expected), "{error}");
    }
}
