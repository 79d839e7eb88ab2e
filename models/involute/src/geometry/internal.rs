//! Internal gears (ring gears): an involute toothing that points to the axis, cut by a pinion-type cutter.
//!
//! With the number of teeth `-z` the equations of an external gear hold (ISO 21771-1, DIN 3960). Written with positive radii:
//!
//! ```text
//! r_a = r - m_n (h_a* + x)     r_f = a_0 + r_a0 (module cutter)      psi = (pi/2 + 2 x tan(alpha_n))/z - thinning/(2 r)
//! half angle of a tooth at the radius R: psi - inv(alpha_t) + inv(acos(r_b/R))
//! ```
//!
//! Teeth are thinnest at their tips, on the smaller radius. Lengths of roll are negative, so that they grow from root to tip
//! as on an external gear and `psi - inv(alpha_t) - inv(atan(s/r_b))` is the half angle of both.
//!
//! Tips foul (trochoidal interference) where the tip corner of the mate has not left the tooth space when it passes the tip
//! circle. It does so at the angles `delta_1`, `delta_2` from the line of centres about the axes of mate and gear,
//!
//! ```text
//! cos(delta_1) = (r_a2^2 - a^2 - r_a1^2)/(2 a r_a1)      cos(delta_2) = (r_a2^2 + a^2 - r_a1^2)/(2 a r_a2)
//! ```
//!
//! where flanks that touch set the tooth of the gear at the angle `theta_2`: free by `r_a2 (theta_2 - psi_a2 - delta_2)`.
//! J. R. Colbourne, *The Geometry of Involute Gears* (1987), chapter 8.

use super::cutter::Cutter;
use super::error::{GeometryError, check, finite};
use super::fillet::Fillet;
use super::gear::Gear;
use super::internal_error::InternalError;
use super::involute::{inv, inv_of_tangent};
use super::parameters::GearParams;
use super::profile::Profile;
use super::quantity::Quantity;

/// Thickness of the rim in modules by default: from this value on ISO 6336-1 neglects the compliance of the rim.
const RIM: f64 = 3.5;

/// Additional parameters of an internal gear. Lengths are in metre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Internal {
    /// Number of teeth of the cutter; by default two fifths of those of the gear.
    pub cutter_teeth: Option<u32>,
    /// Profile shift coefficient of the cutter, which decreases as it is sharpened.
    pub cutter_shift: f64,
    /// Tip radius in place of the addendum factor.
    pub tip_circle: Option<f64>,
    /// Root radius in place of the dedendum factor: the cutter's addendum follows from it.
    pub root_circle: Option<f64>,
    /// Outer radius of the rim, where the body is supported; by default three and a half modules over the root.
    pub rim_radius: Option<f64>,
}

impl Internal {
    pub(super) fn check(&self) -> Result<(), GeometryError> {
        if let Some(teeth) = self.cutter_teeth {
            let expected = "a whole number from 3 to 10000";
            let fits = (3..=10_000).contains(&teeth);
            check(Quantity::CutterTeeth, f64::from(teeth), fits, expected)?;
        }
        finite(Quantity::CutterShift, self.cutter_shift)?;
        for (what, radius) in [
            (Quantity::TipCircle, self.tip_circle),
            (Quantity::RootCircle, self.root_circle),
            (Quantity::RimRadius, self.rim_radius),
        ] {
            let radius = radius.unwrap_or(1.0);
            check(what, radius, radius > 0.0, "a finite number above 0")?;
        }
        Ok(())
    }

    /// Returns the number of teeth of the cutter for a gear with `teeth`.
    pub fn cutter_teeth_of(&self, teeth: u32) -> u32 {
        self.cutter_teeth.unwrap_or((2 * teeth).div_ceil(5).max(3))
    }
}

/// An external toothing inside an internal gear, with flanks in contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meshing {
    pub distance: f64,
    pub alpha_w: f64,
    /// Base radius of the external toothing.
    pub r_base: f64,
    pub chi: f64,
}

impl Meshing {
    /// Returns the smallest clearance (m) along the tip circle between a tip of the internal gear (base radius, half
    /// angle on the base circle, tip radius, half angle there) and corners of the external toothing, each a radius and
    /// a half angle, that leave its tooth space; infinite where none reaches that circle.
    pub(super) fn room_at_tips(
        &self,
        [rb_2, chi_2, ra_2, half_2]: [f64; 4],
        corners: impl IntoIterator<Item = [f64; 2]>,
    ) -> f64 {
        let a = self.distance;
        let rooms = corners.into_iter().filter_map(|[r, half]| {
            let cos_1 = (ra_2 * ra_2 - a * a - r * r) / (2.0 * a * r);
            let cos_2 = (ra_2 * ra_2 + a * a - r * r) / (2.0 * a * ra_2);
            if cos_1 >= 1.0 {
                return None;
            }
            // A circle that is nowhere within the other: its corners never leave.
            let theta_1 = cos_1.max(-1.0).acos() - half;
            let s_1 = self.r_base * (theta_1 + self.alpha_w + self.chi);
            let rho_2 = s_1 + a * self.alpha_w.sin();
            let theta_2 = rho_2 / rb_2 - self.alpha_w + chi_2;
            Some(ra_2 * (theta_2 - half_2 - cos_2.clamp(-1.0, 1.0).acos()))
        });
        rooms.fold(f64::INFINITY, f64::min)
    }
}

