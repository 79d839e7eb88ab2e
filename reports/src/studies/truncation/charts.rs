//! Charts of error and cost over the number of modes and their highest frequency.

use crate::drawing::Chart;
use crate::drawing::axis::{Axis, tick_label};
use crate::drawing::canvas::DrawError;
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart, extremes};
use crate::drawing::style::{CurveStyle, curve_style};
use crate::numbers::{count, short};
use crate::record::{Metrics, Run, finite};
use crate::studies::truncation::{LIMITS, TruncationVariant, counts, variants};
use crate::view::View;

/// Abscissa of gears without modes on the logarithmic axis, over the least number of modes.
const NONE_AT: f64 = 0.5;

/// A method of reduction with its look. Truncation has open markers.
struct StyledVariant<'a> {
    way: TruncationVariant<'a>,
    look: CurveStyle,
}

fn styled_variants<'a>(view: &View<'a>) -> Vec<StyledVariant<'a>> {
    let all = variants(view.results).into_iter();
    all.map(|way| {
        let first = way.runs.first().map_or(0, |(i, _)| *i);
        let group = (view.groups.iter()).find(|g| g.runs.iter().any(|(i, _)| *i == first));
        StyledVariant {
            look: curve_style(group.map_or(0, |g| g.style)),
            way,
        }
    })
    .collect()
}

