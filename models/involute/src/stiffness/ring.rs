//! The gear body as an elastic ring on a rigid seat: what a loaded tooth does to itself and to its
//! neighbours, bore, rim and torsion of the disc included.
//!
//! The ring `a <= r <= R` (seat or bore to root circle) is in plane stress and held at `a`. A tooth
//! stands on the arc `|theta| <= theta_f` of the root circle and passes its load on as a normal stress,
//! uniform and linear, and a uniform shear stress, so that both force components and the torque about
//! the gear's centre are those of the load (after P. Sainsot, P. Velex, O. Duverger, J. Mech. Des. 126
//! (2004) 748-752, who fit their solution of the same ring between `R/a` = 1.4 and 7 for one tooth
//! alone). In Fourier series over `theta` each harmonic is one of Michell's solutions, here in the
//! complex potentials of Kolosov and Muskhelishvili, `kappa = (3 - nu)/(1 + nu)`, `rho = r/R`:
//!
//! ```text
//! 2 G u_r / R      2 G u_theta / R    sigma_r           tau           per cos (u_r, sigma_r), sin (the others) n theta
//! (kappa-n-1)      (kappa+n+1)        (n+1)(2-n)        n (n+1)       rho^(n+1),  stresses over rho
//! 1                -1                 (n-1)             -(n-1)        rho^(n-1)
//! (kappa+n-1)      (n-1-kappa)        (1-n)(2+n)        n (1-n)       rho^(1-n)
//! 1                1                  -(n+1)            -(n+1)        rho^(-n-1)
//! 2 kappa ln rho - 1, -2 kappa ln rho - 1, 3 + kappa, 1 - kappa       third one for n = 1
//! ```
//!
//! The displacement of a tooth is the one its load does work on, so that the compliances between all
//! teeth come from one elastic body: symmetric, and never able to give energy. `n = 0` is the torsion of
//! the disc. The solution holds for any bore, from a thin rim to `a/R -> 0`, where the torsion of the
//! disc outgrows all the rest. The rim of an internal gear is the same ring held outside, `a > R`: displacements and stresses
//! count towards the tips, and the two solutions that die away inwards are the first ones. A rack is the limit of a large ring as thick as its body, whose back is
//! held.

use crate::geometry::{Gear, Rack};

use super::material::Material;

/// Largest `n theta_f` of the summed harmonics: the rest is about 1e-5 of the compliance.
const LAST_PHASE: f64 = 150.0;

/// Radius of the ring that represents a rack, in heights of its body.
const RACK_RADIUS: f64 = 60.0;

/// Uniform normal stress, linear normal stress and uniform shear stress from a unit force at the root.
pub(super) type RootLoad = [f64; 3];

/// Influence between the teeth of one body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RingBody {
    /// Radius of the roots of the teeth (m).
    radius: f64,
    /// Direction of the tips along the radius: 1, or -1 on the inside of a rim.
    outward: f64,
    /// Half angle of a tooth at the root (rad).
    theta_f: f64,
    /// Mean displacement of kind `i` of a tooth per unit load of kind `j` on the tooth `m` pitches before it,
    /// `[m][i][j]`, per width (m^2/N).
    influence: Vec<[[f64; 3]; 3]>,
}

impl RingBody {
    /// Builds the body of a gear supported at its bore, at its seat when it is solid, or at the outside of its rim;
    /// `pitches` is the largest distance between teeth of interest.
    pub(super) fn of_gear(gear: &Gear, material: &Material, pitches: usize) -> RingBody {
        let radii = [gear.seat_radius(), gear.r_root()];
        let pitch = std::f64::consts::TAU / f64::from(gear.teeth());
        let theta_f = gear.half_angle_at(gear.r_root());
        Self::new(radii, theta_f, pitch, material, pitches)
    }

    /// Builds the body of a rack supported at its back.
    pub(super) fn of_rack(rack: &Rack, material: &Material, pitches: usize) -> RingBody {
        let height = rack.params().body_height;
        let radius = RACK_RADIUS * height;
        let theta_f = rack.half_thickness_at(-rack.root_depth()) / radius;
        let pitch = rack.pitch() / radius;
        Self::new([radius - height, radius], theta_f, pitch, material, pitches)
    }

