//! Tests of the command `gearbench reference`: a run of a model as a reference for other studies.

use super::{Folder, as_documented, has, stdout};
use gearbench_reports::record::Results;
use serde_json::Value;

const SCENE: &str = include_str!("../malformed/scene.toml");

/// A scene with a reference made by movable teeth, and one at three times the speed.
fn prepared() -> Folder {
    let folder = Folder::new();
    folder.write("s.toml", &format!("# a comment that stays\n{SCENE}"));
    let make = "reference s.toml --model movable-teeth --method dopri5@1e-9";
    let said = folder.says(&format!("{make} --out teeth.csv --add"));
    has(&said, &["own error", "csv = \"teeth.csv\"", "added to"]);
    let out = folder.ends(
        &format!("{make} --speed pinion=60 --duration 5e-5 --validate --out fast.csv --add --json"),
        0,
    );
    let answer: Value = serde_json::from_str(&stdout(&out)).unwrap();
    assert!(
        answer["own_error"]["force_l2"].as_f64().unwrap() < 1e-4,
        "{answer}"
    );
    folder
}

#[test]
fn a_model_is_a_reference_for_the_others() {
    let folder = prepared();
    let scene = folder.read("s.toml");
    has(
        &scene,
        &[
            "# a comment that stays",
            "[[references]]\nname = \"teeth\"\ncsv = \"teeth.csv\"",
            "duration_s = 5e-5\ngears.pinion.speed_rad_s = 60.0\nrole = \"validate\"",
        ],
    );
    let table = folder.read("fast.csv");
    has(
        &table,
        &[
            "# command: gearbench reference",
            "# gears.pinion.speed_rad_s = 60.0",
            "own error",
        ],
    );
    folder.ends(
        "compare s.toml --integrators dopri5@1e-9 --repeats 1 --out c",
        0,
    );
    let record: Results = gearbench_reports::load_results(&folder.at("c")).unwrap();
    as_documented(&folder.at("c"));
    // The second reference has other conditions; models are not compared with it.
    let [reference] = record.references.as_slice() else {
        panic!("{} references", record.references.len())
    };
    assert_eq!(reference.id, "teeth");
    assert!(
        reference
            .processing
            .iter()
            .any(|l| l.contains("normal force"))
    );
    for run in &record.runs {
        let m = run.against("teeth").unwrap();
        let (force, error) = (m.force_l2.unwrap(), m.transmission_error_l2.unwrap());
        match run.model == "movable-teeth" {
            // The table has ten digits, and joins its samples by lines.
            true => assert!(force < 2e-3 && error < 2e-3, "{force} {error}"),
            false => assert!(force > 0.01 && force < 1.0, "{force}"),
        }
        assert!(m.rebound_rel.is_some());
    }
    has(
        &folder.read("c/index.html"),
        &["Further histories of the references", "read as"],
    );
    // The same reference by name in the study `precision`.
    folder.ends(
        "precision s.toml --models rigid --integrators dopri5 --rtols 1e-4,1e-6 --against teeth --repeats 1 --out p",
        0,
    );
    let record: Results = gearbench_reports::load_results(&folder.at("p")).unwrap();
    assert!(record.runs.iter().all(|r| r.against("teeth").is_some()));
}

