//! An involute gear: its parameters and every derived quantity.
//!
//! ```text
//! tan(alpha_t) = tan(alpha_n) / cos(beta)     sin(beta_b) = sin(beta) cos(alpha_n)
//! r = z m_n / (2 cos(beta))    r_b = r cos(alpha_t)
//! r_a = r + m_n (h_a* + x)     r_f = r + m_n (x - h_f*)
//! psi = (pi/2 + 2 x tan(alpha_n)) / z - thinning / (2 r)       chi = psi + inv(alpha_t)
//! half angle at r (involute): chi - inv(acos(r_b / r))
//! ```
//!
//! ISO 21771-1. Tip, root and fillet of external gears are those of the module `profile`, of internal ones those of `internal`.

use std::f64::consts::PI;
use std::sync::Arc;

use super::Side;
use super::deviation::{ToothDeviations, Toothing};
use super::error::{GeometryError, finite};
use super::helicoid::InvoluteHelicoid;
use super::internal;
use super::involute::inv_of_tangent;
use super::modification::FlankRange;
use super::parameters::GearParams;
use super::profile::{self, Profile};
use super::quantity::Quantity;

/// Ratio of the seat radius of a solid gear to its root radius: that of a gear on a shaft with a key.
const SEAT: f64 = 0.5;

/// An involute gear that can be cut: parameters and derived quantities.
#[derive(Clone, Debug, PartialEq)]
pub struct Gear {
    params: Box<GearParams>,
    alpha_t: f64,
    beta_b: f64,
    r: f64,
    r_base: f64,
    pub(super) profile: Profile,
    /// Length of roll at the form circle, at the tip and at the start of the tip relief (m).
    roll: [f64; 3],
    deviations: Option<Arc<ToothDeviations>>,
    /// Left and right flank.
    pub(super) flanks: Box<[InvoluteHelicoid; 2]>,
}

impl Gear {
    /// Derives a gear from its parameters.
    ///
    /// # Errors
    /// [`GeometryError`] for values out of range, undercut, pointed teeth, a tool tip that does not
    /// fit, a vanishing involute, a bore beyond the root, or modifications off the flank.
    pub fn new(params: GearParams) -> Result<Self, GeometryError> {
        params.check()?;
        let p = &params;
        let z = f64::from(p.teeth);
        let (m, beta) = (p.module, p.helix_angle);
        let alpha_t = (p.pressure_angle.tan() / beta.cos()).atan();
        let beta_b = (beta.sin() * p.pressure_angle.cos()).asin();
        let r = 0.5 * z * m / beta.cos();
        let r_base = r * alpha_t.cos();
        finite(Quantity::ReferenceCircle, r)?;
        let profile = match &p.internal {
            None => profile::external(p, [r, r_base], alpha_t)?,
            Some(of) => internal::profile(p, of, [r, r_base], alpha_t)?,
        };
        let Profile { r_tip, r_form, .. } = profile;
        params.modifications.check(
            [r_form, r_tip],
            params.face_width,
            params.internal.is_some(),
        )?;
        let sign = if params.internal.is_some() { -1.0 } else { 1.0 };
        let roll_of = |radius: f64| sign * (radius * radius - r_base * r_base).max(0.0).sqrt();
        let [s_form, s_tip] = profile.roll;
        let s_relief = params
            .modifications
            .tip_relief
            .map_or(s_tip, |relief| roll_of(relief.start_radius));
        let toothing = Toothing {
            teeth: params.teeth,
            module: params.module,
            r,
            r_base,
            chi: profile.chi,
            roll: [s_form, roll_of(r), s_tip],
        };
        let deviations = ToothDeviations::new(&params.deviations, toothing)?.map(Arc::new);
        let gear = Self {
            params: Box::new(params),
            alpha_t,
            beta_b,
            r,
            r_base,
            roll: [s_form, s_tip, s_relief],
            deviations,
            flanks: Box::new(Side::BOTH.map(|side| InvoluteHelicoid {
                side,
                base_radius: r_base,
                tan_helix: beta_b.tan(),
                cos_helix: beta_b.cos(),
                half_angle: profile.chi,
            })),
            profile,
        };
        let gear = if gear.is_conical() {
            gear.conical()?
        } else {
            gear
        };
        gear.check_depth_of_modifications()?;
        Ok(gear)
    }

