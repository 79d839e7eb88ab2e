//! The command as a user meets it: what it writes, what it refuses, how it ends.

use gearbench_reports::{Metric, Study};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of its own for a test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("gearbench-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn gearbench(dir: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gearbench"))
        .args(arguments)
        .current_dir(dir)
        .env("NO_COLOR", "1")
        .env("GEARBENCH_CACHE", "off")
        .output()
        .unwrap()
}

fn stderr(o: &Output) -> String {
    // Diagnostics wrap at the width of the terminal.
    String::from_utf8_lossy(&o.stderr)
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

fn is_empty(dir: &Path) -> bool {
    std::fs::read_dir(dir).unwrap().next().is_none()
}

#[test]
fn the_bare_command_writes_the_default_report() {
    let folder = Folder::new("bare");
    let out = gearbench(&folder.0, &[]);
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
    let again = gearbench(&folder.0, &["report", "out/spur_impact/compare"]);
    assert_eq!(again.status.code(), Some(0), "{}", stderr(&again));
    assert_eq!(
        page,
        std::fs::read_to_string(dir.join("index.html")).unwrap()
    );
}

#[test]
fn integrators_and_models_can_be_chosen() {
    let folder = Folder::new("chosen");
    let out = gearbench(
        &folder.0,
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
        record.command.contains("--models rigid"),
        "{}",
        record.command
    );
}

#[test]
fn a_run_that_fails_is_a_row_and_an_exit_code() {
    let folder = Folder::new("fails");
    // Ten times the stable step of a tooth.
    let out = gearbench(
        &folder.0,
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
    let folder = Folder::new("refused");
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
            &["compare", "spur_impact", "--integrators", "rk5"],
            &["no integrator `rk5`", "rk4"],
        ),
        (
            &["compare", "spur_impact", "--integrators", "newmark(beta=7)"],
            &["beta = 7 lies outside"],
        ),
        (&["compare", "nowhere.toml"], &["nowhere.toml"]),
        (&["identify", "hammer"], &["no reference"]),
        (&["report", "nowhere"], &["nowhere"]),
    ];
    for (arguments, expected) in cases {
        let out = gearbench(&folder.0, arguments);
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
        assert!(is_empty(&folder.0), "{arguments:?} wrote something");
    }
}

#[test]
fn a_scene_of_ones_own_is_refused_with_its_line() {
    let folder = Folder::new("own");
    let shipped = include_str!("../scenes/hammer.toml");
    let wrong = shipped.replacen("module_m = 0.004", "module_mm = 4.0", 1);
    let line = wrong
        .lines()
        .position(|l| l.starts_with("module_mm"))
        .unwrap()
        + 1;
    std::fs::write(folder.at("mine.toml"), wrong).unwrap();
    let out = gearbench(&folder.0, &["compare", "mine.toml"]);
    assert_eq!(out.status.code(), Some(2));
    let said = stderr(&out);
    assert!(said.contains(&format!("mine.toml:{line}")), "{said}");
    assert!(
        said.contains("module_mm") && said.contains("module_m"),
        "{said}"
    );
    assert!(!folder.at("out").exists());
}

#[test]
fn help_and_list_teach() {
    let folder = Folder::new("help");
    let help = gearbench(&folder.0, &["--help"]);
    let text = String::from_utf8_lossy(&help.stdout).to_string();
    for words in [
        "Examples:",
        "compare",
        "identify",
        "Exit codes",
        "results.json",
    ] {
        assert!(text.contains(words), "{words} is missing in\n{text}");
    }
    let list = gearbench(&folder.0, &["list"]);
    let text = String::from_utf8_lossy(&list.stdout).to_string();
    for words in [
        "spur_impact",
        "hammer",
        "movable-teeth",
        "tooth_mass_kg",
        "dopri5",
        "calculix/case-a-fine",
    ] {
        assert!(text.contains(words), "{words} is missing in\n{text}");
    }
    let wrong = gearbench(&folder.0, &["compare", "--modles", "x"]);
    assert_eq!(wrong.status.code(), Some(2));
}

