//! Charts of error over cost: a point per run, the Pareto front as a staircase, failed runs in a strip of their own.

mod families;
mod integration;

use crate::drawing::Chart;
use crate::drawing::axis::{Axis, Frame};
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw_with};
use crate::drawing::geometry::Rect;
use crate::drawing::labels::OccupiedArea;
use crate::drawing::panel::{LEFT, RIGHT, WIDTH, extremes};
use crate::drawing::scatter;
use crate::drawing::style::{CurveStyle, cross, curve_style, marker};
use crate::metrics::Metric;

use crate::numbers::{count, per_cent, quantity};
use crate::record::{Run, SELF, Status};
use crate::studies::precision::pareto::Point;
use crate::studies::precision::{
    Cost, Precision, WorkPrecision, WorkPrecisionPoint, id_of, modes_and_step,
};
use crate::view::{View, capital, metric_against, resolution};
use families::families;
use integration::integration;

/// Opacity of points that are dominated.
const FAINT: f64 = 0.3;
/// Height of a plot and of a small one.
const PLOT: f64 = 400.0;
const SMALL: f64 = 225.0;
/// Space above a small one for its heading.
const ABOVE: f64 = 24.0;
const ROW: f64 = 19.0;
/// Size of the names of points.
const NAME: f64 = 11.5;

/// Draws the charts of error over cost.
pub fn precision(view: &View<'_>) -> Result<Vec<Chart>, DrawError> {
    let study = Precision::of(view.results);
    let metric = study.headline();
    let mut charts = Vec::new();
    let one = |against: &str, metric, cost, file: String| {
        all_runs(view, &study, (against, metric, cost), file)
    };
    for (i, id) in study.references.iter().enumerate() {
        charts.extend(one(id, metric, Cost::Processor, numbered("model", i))?);
    }
    charts.extend(integration(&study, metric)?);
    let work = "precision_work.svg".to_owned();
    if let Some(first) = study.references.first() {
        charts.extend(families(view, &study, first, metric)?);
        charts.extend(one(first, metric, Cost::Evaluations, work)?);
        for (i, further) in study.metrics.iter().enumerate().skip(1) {
            charts.extend(one(
                first,
                *further,
                Cost::Processor,
                numbered("metric", i),
            )?);
        }
    } else {
        charts.extend(one(SELF, metric, Cost::Evaluations, work)?);
    }
    Ok(charts)
}

/// Returns the file name of a chart of which there may be several.
fn numbered(what: &str, place: usize) -> String {
    match place {
        0 => format!("precision_{what}.svg"),
        _ => format!("precision_{what}_{}.svg", place + 1),
    }
}

/// Axes around points, in per cent and milliseconds or evaluations.
struct Scale {
    cost: f64,
    x: Axis,
    y: Axis,
    x_name: &'static str,
}

impl Scale {
    fn of(points: impl Iterator<Item = Point> + Clone, cost: Cost) -> Option<Self> {
        let (factor, x_name) = match cost {
            Cost::Processor => (1e3, "processor time [ms]"),
            Cost::Evaluations => (1.0, "force evaluations"),
        };
        let x = extremes(points.clone().map(|p| factor * p.cost));
        let y = extremes(points.map(|p| 100.0 * p.error));
        (x.1 > 0.0).then(|| Scale {
            cost: factor,
            x: Axis::logarithmic(x.0, x.1),
            y: Axis::logarithmic(y.0, y.1),
            x_name,
        })
    }

    fn frame(&self, area: Rect) -> Frame {
        Frame {
            area,
            x: self.x.clone(),
            y: self.y.clone(),
        }
    }

    fn at(&self, frame: &Frame, p: Point) -> (f64, f64) {
        frame.at(self.cost * p.cost, 100.0 * p.error)
    }
}

fn translucent(look: CurveStyle) -> CurveStyle {
    CurveStyle {
        ink: look.ink.opacity(FAINT),
        ..look
    }
}

