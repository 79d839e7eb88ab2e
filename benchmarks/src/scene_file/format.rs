//! The scene file as a value: tables that are read, made by a program, changed, and written.
//!
//! ```
//! use gearbench::context::Context;
//! use gearbench::scene_file::format::*;
//!
//! let gear = |teeth, speed| GearTable {
//!     teeth,
//!     module_m: 4e-3,
//!     face_width_m: 10e-3,
//!     speed_rad_s: Some(speed),
//!     ..GearTable::default()
//! };
//! let scene = SceneTable {
//!     name: SceneName("pair".into()),
//!     duration_s: Positive(1e-3),
//!     gears: [("pinion", gear(20, 60.0)), ("wheel", gear(30, 0.0))].into_iter().collect(),
//!     meshes: vec![MeshTable {
//!         gears: ["pinion".into(), "wheel".into()],
//!         centre_distance_m: Some(Positive(0.1002)),
//!         ..MeshTable::default()
//!     }],
//!     models: vec![ModelTable {
//!         model: "rigid".into(),
//!         contact: OneOrMany::One(ContactTable {
//!             stiffness: Some(StiffnessTable::Iso6336(IsoTable::default())),
//!             ..ContactTable::default()
//!         }),
//!         ..ModelTable::default()
//!     }],
//!     ..SceneTable::default()
//! };
//! let file = scene.load(&Context::default()).unwrap();
//! assert_eq!(file.spec.gears[1].name, "wheel");
//! assert_eq!(SceneTable::parse(&Context::default(), "pair.toml", file.text()).unwrap(), scene);
//! ```
//!
//! A value is checked when the scene is loaded: a table that a program makes is refused by the text of its file, with
//! line, key and way out.

pub use super::SceneTable;
pub use super::calibration::OneOrOfGear;
pub use super::calibration_choice::{CalibrationChoice, CalibrationTable};
pub use super::changes::{KeyPath, set_at};
pub use super::contact::{ContactTable, FilmTable, FrictionTable};
pub use super::contact_points::{LawWord, LocalContact, PointTable, PointsChoice};
pub use super::damping::SharedDampingTable;
pub use super::deviations::{DeviationTable, FlankTable};
pub use super::gear::{GearTable, RackTable, ReliefTable, ToothedTable};
pub use super::material::{MaterialChoice, MaterialTable};
pub use super::mesh::{MeshTable, StartTable};
pub use super::model::{GearModelEntry, GearModelTable, ModelLabel, ModelTable, ParameterValue};
pub use super::modifications::{
    AmountTable, EndReliefTable, EndTable, PerSide, SideTable, TopographyTable,
};
pub use super::out_of_plane::{
    BearingTable, DirectionTable, MisalignmentTable, Position, Tilt, Translation,
};
pub use super::profile::*;
pub use super::reading::serializer::WriteError;
pub use super::reading::serializer::number;
pub(crate) use super::reading::serializer::to_value;
pub use super::reading::values::*;
pub use super::references::ReferenceTable;
pub use super::shaft::{SectionTable, ShaftTable, StationTable};
pub use super::stiffness::{
    ComplianceTable, ConstantTable, FoundationWord, HertzWord, IsoTable, ParabolaTable,
    StiffnessTable, TabulatedTable,
};
pub use super::study_plan::{IntegratorTable, StudyTable, ToleranceChoice, ToleranceTable};
pub use super::{SceneName, Schema};
pub use gearbench_models::law::Damping;

use super::reading::Document;
use super::reading::keys;
use super::{Origin, SceneError, SceneFile, known_words};
use crate::context::Context;
use serde::Serialize;
use serde::ser::Error as _;
use toml_edit::{ArrayOfTables, DocumentMut, InlineTable, Item, Table, Value};

/// A key of a table, as it is declared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyDescription {
    /// Name of the key with its unit.
    pub name: &'static str,
    /// Meaning, unit and default.
    pub meaning: String,
    /// The Rust type into which its value is read.
    pub type_name: &'static str,
    /// True if a file must have the key.
    pub is_required: bool,
}

/// A table of the format with its keys.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableDescription {
    /// Name of the type into which the table is read, for example `GearTable`.
    pub name: &'static str,
    /// The keys in the order of their declaration.
    pub keys: Vec<KeyDescription>,
}

