//! Engineering outputs of a run against a reference.
//!
//! With the run's contact force f(t), the reference f_r(t) and integrals by the trapezoidal rule on
//! the reference's own time grid,
//!
//! ```text
//! force_l2         = sqrt( int (f(t) - f_r(t))^2 dt / int f_r(t)^2 dt )
//! force_l2_aligned = min over tau of the same with f(t - tau);  time_shift_s = tau
//! impulse          = int f dt                    (on the run's own grid, while the reference lasts)
//! duration         = time in which f exceeds 1e-6 of its own peak
//! rebound          = max over gears of (last speed - last speed of the reference) / span of the reference's speed
//! transmission_error_l2 = sqrt( int (e - e_r)^2 dt / int e_r^2 dt ) over the times at which f_r acts
//! ```
//!
//! with the transmission error e as the column [`TRANSMISSION_ERROR`], zero at first touch of rigid flanks.
//!
//! After an impact most of a pointwise error is phase error: the aligned value says how well the
//! shape of the force is met, the shift says how much the phase was off. Outside its samples a run
//! has no force, so a run that stopped early is charged with all it missed.

mod metric;

pub use metric::Metric;

use crate::record::{Ledger, Metrics, finite};
use crate::series::{TimeSeries, resample};

/// Part of the peak force above which teeth count as in contact [-].
pub const CONTACT_THRESHOLD: f64 = 1e-6;

/// Name of the column that holds the transmission error \[m\]: how far both hubs have moved into each other along the
/// line of action since the flanks of rigid gears would have touched.
pub const TRANSMISSION_ERROR: &str = "transmission_error_m";

/// Choices of the comparison.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompareOptions {
    /// Greatest shift that is tried to either side \[s\]; by default twice the width at half height
    /// of the reference's highest peak.
    pub max_shift_s: Option<f64>,
}

/// Compares a run with a reference; `against` is the id of that reference.
///
/// A quantity that the data cannot give is `None`; broken data never panic. The energy drift comes
/// from the run's ledger.
pub fn compare(
    series: &TimeSeries,
    ledger: &Ledger,
    reference: &TimeSeries,
    against: &str,
) -> Metrics {
    compare_with(
        series,
        ledger,
        reference,
        against,
        &CompareOptions::default(),
    )
}

/// [`compare`] with stated options.
pub fn compare_with(
    series: &TimeSeries,
    ledger: &Ledger,
    reference: &TimeSeries,
    against: &str,
    options: &CompareOptions,
) -> Metrics {
    let target = Force::of(reference);
    // What a run does after its reference ends can not be judged by it.
    let window = target.t.last().copied().unwrap_or(f64::INFINITY);
    let run = Force::of(series).until(window);
    let end = |column: &[f64]| last_finite(&column[..run.t.len().min(column.len())]);
    let mut metrics = Metrics {
        against: against.to_owned(),
        omega1_end: end(&series.omega1_rad_s),
        omega2_end: end(&series.omega2_rad_s),
        energy_drift_rel: ledger.residual_rel.and_then(finite),
        ..Metrics::default()
    };
    if run.t.is_empty() {
        return metrics;
    }
    let (peak, _) = run.peak();
    let impulse = run.impulse();
    metrics.peak_force_n = finite(peak);
    metrics.impulse_ns = finite(impulse);
    metrics.duration_s = finite(run.time_above(CONTACT_THRESHOLD * peak));
    if target.t.len() < 2 {
        return metrics;
    }
    let (target_peak, _) = target.peak();
    metrics.peak_force_rel = finite(peak / target_peak - 1.0);
    metrics.impulse_rel = finite(impulse / target.impulse() - 1.0);
    metrics.rebound_rel = rebound(series, reference, window);
    metrics.transmission_error_l2 = transmission_error(series, reference, &target, target_peak);

    let weights = trapezoid_weights(target.t);
    let norm2: f64 = target.y.iter().zip(&weights).map(|(f, w)| w * f * f).sum();
    let mut buffer = Vec::with_capacity(target.t.len());
    let mut error = |shift: f64| {
        resample(run.t, run.y, target.t, shift, &mut buffer);
        let sum: f64 = (buffer.iter().zip(target.y).zip(&weights))
            .map(|((f, r), w)| w * (f - r) * (f - r))
            .sum();
        (sum / norm2).sqrt()
    };
    metrics.force_l2 = finite(error(0.0));
    if metrics.force_l2.is_some() {
        let (shift, aligned) = best_shift(&run, &target, options, &mut error);
        metrics.force_l2_aligned = finite(aligned);
        metrics.time_shift_s = finite(shift);
    }
    metrics
}

/// Speeds that change by less than this part of the fastest gear's change belong to a held gear.
const HELD: f64 = 1e-6;

