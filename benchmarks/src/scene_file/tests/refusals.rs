//! Refusals of the file as such, of gears and of meshes: line, cause, what was expected, way out.

use super::{refused, render};
use crate::scene_file::{Selection, load, load_uncalibrated};

#[test]
fn unknown_keys_and_wrong_units() {
    refused(
        "module_m = 0.004",
        "module_mm = 4",
        10,
        &[
            "unknown key `module_mm` in [gears.pinion]",
            "SI units",
            "`module_m = 0.004`",
            "metres",
        ],
    );
    refused(
        "module_m = 0.004",
        "module = 0.004",
        10,
        &["keys carry their unit", "`module_m`"],
    );
    refused(
        "speed_rad_s = 20.0",
        "speed_rpm = 300",
        12,
        &["`speed_rad_s = 31.4159265359`"],
    );
    refused("teeth = 20", "tetth = 20", 9, &["did you mean `teeth`"]);
    refused(
        "teeth = 20",
        "teeth = 20\npressure_angle_rad = 0.35",
        10,
        &["`pressure_angle_deg = 20.05"],
    );
    refused(
        "title = ",
        "colour = ",
        3,
        &["unknown key `colour`", "known are schema, name, title"],
    );
    refused(
        "torque_nm = 10.0",
        "torque_nmm = 10000",
        13,
        &["`torque_nm = 10`"],
    );
    refused("gap_m = 1e-6", "gap_um = 1", 24, &["`gap_m = 0.000001`"]);
    refused(
        "stiffness_n_per_m2 = 1.4e10",
        "stiffness_n_per_mm_um = 14",
        28,
        &["`stiffness_n_per_m2 = 14000000000`"],
    );
    refused(
        "tooth_mass_kg = 4.8e-3",
        "tooth_mass_g = 4.8",
        33,
        &[
            "has no parameter `tooth_mass_g`",
            "`tooth_mass_kg = 0.0048`",
        ],
    );
    refused("rtol = 1e-6", "tol = 1e-6", 36, &["did you mean `rtol`"]);
    refused("[study]", "[studdy]", 35, &["did you mean `study`"]);
    // A key of a rack on a gear.
    refused(
        "teeth = 20",
        "teeth = 20\nbody_height_m = 1",
        10,
        &["unknown key `body_height_m`"],
    );
}

#[test]
fn wrong_types_and_numbers() {
    refused(
        "module_m = 0.004",
        "module_m = \"4 mm\"",
        10,
        &[
            "`module_m` is the text \"4 mm\", expected a number",
            "normal module in metres",
        ],
    );
    refused(
        "teeth = 20",
        "teeth = 20.5",
        9,
        &["`teeth` is the number 20.5, expected a whole number"],
    );
    refused(
        "teeth = 20",
        "teeth = -20",
        9,
        &["expected a whole number, zero or more"],
    );
    refused(
        "module_m = 0.004",
        "module_m = nan",
        10,
        &["expected a finite number"],
    );
    refused(
        "module_m = 0.004",
        "module_m = inf",
        10,
        &["expected a finite number"],
    );
    refused(
        "speed_rad_s = 20.0",
        "speed_rad_s = -1e999",
        12,
        &["expected a finite number"],
    );
    refused(
        "loads = [{ torque_nm = 10.0 }]",
        "loads = 10.0",
        13,
        &["expected a list"],
    );
    refused(
        "[{ torque_nm = 10.0 }]",
        "[10.0]",
        13,
        &["expected a table"],
    );
    refused(
        "[{ torque_nm = 10.0 }]",
        "[]",
        13,
        &["`loads` is empty", "at least one"],
    );
    refused(
        "name = \"test\"",
        "name = 3",
        2,
        &["expected a text in quotes"],
    );
    refused("name = \"test\"", "name = \"A test\"", 2, &["lower-case"]);
    refused(
        "gears = [\"pinion\", \"wheel\"]",
        "gears = [\"pinion\"]",
        22,
        &["a mesh joins two gears, not 1"],
    );
    refused(
        "teeth = 20",
        "teeth = 20\nposition_m = [1.0]",
        10,
        &["has 1 numbers, expected 2"],
    );
}

#[test]
fn missing_keys() {
    refused(
        "teeth = 20\n",
        "",
        8,
        &["`teeth` is missing in [gears.pinion]", "number of teeth"],
    );
    refused(
        "duration_s = 1e-4\n",
        "",
        1,
        &["`duration_s` is missing", "simulated time in seconds"],
    );
    refused("schema = 1\n", "", 1, &["`schema` is missing"]);
    refused(
        "centre_distance_m = 0.1001\n",
        "",
        21,
        &[
            "where `wheel` stands",
            "`centre_distance_m` or `backlash_m`",
        ],
    );
    refused("model = \"rigid\"\n", "", 26, &["`model` is missing"]);
    refused(
        "stiffness = \"iso6336\"",
        "exponent = 1.0",
        32,
        &["`stiffness` is missing"],
    );
    refused(
        "law = \"flores\", ",
        "",
        28,
        &["`law` is missing in `damping`", "flores"],
    );
    refused(", step_s = 1e-6", "", 36, &["`step_s` is missing"]);
    refused(
        "{ method = \"dopri5\", rtol = 1e-6 }",
        "{ rtol = 1e-6 }",
        36,
        &["`method` is missing"],
    );
    refused(
        ", tooth_mass_kg = 4.8e-3",
        "",
        33,
        &["`tooth_mass_kg`", "is missing", "gearbench identify"],
    );
}

#[test]
fn not_toml() {
    refused("teeth = 20", "teeth = ", 9, &["not TOML"]);
    refused(
        "[gears.wheel]",
        "[gears.pinion]",
        15,
        &["duplicate", "stands once"],
    );
    refused("teeth = 20", "teeth = 20\nteeth = 21", 10, &["duplicate"]);
    refused("title = \"A test\"", "title = \"A test", 3, &["not TOML"]);
}

#[test]
fn scenes_that_are_not_there() {
    let shown = render(&load("spur_inpact").unwrap_err());
    assert!(
        shown.contains("no scene `spur_inpact`") && shown.contains("did you mean `spur_impact`"),
        "{shown}"
    );
    let shown = render(&load_uncalibrated("nowhere/x.toml", Selection::All).unwrap_err());
    assert!(
        shown.contains("nowhere/x.toml") && shown.contains("expected a readable TOML file"),
        "{shown}"
    );
}
