//! The keys `reference` and `[[references]]`: data that the models of a scene are compared with, and fitted to.
//!
//! | module | owns |
//! |---|---|
//! | `columns` | columns and units of a table by gear and mesh |
//! | [`conditions`] | conditions that differ from the scene, and the scene under them |
//! | `loaded_reference` | data of references, and their stated conditions compared with the scene |
//! | `stored` | a stored reference compared with the gears of the scene |
//! | `table` | reading of tables, and the quantities of their columns |
//!
//! A reference under the conditions of the scene serves studies for comparison; one under other conditions (speeds,
//! loads, distances) serves identification, with the scene under these conditions ([`SceneFile::with`]).

pub(super) mod columns;
pub mod conditions;
pub mod loaded_reference;
mod stored;
mod table;

pub use conditions::{ConditionsOfGear, ReferenceConditions};
pub use loaded_reference::LoadedReference;
pub use table::subjects;

use super::reading::Place;
use super::reading::keys::keys;
use super::reading::suggest::there_are;
use super::reading::values::{OrderedTable, Positive, Share, is_default};
use super::{SceneError, SceneFile};
use columns::{ColumnTable, UnitTable};
use conditions::GearConditionTable;
use gearbench_models::spec::SceneSpec;
use gearbench_reference::REFERENCES;
use gearbench_reference::data::{Delimiter, Request};
use gearbench_reports::record::SELF;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

keys! {
    /// Data that models are compared with or fitted to.
    #[derive(Default)]
    struct ReferenceTable {
        /// name in records and in `tolerance`, default the program of a stored one, else the name of the file
        name: Option<String>,
        /// id of a stored reference, for example "calculix/case-a-fine"
        stored: Option<String>,
        /// CSV file with a line of names, its path from the folder of the scene, for example "press.csv"
        csv: Option<String>,
        /// name for legends, default `name`
        title: Option<String>,
        /// where the data come from, one line
        source: Option<String>,
        /// names of columns: { time = "t [ms]", force = "Fn [kN]", speed.pinion = "n1 [1/min]" }, default those that are known by their names
        columns: Option<ColumnTable>,
        /// units where the header has none or another: { time = "ms", force = "kN", speed = "1/min" }
        units: Option<UnitTable>,
        /// "normal" (default) or "transverse", the part of the contact force in the plane of rotation
        force_kind: Option<ForceKindWord>,
        /// "comma", "semicolon" or "tab" between columns, default what the line of names has
        delimiter: Option<DelimiterWord>,
        /// "point" or "comma" in numbers, default what they have
        decimal: Option<DecimalWord>,
        /// factor on all times, before the offset, for a recorder whose clock runs fast or slow, default 1
        time_factor: Option<Positive>,
        /// added to all times in seconds, default 0; the scene begins at 0
        #[serde(default, skip_serializing_if = "is_default")]
        offset_s: f64,
        /// first and last time in seconds, after the offset, of a part whose mean is subtracted from all values
        zero_over_s: Option<[f64; 2]>,
        /// first time that is used in seconds, after the offset, default 0
        from_s: Option<f64>,
        /// last time that is used in seconds, default the end of the scene
        to_s: Option<Positive>,
        /// width of a centred moving average of the reference in seconds, default none
        moving_average_s: Option<Positive>,
        /// step of even times in seconds to which the reference is interpolated, default its own times
        resample_s: Option<Positive>,
        /// own error of the reference, as a share of the quantities that models are compared in, for example 0.02 of
        /// measured forces; default what a stored one states, else not stated
        own_error: Option<Share>,
        /// "fit" (default) or "validate": held out of identification, and told there
        role: Option<Role>,
        /// simulated time of this reference in seconds, default the scene's
        duration_s: Option<Positive>,
        /// gap at the start of this reference in metres, default the scene's
        gap_m: Option<f64>,
        /// path coordinate at its start in metres, default the scene's
        path_coordinate_m: Option<f64>,
        /// centre distance of this reference in metres, default the scene's
        centre_distance_m: Option<Positive>,
        /// conditions that differ at gears: { pinion = { speed_rad_s = 40.0, torque_nm = 20.0 } }
        #[serde(default, skip_serializing_if = "is_default")]
        gears: OrderedTable<GearConditionTable>,
    }
}

/// A reference by name or file, or by its table of keys.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum ReferenceChoice {
    /// Id of a stored reference, or path of a table.
    #[serde(rename = "<text>")]
    Text(String),
    /// A reference by its keys.
    #[serde(rename = "<table>")]
    Table(Box<ReferenceTable>),
}

