//! Refusals of the file as such, of gears and of meshes: line, cause, what was expected, way out.

use super::{BASE, changed, parse, refused, render};
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
fn impossible_gears() {
    refused(
        "teeth = 20",
        "teeth = 12",
        9,
        &["[gears.pinion]: undercut", "profile shift of at least"],
    );
    refused(
        "teeth = 20",
        "teeth = 2",
        9,
        &["number of teeth is 2", "from 3 to 10000"],
    );
    refused(
        "module_m = 0.004",
        "module_m = -0.004",
        10,
        &["normal module", "a length from"],
    );
    refused(
        "teeth = 20",
        "teeth = 20\npressure_angle_deg = 60",
        10,
        &["pressure angle is 60", "degrees"],
    );
    refused(
        "teeth = 20",
        "teeth = 20\nbore_radius_m = 0.05",
        10,
        &["bore too large", "smaller bore"],
    );
    refused(
        "teeth = 20",
        "teeth = 20\naddendum_factor = 3",
        10,
        &["pointed"],
    );
    refused(
        "teeth = 20",
        "teeth = 20\nthinning_m = 0.01",
        10,
        &["no tooth left"],
    );
    refused(
        "teeth = 20",
        "teeth = 20\ntip_radius_factor = 0.9",
        10,
        &["tip radius factor"],
    );
    refused(
        "teeth = 20",
        "teeth = 20\ntip_relief = { amount_m = 1e-5, start_radius_m = 0.01 }",
        10,
        &["tip relief starts"],
    );
    refused(
        "teeth = 20",
        "teeth = 20\ninertia_kgm2 = 0.0",
        10,
        &["expected more than zero"],
    );
    refused(
        "teeth = 20",
        "teeth = 20\nadded_inertia_kgm2 = -1.0",
        10,
        &["expected zero or more"],
    );
    refused(
        "teeth = 20",
        "teeth = 20\nmaterial = \"stel\"",
        10,
        &["did you mean `steel`"],
    );
    refused(
        "teeth = 20",
        "teeth = 20\nmaterial = { young_pa = 2.1e11, poisson = 0.6, density_kg_m3 = 7850 }",
        10,
        &["Poisson", "0.6"],
    );
    refused(
        "mount = \"revolute\"",
        "mount = \"revolut\"",
        19,
        &["did you mean `revolute`"],
    );
    refused(
        "mount = \"revolute\"",
        "mount = \"prismatic\"",
        19,
        &["a gear turns"],
    );
    refused(
        "mount = \"revolute\"",
        "mount = \"driven\"",
        19,
        &["speed_rad_s = 100.0"],
    );
    refused(
        "mount = \"revolute\"",
        "mount = \"fixed\"\nspeed_rad_s = 3.0",
        20,
        &["the mount is fixed"],
    );
    refused(
        "mount = \"revolute\"",
        "mount = { driven = { speed_rad_s = 1.0 } }\nspeed_rad_s = 3.0",
        20,
        &["driven mount"],
    );
}

#[test]
fn impossible_loads() {
    refused(
        "{ torque_nm = 10.0 }",
        "{ torque_nm = 10.0, viscous_nms_per_rad = 1.0 }",
        13,
        &["one key only"],
    );
    refused("{ torque_nm = 10.0 }", "{}", 13, &["is empty", "`ramp`"]);
    refused(
        "{ torque_nm = 10.0 }",
        "{ viscous_nms_per_rad = -1.0 }",
        13,
        &["may not drive"],
    );
    refused(
        "{ torque_nm = 10.0 }",
        "{ force_n = 1.0 }",
        13,
        &["unknown key `force_n`"],
    );
    refused(
        "{ torque_nm = 10.0 }",
        "{ ramp = { from_nm = 0.0, to_nm = 1.0, start_s = 2.0, end_s = 1.0 } }",
        13,
        &["has no length"],
    );
    refused(
        "{ torque_nm = 10.0 }",
        "{ ramp = { to_nm = 1.0, start_s = 2.0, end_s = 1.0 } }",
        13,
        &["`from_nm` is missing"],
    );
    refused(
        "{ torque_nm = 10.0 }",
        "{ table = { time_s = [0.0, 0.0], torque_nm = [1.0, 2.0] } }",
        13,
        &["ascend"],
    );
    refused(
        "{ torque_nm = 10.0 }",
        "{ table = { time_s = [0.0, 1.0], torque_nm = [1.0] } }",
        13,
        &["2 times but 1 values"],
    );
}

