//! The key `material` of a gear: a steel by name, or its constants.

use super::error::SceneError;
use super::reading::Place;
use super::reading::keys::keys;
use gearbench_models::stiffness::{Material, Property, StiffnessError};
use serde::{Deserialize, Serialize};

keys! {
    /// A material by its constants.
    struct MaterialTable {
        /// Young's modulus in pascal, for example 2.1e11
        young_pa: f64,
        /// Poisson's ratio, for example 0.3
        poisson: f64,
        /// density in kg/m^3, for example 7850
        density_kg_m3: f64,
    }
}

/// A steel by name, or a material by its constants.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MaterialChoice {
    /// Steel with 210 GPa.
    #[default]
    Steel,
    /// Steel with the constants of ISO 6336.
    SteelIso6336,
    /// A material by its constants.
    #[serde(rename = "<table>")]
    Own(MaterialTable),
}

/// Returns the material of a choice.
pub(super) fn material(choice: &MaterialChoice, at: &Place<'_>) -> Result<Material, SceneError> {
    let keys = match choice {
        MaterialChoice::Steel => return Ok(Material::STEEL),
        MaterialChoice::SteelIso6336 => return Ok(Material::STEEL_ISO),
        MaterialChoice::Own(keys) => keys,
    };
    let material = Material {
        young: keys.young_pa,
        poisson: keys.poisson,
        density: keys.density_kg_m3,
    };
    material.check().map_err(|e| {
        let key = match &e {
            StiffnessError::Material { property, .. } => match property {
                Property::Young => "young_pa",
                Property::Poisson => "poisson",
                Property::Density => "density_kg_m3",
            },
            _ => "young_pa",
        };
        let help = "steel has young_pa = 2.1e11, poisson = 0.3, density_kg_m3 = 7850";
        at.key(key).error(e.to_string(), "this value", help)
    })?;
    Ok(material)
}
