//! The command as a user meets it: what it writes, what it refuses, how it ends.

mod choose;
mod compare;
mod mesh;
mod precision;
mod reduce;
mod stability_kill;
mod stiffness;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of its own for a test, removed at the end.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Folder(tempfile::tempdir().unwrap())
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn at(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }
}

/// The command in a folder, with a cache of reductions or `off`.
fn command(folder: &Path, cache: impl AsRef<OsStr>, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gearbench"));
    command
        .args(arguments)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .env("GEARBENCH_CACHE", cache);
    command
}

fn gearbench(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, "off", arguments).output().unwrap()
}

fn stdout(o: &Output) -> String {
    String::from_utf8_lossy(&o.stdout).into_owned()
}

/// What it complains of; diagnostics wrap at the width of the terminal.
fn stderr(o: &Output) -> String {
    let all = String::from_utf8_lossy(&o.stderr);
    let words = all.split_whitespace().filter(|w| *w != "│");
    words.collect::<Vec<_>>().join(" ")
}

fn is_empty(folder: &Path) -> bool {
    std::fs::read_dir(folder).unwrap().next().is_none()
}

#[test]
fn help_and_list_teach() {
    let folder = Folder::new();
    let help = gearbench(folder.path(), &["--help"]);
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
    let list = gearbench(folder.path(), &["list"]);
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
    let wrong = gearbench(folder.path(), &["compare", "--modles", "x"]);
    assert_eq!(wrong.status.code(), Some(2));
}

/// The name `modes` is kept for the natural modes of an assembled scene.
#[test]
fn the_former_name_of_the_truncation_study_is_refused_with_the_new_one() {
    let folder = Folder::new();
    let out = gearbench(folder.path(), &["modes", "spur_impact", "--counts", "0,25"]);
    assert_eq!(out.status.code(), Some(2), "{}", stderr(&out));
    assert!(
        stderr(&out).contains("`gearbench truncation`"),
        "{}",
        stderr(&out)
    );
    assert!(is_empty(folder.path()));
}
