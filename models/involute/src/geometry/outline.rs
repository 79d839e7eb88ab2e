//! Outline polygons and mass properties of a gear.
//!
//! With `psi(r)` the half tooth thickness angle, area and polar moment of the transverse section
//! are
//!
//! ```text
//! A   = pi (r_f^2 - r_bore^2)     + 2 z  integral psi r   dr   (r_f to r_a)
//! J_p = pi (r_f^4 - r_bore^4) / 2 + 2 z  integral psi r^3 dr
//! ```
//!
//! and of an internal gear, whose teeth stand on the inside of a rim of radius `r_o`,
//!
//! ```text
//! A   = pi (r_o^2 - r_f^2)        + 2 z  integral psi r   dr   (r_a to r_f)     J_p likewise
//! ```
//!
//! The integrals run over the fillet in its own parameter and over the involute in the length of
//! roll (`r dr = s ds`), both smooth, by composite Gauss-Legendre quadrature to rounding error.
//! Mass and inertia are those of the plain involute; micrometre modifications are left out.

use super::gear::Gear;

/// Mass and moment of inertia of a gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Mass of the gear (kg).
    pub mass: f64,
    /// Moment of inertia about the gear axis (kg m^2).
    pub izz: f64,
}

/// Nodes and weights of the five-point Gauss-Legendre rule on [-1, 1].
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// Integrates a pair of functions over [a, b] in 32 panels.
fn integrate(a: f64, b: f64, f: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    const PANELS: usize = 32;
    let h = (b - a) / PANELS as f64;
    let mut sum = [0.0; 2];
    for k in 0..PANELS {
        let mid = a + (k as f64 + 0.5) * h;
        for (node, weight) in GAUSS {
            let value = f(mid + 0.5 * h * node);
            for i in 0..2 {
                sum[i] += 0.5 * h * weight * value[i];
            }
        }
    }
    sum
}

/// Points per flank of an outline without visible corners: neighbouring chords differ by less than 3 degrees in direction,
/// but at the edges of tips, and depart from the curve by less than 0.02 % of the module.
pub const SMOOTH_FLANK: usize = 96;

/// Angle of the rounding of a tool of 20 degrees, along which points of a fillet are distributed.
const FILLET_OPENING: f64 = 70.0 * std::f64::consts::PI / 180.0;

impl Gear {
    /// Returns area (m^2) and polar second moment of area (m^4) of the transverse section without bore, with the rim
    /// of an internal gear.
    pub fn section_properties(&self) -> (f64, f64) {
        let z = f64::from(self.teeth());
        let half_pitch = 0.5 * self.pitch_angle();
        let fillet = integrate(0.0, self.profile.fillet.q_max(), |q| {
            let p = self.profile.fillet.at(q);
            let f = (half_pitch - p.delta) * p.r_dr;
            [f, f * p.r2]
        });
        let rb2 = self.r_base() * self.r_base();
        let involute = integrate(self.roll_length_form(), self.roll_length_tip(), |s| {
            let f = self.half_angle_at_roll(s) * s;
            [f, f * (rb2 + s * s)]
        });
        let rf2 = self.r_root() * self.r_root();
        // The teeth of an internal gear are passed from the larger radius to the smaller one, its body lies outside.
        let (sign, rim2) = match self.is_internal() {
            true => (-1.0, self.r_outer().powi(2)),
            false => (1.0, 0.0),
        };
        let body = sign * std::f64::consts::PI;
        (
            body * (rf2 - rim2) + sign * 2.0 * z * (fillet[0] + involute[0]),
            0.5 * body * (rf2 * rf2 - rim2 * rim2) + sign * 2.0 * z * (fillet[1] + involute[1]),
        )
    }

