//! Studies whose quantities were in their runs, and are rows of a table now: penalties in schema 1, numbers of modes in
//! schema 2 before its release; and choices on random scenes, which had a list of their own.

use crate::columns::{Columns, Value as Cell};
use crate::markup::column::Format;
use crate::numbers::short;
use crate::record::SCHEMA;
use crate::studies::tabular::{TableChart, TabularRecord};
use crate::view::capital;
use serde_json::{Value, json};

/// Names of the studies whose records are converted.
pub const STUDIES: [&str; 3] = ["penalty", "truncation", CHOICES];
const CHOICES: &str = "choice-check";

/// Converts a record of one of the studies; false if it is one of another study.
///
/// # Errors
/// When the table cannot be represented in JSON.
pub fn upgrade(record: &mut Value) -> serde_json::Result<bool> {
    let Some(name) = STUDIES.into_iter().find(|name| record["study"] == *name) else {
        return Ok(false);
    };
    if name == CHOICES {
        return choices(record);
    }
    let runs = record["runs"].as_array().cloned().unwrap_or_default();
    let file = format!("{name}.csv");
    let columns = Columns::<&Value>::of(&file, "One row per run");
    let (columns, chart) = match name {
        "penalty" => penalty(columns),
        _ => truncation(columns),
    };
    let rows = runs.iter().map(|r| columns.recorded_row(&r));
    let table = TabularRecord {
        name: name.into(),
        rows_are: "One row per run".into(),
        finding: vec!["The record is of an earlier version, without a stored finding.".into()],
        rows: rows.collect(),
        charts: vec![TableChart {
            file: name.into(),
            ..chart
        }],
        columns: columns.recorded(),
        ..TabularRecord::default()
    };
    put(record, &table)
}

/// Gives a record a table as its part.
fn put(record: &mut Value, table: &TabularRecord) -> serde_json::Result<bool> {
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

/// Converts choices on random scenes: numbers and texts of the list are columns under their keys, and ratios of costs and
/// errors are added, which their chart has.
fn choices(record: &mut Value) -> serde_json::Result<bool> {
    let mut list = record["choices"].as_array().cloned().unwrap_or_default();
    const RATIOS: [(&str, &str, &str); 3] = [
        ("cost_ratio", "cost_s", "cheapest_cost_s"),
        ("error_over_tolerance", "error", "tolerance"),
        ("predicted_over_tolerance", "predicted_error", "tolerance"),
    ];
    for choice in &mut list {
        for (key, above, below) in RATIOS {
            let [above, below] = [above, below].map(|k| choice[k].as_f64());
            if let (Some(x), Some(of)) = (above, below.filter(|x| *x > 0.0)) {
                choice[key] = json!(x / of);
            }
        }
    }
    let mut keys: Vec<&String> = Vec::new();
    for (key, value) in list.iter().filter_map(Value::as_object).flatten() {
        if !keys.contains(&key) && !value.is_array() && !value.is_object() {
            keys.push(key);
        }
    }
    let mut columns = Columns::<&Value>::of("choice_check.csv", "One row per scene");
    for key in keys.iter().copied() {
        let cell = move |r: &&Value| {
            serde_json::from_value::<Cell>(r[key].clone()).unwrap_or(Cell::Absent)
        };
        columns = columns.add(key, key.replace('_', " "), cell);
        columns = match key.as_str() {
            "scene" | "gears" => columns.shown(&capital(key), Format::Text),
            "outcome" | "chosen" => columns.shown(&capital(key), Format::Text).result(),
            "tolerance" => columns.shown("Tolerance", Format::Percents(2)),
            "error" => columns.shown("Error", Format::Percents(2)).result(),
            "predicted_error" => columns.shown("Predicted error", Format::Percents(2)),
            "cost_ratio" => {
                (columns.shown("Cost over the cheapest adequate", Format::Short(3))).result()
            }
            _ => columns,
        };
    }
    let chart = TableChart {
        file: "choice_check".into(),
        title: "Choices on random scenes".into(),
        caption: "Processor time of the choice over that of the cheapest candidate that keeps the tolerance; error of the choice over \
                  the tolerance, against the reference over the whole scene; error as predicted."
            .into(),
        abscissa: "number".into(),
        ordinates: (RATIOS.iter().map(|(key, ..)| (*key).to_owned()))
            .filter(|key| keys.contains(&key))
            .collect(),
        points: true,
        levels: vec![1.0],
        ..TableChart::default()
    };
    let table = TabularRecord {
        name: "choice_check".into(),
        rows_are: "one row per scene".into(),
        finding: vec![outcomes(&list)],
        rows: list.iter().map(|r| columns.recorded_row(&r)).collect(),
        columns: columns.recorded(),
        charts: (Some(chart).filter(|c| !c.ordinates.is_empty()).into_iter()).collect(),
        grouped_by: "kind".into(),
        ..TabularRecord::default()
    };
    put(record, &table)
}

/// Returns the sentence on the outcomes of choices, and on the median of their costs.
fn outcomes(list: &[Value]) -> String {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for outcome in list.iter().filter_map(|c| c["outcome"].as_str()) {
        match counts.iter_mut().find(|(known, _)| *known == outcome) {
            Some((_, count)) => *count += 1,
            None => counts.push((outcome, 1)),
        }
    }
    let counts = counts.iter().map(|(outcome, n)| format!("{n} {outcome}"));
    let mut ratios: Vec<f64> = (list.iter())
        .filter_map(|c| c["cost_ratio"].as_f64())
        .collect();
    ratios.sort_by(f64::total_cmp);
    let middle = [ratios.len().saturating_sub(1) / 2, ratios.len() / 2];
    let middle: Vec<f64> = middle
        .iter()
        .filter_map(|k| ratios.get(*k).copied())
        .collect();
    let cost = middle.first().map_or(String::new(), |first| {
        let ratio = short(0.5 * (first + middle[middle.len() - 1]), 3);
        format!("; their processor time is {ratio} times that of the cheapest adequate candidate in the median")
    });
    let counts = counts.collect::<Vec<_>>().join(", ");
    format!("Choices in {} random scenes: {counts}{cost}.", list.len())
}

fn number(key: &'static str) -> impl Fn(&&Value) -> Option<f64> {
    move |r| r[key].as_f64()
}

/// A metric of a run against its first reference.
fn result(key: &'static str) -> impl Fn(&&Value) -> Option<f64> {
    move |r| r["metrics"][0][key].as_f64()
}

#[rustfmt::skip]
fn penalty<'a>(columns: Columns<'a, &'a Value>) -> (Columns<'a, &'a Value>, TableChart) {
    let columns = columns
        .model(|r| word(&r["model"]))
        .add("penalty_pa_per_m", "penalty of the contact; empty for hard contact", number("penalty_pa_per_m")).shown("Penalty", Format::Powers).result()
        .add("status", "end of the run", |r| word(&r["status"])).shown("Status", Format::Text)
        .add("peak_force_n", "peak force", result("peak_force_n")).shown("Peak force", Format::Numbers(5)).result()
        .add("impulse_ns", "impulse", result("impulse_ns")).shown("Impulse", Format::Numbers(5)).result()
        .add("static_transmission_error_m", "mean static transmission error", number("static_error_m")).shown("Static TE, mean", Format::Numbers(5)).result();
    let keys = ["peak_force_n", "impulse_ns", "static_transmission_error_m"];
    let chart = TableChart {
        title: "Independence of the penalty".into(),
        abscissa: "penalty_pa_per_m".into(),
        ordinates: keys.map(String::from).to_vec(),
        limit: "hard contact".into(),
        ..TableChart::default()
    };
    (columns, chart)
}

