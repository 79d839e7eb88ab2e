//! Tables of keys of the scene format.

use super::super::SceneKeys;
use super::super::{
    calibration_choice, contact, contact_points, deviations, gear, material, mesh, model,
    modifications, out_of_plane, profile, references, shaft, stiffness, study_plan,
};
use crate::studies::{check, precision, stability, sweep};

/// The keys of a table with their meanings, units and examples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Table {
    /// Name of the struct into which the table is read.
    pub(crate) name: &'static str,
    /// Each key with its meaning.
    pub(crate) keys: &'static [(&'static str, &'static str)],
}

impl Table {
    /// The meaning of a key; empty for an unknown key.
    pub(super) fn meaning(&self, key: &str) -> &'static str {
        let found = self.keys.iter().find(|(k, _)| *k == key);
        found.map_or("", |(_, meaning)| meaning.trim_start())
    }
}

/// Iterates over all tables of the format.
pub(crate) fn tables() -> impl Iterator<Item = &'static Table> {
    [
        &SceneKeys::TABLE,
        &gear::GearKeys::TABLE,
        &gear::RackKeys::TABLE,
        &gear::ReliefKeys::TABLE,
        &out_of_plane::BearingKeys::TABLE,
        &out_of_plane::DirectionKeys::TABLE,
        &out_of_plane::MisalignmentKeys::TABLE,
        &modifications::EndReliefKeys::TABLE,
        &modifications::EndKeys::TABLE,
        &modifications::SideKeys::TABLE,
        &modifications::TopographyKeys::TABLE,
        &deviations::DeviationKeys::TABLE,
        &deviations::FlankKeys::TABLE,
        &material::MaterialKeys::TABLE,
        &mesh::MeshKeys::TABLE,
        &mesh::StartKeys::TABLE,
        &shaft::ShaftKeys::TABLE,
        &shaft::StationKeys::TABLE,
        &shaft::SectionKeys::TABLE,
        &model::ModelKeys::TABLE,
        &model::GearModelKeys::TABLE,
        &references::ReferenceKeys::TABLE,
        &references::columns::ColumnKeys::TABLE,
        &references::columns::UnitKeys::TABLE,
        &references::conditions::GearConditionKeys::TABLE,
        &calibration_choice::CalibrationKeys::TABLE,
        &contact::ContactKeys::TABLE,
        &contact_points::PointKeys::TABLE,
        &contact::DamperKeys::TABLE,
        &contact::RatioKeys::TABLE,
        &contact::RestitutionKeys::TABLE,
        &contact::FrictionKeys::TABLE,
        &contact::FilmKeys::TABLE,
        &stiffness::ConstantKeys::TABLE,
        &stiffness::ParabolaKeys::TABLE,
        &stiffness::IsoKeys::TABLE,
        &stiffness::ComplianceKeys::TABLE,
        &stiffness::TableKeys::TABLE,
        &study_plan::StudyKeys::TABLE,
        &study_plan::IntegratorKeys::TABLE,
        &study_plan::ToleranceKeys::TABLE,
        &sweep::scene::Sweep::TABLE,
        &precision::scene::PrecisionKeys::TABLE,
        &stability::scene::StabilityKeys::TABLE,
        &stability::scene::SpanKeys::TABLE,
        &stability::scene::AxisKeys::TABLE,
        &check::file::CheckKeys::TABLE,
        &check::file::RuntimeKeys::TABLE,
        &check::file::DifferenceKeys::TABLE,
        &check::file::CaseKeys::TABLE,
    ]
    .into_iter()
    .chain(profile::TABLES)
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

/// Declares a table of the format: a struct for serde, whose fields are the keys and whose comments are their meanings.
macro_rules! keys {
    ($(
        $(#[$outer:meta])*
        $vis:vis struct $name:ident {
            $( $(#[doc = $doc:literal])* $(#[serde($($serde:tt)*)])* $field_vis:vis $field:ident: $type:ty, )*
        }
    )*) => { $(
        #[derive(Clone, Debug, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        $(#[$outer])*
        $vis struct $name {
            $( $(#[doc = $doc])* $(#[serde($($serde)*)])* $field_vis $field: $type, )*
        }

        impl $name {
            /// The keys of the table with their meanings.
            pub(crate) const TABLE: $crate::scene_file::reading::keys::Table =
                $crate::scene_file::reading::keys::Table {
                    name: stringify!($name),
                    keys: &[$((stringify!($field), concat!($($doc),*))),*],
                };
        }
    )* };
}
pub(crate) use keys;
