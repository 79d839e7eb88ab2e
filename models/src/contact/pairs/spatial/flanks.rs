//! Flanks as distances: involute helicoids with what is removed from them, and the planes of racks.

use crate::Vec3;
use crate::geometry::{Gear, Rack, Side};
use std::f64::consts::{PI, TAU};

/// A flank of a tooth at the angle zero (place zero of a rack), in the axes of its hub.
#[derive(Clone, Debug)]
pub enum FlankForm {
    /// An involute helicoid.
    Involute(Box<Helicoid>),
    /// The plane of a rack.
    Plane(Plane),
}

/// An involute helicoid and what is removed from it.
#[derive(Clone, Debug)]
pub struct Helicoid {
    gear: Gear,
    pub(super) base_radius: f64,
    pub(super) tan_helix: f64,
    pub(super) cos_helix: f64,
    half_angle: f64,
    pub(super) tip: f64,
    pub(super) modified: bool,
}

/// The flank of a rack.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    pub(super) tan_pressure: f64,
    pub(super) tan_helix: f64,
    /// Distance over the distance along the slide.
    pub(super) cos: f64,
    pub(super) half_thickness: f64,
    pub(super) tip: f64,
}

/// A point near a flank.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// Distance along the normal, outward positive, removed material included [m].
    pub(super) distance: f64,
    /// Its gradient, in the axes of the hub.
    pub(super) gradient: Vec3,
    /// Length of roll [m] (height over the reference line of a rack), and the base radius through the tangent point.
    pub(super) roll: f64,
    pub(super) base: Vec3,
}

/// Angle in (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    if angle.abs() <= PI {
        angle
    } else {
        angle - TAU * (angle / TAU).round()
    }
}

impl Helicoid {
    /// Of a gear.
    pub fn new(gear: &Gear) -> Self {
        let helix = gear.base_helix_angle();
        Helicoid {
            base_radius: gear.r_base(),
            tan_helix: helix.tan(),
            cos_helix: helix.cos(),
            half_angle: gear.half_angle_base(),
            tip: gear.roll_length_tip(),
            modified: !gear.params().modifications.is_none() || gear.deviates(),
            gear: gear.clone(),
        }
    }

    /// Material removed at a roll and height [m], and its slopes.
    pub(super) fn removed(&self, tooth: i64, side: Side, roll: f64, z: f64) -> [f64; 3] {
        if !self.modified {
            return [0.0; 3];
        }
        let half = 0.5 * self.gear.face_width();
        let of = |roll: f64, z: f64| {
            let radius = self.base_radius.hypot(roll);
            self.gear.flank_deviation(side, radius, z / half)
        };
        // Second differences of smooth modifications are exact enough at a thousandth of their lengths.
        let (h, w) = (1e-4 * self.tip, 1e-3 * half);
        let [own, slope, _] = self.gear.tooth_deviation_at_roll(tooth, side, roll);
        [
            of(roll, z) + own,
            0.5 * (of(roll + h, z) - of(roll - h, z)) / h + slope,
            0.5 * (of(roll, z + w) - of(roll, z - w)) / w,
        ]
    }

    /// The point of the transverse section at `z`, and the direction of its base radius.
    pub(super) fn point(&self, side: Side, psi: f64, roll: f64, z: f64) -> (Vec3, Vec3) {
        let sigma = side.sign();
        let rb = self.base_radius;
        let tau = psi + z * self.tan_helix / rb + sigma * (self.half_angle - roll / rb);
        let (sin, cos) = tau.sin_cos();
        let along = sigma * roll;
        let x = Vec3::new(rb * cos - along * sin, rb * sin + along * cos, z);
        (x, Vec3::new(cos, sin, 0.0))
    }

    /// The same without the distance, which takes most of the time.
    pub(super) fn directed(&self, side: Side, p: &Vec3) -> Near {
        let (sigma, rb) = (side.sign(), self.base_radius);
        let square = p.x * p.x + p.y * p.y;
        let roll = (square - rb * rb).max(0.0).sqrt();
        let (c, s) = (
            (rb * p.x + sigma * roll * p.y) / square,
            (rb * p.y - sigma * roll * p.x) / square,
        );
        Near {
            distance: 0.0,
            gradient: sigma * self.cos_helix * Vec3::new(-s, c, -self.tan_helix),
            roll,
            base: Vec3::new(c, s, 0.0),
        }
    }

    pub(super) fn near(&self, (tooth, side, psi): (i64, Side, f64), p: &Vec3, exact: bool) -> Near {
        let (sigma, rb) = (side.sign(), self.base_radius);
        let mut near = self.directed(side, p);
        let roll = near.roll;
        let ahead = psi + p.z * self.tan_helix / rb - near.base.y.atan2(near.base.x);
        let angle = wrapped(ahead - sigma * (roll / rb - self.half_angle));
        near.distance = -sigma * rb * angle * self.cos_helix;
        if exact && self.modified && roll > 0.0 {
            let [e, by_roll, by_z] = self.removed(tooth, side, roll, p.z);
            near.distance += e;
            near.gradient += Vec3::new(by_roll * p.x / roll, by_roll * p.y / roll, by_z);
        }
        near
    }
}

impl Plane {
    /// Of a rack.
    pub fn new(rack: &Rack, tip: f64) -> Self {
        let (alpha, helix) = (rack.transverse_pressure_angle(), rack.base_helix_angle());
        Plane {
            tan_pressure: alpha.tan(),
            // Seen from the teeth a right-handed rack leans back along its slide.
            tan_helix: -helix.tan() / alpha.cos(),
            cos: alpha.cos() * helix.cos(),
            half_thickness: rack.half_thickness_reference(),
            tip,
        }
    }

    pub(super) fn near(&self, side: Side, psi: f64, p: &Vec3) -> Near {
        let sigma = side.sign();
        let off = p.x - psi - p.z * self.tan_helix;
        let distance = -sigma * off - self.half_thickness + p.y * self.tan_pressure;
        let gradient = Vec3::new(-sigma, self.tan_pressure, sigma * self.tan_helix);
        Near {
            distance: self.cos * distance,
            gradient: self.cos * gradient,
            roll: p.y,
            base: Vec3::zeros(),
        }
    }
}

impl FlankForm {
    pub(super) fn near(&self, tooth: (i64, Side, f64), p: &Vec3, exact: bool) -> Near {
        match self {
            FlankForm::Involute(helicoid) => helicoid.near(tooth, p, exact),
            FlankForm::Plane(plane) => plane.near(tooth.1, tooth.2, p),
        }
    }

    pub(super) fn is_modified(&self) -> bool {
        matches!(self, FlankForm::Involute(h) if h.modified)
    }

    /// Whether a length of roll (height) lies beyond the tip.
    pub(super) fn is_beyond(&self, roll: f64) -> bool {
        match self {
            FlankForm::Involute(h) => roll > h.tip,
            FlankForm::Plane(p) => roll > p.tip,
        }
    }
}
