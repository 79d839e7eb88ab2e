//! Reports of made-up records: their files, their texts, and the accuracy of the texts.

mod files;
mod made_up;
mod modes;
mod mutated;
mod pages;
mod precision;
mod scenes;
mod studies;
mod trains;

use gearbench_reports::dictionary;
use gearbench_reports::{Part, Results, write_results};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Script of all pages.
const SCRIPT: &str = include_str!("../../src/markup/charts.js");

/// Reads the files of a folder by name; pages without the text of their script, which is the same in all.
fn contents(dir: &Path) -> BTreeMap<String, String> {
    let entries = fs::read_dir(dir).unwrap().map(|e| e.unwrap());
    let file = |e: fs::DirEntry| {
        let name = e.file_name().into_string().unwrap();
        let text = fs::read_to_string(e.path()).unwrap();
        (name, text.replace(SCRIPT, ""))
    };
    entries.map(file).collect()
}

/// Writes a report and returns its files.
fn written(results: &Results) -> BTreeMap<String, String> {
    let dir = tempfile::tempdir().unwrap();
    write_results(dir.path(), results).unwrap();
    let files = contents(dir.path());
    as_documented(&files);
    files
}

/// Asserts that a record reads back as it is, so that it has the keys of its types (and of the schema), and that the
/// dictionary has every column of every file.
fn as_documented(files: &BTreeMap<String, String>) {
    let text = &files[gearbench_reports::store::RECORD];
    let record: serde_json::Value = serde_json::from_str(text).unwrap();
    let read: Results = serde_json::from_str(text).unwrap();
    assert_eq!(serde_json::to_value(&read).unwrap(), record);
    let mut described = dictionary::files();
    if let Part::Tabular(table) = &read.part {
        described.push(table.described());
    }
    for (name, text) in files.iter().filter(|(name, _)| name.ends_with(".csv")) {
        for column in text.lines().next().unwrap().split(',') {
            assert!(
                dictionary::is_described(&described, name, column),
                "{column} of {name}"
            );
        }
    }
}

/// Asserts that all of the named files are present.
fn holds(files: &BTreeMap<String, String>, names: &[&str]) {
    for name in names {
        assert!(files.contains_key(*name), "{name}");
    }
}

/// Returns the finding of a page.
fn finding(page: &str) -> &str {
    let text = page.split("class=\"finding\"").nth(1).unwrap();
    text.split("</section>").next().unwrap()
}

/// Returns a page without the elements that begin with a tag `<script` and the given rest of the tag.
fn without_scripts(page: &str, rest: &str) -> String {
    let begin = format!("<script{rest}");
    let mut parts = page.split(begin.as_str());
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |kept, part| {
        kept + part.split_once("</script>").map_or("", |(_, after)| after)
    })
}

/// Asserts that no file contains a number that is not finite; the code of the script may have these words.
fn has_only_numbers(files: &BTreeMap<String, String>) {
    for (name, text) in files {
        let text = without_scripts(text, ">");
        for word in ["NaN", "nan,", "inf,", "Infinity", "null", ">inf", "\"inf"] {
            assert!(!text.contains(word), "{word} in {name}");
        }
    }
}
