//! Finding and tables of a study of coupling.

use super::csv::columns;
use super::{Coupling, CouplingCell, Extrapolation, models};
use crate::markup::table::Table;
use crate::markup::{glance, note, section};
use crate::numbers::{per_cent, quantity, short};
use maud::{Markup, html};

/// Formats a bracket of the largest step in words.
fn up_to([held, next]: [Option<f64>; 2]) -> String {
    match (held, next) {
        (Some(h), Some(_)) => quantity(h, "s", 3),
        (Some(h), None) => format!("\u{2265} {}", quantity(h, "s", 3)),
        (None, Some(h)) => format!("< {}", quantity(h, "s", 3)),
        (None, None) => String::new(),
    }
}

pub fn finding(couplings: &[Coupling]) -> Vec<Markup> {
    if couplings.iter().all(|c| c.cells.is_empty()) {
        return vec![html! { "The record holds no run in two parts." }];
    }
    let best = |label: &str| {
        let of = couplings.iter().filter(|c| c.model_label() == label);
        let kept = of.filter_map(|c| Some((c.accurate()[0]?, c)));
        kept.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let parts: Vec<Markup> = (models(couplings).iter())
        .map(|label| match best(label) {
            Some((step, c)) => html! {
                b { (label) } " up to " (quantity(step, "s", 3)) " (" (c.manner()) ")"
            },
            None => html! { b { (label) } " at no step" },
        })
        .collect();
    let mut all = vec![html! {
        "Communication steps that keep the force within the tolerance: "
        @for (i, part) in parts.iter().enumerate() { @if i > 0 { "; " } (part) }
        "."
    }];
    all.extend(gain(couplings));
    all
}

/// Interpolates the error of the force at a communication step between runs; `None` outside, or where a run failed.
fn error_at(c: &Coupling, step: f64) -> Option<f64> {
    let held = |x: &&CouplingCell| !x.status.is_failure();
    let points: Vec<(f64, f64)> = (c.all().into_iter().take_while(held))
        .filter_map(|x| Some((x.step_s.ln(), x.force_l2.filter(|e| *e > 0.0)?.ln())))
        .collect();
    let at = step.ln();
    let pair = points.windows(2).find(|p| p[0].0 <= at && at <= p[1].0)?;
    let [(x, a), (y, b)] = [pair[0], pair[1]];
    Some((a + (at - x) / (y - x) * (b - a)).exp())
}

/// Returns the sentence on the gain by residual compliance: elastic gears with and without it under the same coupling.
fn gain(couplings: &[Coupling]) -> Option<Markup> {
    let of = |residual: bool| {
        let all = couplings
            .iter()
            .filter(move |c| c.residual == Some(residual));
        all.filter(|c| c.extrapolation == Extrapolation::default())
    };
    let with = of(true).next()?;
    let without = of(false).find(|c| c.motion == with.motion)?;
    let ratio = |a: f64, b: f64| format!("{} times", short(a / b, 2));
    let stable = ratio(with.stable()[0]?, without.stable()[0]?);
    let accurate = with.accurate()[0].zip(without.accurate()[0]);
    let both = with.cells.iter().find_map(|x| {
        let errors = error_at(with, x.step_s).zip(error_at(without, x.step_s))?;
        Some((x.step_s, errors))
    });
    let own = with.step_s.zip(without.step_s).filter(|(a, b)| a != b);
    Some(html! {
        "Under " (with.manner()) " extrapolation " b { (with.model_label()) } " stays stable up to "
        (up_to(with.stable())) ", " (stable) " that of " b { (without.model_label()) } " (" (up_to(without.stable())) ")"
        @if let Some((a, b)) = accurate { ", and accurate " (ratio(a, b)) " as far" }
        @if let Some((h, (a, b))) = both {
            "; at " (quantity(h, "s", 3)) " the force is off by " (per_cent(a, 2)) " and " (per_cent(b, 2))
        }
        @if let Some((a, b)) = own {
            "; its gears take steps of " (quantity(a, "s", 3)) " in place of " (quantity(b, "s", 3))
        }
        "."
    })
}

/// Computes the order of an error between the two smallest steps without failure.
fn order(c: &Coupling, get: fn(&CouplingCell) -> Option<f64>) -> Option<f64> {
    let mut held = c.cells.iter().filter(|x| !x.status.is_failure());
    let (a, b) = (held.next()?, held.next()?);
    let ratio = (get(b)? / get(a)?).abs();
    (ratio > 0.0 && ratio.is_finite()).then(|| ratio.ln() / (b.step_s / a.step_s).ln())
}

pub fn tables(couplings: &[Coupling]) -> Markup {
    let labels = models(couplings);
    let style = |c: &Coupling| {
        labels
            .iter()
            .position(|l| *l == c.model_label())
            .unwrap_or(0)
    };
    let rows: Vec<&Coupling> = couplings.iter().collect();
    let steps = Table::of(&rows)
        .grouped(|c| (c.model_label(), style(c)))
        .text("Extrapolation", |c| c.manner())
        .written("Accurate up to", "", |c| up_to(c.accurate()))
        .result()
        .written("Stable up to", "", |c| up_to(c.stable()))
        .result()
        .written("Limit of theory", "", |c| {
            c.theory_s.map(|h| quantity(h, "s", 3))
        })
        .result()
        .written("Order of force error", "", |c| {
            order(c, |x| x.force_l2).map(|x| short(x, 3))
        })
        .written("Order of energy error", "", |c| {
            order(c, |x| x.energy_error_rel).map(|x| short(x, 3))
        })
        .written("Hubs on teeth", "", |c| {
            c.frequency_hz.map(|f| quantity(f, "Hz", 4))
        })
        .percents("Damping ratio", 3, |c| c.damping_ratio)
        .written("Integrator of the gears", "", |c| match c.step_s {
            Some(h) => format!("{} at {}", c.integrator, quantity(h, "s", 3)),
            None => c.integrator.clone(),
        });
    let all: Vec<(&Coupling, &CouplingCell)> = (couplings.iter())
        .flat_map(|c| c.all().into_iter().map(move |x| (c, x)))
        .collect();
    let cells = Table::of(&all)
        .grouped(|(c, _)| (format!("{}, {}", c.model_label(), c.manner()), style(c)))
        .classed(|(_, x)| if x.status.is_failure() { "failed" } else { "" })
        .columns(&columns(), |row| Some(*row));
    let energy: Vec<String> = (couplings.iter())
        .filter_map(|c| c.energy_j.map(|e| (c.model_label(), e)))
        .fold(Vec::new(), |mut told, (label, e)| {
            let text = format!("{label} {}", quantity(e, "J", 4));
            if !told.contains(&text) {
                told.push(text);
            }
            told
        });
    html! {
        (glance("How far the coupling holds", html! {
            (steps)
            (note("Accurate: every run up to there keeps the tolerance of the settings. Stable: none failed and none made up \
                   more energy than allowed. Orders are those between the two smallest steps; a force that begins within a step \
                   is of first order in the force, of second in the impulse, whatever the extrapolation."))
        }))
        (section("All runs", html! {
            (cells)
            (note(html! {
                "Energy error: work that the host takes less work that the gears give, over the energy that vibrates and passes \
                 through contacts (" (energy.join(", ")) ")" "."
            }))
        }))
    }
}
