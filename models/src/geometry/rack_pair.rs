//! A gear on a rack: the limit of a pair in which gear 2 has an infinite radius.
//!
//! The working pressure angle is `alpha_t` at any distance and the gear rolls on its reference
//! circle. With the gear at the origin and the rack's reference line at `x = D`:
//!
//! ```text
//! s_A = (D - h_a - r_b cos(alpha_t)) / sin(alpha_t)   s_E = sqrt(r_a^2 - r_b^2)   s_C = r_b tan(alpha_t)
//! s   = r_b (sigma theta + alpha_t + chi)
//! gap = (sigma y - w_0) cos(alpha_t) + D sin(alpha_t) - s
//! ```
//!
//! with `theta` the centreline angle of the gear tooth, `y` the centreline position of the rack
//! tooth and `w_0` its half thickness at the reference line. ISO 21771-1.

use super::Side;
use super::error::{GeometryError, Quantity, positive};
use super::gear::Gear;
use super::pair::{FORM_SLACK, SLACK, check_same_rack};
use super::rack::Rack;

/// A gear meshing with a rack; owns numbers only.
#[derive(Clone, Debug, PartialEq)]
pub struct RackPair {
    distance: f64,
    alpha: f64,
    base_pitch: f64,
    s_start: f64,
    s_end: f64,
    r_base: f64,
    r_pitch: f64,
    chi: f64,
    half_thickness: f64,
    face_width: f64,
    beta_b: f64,
    backlash_circ: f64,
    clearance: [f64; 2],
}

impl RackPair {
    /// Sets a gear at `distance` (m) from its centre to the reference line of a rack.
    ///
    /// # Errors
    /// [`GeometryError`] as for [`super::Pair::new`].
    pub fn new(gear: &Gear, rack: &Rack, distance: f64) -> Result<Self, GeometryError> {
        positive(Quantity::RackDistance, distance)?;
        let (g, k) = (gear.params(), rack.params());
        check_same_rack(
            (g.module, g.pressure_angle, g.helix_angle),
            (k.module, k.pressure_angle, k.helix_angle),
        )?;
        let alpha = gear.transverse_pressure_angle();
        let (sin, cos) = alpha.sin_cos();
        let (r, r_base) = (gear.r_reference(), gear.r_base());
        let s_of_x = |x: f64| (x - r_base * cos) / sin;
        let s_start = s_of_x(distance - rack.tip_height());
        let s_end = gear.roll_length_tip();
        if s_end <= s_start || distance - rack.tip_height() >= gear.r_tip() {
            let reach = (r_base * cos + s_end * sin).min(gear.r_tip());
            return Err(GeometryError::NoEngagement {
                centre_distance: distance,
                max_distance: reach + rack.tip_height(),
            });
        }
        // Thickness of both teeth and the pitch, on the reference circle rolling on the pitch line.
        let rack_half = rack.half_thickness_on_flank(distance - r);
        let backlash_circ = rack.pitch() - 2.0 * r * gear.half_angle_reference() - 2.0 * rack_half;
        if backlash_circ < -SLACK * distance {
            return Err(GeometryError::FlanksOverlap {
                centre_distance: distance,
                backlash: backlash_circ,
                min_distance: distance - backlash_circ / (2.0 * alpha.tan()),
            });
        }
        let clearance = [
            distance + rack.root_depth() - gear.r_tip(),
            distance - rack.tip_height() - gear.r_root(),
        ];
        for (tip_of, clearance) in ["gear 1", "the rack"].into_iter().zip(clearance) {
            if clearance < -SLACK * distance {
                return Err(GeometryError::TipRootCollision { tip_of, clearance });
            }
        }
        let below = gear.roll_length_form() - s_start;
        if below > FORM_SLACK * g.module {
            return Err(GeometryError::Interference {
                tip_of: "the rack",
                below,
                reduce_by: below * sin,
            });
        }
        let s_rack_form = s_of_x(distance + rack.form_depth());
        if s_end - s_rack_form > FORM_SLACK * g.module {
            return Err(GeometryError::Interference {
                tip_of: "gear 1",
                below: s_end - s_rack_form,
                reduce_by: gear.r_tip() - r_base.hypot(s_rack_form),
            });
        }
        let pair = Self {
            distance,
            alpha,
            base_pitch: gear.base_pitch(),
            s_start: s_start.max(gear.roll_length_form()),
            s_end: s_end.min(s_rack_form),
            r_base,
            r_pitch: r,
            chi: gear.half_angle_base(),
            half_thickness: rack.half_thickness_reference(),
            face_width: gear.face_width().min(rack.face_width()),
            beta_b: gear.base_helix_angle(),
            backlash_circ: backlash_circ.max(0.0),
            clearance,
        };
        if pair.total_contact_ratio() < 1.0 {
            return Err(GeometryError::ContactRatio {
                value: pair.total_contact_ratio(),
            });
        }
        Ok(pair)
    }

