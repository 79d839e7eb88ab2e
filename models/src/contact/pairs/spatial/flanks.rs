//! Distance functions of flanks: involute helicoids with removed material, and the planes of racks.

use crate::Vec3;
use crate::contact::pairs::lines::side_index;
use crate::geometry::{FlankDistance, Gear, InvoluteHelicoid, PlaneAngle, Rack, Side};

/// Half-length over which kinks of modifications are rounded, relative to the length of roll at the tip and to the
/// face width.
const ROUNDED: f64 = 1e-4;
const ROUNDED_OVER_WIDTH: f64 = 5e-4;

/// Flank of a tooth at the angle zero (position zero of a rack), in the axes of its hub.
#[derive(Clone, Debug)]
pub enum FlankForm {
    /// An involute helicoid with removed material.
    Involute(Box<Helicoid>),
    /// The plane flank of a rack.
    Plane(Plane),
}

/// Involute helicoids of the left and right flanks of a gear, with their extent and the removed material.
#[derive(Clone, Debug)]
pub struct Helicoid {
    gear: Gear,
    flanks: [InvoluteHelicoid; 2],
    tips: [f64; 2],
    tip_slope: f64,
    pub(super) modified: bool,
    /// True if all teeth have the same modifications.
    of_all: bool,
    /// Inverses of the base radii [1/m].
    per_base: [f64; 2],
}

/// Plane flank of a rack.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    pub(super) tan_pressure: f64,
    pub(super) tan_helix: f64,
    /// Ratio of the distance to the displacement along the motion of the rack.
    pub(super) cos: f64,
    pub(super) half_thickness: f64,
    pub(super) tip: f64,
}

impl Helicoid {
    /// Builds the flanks of a gear.
    pub fn new(gear: &Gear) -> Self {
        Helicoid {
            flanks: Side::BOTH.map(|side| *gear.flank(side)),
            tips: Side::BOTH.map(|side| gear.roll_length_tip_at(side, 0.0)),
            tip_slope: gear.params().tip_cone_angle.tan(),
            modified: !gear.params().modifications.is_none() || gear.deviates(),
            per_base: Side::BOTH.map(|side| gear.flank(side).base_radius.recip()),
            of_all: !gear.params().modifications.is_none(),
            gear: gear.clone(),
        }
    }

    /// Returns the helicoid of a side.
    #[inline]
    pub(super) fn flank(&self, side: Side) -> &InvoluteHelicoid {
        &self.flanks[side_index(side)]
    }

    /// Returns the inverse of the base radius of a side [1/m].
    #[inline]
    pub(super) fn per_base(&self, side: Side) -> f64 {
        self.per_base[side_index(side)]
    }

    /// Returns the length of roll at the tip, at a height.
    #[inline]
    pub(super) fn tip(&self, side: Side, z: f64) -> f64 {
        if self.tip_slope == 0.0 {
            self.tips[side_index(side)]
        } else {
            self.gear.roll_length_tip_at(side, z)
        }
    }

    /// Returns the derivative of the length of roll at the tip by the height.
    pub(super) fn tip_rise(&self, side: Side, z: f64) -> f64 {
        self.tip_slope * self.gear.r_tip_at(z) / self.tip(side, z)
    }

    /// Returns true if the removed material has no kink near a length of roll at a height [m]. Closed-form slopes are
    /// valid there.
    #[inline]
    pub(super) fn is_smooth(&self, side: Side, roll: f64, z: f64) -> bool {
        let near = 2.0 * ROUNDED * self.tips[side_index(side)];
        !self.of_all || !self.gear.flank_kinks(side, roll, z, near)
    }

    /// Returns the removed material of a tooth at a length of roll and height [m], its first and second derivative by
    /// the length of roll and its derivative by the height. On conical gears modifications follow the tip cone. Kinks
    /// are rounded: slopes near them are finite differences, so that the direction of the force is continuous.
    #[inline]
    pub(super) fn removed(&self, tooth: i64, side: Side, roll: f64, z: f64) -> [f64; 4] {
        if !self.modified {
            return [0.0; 4];
        }
        let of_all = |roll: f64, z: f64| self.gear.flank_deviation_at_roll(side, roll, z);
        let mut removed = match self.of_all {
            true => of_all(roll, z),
            false => [0.0; 4],
        };
        if !self.is_smooth(side, roll, z) {
            let h = ROUNDED * self.tips[side_index(side)];
            let w = ROUNDED_OVER_WIDTH * self.gear.face_width();
            removed[1] = 0.5 * (of_all(roll + h, z)[0] - of_all(roll - h, z)[0]) / h;
            removed[3] = 0.5 * (of_all(roll, z + w)[0] - of_all(roll, z - w)[0]) / w;
        }
        let own = self.gear.tooth_deviation_at_roll(tooth, side, roll);
        removed.iter_mut().zip(own).for_each(|(r, own)| *r += own);
        removed
    }
}

impl Plane {
    /// Builds the flank of a rack.
    pub fn new(rack: &Rack, tip: f64) -> Self {
        let (alpha, helix) = (rack.transverse_pressure_angle(), rack.base_helix_angle());
        Plane {
            tan_pressure: alpha.tan(),
            // Viewed from the teeth, a right-handed rack is inclined backwards along its slide.
            tan_helix: -helix.tan() / alpha.cos(),
            cos: alpha.cos() * helix.cos(),
            half_thickness: rack.half_thickness_reference(),
            tip,
        }
    }

    /// Returns the tip edge at a height, and its tangent.
    pub(super) fn edge(&self, side: Side, psi: f64, height: f64) -> (Vec3, Vec3) {
        let off = side.sign() * (self.half_thickness - self.tip * self.tan_pressure);
        let along = psi + height * self.tan_helix - off;
        (
            Vec3::new(along, self.tip, height),
            Vec3::new(self.tan_helix, 0.0, 1.0),
        )
    }

    pub(super) fn near(&self, side: Side, psi: f64, p: &Vec3) -> FlankDistance {
        let sigma = side.sign();
        let off = p.x - psi - p.z * self.tan_helix;
        let distance = -sigma * off - self.half_thickness + p.y * self.tan_pressure;
        let gradient = Vec3::new(-sigma, self.tan_pressure, sigma * self.tan_helix);
        FlankDistance {
            distance: self.cos * distance,
            gradient: self.cos * gradient,
            roll: p.y,
            base: PlaneAngle {
                angle: 0.0,
                cos: 1.0,
                sin: 0.0,
            },
        }
    }
}

impl FlankForm {
    pub(super) fn is_modified(&self) -> bool {
        matches!(self, FlankForm::Involute(h) if h.modified)
    }

    /// Returns the largest protrusion of a flank beyond its involute [m].
    pub(super) fn stands_out(&self) -> f64 {
        match self {
            FlankForm::Involute(h) => h.gear.stands_out(),
            FlankForm::Plane(_) => 0.0,
        }
    }

    /// Returns true if a length of roll (for a rack a height) lies beyond the tip at a height of the gear.
    pub(super) fn is_beyond(&self, side: Side, roll: f64, z: f64) -> bool {
        match self {
            FlankForm::Involute(h) => roll > h.tip(side, z),
            FlankForm::Plane(p) => roll > p.tip,
        }
    }
}
