//! Studies whose quantities were in their runs, and are rows of a table now: penalties in schema 1, numbers of modes and
//! error over cost in schema 2 before its release; choices on random scenes and runs with a host, which had lists of
//! their own.

use crate::columns::{Columns, Value as Cell};
use crate::markup::column::Format;
use crate::metrics::Metric;
use crate::numbers::short;
use crate::record::SCHEMA;
use crate::studies::tabular::{
    AGAINST, FrontPanel, TableChart, TableFront, TableRow, TabularRecord,
};
use crate::view::capital;
use serde_json::{Value, json};

/// Names of the studies whose records are converted.
pub const STUDIES: [&str; 5] = ["penalty", "truncation", PRECISION, CHOICES, COUPLING];
const PRECISION: &str = "precision";
const CHOICES: &str = "choice-check";
const COUPLING: &str = "coupling";
/// The finding of a table that is made from a former record.
const FINDING: &str = "The record is of an earlier version, without a stored finding.";

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
        PRECISION => return precision(record),
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
        finding: vec![FINDING.into()],
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
        finding: vec![FINDING.into()],
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

/// Errors over cost: a row per run and reference, a chart of the front for each reference.
#[rustfmt::skip]
fn precision(record: &mut Value) -> serde_json::Result<bool> {
    type Row<'a> = (&'a Value, &'a Value);
    let runs = record["runs"].as_array().cloned().unwrap_or_default();
    let mut rows: Vec<Row<'_>> = Vec::new();
    for run in &runs {
        let metrics = run["metrics"].as_array().filter(|all| !all.is_empty());
        match metrics {
            Some(all) => rows.extend(all.iter().map(|m| (run, m))),
            None => rows.push((run, &Value::Null)),
        }
    }
    let text = |key: &'static str| move |(r, _): &Row<'_>| r[key].as_str().map(str::to_owned);
    let number = |key: &'static str| move |(r, _): &Row<'_>| r[key].as_f64();
    let count = |key: &'static str| move |(r, _): &Row<'_>| r[key].as_u64();
    let metric = record["metrics"][0].as_str().and_then(|key| Metric::ALL.into_iter().find(|m| m.key() == key)).unwrap_or_default();
    let error = move |(_, m): &Row<'_>| m[metric.key()].as_f64();
    let columns = Columns::<Row<'_>>::of("precision.csv", "One row per run and reference")
        .model(|(r, _)| label(r))
        .add("modes", "modes per gear", count("modes")).shown("Modes", Format::Plain).result()
        .integrator(|(r, _)| word(&r["integrator"])).shown("Integrator", Format::Text).result()
        .add("step_s", "fixed step", number("step")).shown("Step", Format::Numbers(3)).result()
        .add("rtol", "relative tolerance of an adaptive method", number("rtol")).shown("Tolerance", Format::Powers).result()
        .add("status", "end of the run", text("status")).shown("Status", Format::Text)
        .add("fitted_to", "reference to which the model's constants were fitted", text("fitted_to")).shown("Fitted to", Format::Text)
        .add(AGAINST, "reference of the errors in this row", |(_, m)| m["against"].as_str().map(str::to_owned)).shown("Against", Format::Text).result()
        .add(metric.key(), metric.meaning(), error).shown(&capital(metric.words()), Format::Percents(3)).result()
        .add("cpu_s", "processor time, or wall time", |(r, _)| r["cpu_s"].as_f64().filter(|t| *t > 0.0).or(r["wall_s"].as_f64())).shown("Processor time", Format::Durations).result()
        .add("steps", "accepted steps", count("steps")).shown("Steps", Format::Counts)
        .add("message", "reason of a failure, or a note", text("message"));
    let mut references: Vec<&str> = rows.iter().filter_map(|(_, m)| m["against"].as_str()).collect();
    references.sort_unstable();
    references.dedup();
    let chart = |(k, id): (usize, &&str)| TableChart {
        file: match k { 0 => PRECISION.into(), k => format!("{PRECISION}_{}", k + 1) },
        title: format!("{} against {id}, over processor time", capital(metric.words())),
        caption: "Every point is a run; those on the front are strong and named.".into(),
        abscissa: "cpu_s".into(),
        ordinates: vec![metric.key().into()],
        front: Some(TableFront {
            panels: vec![FrontPanel { title: String::new(), rows: TableRow::of([(AGAINST.into(), (*id).into())]) }],
            named_by: ["integrator", "modes", "step_s", "rtol"].map(String::from).to_vec(),
            without: "fitted_to".into(),
            ..TableFront::default()
        }),
        ..TableChart::default()
    };
    let table = TabularRecord {
        name: PRECISION.into(),
        rows_are: "one row per run and reference".into(),
        finding: vec![FINDING.into()],
        rows: rows.iter().map(|r| columns.recorded_row(r)).collect(),
        charts: references.iter().enumerate().map(chart).collect(),
        columns: columns.recorded(),
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
