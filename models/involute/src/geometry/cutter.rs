//! The pinion-type cutter of an internal gear and the trochoidal root fillet that its tip generates.
//!
//! Cutter and gear roll without backlash at the centre distance `a_0`, as an external gear of `z_0` teeth in an internal one:
//!
//! ```text
//! inv(alpha_w0) = inv(alpha_t) + 2 tan(alpha_n) (x + x_0)/(z_0 - z)      a_0 = (r_b - r_b0)/cos(alpha_w0)
//! r_f = a_0 + r_a0      r_w0 = r_b0/cos(alpha_w0)      r_w = r_b/cos(alpha_w0)
//! ```
//!
//! Thinning is made by thicker teeth of the cutter. Its tip is rounded in the transverse section by an arc of radius `rho` that
//! joins the tip circle to the involute: its centre stands at the radius `r_c = r_a0 - rho` on the involute parallel to the
//! flank, at the angle `theta_c` from the middle of the cutter's tooth, and the arc meets the flank at the length of roll
//! `s_J`:
//!
//! ```text
//! s_c = sqrt(r_c^2 - r_b0^2)      theta_c = chi_0 - rho/r_b0 - inv(atan(s_c/r_b0))      s_J = s_c + rho
//! ```
//!
//! A normal of the arc passes the cutter's axis at the distance `q`, from 0 (tip) to `r_b0` (flank). The law of gearing (the
//! normal passes through the pitch point) gives the point of the fillet directly, `l` being its distance from the pitch point
//! and `epsilon` the angle of the normal against the line of centres:
//!
//! ```text
//! sin(epsilon) = q/r_w0      l = sqrt(r_c^2 - q^2) + rho - sqrt(r_w0^2 - q^2)
//! R^2 = r_w^2 + 2 r_w l cos(epsilon) + l^2
//! delta = atan(l sin(epsilon)/(r_w + l cos(epsilon))) + z_0/z (theta_c + asin(q/r_c) - epsilon)
//! ```
//!
//! with `delta` the angle from the middle of the tooth space. Litvin and Fuentes (2004), sections 6.3 and 10.11 (envelope of a
//! shaper); ISO 21771-1, tool data of shaper cutters.

use super::error::GeometryError;
use super::fillet::FilletPoint;
use super::internal::{Internal, Meshing};
use super::internal_error::InternalError;
use super::involute::{inv, inv_inverse, inv_of_tangent};
use super::parameters::GearParams;

/// A cutter at its distance from the gear. Lengths are in metre.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cutter {
    /// Ratio of the number of teeth of the cutter to that of the gear.
    ratio: f64,
    r_base: f64,
    r_tip: f64,
    /// Half angle of its teeth on the base circle (rad).
    chi: f64,
    alpha_w: f64,
    distance: f64,
    pitch_radii: [f64; 2],
    rho: f64,
    r_c: f64,
    theta_c: f64,
    s_c: f64,
}

impl Cutter {
    /// Builds the cutter of an internal gear with the reference radius `r`.
    pub(super) fn new(p: &GearParams, of: &Internal, r: f64) -> Result<Self, GeometryError> {
        let refuse = |why| Err(GeometryError::Internal(why));
        let teeth = of.cutter_teeth_of(p.teeth);
        if teeth >= p.teeth {
            return refuse(InternalError::CutterTeeth {
                cutter: teeth,
                ring: p.teeth,
            });
        }
        let ratio = f64::from(teeth) / f64::from(p.teeth);
        let tan_n = p.pressure_angle.tan();
        let alpha_t = (tan_n / p.helix_angle.cos()).atan();
        let x0 = of.cutter_shift;
        let difference = f64::from(p.teeth - teeth);
        let inv_w = inv(alpha_t) - 2.0 * tan_n * (p.profile_shift + x0) / difference;
        // Flanks have to be cut on a common tangent of both base circles.
        if inv_w <= 0.0 {
            return refuse(InternalError::CutterShift {
                shift: x0,
                greatest: inv(alpha_t) * difference / (2.0 * tan_n) - p.profile_shift,
            });
        }
        let alpha_w = inv_inverse(inv_w);
        let cos_t = alpha_t.cos();
        let (r_0, r_base) = (ratio * r, ratio * r * cos_t);
        let pitch_radii = [r_base / alpha_w.cos(), r * cos_t / alpha_w.cos()];
        let distance = pitch_radii[1] - pitch_radii[0];
        let r_tip = match of.root_circle {
            None => r_0 + p.module * (p.dedendum + x0),
            Some(root) => root - distance,
        };
        let half = (std::f64::consts::FRAC_PI_2 + 2.0 * x0 * tan_n) / f64::from(teeth);
        let chi = half + p.thinning / (2.0 * r_0) + inv(alpha_t);
        let mut cutter = Cutter {
            ratio,
            r_base,
            r_tip,
            chi,
            alpha_w,
            distance,
            pitch_radii,
            rho: 0.0,
            r_c: r_tip,
            theta_c: 0.0,
            s_c: 0.0,
        };
        if r_tip <= r_base || !cutter.round(0.0) {
            return refuse(InternalError::CutterTip {
                r_tip,
                r_base,
                r_pointed: r_base / inv_inverse(chi).cos(),
            });
        }
        if !cutter.round(p.tip_radius * p.module) {
            let (mut fits, mut fails) = (0.0, p.tip_radius * p.module);
            for _ in 0..60 {
                let middle = 0.5 * (fits + fails);
                if cutter.round(middle) {
                    fits = middle;
                } else {
                    fails = middle;
                }
            }
            return Err(GeometryError::TipRadius {
                factor: p.tip_radius,
                max_factor: fits / p.module,
            });
        }
        Ok(cutter)
    }

