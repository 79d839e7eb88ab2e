//! The list of metrics, the values of a run, and their keys, names, units and meanings; no other module names them.

use crate::record::{not_a_number, ordered_map};
use crate::words::words;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Declares every metric once: variant, name on the command line (relative errors have one), field of the record with its key,
/// name in prose, SI unit (ratios have none and are shown in per cent), meaning.
macro_rules! metrics {
    ($(
        $(#[$default:meta])?
        $variant:ident $(($option:literal))?, $field:ident = $key:literal: $words:literal $(in $unit:literal)?,
            $meaning:literal;
    )+) => {
        words! {
            /// A metric of a run against a reference by its key in records, tables and scene files; definitions in
            /// [`crate::metrics`].
            ///
            /// An error is worse the larger its magnitude; quantities have no better and worse by themselves.
            #[derive(PartialOrd, Ord)]
            pub enum Metric {
                $( $(#[$default])? #[doc = $meaning] $(#[serde(alias = $option)])? $variant = $key, )+
            }
        }

        impl Metric {
            /// Returns the name in prose.
            pub fn words(self) -> &'static str {
                match self { $(Self::$variant => $words,)+ }
            }

            /// Returns the SI unit; empty for ratios, which pages show in per cent.
            pub fn unit(self) -> &'static str {
                match self { $(Self::$variant => concat!($($unit)?),)+ }
            }

            /// Returns the name on the command line; only relative errors have one.
            pub fn option(self) -> Option<&'static str> {
                let name = match self { $(Self::$variant => concat!($($option)?),)+ };
                Some(name).filter(|name| !name.is_empty())
            }

            /// Returns the meaning in the dictionary of columns.
            pub fn meaning(self) -> &'static str {
                match self { $(Self::$variant => $meaning,)+ }
            }
        }

        /// Engineering outputs of one run against one reference; see [`crate::metrics`] for definitions.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[cfg_attr(test, derive(schemars::JsonSchema))]
        #[serde(default)]
        pub struct Metrics {
            $( #[doc = $meaning] #[serde(skip_serializing_if = "not_a_number")] pub $field: Option<f64>, )+
            /// Last angular velocity of each gear, in the order of the scene [rad/s]; of a rack its speed over the pitch
            /// radius of its mate.
            #[serde(with = "ordered_map", skip_serializing_if = "Vec::is_empty")]
            #[cfg_attr(test, schemars(with = "BTreeMap<String, f64>"))]
            pub speeds_end: Vec<(String, f64)>,
            /// Amplitudes of the transmission error by orders of the mesh cycle, from the first on, over the last whole
            /// cycles \[m\]; of the mesh with the largest peak to peak.
            #[serde(skip_serializing_if = "Vec::is_empty")]
            pub transmission_error_orders_m: Vec<f64>,
            /// The mesh of each value by the key of its metric: the names of its gears, `_` between them; empty for scenes
            /// with one mesh.
            #[serde(skip_serializing_if = "BTreeMap::is_empty")]
            pub meshes: BTreeMap<String, String>,
            /// Id of the reference: `fe`, `calculix`, or `self` for the model's own converged solution.
            pub against: String,
        }

        impl Metrics {
            /// Returns the value of a metric.
            pub fn get(&self, metric: Metric) -> Option<f64> {
                match metric { $(Metric::$variant => self.$field,)+ }
            }

            fn value_mut(&mut self, metric: Metric) -> &mut Option<f64> {
                match metric { $(Metric::$variant => &mut self.$field,)+ }
            }
        }
    };
}

