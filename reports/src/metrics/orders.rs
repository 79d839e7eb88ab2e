//! Transmission error by orders of the mesh cycle, independent of its mean and of its phase.
//!
//! Over the last whole mesh cycles that both sides have, with c the number of elapsed cycles,
//!
//! ```text
//! E_n = 2/N int e(c) exp(-2 pi i n c) dc          over N whole cycles, n = 1, 2, ..
//! orders_rel = sqrt( sum (|E_n| - |R_n|)^2 / sum |R_n|^2 )
//! aligned    = min over s of sqrt( sum |E_n exp(2 pi i n s) - R_n|^2 / sum |R_n|^2 )
//! ```
//!
//! The integral is the trapezoidal rule at the samples of each side, with both ends interpolated linearly. Measured
//! transmission errors have no known mean, and their phase depends on the zero of an encoder: neither enters. The part
//! that repeats with the turns of the gears and not with the mesh cycle lies between the orders and does not enter
//! either.

use super::columns::at_times;
use super::history::trapezoid_weights;
use crate::series::{MESH_CYCLE, Quantity, TRANSMISSION_ERROR, TimeSeries};
use std::f64::consts::TAU;

/// Number of orders whose amplitudes a record keeps.
pub const KEPT: usize = 5;
/// Orders that errors are summed over.
const SUMMED: usize = 20;
/// Samples that a period of the highest order has at least.
const SAMPLES: f64 = 8.0;
/// Shifts that are tried, over one cycle.
const SHIFTS: usize = 256;

/// A history over mesh cycles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CycleHistory {
    /// Mesh cycles that have passed, ascending.
    pub cycle: Vec<f64>,
    /// Values of a quantity of a mesh, in general the transmission error \[m\].
    pub values: Vec<f64>,
}

/// Real and imaginary part of the amplitude of an order \[m\].
#[derive(Clone, Copy, Debug, Default)]
struct Order {
    re: f64,
    im: f64,
}

impl Order {
    fn square(self) -> f64 {
        self.re * self.re + self.im * self.im
    }
}

/// Returns the history of a quantity of a mesh if it has one value per time.
fn column<'s>(series: &'s TimeSeries, quantity: Quantity, mesh: &str) -> Option<&'s [f64]> {
    let values = series.of(quantity, mesh)?;
    (values.len() == series.time_s.len()).then_some(values)
}

impl CycleHistory {
    /// Returns the transmission error of a mesh of a run over its own mesh cycles; `None` where it was not recorded, or
    /// where the gears turn back by more than rounding errors.
    pub fn of_run(series: &TimeSeries, mesh: &str) -> Option<Self> {
        Self::of_quantity(series, TRANSMISSION_ERROR, mesh)
    }

    /// Returns a quantity of a mesh of a run over its own mesh cycles; `None` as [`CycleHistory::of_run`].
    pub fn of_quantity(series: &TimeSeries, quantity: Quantity, mesh: &str) -> Option<Self> {
        let cycles = column(series, MESH_CYCLE, mesh)?;
        Self::at(column(series, quantity, mesh)?, cycles)
    }

    /// Returns the transmission error of a mesh of a reference over its own mesh cycles, or over those of a run at the
    /// same times.
    pub fn of_reference(series: &TimeSeries, run: &TimeSeries, mesh: &str) -> Option<Self> {
        let cycles = match column(series, MESH_CYCLE, mesh) {
            Some(own) => own.to_vec(),
            None => {
                let last = *run.time_s.last()?;
                let known = series.time_s.partition_point(|&t| t <= last);
                at_times(
                    &run.time_s,
                    column(run, MESH_CYCLE, mesh)?,
                    &series.time_s[..known],
                )
            }
        };
        Self::at(column(series, TRANSMISSION_ERROR, mesh)?, &cycles)
    }

    fn at(values: &[f64], cycles: &[f64]) -> Option<Self> {
        let (first, last) = (cycles.first()?, cycles.last()?);
        let sign = (last - first).signum();
        let mut found = Self::default();
        for (c, e) in cycles.iter().map(|c| sign * c).zip(values) {
            if !(c.is_finite() && e.is_finite()) {
                continue;
            }
            match found.cycle.last() {
                Some(&before) if c < before - 1e-9 => return None,
                // The two values at a jump have the same abscissa.
                Some(&before) => found.cycle.push(c.max(before)),
                None => found.cycle.push(c),
            }
            found.values.push(*e);
        }
        (found.cycle.len() > 1).then_some(found)
    }

