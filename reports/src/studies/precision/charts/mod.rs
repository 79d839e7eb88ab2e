//! Error against cost: every run a point, the Pareto front a staircase, failures on an edge of their own.

mod families;
mod integration;
mod marks;

use crate::drawing::Chart;
use crate::drawing::axis::{Axis, Frame};
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw};
use crate::drawing::geometry::Rect;
use crate::drawing::labels::point_label;
use crate::drawing::panel::{LEFT, RIGHT, WIDTH, extremes};
use crate::drawing::style::{Look, cross, marker};
use crate::metrics::Metric;

use crate::numbers::count;
use crate::record::{Run, SELF, Status};
use crate::studies::precision::pareto::Point;
use crate::studies::precision::{
    Cloud, Cost, LEVELS, Precision, Shown, Standing, id_of, is_ours, modes_and_step,
};
use crate::view::{View, capital, metric_against};
use families::families;
use integration::integration;
use marks::{Marks, legend, legend_height};

/// Opacity of what something else beats.
const FAINT: f64 = 0.3;
/// Height of a plot and of a small one.
const PLOT: f64 = 400.0;
const SMALL: f64 = 225.0;
const ROW: f64 = 19.0;

/// The charts of accuracy against cost.
pub fn precision(view: &View<'_>) -> Result<Vec<Chart>, DrawError> {
    let study = Precision::of(view.results);
    let marks = Marks::of(view.results);
    let metric = study.headline();
    let mut charts = Vec::new();
    let one = |against: &str, metric, cost, file: String| {
        scatter(view, &study, &marks, (against, metric, cost), file)
    };
    for (i, id) in study.references.iter().enumerate() {
        charts.extend(one(id, metric, Cost::Wall, numbered("model", i))?);
    }
    charts.extend(integration(&study, &marks, metric)?);
    let work = "precision_work.svg".to_owned();
    if let Some(first) = study.references.first() {
        charts.extend(families(view, &study, &marks, first, metric)?);
        charts.extend(one(first, metric, Cost::Evaluations, work)?);
        for (i, further) in study.metrics.iter().enumerate().skip(1) {
            charts.extend(one(first, *further, Cost::Wall, numbered("metric", i))?);
        }
    } else {
        charts.extend(one(SELF, metric, Cost::Evaluations, work)?);
    }
    Ok(charts)
}

/// File name of a chart that there may be several of.
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
            Cost::Wall => (1e3, "wall time [ms]"),
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

fn faint(look: Look) -> Look {
    Look {
        ink: look.ink.opacity(FAINT),
        ..look
    }
}

/// The staircase under a front: everything above and to the right of it is beaten.
fn staircase(c: &mut Canvas<'_>, frame: &Frame, scale: &Scale, points: &[Point], stroke: Stroke) {
    let mut path: Vec<(f64, f64)> = Vec::with_capacity(2 * points.len() + 2);
    for p in points {
        let at = scale.at(frame, *p);
        let from = path.last().map_or(frame.area.y0, |l| l.1);
        path.extend([(at.0, from), at]);
    }
    if let Some(last) = path.last().copied() {
        path.push((frame.area.x1, last.1));
        c.line_within(&path, &frame.area, stroke);
    }
}

