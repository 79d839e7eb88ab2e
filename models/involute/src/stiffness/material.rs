//! Linear elastic isotropic material.

use super::error::{Property, StiffnessError};

/// Material of a gear or rack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus `E` (Pa).
    pub young: f64,
    /// Poisson's ratio nu (-).
    pub poisson: f64,
    /// Density of the material (kg/m^3).
    pub density: f64,
}

/// Largest Poisson's ratio: the bulk modulus is then 5000 times the shear modulus, and matrices are ill-conditioned
/// beyond.
const MOST_POISSON: f64 = 0.4999;

impl Material {
    /// The steel of the stored finite-element reference data: E = 210 GPa, nu = 0.3, 7850 kg/m^3.
    pub const STEEL: Material = Material {
        young: 2.1e11,
        poisson: 0.3,
        density: 7850.0,
    };

    /// The steel of ISO 6336: as [`Material::STEEL`] with E = 206 GPa.
    pub const STEEL_ISO: Material = Material {
        young: 2.06e11,
        ..Material::STEEL
    };

    /// Checks all three values.
    ///
    /// # Errors
    /// [`StiffnessError`] names the value out of range.
    pub fn check(&self) -> Result<(), StiffnessError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let (property, value) = if !positive(self.young) {
            (Property::Young, self.young)
        } else if !positive(self.density) {
            (Property::Density, self.density)
        } else if !(0.0..=MOST_POISSON).contains(&self.poisson) {
            (Property::Poisson, self.poisson)
        } else {
            return Ok(());
        };
        Err(StiffnessError::Material { property, value })
    }

    /// Returns the speed of shear waves (m/s).
    pub fn shear_wave_speed(&self) -> f64 {
        (self.shear_modulus() / self.density).sqrt()
    }

    /// Returns the shear modulus G (Pa).
    pub fn shear_modulus(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// Returns the plane-strain modulus `E / (1 - nu^2)` (Pa).
    pub fn plane_strain(&self) -> f64 {
        self.young / (1.0 - self.poisson * self.poisson)
    }
}
