//! Compliance of the gear body under one tooth (foundation).
//!
//! Ring, after P. Sainsot, P. Velex, O. Duverger, J. Mech. Des. 126 (2004) 748-752:
//!
//! ```text
//! b delta/F = cos(beta)^2 / E [L* (u/S)^2 + M* (u/S) + P* (1 + Q* tan(beta)^2)]
//! X* = A/theta_f^2 + B h^2 + C h/theta_f + D/theta_f + E h + F,     h = r_f / r_bore
//! ```
//!
//! `theta_f` is the half angle of the tooth at the root circle `r_f` (end of the fillet), `u` the
//! distance along the centreline from the root circle to the line of action. `S`, the length of the
//! tooth root, is written and coded in three ways: [`RootLength`] says which, and results that print a
//! foundation print it too.
//!
//! Half-plane, after Weber and Banaschek (1953), plane strain, `y` and `s` lever and thickness at the
//! root chord:
//!
//! ```text
//! b delta/F = cos(beta)^2 (1 - nu^2)/E [18/pi (y/s)^2 + 2 (1 - 2 nu)/(1 - nu) (y/s)
//!             + 4.8/pi (1 + (1 - nu)/2.4 tan(beta)^2)]       (5.2, 1.0, 1.4 and 0.294 for nu = 0.3)
//! ```
//!
//! Half-plane, after R. W. Cornell, J. Mech. Des. 103 (1981) 447-459, at the section where the fillet
//! tangent makes 75 degrees with the centreline, lever `L`, thickness `H`:
//!
//! ```text
//! narrow   cos(beta)^2 / E [5.306 (L/H)^2 + 2 (1 - nu) (L/H) + 1.534 (1 + 0.4167 tan(beta)^2/(1 + nu))]
//! wide     the same times (1 - nu^2), the middle coefficient being 2 (1 - nu - 2 nu^2)/(1 - nu^2)
//! ```

use std::f64::consts::PI;

use crate::geometry::Gear;

use super::error::{StiffnessError, StiffnessWarning};
use super::material::Material;
use super::tooth::{ToothLoad, ToothProfile, is_wide};

/// Definition of the length `S` of the tooth root in the Sainsot-Velex formula.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize, serde::Serialize)]
pub enum RootLength {
    /// Arc `2 r_f theta_f` (ROSS).
    #[default]
    #[serde(rename = "2 rf theta")]
    TwoRfThetaF,
    /// Chord `2 r_f sin(theta_f)`.
    #[serde(rename = "2 rf sin theta")]
    TwoRfSinThetaF,
    /// Arc on the base circle, `2 r_b theta_f` (GEARpie).
    #[serde(rename = "2 rb theta")]
    TwoRbThetaF,
}

impl RootLength {
    /// Returns the formula for reports.
    pub fn formula(self) -> &'static str {
        match self {
            RootLength::TwoRfThetaF => "S = 2 r_f theta_f",
            RootLength::TwoRfSinThetaF => "S = 2 r_f sin(theta_f)",
            RootLength::TwoRbThetaF => "S = 2 r_b theta_f",
        }
    }

    fn length(self, gear: &Gear, theta_f: f64) -> f64 {
        match self {
            RootLength::TwoRfThetaF => 2.0 * gear.r_root() * theta_f,
            RootLength::TwoRfSinThetaF => 2.0 * gear.r_root() * theta_f.sin(),
            RootLength::TwoRbThetaF => 2.0 * gear.r_base() * theta_f,
        }
    }
}

/// Model of the gear body under the teeth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Foundation {
    /// Elastic ring supported at the bore or seat, solved exactly (see the module `ring`); a rack likewise.
    Ring,
    /// Published fit of the ring under one tooth; a rack has no such fit and its foundation is left out.
    SainsotVelex(RootLength),
    /// Elastic half-plane under the root chord.
    WeberBanaschek,
    /// Elastic half-plane under Cornell's fillet section.
    Cornell,
    /// Rigid body without foundation compliance.
    Rigid,
}

impl Foundation {
    /// Returns the name in scenes and reports.
    pub fn id(self) -> &'static str {
        match self {
            Foundation::Ring => "ring",
            Foundation::SainsotVelex(_) => "sainsot-velex",
            Foundation::WeberBanaschek => "weber-banaschek",
            Foundation::Cornell => "cornell",
            Foundation::Rigid => "rigid",
        }
    }

    /// Returns the name with its convention, for reports.
    pub fn describe(self) -> String {
        match self {
            Foundation::SainsotVelex(s) => format!("sainsot-velex, {}", s.formula()),
            other => other.id().to_owned(),
        }
    }

    /// Returns the height of the root section above the root chord (m): the tooth ends and the foundation begins
    /// there.
    pub(super) fn root_section(self, profile: &ToothProfile) -> f64 {
        match self {
            Foundation::Cornell => profile.cornell_section(),
            _ => 0.0,
        }
    }

    /// Returns the compliance (m/N) of the half-plane foundations and of the rigid one; `None` for rings.
    pub(super) fn half_plane(
        self,
        profile: &ToothProfile,
        material: &Material,
        width: f64,
        load: &ToothLoad,
    ) -> Option<f64> {
        let section = self.root_section(profile);
        let thickness = 2.0 * profile.half_thickness(section);
        let lever = (load.crossing() - section) / thickness;
        let nu = material.poisson;
        let (tan2, cos2) = (load.beta.tan().powi(2), load.beta.cos().powi(2));
        let bracket = match self {
            Foundation::Ring | Foundation::SainsotVelex(_) => return None,
            Foundation::Rigid => 0.0,
            Foundation::WeberBanaschek => {
                (1.0 - nu * nu)
                    * (18.0 / PI * lever * lever
                        + 2.0 * (1.0 - 2.0 * nu) / (1.0 - nu) * lever
                        + 4.8 / PI * (1.0 + (1.0 - nu) / 2.4 * tan2))
            }
            Foundation::Cornell => {
                let ends = 5.306 * lever * lever + 1.534 * (1.0 + 0.4167 * tan2 / (1.0 + nu));
                if is_wide(width, thickness) {
                    (1.0 - nu * nu) * ends + 2.0 * (1.0 - nu - 2.0 * nu * nu) * lever
                } else {
                    ends + 2.0 * (1.0 - nu) * lever
                }
            }
        };
        Some(cos2 / (material.young * width) * bracket)
    }
}

