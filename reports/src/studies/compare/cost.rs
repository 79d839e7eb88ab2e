//! Cost of runs: processor time per run, and error over processor time. Failed runs are drawn as failures.

use super::ERROR_WIDTH;
use crate::drawing::Chart;
use crate::drawing::axis::{Axis, Frame, TICK_SIZE};
use crate::drawing::canvas::{
    Anchor, Canvas, DrawError, Ink, Stroke, Type, draw, draw_with, text_width,
};
use crate::drawing::geometry::Rect;
use crate::drawing::labels::OccupiedArea;
use crate::drawing::panel::{LEFT, RIGHT, WIDTH, extremes};
use crate::drawing::scatter::{self, Numbers};
use crate::drawing::style::{cross, curve_style, marker};
use crate::metrics::Metric;
use crate::numbers::{Prefix, quantity, short};
use crate::record::{ReferenceSeries, Run, Status};
use crate::view::{NOTHING, View, capital, resolution};

const ROW: f64 = 19.0;
const HEAD: f64 = 27.0;
const BARS_LEFT: f64 = 304.0;
/// Space for the time and the status of the longest bar.
const BARS_RIGHT: f64 = 152.0;

fn measured(run: &Run) -> bool {
    run.cost_s().is_finite() && run.cost_s() > 0.0
}