/// A reference may lack the force: metrics of what it has are there, of what it has not are absent, and nothing is zero in
/// its place.
#[test]
fn what_a_reference_lacks_is_absent() {
    let folder = Folder::new();
    folder.write("s.toml", SCENE);
    folder.says("reference s.toml --model rigid --method dopri5@1e-9 --out whole.csv");
    let whole = folder.read("whole.csv");
    let lines: Vec<&str> = whole.lines().filter(|l| !l.starts_with('#')).collect();
    let names: Vec<&str> = lines[0].split(',').collect();
    let place = |name: &str| names.iter().position(|n| *n == name).unwrap();
    let keep = [place("time_s"), place("speed_pinion_rad_s")];
    let mut table = String::from("t [s],speed_pinion [rad/s],transmission_error [um]\n");
    let error = place("transmission_error_pinion_wheel_m");
    for (i, line) in lines[1..].iter().enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        let um = 1e6 * cells[error].parse::<f64>().unwrap();
        // Every third row alone has a transmission error: it has times of its own.
        let um = if i % 3 == 0 {
            um.to_string()
        } else {
            String::new()
        };
        table.push_str(&format!("{},{},{um}\n", cells[keep[0]], cells[keep[1]]));
    }
    folder.write("measured.csv", &table);
    let scene = SCENE.replace(
        "name = \"base\"",
        "reference = \"measured.csv\"\nname = \"base\"",
    );
    folder.write("s.toml", &scene);
    folder.ends(
        "compare s.toml --models rigid --integrators dopri5@1e-9 --repeats 1 --out c",
        0,
    );
    as_documented(&folder.at("c"));
    let record: Results = gearbench_reports::load_results(&folder.at("c")).unwrap();
    let reference = &record.references[0];
    assert!(reference.series.contact_force().is_empty() && reference.further.len() == 1);
    let m = record.runs[0].against("measured").unwrap();
    let absent = [
        m.force_l1,
        m.force_l2,
        m.force_l2_aligned,
        m.peak_force_rel,
        m.impulse_rel,
    ];
    assert_eq!(absent, [None; 5]);
    assert!(
        m.rebound_rel.unwrap() < 1e-6 && m.transmission_error_l2.unwrap() < 1e-3,
        "{m:?}"
    );
    let head = folder.read("c/reference01-measured.csv");
    assert_eq!(head.lines().next(), Some("time_s,speed_pinion_rad_s"));
    has(
        &folder.read("c/reference01-measured-2.csv"),
        &["time_s,transmission_error_pinion_wheel_m"],
    );
}

/// Columns of a table in a folder, without comments.
fn table(folder: &Folder, name: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let text = folder.read(name);
    let mut lines = text.lines().filter(|l| !l.starts_with('#'));
    let cells = |l: &str| l.split(',').map(str::to_owned).collect::<Vec<_>>();
    (cells(lines.next().unwrap()), lines.map(cells).collect())
}

