//! Chart of the histories of a tabulated reference without a chart of their own: transmission errors, angles, torques.

use super::histories::Histories;
use crate::csv_table::named_unit;
use crate::drawing::Chart;
use crate::drawing::canvas::DrawError;
use crate::drawing::panel::{Panel, chart};
use crate::numbers::Prefix;
use crate::series::{CONTACT_FORCE, TRANSMISSION_ERROR};
use crate::view::View;

/// Draws a panel for each such history of tabulated references, with the runs that have it.
pub fn channels(views: &[View<'_>]) -> Result<Option<Chart>, DrawError> {
    let references = views.iter().flat_map(|v| &v.results.references);
    let tables = references.filter(|r| !r.processing.is_empty());
    let mut names: Vec<&str> = Vec::new();
    for series in tables.flat_map(|r| r.all_series()) {
        for c in &series.columns {
            let has_chart = c.name.ends_with("_rad_s") || CONTACT_FORCE.subject(&c.name).is_some();
            if !has_chart && !names.contains(&c.name.as_str()) {
                names.push(&c.name);
            }
        }
    }
    let Some(h) = Histories::of(views).filter(|_| !names.is_empty()) else {
        return Ok(None);
    };
    names.sort_by_key(|n| TRANSMISSION_ERROR.subject(n).is_none());
    let time = h.zoom.as_ref().unwrap_or(&h.time);
    let panels: Vec<Panel> = (names.iter().enumerate())
        .map(|(i, name)| {
            let all = h.curves.iter().flat_map(|c| c.all_series());
            let values = all.filter_map(|s| s.column(name)).flatten();
            let largest = values.fold(0.0_f64, |most, x| most.max(x.abs()));
            let prefix = Prefix::of(largest, 1.0);
            let (stem, unit) = named_unit(name);
            let label = format!("[{}{unit}]", prefix.symbol);
            Panel {
                x_name: (i + 1 == names.len()).then(|| time.name.clone()),
                ..Panel::new(130.0, &time.axis, &label)
                    .remark(h.without_only_mesh(stem).replace('_', " "))
                    .curves(h.lines(|s| s.column(name), prefix.factor, time))
                    .close()
            }
        })
        .collect();
    let title = "Further histories of the references";
    let caption = "What references have beside contact force and speeds, with the runs that have it. Errors of angles, torques and \
                   transmission errors stand in the table of metrics.";
    chart("channels.svg", title, caption, &h.legend(), &panels).map(Some)
}
