//! Rotation of vectors about z.

use crate::Vec3;

/// Returns a vector rotated about z by an angle [rad]. The angle zero leaves every bit.
pub fn turned(x: Vec3, angle: f64) -> Vec3 {
    if angle == 0.0 {
        return x;
    }
    let (s, c) = angle.sin_cos();
    Vec3::new(c * x.x - s * x.y, s * x.x + c * x.y, x.z)
}
