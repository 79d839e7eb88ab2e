//! A flank as an involute helicoid, told by the distance of points from it, and the helicoids of a gear.
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
    /// Which flank of a tooth it is.
    pub side: Side,
    /// Base radius [m].
    pub base_radius: f64,
    /// Tangent and cosine of the base helix angle.
    pub tan_helix: f64,
    /// See [`InvoluteHelicoid::tan_helix`].
    pub cos_helix: f64,
    /// Angle between the middle of the tooth and the origin of the flank on the base circle, at the height zero [rad].
    pub half_angle: f64,
}

/// A point near a flank.
#[derive(Clone, Copy, Debug)]
pub struct Near {
    /// Distance along the normal, outward positive [m].
    pub distance: f64,
    /// Its gradient, in the axes of the gear.
    pub gradient: Vec3,
    /// Length of roll [m] (height over the reference line of a rack), and the base radius through the tangent point.
    pub roll: f64,
    /// Direction of that base radius.
    pub base: Vec3,
}

/// Angle [rad] up to which sine and cosine are series of three terms: the next is below rounding.
const SMALL_TURN: f64 = 1e-4;

/// Angle in (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    if angle.abs() <= PI {
        angle
    } else {
        angle - TAU * (angle / TAU).round()
    }
}

impl InvoluteHelicoid {
    /// The flank that the side of a tilted rack cuts on a gear.
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

    /// The point of the transverse section at `z` [m] with a length of roll [m], of a tooth at the angle `psi`, and the
    /// direction of its base radius.
    pub fn point(&self, psi: f64, roll: f64, z: f64) -> (Vec3, Vec3) {
        let sigma = self.side.sign();
        let rb = self.base_radius;
        let tau = psi + z * self.tan_helix / rb + sigma * (self.half_angle - roll / rb);
        let (sin, cos) = tau.sin_cos();
        let along = sigma * roll;
        let x = Vec3::new(rb * cos - along * sin, rb * sin + along * cos, z);
        (x, Vec3::new(cos, sin, 0.0))
    }

    /// [`Self::point`] with a length of roll that is longer than that of a known point by `more` [m], whose base radius has
    /// the direction `base`: a small turn takes a series instead of sine and cosine, exact to rounding.
    pub fn point_onwards(
        &self,
        (psi, z): (f64, f64),
        base: &Vec3,
        roll: f64,
        more: f64,
    ) -> (Vec3, Vec3) {
        let sigma = self.side.sign();
        let rb = self.base_radius;
        let turn = -sigma * more / rb;
        if turn.abs() > SMALL_TURN {
            return self.point(psi, roll, z);
        }
        let square = turn * turn;
        let (sin, lack) = (turn * (1.0 - square / 6.0), 0.5 * square);
        let cosine = base.x - (base.y * sin + base.x * lack);
        let sine = base.y + (base.x * sin - base.y * lack);
        let along = sigma * roll;
        let x = Vec3::new(rb * cosine - along * sine, rb * sine + along * cosine, z);
        (x, Vec3::new(cosine, sine, 0.0))
    }

    /// What is known of a point near the flank without its distance, which takes most of the time.
    pub fn directed(&self, p: &Vec3) -> Near {
        let (sigma, rb) = (self.side.sign(), self.base_radius);
        let square = p.x * p.x + p.y * p.y;
        let roll = (square - rb * rb).max(0.0).sqrt();
        let (c, s) = (
            (rb * p.x + sigma * roll * p.y) / square,
            (rb * p.y - sigma * roll * p.x) / square,
        );
        Near {
            distance: 0.0,
            gradient: sigma * self.cos_helix * Vec3::new(-s, c, -self.tan_helix),
            roll,
            base: Vec3::new(c, s, 0.0),
        }
    }

    /// A point near the flank of a tooth at the angle `psi`.
    pub fn near(&self, psi: f64, p: &Vec3) -> Near {
        let (sigma, rb) = (self.side.sign(), self.base_radius);
        let mut near = self.directed(p);
        let ahead = psi + p.z * self.tan_helix / rb - near.base.y.atan2(near.base.x);
        let angle = wrapped(ahead - sigma * (near.roll / rb - self.half_angle));
        near.distance = -sigma * rb * angle * self.cos_helix;
        near
    }
}
