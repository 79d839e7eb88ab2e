//! Finding and tables of an identification.

use super::csv::{fitted, parameters};
use super::{DataKind, DataRecord, FitRecord, Outcome, ParameterRecord};
use crate::markup::table::Table;
use crate::markup::{glance, note, section};
use crate::numbers::{per_cent, quantity, significant};
use maud::{Markup, html};

/// Correlation from which on two parameters count as correlated.
const TOGETHER: f64 = 0.95;

pub fn finding(fits: &[FitRecord]) -> Vec<Markup> {
    let mut all = Vec::new();
    for f in fits {
        let errors: Vec<String> = (f.data.iter())
            .filter(|d| !d.validation)
            .map(|d| format!("{} of {}", per_cent(d.l2, 2), d.name))
            .collect();
        let worst = (f.data.iter())
            .filter(|d| d.validation)
            .map(|d| d.l2)
            .reduce(f64::max);
        all.push(html! {
            b { (f.label) } " comes within " (errors.join(", ")) " (relative L2)"
            @if let Some(worst) = worst { ", and within " (per_cent(worst, 2)) " of what was not fitted" }
            "."
        });
        for text in &f.undetermined {
            all.push(html! { b { (f.label) } ": " (text) "." });
        }
    }
    all
}

/// Formats an interval: both ends, in the unit of the value.
fn interval(p: &ParameterRecord) -> Option<String> {
    if p.outcome != Outcome::Identified {
        return None;
    }
    let end = |x: Option<f64>| x.map_or_else(|| "open".into(), |x| quantity(x, &p.unit, 4));
    Some(format!("{} to {}", end(p.low), end(p.high)))
}

pub fn tables(fits: &[FitRecord]) -> Markup {
    let rows: Vec<(usize, &FitRecord, &ParameterRecord)> = (fits.iter().enumerate())
        .flat_map(|(i, f)| f.parameters.iter().map(move |p| (i, f, p)))
        .collect();
    let estimates = Table::of(&rows)
        .grouped(|(i, f, _)| (f.label.clone(), *i))
        .text("Parameter", |(.., p)| p.name.clone())
        .columns_by_key(&parameters(), &["outcome"], |(_, f, p)| Some((*f, *p)))
        .written("Value", "", |(.., p)| {
            p.value.map(|x| quantity(x, &p.unit, 5))
        })
        .result()
        .written("95 % interval", "", |(.., p)| interval(p))
        .result()
        .percents("Half width", 2, |(.., p)| p.relative())
        .result()
        .columns_by_key(&parameters(), &["freedom", "parameter"], |(_, f, p)| {
            Some((*f, *p))
        });
    let sets: Vec<(usize, &FitRecord, &DataRecord)> = (fits.iter().enumerate())
        .flat_map(|(i, f)| f.data.iter().map(move |d| (i, f, d)))
        .collect();
    let data = Table::of(&sets)
        .grouped(|(i, f, _)| (f.label.clone(), *i))
        .columns_by_key(&fitted(), &["against"], |(_, f, d)| Some((*f, *d)))
        .text("Use", |(.., d)| {
            if d.validation { "validation" } else { "fitted" }.to_owned()
        })
        .result()
        .text("What", |(.., d)| d.kind.to_string())
        .columns_by_key(
            &fitted(),
            &[
                "error_l2",
                "peak_force_rel",
                "impulse_rel",
                "correlation_lag1",
                "weight",
            ],
            |(_, f, d)| Some((*f, *d)),
        );
    html! {
        (glance("Estimates", html! {
            (estimates)
            (note("Intervals hold for correlated residuals: an autoregressive process is fitted to them by restricted \
                   likelihood. Where the fit is not linear over an interval, its ends are those of the profile."))
        }))
        (glance("Data", html! { (data) }))
    }
}

/// Returns the correlations of the fitted parameters, and the data on the fit itself.
pub fn details(fits: &[FitRecord]) -> Markup {
    html! {
        @for f in fits {
            @let fitted: Vec<&ParameterRecord> = (f.parameters.iter())
                .filter(|p| p.outcome != Outcome::Held)
                .collect();
            @if f.correlation.len() == fitted.len() && fitted.len() > 1 {
                (section(&format!("Correlation: {}", f.label), html! {
                    (correlation(f, &fitted))
                    (note(how(f)))
                }))
            }
        }
    }
}

fn correlation(f: &FitRecord, fitted: &[&ParameterRecord]) -> Markup {
    let rows: Vec<usize> = (0..fitted.len()).collect();
    let mut table = Table::of(&rows).text("", |&i| fitted[i].name.clone());
    for (j, p) in fitted.iter().enumerate() {
        let value = |&i: &usize| f.correlation[i].get(j).copied();
        table = table.numbers(&p.name, "", 3, value).result();
    }
    html! { (table) }
}

fn how(f: &FitRecord) -> String {
    let close: Vec<String> = (0..f.correlation.len())
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .filter(|&(i, j)| f.correlation[i].get(j).is_some_and(|c| c.abs() > TOGETHER))
        .map(|(i, j)| format!("parameters {} and {}", j + 1, i + 1))
        .collect();
    let condition = match f.condition {
        Some(c) => format!(
            "Condition number of the sensitivities {}.",
            significant(c, 3)
        ),
        None => "The sensitivities are singular.".into(),
    };
    let together = match close.is_empty() {
        true => String::new(),
        false => format!(" Nearly one: {}.", close.join(", ")),
    };
    format!(
        "{condition}{together} {} of {} starting points led here, in {} evaluations.",
        f.starts_agreed, f.starts, f.evaluations
    )
}

/// Returns the labels of abscissa and ordinate of a data set.
pub fn axis_names(kind: DataKind) -> [&'static str; 2] {
    match kind {
        DataKind::Force => ["time [\u{b5}s]", "force [N]"],
        DataKind::Torque => ["time [ms]", "torque [N m]"],
        DataKind::Speed => ["time [ms]", "speed [rad/s]"],
        DataKind::Angle => ["time [ms]", "angle [rad]"],
        DataKind::Compliance => ["position [base pitches]", "compliance [nm/N]"],
    }
}
