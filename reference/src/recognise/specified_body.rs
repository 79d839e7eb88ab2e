//! Specification of a body by the user, and reasons of refusals.
//!
//! The specification guides the search: a direction is tried first, a point replaces the middle of the hull where the
//! hull is no circle, a bore is the cylinder whose radius is nearest. The result then has to agree: the geometry is
//! more precise than the user, so that it decides within the tolerances below, and beyond them the body is refused
//! with both figures.

use super::axis::Axis;
use gearbench_models::Vec3;
use std::fmt;

/// Largest angle between the specified axis and the recognised one [rad].
const ALIGNED: f64 = 0.02;

/// Largest distance of the recognised axis from the specified point, relative to the tooth height.
const CLOSE: f64 = 0.1;

/// Largest difference of the ends of flanks from the specified ones, relative to the tooth height: a row of coarse
/// faces.
const ENDS: f64 = 0.3;

/// Specification of a body by the user.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpecifiedBody {
    /// Number of teeth, if specified.
    pub teeth: Option<u32>,
    /// Direction of the axis of rotation, with the sense of its own z axis; of a rack that of its width. Of any length but
    /// 0.
    pub axis: Option<Vec3>,
    /// A point on the axis [m].
    pub point: Option<Vec3>,
    /// Radius of the bore [m].
    pub bore_radius: Option<f64>,
    /// Least and greatest radius of the flanks [m].
    pub flanks: Option<[f64; 2]>,
}

/// Why a body is refused.
#[derive(Clone, Debug, PartialEq)]
pub enum Misfit {
    /// A part that is missing.
    Missing(String),
    /// The recognised value differs from the specified one.
    Against {
        /// Key of the quantity as in scenes: `axis`, `axis_point_m`, `flank_radii_m`.
        key: &'static str,
        /// Specified value.
        said: String,
        /// Recognised value.
        found: String,
    },
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Misfit::Missing(why) => f.write_str(why),
            Misfit::Against { key, said, found } => {
                write!(f, "`{key}` says {said}, but {found}")
            }
        }
    }
}

/// A direction with four digits.
fn direction(d: &Vec3) -> String {
    // Without the sign of a zero.
    let [x, y, z] = [d.x, d.y, d.z].map(|c| if c.abs() < 5e-5 { 0.0 } else { c });
    format!("({x:.4}, {y:.4}, {z:.4})")
}

/// A position [mm].
fn place(x: &Vec3) -> String {
    let [x, y, z] = [x.x, x.y, x.z].map(|c| if c.abs() < 5e-8 { 0.0 } else { 1e3 * c });
    format!("({x:.4}, {y:.4}, {z:.4}) mm")
}

impl SpecifiedBody {
    /// Returns the unit vector of the specified axis.
    pub fn unit_axis(&self) -> Option<Vec3> {
        self.axis.and_then(|a| a.try_normalize(0.0))
    }

    /// Checks that a direction agrees with the specified one, including its sense.
    ///
    /// # Errors
    /// Both directions, where they are apart.
    pub fn same_axis(&self, found: &Vec3) -> Result<(), Misfit> {
        match self.unit_axis() {
            Some(said) if said.dot(found) < ALIGNED.cos() => Err(Misfit::Against {
                key: "axis",
                said: direction(&said),
                found: format!("the axis of the body is {}", direction(found)),
            }),
            _ => Ok(()),
        }
    }

    /// Checks that an axis passes through the specified point, within a fraction of the tooth height [m].
    ///
    /// # Errors
    /// The point and the one of the axis next to it.
    pub fn same_point(&self, axis: &Axis, height: f64) -> Result<(), Misfit> {
        let Some(said) = self.point else {
            return Ok(());
        };
        let foot = axis.point + (said - axis.point).dot(&axis.direction) * axis.direction;
        if (said - foot).norm() <= CLOSE * height {
            return Ok(());
        }
        Err(Misfit::Against {
            key: "axis_point_m",
            said: place(&said),
            found: format!("the axis of the body passes {}", place(&foot)),
        })
    }

    /// Checks that flanks lie between the specified radii [m].
    ///
    /// # Errors
    /// Both ranges, where they are apart.
    pub fn same_flanks(&self, active: Option<[f64; 2]>, height: f64) -> Result<(), Misfit> {
        let Some(said) = self.flanks else {
            return Ok(());
        };
        let near = |a: [f64; 2]| (0..2).all(|i| (a[i] - said[i]).abs() <= ENDS * height);
        let mm = |[a, b]: [f64; 2]| format!("{:.4} to {:.4} mm", 1e3 * a, 1e3 * b);
        match active {
            Some(found) if near(found) => Ok(()),
            found => Err(Misfit::Against {
                key: "flank_radii_m",
                said: mm(said),
                found: found.map_or("no face there lies on the involute".to_owned(), |f| {
                    format!("faces on the involute reach from {}", mm(f))
                }),
            }),
        }
    }
}

#[cfg(test)]
mod tests;
