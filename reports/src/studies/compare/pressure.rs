//! Chart of the contact pressure over time, for runs with half-space contact.

use super::histories::{Histories, History, MemberColumn};
use crate::drawing::Chart;
use crate::drawing::canvas::DrawError;
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Panel, chart};
use crate::numbers::{Prefix, quantity};
use crate::series::{HALF_WIDTH, PRESSURE, Quantity};
use crate::view::View;

/// Draws pressure and width of contact over time, a panel for each mesh; `None` where no run has them.
pub fn pressure(views: &[View<'_>]) -> Result<Option<Chart>, DrawError> {
    let Some(h) = Histories::of(views) else {
        return Ok(None);
    };
    let has = |m: &MemberColumn| h.curves.iter().any(|c| m.of(c.series).is_some());
    let of = |quantity: Quantity| -> Vec<MemberColumn> {
        h.meshes_with(quantity).into_iter().filter(has).collect()
    };
    let pressures = of(PRESSURE);
    let (_, peak) = h.extremes(&pressures);
    if peak == 0.0 {
        return Ok(None);
    }
    let time = h.zoom.as_ref().unwrap_or(&h.time);
    let mut panels = Vec::new();
    let widths = of(HALF_WIDTH);
    for (meshes, words, unit) in [
        (&pressures, "peak pressure", "Pa"),
        (&widths, "half-width", "m"),
    ] {
        let prefix = Prefix::of(h.extremes(meshes).1, 1.0);
        let label = format!("{words} [{}{unit}]", prefix.symbol);
        panels.extend(meshes.iter().map(|m| {
            Panel::new(150.0, &time.axis, &label)
                .remark(m.name.as_str())
                .curves(h.lines(|s| m.of(s), prefix.factor, time))
                .close()
        }));
    }
    if let Some(last) = panels.last_mut() {
        last.x_name = Some(time.name.clone());
    }
    let shown = |c: &&History<'_>| pressures.iter().any(|m| m.of(c.series).is_some());
    let legend: Vec<Entry> = (h.curves.iter().filter(shown))
        .map(|c| Entry::history(&c.label, c.stroke, c.style))
        .collect();
    let caption = format!(
        "Hertz's pressure in the middle of the most pressed line between two flanks, and half the width of that line, of \
         runs whose contact acts on half-spaces. The largest pressure is {}.",
        quantity(peak, "Pa", 3)
    );
    let title = "Contact pressure over time";
    chart("pressure.svg", title, caption, &legend, &panels).map(Some)
}
