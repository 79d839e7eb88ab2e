//! The format of a study's files for other programs: JSON Schema of `results.json`, dictionary of the CSV columns, and
//! checks of data against both.

use serde_json::Value;

/// JSON Schema (draft 2020-12) of `results.json` as this version writes it: `docs/results.schema.json`.
pub const RECORD_SCHEMA: &str = include_str!("../../docs/results.schema.json");

/// Columns of all CSV files with units and meaning: `docs/data.md`.
pub const DATA_DICTIONARY: &str = include_str!("../../docs/data.md");

/// Returns all violations of the schema in a record, each with its place. A key that the schema does not list is a
/// violation.
pub fn violations(record: &Value) -> Vec<String> {
    let mut found = Vec::new();
    match serde_json::from_str(RECORD_SCHEMA) {
        Ok(schema) => check(record, &schema, &schema, "", &mut found),
        Err(e) => found.push(format!("the schema itself: {e}")),
    }
    found
}

/// Checks a value against the part of JSON Schema that `results.schema.json` uses.
fn check(x: &Value, schema: &Value, root: &Value, place: &str, found: &mut Vec<String>) {
    if let Some(name) = schema["$ref"].as_str() {
        let target = root.pointer(name.trim_start_matches('#'));
        return match target {
            Some(target) => check(x, target, root, place, found),
            None => found.push(format!("{place}: the schema has no {name}")),
        };
    }
    let of_type = match schema["type"].as_str() {
        Some("object") => x.is_object(),
        Some("array") => x.is_array(),
        Some("string") => x.is_string(),
        Some("number") => x.is_number(),
        Some("integer") => x.is_i64() || x.is_u64(),
        Some("boolean") => x.is_boolean(),
        _ => true,
    };
    let chosen = schema["enum"].as_array().is_none_or(|all| all.contains(x));
    let constant = schema.get("const").is_none_or(|c| c == x);
    let least = schema["minimum"].as_f64().zip(x.as_f64());
    if !(of_type && chosen && constant && least.is_none_or(|(least, x)| x >= least)) {
        return found.push(format!("{place}: {x} is not what the schema asks for"));
    }
    if let Some(object) = x.as_object() {
        for key in schema["required"].as_array().into_iter().flatten() {
            if !key.as_str().is_some_and(|key| object.contains_key(key)) {
                found.push(format!("{place}: {key} is missing"));
            }
        }
        for (key, value) in object {
            let known = schema["properties"].get(key);
            match known.or(schema.get("additionalProperties")) {
                Some(of) => check(value, of, root, &format!("{place}/{key}"), found),
                None => found.push(format!("{place}: the schema does not know `{key}`")),
            }
        }
    }
    if let Some(items) = x.as_array() {
        let length = |key: &str| schema[key].as_u64();
        let n = items.len() as u64;
        if length("minItems").is_some_and(|m| n < m) || length("maxItems").is_some_and(|m| n > m) {
            found.push(format!("{place}: {n} items"));
        }
        for (i, item) in items.iter().enumerate() {
            let of = schema["prefixItems"].get(i).or(schema.get("items"));
            if let Some(of) = of {
                check(item, of, root, &format!("{place}/{i}"), found);
            }
        }
    }
}

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

    #[test]
    fn placeholders_stand_for_anything() {
        assert!(fits("speed_GEAR_rad_s", "speed_sun wheel_rad_s"));
        assert!(!fits("speed_GEAR_rad_s", "speed__m_s") && !fits("speed_GEAR_rad_s", "speed_"));
        assert!(fits("bearing_GEAR_N_n", "bearing_a_3_n") && fits("time_s", "time_s"));
        assert!(is_described("time_s") && !is_described("time_h"));
    }

    #[test]
    fn a_record_that_breaks_the_schema_is_told_where() {
        let mut results = crate::record::Results::default();
        results.runs.push(crate::record::Run {
            wall_s: 1.0,
            ..Default::default()
        });
        let good = serde_json::to_value(&results).unwrap();
        assert_eq!(violations(&good), Vec::<String>::new());
        let broken = |pointer: &str, to: Value| {
            let mut record = good.clone();
            match record.pointer_mut(pointer) {
                Some(place) => *place = to,
                None => record["runs"][0]["surprise"] = to,
            }
            violations(&record).join("; ")
        };
        assert!(broken("/schema", 9.into()).contains("/schema"));
        assert!(broken("/runs/0/status", "well".into()).contains("/runs/0/status"));
        assert!(broken("/runs/0/steps", (-1).into()).contains("/runs/0/steps"));
        assert!(broken("/none", 1.into()).contains("`surprise`"));
    }
}
