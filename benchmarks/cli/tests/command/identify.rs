//! Tests of the command `gearbench identify`: constants of single gears and along the path, written into a calibration
//! or into the scene.

use super::{Folder, as_documented, has};

/// The shipped impact as a file of one's own, with comments where constants will go, and a tolerance that decides.
fn own(folder: &Folder) -> String {
    let scene = include_str!("../../../scenes/spur_impact.toml").replacen(
        "calibration = \"impact\"",
        "# as fitted\ncalibration = \"impact\" # to one blow",
        1,
    );
    let scene = scene.replacen("limit = 0.05", "limit = 0.2", 1);
    folder.write("own.toml", &scene);
    folder.write(
        "own.calibration.toml",
        include_str!("../../../calibrations/spur_impact.toml"),
    );
    scene
}

/// The first run of a record.
fn run_of(folder: &Folder, record: &str) -> serde_json::Value {
    let record: serde_json::Value = serde_json::from_str(&folder.read(record)).unwrap();
    record["runs"][0].clone()
}

#[test]
fn constants_go_into_the_scene_with_comments_kept() {
    let folder = Folder::new();
    let before = own(&folder);
    let fit = "identify own.toml --model rigid --fit stiffness_n_per_m2 --hold gap_m=2.9e-6,path_slope=0.1 --out fit";
    let said = folder.says(&format!("{fit} --write=scene"));
    has(
        &said,
        &["written:", "own.toml", "stiffness slope along the path"],
    );
    as_documented(&folder.at("fit"));
    let after = folder.read("own.toml");
    let comments = |text: &str| -> Vec<String> {
        let of = |l: &str| Some(l[l.find('#')?..].to_owned());
        text.lines().filter_map(of).collect()
    };
    for comment in comments(&before) {
        assert!(after.contains(&comment), "{comment}\n{after}");
    }
    let of_fit = |text: &str| text.matches("# identified, rigid: ").count();
    assert_eq!(of_fit(&after), 3, "{after}");
    has(
        &after,
        &[
            "written by gearbench identify own.toml --model rigid",
            "fitted to calculix/case-a-graded (data ",
            "kind = \"parabola\"",
            "gap_m = 2.9e-6\n",
        ],
    );
    // All other lines are unchanged.
    let lines: Vec<&str> = after.lines().collect();
    let gone: Vec<&str> = before.lines().filter(|l| !lines.contains(l)).collect();
    assert!(
        gone.len() <= 2
            && gone
                .iter()
                .all(|l| l.contains("contact") || l.contains("calibration")),
        "{gone:?}"
    );

    // The scene runs, and its error against the reference equals that of the fit.
    folder.says("compare own.toml --models rigid --integrators dopri5 --repeats 1 --out run");
    let found: serde_json::Value = serde_json::from_str(&folder.read("fit/results.json")).unwrap();
    let fitted = found["fits"][0]["data"][0]["l2"].as_f64().unwrap();
    let run = run_of(&folder, "run/results.json");
    let run = run["metrics"][0]["force_l2"].as_f64().unwrap();
    assert!((run / fitted - 1.0).abs() < 0.02, "{run} {fitted}");

    // Written again nothing is doubled; a model without a calibration is fitted when it is asked for.
    folder.says(&format!("{fit} --write=scene"));
    assert_eq!(of_fit(&folder.read("own.toml")), 3);
    folder.refuses(&format!("{fit} --write=nowhere"), &["calibration, scene"]);
}

