//! Each family by its own front alone.

use super::marks::{Marks, legend, legend_height};
use super::{PLOT, Scale, models_of};
use crate::drawing::Chart;
use crate::drawing::canvas::{DrawError, Stroke, draw};
use crate::drawing::geometry::Rect;
use crate::drawing::labels::point_label;
use crate::drawing::panel::{LEFT, RIGHT, WIDTH};
use crate::drawing::style::marker;
use crate::metrics::Metric;
use crate::studies::precision::{Cost, Precision, family, is_ours};
use crate::view::View;

/// Each family by its own front alone.
pub(super) fn families(
    view: &View<'_>,
    study: &Precision<'_>,
    marks: &Marks,
    against: &str,
    metric: Metric,
) -> Result<Option<Chart>, DrawError> {
    let cloud = study.cloud(against, metric, Cost::Wall);
    let Some(scale) = Scale::of(cloud.shown.iter().map(|s| s.point), Cost::Wall) else {
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
    let top = 8.0 + legend_height(&models, marks);
    let area = Rect::new(LEFT, top, WIDTH - RIGHT, top + PLOT);
    let title = "The best of each family";
    let svg = draw(WIDTH, area.y1 + 46.0, title, |c| {
        legend(c, &models, marks);
        let frame = scale.frame(area);
        frame.paint(c, scale.x_name, &metric.axis(), true);
        let mut taken: Vec<Rect> = Vec::new();
        let mut ends: Vec<(String, (f64, f64))> = Vec::new();
        for name in &names {
            let best = cloud.news(&cloud.front(|s| family(s.run) == *name));
            let path: Vec<(f64, f64)> = (best.iter())
                .map(|&i| scale.at(&frame, cloud.shown[i].point))
                .collect();
            let Some(&first) = best.first() else { continue };
            let s = &cloud.shown[first];
            let (own, filled) = marks.look(s.style, s.run);
            let width = if is_ours(s.run) { 2.4 } else { 1.1 };
            c.line(&path, Stroke::dashed(own.ink, width, own.dash));
            for at in &path {
                marker(c, *at, 4.0, own, filled);
                taken.push(Rect::around(*at, 4.5));
            }
            if let Some(&i) = best.last() {
                let s = &cloud.shown[i];
                ends.push((s.run.integrator.clone(), scale.at(&frame, s.point)));
            }
        }
        for (text, at) in &ends {
            point_label(c, text, *at, &area, &mut taken, true);
        }
    })?;
    Ok(Some(Chart {
        file: "precision_families.svg".into(),
        title,
        caption: format!(
            "The runs of each family (a model under an integrator) that no other run of the same family beats, against {}, \
             as far as each errs less than the last by more than a twentieth: where a line ends, finer steps buy nothing more \
             from the model. Names stand at that end where there is room.",
            view.reference_name(against)
        ),
        svg,
    }))
}
