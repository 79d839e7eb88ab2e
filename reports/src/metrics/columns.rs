//! Errors of angles, speeds and torques, relative to the span of the reference.
//!
//! ```text
//! error = sqrt( int (y - y_r)^2 dt / T ) / (max y_r - min y_r)
//! ```
//!
//! The integral is the trapezoidal rule at the reference's own times, and T is their range. The run is linear between
//! its samples. Where both sides have two samples at one time, the two sides of a jump, each is compared with its
//! counterpart. Angles count from the start and torques have a sign, so an offset is an error, as for speeds. A
//! constant column of the reference has no span; its error is relative to its magnitude.

use super::history::trapezoid_weights;
use crate::record::finite;
use crate::series::{SPEED, TimeSeries};

/// True if the column is an angle of a hub, or the displacement of a rack.
pub(super) fn is_angle(name: &str) -> bool {
    name.starts_with("hub_angle_") || name.starts_with("hub_displacement_")
}

/// True if the column is the speed of a gear or body.
pub(super) fn is_speed(name: &str) -> bool {
    SPEED.subject(name).is_some()
}

/// True if the column is a torque about a gear's axis or through a shaft, or a force along the slide of a rack.
pub(super) fn is_torque(name: &str) -> bool {
    let of_torques = ["contact_torque_", "mount_torque_", "shaft_torque_"];
    of_torques.iter().any(|start| name.starts_with(start))
}

/// A column of the run and of the reference at the reference's times.
struct Pair {
    weights: Vec<f64>,
    run: Vec<f64>,
    reference: Vec<f64>,
}

/// Returns the columns of a kind that both sides have; empty for a run that ends before its reference.
fn pairs(run: &TimeSeries, reference: &TimeSeries, of: impl Fn(&str) -> bool) -> Vec<Pair> {
    let n = reference.finite_len();
    let times = &reference.time_s[..n];
    let (Some(last), Some(end)) = (run.time_s.last(), times.last()) else {
        return Vec::new();
    };
    if n < 2 || *last < end * (1.0 - 1e-9) {
        return Vec::new();
    }
    let wanted = reference.columns.iter();
    let wanted = wanted.filter(|c| of(&c.name) && c.values.len() == reference.len());
    let pair = |wanted: &crate::series::Column| {
        let own = run.column(&wanted.name)?;
        (own.len() == run.len()).then(|| Pair {
            weights: trapezoid_weights(times),
            run: at_times(&run.time_s, own, times),
            reference: wanted.values[..n].to_vec(),
        })
    };
    wanted.filter_map(pair).collect()
}

/// Returns values at ascending times: linear between samples, constant outside; of two equal times at a jump the first
/// is its left side and the second its right one.
pub(crate) fn at_times(t: &[f64], y: &[f64], times: &[f64]) -> Vec<f64> {
    let value = |(k, &x): (usize, &f64)| {
        let second = k > 0 && times[k - 1] == x;
        // The first sample at or beyond x, on the right side of a jump the first beyond it.
        let next = match second {
            false => t.partition_point(|&s| s < x),
            true => t.partition_point(|&s| s <= x),
        };
        match (next, t.get(next)) {
            (0, _) => y[0],
            (_, None) => y[t.len() - 1],
            (i, Some(&s)) if s > x => {
                let u = (x - t[i - 1]) / (s - t[i - 1]);
                y[i - 1] + u * (y[i] - y[i - 1])
            }
            (i, _) => y[i],
        }
    };
    times.iter().enumerate().map(value).collect()
}

/// Computes the largest error over the columns of a kind (see the head of the module).
pub(super) fn worst(
    run: &TimeSeries,
    reference: &TimeSeries,
    of: impl Fn(&str) -> bool,
) -> Option<f64> {
    let error = |p: &Pair| {
        let least = p.reference.iter().copied().fold(f64::INFINITY, f64::min);
        let most = p
            .reference
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        let length: f64 = p.weights.iter().sum();
        finite((p.missed() / length).sqrt() / p.scale(most - least))
    };
    let all = pairs(run, reference, of);
    all.iter().map(error).fold(None, larger)
}

/// Computes the largest deviation of a peak magnitude over the columns of a kind, over the reference's peak.
pub(super) fn peak(
    run: &TimeSeries,
    reference: &TimeSeries,
    of: impl Fn(&str) -> bool,
) -> Option<f64> {
    let highest = |values: &[f64]| values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let all = pairs(run, reference, of);
    let deviation = |p: &Pair| finite(highest(&p.run) / highest(&p.reference) - 1.0);
    all.iter().map(deviation).fold(None, larger)
}