/// Coefficients A..F and the fit range of one factor `X*`.
struct Fit {
    name: &'static str,
    coefficients: [f64; 6],
    range: [f64; 2],
}

const FITS: [Fit; 4] = [
    Fit {
        name: "L*",
        coefficients: [-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045],
        range: [6.82, 6.94],
    },
    Fit {
        name: "M*",
        coefficients: [60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086],
        range: [1.08, 3.29],
    },
    Fit {
        name: "P*",
        coefficients: [-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236],
        range: [2.56, 13.47],
    },
    Fit {
        name: "Q*",
        coefficients: [
            -6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904,
        ],
        range: [0.141, 0.62],
    },
];

/// Largest ratio of root to bore radius of the fit, used beyond it with a warning: towards this end the fit becomes
/// soft, a solid gear is about half as stiff with it as with a bore of half its root radius.
const GREATEST_RATIO: f64 = 7.0;

/// Returns the factors `[L*, M*, P*, Q*]` of the Sainsot-Velex fit for the half angle `theta_f` (rad) and the ratio `h =
/// r_f / r_bore`.
pub fn sainsot_velex_factors(theta_f: f64, h: f64) -> [f64; 4] {
    std::array::from_fn(|i| {
        let [a, b, c, d, e, f] = FITS[i].coefficients;
        a / (theta_f * theta_f) + b * h * h + c * h / theta_f + d / theta_f + e * h + f
    })
}

/// Fit of Sainsot and Velex for the teeth of one gear.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RingFit {
    factors: [f64; 4],
    root_length: f64,
    r_root: f64,
    r_base: f64,
    theta_f: f64,
    ratio: f64,
    number: usize,
}

impl RingFit {
    /// Evaluates the fit; `number` is 1 or 2, for the messages.
    pub(super) fn new(
        gear: &Gear,
        convention: RootLength,
        material: &Material,
        number: usize,
        warnings: &mut Vec<StiffnessWarning>,
    ) -> RingFit {
        let theta_f = gear.half_angle_at(gear.r_root());
        let ratio = gear.r_root() / gear.seat_radius();
        let used = ratio.min(GREATEST_RATIO);
        if ratio > used {
            warnings.push(StiffnessWarning::FoundationRatioHeld {
                gear: number,
                ratio,
                used,
            });
        }
        if (material.poisson - 0.3).abs() > 0.02 {
            warnings.push(StiffnessWarning::FoundationPoisson {
                gear: number,
                poisson: material.poisson,
            });
        }
        let factors = sainsot_velex_factors(theta_f, used);
        for (fit, value) in FITS.iter().zip(factors) {
            if !(fit.range[0]..=fit.range[1]).contains(&value) {
                warnings.push(StiffnessWarning::FoundationFit {
                    gear: number,
                    coefficient: fit.name,
                    value,
                    range: fit.range,
                });
            }
        }
        RingFit {
            factors,
            root_length: convention.length(gear, theta_f),
            r_root: gear.r_root(),
            r_base: gear.r_base(),
            theta_f,
            ratio,
            number,
        }
    }

    /// Returns the compliance (m/N) of the ring of `width` (m) under a force at the load angle `beta` (rad).
    pub(super) fn compliance(
        &self,
        material: &Material,
        width: f64,
        beta: f64,
    ) -> Result<f64, StiffnessError> {
        let u = self.r_base / beta.cos() - self.r_root;
        let value = ring_compliance(self.factors, u / self.root_length, beta, material, width);
        if value.is_finite() && value > 0.0 {
            Ok(value)
        } else {
            Err(StiffnessError::FoundationRange {
                gear: self.number,
                value,
                theta_f: self.theta_f,
                ratio: self.ratio,
            })
        }
    }
}

/// Evaluates the formula of Sainsot and Velex for given factors; `lever = u/S`.
pub(super) fn ring_compliance(
    [l, m, p, q]: [f64; 4],
    lever: f64,
    beta: f64,
    material: &Material,
    width: f64,
) -> f64 {
    let bracket = l * lever * lever + m * lever + p * (1.0 + q * beta.tan().powi(2));
    beta.cos().powi(2) / (material.young * width) * bracket
}

#[cfg(test)]
#[path = "foundation_tests.rs"]
mod tests;
