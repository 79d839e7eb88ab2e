//! The involute helicoid through the nodes of flanks, by nonlinear least squares.
//!
//! On the flank of side `s` (+1 left, counter-clockwise; -1 right) of tooth `i`, at the radius `r` and the height `z`,
//!
//! ```text
//! phi = phi_0 + i tau + kappa z + s (psi_b - inv alpha),   cos alpha = r_b / r,   tau = 2 pi / teeth
//! e = (s r_b (phi - phi_0 - i tau - kappa z) - r_b psi_b + r_b inv alpha) cos beta_b,   tan beta_b = kappa r_b
//! ```
//!
//! `e` is the distance outwards along the normal (transverse one times `cos beta_b`; D. P. Townsend, *Dudley's Gear
//! Handbook*, 2nd ed. 1991, ch. 4; ISO 21771:2007, 4). Its slope by the base radius is `-tan alpha`, without a
//! singularity at the base circle. Gauss and Newton over `r_b, kappa, psi_b, phi_0`.

use gearbench_models::geometry::Side;
use nalgebra::{Matrix4, Vector4};
use std::f64::consts::TAU;

/// A node of a flank about the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlankPoint {
    /// Distance from the axis [m].
    pub radius: f64,
    /// Angle about the axis [rad].
    pub angle: f64,
    /// Place along the axis [m].
    pub height: f64,
    /// Tooth number, counter-clockwise.
    pub tooth: u32,
    /// Side of the flank.
    pub side: Side,
}

/// An involute toothing, without the limits of its flanks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Involute {
    /// Number of teeth.
    pub teeth: u32,
    /// Base radius [m].
    pub base_radius: f64,
    /// Turn of the teeth along the axis [rad/m], right hand positive.
    pub twist: f64,
    /// Half of the angle that a tooth has at the base circle [rad].
    pub half_angle: f64,
    /// Angle of tooth 0 where the height is 0 [rad].
    pub phase: f64,
    /// Root mean square and largest distance of the nodes along the normal [m].
    pub residual: [f64; 2],
    /// Standard errors of base radius [m], twist [rad/m] and half angle [rad], as if the residuals were independent.
    pub errors: [f64; 3],
    /// Nodes that it was fitted to.
    pub nodes: usize,
}

impl Involute {
    /// A first guess, before any fit.
    pub fn guess(teeth: u32, base_radius: f64, twist: f64) -> Self {
        Involute {
            teeth,
            base_radius,
            twist,
            half_angle: 0.0,
            phase: 0.0,
            residual: [f64::INFINITY; 2],
            errors: [f64::INFINITY; 3],
            nodes: 0,
        }
    }

    /// Transverse base pitch `2 pi r_b / teeth` [m].
    pub fn base_pitch(&self) -> f64 {
        TAU * self.base_radius / f64::from(self.teeth)
    }

    /// Helix angle at the base cylinder, right hand positive [rad].
    pub fn base_helix_angle(&self) -> f64 {
        (self.twist * self.base_radius).atan()
    }

    /// Transverse thickness of a tooth along the base circle [m].
    pub fn base_thickness(&self) -> f64 {
        2.0 * self.base_radius * self.half_angle
    }

    /// Angle between two teeth [rad].
    pub fn pitch_angle(&self) -> f64 {
        TAU / f64::from(self.teeth)
    }

    /// Length of roll from the base circle to a radius, 0 within it [m].
    pub fn roll(&self, radius: f64) -> f64 {
        (radius * radius - self.base_radius * self.base_radius)
            .max(0.0)
            .sqrt()
    }

    /// Half of the angle of a tooth at a length of roll [rad].
    pub fn half_angle_at(&self, roll: f64) -> f64 {
        let s = roll / self.base_radius;
        self.half_angle - (s - s.atan())
    }

    /// Angle of a point from its flank's base point, forward to the flank's own side, with the turn of its tooth taken out
    /// [rad].
    fn offset(&self, p: &FlankPoint) -> f64 {
        let centre = self.phase + f64::from(p.tooth) * self.pitch_angle() + self.twist * p.height;
        let turn = p.angle - centre;
        p.side.sign() * (turn - TAU * (turn / TAU).round())
    }