#[rustfmt::skip]
fn truncation<'a>(columns: Columns<'a, &'a Value>) -> (Columns<'a, &'a Value>, TableChart) {
    let label = |r: &&Value| match r["variant"].as_str() {
        Some(variant) => format!("{}, {variant}", word(&r["model"])),
        None => word(&r["model"]),
    };
    let columns = columns
        .model(label)
        .add("modes", "modes per gear that are kept", |r| r["modes"].as_u64()).shown("Modes", Format::Plain).result()
        .add("highest_hz", "highest frequency among the modes", number("highest_hz")).shown("Highest mode", Format::Numbers(3))
        .add("status", "end of the run", |r| word(&r["status"])).shown("Status", Format::Text)
        .add("force_l2", "relative L2 error of the force history against the first reference", result("force_l2")).shown("Force history, off", Format::Percents(3)).result()
        .add("wall_s", "wall time, median of the repeats", number("wall_s")).shown("Wall time", Format::Durations);
    let chart = TableChart {
        title: "Error over the number of modes".into(),
        abscissa: "modes".into(),
        ordinates: vec!["force_l2".into()],
        magnitudes: true,
        ..TableChart::default()
    };
    (columns, chart)
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
    fn lists_of_choices_become_tables_with_their_outcomes() {
        let choice = |number: u32, outcome: &str, cost: f64| {
            json!({"scene": format!("s-{number}"), "number": number, "kind": "one impact", "gears": "20/30", "outcome": outcome,
                "chosen": "rigid", "tolerance": 0.05, "error": 0.01, "predicted_error": 0.02, "cost_s": cost, "cheapest_cost_s": 1e-5})
        };
        let old = json!({"schema": 1, "study": "choice-check", "scene": "s", "command": "", "machine": {}, "commit": "",
            "created": "", "runs": [], "choices": [choice(1, "adequate", 1e-5), choice(2, "adequate", 3e-5), choice(3, "inadequate", 2e-5)]});
        let results = upgrade(&old.to_string()).unwrap().unwrap();
        results.validate().unwrap();
        let Part::Tabular(table) = &results.part else {
            panic!("{:?}", results.part)
        };
        let finding = "Choices in 3 random scenes: 2 adequate, 1 inadequate; their processor time is 2 times that of the cheapest \
                       adequate candidate in the median.";
        assert_eq!(table.finding, [finding]);
        let rows = serde_json::to_value(&table.rows).unwrap();
        let found = [&rows[1]["cost_ratio"], &rows[1]["error_over_tolerance"]];
        assert!((found[0].as_f64().unwrap() - 3.0).abs() < 1e-12);
        assert!((found[1].as_f64().unwrap() - 0.2).abs() < 1e-12);
    }

    #[test]
    fn studies_of_runs_become_tables() {
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
        old["study"] = json!("truncation");
        old["runs"][0]["modes"] = json!(25);
        old["runs"][0]["mark"] = json!("a name that runs had");
        let results = upgrade(&old.to_string()).unwrap().unwrap();
        results.validate().unwrap();
        assert_eq!(results.study_name(), "truncation");
        assert_eq!(
            upgrade(r#"{"schema": 1, "study": "compare"}"#).unwrap(),
            None
        );
    }
}