    /// Returns first and last of the whole cycles that all histories share; `None` where they share less than one
    /// cycle.
    pub fn whole<'s>(all: impl IntoIterator<Item = &'s Self>) -> Option<[f64; 2]> {
        let mut shared: Option<[f64; 2]> = None;
        for of in all {
            let (first, last) = (*of.cycle.first()?, *of.cycle.last()?);
            shared = Some(shared.map_or([first, last], |[a, b]| [a.max(first), b.min(last)]));
        }
        let [first, last] = shared?;
        let whole = (last - first + 1e-6).floor();
        (whole >= 1.0).then_some([last - whole, last])
    }

    /// Computes the amplitudes of the orders over whole cycles \[m\], from the first on.
    pub fn amplitudes(&self, cycles: [f64; 2], most: usize) -> Vec<f64> {
        let kept = self.resolved(cycles).min(most);
        let orders = self.orders(cycles, kept);
        orders.iter().map(|o| o.square().sqrt()).collect()
    }

    /// Returns the number of orders that the samples between two cycles resolve.
    fn resolved(&self, [first, last]: [f64; 2]) -> usize {
        let until = |c: f64| self.cycle.partition_point(|&x| x < c);
        ((until(last) - until(first)) as f64 / (last - first) / SAMPLES) as usize
    }

    /// Returns cycles and values of the samples between two cycles, with both ends interpolated linearly.
    pub fn between(&self, [first, last]: [f64; 2]) -> (Vec<f64>, Vec<f64>) {
        let inner =
            self.cycle.partition_point(|&c| c <= first)..self.cycle.partition_point(|&c| c < last);
        let ends = at_times(&self.cycle, &self.values, &[first, last]);
        let with_ends = |ends: [f64; 2], inner: &[f64]| {
            let mut all = vec![ends[0]];
            all.extend_from_slice(inner);
            all.push(ends[1]);
            all
        };
        (
            with_ends([first, last], &self.cycle[inner.clone()]),
            with_ends([ends[0], ends[1]], &self.values[inner]),
        )
    }

    fn orders(&self, cycles: [f64; 2], kept: usize) -> Vec<Order> {
        let (cycle, error) = self.between(cycles);
        let scale = 2.0 / (cycles[1] - cycles[0]);
        let mut found = vec![Order::default(); kept];
        for ((c, e), w) in cycle.iter().zip(&error).zip(trapezoid_weights(&cycle)) {
            // Powers of the first order's phase are those of the others.
            let (sine, cosine) = (TAU * c).sin_cos();
            let (mut re, mut im) = (scale * w * e, 0.0);
            for order in &mut found {
                (re, im) = (re * cosine + im * sine, im * cosine - re * sine);
                order.re += re;
                order.im += im;
            }
        }
        found
    }
}

/// Errors of a run by orders; see the head of the module.
#[derive(Clone, Copy, Debug)]
pub struct OrderErrors {
    /// Error of the amplitudes [-].
    pub amplitudes: f64,
    /// Error after the best shift [-].
    pub aligned: f64,
}

