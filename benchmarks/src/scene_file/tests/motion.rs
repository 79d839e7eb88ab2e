//! Warnings on initial speeds and loads that do not suit the gear train, and scenes without warnings.

use super::render;
use crate::context::Context;
use crate::scene_file::{Origin, SceneFile};
use gearbench_models::spec::Train;

/// Reads a scene without its models, which are not tested here.
fn read(text: &str) -> SceneFile {
    let scene = SceneFile::unbuilt(
        &Context::default(),
        "test.toml",
        text,
        Origin::Shipped,
        false,
    );
    scene.unwrap_or_else(|e| panic!("{}", render(&e)))
}

fn warnings(text: &str) -> Vec<String> {
    let scene = read(text);
    scene.odd.iter().map(|odd| odd.to_text()).collect()
}

/// Checks that there is exactly one warning, with all these words.
fn one(text: &str, words: &[&str]) {
    let found = warnings(text);
    assert_eq!(found.len(), 1, "{found:#?}\n{text}");
    for word in words {
        assert!(
            found[0].contains(word),
            "`{word}` is missing in {}",
            found[0]
        );
    }
}

const TAIL: &str = "\n[[models]]\nmodel = \"rigid\"\ncontact = { stiffness = \"iso6336\" }\n";

/// Two gears with 20 and 40 teeth, with additional keys of pinion, wheel and start.
fn pair(pinion: &str, wheel: &str, start: &str) -> String {
    format!(
        "schema = 1\nname = \"t\"\nduration_s = 1e-3\n\
         gears.pinion = {{ teeth = 20, module_m = 2e-3, face_width_m = 0.02, {pinion} }}\n\
         gears.wheel = {{ teeth = 40, module_m = 2e-3, face_width_m = 0.02, {wheel} }}\n\
         meshes = [{{ gears = [\"pinion\", \"wheel\"], backlash_m = 80e-6, start = {{ {start} }} }}]\n{TAIL}"
    )
}

#[test]
fn a_pair_in_step_under_loads_in_balance_has_no_warning() {
    let [pinion, wheel] = [
        "speed_rad_s = 100.0, loads = [{ torque_nm = 20.0 }]",
        "speed_rad_s = -50.0, loads = [{ torque_nm = 40.0 }]",
    ];
    assert_eq!(
        warnings(&pair(pinion, wheel, "flank = \"left\"")),
        Vec::<String>::new()
    );
    let driven = "mount = { driven = { speed_rad_s = 100.0 } }";
    assert_eq!(
        warnings(&pair(driven, wheel, "flank = \"left\"")),
        Vec::<String>::new()
    );
    // Rounded to three digits, and at rest.
    let rounded = wheel.replace("-50.0", "-49.99");
    assert_eq!(
        warnings(&pair(pinion, &rounded, "flank = \"left\"")),
        Vec::<String>::new()
    );
    let [pinion, wheel] =
        [pinion, wheel].map(|g| g.replace("100.0", "0.0").replace("-50.0", "0.0"));
    assert_eq!(
        warnings(&pair(&pinion, &wheel, "flank = \"left\"")),
        Vec::<String>::new()
    );
}

#[test]
fn gears_out_of_step_are_named_with_their_speed() {
    let pinion = "speed_rad_s = 100.0, loads = [{ torque_nm = 20.0 }]";
    let torque = "loads = [{ torque_nm = 40.0 }]";
    // The base radius of the pinion is 18.79 mm.
    one(
        &pair(
            pinion,
            &format!("speed_rad_s = 50.0, {torque}"),
            "flank = \"left\"",
        ),
        &[
            "test.toml:5:",
            "`wheel` starts at 50.0 rad/s",
            "close at 3.76 m/s",
            "speed_rad_s = -50",
        ],
    );
    one(
        &pair(pinion, torque, "flank = \"left\""),
        &[
            "test.toml:5:",
            "`wheel` is at rest",
            "close at 1.88 m/s",
            "speed_rad_s = -50",
        ],
    );
    one(
        &pair(
            pinion,
            &format!("speed_rad_s = -60.0, {torque}"),
            "flank = \"left\"",
        ),
        &["separate at 0.376 m/s", "speed_rad_s = -50"],
    );
    one(
        &pair(
            "mount = { driven = { speed_rad_s = 100.0 } }",
            "bore_radius_m = 0.01",
            "flank = \"left\"",
        ),
        &["`wheel` is at rest", "speed_rad_s = -50"],
    );
    // Whichever gear moves first in the file is the measure of the other.
    one(
        &pair(torque, "speed_rad_s = -50.0", "flank = \"left\""),
        &["test.toml:4:", "`pinion` is at rest", "speed_rad_s = 100"],
    );
}

