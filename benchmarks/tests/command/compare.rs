//! `gearbench compare`: what it writes, what it refuses.

use super::{Folder, gearbench, is_empty, stderr};

/// Writes a report, quietly.
fn reports(arguments: &[&str]) {
    let folder = Folder::new();
    let out = gearbench(folder.path(), arguments);
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    let dir = folder.at("out/spur_impact/compare");
    let page = std::fs::read_to_string(dir.join("index.html")).unwrap();
    assert!(page.contains("movable-teeth") && page.contains("CalculiX"));
    assert!(
        !page.contains("src=\"http") && !page.contains("href=\"http") && !page.contains("url(http")
    );
    let said = String::from_utf8_lossy(&out.stdout);
    assert!(
        said.contains("index.html") && said.contains("results.json"),
        "{said}"
    );
    assert!(
        out.stderr.is_empty(),
        "quiet without a terminal: {}",
        stderr(&out)
    );

    // Drawn again from the record alone, the page is the same to the byte.
    let again = gearbench(folder.path(), &["report", "out/spur_impact/compare"]);
    assert_eq!(again.status.code(), Some(0), "{}", stderr(&again));
    assert_eq!(
        page,
        std::fs::read_to_string(dir.join("index.html")).unwrap()
    );
}

#[test]
fn a_comparison_writes_its_report() {
    reports(&["compare", "spur_impact", "--models", "rigid,movable-teeth"]);
}

#[test]
#[ignore = "a quarter of a minute of finite elements: cargo test --release -p gearbench --test command -- --ignored"]
fn the_bare_command_writes_the_default_report() {
    reports(&[]);
}

#[test]
fn integrators_and_models_can_be_chosen() {
    let folder = Folder::new();
    let out = gearbench(
        folder.path(),
        &[
            "compare",
            "spur_impact",
            "--models",
            "rigid",
            "--integrators",
            "generalised-alpha(rho_inf=0.5)@1e-6,dopri5@1e-8",
            "--out",
            "here",
            "--repeats",
            "1",
        ],
    );
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
    let runs: Vec<_> = record
        .runs
        .iter()
        .map(|r| (r.integrator.as_str(), r.step, r.rtol))
        .collect();
    assert_eq!(
        runs,
        [
            ("generalised-alpha(rho_inf=0.5)", Some(1e-6), None),
            ("dopri5", None, Some(1e-8))
        ]
    );
    assert!(
        record.header.command.contains("--models rigid"),
        "{}",
        record.header.command
    );
}

#[test]
fn a_run_that_fails_is_a_row_and_an_exit_code() {
    let folder = Folder::new();
    // Ten times the stable step of a tooth.
    let out = gearbench(
        folder.path(),
        &[
            "compare",
            "spur_impact",
            "--models",
            "movable-teeth",
            "--integrators",
            "velocity-verlet@5e-5,dopri5",
            "--out",
            "here",
            "--repeats",
            "1",
        ],
    );
    assert_eq!(
        out.status.code(),
        Some(3),
        "{}",
        String::from_utf8_lossy(&out.stdout)
    );
    let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
    assert_eq!(record.runs.len(), 2);
    let failed = &record.runs[0];
    assert!(failed.status.is_failure(), "{:?}", failed.status);
    assert!(
        failed
            .message
            .as_ref()
            .is_some_and(|m| m.contains("t = ") || m.contains("overlap")),
        "{failed:?}"
    );
    assert!(!record.runs[1].status.is_failure());
}

#[test]
fn bad_input_is_refused_and_nothing_is_written() {
    let folder = Folder::new();
    let cases: [(&[&str], &[&str]); 7] = [
        (
            &["compare", "spur_impct"],
            &["there is no scene", "spur_impact"],
        ),
        (
            &["compare", "spur_impact", "--models", "rigd"],
            &["no model `rigd`", "rigid"],
        ),
        (
            &[
                "compare",
                "spur_impact",
                "--models",
                "rigid",
                "--integrators",
                "rk5",
            ],
            &["no integrator `rk5`", "rk4"],
        ),
        (
            &[
                "compare",
                "spur_impact",
                "--models",
                "rigid",
                "--integrators",
                "newmark(beta=7)",
            ],
            &["beta = 7 lies outside"],
        ),
        (&["compare", "nowhere.toml"], &["nowhere.toml"]),
        (
            &["identify", "hammer", "--model", "rigid"],
            &["no reference"],
        ),
        (&["report", "nowhere"], &["nowhere"]),
    ];
    for (arguments, expected) in cases {
        let out = gearbench(folder.path(), arguments);
        assert_eq!(
            out.status.code(),
            Some(2),
            "{arguments:?}: {}",
            stderr(&out)
        );
        for words in expected {
            assert!(
                stderr(&out).contains(words),
                "{arguments:?}: {}",
                stderr(&out)
            );
        }
        assert!(is_empty(folder.path()), "{arguments:?} wrote something");
    }
}

#[test]
fn a_scene_of_ones_own_is_refused_with_its_line() {
    let folder = Folder::new();
    let shipped = include_str!("../../scenes/hammer.toml");
    let wrong = shipped.replacen("module_m = 0.004", "module_mm = 4.0", 1);
    let line = wrong
        .lines()
        .position(|l| l.starts_with("module_mm"))
        .unwrap()
        + 1;
    std::fs::write(folder.at("mine.toml"), wrong).unwrap();
    let out = gearbench(folder.path(), &["compare", "mine.toml"]);
    assert_eq!(out.status.code(), Some(2));
    let said = stderr(&out);
    assert!(said.contains(&format!("mine.toml:{line}")), "{said}");
    assert!(
        said.contains("module_mm") && said.contains("module_m"),
        "{said}"
    );
    assert!(!folder.at("out").exists());
}
