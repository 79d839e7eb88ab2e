//! Charts of amplitudes over frequency and over the orders of shafts.

use super::{KHZ, UM, legend, settled};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::DrawError;
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart, extremes};
use crate::drawing::style::curve_style;
use crate::numbers::quantity;
use crate::record::{Bearing, Steady};
use crate::studies::sweep::{SweptBranch, resonance};

/// Draws the amplitude of every harmonic at every speed over its own frequency.
pub(super) fn spectra(all: &[SweptBranch<'_>]) -> Result<Option<Chart>, DrawError> {
    let harmonics = |r: &Steady| r.mesh_frequency_hz * r.error_harmonics_m.len() as f64;
    let highest = settled(all).map(harmonics).fold(0.0, f64::max);
    let frequencies = settled(all).map(|r| r.mesh_frequency_hz);
    let (lowest, _) = extremes(frequencies.filter(|f| *f > 0.0));
    let Some(fn_hz) = resonance(all) else {
        return Ok(None);
    };
    // Far above the mesh resonance, modes of bodies and teeth respond.
    let top = highest.min(6.0 * fn_hz);
    let x = Axis::decades(0.9 * KHZ * lowest, KHZ * top);
    let bearings = settled(all).next().map_or(&[][..], |r| &r.bearings);
    let points = |s: &SweptBranch<'_>, of: &dyn Fn(&Steady) -> Vec<f64>, scale: f64| -> Curve {
        let mut points: Vec<(f64, f64)> = (s.runs.iter())
            .flat_map(|(r, _)| {
                let f = r.mesh_frequency_hz;
                of(r)
                    .into_iter()
                    .enumerate()
                    .map(move |(k, a)| (KHZ * f * (k + 1) as f64, scale * a))
            })
            .filter(|p| p.1 > 0.0 && p.0 <= x.max)
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve::points(curve_style(s.style), 1.7, true, points)
    };
    let errors = all
        .iter()
        .map(|s| points(s, &|r| r.error_harmonics_m.clone(), UM));
    let mut panels = vec![Panel::new(230.0, &x, "TE amplitude [\u{b5}m]").curves(errors)];
    for Bearing { gear, .. } in bearings {
        let of = |r: &Steady| {
            let b = r.bearings.iter().find(|b| b.gear == *gear);
            b.map_or_else(Vec::new, |b| b.harmonics_n.clone())
        };
        let panel = Panel::new(210.0, &x, "bearing force [N]")
            .remark(format!("bearing of {gear}"))
            .curves(all.iter().map(|s| points(s, &of, 1.0)));
        panels.push(panel);
    }
    for p in &mut panels {
        p.y = top_decades(p, 4.0);
        p.verticals = vec![(KHZ * fn_hz, String::new())];
    }
    panels[0].verticals[0].1 = "fn".into();
    if let Some(last) = panels.last_mut() {
        last.x_name = Some("frequency [kHz]".into());
    }
    let own = settled(all).any(|r| r.bearings.iter().any(|b| b.own_inertia));
    let handed = if own {
        "Bearing forces of elastic gears contain the inertia of their own vibration; those of the others are the contact \
         force handed on."
    } else {
        "Bearing forces are the contact force handed on: the hubs do not give way."
    };
    let caption = format!(
        "Amplitudes of all harmonics of the mesh frequency at all speeds, each at its own frequency: where the points of \
         many speeds rise together the gears resonate. {handed}"
    );
    let title = "Spectra of transmission error and bearing forces, all speeds";
    chart("sweep_spectra.svg", title, caption, &legend(all), &panels).map(Some)
}

/// Returns a logarithmic ordinate over the upper decades of a panel.
fn top_decades(panel: &Panel, decades: f64) -> Option<Axis> {
    let (low, high) = panel.ordinates();
    (high > 0.0).then(|| Axis::logarithmic(low.max(high * 10f64.powf(-decades)), high))
}

/// Draws the transmission error at the orders of the shafts at the lowest speed, which deviations from tooth to tooth
/// excite.
pub(super) fn shaft_orders(all: &[SweptBranch<'_>]) -> Result<Option<Chart>, DrawError> {
    let shown: Vec<(&SweptBranch<'_>, &Steady)> = (all.iter())
        .filter(|s| s.first)
        .filter_map(|s| Some((s, s.runs.first()?.0)))
        .filter(|(_, r)| !r.shaft_orders.is_empty())
        .collect();
    let Some((_, first)) = shown.first() else {
        return Ok(None);
    };
    let mut panels = Vec::new();
    for (k, orders) in first.shaft_orders.iter().enumerate() {
        let x = Axis::linear(0.0, (orders.error_m.len() + 1) as f64);
        let curves = shown.iter().filter_map(|(s, r)| {
            let of = r.shaft_orders.get(k)?;
            let points = of.error_m.iter().enumerate();
            let points = points
                .map(|(i, a)| ((i + 1) as f64, UM * a))
                .filter(|p| p.1 > 0.0);
            Some(Curve::points(
                curve_style(s.style),
                2.6,
                true,
                points.collect(),
            ))
        });
        let mut panel = Panel::new(200.0, &x, "TE amplitude [\u{b5}m]").curves(curves);
        panel.y = top_decades(&panel, 6.0);
        panel.verticals = (1..=2)
            .map(|n| ((n * orders.teeth) as f64, format!("{n} x mesh")))
            .filter(|v| v.0 <= x.max)
            .collect();
        panel.x_name = Some(format!(
            "order: times the turns per second of {}",
            orders.gear
        ));
        panels.push(panel);
    }
    let caption = format!(
        "At a mesh frequency of {}, over whole turns. Orders between those of the mesh are what differs from tooth to tooth; \
         without deviations they are next to nothing.",
        quantity(first.mesh_frequency_hz, "Hz", 3)
    );
    let title = "Orders of the transmission error";
    let names: Vec<Entry> = (shown.iter())
        .map(|(s, _)| Entry::marked(&s.label, curve_style(s.style), true))
        .collect();
    chart("sweep_orders.svg", title, caption, &names, &panels).map(Some)
}
