//! Tables of keys of the scene format.

use super::super::{SceneError, SceneTable};
use super::super::{
    calibration_choice, contact, contact_points, damping, deviations, gear, material, measured,
    mesh, model, modifications, out_of_plane, profile, references, shaft, stage, stiffness,
    study_plan,
};
use super::Document;
use crate::studies::{check, precision, stability, sweep};
use gearbench_models::law::{Damping, DampingKeys};
use std::sync::LazyLock;

/// The keys of a table with their meanings, units and examples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Table {
    /// Name of the struct into which the table is read.
    pub(crate) name: &'static str,
    /// Each key with its meaning.
    pub(crate) keys: &'static [(&'static str, &'static str)],
    /// The type of each key, and its attributes for serde, as they are declared.
    pub(crate) types: &'static [(&'static str, &'static str)],
    /// Reads the text of a table alone, whose names of gears and models may be any. The first argument is the name of
    /// the text in errors.
    pub(crate) check: fn(&str, &str) -> Result<(), SceneError>,
}

impl Table {
    /// The meaning of a key; empty for an unknown key.
    pub(super) fn meaning(&self, key: &str) -> &'static str {
        let found = self.keys.iter().find(|(k, _)| *k == key);
        found.map_or("", |(_, meaning)| meaning.trim_start())
    }
}

/// The keys of each damping law, which the law declares itself; the identifier is the name of the table.
static DAMPING_LAWS: LazyLock<Vec<Table>> = LazyLock::new(|| {
    let of_law = |law: &DampingKeys| Table {
        name: law.id,
        keys: law.keys,
        types: &[("f64", "")],
        check: |name, text| Document::read::<Damping>(name, text, |_| Vec::new()).map(|_| ()),
    };
    let with_keys = Damping::LAWS.iter().filter(|law| !law.keys.is_empty());
    with_keys.map(of_law).collect()
});

/// Iterates over all tables of the format.
pub(crate) fn tables() -> impl Iterator<Item = &'static Table> {
    [
        &SceneTable::TABLE,
        &gear::GearTable::TABLE,
        &gear::RackTable::TABLE,
        &gear::ReliefTable::TABLE,
        &out_of_plane::BearingTable::TABLE,
        &out_of_plane::DirectionTable::TABLE,
        &out_of_plane::MisalignmentTable::TABLE,
        &modifications::EndReliefTable::TABLE,
        &modifications::EndTable::TABLE,
        &modifications::SideTable::TABLE,
        &modifications::TopographyTable::TABLE,
        &deviations::DeviationTable::TABLE,
        &deviations::FlankTable::TABLE,
        &material::MaterialTable::TABLE,
        &mesh::MeshTable::TABLE,
        &mesh::StartTable::TABLE,
        &shaft::ShaftTable::TABLE,
        &shaft::StationTable::TABLE,
        &shaft::SectionTable::TABLE,
        &stage::StageTable::TABLE,
        &measured::MeasuredTable::TABLE,
        &model::ModelTable::TABLE,
        &model::GearModelTable::TABLE,
        &references::ReferenceTable::TABLE,
        &references::columns::ColumnTable::TABLE,
        &references::columns::UnitTable::TABLE,
        &references::conditions::GearConditionTable::TABLE,
        &calibration_choice::CalibrationTable::TABLE,
        &damping::SharedDampingTable::TABLE,
        &contact::ContactTable::TABLE,
        &contact_points::PointTable::TABLE,
        &contact::FrictionTable::TABLE,
        &contact::FilmTable::TABLE,
        &stiffness::ConstantTable::TABLE,
        &stiffness::ParabolaTable::TABLE,
        &stiffness::IsoTable::TABLE,
        &stiffness::ComplianceTable::TABLE,
        &stiffness::TabulatedTable::TABLE,
        &study_plan::StudyTable::TABLE,
        &study_plan::IntegratorTable::TABLE,
        &study_plan::ToleranceTable::TABLE,
        &sweep::scene::Sweep::TABLE,
        &precision::scene::PrecisionTable::TABLE,
        &stability::scene::StabilityTable::TABLE,
        &stability::scene::SpanTable::TABLE,
        &stability::scene::AxisTable::TABLE,
        &check::file::CheckTable::TABLE,
        &check::file::RuntimeTable::TABLE,
        &check::file::DifferenceTable::TABLE,
        &check::file::CaseTable::TABLE,
    ]
    .into_iter()
    .chain(profile::TABLES)
    .chain(DAMPING_LAWS.iter())
    .chain([&profile::TurningGuide::TABLE, &profile::SlidingGuide::TABLE])
}

/// Returns the table of a struct.
pub(super) fn table(name: &str) -> Option<&'static Table> {
    let found = tables().find(|t| t.name == name);
    assert!(
        !cfg!(test) || found.is_some() || name.is_empty(),
        "{name} is not among the tables"
    );
    found
}

/// Declares a table of the format: a struct that is read and written, whose fields are the keys with their units in their
/// names, and whose comments are their meanings.
macro_rules! keys {
    ($(
        $(#[$outer:meta])*
        struct $name:ident {
            $( $(#[doc = $doc:literal])* $(#[serde($($serde:tt)*)])* $field:ident: $type:ty, )*
        }
    )*) => { $(
        #[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
        #[serde(deny_unknown_fields)]
        $(#[$outer])*
        pub struct $name {
            $( $(#[doc = $doc])* $(#[serde($($serde)*)])* pub $field: $type, )*
        }

        impl $name {
            /// The keys of the table with their meanings.
            pub(crate) const TABLE: $crate::scene_file::reading::keys::Table =
                $crate::scene_file::reading::keys::Table {
                    name: stringify!($name),
                    keys: &[$((stringify!($field), concat!($($doc),*))),*],
                    types: &[$((stringify!($type), concat!($(stringify!($($serde)*)),*))),*],
                    check: |name, text| {
                        $crate::scene_file::reading::Document::read::<$name>(name, text, |_| Vec::new()).map(|_| ())
                    },
                };
        }
    )* };
}
pub(crate) use keys;