    /// Checks that the modifications leave some tooth at the tip.
    fn check_depth_of_modifications(&self) -> Result<(), GeometryError> {
        let of_all = [Side::Left, Side::Right].map(|side| {
            let ends = [-1.0, 1.0].map(|zeta| self.flank_deviation(side, self.r_tip(), zeta));
            ends[0].max(ends[1])
        });
        let removed = of_all[0].max(of_all[1]) + self.stands_out();
        // The tooth centreline is r_b times the half angle away, measured along the line of action.
        let available = self.r_base * self.half_angle_at(self.r_tip()) * self.beta_b.cos();
        if removed < available {
            Ok(())
        } else {
            Err(GeometryError::ModificationTooDeep { removed, available })
        }
    }

    /// Returns the parameters of the gear.
    pub fn params(&self) -> &GearParams {
        &self.params
    }

    /// Returns the number of teeth.
    pub fn teeth(&self) -> u32 {
        self.params.teeth
    }

    /// Returns the face width (m).
    pub fn face_width(&self) -> f64 {
        self.params.face_width
    }

    /// Returns the transverse pressure angle at the reference circle (rad).
    pub fn transverse_pressure_angle(&self) -> f64 {
        self.alpha_t
    }

    /// Returns the helix angle on the base cylinder (rad), signed as the helix angle.
    pub fn base_helix_angle(&self) -> f64 {
        self.beta_b
    }

    /// Returns the transverse module (m).
    pub fn transverse_module(&self) -> f64 {
        self.params.module / self.params.helix_angle.cos()
    }

    /// Returns the reference radius (m).
    pub fn r_reference(&self) -> f64 {
        self.r
    }

    /// Returns the base radius (m).
    pub fn r_base(&self) -> f64 {
        self.r_base
    }

    /// Returns the tip radius (m).
    pub fn r_tip(&self) -> f64 {
        self.profile.r_tip
    }

    /// Returns the root radius (m).
    pub fn r_root(&self) -> f64 {
        self.profile.r_root
    }

    /// Returns the radius at which the body is supported (m): the bore, or for a solid gear the seat that represents
    /// its shaft, half the root radius; for an internal gear the outer radius of its rim.
    pub fn seat_radius(&self) -> f64 {
        if self.is_internal() {
            return self.r_outer();
        }
        let bore = self.params.bore_radius;
        if bore > 0.0 {
            bore
        } else {
            SEAT * self.r_root()
        }
    }

    /// Returns the form radius (m): where the fillet ends and the involute begins.
    pub fn r_form(&self) -> f64 {
        self.profile.r_form
    }

    /// Returns the transverse base pitch (m).
    pub fn base_pitch(&self) -> f64 {
        self.r_base * self.pitch_angle()
    }

    /// Returns the angular pitch 2 pi / z (rad).
    pub fn pitch_angle(&self) -> f64 {
        2.0 * PI / f64::from(self.params.teeth)
    }

    /// Returns half the tooth thickness angle at the reference circle (rad), including thinning.
    pub fn half_angle_reference(&self) -> f64 {
        self.profile.psi
    }

    /// Returns the angle between the tooth centreline and the origin of the flank on the base circle (rad); negative
    /// where the flanks of an internal tooth intersect before it.
    pub fn half_angle_base(&self) -> f64 {
        self.profile.chi
    }

    /// Returns the length of roll (path coordinate) (m) of the involute at radius `r` (m); 0 below the base, negative
    /// on an internal gear.
    pub fn roll_length(&self, r: f64) -> f64 {
        self.sign() * ((r - self.r_base) * (r + self.r_base)).max(0.0).sqrt()
    }

    /// Returns the length of roll at the form circle (m).
    pub fn roll_length_form(&self) -> f64 {
        self.roll[0]
    }

    /// Returns the length of roll at the tip circle (m).
    pub fn roll_length_tip(&self) -> f64 {
        self.roll[1]
    }

    /// Returns half the tooth thickness angle (rad) on the involute at length of roll `s` (m); the point has radius
    /// `sqrt(r_b^2 + s^2)`. Unlike [`Gear::half_angle_at`] it is smooth where the involute meets the base circle.
    pub fn half_angle_at_roll(&self, s: f64) -> f64 {
        self.profile.chi - inv_of_tangent(s / self.r_base)
    }

    /// Returns half the tooth thickness angle (rad) at radius `r` (m): involute between tip and form radius,
    /// trochoidal fillet down to the root. `r` is limited to the range from root to tip radius.
    pub fn half_angle_at(&self, r: f64) -> f64 {
        let (root, form, tip) = (self.r_root(), self.r_form(), self.r_tip());
        if self.sign() * (r - form) >= 0.0 {
            return self.half_angle_at_roll(self.roll_length(if self.sign() * (r - tip) > 0.0 {
                tip
            } else {
                r
            }));
        }
        let r = if self.sign() * (r - root) < 0.0 {
            root
        } else {
            r
        };
        0.5 * self.pitch_angle()
            - self
                .profile
                .fillet
                .delta_at(((r - root) * (r + root)).abs())
    }

