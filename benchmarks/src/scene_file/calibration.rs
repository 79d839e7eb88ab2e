//! Calibrations: constants of models fitted to a reference, kept in generated files.
//!
//! `gearbench identify SCENE --write` writes them, a model with `calibration = "impact"` reads them; they
//! are never typed in. What they were fitted to says what they hold for ([`FittedTo`]). A file has a header of comments (command, fit figures) and one table per calibration
//! and model label:
//!
//! ```toml
//! [impact.movable-teeth]
//! stiffness_n_per_m2 = 3.6e10      # of the contact, per face width
//! damping_ns_per_m = 40            # of the contact, a linear dashpot; most calibrations have none
//! gap_m = 3.1e-6                   # gap at the start
//! tooth_stiffness_n_per_m = 5.3e8  # any further key: a parameter of the gear model
//! ```
//!
//! Shipped scenes have theirs embedded (`benchmarks/calibrations/NAME.toml`); a scene file of one's own has
//! it beside itself, as `NAME.calibration.toml`.

use super::error::SceneError;
use super::reading::values::InOrder;
use super::reading::{Document, Place, suggest};
use gearbench_models::law::Damping;
use gearbench_models::spec::{Modelling, Value};
use gearbench_models::stiffness::{PairOrMesh, PairStiffness};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// What constants were fitted to: the name of a calibration, and what it holds for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FittedTo {
    /// The force history of one impact.
    #[default]
    Impact,
    /// The static compliance of finite elements over a mesh cycle.
    Static,
    /// Both at once.
    Running,
}

impl FittedTo {
    /// All.
    pub const ALL: [FittedTo; 3] = [FittedTo::Impact, FittedTo::Static, FittedTo::Running];

    /// The name in files and on the command line.
    pub const fn as_str(self) -> &'static str {
        match self {
            FittedTo::Impact => "impact",
            FittedTo::Static => "static",
            FittedTo::Running => "running",
        }
    }

    /// That with a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|f| f.as_str() == name)
    }

    /// What the constants hold for, in words.
    pub fn holds_for(self) -> &'static str {
        match self {
            FittedTo::Impact => {
                "single impacts; under a load that stays it is too stiff, as an impact is over before the bodies give way"
            }
            FittedTo::Static => "standing and slow running under load; impacts are too soft",
            FittedTo::Running => {
                "running under load with impacts, as well as one set of constants can"
            }
        }
    }

    /// Whether the force history of the scene's reference took part.
    pub fn to_history(self) -> bool {
        self != FittedTo::Static
    }

    /// Whether the static compliance took part.
    pub fn to_statics(self) -> bool {
        self != FittedTo::Impact
    }
}

/// The names a calibration can have.
pub(super) const NAMES: [&str; 3] = [
    FittedTo::Impact.as_str(),
    FittedTo::Static.as_str(),
    FittedTo::Running.as_str(),
];

/// Fitted constants of one model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constants {
    /// Stiffness of a tooth pair per face width [N/m per m].
    pub stiffness: Option<f64>,
    /// Linear dashpot of the contact [N s/m].
    pub damping: Option<f64>,
    /// Gap at the start of the first mesh [m].
    pub gap: Option<f64>,
    /// Parameters of the gear model by key, in SI units.
    pub parameters: BTreeMap<String, f64>,
}

/// Key of [`Constants::stiffness`].
pub const STIFFNESS: &str = "stiffness_n_per_m2";
/// Key of [`Constants::damping`].
pub const DAMPING: &str = "damping_ns_per_m";
/// Key of [`Constants::gap`].
pub const GAP: &str = "gap_m";

/// The end of the keys of dampers.
const DAMPER: &str = "_ns_per_m";

impl Constants {
    /// Constants by their keys.
    pub fn of<'k>(values: impl IntoIterator<Item = (&'k str, f64)>) -> Self {
        let mut constants = Constants::default();
        for (key, x) in values {
            match key {
                STIFFNESS => constants.stiffness = Some(x),
                DAMPING => constants.damping = Some(x),
                GAP => constants.gap = Some(x),
                other => {
                    constants.parameters.insert(other.to_owned(), x);
                }
            }
        }
        constants
    }

    /// All by their keys.
    pub fn by_key(&self) -> Vec<(String, f64)> {
        let own = [
            (STIFFNESS, self.stiffness),
            (DAMPING, self.damping),
            (GAP, self.gap),
        ];
        let own = own
            .into_iter()
            .filter_map(|(k, x)| Some((k.to_owned(), x?)));
        let parameters = self.parameters.iter().map(|(k, x)| (k.clone(), *x));
        own.chain(parameters).collect()
    }

    /// Puts them in place of what a scene gives its contacts and the gears that take a model; the gap is the scene's.
    /// A stiffness stays that of a pair or of the mesh, as it was.
    pub fn apply(&self, model: &str, modelling: &mut Modelling) {
        if let Some(per_width) = self.stiffness {
            for contact in &mut modelling.contacts {
                let of = match contact.stiffness {
                    PairStiffness::Constant { of, .. } | PairStiffness::Table { of, .. } => of,
                    _ => PairOrMesh::Pair,
                };
                contact.stiffness = PairStiffness::Constant { per_width, of };
            }
        }
        if let Some(c) = self.damping {
            for contact in &mut modelling.contacts {
                contact.damping = Damping::KelvinVoigt { c };
            }
        }
        for gear in modelling.gears.iter_mut().filter(|g| g.id == model) {
            for (key, value) in &self.parameters {
                gear.parameters.insert(key.clone(), Value::Number(*value));
            }
        }
    }
}

