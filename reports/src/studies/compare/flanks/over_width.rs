//! Chart of the normal force per face width at the peak.

use super::{PeakLoads, axes, teeth};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::DrawError;
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart};
use crate::drawing::style::{curve_style, model_stroke};
use crate::numbers::Prefix;
use crate::record::FlankPatch;

/// Most parts of the width that forces are summed over.
const PARTS: f64 = 40.0;

/// Computes the force per width over equal parts of the loaded width, each about as wide as the patches: middles [mm],
/// values [N/m]. Patches of different meshes differ in width, and one at the start of contact may be very narrow.
fn per_width(patches: &[&FlankPatch]) -> Vec<(f64, f64)> {
    let ends = |p: &FlankPatch| [-0.5, 0.5].map(|half| p.height_m + half * p.size_m[1]);
    let mut widths: Vec<f64> = patches.iter().map(|p| p.size_m[1]).collect();
    widths.sort_by(f64::total_cmp);
    let usual = widths.get(widths.len() / 2).copied().unwrap_or(0.0);
    let low = patches
        .iter()
        .map(|p| ends(p)[0])
        .fold(f64::INFINITY, f64::min);
    let high = patches
        .iter()
        .map(|p| ends(p)[1])
        .fold(f64::NEG_INFINITY, f64::max);
    if !(usual > 0.0 && high > low) {
        return Vec::new();
    }
    let count = ((high - low) / usual).round().clamp(1.0, PARTS);
    let part = (high - low) / count;
    let mut forces = vec![0.0; count as usize];
    for p in patches {
        let [from, to] = ends(p);
        for (i, force) in forces.iter_mut().enumerate() {
            let [start, end] = [low + i as f64 * part, low + (i + 1) as f64 * part];
            let share = if to > from {
                (to.min(end) - from.max(start)).max(0.0) / (to - from)
            } else {
                f64::from(u8::from((start..end).contains(&from)))
            };
            *force += share * p.force_n;
        }
    }
    let middle = |i: usize| 1e3 * (low + (i as f64 + 0.5) * part);
    (forces.iter().enumerate())
        .map(|(i, f)| (middle(i), f / part))
        .collect()
}

/// Draws the force per width at the peak, for each tooth.
pub(super) fn over_width(all: &[PeakLoads<'_>]) -> Result<Option<Chart>, DrawError> {
    let mut curves = Vec::new();
    let mut greatest = 0.0_f64;
    for b in all {
        for tooth in teeth(b.load) {
            let of = b.load.patches.iter().filter(|p| p.tooth == tooth);
            let points = per_width(&of.collect::<Vec<_>>());
            greatest = points.iter().map(|p| p.1).fold(greatest, f64::max);
            curves.push((b, tooth, points));
        }
    }
    let several = curves.iter().any(|(_, _, points)| points.len() > 1);
    if !several || greatest <= 0.0 {
        return Ok(None);
    }
    let prefix = Prefix::of(greatest, 1.0);
    let [x, _] = axes(all[0].load);
    let title = "Load over the width at peak force";
    let mut panel = Panel {
        x_name: Some("place over the width [mm]".into()),
        y: Some(Axis::from_zero(greatest * prefix.factor)),
        ..Panel::new(
            220.0,
            &x,
            &format!("force per width [{}N/m]", prefix.symbol),
        )
    };
    panel.marks = (curves.iter())
        .filter_map(|(_, tooth, points)| {
            let most = points.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
            Some(((most.0, most.1 * prefix.factor), format!("tooth {tooth}")))
        })
        .collect();
    panel.curves = curves
        .into_iter()
        .map(|(b, tooth, points)| {
            let points = points
                .into_iter()
                .map(|(x, y)| (x, y * prefix.factor))
                .collect();
            Curve {
                marker: Some((curve_style(b.style), 2.6, true)),
                name: format!("tooth {tooth}"),
                ..Curve::line(model_stroke(b.style), points)
            }
        })
        .collect();
    let legend: Vec<Entry> = (all.iter())
        .map(|b| Entry::history(b.label, model_stroke(b.style), Some(b.style)))
        .collect();
    let caption = "Normal force per width of the face at the instant of the highest contact force, one curve for each tooth in \
                   contact."
        .to_owned();
    chart("load_over_width.svg", title, &caption, &legend, &[panel]).map(Some)
}
