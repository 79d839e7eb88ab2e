//! `[study] sweep` of a scene: default speeds of a sweep.

use crate::scene_file::SceneError;
use crate::scene_file::reading::Place;
use crate::scene_file::reading::keys::keys;
use crate::scene_file::reading::values::{Count, Distinct, Positive};
use gearbench_reports::sweep::Branch;

keys! {
    /// Speeds at which a sweep runs.
    #[serde(default)]
    struct Sweep {
        /// lowest mesh frequency in hertz: teeth times turns per second
        from_hz: Option<Positive>,
        /// highest mesh frequency in hertz
        to_hz: Option<Positive>,
        /// number of speeds, default 40
        points: Count<2, 10_000>,
        /// whole mesh cycles that are measured, default 8
        cycles: Count<1, 1000>,
        /// whole turns of the first gear that are measured in place of mesh cycles, for the orders of its shaft (and of the
        /// other's, where it makes whole turns as well)
        turns: Option<Count<1, 1000>>,
        /// time in seconds that a run is given to settle, default 0.005; at least four mesh cycles
        settle_s: Positive,
        /// how runs come to their speed: a list of "up", "down" (each from the speed before) and "fresh" (from teeth
        /// that touch unloaded), default ["up", "down"]
        branches: Distinct<Branch>,
    }
}

impl Default for Sweep {
    fn default() -> Self {
        Sweep {
            from_hz: None,
            to_hz: None,
            points: Count(40),
            cycles: Count(8),
            turns: None,
            settle_s: Positive(5e-3),
            branches: Distinct(vec![Branch::Up, Branch::Down]),
        }
    }
}

impl Sweep {
    /// Returns the lowest and highest mesh frequency [Hz]; `None` takes them from the mesh resonance.
    pub fn range(&self) -> Option<[f64; 2]> {
        Some([self.from_hz?.0, self.to_hz?.0])
    }

    /// Returns the number of speeds.
    pub fn points(&self) -> usize {
        self.points.0
    }

    /// Returns the number of whole mesh cycles that are measured.
    pub fn cycles(&self) -> usize {
        self.cycles.0
    }

    /// Returns the number of whole turns of the first gear to measure, in place of mesh cycles.
    pub fn turns(&self) -> Option<usize> {
        self.turns.map(|n| n.0)
    }

    /// Returns the settling time [s].
    pub fn settle(&self) -> f64 {
        self.settle_s.0
    }

    /// Returns the branches of the sweep.
    pub fn branches(&self) -> &[Branch] {
        &self.branches.0
    }

    /// Returns an error for settings that exclude each other.
    pub(crate) fn check(&self, at: &Place<'_>) -> Result<(), SceneError> {
        match (self.from_hz, self.to_hz) {
            (Some(from), Some(to)) if to.0 <= from.0 => at.key("to_hz").refuse(
                format!("the sweep ends at {} Hz, below its start", to.0),
                format!("expected more than {} Hz", from.0),
                "give the lower mesh frequency as `from_hz`",
            ),
            (Some(_), None) => Err(at.missing("to_hz", &Self::TABLE)),
            (None, Some(_)) => Err(at.missing("from_hz", &Self::TABLE)),
            _ => Ok(()),
        }
    }
}
