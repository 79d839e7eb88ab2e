//! What the terminal says of a choice.

use super::reason::{per_cent, seconds};
use super::requirement::Requirement;
use super::run::Choice;
use crate::cli::terminal::say;
use crate::experiment::budget::NOT_TRIED;

/// What is to be said where the finer mesh itself is off by more than was asked.
pub(super) fn doubt(choice: &Choice, requirement: &Requirement) -> Option<String> {
    let off = choice.parts.mesh.filter(|e| *e > requirement.tolerance)?;
    Some(format!(
        "twice the elements, which all models are held against, may be {} off themselves: this scene amplifies what a mesh is off; elastic gears with more elements (`flank_elements`, `rim_elements`) are judged by finer ones",
        per_cent(off)
    ))
}

/// The answer in plain words.
pub(super) fn summarise(choice: &Choice, requirement: &Requirement) {
    let wanted = format!(
        "{} within {}",
        requirement.title(),
        per_cent(requirement.tolerance)
    );
    match &choice.candidate {
        Some(c) => {
            say(&format!("{wanted}: {}", c.name()));
            say(&format!(
                "predicted error {}, predicted cost {} for the whole scene",
                per_cent(choice.predicted_error),
                seconds(choice.predicted_cost_s)
            ));
        }
        None => say(&format!("{wanted}: nothing is adequate")),
    }
    for sentence in &choice.reason {
        say(&format!("  {sentence}"));
    }
    // One number for a level with its best method, another for the choice.
    say(
        "  (`error` in the table is a level's under its most accurate method; the choice adds that of its own)",
    );
    for sentence in &choice.outside {
        say(&format!(
            "warning: not checked on scenes like this: {sentence}"
        ));
    }
    if let Some(doubt) = doubt(choice, requirement) {
        say(&format!("warning: {doubt}"));
    }
    if !choice.not_tried.is_empty() {
        say(&format!("{NOT_TRIED}: {}", choice.not_tried.join("; ")));
    }
    say(&format!(
        "{:<34} {:>9} {:>9}  {}",
        "level", "error", "cost", "result"
    ));
    for r in &choice.levels {
        let (cost, result) = match (&r.cheapest, &r.failure) {
            (_, Some(f)) => (String::new(), f.clone()),
            (Some((c, cost)), None) => {
                let name = c.name();
                let method = name.strip_prefix(&r.level.name()).unwrap_or(&name);
                let method = method.trim_start_matches(", ").to_string();
                (seconds(*cost), format!("adequate with {method}"))
            }
            (None, None) if r.adequate && choice.candidate.is_some() => {
                (String::new(), "adequate, dearer".into())
            }
            (None, None) if r.adequate => (String::new(), "no step tried keeps it".into()),
            (None, None) => (String::new(), "not adequate".into()),
        };
        say(&format!(
            "{:<34} {:>9} {:>9}  {result}",
            r.level.name(),
            per_cent(r.error),
            cost
        ));
    }
}
