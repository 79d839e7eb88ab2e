//! Two external gears on parallel axes: line of action, path of contact, backlash.
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

use std::f64::consts::{FRAC_PI_2, PI};

use super::Side;
use super::error::{GeometryError, Quantity, positive};
use super::gear::Gear;
use super::involute::inv;

/// A meshing pair of gears; owns numbers only, not the gears.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    centre_distance: f64,
    alpha_w: f64,
    base_pitch: f64,
    length: f64,
    s_start: f64,
    s_end: f64,
    r_base: [f64; 2],
    chi: [f64; 2],
    pitch_radii: [f64; 2],
    face_width: f64,
    beta_b: f64,
    backlash_base: f64,
    clearance: [f64; 2],
}

/// Relative slack on lengths that decide a refusal, far above rounding and far below any tolerance
/// of manufacture.
pub(super) const SLACK: f64 = 1e-10;

/// How far a tip may pass the start of the mate's involute, in modules along the line of action,
/// before it counts as interference: ISO 53 rounds the tip radius factor 0.25 / (1 - sin 20 deg) =
/// 0.3799 to 0.38, so that a standard gear on a standard rack would miss by 1e-4. The path of
/// contact is then cut at the form circle.
pub(super) const FORM_SLACK: f64 = 2e-4;

/// Normal module (m), normal pressure angle and helix angle (rad) of one member.
pub(super) type BasicRack = (f64, f64, f64);

/// Refuses members cut by different basic racks.
pub(super) fn check_same_rack(one: BasicRack, two: BasicRack) -> Result<(), GeometryError> {
    if (one.0 - two.0).abs() > 1e-9 * one.0 {
        return Err(GeometryError::UnequalModules {
            first: one.0,
            second: two.0,
        });
    }
    if (one.1 - two.1).abs() > 1e-9 {
        return Err(GeometryError::UnequalPressureAngles {
            first_deg: one.1.to_degrees(),
            second_deg: two.1.to_degrees(),
        });
    }
    if (one.2 + two.2).abs() > 1e-9 {
        return Err(GeometryError::HelixMismatch {
            first_deg: one.2.to_degrees(),
            second_deg: two.2.to_degrees(),
        });
    }
    Ok(())
}

fn basic_rack(gear: &Gear) -> BasicRack {
    let p = gear.params();
    (p.module, p.pressure_angle, p.helix_angle)
}

/// `p_bt - 2 (r_b1 chi_1 + r_b2 chi_2)`: the backlash on the line of action at `inv(alpha_w) = 0`.
fn backlash_constant(one: &Gear, two: &Gear) -> f64 {
    let chi = one.r_base() * one.half_angle_base() + two.r_base() * two.half_angle_base();
    one.base_pitch() - 2.0 * chi
}

