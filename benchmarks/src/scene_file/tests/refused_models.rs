//! Refusals of contacts, models and studies: line, cause, what was expected, way out.

use super::{changed, refused};

#[test]
fn impossible_flank_points() {
    let contact = |with: &str, words: &[&str]| {
        refused("damping = { law = \"flores\", e = 0.9 }", with, 28, words);
    };
    contact("penalty_pa_per_m = 0.0", &["penalty", "positive"]);
    contact("points = \"nodes\"", &["`points`", "penalty_pa_per_m"]);
    contact(
        "penalty_pa_per_m = 1e15, points = \"node\"",
        &["did you mean `nodes`"],
    );
    contact(
        "penalty_pa_per_m = 1e15, points = { along = 3, across = 0 }",
        &["`across` is 0", "1 to 10"],
    );
    contact(
        "penalty_pa_per_m = 1e15, surface = \"flat\"",
        &["smooth", "faceted"],
    );
    contact(
        "penalty_pa_per_m = 1e15, damping_ns_per_m3 = -1.0",
        &["damping", "not negative"],
    );
    contact("penalty_pa_per_m = 1e15, reach_m = 0.0", &["reach"]);
}

#[test]
fn impossible_contacts() {
    refused(
        "stiffness_n_per_m2 = 1.4e10",
        "stiffness_n_per_m2 = -1.0",
        28,
        &["expected more than zero"],
    );
    refused(
        "law = \"flores\"",
        "law = \"floras\"",
        28,
        &["did you mean `flores`"],
    );
    refused("e = 0.9", "e = 1.5", 28, &["restitution", "(0, 1]"]);
    refused("e = 0.9", "ratio = 0.9", 28, &["unknown key `ratio`"]);
    refused(
        "damping = { law = \"flores\", e = 0.9 }",
        "damping = \"flores\"",
        28,
        &["e = 0.9"],
    );
    refused(
        "damping = { law = \"flores\", e = 0.9 }",
        "exponent = 4.0",
        28,
        &["exponent", "[1, 3]"],
    );
    refused(
        "damping = { law = \"flores\", e = 0.9 }",
        "exponent = 1.5, damping = { law = \"kelvin-voigt-ratio\", ratio = 0.1 }",
        28,
        &["linear law only"],
    );
    refused(
        "damping = { law = \"flores\", e = 0.9 }",
        "friction = { mu = -0.1, v_ref_m_s = 0.01 }",
        28,
        &["friction coefficient mu"],
    );
    refused(
        "damping = { law = \"flores\", e = 0.9 }",
        "slices = 0",
        28,
        &["1 to 1000"],
    );
    refused(
        "kind = \"constant\"",
        "kind = \"konstant\"",
        28,
        &["did you mean `constant`"],
    );
    refused(
        "stiffness = \"iso6336\"",
        "stiffness = \"table\"",
        32,
        &["path_coordinate_m = [..]"],
    );
    refused(
        "stiffness = \"iso6336\"",
        "stiffness = { kind = \"table\", path_coordinate_m = [0.0, 0.0], stiffness_n_per_m = [1e8, 1e8] }",
        32,
        &["table"],
    );
    refused(
        "stiffness = \"iso6336\"",
        "stiffness = { kind = \"compliance\", hertz = \"log\" }",
        32,
        &["`reference_load_n` is missing"],
    );
    refused(
        "stiffness = \"iso6336\"",
        "stiffness = { kind = \"compliance\", foundation = \"rigid\", root_length = \"2 rf theta\" }",
        32,
        &["does not belong"],
    );
    refused(
        "contact = { stiffness = \"iso6336\" }",
        "contact = [{ stiffness = \"iso6336\" }, { stiffness = \"iso6336\" }]",
        32,
        &["2 contacts for 1 meshes"],
    );
}

