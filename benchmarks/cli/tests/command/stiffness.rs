//! Tests of the command `gearbench stiffness`.

use super::{Folder, has, stderr};

/// A column of a table.
fn column(text: &str, n: usize) -> Vec<f64> {
    let value = |l: &str| l.split(',').nth(n).unwrap().parse().unwrap();
    text.lines().skip(1).map(value).collect()
}

/// Stiffness at the pitch point of a model.
fn at_pitch_point(summary: &str, model: &str) -> f64 {
    let line = summary.lines().find(|l| l.starts_with(model)).unwrap();
    line.split(',').nth(2).unwrap().parse().unwrap()
}

#[test]
fn stiffness_prints_a_table_and_writes_its_folder() {
    let folder = Folder::new();
    let arguments = "stiffness spur_impact --models rigid-iso6336 --positions 10";
    let said = folder.says(arguments);
    has(
        &said,
        &[
            "300 N/mm, the default",
            "ISO 6336-1",
            "analytic",
            "N/(mm um)",
            "peak to peak",
        ],
    );
    let read = |name: &str| folder.read(&format!("out/spur_impact/stiffness/{name}"));
    // Rigid gears with the norm's stiffness are the norm.
    let summary = read("stiffness.csv");
    let norm = at_pitch_point(&summary, "ISO 6336-1");
    assert_eq!(at_pitch_point(&summary, "rigid-iso6336"), norm);
    assert!((norm / 1e9 - 12.5).abs() < 0.1);
    let cycle = read("cycle_rigid-iso6336.csv");
    assert_eq!(cycle.lines().count(), 11);
    assert!(cycle.starts_with("path_coordinate_m,"));
    assert!(read("stiffness.svg").starts_with("<svg"));
    let left = std::fs::read_dir(folder.at("out/spur_impact/stiffness")).unwrap();
    // Record, page, chart, two tables and three cycles.
    assert_eq!(left.count(), 8, "nothing half written");
    super::as_documented(&folder.at("out/spur_impact/stiffness"));

    // As other studies: its page is drawn again, and it is made again from its record.
    let page = read("index.html");
    has(&page, &["mesh stiffness", "rigid-iso6336", "ISO 6336-1"]);
    folder.says("report out/spur_impact/stiffness");
    assert_eq!(page, read("index.html"));
    has(
        &folder.says("rerun out/spur_impact/stiffness"),
        &["the same"],
    );
    let record = gearbench_reports::load_results(&folder.at("out/spur_impact/stiffness"));
    let record = record.unwrap();
    let models: Vec<&str> = record
        .stiffness()
        .iter()
        .map(|m| m.label.as_str())
        .collect();
    assert_eq!(models, ["rigid-iso6336", "ISO 6336-1", "analytic"]);
    assert_eq!(record.stiffness()[0].positions.len(), 10);

    // The torque of a force on the line of action is the same load.
    let rb = 0.04 * 20f64.to_radians().cos();
    folder.says(&format!("{arguments} --out b --torque {}", 3000.0 * rb));
    let other = folder.read("b/cycle_rigid-iso6336.csv");
    for (a, b) in column(&cycle, 2).iter().zip(column(&other, 2)) {
        assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
    }
}

/// Without `--load` the loads of the scene are used, and the flank of the start carries a torque of either sign.
#[test]
fn stiffness_takes_the_load_of_the_scene() {
    let folder = Folder::new();
    let said = folder.says("stiffness loaded_mesh --models rigid --positions 4 --out own");
    has(&said, &["from the loads of the scene", "2.78"]);
    let own = folder.read("own/cycle_rigid.csv");
    let rb = 0.5 * 16.0 * 4.5e-3 * 20f64.to_radians().cos();
    for force in column(&own, 3) {
        assert!((force * rb / 94.1 - 1.0).abs() < 1e-5, "{force}");
    }
    for torque in ["94.1", "-94.1"] {
        let said = folder.says(&format!(
            "stiffness loaded_mesh --models rigid --positions 4 --out t --torque {torque}"
        ));
        has(&said, &["from --torque"]);
        let other = folder.read("t/cycle_rigid.csv");
        for (a, b) in column(&own, 2).iter().zip(column(&other, 2)) {
            assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
        }
    }
    folder.refuses("stiffness loaded_mesh --torque 0", &["other than zero"]);
}

#[test]
fn stiffness_of_finite_elements_stands_beside_the_norm() {
    let folder = Folder::new();
    let said = folder.says("stiffness spur_impact --model fe --positions 4 --out fe");
    let summary = folder.read("fe/stiffness.csv");
    let ratio = at_pitch_point(&summary, "fe") / at_pitch_point(&summary, "ISO 6336-1");
    assert!((ratio - 1.0).abs() < 0.08, "{ratio}");
    has(&said, &["penalty 1.0e15 Pa/m", "unknowns"]);
}

#[test]
fn stiffness_refuses_what_it_cannot_load() {
    let folder = Folder::new();
    folder.refuses(
        "stiffness spur_impact --models soft",
        &["soft", "rigid-iso6336"],
    );
    folder.refuses("stiffness spur_impact --load 0", &["positive"]);
    folder.refuses("stiffness spur_impact --positions 1", &["2 to 2000"]);
    let failed = folder.ends("stiffness spur_impact --models rigid --load 1e8", 3);
    has(
        &stderr(&failed),
        &["rigid", "no approach", "a smaller load"],
    );
    assert_eq!(folder.files(), 0, "nothing is written");
}
