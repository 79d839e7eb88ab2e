//! The format of a study's files for other programs: JSON Schema of `results.json` and dictionary of the CSV
//! columns.
//!
//! The schema is derived from the types of the record and their doc comments (crate `schemars`, in tests alone), the
//! dictionary from the declarations of columns (`crate::columns`).

pub use crate::columns::FileDescription;
use crate::csv_table::{SCENE, named_unit};
use crate::studies::runs::RUNS;
use crate::{histories, studies};

/// JSON Schema (draft 2020-12) of `results.json` as this version writes it: `docs/results.schema.json`.
pub const RECORD_SCHEMA: &str = include_str!("../../docs/results.schema.json");

/// The document on data of a study, with the columns of all CSV files: `docs/data.md`.
pub const DATA_DICTIONARY: &str = include_str!("../../docs/data.md");

/// Returns the descriptions of the CSV files of the studies of this crate; studies whose results are one table have
/// theirs. In the names of files and columns, words in capitals are
/// placeholders.
pub fn files() -> Vec<FileDescription> {
    let mut all = histories::files();
    all.extend(studies::files());
    all
}

/// True if the descriptions have the column in the table of the file. `runs.csv` of a study without runs, and the histories
/// of an identification, have the columns of other tables.
pub fn is_described(files: &[FileDescription], file: &str, column: &str) -> bool {
    let of_others = [RUNS, "identify_histories.csv"].contains(&file);
    // Histories of one of several scenes have its name in front.
    let after_scene = file.match_indices('-').map(|(i, _)| &file[i + 1..]);
    let names: Vec<&str> = std::iter::once(file).chain(after_scene).collect();
    let is_of = |f: &FileDescription| names.iter().any(|name| fits(&f.file, name));
    column == SCENE
        || files
            .iter()
            .any(|f| (of_others || is_of(f)) && f.columns.iter().any(|(key, _)| fits(key, column)))
}

impl FileDescription {
    /// Returns the table of columns in Markdown.
    pub fn to_markdown(&self) -> String {
        let mut text = String::from("| column | unit | meaning |\n|---|---|---|\n");
        for (key, meaning) in &self.columns {
            let unit = match named_unit(key).1 {
                "" => "-",
                unit => unit,
            };
            text.push_str(&format!("| `{key}` | {unit} | {meaning} |\n"));
        }
        text
    }
}

/// Returns the document with the tables of columns: that of a file whose name is in the heading of a section takes the
/// place of the table of the section. Those of the other files, each under a heading of its own, are the end.
pub fn with_tables(document: &str, mut files: Vec<FileDescription>) -> String {
    let prose = document.split("\n### ").next().unwrap_or(document);
    let mut text = String::new();
    let mut table = None;
    for line in prose.lines() {
        if line.starts_with('#') {
            let named = |f: &FileDescription| line.contains(&format!("`{}`", f.file));
            let place = files.iter().position(named);
            table = place.map(|i| files.remove(i).to_markdown());
        }
        match (&mut table, line.starts_with('|')) {
            // The first line of the old table becomes the whole new one.
            (Some(table), true) => text.push_str(&std::mem::take(table)),
            _ => text.push_str(&format!("{line}\n")),
        }
    }
    for f in files {
        let (name, rows, table) = (&f.file, &f.rows, f.to_markdown());
        text.push_str(&format!("\n### `{name}`\n\n{rows}\n\n{table}"));
    }
    text
}

/// True if a text matches a name in which a word in capitals stands for any text.
fn fits(name: &str, text: &str) -> bool {
    let Some(begin) = name.find(|c: char| c.is_ascii_uppercase()) else {
        return name == text;
    };
    let rest = name[begin..].trim_start_matches(|c: char| c.is_ascii_uppercase());
    let Some(after) = text.strip_prefix(&name[..begin]) else {
        return false;
    };
    (1..=after.len())
        .filter(|&i| after.is_char_boundary(i))
        .any(|i| fits(rest, &after[i..]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Results;
    use serde_json::Value;

    const DESCRIPTION: &str = "The record of a study, format version 2. Keys may be added; none is renamed or given another meaning without a new \
        version. Quantities are in SI units, with the unit at the end of the name; a quantity that was not measured or is not finite is absent.";

    #[test]
    fn placeholders_stand_for_anything() {
        assert!(fits("speed_GEAR_rad_s", "speed_sun wheel_rad_s"));
        assert!(!fits("speed_GEAR_rad_s", "speed__m_s") && !fits("speed_GEAR_rad_s", "speed_"));
        assert!(fits("bearing_GEAR_N_n", "bearing_a_3_n") && fits("time_s", "time_s"));
        let has = |column: &str| is_described(&files(), "run01-rigid-rk4.csv", column);
        assert!(has("time_s") && !has("time_h") && !has("set"));
    }

    /// Asserts that a stored document is the text that the code makes, or writes it.
    fn stored(name: &str, document: &str, text: &str) {
        if std::env::var_os("GEARBENCH_UPDATE_GOLDEN").is_some() {
            let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs");
            std::fs::write(format!("{folder}/{name}"), text).unwrap();
        } else {
            let command =
                "GEARBENCH_UPDATE_GOLDEN=1 cargo test --release --workspace --lib dictionary";
            assert!(
                text == document,
                "docs/{name} is not that of the code; {command}"
            );
        }
    }

    /// The stored schema is the one that the types of the record have; `GEARBENCH_UPDATE_GOLDEN=1` writes it.
    #[test]
    fn the_schema_is_that_of_the_types() {
        let settings = schemars::generate::SchemaSettings::draft2020_12().for_serialize();
        let mut schema = settings.into_generator().into_root_schema_for::<Results>();
        schema.insert("title".into(), "gearbench results.json".into());
        schema.insert("description".into(), DESCRIPTION.into());
        let text = serde_json::to_string_pretty(&plain(schema.into())).unwrap() + "\n";
        stored("results.schema.json", RECORD_SCHEMA, &text);
    }

    /// The schema without default values and formats of numbers, which are not part of the format of files, and without
    /// the markup of doc comments.
    fn plain(schema: Value) -> Value {
        match schema {
            Value::Object(members) => {
                let kept = members
                    .into_iter()
                    .filter(|(key, _)| key != "default" && key != "format");
                kept.map(|(key, x)| match (key.as_str(), x) {
                    // Its keys are names of the record.
                    ("properties", Value::Object(of)) => {
                        let of: serde_json::Map<_, _> =
                            of.into_iter().map(|(name, x)| (name, plain(x))).collect();
                        (key, of.into())
                    }
                    ("description", Value::String(text)) => {
                        let text = text.replace("\\[", "[").replace("\\]", "]");
                        (key, text.replace("[`", "`").replace("`]", "`").into())
                    }
                    (_, x) => (key, plain(x)),
                })
                .collect()
            }
            Value::Array(items) => items.into_iter().map(plain).collect(),
            other => other,
        }
    }
}
