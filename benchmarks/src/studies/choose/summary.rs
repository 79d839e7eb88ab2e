//! Terminal summary of a record of `choose`.

use super::reasons::{per_cent, runs, seconds};
use super::run::Choice;
use crate::experiment::budget::NOT_TRIED;
use crate::messages::Messages;
use gearbench_reports::{Adequacy, ChoiceRecord, Verdict};

/// Prints the result of the choice in words.
pub(super) fn summarise(messages: &Messages, choice: &ChoiceRecord, found: &Choice) {
    let wanted = format!(
        "{} within {}",
        choice.metric_title,
        per_cent(choice.tolerance)
    );
    let own = match choice.yardstick_error {
        Some(own) => format!("the yardstick's own error is {}", per_cent(own)),
        None => "the yardstick's own error is not known".into(),
    };
    match (choice.answer(), &found.candidate) {
        (Verdict::Adequate, Some(c)) => {
            messages.print_line(&format!("{wanted}: {}", c.name()));
            messages.print_line(&format!(
                "predicted error {}, {own}; predicted cost {} a run after a set-up of {}, {} for {}",
                per_cent(found.predicted_error),
                seconds(found.predicted_cost_s),
                seconds(found.setup_s),
                seconds(found.total_cost_s),
                runs(found.runs)
            ));
        }
        (Verdict::NotDecided, _) => {
            let contradicts =
                (choice.references.iter()).find(|r| r.choice.is_some_and(|e| e > choice.tolerance));
            let why = match (&choice.not_repeatable, contradicts) {
                (_, Some(r)) => format!("`{}` contradicts the yardstick", r.reference),
                (Some(_), None) => format!("the history does not repeat; {own}"),
                (None, None) => own,
            };
            messages.print_line(&format!("{wanted}: not decided, {why}"));
        }
        _ => messages.print_line(&format!("{wanted}: nothing is adequate; {own}")),
    }
    for sentence in &choice.reason {
        messages.print_line(&format!("  {sentence}"));
    }
    // One number for a level with its best method, another for the choice.
    messages.print_line(
        "  (`error` in the table is a level's against the yardstick under its most accurate method; the choice adds that of its own)",
    );
    for sentence in &choice.outside {
        messages.print_line(&format!(
            "warning: not checked on scenes like this: {sentence}"
        ));
    }
    if !found.not_tried.is_empty() {
        messages.print_line(&format!("{NOT_TRIED}: {}", found.not_tried.join("; ")));
    }
    messages.print_line(&format!(
        "{:<34} {:>9} {:>9}  {}",
        "level", "error", "cost", "result"
    ));
    for r in &found.levels {
        let (cost, result) = match (&r.cheapest, &r.failure) {
            (_, Some(f)) => (String::new(), f.clone()),
            (Some((c, cost)), None) => {
                let name = c.name();
                let method = name.strip_prefix(&r.level.name()).unwrap_or(&name);
                let method = method.trim_start_matches(", ").to_string();
                (seconds(*cost), format!("adequate with {method}"))
            }
            (None, None) => {
                let word = match r.adequate {
                    Adequacy::Adequate if found.candidate.is_some() => "adequate, dearer",
                    Adequacy::Adequate => "no step tried keeps it",
                    of => of.as_str(),
                };
                (String::new(), word.into())
            }
        };
        messages.print_line(&format!(
            "{:<34} {:>9} {:>9}  {result}",
            r.level.name(),
            per_cent(r.error),
            cost
        ));
    }
}
