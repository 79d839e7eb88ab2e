//! Trochoidal root fillets, and the tip of the rack tool that generates those of external gears (`cutter` has the other).
//!
//! The tool tip, in the tool's normal section, is a circular arc of radius `rho` that joins the
//! straight flank to the tip line. Depth `d` counts from the rolling (pitch) line towards the gear
//! centre, `u` from the centreline of the tool tooth. With `phi` the angle of the outward normal
//! (`alpha_n` at the flank, `pi/2` at the tip line):
//!
//! ```text
//! u_n = w_c + rho cos(phi)      d = d_c + rho sin(phi)      u = u_n / cos(beta)
//! ```
//!
//! The transverse section stretches `u` by `1/cos(beta)`, so the transverse arc is elliptic and its
//! normal is parallel to `(cos(phi) cos(beta), sin(phi))`. The law of gearing (the common normal
//! passes through the pitch point) gives the point of the fillet directly, no iteration needed:
//!
//! ```text
//! X = d cos(beta) cot(phi)      R^2 = X^2 + (r - d)^2
//! delta = atan(X / (r - d)) - (X - u) / r
//! ```
//!
//! with `R` the radius on the gear and `delta` the angle from the centreline of the tooth space.
//! Litvin and Fuentes (2004), sections 6.3 to 6.8 (envelope of a rack cutter). The parameter used
//! below is `q = cos(phi)`, in which both ends are regular.

use super::cutter::Cutter;
use super::error::GeometryError;

/// Number of intervals in which a fillet is checked to be monotonic.
const CHECKED: usize = 64;

/// Rounded tip of a rack tool, in coordinates of its rolling line. Lengths are in metre, in the normal section.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ToolTip {
    /// Half length of the flat tip; 0 for the full-radius tool.
    w_c: f64,
    /// Depth of the centre of the rounding below the rolling line.
    d_c: f64,
    /// Radius of the rounding.
    rho: f64,
    /// Depth of the tip line below the rolling line.
    d_tip: f64,
    sin_alpha: f64,
    cos_alpha: f64,
    cos_beta: f64,
}

impl ToolTip {
    /// Builds the tip from `half_width`, half the thickness of the tool tooth at its rolling line, and `d_tip`, the
    /// depth of the tip below it; `module`, `dedendum` and `factor` scale the messages only.
    pub(super) fn new(
        half_width: f64,
        d_tip: f64,
        factor: f64,
        module: f64,
        dedendum: f64,
        alpha: f64,
        beta: f64,
    ) -> Result<Self, GeometryError> {
        let (sin_alpha, cos_alpha) = alpha.sin_cos();
        let tan_alpha = sin_alpha / cos_alpha;
        let half_tip = half_width - d_tip * tan_alpha;
        let slack = 1e-12 * module;
        if half_tip < -slack {
            return Err(GeometryError::PointedTool {
                dedendum,
                max_dedendum: dedendum + half_tip / (tan_alpha * module),
            });
        }
        let rho = factor * module;
        let d_c = d_tip - rho;
        let w_c = half_tip - rho * (1.0 - sin_alpha) / cos_alpha;
        if w_c < -slack {
            return Err(GeometryError::TipRadius {
                factor,
                max_factor: half_tip.max(0.0) * cos_alpha / ((1.0 - sin_alpha) * module),
            });
        }
        Ok(Self {
            w_c: w_c.max(0.0),
            d_c,
            rho,
            d_tip,
            sin_alpha,
            cos_alpha,
            cos_beta: beta.cos(),
        })
    }

    /// Returns the depth below the rolling line at which the straight flank ends.
    pub(super) fn flank_end_depth(&self) -> f64 {
        self.d_c + self.rho * self.sin_alpha
    }

    /// Returns the half width of the tool tooth (transverse) at depth `d` between the flank end and the tip.
    pub(super) fn half_width_at(&self, d: f64) -> f64 {
        let h = d - self.d_c;
        (self.w_c + (self.rho * self.rho - h * h).max(0.0).sqrt()) / self.cos_beta
    }

    /// Returns the half length of the flat tip in the transverse section.
    pub(super) fn flat(&self) -> f64 {
        self.w_c / self.cos_beta
    }

    /// Returns the largest parameter `q = cos(phi)`: the end of the straight flank.
    pub(super) fn q_max(&self) -> f64 {
        self.cos_alpha
    }

    /// Returns the transverse point `(u, d)` of the rounding at parameter `q`.
    pub(super) fn point(&self, q: f64) -> (f64, f64) {
        let d = self.d_c + self.rho * (1.0 - q * q).max(0.0).sqrt();
        ((self.w_c + self.rho * q) / self.cos_beta, d)
    }

