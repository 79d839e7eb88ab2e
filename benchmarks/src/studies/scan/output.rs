//! Quantities of a run that a scan records.

use gearbench_reports::Metric;
use gearbench_reports::record::{Run, TorquePaths};

/// A quantity of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// A metric: a quantity of the run itself, or an error against the model of `--against`.
    Metric(Metric),
    /// Power taken out over power put in by loads and drives, means over the second half of a settled run.
    Efficiency,
    /// Number of accepted steps.
    Steps,
}

/// Quantities that are no metrics, with their keys.
const OTHERS: [(Output, &str); 2] = [(Output::Efficiency, "efficiency"), (Output::Steps, "steps")];

impl Output {
    /// Default quantities of a scan.
    pub const DEFAULTS: [Output; 4] = [
        Output::Metric(Metric::PeakForce),
        Output::Metric(Metric::RmsForce),
        Output::Metric(Metric::Impulse),
        Output::Metric(Metric::TransmissionErrorSpan),
    ];

    /// Default errors, with `--against`.
    pub const ERRORS: [Output; 3] = [
        Output::Metric(Metric::ForceL2Aligned),
        Output::Metric(Metric::PeakForceRel),
        Output::Metric(Metric::ImpulseRel),
    ];

    /// The key in tables and records.
    pub fn key(self) -> &'static str {
        match self {
            Output::Metric(metric) => metric.key(),
            other => OTHERS.iter().find(|o| o.0 == other).map_or("", |o| o.1),
        }
    }

    /// True if the quantity is an error against another run.
    pub fn is_error(self) -> bool {
        matches!(self, Output::Metric(m) if m.is_error() && m != Metric::EnergyDrift)
            || self == Output::Metric(Metric::TimeShift)
    }

    /// The value of a run, whose metrics are the first ones; `None` where the run has none.
    pub fn of(self, run: &Run) -> Option<f64> {
        match self {
            Output::Metric(metric) => run.metrics.first()?.get(metric),
            Output::Efficiency => (run.paths.as_ref())
                .filter(|p| p.has_settled())
                .and_then(TorquePaths::efficiency),
            Output::Steps => Some(run.steps as f64),
        }
    }
}

impl std::str::FromStr for Output {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if let Some((other, _)) = OTHERS.iter().find(|o| o.1 == text) {
            return Ok(*other);
        }
        text.parse().map(Output::Metric).map_err(|_| {
            let metrics = Metric::ALL.into_iter().filter(|m| !m.is_of_measurements());
            let keys: Vec<&str> = metrics
                .map(Metric::key)
                .chain(OTHERS.map(|o| o.1))
                .collect();
            format!(
                "there is no quantity `{text}`; there are {}",
                keys.join(", ")
            )
        })
    }
}
