//! Quantities that a check evaluates for each run and compares with the baseline.

use gearbench_reports::Metric;
use gearbench_reports::metrics::{compare, compare_all};
use gearbench_reports::record::{ReferenceSeries, Run, SELF, speed_end};
use gearbench_reports::series::{self, CONTACT_FORCE, TRANSMISSION_ERROR, TimeSeries};
use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

/// Quantity of a run that a check compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// A metric; errors are against every reference of the scene.
    Metric(Metric),
    /// Last speeds of all gears [rad/s].
    SpeedsEnd,
    /// Root mean square of the contact force over the samples of the history, of the mesh where it is largest [N].
    ForceRms,
    /// Root mean square of the transmission error, likewise [m].
    TransmissionErrorRms,
}

const SPEEDS_END: &str = "speeds_end";
/// Names of the last speeds of the first two gears in check files and baselines of former versions.
pub(super) const FORMER_SPEEDS: [&str; 2] = ["omega1_end", "omega2_end"];
const FORCE_RMS: &str = "force_rms_n";
const TRANSMISSION_ERROR_RMS: &str = "transmission_error_rms_m";

/// Quantities that a check evaluates by default.
pub(crate) const USUAL: [Quantity; 7] = [
    Quantity::Metric(Metric::PeakForce),
    Quantity::Metric(Metric::Impulse),
    Quantity::SpeedsEnd,
    Quantity::Metric(Metric::EnergyDrift),
    Quantity::Metric(Metric::ForceL2Aligned),
    Quantity::ForceRms,
    Quantity::TransmissionErrorRms,
];

impl Quantity {
    /// Returns all quantities that a check can evaluate.
    pub(crate) fn all() -> impl Iterator<Item = Quantity> {
        let own = [
            Quantity::SpeedsEnd,
            Quantity::ForceRms,
            Quantity::TransmissionErrorRms,
        ];
        Metric::ALL.into_iter().map(Quantity::Metric).chain(own)
    }

    /// Returns the key of the quantity, without the reference.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Quantity::Metric(m) => m.key(),
            Quantity::SpeedsEnd => SPEEDS_END,
            Quantity::ForceRms => FORCE_RMS,
            Quantity::TransmissionErrorRms => TRANSMISSION_ERROR_RMS,
        }
    }

    /// Returns the quantity of a key in a baseline, for example `force_l2` for `force_l2@calculix`, and `speeds_end` for
    /// `speed_end_pinion_rad_s`.
    pub(crate) fn of_key(key: &str) -> Option<Quantity> {
        let key = key.split_once('@').map_or(key, |(key, _)| key);
        if key.starts_with("speed_end_") {
            return Some(Quantity::SpeedsEnd);
        }
        Self::all().find(|q| q.key() == key)
    }

    /// True if the quantity needs a reference: errors do; the drift of a run's own energy does not.
    fn needs_reference(self) -> bool {
        match self {
            Quantity::Metric(Metric::EnergyDrift) => false,
            Quantity::Metric(Metric::TimeShift) => true,
            Quantity::Metric(m) => m.is_error(),
            _ => false,
        }
    }

    /// True if the quantity is a relative error: it may be almost zero, so that a relative tolerance alone is
    /// meaningless.
    pub(crate) fn is_ratio(self) -> bool {
        matches!(self, Quantity::Metric(m) if m.is_error())
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key())
    }
}

impl FromStr for Quantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Ok(metric) = text.parse() {
            return Ok(Quantity::Metric(metric));
        }
        if FORMER_SPEEDS.contains(&text) {
            return Ok(Quantity::SpeedsEnd);
        }
        Self::all().find(|q| q.key() == text).ok_or_else(|| {
            let keys: Vec<&str> = Self::all().map(Self::key).collect();
            format!(
                "there is no quantity `{text}`; there are {}",
                keys.join(", ")
            )
        })
    }
}

/// Computes the quantities of a run by key; the result is empty if the run did not reach its end.
pub(super) fn values(
    run: &Run,
    wanted: &[Quantity],
    references: &[ReferenceSeries],
) -> BTreeMap<String, f64> {
    let mut found = BTreeMap::new();
    let (Ok(finished), Some(series)) = (run.finished(), &run.series) else {
        return found;
    };
    let own = compare(finished, series, SELF);
    let against: Vec<_> = (references.iter())
        .map(|r| (r, compare_all(finished, &r.all_series(), &r.id)))
        .collect();
    for quantity in wanted {
        let key = quantity.key();
        match quantity {
            Quantity::Metric(m) if quantity.needs_reference() => {
                let errors = against.iter().map(|(r, of)| (r, of.get(*m)));
                found.extend(errors.filter_map(|(r, x)| Some((format!("{key}@{}", r.id), x?))));
            }
            Quantity::Metric(m) => found.extend(own.get(*m).map(|x| (key.to_owned(), x))),
            Quantity::SpeedsEnd => {
                let speeds = own.speeds_end.iter();
                found.extend(speeds.map(|(gear, x)| (speed_end(gear), *x)));
            }
            Quantity::ForceRms => {
                let rms = largest_rms(series, CONTACT_FORCE);
                found.extend(rms.map(|x| (key.to_owned(), x)));
            }
            Quantity::TransmissionErrorRms => {
                let rms = largest_rms(series, TRANSMISSION_ERROR);
                found.extend(rms.map(|x| (key.to_owned(), x)));
            }
        }
    }
    found.retain(|_, x| x.is_finite());
    found
}

/// Returns the root mean square of a quantity of the mesh for which it is largest.
fn largest_rms(series: &TimeSeries, quantity: series::Quantity) -> Option<f64> {
    let all = series.all_of(quantity);
    all.filter_map(|(_, values)| root_mean_square(values))
        .reduce(f64::max)
}

fn root_mean_square(values: &[f64]) -> Option<f64> {
    let finite = || values.iter().filter(|x| x.is_finite());
    let n = finite().count();
    (n > 0).then(|| (finite().map(|x| x * x).sum::<f64>() / n as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_lead_back() {
        for q in Quantity::all() {
            assert_eq!(q.key().parse(), Ok(q));
            assert_eq!(Quantity::of_key(&format!("{q}@calculix")), Some(q));
        }
        assert!("peak".parse::<Quantity>().is_ok());
        let of_gear = Quantity::of_key("speed_end_pinion_rad_s");
        assert_eq!(of_gear, Some(Quantity::SpeedsEnd));
        assert_eq!("omega2_end".parse(), Ok(Quantity::SpeedsEnd));
        let e = "velocity".parse::<Quantity>().unwrap_err();
        assert!(
            e.contains("force_rms_n") && e.contains("peak_force_n"),
            "{e}"
        );
    }
}
