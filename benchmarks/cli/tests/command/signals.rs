//! Tests of signals: exit code 130 in every phase of every command, with a report of the finished runs.
#![cfg(target_os = "linux")]

use super::kill::{finish, lines, start};
use super::{Folder, has, stderr, stdout};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

fn send(signal: &str, pid: u32) {
    let sent = Command::new("kill")
        .args([&format!("-{signal}"), &pid.to_string()])
        .status();
    assert!(sent.unwrap().success());
}

/// Signals that a process treats in some manner (`SigCgt`, `SigIgn`), as bits.
fn signals(pid: u32, manner: &str) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|l| l.strip_prefix(manner)?.strip_prefix(':'));
    mask.map_or(0, |m| u64::from_str_radix(m.trim(), 16).unwrap())
}

const HUP: u64 = 1;
const INT: u64 = 1 << 1;
const TERM: u64 = 1 << 14;

/// Returns the signals that the tests do not ignore: as background jobs of a shell they inherit that SIGINT is ignored,
/// and so do their programs.
fn heard() -> Vec<&'static str> {
    let ignored = signals(std::process::id(), "SigIgn");
    let all = [("INT", INT), ("TERM", TERM), ("HUP", HUP)];
    let heard = all.into_iter().filter(|(_, mask)| ignored & mask == 0);
    heard.map(|(name, _)| name).collect()
}

/// Waits until a program has got so far that it catches all signals that it hears, its first act. It begins to catch
/// them one after the other: one that has not come to its turn would end the program without a code.
fn begun(child: &mut Child) {
    let ends = INT | TERM | HUP;
    while ends & !signals(child.id(), "SigIgn") & !signals(child.id(), "SigCgt") != 0 {
        assert!(child.try_wait().unwrap().is_none(), "it ended before");
        std::thread::sleep(Duration::from_micros(100));
    }
}

/// Meshing, reduction and loading of scenes take seconds in these.
const SET_UP: [&str; 4] = [
    "mesh spur_impact --flank 60 --across 40 --width 40 --out g.inp",
    "reduce spur_impact --modes 200 --out g.npz",
    "compare spur_impact --models elastic --repeats 1 --out o",
    "response loaded_mesh --models elastic --out o",
];

#[test]
fn a_signal_in_set_up_ends_the_program_with_130() {
    let heard = heard();
    for (i, command) in SET_UP.iter().enumerate() {
        let folder = Folder::new();
        let mut command_line = folder.command(command);
        command_line.stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command_line.spawn().unwrap();
        begun(&mut child);
        send(heard[i % heard.len()], child.id());
        let out = child.wait_with_output().unwrap();
        assert_eq!(out.status.code(), Some(130), "{command}: {}", stderr(&out));
        assert!(!folder.at("g.inp").exists() && !folder.at("g.npz").exists());
    }
}

/// A signal that `nohup` has set to be ignored stays ignored.
#[test]
fn a_signal_that_is_ignored_stays_ignored() {
    let folder = Folder::new();
    let mut shell = Command::new("sh");
    let program = env!("CARGO_BIN_EXE_gearbench");
    let script = format!("trap '' HUP; exec '{program}' reduce spur_impact --modes 200");
    shell
        .args(["-c", &script])
        .env("GEARBENCH_CACHE", "off")
        .current_dir(folder.path());
    let mut child = shell
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    begun(&mut child);
    assert_eq!(signals(child.id(), "SigIgn") & HUP, HUP);
    assert_eq!(signals(child.id(), "SigCgt") & HUP, 0);
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn an_interrupted_study_reports_what_is_finished_and_goes_on() {
    let study = "sweep loaded_mesh --models rigid --from 1000 --to 3000 --points 24 --cycles 4";
    for signal in heard() {
        let folder = Folder::new();
        let child = start(&folder, study, true);
        while lines(&folder) < 4 {
            std::thread::sleep(Duration::from_micros(200));
        }
        send(signal, child.id());
        let out = child.wait_with_output().unwrap();
        assert_eq!(out.status.code(), Some(130), "{}", super::stderr(&out));
        let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
        assert!(
            (1..24).contains(&record.runs.len()),
            "{} runs",
            record.runs.len()
        );
        let said = record
            .settings
            .iter()
            .any(|(what, _)| what == "interrupted");
        assert!(said && folder.at("here/index.html").exists());
        finish(&folder, study);
        let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
        assert_eq!(record.runs.len(), 48);
    }
}

/// Starts a study, interrupts it when its journal has some lines, and returns its output.
fn interrupted(folder: &Folder, study: &str, at: usize) -> String {
    let mut command = folder.command(&format!("{study} --out here"));
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    while lines(folder) < at {
        assert!(child.try_wait().unwrap().is_none(), "{study} ended before");
        std::thread::sleep(Duration::from_micros(100));
    }
    send("TERM", child.id());
    let out = child.wait_with_output().unwrap();
    assert_eq!(out.status.code(), Some(130), "{study}: {}", stderr(&out));
    stdout(&out)
}

/// A check reports the entries that were run, and stores no baseline of a part; an identification the models that were
/// fitted; a choice, which is of the whole or none, the number of its pieces.
#[test]
fn checks_identifications_and_choices_report_what_is_finished() {
    let folder = Folder::new();
    folder.write("s.toml", include_str!("../malformed/scene.toml"));
    let methods = (1..=40).map(|i| format!("\"rk4@{}ns\"", 20 + i));
    let methods = methods.collect::<Vec<_>>().join(", ");
    folder.write(
        "check.toml",
        &format!(
            "schema = 1\n[[cases]]\nscene = \"s.toml\"\nmodels = [\"rigid\"]\nintegrators = [{methods}]\n"
        ),
    );
    let said = interrupted(&folder, "check --update --no-runtime", 4);
    has(&said, &["interrupted", "the same command continues"]);
    assert!(!folder.at("check.baseline.jsonl").exists());
    let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
    let gearbench_reports::Part::Check(part) = record.part else {
        panic!("a record of another study")
    };
    assert!(
        (1..40).contains(&part.entries.len()),
        "{}",
        part.entries.len()
    );
    let said = folder.says("check --update --no-runtime --out here");
    has(&said, &["continuing after", "stored:"]);

    let folder = Folder::new();
    folder.says("init spur_impact --out own.toml");
    let said = interrupted(&folder, "identify own.toml --write", 3);
    has(&said, &["interrupted", "the same command continues"]);
    assert!(!folder.at("own.calibration.toml").exists());

    let folder = Folder::new();
    folder.write("s.toml", include_str!("../malformed/scene.toml"));
    let said = interrupted(&folder, "choose s.toml --metric peak --tolerance 0.01", 3);
    has(&said, &["finished pieces are stored"]);
}
