//! Shape of a bore from its nodes: a circle about z, or a plane parallel to z.

use gearbench_models::Vec3;

/// Greatest relative deviation of bore nodes from their circle or plane: decks print five digits or more.
pub(super) const TOLERANCE: f64 = 1e-4;

/// Shape of a bore, seen along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// Nodes on a circle.
    Circle {
        /// Centre, z = 0 [m].
        centre: Vec3,
        /// Radius of the circle [m].
        radius: f64,
    },
    /// Nodes on a line with this unit normal.
    Plane {
        /// Unit vector in the x-y plane, of either sense.
        normal: Vec3,
    },
    /// Neither a circle nor a plane.
    Neither,
}

/// Fits a circle (Kasa's least squares, exact for points on a circle) unless the points lie on a line.
pub(super) fn shape(points: &[Vec3]) -> Shape {
    if points.len() < 3 {
        return Shape::Neither;
    }
    let n = points.len() as f64;
    let mean = points.iter().sum::<Vec3>() / n;
    let (mut suu, mut suv, mut svv, mut au, mut av) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for p in points {
        let (u, v) = (p.x - mean.x, p.y - mean.y);
        suu += u * u;
        suv += u * v;
        svv += v * v;
        au += 0.5 * u * (u * u + v * v);
        av += 0.5 * v * (u * u + v * v);
    }
    // Principal direction of the points: the line they would lie on.
    let along = 0.5 * (2.0 * suv).atan2(suu - svv);
    let (s, c) = along.sin_cos();
    let mut half_length: f64 = 0.0;
    let mut off: f64 = 0.0;
    for p in points {
        let (u, v) = (p.x - mean.x, p.y - mean.y);
        half_length = half_length.max((c * u + s * v).abs());
        off = off.max((c * v - s * u).abs());
    }
    if half_length > 0.0 && off <= TOLERANCE * half_length {
        let exact = off <= 1e-12 * half_length;
        // Lines along an axis stay exact.
        let normal = match (exact, s.abs() < 1e-12, c.abs() < 1e-12) {
            (true, true, _) => Vec3::new(0.0, 1.0, 0.0),
            (true, _, true) => Vec3::new(1.0, 0.0, 0.0),
            _ => Vec3::new(-s, c, 0.0),
        };
        return Shape::Plane { normal };
    }
    let det = suu * svv - suv * suv;
    let (uc, vc) = ((au * svv - av * suv) / det, (av * suu - au * suv) / det);
    let radius = (uc * uc + vc * vc + (suu + svv) / n).sqrt();
    let centre = Vec3::new(mean.x + uc, mean.y + vc, 0.0);
    let fits = points.iter().all(|p| {
        let r = (p.x - centre.x).hypot(p.y - centre.y);
        (r - radius).abs() <= TOLERANCE * radius
    });
    if fits && radius.is_finite() && radius > 0.0 {
        Shape::Circle { centre, radius }
    } else {
        Shape::Neither
    }
}
