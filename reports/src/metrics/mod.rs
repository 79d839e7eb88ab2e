//! Engineering outputs of a run against a reference.
//!
//! With the run's contact force f(t), the reference f_r(t):
//!
//! ```text
//! force_l1         = int |f(t) - f_r(t)| dt / int |f_r(t)| dt
//! force_l2         = sqrt( int (f(t) - f_r(t))^2 dt / int f_r(t)^2 dt )
//! force_l2_aligned = min over tau of the same with f(t - tau);  time_shift_s = tau
//! impulse          = int f dt                    (while the reference lasts)
//! rms_force        = sqrt( int f^2 dt / T )      (T the time that both last)
//! transmission_error_pp = max e - min e          (while the reference lasts)
//! duration         = time in which f exceeds 1e-6 of its own peak
//! rebound          = max over gears of (last speed - last speed of the reference) / span of the reference's speed
//! transmission_error_orders_rel, transmission_error_l2_aligned: by orders of the mesh cycle, see [`orders`]
//! transmission_error_l2 = sqrt( int (e - e_r)^2 dt / int e_r^2 dt ) over the times at which f_r acts
//! angle_l2         = max over gears of sqrt( int (phi - phi_r)^2 dt / T ) / span of phi_r
//! speed_l2         = the same of speeds, of gears and bodies
//! torque_l2        = the same of torques
//! torque_peak_rel  = max |M| / max |M_r| - 1, of the torque for which its magnitude is largest
//! ```
//!
//! Errors of the force are the largest over the meshes whose forces both sides have, of those whose reference bears at least
//! 1e-3 of the force of the most loaded one (root mean squares); the alignment is that of each mesh, the shift that of the
//! mesh with the largest aligned error. Peak, impulse, root mean square and duration are those of the first mesh of the scene;
//! those of all meshes are in [`MeshForce`](crate::record::MeshForce). The rebound error is the largest over all gears whose
//! speeds both sides have. Errors of the transmission error are the largest over all meshes likewise, with f_r the force of the
//! mesh, those of peak to peak and of orders over meshes whose reference has at least 1e-3 of the largest peak to peak; peak to
//! peak and amplitudes themselves are those of the first mesh. A metric whose quantity the reference lacks is absent; without
//! a force the transmission error is compared at all its times. T is the duration of the reference. Angles and torques are compared
//! with external references only (`columns.rs`).
//!
//! **Integrals.** Forces of runs are polynomials between located events, with both sides of every jump
//! ([`ForceHistory`](crate::force::ForceHistory)). Between two runs, integrals are Gauss quadratures over the union of
//! their pieces, and peaks are those of the polynomials: there is no sampling error, and the error of a run against
//! itself is 0. An external reference is known at its own times only: the run is evaluated there, and the rule is the
//! trapezoidal one.
//!
//! **Choice of norm.** A force with damped contact jumps at touch-down and where tooth pairs change. If an integrator
//! locates such an event d early or late, the force is wrong by the jump J for the time d: `int |f - f_r| = J d`, but
//! `sqrt(int (f - f_r)^2) = J sqrt(d)`. The L2 norm therefore converges as the square root of the event times: an event
//! time error of 1e-8 of a contact gives an L2 error of 0.01 %. The L1 norm converges as the event times do, and equals
//! the share of the impulse that acts at a wrong time. `force_l1` is therefore the integration error wherever runs are
//! compared with their model's own converged solution. Against finite elements, whose force does not jump, the L2 norms
//! measure the error of the shape.
//!
//! After an impact most of a pointwise error is phase error: the aligned value is the error of the shape of the force,
//! the shift is the phase error. Outside its history a run has no force, so a run that ends before its reference has an
//! error for the missing part. A run that did not reach its own end has no metrics ([`FinishedRun`]).

mod columns;
mod history;
pub mod meshes;
mod metric;
pub mod orders;

pub use metric::Metric;

use crate::record::{Ledger, Metrics, finite};
use crate::series::{CONTACT_FORCE, SPEED, TRANSMISSION_ERROR, TimeSeries, resample};
pub(crate) use columns::at_times;
pub(crate) use history::trapezoid_weights;
use history::{Force, Target, force_of, last_finite, samples_of};
use orders::CycleHistory;

/// Part of the peak force above which teeth count as in contact [-].
pub const CONTACT_THRESHOLD: f64 = 1e-6;

/// Histories and ledger of a run that reached its end, as input of the metrics; other runs have none.
#[derive(Clone, Copy, Debug)]
pub struct FinishedRun<'a> {
    series: &'a TimeSeries,
    ledger: &'a Ledger,
}

