//! Refusals: line, cause, what was expected, way out.
//!
//! A row of a table is `LINE: OLD => NEW`, what is replaced in the base scene and the line that is to blame, several
//! replacements between `&&`; below it stand words of the refusal between `|`.

use super::{BASE, STABILITY, parse, render};
use crate::scene_file::{Origin, SceneFile, Selection, load, load_uncalibrated};

/// Holds every row of a table against what is said about the changed scene.
fn refused(base: &str, table: &str) {
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
fn contacts_and_models() {
    refused(BASE, MODELS);
}

#[test]
fn studies() {
    refused(BASE, STUDIES);
}

#[test]
fn maps_of_stability() {
    refused(&format!("{BASE}{STABILITY}"), MAPS);
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

/// A calibration that is not there is no matter for those who look for it.
#[test]
fn a_missing_calibration_can_be_left_out() {
    let wanted = "model = \"rigid\"\ncalibration = \"impact\"";
    let text = BASE.replacen("model = \"rigid\"", wanted, 1);
    let file = SceneFile::parse("test.toml", &text, Origin::Shipped, false).unwrap();
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
    `gears` has 1 members, expected 2 | for example
10: teeth = 20 => teeth = 20\nposition_m = [1.0]
    has 1 members, expected 2
# missing keys
8: teeth = 20\n =>
    `teeth` is missing in [gears.pinion] | number of teeth
1: duration_s = 1e-4\n =>
    `duration_s` is missing | simulated time in seconds
1: schema = 1\n =>
    `schema` is missing
21: centre_distance_m = 0.1001\n =>
    where `wheel` stands | `centre_distance_m` or `backlash_m`
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
    duplicate | stands once
10: teeth = 20 => teeth = 20\nteeth = 21
    duplicate
3: title = "A test" => title = "A test
    not TOML
"##;

const GEARS: &str = r##"
# gears
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
    there are `revolute`, `fixed` or `driven`
19: mount = "revolute" => mount = "driven"
    is empty | speed_rad_s = 100.0
20: mount = "revolute" => mount = "fixed"\nspeed_rad_s = 3.0
    the mount is fixed
20: mount = "revolute" => mount = { driven = { speed_rad_s = 1.0 } }\nspeed_rad_s = 3.0
    driven mount
# loads
13: { torque_nm = 10.0 } => { torque_nm = 10.0, viscous_nms_per_rad = 1.0 }
    one key only | `ramp`
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
    larger than the backlash | other flanks would overlap
24: gap_m = 1e-6 => path_coordinate_m = 0.1
    outside the path of contact | expected 4.2
24: flank = "left" => flank = "top"
    `left` or `right`
27: [[models]] => [[meshes]]\ngears = ["wheel", "pinion"]\n\n[[models]]
    mesh twice | first here
15: [gears.wheel] => [gears.third]\nteeth = 30\nmodule_m = 0.004\nface_width_m = 0.01\n\n[gears.wheel]
    gear `third` takes part in no mesh
24: mount = "revolute" => position_m = [0.1001, 0.0] && teeth = 20 => teeth = 20\nposition_m = [0.0, 0.0]
    `centre_distance_m` is given, but both gears have a position
17: teeth = 30\nmodule_m = 0.004 => teeth = 30\nmodule_m = 0.005
    unequal modules | this one | differs from this one
# racks
23: teeth = 30 => kind = "rack"\nteeth = 30 && mount = "revolute" => mount = "prismatic" && gears = ["pinion", "wheel"] => gears = ["wheel", "pinion"]
    may not be a rack | gears = ["pinion", "wheel"]
20: teeth = 30 => kind = "rack"\nteeth = 30
    `mount` is "revolute" | `prismatic`
16: teeth = 30 => kind = "rak"\nteeth = 30
    did you mean `rack`
"##;

const MODELS: &str = r##"
# flank points
28: damping = { law = "flores", e = 0.9 } => penalty_pa_per_m = 0.0
    penalty | positive
28: damping = { law = "flores", e = 0.9 } => points = "nodes"
    `points` | penalty_pa_per_m
28: damping = { law = "flores", e = 0.9 } => penalty_pa_per_m = 1e15, points = "node"
    did you mean `nodes`
28: damping = { law = "flores", e = 0.9 } => penalty_pa_per_m = 1e15, points = { along = 3, across = 0 }
    `across` is the number 0 | 1 to 10
28: damping = { law = "flores", e = 0.9 } => penalty_pa_per_m = 1e15, surface = "flat"
    smooth | faceted
28: damping = { law = "flores", e = 0.9 } => penalty_pa_per_m = 1e15, damping_ns_per_m3 = -1.0
    damping | not negative
28: damping = { law = "flores", e = 0.9 } => penalty_pa_per_m = 1e15, reach_m = 0.0
    reach
# contacts
28: stiffness_n_per_m2 = 1.4e10 => stiffness_n_per_m2 = -1.0
    expected more than 0
28: law = "flores" => law = "floras"
    did you mean `flores`
28: e = 0.9 => e = 1.5
    restitution | (0, 1]
28: e = 0.9 => ratio = 0.9
    unknown key `ratio`
28: damping = { law = "flores", e = 0.9 } => damping = "flores"
    `e` is missing in `damping` | e = 0.9
28: damping = { law = "flores", e = 0.9 } => exponent = 4.0
    exponent | [1, 3]
28: damping = { law = "flores", e = 0.9 } => exponent = 1.5, damping = { law = "kelvin-voigt-ratio", ratio = 0.1 }
    linear law only
28: damping = { law = "flores", e = 0.9 } => friction = { mu = -0.1, v_ref_m_s = 0.01 }
    friction coefficient mu
28: damping = { law = "flores", e = 0.9 } => slices = 0
    1 to 1000
28: kind = "constant" => kind = "konstant"
    did you mean `constant`
32: stiffness = "iso6336" => stiffness = "table"
    `path_coordinate_m` is missing
32: stiffness = "iso6336" => stiffness = { kind = "table", path_coordinate_m = [0.0, 0.0], stiffness_n_per_m = [1e8, 1e8] }
    table
32: stiffness = "iso6336" => stiffness = { kind = "compliance", hertz = "log" }
    `reference_load_n` is missing
32: stiffness = "iso6336" => stiffness = { kind = "compliance", foundation = "rigid", root_length = "2 rf theta" }
    does not belong
32: contact = { stiffness = "iso6336" } => contact = [{ stiffness = "iso6336" }, { stiffness = "iso6336" }]
    2 contacts for 1 meshes
# models
27: model = "rigid" => model = "rigit"
    did you mean `rigid`
32: model = "rigid" => model = "movable-teeth"\nparameters = { tooth_stiffness_n_per_m = 5e8, tooth_mass_kg = 5e-3 }
    two models have the label `movable-teeth` | first here
28: model = "rigid" => model = "rigid"\nlabel = "a,b"
    without commas
28: model = "rigid" => model = "rigid"\ngears = { weel = "rigid" }
    there is no gear `weel` | did you mean `wheel`
28: model = "rigid" => model = "rigid"\nparameters = { tooth_mass_kg = 1.0 }
    the model `rigid` has no parameter
33: tooth_mass_kg = 4.8e-3 => tooth_mass_kg = 1.0
    `tooth_mass_kg` | take an inertia of
33: tooth_mass_kg = 4.8e-3 => tooth_mass_kg = [1e-3, 2e-3]
    2 values for 20 teeth
33: tooth_mass_kg = 4.8e-3 => tooth_mass_kg = -1.0
    not positive
33: tooth_mass_kg = 4.8e-3 => tooth_mass_kg = "light"
    expected a number
33: tooth_mass_kg = 4.8e-3 => tooth_mass_kg = 4.8e-3, integrate = "some"
    "active" or "all"
28: model = "rigid" => model = "rigid"\ncalibration = "impct"
    did you mean `impact`
28: model = "rigid" => model = "rigid"\ncalibration = "impact"
    no calibration "impact" of `rigid` in scene `test` | gearbench identify test --model rigid --write
28: model = "rigid" => model = "rigid"\ncalibration = { name = "impact", scene = "spur_impact", label = "stiff" }
    there is one for `movable-teeth` or `rigid`
"##;

const STUDIES: &str = r##"
# the study
36: method = "dopri5" => method = "dopri6"
    did you mean `dopri5`
36: method = "dopri5" => method = "newmark(rho=1)"
    no parameter `rho`
36: method = "dopri5" => method = "newmark(beta"
    closing bracket
36: rtol = 1e-6 => rtol = 0.0
    more than 0 and less than 1
36: rtol = 1e-6 => rtol = 1e-6, step_s = 1e-6
    both given
36: step_s = 1e-6 => rtol = 1e-6
    rk4 has fixed steps
36: method = "rk4" => method = "rk4(coast=1)"
    `coast` | `free_flight`
33: tooth_mass_kg = 4.8e-3 => tooth_mass_kg = 4.8e-3, sleep = 1e-6
    `sleep` is called `vibration_cut_off` now
36: method = "rk4" => method = "rk4(free_flight=2)"
    free_flight = 2 | neither 0 nor 1
36: method = "rk4" => method = "trigonometric(free_flight=0)"
    always crosses flights
33: tooth_mass_kg = 4.8e-3 => tooth_mass_kg = 4.8e-3, vibration_cut_off = 1.0
    `vibration_cut_off` | at least 0 and less than 1
33: tooth_mass_kg = 4.8e-3 => tooth_mass_kg = 4.8e-3, vibration_cut_off = -1e-8
    `vibration_cut_off` | at least 0 and less than 1
33: tooth_mass_kg = 4.8e-3 => tooth_mass_kg = 4.8e-3, vibration_cut_off = "never"
    `vibration_cut_off` | at least 0 and less than 1
36: step_s = 1e-6 => step_s = -1e-6
    expected more than 0
36: method = "dopri5", rtol => method = "bdf", step_s
    bdf chooses its steps
36: [study] => [study]\nmodels = ["rigd"]
    did you mean `rigid`
36: [study] => [study]\nmodels = ["rigid", "rigid"]
    stands twice
36: [study] => [study]\nmodels = []
    is empty
36: [study] => [study]\nsamples = 1
    2 to 1000000
36: [study] => [study]\nquantities = ["force"]
    `force_l2`
36: [study] => [study]\nevents = 1
    expected true or false
5: case-a-fine => case-b
    calculix/case-a-fine
6: tolerance = 0.05 => tolerance = -1
    more than 0
6: tolerance = 0.05 => tolerance = { metric = "force", limit = 0.1 }
    not known
4: duration_s = 1e-4 => duration_s = 0
    more than 0
1: schema = 1 => schema = 2
    schema 2 | expected 1
# precision
36: [study] => [study]\nprecision = { stepps = [1] }
    unknown key `stepps` | steps_s
36: [study] => [study]\nprecision = { models = ["rigd"] }
    rigd | rigid
36: [study] => [study]\nprecision = { modes = [10, -1] }
    -1 | whole number
36: [study] => [study]\nprecision = { modes = [10, 5000] }
    `modes` holds the number 5000 | 0 to 2000
36: [study] => [study]\nprecision = { modes = 10 }
    `modes`
36: [study] => [study]\nprecision = { factors = [1.0, 0] }
    `factors` holds the number 0 | more than 0
36: [study] => [study]\nprecision = { steps_s = [-1e-6] }
    `steps_s` holds | more than 0
36: [study] => [study]\nprecision = { rtols = [1e-3, 2.0] }
    `rtols` holds the number 2.0 | less than 1
36: [study] => [study]\nprecision = { rtols = [] }
    is empty
36: [study] => [study]\nprecision = { metrics = ["farce"] }
    farce | force
36: [study] => [study]\nprecision = { duration_s = 0 }
    `duration_s` is the number 0 | more than 0
36: [study] => [study]\nprecision = { integrators = [{ method = "rk4", rtol = 1e-3 }] }
    rk4 has fixed steps
36: [study] => [study]\nprecision = { factors = [1.0], steps_s = [1e-6] }
    steps are given twice | give one
# sweep
36: [study] => [study]\nsweep = { from_hz = 100 }
    `to_hz` is missing in [study.sweep]
36: [study] => [study]\nsweep = { from_hz = 200, to_hz = 100 }
    ends at 100 Hz | lower mesh frequency
36: [study] => [study]\nsweep = { points = 1 }
    `points` is the number 1 | 2 to 10000
36: [study] => [study]\nsweep = { settle_s = 0 }
    more than 0
36: [study] => [study]\nsweep = { cycels = 8 }
    did you mean `cycles`
# stability
36: [study] => [study]\nstability = { axes = [{ axis = "modes" }, { axis = "speed" }, { axis = "damping" }] }
    one or two
"##;

const MAPS: &str = r##"
39: models = ["rigid"] => models = ["rigit"]
    did you mean `rigid` | rigit
40: ["rk4" => ["rk5"
    rk5 | rk4
40: rho_inf=0.5 => rho_inf=5
    outside | brackets
41: duration_s = 5e-5 => duration_s = 0
    `duration_s` is the number 0 | more than 0
42: to = 1e-5 => to = 1e-8
    has not begun | smaller value as `from`
42: points = 5 => points = 1
    `points` is the number 1 | 2 to 400
42: from = 1e-7,  => 
    `from` is missing | smallest value
42: step_s = { => step = {
    unknown key `step` | step_s
43: "damping" => "dampin"
    did you mean `damping` | not known
43: 0.2, 0.0 => 0.2, 1.5
    damping ratio 1.5 cannot be | 0 to 0.999
43: values = [0.2, 0.0] => values = [0.2], to = 1.0
    both given | and this
43: "speed", from = 0.5, to = 2.0, points = 3 => "damping", values = [0.1]
    stands twice | leave it out
43: "speed", from = 0.5 => "speed", from = 0.0
    `from` is the number 0.0 | more than 0
44: max_steps = 1000 => max_steps = 0
    `max_steps` is the number 0 | at least 1
"##;
