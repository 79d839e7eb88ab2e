//! `gearbench stiffness`.

use super::{Folder, gearbench, is_empty, stderr};

#[test]
fn stiffness_prints_a_table_and_writes_its_folder() {
    let folder = Folder::new();
    let arguments = |extra: &[&'static str]| {
        let fixed = ["stiffness", "spur_impact", "--models", "rigid-iso6336"];
        [&fixed, extra].concat()
    };
    let out = gearbench(folder.path(), &arguments(&["--positions", "10"]));
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    let said = String::from_utf8_lossy(&out.stdout);
    for word in [
        "300.0000 N/mm",
        "ISO 6336-1",
        "analytic",
        "N/(mm um)",
        "peak to peak",
    ] {
        assert!(said.contains(word), "{word} is missing in\n{said}");
    }
    let dir = folder.at("out/spur_impact/stiffness");
    let read = |name: &str| std::fs::read_to_string(dir.join(name)).unwrap();
    // Rigid gears with the norm's stiffness are the norm.
    let summary = read("stiffness.csv");
    let value = |model: &str| -> f64 {
        let line = summary.lines().find(|l| l.starts_with(model)).unwrap();
        line.split(',').nth(2).unwrap().parse().unwrap()
    };
    assert_eq!(value("rigid-iso6336"), value("ISO 6336-1"));
    assert!((value("ISO 6336-1") / 1e9 - 12.5).abs() < 0.1);
    let cycle = read("cycle_rigid-iso6336.csv");
    assert_eq!(cycle.lines().count(), 11);
    assert!(cycle.starts_with("path_coordinate_m,"));
    assert!(read("stiffness.svg").starts_with("<svg"));
    let left = std::fs::read_dir(&dir).unwrap().count();
    assert_eq!(left, 5, "nothing half written");

    // The torque of a force on the line of action is the same load.
    let rb = 0.04 * 20f64.to_radians().cos();
    let torque = format!("{}", 3000.0 * rb);
    let again = gearbench(
        folder.path(),
        &[
            &arguments(&["--positions", "10", "--out", "b", "--torque"])[..],
            &[&torque],
        ]
        .concat(),
    );
    assert_eq!(again.status.code(), Some(0), "{}", stderr(&again));
    let other = std::fs::read_to_string(folder.at("b/cycle_rigid-iso6336.csv")).unwrap();
    let column = |text: &str, n: usize| -> Vec<f64> {
        let value = |l: &str| l.split(',').nth(n).unwrap().parse().unwrap();
        text.lines().skip(1).map(value).collect()
    };
    for (a, b) in column(&cycle, 2).iter().zip(column(&other, 2)) {
        assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn stiffness_of_finite_elements_stands_beside_the_norm() {
    let folder = Folder::new();
    let out = gearbench(
        folder.path(),
        &[
            "stiffness",
            "spur_impact",
            "--model",
            "fe",
            "--positions",
            "4",
            "--out",
            "fe",
        ],
    );
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    let summary = std::fs::read_to_string(folder.at("fe/stiffness.csv")).unwrap();
    let value = |model: &str| -> f64 {
        let line = summary.lines().find(|l| l.starts_with(model)).unwrap();
        line.split(',').nth(2).unwrap().parse().unwrap()
    };
    let ratio = value("fe") / value("ISO 6336-1");
    assert!((ratio - 1.0).abs() < 0.08, "{ratio}");
    let said = String::from_utf8_lossy(&out.stdout);
    assert!(
        said.contains("penalty 1.0e15 Pa/m") && said.contains("unknowns"),
        "{said}"
    );
}

#[test]
fn stiffness_refuses_what_it_cannot_load() {
    let folder = Folder::new();
    for (arguments, code, words) in [
        (
            &["stiffness", "spur_impact", "--models", "soft"][..],
            2,
            &["soft", "rigid-iso6336"][..],
        ),
        (
            &["stiffness", "spur_impact", "--load", "0"],
            2,
            &["positive"],
        ),
        (
            &["stiffness", "spur_impact", "--positions", "1"],
            2,
            &["2 to 2000"],
        ),
        (
            &[
                "stiffness",
                "spur_impact",
                "--models",
                "rigid",
                "--load",
                "1e8",
            ],
            3,
            &["rigid", "no approach", "less load"],
        ),
    ] {
        let out = gearbench(folder.path(), arguments);
        assert_eq!(
            out.status.code(),
            Some(code),
            "{arguments:?}: {}",
            stderr(&out)
        );
        for word in words {
            assert!(stderr(&out).contains(word), "{word}: {}", stderr(&out));
        }
    }
    assert!(is_empty(folder.path()), "nothing is written");
}