#[test]
fn stiffness_prints_a_table_and_writes_its_folder() {
    let folder = Folder::new("stiffness");
    let arguments = |extra: &[&'static str]| {
        let fixed = ["stiffness", "spur_impact", "--models", "rigid-iso6336"];
        [&fixed, extra].concat()
    };
    let out = gearbench(&folder.0, &arguments(&["--positions", "10"]));
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
        &folder.0,
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
    let folder = Folder::new("stiffness-fe");
    let out = gearbench(
        &folder.0,
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
    let folder = Folder::new("stiffness-refusals");
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
        let out = gearbench(&folder.0, arguments);
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
    assert!(is_empty(&folder.0), "nothing is written");
}

fn stdout(o: &Output) -> String {
    String::from_utf8_lossy(&o.stdout).into_owned()
}

#[test]
fn meshes_are_written_as_decks_and_for_paraview() {
    let folder = Folder::new("mesh");
    let dry = gearbench(&folder.0, &["mesh", "spur_impact"]);
    assert_eq!(dry.status.code(), Some(0), "{}", stderr(&dry));
    let said = stdout(&dry);
    assert!(
        said.contains("pinion") && said.contains("wheel") && said.contains("nothing was written"),
        "{said}"
    );
    assert!(is_empty(&folder.0));

    let arguments = [
        "mesh",
        "spur_impact",
        "--width",
        "1",
        "--flank",
        "5",
        "--element",
        "c3d20r",
    ];
    let out = gearbench(
        &folder.0,
        &[&arguments[..], &["--out", "g.inp", "--vtu", "g.vtu"]].concat(),
    );
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    for (name, teeth) in [("pinion", 20), ("wheel", 30)] {
        let deck = gearbench_reference::deck::read(folder.at(&format!("g-{name}.inp"))).unwrap();
        let gears = gearbench_reference::deck::gears(&deck).unwrap();
        let mesh = &gears[0].mesh;
        assert_eq!((gears.len(), mesh.teeth), (1, teeth));
        assert_eq!(mesh.mesh.kind.name(), "C3D20R");
        assert!(mesh.flanks.iter().all(|f| (f.rows, f.columns) == (6, 2)));
        let counts = format!(
            "{}  {:>8}",
            mesh.mesh.nodes.len(),
            mesh.mesh.element_count()
        );
        assert!(stdout(&out).contains(&counts), "{}", stdout(&out));
        let page = std::fs::read_to_string(folder.at(&format!("g-{name}.vtu"))).unwrap();
        let head = format!(
            "NumberOfPoints=\"{}\" NumberOfCells=\"{}\"",
            mesh.mesh.nodes.len(),
            mesh.mesh.element_count()
        );
        assert!(page.contains(&head) && page.ends_with("</VTKFile>\n"));
    }
    // Four files and nothing else.
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 4);

    // A deck brings its own mesh.
    let again = gearbench(&folder.0, &["mesh", "g-pinion.inp", "--vtu", "again.vtu"]);
    assert_eq!(again.status.code(), Some(0), "{}", stderr(&again));
    assert!(folder.at("again.vtu").exists());
}

#[test]
fn a_sector_carries_the_cuts_in_matching_order() {
    let folder = Folder::new("sector");
    let out = gearbench(
        &folder.0,
        &[
            "mesh",
            "spur_impact",
            "--gear",
            "wheel",
            "--sector",
            "--out",
            "s.inp",
        ],
    );
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    let text = std::fs::read_to_string(folder.at("s.inp")).unwrap();
    let numbers = |block: &str| -> Vec<Vec<f64>> {
        let body = text
            .split_once(block)
            .unwrap()
            .1
            .split_once('\n')
            .unwrap()
            .1;
        let lines = body.lines().take_while(|l| !l.starts_with('*'));
        lines
            .map(|l| l.split(',').filter_map(|w| w.trim().parse().ok()).collect())
            .collect()
    };
    let nodes = numbers("*NODE,");
    let at = |n: &f64| &nodes[*n as usize - 1][1..4];
    let (low, high) = (
        numbers("NSET=cut_low").concat(),
        numbers("NSET=cut_high").concat(),
    );
    assert!(low.len() == high.len() && low.len() > 20);
    let (sin, cos) = (std::f64::consts::TAU / 30.0).sin_cos();
    for (a, b) in low.iter().zip(&high) {
        let (a, b) = (at(a), at(b));
        let turned = [cos * a[0] - sin * a[1], sin * a[0] + cos * a[1], a[2]];
        for k in 0..3 {
            assert!((turned[k] - b[k]).abs() < 1e-14, "{turned:?} {b:?}");
        }
    }
}

