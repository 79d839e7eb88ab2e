//! An independent tooth-contact analysis: flanks enveloped by the planes of a tilted rack, by the equation of meshing, and
//! the common normal point of two of them by Newton's method (F. L. Litvin, A. Fuentes, *Gear Geometry and Applied Theory*,
//! chapters 6 and 9). Nothing of it is shared with the code under test: no involute, no base circle.
//!
//! The rack stands at `x = r`, its plane has the unit normal `n`, turned from that of the basic rack by the helix angle about
//! the normal of its pitch plane and by the profile-shift angle about the rolling motion. While it moves by `r phi` along
//! `y`, the gear turns by `phi`; a point `x` of the plane is on the flank where `n . (r y - z x x) = 0`.

use gearbench_models::Vec3;
use gearbench_models::geometry::{Frame, Gear, Side};
use nalgebra::{Rotation3, SMatrix, SVector};

/// An enveloped flank with its removed material.
pub struct EnvelopedFlank {
    normal: Vec3,
    through: Vec3,
    radius: f64,
    /// Crowning over the face width and its half [m].
    lead: (f64, f64),
    /// Crowning over the profile [m], rolls of the base circle at form circle and tip [m], base radius and slope of the tip.
    profile: (f64, [f64; 2], f64, f64),
}

impl EnvelopedFlank {
    pub fn new(gear: &Gear, side: Side) -> Self {
        let p = gear.params();
        let sigma = side.sign();
        let (sin, cos) = p.pressure_angle.sin_cos();
        let tilted = Rotation3::from_axis_angle(&Vec3::y_axis(), p.profile_shift_angle);
        let askew = Rotation3::from_axis_angle(&Vec3::x_axis(), -p.helix_angle);
        let radius = 0.5 * f64::from(p.teeth) * p.module / p.helix_angle.cos();
        let half = 0.25 * std::f64::consts::PI * p.module / p.helix_angle.cos() - 0.5 * p.thinning;
        EnvelopedFlank {
            normal: tilted * askew * Vec3::new(sin, sigma * cos, 0.0),
            through: Vec3::new(radius + p.profile_shift * p.module, sigma * half, 0.0),
            radius,
            lead: (p.modifications.lead_crowning, 0.5 * p.face_width),
            profile: (
                p.modifications.profile_crowning,
                [gear.roll_length_form(), gear.roll_length_tip()],
                gear.r_base(),
                p.tip_cone_angle.tan(),
            ),
        }
    }

    /// Returns the point that the rack generates at a rotation and a height, in the axes of the gear with the tooth at
    /// the angle zero, and the outward normal of the rack there.
    fn cut(&self, turn: f64, height: f64) -> (Vec3, Vec3) {
        let n = &self.normal;
        let along = n.dot(&self.through) + n.y * self.radius * turn - n.z * height;
        let across = n.y * self.radius;
        let square = n.x * n.x + n.y * n.y;
        let x = Vec3::new(
            (n.x * along + n.y * across) / square,
            (n.y * along - n.x * across) / square,
            height,
        );
        let back = Rotation3::from_axis_angle(&Vec3::z_axis(), -turn);
        (back * x, back * n)
    }

    /// Returns the generated point with the removed material of modifications.
    pub fn point(&self, turn: f64, height: f64) -> Vec3 {
        let (x, n) = self.cut(turn, height);
        let (lead, half) = self.lead;
        let (profile, [form, tip], base, slope) = self.profile;
        let radius = x.x.hypot(x.y) - slope * height;
        let roll = (radius * radius - base * base).sqrt();
        let place = (2.0 * roll - form - tip) / (tip - form);
        let removed = lead * (height / half).powi(2) + profile * place * place;
        x - removed * n
    }

    /// Returns the ratio of the radius to that of the tip cone, and of the height to half the face: below one on the
    /// flank.
    pub fn beyond(&self, gear: &Gear, turn: f64, height: f64) -> [f64; 2] {
        let x = self.point(turn, height);
        [
            x.x.hypot(x.y) / gear.r_tip_at(height),
            (height / self.lead.1).abs(),
        ]
    }

    /// Returns the point in space, for a tooth at an angle, and its outward unit normal by differences.
    fn placed(&self, frame: &Frame, psi: f64, [turn, height]: [f64; 2]) -> (Vec3, Vec3) {
        let turned = Rotation3::from_axis_angle(&Vec3::z_axis(), psi);
        let at = |turn: f64, height: f64| frame.point(&(turned * self.point(turn, height)));
        let (h, w) = (1e-4, 1e-4);
        let by_turn = (at(turn + h, height) - at(turn - h, height)) / (2.0 * h);
        let by_height = (at(turn, height + w) - at(turn, height - w)) / (2.0 * w);
        let normal = by_turn.cross(&by_height).normalize();
        let (_, outward) = self.cut(turn, height);
        let outward = frame.turn(&(turned * outward));
        (at(turn, height), normal * normal.dot(&outward).signum())
    }
}

/// Contact of two flanks: rotations and heights on both, and the angle of the second tooth.
pub struct Contact {
    pub place: [[f64; 2]; 2],
    pub psi: f64,
}

/// Finds the angle of the second tooth at which the flanks touch, from a nearby start; the residual has to vanish.
pub fn touch(
    flanks: [&EnvelopedFlank; 2],
    frames: [&Frame; 2],
    psi: f64,
    start: Contact,
) -> Option<Contact> {
    let residual = |x: &SVector<f64, 5>| {
        let (p, n) = flanks[0].placed(frames[0], psi, [x[0], x[1]]);
        let (q, m) = flanks[1].placed(frames[1], x[4], [x[2], x[3]]);
        let apart = q - p;
        // Normals are opposite: their sum vanishes; two directions across the first are enough.
        let [e, f] = [n.cross(&Vec3::z()).normalize(), n.cross(&Vec3::x())];
        let sum = n + m;
        SVector::<f64, 5>::new(apart.x, apart.y, apart.z, e.dot(&sum), f.dot(&sum))
    };
    let [a, b] = start.place;
    let mut x = SVector::<f64, 5>::new(a[0], a[1], b[0], b[1], start.psi);
    let sizes = [1e-5, 1e-5, 1e-5, 1e-5, 1e-6];
    for _ in 0..60 {
        let here = residual(&x);
        let mut jacobian = SMatrix::<f64, 5, 5>::zeros();
        for (k, h) in sizes.iter().enumerate() {
            let (mut up, mut down) = (x, x);
            up[k] += h;
            down[k] -= h;
            jacobian.set_column(k, &((residual(&up) - residual(&down)) / (2.0 * h)));
        }
        let mut step = jacobian.lu().solve(&here)?;
        let longest = (step[0].abs() / 0.05)
            .max(step[2].abs() / 0.05)
            .max(step[1].abs() / 0.02);
        step /= longest.max(step[3].abs() / 0.02).max(1.0);
        x -= step;
        if step.norm() < 1e-12 {
            break;
        }
    }
    let left = residual(&x);
    (left.norm() < 1e-10).then_some(Contact {
        place: [[x[0], x[1]], [x[2], x[3]]],
        psi: x[4],
    })
}
