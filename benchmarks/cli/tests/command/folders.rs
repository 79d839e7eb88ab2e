//! Tests of output folders and files: one owner at a time, no foreign file replaced, no partial file left behind.

use super::{Folder, has, stderr, stdout};
use serde_json::Value;
use std::process::{Command, Stdio};
use std::time::Duration;

const SCENE: &str = include_str!("../malformed/scene.toml");
/// Command with one run of some milliseconds.
const COMPARE: &str = "compare s.toml --models rigid --integrators rk4 --repeats 1";

fn with_scene() -> Folder {
    let folder = Folder::new();
    folder.write("s.toml", SCENE);
    folder
}

#[test]
fn a_folder_belongs_to_one_study_of_one_scene() {
    let folder = with_scene();
    folder.says(&format!("{COMPARE} --out o"));
    let first = folder.read("o/results.json");
    // The command is repeated, and repeated after an edit of the scene.
    folder.says(&format!("{COMPARE} --out o"));
    folder.write("s.toml", &SCENE.replace("A sound scene", "An edited scene"));
    folder.says(&format!(
        "{} --out o",
        COMPARE.replace("repeats 1", "repeats 2")
    ));
    has(&folder.read("o/results.json"), &["An edited scene"]);
    assert_ne!(folder.read("o/results.json"), first);
    let kept = folder.read("o/results.json");
    // Another file whose scene has the same name, other models, another study.
    folder.write("t.toml", SCENE);
    for (command, words) in [
        (
            COMPARE.replace("s.toml", "t.toml"),
            "another scene of the same name",
        ),
        (
            COMPARE.replace("rigid", "movable-teeth"),
            "another choice of models",
        ),
        (
            COMPARE.replace("--models rigid ", ""),
            "another choice of models",
        ),
        (
            "precision s.toml --models rigid --integrators rk4@1us".to_owned(),
            "another study",
        ),
    ] {
        let command = format!("{command} --out o");
        folder.refuses(
            &command,
            &[words, "gearbench compare s.toml", "--out", "--force"],
        );
        assert_eq!(folder.read("o/results.json"), kept, "{command}");
        assert!(!folder.at("o/.lock").exists() && !folder.at("o/journal.jsonl").exists());
    }
    folder.says(&format!(
        "{} --out o --force",
        COMPARE.replace("rigid", "movable-teeth")
    ));
    has(&folder.read("o/results.json"), &["movable-teeth"]);
}

#[test]
fn what_is_not_of_gearbench_is_not_replaced() {
    let folder = with_scene();
    for (name, text, words) in [
        ("results.json", "{\"mine\": 1}", "not a record of gearbench"),
        ("index.html", "<p>mine", "files that no study has written"),
        (
            "measured.csv",
            "t,f\n0,1\n",
            "files that no study has written",
        ),
        ("journal.jsonl", "{\"mine\": 1}\n", "not gearbench's"),
    ] {
        std::fs::create_dir(folder.at("o")).unwrap();
        folder.write(&format!("o/{name}"), text);
        folder.refuses(&format!("{COMPARE} --out o"), &[words, "--out"]);
        assert_eq!(folder.read(&format!("o/{name}")), text);
        assert_eq!(std::fs::read_dir(folder.at("o")).unwrap().count(), 1);
        std::fs::remove_dir_all(folder.at("o")).unwrap();
    }
    // A table that the scene reads, in the folder that its study would write to.
    folder.says("reference s.toml --model rigid --method dopri5@1e-8 --out measured.csv --add");
    folder.refuses(
        &format!("{COMPARE} --out . --force"),
        &["measured.csv", "--out"],
    );
    std::fs::create_dir(folder.at("empty")).unwrap();
    folder.says(&format!("{COMPARE} --out empty"));
}

#[test]
fn an_output_is_never_an_input_and_no_foreign_file() {
    let folder = with_scene();
    folder.write("library.so", "the library");
    folder.write("mine.csv", "t,f\n0,1\n");
    folder.write("mine.inp", "*NODE\n1, 0, 0, 0\n");
    for name in ["mine.npz", "mine.vtu", "mine.fmu"] {
        folder.write(name, "mine");
    }
    folder.says("reference s.toml --model rigid --method dopri5@1e-8 --out ref.csv --add");
    let scene = folder.read("s.toml");
    let reference = "reference s.toml --model movable-teeth --method dopri5@1e-6";
    let fmu = "fmu s.toml --library library.so";
    let mesh = "mesh s.toml --gear pinion --flank 3 --rim 1 --width 1";
    for (command, out, force) in [
        (reference, "--out s.toml", false),
        (reference, "--out ./ref.csv", false),
        (fmu, "--out s.toml", false),
        (fmu, "--out library.so", false),
        (reference, "--out mine.csv", true),
        (fmu, "--out mine.fmu", true),
        (mesh, "--out mine.inp", true),
        (mesh, "--vtu mine.vtu", true),
        (
            "reduce s.toml --gear pinion --modes 2",
            "--out mine.npz",
            true,
        ),
    ] {
        let name = out.split_once(' ').unwrap().1;
        let before = std::fs::read(folder.at(name)).unwrap();
        folder.refuses(&format!("{command} {out}"), &["--out"]);
        if !force {
            folder.refuses(
                &format!("{command} {out} --force"),
                &["input of the command"],
            );
        }
        assert_eq!(
            std::fs::read(folder.at(name)).unwrap(),
            before,
            "{command} {out}"
        );
        if force {
            folder.says(&format!("{command} {out} --force"));
            assert_ne!(
                std::fs::read(folder.at(name)).unwrap(),
                before,
                "{command} {out}"
            );
            // What the command wrote itself it writes again.
            folder.says(&format!("{command} {out}"));
        }
    }
    assert_eq!(folder.read("s.toml"), scene);
    let left = std::fs::read_dir(folder.path()).unwrap();
    let left = left.filter(|e| {
        e.as_ref()
            .unwrap()
            .file_name()
            .to_string_lossy()
            .contains(".part")
    });
    assert_eq!(left.count(), 0);
}

