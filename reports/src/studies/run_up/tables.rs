//! Finding and tables of run-ups.

use super::{ModelRunUp, NaturalFrequency, Peak, strongest};
use crate::markup::table::Table;
use crate::markup::{glance, note, prose, section};
use crate::numbers::{quantity, short, significant};
use maud::{Markup, html};
use std::f64::consts::TAU;

/// Orders of a quantity in the table.
const EACH: usize = 4;
/// Relative distance up to which a natural frequency is named with a peak.
const NEAR: f64 = 0.1;

fn turns_a_minute(speed: f64) -> f64 {
    60.0 * speed / TAU
}

/// Returns the natural frequency of the model that is closest to the peak, if it is near.
fn near<'a>(run: &'a ModelRunUp, peak: &Peak<'_>) -> Option<&'a NaturalFrequency> {
    let f = peak.frequency_hz();
    let off = |n: &&NaturalFrequency| (n.frequency_hz / f - 1.0).abs();
    let all = run.natural.iter().filter(|n| off(n) < NEAR);
    all.min_by(|a, b| off(a).total_cmp(&off(b)))
        .filter(|_| !peak.at_the_end)
}

pub fn finding(run_ups: &[ModelRunUp]) -> Vec<Markup> {
    let of = |run: &ModelRunUp| {
        let peak = strongest(run, 1).into_iter().next();
        html! {
            b { (run.label) } " "
            @match peak {
                None => { "has no run-up: " (prose(&run.message)) "." }
                Some(p) => {
                    "runs " (run.gear) " from " (short(run.lowest_rad_s, 3)) " to " (short(run.highest_rad_s, 3))
                    " rad/s; the largest amplitude of its " (p.channel.name) " is " (quantity(p.amplitude, &p.channel.unit, 3))
                    " at the order " (short(p.order.order, 5)) " (" (p.order.name) "), at " (short(p.speed_rad_s, 3)) " rad/s and "
                    (quantity(p.frequency_hz(), "Hz", 3))
                    @if let Some(n) = near(run, &p) {
                        ", beside the natural frequency " (quantity(n.frequency_hz, "Hz", 3)) " (" (n.name) ")"
                    } @else if p.at_the_end { ", where the run-up ends" }
                    "."
                }
            }
        }
    };
    run_ups.iter().map(of).collect()
}

pub fn tables(run_ups: &[ModelRunUp]) -> Markup {
    let peaks: Vec<(usize, &ModelRunUp, Peak<'_>)> = (run_ups.iter().enumerate())
        .flat_map(|(k, run)| strongest(run, EACH).into_iter().map(move |p| (k, run, p)))
        .collect();
    let ranking = Table::of(&peaks)
        .grouped(|(k, run, _)| (run.label.clone(), *k))
        .text("Quantity", |(.., p)| p.channel.name.clone())
        .text("Order", |(.., p)| p.order.name.clone())
        .key()
        .written("per turn", "", |(.., p)| short(p.order.order, 6))
        .result()
        .text("Amplitude", |(.., p)| {
            quantity(p.amplitude, &p.channel.unit, 4)
        })
        .result()
        .written("at speed", "rad/s", |(.., p)| significant(p.speed_rad_s, 4))
        .result()
        .written("", "1/min", |(.., p)| {
            significant(turns_a_minute(p.speed_rad_s), 4)
        })
        .written("and frequency", "Hz", |(.., p)| {
            significant(p.frequency_hz(), 4)
        })
        .result()
        .text("Natural frequency beside it", |(_, run, p)| {
            match near(run, p) {
                Some(n) => Some(format!(
                    "{} ({})",
                    quantity(n.frequency_hz, "Hz", 4),
                    n.name
                )),
                None if p.at_the_end => Some("end of the run-up".into()),
                None => None,
            }
        });
    let runs: Vec<(usize, &ModelRunUp)> = (run_ups.iter().enumerate())
        .filter(|(_, r)| r.message.is_empty())
        .collect();
    let windows = Table::of(&runs)
        .text("Model", |(_, r)| r.label.clone())
        .text("Reference gear", |(_, r)| r.gear.clone())
        .written("From", "rad/s", |(_, r)| significant(r.lowest_rad_s, 4))
        .result()
        .written("to", "rad/s", |(_, r)| significant(r.highest_rad_s, 4))
        .result()
        .written("Turns", "", |(_, r)| significant(r.turns, 4))
        .result()
        .numbers("Looked at from", "s", 3, |(_, r)| r.onset_s)
        .written("Windows of orders", "turns", |(_, r)| {
            short(r.by_turns.span, 4)
        })
        .result()
        .written("their number", "", |(_, r)| {
            r.by_turns.time_s.len().to_string()
        })
        .numbers("Windows of spectra", "s", 3, |(_, r)| r.by_time.span)
        .result()
        .written("number", "", |(_, r)| r.by_time.time_s.len().to_string());
    html! {
        (glance("Strongest orders", html! {
            (ranking)
            (note("Amplitudes (half of peak to peak) of orders that were followed, where they are largest over the speed; of bearing \
                   forces both radial components together. Amplitudes, speeds and frequencies are means over a window."))
        }))
        (section("The windows", html! {
            (windows)
            @for r in run_ups.iter().filter(|r| !r.message.is_empty()) {
                (note(html! { b { (r.label) } ": " (prose(&r.message)) "." }))
            }
        }))
    }
}
