//! Chart of error over cost with the Pareto front of each family.

use super::{PLOT, Scale, models_of, point_text};
use crate::drawing::Chart;
use crate::drawing::axis::TICK_SIZE;
use crate::drawing::canvas::{Anchor, DrawError, Stroke, Type, draw_with};
use crate::drawing::geometry::Rect;
use crate::drawing::labels::OccupiedArea;
use crate::drawing::panel::{LEFT, RIGHT, WIDTH};
use crate::drawing::scatter::{self, Numbers};
use crate::drawing::style::{curve_style, marker};
use crate::metrics::Metric;
use crate::studies::precision::{Cost, Precision, family, is_reduced_exactly};
use crate::view::View;

/// Draws the chart with the Pareto front of each family.
pub(super) fn families(
    view: &View<'_>,
    study: &Precision<'_>,
    against: &str,
    metric: Metric,
) -> Result<Option<Chart>, DrawError> {
    let cloud = study.cloud(against, metric, Cost::Processor);
    let Some(scale) = Scale::of(cloud.shown.iter().map(|s| s.point), Cost::Processor) else {
        return Ok(None);
    };
    let mut names: Vec<String> = Vec::new();
    for s in &cloud.shown {
        let name = family(s.run);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let models = models_of(study, &cloud);
    let models: Vec<(&str, usize)> = models.iter().map(|(s, m)| (m.as_str(), *s)).collect();
    let numbers = Numbers::of(cloud.shown.iter().map(|s| s.run.integrator.as_str()), WIDTH);
    let top = scatter::key_height(&models, WIDTH);
    let area = Rect::new(LEFT, top, WIDTH - RIGHT, top + PLOT);
    let reference = view.reference_name(against);
    let title = format!("The best of each model and integrator against {against}");
    let below = area.y1 + 46.0;
    let height = below + numbers.height();
    let svg = draw_with(WIDTH, height, &title, &scatter::panels(), |c| {
        scatter::key(c, &models, WIDTH, true);
        let frame = scale.frame(area);
        let y_name = metric.axis();
        c.group(&frame.attributes("panel", scale.x_name, &y_name, ""), |c| {
            frame.paint(c, scale.x_name, &y_name, true);
            let mut room = OccupiedArea::of(area);
            let mut ends: Vec<(String, (f64, f64))> = Vec::new();
            for name in &names {
                let best = cloud.improvements(&cloud.front(|s| family(s.run) == *name));
                let path: Vec<(f64, f64)> = (best.iter())
                    .map(|&i| scale.at(&frame, cloud.shown[i].point))
                    .collect();
                let Some(&last) = best.last() else { continue };
                let s = &cloud.shown[last];
                let own = curve_style(s.style);
                let width = if is_reduced_exactly(s.run) { 2.4 } else { 1.1 };
                let stroke = Stroke::new(own.ink.opacity(0.6), width);
                scatter::guide(c, &path, &area, stroke, Some(s.style));
                room.occupy_line(&path);
                for (&i, at) in best.iter().zip(&path) {
                    let text = point_text(study, &cloud.shown[i]);
                    scatter::point(c, *at, (s.style, None), &text, |c| {
                        marker(c, *at, 4.0, own, !s.run.implicit);
                    });
                    room.occupy_point(*at, 4.5);
                }
                ends.push((numbers.text(&s.run.integrator), scale.at(&frame, s.point)));
            }
            c.group(&scatter::notes(), |c| {
                for (text, at) in &ends {
                    room.write(c, text, *at, Type::new(TICK_SIZE, Anchor::Start));
                }
            });
        });
        numbers.paint(c, below);
    })?;
    Ok(Some(Chart {
        file: "precision_families.svg".into(),
        title,
        caption: format!(
            "The runs of each model under each integrator that no other run of the two beats, against {reference}, as far as \
             each errs less than the last by more than a twentieth: where a line ends, finer steps buy nothing more from the \
             model. The number of the integrator is at that end."
        ),
        svg,
    }))
}
