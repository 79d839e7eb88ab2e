//! An involute rack: straight flanks, circular root fillets, finite number of teeth.
//!
//! Frame of a rack: its reference line is the y axis, the teeth point to -x and the body lies at
//! +x. Tooth `k` has its centreline at `y = k p_t`, with `k` from `-(n-1)/2` (rounded towards 0)
//! upwards. Height `h` counts from the reference line towards the tooth tips:
//!
//! ```text
//! w(h) = (pi m_t / 2 - thinning) / 2 - h tan(alpha_t)       -h_form <= h <= h_a* m
//! ```
//!
//! and below it the arc of the tool tip that cut it. ISO 53 (basic rack), ISO 21771-1.

use std::f64::consts::FRAC_PI_2;

use super::error::GeometryError;
use super::fillet::ToolTip;
use super::parameters::RackParams;

/// A rack that can be cut: parameters and derived quantities.
#[derive(Clone, Debug, PartialEq)]
pub struct Rack {
    params: RackParams,
    alpha_t: f64,
    beta_b: f64,
    half_thickness: f64,
    tip: ToolTip,
}

impl Rack {
    /// Derives a rack from its parameters.
    ///
    /// # Errors
    /// [`GeometryError`] for values out of range, pointed teeth or a fillet that does not fit.
    pub fn new(params: RackParams) -> Result<Self, GeometryError> {
        params.check()?;
        let p = &params;
        let cos_beta = p.helix_angle.cos();
        let alpha_t = (p.pressure_angle.tan() / cos_beta).atan();
        let beta_b = (p.helix_angle.sin() * p.pressure_angle.cos()).asin();
        let thickness = FRAC_PI_2 * p.module / cos_beta;
        let half_thickness = 0.5 * (thickness - p.thinning);
        if half_thickness <= 0.0 {
            return Err(GeometryError::NoToothLeft {
                thinning: p.thinning,
                thickness,
            });
        }
        let h_pointed = half_thickness / alpha_t.tan();
        if h_pointed <= p.addendum * p.module {
            return Err(GeometryError::PointedTooth {
                r_tip: p.addendum * p.module,
                r_pointed: h_pointed,
                max_addendum: h_pointed / p.module,
            });
        }
        let half_space = (thickness - half_thickness) * cos_beta;
        let tip = ToolTip::new(
            half_space,
            p.dedendum * p.module,
            p.tip_radius,
            p.module,
            p.dedendum,
            p.pressure_angle,
            p.helix_angle,
        )?;
        Ok(Self {
            params,
            alpha_t,
            beta_b,
            half_thickness,
            tip,
        })
    }