impl Pair {
    /// Sets two gears at a centre distance (m).
    ///
    /// # Errors
    /// [`GeometryError`] for gears that do not belong together, a centre distance without
    /// engagement or with overlapping flanks, tips that reach root or fillet of the mate, and a
    /// total contact ratio below 1.
    pub fn new(one: &Gear, two: &Gear, centre_distance: f64) -> Result<Self, GeometryError> {
        positive(Quantity::CentreDistance, centre_distance)?;
        check_same_rack(basic_rack(one), basic_rack(two))?;
        let a = centre_distance;
        let r_base = [one.r_base(), two.r_base()];
        let base_sum = r_base[0] + r_base[1];
        if a <= base_sum {
            return Err(GeometryError::CentreDistanceTooSmall {
                centre_distance: a,
                base_sum,
            });
        }
        let alpha_w = (base_sum / a).acos();
        let length = ((a - base_sum) * (a + base_sum)).sqrt();
        let s_start = length - two.roll_length_tip();
        let s_end = one.roll_length_tip();
        if a >= one.r_tip() + two.r_tip() || s_end <= s_start {
            let reach = one.roll_length_tip() + two.roll_length_tip();
            return Err(GeometryError::NoEngagement {
                centre_distance: a,
                max_distance: base_sum.hypot(reach).min(one.r_tip() + two.r_tip()),
            });
        }
        let backlash_base = backlash_constant(one, two) + 2.0 * base_sum * inv(alpha_w);
        if backlash_base < -SLACK * a {
            return Err(GeometryError::FlanksOverlap {
                centre_distance: a,
                backlash: backlash_base / alpha_w.cos(),
                min_distance: Self::centre_distance_for_backlash(one, two, 0.0)?,
            });
        }
        let clearance = [
            a - one.r_tip() - two.r_root(),
            a - two.r_tip() - one.r_root(),
        ];
        for (tip_of, clearance) in ["gear 1", "gear 2"].into_iter().zip(clearance) {
            if clearance < -SLACK * a {
                return Err(GeometryError::TipRootCollision { tip_of, clearance });
            }
        }
        // The tip of each gear must meet its mate on the involute.
        for (tip_of, tip, mate) in [("gear 1", one, two), ("gear 2", two, one)] {
            let reach = length - tip.roll_length_tip();
            let below = mate.roll_length_form() - reach;
            if below > FORM_SLACK * one.params().module {
                let allowed = tip.r_base().hypot(length - mate.roll_length_form());
                return Err(GeometryError::Interference {
                    tip_of,
                    below,
                    reduce_by: tip.r_tip() - allowed,
                });
            }
        }
        let pair = Self {
            centre_distance: a,
            alpha_w,
            base_pitch: one.base_pitch(),
            length,
            s_start: s_start.max(one.roll_length_form()),
            s_end: s_end.min(length - two.roll_length_form()),
            r_base,
            chi: [one.half_angle_base(), two.half_angle_base()],
            pitch_radii: r_base.map(|rb| rb / alpha_w.cos()),
            face_width: one.face_width().min(two.face_width()),
            beta_b: one.base_helix_angle(),
            backlash_base: backlash_base.max(0.0),
            clearance,
        };
        if pair.total_contact_ratio() < 1.0 {
            return Err(GeometryError::ContactRatio {
                value: pair.total_contact_ratio(),
            });
        }
        Ok(pair)
    }

    /// Centre distance (m) at which two gears have the circumferential backlash `backlash` (m) at
    /// the working pitch circle; 0 gives the closest mesh free of backlash.
    ///
    /// # Errors
    /// [`GeometryError`] for gears that do not belong together, a negative backlash, or teeth so
    /// thin that the backlash is larger at every centre distance.
    pub fn centre_distance_for_backlash(
        one: &Gear,
        two: &Gear,
        backlash: f64,
    ) -> Result<f64, GeometryError> {
        super::error::not_negative(Quantity::Backlash, backlash)?;
        check_same_rack(basic_rack(one), basic_rack(two))?;
        let base_sum = one.r_base() + two.r_base();
        let constant = backlash_constant(one, two);
        let excess = |aw: f64| constant + 2.0 * base_sum * inv(aw) - backlash * aw.cos();
        if excess(0.0) >= 0.0 {
            return Err(GeometryError::Invalid {
                what: Quantity::Backlash,
                value: backlash,
                expected: "more: the thinned teeth have a larger backlash at any centre distance",
            });
        }
        // The excess rises with the working pressure angle: bisection cannot miss it.
        let (mut lo, mut hi) = (0.0, FRAC_PI_2 - 1e-9);
        for _ in 0..100 {
            let mid = 0.5 * (lo + hi);
            if excess(mid) < 0.0 {
                lo = mid;
            } else {
                hi = mid;
            }
        }
        Ok(base_sum / hi.cos())
    }

    /// Centre distance (m).
    #[must_use]
    pub fn centre_distance(&self) -> f64 {
        self.centre_distance
    }

    /// Transverse working pressure angle (rad).
    #[must_use]
    pub fn working_pressure_angle(&self) -> f64 {
        self.alpha_w
    }