/// Draws bars of processor time, one per run, sorted within each model.
pub fn runtime(views: &[View<'_>]) -> Result<Option<Chart>, DrawError> {
    let groups = || views.iter().flat_map(|v| &v.groups);
    let runs = || views.iter().flat_map(|v| &v.results.runs);
    let times: Vec<f64> = runs()
        .filter(|r| !r.status.is_failure() && measured(r))
        .map(Run::cost_s)
        .collect();
    if runs().next().is_none() {
        return Ok(None);
    }
    let stored: Vec<(&View<'_>, &ReferenceSeries)> = (views.iter())
        .flat_map(|v| v.results.references.iter().map(move |r| (v, r)))
        .filter(|(_, r)| stored_cost(r).is_some())
        .collect();
    let times: Vec<f64> = (times.into_iter())
        .chain(stored.iter().filter_map(|(_, r)| stored_cost(r)))
        .collect();
    let (least, most) = extremes(times.iter().copied());
    let prefix = Prefix::of(
        if least > 0.0 && least.is_finite() {
            (least * most).sqrt()
        } else {
            1.0
        },
        1.0,
    );
    let (low, high) = (least * prefix.factor, most * prefix.factor);
    let log = times.len() > 1 && high > 30.0 * low;
    let axis = if log {
        let mut axis = Axis::logarithmic(low, high);
        axis.min = 10f64.powf((low.log10() - 0.05).floor());
        axis
    } else {
        Axis::from_zero(high)
    };
    let rows = runs().count() as f64;
    let heads = groups().count() as f64;
    let mut body = rows * ROW + heads * HEAD;
    if !stored.is_empty() {
        body += HEAD + stored.len() as f64 * ROW;
    }
    let area = Rect::new(BARS_LEFT, 6.0, WIDTH - BARS_RIGHT, 6.0 + body + 6.0);
    let title = "Processor time per run";
    let svg = draw(WIDTH, area.y1 + 46.0, title, |c| {
        let frame = Frame {
            area,
            x: axis,
            y: Axis::linear(0.0, 1.0),
        };
        frame.paint_x(c, &format!("processor time [{}s]", prefix.symbol), 7);
        let edge = [(area.x0, area.y0), (area.x0, area.y1)];
        c.line(&edge, Stroke::new(Ink::PALE, 1.0));
        let mut y = area.y0 + 3.0;
        for group in groups() {
            let middle = y + 0.6 * HEAD;
            marker(c, (9.0, middle), 5.2, curve_style(group.style), true);
            let bold = Type::new(13.5, Anchor::Start).bold();
            c.text(&group.label, (20.0, middle), bold);
            y += HEAD;
            let mut runs: Vec<&Run> = group.runs.iter().map(|(_, r)| *r).collect();
            runs.sort_by(|a, b| {
                (a.status.is_failure().cmp(&b.status.is_failure()))
                    .then(a.cost_s().total_cmp(&b.cost_s()))
            });
            for run in runs {
                bar(c, &frame, run, group.style, y, prefix);
                y += ROW;
            }
        }
        if !stored.is_empty() {
            let bold = Type::new(13.5, Anchor::Start).bold();
            c.text("Stored references", (20.0, y + 0.6 * HEAD), bold);
            y += HEAD;
        }
        for (view, reference) in &stored {
            stored_bar(c, &frame, view, reference, y, prefix);
            y += ROW;
        }
    })?;
    let other = match stored.is_empty() {
        false => {
            " Grey bars of stored references are the processor time of another program, on the machine where they were computed."
        }
        true => "",
    };
    let scale = if log { " (logarithmic axis)" } else { "" };
    Ok(Some(Chart {
        file: "runtime.svg".into(),
        title: title.into(),
        caption: format!(
            "Median processor time of the repeats{scale}, fixed costs not included. Bars of implicit methods are lighter, outlined bars are beyond the scene's tolerance. \
             Hatched rows failed: the time at which a run failed is not a cost, so no bar is drawn.{other}"
        ),
        svg,
    }))
}

/// Returns the processor time of another program for a stored reference [s], where it is known.
fn stored_cost(reference: &ReferenceSeries) -> Option<f64> {
    let by_program = reference.command.is_some();
    reference
        .cpu_s
        .filter(|t| by_program && t.is_finite() && *t > 0.0)
}

/// Draws the bar of a stored reference, which another program computed on a machine of its own.
fn stored_bar(
    c: &mut Canvas,
    frame: &Frame,
    view: &View<'_>,
    reference: &ReferenceSeries,
    y: f64,
    prefix: Prefix,
) {
    let Some(seconds) = stored_cost(reference) else {
        return;
    };
    let middle = y + 0.5 * ROW;
    let name = view.with_scene(&view.reference_name(&reference.id));
    let fits =
        |n: usize| text_width(&name.chars().take(n).collect::<String>(), 12.5) < BARS_LEFT - 40.0;
    let kept = (0..=name.chars().count())
        .rev()
        .find(|n| fits(*n))
        .unwrap_or(0);
    let mut label: String = name.chars().take(kept).collect();
    if kept < name.chars().count() {
        label.push('\u{2026}');
    }
    c.text(&label, (20.0, middle), Type::new(12.5, Anchor::Start));
    let full = frame.area;
    let (end, _) = frame.at(seconds * prefix.factor, 0.0);
    let rect = Rect::new(full.x0, y + 3.0, end.max(full.x0 + 1.0), y + ROW - 3.0);
    c.fill(&rect, Ink::PALE);
    c.frame(&rect, Stroke::new(Ink::DARK, 1.0));
    let text = format!("{}, other program", quantity(seconds, "s", 3));
    let kind = Type::new(12.5, Anchor::Start);
    c.text(&text, (rect.x1 + 7.0, middle), kind);
}

fn bar(c: &mut Canvas, frame: &Frame, run: &Run, style: usize, y: f64, prefix: Prefix) {
    let middle = y + 0.5 * ROW;
    let label = Type::new(12.5, Anchor::Start);
    c.text(&run.integrator, (20.0, middle), label);
    let at = BARS_LEFT - 9.0;
    c.text(
        &resolution(run),
        (at, middle),
        Type::new(12.0, Anchor::End).ink(Ink::GREY),
    );
    let full = Rect::new(frame.area.x0, y + 3.0, frame.area.x1, y + ROW - 3.0);
    if run.status.is_failure() || !measured(run) {
        let text = if run.status.is_failure() {
            run.status.as_str()
        } else {
            "no time recorded"
        };
        c.hatch(&full, 7.0, Stroke::new(Ink::PALE, 1.0));
        c.frame(&full, Stroke::new(Ink::PALE, 1.0));
        let width = text_width(text, 12.5) + 18.0;
        let plate = Rect::new(
            full.x0 + 10.0,
            y + 1.0,
            full.x0 + 16.0 + width,
            y + ROW - 1.0,
        );
        c.fill(&plate, Ink::WHITE);
        cross(c, (plate.x0 + 9.0, middle), 3.6, Ink::FAIL);
        let kind = Type::new(12.5, Anchor::Start).ink(Ink::FAIL);
        c.text(text, (plate.x0 + 18.0, middle), kind);
        return;
    }
    let ink = curve_style(style).ink;
    let (end, _) = frame.at(run.cost_s() * prefix.factor, 0.0);
    let rect = Rect::new(full.x0, full.y0, end.max(full.x0 + 1.0), full.y1);
    let mut text = quantity(run.cost_s(), "s", 3);
    if run.status == Status::Inaccurate {
        c.fill(&rect, ink.opacity(0.12));
        c.frame(&rect, Stroke::dashed(ink, 1.3, &[3.0, 2.0]));
        text.push_str(", inaccurate");
    } else {
        c.fill(&rect, ink.opacity(if run.implicit { 0.62 } else { 1.0 }));
        c.frame(&rect, Stroke::new(ink, 1.0));
    }
    let kind = Type::new(12.5, Anchor::Start);
    c.text(&text, (rect.x1 + 7.0, middle), kind);
}

/// A run in the chart of errors over processor time.
struct Point<'a> {
    view: &'a View<'a>,
    /// Label of its model.
    label: &'a str,
    /// Index of the look of its model.
    style: usize,
    /// Index of the run in the record.
    index: usize,
    run: &'a Run,
    error: f64,
}

impl Point<'_> {
    /// Returns model, method, error and cost as a text.
    fn text(&self) -> String {
        format!(
            "{} under {}, {}: {} in {}",
            self.label,
            self.run.integrator,
            resolution(self.run),
            self.view.error_text(self.error),
            quantity(self.run.cost_s(), "s", 3)
        )
    }
}