impl Pair {
    /// Computes the integral of the squared difference.
    fn missed(&self) -> f64 {
        let both = self.run.iter().zip(&self.reference);
        let squares = both.map(|(y, r)| (y - r).powi(2));
        squares.zip(&self.weights).map(|(s, w)| s * w).sum()
    }

    /// Returns the denominator of the relative error: the span of the reference, or its largest magnitude where it is
    /// constant.
    fn scale(&self, span: f64) -> f64 {
        let magnitude = self.reference.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        match span > 1e-9 * magnitude {
            true => span,
            false => magnitude,
        }
    }
}

/// Returns the error of larger magnitude among those that are known.
fn larger(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(x), Some(y)) => Some(if y.abs() > x.abs() { y } else { x }),
        (a, b) => a.or(b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::{FinishedRun, compare};
    use crate::record::{Ledger, Metrics};
    use crate::series::Column;

    /// Makes a run of one second with an angle up to 2 rad and a torque that jumps from 0 to 3 N m at half time.
    fn run() -> TimeSeries {
        let time_s = vec![0.0, 0.25, 0.5, 0.5, 0.75, 1.0];
        let angle = time_s.iter().map(|t| 2.0 * t).collect();
        let torque = vec![0.0, 0.0, 0.0, 3.0, 3.0, 3.0];
        let columns = vec![
            Column::new("hub_angle_pinion_rad", angle),
            Column::new("contact_torque_wheel_nm", torque),
            Column::new("transmission_error_b_c_m", vec![1e-6; 6]),
            Column::new("contact_force_a_b_n", vec![0.0; 6]),
        ];
        TimeSeries::new(time_s, columns).unwrap()
    }

    fn metrics(run: &TimeSeries, reference: &TimeSeries) -> Metrics {
        let ledger = Ledger::default();
        let run = FinishedRun::reached(run, &ledger, [1.0, 1.0]).unwrap();
        compare(run, reference, "measured")
    }

    fn found(m: &Metrics) -> [Option<f64>; 4] {
        [
            m.angle_l2,
            m.torque_l2,
            m.torque_peak_rel,
            m.transmission_error_l2,
        ]
    }

    #[test]
    fn a_run_against_itself_is_zero_jumps_and_all() {
        let run = run();
        assert_eq!(found(&metrics(&run, &run)), [Some(0.0); 4]);
    }

    #[test]
    fn known_changes_have_known_errors() {
        let run = run();
        let mut reference = run.clone();
        // An offset of 0.1 rad, over the span of 2; torques of 5/6 and transmission errors of half as much.
        let factors = [1.0, 1.2, 2.0];
        for (c, factor) in reference.columns.iter_mut().zip(factors) {
            c.values.iter_mut().for_each(|x| *x *= factor);
        }
        let angle = &mut reference.columns[0].values;
        angle.iter_mut().for_each(|x| *x += 0.1);
        let wanted = [0.05, 0.6 * 0.5_f64.sqrt() / 3.6, 1.0 / 1.2 - 1.0, 0.5];
        for (x, wanted) in found(&metrics(&run, &reference)).iter().zip(wanted) {
            assert!((x.unwrap() - wanted).abs() < 1e-12, "{x:?} {wanted}");
        }
    }

    /// A metric is absent without its data: a missing column, another gear, a run that ends early, or a reference that
    /// is itself a run of the study.
    #[test]
    fn what_is_not_there_has_no_error() {
        let run = run();
        let mut reference = run.clone();
        reference.columns.truncate(1);
        let [angle, rest @ ..] = found(&metrics(&run, &reference));
        assert_eq!((angle, rest), (Some(0.0), [None; 3]));
        reference.columns[0].name = "hub_angle_wheel_rad".into();
        assert_eq!(found(&metrics(&run, &reference)), [None; 4]);
        let mut longer = run.clone();
        longer.time_s[5] = 2.0;
        assert_eq!(found(&metrics(&run, &longer))[..3], [None; 3]);
        let mut of_the_study = run.clone();
        of_the_study.forces = vec![crate::force::ForceHistory::default()];
        let [angle, torque, peak, _] = found(&metrics(&run, &of_the_study));
        assert_eq!([angle, torque, peak], [None; 3]);
    }

    /// The reference's times alone count, and between samples the run is a line.
    #[test]
    fn runs_are_joined_by_lines() {
        let t = [0.0, 1.0, 1.0, 2.0];
        let y = [0.0, 1.0, 5.0, 6.0];
        let found = at_times(&t, &y, &[0.5, 1.0, 1.0, 1.5, 3.0]);
        assert_eq!(found, [0.5, 1.0, 5.0, 5.5, 6.0]);
    }
}
