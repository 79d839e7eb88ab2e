//! The format of a study's files for other programs: JSON Schema of `results.json` and dictionary of the CSV columns.
//!
//! The schema is derived from the types of the record and their doc comments (crate `schemars`, in tests alone).

/// JSON Schema (draft 2020-12) of `results.json` as this version writes it: `docs/results.schema.json`.
pub const RECORD_SCHEMA: &str = include_str!("../../docs/results.schema.json");

/// Columns of all CSV files with units and meaning: `docs/data.md`.
pub const DATA_DICTIONARY: &str = include_str!("../../docs/data.md");

/// True if the dictionary has the column by its name, or by a name with a placeholder in capitals such as
/// `speed_GEAR_rad_s`.
pub fn is_described(column: &str) -> bool {
    let names = DATA_DICTIONARY
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    names.into_iter().any(|name| fits(name, column))
}

/// True if `column` matches a name of the dictionary, in which a word in capitals matches any text.
fn fits(name: &str, column: &str) -> bool {
    let Some(begin) = name.find(|c: char| c.is_ascii_uppercase()) else {
        return name == column;
    };
    let rest = name[begin..].trim_start_matches(|c: char| c.is_ascii_uppercase());
    let Some(after) = column.strip_prefix(&name[..begin]) else {
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

    const DESCRIPTION: &str = "The record of a study, format version 1. Keys may be added; none is renamed or given another meaning without a new \
        version. Quantities are in SI units, with the unit at the end of the name; a quantity that was not measured or is not finite is absent.";

    #[test]
    fn placeholders_stand_for_anything() {
        assert!(fits("speed_GEAR_rad_s", "speed_sun wheel_rad_s"));
        assert!(!fits("speed_GEAR_rad_s", "speed__m_s") && !fits("speed_GEAR_rad_s", "speed_"));
        assert!(fits("bearing_GEAR_N_n", "bearing_a_3_n") && fits("time_s", "time_s"));
        assert!(is_described("time_s") && !is_described("time_h"));
    }

    /// The stored schema is the one that the types of the record have; `GEARBENCH_UPDATE_GOLDEN=1` writes it.
    #[test]
    fn the_schema_is_that_of_the_types() {
        let settings = schemars::generate::SchemaSettings::draft2020_12().for_serialize();
        let mut schema = settings.into_generator().into_root_schema_for::<Results>();
        schema.insert("title".into(), "gearbench results.json".into());
        schema.insert("description".into(), DESCRIPTION.into());
        let text = serde_json::to_string_pretty(&plain(schema.into())).unwrap() + "\n";
        if std::env::var_os("GEARBENCH_UPDATE_GOLDEN").is_some() {
            let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/results.schema.json");
            std::fs::write(path, &text).unwrap();
        } else {
            let command =
                "GEARBENCH_UPDATE_GOLDEN=1 cargo test --release --workspace --lib dictionary";
            assert!(
                text == RECORD_SCHEMA,
                "docs/results.schema.json is not of these types; {command}"
            );
        }
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