    fn new(
        [held, radius]: [f64; 2],
        theta_f: f64,
        pitch: f64,
        material: &Material,
        pitches: usize,
    ) -> RingBody {
        let ring = Harmonics {
            kappa: (3.0 - material.poisson) / (1.0 + material.poisson),
            alpha: held / radius,
        };
        let outward = ring.outward();
        let mut influence = vec![[[0.0; 3]; 3]; pitches + 1];
        let [normal, shear] = ring.uniform();
        // Unit loads have the mean 1/(2 pi R) and the amplitudes f/(pi R), g/(pi R).
        for m in &mut influence {
            m[0][0] += 0.5 * normal;
            m[2][2] += 0.5 * shear;
        }
        let last = (LAST_PHASE / theta_f).ceil() as u32;
        for n in 1..=last {
            let h = ring.compliance(n);
            let x = f64::from(n) * theta_f;
            let f = x.sin() / x;
            let g = (x.sin() - x * x.cos()) / (x * x);
            for (m, to) in influence.iter_mut().enumerate() {
                let (sin, cos) = (f64::from(n) * pitch * m as f64).sin_cos();
                to[0][0] += f * f * h.normal * cos;
                to[0][1] += f * g * h.normal * sin;
                to[0][2] -= f * f * h.mixed * sin;
                to[1][0] -= f * g * h.normal * sin;
                to[1][1] += g * g * h.normal * cos;
                to[1][2] -= f * g * h.mixed * cos;
                to[2][0] += f * f * h.mixed * sin;
                to[2][1] -= f * g * h.mixed * cos;
                to[2][2] += f * f * h.shear * cos;
            }
        }
        let unit = 1.0 / (2.0 * material.shear_modulus() * std::f64::consts::PI);
        for x in influence.as_flattened_mut().as_flattened_mut() {
            *x *= unit;
        }
        RingBody {
            radius,
            outward,
            theta_f,
            influence,
        }
    }

    /// Returns the root stresses from a unit force that crosses the centreline at `lever` (m) above the root circle
    /// and is inclined by `beta` (rad) to the normal of the centreline.
    pub(super) fn root_load(&self, lever: f64, beta: f64) -> RootLoad {
        let (sin, cos) = beta.sin_cos();
        let t = self.theta_f;
        let sinc = t.sin() / t;
        let shear = -(self.radius + self.outward * lever) * cos / self.radius;
        let linear = self.outward * (-cos - shear * sinc) * t * t / (t.sin() - t * t.cos());
        [-sin / sinc, linear, shear]
    }

    /// Returns the compliance (m/N) between a tooth with the load `lower` and the one `pitches` further, on the side
    /// that its force comes from, with `upper`; `pitches` = 0 for the tooth itself.
    pub(super) fn between(
        &self,
        pitches: usize,
        lower: &RootLoad,
        upper: &RootLoad,
        width: f64,
    ) -> f64 {
        let m = &self.influence[pitches];
        let along = |row: &[f64; 3]| row.iter().zip(lower).map(|(a, b)| a * b).sum::<f64>();
        upper
            .iter()
            .zip(m)
            .map(|(u, row)| u * along(row))
            .sum::<f64>()
            / width
    }
}

/// Displacements of the rim under its stresses, for one harmonic, in units of `R/(2 G)`.
struct Rim {
    /// Radial displacement by normal stress.
    normal: f64,
    /// Tangential displacement by normal stress, and radial displacement by shear.
    mixed: f64,
    /// Tangential displacement by shear.
    shear: f64,
}

/// A ring with teeth at the radius 1, supported at `alpha`: inside them, or outside as the rim of an internal gear.
struct Harmonics {
    kappa: f64,
    alpha: f64,
}

impl Harmonics {
    /// Returns the sign of the direction of the teeth on the ring.
    fn outward(&self) -> f64 {
        if self.alpha < 1.0 { 1.0 } else { -1.0 }
    }