/// See the head of the module; `None` where no speed changes or the run stops before the reference does.
fn rebound(series: &TimeSeries, reference: &TimeSeries, window: f64) -> Option<f64> {
    let reached = series.time_s.last()? >= &(window * (1.0 - 1e-9));
    let gears = [
        (&series.omega1_rad_s, &reference.omega1_rad_s),
        (&series.omega2_rad_s, &reference.omega2_rad_s),
    ];
    let span = |x: &[f64]| {
        let finite = || x.iter().copied().filter(|x| x.is_finite());
        finite().fold(f64::MIN, f64::max) - finite().fold(f64::MAX, f64::min)
    };
    let largest = gears.iter().map(|(_, r)| span(r)).fold(0.0, f64::max);
    let last = |(run, r): &(&Vec<f64>, &Vec<f64>)| {
        let n = series.time_s.partition_point(|&t| t <= window);
        Some(((last_finite(&run[..n.min(run.len())])? - last_finite(r)?) / span(r)).abs())
    };
    let worst = (gears.iter())
        .filter(|(_, r)| span(r) > HELD * largest)
        .map(last)
        .try_fold(0.0_f64, |worst, x| Some(worst.max(x?)))?;
    (reached && largest > 0.0).then_some(worst).and_then(finite)
}

/// See the head of the module; `None` where a side has no such column.
fn transmission_error(
    series: &TimeSeries,
    reference: &TimeSeries,
    target: &Force<'_>,
    peak: f64,
) -> Option<f64> {
    let column = |s: &'_ TimeSeries| {
        let found = s.columns.iter().find(|c| c.name == TRANSMISSION_ERROR)?;
        (found.values.len() == s.time_s.len() && s.time_s.len() > 1).then(|| found.values.clone())
    };
    let (own, wanted) = (column(series)?, column(reference)?);
    let n = target.t.len();
    let mut buffer = Vec::with_capacity(n);
    resample(&series.time_s, &own, target.t, 0.0, &mut buffer);
    let (mut missed, mut norm) = (0.0, 0.0);
    for (i, w) in trapezoid_weights(target.t).iter().enumerate() {
        if target.y[i] > CONTACT_THRESHOLD * peak {
            missed += w * (buffer[i] - wanted[i]).powi(2);
            norm += w * wanted[i] * wanted[i];
        }
    }
    finite((missed / norm).sqrt())
}

/// The finite, well-formed part of a force history.
struct Force<'a> {
    t: &'a [f64],
    y: &'a [f64],
}

impl<'a> Force<'a> {
    fn of(series: &'a TimeSeries) -> Self {
        let (t, y) = (&series.time_s, &series.contact_force_n);
        let n = (t.iter().zip(y))
            .position(|(t, y)| !(t.is_finite() && y.is_finite()))
            .unwrap_or(t.len().min(y.len()));
        Self {
            t: &t[..n],
            y: &y[..n],
        }
    }

    /// The samples up to a time \[s\].
    fn until(self, end: f64) -> Self {
        let n = self.t.partition_point(|&t| t <= end);
        Self {
            t: &self.t[..n],
            y: &self.y[..n],
        }
    }

    fn peak(&self) -> (f64, usize) {
        let mut best = (0.0, 0);
        for (i, &y) in self.y.iter().enumerate() {
            if y > best.0 {
                best = (y, i);
            }
        }
        best
    }

    fn segments(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        (self.t.windows(2).zip(self.y.windows(2))).map(|(t, y)| (t[1] - t[0], y[0], y[1]))
    }

    fn impulse(&self) -> f64 {
        self.segments().map(|(h, a, b)| 0.5 * h * (a + b)).sum()
    }

    /// Centroid of the force in time.
    fn centroid(&self) -> f64 {
        let moment: f64 = (self.t.windows(2).zip(self.segments()))
            .map(|(t, (h, a, b))| h * (t[0] * (2.0 * a + b) + t[1] * (a + 2.0 * b)) / 6.0)
            .sum();
        moment / self.impulse()
    }

    /// Time in which the piecewise linear force exceeds `level`.
    fn time_above(&self, level: f64) -> f64 {
        self.segments()
            .map(|(h, a, b)| match (a > level, b > level) {
                (true, true) => h,
                (true, false) => h * (a - level) / (a - b),
                (false, true) => h * (b - level) / (b - a),
                (false, false) => 0.0,
            })
            .sum()
    }

    /// Width of the highest peak at half its height.
    fn half_width(&self) -> f64 {
        let (peak, at) = self.peak();
        let below = |&i: &usize| self.y[i] < 0.5 * peak;
        let left = (0..at).rev().find(below).unwrap_or(0);
        let right = (at..self.t.len())
            .find(below)
            .unwrap_or(self.t.len().saturating_sub(1));
        self.t[right] - self.t[left]
    }
}

