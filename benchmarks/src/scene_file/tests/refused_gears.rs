//! Refusals of gears, their loads and their meshes: line, cause, what was expected, way out.

use super::{BASE, changed, parse, refused, render};

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