/// Kind of the contact force in a table.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ForceKindWord {
    /// The force normal to the flanks.
    Normal,
    /// Its part in the plane of rotation.
    Transverse,
}

/// Sign between columns.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DelimiterWord {
    /// Commas.
    Comma,
    /// Semicolons.
    Semicolon,
    /// Tabs.
    Tab,
}

impl DelimiterWord {
    /// Returns the delimiter.
    pub(super) fn delimiter(self) -> Delimiter {
        match self {
            DelimiterWord::Comma => Delimiter::Comma,
            DelimiterWord::Semicolon => Delimiter::Semicolon,
            DelimiterWord::Tab => Delimiter::Tab,
        }
    }
}

/// Decimal sign.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DecimalWord {
    /// A point.
    Point,
    /// A comma.
    Comma,
}

/// Use of a reference in an identification.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Constants are fitted to the reference.
    #[default]
    Fit,
    /// The reference is held out and serves to validate constants fitted to others.
    Validate,
}

/// Origin of the data of a reference.
#[derive(Clone, Debug, PartialEq)]
pub enum DataOrigin {
    /// A reference stored in the program, by its id.
    Stored(String),
    /// A table of the user, or one written by `gearbench reference`.
    Csv {
        /// Path of the table.
        path: PathBuf,
        /// Columns, units and separators of the table.
        request: Box<Request>,
    },
}

/// A reference of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedReference {
    /// Id in records, metrics and tolerances.
    pub name: String,
    /// Name for legends, if the scene gives one.
    pub title: Option<String>,
    /// Source of the data, if the scene gives one.
    pub source: Option<String>,
    /// Origin of the data.
    pub origin: DataOrigin,
    /// Error of the reference itself, if the scene gives it [-].
    pub own_error: Option<f64>,
    /// Use of the reference in an identification.
    pub role: Role,
    /// Conditions that differ from the scene.
    pub conditions: ReferenceConditions,
    /// Path of the reference in the scene file.
    pub(super) at: String,
}

impl NamedReference {
    /// The id of a stored reference; `None` for a table.
    pub fn stored(&self) -> Option<&str> {
        match &self.origin {
            DataOrigin::Stored(id) => Some(id),
            DataOrigin::Csv { .. } => None,
        }
    }

    /// The path of a table; `None` for a stored reference.
    pub fn file(&self) -> Option<&Path> {
        match &self.origin {
            DataOrigin::Stored(_) => None,
            DataOrigin::Csv { path, .. } => Some(path),
        }
    }

    /// Index among `[[references]]`; `None` for the key `reference`.
    pub fn index(&self) -> Option<usize> {
        let inner = self.at.strip_prefix("references[")?;
        inner.strip_suffix(']')?.parse().ok()
    }

    /// True if the reference has the conditions of the scene itself.
    pub fn is_of_the_scene(&self) -> bool {
        self.conditions == ReferenceConditions::default()
    }
}

/// Parts of the scene that its references are checked against.
pub(super) struct SceneParts<'a> {
    pub spec: &'a SceneSpec,
    pub labels: &'a [&'a str],
    pub folder: Option<&'a Path>,
    pub duration: f64,
}

/// Checks all references of a scene; their data are read when a study needs them.
pub(super) fn references(
    one: Option<ReferenceChoice>,
    several: Vec<ReferenceTable>,
    beside: &SceneParts<'_>,
    root: &Place<'_>,
) -> Result<Vec<NamedReference>, SceneError> {
    let mut all: Vec<NamedReference> = Vec::new();
    let one = one.map(|choice| match choice {
        ReferenceChoice::Table(keys) => (*keys, "reference".to_owned()),
        ReferenceChoice::Text(text) => (short(text), "reference".to_owned()),
    });
    let several = (several.into_iter().enumerate()).map(|(i, k)| (k, format!("references[{i}]")));
    for (keys, at) in one.into_iter().chain(several) {
        let place = root.at(&at);
        let found = named(keys, beside, &place, at)?;
        let own = ["name", "stored", "csv"];
        if let Some(other) = all.iter().find(|other| other.name == found.name) {
            return Err(place.first(&own).against(
                (&root.at(&other.at).first(&own), "first here"),
                format!("two references are called \"{}\"", found.name),
                "again here",
                "give one of them another `name`",
            ));
        }
        if found.name == SELF || beside.labels.contains(&found.name.as_str()) {
            return place.first(&own).refuse(
                format!(
                    "the reference has the name \"{}\" of a model or of the converged solution",
                    found.name
                ),
                "not a unique name",
                "give it another `name`",
            );
        }
        all.push(found);
    }
    Ok(all)
}

