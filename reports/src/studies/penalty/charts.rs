//! Force, impulse and transmission error over the penalty, with hard contact as their limit.

use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink};
use crate::drawing::curves::{Curve, CurvePanel, draw_curves};
use crate::drawing::style::{Look, Marker, look};
use crate::record::{Run, finite};
use crate::view::View;

/// Look of the hard contact.
const HARD: Look = Look {
    ink: Ink::DARK,
    dash: &[],
    marker: Marker::Diamond,
};

/// A quantity of a run: its name, its value in the unit of the name.
type Quantity = (&'static str, fn(&Run) -> Option<f64>);

/// What is shown.
pub const QUANTITIES: [Quantity; 3] = [
    ("peak force [N]", |r| r.metrics.first()?.peak_force_n),
    ("impulse [N s]", |r| r.metrics.first()?.impulse_ns),
    ("static TE [\u{b5}m]", |r| Some(1e6 * r.static_error_m?)),
];

/// The runs of one model by penalty, and its hard contact.
pub struct Series<'a> {
    /// Its name.
    pub label: String,
    /// Place in the order of appearance.
    pub style: usize,
    /// Runs with a penalty, ascending.
    pub soft: Vec<(f64, &'a Run)>,
    /// The run with hard contact.
    pub hard: Option<&'a Run>,
}

/// The models of a study of penalties.
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

/// The charts of a study of penalties.
///
/// # Errors
/// [`DrawError`] when the backend refuses.
pub fn penalty(view: &View<'_>) -> Result<Vec<Chart>, DrawError> {
    let all = series(view);
    if all.is_empty() {
        return Ok(Vec::new());
    }
    let penalties = || all.iter().flat_map(|s| s.soft.iter().map(|p| p.0));
    let x = Axis::logarithmic(
        penalties().fold(f64::INFINITY, f64::min),
        penalties().fold(0.0, f64::max),
    );
    let panel = |height: f64, y_name: &str, last: bool| CurvePanel {
        height,
        x: x.clone(),
        x_ticks: Vec::new(),
        x_name: last.then(|| "penalty [Pa/m]".to_string()),
        y: None,
        y_name: y_name.into(),
        remark: String::new(),
        curves: Vec::new(),
        limits: Vec::new(),
        verticals: Vec::new(),
        marks: Vec::new(),
    };
    let curve = |s: &Series<'_>, y: &dyn Fn(&Run) -> Option<f64>| Curve {
        look: look(s.style),
        width: 1.6,
        radius: 4.2,
        filled: true,
        points: (s.soft.iter())
            .filter(|(_, r)| !r.status.is_failure())
            .filter_map(|(p, r)| Some((*p, finite(y(r)?)?)))
            .collect(),
        failed: (s.soft.iter())
            .filter(|(_, r)| r.status.is_failure())
            .map(|(p, _)| *p)
            .collect(),
    };
    let mut legend: Vec<(String, Look, bool)> = (all.iter())
        .map(|s| (s.label.clone(), look(s.style), true))
        .collect();

    let mut distance = Vec::new();
    for (k, (name, get)) in QUANTITIES.into_iter().enumerate() {
        let name = name.split(" [").next().unwrap_or(name);
        let mut p = panel(170.0, &format!("{name} [%]"), k == 2);
        for s in &all {
            let Some(limit) = s.hard.and_then(get) else {
                continue;
            };
            let off = |r: &Run| {
                let d = 100.0 * (get(r)? / limit - 1.0).abs();
                (d > 0.0).then_some(d)
            };
            p.curves.push(curve(s, &off));
        }
        distance.push(p);
    }
    let plain = legend.clone();
    let mut panels = Vec::new();
    for (k, (name, get)) in QUANTITIES.into_iter().enumerate() {
        let mut p = panel(170.0, name, k == 2);
        for s in &all {
            if let Some(limit) = s.hard.and_then(get) {
                p.curves.push(Curve {
                    look: HARD,
                    width: 1.4,
                    radius: 0.0,
                    filled: false,
                    points: vec![(x.min, limit), (x.max, limit)],
                    failed: Vec::new(),
                });
            }
            p.curves.push(curve(s, &get));
        }
        // The limit counts, not zero.
        let values = || p.curves.iter().flat_map(|c| c.points.iter().map(|q| q.1));
        let (low, high) = (
            values().fold(f64::INFINITY, f64::min),
            values().fold(f64::NEG_INFINITY, f64::max),
        );
        p.y = Some(Axis::padded(low, high, 0.1));
        panels.push(p);
    }
    if all.iter().any(|s| s.hard.is_some()) {
        legend.push(("hard contact".into(), HARD, false));
    }
    let title = "Independence of the penalty";
    let mut charts = vec![Chart {
        file: "penalty.svg".into(),
        title,
        caption: "Peak force and impulse of the run, and mean static transmission error over one base pitch, over the \
                  penalty of the contact. The dark line is hard contact, which has none."
            .into(),
        svg: draw_curves(title, &legend, &panels)?,
    }];
    if distance
        .iter()
        .any(|p| p.curves.iter().any(|c| c.points.len() > 1))
    {
        let title = "Distance to hard contact";
        charts.push(Chart {
            file: "penalty_distance.svg".into(),
            title,
            caption: "Magnitudes of the deviations from hard contact. A penalty that gives like a spring in series \
                      loses a decade of deviation per decade of penalty; where the lines level off, step and mesh decide."
                .into(),
            svg: draw_curves(title, &plain, &distance)?,
        });
    }
    Ok(charts)
}
