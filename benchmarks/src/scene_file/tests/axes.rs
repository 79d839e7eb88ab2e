//! Axes of cylindrical gears: parallel but for small misalignments, through whatever key they are tilted.

use super::{BASE, SHIPPED_BEVELOID, parse, render};
use crate::context::Context;

const WHEEL: &str = "mount = \"revolute\"\n";
const PINION: &str = "speed_rad_s = 20.0\n";

/// The base scene with additional keys for pinion and wheel, without keys that tilted axes exclude.
fn with(pinion: &str, wheel: &str) -> String {
    BASE.replace("reference = \"calculix/case-a-fine\"\n", "")
        .replace("tolerance = 0.05\n", "")
        .replacen(PINION, &format!("{PINION}{pinion}\n"), 1)
        .replacen(WHEEL, &format!("{WHEEL}{wheel}\n"), 1)
}

/// Direction of an axis rotated by an angle in degrees about x or y.
fn axis(degrees: f64, about_x: bool) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    match about_x {
        true => format!("axis = [0.0, {sin}, {cos}]"),
        false => format!("axis = [{sin}, 0.0, {cos}]"),
    }
}

/// Checks that a scene is read, or refused at a key for crossed axes.
fn check(text: &str, refused_at: Option<&str>) {
    let found = parse(text);
    match (found, refused_at) {
        (Ok(_), None) => {}
        (Ok(_), Some(key)) => panic!("not refused at {key}:\n{text}"),
        (Err(e), None) => panic!("{}", render(&e)),
        (Err(e), Some(key)) => {
            let said = render(&e);
            let words = ["crossed gears are not modelled", "conical", "degrees"];
            for word in words.into_iter().chain([key]) {
                assert!(said.contains(word), "`{word}` is missing in\n{said}");
            }
            // The line of the key, and its file.
            assert!(said.contains("test.toml:"), "{said}");
        }
    }
}

#[test]
fn crossed_cylindrical_gears_are_refused_at_the_key_that_turns_an_axis() {
    let upright = "axis = [0.0, 0.0, 1.0]";
    for (degrees, sound) in [
        (0.0, true),
        (1.9, true),
        (2.1, false),
        (10.0, false),
        (60.0, false),
        (90.0, false),
        (180.0, false),
    ] {
        for about_x in [true, false] {
            let refused = (!sound).then_some("axis");
            check(&with(upright, &axis(degrees, about_x)), refused);
            check(&with(&axis(degrees, about_x), upright), refused);
        }
        // Both gears turned by half of it, against each other.
        let [one, two] = [0.5, -0.5].map(|part| axis(part * degrees, true));
        check(&with(&one, &two), (!sound).then_some("axis"));
        // Turned together they stay parallel.
        let both = axis(degrees, true);
        if degrees < 90.0 {
            check(&with(&both, &both), None);
        }
    }
}

#[test]
fn misalignments_of_both_gears_add_up() {
    for within in [
        "plane_of_action = X",
        "across = X",
        "about = [1.0, 0.0, 0.0], angle = X",
    ] {
        let keys = |x: &str| format!("misalignment_deg = {{ {} }}", within.replace('X', x));
        check(&with("", &keys("1.9")), None);
        // In the plane of action angles are counted towards the mate, so that equal ones add up.
        let against = if within.starts_with("about") {
            "-1.1"
        } else {
            "1.1"
        };
        check(
            &with(&keys("1.1"), &keys(against)),
            Some("misalignment_deg"),
        );
        let same = if within.starts_with("about") {
            "1.1"
        } else {
            "-1.1"
        };
        check(&with(&keys("1.1"), &keys(same)), None);
    }
    // On an axis that is turned already.
    let more = "misalignment_deg = { about = [1.0, 0.0, 0.0], angle = -1.0 }";
    let wheel = format!("{}\n{more}", axis(1.5, true));
    check(
        &with("axis = [0.0, 0.0, 1.0]", &wheel),
        Some("misalignment_deg"),
    );
}

#[test]
fn prescribed_tilts_count_over_the_whole_simulation() {
    // 1e-4 s at 1000 rad/s are 5.7 degrees.
    let driven = |direction: &str, speed: f64| {
        format!(
            "directions = {{ x = \"held\", y = \"held\", z = \"held\", {direction} = {{ driven = {{ speed_rad_s = {speed} }} }} }}"
        )
    };
    for direction in ["tilt_x", "tilt_y"] {
        check(&with("", &driven(direction, 300.0)), None);
        check(&with("", &driven(direction, 1000.0)), Some("directions"));
        check(&with(&driven(direction, 1000.0), ""), Some("directions"));
    }
}

#[test]
fn racks_and_gears_of_any_helix_are_refused_alike_and_conical_gears_are_not() {
    // Crossed helical gears: equal hands on axes at the sum of the helix angles.
    let helical = with("axis = [0.0, 0.0, 1.0]", &axis(30.0, true)).replace(
        "face_width_m = 0.01\n",
        "face_width_m = 0.01\nhelix_angle_deg = 15.0\n",
    );
    check(&helical, Some("axis"));
    let rack = |axis: &str| {
        with(axis, "kind = \"rack\"")
            .replace(WHEEL, "")
            .replace("centre_distance_m = 0.1001", "backlash_m = 1e-4")
    };
    check(&rack(""), None);
    check(&rack(&axis(10.0, true)), Some("axis"));
    // Their axes intersect at 10 degrees.
    let scene = super::SceneFile::unbuilt(
        &Context::default(),
        "beveloid",
        SHIPPED_BEVELOID,
        super::Origin::Shipped,
        true,
    );
    assert!(scene.is_ok());
}