/// Paints the staircase of a front: all points above and to the right of it are dominated.
fn staircase(
    c: &mut Canvas,
    frame: &Frame,
    scale: &Scale,
    points: &[Point],
    stroke: Stroke,
    room: &mut OccupiedArea,
) {
    let mut path: Vec<(f64, f64)> = Vec::with_capacity(2 * points.len() + 2);
    for p in points {
        let at = scale.at(frame, *p);
        let from = path.last().map_or(frame.area.y0, |l| l.1);
        path.extend([(at.0, from), at]);
    }
    if let Some(last) = path.last().copied() {
        path.push((frame.area.x1, last.1));
        scatter::guide(c, &path, &frame.area, stroke, None);
        room.occupy_line(&path);
    }
}

/// Draws the chart of all runs against one reference.
fn all_runs(
    view: &View<'_>,
    study: &Precision<'_>,
    (against, metric, cost): (&str, Metric, Cost),
    file: String,
) -> Result<Option<Chart>, DrawError> {
    let metric = metric_against(view.results, against, metric);
    let cloud = study.cloud(against, metric, cost);
    let Some(scale) = Scale::of(cloud.shown.iter().map(|s| s.point), cost) else {
        return Ok(None);
    };
    let fitted = cloud.has_fitted();
    let all = cloud.front(|_| true);
    let fair = cloud.front(|s| !s.is_fitted());
    let reasons = cloud.reasons();
    let models = models_of(study, &cloud);
    let models: Vec<(&str, usize)> = models.iter().map(|(s, m)| (m.as_str(), *s)).collect();
    let top = scatter::key_height(&models, WIDTH);
    let strip = strip_height(&reasons);
    let area = Rect::new(LEFT, top + strip, WIDTH - RIGHT, top + strip + PLOT);
    let reference = view.reference_name(against);
    let over = match cost {
        Cost::Processor => "processor time",
        Cost::Evaluations => "force evaluations",
    };
    // Names of references are long, and the caption has them.
    let short = match against {
        SELF => "the converged solution",
        id => id,
    };
    let title = format!("{} against {short}, over {over}", capital(metric.words()));
    let svg = draw_with(WIDTH, area.y1 + 46.0, &title, &scatter::panels(), |c| {
        scatter::key(c, &models, WIDTH, true);
        let edge = Rect::new(LEFT, top, WIDTH - RIGHT, top + strip - 8.0);
        failures(c, &reasons, &edge);
        let frame = scale.frame(area);
        let y_name = metric.axis();
        c.group(&frame.attributes("panel", scale.x_name, &y_name, ""), |c| {
            frame.paint(c, scale.x_name, &y_name, true);
            let on = |i: &usize| all.contains(i) || fair.contains(i);
            let mut room = OccupiedArea::of(area);
            for s in (0..cloud.shown.len())
                .filter(|i| !on(i))
                .map(|i| &cloud.shown[i])
            {
                let at = scale.at(&frame, s.point);
                let look = translucent(curve_style(s.style));
                scatter::point(c, at, (s.style, None), &point_text(study, s), |c| {
                    marker(c, at, 3.4, look, !s.run.implicit);
                });
                room.keep_pale(at, 3.4);
            }
            let stairs =
                |of: &[usize]| of.iter().map(|&i| cloud.shown[i].point).collect::<Vec<_>>();
            if fitted {
                let stroke = Stroke::dashed(Ink::GREY, 1.3, &[3.0, 3.0]);
                staircase(c, &frame, &scale, &stairs(&all), stroke, &mut room);
            }
            let full = Stroke::new(Ink::DARK, 1.5);
            staircase(c, &frame, &scale, &stairs(&fair), full, &mut room);
            for s in (0..cloud.shown.len()).filter(on).map(|i| &cloud.shown[i]) {
                let at = scale.at(&frame, s.point);
                room.occupy_point(at, 6.0);
                scatter::point(c, at, (s.style, None), &point_text(study, s), |c| {
                    marker(c, at, 5.4, curve_style(s.style), !s.run.implicit);
                });
            }
            let mut named = cloud.improvements(&fair);
            named.extend(cloud.improvements(&all));
            named.sort_unstable();
            named.dedup();
            c.group(&scatter::notes(), |c| {
                for &i in &named {
                    let s = &cloud.shown[i];
                    let text = words(s);
                    let kind = Type::new(NAME, Anchor::Start);
                    room.write(c, &text, scale.at(&frame, s.point), kind);
                }
            });
        });
    })?;
    Ok(Some(Chart {
        file,
        title,
        caption: caption(&reference, metric, cost, fitted, against == SELF),
        svg,
    }))
}

