//! Terminal summary of a record of `identify`.

use crate::messages::Messages;
use gearbench_reports::identify::{DataRecord, FitRecord, Outcome, ParameterRecord};
use gearbench_reports::record::Results;

/// Prints all fits of a record.
pub fn summarise(messages: &Messages, results: &Results) {
    results.fits().iter().for_each(|fit| one(messages, fit));
}

fn one(messages: &Messages, f: &FitRecord) {
    messages.print_line(&format!(
        "{}: {} evaluations; {} of {} starting points converged to this solution",
        f.label, f.evaluations, f.starts_agreed, f.starts
    ));
    for d in &f.data {
        messages.print_line(&format!("  {}", data(d)));
    }
    let widest = f.parameters.iter().map(|p| p.name.chars().count()).max();
    let widest = widest.unwrap_or(0);
    for p in &f.parameters {
        messages.print_line(&format!(
            "  {:<widest$}  {}  {}",
            p.name,
            parameter_text(p),
            p.key
        ));
    }
    for text in &f.undetermined {
        messages.print_line(&format!("  {text}"));
    }
}

fn data(d: &DataRecord) -> String {
    let part = |what: &str, x: Option<f64>| {
        x.map_or_else(String::new, |x| format!(", {what} {:+.2} %", 100.0 * x))
    };
    format!(
        "{} of {} {} {:.3} % (relative L2){}{}",
        d.kind,
        d.name,
        if d.validation {
            "compared with an error of"
        } else {
            "fitted with an error of"
        },
        100.0 * d.l2,
        part("peak", d.peak_rel),
        part("impulse", d.impulse_rel),
    )
}

fn parameter_text(p: &ParameterRecord) -> String {
    let value = p.value.map_or_else(String::new, |x| format!("{x:>12.5e}"));
    match p.outcome {
        Outcome::Identified => {
            let end = |x: Option<f64>| x.map_or_else(|| "open".into(), |x| format!("{x:.4e}"));
            let half = p.relative();
            let half = half.map_or_else(String::new, |r| format!("  +- {:.1} %", 100.0 * r));
            format!("{value}{half} (95 %: {} to {})", end(p.low), end(p.high))
        }
        Outcome::AtBound => {
            format!("{value}  at its bound; the least error lies outside the bounds")
        }
        Outcome::Held => format!("{value}  fixed"),
        Outcome::NotIdentifiable => "not identifiable".into(),
    }
}