#[test]
fn meshes_that_cannot_be_made_are_refused_and_nothing_is_written() {
    let folder = Folder::new("unmeshable");
    let solid: String = include_str!("../scenes/hammer.toml")
        .lines()
        .filter(|l| !l.starts_with("bore_radius_m"))
        .map(|l| format!("{l}\n"))
        .collect();
    std::fs::write(folder.at("solid.toml"), solid).unwrap();
    std::fs::write(folder.at("broken.inp"), "*NODE\n1, 2\n").unwrap();
    let cases: [(&[&str], &[&str]); 9] = [
        (
            &["solid.toml"],
            &["is solid", "bore_radius_m = 0.0", "[gears.pinion]"],
        ),
        (
            &["spur_impact", "--gear", "pinoin"],
            &["no gear `pinoin`", "pinion, wheel"],
        ),
        (
            &["spur_impact", "--element", "C3D4"],
            &["no element `C3D4`", "C3D20R"],
        ),
        (
            &["spur_impact", "--across", "2"],
            &["across the tooth is 2", "--across"],
        ),
        (
            &["spur_impact", "--fine-teeth", "1,31"],
            &["fine tooth 30 does not exist", "from 1"],
        ),
        (&["spur_impact", "--fine-teeth", "0"], &["--fine-teeth"]),
        (&["broken.inp"], &["broken.inp"]),
        (
            &["broken.inp", "--flank", "3"],
            &["--flank", "brings its own mesh"],
        ),
        (&["spur_impact", "--vtu", "x.inp"], &["asked for twice"]),
    ];
    for (arguments, expected) in cases {
        let all = [&["mesh"], arguments, &["--out", "x.inp"]].concat();
        let out = gearbench(&folder.0, &all);
        assert_eq!(out.status.code(), Some(2), "{all:?}: {}", stderr(&out));
        for words in expected {
            assert!(stderr(&out).contains(words), "{all:?}: {}", stderr(&out));
        }
        assert_eq!(
            std::fs::read_dir(&folder.0).unwrap().count(),
            2,
            "{all:?} wrote something"
        );
    }
    // The input itself is never overwritten, and a folder that does not exist is named.
    for out in ["broken.inp", "nowhere/x.inp"] {
        let o = gearbench(
            &folder.0,
            &["mesh", "spur_impact", "--gear", "pinion", "--out", out],
        );
        assert_eq!(
            o.status.code(),
            Some(if out == "broken.inp" { 0 } else { 2 })
        );
    }
    let own = gearbench(&folder.0, &["mesh", "broken.inp", "--out", "broken.inp"]);
    assert_eq!(own.status.code(), Some(2));
    assert!(stderr(&own).contains("is the input"), "{}", stderr(&own));
}

#[test]
fn precision_writes_its_table_and_takes_failures_as_data() {
    let folder = Folder::new("precision");
    let arguments = [
        "precision",
        "spur_impact",
        "--models",
        "rigid-iso6336",
        "--integrators",
        "velocity-verlet@100us,rk4@1us,dopri5@1e-4",
        "--metric",
        "force-aligned,peak",
        "--out",
        "here",
    ];
    let out = gearbench(&folder.0, &arguments);
    // A step that fails is a point of the study, not a failure of the command.
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
    assert_eq!((record.study, record.runs.len()), (Study::Precision, 3));
    assert_eq!(
        record.metrics,
        [Metric::ForceL2Aligned, Metric::PeakForceRel]
    );
    assert!(
        record.runs[0].status.is_failure(),
        "{:?}",
        record.runs[0].status
    );
    assert_eq!(record.runs[1].step, Some(1e-6));
    let table = std::fs::read_to_string(folder.at("here/precision.csv")).unwrap();
    // Two references each: CalculiX, and the model's own converged solution.
    assert_eq!(table.lines().count(), 1 + 2 * 3, "{table}");
    assert!(folder.at("here/precision_model.svg").exists());
    let said = String::from_utf8_lossy(&out.stdout);
    assert!(said.contains("Pareto front against calculix"), "{said}");

    for (wrong, expected) in [
        (["--metric", "farce"], "there is no metric `farce`"),
        (["--against", "abaqus"], "`abaqus` is no reference"),
        (["--integrators", "bdf@1us"], "chooses its steps"),
        (["--models", "rigd"], "did you mean `rigid`"),
    ] {
        let all = [
            "precision",
            "spur_impact",
            "--out",
            "there",
            wrong[0],
            wrong[1],
        ];
        let out = gearbench(&folder.0, &all);
        assert_eq!(out.status.code(), Some(2), "{wrong:?}");
        assert!(stderr(&out).contains(expected), "{}", stderr(&out));
        assert!(!folder.at("there").exists());
    }
}

/// The name `modes` is kept for the natural modes of an assembled scene.
#[test]
fn the_former_name_of_the_truncation_study_is_refused_with_the_new_one() {
    let folder = Folder::new("truncation");
    let out = gearbench(&folder.0, &["modes", "spur_impact", "--counts", "0,25"]);
    assert_eq!(out.status.code(), Some(2), "{}", stderr(&out));
    assert!(
        stderr(&out).contains("`gearbench truncation`"),
        "{}",
        stderr(&out)
    );
    assert!(is_empty(&folder.0));
}
