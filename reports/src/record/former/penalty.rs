//! Studies of penalties of schema 1, whose quantities are in their runs.

use crate::columns::Columns;
use crate::markup::column::Format;
use crate::record::SCHEMA;
use crate::studies::tabular::{TableChart, TabularRecord};
use serde_json::{Value, json};

/// Converts a record of a study of penalties; false if it is one of another study.
///
/// # Errors
/// When the table cannot be represented in JSON.
pub fn upgrade(record: &mut Value) -> serde_json::Result<bool> {
    if record["study"] != super::PENALTY {
        return Ok(false);
    }
    let runs = record["runs"].as_array().cloned().unwrap_or_default();
    let number = |key: &'static str| move |r: &&Value| r[key].as_f64();
    let result = |key: &'static str| move |r: &&Value| r["metrics"][0][key].as_f64();
    let columns = Columns::<&Value>::of("penalty.csv", "One row per run")
        .model(|r| word(&r["model"]))
        .add(
            "penalty_pa_per_m",
            "penalty of the contact; empty for hard contact",
            number("penalty_pa_per_m"),
        )
        .shown("Penalty", Format::Powers)
        .result()
        .add("status", "end of the run", |r| word(&r["status"]))
        .shown("Status", Format::Text)
        .add("peak_force_n", "peak force", result("peak_force_n"))
        .shown("Peak force", Format::Numbers(5))
        .result()
        .add("impulse_ns", "impulse", result("impulse_ns"))
        .shown("Impulse", Format::Numbers(5))
        .result()
        .add(
            "static_transmission_error_m",
            "mean static transmission error",
            number("static_error_m"),
        )
        .shown("Static TE, mean", Format::Numbers(5))
        .result();
    let rows = runs.iter().map(|r| columns.recorded_row(&r));
    let table = TabularRecord {
        name: "penalty".into(),
        rows_are: "One row per run".into(),
        finding: vec!["The record is of an earlier version, without a stored finding.".into()],
        rows: rows.collect(),
        charts: vec![TableChart {
            file: "penalty".into(),
            title: "Independence of the penalty".into(),
            abscissa: "penalty_pa_per_m".into(),
            ordinates: ["peak_force_n", "impulse_ns", "static_transmission_error_m"]
                .map(String::from)
                .to_vec(),
            limit: "hard contact".into(),
            ..TableChart::default()
        }],
        columns: columns.recorded(),
        ..TabularRecord::default()
    };
    let Value::Object(part) = serde_json::to_value(table)? else {
        return Ok(false);
    };
    record["study"] = json!("tabular");
    record["schema"] = json!(SCHEMA);
    for (key, value) in part {
        record[&key] = value;
    }
    Ok(true)
}

fn word(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use crate::record::Part;
    use crate::record::former::upgrade;

    #[test]
    fn a_study_of_penalties_becomes_a_table() {
        let text = r#"{"schema": 1, "study": "penalty", "scene": "s", "command": "gearbench penalty s", "machine": {},
            "commit": "", "created": "", "runs": []}"#;
        let mut old: Value = serde_json::from_str(text).unwrap();
        let run = |penalty: Value, peak: f64, status: &str| {
            let mut run = serde_json::to_value(crate::record::Run::default()).unwrap();
            run["model"] = json!("elastic");
            run["integrator"] = json!("trigonometric");
            run["status"] = json!(status);
            run["penalty_pa_per_m"] = penalty;
            run["metrics"] = json!([{"against": "hard", "peak_force_n": peak}]);
            run
        };
        old["runs"] = json!([
            run(json!(1e15), 1090.0, "converged"),
            run(Value::Null, 1100.0, "timeout")
        ]);
        let results = upgrade(&old.to_string()).unwrap().unwrap();
        results.validate().unwrap();
        assert_eq!((results.study_name(), results.runs.len()), ("penalty", 2));
        let Part::Tabular(table) = &results.part else {
            panic!("{:?}", results.part)
        };
        let rows = serde_json::to_value(&table.rows).unwrap();
        assert_eq!(rows[0]["penalty_pa_per_m"], 1e15);
        assert_eq!(rows[1]["penalty_pa_per_m"], Value::Null);
        assert_eq!(rows[1]["peak_force_n"], 1100.0);
        assert_eq!(
            upgrade(r#"{"schema": 1, "study": "compare"}"#).unwrap(),
            None
        );
    }
}
