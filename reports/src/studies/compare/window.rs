//! The time interval that charts of histories show.

use crate::drawing::axis::Axis;
use crate::numbers::Prefix;
use crate::series::TimeSeries;

/// Time axis: window \[s\], prefix, name.
#[derive(PartialEq)]
pub(super) struct TimeAxis {
    pub axis: Axis,
    pub factor: f64,
    pub name: String,
}

pub(super) fn time_axis(window: (f64, f64)) -> TimeAxis {
    let prefix = Prefix::of(window.1.abs().max(window.0.abs()), 1.0);
    TimeAxis {
        axis: Axis::linear(window.0 * prefix.factor, window.1 * prefix.factor)
            .of_time(1.0 / prefix.factor),
        factor: prefix.factor,
        name: format!("time [{}s]", prefix.symbol),
    }
}

/// Returns the time interval of a chart by times and forces of all histories: all contact with a margin, or the whole
/// time.
pub(super) fn contact_window(all: &[(&[f64], &[f64])]) -> (f64, f64) {
    let mut whole = (f64::INFINITY, f64::NEG_INFINITY);
    let mut contact = whole;
    let peak = peak_of(all);
    for (times, forces) in all {
        for (&t, &f) in times.iter().zip(*forces) {
            whole = (whole.0.min(t), whole.1.max(t));
            if f > 1e-3 * peak {
                contact = (contact.0.min(t), contact.1.max(t));
            }
        }
    }
    let span = contact.1 - contact.0;
    if span > 0.0 && span < 0.75 * (whole.1 - whole.0) {
        let margin = 0.12 * span;
        (
            whole.0.max(contact.0 - margin),
            whole.1.min(contact.1 + margin),
        )
    } else {
        whole
    }
}

pub(super) fn peak_of(all: &[(&[f64], &[f64])]) -> f64 {
    (all.iter().flat_map(|(_, force)| *force)).fold(0.0_f64, |a, &f| a.max(f))
}

/// Returns a window around the highest peak when the history is too dense to read as a whole: five contacts, or about
/// eight oscillations about the mean.
pub(super) fn busy_window(s: &TimeSeries) -> Option<(f64, f64)> {
    let f = s.contact_force();
    let n = f.len().min(s.time_s.len());
    let peak_at = (0..n).max_by(|&a, &b| f[a].total_cmp(&f[b]))?;
    let mean = f[..n].iter().sum::<f64>() / n as f64;
    let rises: Vec<usize> = (1..n)
        .filter(|&i| f[i - 1] <= mean && f[i] > mean)
        .collect();
    if rises.len() < 12 {
        return None;
    }
    let here = rises.partition_point(|&i| i <= peak_at);
    let from = rises[here.saturating_sub(3).min(rises.len() - 1)];
    let to = rises[(here + 2).min(rises.len() - 1)];
    let (a, b) = (s.time_s[from], s.time_s[to]);
    let margin = 0.08 * (b - a);
    (b > a).then_some((a - margin, b + margin))
}