fn caption(reference: &str, metric: Metric, cost: Cost, fitted: bool, own: bool) -> String {
    let what = match cost {
        Cost::Processor => "processor time, median of the repeats without setup",
        Cost::Evaluations => {
            "evaluations of the contact forces, which a noisy machine does not change; one of a larger model takes longer"
        }
    };
    let fits = if fitted {
        " The full staircase is the front of models with nothing fitted; the dotted one takes in those whose constants \
         were fitted to that very history, whose error there is the rest of a fit."
    } else {
        ""
    };
    let two = if own {
        ""
    } else {
        " An error against this reference is that of the model and its resolution together."
    };
    format!(
        "{} against {reference} over {what}. Every point is a run; those on the front are strong and named, those that \
         another beats in both are faint.{two}{fits} Failed runs stand above, by reason; their place in a row means nothing, \
         for the time at which a run failed is no cost.",
        capital(metric.words()),
    )
}

/// Returns the text at a point of the front: integrator, modes and step.
fn words(s: &WorkPrecisionPoint<'_>) -> String {
    format!("{} {}", id_of(&s.run.integrator), modes_and_step(s.run))
}

/// Returns model, method, error and cost of a point as a text for the cursor of a page.
fn point_text(study: &Precision<'_>, s: &WorkPrecisionPoint<'_>) -> String {
    let modes = s
        .run
        .modes
        .map_or_else(String::new, |n| format!(", {n} modes"));
    format!(
        "{}{modes} under {}, {}: {} in {} and {} force evaluations",
        study.models[s.style],
        s.run.integrator,
        resolution(s.run),
        per_cent(s.point.error, 3),
        quantity(s.run.cost_s(), "s", 3),
        count(s.run.force_evaluations)
    )
}

/// Returns the models of a cloud: place, label and whether they are fitted.
fn models_of(study: &Precision<'_>, cloud: &WorkPrecision<'_>) -> Vec<(usize, String)> {
    let styles = (cloud.shown.iter().map(|s| (s.style, s.is_fitted()))).chain(
        cloud
            .failed
            .iter()
            .map(|(r, style)| (*style, r.fitted_to.is_some())),
    );
    let mut found: Vec<(usize, bool)> = Vec::new();
    for (style, fitted) in styles {
        if !found.iter().any(|f| f.0 == style) {
            found.push((style, fitted));
        }
    }
    found.sort_unstable();
    let label = |(style, fitted): (usize, bool)| {
        let name = &study.models[style];
        let text = if fitted {
            format!("{name} (fitted)")
        } else {
            name.clone()
        };
        (style, text)
    };
    found.into_iter().map(label).collect()
}

fn strip_height(reasons: &[(Status, Vec<(&Run, usize)>)]) -> f64 {
    if reasons.is_empty() {
        0.0
    } else {
        16.0 + ROW * reasons.len() as f64
    }
}

/// Paints failed runs in their strip, a row per reason.
fn failures(c: &mut Canvas, reasons: &[(Status, Vec<(&Run, usize)>)], edge: &Rect) {
    if reasons.is_empty() {
        return;
    }
    c.edge_of_failures(edge);
    let left = edge.x0 + 160.0;
    for (k, (status, runs)) in reasons.iter().enumerate() {
        let y = edge.y0 + 4.0 + ROW * (k as f64 + 0.5);
        cross(c, (edge.x0 + 12.0, y), 3.4, Ink::FAIL);
        let text = format!("{status} ({})", count(runs.len() as u64));
        c.text(
            &text,
            (edge.x0 + 22.0, y),
            Type::new(12.0, Anchor::Start).ink(Ink::FAIL),
        );
        let pitch = ((edge.x1 - left - 12.0) / runs.len().max(1) as f64).min(13.0);
        for (i, (run, style)) in runs.iter().enumerate() {
            let at = (left + pitch * (i as f64 + 0.5), y);
            marker(c, at, 3.6, curve_style(*style), !run.implicit);
        }
    }
}
