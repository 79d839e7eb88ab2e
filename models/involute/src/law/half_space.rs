//! Approach of elastic half-spaces under a line load, beyond the part that a finite-element mesh resolves.
//!
//! Two bodies whose flanks touch along a line of load `q` per width [N/m] flatten over Hertz's half-width
//!
//! ```text
//! b^2 = 2 R A q,    A = A_1 + A_2,    A_i = 2 (1 - nu_i^2) / (pi E_i)
//! ```
//!
//! with the relative radius of curvature `R`. A mesh whose elements are larger than `b` spreads the load over an effective
//! half-width `b_i` of its own instead, so that of the approach it leaves out
//!
//! ```text
//! d = q [A_1 ln(b_1/b) + A_2 ln(b_2/b)] = A/2 q ln(q_0/q),    q_0 = exp(2 (A_1 ln b_1 + A_2 ln b_2)/A) / (2 R A)
//! ```
//!
//! In forces over a width `w`, with `F_0 = w q_0` and `K = 2 w/A`: `N ln(F_0/N) = K d`. The place of the contact on its
//! flanks is in `F_0` alone, which is the `k` of the law. From `K. L. Johnson, *Contact Mechanics* (1985), 5.6`; the load
//! enters as `ln b` wherever the support of the body is.
//!
//! The tangent grows without bound at `N = F_0/e`, where the contact is as wide as what the mesh spreads it over; before
//! that the force goes on in a straight line.

/// Value of `ln(F_0/N)` below which the force is continued by a straight line.
const STRAIGHT: f64 = 1.3;

/// Constants of the half-space law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSpace {
    /// Stiffness constant `2 w/A` (N/m).
    stiffness: f64,
}

impl HalfSpace {
    /// Creates the law for contact over a width (m), with the sum `A` of both bodies (m^2/N).
    pub fn new(width: f64, compliance: f64) -> Self {
        HalfSpace {
            stiffness: 2.0 * width / compliance,
        }
    }

    /// Returns the stiffness constant `2 w/A` (N/m).
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Returns the law for a share of the width.
    #[inline]
    pub(super) fn shared(self, share: f64) -> Self {
        HalfSpace {
            stiffness: self.stiffness * share,
        }
    }

    /// Returns `ln(F_0/N)` of an approach, or `None` on the straight line.
    #[inline]
    fn logarithm(&self, d: f64, f0: f64) -> Option<f64> {
        // t exp(-t) = y, on the branch t > 1.
        let y = self.stiffness * d / f0;
        if y >= STRAIGHT * (-STRAIGHT).exp() {
            return None;
        }
        // Within 3e-4 of the solution, D. A. Barry et al., Math. Comput. Simul. 53 (2000) 95, an exponential near one by
        // its series.
        let sigma = -y.ln() - 1.0;
        let root = sigma.sqrt();
        let near_one = 1.0 - 0.0201 * root * (1.0 - 0.01005 * root);
        let ratio =
            0.3361 * std::f64::consts::FRAC_1_SQRT_2 * root / (1.0 - 0.0042 * sigma * near_one);
        let t = 1.0 + sigma + 2.0 / 0.3361 * (1.0 - 1.0 / (1.0 + ratio));
        // One step of order four: F. N. Fritsch, R. E. Shafer, W. P. Crowley, Commun. ACM 16 (1973) 123.
        let (z, w) = ((y / t).ln() + t, 1.0 - t);
        let q = 2.0 * w * (w + 2.0 / 3.0 * z);
        Some(t * (1.0 + z / w * (q - z) / (q - 2.0 * z)))
    }

    /// Returns the force at the start of the straight line, the approach there, and its slope.
    #[inline]
    fn straight(&self, f0: f64) -> (f64, f64, f64) {
        let n = f0 * (-STRAIGHT).exp();
        (
            n,
            n * STRAIGHT / self.stiffness,
            self.stiffness / (STRAIGHT - 1.0),
        )
    }

    /// Returns the force of an approach `d >= 0` (m), and its derivatives by the approach and by `F_0`.
    #[inline]
    pub(super) fn force(&self, d: f64, f0: f64) -> (f64, f64, f64) {
        if d <= 0.0 {
            return (0.0, 0.0, 0.0);
        }
        match self.logarithm(d, f0) {
            Some(t) => {
                let n = self.stiffness * d / t;
                (n, self.stiffness / (t - 1.0), -n / (f0 * (t - 1.0)))
            }
            None => {
                let (n, from, slope) = self.straight(f0);
                (n + slope * (d - from), slope, -n / (f0 * (STRAIGHT - 1.0)))
            }
        }
    }

    /// Returns the energy of an approach `d >= 0` (J), and its derivative by `F_0`.
    #[inline]
    pub(super) fn energy(&self, d: f64, f0: f64) -> (f64, f64) {
        if d <= 0.0 {
            return (0.0, 0.0);
        }
        let up_to = |n: f64, t: f64| n * n / self.stiffness * (0.5 * t - 0.25);
        match self.logarithm(d, f0) {
            Some(t) => {
                let n = self.stiffness * d / t;
                (up_to(n, t), -n * n / (2.0 * self.stiffness * f0))
            }
            None => {
                let (n, from, slope) = self.straight(f0);
                let (first, beyond) = (up_to(n, STRAIGHT), d - from);
                let by_f0 = 2.0 * first + n * beyond - from * (n + slope * beyond);
                (first + beyond * (n + 0.5 * slope * beyond), by_f0 / f0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The force is the derivative of the energy, by the approach and by `F_0`; it satisfies its equation; it has no
    /// jump where the straight line begins.
    #[test]
    fn the_force_derives_from_its_energy() {
        let law = HalfSpace::new(0.014, 2.0 * 2.0 * 0.91 / (std::f64::consts::PI * 2.06e11));
        let f0 = 3e5;
        let from = law.straight(f0).1;
        for part in [
            1e-60, 1e-30, 1e-12, 1e-6, 1e-3, 0.03, 0.1, 0.3, 0.5, 0.8, 0.99, 0.999, 1.001, 1.01,
            2.0, 10.0,
        ] {
            let d = part * from;
            let (n, slope, by_f0) = law.force(d, f0);
            if part < 1.0 {
                assert!((n * (f0 / n).ln() / (law.stiffness * d) - 1.0).abs() < 4e-15);
            }
            let h = 1e-5 * d;
            let difference = |f: &dyn Fn(f64) -> f64| (f(d + h) - f(d - h)) / (2.0 * h);
            let near = |x: f64, y: f64| (x - y).abs() < 2e-5 * y.abs();
            assert!(near(difference(&|d| law.energy(d, f0).0), n), "{part}");
            assert!(near(difference(&|d| law.force(d, f0).0), slope), "{part}");
            let h = 1e-5 * f0;
            let difference = |f: &dyn Fn(f64) -> f64| (f(f0 + h) - f(f0 - h)) / (2.0 * h);
            assert!(near(difference(&|f0| law.force(d, f0).0), by_f0), "{part}");
            let energy = law.energy(d, f0).1;
            assert!(
                near(difference(&|f0| law.energy(d, f0).0), energy),
                "{part}"
            );
        }
        let [below, above] = [1.0 - 1e-12, 1.0 + 1e-12].map(|part| law.force(part * from, f0));
        assert!((above.0 / below.0 - 1.0).abs() < 1e-9 && (above.1 / below.1 - 1.0).abs() < 1e-9);
        assert_eq!(law.force(0.0, f0), (0.0, 0.0, 0.0));
    }
}