/// The content of a calibration file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calibration {
    /// Constants by calibration name and model label.
    pub sets: BTreeMap<String, BTreeMap<String, Constants>>,
}

/// Tables of constants by name of the calibration and label of the model.
type Sets = InOrder<InOrder<InOrder<f64>>>;

impl Calibration {
    /// Reads a calibration file.
    ///
    /// # Errors
    /// [`SceneError`] for anything but tables of positive numbers (a gap may have any sign).
    pub fn parse(name: &str, text: &str) -> Result<Self, SceneError> {
        let (document, sets): (_, Sets) = Document::read(name, text, |_| Vec::new())?;
        Self::of(sets, &document.at(""))
    }

    /// Reads its tables, which stand at a place.
    ///
    /// # Errors
    /// [`SceneError`] at a name that is none, or a constant that is not positive.
    pub(super) fn of(sets: Sets, at: &Place<'_>) -> Result<Self, SceneError> {
        let mut calibration = Calibration::default();
        for (set, labels) in sets.0 {
            if !NAMES.contains(&set.as_str()) {
                return at.key(&set).refuse(
                    format!("unknown calibration `{set}`"),
                    "not known here",
                    suggest::there_are(&set, &NAMES),
                );
            }
            let mut constants = BTreeMap::new();
            for (label, values) in labels.0 {
                let at = at.key(&set).key(&label);
                let values = values.0;
                // A gap may have any sign, a damper be none.
                let wrong = |key: &str, x: f64| {
                    key != GAP && (x < 0.0 || x == 0.0 && !key.ends_with(DAMPER))
                };
                if let Some((key, x)) = values.iter().find(|(key, x)| wrong(key, *x)) {
                    return at.key(key).refuse(
                        format!("`{key}` is {x}"),
                        "expected more than zero",
                        "write the file again with `gearbench identify SCENE --write`",
                    );
                }
                let values = values.iter().map(|(key, x)| (key.as_str(), *x));
                constants.insert(label, Constants::of(values));
            }
            calibration.sets.insert(set, constants);
        }
        Ok(calibration)
    }

    /// Constants of a label.
    pub fn get(&self, name: &str, label: &str) -> Option<&Constants> {
        self.sets.get(name)?.get(label)
    }

    /// Its tables as TOML; numbers keep every digit.
    pub fn to_toml(&self) -> String {
        let key = |name: &str| toml_edit::Key::new(name).display_repr().into_owned();
        let mut text = String::new();
        for (name, labels) in &self.sets {
            for (label, constants) in labels {
                let _ = writeln!(text, "\n[{}.{}]", key(name), key(label));
                for (name, x) in constants.by_key() {
                    let _ = writeln!(text, "{} = {x:e}", key(&name));
                }
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let constants = Constants::of([
            (STIFFNESS, 1.0 / 3.0 * 1e10),
            (DAMPING, 0.0),
            (GAP, -3.1e-6),
            ("tooth_mass_kg", 4.8e-3),
        ]);
        let labels = [
            ("movable-teeth".to_owned(), constants.clone()),
            ("odd \"label\" \\ é".to_owned(), constants),
        ];
        let calibration = Calibration {
            sets: [("impact".to_owned(), labels.into())].into(),
        };
        let read = Calibration::parse("x.toml", &calibration.to_toml()).unwrap();
        assert_eq!(read, calibration);
        assert!(read.get("impact", "movable-teeth").is_some());
        assert!(read.get("static", "movable-teeth").is_none());
    }

    #[test]
    fn damaged_files_are_refused() {
        let refuse = |text: &str| Calibration::parse("x.toml", text).unwrap_err();
        assert!(
            refuse("[impat.rigid]")
                .help_text()
                .unwrap()
                .contains("`impact`")
        );
        assert!(
            refuse("[impact.rigid]\nstiffness_n_per_m2 = -1")
                .message()
                .contains("-1")
        );
        assert!(
            refuse("[impact.rigid]\nstiffness_n_per_m2 = nan")
                .message()
                .contains("finite")
        );
        assert!(
            refuse("[impact]\nrigid = 3")
                .message()
                .contains("expected a table")
        );
        assert_eq!(refuse("[impact.rigid]\nx = ").line(), Some(2));
    }
}