/// All runs against one reference.
fn scatter(
    view: &View<'_>,
    study: &Precision<'_>,
    marks: &Marks,
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
    let notes = match cost {
        Cost::Wall => notes(&cloud),
        Cost::Evaluations => Vec::new(),
    };
    let models = models_of(study, &cloud);
    let top = 8.0 + legend_height(&models, marks);
    let strip = strip_height(&reasons);
    let area = Rect::new(LEFT, top + strip, WIDTH - RIGHT, top + strip + PLOT);
    let notes_height = 17.0 * notes.len() as f64 + if notes.is_empty() { 0.0 } else { 10.0 };
    let title = match (against, cost) {
        (SELF, _) => "Integration error against work",
        (_, Cost::Wall) => "Model error against wall time",
        (_, Cost::Evaluations) => "Model error against work",
    };
    let svg = draw(WIDTH, area.y1 + 46.0 + notes_height, title, |c| {
        legend(c, &models, marks);
        failures(
            c,
            marks,
            &reasons,
            &Rect::new(LEFT, top, WIDTH - RIGHT, top + strip - 8.0),
        );
        let frame = scale.frame(area);
        frame.paint(c, scale.x_name, &metric.axis(), true);
        let on = |i: &usize| all.contains(i) || fair.contains(i);
        for i in (0..cloud.shown.len()).filter(|i| !on(i)) {
            let s = &cloud.shown[i];
            let (look, filled) = marks.look(s.style, s.run);
            marker(c, scale.at(&frame, s.point), 3.4, faint(look), filled);
        }
        let stairs = |of: &[usize]| of.iter().map(|&i| cloud.shown[i].point).collect::<Vec<_>>();
        if fitted {
            let stroke = Stroke::dashed(Ink::GREY, 1.3, &[3.0, 3.0]);
            staircase(c, &frame, &scale, &stairs(&all), stroke);
        }
        staircase(
            c,
            &frame,
            &scale,
            &stairs(&fair),
            Stroke::new(Ink::DARK, 1.5),
        );
        let shown: Vec<usize> = (0..cloud.shown.len()).filter(on).collect();
        let mut taken: Vec<Rect> = Vec::new();
        for &i in &shown {
            let s = &cloud.shown[i];
            let at = scale.at(&frame, s.point);
            taken.push(Rect::around(at, 6.0));
            let (look, filled) = marks.look(s.style, s.run);
            marker(c, at, 5.4, look, filled);
        }
        let mut named = cloud.news(&fair);
        named.extend(cloud.news(&all));
        named.sort_unstable();
        named.dedup();
        for &i in &named {
            let s = &cloud.shown[i];
            point_label(
                c,
                &words(s),
                scale.at(&frame, s.point),
                &area,
                &mut taken,
                true,
            );
        }
        let mut y = area.y1 + 58.0;
        for (cells, strong) in &notes {
            for (text, x) in cells.iter().zip(NOTES) {
                let kind = Type::new(11.5, Anchor::Start);
                c.text(text, (x, y), if *strong { kind.bold() } else { kind });
            }
            y += 17.0;
        }
    })?;
    let reference = view.reference_name(against);
    Ok(Some(Chart {
        file,
        title,
        caption: caption(&reference, metric, cost, fitted, against == SELF),
        svg,
    }))
}

fn caption(reference: &str, metric: Metric, cost: Cost, fitted: bool, own: bool) -> String {
    let what = match cost {
        Cost::Wall => "wall time, median of the repeats without setup",
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

/// What a point of the front is called beside its colour.
fn words(s: &Shown<'_>) -> String {
    if is_ours(s.run) {
        return modes_and_step(s.run);
    }
    format!("{} {}", id_of(&s.run.integrator), modes_and_step(s.run))
}

/// Models of a cloud: place, label, fitted or not.
fn models_of(study: &Precision<'_>, cloud: &Cloud<'_>) -> Vec<(usize, String)> {
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

/// Left edges of the columns of the notes.
const NOTES: [f64; 4] = [LEFT - 60.0, LEFT - 14.0, LEFT + 234.0, LEFT + 508.0];

/// Who leads at which error, in columns under the plot; headings are strong.
fn notes(cloud: &Cloud<'_>) -> Vec<([String; 4], bool)> {
    let line = |s: &Standing<'_, '_>| {
        let cells = [s.level(), s.own(), s.beside_next(), s.beside_other()];
        (cells, false)
    };
    let of = |fitted_too: bool| {
        LEVELS
            .iter()
            .filter_map(move |l| cloud.standing(*l, fitted_too))
    };
    let fair: Vec<_> = of(false).map(|s| line(&s)).collect();
    if fair.is_empty() {
        return Vec::new();
    }
    let head = |what: &str| {
        let texts = [
            "within",
            what,
            "beside the next family",
            "beside the next other model",
        ];
        (texts.map(String::from), true)
    };
    let mut all = vec![head(if cloud.has_fitted() {
        "cheapest of residual compliance, nothing fitted"
    } else {
        "cheapest of residual compliance"
    })];
    all.extend(fair);
    // Only what a fit changes is told again.
    let fits: Vec<_> = of(true)
        .filter(|s| s.next.is_some_and(|(rival, _)| rival.is_fitted()))
        .map(|s| line(&s))
        .collect();
    if !fits.is_empty() {
        all.push(head("models fitted to this history included"));
        all.extend(fits);
    }
    all
}

fn strip_height(reasons: &[(Status, Vec<(&Run, usize)>)]) -> f64 {
    if reasons.is_empty() {
        0.0
    } else {
        16.0 + ROW * reasons.len() as f64
    }
}

/// Failed runs, one row per reason.
fn failures(
    c: &mut Canvas<'_>,
    marks: &Marks,
    reasons: &[(Status, Vec<(&Run, usize)>)],
    edge: &Rect,
) {
    if reasons.is_empty() {
        return;
    }
    c.edge_of_failures(edge);
    let left = edge.x0 + 128.0;
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
            let (look, filled) = marks.look(*style, run);
            marker(c, (left + pitch * (i as f64 + 0.5), y), 3.6, look, filled);
        }
    }
}
