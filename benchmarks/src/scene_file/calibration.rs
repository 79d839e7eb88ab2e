//! Calibrations: constants of models that were fitted to a reference, in generated files.
//!
//! `gearbench identify SCENE --write` writes them, and a model with `calibration = "impact"` reads them; they are never
//! written by hand. The data of the fit determine their range of validity ([`CalibrationKind`]). A file has a header of
//! comments (command, errors of the fit) and one table per calibration and model label:
//!
//! ```toml
//! [impact.movable-teeth]
//! stiffness_n_per_m2 = 1.5e10      # of the contact, per face width
//! damping_ns_per_m = 40            # of the contact, a linear dashpot; most calibrations have none
//! gap_m = 3.1e-6                   # gap at the start
//! path_slope = 0.04                # of the stiffness along the path of contact, which is then a parabola
//! path_curvature = -0.1            # likewise
//! tooth_stiffness_n_per_m = 5.3e8  # any further key: a parameter of the gear model
//! pinion.tooth_mass_kg = 4e-3      # that of one gear, in the place of what all have
//! fitted_to = ["calculix/case-a"]  # references whose histories were fitted; constants without it are no fit
//! ```
//!
//! Calibrations of shipped scenes are embedded (`benchmarks/calibrations/NAME.toml`); a scene file of the user has its
//! calibrations next to it, as `NAME.calibration.toml`.

use super::error::SceneError;
use super::format::document_of;
use super::reading::values::OrderedTable;
use super::reading::{Document, Place, suggest};
use gearbench_models::error::BuildError;
use gearbench_models::law::Damping;
use gearbench_models::spec::Modelling;
use gearbench_models::stiffness::{PairOrMesh, PairStiffness};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Kind of data to which constants were fitted; it is the name of a calibration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CalibrationKind {
    /// Fitted to the force history of one impact.
    #[default]
    Impact,
    /// Fitted to the static compliance of finite elements over a mesh cycle.
    Static,
    /// The force history and the static compliance together.
    Running,
}

impl CalibrationKind {
    /// All kinds, in the order of the documentation.
    pub const ALL: [CalibrationKind; 3] = [
        CalibrationKind::Impact,
        CalibrationKind::Static,
        CalibrationKind::Running,
    ];

    /// The name in files and on the command line.
    pub const fn as_str(self) -> &'static str {
        match self {
            CalibrationKind::Impact => "impact",
            CalibrationKind::Static => "static",
            CalibrationKind::Running => "running",
        }
    }

    /// Returns the kind with a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|f| f.as_str() == name)
    }

    /// The range of validity of the constants, in words.
    pub fn holds_for(self) -> &'static str {
        match self {
            CalibrationKind::Impact => {
                "single impacts; under constant load the stiffness is too high, since an impact ends before the bodies deform"
            }
            CalibrationKind::Static => {
                "gears at rest and slow running under load; for impacts the stiffness is too low"
            }
            CalibrationKind::Running => {
                "running under load with impacts, with the best single set of constants"
            }
        }
    }

    /// True if the fit includes the force history of the scene's reference.
    pub fn to_history(self) -> bool {
        self != CalibrationKind::Static
    }

    /// True if the fit includes the static compliance.
    pub fn to_statics(self) -> bool {
        self != CalibrationKind::Impact
    }
}

/// Valid names of calibrations.
pub(super) const NAMES: [&str; 3] = [
    CalibrationKind::Impact.as_str(),
    CalibrationKind::Static.as_str(),
    CalibrationKind::Running.as_str(),
];

/// Fitted constants of one model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constants {
    /// Stiffness of a tooth pair per face width [N/m per m].
    pub stiffness: Option<f64>,
    /// Linear dashpot of the contact [N s/m].
    pub damping: Option<f64>,
    /// Gap of all meshes at the start [m].
    pub gap: Option<f64>,
    /// Slope of the stiffness along the path of contact, see [`PairStiffness::Parabola`].
    pub slope: Option<f64>,
    /// Curvature of the stiffness along the path, see [`PairStiffness::Parabola`].
    pub curvature: Option<f64>,
    /// Parameters of the gear model by key, in SI units; the key `GEAR.KEY` is that of one gear, see [`of_gear`].
    pub parameters: BTreeMap<String, f64>,
    /// References to whose histories the constants were fitted; empty for constants of another origin.
    pub fitted_to: Vec<String>,
}

