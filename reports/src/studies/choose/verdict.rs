//! Verdict on an estimated error under a tolerance, where the yardstick has an error of its own.
//!
//! With the estimated error `E` against the yardstick, the yardstick's own error `Y` and the tolerance `T`, the error against
//! the truth lies between `E - Y` and `E + Y`:
//!
//! | | |
//! |---|---|
//! | `E + Y <= T` | adequate |
//! | `E - Y > T` | not adequate |
//! | between the two | not decided |

use crate::words::words;
use serde::{Deserialize, Deserializer};

words! {
    /// Verdict of a model choice.
    pub enum Verdict {
        /// A candidate keeps the tolerance.
        Adequate = "adequate",
        /// The yardstick cannot decide whether any candidate keeps the tolerance.
        #[default]
        NotDecided = "not decided",
        /// No candidate keeps the tolerance.
        NoneAdequate = "none adequate",
    }
}

/// Adequacy of a model under the tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum Adequacy {
    /// The model keeps the tolerance.
    #[serde(rename = "adequate")]
    Adequate,
    /// The error of the yardstick is too large to decide.
    #[default]
    #[serde(rename = "not decided")]
    NotDecided,
    /// The model exceeds the tolerance.
    #[serde(rename = "not adequate")]
    NotAdequate,
}

impl Adequacy {
    /// Returns the adequacy of an estimated error under the yardstick's own error and a tolerance. An infinite error,
    /// that of a run without one, is never adequate.
    #[must_use]
    pub fn of(error: f64, own: f64, tolerance: f64) -> Adequacy {
        if !error.is_finite() {
            Adequacy::NotAdequate
        } else if error + own <= tolerance {
            Adequacy::Adequate
        } else if error - own > tolerance {
            Adequacy::NotAdequate
        } else {
            Adequacy::NotDecided
        }
    }

    /// Returns the adequacy of an error over the whole scene that is the error on a window times its growth beyond it.
    ///
    /// The growth is the largest effect of a small change, so that `error` and `own` are upper estimates: a model is not
    /// adequate only where its error on the window is beyond the tolerance as well.
    #[must_use]
    pub fn of_grown((error, own): (f64, f64), growth: f64, tolerance: f64) -> Adequacy {
        let on_window = || Adequacy::of(error / growth, own / growth, tolerance);
        match Adequacy::of(error, own, tolerance) {
            Adequacy::NotAdequate if on_window() != Adequacy::NotAdequate => Adequacy::NotDecided,
            found => found,
        }
    }

    /// Returns the word of the format and of the report.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Adequacy::Adequate => "adequate",
            Adequacy::NotDecided => "not decided",
            Adequacy::NotAdequate => "not adequate",
        }
    }
}

impl std::fmt::Display for Adequacy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for Adequacy {
    /// Reads a word, or a boolean of records of earlier versions.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Earlier(bool),
            Word(String),
        }
        let all = [
            Adequacy::Adequate,
            Adequacy::NotDecided,
            Adequacy::NotAdequate,
        ];
        match Written::deserialize(deserializer)? {
            Written::Earlier(true) => Ok(Adequacy::Adequate),
            Written::Earlier(false) => Ok(Adequacy::NotAdequate),
            Written::Word(word) => (all.into_iter().find(|a| a.as_str() == word))
                .ok_or_else(|| serde::de::Error::custom(format!("unknown adequacy `{word}`"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Adequacy;

    /// The three verdicts at their bounds, without a known error of the yardstick, and for failed runs.
    #[test]
    fn growth_alone_rules_no_level_out() {
        use Adequacy::{Adequate, NotAdequate, NotDecided};
        let of =
            |error, own, growth| Adequacy::of_grown((growth * error, growth * own), growth, 0.05);
        // 2.5 % on the window with a yardstick of 0.5 %, where a little more stiffness moves the result 80 times as far later.
        assert_eq!(of(0.025, 0.005, 80.0), NotDecided);
        assert_eq!(of(0.08, 0.005, 2.0), NotAdequate);
        assert_eq!(of(0.08, 0.005, 1.0), NotAdequate);
        assert_eq!(of(0.01, 0.005, 2.0), Adequate);
        assert_eq!(of(f64::INFINITY, 0.005, 3.0), NotAdequate);
    }

    #[test]
    fn the_yardsticks_own_error_bounds_what_is_decided() {
        for (error, own, expected) in [
            (0.03, 0.02, Adequacy::Adequate),
            (0.03, 0.021, Adequacy::NotDecided),
            (0.069, 0.02, Adequacy::NotDecided),
            (0.071, 0.02, Adequacy::NotAdequate),
            (0.0, 0.06, Adequacy::NotDecided),
            (9.0, f64::INFINITY, Adequacy::NotDecided),
            (f64::INFINITY, f64::INFINITY, Adequacy::NotAdequate),
            (f64::NAN, 0.01, Adequacy::NotAdequate),
        ] {
            let found = Adequacy::of(error, own, 0.05);
            assert_eq!(found, expected, "{error} with {own}");
        }
    }

    #[test]
    fn records_of_earlier_versions_have_booleans() {
        let read = |text| serde_json::from_str::<Adequacy>(text).ok();
        assert_eq!(read("true"), Some(Adequacy::Adequate));
        assert_eq!(read("false"), Some(Adequacy::NotAdequate));
        assert_eq!(read("\"not decided\""), Some(Adequacy::NotDecided));
        assert_eq!(read("\"perhaps\""), None);
    }
}