/// Returns the descriptions of all tables of scene files and check files.
#[must_use]
pub fn tables() -> Vec<TableDescription> {
    let of_key = |((name, meaning), (type_name, attributes)): (
        &(&'static str, &str),
        &(&'static str, &str),
    )| {
        KeyDescription {
            name,
            meaning: meaning.split_whitespace().collect::<Vec<_>>().join(" "),
            type_name,
            is_required: !type_name.starts_with("Option") && !attributes.starts_with("default"),
        }
    };
    let of_table = |table: &keys::Table| TableDescription {
        name: table.name,
        keys: table.keys.iter().zip(table.types).map(of_key).collect(),
    };
    keys::tables().map(of_table).collect()
}

/// Reads the text of one table alone by the name of its type, also of the choices [`StiffnessTable`], [`Damping`],
/// [`GearLoad`] and [`RackLoad`]. The names of gears and models may be any, as the scene defines them. `None` if there
/// is no such type.
///
/// # Errors
/// [`SceneError`] with the line of the text.
pub fn check_table(type_name: &str, name: &str, text: &str) -> Option<Result<(), SceneError>> {
    fn read<T: serde::de::DeserializeOwned>(name: &str, text: &str) -> Result<(), SceneError> {
        Document::read::<T>(name, text, |_| Vec::new()).map(|_| ())
    }
    let check = match type_name {
        "StiffnessTable" => read::<StiffnessTable>,
        "Damping" => read::<Damping>,
        "GearLoad" => read::<GearLoad>,
        "RackLoad" => read::<RackLoad>,
        _ => keys::tables().find(|t| t.name == type_name)?.check,
    };
    Some(check(name, text))
}

impl SceneTable {
    /// Reads the tables of a scene file, each value by itself.
    ///
    /// # Errors
    /// [`SceneError`] with line and help.
    pub fn parse(context: &Context, name: &str, text: &str) -> Result<Self, SceneError> {
        Self::read(context, name, text).map(|(_, tables)| tables)
    }

    /// Reads the tables of a scene file with the places of all values.
    pub(super) fn read(
        context: &Context,
        name: &str,
        text: &str,
    ) -> Result<(Document, Self), SceneError> {
        Document::read(name, text, |scene| known_words(scene, &context.models))
    }

    /// Writes the scene file: one table under a header for each gear, mesh, shaft, reference and model.
    ///
    /// # Errors
    /// [`WriteError`] for a whole number that TOML cannot have.
    pub fn to_toml(&self) -> Result<String, WriteError> {
        Ok(document_of(self)?.to_string())
    }

    /// Writes and loads the scene; its name is that of the file in errors.
    ///
    /// # Errors
    /// [`SceneError`] with the line of the text that was written.
    pub fn load(&self, context: &Context) -> Result<SceneFile, SceneError> {
        let help = "give whole numbers below 2^63";
        let text = self.to_toml();
        let text = text.map_err(|e| SceneError::plain(e.to_string(), help))?;
        let name = format!("{}.toml", self.name.0);
        SceneFile::parse(context, &name, &text, Origin::Shipped, true)
    }
}

/// Lays the tables of a scene out as its file has them: one table under a header for each gear, mesh, shaft, reference
/// and model.
#[must_use]
pub fn laid_out(tables: InlineTable) -> DocumentMut {
    let mut document = DocumentMut::new();
    for (key, value) in tables {
        let is_plain = |list: &toml_edit::Array| list.iter().any(|m| !m.is_inline_table());
        let item = match value {
            // The reader refuses such a list with its line.
            Value::Array(list) if is_plain(&list) => Item::Value(list.into()),
            value => with_headers(&key, value),
        };
        document.insert(&key, item);
    }
    document
}

/// Writes the parts of a file.
///
/// # Errors
/// [`WriteError`] for what TOML cannot have, or no table.
pub(crate) fn document_of(parts: &impl Serialize) -> Result<DocumentMut, WriteError> {
    let Some(Value::InlineTable(all)) = to_value(parts)? else {
        return Err(WriteError::custom("the file is no table"));
    };
    let mut document = DocumentMut::new();
    for (key, value) in all {
        document.insert(&key, with_headers(&key, value));
    }
    Ok(document)
}

/// Puts a part of a scene into a document: a value, or tables under headers of their own.
///
/// # Errors
/// [`WriteError`] for what TOML cannot have.
pub(crate) fn insert(
    document: &mut DocumentMut,
    key: &str,
    part: &impl Serialize,
) -> Result<(), WriteError> {
    if let Some(value) = to_value(part)? {
        document.insert(key, with_headers(key, value));
    }
    Ok(())
}

impl<'k, T, U: Into<T>> FromIterator<(&'k str, U)> for OrderedTable<T> {
    fn from_iter<I: IntoIterator<Item = (&'k str, U)>>(entries: I) -> Self {
        let entries = entries.into_iter();
        OrderedTable(
            entries
                .map(|(name, x)| (name.to_owned(), x.into()))
                .collect(),
        )
    }
}

impl From<GearTable> for ToothedTable {
    fn from(gear: GearTable) -> Self {
        ToothedTable::Gear(Box::new(gear))
    }
}

impl From<RackTable> for ToothedTable {
    fn from(rack: RackTable) -> Self {
        ToothedTable::Rack(Box::new(rack))
    }
}

impl From<f64> for ParameterValue {
    fn from(x: f64) -> Self {
        ParameterValue::Number(x)
    }
}

impl From<&str> for ParameterValue {
    fn from(x: &str) -> Self {
        ParameterValue::Text(x.to_owned())
    }
}

impl From<bool> for ParameterValue {
    fn from(x: bool) -> Self {
        ParameterValue::Flag(x)
    }
}

impl<T> From<T> for OneOrMany<T> {
    fn from(one: T) -> Self {
        OneOrMany::One(one)
    }
}

/// A value as it stands in the file: `[study]`, `[gears.NAME]`, `[impact.LABEL]` and `[[meshes]]` under headers,
/// everything else in one line.
fn with_headers(key: &str, value: Value) -> Item {
    let named = |named: InlineTable, below: &dyn Fn(Value) -> Item| {
        let mut all = Table::new();
        all.set_implicit(true);
        for (name, value) in named {
            all.insert(&name, below(value));
        }
        Item::Table(all)
    };
    let fields = |value: Value| match value {
        Value::InlineTable(own) => {
            let mut table = own.into_table();
            table.fmt();
            Item::Table(table)
        }
        other => Item::Value(other),
    };
    match (key, value) {
        ("calibration", Value::InlineTable(sets)) => {
            named(sets, &|labels| with_headers("gears", labels))
        }
        ("study", own @ Value::InlineTable(_)) => fields(own),
        ("reference" | "tolerance" | "damping", value) => Item::Value(value),
        (_, Value::InlineTable(all)) => named(all, &fields),
        (_, Value::Array(list)) => {
            let tables = list
                .into_iter()
                .filter_map(|member| fields(member).into_table().ok());
            Item::ArrayOfTables(tables.collect::<ArrayOfTables>())
        }
        (_, value) => Item::Value(value),
    }
}
