//! Refusals of contacts, models and studies, in tables as in `refusals`.

use super::refusals::refused;
use super::{BASE, STABILITY};

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
28: damping = { law = "flores", e = 0.9 } => friction = { mu = 0.1 }
    none of `v_ref_m_s` and `stick_m` | stick_m = 1e-6
28: damping = { law = "flores", e = 0.9 } => friction = { mu = 0.1, v_ref_m_s = 0.01, stick_m = 1e-6 }
    both of `v_ref_m_s` and `stick_m`
28: damping = { law = "flores", e = 0.9 } => friction = { v_ref_m_s = 0.01 }
    none of `mu` and `film`
28: damping = { law = "flores", e = 0.9 } => friction = { film = { viscosity_pa_s = 0, roughness_m = 4e-7 }, v_ref_m_s = 0.01 }
    friction viscosity
28: damping = { law = "flores", e = 0.9 } => slices = 0
    1 to 1000
28: kind = "constant" => kind = "konstant"
    did you mean `constant`
32: stiffness = "iso6336" => stiffness = "table"
    `path_coordinate_m` is missing
32: stiffness = "iso6336" => stiffness = { kind = "table", path_coordinate_m = [0.0, 0.0], stiffness_n_per_m = [1e8, 1e8] }
    table
32: stiffness = "iso6336" => stiffness = { kind = "parabola", stiffness_n_per_m2 = 1.4e10, path_slope = 1.2, path_curvature = 0.1 }
    not positive all along the path | every xi from -1
32: stiffness = "iso6336" => stiffness = { kind = "parabola", stiffness_n_per_m2 = 1.4e10, path_slop = 0.2 }
    did you mean `path_slope`
32: stiffness = "iso6336" => stiffness = { kind = "compliance", hertz = "linear", reference_load_n = 1000.0 }
    does not belong
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
    `tooth_mass_kg` | have an inertia of
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
    the scene `test` has no calibration "impact" of `rigid` | gearbench identify test --model rigid --write
28: model = "rigid" => model = "rigid"\ncalibration = { name = "impact", scene = "spur_impact", label = "stiff" }
    the scene has one for `movable-teeth` or `rigid`
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
36: method = "rk4" => method = "rk4(free_flight=2)"
    free_flight = 2 | neither 0 nor 1
36: method = "rk4" => method = "trigonometric(free_flight=0)"
    always crosses flights
36: step_s = 1e-6 => step_s = -1e-6
    expected more than 0
36: method = "dopri5", rtol => method = "bdf", step_s
    bdf controls its step size
36: [study] => [study]\nmodels = ["rigd"]
    did you mean `rigid`
36: [study] => [study]\nmodels = ["rigid", "rigid"]
    occurs twice
36: [study] => [study]\nmodels = []
    is empty
36: [study] => [study]\nsamples = 1
    2 to 1000000
36: [study] => [study]\nquantities = ["forces"]
    `force_l2`
36: [study] => [study]\nevents = 1
    expected true or false
5: case-a-fine => case-b
    calculix/case-a-fine
6: tolerance = 0.05 => tolerance = -1
    more than 0
6: tolerance = 0.05 => tolerance = { metric = "forces", limit = 0.1 }
    `force_l2`
36: [study] => [study]\nprecision = { metrics = ["peak_force_n"] }
    peak_force_n | `peak`
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
    outside | parentheses
41: duration_s = 5e-5 => duration_s = 0
    `duration_s` is the number 0 | more than 0
42: to = 1e-5 => to = 1e-8
    below the start of the map | smaller value as `from`
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
    is given twice | remove it
43: "speed", from = 0.5 => "speed", from = 0.0
    `from` is the number 0.0 | more than 0
44: max_steps = 1000 => max_steps = 0
    `max_steps` is the number 0 | at least 1
"##;
