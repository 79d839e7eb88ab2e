//! Tests of the command `gearbench compare`: its files and its refusals.

use super::{Folder, has, stdout};
use gearbench_reports::record::Results;

/// Runs a comparison with an expected exit code, and checks its page, and that the command prints no progress.
fn reports(arguments: &str, code: i32) {
    let folder = Folder::new();
    let out = folder.ends(arguments, code);
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
    // What is left of their fits is not decided: the reference itself is off by 2.3 %.
    reports("compare spur_impact --models rigid,movable-teeth", 1);
}

#[test]
#[ignore = "a quarter of a minute of finite elements: cargo test --release -p gearbench-cli --test command -- --ignored"]
fn the_bare_command_writes_the_default_report() {
    reports("", 0);
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
        1,
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
    let shipped = include_str!("../../../scenes/hammer.toml");
    let wrong = shipped.replacen("module_m = 0.004", "module_mm = 4.0", 1);
    let line = wrong.lines().position(|l| l.starts_with("module_mm"));
    folder.write("mine.toml", &wrong);
    let at = format!("mine.toml:{}", line.unwrap() + 1);
    folder.refuses("compare mine.toml", &[&at, "module_mm", "module_m"]);
    assert!(!folder.at("out").exists());
}

/// Histories have the requested number of evenly spaced rows, with every gear and mesh; events enclose the jumps.
#[test]
fn histories_are_an_even_grid_with_events_beside() {
    let folder = Folder::new();
    let of = "--models rigid,movable-teeth --integrators dopri5@1e-6 --repeats 1";
    folder.ends(&format!("compare loaded_mesh {of} --out here"), 0);
    super::as_documented(&folder.at("here"));
    let table = |name: &str| -> (Vec<String>, Vec<Vec<String>>) {
        let text = folder.read(&format!("here/{name}"));
        let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines().map(cells);
        (lines.next().unwrap(), lines.collect())
    };
    let number = |text: &String| text.parse::<f64>().unwrap();
    for stem in ["run01-rigid-dopri5", "run02-movable-teeth-dopri5"] {
        let (columns, rows) = table(&format!("{stem}.csv"));
        for name in [
            "hub_angle_pinion_rad",
            "hub_angle_wheel_rad",
            "speed_pinion_rad_s",
            "speed_wheel_rad_s",
            "transmission_error_pinion_wheel_m",
            "transverse_force_pinion_wheel_n",
            "bearing_pinion_x_n",
            "bearing_wheel_y_n",
        ] {
            assert!(columns.iter().any(|c| c == name), "{name}");
        }
        assert_eq!(rows.len(), 4000, "{stem}");
        let step = 0.01 / 3999.0;
        for (i, row) in rows.iter().enumerate() {
            assert!(
                (number(&row[0]) - i as f64 * step).abs() < 1e-6 * step,
                "row {i}"
            );
            assert!(row.iter().all(|cell| number(cell).is_finite()), "row {i}");
        }
        let (columns, rows) = table(&format!("{stem}-events.csv"));
        let at = |name: &str| columns.iter().position(|c| c == name).unwrap();
        let [before, after] = ["force_before_n", "force_after_n"].map(at);
        let jump = |r: &Vec<String>| (number(&r[after]) - number(&r[before])).abs();
        let closing: Vec<_> = rows.iter().filter(|r| r[1] == "closes").collect();
        assert!(closing.len() > 8 && rows.iter().all(|r| r[at("located")] == "true"));
        // The damper grows with the force: no pair makes the force jump when it closes.
        assert!(closing.iter().all(|r| jump(r) < 10.0), "{stem}");
        assert!(
            rows.windows(2)
                .all(|w| number(&w[0][0]) <= number(&w[1][0]))
        );
        let (_, pairs) = table(&format!("{stem}-pairs.csv"));
        assert!(pairs.len() > 2000);
        for row in &pairs {
            assert!(
                (1.0..=16.0).contains(&number(&row[2])) && (1.0..=24.0).contains(&number(&row[3]))
            );
        }
    }
}

