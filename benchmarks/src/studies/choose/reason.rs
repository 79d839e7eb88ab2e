//! The reason of a choice in plain words.

use super::detail::Detail;
use super::level::Level;
use super::refinement::Refinement;
use super::requirement::Requirement;
use super::run::{Choice, LevelTried};
use gearbench_reports::numbers::{percent, short};

/// A ratio in per cent, with the unit.
pub fn per_cent(x: f64) -> String {
    format!("{} %", percent(x, 2))
}

/// Seconds with a fitting unit.
pub fn seconds(s: f64) -> String {
    match s {
        s if s < 1e-3 => format!("{} us", short(1e6 * s, 2)),
        s if s < 1.0 => format!("{} ms", short(1e3 * s, 2)),
        s => format!("{} s", short(s, 2)),
    }
}

/// Sentences on why a choice is what it is.
pub fn reason(choice: &Choice, requirement: &Requirement, refinement: &Refinement) -> Vec<String> {
    let mut said = Vec::new();
    let limit = per_cent(requirement.tolerance);
    let metric = requirement.title();
    let top = refinement
        .top()
        .map_or(String::new(), |l| l.candidate.level.name());
    said.push(format!(
        "On the window ({}) the hierarchy of elastic gears {} `{top}`, which is estimated to be {} off in the {metric} by its modes.",
        choice.window.describe(),
        if refinement.settled { "settles at" } else { "ends unsettled at" },
        per_cent(refinement.remaining)
    ));
    if !choice.not_tried.is_empty() {
        said.push(format!(
            "The answer is of what was tried: for {} levels and methods no processor time was left (--budget).",
            choice.not_tried.len()
        ));
    }
    said.extend(beyond_the_mesh(choice, metric, refinement));
    if refinement.growth > 1.05 {
        said.push(format!(
            "A little more stiffness moves the {metric} {:.1} times as far over the whole scene as over the window; estimates are larger by that.",
            refinement.growth
        ));
    }
    let Some(candidate) = &choice.candidate else {
        said.push(format!(
            "Nothing that was tried keeps {limit}: the least estimate is {}.",
            per_cent(choice.predicted_error)
        ));
        return said;
    };
    let simpler = |r: &&LevelTried| r.level != candidate.level && !r.adequate;
    let told = |r: &LevelTried| match &r.failure {
        Some(f) => format!("{} ({f})", r.level.name()),
        None => format!("{} ({})", r.level.name(), per_cent(r.error)),
    };
    // Of another mesh or contact the nearest stands for all.
    let detail = candidate.level.detail();
    let (other, same): (Vec<_>, Vec<_>) = (choice.levels.iter())
        .take_while(|r| r.level != candidate.level)
        .filter(simpler)
        .partition(|r| r.level.detail().is_some() && r.level.detail() != detail);
    let nearest = (other.into_iter()).min_by(|a, b| a.error.total_cmp(&b.error));
    let cheaper: Vec<String> = same.into_iter().chain(nearest).map(told).collect();
    if !cheaper.is_empty() {
        said.push(format!(
            "Simpler models do not keep {limit}: {}.",
            cheaper.join(", ")
        ));
    }
    said.push(format!(
        "{} with {} has an estimated error of {} over the whole scene. It combines {} from the model and {} from the integration, both on the window, with the error of the most detailed model itself.",
        capital(&candidate.level.name()),
        candidate.method.method,
        per_cent(choice.predicted_error),
        per_cent(choice.parts.model),
        per_cent(choice.parts.integration)
    ));
    let next = (choice.levels.iter())
        .filter(|r| r.level != candidate.level)
        .filter_map(|r| r.cheapest.as_ref().map(|(c, cost)| (c, *cost)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((other, cost)) = next {
        said.push(format!(
            "The next cheapest adequate one, {}, costs {:.1} times as much.",
            other.name(),
            cost / choice.predicted_cost_s
        ));
    }
    if !matches!(candidate.level, Level::Rigid(_) | Level::MovableTeeth(_)) {
        said.push(format!(
            "Reducing the meshes is paid once ({} here) and kept on disk.",
            seconds(choice.setup_s)
        ));
    }
    said
}

/// What mesh and contact of the scene are off, and what all models are held against.
fn beyond_the_mesh(choice: &Choice, metric: &str, refinement: &Refinement) -> Vec<String> {
    let mut said = Vec::new();
    let given = (choice.levels.iter())
        .find(|l| l.level.detail() == Some(Detail::Given))
        .filter(|_| choice.details.lead.detail == Detail::HalfSpaces);
    if let Some(given) = given {
        let contact = match &choice.details.lead.label {
            Some(label) => format!("the elements and the contact of `{label}`"),
            None => "the elements of such a mesh and a penalty".into(),
        };
        said.push(format!(
            "Flanks touch on half-spaces (local = \"half-space\"): with {contact} the {metric} would be {} off.",
            per_cent(given.distance)
        ));
    }
    if let Some(why) = &choice.details.no_half_spaces {
        said.push(format!(
            "Flanks touch with the elements of their mesh, because {why}."
        ));
    }
    match (&refinement.finer, refinement.of_mesh()) {
        (Ok(finer), Some(distance)) => said.push(format!(
            "All models are held against twice the elements, from which the mesh of the scene is {} away and which are estimated to be {} off themselves; that took {} of set-up and {} of running.",
            per_cent(distance),
            per_cent(choice.parts.mesh.unwrap_or(f64::NAN)),
            seconds(choice.details.setup_s(Detail::Finer) + finer.setup_s),
            seconds(finer.outcome.row.wall_s)
        )),
        (Ok(_), None) => {}
        (Err(why), _) => said.push(format!(
            "What the mesh itself is off is not known: it was not refined ({why})."
        )),
    }
    said
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or(String::new(), |c| c.to_uppercase().chain(letters).collect())
}
