//! Answer, reason and hierarchy of a choice.

use super::{ChoiceRecord, LevelRecord};
use crate::markup::table::Table;
use crate::markup::{glance, note, prose, section};
use crate::numbers::{limit, per_cent, quantity};
use maud::{Markup, html};

/// The answer.
pub fn finding(choice: &ChoiceRecord) -> Vec<Markup> {
    let asked = format!("{} within {}", choice.metric_title, limit(choice.tolerance));
    let Some(t) = choice.choice() else {
        return vec![html! {
            "For the " (asked) " " b { "nothing that was tried is adequate" }
            @if let Some(e) = choice.predicted_error { ": the least estimate is " (per_cent(e, 2)) }
            "."
        }];
    };
    let mut sentences = vec![html! {
        "The cheapest that was tried for the " (asked) " is " b { (prose(&t.level)) } " under " b { (t.method()) } "."
    }];
    if let (Some(e), Some(cost)) = (choice.predicted_error, choice.predicted_cost_s) {
        sentences.push(html! {
            "Its estimated error is " (per_cent(e, 2)) ", its predicted cost " (quantity(cost, "s", 3))
            " of processor time for the whole scene"
            @if let Some(setup) = choice.setup_s { " after a set-up of " (quantity(setup, "s", 2)) }
            "."
        });
    }
    sentences
}

/// Reason, warnings and the hierarchy.
pub fn tables(choice: &ChoiceRecord) -> Markup {
    html! {
        (section("Reason", html! { @for sentence in &choice.reason { p { (prose(sentence)) } } }))
        @if !choice.outside.is_empty() {
            section {
                h2 { "Outside of what was checked" }
                p { "Choices were not checked on scenes like this one:" }
                ul { @for sentence in &choice.outside { li { (prose(sentence)) } } }
            }
        }
        (hierarchy(choice))
    }
}

fn hierarchy(choice: &ChoiceRecord) -> Markup {
    let families = choice.families();
    let place = |r: &LevelRecord| families.iter().position(|f| *f == r.family).unwrap_or(0);
    let mut rows: Vec<&LevelRecord> = choice.levels.iter().collect();
    rows.sort_by_key(|r| place(r));
    if rows.is_empty() {
        return Markup::default();
    }
    let cheapest = |r: &LevelRecord| r.cheapest.and_then(|i| choice.tried.get(i));
    let outcome = |r: &&LevelRecord| match (&r.failure, r.cheapest) {
        (Some(f), _) => f.clone(),
        (_, Some(_)) if r.cheapest == choice.chosen => "chosen".into(),
        (_, Some(_)) => "adequate".into(),
        _ if r.adequate && choice.chosen.is_some() => "adequate, dearer".into(),
        _ if r.adequate => "no step tried keeps it".into(),
        _ => "not adequate".into(),
    };
    let table = Table::of(&rows)
        .grouped(|r| (r.family.clone(), place(r)))
        .classed(|r| match (&r.failure, r.cheapest) {
            (Some(_), _) => "failed",
            (None, None) if !r.adequate => "inaccurate",
            _ => "",
        })
        .text("Level", |r| r.name.clone())
        .percents("Distance to the top level", 2, |r| r.distance)
        .percents("Distance to the next level", 2, |r| r.step_up)
        .percents("Estimated error", 2, |r| r.error)
        .result()
        .text("Cheapest adequate integrator", |r| {
            cheapest(r).map(|t| t.method())
        })
        .result()
        .written("Predicted cost", "", |r| {
            Some(quantity(cheapest(r)?.cost_s?, "s", 3))
        })
        .result()
        .written("Set-up", "", |r| Some(quantity(r.setup_s?, "s", 2)))
        .text("Outcome", outcome)
        .result();
    let remark = format!(
        "Distances are those of the levels' own fine solutions on the window ({}). The estimated error adds what the top level \
         is off and holds over the whole scene. Parts of an error by model and by integrator are estimated each on its own: they \
         can cancel or add up, so that the whole is not their sum. Costs are processor times on this machine.",
        choice.window
    );
    glance("The hierarchy of models", html! { (table) (note(remark)) })
}