    /// Returns the distance of a point outwards from its flank, along the normal [m]; for a point within the base
    /// circle, from the base point.
    pub fn distance(&self, p: &FlankPoint) -> f64 {
        let away = self.offset(p) - self.half_angle_at(self.roll(p.radius));
        self.base_radius * away * self.base_helix_angle().cos()
    }

    /// Fits an involute to points; `None` where they are insufficient (fewer than eight, one radius only, or within
    /// the base circle). Where all have one height the twist is not changed.
    pub fn fitted(&self, points: &[FlankPoint]) -> Option<Self> {
        if points.len() < 8 {
            return None;
        }
        let mut fit = *self;
        let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |e, p| {
            (e.0.min(p.radius), e.1.max(p.radius))
        });
        let size = high;
        fit.base_radius = fit.base_radius.min(low);
        let mut inverse = Matrix4::zeros();
        for _ in 0..40 {
            let mut normal = Matrix4::zeros();
            let mut right = Vector4::zeros();
            for p in points {
                let roll = fit.roll(p.radius) / fit.base_radius;
                let e = fit.offset(p) - fit.half_angle_at(fit.roll(p.radius));
                let s = p.side.sign();
                // By r_b over r_b, kappa r_b, psi_b, phi_0, all over r_b.
                let row = Vector4::new(-roll, -s * p.height / fit.base_radius, -1.0, -s);
                normal += row * row.transpose();
                right -= row * e;
            }
            if normal[(1, 1)] <= 1e-20 * normal[(2, 2)] {
                (normal[(1, 1)], normal[(1, 0)], normal[(0, 1)]) = (1.0, 0.0, 0.0);
                for k in [2, 3] {
                    (normal[(1, k)], normal[(k, 1)]) = (0.0, 0.0);
                }
                right[1] = 0.0;
            }
            inverse = normal.cholesky()?.inverse();
            let step = inverse * right;
            // The base circle stays within the points.
            let by = step[0].clamp(-0.2, 0.2);
            let base = fit.base_radius;
            fit.base_radius = (base * (1.0 + by)).min(0.5 * (low + high));
            fit.twist += step[1] / base;
            fit.half_angle += step[2];
            fit.phase += step[3];
            if step.amax() < 1e-15 {
                break;
            }
        }
        let n = points.len() as f64;
        let distances = || points.iter().map(|p| fit.distance(p));
        let square = distances().map(|e| e * e).sum::<f64>();
        let most = distances().fold(0.0, |m: f64, e| m.max(e.abs()));
        if !(square.is_finite() && fit.base_radius > 0.0 && fit.base_radius < size) {
            return None;
        }
        let deviation =
            (square / (n - 4.0)).sqrt() / (fit.base_radius * fit.base_helix_angle().cos());
        let error = |k: usize| deviation * inverse[(k, k)].max(0.0).sqrt();
        fit.errors = [
            error(0) * fit.base_radius,
            error(1) / fit.base_radius,
            error(2),
        ];
        fit.residual = [(square / n).sqrt(), most];
        fit.nodes = points.len();
        Some(fit)
    }

    /// Fits as [`Involute::fitted`], then again without the points at more than six times the median deviation:
    /// reliefs, fillets. Points nearer than `fine` [m] are never left out.
    pub fn fitted_to_most(&self, points: &[FlankPoint], fine: f64) -> Option<Self> {
        let mut fit = self.fitted(points)?;
        let mut kept = points.len();
        for _ in 0..12 {
            let mut off: Vec<f64> = points.iter().map(|p| fit.distance(p).abs()).collect();
            off.sort_by(f64::total_cmp);
            let limit = (6.0 * 1.4826 * off[off.len() / 2]).max(fine);
            let near = points.iter().filter(|p| fit.distance(p).abs() <= limit);
            let near: Vec<FlankPoint> = near.copied().collect();
            fit = fit.fitted(&near)?;
            if near.len() == kept {
                break;
            }
            kept = near.len();
        }
        Some(fit)
    }
}
