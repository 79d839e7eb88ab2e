//! `gearbench choose`: what it writes, that its answer runs, what it refuses.

use super::{Folder, gearbench};
use std::process::Output;

fn told(o: &Output) -> String {
    format!(
        "{}{}",
        String::from_utf8_lossy(&o.stdout),
        String::from_utf8_lossy(&o.stderr)
    )
}

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
    std::fs::write(folder.at("small.toml"), scene("1e-6")).unwrap();
    let out = gearbench(
        folder.path(),
        &[
            "choose",
            "small.toml",
            "--metric",
            "impulse",
            "--tolerance",
            "0.05",
            "--out",
            "o",
        ],
    );
    assert_eq!(out.status.code(), Some(0), "{}", told(&out));
    let said = told(&out);
    assert!(said.contains("predicted error"), "{said}");
    let read = |name: &str| std::fs::read_to_string(folder.at("o").join(name)).unwrap();
    let page = read("index.html");
    assert!(page.contains("The hierarchy of models") && page.contains("<svg"));
    assert!(
        read("choose.csv")
            .lines()
            .filter(|l| l.contains(",true,true,"))
            .count()
            == 1
    );
    let chosen = read("chosen.toml");
    assert_eq!(chosen.matches("[[models]]").count(), 1, "{chosen}");
    assert!(
        chosen.contains("# Two gears") && !chosen.contains("tolerance ="),
        "{chosen}"
    );

    // The page follows from the record alone.
    assert_eq!(
        gearbench(folder.path(), &["report", "o"]).status.code(),
        Some(0)
    );
    assert_eq!(page, read("index.html"));

    // The choice runs as it stands, and nothing is left of the numbers of another scene.
    let run = gearbench(
        folder.path(),
        &["compare", "o/chosen.toml", "--repeats", "1", "--out", "r"],
    );
    assert_eq!(run.status.code(), Some(0), "{}", told(&run));
    let record = std::fs::read_to_string(folder.at("r/results.json")).unwrap();
    assert!(record.contains("\"variant\": \"chosen\""), "{record}");
}

#[test]
fn what_cannot_be_kept_is_said() {
    let folder = Folder::new();
    std::fs::write(folder.at("small.toml"), scene("1e-6")).unwrap();
    let out = gearbench(
        folder.path(),
        &["choose", "small.toml", "--tolerance", "1e-7"],
    );
    assert_eq!(out.status.code(), Some(1), "{}", told(&out));
    assert!(told(&out).contains("nothing is adequate"), "{}", told(&out));
    assert!(!folder.at("out/small/choose/chosen.toml").exists());
    assert!(folder.at("out/small/choose/index.html").exists());
}

#[test]
fn bad_wishes_and_scenes_are_refused() {
    let folder = Folder::new();
    std::fs::write(folder.at("apart.toml"), scene("7e-5")).unwrap();
    for (arguments, says) in [
        (&["choose", "apart.toml"][..], "no teeth touch"),
        (
            &["choose", "spur_impact", "--metric", "speed"],
            "force-aligned",
        ),
        (
            &["choose", "spur_impact", "--tolerance", "0"],
            "between 0 and 1",
        ),
        (&["choose", "nowhere"], "there is no scene `nowhere`"),
    ] {
        let out = gearbench(folder.path(), arguments);
        assert_eq!(out.status.code(), Some(2), "{}", told(&out));
        assert!(told(&out).contains(says), "{}", told(&out));
    }
    assert!(!folder.at("out").exists());
}
