//! Finding and tables of choices validated on random scenes.

use super::{Outcome, Share, ValidatedChoice, share, shares};
use crate::markup::table::Table;
use crate::markup::{glance, note, section};
use crate::numbers::{percent, significant};
use maud::{Markup, html};

pub fn finding(choices: &[ValidatedChoice]) -> Markup {
    let scenes = choices;
    let all: Vec<&ValidatedChoice> = scenes.iter().collect();
    let total = share("all", &all);
    let count = |o: Outcome| scenes.iter().filter(|s| s.outcome == o).count();
    let part = total.met as f64 / total.scenes.max(1) as f64;
    let three = |x: f64| significant(x, 3);
    html! {
        "On " b { (total.met) " of " (total.scenes) } " random scenes (" (percent(part, 3)) "\u{a0}%) the choice does what \
         was asked: " (count(Outcome::Adequate)) " times it keeps the tolerance, " (count(Outcome::RightlyNone)) " times it \
         rightly says that nothing tried does. " (count(Outcome::Inadequate)) " choices are beyond the tolerance, "
        (count(Outcome::WronglyNone)) " times an adequate candidate was overlooked, " (count(Outcome::NotValidated)) " scenes \
         could not be validated."
        @if let [Some(low), Some(middle), Some(high), Some(most)] = total.cost_ratio {
            " An adequate choice costs " b { (three(middle)) " times" } " the cheapest adequate candidate in the median \
             (quartiles " (three(low)) " and " (three(high)) ", nine tenths below " (three(most)) ")."
        }
        @if let [Some(low), Some(middle), Some(high), _] = total.prediction {
            " Predicted errors are " (significant(middle, 2)) " times those found in the median (quartiles "
            (significant(low, 2)) " and " (significant(high, 2)) ")."
        }
    }
}

/// Tables: figures by group, and the scenes that were missed.
pub fn tables(choices: &[ValidatedChoice]) -> Markup {
    let groups = shares(choices);
    let sure = |x: Option<f64>| x.map_or_else(|| "-".into(), |x| significant(x, 3));
    let part = |g: &Share| percent(g.met as f64 / g.scenes.max(1) as f64, 3);
    let table = Table::of(&groups)
        .text("Scenes", |g| g.name.clone())
        .written("number", "", |g| g.scenes.to_string())
        .written("met", "", |g| g.met.to_string())
        .written("met", "%", part)
        .written("rightly none", "", |g| g.rightly_none.to_string())
        .written("cost ratio, median", "", |g| sure(g.cost_ratio[1]))
        .written("90 % below", "", |g| sure(g.cost_ratio[3]))
        .written("predicted / true error, median", "", |g| {
            sure(g.prediction[1])
        });
    let remark = note(
        "met: the tolerance is kept against the reference over the whole scene, or nothing that was tried keeps it and the \
         choice said so. Cost ratio: processor time over that of the cheapest adequate candidate.",
    );
    let missed: Vec<&ValidatedChoice> = (choices.iter()).filter(|s| !s.outcome.is_met()).collect();
    let misses = Table::of(&missed)
        .text("Scene", |s| s.scene.clone())
        .text("Kind", |s| s.kind.clone())
        .text("Gears", |s| s.gears.clone())
        .text("Metric", |s| s.metric.to_string())
        .written("Tolerance", "%", |s| percent(s.tolerance, 2))
        .text("Outcome", |s| s.outcome.to_string())
        .text("Chosen", |s| chosen(s))
        .text("Why", |s| s.why_missed());
    html! {
        (glance("How choices came out", html! { (table) (remark) }))
        @if !missed.is_empty() { (section("Misses", misses)) }
    }
}

fn chosen(s: &ValidatedChoice) -> String {
    s.chosen.clone().unwrap_or_else(|| "none".into())
}

/// All scenes, one line each.
pub fn scenes(choices: &[ValidatedChoice]) -> Markup {
    let table = Table::of(choices)
        .classed(|s| if s.outcome.is_met() { "" } else { "failed" })
        .text("Scene", |s| s.scene.clone())
        .text("Kind", |s| s.kind.clone())
        .text("Metric", |s| s.metric.to_string())
        .percents("Tolerance", 2, |s| s.tolerance)
        .text("Against", |s| s.reference.clone())
        .percents("its own error", 2, |s| s.reference_error)
        .text("Chosen", chosen)
        .percents("Predicted", 2, |s| s.predicted_error)
        .percents("Error", 2, |s| s.error)
        .written("Cost ratio", "", |s| {
            s.cost_ratio().map(|r| significant(r, 3))
        })
        .text("Outcome", |s| s.outcome.to_string());
    let remark = note(
        "Its own error: what twice the step or fewer modes change in the densest elastic model; against full finite elements \
         nothing is stated.",
    );
    section("Scenes", html! { (table) (remark) })
}