#[test]
fn constants_of_single_gears_go_into_a_calibration_that_is_read() {
    let folder = Folder::new();
    own(&folder);
    let held = "stiffness_n_per_m2=2.48e10,tooth_stiffness_n_per_m=7.27e8,gap_m=2.02e-6";
    let fit = format!(
        "identify own.toml --model movable-teeth --fit tooth_mass_kg --hold {held},wheel.tooth_mass_kg=6e-3 --out fit"
    );
    folder.says(&format!("{fit} --write"));
    has(
        &folder.read("own.calibration.toml"),
        &[
            "[impact.movable-teeth]",
            "\nwheel.tooth_mass_kg = 6e-3\n",
            "\ntooth_mass_kg = ",
        ],
    );
    let run = "compare own.toml --models movable-teeth --integrators dopri5 --repeats 1 --out run";
    folder.says(run);
    let parameters = &run_of(&folder, "run/results.json")["parameters"];
    let masses = ["pinion", "wheel"].map(|g| parameters[g]["tooth_mass_kg"].as_f64());
    assert_eq!(masses[1], Some(6e-3));
    assert_ne!(masses[0], masses[1]);
    // A gear that the scene has not.
    let other = folder
        .read("own.calibration.toml")
        .replace("wheel.tooth", "whel.tooth");
    folder.write("own.calibration.toml", &other);
    folder.refuses(run, &["gear `whel`", "did you mean `wheel`"]);
    folder.write(
        "own.calibration.toml",
        &other.replace("whel.tooth", "wheel.tooth"),
    );

    // The same in the scene: the gear then has an entry of its own with all its parameters.
    folder.says(&format!("{fit} --write=scene"));
    has(
        &folder.read("own.toml"),
        &["gears = { wheel = { model = \"movable-teeth\", parameters = {"],
    );
    folder.says(run);
    let parameters = &run_of(&folder, "run/results.json")["parameters"];
    let masses = ["pinion", "wheel"].map(|g| parameters[g]["tooth_mass_kg"].as_f64());
    assert_eq!(masses[1], Some(6e-3));
    assert_ne!(masses[0], masses[1]);
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let folder = Folder::new();
    for (arguments, words) in [
        (
            "--model rigid --fit pinion.tooth_mass_kg",
            &["gears of the model `rigid` have no constants"][..],
        ),
        (
            "--model movable-teeth --fit pinon.tooth_mass_kg",
            &["does not belong to a gear of the model", "pinion, wheel"],
        ),
        (
            "--weight other=2",
            &["`other` has a weight", "calculix/case-a-graded"],
        ),
        ("--weight other=-2", &["NAME=WEIGHT"]),
    ] {
        folder.refuses(&format!("identify spur_impact {arguments}"), words);
    }
}

/// A model whose runs fail does not stop the others: teeth this light vibrate so fast that no trial reaches the end.
#[test]
fn a_model_that_cannot_be_fitted_is_a_row_and_the_others_are_fitted() {
    let folder = Folder::new();
    let light = "parameters = { tooth_stiffness_n_per_m = 5.3e8, tooth_mass_kg = 1e-9 }";
    let movable = "model = \"movable-teeth\"";
    let scene = own(&folder).replacen(movable, &format!("{movable}\n{light}"), 1);
    folder.write("own.toml", &scene);
    let fit = "identify own.toml --fit stiffness_n_per_m2 --starts 1 --out fit";
    let out = folder.ends(fit, 3);
    has(
        &super::stderr(&out),
        &["`movable-teeth` is not fitted", "from every start"],
    );
    let record: serde_json::Value = serde_json::from_str(&folder.read("fit/results.json")).unwrap();
    let fits = record["fits"].as_array().unwrap();
    assert_eq!((fits.len(), &fits[0]["label"]), (1, &"rigid".into()));
    let row = run_of(&folder, "fit/results.json");
    assert_eq!(row["model"], "movable-teeth");
    assert_eq!(row["status"], "refused");
    // Alone it is the failure of the study.
    let alone = folder.ends(
        &fit.replace("--fit", "--model movable-teeth --fit")
            .replace("--out fit", "--out alone"),
        3,
    );
    has(&super::stderr(&alone), &["the fit failed from every start"]);
    assert!(!folder.at("alone/results.json").exists());
}

