//! An external involute gear: what a user gives and every derived quantity.
//!
//! ```text
//! tan(alpha_t) = tan(alpha_n) / cos(beta)     sin(beta_b) = sin(beta) cos(alpha_n)
//! r = z m_n / (2 cos(beta))    r_b = r cos(alpha_t)
//! r_a = r + m_n (h_a* + x)     r_f = r + m_n (x - h_f*)
//! psi = (pi/2 + 2 x tan(alpha_n)) / z - thinning / (2 r)       chi = psi + inv(alpha_t)
//! half angle at r (involute): chi - inv(acos(r_b / r))
//! ```
//!
//! ISO 21771-1. The involute starts where the straight flank of the rack tool ends: at depth `d_j`
//! below the rolling line the length of roll is `s_form = r sin(alpha_t) - d_j / sin(alpha_t)`,
//! and undercut means `s_form < 0`. Below it lies the trochoid of the `fillet` module. Thinning is
//! made by a wider tool tooth at unchanged depth, so the root circle keeps its radius.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use super::Side;
use super::deviation::{ToothDeviations, Toothing};
use super::error::{GeometryError, finite};
use super::fillet::{Fillet, ToolTip};
use super::helicoid::InvoluteHelicoid;
use super::involute::{inv, inv_inverse, inv_of_tangent};
use super::modification::FlankRange;
use super::parameters::GearParams;
use super::quantity::Quantity;

/// Seat over root radius of a solid gear: that of a gear on a shaft with a key.
const SEAT: f64 = 0.5;

/// An external involute gear that can be cut: parameters and derived quantities.
#[derive(Clone, Debug, PartialEq)]
pub struct Gear {
    params: Box<GearParams>,
    alpha_t: f64,
    beta_b: f64,
    r: f64,
    r_base: f64,
    r_tip: f64,
    r_root: f64,
    r_form: f64,
    psi: f64,
    chi: f64,
    /// Length of roll at the form circle, at the tip and at the start of the tip relief (m).
    roll: [f64; 3],
    pub(super) fillet: Fillet,
    deviations: Option<Arc<ToothDeviations>>,
    /// Left and right.
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
        let (m, x, beta) = (p.module, p.profile_shift, p.helix_angle);
        let tan_alpha_n = p.pressure_angle.tan();
        let alpha_t = (tan_alpha_n / beta.cos()).atan();
        let beta_b = (beta.sin() * p.pressure_angle.cos()).asin();
        let r = 0.5 * z * m / beta.cos();
        let r_base = r * alpha_t.cos();
        let r_tip = r + m * (p.addendum + x);
        let r_root = r + m * (x - p.dedendum);
        for (what, value) in [
            (Quantity::ReferenceCircle, r),
            (Quantity::TipCircle, r_tip),
            (Quantity::RootCircle, r_root),
        ] {
            finite(what, value)?;
        }
        if r_root <= 0.0 {
            return Err(GeometryError::NoRoot { r_root });
        }
        if p.bore_radius >= r_root {
            return Err(GeometryError::BoreTooLarge {
                bore: p.bore_radius,
                r_root,
            });
        }
        let psi_full = (FRAC_PI_2 + 2.0 * x * tan_alpha_n) / z;
        let psi = psi_full - p.thinning / (2.0 * r);
        let chi = psi + inv(alpha_t);
        // Where the flanks meet: chi = inv(alpha). Not above the base circle when chi <= 0.
        let r_pointed = r_base / inv_inverse(chi.max(0.0)).cos();
        if p.thinning > 0.0 && psi <= 0.0 && psi_full > 0.0 {
            return Err(GeometryError::NoToothLeft {
                thinning: p.thinning,
                thickness: 2.0 * r * psi_full,
            });
        }
        if chi <= 0.0 || r_pointed <= r_tip {
            return Err(GeometryError::PointedTooth {
                r_tip,
                r_pointed,
                max_addendum: (r_pointed - r) / m - x,
            });
        }

        // The tool tooth fills the tooth space: its half width at the rolling line.
        let half_space = r * (PI / z - psi) * beta.cos();
        let d_tip = m * (p.dedendum - x);
        let alpha_n = p.pressure_angle;
        let tip = ToolTip::new(
            half_space,
            d_tip,
            p.tip_radius,
            m,
            p.dedendum,
            alpha_n,
            beta,
        )?;
        let d_j = tip.flank_end_depth();
        let (sin_t, cos_t) = alpha_t.sin_cos();
        let s_form = r * sin_t - d_j / sin_t;
        if s_form < -1e-12 * r {
            return Err(undercut(p, d_j, r, sin_t));
        }
        let s_form = s_form.max(0.0);
        let r_form = (r - d_j).hypot(d_j * cos_t / sin_t).max(r_base);
        if r_form >= r_tip {
            return Err(GeometryError::NoInvolute { r_form, r_tip });
        }
        let fillet = Fillet::new(tip, r)?;