/// There is no warning on an intended impact: without loads and drives only an impact can happen, and a held wheel
/// allows no other motion.
#[test]
fn impacts_have_no_warning() {
    for (pinion, wheel) in [
        ("speed_rad_s = 20.0", "bore_radius_m = 0.01"),
        ("speed_rad_s = 20.0", "speed_rad_s = -8.0"),
        ("speed_rad_s = 20.0", "mount = \"fixed\""),
        (
            "mount = { driven = { speed_rad_s = 0.2 } }",
            "mount = \"fixed\"",
        ),
        (
            "speed_rad_s = 20.0, loads = [{ torque_nm = 5.0 }]",
            "mount = \"fixed\"",
        ),
    ] {
        let found = warnings(&pair(pinion, wheel, "flank = \"left\", gap_m = 1e-6"));
        assert!(found.is_empty(), "{pinion}; {wheel}: {found:#?}");
    }
    // Lost motion: a start in the middle of the backlash.
    let driven = "mount = { driven = { speed_rad_s = 10.0 } }";
    let found = warnings(&pair(
        driven,
        "bore_radius_m = 0.01",
        "flank = \"left\", gap_m = 40e-6",
    ));
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn loads_of_the_wrong_sign_are_named() {
    let wheel =
        |torque: f64| format!("speed_rad_s = -50.0, loads = [{{ torque_nm = {torque:?} }}]");
    let driven = "mount = { driven = { speed_rad_s = 100.0 } }";
    one(
        &pair(driven, &wheel(-40.0), "flank = \"left\""),
        &[
            "test.toml:6:",
            "act on the right flanks of `pinion` and `wheel`",
            "start = { flank = \"right\" }",
        ],
    );
    assert!(warnings(&pair(driven, &wheel(-40.0), "flank = \"right\"")).is_empty());
    // Free gears: both torques with the motion.
    one(
        &pair(
            "speed_rad_s = 100.0, loads = [{ torque_nm = 20.0 }]",
            &wheel(-40.0),
            "flank = \"left\"",
        ),
        &[
            "test.toml:5:",
            "act in the direction of motion",
            "opposite sign",
        ],
    );
    one(
        &pair(
            "speed_rad_s = 100.0, loads = [{ torque_nm = -20.0 }]",
            &wheel(40.0),
            "flank = \"left\"",
        ),
        &["act on the right flanks"],
    );
    // Both gears accelerate alike: T_a R_a / I_a + T_b R_b / I_b = 0 of inertias 1 and 4.
    one(
        &pair(
            "inertia_kgm2 = 1e-3, loads = [{ torque_nm = 20.0 }]",
            "inertia_kgm2 = 4e-3, loads = [{ torque_nm = -40.0 }]",
            "flank = \"left\"",
        ),
        &["act on no flank"],
    );
    // A load that changes its sign is not judged.
    let swinging =
        "speed_rad_s = -50.0, loads = [{ harmonic = { amplitude_nm = 5.0, frequency_hz = 50.0 } }]";
    assert!(warnings(&pair(driven, swinging, "flank = \"left\"")).is_empty());
}

#[test]
fn a_load_on_a_driven_gear_has_no_effect() {
    one(
        &pair(
            "mount = { driven = { speed_rad_s = 100.0 } }, loads = [{ torque_nm = 20.0 }]",
            "speed_rad_s = -50.0, loads = [{ torque_nm = 40.0 }]",
            "flank = \"left\"",
        ),
        &[
            "test.toml:4:",
            "the loads on `pinion` have no effect",
            "driven",
        ],
    );
}

/// A two-stage gearbox on elastic shafts; the second pinion turns clockwise.
const GEARBOX: &str = r#"schema = 1
name = "two_stage"
duration_s = 0.02
gears.p1 = { teeth = 19, module_m = 2e-3, face_width_m = 0.02, bore_radius_m = 0.006 }
gears.w1 = { teeth = 53, module_m = 2e-3, face_width_m = 0.02, bore_radius_m = 0.015 }
gears.p2 = { teeth = 17, module_m = 3e-3, face_width_m = 0.03, bore_radius_m = 0.008, profile_shift = 0.2 }
gears.w2 = { teeth = 61, module_m = 3e-3, face_width_m = 0.03, bore_radius_m = 0.03 }
shafts = [
  { name = "input", carries = [{ body = "motor", at_m = 0.0, inertia_kgm2 = 1e-3, loads = [{ torque_nm = 12.0 }] }, { gear = "p1", at_m = 0.12 }], sections = [{ length_m = 0.12, diameter_m = 0.015 }], damping_ratio = 0.02, speed_rad_s = 150.0 },
  { name = "mid", carries = [{ gear = "w1", at_m = 0.0 }, { gear = "p2", at_m = 0.06 }], sections = [{ length_m = 0.06, diameter_m = 0.025 }], speed_rad_s = -53.774 },
  { name = "output", carries = [{ gear = "w2", at_m = 0.0 }, { body = "machine", at_m = 0.2, inertia_kgm2 = 0.05, loads = [{ viscous_nms_per_rad = 8.0 }] }], sections = [{ length_m = 0.2, diameter_m = 0.03 }], damping_ratio = 0.02, speed_rad_s = 14.986 },
]
meshes = [{ gears = ["p1", "w1"], backlash_m = 60e-6 }, { gears = ["p2", "w2"], backlash_m = 60e-6, direction_deg = 90, start = { flank = "right" } }]
"#;

#[test]
fn speeds_are_those_of_the_whole_train() {
    let whole = format!("{GEARBOX}{TAIL}");
    assert_eq!(warnings(&whole), Vec::<String>::new());
    // The second pinion presses its right flanks, whatever the first one does.
    one(
        &whole.replace(", start = { flank = \"right\" }", ""),
        &["act on the right flanks of `p2` and `w2`"],
    );
    one(
        &whole.replace("speed_rad_s = 14.986", "speed_rad_s = -14.986"),
        &[
            ":11:",
            "`w2` starts at -14.986 rad/s",
            "speed_rad_s = 14.98608",
        ],
    );
    let found = warnings(&whole.replace("speed_rad_s = -53.774", "speed_rad_s = 53.774"));
    assert!(
        found[0].contains("`w1` starts at 53.774") && found[0].contains("-53.77358"),
        "{found:#?}"
    );
    assert!(found.iter().all(|w| w.contains(":10:")), "{found:#?}");
}

const RACK: &str = r#"schema = 1
name = "my_rack"
duration_s = 0.01
gears.pinion = { teeth = 18, module_m = 3e-3, face_width_m = 0.02, bore_radius_m = 0.008, speed_rad_s = 20.0, loads = [{ torque_nm = 5.0 }] }
gears.rack = { kind = "rack", teeth = 25, module_m = 3e-3, face_width_m = 0.02, mass_kg = 12.0, loads = [{ force_n = -185.0 }], speed_m_s = 0.54 }
meshes = [{ gears = ["pinion", "rack"], backlash_m = 50e-6 }]
"#;

#[test]
fn racks_have_a_speed_in_metres_per_second() {
    let whole = format!("{RACK}{TAIL}");
    assert_eq!(warnings(&whole), Vec::<String>::new());
    let reversed = whole.replace("speed_m_s = 0.54", "speed_m_s = -0.54");
    one(
        &reversed,
        &["`rack` starts at -0.54 m/s", "speed_m_s = 0.54"],
    );
    one(
        &whole.replace("force_n = -185.0", "force_n = 185.0"),
        &["act in the direction of motion"],
    );
}

const PLANETS: &str = r#"schema = 1
name = "my_planets"
duration_s = 5e-3
gears.sun = { teeth = 20, module_m = 2e-3, face_width_m = 0.02, bore_radius_m = 0.008, thinning_m = 30e-6, position_m = [0.0, 0.0], speed_rad_s = 100.0, loads = [{ torque_nm = 30.0 }] }
gears.p1 = { teeth = 28, module_m = 2e-3, face_width_m = 0.02, bore_radius_m = 0.01, thinning_m = 30e-6 }
gears.p2 = { teeth = 28, module_m = 2e-3, face_width_m = 0.02, bore_radius_m = 0.01, thinning_m = 30e-6 }
gears.p3 = { teeth = 28, module_m = 2e-3, face_width_m = 0.02, bore_radius_m = 0.01, thinning_m = 30e-6 }
gears.ring = { teeth = 76, module_m = 2e-3, face_width_m = 0.02, internal = true, addendum_factor = 0.85, position_m = [0.0, 0.0], mount = "fixed" }
shafts = [{ name = "arm", carries = [{ body = "carrier", at_m = 0.0, inertia_kgm2 = 2e-3, planets = ["p1", "p2", "p3"], speed_rad_s = 20.833333333333332, loads = [{ torque_nm = -144.0 }] }] }]
meshes = [
  { gears = ["sun", "p1"], centre_distance_m = 0.048, direction_deg = 0 }, { gears = ["sun", "p2"], centre_distance_m = 0.048, direction_deg = 120 },
  { gears = ["sun", "p3"], centre_distance_m = 0.048, direction_deg = 240 }, { gears = ["p1", "ring"], start = { flank = "right" } }, { gears = ["p2", "ring"] }, { gears = ["p3", "ring"] },
]
"#;

#[test]
fn planetary_sets_run_at_the_speed_of_their_carrier() {
    let whole = format!("{PLANETS}{TAIL}");
    assert_eq!(warnings(&whole), Vec::<String>::new());
    // Willis: W = w_sun z_sun / (z_sun + z_ring) = 100 * 20 / 96.
    for wrong in ["-20.833333333333332", "25.0", "0.0"] {
        let text = whole.replace("20.833333333333332", wrong);
        let found = warnings(&text);
        assert_eq!(found.len(), 1, "{found:#?}");
        assert!(found[0].contains(":9:"), "{found:#?}");
        assert!(found[0].contains("speed_rad_s = 20.83333"), "{found:#?}");
    }
    // A free ring has a speed of its own.
    let text = whole.replace(", mount = \"fixed\"", ", speed_rad_s = 5.0");
    let found = warnings(&text);
    assert!(
        found
            .iter()
            .all(|w| !w.contains("does not match the train")),
        "{found:#?}"
    );
    let scene = read(&whole);
    let train = Train::new(&scene.spec);
    let speeds = train.in_step(&[0]);
    // A planet against the carrier: -(100 - 20.8333) * 20 / 28.
    assert!((speeds[1] - (20.833333333333332 - 79.16666666666667 * 20.0 / 28.0)).abs() < 1e-9);
    // Every sun mesh carries a third of the torque on left flanks, every ring mesh as much on right ones.
    let mut loads = vec![0.0; train.members()];
    (loads[0], loads[5]) = (30.0, -144.0);
    let forces = train.forces(&loads);
    let expected = 30.0 / 3.0 / (0.02 * 20f64.to_radians().cos());
    for (i, force) in forces.iter().enumerate() {
        let sign = if i < 3 { 1.0 } else { -1.0 };
        assert!(
            (force - sign * expected).abs() < 1e-6 * expected,
            "{forces:?}"
        );
    }
}

/// A refusal of a pair names the gear, the key and a value that is accepted.
#[test]
fn a_tip_that_interferes_has_a_shorter_addendum() {
    let whole = format!("{PLANETS}{TAIL}");
    let text = whole.replace(", addendum_factor = 0.85", "");
    let e = SceneFile::unbuilt(
        &Context::default(),
        "test.toml",
        &text,
        Origin::Shipped,
        false,
    )
    .unwrap_err();
    let help = e.help_text().unwrap();
    assert!(help.contains("give `ring` addendum_factor = 0."), "{help}");
    assert!(e.message().contains("the tip of `ring`"), "{}", e.message());
    let value = help.split("addendum_factor = ").nth(1).unwrap();
    let value = value.split(',').next().unwrap();
    read(&whole.replace(
        "addendum_factor = 0.85",
        &format!("addendum_factor = {value}"),
    ));
}

#[test]
fn a_ring_without_a_place_is_put_on_the_axis() {
    let whole = format!("{PLANETS}{TAIL}");
    let text = whole.replace(
        "addendum_factor = 0.85, position_m = [0.0, 0.0]",
        "addendum_factor = 0.85",
    );
    let e = SceneFile::unbuilt(
        &Context::default(),
        "test.toml",
        &text,
        Origin::Shipped,
        false,
    )
    .unwrap_err();
    let help = e.help_text().unwrap();
    assert!(
        help.contains("`position_m = [0.0, 0.0]` to `ring`"),
        "{help}"
    );
}

/// An internal gear turns with its pinion.
#[test]
fn internal_pairs_turn_alike() {
    let text = include_str!("../../../scenes/ring_pair.toml");
    assert_eq!(warnings(text), Vec::<String>::new());
    let reversed = text.replace(
        "speed_rad_s = 72.1311475409836",
        "speed_rad_s = -72.1311475409836",
    );
    one(
        &reversed,
        &["`ring` starts at -72.131 rad/s", "speed_rad_s = 72.13115"],
    );
}