/// Key of [`Constants::fitted_to`].
pub const FITTED_TO: &str = "fitted_to";
/// Key of [`Constants::stiffness`].
pub const STIFFNESS: &str = "stiffness_n_per_m2";
/// Key of [`Constants::damping`].
pub const DAMPING: &str = "damping_ns_per_m";
/// Key of [`Constants::gap`].
pub const GAP: &str = "gap_m";

/// Key of [`Constants::slope`].
pub const SLOPE: &str = "path_slope";
/// Key of [`Constants::curvature`].
pub const CURVATURE: &str = "path_curvature";

/// Splits a key into the name of a gear, if it has one, and the key of the model parameter.
pub fn of_gear(key: &str) -> (Option<&str>, &str) {
    match key.rsplit_once('.') {
        Some((gear, key)) => (Some(gear), key),
        None => (None, key),
    }
}

/// Suffix of the keys of dashpots.
const DAMPER: &str = "_ns_per_m";

impl Constants {
    /// Collects constants from their keys and values.
    pub fn of<'k>(values: impl IntoIterator<Item = (&'k str, f64)>) -> Self {
        let mut constants = Constants::default();
        for (key, x) in values {
            match key {
                STIFFNESS => constants.stiffness = Some(x),
                DAMPING => constants.damping = Some(x),
                GAP => constants.gap = Some(x),
                SLOPE => constants.slope = Some(x),
                CURVATURE => constants.curvature = Some(x),
                other => {
                    constants.parameters.insert(other.to_owned(), x);
                }
            }
        }
        constants
    }

    /// The constants with their keys.
    pub fn by_key(&self) -> Vec<(String, f64)> {
        let own = [
            (STIFFNESS, self.stiffness),
            (DAMPING, self.damping),
            (GAP, self.gap),
            (SLOPE, self.slope),
            (CURVATURE, self.curvature),
        ];
        let own = own
            .into_iter()
            .filter_map(|(k, x)| Some((k.to_owned(), x?)));
        let parameters = self.parameters.iter().map(|(k, x)| (k.clone(), *x));
        own.chain(parameters).collect()
    }

    /// Adds the constants of `older` that these do not contain.
    #[must_use]
    pub fn merged_with(&self, older: &Constants) -> Constants {
        let all = [older.by_key(), self.by_key()].concat();
        let later = [self, older].into_iter().find(|c| !c.fitted_to.is_empty());
        Constants {
            fitted_to: later.map_or_else(Vec::new, |c| c.fitted_to.clone()),
            ..Constants::of(all.iter().map(|(key, x)| (key.as_str(), *x)))
        }
    }

    /// Replaces the values of the scene in contacts and in gears with the model, except for the gap. `names` are those
    /// of the gears. A stiffness of a pair stays one of a pair, a stiffness of the mesh one of the mesh.
    ///
    /// # Errors
    /// A parameter that the model does not have.
    pub fn apply(
        &self,
        model: &str,
        names: &[&str],
        modelling: &mut Modelling,
    ) -> Result<(), BuildError> {
        for contact in &mut modelling.contacts {
            self.stiffen(&mut contact.stiffness);
            if let Some(c) = self.damping {
                contact.damping = Damping::KelvinVoigt { c };
            }
        }
        let gears = modelling.gears.iter_mut().zip(names);
        for (gear, name) in gears.filter(|(g, _)| g.id() == model) {
            // Parameters of a single gear follow those of all gears, and replace them.
            for own in [false, true] {
                for (key, value) in &self.parameters {
                    let (of, key) = of_gear(key);
                    if of.is_some() == own && of.is_none_or(|of| of == *name) {
                        gear.set(key, *value)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Replaces the stiffness of a contact: constant, or a parabola if slope and curvature are known.
    fn stiffen(&self, stiffness: &mut PairStiffness) {
        let (before, course, of) = match *stiffness {
            PairStiffness::Constant { per_width, of } => (Some(per_width), [0.0; 2], of),
            PairStiffness::Parabola {
                per_width,
                along,
                of,
            } => (Some(per_width), along, of),
            PairStiffness::Table { of, .. } => (None, [0.0; 2], of),
            _ => (None, [0.0; 2], PairOrMesh::Pair),
        };
        let along = [
            self.slope.unwrap_or(course[0]),
            self.curvature.unwrap_or(course[1]),
        ];
        let changed = [self.stiffness, self.slope, self.curvature];
        if let Some(per_width) = self.stiffness.or(before)
            && changed.iter().any(Option::is_some)
        {
            *stiffness = match along == [0.0; 2] {
                true => PairStiffness::Constant { per_width, of },
                false => PairStiffness::Parabola {
                    per_width,
                    along,
                    of,
                },
            };
        }
    }
}

/// Contents of a calibration file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calibration {
    /// Constants by calibration name and model label.
    pub sets: BTreeMap<String, BTreeMap<String, Constants>>,
}

/// A constant for all gears, constants by gear, or the names of the fitted references.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum OneOrOfGear {
    /// Names of references, under `fitted_to`.
    #[serde(rename = "<list>")]
    Names(Vec<String>),
    /// A constant of all gears.
    #[serde(rename = "<number>")]
    One(f64),
    /// Constants of one gear by key.
    #[serde(rename = "<table>")]
    OfGear(OrderedTable<f64>),
}

/// Tables of constants by name of the calibration and label of the model.
pub(super) type Sets = OrderedTable<OrderedTable<OrderedTable<OneOrOfGear>>>;

/// Flattens nested constants to keys with their places in the file.
fn flat<'a>(values: OrderedTable<OneOrOfGear>, at: &Place<'a>) -> Vec<(String, f64, Place<'a>)> {
    let of = |(key, value): (String, OneOrOfGear)| match value {
        OneOrOfGear::One(x) => {
            let at = at.key(&key);
            vec![(key, x, at)]
        }
        OneOrOfGear::OfGear(own) => {
            let of =
                |(name, x): (String, f64)| (format!("{key}.{name}"), x, at.key(&key).key(&name));
            own.0.into_iter().map(of).collect()
        }
        OneOrOfGear::Names(_) => Vec::new(),
    };
    values.0.into_iter().flat_map(of).collect()
}

impl Calibration {
    /// Reads a calibration file.
    ///
    /// # Errors
    /// [`SceneError`] for anything but tables of positive numbers (a gap may have any sign).
    pub fn parse(name: &str, text: &str) -> Result<Self, SceneError> {
        let (document, sets): (_, Sets) = Document::read(name, text, |_| Vec::new())?;
        Self::of(sets, &document.at(""))
    }

    /// Reads the tables of constants at a place of a file.
    ///
    /// # Errors
    /// [`SceneError`] at an unknown name, or a constant that is not positive.
    pub(super) fn of(sets: Sets, at: &Place<'_>) -> Result<Self, SceneError> {
        let mut calibration = Calibration::default();
        for (set, labels) in sets.0 {
            if !NAMES.contains(&set.as_str()) {
                return at.key(&set).refuse(
                    format!("unknown calibration `{set}`"),
                    "unknown name",
                    suggest::there_are(&set, &NAMES),
                );
            }
            let mut constants = BTreeMap::new();
            for (label, values) in labels.0 {
                let at = at.key(&set).key(&label);
                let mut fitted_to = Vec::new();
                for (key, value) in &values.0 {
                    match value {
                        OneOrOfGear::Names(names) if key == FITTED_TO => {
                            fitted_to.clone_from(names);
                        }
                        OneOrOfGear::Names(_) => {
                            return at.key(key).refuse(
                                format!("`{key}` is a list"),
                                "expected a number",
                                format!("only `{FITTED_TO}` is a list, of the fitted references"),
                            );
                        }
                        OneOrOfGear::One(_) | OneOrOfGear::OfGear(_) => {}
                    }
                }
                let values = flat(values, &at);
                // A gap and the course along the path may have any sign, a damper be none.
                let wrong = |key: &str, x: f64| {
                    ![GAP, SLOPE, CURVATURE].contains(&key)
                        && (x < 0.0 || x == 0.0 && !key.ends_with(DAMPER))
                };
                if let Some((key, x, at)) = values.iter().find(|(key, x, _)| wrong(key, *x)) {
                    return at.refuse(
                        format!("`{key}` is {x}"),
                        "expected more than 0",
                        "write the file again with `gearbench identify SCENE --write`",
                    );
                }
                let values = values.iter().map(|(key, x, _)| (key.as_str(), *x));
                let of_label = Constants {
                    fitted_to,
                    ..Constants::of(values)
                };
                constants.insert(label, of_label);
            }
            calibration.sets.insert(set, constants);
        }
        Ok(calibration)
    }

    /// The constants of a label.
    pub fn get(&self, name: &str, label: &str) -> Option<&Constants> {
        self.sets.get(name)?.get(label)
    }

    /// Adds the constants of another calibration for models that have none here.
    #[must_use]
    pub(super) fn or(mut self, other: &Calibration) -> Calibration {
        for (name, labels) in &other.sets {
            let own = self.sets.entry(name.clone()).or_default();
            for (label, constants) in labels {
                own.entry(label.clone())
                    .or_insert_with(|| constants.clone());
            }
        }
        self
    }

    /// The calibration as TOML; numbers keep all digits.
    pub fn to_toml(&self) -> String {
        let of_label = |(label, c): (&String, &Constants)| (label.clone(), c.into());
        let of_set = |labels: &BTreeMap<String, Constants>| {
            OrderedTable(labels.iter().map(of_label).collect())
        };
        let sets = self
            .sets
            .iter()
            .map(|(name, labels)| (name.clone(), of_set(labels)));
        let sets: Sets = OrderedTable(sets.collect());
        // Names, numbers and lists of names can all be written.
        document_of(&sets).map_or_else(|e| format!("# {e}\n"), |d| d.to_string())
    }
}

impl From<&Constants> for OrderedTable<OneOrOfGear> {
    fn from(constants: &Constants) -> Self {
        let mut all: Vec<(String, OneOrOfGear)> = Vec::new();
        for (key, x) in constants.by_key() {
            let (gear, key) = of_gear(&key);
            let Some(gear) = gear else {
                all.push((key.to_owned(), OneOrOfGear::One(x)));
                continue;
            };
            let of = all.iter().position(|(name, _)| name == gear);
            let of = of.unwrap_or_else(|| {
                let none = OneOrOfGear::OfGear(OrderedTable::default());
                all.push((gear.to_owned(), none));
                all.len() - 1
            });
            if let OneOrOfGear::OfGear(own) = &mut all[of].1 {
                own.0.push((key.to_owned(), x));
            }
        }
        if !constants.fitted_to.is_empty() {
            let names = OneOrOfGear::Names(constants.fitted_to.clone());
            all.push((FITTED_TO.to_owned(), names));
        }
        OrderedTable(all)
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
            (SLOPE, -0.04),
            (CURVATURE, 0.1),
            ("tooth_mass_kg", 4.8e-3),
            ("pinion.tooth_mass_kg", 3.8e-3),
            ("odd \"gear\".tooth_mass_kg", 2.8e-3),
        ]);
        let constants = Constants {
            fitted_to: vec!["calculix/case-a".into(), "odd \"name\"".into()],
            ..constants
        };
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
        assert!(
            refuse("[impact.rigid]\ngap_m = [\"calculix\"]")
                .message()
                .contains("`gap_m` is a list")
        );
    }
}
