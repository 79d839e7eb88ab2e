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
//! mesh with the largest aligned error. Peak, impulse, root mean square, duration and peak to peak are likewise those of the mesh
//! for which they are largest, the duration over meshes that bear at least 1e-3 of the force of the most loaded one. Forces of
//! all meshes are in [`MeshForce`](crate::record::MeshForce), and [`Metrics::meshes`] has the mesh of each value. The rebound
//! error is the largest over all gears whose speeds both sides have. Errors of the transmission error are the largest over all
//! meshes likewise, with f_r the force of the mesh, those of peak to peak and of orders over meshes whose reference has at least
//! 1e-3 of the largest peak to peak; amplitudes themselves are those of the mesh with the largest peak to peak that passes a
//! whole cycle. A metric whose quantity the reference lacks is absent; without a force the transmission error is compared at all
//! its times. T is the duration of the reference. Angles and torques are compared with external references only (`columns.rs`).
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

pub use metric::{Metric, Metrics};

use crate::record::{Ledger, finite};
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

/// Contact force of a mesh of a run up to the end of a comparison, with its peak \[N\], impulse [N s] and root mean square
/// \[N\].
struct ForceOfMesh<'s> {
    mesh: &'s str,
    force: Force<'s>,
    peak: f64,
    impulse: f64,
    rms: f64,
}

/// Compares a run with a reference; `against` is the id of that reference.
///
/// A quantity that the data cannot give is `None`; broken data never panic. The energy drift comes
/// from the run's ledger.
pub fn compare(run: FinishedRun<'_>, reference: &TimeSeries, against: &str) -> Metrics {
    let FinishedRun { series, ledger } = run;
    let meshes: Vec<&str> = series.all_of(CONTACT_FORCE).map(|(mesh, _)| mesh).collect();
    // A run cannot be compared after the end of its reference.
    let ends = (meshes
        .iter()
        .filter(|mesh| !samples_of(reference, mesh).is_empty()))
    .map(|mesh| Target::of(reference, mesh).end());
    let window = ends.reduce(f64::min).unwrap_or_else(|| {
        let last = reference.time_s.last().copied();
        last.unwrap_or(f64::INFINITY)
    });
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
    let lasts = window.min(series.time_s[known - 1]) - series.time_s[0];
    let histories: Vec<_> = (meshes.iter())
        .map(|mesh| (*mesh, force_of(series, mesh)))
        .collect();
    let forces: Vec<ForceOfMesh<'_>> = (histories.iter())
        .map(|(mesh, history)| {
            let force = Force::until(history, window);
            ForceOfMesh {
                mesh,
                peak: force.peak().0,
                impulse: force.impulse(),
                rms: (force.square() / lasts).sqrt(),
                force,
            }
        })
        .collect();
    let most = forces.iter().map(|f| f.rms).fold(0.0, f64::max);
    for f in &forces {
        metrics.keep_larger(Metric::PeakForce, f.mesh, f.peak);
        metrics.keep_larger(Metric::Impulse, f.mesh, f.impulse);
        metrics.keep_larger(Metric::RmsForce, f.mesh, f.rms);
        if f.rms >= BORNE * most {
            let lasts = f.force.time_above(CONTACT_THRESHOLD * f.peak);
            metrics.keep_larger(Metric::Duration, f.mesh, lasts);
        }
    }
    let mut spans = spans_until(series, window);
    for (mesh, span) in &spans {
        metrics.keep_larger(Metric::TransmissionErrorSpan, mesh, *span);
    }
    spans.sort_by(|a, b| b.1.total_cmp(&a.1));
    let orders = spans.iter().find_map(|(mesh, _)| {
        let own = CycleHistory::of_run(series, mesh)?;
        let whole = CycleHistory::whole([&own])?;
        Some(own.amplitudes(whole, orders::KEPT))
    });
    metrics.transmission_error_orders_m = orders.unwrap_or_default();
    if reference.len() >= 2 {
        let all = ErrorsOver {
            series,
            reference,
            window,
        };
        all.of_transmission_errors(&mut metrics, &spans);
        all.of_motions(&mut metrics);
        all.of_forces(&mut metrics, &forces, lasts);
    }
    if meshes.len() < 2 {
        metrics.meshes.clear();
    }
    metrics
}

/// Least force of a mesh, over that of the most loaded one, at which its errors count (root mean squares); likewise the
/// peak to peak of its transmission error.
const BORNE: f64 = 1e-3;

/// Errors of the histories of a run against a reference up to a time (see the head of the module).
struct ErrorsOver<'s> {
    series: &'s TimeSeries,
    reference: &'s TimeSeries,
    /// End of the comparison \[s\].
    window: f64,
}

