//! The metrics there are, with what is said of them: the only place that knows their names.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A metric of a run against a reference; definitions in [`crate::metrics`].
///
/// An error is worse the larger its magnitude; quantities have no better and worse by themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Metric {
    /// Relative L2 error of the force history.
    ForceL2,
    /// The same after the best shift in time.
    #[default]
    ForceL2Aligned,
    /// That shift.
    TimeShift,
    /// Peak of the contact force.
    PeakForce,
    /// Its deviation, over the reference.
    PeakForceRel,
    /// Impulse of the contact force.
    Impulse,
    /// Its deviation, over the reference.
    ImpulseRel,
    /// Time in contact.
    Duration,
    /// Last angular velocity of gear 1.
    Omega1End,
    /// Last angular velocity of gear 2.
    Omega2End,
    /// Largest deviation of a last speed, over the span of that speed.
    Rebound,
    /// Relative L2 error of the transmission error.
    TransmissionError,
    /// Residual of the energy ledger over its largest entry.
    EnergyDrift,
}

impl Metric {
    /// All, in the order of the record.
    pub const ALL: [Self; 13] = [
        Self::ForceL2,
        Self::ForceL2Aligned,
        Self::TimeShift,
        Self::PeakForce,
        Self::PeakForceRel,
        Self::Impulse,
        Self::ImpulseRel,
        Self::Duration,
        Self::Omega1End,
        Self::Omega2End,
        Self::Rebound,
        Self::TransmissionError,
        Self::EnergyDrift,
    ];

    /// Key in records, tables and scene files.
    pub fn key(self) -> &'static str {
        match self {
            Self::ForceL2 => "force_l2",
            Self::ForceL2Aligned => "force_l2_aligned",
            Self::TimeShift => "time_shift_s",
            Self::PeakForce => "peak_force_n",
            Self::PeakForceRel => "peak_force_rel",
            Self::Impulse => "impulse_ns",
            Self::ImpulseRel => "impulse_rel",
            Self::Duration => "duration_s",
            Self::Omega1End => "omega1_end",
            Self::Omega2End => "omega2_end",
            Self::Rebound => "rebound_rel",
            Self::TransmissionError => "transmission_error_l2",
            Self::EnergyDrift => "energy_drift_rel",
        }
    }

    /// Name on the command line; only relative errors have one.
    pub fn option(self) -> Option<&'static str> {
        Some(match self {
            Self::ForceL2 => "force",
            Self::ForceL2Aligned => "force-aligned",
            Self::PeakForceRel => "peak",
            Self::ImpulseRel => "impulse",
            Self::Rebound => "rebound",
            Self::TransmissionError => "transmission-error",
            Self::EnergyDrift => "energy",
            _ => return None,
        })
    }

    /// In prose.
    pub fn words(self) -> &'static str {
        match self {
            Self::ForceL2 => "force-history error",
            Self::ForceL2Aligned => "time-aligned force-history error",
            Self::TimeShift => "shift in time",
            Self::PeakForce => "peak force",
            Self::PeakForceRel => "peak-force error",
            Self::Impulse => "impulse",
            Self::ImpulseRel => "impulse error",
            Self::Duration => "contact duration",
            Self::Omega1End => "last speed of gear 1",
            Self::Omega2End => "last speed of gear 2",
            Self::Rebound => "rebound error",
            Self::TransmissionError => "transmission-error error",
            Self::EnergyDrift => "energy drift",
        }
    }

    /// SI unit; empty for ratios, which pages show in per cent.
    pub fn unit(self) -> &'static str {
        match self {
            Self::TimeShift | Self::Duration => "s",
            Self::PeakForce => "N",
            Self::Impulse => "N s",
            Self::Omega1End | Self::Omega2End => "rad/s",
            _ => "",
        }
    }

    /// Whether it is a relative error: the larger its magnitude, the worse.
    pub fn is_error(self) -> bool {
        self.option().is_some()
    }

    /// What an axis of it is called.
    pub fn axis(self) -> String {
        match self.unit() {
            "" => format!("{} [%]", self.words()),
            unit => format!("{} [{unit}]", self.words()),
        }
    }
}

impl std::fmt::Display for Metric {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.key())
    }
}

impl std::str::FromStr for Metric {
    type Err = String;

    /// A metric by its key, or by its name on the command line.
    fn from_str(text: &str) -> Result<Self, String> {
        let named = |m: &Self| m.key() == text || m.option() == Some(text);
        Self::ALL.into_iter().find(named).ok_or_else(|| {
            let keys = Self::ALL.map(Self::key).join(", ");
            format!("there is no metric `{text}`; there are {keys}")
        })
    }
}

impl Serialize for Metric {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

impl<'de> Deserialize<'de> for Metric {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keys are the fields of the record, in its order; keys and names lead back to their metric.
    #[test]
    fn keys_are_the_fields_of_the_record() {
        use crate::record::Metrics;
        let mut text = String::new();
        for (i, m) in Metric::ALL.into_iter().enumerate() {
            text.push_str(&format!("\"{}\":{},", m.key(), i + 1));
        }
        let json = format!("{{{text}\"against\":\"self\"}}");
        let metrics: Metrics = serde_json::from_str(&json).unwrap();
        for (i, m) in Metric::ALL.into_iter().enumerate() {
            assert_eq!(metrics.get(m), Some((i + 1) as f64), "{m}");
            assert_eq!(m.key().parse(), Ok(m));
            assert!(m.option().is_none_or(|o| o.parse() == Ok(m)));
        }
        let keys: serde_json::Value = serde_json::to_value(&metrics).unwrap();
        assert_eq!(
            keys.as_object().map(|o| o.len()),
            Some(Metric::ALL.len() + 1)
        );
        assert!("speed".parse::<Metric>().unwrap_err().contains("force_l2"));
    }
}
