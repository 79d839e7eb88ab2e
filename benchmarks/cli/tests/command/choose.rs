//! Tests of the command `gearbench choose`: its files, the chosen scene as input, and its refusals.

use super::{Folder, has, stdout};
use gearbench_reports::{Adequacy, ChoiceRecord, Part, Verdict};
use std::process::Output;

/// The choice of a record; reading it checks that levels, candidates and verdict follow from its numbers.
fn choice(folder: &Folder, name: &str) -> ChoiceRecord {
    let record = gearbench_reports::load_results(&folder.at(name)).unwrap();
    let Part::Choose(part) = record.part else {
        panic!("another study");
    };
    part.choice.validate().unwrap();
    part.choice
}

/// Asserts that the first line on the terminal, exit code, page, record and scene agree.
fn agrees(folder: &Folder, name: &str, out: &Output) -> ChoiceRecord {
    let said = choice(folder, name);
    let text = stdout(out);
    let first = text.lines().find(|l| l.contains(" within ")).unwrap();
    let page = folder.read(&format!("{name}/index.html"));
    let (line, finding, code) = match said.answer() {
        Verdict::Adequate => (
            said.choice().unwrap().level.clone(),
            "The cheapest that was tried",
            0,
        ),
        Verdict::NotDecided => ("not decided".into(), "<b>not decided</b>", 1),
        Verdict::NoneAdequate => (
            "nothing is adequate".into(),
            "<b>nothing that was tried is adequate</b>",
            1,
        ),
    };
    has(first, &[&line]);
    has(&page, &[finding]);
    assert_eq!(out.status.code(), Some(code));
    assert_eq!(
        folder.at(&format!("{name}/chosen.toml")).exists(),
        code == 0
    );
    let levels = folder.read(&format!("{name}/choose_levels.csv"));
    assert_eq!(
        levels
            .lines()
            .skip(1)
            .filter(|l| l.contains(said.answer().as_str()))
            .count(),
        said.levels.len()
    );
    said
}

/// Returns a scene with one impact of coarse gears, whose reduction takes a fraction of a second.
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
        table
            .lines()
            .filter(|l| l.contains(",adequate,true,"))
            .count(),
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
    let name = "out/small/choose";
    folder.says("choose small.toml --metric impulse --tolerance 0.05");
    assert!(folder.at("out/small/choose/chosen.toml").exists());
    // The yardstick itself is further off than that: nothing is decided, and the choice of before is gone.
    let out = folder.ends("choose small.toml --tolerance 1e-7", 1);
    let said = agrees(&folder, name, &out);
    assert_eq!(said.answer(), Verdict::NotDecided);
    let own = said.yardstick_error.unwrap();
    let parts = [
        said.top_error,
        said.yardstick_mesh_error,
        said.yardstick_integration_error,
    ];
    let sum: f64 = parts.map(Option::unwrap).iter().sum();
    assert!((own - said.growth.unwrap() * sum).abs() < 1e-12 * sum && own > 1e-7);
    assert!(said.levels.iter().all(|l| l.adequate != Adequacy::Adequate));
}

/// A wheel that a harmonic torque throws to and fro within its backlash: neighbouring histories part, so that no history is
/// judged, and the statistics of the force are listed.
#[test]
fn a_history_that_does_not_repeat_is_not_judged() {
    let folder = Folder::new();
    folder.write("rattle.toml", &rattle());
    let out = folder.ends(
        "choose rattle.toml --metric force --tolerance 0.3 --out o",
        1,
    );
    let said = agrees(&folder, "o", &out);
    assert_eq!(said.answer(), Verdict::NotDecided);
    assert!(said.yardstick_error.is_none() && said.tried.is_empty());
    has(
        said.not_repeatable.as_deref().unwrap(),
        &["1 % more stiffness"],
    );
    has(
        &stdout(&out),
        &["the history does not repeat", "more stiffness"],
    );
    has(
        &folder.read("o/index.html"),
        &["does not repeat", "Peak of a spell, median"],
    );
    for level in said.levels.iter().filter(|l| l.failure.is_none()) {
        assert_eq!(level.adequate, Adequacy::NotDecided);
        let forces = level.statistics.unwrap();
        assert!(forces.spells > 2 && forces.rms_n > 0.0, "{}", level.name);
        assert!(forces.median_peak_n <= forces.greatest_peak_n);
    }
    // Levels that cannot be judged are not refined further.
    assert!(said.levels.iter().all(|l| l.modes.is_none_or(|n| n <= 20)));
}

