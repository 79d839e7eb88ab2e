//! The gears of a pair in their frames, and the nearest points of a section of one to the other.

use super::super::Side;
use super::super::conical::ConicalError;
use super::super::error::GeometryError;
use super::super::frame::Frame;
use super::super::gear::Gear;
use super::super::helicoid::{InvoluteHelicoid, PlaneAngle};
use crate::Vec3;

/// Largest number of corrections of the length of roll of the nearest point of a section.
const MOST_CORRECTIONS: usize = 60;

/// One of the gears in its frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    pub(super) flanks: [InvoluteHelicoid; 2],
    pub(super) frame: Frame,
    /// Direction to the mate in its axes [rad].
    pub(super) towards: f64,
    pub(super) r_base: f64,
    pub(super) cos_helix: f64,
    pub(super) pitch: f64,
    pub(super) half_angle: f64,
    pub(super) r_tip: f64,
    pub(super) tip_slope: f64,
}

/// Nearest point of a section to the mate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// Lengths of roll of both gears [m].
    pub(super) roll: [f64; 2],
    /// Heights of both gears [m].
    pub(super) height: [f64; 2],
    pub(super) distance: f64,
    /// Derivative of the distance by the height.
    pub(super) rise: f64,
}

impl Member {
    pub(super) fn new(gear: &Gear, frame: Frame, to_mate: Vec3) -> Self {
        Member {
            flanks: Side::BOTH.map(|side| *gear.flank(side)),
            frame,
            towards: (frame.axes[1].dot(&to_mate)).atan2(frame.axes[0].dot(&to_mate)),
            r_base: gear.r_base(),
            cos_helix: gear.base_helix_angle().cos(),
            pitch: gear.pitch_angle(),
            half_angle: gear.half_angle_base(),
            r_tip: gear.r_tip(),
            tip_slope: gear.params().tip_cone_angle.tan(),
        }
    }
}

/// Finds the nearest point of a transverse section of gear `own` to its mate, with teeth at `angles` [rad], by
/// Newton's method for the point whose base radius is perpendicular to the normal of the mate.
pub(super) fn nearest(
    members: &[Member; 2],
    angles: [f64; 2],
    (own, side): (usize, Side),
    height: f64,
) -> Nearest {
    let (i, other) = (index(side), 1 - own);
    let [of_own, of_mate] = [own, other].map(|k| &members[k].flanks[i]);
    let [psi, psi_mate] = [own, other].map(|k| angles[k]);
    let [frame, frame_mate] = [own, other].map(|k| &members[k].frame);
    let rb = of_own.base_radius;
    let mut roll = 0.4 * rb;
    let mut found = Nearest {
        roll: [0.0; 2],
        height: [height; 2],
        distance: f64::INFINITY,
        rise: 0.0,
    };
    let mut of_mates_base = PlaneAngle::new(0.0);
    for _ in 0..MOST_CORRECTIONS {
        let base = of_own.base(psi, roll, height);
        let p = of_own.point(&base, roll, height);
        let place = frame_mate.point_back(&frame.point(&p));
        let near = of_mate.near(psi_mate, &place, &of_mates_base);
        of_mates_base = near.base;
        found.roll[own] = roll;
        found.roll[other] = near.roll - near.distance / of_mate.cos_helix;
        found.height[other] = place.z;
        found.distance = near.distance;
        let normal = frame_mate.turn(&near.gradient);
        let twist = of_own.tan_helix / rb;
        let upwards = frame.turn(&Vec3::new(-twist * p.y, twist * p.x, 1.0));
        found.rise = upwards.dot(&normal);
        let base = Vec3::new(base.cos, base.sin, 0.0);
        let slope = frame.turn(&base).dot(&normal);
        let bend = of_mate.cos_helix * (1.0 + roll / near.roll.max(0.01 * rb)) / rb;
        let step = -slope / bend;
        roll = (roll + step).clamp(0.01 * rb, 3.0 * rb);
        if step.abs() < 1e-11 * rb {
            break;
        }
    }
    found
}

pub(super) fn index(side: Side) -> usize {
    usize::from(side == Side::Right)
}

/// Returns the middle of the common face width from the middles of both, and its size [m].
pub(super) fn common_face(
    gears: [&Gear; 2],
    members: &[Member; 2],
) -> Result<([f64; 2], f64), GeometryError> {
    let [a, b] = members;
    let apart = (b.frame.origin - a.frame.origin).norm();
    // Where the middle of each face comes nearest to the mate.
    let front = |m: &Member| {
        let (sin, cos) = m.towards.sin_cos();
        let radius = apart * m.r_base / (a.r_base + b.r_base);
        m.frame.point(&Vec3::new(radius * cos, radius * sin, 0.0))
    };
    let up = |m: &Member, x: &Vec3| m.frame.point_back(x).z;
    let offset = 0.5 * (up(a, &front(b)) - up(b, &front(a)));
    let half = gears.map(|g| 0.5 * g.face_width());
    let (low, high) = (
        (-half[0]).max(offset - half[1]),
        half[0].min(offset + half[1]),
    );
    if high <= low {
        return Err(GeometryError::Conical(ConicalError::FacesApart { offset }));
    }
    let middle = 0.5 * (low + high);
    Ok(([middle, middle - offset], high - low))
}
