//! Studies whose quantities were in their runs, and are rows of a table now: penalties in schema 1, numbers of modes in
//! schema 2 before its release; choices on random scenes and runs with a host, which had lists of their own.

use crate::columns::{Columns, Value as Cell};
use crate::markup::column::Format;
use crate::record::SCHEMA;
use crate::studies::tabular::{TableChart, TabularRecord};
use crate::view::capital;
use serde_json::{Value, json};

/// Names of the studies whose records are converted.
pub const STUDIES: [&str; 4] = ["penalty", "truncation", CHOICES, COUPLING];
const CHOICES: &str = "choice-check";
const COUPLING: &str = "coupling";

/// Converts a record of one of the studies; false if it is one of another study.
///
/// # Errors
/// When the table cannot be represented in JSON.
pub fn upgrade(record: &mut Value) -> serde_json::Result<bool> {
    let Some(name) = STUDIES.into_iter().find(|name| record["study"] == *name) else {
        return Ok(false);
    };
    match name {
        CHOICES => return choices(record),
        COUPLING => return couplings(record),
        _ => {}
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

/// Runs of gears that a host moves: a row for each, in place of a list for each model and extrapolation.
fn couplings(record: &mut Value) -> serde_json::Result<bool> {
    let list = record["couplings"].as_array().cloned().unwrap_or_default();
    let cells = |c: &Value| -> Vec<Value> {
        let all = [&c["cells"], &c["refined"]];
        let all = all.into_iter().filter_map(Value::as_array).flatten();
        all.cloned().collect()
    };
    let mut rows: Vec<(Value, Value)> = Vec::new();
    for coupling in list {
        let mut own = cells(&coupling);
        let step = |c: &Value| c["step_s"].as_f64().unwrap_or(0.0);
        own.sort_by(|a, b| step(a).total_cmp(&step(b)));
        rows.extend(own.into_iter().map(|cell| (coupling.clone(), cell)));
    }
    let of = |key: &'static str| move |(_, cell): &(Value, Value)| cell[key].as_f64();
    let columns = Columns::<(Value, Value)>::of("coupling.csv", "One row per run");
    #[rustfmt::skip]
    let columns = columns
        .model(|(c, _)| label(c))
        .add("manner", "extrapolation of the forces on hubs", |(c, _)| word(&c["extrapolation"])).shown("Extrapolation", Format::Text).result()
        .add("communication_step_s", "communication step of host and gears", of("step_s")).shown("Communication step", Format::Quantities(3)).result()
        .add("status", "end of the run", |(_, x)| word(&x["status"])).shown("Status", Format::Text)
        .add("force_l2", "relative L2 error of the force history", of("force_l2")).shown("Force, L2", Format::Percents(3)).result()
        .add("energy_error_rel", "energy that the coupling adds or removes, over that of the vibration", of("energy_error_rel")).shown("Energy error", Format::Percents(3)).result();
    let table = TabularRecord {
        name: COUPLING.into(),
        rows_are: "One row per run".into(),
        finding: vec!["The record is of an earlier version, without a stored finding.".into()],
        rows: rows.iter().map(|r| columns.recorded_row(r)).collect(),
        charts: vec![TableChart {
            file: "coupling_error".into(),
            title: "Error of the coupling".into(),
            abscissa: "communication_step_s".into(),
            ordinates: vec!["force_l2".into()],
            panels_by: "manner".into(),
            magnitudes: true,
            ..TableChart::default()
        }],
        columns: columns.recorded(),
        ..TabularRecord::default()
    };
    put(record, &table)
}

/// The label of a model with its variant.
fn label(of: &Value) -> String {
    match of["variant"].as_str() {
        Some(variant) => format!("{}, {variant}", word(&of["model"])),
        None => word(&of["model"]),
    }
}

/// Choices on random scenes: numbers and texts of the list are the columns, under their keys.
fn choices(record: &mut Value) -> serde_json::Result<bool> {
    let list = record["choices"].as_array().cloned().unwrap_or_default();
    let mut keys: Vec<&String> = Vec::new();
    for (key, value) in list.iter().filter_map(Value::as_object).flatten() {
        if !keys.contains(&key) && !value.is_array() && !value.is_object() {
            keys.push(key);
        }
    }
    let mut columns = Columns::<&Value>::of("choice_check.csv", "One row per scene");
    for key in keys {
        let cell = move |r: &&Value| {
            serde_json::from_value::<Cell>(r[key].clone()).unwrap_or(Cell::Absent)
        };
        columns = columns.add(key, key.replace('_', " "), cell);
        if ["scene", "outcome", "chosen"].contains(&key.as_str()) {
            columns = columns.shown(&capital(key), Format::Text).result();
        }
    }
    let table = TabularRecord {
        name: "choice_check".into(),
        rows_are: "one row per scene".into(),
        finding: vec!["The record is of an earlier version, without a stored finding.".into()],
        rows: list.iter().map(|r| columns.recorded_row(&r)).collect(),
        columns: columns.recorded(),
        grouped_by: "kind".into(),
        ..TabularRecord::default()
    };
    put(record, &table)
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
    let columns = columns
        .model(|r| label(r))
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
        old["study"] = json!("coupling");
        let cell =
            |step: f64| json!({"step_s": step, "status": "converged", "force_l2": 100.0 * step});
        old["couplings"] = json!([{"model": "elastic", "variant": "truncated", "extrapolation": "linear",
            "cells": [cell(1e-6), cell(4e-6)], "refined": [cell(2e-6)]}]);
        let results = upgrade(&old.to_string()).unwrap().unwrap();
        results.validate().unwrap();
        let Part::Tabular(table) = &results.part else {
            panic!("{:?}", results.part)
        };
        let rows = serde_json::to_value(&table.rows).unwrap();
        assert_eq!(rows[1]["communication_step_s"], 2e-6);
        assert_eq!(rows[2]["model"], "elastic, truncated");
        assert_eq!(
            upgrade(r#"{"schema": 1, "study": "compare"}"#).unwrap(),
            None
        );
    }
}