/// The path of a reference from the folder of the scene, whatever lies between them.
#[test]
fn a_scene_names_its_reference_by_a_relative_path() {
    let folder = Folder::new();
    for name in ["scenes", "tables"] {
        std::fs::create_dir(folder.at(name)).unwrap();
    }
    folder.write("scenes/s.toml", SCENE);
    folder.says(
        "reference scenes/s.toml --model rigid --method dopri5@1e-6 --out tables/a.csv --add",
    );
    has(
        &folder.read("scenes/s.toml"),
        &["csv = \"../tables/a.csv\""],
    );
    folder.says("compare scenes/s.toml --models rigid --integrators dopri5@1e-6 --repeats 1");
}

#[test]
fn a_baseline_lies_beside_its_check() {
    let folder = with_scene();
    for name in ["../x.jsonl", "/tmp/x.jsonl", "a/../../x.jsonl", ""] {
        let text = format!("schema = 1\nbaseline = \"{name}\"\n[[cases]]\nscene = \"s.toml\"\n");
        folder.write("check.toml", &text);
        folder.refuses("check --update --out r", &["check.toml:2", "baseline"]);
    }
    assert_eq!(folder.files(), 2);
}

/// The next start removes the staging folder and the lock of a process that was killed while it wrote.
#[test]
fn staging_folders_of_dead_processes_go() {
    let folder = with_scene();
    folder.says(&format!("{COMPARE} --out o"));
    for command in [&format!("{COMPARE} --out o"), "report o"] {
        std::fs::create_dir(folder.at("o/.staging-12345")).unwrap();
        folder.write("o/.staging-12345/results.json", "{");
        folder.write("o/.lock", "{\"pid\": 12345}");
        folder.says(command);
        assert!(!folder.at("o/.staging-12345").exists(), "{command}");
        assert!(!folder.at("o/.lock").exists(), "{command}");
    }
}

#[test]
fn the_cache_is_shown_and_cleared() {
    let mut folder = with_scene();
    folder.cached = true;
    folder.says("reduce s.toml --gear pinion --modes 2");
    let files = || std::fs::read_dir(folder.at("cache")).unwrap().count();
    assert_eq!(files(), 1);
    folder.write("cache/notes.txt", "mine");
    let shown = |arguments: &str| -> Value {
        let out = folder.ends(arguments, 0);
        serde_json::from_str::<Value>(&stdout(&out)).unwrap()["cache"].clone()
    };
    let cache = shown("list --json");
    assert_eq!(cache["files"], 1);
    assert!(cache["bytes"].as_u64().unwrap() > 1000, "{cache}");
    has(
        &folder.says("list"),
        &["cache of reductions", "1 files", "--clear-cache"],
    );
    assert_eq!(shown("list --clear-cache --json")["files"], 0);
    assert_eq!(files(), 1, "a file of somebody else stays");
}

/// A scene under load that has models for all studies, most of them cheap.
fn loaded(folder: &Folder) {
    folder.says("init loaded_mesh --out m.toml");
    let scene = folder.read("m.toml").replace(
        "flank_elements = 12, width_elements = 3, modes = 60",
        "flank_elements = 4, width_elements = 1, modes = 4",
    );
    folder.write("m.toml", &scene);
    folder.write("s.toml", SCENE);
    folder.says("init spur_impact --out own.toml");
    folder.says("init pair");
    folder.write(
        "check.toml",
        "schema = 1\n[[cases]]\nscene = \"s.toml\"\nmodels = [\"rigid\"]\nintegrators = [\"rk4@2ns\"]\n",
    );
    folder.says("check --update --no-runtime --out c");
}