/// Set-up counts once for all runs that are planned: of one run the simplest adequate model is the cheapest, and a model that
/// cannot run is a row with its reason.
#[test]
fn set_up_is_distributed_over_the_runs_and_refused_models_are_rows() {
    let folder = Folder::new();
    let broken = "[[models]]\nlabel = \"broken\"\nmodel = \"movable-teeth\"\ncontact = { stiffness = \"iso6336\" }\n\
                  parameters = { tooth_stiffness_n_per_m = 1e8 }\n\n[[meshes]]";
    folder.write("small.toml", &scene("1e-6").replace("[[meshes]]", broken));
    let of = |runs: u64| {
        let name = format!("o{runs}");
        let command = format!(
            "choose small.toml --metric impulse --tolerance 0.3 --runs {runs} --out {name}"
        );
        let out = folder.ends(&command, 0);
        let said = agrees(&folder, &name, &out);
        assert_eq!(said.runs, runs);
        let total = said.setup_s.unwrap() + runs as f64 * said.predicted_cost_s.unwrap();
        assert!((said.total_cost_s.unwrap() - total).abs() < 1e-9 * total);
        let of_level = |l: &gearbench_reports::LevelRecord| {
            let cost = said.tried[l.cheapest?].cost_s?;
            Some(l.setup_s? + runs as f64 * cost)
        };
        // The simplest of those that cost the least within a tenth.
        let totals: Vec<Option<f64>> = said.levels.iter().map(of_level).collect();
        let least = totals
            .iter()
            .flatten()
            .fold(f64::INFINITY, |a, b| a.min(*b));
        let same = |t: &Option<f64>| t.is_some_and(|t| t <= 1.1 * least);
        let simplest = totals.iter().position(same).unwrap();
        assert_eq!(said.levels[simplest].cheapest, said.chosen);
        said
    };
    let one = of(1);
    assert_eq!(one.choice().unwrap().family, "rigid");
    of(1_000_000);

    // Movable teeth are tried where rigid gears are not adequate.
    let out = folder.ends("choose small.toml --tolerance 1e-7 --out r", 1);
    let said = agrees(&folder, "r", &out);
    let refused = said.levels.iter().find(|l| l.name.contains("broken"));
    let refused = refused.unwrap();
    assert_eq!(
        (refused.adequate, refused.error),
        (Adequacy::NotAdequate, None)
    );
    has(
        refused.failure.as_deref().unwrap(),
        &["refused", "tooth_mass_kg"],
    );
}

/// Returns a scene of small gears with a fixed pinion and an oscillating wheel.
fn rattle() -> String {
    let still = scene("1e-6")
        .replace("duration_s = 1.2e-4", "duration_s = 1e-2")
        .replace("speed_rad_s = 20.0", "mount = \"fixed\"");
    let shaken = "bore_radius_m = 0.01\n\
                  loads = [{ harmonic = { mean_nm = 0.3, amplitude_nm = 3.0, frequency_hz = 800.0 } }]\n";
    still.replacen("bore_radius_m = 0.01\n", shaken, 1)
}

#[test]
fn bad_requirements_and_scenes_are_refused() {
    let folder = Folder::new();
    folder.write("apart.toml", &scene("7e-5"));
    folder.refuses("choose apart.toml", &["no teeth touch"]);
    folder.refuses("choose spur_impact --metric velocity", &["force-aligned"]);
    folder.refuses("choose spur_impact --tolerance 0", &["between 0 and 1"]);
    folder.refuses("choose nowhere", &["there is no scene `nowhere`"]);
    assert!(!folder.at("out").exists());
    // The way out is one of `choose` and of the scene, not another integrator.
    let free = "bearing = { stiffness = [1e8, 1e8, 5e7, 1e5, 1e5, 0.0] }\nspin_terms = \"on\"\nspeed_rad_s";
    folder.write(
        "spins.toml",
        &scene("1e-6").replacen("speed_rad_s", free, 1),
    );
    folder.refuses(
        "choose spins.toml",
        &[
            "gyroscopic terms",
            "`spin_terms = \"off\"`",
            "--yardstick refined",
        ],
    );
}

/// The choice is compared with every reference of the scene, at the speeds and loads of each; a reference outside of
/// the tolerance overrides the estimate.
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
    assert_eq!(choice(&folder, "o").references.len(), 2);
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

    // With the reference force increased by half the choice is not adequate, whatever the comparison between models
    // gives.
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
        &[
            "not decided, `own` contradicts the yardstick",
            "the choice against own: ",
            "beyond the 20",
            "not adequate",
        ],
    );
    let said = agrees(&folder, "p", &out);
    let own = &said.references[0];
    assert!(own.choice.unwrap() > 0.2 && own.yardstick.unwrap() > 0.2);

    // By default only the yardstick is compared with the scene's reference. The result is reported and does not change
    // the choice.
    let out = folder.ends(
        "choose small.toml --metric impulse --tolerance 0.2 --out q",
        0,
    );
    let said = agrees(&folder, "q", &out);
    assert_eq!(said.references.len(), 1);
    assert!(said.references[0].choice.is_none());
    has(
        &stdout(&out),
        &["the yardstick against own", "another yardstick"],
    );
    has(
        &folder.read("q/index.html"),
        &["the scene has the reference <b>own</b>"],
    );
}