/// Reads a reference given as one word: a path, or the id of a stored one.
fn short(text: String) -> ReferenceTable {
    let is_file = Path::new(&text).extension().is_some_and(|e| {
        ["csv", "tsv", "txt", "dat"]
            .iter()
            .any(|known| e.eq_ignore_ascii_case(known))
    });
    match is_file {
        true => ReferenceTable {
            csv: Some(text),
            ..ReferenceTable::default()
        },
        false => ReferenceTable {
            stored: Some(text),
            ..ReferenceTable::default()
        },
    }
}

fn named(
    keys: ReferenceTable,
    beside: &SceneParts<'_>,
    at: &Place<'_>,
    path: String,
) -> Result<NamedReference, SceneError> {
    let conditions = conditions::read(&keys, beside, at)?;
    let (origin, name) = match (&keys.stored, &keys.csv) {
        (Some(id), None) => {
            if !REFERENCES.iter().any(|r| r.id == id) {
                let known: Vec<String> = REFERENCES.iter().map(|r| r.id.to_owned()).collect();
                return at.first(&["stored"]).refuse(
                    format!("there is no reference `{}`", id),
                    "not known",
                    format!(
                        "{}; your own file is reference = {{ csv = \"press.csv\" }}",
                        there_are(id, &known)
                    ),
                );
            }
            let of_tables = [
                "columns",
                "units",
                "force_kind",
                "delimiter",
                "decimal",
                "time_factor",
                "offset_s",
                "zero_over_s",
                "from_s",
                "to_s",
                "moving_average_s",
                "resample_s",
            ];
            if let Some(key) = of_tables.into_iter().find(|key| at.has(key)) {
                return at.key(key).refuse(
                    format!("`{key}` applies to a table, but the reference is a stored one"),
                    "no effect",
                    "remove it",
                );
            }
            let program = id.split('/').next().unwrap_or(id);
            (DataOrigin::Stored(id.clone()), program.to_owned())
        }
        (None, Some(file)) => {
            let path = located(file, beside.folder);
            let stem = Path::new(file)
                .file_stem()
                .map(|s| s.to_string_lossy().into_owned());
            let request = Box::new(table::request(&keys, &conditions, beside, at)?);
            (DataOrigin::Csv { path, request }, stem.unwrap_or_default())
        }
        (Some(_), Some(_)) => {
            return Err(at.key("csv").against(
                (&at.key("stored"), "this"),
                "a stored reference and a file are both given",
                "and this",
                "remove one, or give each its own [[references]]",
            ));
        }
        (None, None) => {
            return at.refuse(
                "the reference does not specify its data",
                "here",
                "add `csv = \"press.csv\"`, or `stored = \"calculix/case-a-fine\"` (`gearbench list`)",
            );
        }
    };
    let name = keys.name.unwrap_or(name).trim().to_owned();
    if name.is_empty() || name.chars().count() > 60 || name.chars().any(char::is_control) {
        return at.first(&["name", "csv"]).refuse(
            "the name of a reference has to be a short text in one line",
            "not a valid name",
            "give it a `name`, for example \"press\"",
        );
    }
    let line = |text: Option<String>| text.map(|t| t.trim().to_owned()).filter(|t| !t.is_empty());
    Ok(NamedReference {
        name,
        title: line(keys.title),
        source: line(keys.source),
        origin,
        own_error: keys.own_error.map(|e| e.0),
        role: keys.role.unwrap_or_default(),
        conditions,
        at: path,
    })
}

/// Path of a file relative to the folder of the scene file, else to the working folder.
pub(super) fn located(file: &str, folder: Option<&Path>) -> PathBuf {
    let beside = folder.map(|folder| folder.join(file));
    match beside {
        Some(beside) if beside.exists() || !Path::new(file).exists() => beside,
        _ => PathBuf::from(file),
    }
}

impl SceneFile {
    /// The first reference under the conditions of the scene itself, which is the main one for comparisons.
    pub fn reference(&self) -> Option<&NamedReference> {
        self.references.iter().find(|r| r.is_of_the_scene())
    }
}