metrics! {
    ForceL1 ("force-l1"), force_l1 = "force_l1": "relative L1 error of the contact force",
        "relative L1 error of the contact force: integral of the magnitude of its error over that of the force; of the worst mesh";
    ForceL2 ("force"), force_l2 = "force_l2": "force-history error",
        "relative L2 error of the force history, of the worst mesh";
    #[default]
    ForceL2Aligned ("force-aligned"), force_l2_aligned = "force_l2_aligned": "time-aligned force-history error",
        "relative L2 error of the force history after the best shift in time, of the worst mesh";
    TimeShift, time_shift_s = "time_shift_s": "shift in time" in "s",
        "best shift in time, added to the time of the run";
    PeakForce, peak_force_n = "peak_force_n": "peak force" in "N",
        "greatest contact force, of the mesh where it is greatest";
    PeakForceRel ("peak"), peak_force_rel = "peak_force_rel": "peak-force error",
        "error of the peak force, of the worst mesh";
    RmsForce, rms_force_n = "rms_force_n": "rms force" in "N",
        "root mean square of the contact force over the time of the run, of the mesh where it is greatest";
    RmsForceRel ("rms"), rms_force_rel = "rms_force_rel": "rms-force error",
        "error of the root mean square of the force, of the worst mesh";
    Impulse, impulse_ns = "impulse_ns": "impulse" in "N s",
        "impulse of the contact force, of the mesh where it is greatest";
    ImpulseRel ("impulse"), impulse_rel = "impulse_rel": "impulse error",
        "error of the impulse, of the worst mesh";
    Duration, duration_s = "duration_s": "contact duration" in "s",
        "time with more than 1e-6 of the greatest contact force of the same mesh, of the mesh where it is longest; meshes that bear less than a thousandth of the most loaded one do not count";
    Rebound ("rebound"), rebound_rel = "rebound_rel": "rebound error",
        "greatest error of the final speed of a gear over the range of that speed";
    TransmissionError ("transmission-error"), transmission_error_l2 = "transmission_error_l2": "transmission-error error",
        "relative L2 error of the transmission error, of the worst mesh";
    TransmissionErrorSpan, transmission_error_pp_m = "transmission_error_pp_m": "peak-to-peak transmission error" in "m",
        "peak to peak of the transmission error, of the mesh where it is greatest";
    TransmissionErrorSpanRel ("transmission-error-pp"), transmission_error_pp_rel = "transmission_error_pp_rel": "peak-to-peak-transmission-error error",
        "error of the peak to peak of the transmission error, of the worst mesh";
    TransmissionErrorOrders ("transmission-error-orders"), transmission_error_orders_rel = "transmission_error_orders_rel": "transmission-error-orders error",
        "error of the amplitudes of the transmission error at multiples of the mesh frequency, over the last whole mesh cycles: root of the sum of squares over that of the reference's; of the worst mesh";
    TransmissionErrorAligned ("transmission-error-aligned"), transmission_error_l2_aligned = "transmission_error_l2_aligned": "aligned-transmission-error error",
        "relative L2 error of the periodic part of the transmission error, without its mean and after the best shift, of the worst mesh";
    Angle ("angle"), angle_l2 = "angle_l2": "angle error",
        "greatest error of an angle against an external reference: root mean square over the range of the reference";
    Speed ("speed"), speed_l2 = "speed_l2": "speed error",
        "greatest error of a speed against an external reference: root mean square over the range of the reference";
    Torque ("torque"), torque_l2 = "torque_l2": "torque error",
        "greatest error of a torque against an external reference: root mean square over the range of the reference";
    TorquePeakRel ("torque-peak"), torque_peak_rel = "torque_peak_rel": "torque-peak error",
        "largest error of the peak of a torque";
    EnergyDrift ("energy"), energy_drift_rel = "energy_drift_rel": "energy drift",
        "residual of the energy ledger over its largest entry";
}

impl Metrics {
    /// Returns the last angular velocity of a gear [rad/s].
    pub fn speed_end(&self, gear: &str) -> Option<f64> {
        let mut all = self.speeds_end.iter();
        all.find_map(|(g, speed)| (g == gear).then_some(*speed))
    }

    /// Returns the mesh of a value: the names of its gears, `_` between them; `None` for scenes with one mesh.
    pub fn mesh(&self, metric: Metric) -> Option<&str> {
        self.meshes.get(metric.key()).map(String::as_str)
    }

    /// Keeps the value of a mesh where its magnitude is larger than that of the meshes before, and returns whether it is.
    pub(super) fn keep_larger(&mut self, metric: Metric, mesh: &str, value: f64) -> bool {
        let kept = self.value_mut(metric);
        let is_larger = value.is_finite() && kept.is_none_or(|x| value.abs() > x.abs());
        if is_larger {
            *kept = Some(value);
            self.meshes.insert(metric.key().to_owned(), mesh.to_owned());
        }
        is_larger
    }
}

impl Metric {
    /// Returns the key in records, tables and scene files.
    pub fn key(self) -> &'static str {
        self.as_str()
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