/// Angles, torques and transmission errors in what rigs write: zero error against the run itself, a known error for a
/// known change, by compare and by precision.
#[test]
fn angles_and_torques_are_compared() {
    let folder = Folder::new();
    folder.write("s.toml", SCENE);
    folder.says("reference s.toml --model rigid --method dopri5@1e-9 --out whole.csv");
    let (names, rows) = table(&folder, "whole.csv");
    let place = |name: &str| names.iter().position(|n| n == name).unwrap();
    let [time, angle, torque] =
        ["time_s", "hub_angle_pinion_rad", "contact_torque_wheel_nm"].map(place);
    assert!(!names.iter().any(|n| n.starts_with("mount_torque")));
    let write = |name: &str, turned: f64, factor: f64| {
        let mut text = String::from("t [s],phi [deg],M [kN m]\n");
        for row in &rows {
            let x = |i: usize| row[i].parse::<f64>().unwrap();
            let degrees = (x(angle) + turned).to_degrees();
            let (t, m) = (&row[time], factor * 1e-3 * x(torque));
            text.push_str(&format!("{t},{degrees:.12e},{m:.12e}\n"));
        }
        folder.write(name, &text);
    };
    let values = |i: usize| rows.iter().map(move |r| r[i].parse::<f64>().unwrap());
    let span = |i: usize| values(i).fold(f64::MIN, f64::max) - values(i).fold(f64::MAX, f64::min);
    write("same.csv", 0.0, 1.0);
    write("other.csv", 0.01 * span(angle), 1.25);
    let columns = "columns = { time = \"t [s]\", angle.pinion = \"phi\", torque.wheel = \"M\" }";
    let mut scene = SCENE.to_owned();
    for name in ["same", "other"] {
        scene.push_str(&format!(
            "\n[[references]]\ncsv = \"{name}.csv\"\n{columns}\n"
        ));
    }
    folder.write("s.toml", &scene);
    folder.ends(
        "compare s.toml --models rigid --integrators dopri5@1e-9 --repeats 1 --out c",
        0,
    );
    as_documented(&folder.at("c"));
    let record: Results = gearbench_reports::load_results(&folder.at("c")).unwrap();
    let errors = |id: &str| {
        let m = record.runs[0].against(id).unwrap();
        [m.angle_l2, m.torque_l2, m.torque_peak_rel].map(Option::unwrap)
    };
    let zero = errors("same");
    assert!(zero.iter().all(|e| e.abs() < 1e-3), "{zero:?}");
    let [angle_error, torque_error, peak] = errors("other");
    assert!((angle_error - 0.01).abs() < 1e-4, "{angle_error}");
    assert!(torque_error > 0.01 && torque_error < 0.2, "{torque_error}");
    assert!((peak - (1.0 / 1.25 - 1.0)).abs() < 1e-3, "{peak}");
    has(
        &folder.read("c/reference01-same.csv"),
        &["hub_angle_pinion_rad", "contact_torque_wheel_nm"],
    );
    has(
        &folder.read("c/index.html"),
        &["contact torque wheel", "Torque"],
    );
    // What the metric is of stands in the table of precision, and a tolerance in it is refused where nothing has it.
    folder.ends(
        "precision s.toml --models rigid --integrators dopri5 --rtols 1e-4,1e-6 --against other --metric torque \
         --repeats 1 --out p",
        0,
    );
    let (names, rows) = table(&folder, "p/precision.csv");
    let [against, torque] =
        ["against", "torque_l2"].map(|name| names.iter().position(|n| n == name).unwrap());
    let told = rows.iter().filter(|r| r[against] == "other");
    let told: Vec<f64> = told.map(|r| r[torque].parse().unwrap()).collect();
    assert_eq!(told.len(), 2);
    assert!(
        told.iter().all(|e| (e - torque_error).abs() < 0.01),
        "{told:?}"
    );
    let own = rows.iter().find(|r| r[against] == "self").unwrap();
    assert_eq!(own[torque], "");
    let limit = |metric: &str, against: &str| {
        let old = "tolerance = { metric = \"force_l2\", limit = 0.05, against = \"self\" }";
        assert!(scene.contains(old));
        let new = format!(
            "tolerance = {{ metric = \"{metric}\", limit = 0.3, against = \"{against}\" }}"
        );
        folder.write("t.toml", &scene.replace(old, &new));
    };
    limit("torque_l2", "self");
    folder.refuses(
        "compare t.toml --out d",
        &["torque_l2", "a run of gearbench"],
    );
    limit("rebound_rel", "other");
    folder.refuses(
        "compare t.toml --out d",
        &["speed", "angle_l2 or torque_l2"],
    );
    limit("torque_l2", "other");
    folder.ends(
        "compare t.toml --models rigid --integrators dopri5@1e-6 --repeats 1 --out d",
        0,
    );
}

#[test]
fn references_are_refused_before_they_are_computed() {
    let folder = Folder::new();
    folder.write("s.toml", SCENE);
    let reference = |rest: &str| format!("reference s.toml --model rigid {rest}");
    for (rest, words) in [
        (
            "--out a.csv --speed pinoin=3",
            ["no gear `pinoin`", "did you mean"],
        ),
        ("--out a.csv --speed pinion=x", ["GEAR=NUMBER", "pinion=60"]),
        (
            "--out a.csv --gap 1",
            ["larger than the normal backlash", "smaller gap"],
        ),
        ("--out no/folder/a.csv", ["cannot be written", "--out"]),
        (
            "--out a.csv --method rk4@1us,rk4@2us",
            ["several methods", "one"],
        ),
        ("--out a.csv --method rk4@1s", ["longer", "smaller step"]),
        (
            "--out rigid.csv --add --name rigid",
            ["of a model", "`name`"],
        ),
    ] {
        folder.refuses(&reference(rest), &words);
    }
    folder.refuses(
        "reference spur_impact --model rigid --out a.csv --add",
        &["gearbench init"],
    );
    assert_eq!(folder.files(), 1, "nothing is left behind");
}
