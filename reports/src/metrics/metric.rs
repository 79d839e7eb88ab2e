//! The list of metrics with their keys, names and units; no other module names them.

use crate::words::words;

words! {
    /// A metric of a run against a reference by its key in records, tables and scene files; definitions in
    /// [`crate::metrics`].
    ///
    /// An error is worse the larger its magnitude; quantities have no better and worse by themselves.
    #[derive(PartialOrd, Ord)]
    pub enum Metric {
        /// Relative L1 error of the force history: the share of the impulse that acts at another time.
        #[serde(alias = "force-l1")]
        ForceL1 = "force_l1",
        /// Relative L2 error of the force history.
        #[serde(alias = "force")]
        ForceL2 = "force_l2",
        /// Relative L2 error of the force history after the time shift that minimises it.
        #[default]
        #[serde(alias = "force-aligned")]
        ForceL2Aligned = "force_l2_aligned",
        /// Time shift \[s\] that minimises the relative L2 error of the force history.
        TimeShift = "time_shift_s",
        /// Peak of the contact force.
        PeakForce = "peak_force_n",
        /// Deviation of the peak of the contact force from the reference, over the reference.
        #[serde(alias = "peak")]
        PeakForceRel = "peak_force_rel",
        /// Root mean square of the contact force over the time of the run.
        RmsForce = "rms_force_n",
        /// Deviation of the root mean square of the contact force from the reference, over the reference.
        #[serde(alias = "rms")]
        RmsForceRel = "rms_force_rel",
        /// Impulse of the contact force.
        Impulse = "impulse_ns",
        /// Deviation of the impulse from the reference, over the reference.
        #[serde(alias = "impulse")]
        ImpulseRel = "impulse_rel",
        /// Time in contact \[s\].
        Duration = "duration_s",
        /// Largest deviation of a last speed of a gear, over the span of that speed.
        #[serde(alias = "rebound")]
        Rebound = "rebound_rel",
        /// Relative L2 error of the transmission error.
        #[serde(alias = "transmission-error")]
        TransmissionError = "transmission_error_l2",
        /// Peak to peak of the transmission error.
        TransmissionErrorSpan = "transmission_error_pp_m",
        /// Deviation of the peak to peak of the transmission error from the reference, over the reference.
        #[serde(alias = "transmission-error-pp")]
        TransmissionErrorSpanRel = "transmission_error_pp_rel",
        /// Error of the amplitudes of the transmission error by orders of the mesh cycle.
        #[serde(alias = "transmission-error-orders")]
        TransmissionErrorOrders = "transmission_error_orders_rel",
        /// Relative L2 error of the part of the transmission error that repeats with the mesh cycle, after the best shift.
        #[serde(alias = "transmission-error-aligned")]
        TransmissionErrorAligned = "transmission_error_l2_aligned",
        /// Largest error of an angle, over the span of that angle.
        #[serde(alias = "angle")]
        Angle = "angle_l2",
        /// Largest error of a speed over time, over the span of that speed.
        #[serde(alias = "speed")]
        Speed = "speed_l2",
        /// Largest error of a torque, over the span of that torque.
        #[serde(alias = "torque")]
        Torque = "torque_l2",
        /// Largest deviation of the peak of a torque, over the reference.
        #[serde(alias = "torque-peak")]
        TorquePeakRel = "torque_peak_rel",
        /// Residual of the energy ledger over its largest entry.
        #[serde(alias = "energy")]
        EnergyDrift = "energy_drift_rel",
    }
}

