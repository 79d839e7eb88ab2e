//! Compliance of the line contact of two flanks.
//!
//! With `p = F/b` the load per width, `E_i' = E_i / (1 - nu_i^2)` and the half-width
//! `a = sqrt(4 p rho / (pi E*))`, `1/rho = 1/rho_1 + 1/rho_2`, `1/E* = 1/E_1' + 1/E_2'`:
//!
//! ```text
//! linear            1/k = 2/(pi b) (1/E_1' + 1/E_2')     = 4 (1 - nu^2) / (pi E b) for equal bodies
//! logarithmic       1/k = 2/(pi b) sum_i (1/E_i') [ln(2 rho_i / a) + 0.407]
//! Weber-Banaschek   1/k = 2/(pi b) sum_i (1/E_i') [ln(2 t_i / a) - nu_i / (2 (1 - nu_i))]
//! ```
//!
//! Linear: Yang and Sun (1985), the custom of the potential-energy method, independent of load.
//! Logarithmic: Radzimovsky (1953), approach of cylinders, distances up to the curvature radius.
//! Weber and Banaschek (1953): flank against a point on the tooth's centreline, `t_i` along the
//! line of action; it leaves the rest to the tooth, so it is the one that fits a tooth model best.
//! The two logarithmic laws are secants at a reference load of the pair (N).

use std::f64::consts::PI;

use super::error::StiffnessError;
use super::material::Material;

/// Default load over the face width for a law that depends on load (N/m): 100 N/mm, where the validity of the
/// stiffness of ISO 6336-1 begins. Three times the load stiffens a pair by 3 to 5 %.
pub const USUAL_LOAD: f64 = 1e5;

/// Line-contact compliance in series with the teeth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hertz {
    /// Linear contact, independent of load: `k = pi E b / (4 (1 - nu^2))` for equal materials.
    Linear,
    /// Radzimovsky's law at a reference load.
    Log {
        /// Load of the pair (N); by default [`USUAL_LOAD`] over the width.
        reference_load: Option<f64>,
    },
    /// Weber and Banaschek's law at a reference load.
    WeberBanaschek {
        /// Load of the pair (N); by default [`USUAL_LOAD`] over the width.
        reference_load: Option<f64>,
    },
    /// Rigid contact, for laws that include a Hertzian term.
    Rigid,
}

/// Geometry of a contact point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzPoint {
    /// Radii of curvature of both flanks (m); infinite for a rack, negative of the concave flanks of an internal gear.
    pub curvature: [f64; 2],
    /// Distance from the contact point to both centrelines along the line of action (m).
    pub depth: [f64; 2],
}