/// Coarse scan about each guess (no shift, equal centroids, equal peaks), then golden section.
fn best_shift(
    run: &Force<'_>,
    target: &Force<'_>,
    options: &CompareOptions,
    error: &mut dyn FnMut(f64) -> f64,
) -> (f64, f64) {
    const SCAN: i32 = 32;
    let width = target.half_width();
    let limit = options.max_shift_s.unwrap_or(2.0 * width).abs();
    let step = limit.min(2.0 * width) / f64::from(SCAN);
    let mut best = (0.0, error(0.0));
    if !(step.is_finite() && step > 0.0) {
        return best;
    }
    let peaks = target.t[target.peak().1] - run.t[run.peak().1];
    for guess in [0.0, target.centroid() - run.centroid(), peaks] {
        if !guess.is_finite() || (options.max_shift_s.is_some() && guess.abs() > limit) {
            continue;
        }
        for k in -SCAN..=SCAN {
            let shift = guess + f64::from(k) * step;
            let e = error(shift);
            if e < best.1 && (options.max_shift_s.is_none() || shift.abs() <= limit) {
                best = (shift, e);
            }
        }
    }
    let refined = golden_section(best.0 - step, best.0 + step, error);
    if refined.1 < best.1 { refined } else { best }
}

fn golden_section(mut a: f64, mut b: f64, f: &mut dyn FnMut(f64) -> f64) -> (f64, f64) {
    const RATIO: f64 = 0.618_033_988_749_894_8;
    let (mut c, mut d) = (b - RATIO * (b - a), a + RATIO * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    for _ in 0..60 {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - RATIO * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + RATIO * (b - a);
            fd = f(d);
        }
    }
    if fc < fd { (c, fc) } else { (d, fd) }
}

fn trapezoid_weights(t: &[f64]) -> Vec<f64> {
    let mut weights = vec![0.0; t.len()];
    for i in 1..t.len() {
        let half = 0.5 * (t[i] - t[i - 1]);
        weights[i - 1] += half;
        weights[i] += half;
    }
    weights
}

