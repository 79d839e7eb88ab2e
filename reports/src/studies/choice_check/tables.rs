//! Finding and tables of choices validated on random scenes.

use super::csv::columns;
use super::{Outcome, Share, ValidatedChoice, quantile, share, shares};
use crate::markup::table::Table;
use crate::markup::{glance, note, section};
use crate::numbers::{counted, per_cent, percent, short, significant};
use maud::{Markup, html};

pub fn finding(choices: &[ValidatedChoice]) -> Vec<Markup> {
    let all: Vec<&ValidatedChoice> = choices.iter().collect();
    let total = share("all", &all);
    let number = |o: Outcome| choices.iter().filter(|s| s.outcome == o).count();
    let of = |n: usize, one: &str, many: &str| counted(n, one, many);
    let part = total.met as f64 / total.scenes.max(1) as f64;
    let three = |x: f64| significant(x, 3);
    let mut sentences = vec![html! {
        "On " b { (total.met) " of " (of(total.scenes, "random scene", "random scenes")) } " (" (per_cent(part, 3))
        ") the choice does what was asked, " (of(number(Outcome::RightlyNone), "time", "times"))
        " by saying that nothing tried will do; " (of(number(Outcome::Inadequate), "choice is", "choices are"))
        " beyond the tolerance, " (of(number(Outcome::WronglyNone), "time", "times"))
        " an adequate candidate was overlooked, " (of(number(Outcome::NotDecided), "time", "times"))
        " the yardstick of the choice could not decide, " (of(number(Outcome::NotValidated), "scene", "scenes"))
        " could not be validated."
    }];
    if let [Some(low), Some(middle), Some(high), Some(most)] = total.cost_ratio {
        sentences.push(html! {
            "An adequate choice costs " b { (three(middle)) " times" } " the cheapest adequate candidate in the median \
             (quartiles " (three(low)) " and " (three(high)) ", nine tenths below " (three(most)) ")."
        });
    }
    if let [Some(low), Some(middle), Some(high), _] = total.prediction {
        sentences.push(html! {
            "Predicted errors are " (significant(middle, 2)) " times those found in the median (quartiles "
            (significant(low, 2)) " and " (significant(high, 2)) ")."
        });
    }
    sentences
}

/// Returns sentences on the errors of the scenes' own meshes and contacts, and of choices against full finite elements.
fn beyond_the_mesh(choices: &[ValidatedChoice]) -> Vec<Markup> {
    let mut sentences = Vec::new();
    let errors = |of: fn(&ValidatedChoice) -> Option<f64>| -> Vec<(f64, f64)> {
        (choices.iter())
            .filter_map(|s| Some((of(s)?, s.tolerance)))
            .collect()
    };
    let median = |of: &[(f64, f64)]| {
        let values: Vec<f64> = of.iter().map(|x| x.0).collect();
        quantile(&values, 0.5).map(|x| per_cent(x, 2))
    };
    let kept = |of: &[(f64, f64)]| of.iter().filter(|(e, t)| e <= t).count();
    let (given, mesh) = (errors(|s| s.given_error), errors(|s| s.mesh_error));
    if let (Some(given_off), Some(mesh_off)) = (median(&given), median(&mesh)) {
        sentences.push(html! {
            "Compared with the refined model, mesh and contact of the scenes themselves are " (given_off)
            " off in the median with as many modes, and keep the tolerance in " (kept(&given)) " of " (given.len())
            "; their meshes with its contact are " (mesh_off) " off and keep it in " (kept(&mesh)) " of " (mesh.len()) "."
        });
    }
    let full = errors(|s| s.full_error);
    if !full.is_empty() {
        let model = errors(|s| s.densest_error);
        sentences.push(html! {
            "Against full finite elements on a finer mesh, which touch with their elements, " b { (kept(&full)) " of "
            (full.len()) } " choices keep the tolerance"
            @if let Some(off) = median(&model) { "; the refined model itself is " (off) " off these in the median" }
            "."
        });
    }
    sentences
}

/// Returns the tables with the figures by group, and with the scenes that were missed.
pub fn tables(choices: &[ValidatedChoice]) -> Markup {
    let groups = shares(choices);
    let sure = |x: Option<f64>| x.map_or_else(|| "-".into(), |x| significant(x, 3));
    let part = |g: &Share| percent(g.met as f64 / g.scenes.max(1) as f64, 3);
    let table = Table::of(&groups)
        .text("Scenes", |g| g.name.clone())
        .written("Number", "", |g| g.scenes.to_string())
        .written("Met", "", |g| g.met.to_string())
        .written("Met", "%", part)
        .result()
        .written("Rightly none", "", |g| g.rightly_none.to_string())
        .written("Cost ratio, median", "", |g| sure(g.cost_ratio[1]))
        .result()
        .written("Cost ratio, 90 % below", "", |g| sure(g.cost_ratio[3]))
        .written("Predicted / true error, median", "", |g| {
            sure(g.prediction[1])
        })
        .result();
    let remark = note(
        "Met: the tolerance is kept against the reference over the whole scene, or nothing that was tried keeps it and the \
         choice said so. Cost ratio: processor time over that of the cheapest adequate candidate.",
    );
    let missed: Vec<&ValidatedChoice> = (choices.iter()).filter(|s| !s.outcome.is_met()).collect();
    let misses = Table::of(&missed)
        .text("Scene", |s| s.scene.clone())
        .text("Kind", |s| s.kind.clone())
        .text("Gears", |s| s.gears.clone())
        .text("Metric", |s| s.metric.short())
        .written("Tolerance", "%", |s| short(100.0 * s.tolerance, 2))
        .text("Outcome", |s| s.outcome.to_string())
        .result()
        .text("Chosen", |s| chosen(s))
        .text("Why", |s| s.why_missed())
        .result();
    html! {
        (glance("How choices came out", html! { (table) (remark) }))
        @let beyond = beyond_the_mesh(choices);
        @if !beyond.is_empty() {
            (section("Beyond the mesh of a scene", html! { @for sentence in beyond { p { (sentence) } } }))
        }
        @if !missed.is_empty() { (section("Misses", misses)) }
    }
}

fn chosen(s: &ValidatedChoice) -> String {
    s.chosen.clone().unwrap_or_else(|| "none".into())
}

/// Returns the table of all scenes, a row each.
pub fn scenes(choices: &[ValidatedChoice]) -> Markup {
    let columns = columns();
    let table = Table::of(choices)
        .classed(|s| if s.outcome.is_met() { "" } else { "failed" })
        .columns_by_key(&columns, &["scene", "kind"], Some)
        .text("Metric", |s| s.metric.short())
        .written("Tolerance", "%", |s| short(100.0 * s.tolerance, 2))
        .result()
        .text("Chosen", chosen)
        .result()
        .columns_by_key(&columns, &["predicted_error", "error"], Some)
        .written("Cost ratio", "", |s| {
            s.cost_ratio().map(|r| significant(r, 3))
        })
        .result()
        .columns_by_key(
            &columns,
            &[
                "outcome",
                "reference",
                "reference_error",
                "mesh_error",
                "given_error",
                "full_error",
            ],
            Some,
        );
    let remark = note(
        "Error of the yardstick: its change by twice the step or fewer modes. Mesh of the scene, mesh and contact: \
         their error against the yardstick with as many modes, the first with its contact. Finite elements: full ones, on a mesh three \
         times as fine along the flanks as the scene's, with a penalty.",
    );
    section("Scenes", html! { (table) (remark) })
}
