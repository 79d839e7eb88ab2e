//! Errors and warnings of the stiffness models.

use crate::error::{Reason, reasoned};
use std::fmt;

/// Property of a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Property {
    /// Young's modulus of the material.
    Young,
    /// Poisson's ratio of the material.
    Poisson,
    /// Density of the material.
    Density,
}

/// Error of the construction of a stiffness.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "what the fields are the messages say")]
pub enum StiffnessError {
    /// A value that has to be positive is not.
    NotPositive { what: &'static str, value: f64 },
    /// A material that no solid has.
    Material { property: Property, value: f64 },
    /// A table is malformed.
    Table { reason: String },
    /// The interpolated stiffness is not positive everywhere.
    NotPositiveBetween { s: f64, value: f64 },
    /// A parabola along the path that is not positive on all of it.
    Parabola { slope: f64, curvature: f64 },
    /// Radzimovsky's Hertz law needs curved bodies.
    HertzFlat,
    /// The contact is wider than the tooth allows.
    HertzTooWide {
        half_width: f64,
        load: f64,
        depth: f64,
    },
    /// The path of contact is empty or not finite.
    Path { start: f64, end: f64 },
    /// ISO 6336 gives no positive stiffness for these teeth.
    IsoRange { q: f64 },
    /// The foundation fit of Sainsot and Velex gives a negative compliance.
    FoundationRange {
        gear: usize,
        value: f64,
        theta_f: f64,
        ratio: f64,
    },
}

impl StiffnessError {
    /// Returns cause and remedy.
    pub fn reason(&self) -> Reason {
        let (cause, help) = match self {
            Self::NotPositive { what, value } => (
                format!("{what} is {value}"),
                "it must be finite and positive".to_owned(),
            ),
            Self::Material { property, value } => {
                let (name, rule) = match property {
                    Property::Young => ("Young's modulus [Pa]", "it must be finite and positive"),
                    Property::Poisson => (
                        "Poisson's ratio",
                        "it must lie in [0, 0.4999]: beyond, a solid hardly changes its volume and its finite elements lock",
                    ),
                    Property::Density => ("density [kg/m^3]", "it must be finite and positive"),
                };
                (format!("{name} is {value}"), rule.to_owned())
            }
            Self::Table { reason } => (format!("stiffness table: {reason}"), String::new()),
            Self::NotPositiveBetween { value, s } => (
                format!("interpolated stiffness falls to {value:.4e} N/m near s = {s:.6e} m"),
                "refine the table or choose linear interpolation".to_owned(),
            ),
            Self::Parabola { slope, curvature } => (
                format!(
                    "the parabola 1 + {slope} xi + {curvature} xi^2 is not positive all along the path"
                ),
                "it must be for every xi from -1, where contact starts, to 1".to_owned(),
            ),
            Self::HertzFlat => (
                "the logarithmic Hertz law needs two curved flanks and a rack is flat".to_owned(),
                "use the linear or the Weber-Banaschek one".to_owned(),
            ),
            Self::HertzTooWide {
                half_width,
                load,
                depth,
            } => (
                format!(
                    "Hertz half-width {half_width:.3e} m at the reference load {load} N does \
                     not fit the tooth (depth {depth:.3e} m)"
                ),
                "lower the reference load".to_owned(),
            ),
            Self::Path { start, end } => (
                format!("path of contact runs from {start} m to {end} m"),
                "the end must lie beyond the start".to_owned(),
            ),
            Self::IsoRange { q } => (
                format!(
                    "ISO 6336-1 gives the tooth flexibility q' = {q:.4} mm um/N for these \
                     teeth"
                ),
                "outside its range, use another stiffness".to_owned(),
            ),
            Self::FoundationRange {
                gear,
                value,
                theta_f,
                ratio,
            } => (
                format!(
                    "Sainsot-Velex foundation of gear {gear} is {value:.3e} m/N, far outside \
                     its fit (theta_f = {theta_f:.4} rad, h = {ratio:.3})"
                ),
                "use another foundation".to_owned(),
            ),
        };
        Reason { cause, help }
    }
}

reasoned!(StiffnessError);

/// Warning about a stiffness that was built nevertheless.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "what the fields are the messages say")]
pub enum StiffnessWarning {
    /// ISO 6336-1 is fitted for `x1 >= x2` (1: pinion).
    IsoShiftOrder { x: [f64; 2] },
    /// ISO 6336-1 is fitted for `-0.5 <= x1 + x2 <= 2`.
    IsoShiftSum { sum: f64 },
    /// ISO 6336-1 gives the mean mesh stiffness for transverse contact ratios of 1.2 and above.
    IsoContactRatio { value: f64 },
    /// A coefficient of the Sainsot-Velex fit is outside the range it was fitted in.
    FoundationFit {
        gear: usize,
        coefficient: &'static str,
        value: f64,
        range: [f64; 2],
    },
    /// The ratio of root to bore radius was limited to the end of the Sainsot-Velex fit.
    FoundationRatioHeld { gear: usize, ratio: f64, used: f64 },
    /// The Sainsot-Velex fit is valid for Poisson's ratio 0.3.
    FoundationPoisson { gear: usize, poisson: f64 },
    /// A rack has no ring foundation.
    RackFoundationOmitted,
    /// The fit for a ring supported inside was used for a rim supported outside.
    RimInPlaceOfFit { gear: usize },
    /// A table does not cover the path of contact and is constant beyond its ends.
    TableShort { table: [f64; 2], path: [f64; 2] },
    /// The period of a periodic table differs from the base pitch.
    TablePeriod { period: f64, base_pitch: f64 },
}

impl fmt::Display for StiffnessWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IsoShiftOrder { x } => write!(
                f,
                "ISO 6336-1 stiffness is fitted for x1 >= x2; pinion {}, wheel {}",
                x[0], x[1]
            ),
            Self::IsoShiftSum { sum } => write!(
                f,
                "ISO 6336-1 stiffness is fitted for -0.5 <= x1 + x2 <= 2; the sum is {sum}"
            ),
            Self::IsoContactRatio { value } => write!(
                f,
                "ISO 6336-1 mesh stiffness holds for a transverse contact ratio of 1.2 and above; it is {value:.3}"
            ),
            Self::FoundationFit {
                gear,
                coefficient,
                value,
                range,
            } => write!(
                f,
                "Sainsot-Velex foundation of gear {gear}: {coefficient} = {value:.3} lies outside the fit [{}, {}]",
                range[0], range[1]
            ),
            Self::FoundationRatioHeld { gear, ratio, used } => write!(
                f,
                "Sainsot-Velex foundation of gear {gear}: root/bore radius {ratio:.3} lies beyond the fit, {used} is used, which leaves out most of the torsion of the disc; foundation = \"ring\" holds for every bore"
            ),
            Self::FoundationPoisson { gear, poisson } => write!(
                f,
                "Sainsot-Velex foundation of gear {gear} is fitted for Poisson's ratio 0.3, given {poisson}"
            ),
            Self::RackFoundationOmitted => write!(
                f,
                "the Sainsot-Velex foundation is that of a ring: the rack's foundation is left out"
            ),
            Self::RimInPlaceOfFit { gear } => write!(
                f,
                "the Sainsot-Velex foundation is that of a ring held inside: for gear {gear}, which is internal, the elastic rim held outside is taken (foundation = \"ring\")"
            ),
            Self::TableShort { table, path } => write!(
                f,
                "stiffness table covers s = [{:.6e}, {:.6e}] m, the path of contact is [{:.6e}, {:.6e}] m: held constant beyond its ends",
                table[0], table[1], path[0], path[1]
            ),
            Self::TablePeriod { period, base_pitch } => write!(
                f,
                "periodic stiffness table has the period {period:.6e} m, the base pitch is {base_pitch:.6e} m"
            ),
        }
    }
}

/// Refuses a value that is not finite and positive.
pub(super) fn positive(what: &'static str, value: f64) -> Result<f64, StiffnessError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(StiffnessError::NotPositive { what, value })
    }
}
