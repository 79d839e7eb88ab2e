//! Error of the integration over cost: one small diagram per model, against its own converged solution.

use super::{ABOVE, SMALL, Scale, point_text, staircase, translucent};
use crate::drawing::Chart;
use crate::drawing::axis::{Frame, NAME_SIZE, TICK_SIZE};
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw_with};
use crate::drawing::geometry::Rect;
use crate::drawing::labels::OccupiedArea;
use crate::drawing::panel::{LEFT, RIGHT, WIDTH};
use crate::drawing::scatter::{self, Numbers};
use crate::drawing::style::{curve_style, marker};
use crate::metrics::Metric;
use crate::record::SELF;
use crate::studies::precision::pareto::{Point, front};
use crate::studies::precision::{Cost, Precision, WorkPrecisionPoint};
use crate::view::{capital, metric_against};

/// Draws work-precision diagrams of the integrators, one per model.
pub(super) fn integration(
    study: &Precision<'_>,
    metric: Metric,
) -> Result<Option<Chart>, DrawError> {
    let metric = metric_against(study.results, SELF, metric);
    let cloud = study.cloud(SELF, metric, Cost::Processor);
    let mut panels: Vec<(usize, Option<usize>, Vec<&WorkPrecisionPoint<'_>>)> = Vec::new();
    for style in 0..study.models.len() {
        let of: Vec<&WorkPrecisionPoint<'_>> =
            cloud.shown.iter().filter(|s| s.style == style).collect();
        let modes = busiest(&of);
        let kept: Vec<&WorkPrecisionPoint<'_>> =
            of.into_iter().filter(|s| s.run.modes == modes).collect();
        if kept.len() > 1 {
            panels.push((style, modes, kept));
        }
    }
    let points = panels.iter().flat_map(|p| p.2.iter().map(|s| s.point));
    let Some(whole) = Scale::of(points.collect::<Vec<_>>().into_iter(), Cost::Processor) else {
        return Ok(None);
    };
    let gap = 62.0;
    let width = 0.5 * (WIDTH - LEFT - RIGHT - gap);
    let rows = panels.len().div_ceil(2);
    let models: Vec<(&str, usize)> = (panels.iter())
        .map(|p| (study.models[p.0].as_str(), p.0))
        .collect();
    let shown = panels.iter().flat_map(|p| &p.2);
    let numbers = Numbers::of(shown.map(|s| s.run.integrator.as_str()), WIDTH);
    let top = scatter::key_height(&models, WIDTH) + ABOVE;
    let title = "Error of integration by model, over processor time";
    let pitch = SMALL + 34.0 + ABOVE;
    let below = top + pitch * rows as f64 + 14.0;
    let name = metric.axis();
    let height = below + numbers.height();
    let svg = draw_with(WIDTH, height, title, &scatter::panels(), |c| {
        scatter::key(c, &models, WIDTH, true);
        numbers.paint(c, below);
        for (k, (style, modes, shown)) in panels.iter().enumerate() {
            let x0 = LEFT + (k % 2) as f64 * (width + gap);
            let y0 = top + pitch * (k / 2) as f64;
            let area = Rect::new(x0, y0, x0 + width, y0 + SMALL);
            let Some(own) = Scale::of(shown.iter().map(|s| s.point), Cost::Processor) else {
                continue;
            };
            let scale = Scale {
                // One range of errors for all models, which then differ in cost only.
                y: whole.y.clone(),
                ..own
            };
            let last = k + 2 >= panels.len();
            let label = match modes {
                Some(n) => format!("{}, {n} modes", study.models[*style]),
                None => study.models[*style].clone(),
            };
            let frame = scale.frame(area);
            let attributes = frame.attributes("panel", scale.x_name, &name, &label);
            c.group(&attributes, |c| {
                panel(c, study, &numbers, &scale, (&frame, last), shown);
            });
            let failed = (cloud.failed.iter())
                .filter(|(r, s)| s == style && r.modes == *modes)
                .count();
            let failed = if failed > 0 {
                format!("{failed} failed")
            } else {
                String::new()
            };
            let bold = Type::new(NAME_SIZE, Anchor::Start).bold();
            c.text(&label, (area.x0, area.y0 - 10.0), bold);
            let kind = Type::new(TICK_SIZE, Anchor::End).ink(Ink::FAIL);
            c.text(&failed, (area.x1, area.y0 - 10.0), kind);
        }
        let middle = top + 0.5 * pitch * rows as f64;
        c.text(
            &name,
            (14.0, middle),
            Type::new(NAME_SIZE, Anchor::Middle).upwards(),
        );
    })?;
    Ok(Some(Chart {
        file: "precision_integration.svg".into(),
        title: title.into(),
        caption: format!(
            "{} against each model's own converged solution: the error of integration alone, without that of the model. One \
             panel per model; an elastic model has the number of modes with which most integrators ran. Thin lines connect the \
             steps or tolerances of an integrator, whose number is at their end; the staircase is the front of the panel.",
            capital(metric.words())
        ),
        svg,
    }))
}

/// Returns the number of modes that occurs with most integrators; of several the largest.
fn busiest(shown: &[&WorkPrecisionPoint<'_>]) -> Option<usize> {
    let mut counts: Vec<(usize, Option<usize>)> = Vec::new();
    for s in shown {
        if counts.iter().any(|c| c.1 == s.run.modes) {
            continue;
        }
        let mut ids: Vec<&str> = (shown.iter())
            .filter(|o| o.run.modes == s.run.modes)
            .map(|o| o.run.integrator.as_str())
            .collect();
        ids.sort_unstable();
        ids.dedup();
        counts.push((ids.len(), s.run.modes));
    }
    counts.into_iter().max().and_then(|c| c.1)
}

fn panel(
    c: &mut Canvas,
    study: &Precision<'_>,
    numbers: &Numbers<'_>,
    scale: &Scale,
    (frame, last): (&Frame, bool),
    shown: &[&WorkPrecisionPoint<'_>],
) {
    let area = frame.area;
    frame.paint(c, if last { scale.x_name } else { "" }, "", true);
    let mut room = OccupiedArea::of(area);
    let mut ends: Vec<(&str, (f64, f64))> = Vec::new();
    for s in shown {
        let id = s.run.integrator.as_str();
        if ends.iter().any(|e| e.0 == id) {
            continue;
        }
        for steps in [true, false] {
            let curve: Vec<(f64, f64)> = (shown.iter())
                .filter(|o| o.run.integrator == id && o.run.step.is_some() == steps)
                .map(|o| scale.at(frame, o.point))
                .collect();
            let stroke = Stroke::new(curve_style(s.style).ink.opacity(0.35), 1.0);
            scatter::guide(c, &curve, &area, stroke, Some(s.style));
            room.occupy_line(&curve);
            // The cheap end lies apart: fine steps meet where the converged solution ends.
            let cheap = curve.iter().min_by(|a, b| a.0.total_cmp(&b.0));
            ends.extend(cheap.map(|at| (id, *at)));
        }
    }
    let points: Vec<Point> = shown.iter().map(|s| s.point).collect();
    let best = front(&points);
    for (i, s) in shown.iter().enumerate() {
        let own = curve_style(s.style);
        let kept = if best.contains(&i) {
            own
        } else {
            translucent(own)
        };
        let radius = if best.contains(&i) { 4.4 } else { 3.2 };
        let at = scale.at(frame, s.point);
        scatter::point(c, at, (s.style, None), &point_text(study, s), |c| {
            marker(c, at, radius, kept, !s.run.implicit);
        });
        room.occupy_point(at, radius);
    }
    let stairs: Vec<Point> = best.iter().map(|&i| points[i]).collect();
    let stroke = Stroke::new(Ink::DARK, 1.2);
    staircase(c, frame, scale, &stairs, stroke, &mut room);
    c.group(&scatter::notes(), |c| {
        for (id, at) in ends {
            let kind = Type::new(TICK_SIZE, Anchor::Start);
            room.write(c, &numbers.text(id), at, kind);
        }
    });
}
