//! Accuracy that the choice must reach: a metric and its largest relative error.
//!
//! Metrics are the relative errors of [`gearbench_reports::metrics`]. Only the energy metric differs: it is the error
//! of the energy dissipated by damping and friction, over the initial energy and the external work of the reference,
//! since all models have an energy balance.

use gearbench_reports::Metric;
use gearbench_reports::metrics::{FinishedRun, compare};
use gearbench_reports::record::Ledger;
use gearbench_reports::series::TimeSeries;

/// Metric and its largest relative error that counts as accurate enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Requirement {
    /// Metric whose error is limited.
    pub metric: Metric,
    /// Largest relative error that is permitted [-].
    pub tolerance: f64,
}

impl Requirement {
    /// Returns the name of the metric on the command line.
    pub fn name(&self) -> &'static str {
        self.metric.option().unwrap_or_default()
    }

    /// Returns the name of the metric in words.
    pub fn title(&self) -> &'static str {
        match self.metric {
            Metric::ForceL2 => "force history",
            Metric::ForceL2Aligned => "force history, aligned in time",
            Metric::PeakForceRel => "peak force",
            Metric::ImpulseRel => "impulse",
            Metric::Rebound => "rebound speeds",
            Metric::TransmissionError => "transmission error",
            Metric::EnergyDrift => "energy lost",
            other => other.words(),
        }
    }
}

/// True if the metric compares a single number of each run, whose errors may cancel by chance; the others compare whole
/// histories.
pub fn is_scalar(metric: Metric) -> bool {
    matches!(
        metric,
        Metric::PeakForceRel | Metric::ImpulseRel | Metric::Rebound | Metric::EnergyDrift
    )
}

/// Computes the absolute value of the error of a run against a reference; `None` where one of them lacks the quantity.
pub fn error(
    metric: Metric,
    run: FinishedRun<'_>,
    (reference, its_ledger): (&TimeSeries, &Ledger),
) -> Option<f64> {
    if metric != Metric::EnergyDrift {
        return compare(run, reference, "top").get(metric).map(f64::abs);
    }
    let all = its_ledger.energy_start_j?.abs() + its_ledger.external_work_j?.abs();
    let e = (run.ledger().dissipated_j? - its_ledger.dissipated_j?).abs() / all;
    e.is_finite().then_some(e)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_lost_is_over_all_energy() {
        let ledger = |dissipated| Ledger {
            energy_start_j: Some(3.0),
            external_work_j: Some(-1.0),
            dissipated_j: Some(dissipated),
            ..Ledger::default()
        };
        let mut none = TimeSeries::default();
        none.push(0.0, &[]);
        let error = |own: &Ledger| {
            let run = FinishedRun::reached(&none, own, [0.0, 0.0]).unwrap();
            error(Metric::EnergyDrift, run, (&none, &ledger(0.7)))
        };
        assert!((error(&ledger(0.5)).unwrap() - 0.05).abs() < 1e-12);
        assert_eq!(error(&Ledger::default()), None);
    }
}