    /// Returns the displacement towards the tips by uniform tension, and the tangential one by uniform shear
    /// (torsion).
    fn uniform(&self) -> [f64; 2] {
        let (k, a2) = (self.kappa, self.alpha * self.alpha);
        // u_r = rho - alpha^2/rho, u_theta = 1/rho - rho/alpha^2.
        let normal = (1.0 - a2) / (2.0 / (k - 1.0) + a2);
        [normal, (1.0 - a2) / a2].map(|u| self.outward() * u)
    }

    fn compliance(&self, n: u32) -> Rim {
        self.both(n).0
    }

    /// Returns the harmonic, and the radial displacement by shear, which reciprocity makes equal to `mixed`.
    fn both(&self, n: u32) -> (Rim, f64) {
        let (k, a) = (self.kappa, self.alpha);
        let exponent = n as i32;
        let n = f64::from(n);
        // (u_r, u_theta) at the seat and at the teeth, (sigma, tau) there. Those two that die away from the seat to the teeth
        // are scaled to 1 at the seat, so that nothing overflows; the others are 1 at the teeth.
        let stress = [
            [(n + 1.0) * (2.0 - n), n * (n + 1.0)],
            [n - 1.0, 1.0 - n],
            [(1.0 - n) * (2.0 + n), n * (1.0 - n)],
            [-(n + 1.0); 2],
        ];
        let u = [
            [k - n - 1.0, k + n + 1.0],
            [1.0, -1.0],
            [k + n - 1.0, n - 1.0 - k],
            [1.0; 2],
        ];
        let within = self.outward() > 0.0;
        let ratio = if within { a } else { a.recip() };
        let (low, high) = (ratio.powi(exponent - 1), ratio.powi(exponent + 1));
        let at_seat =
            |i: usize, scale: f64| (u[i], u[i].map(|x| x * scale), stress[i].map(|x| x * scale));
        let at_teeth = |i: usize, scale: f64| (u[i].map(|x| x * scale), u[i], stress[i]);
        let logarithmic = {
            let log = 2.0 * k * a.ln();
            ([log - 1.0, -log - 1.0], [-1.0, -1.0], [3.0 + k, 1.0 - k])
        };
        let one = exponent == 1;
        let (fixed, growing) = match within {
            true => (
                [
                    if one { logarithmic } else { at_seat(2, low) },
                    at_seat(3, high),
                ],
                [at_teeth(0, high), at_teeth(1, low)],
            ),
            false => (
                [at_seat(0, high), at_seat(1, low)],
                [
                    if one { logarithmic } else { at_teeth(2, low) },
                    at_teeth(3, high),
                ],
            ),
        };
        // Each of these with so much of the other two that the seat stays.
        let [third, fourth] = fixed;
        let [d, e] = [third.0, fourth.0];
        let det = d[0] * e[1] - d[1] * e[0];
        let [first, second] = growing.map(|(seat, u, stress)| {
            let b = seat.map(|x| -x);
            let c3 = (b[0] * e[1] - b[1] * e[0]) / det;
            let c4 = (d[0] * b[1] - d[1] * b[0]) / det;
            let with = |x: [f64; 2], y: [f64; 2], z: [f64; 2]| {
                [0, 1].map(|i| x[i] + c3 * y[i] + c4 * z[i])
            };
            (with(u, third.1, fourth.1), with(stress, third.2, fourth.2))
        });
        let ((u1, s1), (u2, s2)) = (first, second);
        let det = s1[0] * s2[1] - s1[1] * s2[0];
        // By unit normal stress and by unit shear stress.
        let by = |sigma: f64, tau: f64| {
            let c1 = (sigma * s2[1] - tau * s2[0]) / det;
            let c2 = (s1[0] * tau - s1[1] * sigma) / det;
            [0, 1].map(|i| c1 * u1[i] + c2 * u2[i])
        };
        let ([normal, mixed], [mirrored, shear]) = (by(1.0, 0.0), by(0.0, 1.0));
        // Towards the tips, by tension and by shear on the side of the teeth.
        let [normal, shear] = [normal, shear].map(|u| self.outward() * u);
        let rim = Rim {
            normal,
            mixed,
            shear,
        };
        (rim, mirrored)
    }
}

#[cfg(test)]
#[path = "ring_tests.rs"]
mod tests;
