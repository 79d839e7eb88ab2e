//! Reasons of a choice in words.

use super::detail::Detail;
use super::refinement::Refinement;
use super::requirement::Requirement;
use super::run::{Choice, LevelResult};
use super::selection::SAME_COST;
use gearbench_reports::numbers::{percent, short};
use gearbench_reports::{Adequacy, Verdict};

/// Formats a ratio in per cent, with the unit.
pub fn per_cent(x: f64) -> String {
    format!("{} %", percent(x, 2))
}

/// Formats a time given in seconds with a suitable unit.
pub fn seconds(s: f64) -> String {
    match s {
        s if s < 1e-3 => format!("{} us", short(1e6 * s, 2)),
        s if s < 1.0 => format!("{} ms", short(1e3 * s, 2)),
        s => format!("{} s", short(s, 2)),
    }
}

/// Describes the yardstick: its level, mesh and contact.
pub fn yardstick(choice: &Choice) -> String {
    let name = choice.yardstick.level.name();
    let contact = match choice.details.on_half_spaces() {
        true => "on half-spaces",
        false => "with the contact of the scene",
    };
    match choice.yardstick.level.detail() {
        Some(Detail::Finer) => format!("`{name}` (twice the elements of the scene, {contact})"),
        _ => format!("`{name}` (the mesh of the scene, {contact})"),
    }
}

/// Returns sentences that explain a choice.
pub fn reason(choice: &Choice, requirement: &Requirement, refinement: &Refinement) -> Vec<String> {
    let mut said = Vec::new();
    let limit = per_cent(requirement.tolerance);
    let metric = requirement.title();
    let top = refinement
        .top()
        .map_or(String::new(), |l| l.candidate.level.name());
    said.push(format!(
        "On the window ({}) the hierarchy of elastic gears {} `{top}`, whose error in the {metric} is estimated as {} by its modes.",
        choice.window.describe(),
        if refinement.settled { "settles at" } else { "ends unsettled at" },
        per_cent(refinement.remaining)
    ));
    said.push(own_error(choice, requirement));
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
    if let Some(why) = &choice.not_repeatable {
        said.push(format!(
            "The history does not repeat: {why}. No model predicts such a history; the statistics of the contact force are listed by level, and are not judged."
        ));
    }
    let Some(candidate) = &choice.candidate else {
        said.push(match choice.verdict {
            Verdict::NoneAdequate => format!(
                "Nothing that was tried keeps {limit}: the least estimate is {}.",
                per_cent(choice.predicted_error)
            ),
            _ => undecided(choice, &limit),
        });
        return said;
    };
    let simpler = |r: &&LevelResult| r.level != candidate.level && r.adequate != Adequacy::Adequate;
    let told = |r: &LevelResult| match (&r.failure, r.adequate) {
        (Some(f), _) => format!("{} ({f})", r.level.name()),
        (None, Adequacy::NotDecided) => {
            format!("{} ({}, not decided)", r.level.name(), per_cent(r.error))
        }
        (None, _) => format!("{} ({})", r.level.name(), per_cent(r.error)),
    };
    // Among levels of another mesh or contact only the nearest is listed.
    let detail = candidate.level.detail();
    let (other, same): (Vec<_>, Vec<_>) = (choice.levels.iter())
        .take_while(|r| r.level != candidate.level)
        .filter(simpler)
        .partition(|r| r.level.detail().is_some() && r.level.detail() != detail);
    let nearest = (other.into_iter()).min_by(|a, b| a.error.total_cmp(&b.error));
    let cheaper: Vec<String> = same.into_iter().chain(nearest).map(told).collect();
    if !cheaper.is_empty() {
        said.push(format!(
            "Simpler models are not known to keep {limit}: {}.",
            cheaper.join(", ")
        ));
    }
    said.push(format!(
        "{} with {} has an estimated error of {} over the whole scene against the yardstick. It combines {} from the model and {} from the integration, both on the window.",
        capital(&candidate.level.name()),
        candidate.method.method,
        per_cent(choice.predicted_error),
        per_cent(choice.parts.model),
        per_cent(choice.parts.integration)
    ));
    said.push(format!(
        "The cost of a model is the processor time of its set-up, {} here, once and of its runs (--runs): {} for {}.",
        seconds(choice.setup_s),
        seconds(choice.total_cost_s),
        runs(choice.runs)
    ));
    let next = (choice.levels.iter())
        .filter(|r| r.level != candidate.level)
        .filter_map(|r| {
            let (c, cost) = r.cheapest.as_ref()?;
            Some((c, r.setup_s + choice.runs as f64 * cost))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((other, cost)) = next {
        let ratio = cost / choice.total_cost_s;
        said.push(match ratio <= SAME_COST {
            true => format!(
                "{} costs the same within 10 %; the simpler model is chosen.",
                capital(&other.name())
            ),
            false => format!(
                "The next cheapest adequate one, {}, costs {ratio:.1} times as much.",
                other.name()
            ),
        });
    }
    said
}

/// Formats a number of runs in words.
pub fn runs(n: u64) -> String {
    match n {
        1 => "one run".into(),
        n => format!("{n} runs"),
    }
}

/// Describes the yardstick's own error.
fn own_error(choice: &Choice, requirement: &Requirement) -> String {
    let parts = &choice.parts;
    let mesh = match parts.mesh {
        Some(e) => format!("{} by its mesh", per_cent(e)),
        None => "an unknown part by its mesh, which counts as zero".into(),
    };
    let scatter = match choice.scatter > 0.0 {
        true => format!(
            ", and by the scatter of a history that does not repeat, {}",
            per_cent(choice.scatter)
        ),
        false => String::new(),
    };
    match choice.own_error {
        Some(own) => format!(
            "The yardstick is {}. Its own error in the {} over the whole scene is estimated as {}: on the window {} by its modes, {mesh} and {} by its integration{scatter}. A level is adequate where its error and that one together keep the tolerance.",
            yardstick(choice),
            requirement.title(),
            per_cent(own),
            per_cent(parts.top),
            per_cent(parts.top_integration)
        ),
        None => format!(
            "The yardstick is {}. Its own error in the {} is not known, so nothing is judged by it.",
            yardstick(choice),
            requirement.title()
        ),
    }
}

/// Explains why it is not decided whether any candidate is adequate.
fn undecided(choice: &Choice, limit: &str) -> String {
    let cure = "elastic gears with more elements (`flank_elements`, `rim_elements`) have a yardstick of finer ones";
    match choice.own_error {
        _ if choice.not_repeatable.is_some() => format!(
            "So it is not decided what keeps {limit}: ask for a single number (--metric impulse or energy), for a shorter scene, or give the scene its damping."
        ),
        Some(own) => format!(
            "It is not decided what keeps {limit}: the yardstick itself has an error of {}; {cure}.",
            per_cent(own)
        ),
        None => format!(
            "It is not decided what keeps {limit}: the error of the yardstick is not known."
        ),
    }
}

/// Describes the errors of mesh and contact of the scene, and the yardstick of all models.
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
            "The mesh of the scene is {} away from twice the elements, which took {} of set-up and {} of running.",
            per_cent(distance),
            seconds(choice.details.setup_s(Detail::Finer) + finer.setup_s),
            seconds(finer.outcome.row.cpu_s)
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
