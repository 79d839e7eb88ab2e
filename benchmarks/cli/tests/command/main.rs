//! Tests of the command line: output, refusals and exit codes.

mod axes;
mod bounds;
mod check;
mod choose;
mod compare;
mod coupling;
mod damping;
mod documents;
mod drives;
mod files;
mod fmu;
mod folders;
mod identify;
mod init;
mod judged;
mod kill;
mod malformed;
mod measured;
mod mesh;
mod precision;
mod reduce;
mod reference;
mod rerun;
mod rexs;
mod scan;
mod seeds;
mod signals;
mod stiffness;
mod tables;
mod terminal;
mod view;
mod yardstick;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// A folder of its own for a test, removed at the end.
struct Folder {
    folder: tempfile::TempDir,
    /// True if the folder has a cache of its own, `cache`; else reductions are computed once for all tests.
    cached: bool,
}

/// The cache of reductions that tests share. It begins empty in every run of the tests, so that no reduction of earlier
/// code is used.
fn shared_cache() -> &'static Path {
    static CACHE: OnceLock<PathBuf> = OnceLock::new();
    CACHE.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cache-of-command-tests");
        let _ = std::fs::remove_dir_all(&folder);
        folder
    })
}

impl Folder {
    fn new() -> Self {
        Folder {
            folder: tempfile::tempdir().unwrap(),
            cached: false,
        }
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn at(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    fn read(&self, name: &str) -> String {
        let text = std::fs::read_to_string(self.at(name));
        text.unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.at(name), text).unwrap();
    }

    fn files(&self) -> usize {
        std::fs::read_dir(self.path()).unwrap().count()
    }

    /// The command with arguments between blanks.
    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gearbench"));
        command
            .args(arguments.split_whitespace())
            .current_dir(self.path())
            .env("NO_COLOR", "1");
        match self.cached {
            true => command.env("GEARBENCH_CACHE", self.at("cache")),
            false => command.env("GEARBENCH_CACHE", shared_cache()),
        };
        command
    }

    /// Runs it to an exit code.
    fn ends(&self, arguments: &str, code: i32) -> Output {
        let out = self.command(arguments).output().unwrap();
        let said = format!("{arguments}: {}{}", stdout(&out), stderr(&out));
        assert_eq!(out.status.code(), Some(code), "{said}");
        out
    }

    /// Runs the program, which must succeed, and returns its standard output.
    fn says(&self, arguments: &str) -> String {
        stdout(&self.ends(arguments, 0))
    }

    /// Runs the program, which must refuse its input with messages that contain `words`.
    fn refuses(&self, arguments: &str, words: &[&str]) {
        has(&stderr(&self.ends(arguments, 2)), words);
    }
}

fn has(said: &str, words: &[&str]) {
    for word in words {
        assert!(said.contains(word), "`{word}` is missing in\n{said}");
    }
}

fn stdout(o: &Output) -> String {
    String::from_utf8_lossy(&o.stdout).into_owned()
}

/// Asserts that the record of a folder reads back as it is, so that it has the keys of its types (and of the schema), and
/// that the dictionary describes every column of its CSV files.
fn as_documented(folder: &std::path::Path) {
    use gearbench_reports::dictionary::is_described;
    if let Ok(text) = std::fs::read_to_string(folder.join("results.json")) {
        let record: serde_json::Value = serde_json::from_str(&text).unwrap();
        let read: gearbench_reports::record::Results = serde_json::from_str(&text).unwrap();
        assert_eq!(serde_json::to_value(&read).unwrap(), record);
    }
    let described = gearbench::studies::files();
    // A study may write no files, only its printed result.
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "csv") {
            let text = std::fs::read_to_string(&path).unwrap();
            let name = path.file_name().unwrap().to_string_lossy();
            for column in text.lines().next().unwrap_or_default().split(',') {
                assert!(
                    is_described(&described, &name, column),
                    "{column} of {name}"
                );
            }
        }
    }
}

/// Returns standard error with single spaces; diagnostics wrap at the width of the terminal.
fn stderr(o: &Output) -> String {
    let all = String::from_utf8_lossy(&o.stderr);
    let words = all.split_whitespace().filter(|w| *w != "│");
    words.collect::<Vec<_>>().join(" ")
}

#[test]
fn help_and_list_teach() {
    let folder = Folder::new();
    let words = "Examples: compare identify Exit results.json --json --quiet 130";
    has(
        &folder.says("--help"),
        &words.split(' ').collect::<Vec<_>>(),
    );
    let words = "spur_impact hammer movable-teeth dopri5 calculix/case-a-fine";
    let list = folder.says("list");
    has(&list, &words.split(' ').collect::<Vec<_>>());
    assert!(list.lines().count() < 80, "{}", list.lines().count());
    has(&folder.says("list models"), &["tooth_mass_kg", "required"]);
    assert!(!folder.says("list models").contains("dopri5"));
    folder.refuses("list modells", &["models"]);
    // The documents that are embedded in the program.
    has(
        &folder.says("help scene"),
        &["# ", "centre_distance_m", "```toml"],
    );
    has(&folder.says("help limits"), &["**Plausibility.**"]);
    has(&folder.says("help compare"), &["--models", "Examples:"]);
    folder.refuses("help scenne", &["did you mean `scene`"]);
    let version = folder.says("--version");
    assert!(
        version.contains("(commit ") && version.lines().count() == 1,
        "{version}"
    );
    folder.ends("compare --modles x", 2);
}

/// Natural frequencies of the driveline, for people and for programs; full finite elements are refused with a way out.
#[test]
fn natural_frequencies_are_told() {
    let folder = Folder::new();
    let said = folder.says("modes driveline --out modes");
    has(&said, &["loaded", "torsion of", "mesh pinion - wheel"]);
    as_documented(&folder.at("modes"));
    let record = std::fs::read_to_string(folder.at("modes").join("results.json")).unwrap();
    let record: serde_json::Value = serde_json::from_str(&record).unwrap();
    assert_eq!(record["study"], "modes");
    folder.refuses(
        "modes spur_impact --models fe --out fe",
        &["too many", "elastic gears"],
    );
    folder.refuses("modes driveline --group 3", &["0 to 0.1"]);
}

/// A scene without a run-up of its own is brought from speed to speed; a gear that is none is refused with those that are.
#[test]
fn run_ups_are_told() {
    let folder = Folder::new();
    let command =
        "run-up loaded_mesh --models rigid --from 200 --to 900 --over 0.08 --samples 16384";
    let said = folder.says(&format!("{command} --out run-up"));
    has(
        &said,
        &["x mesh", "transmission error pinion - wheel", "rad/s"],
    );
    as_documented(&folder.at("run-up"));
    let record = std::fs::read_to_string(folder.at("run-up").join("results.json")).unwrap();
    let record: serde_json::Value = serde_json::from_str(&record).unwrap();
    assert_eq!(record["study"], "run-up");
    let order = record["run_ups"][0]["orders"][0]["order"].as_f64().unwrap();
    assert!((order - 16.0).abs() < 1e-3, "{order}");
    folder.refuses(
        "run-up loaded_mesh --models rigid --gear sun --out gear",
        &["no rotating gear `sun`", "pinion, wheel"],
    );
    folder.refuses("run-up loaded_mesh --from 200", &["--to"]);
}