impl ErrorsOver<'_> {
    /// Adds the errors of the transmission errors; `spans` are the peaks to peaks of the run by mesh \[m\].
    fn of_transmission_errors(&self, metrics: &mut Metrics, spans: &[(&str, f64)]) {
        let (series, reference) = (self.series, self.reference);
        let wanted = spans_until(reference, self.window);
        let most = wanted.iter().map(|s| s.1).fold(0.0, f64::max);
        for (mesh, wanted) in wanted.into_iter().filter(|s| s.1 >= BORNE * most) {
            let Some((_, own)) = spans.iter().find(|(own, _)| *own == mesh) else {
                continue;
            };
            let error = deviation(*own, wanted);
            metrics.keep_larger(Metric::TransmissionErrorSpanRel, mesh, error);
            if let Some(own) = CycleHistory::of_run(series, mesh)
                && let Some(wanted) = CycleHistory::of_reference(reference, series, mesh)
                && let Some(errors) = orders::errors(&own, &wanted)
            {
                metrics.keep_larger(Metric::TransmissionErrorOrders, mesh, errors.amplitudes);
                metrics.keep_larger(Metric::TransmissionErrorAligned, mesh, errors.aligned);
            }
        }
        for (mesh, _) in reference.all_of(TRANSMISSION_ERROR) {
            if let Some(error) = transmission_error(series, reference, mesh, self.window) {
                metrics.keep_larger(Metric::TransmissionError, mesh, error);
            }
        }
    }

    /// Adds the errors of speeds, angles and torques.
    fn of_motions(&self, metrics: &mut Metrics) {
        let (series, reference) = (self.series, self.reference);
        metrics.rebound_rel = rebound(series, reference, self.window);
        if reference.forces.is_empty() {
            metrics.angle_l2 = columns::worst(series, reference, columns::is_angle);
            metrics.speed_l2 = columns::worst(series, reference, columns::is_speed);
            metrics.torque_l2 = columns::worst(series, reference, columns::is_torque);
            metrics.torque_peak_rel = columns::peak(series, reference, columns::is_torque);
        }
    }

    /// Adds the errors of the contact forces; `lasts` is the duration of the comparison \[s\].
    fn of_forces(&self, metrics: &mut Metrics, forces: &[ForceOfMesh<'_>], lasts: f64) {
        let (reference, window) = (self.reference, self.window);
        let compared: Vec<_> = (forces.iter())
            .filter(|own| !samples_of(reference, own.mesh).is_empty())
            .map(|own| (own, force_of(reference, own.mesh)))
            .collect();
        let compared: Vec<_> = (compared.iter())
            .map(|(own, wanted)| {
                let wanted = Force::until(wanted, window);
                (own, (wanted.square() / lasts).sqrt(), wanted)
            })
            .collect();
        let most = compared.iter().map(|f| f.1).fold(0.0, f64::max);
        for (own, bears, wanted) in &compared {
            if *bears < BORNE * most {
                continue;
            }
            let mesh = own.mesh;
            let target = Target::of(reference, mesh);
            let peaks = deviation(own.peak, wanted.peak().0);
            metrics.keep_larger(Metric::PeakForceRel, mesh, peaks);
            let impulses = deviation(own.impulse, wanted.impulse());
            metrics.keep_larger(Metric::ImpulseRel, mesh, impulses);
            metrics.keep_larger(Metric::RmsForceRel, mesh, deviation(own.rms, *bears));
            let distance = target.distance(&own.force, 0.0);
            metrics.keep_larger(Metric::ForceL1, mesh, distance.l1);
            metrics.keep_larger(Metric::ForceL2, mesh, distance.l2);
            if distance.l2.is_finite() {
                let (shift, aligned) = target.best_shift(&own.force);
                if metrics.keep_larger(Metric::ForceL2Aligned, mesh, aligned) {
                    metrics.time_shift_s = finite(shift);
                }
            }
        }
    }
}

/// Metrics of histories that a reference may have on further axes of time.
const OF_FURTHER_HISTORIES: [Metric; 9] = [
    Metric::Rebound,
    Metric::TransmissionError,
    Metric::TransmissionErrorSpanRel,
    Metric::TransmissionErrorOrders,
    Metric::TransmissionErrorAligned,
    Metric::Angle,
    Metric::Speed,
    Metric::Torque,
    Metric::TorquePeakRel,
];

/// Compares a run with a reference whose histories have several axes of time, the contact force on the first: each metric
/// is that of the histories it is about, the worst where several are.
pub fn compare_all(run: FinishedRun<'_>, all: &[&TimeSeries], against: &str) -> Metrics {
    let mut all = all.iter().map(|series| compare(run, series, against));
    let mut whole = all.next().unwrap_or_else(|| Metrics {
        against: against.to_owned(),
        ..Metrics::default()
    });
    for more in all {
        for metric in OF_FURTHER_HISTORIES {
            if let Some(error) = more.get(metric) {
                let mesh = more.meshes.get(metric.key());
                whole.keep_larger(metric, mesh.map_or("", String::as_str), error);
            }
        }
    }
    whole.meshes.retain(|_, mesh| !mesh.is_empty());
    whole
}

/// Computes the deviation of a value over that of a reference; zero agrees with zero.
fn deviation(value: f64, reference: f64) -> f64 {
    match (value, reference) {
        (0.0, 0.0) => 0.0,
        (value, reference) => value / reference - 1.0,
    }
}

/// Computes the peak to peak of the transmission error of each mesh up to a time \[m\].
fn spans_until(series: &TimeSeries, until: f64) -> Vec<(&str, f64)> {
    let known = series.time_s.partition_point(|&t| t <= until);
    let span = |(mesh, history): (_, &[f64])| {
        let values = history.iter().take(known).filter(|x| x.is_finite());
        let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(*x), b.max(*x))
        });
        Some((mesh, finite(most - least)?))
    };
    series.all_of(TRANSMISSION_ERROR).filter_map(span).collect()
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
