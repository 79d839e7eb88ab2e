//! A gear and its mate, a second gear on a parallel axis or a rack: line of action, path of contact, backlash.
//!
//! ```text
//! cos(alpha_w) = (r_b1 + r_b2) / a          L = (r_b1 + r_b2) tan(alpha_w)
//! s_A = L - sqrt(r_a2^2 - r_b2^2)           s_E = sqrt(r_a1^2 - r_b1^2)        s_C = r_b1 tan(alpha_w)
//! eps_alpha = (s_E - s_A) / p_bt            eps_beta = b tan|beta_b| / p_bt
//! j_bt = p_bt - 2 r_b1 (chi_1 - inv alpha_w) - 2 r_b2 (chi_2 - inv alpha_w) = j_wt cos(alpha_w)
//! ```
//!
//! ISO 21771-1, clauses on the cylindrical gear pair. For a tooth of gear 1 with centreline angle
//! `theta_1` and a tooth of gear 2 with `theta_2` (both absolute, gear 2 centred at `(a, 0)`), the
//! flanks of `side` (sign sigma) reach along the line of action
//!
//! ```text
//! s_1 = r_b1 (sigma theta_1 + alpha_w + chi_1)
//! s_2 = r_b2 (sigma (theta_2 - pi) + alpha_w + chi_2)       gap = L - s_1 - s_2
//! ```
//!
//! `s_2` counts from T2 towards T1; the gap is positive when open.
//!
//! An internal gear has negative radii, half angles and lengths of roll in all of this, and the centre distance is negative: the
//! line of action runs on beyond the pitch point, `L` is negative, T2 lies behind T1, and both gears turn in one sense. A
//! flank of its mate then touches the flank of the other side on it; `side` is that of the external gear. Angles of a
//! tooth count from the line of centres: the pitch point is at the angle 0 from the axis of gear 1, at `pi` from that of an
//! external gear 2 and at 0 from those of an internal gear and its mate.
//!
//! A rack is the limit of an infinite radius: the working pressure angle is `alpha_t` at any distance and the gear
//! rolls on its reference circle. With the rack's reference line at `x = D`, `y` the centreline position of its tooth
//! and `w_0` its half thickness at the reference line,
//!
//! ```text
//! s_A = (D - h_a - r_b cos(alpha_t)) / sin(alpha_t)
//! gap = (sigma y - w_0) cos(alpha_t) + D sin(alpha_t) - s_1
//! ```

use super::Side;
use super::gear::Gear;
use super::rack::Rack;

/// The mate of a gear: a gear or a rack.
#[derive(Clone, Copy, Debug)]
pub enum Mate<'a> {
    /// The mate is a gear.
    Gear(&'a Gear),
    /// The mate is a rack.
    Rack(&'a Rack),
}

impl<'a> From<&'a Gear> for Mate<'a> {
    fn from(gear: &'a Gear) -> Self {
        Mate::Gear(gear)
    }
}

impl<'a> From<&'a Rack> for Mate<'a> {
    fn from(rack: &'a Rack) -> Self {
        Mate::Rack(rack)
    }
}

/// A gear in mesh with its mate; it has numbers only, not the bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    pub(super) distance: f64,
    pub(super) alpha_w: f64,
    pub(super) base_pitch: f64,
    pub(super) s_start: f64,
    pub(super) s_end: f64,
    pub(super) r_base: f64,
    pub(super) chi: f64,
    pub(super) second: MateFlanks,
    pub(super) pitch_radii: [f64; 2],
    pub(super) face_width: f64,
    pub(super) beta_b: f64,
    pub(super) backlash_base: f64,
    pub(super) backlash_circ: f64,
}

/// Flanks of the mate.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum MateFlanks {
    Gear {
        length: f64,
        r_base: f64,
        chi: f64,
        /// Direction of the pitch point from its axis.
        towards: f64,
    },
    Rack {
        half_thickness: f64,
    },
}

impl Pair {
    /// Returns the centre distance, or the distance to the rack's reference line (m).
    pub fn centre_distance(&self) -> f64 {
        self.distance
    }

    /// Returns the transverse working pressure angle (rad).
    pub fn working_pressure_angle(&self) -> f64 {
        self.alpha_w
    }

    /// Returns the transverse base pitch (m).
    pub fn base_pitch(&self) -> f64 {
        self.base_pitch
    }

    /// Returns the length L of the line of action between its tangent points T1 and T2 (m), infinite for a rack,
    /// negative for an internal gear.
    pub fn line_length(&self) -> f64 {
        match self.second {
            MateFlanks::Gear { length, .. } => length,
            MateFlanks::Rack { .. } => f64::INFINITY,
        }
    }

