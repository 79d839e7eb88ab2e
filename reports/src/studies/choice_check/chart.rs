//! Choices validated on random scenes: cost ratio, and error over tolerance, scene by scene.

use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink};
use crate::drawing::curves::{Curve, CurvePanel, draw_curves};
use crate::drawing::style::{Look, Marker, look};
use crate::record::finite;
use crate::studies::choice_check::{Outcome, ValidatedChoice, quantile};

/// Look of misses.
const MISSED: Look = Look {
    ink: Ink::FAIL,
    dash: &[],
    marker: Marker::Wedge,
};
/// Look of scenes in which nothing keeps the tolerance.
const NONE: Look = Look {
    ink: Ink::GREY,
    dash: &[],
    marker: Marker::Diamond,
};
/// Cost ratio that the median is held against.
const DEAR: f64 = 2.0;
/// Ratios beyond which points lie on the edge of their panel.
const ERRORS: [f64; 2] = [1e-3, 1e2];

/// Scenes at their places on the chart: by kind, within a kind by number.
fn ordered(choices: &[ValidatedChoice]) -> Vec<(f64, &ValidatedChoice)> {
    let mut all: Vec<&ValidatedChoice> = choices.iter().collect();
    all.sort_by(|a, b| (&a.kind, a.number).cmp(&(&b.kind, b.number)));
    let placed = all.into_iter().enumerate();
    placed.map(|(i, s)| (i as f64 + 1.0, s)).collect()
}

/// Where kinds begin.
fn starts(scenes: &[(f64, &ValidatedChoice)]) -> Vec<(f64, String)> {
    let mut found: Vec<(f64, String)> = Vec::new();
    for (x, s) in scenes {
        if found.last().is_none_or(|(_, kind)| *kind != s.kind) {
            found.push((x - 0.5, s.kind.clone()));
        }
    }
    found
}

/// The chart of a check.
///
/// # Errors
/// [`DrawError`] when the backend refuses.
pub fn choice_check(choices: &[ValidatedChoice]) -> Result<Vec<Chart>, DrawError> {
    let scenes = ordered(choices);
    if scenes.is_empty() {
        return Ok(Vec::new());
    }
    let n = scenes.len() as f64;
    let x = Axis::linear(0.0, n + 1.0);
    let points = |keep: &dyn Fn(&ValidatedChoice) -> bool,
                  y: &dyn Fn(&ValidatedChoice) -> Option<f64>| {
        (scenes.iter())
            .filter(|(_, s)| keep(s))
            .filter_map(|(x, s)| Some((*x, finite(y(s)?)?)))
            .collect::<Vec<_>>()
    };
    let curve = |look: Look, radius: f64, filled: bool, points: Vec<(f64, f64)>| Curve {
        look,
        width: 0.0,
        radius,
        filled,
        points,
        failed: Vec::new(),
    };
    let panel = |height: f64, y: Axis, y_name: &str, last: bool| CurvePanel {
        height,
        x: x.clone(),
        x_ticks: Vec::new(),
        x_name: last.then(|| "scenes, by kind and number".to_string()),
        y: Some(y),
        y_name: y_name.into(),
        remark: String::new(),
        curves: Vec::new(),
        limits: Vec::new(),
        verticals: Vec::new(),
        marks: Vec::new(),
    };

    let ratios: Vec<f64> = scenes.iter().filter_map(|(_, s)| s.cost_ratio()).collect();
    let dearest = ratios.iter().copied().fold(2.0 * DEAR, f64::max);
    let mut cost = panel(
        210.0,
        Axis::logarithmic(0.8, dearest),
        "cost / cheapest adequate",
        false,
    );
    cost.verticals = starts(&scenes);
    cost.limits = vec![(DEAR, String::new())];
    if let Some(median) = quantile(&ratios, 0.5) {
        cost.limits.push((median, format!("median {median:.2}")));
    }
    cost.curves.push(curve(
        look(1),
        3.8,
        true,
        points(&|s| s.outcome == Outcome::Adequate, &|s| s.cost_ratio()),
    ));
    // Misses and scenes without an answer have no ratio: they stand on the strip above.
    for (kept, look) in [
        (Outcome::is_met as fn(Outcome) -> bool, NONE),
        (|o| !o.is_met(), MISSED),
    ] {
        let mut c = curve(look, 0.0, true, Vec::new());
        c.failed = (scenes.iter())
            .filter(|(_, s)| kept(s.outcome) && s.outcome != Outcome::Adequate)
            .map(|(x, _)| *x)
            .collect();
        cost.curves.push(c);
    }

    let [low, high] = ERRORS;
    let within = |x: Option<f64>| x.map(|x| x.clamp(1.05 * low, 0.95 * high));
    let mut error = panel(
        230.0,
        Axis::logarithmic(low, high),
        "error / tolerance",
        true,
    );
    error.limits = vec![(1.0, "tolerance".into())];
    let predicted = |s: &ValidatedChoice| within(Some(s.predicted_error? / s.tolerance));
    error.curves.push(curve(
        Look {
            ink: Ink::PALE,
            ..look(1)
        },
        3.2,
        false,
        points(&|s| s.chosen.is_some(), &predicted),
    ));
    let found = |s: &ValidatedChoice| within(s.error_ratio());
    error.curves.push(curve(
        look(1),
        3.8,
        true,
        points(&|s| s.outcome == Outcome::Adequate, &found),
    ));
    error.curves.push(curve(
        MISSED,
        4.8,
        true,
        points(&|s| s.outcome == Outcome::Inadequate, &found),
    ));
    let least = |s: &ValidatedChoice| within(Some(s.least_error? / s.tolerance));
    error.curves.push(curve(
        NONE,
        3.8,
        false,
        points(&|s| s.chosen.is_none(), &least),
    ));

    let legend = [
        ("choice adequate".into(), look(1), true),
        ("choice missed the tolerance".into(), MISSED, true),
        ("none chosen: least error there is".into(), NONE, false),
        (
            "error as predicted".into(),
            Look {
                ink: Ink::PALE,
                ..look(1)
            },
            false,
        ),
    ];
    let title = "Choices on random scenes";
    Ok(vec![Chart {
        file: "choice_check.svg".into(),
        title,
        caption: format!(
            "Above: processor time of the choice over that of the cheapest candidate that keeps the tolerance, \
             of all but those that cannot be cheaper. Crosses in the strip: red, a miss; grey, nothing keeps the tolerance, as the choice \
             said. Below: error of the choice over the tolerance, against the reference over the whole scene; points \
             beyond {low} and {high} stand at the edge."
        ),
        svg: draw_curves(title, &legend, &[cost, error])?,
    }])
}
