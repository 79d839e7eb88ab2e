//! Reduction of histories to the size of a record.

use gearbench_reports::record::{ReferenceSeries, Run};
use gearbench_reports::series::{Column, TimeSeries};

/// Half width of the full-resolution window around the peak, relative to the duration.
const CLOSE_UP: f64 = 0.012;
/// Number of intervals of a history in the record.
const KEPT_BUCKETS: usize = 700;
/// Largest number of samples for which a record keeps other columns than contact forces and speeds as well.
const FULL_COLUMNS: usize = 5000;

/// Reduces a history for the record: extrema of each interval stay, and the surroundings of the highest peak in full
/// resolution. Of long histories columns that `kept` has stay beside contact forces and speeds.
pub fn decimate(series: &TimeSeries, kept: impl Fn(&Column) -> bool) -> TimeSeries {
    let force = series.contact_force();
    let peak = (0..force.len()).max_by(|&a, &b| force[a].total_cmp(&force[b]));
    let at = peak.map_or(0.0, |i| series.time_s[i]);
    let half = CLOSE_UP * series.time_s.last().copied().unwrap_or(0.0);
    let mut thin = series.decimated_around(KEPT_BUCKETS, [at - half, at + half]);
    if thin.len() > FULL_COLUMNS {
        thin.columns.retain(|c| TimeSeries::is_drawn(c) || kept(c));
    }
    thin
}

/// Replaces the history of a row by its reduced form, with what `references` have; the full one stays for the files of
/// histories, if the row has them. The force pieces for metrics are dropped.
pub fn decimate_run(row: &mut Run, references: &[ReferenceSeries]) {
    let Some(mut whole) = row.series.take() else {
        return;
    };
    whole.forces.clear();
    let compared = |c: &Column| {
        let mut all = references.iter().flat_map(ReferenceSeries::all_series);
        all.any(|series| series.column(&c.name).is_some())
    };
    row.series = Some(decimate(&whole, compared));
    if let Some(histories) = &mut row.histories {
        histories.series = Some(whole);
    }
}