/// Studies in some of their cheapest forms.
const QUICK: [&str; 11] = [
    "compare s.toml --models rigid --integrators rk4@2ns",
    "precision s.toml --models rigid --integrators rk4",
    "stability s.toml --models rigid --integrators rk4 --grid 3x3 --duration 1e-4 --axis contact-stiffness=1:2 --no-refine",
    "identify own.toml --model rigid",
    "stiffness s.toml --models rigid,movable-teeth --positions 400",
    "modes m.toml --models rigid,elastic",
    "response m.toml --models rigid,movable-teeth --points 60",
    "sweep m.toml --models rigid --points 3 --cycles 2",
    "coupling s.toml --models rigid --steps 1e-6:6.4e-5:4",
    "run-up m.toml --models rigid --from 200 --to 900 --over 0.05 --samples 8192",
    "check --no-runtime",
];
/// Studies that solve finite elements: only the last of their pairs is run to its end.
const DEAR: [&str; 3] = [
    "choose s.toml --tolerance 0.2 --metric impulse",
    "penalty pair.toml --model elastic --points 2 --positions 2",
    "truncation own.toml --counts 5,10 --no-refine --repeats 1",
];

fn signal(name: &str, pid: u32) {
    let sent = Command::new("kill")
        .args([&format!("-{name}"), &pid.to_string()])
        .status();
    assert!(sent.unwrap().success());
}

/// Starts a study twice in one folder: the first, which is stopped in the middle, works; the second is refused with the
/// first as owner, and leaves the folder alone. Returns the exit code of the first.
#[cfg(target_os = "linux")]
fn pair(folder: &Folder, study: &str, n: usize, to_the_end: bool) -> Option<i32> {
    // A first process that ended, or had not named itself yet, when it was stopped is no pair.
    let mut attempts = (0..50).filter_map(|_| attempt(folder, study, n, to_the_end));
    attempts
        .next()
        .unwrap_or_else(|| panic!("{study}: it was never stopped in its folder"))
}

/// Runs one attempt of a pair of processes.
#[cfg(target_os = "linux")]
fn attempt(folder: &Folder, study: &str, n: usize, to_the_end: bool) -> Option<Option<i32>> {
    let out = format!("pair-{n}");
    let command = format!("{study} --out {out}");
    let lock = folder.at(&out).join(".lock");
    let mut first = folder.command(&command);
    first.stdout(Stdio::null()).stderr(Stdio::null());
    let mut first = first.spawn().unwrap();
    let pid = first.id();
    loop {
        // The lines are read after the process has stopped.
        if lock.exists() {
            signal("STOP", pid);
            break;
        }
        if first.try_wait().unwrap().is_some() {
            std::fs::remove_dir_all(folder.at(&out)).unwrap();
            return None;
        }
        std::thread::sleep(Duration::from_micros(100));
    }
    let owned = std::fs::read_to_string(&lock).unwrap_or_default();
    let refused = owned.contains(&pid.to_string()).then(|| {
        let second = folder.command(&command).output().unwrap();
        (second.status.code(), stderr(&second))
    });
    if !to_the_end {
        signal("KILL", pid);
    }
    signal("CONT", pid);
    let code = first.wait().unwrap().code();
    let Some((refused, said)) = refused else {
        std::fs::remove_dir_all(folder.at(&out)).unwrap();
        return None;
    };
    assert_eq!(refused, Some(2), "{study}: {said}");
    has(
        &said,
        &[
            &format!("process {pid} on"),
            "works in this folder since",
            "--out",
        ],
    );
    assert!(!(to_the_end && lock.exists()), "{study}");
    Some(code)
}

/// Makes pairs of every study.
#[cfg(target_os = "linux")]
fn pairs(studies: &[&str], each: usize, all_to_the_end: bool) {
    let mut folder = Folder::new();
    folder.cached = true;
    loaded(&folder);
    for study in studies {
        for n in 1..=each {
            let to_the_end = all_to_the_end || n == each;
            let code = pair(&folder, study, n, to_the_end);
            let out = format!("pair-{n}");
            if to_the_end {
                assert!([Some(0), Some(1)].contains(&code), "{study}: {code:?}");
                let record = gearbench_reports::load_results(&folder.at(&out));
                assert!(record.is_ok() || study.starts_with("stiffness"), "{study}");
            }
            std::fs::remove_dir_all(folder.at(&out)).unwrap();
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn two_processes_do_not_write_one_folder() {
    pairs(&QUICK, 1, true);
}

/// Takes some minutes: `cargo test --release -p gearbench-cli --test command -- --ignored two_processes`.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "twenty pairs of every study, some minutes"]
fn two_processes_do_not_write_one_folder_in_twenty_pairs() {
    pairs(&QUICK, 20, true);
    pairs(&DEAR, 20, false);
}

/// `report` writes a folder as well.
#[test]
fn a_report_waits_for_the_owner() {
    let folder = with_scene();
    folder.says(&format!("{COMPARE} --out o"));
    let lock = std::fs::File::create(folder.at("o/.lock")).unwrap();
    lock.lock().unwrap();
    for command in [
        "report o".to_owned(),
        format!("{COMPARE} --out o"),
        format!("{COMPARE} --out o --force"),
    ] {
        folder.refuses(&command, &["another process works in this folder", "--out"]);
    }
    drop(lock);
    folder.says("report o");
}