fn legend(shown: &[StyledVariant<'_>]) -> Vec<Entry> {
    let entry = |s: &StyledVariant<'_>| Entry::marked(&s.way.label, s.look, s.way.residual);
    shown.iter().map(entry).collect()
}

/// Abscissa of mode counts: logarithmic, with a place for none at all.
struct ModeCountAxis {
    none: f64,
    axis: Axis,
    ticks: Vec<(f64, String)>,
}

impl ModeCountAxis {
    fn of(shown: &[StyledVariant<'_>]) -> Option<Self> {
        let tried = counts(shown.iter().map(|s| &s.way));
        let least = *tried.iter().find(|n| **n > 0)? as f64;
        let most = *tried.last()? as f64;
        let none = NONE_AT * least;
        let low = if tried[0] == 0 { none } else { least };
        let axis = Axis::decades(0.85 * low, 1.12 * most);
        let mut ticks: Vec<(f64, String)> = Vec::new();
        if tried[0] == 0 {
            ticks.push((none, "0".into()));
        }
        let inner = Axis::decades(least, axis.max);
        let at: Vec<f64> = inner.ticks(9);
        ticks.extend(at.iter().map(|&t| (t, tick_label(t, &at, true))));
        Some(ModeCountAxis { none, axis, ticks })
    }

    fn place(&self, modes: usize) -> f64 {
        if modes == 0 { self.none } else { modes as f64 }
    }
}

/// Returns a curve over an abscissa, with failed runs that have one.
fn curve(
    s: &StyledVariant<'_>,
    x: impl Fn(&Run) -> Option<f64>,
    y: impl Fn(&Run) -> Option<f64>,
) -> Curve {
    let mut points: Vec<(f64, f64)> = (s.way.runs.iter())
        .filter(|(_, r)| !r.status.is_failure())
        .filter_map(|(_, r)| Some((x(r)?, finite(y(r)?)?)))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let failed = s.way.runs.iter().filter(|(_, r)| r.status.is_failure());
    let curve = Curve::joined(s.look, 1.6, 4.4, points);
    Curve {
        marker: Some((s.look, 4.4, s.way.residual)),
        ..curve.failed(failed.filter_map(|(_, r)| x(r)).collect())
    }
}

fn marks(
    shown: &[StyledVariant<'_>],
    x: impl Fn(&Run) -> Option<f64>,
    y: impl Fn(&Run) -> Option<f64>,
) -> Vec<((f64, f64), String)> {
    (shown.iter())
        .flat_map(|s| &s.way.runs)
        .filter(|(_, r)| !r.status.is_failure())
        .filter_map(|(_, r)| Some(((x(r)?, y(r)?), r.mark.clone()?)))
        .collect()
}

fn percent_of(run: &Run, against: &str, metric: fn(&Metrics) -> Option<f64>) -> Option<f64> {
    let e = 100.0 * metric(run.against(against)?)?.abs();
    (e > 0.0).then_some(e)
}

fn limits() -> Vec<(f64, String)> {
    let text = |l: &f64| (100.0 * l, format!("{} %", short(100.0 * l, 2)));
    LIMITS.iter().map(text).collect()
}

/// Draws the charts of a study of mode counts.
pub fn truncation(view: &View<'_>) -> Result<Vec<Chart>, DrawError> {
    let shown = styled_variants(view);
    let (Some(x), Some(against)) = (ModeCountAxis::of(&shown), view.against.clone()) else {
        return Ok(Vec::new());
    };
    let by_count = |r: &Run| Some(x.place(r.modes?));
    let legend = legend(&shown);
    let over_counts = |height: f64, y_name: &str, last: bool| Panel {
        x_ticks: x.ticks.clone(),
        x_name: last.then(|| "modes per gear".to_string()),
        ..Panel::new(height, &x.axis, y_name)
    };
    let l2: fn(&Metrics) -> Option<f64> = |m| m.force_l2;

    // Force history against every reference.
    let ids: Vec<&str> = (view.results.references.iter())
        .map(|r| r.id.as_str())
        .filter(|id| {
            view.results
                .runs
                .iter()
                .any(|r| r.modes.is_some() && r.against(id).is_some())
        })
        .collect();
    let mut panels: Vec<Panel> = Vec::new();
    for (k, id) in ids.iter().enumerate() {
        let y = |r: &Run| percent_of(r, id, l2);
        let remark = format!("against {}", view.reference_name(id));
        let height = if k == 0 { 330.0 } else { 220.0 };
        let mut panel = over_counts(height, "force-history error [%]", k + 1 == ids.len());
        panel.remark = remark;
        panel.curves = shown.iter().map(|s| curve(s, by_count, y)).collect();
        panel.limits = limits();
        if k == 0 {
            panel.marks = marks(&shown, by_count, y);
        }
        panels.push(panel);
    }
    let mut charts = Vec::new();
    let how = "Relative L2 error of the contact-force history, not shifted in time. Filled: truncated modes kept as \
               residual compliance; open: plain truncation. Failed runs stand as crosses above the frame.";
    if !panels.is_empty() {
        let caption = format!("{how} Left: gears without any mode.");
        let title = "Error over the number of modes";
        charts.push(chart("truncation.svg", title, caption, &legend, &panels)?);
    }
    charts.extend(frequencies(view, &shown, &legend, &against)?);

    // Peak and impulse.
    type Field = fn(&Metrics) -> Option<f64>;
    let metrics: [(&str, Field); 2] = [
        ("peak-force error [%]", |m| m.peak_force_rel),
        ("impulse error [%]", |m| m.impulse_rel),
    ];
    let mut panels = Vec::new();
    for (k, (name, metric)) in metrics.into_iter().enumerate() {
        let y = |r: &Run| percent_of(r, &against, metric);
        let mut panel = over_counts(210.0, name, k == 1);
        panel.curves = shown.iter().map(|s| curve(s, by_count, y)).collect();
        panels.push(panel);
    }
    if (panels.iter().flat_map(|p| &p.curves)).any(|c| !c.points.is_empty()) {
        let reference = view.reference_name(&against);
        charts.push(chart(
            "truncation_peak.svg",
            "Peak force and impulse over the number of modes",
            format!("Magnitudes of the deviations from {reference}."),
            &legend,
            &panels,
        )?);
    }
    charts.extend(cost(&shown, &legend, &x, over_counts)?);
    Ok(charts)
}

fn frequencies(
    view: &View<'_>,
    shown: &[StyledVariant<'_>],
    legend: &[Entry],
    against: &str,
) -> Result<Option<Chart>, DrawError> {
    let khz = |r: &Run| r.highest_hz.filter(|f| *f > 0.0).map(|f| 1e-3 * f);
    let (low, high) =
        extremes((shown.iter()).flat_map(|s| s.way.runs.iter().filter_map(|(_, r)| khz(r))));
    if low >= high {
        return Ok(None);
    }
    let y = |r: &Run| percent_of(r, against, |m| m.force_l2);
    let x = Axis::decades(0.88 * low, 1.12 * high);
    let panel = Panel {
        x_name: Some("highest frequency among the modes [kHz]".into()),
        limits: limits(),
        marks: marks(shown, khz, y),
        ..Panel::new(330.0, &x, "force-history error [%]")
            .remark(format!("against {}", view.reference_name(against)))
            .curves(shown.iter().map(|s| curve(s, khz, y)))
    };
    chart(
        "truncation_frequencies.svg",
        "Error over the highest frequency",
        "The same runs over the highest frequency among the modes that either gear keeps. Modes chosen by flank \
         compliance reach high frequencies early: the axis says what a step has to follow, not how many modes there are.",
        legend,
        &[panel],
    )
    .map(Some)
}

/// Draws the time of a step over the number of modes.
fn cost(
    shown: &[StyledVariant<'_>],
    legend: &[Entry],
    x: &ModeCountAxis,
    panel: impl Fn(f64, &str, bool) -> Panel,
) -> Result<Option<Chart>, DrawError> {
    let by_count = |r: &Run| Some(x.place(r.modes?));
    let per_step = |r: &Run| {
        let t = 1e6 * r.wall_s / r.steps as f64;
        (t.is_finite() && t > 0.0).then_some(t)
    };
    let total = |r: &Run| finite(1e3 * r.wall_s).filter(|t| *t > 0.0);
    let mut step = panel(190.0, "time per step [\u{b5}s]", false);
    let mut whole = panel(190.0, "wall time of the run [ms]", true);
    for (p, y) in [
        (&mut step, &per_step as &dyn Fn(&Run) -> Option<f64>),
        (&mut whole, &total),
    ] {
        p.curves = shown.iter().map(|s| curve(s, by_count, y)).collect();
    }
    if step.curves.iter().all(|c| c.points.is_empty()) {
        return Ok(None);
    }
    let repeats: u32 = (shown.iter())
        .flat_map(|s| s.way.runs.iter().map(|(_, r)| r.repeats))
        .max()
        .unwrap_or(0);
    let caption = format!(
        "Wall time over accepted steps, and of the whole run; setup is not included. Median of {} repeats. Plain \
         truncation needs the small steps of its stiff contact.",
        count(u64::from(repeats.max(1)))
    );
    let title = "Cost over the number of modes";
    chart(
        "truncation_cost.svg",
        title,
        caption,
        legend,
        &[step, whole],
    )
    .map(Some)
}
