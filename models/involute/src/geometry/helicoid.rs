//! A flank as an involute helicoid, defined by the distance of points from it, and the helicoids of a gear.
//!
//! A plane side of a rack tool generates an involute helicoid. With its unit normal `n = (n_r, n_t, n_a)` in the radial
//! direction, along the rolling motion and along the axis, and the side `sigma` = +1 (left) or -1,
//!
//! ```text
//! tan(alpha_t) = n_r/(sigma n_t)      sin(beta_b) = -sigma n_a      r_b cos(beta_b) = z m_n cos(alpha_n)/2
//! ```
//!
//! since the rack has the same normal pitch whichever way it stands to the gear. Where the profile shift grows along the axis
//! (conical gears, beveloids: the pitch plane of the rack is tilted by the profile-shift angle `theta`, its teeth stand
//! askew by `beta` in it) both sides differ:
//!
//! ```text
//! n = sigma cos(alpha_n) u + sin(alpha_n) h,    h = (cos(theta), 0, -sin(theta)),
//! u = (-sin(beta) sin(theta), cos(beta), -sin(beta) cos(theta))
//! sin(beta_b)  = cos(alpha_n) sin(beta) cos(theta) + sigma sin(alpha_n) sin(theta)
//! tan(alpha_t) = (tan(alpha_n) cos(theta) - sigma sin(beta) sin(theta))/cos(beta)
//! chi          = (pi m_n/(4 cos(beta)) - thinning/2 + x m_n tan(alpha_t))/r + inv(alpha_t)
//! ```
//!
//! with `x` and the half angle `chi` those of the transverse section in the middle of the face width. K. Mitome, *Conical
//! involute gear*, Bulletin of JSME 26 (1983); C.-C. Liu, C.-B. Tsay, *Mathematical models and contact simulations of concave
//! beveloid gears*, J. Mech. Des. 124 (2002).
//!
//! An involute helicoid that turns moves parallel to itself, so that the distance of a point from it is known in closed
//! form, with `rho` the length of roll of the involute through the point, `tau` the angle of its tangent point on the base
//! circle and `psi` that of the tooth:
//!
//! ```text
//! D = cos(beta_b) (rho - r_b (chi + sigma (psi - tau)) - sigma z tan(beta_b)),   grad D = outward unit normal
//! ```

use super::Side;
use super::involute::inv;
use super::parameters::GearParams;
use crate::Vec3;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// A flank of a tooth at the angle zero, in the axes of its gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvoluteHelicoid {
    /// Side of the flank.
    pub side: Side,
    /// Base radius [m].
    pub base_radius: f64,
    /// Tangent of the base helix angle.
    pub tan_helix: f64,
    /// Cosine of the base helix angle.
    pub cos_helix: f64,
    /// Angle between the middle of the tooth and the origin of the flank on the base circle, at the height zero [rad].
    pub half_angle: f64,
}

/// Distance of a point from a flank, with the corresponding point of the flank.
#[derive(Clone, Copy, Debug)]
pub struct FlankDistance {
    /// Distance along the normal, outward positive [m].
    pub distance: f64,
    /// Gradient of the distance, in the axes of the gear.
    pub gradient: Vec3,
    /// Length of roll [m] (height over the reference line of a rack).
    pub roll: f64,
    /// Angle of the base radius through the tangent point.
    pub base: PlaneAngle,
}

/// Angle [rad] up to which trigonometric functions are computed as power series, with a remainder below rounding.
const SMALL_TURN: f64 = 0.02;

/// Coefficients of these series after the first: of sine, of one minus cosine, and of arcsine.
const SINE: [f64; 3] = [-1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0];
const VERSINE: [f64; 2] = [-1.0 / 24.0, 1.0 / 720.0];
const ARCSINE: [f64; 3] = [1.0 / 6.0, 3.0 / 40.0, 15.0 / 336.0];

/// Reduces an angle to (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    if angle.abs() <= PI {
        angle
    } else {
        angle - TAU * (angle / TAU).round()
    }
}

/// Reduces a length along a circle of a radius to half its circumference on either side.
#[inline]
fn wrapped_on(radius: f64, length: f64) -> f64 {
    if length.abs() <= PI * radius {
        length
    } else {
        radius * wrapped(length / radius)
    }
}

/// An angle in the transverse plane with its cosine and sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneAngle {
    /// Angle in the transverse plane [rad].
    pub angle: f64,
    /// Cosine of the angle.
    pub cos: f64,
    /// Sine of the angle.
    pub sin: f64,
}

impl PlaneAngle {
    /// Creates an angle [rad] with its cosine and sine.
    #[inline]
    pub fn new(angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        PlaneAngle { angle, cos, sin }
    }

    /// Adds a rotation to the angle [rad]; a small rotation needs no trigonometric functions.
    #[inline]
    #[must_use]
    pub fn turned(&self, turn: f64) -> Self {
        if turn.abs() > SMALL_TURN {
            return Self::new(self.angle + turn);
        }
        let square = turn * turn;
        let sin = turn * (1.0 + square * (SINE[0] + square * (SINE[1] + square * SINE[2])));
        let lack = square * (0.5 + square * (VERSINE[0] + square * VERSINE[1]));
        PlaneAngle {
            angle: self.angle + turn,
            cos: self.cos - (self.sin * sin + self.cos * lack),
            sin: self.sin + (self.cos * sin - self.sin * lack),
        }
    }

