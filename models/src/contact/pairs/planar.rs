//! Lines of action of gears whose axes stay parallel while their hubs move.
//!
//! With the centres a vector `D` apart in the transverse plane (complex numbers), signed base radii `r` (negative of an internal
//! gear), `R = r_a + r_b`, and `sigma` the sign of the side, the common tangent of the base circles is known in closed form:
//!
//! ```text
//! D = L t + R e,    t = sigma i e,    L^2 = |D|^2 - R^2,    e = D/(R + i sigma L)
//! g = cos(beta) (L - s_a - s_b) + e_a(s_a) + e_b(s_b),      s_k = s_k(theta_k) - sigma r_k dphi
//! ```
//!
//! `dphi` is how far the line has turned from where it stood at the start. By the velocity `v` of gear b over gear a at the
//! contact point `s` and the spin `w` of b over a
//!
//! ```text
//! ds_a = r_a/L (e . v - sigma (L - s) w),    ds_b = r_b/L (e . v + sigma s w) + sigma tan(beta) v_z
//! ```
//!
//! (F. L. Litvin, A. Fuentes, *Gear Geometry and Applied Theory*, 2nd ed. 2004, ch. 10: a change of the centre
//! distance leaves involutes conjugate.) The separation of the flanks from their involutes adds `e_k'(s_k) ds_k` to
//! the change of the gap: force and moment, which are one force along another line.

use super::lines::{Line, LinesOfAction, MeshedGears, PairState};
use super::spatial::NearestPoints;
use crate::Vec3;
use crate::geometry::Side;
use crate::kinematics::PointWrench;

impl LinesOfAction {
    /// Returns a pair whose hubs have moved in the transverse plane and along their axes.
    pub(super) fn pair_in_plane(
        &self,
        line: &Line,
        gears: &MeshedGears<'_>,
        pair: i64,
        s: [f64; 2],
    ) -> PairState {
        let radii = self.mesh.views.map(|v| v.base_radius.unwrap_or(0.0));
        let sum = radii[0] + radii[1];
        let sigma = if line.side == Side::Left { 1.0 } else { -1.0 };
        let [x, y, axis] = self.mesh.axes;
        let origins = [0, 1].map(|k| gears.of[k].frame().0.origin);
        let apart = origins[1] - origins[0];
        let (dx, dy) = (x.dot(&apart), y.dot(&apart));
        let square = dx * dx + dy * dy;
        let length = (square - sum * sum)
            .max(0.0)
            .sqrt()
            .copysign(self.mesh.length);
        // e = D (R - i sigma L)/|D|^2 and what it was.
        let [re, im] = [sum / square, -sigma * length / square];
        let e = [dx * re - dy * im, dx * im + dy * re];
        let was = [
            sigma * y.dot(&line.transverse),
            -sigma * x.dot(&line.transverse),
        ];
        let turned = (was[0] * e[1] - was[1] * e[0]).atan2(was[0] * e[0] + was[1] * e[1]);
        // A right-handed helix of gear a, as the normal of the line has it.
        let tan_helix = -axis.dot(&line.normal) / self.helix_cos;
        let [above_a, above_b] = [0, 1].map(|k| axis.dot(&origins[k]) - self.heights[k]);
        let s = [
            s[0] - sigma * radii[0] * turned,
            s[1] - sigma * radii[1] * turned + tan_helix * (above_b - above_a),
        ];
        let mut p = PairState {
            teeth: self.teeth(line.side, pair),
            s,
            gap: self.helix_cos * (length - s[0] - s[1]),
            scale: [1.0; 2],
            curvature: [0.0; 2],
            touch: None,
        };
        self.separate(line, &mut p);
        let base = e[0] * x + e[1] * y;
        let along = sigma * axis.cross(&base);
        let at = self.middle(s);
        let slopes = p.scale.map(|scale| (1.0 - scale) * self.helix_cos);
        // Forces and moments by which path coordinates move.
        let [of_a, of_b] = radii.map(|r| r / length);
        let force = [of_a * base, of_b * base + tan_helix * axis];
        let moment = [-sigma * of_a * (length - at), sigma * of_b * at];
        let plain = self.helix_cos * (along - tan_helix * axis);
        let normal = plain + slopes[0] * force[0] + slopes[1] * force[1];
        let couple = slopes[0] * moment[0] + slopes[1] * moment[1];
        let height = axis.dot(&(line.origin - self.mesh.centre_a));
        let place = origins[0] + radii[0] * base + at * along + height * axis;
        // The force acts where it has that moment too.
        let across = axis.cross(&normal);
        let beside = couple / across.norm_squared() * across;
        p.touch = Some(NearestPoints {
            gap: p.gap,
            x: place - beside,
            normal,
            roll: s,
            path: [
                0.5 * (force[0] - force[1]),
                0.5 * (moment[0] - moment[1]) * axis,
            ],
            rolls: [0, 1].map(|k| PointWrench {
                point: place,
                force: force[k],
                moment: moment[k] * axis,
            }),
        });
        p.scale = [1.0; 2];
        p.curvature = [0.0; 2];
        p
    }

    /// Builds the lines for hubs that move across and along parallel axes; heights are those of both centres at the
    /// start.
    #[must_use]
    pub fn in_plane(mut self, centres: [Vec3; 2]) -> Self {
        self.planar = true;
        self.heights = centres.map(|c| self.mesh.axes[2].dot(&c));
        for line in &mut self.lines {
            line.plain = false;
        }
        self
    }
}
