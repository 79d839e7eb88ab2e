//! Chart of the contact pressure over time, for runs with half-space contact.

use super::histories::{Histories, History};
use crate::drawing::Chart;
use crate::drawing::canvas::DrawError;
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Panel, chart};
use crate::numbers::{Prefix, quantity};
use crate::view::View;

/// Column of the pressure of the first mesh, and of half the width of its contact.
const PRESSURE: [&str; 2] = ["contact_pressure_pa", "contact_half_width_m"];

/// Draws pressure and width of contact over time; `None` where no run has them.
pub fn pressure(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let Some(h) = Histories::of(view) else {
        return Ok(None);
    };
    let largest = |name: &str| {
        let all = h.curves.iter().filter_map(|c| c.series.column(name));
        all.flatten().fold(0.0_f64, |most, x| most.max(*x))
    };
    let [peak, width] = PRESSURE.map(largest);
    if peak == 0.0 {
        return Ok(None);
    }
    let (pressure, length) = (Prefix::of(peak, 1.0), Prefix::of(width, 1.0));
    let time = h.zoom.as_ref().unwrap_or(&h.time);
    let panel = |name: &str, label: &str, factor: f64| Panel {
        x_name: (name == PRESSURE[1]).then(|| time.name.clone()),
        ..Panel::new(150.0, &time.axis, label)
            .curves(h.lines(|s| s.column(name), factor, time))
            .close()
    };
    let panels = [
        panel(
            PRESSURE[0],
            &format!("peak pressure [{}Pa]", pressure.symbol),
            pressure.factor,
        ),
        panel(
            PRESSURE[1],
            &format!("half-width [{}m]", length.symbol),
            length.factor,
        ),
    ];
    let shown = |c: &&History<'_>| c.series.column(PRESSURE[0]).is_some();
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