        params
            .modifications
            .check([r_form, r_tip], params.face_width)?;
        let roll_of = |radius: f64| (radius * radius - r_base * r_base).max(0.0).sqrt();
        let s_tip = roll_of(r_tip);
        let s_relief = params
            .modifications
            .tip_relief
            .map_or(s_tip, |relief| roll_of(relief.start_radius));
        let toothing = Toothing {
            teeth: params.teeth,
            module: params.module,
            r,
            r_base,
            chi,
            roll: [s_form, roll_of(r), s_tip],
        };
        let deviations = ToothDeviations::new(&params.deviations, toothing)?.map(Arc::new);
        let gear = Self {
            params: Box::new(params),
            alpha_t,
            beta_b,
            r,
            r_base,
            r_tip,
            r_root,
            r_form,
            psi,
            chi,
            roll: [s_form, s_tip, s_relief],
            fillet,
            deviations,
            flanks: Box::new(Side::BOTH.map(|side| InvoluteHelicoid {
                side,
                base_radius: r_base,
                tan_helix: beta_b.tan(),
                cos_helix: beta_b.cos(),
                half_angle: chi,
            })),
        };
        let gear = if gear.is_conical() {
            gear.conical()?
        } else {
            gear
        };
        gear.check_depth_of_modifications()?;
        Ok(gear)
    }

    /// The modifications must leave some tooth at the tip.
    fn check_depth_of_modifications(&self) -> Result<(), GeometryError> {
        let each = self.deviations.as_ref().map_or(0.0, |d| d.greatest());
        let of_all = [Side::Left, Side::Right].map(|side| {
            let ends = [-1.0, 1.0].map(|zeta| self.flank_deviation(side, self.r_tip, zeta));
            ends[0].max(ends[1])
        });
        let measured = self.params.modifications.topography.iter().flatten();
        let measured = measured.map(|t| 2.0 * t.greatest()).fold(0.0, f64::max);
        let removed = of_all[0].max(of_all[1]) + measured + each * self.beta_b.cos();
        // The tooth centreline is r_b times the half angle away, measured along the line of action.
        let available = self.r_base * self.half_angle_at(self.r_tip) * self.beta_b.cos();
        if removed < available {
            Ok(())
        } else {
            Err(GeometryError::ModificationTooDeep { removed, available })
        }
    }

    /// What the user gave.
    pub fn params(&self) -> &GearParams {
        &self.params
    }

    /// Number of teeth.
    pub fn teeth(&self) -> u32 {
        self.params.teeth
    }

    /// Face width (m).
    pub fn face_width(&self) -> f64 {
        self.params.face_width
    }

    /// Transverse pressure angle at the reference circle (rad).
    pub fn transverse_pressure_angle(&self) -> f64 {
        self.alpha_t
    }

    /// Helix angle on the base cylinder (rad), signed as the helix angle.
    pub fn base_helix_angle(&self) -> f64 {
        self.beta_b
    }

    /// Transverse module (m).
    pub fn transverse_module(&self) -> f64 {
        self.params.module / self.params.helix_angle.cos()
    }

    /// Reference radius (m).
    pub fn r_reference(&self) -> f64 {
        self.r
    }

    /// Base radius (m).
    pub fn r_base(&self) -> f64 {
        self.r_base
    }

    /// Tip radius (m).
    pub fn r_tip(&self) -> f64 {
        self.r_tip
    }

    /// Root radius (m).
    pub fn r_root(&self) -> f64 {
        self.r_root
    }

    /// Radius at which the body is held (m): the bore, or for a solid gear the seat that stands for
    /// its shaft, half the root radius.
    pub fn seat_radius(&self) -> f64 {
        let bore = self.params.bore_radius;
        if bore > 0.0 { bore } else { SEAT * self.r_root }
    }

    /// Form radius (m): where the fillet ends and the involute begins.
    pub fn r_form(&self) -> f64 {
        self.r_form
    }

    /// Transverse base pitch (m).
    pub fn base_pitch(&self) -> f64 {
        self.r_base * self.pitch_angle()
    }

    /// Angular pitch 2 pi / z (rad).
    pub fn pitch_angle(&self) -> f64 {
        2.0 * PI / f64::from(self.params.teeth)
    }

    /// Half tooth thickness angle at the reference circle (rad), thinning included.
    pub fn half_angle_reference(&self) -> f64 {
        self.psi
    }

    /// Angle between the tooth centreline and the origin of the flank on the base circle (rad).
    pub fn half_angle_base(&self) -> f64 {
        self.chi
    }

    /// Length of roll (path coordinate) (m) of the involute at radius `r` (m); 0 below the base.
    pub fn roll_length(&self, r: f64) -> f64 {
        ((r - self.r_base) * (r + self.r_base)).max(0.0).sqrt()
    }

    /// Length of roll at the form circle (m).
    pub fn roll_length_form(&self) -> f64 {
        self.roll[0]
    }

    /// Length of roll at the tip circle (m).
    pub fn roll_length_tip(&self) -> f64 {
        self.roll[1]
    }

    /// Half tooth thickness angle (rad) on the involute at length of roll `s` (m); the point has radius
    /// `sqrt(r_b^2 + s^2)`. Unlike [`Gear::half_angle_at`] it is smooth where the involute meets the base circle.
    pub fn half_angle_at_roll(&self, s: f64) -> f64 {
        self.chi - inv_of_tangent(s / self.r_base)
    }

    /// Half tooth thickness angle (rad) at radius `r` (m): involute above the form radius,
    /// trochoidal fillet below. `r` is held within root and tip radius.
    pub fn half_angle_at(&self, r: f64) -> f64 {
        if r >= self.r_form {
            return self.half_angle_at_roll(self.roll_length(r.min(self.r_tip)));
        }
        let r = r.max(self.r_root);
        0.5 * self.pitch_angle() - self.fillet.delta_at((r - self.r_root) * (r + self.r_root))
    }

    /// Point of the left fillet in its own parameter, from 0 at the root circle to 1 at the form circle:
    /// radius (m) and half tooth thickness angle (rad).
    pub fn fillet_at(&self, t: f64) -> (f64, f64) {
        let p = self.fillet.at(self.fillet.q_max() * t.clamp(0.0, 1.0));
        (p.r2.sqrt(), 0.5 * self.pitch_angle() - p.delta)
    }

    /// Material removed normal to the flanks of a side (m) by its modifications at radius `r` (m) and at `zeta` in [-1, 1]
    /// over the face width; below 0 only where a measured topography says so. Below the form radius the value there.
    pub fn flank_deviation(&self, side: Side, r: f64, zeta: f64) -> f64 {
        let modifications = &self.params.modifications;
        if modifications.is_none() {
            return 0.0;
        }
        let range = FlankRange {
            roll: self.roll,
            r_base: self.r_base,
            half_width: 0.5 * self.params.face_width,
        };
        modifications.removed(side, self.roll_length(r), &range, zeta)
    }

    /// The part of it that varies over the width alone (m).
    pub fn lead_deviation(&self, side: Side, zeta: f64) -> f64 {
        let half_width = 0.5 * self.params.face_width;
        self.params.modifications.over_width(side, zeta, half_width)
    }

    /// Whether flanks are not the same in all transverse sections, turned by the helix or not.
    pub fn varies_over_width(&self) -> bool {
        self.params.helix_angle != 0.0
            || self.is_conical()
            || self.params.modifications.vary_over_width()
    }

    #[cfg(test)]
    pub(super) fn deviations(&self) -> Option<&Arc<ToothDeviations>> {
        self.deviations.as_ref()
    }

    /// Whether teeth deviate from each other.
    pub fn deviates(&self) -> bool {
        self.deviations.is_some()
    }

    /// Material removed normal to the flank of one tooth (m) at radius `radius` (m), beside what all
    /// teeth have removed ([`Gear::flank_deviation`]); negative where there is more than the involute.
    /// Teeth count counter-clockwise, unwrapped. Below the form radius the value there.
    pub fn tooth_deviation(&self, tooth: i64, side: Side, radius: f64) -> f64 {
        let s = self.roll_length(radius).clamp(self.roll[0], self.roll[1]);
        self.tooth_deviation_at_roll(tooth, side, s)[0]
    }

    /// The same over the length of roll `s` (m), and its first two derivatives (-, 1/m): smooth, and
    /// continued beyond form circle and tip. Constant time, no allocation.
    #[inline]
    pub fn tooth_deviation_at_roll(&self, tooth: i64, side: Side, s: f64) -> [f64; 3] {
        match &self.deviations {
            None => [0.0; 3],
            Some(d) => d.at(tooth, side, s).map(|x| x * self.beta_b.cos()),
        }
    }

    /// Greatest amount by which the flank of any tooth stands off the place of all (m).
    pub fn greatest_tooth_deviation(&self) -> f64 {
        let greatest = self.deviations.as_ref().map_or(0.0, |d| d.greatest());
        greatest * self.beta_b.cos()
    }
}

/// The refusal of undercut, with the limits of profile shift and tooth number.
fn undercut(p: &GearParams, d_j: f64, r: f64, sin_t: f64) -> GeometryError {
    // Free of undercut when d_j <= r sin^2(alpha_t); d_j falls by m for each unit of x.
    let short = (d_j - r * sin_t * sin_t) / p.module;
    let teeth = f64::from(p.teeth) * d_j / (r * sin_t * sin_t);
    GeometryError::Undercut {
        teeth: p.teeth,
        profile_shift: p.profile_shift,
        min_profile_shift: p.profile_shift + short,
        min_teeth: teeth.ceil() as u64,
    }
}