/// Computes the profile of an internal gear with the reference and base radius.
pub(super) fn profile(
    p: &GearParams,
    of: &Internal,
    [r, r_base]: [f64; 2],
    alpha_t: f64,
) -> Result<Profile, GeometryError> {
    if p.bore_radius > 0.0 {
        return Err(InternalError::Bore.into());
    }
    if p.profile_shift_angle != 0.0 || p.tip_cone_angle != 0.0 {
        let what = "profile-shift angle or tip cone";
        return Err(InternalError::Not { what }.into());
    }
    if p.modifications.topography.iter().any(Option::is_some) {
        let what = "measured topography";
        return Err(InternalError::Not { what }.into());
    }
    let z = f64::from(p.teeth);
    let r_tip = of
        .tip_circle
        .unwrap_or(r - p.module * (p.addendum + p.profile_shift));
    if r_tip <= r_base {
        return Err(InternalError::TipWithinBase { r_tip, r_base }.into());
    }
    let full = (std::f64::consts::FRAC_PI_2 + 2.0 * p.profile_shift * p.pressure_angle.tan()) / z;
    let psi = full - p.thinning / (2.0 * r);
    if psi <= 0.0 && full > 0.0 && p.thinning > 0.0 {
        return Err(GeometryError::NoToothLeft {
            thinning: p.thinning,
            thickness: 2.0 * r * full,
        });
    }
    let chi = psi - inv(alpha_t);
    let tip_roll = ((r_tip - r_base) * (r_tip + r_base)).sqrt();
    let half_tip = chi + inv_of_tangent(tip_roll / r_base);
    if half_tip <= 0.0 {
        // Pressure angle at the intersection of the flanks: inv(alpha) = -chi.
        let r_pointed = r_base / super::involute::inv_inverse(-chi).cos();
        return Err(GeometryError::PointedTooth {
            r_tip,
            r_pointed,
            max_addendum: (r - r_pointed) / p.module - p.profile_shift,
        });
    }
    let cutter = Cutter::new(p, of, r)?;
    let r_root = cutter.r_root();
    if r_root <= r_tip {
        return Err(InternalError::RootWithinTip { r_root, r_tip }.into());
    }
    let missing = cutter.base_roll() - tip_roll;
    if missing > 1e-12 * r {
        return Err(InternalError::CutterBase {
            missing,
            tip_radius: r_base.hypot(cutter.base_roll()),
        }
        .into());
    }
    let form_roll = cutter.form_roll();
    let r_form = r_base.hypot(form_roll);
    if r_form <= r_tip {
        return Err(InternalError::NoInvolute { r_form, r_tip }.into());
    }
    let (meshing, corners) = cutter.meshing();
    let room = meshing.room_at_tips([r_base, chi, r_tip, half_tip], corners);
    if room < -super::meshing::SLACK * r {
        return Err(InternalError::CutterFouls { overlap: -room }.into());
    }
    let rim = of.rim_radius.unwrap_or(r_root + RIM * p.module);
    if rim <= r_root {
        return Err(InternalError::Rim { rim, r_root }.into());
    }
    Ok(Profile {
        r_tip,
        r_root,
        r_form,
        psi,
        chi,
        roll: [-form_roll, -tip_roll],
        fillet: Fillet::cut(cutter)?,
    })
}

impl Gear {
    /// Returns true for an internal gear, whose teeth point to the axis.
    pub fn is_internal(&self) -> bool {
        self.params().internal.is_some()
    }

    /// Returns the sign of the number of teeth in the equations of a pair: -1 for an internal gear.
    pub fn sign(&self) -> f64 {
        if self.is_internal() { -1.0 } else { 1.0 }
    }

    /// Returns the outer radius of the rim of an internal gear (m), or the tip radius of an external one.
    pub fn r_outer(&self) -> f64 {
        let Some(of) = &self.params().internal else {
            return self.r_tip();
        };
        of.rim_radius
            .unwrap_or(self.r_root() + RIM * self.params().module)
    }
}
