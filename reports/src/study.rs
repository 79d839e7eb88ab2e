//! The studies that write a record.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A study.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Study {
    /// All models and integrators of a scene against its references.
    #[default]
    Compare,
    /// Error against cost.
    Precision,
    /// Where methods fail.
    Stability,
    /// The cheapest adequate model, integrator and step.
    Choose,
    /// Choices judged on random scenes.
    ChoiceCheck,
    /// Error over the number of modes that a reduction keeps.
    Truncation,
    /// Force and transmission error over the penalty of the contact.
    Penalty,
    /// Running under load at speed after speed.
    Sweep,
}

impl Study {
    /// All.
    pub const ALL: [Self; 8] = [
        Self::Compare,
        Self::Precision,
        Self::Stability,
        Self::Choose,
        Self::ChoiceCheck,
        Self::Truncation,
        Self::Penalty,
        Self::Sweep,
    ];

    /// The word of the format, of commands and of folders.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Compare => "compare",
            Self::Precision => "precision",
            Self::Stability => "stability",
            Self::Choose => "choose",
            Self::ChoiceCheck => "choice-check",
            Self::Truncation => "truncation",
            Self::Penalty => "penalty",
            Self::Sweep => "sweep",
        }
    }
}

impl std::fmt::Display for Study {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.as_str())
    }
}

/// What the study of mode counts was called in records.
const FORMER_TRUNCATION: &str = "modes";

impl std::str::FromStr for Study {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(study) = Self::ALL.into_iter().find(|s| s.as_str() == text) {
            return Ok(study);
        }
        let new = Self::Truncation;
        Err(if text == FORMER_TRUNCATION {
            format!(
                "the record is of an older version: its study `{text}` is called `{new}` now; run the study again, or \
                 write `{new}` into the record"
            )
        } else {
            let all = Self::ALL.map(Self::as_str).join(", ");
            format!("there is no study `{text}`; this version knows {all}")
        })
    }
}

impl Serialize for Study {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for Study {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lead_back_and_the_former_name_is_refused_with_the_new_one() {
        for s in Study::ALL {
            assert_eq!(s.as_str().parse(), Ok(s));
        }
        let old = "modes".parse::<Study>().unwrap_err();
        assert!(old.contains("`truncation`"), "{old}");
        assert!("mode".parse::<Study>().unwrap_err().contains("compare"));
    }
}