impl Hertz {
    /// Returns the name in scenes and reports.
    pub fn id(&self) -> &'static str {
        match self {
            Hertz::Linear => "linear",
            Hertz::Log { .. } => "log",
            Hertz::WeberBanaschek { .. } => "weber-banaschek",
            Hertz::Rigid => "rigid",
        }
    }

    /// Returns the compliance (m/N) of the line contact of width `width` (m).
    ///
    /// # Errors
    /// [`StiffnessError`] when the load is not positive, a flat flank meets the logarithmic law, or
    /// the contact is wider than the tooth.
    pub fn compliance(
        &self,
        materials: &[Material; 2],
        width: f64,
        at: &HertzPoint,
    ) -> Result<f64, StiffnessError> {
        let soft = materials.map(|m| 1.0 / m.plane_strain());
        let factor = 2.0 / (PI * width);
        let load = match *self {
            Hertz::Rigid => return Ok(0.0),
            Hertz::Linear => return Ok(factor * (soft[0] + soft[1])),
            Hertz::Log { reference_load } | Hertz::WeberBanaschek { reference_load } => {
                let load = reference_load.unwrap_or(USUAL_LOAD * width);
                super::error::positive("reference load of the Hertz law [N]", load)?
            }
        };
        let rho = 1.0 / (1.0 / at.curvature[0] + 1.0 / at.curvature[1]);
        let a = (4.0 * load / width * rho * (soft[0] + soft[1]) / PI).sqrt();
        let mut sum = 0.0;
        for i in 0..2 {
            let nu = materials[i].poisson;
            let (depth, shape) = if matches!(self, Hertz::Log { .. }) {
                if at.curvature[i].is_infinite() {
                    return Err(StiffnessError::HertzFlat);
                }
                (at.curvature[i].abs(), 0.407)
            } else {
                (at.depth[i], -nu / (2.0 * (1.0 - nu)))
            };
            let bracket = (2.0 * depth / a).ln() + shape;
            // Beyond half the depth the half-space picture has lost its meaning.
            if !(bracket > 0.0 && a < 0.5 * depth) {
                return Err(StiffnessError::HertzTooWide {
                    half_width: a,
                    load,
                    depth,
                });
            }
            sum += soft[i] * bracket;
        }
        Ok(factor * sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINT: HertzPoint = HertzPoint {
        curvature: [13e-3, 21e-3],
        depth: [3.2e-3, 3.3e-3],
    };

    /// The linear value pi E b / (4 (1 - nu^2)) is 177.8 N/(mm um) at 206 GPa; 3.55587e9 N/m at b = 20 mm is the
    /// regression value of the rotor-dynamics package ROSS.
    #[test]
    fn linear_value() {
        let steel = [Material::STEEL_ISO; 2];
        let k = 1.0 / Hertz::Linear.compliance(&steel, 1e-3, &POINT).unwrap();
        assert!((k / 1e6 - 177.8).abs() < 0.05, "{k}");
        let k = 1.0 / Hertz::Linear.compliance(&steel, 20e-3, &POINT).unwrap();
        assert!((k / 3.55587e9 - 1.0).abs() < 2e-6, "{k}");
    }

    /// The half-width and the depth law agree with the plane strain under the Hertzian pressure, integrated
    /// numerically from the surface down to the depth t.
    #[test]
    fn weber_banaschek_is_the_integrated_strain() {
        let steel = Material::STEEL;
        let (load, width) = (2000.0, 10e-3);
        let p = load / width;
        let rho = 1.0 / (1.0 / POINT.curvature[0] + 1.0 / POINT.curvature[1]);
        let a = (8.0 * p * rho / (PI * steel.plane_strain())).sqrt();
        let p0 = 2.0 * p / (PI * a);
        let mut total = 0.0;
        for t in POINT.depth {
            // sigma_z and sigma_x on the axis (McEwen); z = a sinh(u) resolves the surface layer.
            let n = 20_000;
            let top = (t / a).asinh();
            let h = top / f64::from(n);
            for j in 0..n {
                let u = (f64::from(j) + 0.5) * h;
                let (z, root) = (u.sinh(), u.cosh());
                let sz = -p0 / root;
                let sx = -p0 * ((1.0 + 2.0 * z * z) / root - 2.0 * z);
                let nu = steel.poisson;
                let strain = (sz - nu / (1.0 - nu) * sx) / steel.plane_strain();
                total -= strain * a * root * h;
            }
        }
        let law = Hertz::WeberBanaschek {
            reference_load: Some(load),
        };
        let c = law.compliance(&[steel; 2], width, &POINT).unwrap();
        // The closed form drops terms of order (a/t)^2.
        assert!((c * load / total - 1.0).abs() < 2e-3, "{c} {total}");
    }

    #[test]
    fn softens_with_curvature_and_stiffens_with_load() {
        let steel = [Material::STEEL; 2];
        let log = |f: f64| {
            Hertz::Log {
                reference_load: Some(f),
            }
            .compliance(&steel, 10e-3, &POINT)
            .unwrap()
        };
        assert!(log(100.0) > log(1000.0));
        let usual = Hertz::Log {
            reference_load: None,
        };
        let usual = usual.compliance(&steel, 10e-3, &POINT).unwrap();
        assert_eq!(usual, log(1000.0));
        // Twice the load takes ln(2) off the bracket sum.
        let drop = 2.0 / (PI * 10e-3) * 2f64.ln() / Material::STEEL.plane_strain();
        assert!(((log(100.0) - log(200.0)) / drop - 1.0).abs() < 1e-10);
    }

    #[test]
    fn refusals() {
        let steel = [Material::STEEL; 2];
        let flat = HertzPoint {
            curvature: [13e-3, f64::INFINITY],
            ..POINT
        };
        let log = Hertz::Log {
            reference_load: Some(100.0),
        };
        assert_eq!(
            log.compliance(&steel, 1e-2, &flat),
            Err(StiffnessError::HertzFlat)
        );
        let wb = Hertz::WeberBanaschek {
            reference_load: Some(100.0),
        };
        assert!(wb.compliance(&steel, 1e-2, &flat).is_ok());
        let crushed = Hertz::WeberBanaschek {
            reference_load: Some(1e9),
        };
        assert!(matches!(
            crushed.compliance(&steel, 1e-2, &POINT),
            Err(StiffnessError::HertzTooWide { .. })
        ));
        let none = Hertz::Log {
            reference_load: Some(0.0),
        };
        assert!(none.compliance(&steel, 1e-2, &POINT).is_err());
    }
}