    /// Returns the parameters of the rack.
    pub fn params(&self) -> &RackParams {
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

    /// Returns the index of the first tooth, the one at the lowest y.
    pub fn first_tooth(&self) -> i64 {
        -((i64::from(self.params.teeth) - 1) / 2)
    }

    /// Returns the transverse pressure angle (rad).
    pub fn transverse_pressure_angle(&self) -> f64 {
        self.alpha_t
    }

    /// Returns the base helix angle (rad), signed as the helix angle.
    pub fn base_helix_angle(&self) -> f64 {
        self.beta_b
    }

    /// Returns the transverse pitch along the reference line (m).
    pub fn pitch(&self) -> f64 {
        2.0 * FRAC_PI_2 * self.params.module / self.params.helix_angle.cos()
    }

    /// Returns the transverse base pitch (m).
    pub fn base_pitch(&self) -> f64 {
        self.pitch() * self.alpha_t.cos()
    }

    /// Returns the height of the tips above the reference line (m).
    pub fn tip_height(&self) -> f64 {
        self.params.addendum * self.params.module
    }

    /// Returns the depth of the root below the reference line (m).
    pub fn root_depth(&self) -> f64 {
        self.params.dedendum * self.params.module
    }

    /// Returns the depth below the reference line (m) at which the straight flank ends and the fillet begins.
    pub fn form_depth(&self) -> f64 {
        self.tip.flank_end_depth()
    }

    /// Returns half the tooth thickness at the reference line (m), including thinning.
    pub fn half_thickness_reference(&self) -> f64 {
        self.half_thickness
    }

    /// Returns half the transverse tooth thickness (m) at `height` (m) above the reference line: straight flank, below
    /// it the fillet. `height` is limited to the range from root to tip.
    pub fn half_thickness_at(&self, height: f64) -> f64 {
        if height >= -self.form_depth() {
            return self.half_thickness_on_flank(height.min(self.tip_height()));
        }
        let depth = (-height).min(self.root_depth());
        0.5 * self.pitch() - self.tip.half_width_at(depth)
    }

    /// Returns a point of a fillet by its own parameter, from 0 at the root line to 1 at the straight flank: height
    /// (m) above the reference line and half tooth thickness (m).
    pub fn fillet_at(&self, t: f64) -> (f64, f64) {
        let (u, d) = self.tip.point(self.tip.q_max() * t.clamp(0.0, 1.0));
        (-d, 0.5 * self.pitch() - u)
    }

    /// Returns half the thickness (m) of the straight flank, extended beyond both ends.
    pub(super) fn half_thickness_on_flank(&self, height: f64) -> f64 {
        self.half_thickness - height * self.alpha_t.tan()
    }

    /// Returns the area (m^2) of one pitch of the transverse section: tooth, fillets and body.
    fn pitch_area(&self) -> f64 {
        let (ha, form, root) = (self.tip_height(), self.form_depth(), self.root_depth());
        // Straight part: its mean half thickness is at mid height.
        let straight = 2.0 * (ha + form) * self.half_thickness_on_flank(0.5 * (ha - form));
        // Fillet: pitch minus the tool tip, a flat of half length w_c and a circular segment of
        // opening angle pi/2 - alpha_n, stretched by 1/cos(beta) along the rack.
        let p = &self.params;
        let rho = p.tip_radius * p.module;
        let opening = FRAC_PI_2 - p.pressure_angle;
        let segment = 0.5 * rho * rho * (opening + opening.sin() * opening.cos())
            - rho * rho * p.pressure_angle.sin() * p.pressure_angle.cos();
        let tool = 2.0 * (self.tip.flat() * (root - form) + segment / p.helix_angle.cos());
        straight + (root - form) * self.pitch() - tool + p.body_height * self.pitch()
    }

    /// Returns the mass (kg) of the rack, cut square in the middle of the outer tooth spaces, for a density (kg/m^3).
    pub fn mass(&self, density: f64) -> f64 {
        density * self.params.face_width * f64::from(self.params.teeth) * self.pitch_area()
    }

    /// Returns half a tooth as height below the reference line and half thickness (m), from the tip to the root line.
    fn half_tooth(&self, points: usize) -> Vec<(f64, f64)> {
        let n = points.max(2);
        let half_pitch = 0.5 * self.pitch();
        let mut half = vec![(
            -self.tip_height(),
            self.half_thickness_at(self.tip_height()),
        )];
        for k in 0..n {
            let q = self.tip.q_max() * (1.0 - k as f64 / (n - 1) as f64);
            let (u, d) = self.tip.point(q);
            half.push((d, half_pitch - u));
        }
        half
    }

    /// Returns one pitch of the outline (m), counter-clockwise, from the middle of the space above tooth 0 to that of
    /// the space below it, with `points` (at least 2) on each fillet.
    pub fn tooth_outline(&self, points: usize) -> Vec<[f64; 2]> {
        let half = self.half_tooth(points);
        let end = [self.root_depth(), 0.5 * self.pitch()];
        let mut all = vec![end];
        all.extend(half.iter().rev().map(|&(x, w)| [x, w]));
        all.extend(half.iter().map(|&(x, w)| [x, -w]));
        all.push([end[0], -end[1]]);
        all
    }

    /// Returns the closed outline polygon (m), counter-clockwise, in the rack frame (reference line at x = 0, teeth
    /// towards -x), with `points` (at least 2) on each fillet.
    pub fn outline(&self, points: usize) -> Vec<[f64; 2]> {
        let half_pitch = 0.5 * self.pitch();
        let half = self.half_tooth(points);
        let first = self.first_tooth();
        let last = first + i64::from(self.params.teeth) - 1;
        let back = self.root_depth() + self.params.body_height;
        let low = (first as f64 - 0.5) * self.pitch();
        let high = (last as f64 + 0.5) * self.pitch();
        // Counter-clockwise with the teeth on the -x side: down along the teeth, up at the back.
        let mut all = vec![[back, low], [back, high], [self.root_depth(), high]];
        for k in (first..=last).rev() {
            let y = k as f64 * self.pitch();
            all.extend(half.iter().rev().map(|&(x, w)| [x, y + w]));
            all.extend(half.iter().map(|&(x, w)| [x, y - w]));
        }
        all.push([self.root_depth(), low]);
        // A full-radius fillet ends in the middle of the space, where the next one begins.
        all.dedup_by(|a, b| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9 * half_pitch);
        all
    }
}
