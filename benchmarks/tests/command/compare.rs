//! `gearbench compare`: what it writes, what it refuses.

use super::{Folder, has, stdout};
use gearbench_reports::record::Results;

/// Writes a report, quietly.
fn reports(arguments: &str) {
    let folder = Folder::new();
    let out = folder.ends(arguments, 0);
    let read = || folder.read("out/spur_impact/compare/index.html");
    let page = read();
    has(&page, &["movable-teeth", "CalculiX"]);
    for far in ["src=\"http", "href=\"http", "url(http"] {
        assert!(!page.contains(far), "{far}");
    }
    has(&stdout(&out), &["index.html", "results.json"]);
    assert!(out.stderr.is_empty(), "quiet without a terminal: {out:?}");

    // Drawn again from the record alone, the page is the same to the byte.
    folder.says("report out/spur_impact/compare");
    assert_eq!(page, read());
}

#[test]
fn a_comparison_writes_its_report() {
    reports("compare spur_impact --models rigid,movable-teeth");
}

#[test]
#[ignore = "a quarter of a minute of finite elements: cargo test --release -p gearbench --test command -- --ignored"]
fn the_bare_command_writes_the_default_report() {
    reports("");
}

/// The record of a model of the impact under some integrators, each run once.
fn compared(models: &str, integrators: &str, code: i32) -> Results {
    let folder = Folder::new();
    let of = format!("--models {models} --integrators {integrators}");
    folder.ends(
        &format!("compare spur_impact {of} --out here --repeats 1"),
        code,
    );
    gearbench_reports::load_results(&folder.at("here")).unwrap()
}

#[test]
fn integrators_and_models_can_be_chosen() {
    let record = compared(
        "rigid",
        "generalised-alpha(rho_inf=0.5)@1e-6,dopri5@1e-8",
        0,
    );
    let runs = record.runs.iter();
    let runs: Vec<_> = runs
        .map(|r| (r.integrator.as_str(), r.step, r.rtol))
        .collect();
    let expected = [
        ("generalised-alpha(rho_inf=0.5)", Some(1e-6), None),
        ("dopri5", None, Some(1e-8)),
    ];
    assert_eq!(runs, expected);
    has(&record.header.command, &["--models rigid"]);
}

#[test]
fn a_run_that_fails_is_a_row_and_an_exit_code() {
    // Ten times the stable step of a tooth.
    let record = compared("movable-teeth", "velocity-verlet@5e-5,dopri5", 3);
    let [failed, sound] = record.runs.as_slice() else {
        panic!("{} runs", record.runs.len())
    };
    assert!(failed.status.is_failure() && !sound.status.is_failure());
    let message = failed.message.as_ref();
    assert!(
        message.is_some_and(|m| m.contains("t = ") || m.contains("overlap")),
        "{failed:?}"
    );
}

#[test]
fn bad_input_is_refused_and_nothing_is_written() {
    let folder = Folder::new();
    let cases: [(&str, &[&str]); 7] = [
        ("compare spur_impct", &["there is no scene", "spur_impact"]),
        (
            "compare spur_impact --models rigd",
            &["no model `rigd`", "rigid"],
        ),
        (
            "compare spur_impact --models rigid --integrators rk5",
            &["no integrator `rk5`", "rk4"],
        ),
        (
            "compare spur_impact --models rigid --integrators newmark(beta=7)",
            &["beta = 7 lies outside"],
        ),
        ("compare nowhere.toml", &["nowhere.toml"]),
        ("identify hammer --model rigid", &["no reference"]),
        ("report nowhere", &["nowhere"]),
    ];
    for (arguments, words) in cases {
        folder.refuses(arguments, words);
        assert_eq!(folder.files(), 0, "{arguments} wrote something");
    }
}

#[test]
fn a_scene_of_ones_own_is_refused_with_its_line() {
    let folder = Folder::new();
    let shipped = include_str!("../../scenes/hammer.toml");
    let wrong = shipped.replacen("module_m = 0.004", "module_mm = 4.0", 1);
    let line = wrong.lines().position(|l| l.starts_with("module_mm"));
    folder.write("mine.toml", &wrong);
    let at = format!("mine.toml:{}", line.unwrap() + 1);
    folder.refuses("compare mine.toml", &[&at, "module_mm", "module_m"]);
    assert!(!folder.at("out").exists());
}
