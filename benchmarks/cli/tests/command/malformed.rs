//! Tests of malformed input of every kind, from a table: no case panics or ends with an unexpected exit code.
//!
//! `tests/malformed/cases.tsv` has the cases and says how it is read. The quick ones run in every test; all are measured,
//! each with exit code, wall time and greatest memory, by
//! `cargo test --release -p gearbench-cli --test command -- --ignored malformed`, which needs `/usr/bin/time` and writes
//! `tests/malformed/measured.csv`.

use super::Folder;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

const TABLE: &str = include_str!("../malformed/cases.tsv");
const SCENE: &str = include_str!("../malformed/scene.toml");
const DECK: &str = include_str!("../malformed/gear.inp");

/// Greatest memory [kB] and time [s] of a case.
const BOUNDS: (u64, f64) = (2_000_000, 10.0);

/// A line of the table.
struct Case {
    codes: Vec<i32>,
    quick: bool,
    command: &'static str,
    edits: &'static str,
}

fn cases() -> Vec<Case> {
    let lines = TABLE
        .lines()
        .filter(|l| !l.is_empty() && !l.starts_with('#'));
    let cases = lines.map(|line| {
        let mut parts = line.split('\t');
        let (codes, command) = (parts.next().unwrap(), parts.next().unwrap());
        Case {
            codes: codes.split(' ').filter_map(|c| c.parse().ok()).collect(),
            quick: !codes.ends_with("slow"),
            command,
            edits: parts.next().unwrap_or(""),
        }
    });
    cases.collect()
}

/// The sound files: a scene, a deck, its reduction, a record.
fn sound() -> Folder {
    let folder = Folder::new();
    folder.write("s.toml", SCENE);
    folder.write("g.inp", DECK);
    folder.says("reduce g.inp --modes 2 --out g.npz");
    folder.says("compare s.toml --models rigid --integrators rk4 --repeats 1 --out r");
    folder
}

/// A folder for a case, and the command in it.
fn prepared(case: &Case, sound: &Folder) -> (Folder, Command) {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.at("r")).unwrap();
    for name in ["s.toml", "g.inp", "g.npz", "r/results.json"] {
        let top = name.split('/').next().unwrap();
        if case.command.contains(top) || case.edits.contains(name) {
            std::fs::copy(sound.at(name), folder.at(name)).unwrap();
        }
    }
    for file in case.edits.split(" ;; ").filter(|e| !e.is_empty()) {
        let (name, edits) = file.split_once(": ").unwrap();
        for edit in edits.split(" && ") {
            change(&folder.at(name), edit);
        }
    }
    let command = folder.command(case.command);
    (folder, command)
}

/// Does an edit to a file.
fn change(path: &Path, edit: &str) {
    let before = std::fs::read(path).unwrap_or_default();
    let at = |per_cent: &str| {
        let part: usize = per_cent.parse().unwrap();
        (before.len() * part / 100).min(before.len().saturating_sub(1))
    };
    let breaks = |text: &str| text.replace("\\n", "\n");
    let (word, rest) = edit.split_once(' ').unwrap_or((edit, ""));
    let after = match word {
        "!keep" => return,
        "!empty" => Vec::new(),
        "!cut" => before[..at(rest)].to_vec(),
        "!flip" => {
            let mut bytes = before.clone();
            bytes[at(rest)] ^= 0xff;
            bytes
        }
        "!bytes" => [&before[..], &[0xff, 0xfe, 0x00, 0x80]].concat(),
        "!append" => [&before[..], b"\n", breaks(rest).as_bytes(), b"\n"].concat(),
        "!text" => breaks(rest).into_bytes(),
        "!repeat" => {
            let (count, text) = rest.split_once(' ').unwrap();
            let many = text.repeat(count.parse().unwrap());
            [&before[..], many.as_bytes()].concat()
        }
        "!delete" | "!folder" => {
            let _ = std::fs::remove_file(path);
            if word == "!folder" {
                std::fs::create_dir_all(path).unwrap();
            }
            return;
        }
        _ => {
            let (old, new) = edit.split_once(" =>").unwrap_or_else(|| panic!("{edit}"));
            let (old, new) = (breaks(old), breaks(new.strip_prefix(' ').unwrap_or(new)));
            let text = String::from_utf8(before.clone()).unwrap();
            assert!(text.contains(&old), "`{old}` is not in {}", path.display());
            text.replacen(&old, &new, 1).into_bytes()
        }
    };
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent).unwrap();
    }
    std::fs::write(path, after).unwrap();
}

