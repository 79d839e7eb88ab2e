//! Quantities of a run that a scan records.

use gearbench_models::spec::SceneSpec;
use gearbench_reports::Metric;
use gearbench_reports::record::{Run, TorquePaths, speed_end};

/// A quantity of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// A metric: a quantity of the run itself, or an error against the model of `--against`.
    Metric(Metric),
    /// Last speeds of all gears.
    SpeedsEnd,
    /// Last speed of a gear, by its name.
    SpeedEnd(String),
    /// Last speed of a gear by its number from 1: `omega1_end`, as former versions have it.
    NumberedSpeedEnd(usize),
    /// Power taken out over power put in by loads and drives, means over the second half of a settled run.
    Efficiency,
    /// Number of accepted steps.
    Steps,
}

/// Key of the last speeds of all gears.
const SPEEDS_END: &str = "speeds_end";
/// Other quantities that are no metrics, with their keys.
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
    pub fn key(&self) -> String {
        match self {
            Output::Metric(metric) => metric.key().into(),
            Output::SpeedsEnd => SPEEDS_END.into(),
            Output::SpeedEnd(gear) => speed_end(gear),
            Output::NumberedSpeedEnd(n) => format!("omega{n}_end"),
            other => OTHERS
                .iter()
                .find(|o| o.0 == *other)
                .map_or("", |o| o.1)
                .into(),
        }
    }

    /// The quantities of a scene that are meant, with the names of its gears.
    ///
    /// # Errors
    /// A sentence on the gear that the scene does not have.
    pub fn of_scene(self, scene: &SceneSpec) -> Result<Vec<Output>, String> {
        let mut gears = scene.gears.iter().map(|g| &g.name);
        let known = match &self {
            Output::SpeedsEnd => return Ok(gears.cloned().map(Output::SpeedEnd).collect()),
            Output::SpeedEnd(gear) => gears.find(|name| *name == gear),
            Output::NumberedSpeedEnd(n) => n.checked_sub(1).and_then(|i| gears.nth(i)),
            _ => return Ok(vec![self]),
        };
        match known {
            Some(gear) => Ok(vec![Output::SpeedEnd(gear.clone())]),
            None => Err(format!("the scene has no gear of `{}`", self.key())),
        }
    }

    /// True if the quantity is an error against another run.
    pub fn is_error(&self) -> bool {
        matches!(self, Output::Metric(m) if m.is_error() && *m != Metric::EnergyDrift)
            || *self == Output::Metric(Metric::TimeShift)
    }

    /// The value of a run, whose metrics are the first ones; `None` where the run has none.
    pub fn of(&self, run: &Run) -> Option<f64> {
        match self {
            Output::Metric(metric) => run.metrics.first()?.get(*metric),
            Output::SpeedEnd(gear) => run.metrics.first()?.speed_end(gear),
            Output::SpeedsEnd | Output::NumberedSpeedEnd(_) => None,
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
            return Ok(other.clone());
        }
        if text == SPEEDS_END {
            return Ok(Output::SpeedsEnd);
        }
        let between = |begin: &str, end: &str| text.strip_prefix(begin)?.strip_suffix(end);
        if let Some(gear) = between("speed_end_", "_rad_s") {
            return Ok(Output::SpeedEnd(gear.into()));
        }
        if let Some(n) = between("omega", "_end").and_then(|n| n.parse().ok()) {
            return Ok(Output::NumberedSpeedEnd(n));
        }
        text.parse().map(Output::Metric).map_err(|_| {
            let metrics = Metric::ALL.into_iter().filter(|m| !m.is_of_measurements());
            let keys: Vec<&str> = metrics
                .map(Metric::key)
                .chain([SPEEDS_END])
                .chain(OTHERS.map(|o| o.1))
                .collect();
            format!(
                "there is no quantity `{text}`; there are {}",
                keys.join(", ")
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Context;
    use crate::scene_file::{self, Selection};

    /// The last speeds are named after the gears of the scene, also those that former versions had by number.
    #[test]
    fn last_speeds_have_the_names_of_gears() {
        let labels = Selection::Labels(Some("rigid"));
        let scene = scene_file::load_for(&Context::default(), "hammer", labels).unwrap();
        let keys = |word: &str| -> Result<Vec<String>, String> {
            let all = word.parse::<Output>()?.of_scene(&scene.spec)?;
            Ok(all.iter().map(Output::key).collect())
        };
        let [pinion, wheel] = ["speed_end_pinion_rad_s", "speed_end_wheel_rad_s"];
        for (word, wanted) in [
            ("speeds_end", vec![pinion, wheel]),
            ("omega2_end", vec![wheel]),
            (pinion, vec![pinion]),
            ("steps", vec!["steps"]),
        ] {
            assert_eq!(keys(word).unwrap(), wanted, "{word}");
        }
        for word in [
            "omega3_end",
            "omega0_end",
            "speed_end_sun_rad_s",
            "velocity",
        ] {
            assert!(keys(word).unwrap_err().contains(word), "{word}");
        }
    }
}
