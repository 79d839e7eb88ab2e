//! Cost of runs: processor time per run, and error over processor time. Failed runs are drawn as failures.

use crate::drawing::Chart;
use crate::drawing::axis::{Axis, Frame, TICK_SIZE};
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw, text_width};
use crate::drawing::geometry::Rect;
use crate::drawing::labels::OccupiedArea;
use crate::drawing::panel::{LEFT, RIGHT, WIDTH, extremes};
use crate::drawing::scatter::{self, Numbers};
use crate::drawing::style::{cross, curve_style, marker};
use crate::numbers::{Prefix, quantity, short};
use crate::record::{Run, Status};
use crate::view::{NOTHING, View, capital, resolution};

const ROW: f64 = 19.0;
const HEAD: f64 = 27.0;
const BARS_LEFT: f64 = 262.0;
/// Space for the time and the status of the longest bar, .
const BARS_RIGHT: f64 = 146.0;

fn measured(run: &Run) -> bool {
    run.cost_s().is_finite() && run.cost_s() > 0.0
}

/// Draws bars of processor time, one per run, sorted within each model.
pub fn runtime(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let times: Vec<f64> = (view.results.runs.iter())
        .filter(|r| !r.status.is_failure() && measured(r))
        .map(|r| r.cost_s())
        .collect();
    if view.results.runs.is_empty() {
        return Ok(None);
    }
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
    let rows = view.results.runs.len() as f64;
    let heads = view.groups.len() as f64;
    let body = rows * ROW + heads * HEAD;
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
        for group in &view.groups {
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
    })?;
    let scale = if log { " (logarithmic axis)" } else { "" };
    Ok(Some(Chart {
        file: "runtime.svg".into(),
        title: title.into(),
        caption: format!(
            "Median processor time of the repeats{scale}, fixed costs not included. Bars of implicit methods are lighter, outlined bars are beyond the scene's tolerance. \
             Hatched rows failed: the time at which a run failed is not a cost, so no bar is drawn."
        ),
        svg,
    }))
}

fn bar(c: &mut Canvas<'_>, frame: &Frame, run: &Run, style: usize, y: f64, prefix: Prefix) {
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

/// Draws the error over processor time, a point per run.
pub fn accuracy(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let Some(against) = &view.against else {
        return Ok(None);
    };
    let good: Vec<(usize, &Run, f64)> = (view.groups.iter())
        .flat_map(|g| g.runs.iter().map(move |(_, r)| (g.style, *r)))
        .filter(|(_, r)| !r.status.is_failure() && measured(r))
        .filter_map(|(s, r)| Some((s, r, view.error(r)?)))
        .filter(|p| p.2 > NOTHING)
        .collect();
    if good.is_empty() {
        return Ok(None);
    }
    let models: Vec<(&str, usize)> = (view.groups.iter())
        .map(|g| (g.label.as_str(), g.style))
        .collect();
    let failed: Vec<(Ink, String)> = (view.results.runs.iter())
        .filter(|r| r.status.is_failure())
        .map(|r| {
            let model = r.model_label();
            let style = models.iter().find(|m| m.0 == model).map_or(0, |m| m.1);
            let text = format!(
                "{model} under {} {}: {}",
                r.integrator,
                resolution(r),
                r.status
            );
            (curve_style(style).ink, text)
        })
        .collect();
    let relative = view.metric.unit().is_empty();
    let factor = if relative { 100.0 } else { 1.0 };
    let limit = (view.results.tolerance.as_ref()).map(|t| t.limit * factor);
    let (low, high) = extremes(good.iter().map(|p| p.2 * factor));
    let high = limit.map_or(high, |l| high.max(l));
    let y = if high > 8.0 * low {
        Axis::logarithmic(low, high)
    } else {
        Axis::from_zero(high)
    };
    let (fast, slow) = extremes(good.iter().map(|p| p.1.cost_s() * 1e3));
    let x = Axis::logarithmic(fast, slow);
    let numbers = Numbers::of(good.iter().map(|p| p.1.integrator.as_str()));
    let top = 6.0 + scatter::key_height(&models) + scatter::failures_height(failed.len());
    let area = Rect::new(LEFT, top, WIDTH - RIGHT, top + 330.0);
    let reference = view.reference_name(against);
    let title = format!("Error against {reference}, over processor time");
    let unit = if relative { "%" } else { view.metric.unit() };
    let below = area.y1 + 46.0;
    let svg = draw(WIDTH, below + numbers.height(), &title, |c| {
        scatter::key(c, &models, true);
        scatter::failures(c, &failed, top, "the table of failures");
        let frame = Frame { area, x, y };
        frame.paint(c, "processor time [ms]", &view.metric.axis(), true);
        let mut room = OccupiedArea::of(area);
        let tolerance = limit.map(|l| (scatter::tolerance(c, &frame, l, &mut room), l));
        let points: Vec<(f64, f64)> = (good.iter())
            .map(|(_, r, e)| frame.at(r.cost_s() * 1e3, e * factor))
            .collect();
        for p in &points {
            room.occupy_point(*p, 6.0);
        }
        let small = Type::new(TICK_SIZE, Anchor::Start);
        if let Some((y, limit)) = tolerance {
            let text = format!("tolerance {} {unit}", short(limit, 3));
            room.write_along(c, &text, y, small.ink(Ink::GREY));
        }
        for ((_, run, _), p) in good.iter().zip(&points) {
            room.write(c, &numbers.text(&run.integrator), *p, small);
        }
        for ((style, run, _), p) in good.iter().zip(&points) {
            marker(c, *p, 5.2, curve_style(*style), !run.implicit);
        }
        numbers.paint(c, below);
    })?;
    Ok(Some(Chart {
        file: "accuracy.svg".into(),
        title,
        caption: format!(
            "{} against {} over processor time; lower left is better. Numbers name the integrators below. Points on one level \
             share the error of the model: a finer step no longer helps. Failed runs stand on their own edge, whatever \
             their time.",
            capital(view.metric.words()),
            reference,
        ),
        svg,
    }))
}