/// A run that stopped before its end: a part of a run has no metrics.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the run stopped at {reached_s:.4e} s of {end_s:.4e} s: nothing is known of the whole")]
pub struct UnfinishedRun {
    /// Time that it reached \[s\].
    pub reached_s: f64,
    /// Time that it was to reach \[s\].
    pub end_s: f64,
}

impl<'a> FinishedRun<'a> {
    /// Returns the run if it reached its end: histories and ledger, with the time that it reached and the time that it
    /// should reach \[s\]. The history may end before, where only intervals of contact are recorded.
    ///
    /// # Errors
    /// [`UnfinishedRun`] when it did not reach its end, or has no history.
    pub fn reached(
        series: &'a TimeSeries,
        ledger: &'a Ledger,
        [reached_s, end_s]: [f64; 2],
    ) -> Result<Self, UnfinishedRun> {
        if !series.is_empty() && reached_s >= end_s - 1e-9 * end_s.abs() {
            Ok(Self { series, ledger })
        } else {
            Err(UnfinishedRun { reached_s, end_s })
        }
    }

    /// Returns the energy and impulse ledger of the run.
    pub fn ledger(&self) -> &'a Ledger {
        self.ledger
    }
}

/// Compares a run with a reference; `against` is the id of that reference.
///
/// A quantity that the data cannot give is `None`; broken data never panic. The energy drift comes
/// from the run's ledger.
pub fn compare(run: FinishedRun<'_>, reference: &TimeSeries, against: &str) -> Metrics {
    let FinishedRun { series, ledger } = run;
    let mesh = series.first_mesh().map_or("", |(mesh, _)| mesh);
    let target = Target::of(reference, mesh);
    let has_force = !samples_of(reference, mesh).is_empty();
    // A run cannot be compared after the end of its reference.
    let window = match has_force {
        false => reference.time_s.last().copied().unwrap_or(f64::INFINITY),
        true => target.end(),
    };
    let history = force_of(series, mesh);
    let run = Force::until(&history, window);
    let known = series.time_s.partition_point(|&t| t <= window);
    let end = |(gear, speed): (&str, &[f64])| {
        let last = last_finite(&speed[..known.min(speed.len())])?;
        Some((gear.to_owned(), last))
    };
    let mut metrics = Metrics {
        against: against.to_owned(),
        speeds_end: series.all_of(SPEED).filter_map(end).collect(),
        energy_drift_rel: ledger.residual_rel.and_then(finite),
        ..Metrics::default()
    };
    if known == 0 {
        return metrics;
    }
    let (peak, _) = run.peak();
    let impulse = run.impulse();
    metrics.peak_force_n = finite(peak);
    metrics.impulse_ns = finite(impulse);
    let lasts = window.min(series.time_s[known - 1]) - series.time_s[0];
    let rms = |force: &Force<'_>| (force.square() / lasts).sqrt();
    metrics.rms_force_n = finite(rms(&run));
    let span_of_error =
        |of: &TimeSeries, mesh: &str| span_until(of, of.of(TRANSMISSION_ERROR, mesh)?, window);
    metrics.transmission_error_pp_m = span_of_error(series, mesh);
    if let Some(own) = &CycleHistory::of_run(series, mesh)
        && let Some(whole) = CycleHistory::whole([own])
    {
        metrics.transmission_error_orders_m = own.amplitudes(whole, orders::KEPT);
    }
    metrics.duration_s = finite(run.time_above(CONTACT_THRESHOLD * peak));
    if reference.len() < 2 {
        return metrics;
    }
    let both = |(mesh, _)| {
        let (own, wanted) = (
            span_of_error(series, mesh)?,
            span_of_error(reference, mesh)?,
        );
        Some((mesh, own, wanted))
    };
    let spans: Vec<(&str, f64, f64)> = (reference.all_of(TRANSMISSION_ERROR))
        .filter_map(both)
        .collect();
    let most = spans.iter().map(|s| s.2).fold(0.0, f64::max);
    for (mesh, own, wanted) in spans.into_iter().filter(|s| s.2 >= BORNE * most) {
        let worst = |metric: &mut Option<f64>, error: f64| {
            *metric = larger(*metric, finite(error));
        };
        let deviates = deviation(own, wanted);
        worst(&mut metrics.transmission_error_pp_rel, deviates);
        if let Some(own) = CycleHistory::of_run(series, mesh)
            && let Some(wanted) = CycleHistory::of_reference(reference, series, mesh)
            && let Some(errors) = orders::errors(&own, &wanted)
        {
            worst(
                &mut metrics.transmission_error_orders_rel,
                errors.amplitudes,
            );
            worst(&mut metrics.transmission_error_l2_aligned, errors.aligned);
        }
    }
    metrics.rebound_rel = rebound(series, reference, window);
    let errors = reference.all_of(TRANSMISSION_ERROR);
    metrics.transmission_error_l2 = errors
        .map(|(mesh, _)| transmission_error(series, reference, mesh, window))
        .fold(None, larger);
    if reference.forces.is_empty() {
        metrics.angle_l2 = columns::worst(series, reference, columns::is_angle);
        metrics.speed_l2 = columns::worst(series, reference, columns::is_speed);
        metrics.torque_l2 = columns::worst(series, reference, columns::is_torque);
        metrics.torque_peak_rel = columns::peak(series, reference, columns::is_torque);
    }
    force_errors(&mut metrics, series, reference, [window, lasts]);
    metrics
}

