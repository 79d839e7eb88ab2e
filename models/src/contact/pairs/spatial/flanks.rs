//! Flanks as distances: involute helicoids with what is removed from them, and the planes of racks.

use crate::Vec3;
use crate::contact::pairs::lines::side_index;
use crate::geometry::{Frame, Gear, InvoluteHelicoid, Near, Rack, Side};

/// A flank of a tooth at the angle zero (place zero of a rack), in the axes of its hub.
#[derive(Clone, Debug)]
pub enum FlankForm {
    /// An involute helicoid.
    Involute(Box<Helicoid>),
    /// The plane of a rack.
    Plane(Plane),
}

/// The involute helicoids of the left and right flanks of a gear, how far they go, and what is removed from them.
#[derive(Clone, Debug)]
pub struct Helicoid {
    gear: Gear,
    flanks: [InvoluteHelicoid; 2],
    tips: [f64; 2],
    tip_slope: f64,
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

impl Helicoid {
    /// Of a gear.
    pub fn new(gear: &Gear) -> Self {
        Helicoid {
            flanks: Side::BOTH.map(|side| *gear.flank(side)),
            tips: Side::BOTH.map(|side| gear.roll_length_tip_at(side, 0.0)),
            tip_slope: gear.params().tip_cone_angle.tan(),
            modified: !gear.params().modifications.is_none() || gear.deviates(),
            gear: gear.clone(),
        }
    }

    /// The flank of a side.
    #[inline]
    pub(super) fn flank(&self, side: Side) -> &InvoluteHelicoid {
        &self.flanks[side_index(side)]
    }

    /// Length of roll at the tip, at a height.
    #[inline]
    pub(super) fn tip(&self, side: Side, z: f64) -> f64 {
        if self.tip_slope == 0.0 {
            self.tips[side_index(side)]
        } else {
            self.gear.roll_length_tip_at(side, z)
        }
    }

    /// Change of that length over the height.
    pub(super) fn tip_rise(&self, side: Side, z: f64) -> f64 {
        self.tip_slope * self.gear.r_tip_at(z) / self.tip(side, z)
    }

    /// Material removed at a roll and height [m], and its slopes. On conical gears modifications follow the tip cone.
    pub(super) fn removed(&self, tooth: i64, side: Side, roll: f64, z: f64) -> [f64; 3] {
        if !self.modified {
            return [0.0; 3];
        }
        let half = 0.5 * self.gear.face_width();
        let base_radius = self.flank(side).base_radius;
        let of = |roll: f64, z: f64| {
            let radius = base_radius.hypot(roll);
            self.gear.flank_deviation_at(side, radius, z)
        };
        // Second differences of smooth modifications are exact enough at a thousandth of their lengths.
        let (h, w) = (1e-4 * self.tips[side_index(side)], 1e-3 * half);
        let [own, slope, _] = self.gear.tooth_deviation_at_roll(tooth, side, roll);
        [
            of(roll, z) + own,
            0.5 * (of(roll + h, z) - of(roll - h, z)) / h + slope,
            0.5 * (of(roll, z + w) - of(roll, z - w)) / w,
        ]
    }

    pub(super) fn near(&self, (tooth, side, psi): (i64, Side, f64), p: &Vec3, exact: bool) -> Near {
        let mut near = self.flank(side).near(psi, p);
        let roll = near.roll;
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

    /// Height of the gear at a point in space; nothing depends on that of a rack.
    pub(super) fn height(&self, frame: &Frame, x: &Vec3) -> f64 {
        match self {
            FlankForm::Involute(h) if h.tip_slope != 0.0 => frame.point_back(x).z,
            _ => 0.0,
        }
    }

    pub(super) fn is_modified(&self) -> bool {
        matches!(self, FlankForm::Involute(h) if h.modified)
    }

    /// Whether a length of roll (height) at a height of the gear lies beyond the tip.
    pub(super) fn is_beyond(&self, side: Side, roll: f64, z: f64) -> bool {
        match self {
            FlankForm::Involute(h) => roll > h.tip(side, z),
            FlankForm::Plane(p) => roll > p.tip,
        }
    }
}