    /// Rounds the tip with a radius (m); returns false where it does not fit.
    fn round(&mut self, rho: f64) -> bool {
        let r_c = self.r_tip - rho;
        if r_c <= self.r_base {
            return false;
        }
        let s_c = ((r_c - self.r_base) * (r_c + self.r_base)).sqrt();
        let theta_c = self.chi - rho / self.r_base - inv_of_tangent(s_c / self.r_base);
        if theta_c < -1e-12 {
            return false;
        }
        (self.rho, self.r_c, self.s_c) = (rho, r_c, s_c);
        self.theta_c = theta_c.max(0.0);
        true
    }

    /// Returns the root radius of the gear.
    pub(super) fn r_root(&self) -> f64 {
        self.distance + self.r_tip
    }

    /// Returns the distance between the tangent points of both base circles on the line of action.
    fn between_tangents(&self) -> f64 {
        self.distance * self.alpha_w.sin()
    }

    /// Returns the length of roll, a positive number, at which the involute of the gear ends at its root.
    pub(super) fn form_roll(&self) -> f64 {
        self.between_tangents() + self.s_c + self.rho
    }

    /// Returns the length of roll at which the involute of the cutter begins at its base circle.
    pub(super) fn base_roll(&self) -> f64 {
        self.between_tangents()
    }

    /// Returns the meshing of the cutter with its gear, and the corners of its tip: radius and half angle.
    pub(super) fn meshing(&self) -> (Meshing, Vec<[f64; 2]>) {
        const CORNERS: usize = 16;
        let last = self.chi - (self.s_c + self.rho) / self.r_base + std::f64::consts::FRAC_PI_2;
        let corner = |k: usize| {
            let phi = self.theta_c + (last - self.theta_c) * k as f64 / CORNERS as f64;
            let x = self.r_c * self.theta_c.cos() + self.rho * phi.cos();
            let y = self.r_c * self.theta_c.sin() + self.rho * phi.sin();
            [x.hypot(y), y.atan2(x)]
        };
        let meshing = Meshing {
            distance: self.distance,
            alpha_w: self.alpha_w,
            r_base: self.r_base,
            chi: self.chi,
        };
        (meshing, (0..=CORNERS).map(corner).collect())
    }

    /// Returns the largest parameter: the normal of the flank.
    pub(super) fn q_max(&self) -> f64 {
        self.r_base
    }

    /// Returns the half angle of the root-circle arc around the centreline of the tooth space (rad).
    pub(super) fn root_arc(&self) -> f64 {
        self.ratio * self.theta_c
    }

    /// Returns the point of the fillet at the parameter `q` in `[0, q_max]`.
    pub(super) fn at(&self, q: f64) -> FilletPoint {
        let [r_w0, r_w] = self.pitch_radii;
        let (to_c, to_pitch) = (
            ((self.r_c - q) * (self.r_c + q)).sqrt(),
            ((r_w0 - q) * (r_w0 + q)).sqrt(),
        );
        let (sin, cos) = (q / r_w0, to_pitch / r_w0);
        let l_tip = self.r_tip - r_w0;
        // l(0) - l, without cancellation.
        let fallen = q * q * ((self.r_c + to_c).recip() - (r_w0 + to_pitch).recip());
        let l = l_tip - fallen;
        let l_q = q * (to_pitch.recip() - to_c.recip());
        let (x, y) = (r_w + l * cos, l * sin);
        let below_root2 = 2.0 * r_w * (fallen + l * sin * sin / (1.0 + cos)) + fallen * (l_tip + l);
        FilletPoint {
            r2: x * x + y * y,
            delta: y.atan2(x)
                + self.ratio * (self.theta_c + (q / self.r_c).asin() - (q / r_w0).asin()),
            r_dr: r_w * (l_q * cos - l * sin / (r_w0 * cos)) + l * l_q,
            from_root2: below_root2,
        }
    }
}