    /// Returns another angle [rad], up to whole turns.
    #[inline]
    #[must_use]
    pub fn turned_to(&self, angle: f64) -> Self {
        self.turned(wrapped(angle - self.angle))
    }

    /// Returns the angle of a unit vector; one near this angle needs no trigonometric functions.
    #[inline]
    #[must_use]
    pub fn of_direction(&self, cos: f64, sin: f64) -> Self {
        let across = self.cos * sin - self.sin * cos;
        let along = self.cos * cos + self.sin * sin;
        if across.abs() > SMALL_TURN || along < 0.0 {
            return PlaneAngle {
                angle: sin.atan2(cos),
                cos,
                sin,
            };
        }
        let square = across * across;
        let arc = ARCSINE[0] + square * (ARCSINE[1] + square * ARCSINE[2]);
        let turn = across * (1.0 + square * arc);
        PlaneAngle {
            angle: self.angle + turn,
            cos,
            sin,
        }
    }
}

impl InvoluteHelicoid {
    /// Returns the flank that the side of a tilted rack generates on a gear.
    pub(super) fn of_tilted_rack(p: &GearParams, side: Side) -> Self {
        let sigma = side.sign();
        let (sin_n, cos_n) = p.pressure_angle.sin_cos();
        let (sin_h, cos_h) = p.helix_angle.sin_cos();
        let (sin_s, cos_s) = p.profile_shift_angle.sin_cos();
        let r = 0.5 * f64::from(p.teeth) * p.module / cos_h;
        let sin_helix = cos_n * sin_h * cos_s + sigma * sin_n * sin_s;
        let cos_helix = ((1.0 - sin_helix) * (1.0 + sin_helix)).sqrt();
        let tan_pressure = (sin_n / cos_n * cos_s - sigma * sin_h * sin_s) / cos_h;
        let half_thickness = FRAC_PI_4 * p.module / cos_h - 0.5 * p.thinning
            + p.profile_shift * p.module * tan_pressure;
        InvoluteHelicoid {
            side,
            base_radius: r * cos_h * cos_n / cos_helix,
            tan_helix: sin_helix / cos_helix,
            cos_helix,
            half_angle: half_thickness / r + inv(tan_pressure.atan()),
        }
    }

    /// Returns the angle of the base radius through the tangent point of a point of the transverse section at `z` [m]
    /// with a length of roll [m], for a tooth at the angle `psi`.
    #[inline]
    pub fn angle(&self, psi: f64, roll: f64, z: f64) -> f64 {
        let rb = self.base_radius;
        psi + z * self.tan_helix / rb + self.side.sign() * (self.half_angle - roll / rb)
    }

    /// Returns the base radius at [`Self::angle`].
    #[inline]
    pub fn base(&self, psi: f64, roll: f64, z: f64) -> PlaneAngle {
        PlaneAngle::new(self.angle(psi, roll, z))
    }

    /// Returns the length of roll [m] of the point of that section whose base radius has an angle.
    #[inline]
    pub fn roll(&self, psi: f64, angle: f64, z: f64) -> f64 {
        let (sigma, rb) = (self.side.sign(), self.base_radius);
        let ahead = wrapped_on(rb, rb * (psi - angle) + z * self.tan_helix);
        rb * self.half_angle + sigma * ahead
    }

    /// Returns the point of the section at `z` [m] with a length of roll [m], whose base radius has an angle.
    #[inline]
    pub fn point(&self, base: &PlaneAngle, roll: f64, z: f64) -> Vec3 {
        let (rb, along) = (self.base_radius, self.side.sign() * roll);
        let PlaneAngle { cos, sin, .. } = base;
        Vec3::new(rb * cos - along * sin, rb * sin + along * cos, z)
    }

    /// Returns the distance data of a point near the flank of a tooth at the angle `psi`; it is fastest if the base
    /// radius of the point is near the angle `around`.
    #[inline]
    pub fn near(&self, psi: f64, p: &Vec3, around: &PlaneAngle) -> FlankDistance {
        let (sigma, rb) = (self.side.sign(), self.base_radius);
        let square = p.x * p.x + p.y * p.y;
        let beyond = square - rb * rb;
        // Inside the base cylinder, where no flank is, the distance goes on as that of the radial plane through its origin.
        let (roll, per_square, stretch) = if beyond >= 0.0 {
            (beyond.sqrt(), square.recip(), 1.0)
        } else {
            let radius = square.sqrt();
            (0.0, (rb * radius).recip(), rb / radius)
        };
        let base = around.of_direction(
            (rb * p.x + sigma * roll * p.y) * per_square,
            (rb * p.y - sigma * roll * p.x) * per_square,
        );
        let ahead = rb * (psi - base.angle + sigma * self.half_angle) + p.z * self.tan_helix;
        let along = wrapped_on(rb, ahead - sigma * roll);
        let (c, s) = (base.cos, base.sin);
        FlankDistance {
            distance: -sigma * along * self.cos_helix,
            gradient: sigma
                * self.cos_helix
                * Vec3::new(-stretch * s, stretch * c, -self.tan_helix),
            roll,
            base,
        }
    }
}