    /// Transverse base pitch (m).
    #[must_use]
    pub fn base_pitch(&self) -> f64 {
        self.base_pitch
    }

    /// Length L of the line of action between its tangent points T1 and T2 (m).
    #[must_use]
    pub fn line_length(&self) -> f64 {
        self.length
    }

    /// Path coordinate of the start of contact A (tip of gear 2) (m).
    #[must_use]
    pub fn s_start(&self) -> f64 {
        self.s_start
    }

    /// Path coordinate of the end of contact E (tip of gear 1) (m).
    #[must_use]
    pub fn s_end(&self) -> f64 {
        self.s_end
    }

    /// Path coordinate of the pitch point C (m).
    #[must_use]
    pub fn s_pitch(&self) -> f64 {
        self.r_base[0] * self.alpha_w.tan()
    }

    /// Transverse contact ratio.
    #[must_use]
    pub fn contact_ratio(&self) -> f64 {
        (self.s_end - self.s_start) / self.base_pitch
    }

    /// Overlap ratio over the common face width; 0 for spur gears.
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

    /// Circumferential backlash at the working pitch circle, transverse (m).
    #[must_use]
    pub fn backlash_circ(&self) -> f64 {
        self.backlash_base / self.alpha_w.cos()
    }

    /// Transverse backlash along the line of action (m): the sum of the gaps of both flanks.
    #[must_use]
    pub fn backlash_base(&self) -> f64 {
        self.backlash_base
    }

    /// Normal backlash (m): shortest distance between the idle flanks when the others touch.
    #[must_use]
    pub fn backlash_normal(&self) -> f64 {
        self.backlash_base * self.beta_b.cos()
    }

    /// Working pitch radii of both gears (m).
    #[must_use]
    pub fn pitch_radii(&self) -> [f64; 2] {
        self.pitch_radii
    }

    /// Tip clearance (m): tip of gear 1 to root of gear 2, tip of gear 2 to root of gear 1.
    #[must_use]
    pub fn tip_clearance(&self) -> [f64; 2] {
        self.clearance
    }

    /// Path coordinate `s_1` (m) that a flank of gear 1 reaches when the centreline of its tooth
    /// stands at `theta` (rad).
    #[inline]
    #[must_use]
    pub fn path_coordinate(&self, theta: f64, side: Side) -> f64 {
        self.r_base[0] * (side.sign() * theta + self.alpha_w + self.chi[0])
    }

    /// Path coordinate `s_2` (m), counted from T2 towards T1, that a flank of gear 2 reaches when
    /// the centreline of its tooth stands at `theta` (rad).
    #[inline]
    #[must_use]
    pub fn path_coordinate_2(&self, theta: f64, side: Side) -> f64 {
        self.r_base[1] * (side.sign() * (theta - PI) + self.alpha_w + self.chi[1])
    }

    /// Gap (m) along the line of action, positive when open, between the flanks of `side` of two
    /// teeth whose centrelines stand at `theta_1` and `theta_2` (rad).
    #[inline]
    #[must_use]
    pub fn gap(&self, theta_1: f64, theta_2: f64, side: Side) -> f64 {
        self.length - self.path_coordinate(theta_1, side) - self.path_coordinate_2(theta_2, side)
    }

    /// Centreline angle (rad) of the tooth of gear 1 whose flank of `side` stands at `s` (m).
    #[must_use]
    pub fn tooth_angle_1(&self, s: f64, side: Side) -> f64 {
        side.sign() * (s / self.r_base[0] - self.alpha_w - self.chi[0])
    }

    /// Centreline angle (rad) of the tooth of gear 2 whose flank of `side` stands `gap` (m) away
    /// from a flank of gear 1 at path coordinate `s` (m).
    #[must_use]
    pub fn tooth_angle_2(&self, s: f64, gap: f64, side: Side) -> f64 {
        let s_2 = self.length - s - gap;
        PI + side.sign() * (s_2 / self.r_base[1] - self.alpha_w - self.chi[1])
    }
}