/// A fit of one constant of one model leaves the other stored constants and the other models as they are, also where the
/// scene file has them itself.
#[test]
fn constants_that_are_not_fitted_stay_stored() {
    let folder = Folder::new();
    let scene =
        include_str!("../../../scenes/spur_impact.toml").replacen("limit = 0.05", "limit = 0.2", 1);
    let model = "model = \"movable-teeth\"\n";
    let mass = "parameters = { tooth_mass_kg = 5e-3 }\n";
    let scene = scene.replacen(model, &format!("{model}{mass}"), 1);
    let stored = "\n[calibration.impact.rigid]\nstiffness_n_per_m2 = 1.4e10\n\n[calibration.impact.movable-teeth]\n\
                  stiffness_n_per_m2 = 2.5e10\ntooth_stiffness_n_per_m = 8e8\ntooth_mass_kg = 6e-3\n";
    folder.write("own.toml", &(scene + stored));
    folder.says(
        "identify own.toml --model movable-teeth --fit stiffness_n_per_m2 --hold tooth_stiffness_n_per_m=8e8,gap_m=2e-6 \
         --out fit --write",
    );
    let written = folder.read("own.calibration.toml");
    has(
        &written,
        &["tooth_mass_kg = 6e-3", "[impact.movable-teeth]"],
    );
    let run = |model: &str| {
        let integrators = "--integrators dopri5@1e-4 --repeats 1";
        folder.says(&format!(
            "compare own.toml --models {model} {integrators} --out {model}"
        ));
        run_of(&folder, &format!("{model}/results.json"))
    };
    let teeth = run("movable-teeth");
    let mass = &teeth["parameters"]["pinion"]["tooth_mass_kg"];
    assert_eq!(mass.as_f64(), Some(6e-3));
    let rigid = run("rigid");
    let stiffness = &rigid["parameters"]["contact pinion - wheel"]["stiffness_n_per_m2"];
    assert_eq!(stiffness.as_f64(), Some(1.4e10));
    // Constants that were typed in are not called fitted to the reference.
    let own = &teeth["metrics"][0]["against"];
    assert!(own.is_string() && teeth["fitted_to"] == *own, "{teeth}");
    assert!(rigid["fitted_to"].is_null(), "{rigid}");
}

/// A parameter of some models is fixed in these; one that no model has is refused.
#[test]
fn held_parameters_apply_where_they_exist() {
    let folder = Folder::new();
    own(&folder);
    let fit = "identify own.toml --fit stiffness_n_per_m2 --out fit";
    let held = "gap_m=2e-6,tooth_stiffness_n_per_m=8e8,tooth_mass_kg=5e-3";
    let said = folder.says(&format!("{fit} --hold {held}"));
    for key in ["tooth_stiffness_n_per_m", "tooth_mass_kg"] {
        has(&said, &[&format!("--hold {key} does not apply to `rigid`")]);
    }
    assert!(!said.contains("--hold gap_m"), "{said}");
    let record: serde_json::Value = serde_json::from_str(&folder.read("fit/results.json")).unwrap();
    let keys = |fit: usize| -> Vec<&str> {
        let all = record["fits"][fit]["parameters"].as_array().unwrap();
        all.iter().filter_map(|p| p["key"].as_str()).collect()
    };
    let mut both = [keys(0), keys(1)];
    both.sort_by_key(Vec::len);
    assert_eq!(both[0], ["stiffness_n_per_m2", "gap_m"]);
    assert_eq!(both[1].len(), 4, "{both:?}");
    folder.refuses(
        &format!("{fit} --hold tooth_mas_kg=1 --fresh"),
        &["tooth_mas_kg"],
    );
}