/// A shipped scene, and the text of a file with it under another name.
fn with_another_name(scene: &str, name: &str, text: &str) -> String {
    text.replace(
        &format!("name = \"{scene}\""),
        &format!("name = \"{name}\""),
    )
}

/// A record as JSON without values of the clock, and without the command, the source and the files of histories.
fn without_clock(mut record: serde_json::Value) -> serde_json::Value {
    use serde_json::Value;
    fn strip(value: &mut Value) {
        match value {
            Value::Object(members) => {
                for key in gearbench_reports::record::OF_THE_CLOCK {
                    members.remove(key);
                }
                members.remove("files");
                members.values_mut().for_each(strip);
            }
            Value::Array(items) => items.iter_mut().for_each(strip),
            _ => {}
        }
    }
    strip(&mut record);
    record
}

/// Two scenes in one report: the record of each is that of its own comparison, the terminal has the finding of each, and
/// the record is made again from itself. Two scenes of one name are refused.
#[test]
fn scenes_are_compared_in_one_report() {
    let folder = Folder::new();
    let hammer = include_str!("../../../scenes/hammer.toml");
    let tighter = with_another_name("hammer", "tighter", hammer);
    assert_ne!(tighter, hammer);
    folder.write("tighter.toml", &tighter);
    let of = "--models rigid --integrators dopri5@1e-6 --repeats 1";
    let said = folder.says(&format!("compare hammer tighter.toml {of}"));
    has(&said, &["scene hammer:", "scene tighter:"]);
    let own = "out/hammer+tighter/compare";
    super::as_documented(&folder.at(own));
    has(
        &folder.read(&format!("{own}/index.html")),
        &["hammer: rigid", "tighter: rigid"],
    );
    has(
        &folder.read(&format!("{own}/force.svg")),
        &["hammer: rigid", "tighter: rigid"],
    );
    let record = |path: &str| -> serde_json::Value {
        serde_json::from_str(&folder.read(&format!("{path}/results.json"))).unwrap()
    };
    let both = record(own);
    folder.says(&format!("compare hammer {of} --out alone"));
    let mut first = both.clone();
    let second = first.as_object_mut().unwrap().remove("further").unwrap()[0].clone();
    let alone = without_clock(record("alone"));
    assert_eq!(without_clock(first), alone);
    // The same gears under another name have the same runs.
    assert_eq!(without_clock(second)["runs"], alone["runs"]);
    has(&folder.says(&format!("rerun {own}")), &["the same"]);
    folder.refuses(
        &format!("compare hammer hammer {of} --out twice"),
        &["two scenes", "`hammer`", "another `name`"],
    );
    // The folder of both is not that of one of them.
    folder.refuses(
        &format!("compare hammer {of} --out {own}"),
        &["another scene"],
    );
}

/// A sweep of two scenes has one table and one chart with the names of both.
#[test]
fn scenes_are_swept_in_one_report() {
    let folder = Folder::new();
    let loaded = include_str!("../../../scenes/loaded_mesh.toml");
    let other = with_another_name("loaded_mesh", "other", loaded);
    folder.write("other.toml", &other);
    let of = "--models rigid --points 2 --cycles 2 --from 500 --to 800 --branches up --out here";
    let said = folder.says(&format!("sweep loaded_mesh other.toml {of}"));
    has(&said, &["scene loaded_mesh:", "scene other:"]);
    super::as_documented(&folder.at("here"));
    let table = folder.read("here/sweep.csv");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 1 + 4, "{table}");
    assert!(rows[1].starts_with("loaded_mesh,rigid,") && rows[3].starts_with("other,rigid,"));
    // The same gears have the same results.
    assert_eq!(
        rows[1].strip_prefix("loaded_mesh"),
        rows[3].strip_prefix("other")
    );
    has(
        &folder.read("here/sweep.svg"),
        &["loaded_mesh: rigid", "other: rigid"],
    );
}