/// Returns a description of a wrong end of a case; `None` if it ended as expected.
fn flaw(case: &Case, out: &Output) -> Option<String> {
    let said = String::from_utf8_lossy(&out.stderr);
    let code = out.status.code();
    let panicked = said.contains("panicked at") || said.contains("stack overflow");
    let told = code != Some(2) || !said.trim().is_empty();
    let right = code.is_some_and(|c| case.codes.contains(&c));
    let says: String = said.chars().take(300).collect();
    (panicked || !right || !told).then(|| {
        format!(
            "{}\t{}\nends with {code:?}, expected {:?}: {says}\n",
            case.command, case.edits, case.codes
        )
    })
}

/// Runs cases on two threads and returns the results of `run` in the order of the cases.
fn each<T: Send>(cases: &[Case], run: impl Fn(&Case) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some((i, case)) = Some(next.fetch_add(1, Ordering::Relaxed))
                    .and_then(|i| Some((i, cases.get(i)?)))
                {
                    let found = run(case);
                    done.lock().unwrap().push((i, found));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap();
    done.sort_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, found)| found).collect()
}

#[test]
fn malformed_input_is_refused_with_its_code() {
    let mut all = cases();
    assert!(all.len() >= 300, "{} cases", all.len());
    all.retain(|c| c.quick);
    let sound = sound();
    let flaws = each(&all, |case| {
        let (_folder, mut command) = prepared(case, &sound);
        flaw(case, &command.output().unwrap())
    });
    let flaws: Vec<String> = flaws.into_iter().flatten().collect();
    assert!(
        flaws.is_empty(),
        "{} flaws:\n{}",
        flaws.len(),
        flaws.join("\n")
    );
}

#[test]
#[ignore = "measures all cases, one after the other: cargo test --release -p gearbench-cli --test command -- --ignored malformed"]
fn malformed_input_is_refused_in_little_time_and_memory() {
    let sound = sound();
    let mut table = String::from("exit_code,wall_s,peak_memory_mb,command,edits\n");
    let mut flaws = Vec::new();
    for case in cases() {
        let (folder, command) = prepared(&case, &sound);
        let figures: PathBuf = folder.at("figures");
        // A command that does not end by itself ends with 124, without time and memory.
        let mut timed = Command::new("timeout");
        timed
            .args(["40", "/usr/bin/time", "-q", "-f", "%e %M", "-o"])
            .arg(&figures);
        timed.arg(command.get_program()).args(command.get_args());
        timed.current_dir(folder.path());
        for (key, value) in command.get_envs() {
            timed.env(key, value.unwrap_or_default());
        }
        let out = timed.output().unwrap();
        flaws.extend(flaw(&case, &out));
        let figures = std::fs::read_to_string(&figures).unwrap_or("40 0".into());
        let (wall, memory) = figures.trim().split_once(' ').unwrap();
        let (wall, memory): (f64, u64) = (wall.parse().unwrap(), memory.parse().unwrap());
        if memory > BOUNDS.0 || wall > BOUNDS.1 {
            flaws.push(format!(
                "{}\t{}\n{wall} s, {memory} kB\n",
                case.command, case.edits
            ));
        }
        let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
        let _ = writeln!(
            table,
            "{},{wall},{:.0},{},{}",
            out.status.code().unwrap_or(-1),
            memory as f64 / 1e3,
            quoted(case.command),
            quoted(case.edits)
        );
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/malformed/measured.csv");
    std::fs::write(path, table).unwrap();
    assert!(
        flaws.is_empty(),
        "{} flaws:\n{}",
        flaws.len(),
        flaws.join("\n")
    );
}
