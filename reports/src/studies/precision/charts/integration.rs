//! What integrators lose: one small diagram per model, against its own converged solution.

use super::marks::{Marks, legend, legend_height};
use super::{SMALL, Scale, faint, staircase};
use crate::drawing::Chart;
use crate::drawing::axis::{NAME_SIZE, TICK_SIZE};
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw};
use crate::drawing::geometry::Rect;
use crate::drawing::panel::{LEFT, RIGHT, WIDTH};
use crate::drawing::style::{look, marker};
use crate::metrics::Metric;
use crate::record::SELF;
use crate::studies::precision::pareto::{Point, front};
use crate::studies::precision::{Cost, Precision, Shown};
use crate::view::{capital, metric_against};

/// Work-precision diagrams, one per model: what its integrators lose.
pub(super) fn integration(
    study: &Precision<'_>,
    marks: &Marks,
    metric: Metric,
) -> Result<Option<Chart>, DrawError> {
    let metric = metric_against(study.results, SELF, metric);
    let cloud = study.cloud(SELF, metric, Cost::Wall);
    let mut panels: Vec<(usize, Option<usize>, Vec<&Shown<'_>>)> = Vec::new();
    for style in 0..study.models.len() {
        let of: Vec<&Shown<'_>> = cloud.shown.iter().filter(|s| s.style == style).collect();
        let modes = busiest(&of);
        let kept: Vec<&Shown<'_>> = of.into_iter().filter(|s| s.run.modes == modes).collect();
        if kept.len() > 1 {
            panels.push((style, modes, kept));
        }
    }
    let points = panels.iter().flat_map(|p| p.2.iter().map(|s| s.point));
    let Some(whole) = Scale::of(points.collect::<Vec<_>>().into_iter(), Cost::Wall) else {
        return Ok(None);
    };
    let gap = 62.0;
    let width = 0.5 * (WIDTH - LEFT - RIGHT - gap);
    let rows = panels.len().div_ceil(2);
    let models: Vec<(usize, String)> = panels
        .iter()
        .map(|p| (p.0, study.models[p.0].clone()))
        .collect();
    let top = 8.0 + legend_height(&models, marks);
    let title = "Integration error against wall time";
    let pitch = SMALL + 34.0;
    let svg = draw(WIDTH, top + pitch * rows as f64 + 26.0, title, |c| {
        legend(c, &models, marks);
        for (k, (style, modes, shown)) in panels.iter().enumerate() {
            let x0 = LEFT + (k % 2) as f64 * (width + gap);
            let y0 = top + pitch * (k / 2) as f64;
            let area = Rect::new(x0, y0, x0 + width, y0 + SMALL);
            let Some(own) = Scale::of(shown.iter().map(|s| s.point), Cost::Wall) else {
                continue;
            };
            let scale = Scale {
                // One range of errors for all: models can be told apart by cost alone.
                y: whole.y.clone(),
                ..own
            };
            let last = k + 2 >= panels.len();
            panel(c, marks, &scale, (area, last), *style, shown);
            let label = match modes {
                Some(n) => format!("{}, {n} modes", study.models[*style]),
                None => study.models[*style].clone(),
            };
            let failed = (cloud.failed.iter())
                .filter(|(r, s)| s == style && r.modes == *modes)
                .count();
            let failed = if failed > 0 {
                format!("{failed} failed")
            } else {
                String::new()
            };
            let bold = Type::new(NAME_SIZE, Anchor::End).bold();
            c.text(&label, (area.x1 - 8.0, area.y0 + 14.0), bold);
            let kind = Type::new(TICK_SIZE, Anchor::End).ink(Ink::FAIL);
            c.text(&failed, (area.x1 - 8.0, area.y0 + 31.0), kind);
        }
        let middle = top + 0.5 * pitch * rows as f64;
        let name = metric.axis();
        c.text(
            &name,
            (14.0, middle),
            Type::new(NAME_SIZE, Anchor::Middle).upwards(),
        );
    })?;
    Ok(Some(Chart {
        file: "precision_integration.svg".into(),
        title,
        caption: format!(
            "{} against each model's own converged solution: what the integrator loses, whatever the model is worth. One \
             panel per model, of an elastic model with the number of modes that most integrators run; thin lines join the \
             steps or tolerances of an integrator, the staircase is the front of the panel.",
            capital(metric.words())
        ),
        svg,
    }))
}

/// The number of modes that most integrators run, of several the largest.
fn busiest(shown: &[&Shown<'_>]) -> Option<usize> {
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
    c: &mut Canvas<'_>,
    marks: &Marks,
    scale: &Scale,
    (area, last): (Rect, bool),
    style: usize,
    shown: &[&Shown<'_>],
) {
    let frame = scale.frame(area);
    frame.paint(c, if last { scale.x_name } else { "" }, "", true);
    let mut seen: Vec<&str> = Vec::new();
    for s in shown {
        let id = s.run.integrator.as_str();
        if seen.contains(&id) {
            continue;
        }
        seen.push(id);
        for steps in [true, false] {
            let curve: Vec<(f64, f64)> = (shown.iter())
                .filter(|o| o.run.integrator == id && o.run.step.is_some() == steps)
                .map(|o| scale.at(&frame, o.point))
                .collect();
            c.line_within(
                &curve,
                &area,
                Stroke::new(look(style).ink.opacity(0.35), 1.0),
            );
        }
    }
    let points: Vec<Point> = shown.iter().map(|s| s.point).collect();
    let best = front(&points);
    for (i, s) in shown.iter().enumerate() {
        let (own, filled) = marks.look(s.style, s.run);
        let kept = if best.contains(&i) { own } else { faint(own) };
        let radius = if best.contains(&i) { 4.4 } else { 3.2 };
        marker(c, scale.at(&frame, s.point), radius, kept, filled);
    }
    let stairs: Vec<Point> = best.iter().map(|&i| points[i]).collect();
    staircase(c, &frame, scale, &stairs, Stroke::new(Ink::DARK, 1.2));
}
