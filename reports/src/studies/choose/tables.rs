//! Finding and tables of a model choice: choice, reasons, hierarchy of models and candidates.

use super::csv::{self, levels};
use super::{Adequacy, ChoiceRecord, ForceStatistics, LevelRecord, Verdict};
use crate::markup::table::Table;
use crate::markup::{glance, note, prose, section};
use crate::numbers::{counted, limit, per_cent, quantity};
use maud::{Markup, html};

/// Returns the sentences with the choice and its error.
pub fn finding(choice: &ChoiceRecord) -> Vec<Markup> {
    let asked = format!("{} within {}", choice.metric_title, limit(choice.tolerance));
    let least = choice.predicted_error.map(|e| per_cent(e, 2));
    let mut sentences = Vec::new();
    match (choice.answer(), choice.choice()) {
        (Verdict::Adequate, Some(t)) => {
            sentences.push(html! {
                "The cheapest that was tried for the " (asked) " is " b { (prose(&t.level)) } " under " b { (t.method()) } "."
            });
            sentences.extend(predicted(choice));
        }
        (Verdict::NotDecided, _) => sentences.push(html! {
            "For the " (asked) " it is " b { "not decided" } " which model is adequate"
            @if let Some(why) = &choice.not_repeatable { ": the history does not repeat (" (prose(why)) ")" }
            "."
        }),
        _ => sentences.push(html! {
            "For the " (asked) " " b { "nothing that was tried is adequate" }
            @if let Some(e) = &least { ": the least estimate is " (e) }
            "."
        }),
    }
    if !choice.yardstick.is_empty() {
        sentences.push(yardstick(choice));
    }
    sentences
}

/// Returns the sentences on the yardstick, its own error, and distances to the references of the scene.
fn yardstick(choice: &ChoiceRecord) -> Markup {
    let to =
        |x: Option<f64>, of: &str| x.map(|x| format!("the {of} is {} from it", per_cent(x, 2)));
    html! {
        "The yardstick is " (prose(&choice.yardstick)) ", whose own error is "
        @if let Some(own) = choice.yardstick_error { "estimated as " b { (per_cent(own, 2)) } }
        @else { "not known" }
        @for r in &choice.references {
            @let all: Vec<String> = [to(r.yardstick, "yardstick"), to(r.choice, "choice")].into_iter().flatten().collect();
            @if !all.is_empty() { "; the scene has the reference " b { (r.reference) } ": " (all.join(", ")) }
        }
        "."
    }
}

/// Returns the sentence on predicted error and cost of the choice.
fn predicted(choice: &ChoiceRecord) -> Option<Markup> {
    let (error, cost) = (choice.predicted_error?, choice.predicted_cost_s?);
    Some(html! {
        "Its estimated error is " (per_cent(error, 2)) ", its predicted cost " (quantity(cost, "s", 3))
        " of processor time for the whole scene"
        @if let Some(setup) = choice.setup_s { " after a set-up of " (quantity(setup, "s", 2)) }
        @if let Some(total) = choice.total_cost_s {
            "; " (counted(usize::try_from(choice.runs).unwrap_or(usize::MAX), "run costs", "runs cost")) " " (quantity(total, "s", 2)) " with the set-up"
        }
        "."
    })
}

/// Returns the tables with reasons, warnings and hierarchy.
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
    let outcome = |r: &&LevelRecord| match (&r.failure, r.cheapest, r.adequate) {
        (Some(f), _, _) => f.clone(),
        (_, Some(_), _) if r.cheapest == choice.chosen => "chosen".into(),
        (_, Some(_), of) => of.to_string(),
        (_, None, Adequacy::Adequate) if choice.chosen.is_some() => "adequate, dearer".into(),
        (_, None, Adequacy::Adequate) => "no step tried keeps it".into(),
        (_, None, of) => of.to_string(),
    };
    let table = Table::of(&rows)
        .grouped(|r| (r.family.clone(), place(r)))
        .classed(|r| match (&r.failure, r.cheapest) {
            (Some(_), _) => "failed",
            (None, None) if r.adequate != Adequacy::Adequate => "inaccurate",
            _ => "",
        })
        .columns_by_key(
            &levels(),
            &["level", "distance", "step_up", "estimated_error"],
            |l| Some((choice, *l)),
        )
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
        "Distances are those of the levels' own fine solutions on the window ({}). The estimated error is the distance to the \
         yardstick over the whole scene. A level is adequate where its error and the yardstick's own error together are within \
         the tolerance, not adequate where it is beyond the tolerance by more than the yardstick's own error, and not decided \
         between the two. Parts of an error by model and by integrator are estimated each on its own: they can cancel or add \
         up. Costs are processor times on this machine, set-up included once, with the caches as they were.",
        choice.window
    );
    let statistics = statistics(&rows);
    glance(
        "The hierarchy of models",
        html! { (table) (note(remark)) (statistics) },
    )
}

/// Returns the statistics of the contact force of all levels, for a history that is not repeatable.
fn statistics(levels: &[&LevelRecord]) -> Markup {
    let known: Vec<(&str, ForceStatistics)> = (levels.iter())
        .filter_map(|r| Some((r.name.as_str(), r.statistics?)))
        .collect();
    if known.is_empty() {
        return Markup::default();
    }
    let table = Table::of(&known)
        .text("Level", |(name, _)| (*name).to_owned())
        .columns(&csv::statistics(), |(_, s)| Some(*s));
    html! {
        (table)
        (note("The history of the contact force does not repeat: only its statistics on the window can be compared between levels. \
               They are not judged."))
    }
}
