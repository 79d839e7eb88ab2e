//! Refusals of files, gears and meshes: line, cause, expected value, help.
//!
//! A row of a table is `LINE: OLD => NEW`, the replacement in the base scene and the line of the error, several
//! replacements separated by `&&`; the next line has words of the error, separated by `|`.

use super::{BASE, parse, render};
use crate::context::Context;
use crate::scene_file::{Origin, SceneFile, Selection, load, load_uncalibrated};

/// Checks the errors of modified scenes against the rows of a table.
pub(super) fn refused(base: &str, table: &str) {
    let mut failures = String::new();
    let mut rows = table
        .lines()
        .map(str::trim)
        .filter(|row| !row.is_empty() && !row.starts_with('#'));
    while let (Some(row), Some(words)) = (rows.next(), rows.next()) {
        let (line, edits) = row.split_once(": ").unwrap();
        let mut text = base.to_owned();
        for edit in edits.split(" && ") {
            let (old, new) = edit.split_once(" =>").unwrap();
            let [old, new] = [old, new].map(|t| t.trim_start().replace("\\n", "\n"));
            assert!(text.contains(&old), "`{old}` is not in the scene");
            text = text.replacen(&old, &new, 1);
        }
        let Err(error) = parse(&text) else {
            failures += &format!("\n{row}\nis accepted\n");
            continue;
        };
        let shown = render(&error);
        let heading = format!("test.toml:{line}:");
        let missing = (words.split(" | ").chain([heading.as_str()])).find(|w| !shown.contains(w));
        if let Some(word) = missing {
            failures += &format!("\n{row}\nno `{word}` in\n{shown}");
        } else if error.help_text().is_none() {
            failures += &format!("\n{row}\nno way out in\n{shown}");
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

#[test]
fn keys_types_and_syntax() {
    refused(BASE, FILE);
}

#[test]
fn gears_and_meshes() {
    refused(BASE, GEARS);
}

#[test]
fn conical_gears() {
    refused(BASE, CONICAL);
}

#[test]
fn bearings_and_axes() {
    refused(BASE, LATERAL);
}

#[test]
fn shafts() {
    refused(BASE, SHAFTS);
}

#[test]
fn what_cannot_be() {
    refused(BASE, IMPOSSIBLE);
}

#[test]
fn what_is_not_done() {
    refused(BASE, NOT_DONE);
}

#[test]
fn scenes_that_are_not_there() {
    let shown = render(&load(&Context::default(), "spur_inpact").unwrap_err());
    assert!(
        shown.contains("no scene `spur_inpact`") && shown.contains("did you mean `spur_impact`"),
        "{shown}"
    );
    let shown = render(
        &load_uncalibrated(&Context::default(), "nowhere/x.toml", Selection::All).unwrap_err(),
    );
    assert!(
        shown.contains("nowhere/x.toml") && shown.contains("expected a readable TOML file"),
        "{shown}"
    );
}

/// A missing calibration is no error where calibrations are optional.
#[test]
fn a_missing_calibration_can_be_left_out() {
    let wanted = "model = \"rigid\"\ncalibration = \"impact\"";
    let text = BASE.replacen("model = \"rigid\"", wanted, 1);
    let file = SceneFile::parse(
        &Context::default(),
        "test.toml",
        &text,
        Origin::Shipped,
        false,
    )
    .unwrap();
    let calibration = file.models[0].calibration.as_ref().unwrap();
    assert!(calibration.constants.is_none());
}

const FILE: &str = r##"
# unknown keys and other units
10: module_m = 0.004 => module_mm = 4
    unknown key `module_mm` in [gears.pinion] | SI units | `module_m = 0.004` | metres
10: module_m = 0.004 => module = 0.004
    keys carry their unit | `module_m`
12: speed_rad_s = 20.0 => speed_rpm = 300
    `speed_rad_s = 31.4159265359`
9: teeth = 20 => tetth = 20
    did you mean `teeth`
10: teeth = 20 => teeth = 20\npressure_angle_rad = 0.35
    `pressure_angle_deg = 20.05
3: title =  => colour =
    unknown key `colour` | known are schema, name, title
13: torque_nm = 10.0 => torque_nmm = 10000
    `torque_nm = 10`
24: gap_m = 1e-6 => gap_um = 1
    `gap_m = 0.000001`
28: stiffness_n_per_m2 = 1.4e10 => stiffness_n_per_mm_um = 14
    `stiffness_n_per_m2 = 14000000000`
33: tooth_mass_kg = 4.8e-3 => tooth_mass_g = 4.8
    has no parameter `tooth_mass_g` | `tooth_mass_kg = 0.0048`
36: rtol = 1e-6 => tol = 1e-6
    did you mean `rtol`
35: [study] => [studdy]
    did you mean `study`
10: teeth = 20 => teeth = 20\nbody_height_m = 1
    unknown key `body_height_m`
# other types
10: module_m = 0.004 => module_m = "4 mm"
    `module_m` is the text "4 mm", expected a number | normal module in metres
9: teeth = 20 => teeth = 20.5
    `teeth` is the number 20.5, expected a whole number
9: teeth = 20 => teeth = -20
    expected a whole number, zero or more
9: teeth = 20 => teeth = 1000000000000
    expected a whole number up to 4294967295
10: module_m = 0.004 => module_m = nan
    expected a finite number
10: module_m = 0.004 => module_m = inf
    expected a finite number
12: speed_rad_s = 20.0 => speed_rad_s = -1e999
    expected a finite number
13: loads = [{ torque_nm = 10.0 }] => loads = 10.0
    expected a list
13: [{ torque_nm = 10.0 }] => [10.0]
    expected one of `torque_nm`, `ramp`
13: [{ torque_nm = 10.0 }] => []
    `loads` is empty | at least one
2: name = "test" => name = 3
    expected a text in quotes
2: name = "test" => name = "A test"
    lower-case
22: gears = ["pinion", "wheel"] => gears = ["pinion"]
    `gears` has 1 member, expected 2 | for example
10: teeth = 20 => teeth = 20\nposition_m = [1.0]
    invalid length 1, expected [x, y] or [x, y, z]
# missing keys
8: teeth = 20\n =>
    `teeth` is missing in [gears.pinion] | number of teeth
1: duration_s = 1e-4\n =>
    `duration_s` is missing | simulated time in seconds
1: schema = 1\n =>
    `schema` is missing
21: centre_distance_m = 0.1001\n =>
    position of `wheel` | `centre_distance_m` or `backlash_m`
26: model = "rigid"\n =>
    `model` is missing
32: stiffness = "iso6336" => exponent = 1.0
    `stiffness` is missing
28: law = "flores",  =>
    `law` is missing in `damping` | flores
36: , step_s = 1e-6 =>
    `step_s` is missing
36: { method = "dopri5", rtol = 1e-6 } => { rtol = 1e-6 }
    `method` is missing
33: , tooth_mass_kg = 4.8e-3 =>
    `tooth_mass_kg` | is missing | gearbench identify
# not TOML
9: teeth = 20 => teeth =
    not TOML
15: [gears.wheel] => [gears.pinion]
    duplicate | each name once
10: teeth = 20 => teeth = 20\nteeth = 21
    duplicate
3: title = "A test" => title = "A test
    not TOML
"##;

const GEARS: &str = r##"
# gears
8: [gears.pinion] => [gears.""] && "pinion" => ""
    the gear has the name "" | column name | 1 to 60 characters
8: [gears.pinion] => [gears."a\u001bb"] && "pinion" => "a\u001bb"
    the gear has the name | \u{1b} | 1 to 60 characters
9: teeth = 20 => teeth = 12
    [gears.pinion]: undercut | profile shift of at least
9: teeth = 20 => teeth = 2
    number of teeth is 2 | from 3 to 10000
10: module_m = 0.004 => module_m = -0.004
    normal module | a length from
10: teeth = 20 => teeth = 20\npressure_angle_deg = 60
    pressure angle is 60 | degrees
10: teeth = 20 => teeth = 20\nbore_radius_m = 0.05
    bore too large | smaller bore
10: teeth = 20 => teeth = 20\naddendum_factor = 3
    pointed
10: teeth = 20 => teeth = 20\nend_relief = { low = { amount_m = 1e-5, length_m = 1.0 } }
    the face is | choose a length up to
10: teeth = 20 => teeth = 20\ntopography = { both = "none.csv" }
    cannot be read | paths are relative to the folder of the scene file
10: teeth = 20 => teeth = 20\ntopography = { both = [[0, 1], [0]], left = [[0, 1], [0, 1]] }
    define the removed material of the same flanks | remove one
10: teeth = 20 => teeth = 20\ntopography = { both = [[0, 1e-6], [0]] }
    1 amounts in row 2 | 2 as in the first row
10: teeth = 20 => teeth = 20\ntopography = { both = [[0, 1], [0, 1]] }
    flank modifications remove
10: teeth = 20 => teeth = 20\ntopography = { unit_m = 1e-6 }
    no amounts | a CSV file
10: teeth = 20 => teeth = 20\ntwist_m = "much"
    a number or a table
10: teeth = 20 => teeth = 20\ndeviations = { class = 6, seed = 1, runout_m = 1e-5 }
    `runout_m` and `class` are both given
10: teeth = 20 => teeth = 20\ndeviations = { seed = 1 }
    `seed` is given without `class`
10: teeth = 20 => teeth = 20\ndeviations = { left = { cumulative_pitch_m = [1e-6, 2e-6] } }
    2 values | one for each of the 20 teeth
10: teeth = 20 => teeth = 20\nthinning_m = 0.01
    no tooth left
10: teeth = 20 => teeth = 20\ntip_radius_factor = 0.9
    tip radius factor
10: teeth = 20 => teeth = 20\ntip_relief = { amount_m = 1e-5, start_radius_m = 0.01 }
    tip relief starts
10: teeth = 20 => teeth = 20\ninertia_kgm2 = 0.0
    expected more than 0
10: teeth = 20 => teeth = 20\nadded_inertia_kgm2 = -1.0
    expected zero or more
10: teeth = 20 => teeth = 20\nmaterial = "stel"
    did you mean `steel`
10: teeth = 20 => teeth = 20\nmaterial = { young_pa = 2.1e11, poisson = 0.6, density_kg_m3 = 7850 }
    Poisson | 0.6
19: mount = "revolute" => mount = "revolut"
    did you mean `revolute`
19: mount = "revolute" => mount = "prismatic"
    there are `revolute`, `fixed`, `driven` and `guided`
19: mount = "revolute" => mount = { guided = {} }
    has no effect | stiffness_nm_per_rad
19: mount = "revolute" => mount = { guided = { friction_nm = 1.0 } }
    one regularisation | stick_rad
19: mount = "revolute" => mount = { guided = { stick_rad = 1e-5 } }
    friction_nm | belong to friction
19: mount = "revolute" => mount = { guided = { stiffness_n_per_m = 1.0 } }
    stiffness_n_per_m | stiffness_nm_per_rad
19: mount = "revolute" => mount = "driven"
    is empty | speed_rad_s = 100.0
20: mount = "revolute" => mount = "fixed"\nspeed_rad_s = 3.0
    the mount is fixed
20: mount = "revolute" => mount = { driven = { speed_rad_s = 1.0 } }\nspeed_rad_s = 3.0
    driven mount
# loads
13: { torque_nm = 10.0 } => { torque_nm = 10.0, viscous_nms_per_rad = 1.0 }
    exactly one key | `ramp`
13: { torque_nm = 10.0 } => {}
    is empty | `ramp`
13: { torque_nm = 10.0 } => { viscous_nms_per_rad = -1.0 }
    expected zero or more
13: { torque_nm = 10.0 } => { force_n = 1.0 }
    unknown key `force_n`
13: { torque_nm = 10.0 } => { ramp = { from_nm = 0.0, to_nm = 1.0, start_s = 2.0, end_s = 1.0 } }
    has no length
13: { torque_nm = 10.0 } => { ramp = { to_nm = 1.0, start_s = 2.0, end_s = 1.0 } }
    `from_nm` is missing
13: { torque_nm = 10.0 } => { table = { time_s = [0.0, 0.0], torque_nm = [1.0, 2.0] } }
    ascend
13: { torque_nm = 10.0 } => { table = { time_s = [0.0, 1.0], torque_nm = [1.0] } }
    2 times but 1 values
# meshes
22: "wheel"] => "weel"]
    there is no gear `weel` | did you mean `wheel`
22: "wheel"] => "pinion"]
    cannot mesh with itself
23: centre_distance_m = 0.1001 => centre_distance_m = 0.09
    `pinion` and `wheel` | centre distance too small | increase it
23: centre_distance_m = 0.1001 => centre_distance_m = 0.0999
    flanks overlap | 0.1000
23: centre_distance_m = 0.1001 => centre_distance_m = 0.2
    no tooth engagement
24: centre_distance_m = 0.1001 => centre_distance_m = 0.1001\nbacklash_m = 1e-4
    both given
23: centre_distance_m = 0.1001 => backlash_m = -1e-4
    backlash
23: centre_distance_m = 0.1001 => centre_distance_mm = 100.1
    `centre_distance_m = 0.1001`
24: gap_m = 1e-6 => gap_m = 1e-3
    larger than the normal backlash | opposite flanks would overlap
24: gap_m = 1e-6 => path_coordinate_m = 0.1
    outside the path of contact | expected 4.2
24: flank = "left" => flank = "top"
    `left` and `right`
27: [[models]] => [[meshes]]\ngears = ["wheel", "pinion"]\n\n[[models]]
    have two meshes | first here
15: [gears.wheel] => [gears.third]\nteeth = 30\nmodule_m = 0.004\nface_width_m = 0.01\n\n[gears.wheel]
    gear `third` is in no mesh
24: mount = "revolute" => position_m = [0.1001, 0.0] && teeth = 20 => teeth = 20\nposition_m = [0.0, 0.0]
    `centre_distance_m` is given, but the positions of both gears are known
17: teeth = 30\nmodule_m = 0.004 => teeth = 30\nmodule_m = 0.005
    unequal modules | this one | differs from this one
# racks
23: teeth = 30 => kind = "rack"\nteeth = 30 && mount = "revolute" => mount = "prismatic" && gears = ["pinion", "wheel"] => gears = ["wheel", "pinion"]
    must not be a rack | gears = ["pinion", "wheel"]
20: teeth = 30 => kind = "rack"\nteeth = 30
    `mount` is "revolute" | `prismatic`
16: teeth = 30 => kind = "rak"\nteeth = 30
    did you mean `rack`
"##;

const IMPOSSIBLE: &str = r##"
10: teeth = 20 => teeth = 20\npressure_angle_deg = 0.349
    pressure angle of 0.349 degrees | at least 5 degrees | in radians, write pressure_angle_deg = 19.99
12: speed_rad_s = 20.0 => speed_rad_s = 1e12
    the teeth of `pinion` move at | faster than the speed of sound in their material, 5172 m/s
19: mount = "revolute" => mount = { driven = { ramp = { from_rad_s = 0, to_rad_s = -1e6, start_s = 0, end_s = 1 } } }
    the teeth of `wheel` move at | speed of sound
13: torque_nm = 10.0 => torque_nm = 1e15
    on the teeth of `pinion` | of its Young's modulus
13: [{ torque_nm = 10.0 }] => [{ viscous_nms_per_rad = 1.0 }, { table = { time_s = [0.0, 1.0], torque_nm = [0.0, -1e9] } }]
    too large for any solid
13: teeth = 20 => teeth = 20\nmaterial = { young_pa = 210, poisson = 0.3, density_kg_m3 = 7850 }
    speed of sound in their material | here 210 Pa | pascal
33: tooth_stiffness_n_per_m = 5.3e8 => tooth_stiffness_n_per_m = 1e300
    1e300 N/m on a tooth of 0.0048 kg | waves in the material of `pinion` | the model `rigid`
33: tooth_mass_kg = 4.8e-3 => tooth_mass_kg = 1e-30
    on a tooth of 1e
36: step_s = 1e-6 => step_s = 1
    a step of 1e0 s of `rk4` is longer than the 1e-4 s
28: contact = { stiffness = { kind = "constant", stiffness_n_per_m2 = 1.4e10 }, damping = { law = "flores", e = 0.9 } } => integrators = [{ method = "rk4", step_s = 1e-3 }]\ncontact = { stiffness = "iso6336" } && [study] => \n[study]
    longer than the 1e-4 s
28: { stiffness = { kind = "constant", stiffness_n_per_m2 = 1.4e10 }, damping = { law = "flores", e = 0.9 } } => { law = "hard", points = "nodes" }
    a contact of flank points has no effect | no flank points
# in each other's place
34: [[models]] => [[meshes]]\ngears = ["wheel", "third"]\ncentre_distance_m = 0.1001\ndirection_deg = 180\n\n[[models]] && [[meshes]] => [gears.third]\nteeth = 20\nmodule_m = 0.004\nface_width_m = 0.01\n\n[[meshes]]
    `pinion` and `third` do not mesh and overlap | 0 m apart, their tip circles need 0.088 m
# closed loops
37: [[models]] => [[meshes]]\ngears = ["third", "pinion"]\nbacklash_m = 1e-4\n\n[[models]] && [[models]] => [[meshes]]\ngears = ["wheel", "third"]\ncentre_distance_m = 0.1001\n\n[[models]] && [[meshes]] => [gears.third]\nteeth = 20\nmodule_m = 0.004\nface_width_m = 0.01\n\n[[meshes]]
    the positions of both gears are known | earlier meshes determine the positions of both gears
"##;

const NOT_DONE: &str = r##"
10: teeth = 20 => teeth = 20\nshaft_diameter_m = 0.03
    unknown key `shaft_diameter_m` | what turns together stands in `[[shafts]]` | gearbench help limits
10: teeth = 20 => teeth = 20\ncarrier = "arm"
    a body on a shaft with `planets` is a carrier | gearbench help limits
10: teeth = 20 => teeth = 20\nhelix_deviation_m = 1e-5
    no deviations of the helix | gearbench help limits
24: start =  => misalignment_deg = 0.1\nstart = 
    unknown key `misalignment_deg` | known are gears
"##;

const CONICAL: &str = r##"
10: teeth = 20 => teeth = 20\nbevel_angle_deg = 5
    unknown key `bevel_angle_deg` | gears are cylindrical or conical (beveloid) | gearbench help limits
9: teeth = 20 => profile_shift_angle_deg = 60\nteeth = 20
    profile-shift angle is 60 | -45 to 45 degrees
9: teeth = 20 => tip_cone_angle_deg = -50\nteeth = 20
    angle of the tip cone is -50 | -45 to 45 degrees
9: teeth = 20 => profile_shift_angle_deg = 40\nteeth = 20
    at the height -0.0050 m, the end of the face where the profile shift is -1.04 | smaller profile-shift angle
10: teeth = 20 => profile_shift_angle_deg = 5\ndeviations = { class = 6 }\nteeth = 20
    found a conical gear
24: teeth = 20 => profile_shift_angle_deg = 3\nteeth = 20 && centre_distance_m = 0.1001 => backlash_m = 1e-4
    the backlash of conical gears does not determine their positions | `position_m` and `axis`
25: teeth = 20 => profile_shift_angle_deg = 3\nprofile_shift = 0.3\nteeth = 20
    flanks overlap | thin
"##;

const LATERAL: &str = r#"
    12: speed_rad_s = 20.0 => bearing = { stiffness = [1e8, -1e8, 1e8, 1e4, 1e4, 0.0] }
    stiffness of direction 2 is not zero or positive | N/m
    12: speed_rad_s = 20.0 => bearing = { stiffness = [1e8, 1e8, 1e8, 1e4, 1e4] }
    6
    12: speed_rad_s = 20.0 => bearing = { stiffness = [1e8, 2e8, 1e8, 1e4, 1e4, 0.0], clearance_m = 1e-5 }
    a radial clearance | one radial stiffness
    12: speed_rad_s = 20.0 => directions = { tilt_z = "free" }
    the direction of motion of the mount | give it in `mount`
    12: speed_rad_s = 20.0 => centre_of_mass_m = [0.0, 1e-3, 0.0]
    no effect on a hub that only rotates | add `bearing` or `directions`
    12: speed_rad_s = 20.0 => axis = [0.0, 0.0, 0.0]
    the direction of the axis is zero | [0.0, 0.0, 1.0]
    12: speed_rad_s = 20.0 => misalignment_deg = { plane_of_action = 5.0 }
    turned by 5.000 degrees | at most 2
    12: speed_rad_s = 20.0 => misalignment_deg = { about = [0.0, 1.0, 0.0] }
    `about` and `angle` belong together | angle = 0.03
    12: speed_rad_s = 20.0 => position_m = [0.0]
    [x, y] or [x, y, z]
    22: mount = "revolute" => position_m = [0.1001, 0.0, 0.05] && speed_rad_s = 20.0 => position_m = [0.0, 0.0] && centre_distance_m = 0.1001\n =>
    the face widths do not overlap | third coordinates
"#;

const SHAFTS: &str = r#"
    27: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0 }]\n[[models]]
    shaft `s`: a rigid shaft joins at least two | name two
    27: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0 }, { gear = "wheel", at_m = 0.1 }]\n[[models]]
    is not on the axis of `pinion` | the same axis
    28: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0 }, { at_m = 0.1 }]\n[[models]]
    neither a gear nor a body
    28: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0, inertia_kgm2 = 1.0 }]\n[[models]]
    is given for a gear | [gears.pinion]
    28: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0 }, { body = "a b", at_m = 0.1 }]\n[[models]]
    has to be valid in column names | letters
    28: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "nobody", at_m = 0.0 }]\n[[models]]
    nobody
    27: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0 }, { body = "b", at_m = 0.3, inertia_kgm2 = 1e-3 }]\nsections = [{ length_m = 0.2, diameter_m = 0.02 }]\n[[models]]
    is not on the shaft | sum of the lengths
    29: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0 }, { body = "b", at_m = 0.2, inertia_kgm2 = 1e-3 }]\nsections = [{ length_m = 0.2 }]\n[[models]]
    neither a diameter nor a torsional stiffness
    27: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0 }, { body = "b", at_m = 0.2, inertia_kgm2 = 1e-3 }]\nsections = [{ length_m = 0.2, diameter_m = 0.02, inner_diameter_m = 0.03 }]\n[[models]]
    the wall thickness is not positive
    27: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0 }, { body = "b", at_m = 0.2 }]\nsections = [{ length_m = 0.2, stiffness_nm_per_rad = 1e3 }]\n[[models]]
    there is no inertia | give the body an inertia
    30: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0 }, { body = "b", at_m = 0.2, inertia_kgm2 = 1e-3 }]\nsections = [{ length_m = 0.2, diameter_m = 0.02 }]\ndamping_s = 1e-6\ndamping_ratio = 0.1\n[[models]]
    two values of damping are given | a ratio or a time
    27: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0 }, { body = "b", at_m = 0.2, inertia_kgm2 = 1e-3 }]\ndamping_ratio = 0.1\n[[models]]
    no effect on a rigid shaft
    27: [[models]] => [[shafts]]\nname = "s"\ncarries = [{ gear = "pinion", at_m = 0.0 }, { body = "b", at_m = 0.2, inertia_kgm2 = 1e-3 }]\n[[models]]
    starts at 20 rad/s | the same speed
"#;
