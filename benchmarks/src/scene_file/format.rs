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
pub use super::contact::{
    ContactTable, DamperTable, DampingTable, FilmTable, FrictionTable, RatioTable, RestitutionTable,
};
pub use super::contact_points::{PointLaw, PointTable, PointsChoice};
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
pub use super::reading::values::*;
pub use super::references::ReferenceTable;
pub use super::shaft::{SectionTable, ShaftTable, StationTable};
pub use super::stiffness::{
    ComplianceTable, ConstantTable, FoundationWord, HertzWord, IsoTable, ParabolaTable,
    StiffnessTable, TabulatedTable,
};
pub use super::study_plan::{IntegratorTable, StudyTable, ToleranceChoice, ToleranceTable};
pub use super::{SceneName, Schema};

use super::reading::Document;
use super::reading::serializer::to_value;
use super::{Origin, SceneError, SceneFile, known_words};
use crate::context::Context;
use serde::ser::Error as _;
use toml_edit::{ArrayOfTables, DocumentMut, InlineTable, Item, Table, Value};

impl SceneTable {
    /// Reads the tables of a scene file, each value by itself.
    ///
    /// # Errors
    /// [`SceneError`] with line and help.
    pub fn parse(context: &Context, name: &str, text: &str) -> Result<Self, SceneError> {
        let read = Document::read(name, text, |scene| known_words(scene, &context.models));
        read.map(|(_, tables)| tables)
    }

    /// Writes the scene file: one table under a header for each gear, mesh, shaft, reference and model.
    ///
    /// # Errors
    /// [`WriteError`] for a number that is not finite.
    pub fn to_toml(&self) -> Result<String, WriteError> {
        let Some(Value::InlineTable(all)) = to_value(self)? else {
            return Err(WriteError::custom("the scene is no table"));
        };
        let mut document = DocumentMut::new();
        for (key, value) in all {
            document.insert(&key, with_headers(&key, value));
        }
        Ok(document.to_string())
    }

    /// Writes and loads the scene; its name is that of the file in errors.
    ///
    /// # Errors
    /// [`SceneError`] with the line of the text that was written.
    pub fn load(&self, context: &Context) -> Result<SceneFile, SceneError> {
        let text = self.to_toml().map_err(|e| {
            SceneError::plain(
                e.to_string(),
                "give finite numbers in the units of the keys",
            )
        })?;
        let name = format!("{}.toml", self.name.0);
        SceneFile::parse(context, &name, &text, Origin::Shipped, true)
    }
}

impl<T> FromIterator<(&'static str, T)> for OrderedTable<T> {
    fn from_iter<I: IntoIterator<Item = (&'static str, T)>>(entries: I) -> Self {
        let entries = entries.into_iter().map(|(name, x)| (name.to_owned(), x));
        OrderedTable(entries.collect())
    }
}

/// Parts of a scene that stand under headers of their own.
const UNDER_HEADERS: [&str; 7] = [
    "gears",
    "meshes",
    "shafts",
    "models",
    "references",
    "study",
    "calibration",
];

/// A value as it stands in the file: `[study]`, `[gears.NAME]`, `[[meshes]]`, everything else in one line.
fn with_headers(key: &str, value: Value) -> Item {
    let fields = |table: InlineTable| {
        let mut table = table.into_table();
        table.fmt();
        table
    };
    match value {
        Value::InlineTable(named) if ["gears", "calibration"].contains(&key) => {
            let mut all = Table::new();
            all.set_implicit(true);
            for (name, value) in named {
                let item = match value {
                    Value::InlineTable(labels) if key == "calibration" => {
                        with_headers("gears", Value::InlineTable(labels))
                    }
                    Value::InlineTable(own) => Item::Table(fields(own)),
                    other => Item::Value(other),
                };
                all.insert(&name, item);
            }
            Item::Table(all)
        }
        Value::InlineTable(own) if UNDER_HEADERS.contains(&key) => Item::Table(fields(own)),
        Value::Array(list) if UNDER_HEADERS.contains(&key) => {
            let tables = list.into_iter().filter_map(|member| match member {
                Value::InlineTable(own) => Some(fields(own)),
                _ => None,
            });
            Item::ArrayOfTables(tables.collect::<ArrayOfTables>())
        }
        other => Item::Value(other),
    }
}
