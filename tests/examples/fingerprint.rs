//! Make:    `cargo run --release -p gearbench-tests --example fingerprint -- OUT_FILE [--only STUDY]`
//! Compare: `cargo run --release -p gearbench-tests --example fingerprint -- --compare OLD NEW`
//!
//! Writes what every study computes on the scenes of `tests/fingerprint` (see `gearbench_tests::fingerprint`), about a
//! minute of processor time. `--compare` lists keys that differ, by bits, after the renames of
//! `tests/golden/renames.txt`, and fails if a value changed or is gone. `--golden` writes the stored form that the test
//! `golden` holds results against.
#![allow(clippy::print_stdout, clippy::print_stderr)]

use gearbench_tests::fingerprint::{
    Difference, List, Renames, differences, fingerprint, golden_form, studies,
};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const HEADER: &str = "# What every study computes on the scenes of tests/fingerprint, without hashes of bits, made by:\n\
    #   cargo run --release -p gearbench-tests --example fingerprint -- --golden\n";

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("golden")
        .join(name)
}

fn read(path: &Path) -> List {
    let text = std::fs::read_to_string(path);
    List::of_text(&text.unwrap_or_else(|e| panic!("{}: {e}", path.display())))
}

fn compare(old: &Path, new: &Path) -> ExitCode {
    let renames = std::fs::read_to_string(golden("renames.txt")).expect("the renames");
    let old = Renames::of_text(&renames).apply(&read(old));
    let found = differences(&old, &read(new));
    let mut counts = [0; 3];
    for (key, difference) in &found {
        let (i, text) = match difference {
            Difference::Changed(a, b) => (0, format!("changed {key} = {a} -> {b}")),
            Difference::Added(v) => (1, format!("added   {key} = {v}")),
            Difference::Removed(v) => (2, format!("removed {key} = {v}")),
        };
        counts[i] += 1;
        println!("{text}");
    }
    let same = old.0.len() - counts[0] - counts[2];
    println!(
        "{same} equal, {} changed, {} added, {} removed",
        counts[0], counts[1], counts[2]
    );
    ExitCode::from(u8::from(counts[0] + counts[2] > 0))
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (file, only) = match arguments[..] {
        ["--compare", old, new] => return compare(Path::new(old), Path::new(new)),
        ["--golden"] => (None, None),
        [file] if !file.starts_with('-') => (Some(file), None),
        [file, "--only", study] if studies().contains(&study) => (Some(file), Some(study)),
        _ => {
            eprintln!(
                "OUT_FILE [--only STUDY] | --compare OLD NEW | --golden; studies: {:?}",
                studies()
            );
            return ExitCode::from(2);
        }
    };
    let folder = tempfile::tempdir().expect("a folder for results");
    let list = fingerprint(only, folder.path());
    let (path, text) = match file {
        Some(file) => (PathBuf::from(file), list.to_text()),
        None => (
            golden("fingerprint.txt"),
            format!("{HEADER}{}", golden_form(&list).to_grouped_text()),
        ),
    };
    std::fs::write(&path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    println!("{} values: {}", list.0.len(), path.display());
    ExitCode::SUCCESS
}