    /// Returns the path coordinate of the start of contact A (tip of the mate) (m).
    pub fn s_start(&self) -> f64 {
        self.s_start
    }

    /// Returns the path coordinate of the end of contact E (tip of gear 1) (m).
    pub fn s_end(&self) -> f64 {
        self.s_end
    }

    /// Returns the path coordinate of the pitch point C (m).
    pub fn s_pitch(&self) -> f64 {
        self.r_base * self.alpha_w.tan()
    }

    /// Returns the sign of the number of teeth of gear 1: -1 for an internal gear, whose path coordinates are
    /// negative.
    pub fn first_sign(&self) -> f64 {
        self.r_base.signum()
    }

    /// Returns true if one of both gears is internal.
    pub fn is_internal(&self) -> bool {
        let second = match self.second {
            MateFlanks::Gear { r_base, .. } => r_base,
            MateFlanks::Rack { .. } => 0.0,
        };
        self.r_base.min(second) < 0.0
    }

    /// Returns the transverse contact ratio.
    pub fn contact_ratio(&self) -> f64 {
        (self.s_end - self.s_start) / self.base_pitch
    }

    /// Returns the overlap ratio over the common face width; 0 for spur teeth.
    pub fn overlap_ratio(&self) -> f64 {
        self.face_width * self.beta_b.tan().abs() / self.base_pitch
    }

    /// Returns the total contact ratio: transverse plus overlap.
    pub fn total_contact_ratio(&self) -> f64 {
        self.contact_ratio() + self.overlap_ratio()
    }

    /// Returns the common face width (m).
    pub fn face_width(&self) -> f64 {
        self.face_width
    }

    /// Returns the circumferential transverse backlash at the working pitch circle (m).
    pub fn backlash_circ(&self) -> f64 {
        self.backlash_circ
    }

    /// Returns the transverse backlash along the line of action (m): the sum of the gaps of both flanks.
    pub fn backlash_base(&self) -> f64 {
        self.backlash_base
    }

    /// Returns the normal backlash (m): the shortest distance between the non-working flanks when the working flanks
    /// touch.
    pub fn backlash_normal(&self) -> f64 {
        self.backlash_base * self.beta_b.cos()
    }

    /// Returns the working pitch radii (m); that of a rack is infinite, that of an internal gear negative.
    pub fn pitch_radii(&self) -> [f64; 2] {
        self.pitch_radii
    }

    /// Returns the path coordinate `s_1` (m) of a flank of gear 1 when the centreline of its tooth is at `theta`
    /// (rad).
    #[inline]
    pub fn path_coordinate(&self, theta: f64, side: Side) -> f64 {
        self.r_base * (side.sign() * theta + self.alpha_w + self.chi)
    }

    /// Returns the gap (m) along the line of action, positive when open, between the flanks of `side` of two teeth:
    /// that of gear 1 with its centreline at `theta` (rad), that of its mate at `other` (rad, or m along a rack).
    #[inline]
    pub fn gap(&self, theta: f64, other: f64, side: Side) -> f64 {
        let s_1 = self.path_coordinate(theta, side);
        match self.second {
            MateFlanks::Gear {
                length,
                r_base,
                chi,
                towards,
            } => length - s_1 - r_base * (side.sign() * (other - towards) + self.alpha_w + chi),
            MateFlanks::Rack { half_thickness } => {
                let (sin, cos) = self.alpha_w.sin_cos();
                (side.sign() * other - half_thickness) * cos + self.distance * sin - s_1
            }
        }
    }

    /// Returns the centreline angle (rad) of the tooth of gear 1 whose flank of `side` is at the path coordinate `s`
    /// (m).
    #[inline]
    pub fn tooth_angle(&self, s: f64, side: Side) -> f64 {
        side.sign() * (s / self.r_base - self.alpha_w - self.chi)
    }

    /// Returns the centreline (rad, or m along a rack) of the tooth of the mate whose flank of `side` has the distance
    /// `gap` (m) from a flank of gear 1 at path coordinate `s` (m).
    #[inline]
    pub fn mate_position(&self, s: f64, gap: f64, side: Side) -> f64 {
        match self.second {
            MateFlanks::Gear {
                length,
                r_base,
                chi,
                towards,
            } => towards + side.sign() * ((length - s - gap) / r_base - self.alpha_w - chi),
            MateFlanks::Rack { half_thickness } => {
                let (sin, cos) = self.alpha_w.sin_cos();
                side.sign() * ((s + gap - self.distance * sin) / cos + half_thickness)
            }
        }
    }
}
