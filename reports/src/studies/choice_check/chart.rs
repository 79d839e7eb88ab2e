//! Chart of validated choices: cost ratio and error over tolerance, scene by scene.

use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart};
use crate::drawing::style::{CurveStyle, Marker, curve_style};
use crate::record::finite;
use crate::studies::choice_check::{Outcome, ValidatedChoice, quantile};

/// Marker of scenes in which the choice missed.
const MISSED: CurveStyle = CurveStyle {
    ink: Ink::FAIL,
    dash: &[],
    marker: Marker::Wedge,
};
/// Marker of scenes without any adequate candidate.
const NONE: CurveStyle = CurveStyle {
    ink: Ink::GREY,
    dash: &[],
    marker: Marker::Diamond,
};
/// Cost ratio that the median is compared with.
const DEAR: f64 = 2.0;
/// Ratios beyond which points lie on the edge of their panel.
const ERRORS: [f64; 2] = [1e-3, 1e2];

/// Returns the scenes with their abscissae on the chart: by kind, within a kind by number.
fn ordered(choices: &[ValidatedChoice]) -> Vec<(f64, &ValidatedChoice)> {
    let mut all: Vec<&ValidatedChoice> = choices.iter().collect();
    all.sort_by(|a, b| (&a.kind, a.number).cmp(&(&b.kind, b.number)));
    let placed = all.into_iter().enumerate();
    placed.map(|(i, s)| (i as f64 + 1.0, s)).collect()
}

/// Returns the abscissae at which the kinds of scenes begin, with their names.
fn starts(scenes: &[(f64, &ValidatedChoice)]) -> Vec<(f64, String)> {
    let mut found: Vec<(f64, String)> = Vec::new();
    for (x, s) in scenes {
        if found.last().is_none_or(|(_, kind)| *kind != s.kind) {
            found.push((x - 0.5, s.kind.clone()));
        }
    }
    found
}

/// Draws the chart of validated choices.
pub fn choice_check(choices: &[ValidatedChoice]) -> Result<Vec<Chart>, DrawError> {
    let scenes = ordered(choices);
    if scenes.is_empty() {
        return Ok(Vec::new());
    }
    let n = scenes.len() as f64;
    let x = Axis::linear(0.0, n + 1.0);
    let points = |look: CurveStyle,
                  radius: f64,
                  filled: bool,
                  keep: &dyn Fn(&ValidatedChoice) -> bool,
                  y: &dyn Fn(&ValidatedChoice) -> Option<f64>| {
        let kept = scenes.iter().filter(|(_, s)| keep(s));
        let points = kept.filter_map(|(x, s)| Some((*x, finite(y(s)?)?)));
        Curve::points(look, radius, filled, points.collect())
    };
    let is = |outcome: Outcome| move |s: &ValidatedChoice| s.outcome == outcome;

    let ratios: Vec<f64> = scenes.iter().filter_map(|(_, s)| s.cost_ratio()).collect();
    let dearest = ratios.iter().copied().fold(2.0 * DEAR, f64::max);
    let mut cost = Panel::new(210.0, &x, "cost / cheapest adequate");
    cost.y = Some(Axis::logarithmic(0.8, dearest));
    cost.verticals = starts(&scenes);
    cost.limits = vec![(DEAR, String::new())];
    if let Some(median) = quantile(&ratios, 0.5) {
        cost.limits.push((median, format!("median {median:.2}")));
    }
    let adequate = is(Outcome::Adequate);
    let ratio = |s: &ValidatedChoice| s.cost_ratio();
    cost.curves = vec![points(curve_style(1), 3.8, true, &adequate, &ratio)];
    // Wrong choices and scenes without a choice have no ratio; they are drawn on the strip above.
    for (kept, look) in [
        (
            (|o| o.is_met() || o == Outcome::NotDecided) as fn(Outcome) -> bool,
            NONE,
        ),
        (|o| !o.is_met() && o != Outcome::NotDecided, MISSED),
    ] {
        let crosses = (scenes.iter())
            .filter(|(_, s)| kept(s.outcome) && s.outcome != Outcome::Adequate)
            .map(|(x, _)| *x);
        let none = Curve::points(look, 0.0, true, Vec::new());
        cost.curves.push(none.failed(crosses.collect()));
    }

    let [low, high] = ERRORS;
    let within = |x: Option<f64>| x.map(|x| x.clamp(1.05 * low, 0.95 * high));
    let pale = CurveStyle {
        ink: Ink::PALE,
        ..curve_style(1)
    };
    let predicted = |s: &ValidatedChoice| within(Some(s.predicted_error? / s.tolerance));
    let found = |s: &ValidatedChoice| within(s.error_ratio());
    let least = |s: &ValidatedChoice| within(Some(s.least_error? / s.tolerance));
    let error = Panel {
        y: Some(Axis::logarithmic(low, high)),
        x_name: Some("scenes, by kind and number".into()),
        limits: vec![(1.0, "tolerance".into())],
        ..Panel::new(230.0, &x, "error / tolerance").curves([
            points(pale, 3.2, false, &|s| s.chosen.is_some(), &predicted),
            points(curve_style(1), 3.8, true, &adequate, &found),
            points(MISSED, 4.8, true, &is(Outcome::Inadequate), &found),
            points(NONE, 3.8, false, &|s| s.chosen.is_none(), &least),
        ])
    };

    let legend = [
        Entry::marked("choice adequate", curve_style(1), true),
        Entry::marked("choice missed the tolerance", MISSED, true),
        Entry::marked("none chosen: least error there is", NONE, false),
        Entry::marked("error as predicted", pale, false),
    ];
    let caption = format!(
        "Above: processor time of the choice over that of the cheapest candidate that keeps the tolerance, \
         of all but those that cannot be cheaper. Crosses in the strip: red, a miss; grey, nothing keeps the tolerance, as the choice \
         said, or it was not decided. Below: error of the choice over the tolerance, against the reference over the whole scene; points \
         beyond {low} and {high} stand at the edge."
    );
    let title = "Choices on random scenes";
    Ok(vec![chart(
        "choice_check.svg",
        title,
        caption,
        &legend,
        &[cost, error],
    )?])
}
