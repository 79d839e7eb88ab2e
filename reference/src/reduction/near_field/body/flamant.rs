//! Flamant's solution: a half-plane under a line load (K. L. Johnson, *Contact Mechanics* (1985), 2.2).

use gearbench_models::Vec3;
use std::f64::consts::PI;

/// Flamant's solution of an inward unit load per width at a row, over `A`.
pub struct Flamant {
    place: Vec3,
    inward: Vec3,
    along: Vec3,
    poisson: f64,
}

impl Flamant {
    /// Of a row at a place, with an outward normal.
    pub fn new(&(place, normal): &(Vec3, Vec3), poisson: f64) -> Self {
        Flamant {
            place,
            inward: -normal,
            along: Vec3::z().cross(&normal),
            poisson,
        }
    }

    /// Depth and place along the surface of a point.
    pub fn seen(&self, x: &Vec3) -> [f64; 2] {
        let d = x - self.place;
        [self.inward.dot(&d), self.along.dot(&d)]
    }

    /// Distance of a point to the line.
    pub fn distance(&self, x: &Vec3) -> f64 {
        let [depth, along] = self.seen(x);
        depth.hypot(along)
    }

    /// Returns the displacement over `A`.
    pub fn displacement(&self, x: &Vec3) -> Vec3 {
        let [depth, along] = self.seen(x);
        let (r, t) = (depth.hypot(along), along.atan2(depth));
        let scale = 1.0 / (2.0 * (1.0 - self.poisson));
        let c = scale * (1.0 - 2.0 * self.poisson);
        let (sin, cos) = t.sin_cos();
        (scale * cos * cos - r.ln()) * self.inward + (scale * sin * cos - c * t) * self.along
    }

    /// Traction on a face with an outward normal.
    pub fn traction(&self, x: &Vec3, normal: &Vec3) -> Vec3 {
        let [depth, along] = self.seen(x);
        let squared = depth * depth + along * along;
        let outwards = depth * self.inward + along * self.along;
        let stress = -2.0 * depth / (PI * squared);
        stress * (outwards.dot(normal) / squared * outwards)
            + self.poisson * stress * normal.z * Vec3::z()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gearbench_models::stiffness::Material;
    use nalgebra::Matrix3;

    /// Tractions are those of the strains of the displacements, in plane strain.
    #[test]
    fn tractions_belong_to_the_displacements() {
        let steel = Material::STEEL;
        let (young, nu) = (steel.young, steel.poisson);
        let normal = Vec3::new(0.6, 0.8, 0.0);
        let field = Flamant::new(&(Vec3::new(0.1, 0.2, 0.0), normal), nu);
        let a = 2.0 * (1.0 - nu * nu) / (PI * young);
        let h = 1e-7;
        for (depth, along) in [(2e-3, 1e-3), (1e-3, -4e-3), (5e-3, 0.0), (1e-4, 2e-3)] {
            let x = field.place + depth * field.inward + along * field.along;
            let mut gradient = Matrix3::zeros();
            for axis in 0..2 {
                let mut step = Vec3::zeros();
                step[axis] = h;
                let [b, c] = [x + step, x - step].map(|x| field.displacement(&x));
                gradient.set_column(axis, &(a * (b - c) / (2.0 * h)));
            }
            let strain = 0.5 * (gradient + gradient.transpose());
            let mu = young / (2.0 * (1.0 + nu));
            let lambda = 2.0 * mu * nu / (1.0 - 2.0 * nu);
            let stress = lambda * strain.trace() * Matrix3::identity() + 2.0 * mu * strain;
            for m in [normal, Vec3::new(-0.8, 0.6, 0.0), Vec3::z()] {
                let (found, expected) = (field.traction(&x, &m), stress * m);
                assert!(
                    (found - expected).norm() < 1e-5 * stress.norm(),
                    "{found} {expected}"
                );
            }
        }
    }
}
