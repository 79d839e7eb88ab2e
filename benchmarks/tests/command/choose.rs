//! `gearbench choose`: what it writes, that its answer runs, what it refuses.

use super::{Folder, has, stdout};

/// One impact of coarse gears: their reduction takes a fraction of a second.
fn scene(gap: &str) -> String {
    format!(
        "schema = 1\nname = \"small\"\nduration_s = 1.2e-4\ntolerance = {{ limit = 0.1, against = \"model\" }}\n\n\
         # Two gears\n[gears.a]\nteeth = 18\nmodule_m = 0.002\nface_width_m = 0.006\nbore_radius_m = 0.007\n\
         speed_rad_s = 20.0\n\n[gears.b]\nteeth = 24\nmodule_m = 0.002\nface_width_m = 0.006\nbore_radius_m = 0.01\n\n\
         [[models]]\nmodel = \"rigid\"\ncontact = {{ stiffness = \"iso6336\" }}\n\n\
         [[models]]\nmodel = \"elastic\"\nparameters = {{ flank_elements = 4, fillet_elements = 2, across_elements = 6, \
         rim_elements = 2, width_elements = 1, modes = 30 }}\ncontact = {{ penalty_pa_per_m = 2e15 }}\n\
         integrators = [{{ method = \"trigonometric\", step_s = 1e-6 }}]\n\n\
         [[meshes]]\ngears = [\"a\", \"b\"]\nbacklash_m = 80e-6\nstart = {{ flank = \"left\", gap_m = {gap} }}\n\n\
         [study]\nmodels = [\"rigid\"]\nreference_model = \"rigid\"\nsamples = 400\n"
    )
}

#[test]
fn a_choice_is_written_and_runs() {
    let folder = Folder::new();
    folder.write("small.toml", &scene("1e-6"));
    let said = folder.says("choose small.toml --metric impulse --tolerance 0.05 --out o");
    has(&said, &["predicted error"]);
    let page = folder.read("o/index.html");
    has(&page, &["The hierarchy of models", "<svg"]);
    let table = folder.read("o/choose.csv");
    assert_eq!(
        table.lines().filter(|l| l.contains(",true,true,")).count(),
        1
    );
    let chosen = folder.read("o/chosen.toml");
    assert_eq!(chosen.matches("[[models]]").count(), 1, "{chosen}");
    assert!(
        chosen.contains("# Two gears") && !chosen.contains("tolerance ="),
        "{chosen}"
    );

    // The page follows from the record alone.
    folder.says("report o");
    assert_eq!(page, folder.read("o/index.html"));

    // The choice runs as it stands, and nothing is left of the numbers of another scene.
    folder.says("compare o/chosen.toml --repeats 1 --out r");
    has(&folder.read("r/results.json"), &["\"variant\": \"chosen\""]);
}

#[test]
fn what_cannot_be_kept_is_said() {
    let folder = Folder::new();
    folder.write("small.toml", &scene("1e-6"));
    let out = folder.ends("choose small.toml --tolerance 1e-7", 1);
    has(&stdout(&out), &["nothing is adequate"]);
    assert!(!folder.at("out/small/choose/chosen.toml").exists());
    assert!(folder.at("out/small/choose/index.html").exists());
}

#[test]
fn bad_requirements_and_scenes_are_refused() {
    let folder = Folder::new();
    folder.write("apart.toml", &scene("7e-5"));
    folder.refuses("choose apart.toml", &["no teeth touch"]);
    folder.refuses("choose spur_impact --metric speed", &["force-aligned"]);
    folder.refuses("choose spur_impact --tolerance 0", &["between 0 and 1"]);
    folder.refuses("choose nowhere", &["there is no scene `nowhere`"]);
    assert!(!folder.at("out").exists());
}

/// What was chosen is held against every reference of the scene, at the speeds and loads of each; one that says otherwise has
/// the last word.
#[test]
fn a_choice_is_held_against_references() {
    let folder = Folder::new();
    let plain = scene("1e-6");
    folder.write("small.toml", &plain);
    folder.refuses(
        "choose small.toml --references --out o",
        &["has no reference", "[[references]]"],
    );
    // Made by the chosen kind of model, so that the choice is near it; at another speed under conditions of its own.
    let make = "reference small.toml --model elastic --method trigonometric@5e-7s";
    folder.says(&format!("{make} --out own.csv --add"));
    folder.says(&format!(
        "{make} --speed a=40 --duration 8e-5 --out fast.csv --add"
    ));
    let with = folder.read("small.toml");
    let choose = "choose small.toml --metric impulse --tolerance 0.2 --references";
    let said = folder.says(&format!("{choose} --out o"));
    has(
        &said,
        &[
            "the choice against own: ",
            "the choice against fast (at its own speeds and loads): ",
            "so the impulse is within the 20",
        ],
    );
    let record = gearbench_reports::load_results(&folder.at("o")).unwrap();
    let settings: Vec<_> = (record.settings.iter())
        .filter(|(what, _)| what.starts_with("the choice against"))
        .collect();
    assert_eq!(settings.len(), 2);
    for (_, found) in &settings {
        has(
            found,
            &[
                "impulse error",
                "rebound error",
                "angle error",
                "torque error",
            ],
        );
    }
    has(&folder.read("o/index.html"), &["the choice against fast"]);

    // The same with a force half as large again: the choice is not adequate, whatever models say among each other.
    let mut table = String::new();
    for line in folder.read("own.csv").lines() {
        let cells: Vec<&str> = line.split(',').collect();
        match cells.get(1).and_then(|c| c.parse::<f64>().ok()) {
            Some(force) => table.push_str(&format!("{},{:e}\n", cells[0], 1.5 * force)),
            None if line.starts_with('#') => table.push_str(&format!("{line}\n")),
            None => table.push_str("time_s,contact_force_n\n"),
        }
    }
    folder.write("own.csv", &table);
    folder.write("small.toml", &with);
    let out = folder.ends(&format!("{choose} --out p"), 1);
    has(
        &stdout(&out),
        &["the choice against own: ", "beyond the 20", "not adequate"],
    );
}
