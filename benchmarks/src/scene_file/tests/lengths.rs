//! Lengths in millimetres or micrometres are recognised, in warnings and in refusals that they cause.

use super::{changed, parse, render};

/// The base scene with a change: the help if it is refused, else its warnings.
fn remarks(from: &str, to: &str) -> String {
    match parse(&changed(from, to)) {
        Ok(scene) => scene.odd.iter().map(|odd| odd.to_text() + "\n").collect(),
        Err(e) => format!(
            "{}: {}",
            e.line().unwrap_or(0),
            e.help_text().unwrap_or_default()
        ),
    }
}

#[test]
fn a_length_in_another_unit_is_recognised() {
    let wheel = "teeth = 30";
    let start = "gap_m = 1e-6";
    let cases = [
        (
            "centre_distance_m = 0.1001",
            "centre_distance_m = 100",
            "if 100 is in millimetres, write centre_distance_m = 0.1",
        ),
        (
            "centre_distance_m = 0.1001",
            "backlash_m = 0.08",
            "if 0.08 is in millimetres, write backlash_m = 8e-5",
        ),
        (
            "centre_distance_m = 0.1001",
            "backlash_m = 80",
            "if 80 is in micrometres, write backlash_m = 8e-5",
        ),
        (
            wheel,
            "teeth = 30\nbore_radius_m = 15",
            "if 15 is in millimetres, write bore_radius_m = 0.015",
        ),
        (
            wheel,
            "teeth = 30\ntip_relief = { amount_m = 12, start_radius_m = 0.062 }",
            "if 12 is in micrometres, write amount_m = 1.2e-5",
        ),
        (
            wheel,
            "teeth = 30\ntip_relief = { amount_m = 12e-6, start_radius_m = 62 }",
            "if 62 is in millimetres, write start_radius_m = 0.062",
        ),
        (
            wheel,
            "teeth = 30\nthinning_m = 50",
            "if 50 is in micrometres, write thinning_m = 5e-5",
        ),
        (
            wheel,
            "teeth = 30\nlead_crowning_m = 8",
            "if 8 is in micrometres, write lead_crowning_m = 8e-6",
        ),
        (
            wheel,
            "teeth = 30\nhelix_slope_m = { left = 8 }",
            "if 8 is in micrometres, write helix_slope_m = 8e-6",
        ),
        (
            wheel,
            "teeth = 30\nposition_m = [100.1, 0]",
            "if 100.1 is in millimetres, write position_m = 0.1001",
        ),
        (
            start,
            "gap_m = 5",
            "if 5 is in micrometres, write gap_m = 5e-6",
        ),
        (
            start,
            "gap_m = 1e-6, path_coordinate_m = 17",
            "if 17 is in millimetres, write path_coordinate_m = 0.017",
        ),
        (
            "[[models]]",
            "[[shafts]]\nname = \"s\"\ncarries = [{ gear = \"pinion\", at_m = 0.0 }, { body = \"b\", at_m = 20, inertia_kgm2 = 1e-3, speed_rad_s = 20.0 }]\nsections = [{ length_m = 20, diameter_m = 15 }]\n\n[[models]]",
            "if 15 is in millimetres, write diameter_m = 0.015",
        ),
    ];
    for (from, to, expected) in cases {
        let found = remarks(from, to);
        assert!(found.contains(expected), "{to}: {found}");
    }
}

/// A refusal of the geometry begins with the unit that is probably meant, at the line of the value.
#[test]
fn a_refusal_names_the_unit() {
    let e = parse(&changed("teeth = 30", "teeth = 30\nbore_radius_m = 15")).unwrap_err();
    assert_eq!(e.line(), Some(17), "{}", render(&e));
    assert!(
        e.help_text()
            .unwrap()
            .starts_with("if 15 is in millimetres"),
        "{}",
        render(&e)
    );
}

#[test]
fn lengths_of_usual_size_are_no_subject() {
    for (from, to) in [
        ("centre_distance_m = 0.1001", "centre_distance_m = 0.1001"),
        ("centre_distance_m = 0.1001", "backlash_m = 5e-4"),
        (
            "teeth = 30",
            "teeth = 30\nbore_radius_m = 0.03\nthinning_m = 1e-4",
        ),
        (
            "teeth = 30",
            "teeth = 30\ntip_relief = { amount_m = 40e-6, start_radius_m = 0.062 }",
        ),
    ] {
        let found = remarks(from, to);
        assert!(!found.contains("is far outside"), "{to}: {found}");
    }
}