/// Measured histories of a rig: the force is fitted as the scene's reference, and the transmission error over the mesh cycle,
/// which no fit has seen, is compared with the model as it was and as it was identified.
#[test]
fn measured_histories_are_fitted_and_compared() {
    let folder = Folder::new();
    let rig = "name = \"rig\"\nduration_s = 2e-4\n[gears.pinion]\nteeth = 20\nmodule_m = 0.004\nface_width_m = 0.01\n\
               speed_rad_s = 20.0\n[gears.wheel]\nteeth = 30\nmodule_m = 0.004\nface_width_m = 0.01\nspeed_rad_s = -12.0\n[[meshes]]\n\
               gears = [\"pinion\", \"wheel\"]\ncentre_distance_m = 0.1001\nstart = { flank = \"left\", gap_m = 1e-6 }\n[[models]]\n\
               model = \"rigid\"\ncontact = { stiffness = { kind = \"constant\", stiffness_n_per_m2 = 1.3e10 } }\n";
    folder.write("rig.toml", &format!("schema = 1\n{rig}"));
    folder.says("reference rig.toml --model rigid --method dopri5@1e-9 --out whole.csv");
    let whole = folder.read("whole.csv");
    let lines: Vec<&str> = whole.lines().filter(|l| !l.starts_with('#')).collect();
    let names: Vec<&str> = lines[0].split(',').collect();
    let write = |file: &str, columns: &[(&str, &str, f64)]| {
        let head: Vec<&str> = columns.iter().map(|c| c.1).collect();
        let mut text = head.join(",") + "\n";
        for line in &lines[1..] {
            let cells: Vec<&str> = line.split(',').collect();
            let value = |name: &str| -> f64 {
                let at = names.iter().position(|n| *n == name).unwrap();
                cells[at].parse().unwrap()
            };
            let row = columns
                .iter()
                .map(|(of, _, factor)| (value(of) * factor).to_string());
            text += &(row.collect::<Vec<_>>().join(",") + "\n");
        }
        folder.write(file, &text);
    };
    write(
        "force.csv",
        &[
            ("time_s", "time [ms]", 1e3),
            ("contact_force_pinion_wheel_n", "contact_force [kN]", 1e-3),
        ],
    );
    let cycles = 20.0 / std::f64::consts::TAU;
    let error = (
        "transmission_error_pinion_wheel_m",
        "transmission error [um]",
        1e6,
    );
    write(
        "cycle.csv",
        &[("hub_angle_pinion_rad", "mesh_cycle", cycles), error],
    );
    let fitted = rig.replacen(
        "[gears.pinion]",
        "reference = \"force.csv\"\n[gears.pinion]",
        1,
    );
    folder.write("rig.toml", &format!("schema = 1\n{fitted}"));
    let fit = "identify rig.toml --model rigid --fit stiffness_n_per_m2 --hold gap_m=1e-6";
    let said = folder.says(&format!(
        "{fit} --measured cycle.csv --measured force.csv --out fit"
    ));
    as_documented(&folder.at("fit"));
    let off = |constants: &str| -> f64 {
        let line = said.lines().find(|l| {
            l.contains("transmission error over mesh cycle, rigid, ") && l.contains(constants)
        });
        let line = line.unwrap_or_else(|| panic!("{constants} is missing in {said}"));
        let (_, rest) = line.rsplit_once(": ").unwrap();
        let number = rest.split(['\u{a0}', ' ']).next().unwrap();
        let number = number.replace('\u{2212}', "-");
        number.parse().unwrap_or_else(|_| panic!("{line}"))
    };
    assert!(off("initial") > 1.0 && off("identified") < 0.1, "{said}");
    has(
        &folder.read("fit/index.html"),
        &[
            "Measured curves",
            "rigid, initial",
            "rigid, identified",
            "cycle.csv",
        ],
    );
    let table = folder.read("fit/identify_histories.csv");
    has(
        &table,
        &["model,constants,time_s", "rigid,identified,", "mesh_cycle"],
    );
    // Without measured curves no run is made for them.
    folder.says(&format!("{fit} --out plain"));
    assert!(!folder.at("plain/identify_histories.csv").exists());
}