/// Least force of a mesh, over that of the most loaded one, at which its errors count (root mean squares); likewise the
/// peak to peak of its transmission error.
const BORNE: f64 = 1e-3;

/// Adds the errors of the contact forces (see the head of the module); `window` is the end of the comparison, `lasts` its
/// duration \[s\].
fn force_errors(
    metrics: &mut Metrics,
    series: &TimeSeries,
    reference: &TimeSeries,
    [window, lasts]: [f64; 2],
) {
    let meshes: Vec<&str> = series.all_of(CONTACT_FORCE).map(|(mesh, _)| mesh).collect();
    let known = |mesh: &&&str| !samples_of(reference, mesh).is_empty();
    let compared: Vec<&str> = match meshes.iter().filter(known).count() {
        // Nothing is known of the forces: the first mesh stands for that.
        0 => vec![meshes.first().copied().unwrap_or("")],
        _ => meshes.iter().filter(known).copied().collect(),
    };
    let histories: Vec<_> = (compared.iter())
        .map(|mesh| (mesh, force_of(series, mesh), force_of(reference, mesh)))
        .collect();
    let rms = |force: &Force<'_>| (force.square() / lasts).sqrt();
    let forces: Vec<_> = (histories.iter())
        .map(|(mesh, own, wanted)| {
            let wanted = Force::until(wanted, window);
            (mesh, Force::until(own, window), rms(&wanted), wanted)
        })
        .collect();
    let most = forces.iter().map(|f| f.2).fold(0.0, f64::max);
    for (mesh, own, bears, wanted) in &forces {
        if *bears < BORNE * most {
            continue;
        }
        let target = Target::of(reference, mesh);
        let worst = |metric: &mut Option<f64>, error: f64| {
            *metric = larger(*metric, finite(error));
        };
        let peaks = deviation(own.peak().0, wanted.peak().0);
        worst(&mut metrics.peak_force_rel, peaks);
        let impulses = deviation(own.impulse(), wanted.impulse());
        worst(&mut metrics.impulse_rel, impulses);
        if !samples_of(reference, mesh).is_empty() {
            worst(&mut metrics.rms_force_rel, deviation(rms(own), *bears));
        }
        let distance = target.distance(own, 0.0);
        worst(&mut metrics.force_l1, distance.l1);
        worst(&mut metrics.force_l2, distance.l2);
        if distance.l2.is_finite() {
            let (shift, aligned) = target.best_shift(own);
            if metrics.force_l2_aligned.is_none_or(|known| aligned > known) {
                metrics.force_l2_aligned = finite(aligned);
                metrics.time_shift_s = finite(shift);
            }
        }
    }
}

/// Compares a run with a reference whose histories have several axes of time, the contact force on the first: each metric
/// is that of the histories it is about, the worst where several are.
pub fn compare_all(run: FinishedRun<'_>, all: &[&TimeSeries], against: &str) -> Metrics {
    let mut all = all.iter().map(|series| compare(run, series, against));
    let mut whole = all.next().unwrap_or_else(|| Metrics {
        against: against.to_owned(),
        ..Metrics::default()
    });
    for more in all {
        for (worst, more) in [
            (&mut whole.rebound_rel, more.rebound_rel),
            (&mut whole.transmission_error_l2, more.transmission_error_l2),
            (
                &mut whole.transmission_error_pp_rel,
                more.transmission_error_pp_rel,
            ),
            (
                &mut whole.transmission_error_orders_rel,
                more.transmission_error_orders_rel,
            ),
            (
                &mut whole.transmission_error_l2_aligned,
                more.transmission_error_l2_aligned,
            ),
            (&mut whole.angle_l2, more.angle_l2),
            (&mut whole.speed_l2, more.speed_l2),
            (&mut whole.torque_l2, more.torque_l2),
            (&mut whole.torque_peak_rel, more.torque_peak_rel),
        ] {
            *worst = larger(*worst, more);
        }
    }
    whole
}

