//! Springs, dampers and masses of the teeth.

/// Parameters of the teeth: lists with one entry, or one per tooth.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ToothSprings {
    /// True if all teeth are equal; the lists have one entry.
    pub uniform: bool,
    /// Stiffness of each tooth [N/m].
    pub stiffness: Vec<f64>,
    /// Damping of each tooth [N s/m].
    pub damping: Vec<f64>,
    /// Mass of each tooth [kg].
    pub mass: Vec<f64>,
    /// Square of the tooth radius, `r_d^2` [m^2]; 1 for a rack.
    pub radius_squared: f64,
    /// Stiffness over the contact radius for teeth in contact.
    pub radius: Option<RadiusStiffness>,
}

impl ToothSprings {
    /// Returns `1/omega` of the fastest tooth [s].
    pub fn shortest_time(&self) -> f64 {
        let n = self.stiffness.len().max(self.mass.len());
        let pick = |x: &[f64], i: usize| x[i.min(x.len() - 1)];
        let k = |i| {
            let most = self.radius.as_ref().map_or(0.0, |r| r.largest());
            pick(&self.stiffness, i).max(most)
        };
        (0..n)
            .map(|i| (pick(&self.mass, i) / k(i)).sqrt())
            .fold(f64::INFINITY, f64::min)
    }
}

/// Stiffness over the contact radius, `k(r)`: cubic between knots with slopes from neighbouring knots (continuous
/// derivative), constant outside.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RadiusStiffness {
    radius: Vec<f64>,
    stiffness: Vec<f64>,
    slope: Vec<f64>,
}

impl RadiusStiffness {
    /// Builds the curve from ascending knots [m] and values [N/m], which the caller has checked.
    pub fn new(radius: Vec<f64>, stiffness: Vec<f64>) -> Self {
        let n = radius.len();
        let chord = |i: usize| (stiffness[i + 1] - stiffness[i]) / (radius[i + 1] - radius[i]);
        // Constant outside, so the end slopes are zero; inside, harmonic means keep the curve monotone.
        let slope = (0..n)
            .map(|i| {
                if i == 0 || i + 1 == n {
                    return 0.0;
                }
                let (a, b) = (chord(i - 1), chord(i));
                if a * b <= 0.0 {
                    0.0
                } else {
                    2.0 * a * b / (a + b)
                }
            })
            .collect();
        RadiusStiffness {
            radius,
            stiffness,
            slope,
        }
    }

    /// Returns the stiffness of a tooth out of contact: the value at the first knot.
    pub fn rest(&self) -> f64 {
        self.stiffness[0]
    }

    fn largest(&self) -> f64 {
        self.stiffness.iter().copied().fold(0.0, f64::max)
    }

    /// Returns `k` and its first and second derivative by `r`.
    pub fn at(&self, r: f64) -> [f64; 3] {
        let n = self.radius.len();
        let i = self.radius.partition_point(|&x| x <= r);
        if i == 0 {
            return [self.stiffness[0], 0.0, 0.0];
        }
        if i == n {
            return [self.stiffness[n - 1], 0.0, 0.0];
        }
        let (r0, r1) = (self.radius[i - 1], self.radius[i]);
        let (k0, k1) = (self.stiffness[i - 1], self.stiffness[i]);
        let (m0, m1) = (self.slope[i - 1], self.slope[i]);
        let h = r1 - r0;
        let (u, w) = ((r - r0) / h, (r1 - r) / h);
        let d = (k1 - k0) / h;
        let k = k0 * w + k1 * u + h * u * w * (w * (m0 - d) - u * (m1 - d));
        let dk = d + w * (1.0 - 3.0 * u) * (m0 - d) + u * (2.0 - 3.0 * u) * (d - m1);
        let bend = (6.0 * u - 4.0) * (m0 - d) + (2.0 - 6.0 * u) * (d - m1);
        [k, dk, bend / h]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stiffness_over_radius_has_its_derivative() {
        let k = RadiusStiffness::new(vec![0.03, 0.035, 0.04], vec![6e8, 5e8, 2e8]);
        for i in 1..40 {
            let r = 0.0301 + 0.0098 * f64::from(i) / 41.0;
            let h = 1e-8;
            for i in 0..2 {
                let fd = (k.at(r + h)[i] - k.at(r - h)[i]) / (2.0 * h);
                let allowed = [1e6, 1e9][i];
                assert!(
                    (fd - k.at(r)[i + 1]).abs() < allowed,
                    "{r} {fd} {:?}",
                    k.at(r)
                );
            }
        }
        assert_eq!(k.at(0.02), [6e8, 0.0, 0.0]);
        assert_eq!(k.at(0.05), [2e8, 0.0, 0.0]);
    }
}