/// Compares a run with a reference over the last whole mesh cycles that both have.
pub fn errors(run: &CycleHistory, reference: &CycleHistory) -> Option<OrderErrors> {
    let window = CycleHistory::whole([run, reference])?;
    let kept = SUMMED
        .min(run.resolved(window))
        .min(reference.resolved(window));
    if kept == 0 {
        return None;
    }
    let (own, wanted) = (run.orders(window, kept), reference.orders(window, kept));
    let norm: f64 = wanted.iter().map(|r| r.square()).sum();
    let total: f64 = own.iter().map(|e| e.square()).sum();
    let differ = |(e, r): (&Order, &Order)| (e.square().sqrt() - r.square().sqrt()).powi(2);
    let amplitudes: f64 = own.iter().zip(&wanted).map(differ).sum();
    // The sum of squares is least where the correlation is greatest.
    let correlation = |shift: f64| -> f64 {
        let one = |(n, (e, r)): (usize, (&Order, &Order))| {
            let (sine, cosine) = (TAU * (n + 1) as f64 * shift).sin_cos();
            let (re, im) = (e.re * cosine - e.im * sine, e.re * sine + e.im * cosine);
            re * r.re + im * r.im
        };
        own.iter().zip(&wanted).enumerate().map(one).sum()
    };
    let better = |a: &f64, b: &f64| correlation(*a).total_cmp(&correlation(*b));
    let step = 1.0 / SHIFTS as f64;
    let mut best = (0..SHIFTS).map(|k| k as f64 * step).max_by(better)?;
    let mut half = step;
    while half > 1e-12 {
        half *= 0.5;
        best = [best - half, best, best + half]
            .into_iter()
            .max_by(better)?;
    }
    let rest = (total + norm - 2.0 * correlation(best)).max(0.0);
    Some(OrderErrors {
        amplitudes: (amplitudes / norm).sqrt(),
        aligned: (rest / norm).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::{CONTACT_FORCE, Column};

    const MESH: &str = "a_b";

    fn series(speed: f64, error: impl Fn(f64) -> f64, cycles: bool) -> TimeSeries {
        let time: Vec<f64> = (0..=4000).map(|i| f64::from(i) * 1e-3).collect();
        let of = |quantity: Quantity, f: &dyn Fn(f64) -> f64| {
            Column::new(quantity.of(MESH), time.iter().map(|&t| f(t)).collect())
        };
        let mut columns = vec![
            of(CONTACT_FORCE, &|_| 0.0),
            of(TRANSMISSION_ERROR, &|t| error(speed * t)),
        ];
        columns.extend(cycles.then(|| of(MESH_CYCLE, &|t| speed * t)));
        TimeSeries {
            time_s: time,
            columns,
            ..TimeSeries::default()
        }
    }

    fn wave(c: f64) -> f64 {
        3e-6 * (TAU * c).cos() + 1e-6 * (2.0 * TAU * c).sin()
    }

    /// Neither mean nor shift counts, a smaller second order does.
    #[test]
    fn mean_and_shift_are_no_errors_and_orders_are() {
        let run = series(2.6, wave, true);
        let own = CycleHistory::of_run(&run, MESH).unwrap();
        let found = own.amplitudes(CycleHistory::whole([&own]).unwrap(), 3);
        for (a, b) in found.iter().zip([3e-6, 1e-6, 0.0]) {
            assert!((a - b).abs() < 1e-10, "{found:?}");
        }
        let shifted = series(2.6, |c| 7e-6 + wave(c + 0.37), false);
        let shifted = CycleHistory::of_reference(&shifted, &run, MESH).unwrap();
        let same = errors(&own, &shifted).unwrap();
        assert!(same.aligned < 1e-4 && same.amplitudes < 1e-4, "{same:?}");
        // Half of the second order is missing: 0.5e-6 over the norm of what is there.
        let flat = series(2.6, |c| wave(c) - 0.5e-6 * (2.0 * TAU * c).sin(), false);
        let flat = CycleHistory::of_reference(&flat, &run, MESH).unwrap();
        let differs = errors(&own, &flat).unwrap();
        let expected = 0.5 / (9.0_f64 + 0.25).sqrt();
        assert!((differs.amplitudes - expected).abs() < 1e-4, "{differs:?}");
        assert!((differs.aligned - expected).abs() < 1e-4, "{differs:?}");
    }

    /// A quarter turn of the second order against the first is no shift, and no error of amplitudes.
    #[test]
    fn phases_between_orders_count_after_the_best_shift() {
        let run = series(2.6, wave, true);
        let own = CycleHistory::of_run(&run, MESH).unwrap();
        let turned = |c: f64| 3e-6 * (TAU * c).cos() + 1e-6 * (2.0 * TAU * c).cos();
        let other = CycleHistory::of_reference(&series(2.6, turned, false), &run, MESH).unwrap();
        let found = errors(&own, &other).unwrap();
        assert!(found.amplitudes < 1e-4 && found.aligned > 0.1, "{found:?}");
    }

    /// Less than a cycle, and gears that turn back, have no orders.
    #[test]
    fn no_orders_without_a_whole_cycle() {
        let short = CycleHistory::of_run(&series(0.2, wave, true), MESH).unwrap();
        assert!(CycleHistory::whole([&short]).is_none());
        let mut back = series(2.0, wave, true);
        for c in &mut back.columns[2].values {
            *c = (3.0 * *c).sin();
        }
        assert!(CycleHistory::of_run(&back, MESH).is_none());
    }
}
