//! What is asked for: a metric and how large an error in it may be.

use gearbench_reports::metrics::{Finished, compare};
use gearbench_reports::record::Ledger;
use gearbench_reports::series::TimeSeries;

/// What of a run has to be right; definitions in [`gearbench_reports::metrics`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// History of the contact force, relative L2.
    Force,
    /// The same after the best shift in time.
    ForceAligned,
    /// Peak of the contact force.
    Peak,
    /// Impulse of the contact force.
    Impulse,
    /// Speeds at the end, over their span.
    Rebound,
    /// Transmission error while teeth touch, relative L2.
    TransmissionError,
    /// Energy that damping and friction take, over all the energy that the reference has or is given.
    Energy,
}

impl Metric {
    /// All, in the order of help texts.
    pub const ALL: [Metric; 7] = [
        Metric::Force,
        Metric::ForceAligned,
        Metric::Peak,
        Metric::Impulse,
        Metric::Rebound,
        Metric::TransmissionError,
        Metric::Energy,
    ];

    /// Name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Metric::Force => "force",
            Metric::ForceAligned => "force-aligned",
            Metric::Peak => "peak",
            Metric::Impulse => "impulse",
            Metric::Rebound => "rebound",
            Metric::TransmissionError => "transmission-error",
            Metric::Energy => "energy",
        }
    }

    /// In words.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Metric::Force => "force history",
            Metric::ForceAligned => "force history, aligned in time",
            Metric::Peak => "peak force",
            Metric::Impulse => "impulse",
            Metric::Rebound => "rebound speeds",
            Metric::TransmissionError => "transmission error",
            Metric::Energy => "energy lost",
        }
    }

    /// Metric by its name on the command line.
    #[must_use]
    pub fn named(name: &str) -> Option<Metric> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }

    /// Key of the metric in `results.json`; none for the energy, which is a difference of ledgers.
    #[must_use]
    pub fn key(self) -> Option<gearbench_reports::Metric> {
        let named = self.name().parse().ok();
        named.filter(|_| self != Metric::Energy)
    }

    /// A single number of each run, whose errors may cancel by chance; the others compare whole histories.
    #[must_use]
    pub fn is_scalar(self) -> bool {
        matches!(
            self,
            Metric::Peak | Metric::Impulse | Metric::Rebound | Metric::Energy
        )
    }

    /// Error of a run against a reference, not negative; `None` where one of them does not have the quantity.
    #[must_use]
    pub fn error(
        self,
        run: Finished<'_>,
        (reference, its_ledger): (&TimeSeries, &Ledger),
    ) -> Option<f64> {
        if let Some(key) = self.key() {
            return compare(run, reference, "top").get(key).map(f64::abs);
        }
        let all = its_ledger.energy_start_j?.abs() + its_ledger.external_work_j?.abs();
        let e = (run.ledger().dissipated_j? - its_ledger.dissipated_j?).abs() / all;
        e.is_finite().then_some(e)
    }
}

impl std::fmt::Display for Metric {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// A metric and the largest error in it that is accurate enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Requirement {
    /// What has to be right.
    pub metric: Metric,
    /// How far it may be off, relative [-].
    pub tolerance: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back() {
        for m in Metric::ALL {
            assert_eq!(Metric::named(m.name()), Some(m));
            assert_eq!(m.key().is_none(), m == Metric::Energy);
        }
        assert_eq!(Metric::named("speed"), None);
    }

    #[test]
    fn energy_lost_is_over_all_energy() {
        let ledger = |dissipated| Ledger {
            energy_start_j: Some(3.0),
            external_work_j: Some(-1.0),
            dissipated_j: Some(dissipated),
            ..Ledger::default()
        };
        let mut none = TimeSeries::default();
        none.push(0.0, 0.0, 0.0, 0.0);
        let error = |own: &Ledger| {
            let run = Finished::reached(&none, own, [0.0, 0.0]).unwrap();
            Metric::Energy.error(run, (&none, &ledger(0.7)))
        };
        assert!((error(&ledger(0.5)).unwrap() - 0.05).abs() < 1e-12);
        assert_eq!(error(&Ledger::default()), None);
    }
}