#[test]
fn impossible_meshes() {
    refused(
        "\"wheel\"]",
        "\"weel\"]",
        22,
        &["there is no gear `weel`", "did you mean `wheel`"],
    );
    refused(
        "\"wheel\"]",
        "\"pinion\"]",
        22,
        &["cannot mesh with itself"],
    );
    refused(
        "centre_distance_m = 0.1001",
        "centre_distance_m = 0.09",
        23,
        &[
            "`pinion` and `wheel`",
            "centre distance too small",
            "increase it",
        ],
    );
    refused(
        "centre_distance_m = 0.1001",
        "centre_distance_m = 0.0999",
        23,
        &["flanks overlap", "0.1000"],
    );
    refused(
        "centre_distance_m = 0.1001",
        "centre_distance_m = 0.2",
        23,
        &["no tooth engagement"],
    );
    refused(
        "centre_distance_m = 0.1001",
        "centre_distance_m = 0.1001\nbacklash_m = 1e-4",
        24,
        &["both given"],
    );
    refused(
        "centre_distance_m = 0.1001",
        "backlash_m = -1e-4",
        23,
        &["backlash"],
    );
    refused(
        "centre_distance_m = 0.1001",
        "centre_distance_mm = 100.1",
        23,
        &["`centre_distance_m = 0.1001`"],
    );
    refused(
        "gap_m = 1e-6",
        "gap_m = 1e-3",
        24,
        &["larger than the backlash", "other flanks would overlap"],
    );
    refused(
        "gap_m = 1e-6",
        "path_coordinate_m = 0.1",
        24,
        &["outside the path of contact", "expected 4.2"],
    );
    refused(
        "flank = \"left\"",
        "flank = \"top\"",
        24,
        &["`left` or `right`"],
    );
    let text = changed("mount = \"revolute\"", "position_m = [0.1001, 0.0]").replacen(
        "teeth = 20",
        "teeth = 20\nposition_m = [0.0, 0.0]",
        1,
    );
    let shown = render(&parse(&text).unwrap_err());
    assert!(
        shown.contains("`centre_distance_m` is given, but both gears have a position"),
        "{shown}"
    );
    // The wheel's module: the place of both.
    let text = BASE.replace(
        "teeth = 30\nmodule_m = 0.004",
        "teeth = 30\nmodule_m = 0.005",
    );
    let shown = render(&parse(&text).unwrap_err());
    for word in [
        "unequal modules",
        "this one",
        "differs from this one",
        "test.toml:17:",
    ] {
        assert!(shown.contains(word), "{shown}");
    }
    refused(
        "[[models]]",
        "[[meshes]]\ngears = [\"wheel\", \"pinion\"]\n\n[[models]]",
        27,
        &["mesh twice", "first here"],
    );
    refused(
        "[gears.wheel]",
        "[gears.third]\nteeth = 30\nmodule_m = 0.004\nface_width_m = 0.01\n\n[gears.wheel]",
        15,
        &["gear `third` takes part in no mesh"],
    );
}

#[test]
fn racks_come_second() {
    let text = BASE.replace(
        "[gears.wheel]\nteeth = 30",
        "[gears.wheel]\nkind = \"rack\"\nteeth = 30",
    );
    let text = text.replace("mount = \"revolute\"", "mount = \"prismatic\"");
    let error =
        parse(&text.replace("[\"pinion\", \"wheel\"]", "[\"wheel\", \"pinion\"]")).unwrap_err();
    let shown = render(&error);
    assert!(
        shown.contains("may not be a rack") && shown.contains("gears = [\"pinion\", \"wheel\"]"),
        "{shown}"
    );
    let shown = render(&parse(&text.replace("prismatic", "revolute")).unwrap_err());
    assert!(shown.contains("a rack slides"), "{shown}");
    let shown = render(&parse(&text.replace("\"rack\"", "\"rak\"")).unwrap_err());
    assert!(shown.contains("did you mean `rack`"), "{shown}");
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