/// Draws the error over processor time, a point per run: a chart for each metric of the scenes, mostly one.
pub fn accuracy(views: &[View<'_>]) -> Result<Vec<Chart>, DrawError> {
    let mut metrics: Vec<Metric> = Vec::new();
    for view in views.iter().filter(|v| v.against.is_some()) {
        if !metrics.contains(&view.metric) {
            metrics.push(view.metric);
        }
    }
    let charts = metrics.into_iter().map(|metric| {
        let of_metric = |v: &&View<'_>| v.metric == metric && v.against.is_some();
        accuracy_in(metric, &views.iter().filter(of_metric).collect::<Vec<_>>())
    });
    Ok(charts
        .collect::<Result<Vec<_>, _>>()?
        .into_iter()
        .flatten()
        .collect())
}

/// Draws the error in a metric over processor time, of scenes whose errors are in it.
fn accuracy_in(metric: Metric, views: &[&View<'_>]) -> Result<Option<Chart>, DrawError> {
    let all = views
        .iter()
        .flat_map(|v| v.groups.iter().map(move |g| (*v, g)));
    let good: Vec<Point<'_>> = (all.clone())
        .flat_map(|(v, g)| g.runs.iter().map(move |(i, r)| (v, g, *i, *r)))
        .filter(|(.., r)| !r.status.is_failure() && measured(r))
        .filter_map(|(view, group, index, run)| {
            let error = view.error(run)?;
            Some(Point {
                view,
                label: &group.label,
                style: group.style,
                index,
                run,
                error,
            })
        })
        .filter(|p| p.error > NOTHING)
        .collect();
    if good.is_empty() {
        return Ok(None);
    }
    let models: Vec<(&str, usize)> = (all.clone())
        .map(|(_, g)| (g.label.as_str(), g.style))
        .collect();
    let mut failed: Vec<(usize, Ink, String)> = all
        .flat_map(|(_, g)| g.runs.iter().map(move |(i, r)| (g, *i, *r)))
        .filter(|(.., r)| r.status.is_failure())
        .map(|(g, i, r)| {
            let text = format!(
                "{} under {} {}: {}",
                g.label,
                r.integrator,
                resolution(r),
                r.status
            );
            (i, curve_style(g.style).ink, text)
        })
        .collect();
    // In the order of the record.
    failed.sort_by_key(|(i, ..)| *i);
    let failed: Vec<(Ink, String)> = failed
        .into_iter()
        .map(|(_, ink, text)| (ink, text))
        .collect();
    let relative = metric.unit().is_empty();
    let factor = if relative { 100.0 } else { 1.0 };
    let mut limits: Vec<f64> = (views.iter())
        .filter_map(|v| Some(v.limit? * factor))
        .collect();
    limits.dedup();
    let (low, high) = extremes(good.iter().map(|p| p.error * factor));
    let high = limits.iter().copied().fold(high, f64::max);
    let y = if high > 8.0 * low {
        Axis::logarithmic(low, high)
    } else {
        Axis::from_zero(high)
    };
    let (fast, slow) = extremes(good.iter().map(|p| p.run.cost_s() * 1e3));
    let x = Axis::logarithmic(fast, slow);
    let numbers = Numbers::of(good.iter().map(|p| p.run.integrator.as_str()), ERROR_WIDTH);
    let top =
        6.0 + scatter::key_height(&models, ERROR_WIDTH) + scatter::failures_height(failed.len());
    let area = Rect::new(LEFT, top, ERROR_WIDTH - RIGHT, top + 300.0);
    let mut references: Vec<String> = (views.iter())
        .filter_map(|v| Some(v.reference_name(v.against.as_ref()?)))
        .collect();
    references.dedup();
    let reference = references.join(", ");
    let title = format!("Error against {reference}, over processor time");
    let unit = if relative { "%" } else { metric.unit() };
    let below = area.y1 + 46.0;
    let svg = draw_with(
        ERROR_WIDTH,
        below + numbers.height(),
        &title,
        &scatter::panels(),
        |c| {
            scatter::key(c, &models, ERROR_WIDTH, true);
            scatter::failures(c, &failed, ERROR_WIDTH, top, "the table of failures");
            let frame = Frame { area, x, y };
            let (x_name, y_name) = ("processor time [ms]", metric.axis());
            c.group(&frame.attributes("panel", x_name, &y_name, ""), |c| {
                frame.paint(c, x_name, &y_name, true);
                let mut room = OccupiedArea::of(area);
                let points: Vec<(f64, f64)> = (good.iter())
                    .map(|p| frame.at(p.run.cost_s() * 1e3, p.error * factor))
                    .collect();
                points.iter().for_each(|p| room.occupy_point(*p, 6.0));
                let tolerance = |l: &f64| (*l, format!("tolerance {} {unit}", short(*l, 3)));
                let tolerances: Vec<(f64, String)> = limits.iter().map(tolerance).collect();
                scatter::limits(c, &frame, &tolerances, &mut room);
                let small = Type::new(TICK_SIZE, Anchor::Start);
                c.group(&scatter::notes(), |c| {
                    for (point, p) in good.iter().zip(&points) {
                        room.write(c, &numbers.text(&point.run.integrator), *p, small);
                    }
                });
                for (point, at) in good.iter().zip(&points) {
                    let of = (point.style, Some(point.index));
                    let look = curve_style(point.style);
                    scatter::point(c, *at, of, &point.text(), |c| {
                        marker(c, *at, 5.2, look, !point.run.implicit);
                    });
                }
            });
            numbers.paint(c, below);
        },
    )?;
    Ok(Some(Chart {
        file: "accuracy.svg".into(),
        title,
        caption: format!(
            "{} against {} over processor time; lower left is better. Numbers name the integrators below. Points on one level \
             share the error of the model: a finer step no longer helps. Failed runs stand on their own edge, whatever \
             their time.",
            capital(metric.words()),
            reference,
        ),
        svg,
    }))
}
