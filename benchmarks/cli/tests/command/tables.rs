//! Studies whose results are one table: rows, page, terminal, failures, repetition.

use super::{Folder, as_documented, has, stdout};
use serde_json::Value;

/// Cost of every run: what a step and a second cost follows from the times and counts of the run.
#[test]
fn costs_follow_from_the_runs() {
    let folder = Folder::new();
    let study = "cost spur_impact --models rigid,movable-teeth --integrators rk4@1us,dopri5@1e-6 --simulate 10 --repeats 1";
    let said = folder.says(&format!("{study} --out here"));
    has(
        &said,
        &[
            "Time over simulated time",
            "movable-teeth",
            "10 s of this scene take",
            "record:",
        ],
    );
    as_documented(&folder.at("here"));
    let record: Value = serde_json::from_str(&folder.read("here/results.json")).unwrap();
    let rows = record["rows"].as_array().unwrap();
    let runs = record["runs"].as_array().unwrap();
    assert_eq!((rows.len(), runs.len()), (4, 4));
    for (row, run) in rows.iter().zip(runs) {
        let [of_row, of_run] = [row, run].map(|x| move |key: &str| x[key].as_f64().unwrap());
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{a} {b} of {row}");
        near(of_row("cpu_s"), of_run("cpu_s"));
        near(of_row("cpu_per_step_s"), of_run("cpu_s") / of_run("steps"));
        near(
            of_row("cpu_per_evaluation_s"),
            of_run("cpu_s") / of_run("force_evaluations"),
        );
        near(
            of_row("estimate_s"),
            10.0 * of_run("cpu_s") / of_run("simulated_s"),
        );
        assert_eq!(
            (row["model"].clone(), row["steps"].clone()),
            (run["model"].clone(), run["steps"].clone())
        );
    }
    let page = folder.read("here/index.html");
    has(
        &page,
        &[
            "gearbench \u{b7} cost",
            "Cost over the number of coordinates",
        ],
    );
    assert_eq!(folder.read("here/cost.csv"), folder.read("here/runs.csv"));
    // Times differ, and nothing else does.
    has(&folder.says("rerun here --out again"), &["the same: all"]);
    folder.refuses(
        "cost spur_impact --simulate=-1",
        &["positive number of seconds"],
    );
    folder.refuses("cost spur_impact --models stiff", &["stiff", "rigid"]);
}

/// A run that fails is a row with its reason, and the exit code says so.
#[test]
fn failed_runs_are_rows() {
    let folder = Folder::new();
    let out = folder.ends(
        "cost spur_impact --models rigid,movable-teeth --integrators dopri5@1e-6,semi-implicit-euler@100us --repeats 1 --out here",
        3,
    );
    let record: Value = serde_json::from_str(&folder.read("here/results.json")).unwrap();
    let rows = record["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4);
    assert!(
        rows[0]["estimate_s"].is_number() && rows[1]["estimate_s"].is_null(),
        "{rows:?}"
    );
    assert_ne!(rows[0]["status"], rows[1]["status"]);
    has(&stdout(&out), &["semi-implicit-euler"]);
    has(&folder.read("here/cost.svg"), &["failed"]);
}
