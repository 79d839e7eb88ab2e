//! Chart of a quantity over all stored baselines.

use super::CheckRecord;
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::DrawError;
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart};
use crate::drawing::style::curve_style;

/// Most entries in one chart: those that changed most.
const MOST: usize = 8;

/// Returns the largest change of a history over its first value [-].
fn span(points: &[(u32, f64)]) -> f64 {
    let first = points.first().map_or(f64::NAN, |p| p.1);
    let changes = points.iter().map(|p| (p.1 / first - 1.0).abs());
    changes.filter(|c| c.is_finite()).fold(0.0, f64::max)
}

/// Draws the history of a check: change of a quantity since its first baseline; empty for a single baseline.
pub fn history(record: &CheckRecord) -> Result<Vec<Chart>, DrawError> {
    let mut trends: Vec<_> = (record.history.iter())
        .filter(|t| t.points.len() > 1 && t.points.iter().all(|p| p.1.is_finite()))
        .filter(|t| t.points[0].1 != 0.0)
        .collect();
    if trends.is_empty() {
        return Ok(Vec::new());
    }
    let all = trends.len();
    trends.sort_by(|a, b| span(&b.points).total_cmp(&span(&a.points)));
    trends.truncate(MOST);
    let numbers = || trends.iter().flat_map(|t| t.points.iter().map(|p| p.0));
    let (first, last) = (numbers().min().unwrap_or(1), numbers().max().unwrap_or(1));
    let x = Axis::linear(f64::from(first) - 0.3, f64::from(last) + 0.3);
    // One tick for each baseline, as far as they are distinguishable.
    let every = ((last - first) / 15 + 1) as usize;
    let ticks = (first..=last).step_by(every);
    let mut panel = Panel::new(240.0, &x, &format!("{} [%]", record.quantity));
    panel.x_ticks = ticks.map(|n| (f64::from(n), n.to_string())).collect();
    panel.x_name =
        Some("baseline, by number; the last is the present run where there is one".into());
    panel.limits = vec![(0.0, String::new())];
    panel.curves = (trends.iter().enumerate())
        .map(|(i, t)| {
            let change = |p: &(u32, f64)| (f64::from(p.0), 100.0 * (p.1 / t.points[0].1 - 1.0));
            Curve::joined(
                curve_style(i),
                1.6,
                4.2,
                t.points.iter().map(change).collect(),
            )
        })
        .collect();
    let (low, high) = panel.ordinates();
    panel.y = Some(Axis::padded(
        low.min(0.0),
        high.max(0.0).max(low + 1e-6),
        0.1,
    ));
    let legend: Vec<Entry> = (trends.iter().enumerate())
        .map(|(i, t)| Entry::marked(&t.entry, curve_style(i), true))
        .collect();
    let shown = match all > MOST {
        true => format!(" of the {MOST} entries of {all} that changed most"),
        false => String::new(),
    };
    let caption = format!(
        "Change of {}{shown} over its first stored baseline.",
        record.quantity
    );
    let title = format!("{} over stored baselines", record.quantity);
    Ok(vec![chart(
        "history.svg",
        &title,
        caption,
        &legend,
        &[panel],
    )?])
}