impl Metric {
    /// Returns the key in records, tables and scene files.
    pub fn key(self) -> &'static str {
        self.as_str()
    }

    /// Returns name in prose, SI unit (empty for ratios) and name on the command line.
    fn facts(self) -> (&'static str, &'static str, Option<&'static str>) {
        match self {
            Self::ForceL1 => (
                "relative L1 error of the contact force",
                "",
                Some("force-l1"),
            ),
            Self::ForceL2 => ("force-history error", "", Some("force")),
            Self::ForceL2Aligned => (
                "time-aligned force-history error",
                "",
                Some("force-aligned"),
            ),
            Self::TimeShift => ("shift in time", "s", None),
            Self::PeakForce => ("peak force", "N", None),
            Self::PeakForceRel => ("peak-force error", "", Some("peak")),
            Self::RmsForce => ("rms force", "N", None),
            Self::RmsForceRel => ("rms-force error", "", Some("rms")),
            Self::Impulse => ("impulse", "N s", None),
            Self::ImpulseRel => ("impulse error", "", Some("impulse")),
            Self::Duration => ("contact duration", "s", None),
            Self::Rebound => ("rebound error", "", Some("rebound")),
            Self::TransmissionError => ("transmission-error error", "", Some("transmission-error")),
            Self::TransmissionErrorSpan => ("peak-to-peak transmission error", "m", None),
            Self::TransmissionErrorSpanRel => (
                "peak-to-peak-transmission-error error",
                "",
                Some("transmission-error-pp"),
            ),
            Self::TransmissionErrorOrders => (
                "transmission-error-orders error",
                "",
                Some("transmission-error-orders"),
            ),
            Self::TransmissionErrorAligned => (
                "aligned-transmission-error error",
                "",
                Some("transmission-error-aligned"),
            ),
            Self::Angle => ("angle error", "", Some("angle")),
            Self::Speed => ("speed error", "", Some("speed")),
            Self::Torque => ("torque error", "", Some("torque")),
            Self::TorquePeakRel => ("torque-peak error", "", Some("torque-peak")),
            Self::EnergyDrift => ("energy drift", "", Some("energy")),
        }
    }

    /// Returns the meaning in the dictionary of columns.
    #[rustfmt::skip]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::ForceL1 => "relative L1 error of the contact force: integral of the magnitude of its error over that of the force; of the worst mesh",
            Self::ForceL2 => "relative L2 error of the force history, of the worst mesh",
            Self::ForceL2Aligned => "relative L2 error of the force history after the best shift in time, of the worst mesh",
            Self::TimeShift => "best shift in time, added to the time of the run",
            Self::PeakForce => "greatest contact force of the first mesh",
            Self::PeakForceRel => "error of the peak force, of the worst mesh",
            Self::RmsForce => "root mean square of the contact force of the first mesh over the time of the run",
            Self::RmsForceRel => "error of the root mean square of the force, of the worst mesh",
            Self::Impulse => "impulse of the contact force of the first mesh",
            Self::ImpulseRel => "error of the impulse, of the worst mesh",
            Self::Duration => "time with more than 1e-6 of the greatest contact force, of the first mesh",
            Self::Rebound => "greatest error of the final speed of a gear over the range of that speed",
            Self::TransmissionError => "relative L2 error of the transmission error, of the worst mesh",
            Self::TransmissionErrorSpan => "peak to peak of the transmission error of the first mesh",
            Self::TransmissionErrorSpanRel => "error of the peak to peak of the transmission error, of the worst mesh",
            Self::TransmissionErrorOrders => "error of the amplitudes of the transmission error at multiples of the mesh frequency, over the last whole mesh cycles: root of the sum of squares over that of the reference's; of the worst mesh",
            Self::TransmissionErrorAligned => "relative L2 error of the periodic part of the transmission error, without its mean and after the best shift, of the worst mesh",
            Self::Angle => "greatest error of an angle against an external reference: root mean square over the range of the reference",
            Self::Speed => "greatest error of a speed against an external reference: root mean square over the range of the reference",
            Self::Torque => "greatest error of a torque against an external reference: root mean square over the range of the reference",
            Self::TorquePeakRel => "largest error of the peak of a torque",
            Self::EnergyDrift => "residual of the energy ledger over its largest entry",
        }
    }

    /// Returns the metric for integration errors that corresponds to this metric for model errors. A force with jumps
    /// converges in the L1 norm with the order of its event times, in the L2 norm with half of it (see
    /// [`crate::metrics`]).
    #[must_use]
    pub fn of_integration(self) -> Self {
        match self {
            Self::ForceL2 | Self::ForceL2Aligned => Self::ForceL1,
            // These metrics exist for references that no run of the study made, so that the force stands for them.
            Self::Angle | Self::Speed | Self::Torque | Self::TorquePeakRel => Self::ForceL1,
            other => other,
        }
    }

    /// True if the metric exists against external references only, not between two runs of the same study.
    pub fn is_of_measurements(self) -> bool {
        matches!(
            self,
            Self::Angle | Self::Speed | Self::Torque | Self::TorquePeakRel
        )
    }

    /// Returns the name in prose.
    pub fn words(self) -> &'static str {
        self.facts().0
    }

    /// Returns the head of a column with the metric: its name in prose without the word "error".
    pub fn short(self) -> String {
        let words = self.words();
        let what = words.strip_suffix(" error").unwrap_or(words);
        // Two words that were joined before a third.
        let joined = [
            "force-history",
            "peak-force",
            "rms-force",
            "peak-to-peak-transmission-error",
            "transmission-error-orders",
            "aligned-transmission-error",
            "transmission-error",
            "torque-peak",
        ];
        let apart = |text: String, pair: &str| text.replace(pair, &pair.replace('-', " "));
        joined.into_iter().fold(what.to_owned(), apart)
    }

    /// Returns the SI unit; empty for ratios, which pages show in per cent.
    pub fn unit(self) -> &'static str {
        self.facts().1
    }

    /// Returns the name on the command line; only relative errors have one.
    pub fn option(self) -> Option<&'static str> {
        self.facts().2
    }

    /// True if the metric is a relative error: the larger its magnitude, the worse.
    pub fn is_error(self) -> bool {
        self.option().is_some()
    }

    /// Returns the label of an axis with this metric: name in prose and unit, per cent for ratios.
    pub fn axis(self) -> String {
        match self.unit() {
            "" => format!("{} [%]", self.words()),
            unit => format!("{} [{unit}]", self.words()),
        }
    }
}

impl std::str::FromStr for Metric {
    type Err = String;

    /// Parses a metric from its key, or from its name on the command line.
    fn from_str(text: &str) -> Result<Self, String> {
        let named = |m: &Self| m.key() == text || m.option() == Some(text);
        Self::ALL.into_iter().find(named).ok_or_else(|| {
            let keys = Self::ALL.map(Self::key).join(", ");
            format!("there is no metric `{text}`; there are {keys}")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keys are the fields of the record in its order, and keys and names can be parsed back to their metric.
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
            let apart = m.words().replace('-', " ");
            assert!(apart.starts_with(&m.short().replace('-', " ")[..4]), "{m}");
            assert!(m.option().is_none_or(|o| o.parse() == Ok(m)));
        }
        let keys: serde_json::Value = serde_json::to_value(&metrics).unwrap();
        assert_eq!(
            keys.as_object().map(|o| o.len()),
            Some(Metric::ALL.len() + 1)
        );
        assert!(
            "velocity"
                .parse::<Metric>()
                .unwrap_err()
                .contains("force_l2")
        );
    }
}