    /// Returns mass and inertia for a density (kg/m^3): teeth, fillets and body minus the bore.
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        let (area, polar) = self.section_properties();
        let bore2 = self.params().bore_radius.powi(2);
        let per_area = density * self.face_width();
        MassProperties {
            mass: per_area * (area - std::f64::consts::PI * bore2),
            izz: per_area * (polar - std::f64::consts::FRAC_PI_2 * bore2 * bore2),
        }
    }

    /// Returns the moment of inertia (kg m^2) about the axis of the core of a solid gear within its seat; 0 with a
    /// bore.
    pub fn core_inertia(&self, density: f64) -> f64 {
        if self.params().bore_radius > 0.0 || self.is_internal() {
            return 0.0;
        }
        let seat2 = self.seat_radius().powi(2);
        density * self.face_width() * std::f64::consts::FRAC_PI_2 * seat2 * seat2
    }

    /// Returns the mass (kg) of the core of a solid gear within its seat; 0 with a bore.
    pub fn core_mass(&self, density: f64) -> f64 {
        if self.params().bore_radius > 0.0 || self.is_internal() {
            return 0.0;
        }
        density * self.face_width() * std::f64::consts::PI * self.seat_radius().powi(2)
    }

    /// Returns one pitch of the outline (m), counter-clockwise: from the middle of the tooth space at `-pi/z` over
    /// tooth 0 (centred on +x) to the middle of the next space at `+pi/z`. It has `points` (at least 6) per flank,
    /// half of them on the fillet.
    pub fn tooth_outline(&self, points: usize) -> Vec<[f64; 2]> {
        let half = self.half_outline(points.max(6));
        let upper = half.iter().map(|&(r, a)| [r * a.cos(), r * a.sin()]);
        let mut all: Vec<_> = half
            .iter()
            .rev()
            .map(|&(r, a)| [r * a.cos(), -r * a.sin()])
            .collect();
        // The first point of the upper half lies on the centreline and is there already.
        all.extend(upper.skip(1));
        all
    }

    /// Returns the closed outline polygon (m) of the whole gear without bore (for an internal gear the hole in its
    /// rim), counter-clockwise, with tooth 0 centred on +x; the last point joins the first. The density of points is
    /// that of [`Gear::tooth_outline`].
    pub fn outline(&self, points_per_flank: usize) -> Vec<[f64; 2]> {
        let tooth = self.tooth_outline(points_per_flank);
        let mut all = Vec::with_capacity((tooth.len() - 1) * self.teeth() as usize);
        for k in 0..self.teeth() {
            let (sin, cos) = (f64::from(k) * self.pitch_angle()).sin_cos();
            // The last point of one tooth is the first of the next.
            for [x, y] in &tooth[..tooth.len() - 1] {
                all.push([cos * x - sin * y, sin * x + cos * y]);
            }
        }
        all
    }

    /// Returns a polygon that covers the section in a figure: the outline; for an internal gear the circle of its rim
    /// and then the hole, joined in the middle of a tooth space.
    pub fn filled_outline(&self, points_per_flank: usize) -> Vec<[f64; 2]> {
        let outline = self.outline(points_per_flank);
        if !self.is_internal() {
            return outline;
        }
        let (rim, points) = (self.r_outer(), 4 * self.teeth());
        let circle = (0..=points).map(|k| {
            let angle = (f64::from(k) / f64::from(points) - 0.5 / f64::from(self.teeth()))
                * std::f64::consts::TAU;
            [rim * angle.cos(), rim * angle.sin()]
        });
        let first = outline.first().copied();
        circle
            .chain(first)
            .chain(outline.into_iter().rev())
            .collect()
    }

    /// Returns the left half of a tooth as (radius, angle), from the tip centre to the middle of the space.
    fn half_outline(&self, points: usize) -> Vec<(f64, f64)> {
        let on_fillet = points / 2;
        let on_involute = points - on_fillet;
        let on_arc = (points / 6).max(2);
        let half_pitch = 0.5 * self.pitch_angle();
        let part = |k: usize, n: usize| k as f64 / n as f64;
        let mut out = Vec::with_capacity(points + 2 * on_arc);

        let tip = self.half_angle_at_roll(self.roll_length_tip());
        out.extend((0..on_arc).map(|k| (self.r_tip(), tip * part(k, on_arc))));
        let (s_form, s_tip) = (self.roll_length_form(), self.roll_length_tip());
        out.extend((0..on_involute).map(|k| {
            let s = s_tip + (s_form - s_tip) * part(k, on_involute);
            (self.r_base().hypot(s), self.half_angle_at_roll(s))
        }));
        // Equal steps of the direction of the tool's normal, `q = cos(phi)`, are nearly equal turns of the fillet.
        let q_max = self.profile.fillet.q_max();
        let opening = FILLET_OPENING;
        out.extend((0..on_fillet).map(|k| {
            let q = q_max * ((1.0 - part(k, on_fillet)) * opening).sin() / opening.sin();
            let p = self.profile.fillet.at(q);
            (p.r2.sqrt(), half_pitch - p.delta)
        }));
        let arc = self.profile.fillet.root_arc();
        // A full-radius tool leaves no root arc: one point in the middle of the space is enough.
        let on_root = if arc > 1e-9 * half_pitch { on_arc } else { 0 };
        out.extend(
            (0..on_root).map(|k| (self.r_root(), half_pitch - arc * (1.0 - part(k, on_root)))),
        );
        out.push((self.r_root(), half_pitch));
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::GearParams;

    fn area_and_polar(polygon: &[[f64; 2]]) -> (f64, f64) {
        let (mut area, mut polar) = (0.0, 0.0);
        for i in 0..polygon.len() {
            let ([x0, y0], [x1, y1]) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            let cross = x0 * y1 - x1 * y0;
            area += cross / 2.0;
            let squares = x0 * x0 + x0 * x1 + x1 * x1 + y0 * y0 + y0 * y1 + y1 * y1;
            polar += cross * squares / 12.0;
        }
        (area, polar)
    }

    fn sample() -> Vec<Gear> {
        let base = GearParams {
            teeth: 20,
            module: 4e-3,
            ..GearParams::default()
        };
        [
            base.clone(),
            GearParams {
                teeth: 30,
                tip_radius: 0.0,
                ..base.clone()
            },
            GearParams {
                teeth: 12,
                profile_shift: 0.5,
                helix_angle: 0.4,
                thinning: 1e-4,
                ..base
            },
        ]
        .into_iter()
        .map(|p| Gear::new(p).unwrap())
        .collect()
    }

    #[test]
    fn polygon_converges_to_the_integrals_at_second_order() {
        for gear in sample() {
            let (area, polar) = gear.section_properties();
            let error = |n: usize| {
                let (a, p) = area_and_polar(&gear.outline(n));
                ((a / area - 1.0).abs(), (p / polar - 1.0).abs())
            };
            let (coarse, fine) = (error(120), error(480));
            assert!(fine.0 < 1.5e-6 && fine.1 < 3e-6, "{fine:?}");
            // Four times the points: a sixteenth of the error.
            assert!(
                coarse.0 / fine.0 > 13.0 && coarse.0 / fine.0 < 19.0,
                "{coarse:?} {fine:?}"
            );
        }
    }

    #[test]
    fn polygon_is_simple() {
        for gear in sample() {
            let polygon = gear.outline(24);
            let n = polygon.len();
            let side = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
                (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            };
            for i in 0..n {
                let (a, b) = (polygon[i], polygon[(i + 1) % n]);
                assert!((a[0] - b[0]).hypot(a[1] - b[1]) > 1e-9, "double point {i}");
                for j in i + 2..n {
                    if (j + 1) % n == i {
                        continue;
                    }
                    let (c, d) = (polygon[j], polygon[(j + 1) % n]);
                    let crosses =
                        side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
                    assert!(!crosses, "edges {i} and {j} cross");
                }
            }
        }
    }

    /// Returns the change of direction at each point of a closed polygon, with its radius, in degrees.
    fn corners(polygon: &[[f64; 2]]) -> Vec<(f64, f64)> {
        let n = polygon.len();
        (0..n)
            .map(|i| {
                let [a, b, c] = [polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n]];
                let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
                let turn = (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]);
                (b[0].hypot(b[1]), turn.to_degrees().abs())
            })
            .collect()
    }

    /// The outline has no corner but the two edges of each tip: a fillet meets the root circle with its tangent, also that of a
    /// tool with sharp tips.
    #[test]
    fn smooth_outline_has_corners_only_where_the_tool_cuts_edges() {
        for gear in sample() {
            let teeth = gear.teeth() as usize;
            let found = corners(&gear.outline(SMOOTH_FLANK));
            let sharp: Vec<f64> = (found.iter())
                .filter(|(_, angle)| *angle > 3.0)
                .map(|c| c.0)
                .collect();
            let at_tip = sharp.iter().filter(|r| (**r - gear.r_tip()).abs() < 1e-9);
            assert_eq!(at_tip.count(), 2 * teeth);
            assert_eq!(sharp.len(), 2 * teeth, "{sharp:?}");
        }
    }

    /// Points above the form circle lie on `x + i y = r_b (1 - i t) exp(i (t + c))`, and chords stay close to the curve.
    #[test]
    fn smooth_outline_follows_the_involute() {
        for gear in sample() {
            let rb = gear.r_base();
            let p = gear.params();
            // Half angle on the base circle from the tooth thickness on the reference circle.
            let alpha = gear.transverse_pressure_angle();
            let start = gear.half_angle_reference() + alpha.tan() - alpha;
            let involute = |t: f64| {
                let (sin, cos) = (t - start).sin_cos();
                [rb * (cos + t * sin), -rb * (sin - t * cos)]
            };
            let tooth = gear.tooth_outline(SMOOTH_FLANK);
            let flank: Vec<[f64; 2]> = (tooth.into_iter())
                .filter(|[x, y]| *y > 0.0 && x.hypot(*y) >= gear.r_form() * (1.0 - 1e-12))
                .filter(|[x, y]| x.hypot(*y) <= gear.r_tip() * (1.0 - 1e-9))
                .collect();
            assert!(flank.len() >= SMOOTH_FLANK / 2 - 1);
            let roll = |q: &[f64; 2]| {
                ((q[0] * q[0] + q[1] * q[1]) / (rb * rb) - 1.0)
                    .max(0.0)
                    .sqrt()
            };
            let off = |q: [f64; 2], to: [f64; 2]| (q[0] - to[0]).hypot(q[1] - to[1]);
            for q in &flank {
                assert!(off(*q, involute(roll(q))) < 1e-9 * rb, "{q:?}");
            }
            for pair in flank.windows(2) {
                let between = involute(0.5 * (roll(&pair[0]) + roll(&pair[1])));
                let chord = [0, 1].map(|k| pair[1][k] - pair[0][k]);
                let from = [0, 1].map(|k| between[k] - pair[0][k]);
                let area = chord[0] * from[1] - chord[1] * from[0];
                let sag = area.abs() / chord[0].hypot(chord[1]);
                assert!(sag < 2e-4 * p.module, "{sag}");
            }
        }
    }

    #[test]
    fn outline_lies_on_half_angle_at() {
        for gear in sample() {
            let tooth = gear.tooth_outline(60);
            for [x, y] in tooth {
                let (r, angle) = (x.hypot(y), y.atan2(x).abs());
                let flank = gear.half_angle_at(r);
                if r > gear.r_root() + 1e-9 && r < gear.r_tip() - 1e-9 {
                    assert!((angle - flank).abs() < 1e-9, "{r} {angle} {flank}");
                }
            }
        }
    }

    #[test]
    fn a_bore_takes_its_disc_away() {
        let solid = sample().remove(0);
        let bore = 0.015f64;
        let params = GearParams {
            bore_radius: bore,
            ..solid.params().clone()
        };
        let hollow = Gear::new(params).unwrap().mass_properties(7850.0);
        let full = solid.mass_properties(7850.0);
        let disc = 7850.0 * solid.face_width() * std::f64::consts::PI * bore * bore;
        assert!((full.mass - hollow.mass - disc).abs() < 1e-12 * full.mass);
        assert!((full.izz - hollow.izz - 0.5 * disc * bore * bore).abs() < 1e-12 * full.izz);
    }
}
