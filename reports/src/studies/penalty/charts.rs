//! Charts of force, impulse and transmission error over the penalty, with hard contact as their limit.

use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart, extremes};
use crate::drawing::style::curve_style;
use crate::record::{Run, finite};
use crate::view::View;

/// A quantity of a run: its name, its value in the unit of the name.
type Quantity = (&'static str, fn(&Run) -> Option<f64>);

/// Quantities over the penalty, each with name and unit, one panel each.
pub const QUANTITIES: [Quantity; 3] = [
    ("peak force [N]", |r| r.metrics.first()?.peak_force_n),
    ("impulse [N s]", |r| r.metrics.first()?.impulse_ns),
    ("static TE [\u{b5}m]", |r| Some(1e6 * r.static_error_m?)),
];

/// The runs of one model by penalty, and its hard contact.
pub struct Series<'a> {
    pub label: String,
    /// Place in the order of appearance.
    pub style: usize,
    /// Runs with a penalty, ascending.
    pub soft: Vec<(f64, &'a Run)>,
    /// The run with hard contact.
    pub hard: Option<&'a Run>,
}

/// Returns the models of a study of penalties.
pub fn series<'a>(view: &View<'a>) -> Vec<Series<'a>> {
    (view.groups.iter())
        .map(|g| {
            let mut soft: Vec<(f64, &Run)> = (g.runs.iter())
                .filter_map(|(_, r)| Some((r.penalty_pa_per_m?, *r)))
                .collect();
            soft.sort_by(|a, b| a.0.total_cmp(&b.0));
            Series {
                label: g.label.clone(),
                style: g.style,
                soft,
                hard: (g.runs.iter())
                    .find(|(_, r)| r.hard == Some(true) && !r.status.is_failure())
                    .map(|(_, r)| *r),
            }
        })
        .filter(|s| !s.soft.is_empty())
        .collect()
}

/// Draws the charts of a study of penalties.
pub fn penalty(view: &View<'_>) -> Result<Vec<Chart>, DrawError> {
    let all = series(view);
    if all.is_empty() {
        return Ok(Vec::new());
    }
    let (low, high) = extremes(all.iter().flat_map(|s| s.soft.iter().map(|p| p.0)));
    let x = Axis::logarithmic(low, high);
    let hard = Stroke::new(Ink::DARK, 1.4);
    let panel = |y_name: &str, last: bool, curves: Vec<Curve>| Panel {
        x_name: last.then(|| "penalty [Pa/m]".to_string()),
        ..Panel::new(170.0, &x, y_name).curves(curves)
    };
    let curve = |s: &Series<'_>, y: &dyn Fn(&Run) -> Option<f64>| {
        let (failed, held): (Vec<_>, Vec<_>) =
            (s.soft.iter()).partition(|(_, r)| r.status.is_failure());
        let point = |(p, r): &(f64, &Run)| Some((*p, finite(y(r)?)?));
        let points = held.into_iter().filter_map(point).collect();
        let failed = failed.into_iter().map(|(p, _)| *p).collect();
        Curve::joined(curve_style(s.style), 1.6, 4.2, points).failed(failed)
    };
    let (mut panels, mut distances) = (Vec::new(), Vec::new());
    for (k, (name, get)) in QUANTITIES.into_iter().enumerate() {
        let (mut values, mut distance) = (Vec::new(), Vec::new());
        for s in &all {
            if let Some(limit) = s.hard.and_then(get) {
                values.push(Curve::line(hard, vec![(x.min, limit), (x.max, limit)]));
                let off = |r: &Run| {
                    let d = 100.0 * (get(r)? / limit - 1.0).abs();
                    (d > 0.0).then_some(d)
                };
                distance.push(curve(s, &off));
            }
            values.push(curve(s, &get));
        }
        let mut p = panel(name, k == 2, values);
        // The limit counts, not zero.
        let (low, high) = p.ordinates();
        p.y = Some(Axis::padded(low, high, 0.1));
        panels.push(p);
        let name = name.split(" [").next().unwrap_or(name);
        distances.push(panel(&format!("{name} [%]"), k == 2, distance));
    }
    let mut legend: Vec<Entry> = (all.iter())
        .map(|s| Entry::marked(&s.label, curve_style(s.style), true))
        .collect();
    let plain = legend.clone();
    if all.iter().any(|s| s.hard.is_some()) {
        legend.push(Entry::line("hard contact", hard));
    }
    let mut charts = vec![chart(
        "penalty.svg",
        "Independence of the penalty",
        "Peak force and impulse of the run, and mean static transmission error over one base pitch, over the penalty of \
         the contact. The dark line is hard contact, which has none.",
        &legend,
        &panels,
    )?];
    if (distances.iter().flat_map(|p| &p.curves)).any(|c| c.points.len() > 1) {
        charts.push(chart(
            "penalty_distance.svg",
            "Distance to hard contact",
            "Magnitudes of the deviations from hard contact. A penalty that gives like a spring in series loses a decade \
             of deviation per decade of penalty; where the lines level off, step and mesh decide.",
            &plain,
            &distances,
        )?);
    }
    Ok(charts)
}