#[test]
fn impossible_models() {
    refused(
        "model = \"rigid\"",
        "model = \"rigit\"",
        27,
        &["did you mean `rigid`"],
    );
    refused(
        "model = \"rigid\"",
        "model = \"movable-teeth\"\nparameters = { tooth_stiffness_n_per_m = 5e8, tooth_mass_kg = 5e-3 }",
        32,
        &["two models have the label `movable-teeth`", "first here"],
    );
    refused(
        "model = \"rigid\"",
        "model = \"rigid\"\nlabel = \"a,b\"",
        28,
        &["without commas"],
    );
    refused(
        "model = \"rigid\"",
        "model = \"rigid\"\ngears = { weel = \"rigid\" }",
        28,
        &["there is no gear `weel`", "did you mean `wheel`"],
    );
    refused(
        "model = \"rigid\"",
        "model = \"rigid\"\nparameters = { tooth_mass_kg = 1.0 }",
        28,
        &["the model `rigid` has no parameter"],
    );
    refused(
        "tooth_mass_kg = 4.8e-3",
        "tooth_mass_kg = 1.0",
        33,
        &["`tooth_mass_kg`", "take an inertia of"],
    );
    refused(
        "tooth_mass_kg = 4.8e-3",
        "tooth_mass_kg = [1e-3, 2e-3]",
        33,
        &["2 values for 20 teeth"],
    );
    refused(
        "tooth_mass_kg = 4.8e-3",
        "tooth_mass_kg = -1.0",
        33,
        &["not positive"],
    );
    refused(
        "tooth_mass_kg = 4.8e-3",
        "tooth_mass_kg = \"light\"",
        33,
        &["expected a number"],
    );
    refused(
        "tooth_mass_kg = 4.8e-3",
        "tooth_mass_kg = 4.8e-3, integrate = \"some\"",
        33,
        &["\"active\" or \"all\""],
    );
    refused(
        "model = \"rigid\"",
        "model = \"rigid\"\ncalibration = \"impct\"",
        28,
        &["did you mean `impact`"],
    );
    refused(
        "model = \"rigid\"",
        "model = \"rigid\"\ncalibration = \"impact\"",
        28,
        &[
            "no calibration \"impact\" of `rigid` in scene `test`",
            "gearbench identify test --model rigid --write",
        ],
    );
    refused(
        "model = \"rigid\"",
        "model = \"rigid\"\ncalibration = { name = \"impact\", scene = \"spur_impact\", label = \"stiff\" }",
        28,
        &["there is one for `movable-teeth` or `rigid`"],
    );
    let text = changed(
        "model = \"rigid\"",
        "model = \"rigid\"\ncalibration = \"impact\"",
    );
    let file = super::SceneFile::parse("test.toml", &text, super::Origin::Shipped, false).unwrap();
    assert!(
        file.models[0]
            .calibration
            .as_ref()
            .unwrap()
            .constants
            .is_none()
    );
}

#[test]
fn impossible_studies() {
    refused(
        "method = \"dopri5\"",
        "method = \"dopri6\"",
        36,
        &["did you mean `dopri5`"],
    );
    refused(
        "method = \"dopri5\"",
        "method = \"newmark(rho=1)\"",
        36,
        &["no parameter `rho`"],
    );
    refused(
        "method = \"dopri5\"",
        "method = \"newmark(beta\"",
        36,
        &["closing bracket"],
    );
    refused(
        "rtol = 1e-6",
        "rtol = 0.0",
        36,
        &["more than 0 and less than 1"],
    );
    refused(
        "rtol = 1e-6",
        "rtol = 1e-6, step_s = 1e-6",
        36,
        &["both given"],
    );
    refused("step_s = 1e-6", "rtol = 1e-6", 36, &["rk4 has fixed steps"]);
    let free_flight = |text: &str, words: &[&str]| {
        refused(
            "method = \"rk4\"",
            &format!("method = \"{text}\""),
            36,
            words,
        );
    };
    free_flight(
        "rk4(free_flight=2)",
        &["free_flight = 2", "neither 0 nor 1"],
    );
    free_flight("trigonometric(free_flight=0)", &["always crosses flights"]);
    for share in ["1.0", "-1e-8", "\"never\""] {
        refused(
            "tooth_mass_kg = 4.8e-3",
            &format!("tooth_mass_kg = 4.8e-3, vibration_cut_off = {share}"),
            33,
            &["`vibration_cut_off`", "at least 0 and less than 1"],
        );
    }
    refused(
        "step_s = 1e-6",
        "step_s = -1e-6",
        36,
        &["expected more than 0"],
    );
    refused(
        "method = \"dopri5\", rtol",
        "method = \"bdf\", step_s",
        36,
        &["bdf chooses its steps"],
    );
    refused(
        "[study]",
        "[study]\nmodels = [\"rigd\"]",
        36,
        &["did you mean `rigid`"],
    );
    refused(
        "[study]",
        "[study]\nmodels = [\"rigid\", \"rigid\"]",
        36,
        &["stands twice"],
    );
    refused("[study]", "[study]\nmodels = []", 36, &["is empty"]);
    refused("[study]", "[study]\nsamples = 1", 36, &["2 to 1000000"]);
    refused(
        "[study]",
        "[study]\nquantities = [\"force\"]",
        36,
        &["`force_l2`"],
    );
    refused(
        "[study]",
        "[study]\nevents = 1",
        36,
        &["expected true or false"],
    );
    refused("case-a-fine", "case-b", 5, &["calculix/case-a-fine"]);
    refused("tolerance = 0.05", "tolerance = -1", 6, &["more than 0"]);
    refused(
        "tolerance = 0.05",
        "tolerance = { metric = \"force\", limit = 0.1 }",
        6,
        &["not known"],
    );
    refused("duration_s = 1e-4", "duration_s = 0", 4, &["not positive"]);
    refused("schema = 1", "schema = 2", 1, &["schema 2", "expected 1"]);
}
