//! `gearbench identify`: constants of single gears and along the path, written into a calibration or into the scene.

use super::{Folder, as_documented, has};

/// The shipped impact as a file of one's own, with comments where constants will go, and a tolerance that decides.
fn own(folder: &Folder) -> String {
    let scene = include_str!("../../scenes/spur_impact.toml").replacen(
        "calibration = \"impact\"",
        "# as fitted\ncalibration = \"impact\" # to one blow",
        1,
    );
    let scene = scene.replacen("limit = 0.05", "limit = 0.2", 1);
    folder.write("own.toml", &scene);
    folder.write(
        "own.calibration.toml",
        include_str!("../../calibrations/spur_impact.toml"),
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
    // Every other line stands as it stood.
    let lines: Vec<&str> = after.lines().collect();
    let gone: Vec<&str> = before.lines().filter(|l| !lines.contains(l)).collect();
    assert!(
        gone.len() <= 2
            && gone
                .iter()
                .all(|l| l.contains("contact") || l.contains("calibration")),
        "{gone:?}"
    );

    // It runs, and meets the reference as well as the fit says.
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

/// A model whose runs fail takes no other with it: teeth this light vibrate so fast that no trial reaches the end.
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