/// Computes the deviation of a value over that of a reference; zero agrees with zero.
fn deviation(value: f64, reference: f64) -> f64 {
    match (value, reference) {
        (0.0, 0.0) => 0.0,
        (value, reference) => value / reference - 1.0,
    }
}

/// Returns the error of larger magnitude among those that are known.
fn larger(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(x), Some(y)) => Some(if y.abs() > x.abs() { y } else { x }),
        (a, b) => a.or(b),
    }
}

/// Computes the peak to peak of a history up to a time.
fn span_until(series: &TimeSeries, history: &[f64], until: f64) -> Option<f64> {
    let known = series.time_s.partition_point(|&t| t <= until);
    let values = history.iter().take(known).filter(|x| x.is_finite());
    let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
        (a.min(*x), b.max(*x))
    });
    finite(most - least)
}

/// Relative change of speed below which a gear counts as held, over the change of the fastest gear.
const HELD: f64 = 1e-6;

/// Computes the rebound error (see the head of the module); `None` where no speed changes or the run stops before the
/// reference does.
fn rebound(series: &TimeSeries, reference: &TimeSeries, window: f64) -> Option<f64> {
    let reached = series.time_s.last()? >= &(window * (1.0 - 1e-9));
    let both = |(gear, own)| Some((own, reference.of(SPEED, gear)?));
    let gears: Vec<(&[f64], &[f64])> = series.all_of(SPEED).filter_map(both).collect();
    let span = |x: &[f64]| {
        let finite = || x.iter().copied().filter(|x| x.is_finite());
        finite().fold(f64::MIN, f64::max) - finite().fold(f64::MAX, f64::min)
    };
    let largest = gears.iter().map(|(_, r)| span(r)).fold(0.0, f64::max);
    let last = |(run, r): &(&[f64], &[f64])| {
        let n = series.time_s.partition_point(|&t| t <= window);
        Some(((last_finite(&run[..n.min(run.len())])? - last_finite(r)?) / span(r)).abs())
    };
    let worst = (gears.iter())
        .filter(|(_, r)| span(r) > HELD * largest)
        .map(last)
        .try_fold(0.0_f64, |worst, x| Some(worst.max(x?)))?;
    (reached && largest > 0.0).then_some(worst).and_then(finite)
}

/// Times that both sides must have recorded before others are left out.
const COMMON: usize = 3;

/// Computes the error of the transmission error of a mesh (see the head of the module); `None` where a side has no such
/// column. It is evaluated at the times that both recorded, where neither is interpolated; where these are too few, at
/// those of the reference.
fn transmission_error(
    series: &TimeSeries,
    reference: &TimeSeries,
    mesh: &str,
    window: f64,
) -> Option<f64> {
    fn column<'s>(s: &'s TimeSeries, mesh: &str) -> Option<&'s [f64]> {
        let found = s.of(TRANSMISSION_ERROR, mesh)?;
        (found.len() == s.time_s.len() && s.time_s.len() > 1).then_some(found)
    }
    let (own, wanted) = (column(series, mesh)?, column(reference, mesh)?);
    let n = reference.finite_len();
    let force = samples_of(reference, mesh);
    let peak = Force::until(&force_of(reference, mesh), window).peak().0;
    // Without a force the times of contact are not known, and all times count.
    let acts = |&i: &usize| force.get(i).is_none_or(|f| *f > CONTACT_THRESHOLD * peak);
    let mut common: Vec<usize> = Vec::new();
    let mut next = 0;
    for (i, t) in reference.time_s[..n].iter().enumerate() {
        while series.time_s.get(next).is_some_and(|own| own < t) {
            next += 1;
        }
        if series.time_s.get(next) == Some(t) {
            common.push(i);
        }
    }
    if common.iter().filter(|i| acts(i)).count() < COMMON {
        common = (0..n).collect();
    }
    let times: Vec<f64> = common.iter().map(|&i| reference.time_s[i]).collect();
    let mut found = Vec::with_capacity(times.len());
    resample(&series.time_s, own, &times, 0.0, &mut found);
    let (mut missed, mut norm) = (0.0, 0.0);
    let weights = trapezoid_weights(&times);
    for ((i, w), e) in common
        .iter()
        .zip(weights)
        .zip(found)
        .filter(|((i, _), _)| acts(i))
    {
        missed += w * (e - wanted[*i]).powi(2);
        norm += w * wanted[*i] * wanted[*i];
    }
    finite((missed / norm).sqrt())
}

#[cfg(test)]
mod tests;