    /// Returns the point of the fillet that its point at the parameter `q` generates on a gear of reference radius
    /// `r`.
    fn rolled(&self, q: f64, r: f64) -> FilletPoint {
        let sin_phi = (1.0 - q * q).max(0.0).sqrt();
        let (u, d) = self.point(q);
        let d_q = -self.rho * q / sin_phi;
        let x = d * self.cos_beta * q / sin_phi;
        let x_q = self.cos_beta * (d_q * q / sin_phi + d / (sin_phi * sin_phi * sin_phi));
        let y = r - d;
        // d_tip - d = rho (1 - sin(phi)) = rho q^2 / (1 + sin(phi))
        let from_root2 = x * x + self.rho * q * q / (1.0 + sin_phi) * (2.0 * r - d - self.d_tip);
        FilletPoint {
            r2: x * x + y * y,
            delta: x.atan2(y) - (x - u) / r,
            r_dr: x * x_q - y * d_q,
            from_root2,
        }
    }
}

/// A point of the fillet with the data of the area integrals.
#[derive(Clone, Copy, Debug)]
pub(super) struct FilletPoint {
    /// Squared radius (m^2).
    pub r2: f64,
    /// Angle from the centreline of the tooth space (rad).
    pub delta: f64,
    /// Half the derivative of the squared radius, `d(R^2)/dq / 2 = R dR/dq` (m^2).
    pub r_dr: f64,
    /// Distance of `R^2` from `r_root^2` without cancellation (m^2).
    pub from_root2: f64,
}

/// Tool that generates a fillet.
#[derive(Clone, Debug, PartialEq)]
enum Tool {
    /// The tip of a rack tool that rolls on the reference radius (m).
    Rack(ToolTip, f64),
    /// The tip of a pinion-type cutter, in an internal gear.
    Cutter(Cutter),
}

/// Trochoidal fillet of a gear: the envelope of the tip of its tool.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fillet {
    tool: Tool,
}

impl Fillet {
    /// Generates the fillet on a gear of reference radius `r`; the caller has excluded undercut.
    pub(super) fn new(tip: ToolTip, r: f64) -> Result<Self, GeometryError> {
        Self::that_rises(Tool::Rack(tip, r))
    }

    /// Generates the fillet of an internal gear.
    pub(super) fn cut(cutter: Cutter) -> Result<Self, GeometryError> {
        Self::that_rises(Tool::Cutter(cutter))
    }

    fn that_rises(tool: Tool) -> Result<Self, GeometryError> {
        let fillet = Self { tool };
        let mut last = fillet.at(0.0);
        for k in 1..=CHECKED {
            let p = fillet.at(fillet.q_max() * k as f64 / CHECKED as f64);
            let rises = p.from_root2 > last.from_root2 && p.delta >= last.delta - 1e-12;
            if !rises {
                return Err(GeometryError::FilletFolds);
            }
            last = p;
        }
        Ok(fillet)
    }

    /// Returns the parameter at the junction with the involute; 0 is the junction with the root circle.
    pub(super) fn q_max(&self) -> f64 {
        match &self.tool {
            Tool::Rack(tip, _) => tip.q_max(),
            Tool::Cutter(cutter) => cutter.q_max(),
        }
    }

    /// Returns the half angle of the root-circle arc around the centreline of the tooth space (rad).
    pub(super) fn root_arc(&self) -> f64 {
        match &self.tool {
            Tool::Rack(tip, r) => tip.flat() / r,
            Tool::Cutter(cutter) => cutter.root_arc(),
        }
    }

    /// Returns the point at parameter `q` in `[0, q_max]`.
    pub(super) fn at(&self, q: f64) -> FilletPoint {
        match &self.tool {
            Tool::Rack(tip, r) => tip.rolled(q, *r),
            Tool::Cutter(cutter) => cutter.at(q),
        }
    }