fn last_finite(values: &[f64]) -> Option<f64> {
    values.iter().rev().copied().find(|x| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Half-sine of height `peak` and length `length` that starts at `start`.
    fn half_sine(start: f64, length: f64, peak: f64, h: f64) -> TimeSeries {
        let mut s = TimeSeries::default();
        for i in 0..=((4.0 * length / h) as usize) {
            let t = i as f64 * h;
            let u = (t - start) / length;
            let f = if (0.0..=1.0).contains(&u) {
                peak * (PI * u).sin()
            } else {
                0.0
            };
            s.push(t, f, 20.0, -f64::from(i as u32));
        }
        s
    }

    fn close(a: Option<f64>, b: f64, tolerance: f64) {
        let a = a.expect("a value");
        assert!((a - b).abs() <= tolerance, "{a} against {b}");
    }

    #[test]
    fn half_sine_has_its_closed_form() {
        let s = half_sine(1e-4, 1e-4, 3000.0, 1e-7);
        let m = compare(&s, &Ledger::default(), &s, "self");
        close(m.peak_force_n, 3000.0, 1e-3);
        close(m.impulse_ns, 2.0 / PI * 3000.0 * 1e-4, 1e-6);
        close(m.duration_s, 1e-4, 2e-10);
        close(m.force_l2, 0.0, 1e-15);
        close(m.force_l2_aligned, 0.0, 1e-15);
        close(m.peak_force_rel, 0.0, 0.0);
        close(m.omega1_end, 20.0, 0.0);
        close(m.omega2_end, -4000.0, 0.0);
    }

    #[test]
    fn rebound_and_transmission_error() {
        let with = |s: &mut TimeSeries, scale: f64, end: f64| {
            let n = s.len();
            s.omega1_rad_s = (0..n)
                .map(|i| 20.0 - 25.0 * i as f64 / (n - 1) as f64)
                .collect();
            s.omega2_rad_s = vec![0.0; n];
            s.omega1_rad_s[n - 1] = end;
            s.columns.push(crate::series::Column {
                name: TRANSMISSION_ERROR.into(),
                values: s.contact_force_n.iter().map(|f| scale * 1e-9 * f).collect(),
            });
        };
        let mut r = half_sine(1e-4, 1e-4, 1000.0, 1e-7);
        let mut s = r.clone();
        with(&mut r, 1.0, -5.0);
        with(&mut s, 1.1, -4.5);
        let m = compare(&s, &Ledger::default(), &r, "fe");
        close(m.rebound_rel, 0.5 / 25.0, 1e-12);
        close(m.transmission_error_l2, 0.1, 1e-12);
        // A run that stops early has no rebound; a reference without the column has no transmission error.
        s.time_s.truncate(300);
        s.contact_force_n.truncate(300);
        s.omega1_rad_s.truncate(300);
        s.omega2_rad_s.truncate(300);
        s.columns[0].values.truncate(300);
        r.columns.clear();
        let m = compare(&s, &Ledger::default(), &r, "fe");
        assert_eq!((m.rebound_rel, m.transmission_error_l2), (None, None));
    }

    #[test]
    fn scaled_force_has_the_scale_as_error() {
        let r = half_sine(1e-4, 1e-4, 1000.0, 1e-7);
        let s = half_sine(1e-4, 1e-4, 1100.0, 1e-7);
        let m = compare(&s, &Ledger::default(), &r, "fe");
        close(m.force_l2, 0.1, 1e-12);
        close(m.force_l2_aligned, 0.1, 1e-6);
        close(m.peak_force_rel, 0.1, 1e-12);
        close(m.impulse_rel, 0.1, 1e-12);
        close(m.time_shift_s, 0.0, 1e-8);
    }

    /// Two half-sines of length T, d apart: the squared error is 2 (1 - c(d)) with the overlap
    /// c(d) = (1 - d/T) cos(pi d/T) + sin(pi d/T)/pi.
    #[test]
    fn shifted_force_is_found_and_raw_error_exact() {
        let length = 1e-4;
        let r = half_sine(1e-4, length, 1000.0, 1e-7);
        for shift in [-6.35e-5, -3e-6, 1.234e-5, 9e-5] {
            let s = half_sine(1e-4 + shift, length, 1000.0, 1.3e-7);
            let m = compare(&s, &Ledger::default(), &r, "fe");
            let x: f64 = shift.abs() / length;
            let overlap = (1.0 - x) * (PI * x).cos() + (PI * x).sin() / PI;
            close(m.force_l2, (2.0 * (1.0 - overlap)).sqrt(), 1e-4);
            close(m.force_l2_aligned, 0.0, 2e-4);
            close(m.time_shift_s, -shift, 1e-9);
        }
    }

    #[test]
    fn far_apart_impacts_are_still_aligned() {
        let r = half_sine(1e-5, 1e-4, 1000.0, 1e-7);
        let s = half_sine(2.9e-4, 1e-4, 1000.0, 1e-7);
        let m = compare(&s, &Ledger::default(), &r, "fe");
        close(m.force_l2, 2.0_f64.sqrt(), 1e-6);
        close(m.force_l2_aligned, 0.0, 1e-6);
        let narrow = CompareOptions {
            max_shift_s: Some(1e-6),
        };
        let m = compare_with(&s, &Ledger::default(), &r, "fe", &narrow);
        assert!(m.force_l2_aligned.unwrap() > 1.0);
    }

    #[test]
    fn a_run_that_stopped_early_is_charged() {
        let r = half_sine(1e-4, 1e-4, 1000.0, 1e-7);
        let mut s = r.clone();
        for column in [
            &mut s.time_s,
            &mut s.contact_force_n,
            &mut s.omega1_rad_s,
            &mut s.omega2_rad_s,
        ] {
            column.truncate(1501);
        }
        let m = compare(&s, &Ledger::default(), &r, "fe");
        close(m.force_l2, 0.5_f64.sqrt(), 1e-3);
    }

    #[test]
    fn broken_data_give_no_numbers_and_no_panic() {
        let r = half_sine(1e-4, 1e-4, 1000.0, 1e-7);
        let mut blown = r.clone();
        for f in &mut blown.contact_force_n[1200..] {
            *f = f64::NAN;
        }
        let empty = TimeSeries::default();
        for s in [&blown, &empty] {
            for target in [&r, &empty, &blown] {
                let m = compare(s, &Ledger::default(), target, "fe");
                let json = serde_json::to_string(&m).unwrap();
                assert!(!json.contains("null"), "{json}");
            }
        }
        let ledger = Ledger {
            residual_rel: Some(f64::INFINITY),
            ..Ledger::default()
        };
        assert_eq!(compare(&r, &ledger, &r, "fe").energy_drift_rel, None);
    }

    #[test]
    fn what_follows_the_reference_is_not_compared_with_it() {
        let reference = half_sine(1e-5, 1e-4, 3000.0, 2e-7);
        let mut run = half_sine(1e-5, 1e-4, 3000.0, 2e-7);
        let end = reference.time_s[reference.len() - 1];
        for i in 1..50 {
            run.push(end + f64::from(i) * 1e-6, 9000.0, 5.0, 5.0);
        }
        let m = compare(&run, &Ledger::default(), &reference, "calculix");
        assert!(m.peak_force_rel.is_some_and(|x| x.abs() < 1e-12), "{m:?}");
        assert!(m.impulse_rel.is_some_and(|x| x.abs() < 1e-9), "{m:?}");
        assert_eq!(m.omega1_end, reference.omega1_rad_s.last().copied());
    }
}
