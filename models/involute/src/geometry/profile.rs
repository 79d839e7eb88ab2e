//! Tip, root and fillet of an external gear, cut by a rack tool.
//!
//! The involute starts where the straight flank of the rack tool ends: at depth `d_j`
//! below the rolling line the length of roll is `s_form = r sin(alpha_t) - d_j / sin(alpha_t)`,
//! and undercut means `s_form < 0`. Below it lies the trochoid of the `fillet` module. Thinning is
//! made by a wider tool tooth at unchanged depth, so the root circle keeps its radius.

use std::f64::consts::{FRAC_PI_2, PI};

use super::error::{GeometryError, finite};
use super::fillet::{Fillet, ToolTip};
use super::involute::{inv, inv_inverse};
use super::parameters::GearParams;
use super::quantity::Quantity;

/// Profile of a tooth. Lengths are in metre, angles in radian.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Profile {
    pub r_tip: f64,
    pub r_root: f64,
    /// Radius at which fillet and involute meet.
    pub r_form: f64,
    /// Half angle of a tooth on the reference circle.
    pub psi: f64,
    /// Half angle of a tooth on the base circle.
    pub chi: f64,
    /// Length of roll at the form circle and at the tip.
    pub roll: [f64; 2],
    pub fillet: Fillet,
}

/// Computes the profile of an external gear with the reference and base radius.
pub(super) fn external(
    p: &GearParams,
    [r, r_base]: [f64; 2],
    alpha_t: f64,
) -> Result<Profile, GeometryError> {
    let z = f64::from(p.teeth);
    let (m, x, beta) = (p.module, p.profile_shift, p.helix_angle);
    let tan_alpha_n = p.pressure_angle.tan();
    let r_tip = r + m * (p.addendum + x);
    let r_root = r + m * (x - p.dedendum);
    finite(Quantity::TipCircle, r_tip)?;
    finite(Quantity::RootCircle, r_root)?;
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
    let s_tip = (r_tip * r_tip - r_base * r_base).max(0.0).sqrt();
    Ok(Profile {
        r_tip,
        r_root,
        r_form,
        psi,
        chi,
        roll: [s_form, s_tip],
        fillet,
    })
}

/// Returns the error of undercut, with the limits of profile shift and tooth number.
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