    /// Returns the angle from the centreline of the tooth space at a given difference of the squared radius from that
    /// of the root (m^2).
    ///
    /// Newton's method, kept in a bracket, on `sqrt(|R^2 - r_root^2|)`: nearly linear in `q`.
    pub(super) fn delta_at(&self, from_root2: f64) -> f64 {
        let target = from_root2.max(0.0).sqrt();
        let (mut lo, mut hi) = (0.0, self.q_max());
        let top = self.at(hi).from_root2.sqrt();
        if target >= top {
            return self.at(hi).delta;
        }
        let mut q = hi * target / top;
        for _ in 0..80 {
            let p = self.at(q);
            let f = p.from_root2.sqrt();
            let error = f - target;
            if error.abs() <= 4.0 * f64::EPSILON * top {
                break;
            }
            if error > 0.0 {
                hi = q;
            } else {
                lo = q;
            }
            let newton = q - error * f / p.r_dr.abs();
            q = if newton > lo && newton < hi {
                newton
            } else {
                0.5 * (lo + hi)
            };
        }
        self.at(q).delta
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::{Gear, GearParams};

    fn gears() -> Vec<Gear> {
        let base = GearParams {
            teeth: 20,
            module: 4e-3,
            tip_radius: 0.3,
            ..GearParams::default()
        };
        // The full-radius factor of a spur tool of 20 degrees without thinning.
        let t = 20f64.to_radians();
        let full = (std::f64::consts::FRAC_PI_4 - 1.25 * t.tan()) * t.cos() / (1.0 - t.sin());
        let shifted = GearParams {
            teeth: 11,
            profile_shift: 0.45,
            ..base.clone()
        };
        let helical = GearParams {
            teeth: 15,
            helix_angle: 0.5,
            thinning: 2e-4,
            profile_shift: 0.2,
            ..base.clone()
        };
        let full_radius = GearParams {
            teeth: 40,
            tip_radius: full,
            ..base.clone()
        };
        let sharp = GearParams {
            teeth: 33,
            tip_radius: 0.0,
            ..base.clone()
        };
        [base, shifted, helical, full_radius, sharp]
            .into_iter()
            .map(|p| Gear::new(p).unwrap())
            .collect()
    }

    /// The tooth is the envelope of the rolling tool: no point of the tool enters the tooth, and at every radius some
    /// point touches the flank. The test does not use the law of gearing.
    #[test]
    fn tooth_is_the_envelope_of_the_rolling_tool() {
        for gear in gears() {
            let p = gear.params();
            let (m, r, cos_beta) = (p.module, gear.r_reference(), p.helix_angle.cos());
            let (sin_a, cos_a) = p.pressure_angle.sin_cos();
            let half_space = r * (0.5 * gear.pitch_angle() - gear.half_angle_reference());
            let rho = p.tip_radius * m;
            let d_c = m * (p.dedendum - p.profile_shift) - rho;
            let w_c = half_space * cos_beta - d_c * sin_a / cos_a - rho / cos_a;
            let mut profile = Vec::new();
            for k in 0..=400 {
                let phi = p.pressure_angle
                    + (std::f64::consts::FRAC_PI_2 - p.pressure_angle) * f64::from(k) / 400.0;
                profile.push(((w_c + rho * phi.cos()) / cos_beta, d_c + rho * phi.sin()));
            }
            let d_j = d_c + rho * sin_a;
            for k in 1..=800 {
                let d = d_j - 2.5 * m * f64::from(k) / 800.0;
                profile.push((half_space - d * sin_a / cos_a / cos_beta, d));
            }
            let (root, tip) = (gear.r_root(), gear.r_tip());
            const BINS: usize = 40;
            let mut closest = [f64::INFINITY; BINS];
            for step in -1500..=1500 {
                let t = 4.0 * m * f64::from(step) / 1500.0;
                for &(u, d) in &profile {
                    let (x, y) = (u + t, r - d);
                    let radius = x.hypot(y);
                    if radius <= root * (1.0 + 1e-9) || radius >= tip {
                        continue;
                    }
                    let from_tooth = 0.5 * gear.pitch_angle() - (x.atan2(y) - t / r);
                    let open = (from_tooth - gear.half_angle_at(radius)) * radius;
                    assert!(open > -1e-12, "tool inside the tooth by {open} at {radius}");
                    let bin = ((radius - root) / (tip - root) * BINS as f64) as usize;
                    closest[bin] = closest[bin].min(open);
                }
            }
            let worst = closest.iter().copied().fold(0.0, f64::max);
            assert!(worst < 2e-5 * m, "the tool leaves {worst} m standing");
        }
    }

    /// Returns the angle of the flank tangent to the radial direction, by finite differences.
    fn tangent(gear: &Gear, r: f64, h: f64) -> f64 {
        (r * (gear.half_angle_at(r + h) - gear.half_angle_at(r)) / h).atan()
    }

    #[test]
    fn fillet_joins_involute_and_root_circle_with_a_common_tangent() {
        for gear in gears() {
            let (r, h) = (gear.r_form(), 1e-8);
            let jump = gear.half_angle_at(r * (1.0 - 1e-15)) - gear.half_angle_at(r);
            assert!(jump.abs() < 1e-13, "gap of {jump} rad at the form circle");
            let kink = tangent(&gear, r + 1e-12, h) - tangent(&gear, r - 1e-12, -h);
            assert!(kink.abs() < 1e-4, "kink of {kink} rad at the form circle");
            if gear.params().tip_radius > 0.0 {
                // At the root circle the flank turns into the circle: -90 degrees.
                let near = tangent(&gear, gear.r_root(), 1e-12);
                assert!(near < -1.57, "{near} rad at the root circle");
            }
            let arc = 0.5 * gear.pitch_angle() - gear.half_angle_at(gear.r_root());
            assert!((arc - gear.profile.fillet.root_arc()).abs() < 1e-12);
        }
    }

    #[test]
    fn full_radius_tool_leaves_no_root_arc() {
        let gear = &gears()[3];
        assert!(gear.profile.fillet.root_arc() < 1e-12);
    }
}