    /// Distance from the gear centre to the rack's reference line (m).
    #[must_use]
    pub fn centre_distance(&self) -> f64 {
        self.distance
    }

    /// Transverse working pressure angle (rad): that of the rack.
    #[must_use]
    pub fn working_pressure_angle(&self) -> f64 {
        self.alpha
    }

    /// Transverse base pitch (m).
    #[must_use]
    pub fn base_pitch(&self) -> f64 {
        self.base_pitch
    }

    /// Length of the line of action: infinite, for a rack has its tangent point at infinity.
    #[must_use]
    pub fn line_length(&self) -> f64 {
        f64::INFINITY
    }

    /// Path coordinate of the start of contact (tip of the rack) (m).
    #[must_use]
    pub fn s_start(&self) -> f64 {
        self.s_start
    }

    /// Path coordinate of the end of contact (tip of the gear) (m).
    #[must_use]
    pub fn s_end(&self) -> f64 {
        self.s_end
    }

    /// Path coordinate of the pitch point (m).
    #[must_use]
    pub fn s_pitch(&self) -> f64 {
        self.r_base * self.alpha.tan()
    }

    /// Transverse contact ratio.
    #[must_use]
    pub fn contact_ratio(&self) -> f64 {
        (self.s_end - self.s_start) / self.base_pitch
    }

    /// Overlap ratio over the common face width; 0 for spur teeth.
    #[must_use]
    pub fn overlap_ratio(&self) -> f64 {
        self.face_width * self.beta_b.tan().abs() / self.base_pitch
    }

    /// Total contact ratio: transverse plus overlap.
    #[must_use]
    pub fn total_contact_ratio(&self) -> f64 {
        self.contact_ratio() + self.overlap_ratio()
    }

    /// Common face width (m).
    #[must_use]
    pub fn face_width(&self) -> f64 {
        self.face_width
    }

    /// Backlash along the pitch line, transverse (m).
    #[must_use]
    pub fn backlash_circ(&self) -> f64 {
        self.backlash_circ
    }

    /// Transverse backlash along the line of action (m): the sum of the gaps of both flanks.
    #[must_use]
    pub fn backlash_base(&self) -> f64 {
        self.backlash_circ * self.alpha.cos()
    }

    /// Normal backlash (m): shortest distance between the idle flanks when the others touch.
    #[must_use]
    pub fn backlash_normal(&self) -> f64 {
        self.backlash_base() * self.beta_b.cos()
    }

    /// Working pitch radius of the gear (m), its reference radius; that of the rack is infinite.
    #[must_use]
    pub fn pitch_radii(&self) -> [f64; 2] {
        [self.r_pitch, f64::INFINITY]
    }

    /// Tip clearance (m): gear tip to rack root, rack tip to gear root.
    #[must_use]
    pub fn tip_clearance(&self) -> [f64; 2] {
        self.clearance
    }

    /// Path coordinate (m) that a flank of the gear reaches when the centreline of its tooth stands
    /// at `theta` (rad).
    #[inline]
    #[must_use]
    pub fn path_coordinate(&self, theta: f64, side: Side) -> f64 {
        self.r_base * (side.sign() * theta + self.alpha + self.chi)
    }

    /// Gap (m) along the line of action, positive when open, between the gear flank of `side` of a
    /// tooth at `theta` (rad) and the facing flank of a rack tooth centred at `y` (m).
    #[inline]
    #[must_use]
    pub fn gap(&self, theta: f64, y: f64, side: Side) -> f64 {
        let (sin, cos) = self.alpha.sin_cos();
        (side.sign() * y - self.half_thickness) * cos + self.distance * sin
            - self.path_coordinate(theta, side)
    }

    /// Centreline angle (rad) of the gear tooth whose flank of `side` stands at `s` (m).
    #[must_use]
    pub fn tooth_angle(&self, s: f64, side: Side) -> f64 {
        side.sign() * (s / self.r_base - self.alpha - self.chi)
    }

    /// Centreline position (m) of the rack tooth that stands `gap` (m) away from a gear flank of
    /// `side` at path coordinate `s` (m).
    #[must_use]
    pub fn rack_position(&self, s: f64, gap: f64, side: Side) -> f64 {
        let (sin, cos) = self.alpha.sin_cos();
        side.sign() * ((s + gap - self.distance * sin) / cos + self.half_thickness)
    }
}