    /// Returns a point of the left fillet by its own parameter, from 0 at the root circle to 1 at the form circle:
    /// radius (m) and half tooth thickness angle (rad).
    pub fn fillet_at(&self, t: f64) -> (f64, f64) {
        let fillet = &self.profile.fillet;
        let p = fillet.at(fillet.q_max() * t.clamp(0.0, 1.0));
        (p.r2.sqrt(), 0.5 * self.pitch_angle() - p.delta)
    }

    /// Returns the material removed normal to the flanks of a side (m) by its modifications at radius `r` (m) and at
    /// `zeta` in [-1, 1] over the face width; negative only for a measured topography. Below the form radius it is the
    /// value there.
    pub fn flank_deviation(&self, side: Side, r: f64, zeta: f64) -> f64 {
        let modifications = &self.params.modifications;
        if modifications.is_none() {
            return 0.0;
        }
        modifications.removed(side, self.roll_length(r), &self.flank_range(), zeta)[0]
    }

    pub(super) fn flank_range(&self) -> FlankRange {
        FlankRange {
            roll: self.roll,
            r_base: self.r_base,
            half_width: 0.5 * self.params.face_width,
        }
    }

    /// Returns the part of the removed material that varies over the width alone (m).
    pub fn lead_deviation(&self, side: Side, zeta: f64) -> f64 {
        let half_width = 0.5 * self.params.face_width;
        self.params.modifications.over_width(side, zeta, half_width)[0]
    }

    /// Returns the side of a counter-clockwise or clockwise flank as seen from the root to the tip of its tooth, and
    /// back: the opposite one on an internal gear, whose teeth point to the axis.
    #[inline]
    #[must_use]
    pub fn side_from_root(&self, side: Side) -> Side {
        if self.is_internal() {
            side.opposite()
        } else {
            side
        }
    }

    /// Returns true if the flanks differ between transverse sections, including a rotation by the helix.
    pub fn varies_over_width(&self) -> bool {
        self.params.helix_angle != 0.0
            || self.is_conical()
            || self.params.modifications.vary_over_width()
    }

    #[inline]
    #[cfg(test)]
    pub(super) fn deviations(&self) -> Option<&Arc<ToothDeviations>> {
        self.deviations.as_ref()
    }

    /// Returns true if teeth have individual deviations.
    #[inline]
    pub fn deviates(&self) -> bool {
        self.deviations.is_some()
    }

    /// Returns the material removed normal to the flank of one tooth (m) at radius `radius` (m), in addition to that
    /// of all teeth ([`Gear::flank_deviation`]); negative for additional material. Teeth count counter-clockwise, on
    /// over turns. Below the form radius it is the value there.
    #[inline]
    pub fn tooth_deviation(&self, tooth: i64, side: Side, radius: f64) -> f64 {
        let s = self.roll_length(radius).clamp(self.roll[0], self.roll[1]);
        self.tooth_deviation_at_roll(tooth, side, s)[0]
    }

    /// Returns the material removed from one tooth at the length of roll `s` (m), and its first two derivatives (-,
    /// 1/m): smooth, and continued beyond form circle and tip. It takes constant time without allocation.
    #[inline]
    pub fn tooth_deviation_at_roll(&self, tooth: i64, side: Side, s: f64) -> [f64; 3] {
        match &self.deviations {
            None => [0.0; 3],
            Some(d) => d.at(tooth, side, s).map(|x| x * self.beta_b.cos()),
        }
    }

    /// Returns the largest protrusion of flanks beyond their involutes (m), by a measured topography or by deviations
    /// of teeth.
    pub fn stands_out(&self) -> f64 {
        let measured = self.params.modifications.topography.iter().flatten();
        // Between the amounts of a grid its cubics go beyond them.
        let measured = measured.map(|t| 2.0 * t.greatest()).fold(0.0, f64::max);
        measured + self.greatest_tooth_deviation()
    }

    /// Returns the largest deviation of the flank of any tooth from the common position (m).
    pub fn greatest_tooth_deviation(&self) -> f64 {
        let greatest = self.deviations.as_ref().map_or(0.0, |d| d.greatest());
        greatest * self.beta_b.cos()
    }
}
