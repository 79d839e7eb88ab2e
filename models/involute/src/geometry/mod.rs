//! Geometry of involute cylindrical gears, external and internal, and racks.
//!
//! Owns every length and angle that follows from the parameters of the user (teeth, module, pressure angle, profile
//! shift, helix angle, width, rack factors, thinning, centre distance), and refuses gears that cannot be cut or cannot
//! mesh with a [`GeometryError`] that has the cause and a remedy.
//!
//! Conventions, stated here once:
//!
//! - SI units: metre, radian, kilogram. Lengths and angles lie in the transverse plane unless a
//!   name says normal.
//! - The gear axis is z and angles count counter-clockwise. A gear's own frame has the centreline
//!   of tooth 0 on +x. [`Side::Left`] is the counter-clockwise flank of a tooth, [`Side::Right`]
//!   the clockwise one.
//! - A pair has gear 1 at the origin and gear 2 at `(a, 0)`. The path coordinate `s` runs along
//!   the line of action from the tangent point T1 on the base circle of gear 1 towards T2; a flank
//!   point of gear 1 at `s` has radius `sqrt(r_b1^2 + s^2)`.
//! - An internal gear has the number of teeth `-z` in all equations (ISO 21771-1, DIN 3960), so that one set of them serves
//!   external gears, racks (the limit of infinitely many teeth) and internal gears. Radii and numbers of teeth that a gear
//!   tells are positive; lengths of roll and path coordinates are negative on it, longest at the root. A positive profile
//!   shift thickens its teeth and moves their tips towards the axis.
//! - A rack stands at `x = distance`, its teeth point to -x and it moves along y.
//!
//! Nomenclature and equations of the involute follow ISO 21771-1 and F. L. Litvin, A. Fuentes,
//! *Gear Geometry and Applied Theory* (2nd ed., 2004), chapters 6, 10 and 11; each module names
//! its own.

mod conical;
mod conical_pair;
mod contact_lines;
mod cutter;
mod deviation;
mod error;
mod fillet;
mod flanks;
mod frame;
mod gear;
mod helicoid;
mod internal;
mod internal_error;
#[cfg(test)]
mod internal_refusal_tests;
#[cfg(test)]
mod internal_tests;
mod involute;
mod meshing;
mod modification;
mod outline;
mod pair;
mod parameters;
mod profile;
mod quantity;
mod rack;
#[cfg(test)]
mod reference_tests;
#[cfg(test)]
mod refusal_tests;
#[cfg(test)]
mod sweep_tests;
pub mod swept;
mod topography;

pub use conical::ConicalError;
pub use conical_pair::{ConicalPair, RollMap};
pub use contact_lines::ContactLines;
pub use deviation::{Deviations, FlankDeviations, GivenDeviations, IsoTolerances};
pub use error::GeometryError;
pub use flanks::{FlankGrid, Flanks, Tips};
pub use frame::Frame;
pub use gear::Gear;
pub use helicoid::{FlankDistance, InvoluteHelicoid, PlaneAngle};
pub use internal::Internal;
pub use internal_error::InternalError;
pub use involute::{inv, inv_inverse};
pub use modification::{EndRelief, Modifications, ReliefShape, TipRelief};
pub use outline::{MassProperties, SMOOTH_FLANK};
pub use pair::{Mate, Pair};
pub use parameters::{GearParams, RackParams};
pub use quantity::Quantity;
pub use rack::Rack;
pub use topography::Topography;

use crate::Vec3;

/// Returns the direction along the profile of a flank from its normal: the transverse part, rotated by 90 degrees
/// counter-clockwise.
#[inline]
pub fn along_profile(n: &Vec3) -> Vec3 {
    let t = Vec3::new(-n.y, n.x, 0.0);
    t / t.norm()
}

/// Flank of a tooth, seen along -z: the counter-clockwise or the clockwise one. For contact and for [grids of
/// nodes](FlankGrid) it is the side seen from the root of the tooth, which differs on internal gears only
/// ([`Gear::side_from_root`]).
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Deserialize, serde::Serialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The counter-clockwise flank; it drives when a gear turns counter-clockwise.
    Left,
    /// The clockwise flank; mirror image of the left one.
    Right,
}

impl Side {
    /// Left and right flank.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// Returns +1 for the left flank, -1 for the right one.
    #[inline]
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// Returns 0 for the left flank, 1 for the right one.
    #[inline]
    #[must_use]
    pub fn index(self) -> usize {
        usize::from(self == Self::Right)
    }

    /// Returns the opposite flank.
    #[inline]
    #[must_use]
    pub fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}
