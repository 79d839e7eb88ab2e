//! Error and cost over the number of modes and their highest frequency.

use crate::drawing::Chart;
use crate::drawing::axis::{Axis, tick_label};
use crate::drawing::canvas::DrawError;
use crate::drawing::curves::{Curve, CurvePanel, Mark, draw_curves};
use crate::drawing::style::{Look, look};
use crate::numbers::{count, short};
use crate::record::{Metrics, Run, finite};
use crate::studies::truncation::{LIMITS, Way, ways};
use crate::view::View;

/// Where gears without modes stand on the logarithmic abscissa, over the fewest modes there are.
const NONE_AT: f64 = 0.5;

/// A way of keeping modes with its look. Truncated ones have open markers.
struct Shown<'a> {
    way: Way<'a>,
    look: Look,
}

fn shown<'a>(view: &View<'a>) -> Vec<Shown<'a>> {
    let all = ways(view.results).into_iter();
    all.map(|way| {
        let first = way.runs.first().map_or(0, |(i, _)| *i);
        let group = (view.groups.iter()).find(|g| g.runs.iter().any(|(i, _)| *i == first));
        Shown {
            look: look(group.map_or(0, |g| g.style)),
            way,
        }
    })
    .collect()
}

fn legend(shown: &[Shown<'_>]) -> Vec<(String, Look, bool)> {
    (shown.iter())
        .map(|s| (s.way.label.clone(), s.look, s.way.residual))
        .collect()
}

/// Abscissa of mode counts: logarithmic, with a place for none at all.
struct Counts {
    none: f64,
    axis: Axis,
    ticks: Vec<(f64, String)>,
}

impl Counts {
    fn of(shown: &[Shown<'_>]) -> Option<Self> {
        let all: Vec<&Way<'_>> = shown.iter().map(|s| &s.way).collect();
        let mut tried: Vec<usize> = (all.iter())
            .flat_map(|w| w.runs.iter().filter_map(|(_, r)| r.modes))
            .collect();
        tried.sort_unstable();
        tried.dedup();
        let least = *tried.iter().find(|n| **n > 0)? as f64;
        let most = *tried.last()? as f64;
        let none = NONE_AT * least;
        let low = if tried[0] == 0 { none } else { least };
        let axis = Axis {
            min: 0.85 * low,
            max: 1.12 * most,
            log: true,
        };
        let mut ticks: Vec<(f64, String)> = Vec::new();
        if tried[0] == 0 {
            ticks.push((none, "0".into()));
        }
        let inner = Axis {
            min: least,
            ..axis.clone()
        };
        let at: Vec<f64> = inner.ticks(9);
        ticks.extend(at.iter().map(|&t| (t, tick_label(t, &at, true))));
        Some(Counts { none, axis, ticks })
    }

    fn place(&self, modes: usize) -> f64 {
        if modes == 0 { self.none } else { modes as f64 }
    }
}

/// A curve over an abscissa, failures where it has one.
fn curve(s: &Shown<'_>, x: impl Fn(&Run) -> Option<f64>, y: impl Fn(&Run) -> Option<f64>) -> Curve {
    let mut points: Vec<(f64, f64)> = (s.way.runs.iter())
        .filter(|(_, r)| !r.status.is_failure())
        .filter_map(|(_, r)| Some((x(r)?, finite(y(r)?)?)))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    Curve {
        look: s.look,
        width: 1.6,
        radius: 4.4,
        filled: s.way.residual,
        points,
        failed: (s.way.runs.iter())
            .filter(|(_, r)| r.status.is_failure())
            .filter_map(|(_, r)| x(r))
            .collect(),
    }
}

fn marks(
    shown: &[Shown<'_>],
    x: impl Fn(&Run) -> Option<f64>,
    y: impl Fn(&Run) -> Option<f64>,
) -> Vec<Mark> {
    (shown.iter())
        .flat_map(|s| &s.way.runs)
        .filter(|(_, r)| !r.status.is_failure())
        .filter_map(|(_, r)| {
            Some(Mark {
                at: (x(r)?, y(r)?),
                text: r.mark.clone()?,
            })
        })
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

/// The charts of a study of mode counts.
///
/// # Errors
/// [`DrawError`] when the backend refuses.
pub fn truncation(view: &View<'_>) -> Result<Vec<Chart>, DrawError> {
    let shown = shown(view);
    let (Some(x), Some(against)) = (Counts::of(&shown), view.against.clone()) else {
        return Ok(Vec::new());
    };
    let by_count = |r: &Run| Some(x.place(r.modes?));
    let legend = legend(&shown);
    let over_counts = |y_name: &str, remark: &str, last: bool| CurvePanel {
        height: 250.0,
        x: x.axis.clone(),
        x_ticks: x.ticks.clone(),
        x_name: last.then(|| "modes per gear".to_string()),
        y: None,
        y_name: y_name.into(),
        remark: remark.into(),
        curves: Vec::new(),
        limits: Vec::new(),
        verticals: Vec::new(),
        marks: Vec::new(),
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
    let mut panels: Vec<CurvePanel> = Vec::new();
    for (k, id) in ids.iter().enumerate() {
        let y = |r: &Run| percent_of(r, id, l2);
        let remark = format!("against {}", view.reference_name(id));
        let mut panel = over_counts("force-history error [%]", &remark, k + 1 == ids.len());
        panel.height = if k == 0 { 330.0 } else { 220.0 };
        panel.curves = shown.iter().map(|s| curve(s, by_count, y)).collect();
        panel.limits = limits();
        if k == 0 {
            panel.marks = marks(&shown, by_count, y);
        }
        panels.push(panel);
    }
    let mut charts = Vec::new();
    let how = "Relative L2 error of the contact-force history, not shifted in time. Filled: cut modes kept as \
               residual compliance; open: plain truncation. Failed runs stand as crosses above the frame.";
    if !panels.is_empty() {
        let title = "Error over the number of modes";
        charts.push(Chart {
            file: "truncation.svg".into(),
            title,
            caption: format!("{how} Left: gears without any mode."),
            svg: draw_curves(title, &legend, &panels)?,
        });
    }
    charts.extend(frequencies(view, &shown, &legend, &against)?);

    // Peak and impulse.
    type Get = fn(&Metrics) -> Option<f64>;
    let metrics: [(&str, Get); 2] = [
        ("peak-force error [%]", |m| m.peak_force_rel),
        ("impulse error [%]", |m| m.impulse_rel),
    ];
    let mut panels = Vec::new();
    for (k, (name, metric)) in metrics.into_iter().enumerate() {
        let y = |r: &Run| percent_of(r, &against, metric);
        let mut panel = over_counts(name, "", k == 1);
        panel.height = 210.0;
        panel.curves = shown.iter().map(|s| curve(s, by_count, y)).collect();
        panels.push(panel);
    }
    if panels
        .iter()
        .any(|p| p.curves.iter().any(|c| !c.points.is_empty()))
    {
        let title = "Peak force and impulse over the number of modes";
        charts.push(Chart {
            file: "truncation_peak.svg".into(),
            title,
            caption: format!(
                "Magnitudes of the deviations from {}.",
                view.reference_name(&against)
            ),
            svg: draw_curves(title, &legend, &panels)?,
        });
    }
    charts.extend(cost(&shown, &legend, &x, over_counts)?);
    Ok(charts)
}

fn frequencies(
    view: &View<'_>,
    shown: &[Shown<'_>],
    legend: &[(String, Look, bool)],
    against: &str,
) -> Result<Option<Chart>, DrawError> {
    let khz = |r: &Run| r.highest_hz.filter(|f| *f > 0.0).map(|f| 1e-3 * f);
    let all: Vec<f64> = (shown.iter())
        .flat_map(|s| s.way.runs.iter().filter_map(|(_, r)| khz(r)))
        .collect();
    let low = all.iter().copied().fold(f64::INFINITY, f64::min);
    let high = all.iter().copied().fold(0.0, f64::max);
    if low >= high {
        return Ok(None);
    }
    let y = |r: &Run| percent_of(r, against, |m| m.force_l2);
    let panel = CurvePanel {
        height: 330.0,
        x: Axis {
            min: 0.88 * low,
            max: 1.12 * high,
            log: true,
        },
        x_ticks: Vec::new(),
        x_name: Some("highest frequency among the modes [kHz]".into()),
        y: None,
        y_name: "force-history error [%]".into(),
        remark: format!("against {}", view.reference_name(against)),
        curves: shown.iter().map(|s| curve(s, khz, y)).collect(),
        limits: limits(),
        verticals: Vec::new(),
        marks: marks(shown, khz, y),
    };
    let title = "Error over the highest frequency";
    Ok(Some(Chart {
        file: "truncation_frequencies.svg".into(),
        title,
        caption: "The same runs over the highest frequency among the modes that either gear keeps. Modes chosen by \
                  flank compliance reach high frequencies early: the axis says what a step has to follow, not how \
                  many modes there are."
            .into(),
        svg: draw_curves(title, legend, &[panel])?,
    }))
}

/// Time of a step over the number of modes.
fn cost(
    shown: &[Shown<'_>],
    legend: &[(String, Look, bool)],
    x: &Counts,
    panel: impl Fn(&str, &str, bool) -> CurvePanel,
) -> Result<Option<Chart>, DrawError> {
    let by_count = |r: &Run| Some(x.place(r.modes?));
    let per_step = |r: &Run| {
        let t = 1e6 * r.wall_s / r.steps as f64;
        (t.is_finite() && t > 0.0).then_some(t)
    };
    let total = |r: &Run| finite(1e3 * r.wall_s).filter(|t| *t > 0.0);
    let mut step = panel("time per step [\u{b5}s]", "", false);
    let mut whole = panel("wall time of the run [ms]", "", true);
    for (p, y) in [
        (&mut step, &per_step as &dyn Fn(&Run) -> Option<f64>),
        (&mut whole, &total),
    ] {
        p.height = 190.0;
        p.curves = shown.iter().map(|s| curve(s, by_count, y)).collect();
    }
    if step.curves.iter().all(|c| c.points.is_empty()) {
        return Ok(None);
    }
    let title = "Cost over the number of modes";
    let repeats: u32 = (shown.iter())
        .flat_map(|s| s.way.runs.iter().map(|(_, r)| r.repeats))
        .max()
        .unwrap_or(0);
    Ok(Some(Chart {
        file: "truncation_cost.svg".into(),
        title,
        caption: format!(
            "Wall time over accepted steps, and of the whole run; setup is not included. Median of {} repeats. Plain \
             truncation needs the small steps of its stiff contact.",
            count(u64::from(repeats.max(1)))
        ),
        svg: draw_curves(title, legend, &[step, whole])?,
    }))
}
