//! Tests of standard output and exit codes: answers for programs, closed pipes, full disks.

use super::{Folder, has, stderr, stdout};
use serde_json::Value;
use std::io::Read;
use std::process::Stdio;

/// The one object of an output.
fn object(text: &[u8]) -> Value {
    serde_json::from_slice(text)
        .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(text)))
}

#[test]
fn a_run_beyond_the_tolerance_gates() {
    let folder = Folder::new();
    let shipped = include_str!("../../../scenes/hammer.toml");
    let (before, after) = shipped.split_once("tolerance = ").unwrap();
    let rest = after.split_once('\n').unwrap().1;
    let with = |tolerance: &str| format!("{before}tolerance = {tolerance}\n{rest}");
    let run = "compare mine.toml --models rigid --integrators velocity-verlet@1us --repeats 1";
    folder.write(
        "mine.toml",
        &with(r#"{ metric = "force_l2", limit = 1e-6, against = "self" }"#),
    );
    let said = stdout(&folder.ends(run, 1));
    has(
        &said,
        &[
            "inaccurate: force_l2 against self is",
            "above the limit of the scene",
        ],
    );
    folder.write(
        "mine.toml",
        &with(r#"{ metric = "force_l2", limit = 1e-6, against = "self", except = ["rigid"] }"#),
    );
    has(
        &folder.says(run),
        &["beyond the tolerance, from which the scene excepts the model"],
    );
}

#[test]
fn an_answer_for_programs_is_one_object() {
    let folder = Folder::new();
    let out = folder.ends(
        "compare spur_impact --models rigid --integrators rk4,dopri5 --repeats 1 --json",
        1,
    );
    let all = object(&out.stdout);
    assert_eq!(all["exit"]["code"], 1, "{all}");
    has(all["command"].as_str().unwrap(), &["--models rigid"]);
    let runs = all["results"]["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 2);
    assert_eq!(runs[0]["integrator"], "rk4");
    assert!(runs[0]["metrics"][0]["force_l2"].is_number(), "{all}");
    assert!(
        runs[0].get("series").is_none(),
        "histories stay in the record"
    );
    for key in ["record", "report"] {
        let path = std::path::Path::new(all[key].as_str().unwrap());
        assert!(path.is_absolute() && path.is_file(), "{key}");
    }

    let listed = object(&folder.ends("list --json", 0).stdout);
    for key in ["scenes", "models", "integrators", "references"] {
        assert!(!listed[key].as_array().unwrap().is_empty(), "{key}");
    }
    let meshed = object(
        &folder
            .ends("mesh spur_impact --gear pinion --json", 0)
            .stdout,
    );
    assert_eq!(meshed["gears"][0]["teeth"], 20);
    let stiff = "stiffness spur_impact --models rigid --positions 4 --json";
    let stiff = object(&folder.ends(stiff, 0).stdout);
    let row = &stiff["results"]["stiffness"][0];
    assert_eq!(row["label"], "rigid");
    assert!(row["mesh_stiffness_n_per_m2"].as_f64().unwrap() > 1e9);
}

#[test]
fn a_refusal_for_programs_has_file_line_and_help() {
    let folder = Folder::new();
    let wrong = include_str!("../../../scenes/hammer.toml").replacen("module_m", "module_mm", 1);
    let line = wrong
        .lines()
        .position(|l| l.starts_with("module_mm"))
        .unwrap()
        + 1;
    folder.write("mine.toml", &wrong);
    let out = folder.ends("compare mine.toml --json", 2);
    assert!(out.stdout.is_empty());
    let all = object(&out.stderr);
    assert_eq!(all["exit"]["code"], 2);
    assert_eq!(all["error"]["line"], line);
    has(all["error"]["file"].as_str().unwrap(), &["mine.toml"]);
    has(all["error"]["help"].as_str().unwrap(), &["module_m"]);

    let all = object(&folder.ends("compare --repeats 0 --json", 2).stderr);
    has(all["error"]["message"].as_str().unwrap(), &["--repeats"]);
    let all = object(&folder.ends("report nowhere --json", 2).stderr);
    has(all["error"]["message"].as_str().unwrap(), &["nowhere"]);
}

/// A reference of other gears is used only if the user insists, and the report states it.
#[test]
fn a_reference_of_other_gears_is_refused_unless_the_user_insists() {
    let folder = Folder::new();
    let faster = include_str!("../../../scenes/spur_impact.toml").replacen(
        "speed_rad_s = 20.0",
        "speed_rad_s = 22.0",
        1,
    );
    folder.write("mine.toml", &faster);
    folder.write(
        "mine.calibration.toml",
        include_str!("../../../calibrations/spur_impact.toml"),
    );
    let words = [
        "mine.toml:16",
        "initial speed of `pinion` 22 rad/s (reference: 20)",
    ];
    folder.refuses("compare mine.toml --models rigid --integrators rk4", &words);
    folder.refuses(
        "precision mine.toml --models rigid --integrators rk4",
        &words,
    );
    folder.refuses("identify mine.toml --model rigid", &words);
    assert!(!folder.at("out").exists());
    let run =
        "compare mine.toml --models rigid --integrators rk4 --repeats 1 --out here --any-reference";
    let out = folder.command(run).output().unwrap();
    has(&stderr(&out), &["warning:", "initial speed of `pinion`"]);
    has(
        &folder.read("here/results.json"),
        &["initial speed of `pinion` 22 rad/s (reference: 20)"],
    );
}

#[test]
fn a_quiet_command_says_nothing() {
    let folder = Folder::new();
    let out = folder.ends(
        "compare spur_impact --models rigid --integrators rk4 --repeats 1 --quiet --out here",
        1,
    );
    assert!(out.stdout.is_empty() && out.stderr.is_empty(), "{out:?}");
    assert!(folder.at("here/index.html").is_file());
}

/// Errors in arguments have the form of all refusals.
#[test]
fn arguments_are_refused_in_the_style_of_scenes() {
    let folder = Folder::new();
    for (arguments, words) in [
        (
            "compare --modles x",
            [
                "× unexpected argument '--modles'",
                "help: tip: a similar argument exists: '--models'",
            ],
        ),
        ("report nowhere", ["× nowhere/results.json", "help: "]),
    ] {
        has(&stderr(&folder.ends(arguments, 2)), &words);
    }
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = Folder::new();
    let mut command = folder.command("list");
    let mut child = (command.stdout(Stdio::piped()).stderr(Stdio::piped()))
        .spawn()
        .unwrap();
    let mut first = [0; 1];
    let mut out = child.stdout.take().unwrap();
    out.read_exact(&mut first).unwrap();
    drop(out);
    let mut said = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut said)
        .unwrap();
    assert_eq!((child.wait().unwrap().code(), said.as_str()), (Some(0), ""));
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_behind_standard_output_is_an_error() {
    let folder = Folder::new();
    for arguments in ["list", "list --json", "--help"] {
        let full = std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let out = folder.command(arguments).stdout(full).output().unwrap();
        assert_eq!(out.status.code(), Some(2), "{arguments}: {}", stderr(&out));
        has(&stderr(&out), &["standard output cannot be written"]);
    }
}

/// An answer that cannot be written is an error, for a closed output and for a closed pipe.
#[test]
#[cfg(target_os = "linux")]
fn an_answer_that_nobody_can_read_is_an_error() {
    let folder = Folder::new();
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let out = folder
        .command("list --json")
        .stdout(writer)
        .output()
        .unwrap();
    assert_eq!(out.status.code(), Some(2), "{}", stderr(&out));
    has(&stderr(&out), &["standard output cannot be written"]);

    let program = env!("CARGO_BIN_EXE_gearbench");
    for (to, code) in [(">&-", 2), ("> /dev/null", 0)] {
        let mut shell = std::process::Command::new("sh");
        let shell = shell.args(["-c", &format!("exec '{program}' list --json {to}")]);
        let out = shell.current_dir(folder.path()).output().unwrap();
        assert_eq!(out.status.code(), Some(code), "{to}: {}", stderr(&out));
    }
}

/// A path in another encoding is no scene, and no panic, in whatever command and option.
#[test]
#[cfg(unix)]
fn arguments_that_are_not_utf_8_are_refused_or_taken_as_paths() {
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new();
    folder.write("s.toml", include_str!("../malformed/scene.toml"));
    let odd = |before: &str| {
        let bytes = [before.as_bytes(), b"\xff.toml"].concat();
        std::ffi::OsStr::from_bytes(&bytes).to_owned()
    };
    let help = folder.says("--help");
    let commands = help.split("Start:").nth(1).unwrap();
    let commands = commands.split("Documents").next().unwrap();
    let commands: Vec<&str> = (commands
        .lines()
        .filter(|l| l.starts_with("  ") && !l.starts_with("   ")))
    .filter_map(|l| l.split_whitespace().next())
    .filter(|c| *c != "help")
    .collect();
    assert!(commands.len() > 20, "{commands:?}");
    for command in commands {
        for option in ["", "--out=", "--models="] {
            let mut one = folder.command(command);
            if option == "--out=" {
                one.arg("nowhere.toml");
            }
            let out = one.arg(odd(option)).output().unwrap();
            assert_eq!(
                out.status.code(),
                Some(2),
                "{command} {option}: {}",
                stderr(&out)
            );
        }
    }
    // A folder may be called so.
    let mut command =
        folder.command("compare s.toml --models rigid --integrators rk4 --repeats 1 --out");
    let out = command.arg(odd("o")).output().unwrap();
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    assert!(folder.path().join(odd("o")).join("results.json").exists());
}
