//! Contact between flanks of gears whose axes are not parallel, or whose hubs move out of the plane: nearest points of
//! the slices of a pair.
//!
//! Each side of the teeth of a gear is an [involute helicoid](crate::geometry::InvoluteHelicoid), whose distance `D` from a
//! point is known in closed form; those of both sides differ on conical gears.
//!
//! A slice is the transverse section of one gear, the **sliced** one, at a height `z`; its curve is an involute over `rho_1`.
//! The gap of a slice is the least distance of its points from the mate's flank, what modifications remove included:
//!
//! ```text
//! g = min over rho_1 of  D_2(x_1(rho_1)) + e_1(rho_1) + e_2(rho_2(x_1)),     rho_1 <= rho_tip
//! ```
//!
//! or, where the least distance lies beyond the mate's tip, the distance of the mate's tip edge in the plane of the slice. As
//! the derivatives by `rho_1` vanish, or its end is fixed, `dg = -n . (v_1 - v_2)` at the contact point: forces on both gears
//! are one wrench, whatever the axes, so that momentum is kept and energy follows the gap. For parallel axes the gap is
//! that of the [lines of action](super::LinesOfAction).
//!
//! The path coordinate `s = (rho_a + L - rho_b)/2`, with the roll of the foot of `x_1` on the mate, moves with the mate's
//! velocity `v` at `x_1` and spin `w` over the sliced gear, `e` the base radii through the tangent points, `a` the axes:
//!
//! ```text
//! F = e_1 . n_2 = 0,    F_rho = -sigma (a_1 x e_1) . n_2 / r_b1 + cos(beta_2) (e_1 . e_2)^2 rho_1/(r_b1 rho_2)
//! d rho_1 = (w . (e_1 x n_2) + cos(beta_2) (e_1 . e_2)/rho_2 e_2 . v) / F_rho
//! d rho_2 = (r_b2/rho_2 e_2 + sigma a_2 x e_2) . e_1 rho_1/r_b1 d rho_1 - (r_b2/rho_2 e_2 + sigma tan(beta_2) a_2) . v
//! ```

mod flanks;
mod section;
#[cfg(test)]
mod tests;

use super::lines::{Line, LinesOfAction, MeshedGears, PairState, PointDerivatives, side_index};
use crate::Vec3;
use crate::geometry::{Frame, PlaneAngle, Side};
use crate::kinematics::{HubFrame, PointWrench};
pub use flanks::{FlankForm, Helicoid, Plane};
use section::{Section, SectionPoint};
use std::cell::Cell;

/// Gap relative to the base pitch above which one evaluation is enough, because no contact is possible.
const FAR: f64 = 5e-3;

/// Smallest length of roll relative to the base pitch: nearer to the base circle flanks are not evaluated.
const LEAST_ROLL: f64 = 0.01;

/// Number of pairs of a side whose last nearest points are stored, enough for contact ratios below three.
const KEPT: usize = 4;

/// Nearest points of the flanks of a slice.
#[derive(Clone, Copy, Debug)]
pub struct NearestPoints {
    /// Gap [m]; for distant pairs a lower bound without the removed material.
    pub gap: f64,
    /// Contact point [m].
    pub x: Vec3,
    /// Normal of the gap, `dg = -n . (v_a - v_b)`; a unit vector on plain flanks.
    pub normal: Vec3,
    /// Lengths of roll of both flanks, continued beyond their tips [m].
    pub roll: [f64; 2],
    /// Derivative of the path coordinate, `ds = f . v + m . w` with the velocity `v` at the contact point and the
    /// angular velocity `w` of gear b relative to gear a; zero where it is not needed.
    pub path: [Vec3; 2],
    /// Derivatives of both lengths of roll by the motion of gear b relative to gear a; zero where they are not needed.
    pub rolls: [PointWrench; 2],
}

/// Flanks of a mesh in space.
#[derive(Clone, Debug)]
pub struct Spatial {
    /// Flanks of both gears.
    flanks: [FlankForm; 2],
    /// Index of the gear whose transverse sections the slices are; never a rack.
    sliced: usize,
    /// Distance between the tangent points [m].
    length: f64,
    /// Path coordinate per length of roll of both gears, on left and right flanks.
    roll_scale: [[f64; 2]; 2],
    /// Base pitch [m].
    base_pitch: f64,
    /// Angle (position of a rack) of tooth 0 of both gears at the assembled position.
    phases: [f64; 2],
    /// Largest protrusion of the flanks beyond their involutes [m], and the distance of unmodified flanks above which
    /// a pair is open by [`FAR`] all the same.
    stands_out: f64,
    far: f64,
    /// Number of evaluated distances between a point of a section and the mate.
    evaluated: Cell<u64>,
}

/// Geometry of a mesh whose flanks may touch anywhere in space.
#[derive(Clone, Debug)]
pub struct SpatialGeometry {
    /// Flanks of both gears.
    pub flanks: [FlankForm; 2],
    /// Index of the gear whose transverse sections the slices are; never a rack.
    pub sliced: usize,
    /// Distance between the tangent points [m].
    pub length: f64,
    /// Path coordinate per length of roll of both gears, on left and right flanks.
    pub roll_scale: [[f64; 2]; 2],
    /// Base pitch [m].
    pub base_pitch: f64,
    /// Angle (position of a rack) of tooth 0 of both gears at the assembled position.
    pub phases: [f64; 2],
}

/// Hub poses of both gears at a state, and the nearest points found at it so far, which start the searches of
/// neighbouring slices.
#[derive(Debug)]
pub(super) struct MeshPose {
    /// Hub of the mate of the sliced gear, in space.
    mate: HubFrame,
    /// Hub of the sliced gear in the axes of the mate's.
    sliced: Frame,
    /// Base radii at the nearest points of pairs of left and right flanks, in the axes of the sliced gear and of its
    /// mate. The last entry of a side is the most recent result.
    found: [[Cell<Option<[PlaneAngle; 2]>>; KEPT + 1]; 2],
    /// Smallest distance of all pairs of left and right flanks [m]; `None` until it is needed.
    least: [Cell<Option<f64>>; 2],
}

impl Spatial {
    /// Creates the search from the geometry of a mesh.
    pub fn new(of: SpatialGeometry) -> Self {
        let stands_out: f64 = of.flanks.iter().map(FlankForm::stands_out).sum();
        Spatial {
            stands_out,
            far: FAR * of.base_pitch + stands_out,
            flanks: of.flanks,
            sliced: of.sliced,
            length: of.length,
            roll_scale: of.roll_scale,
            base_pitch: of.base_pitch,
            phases: of.phases,
            evaluated: Cell::new(0),
        }
    }

    /// Returns the hub poses of both gears at a state.
    pub(super) fn pose(&self, hubs: [&HubFrame; 2]) -> MeshPose {
        let [sliced, mate] = [self.sliced, 1 - self.sliced].map(|k| hubs[k]);
        MeshPose {
            mate: *mate,
            sliced: Frame {
                axes: sliced.axes.map(|axis| mate.turn_back(&axis)),
                origin: mate.point_back(&sliced.origin),
            },
            found: Default::default(),
            least: Default::default(),
        }
    }

    /// Returns the tip radius of the sliced gear [m].
    fn tip_radius(&self, side: Side) -> f64 {
        let own = self.sliced_flanks();
        own.tip(side, 0.0).hypot(own.flank(side).base_radius)
    }

    /// Returns the number of evaluated distances.
    pub(super) fn evaluated(&self) -> u64 {
        self.evaluated.get()
    }

    fn sliced_flanks(&self) -> &Helicoid {
        match &self.flanks[self.sliced] {
            FlankForm::Involute(own) => own,
            FlankForm::Plane(_) => unreachable!("a rack is never the sliced gear"),
        }
    }

    /// Returns the slice at the height `z` of the sliced gear, from teeth and angles of gear a and gear b.
    #[inline]
    fn section<'a>(
        &'a self,
        side: Side,
        z: f64,
        pose: &'a MeshPose,
        teeth: [(i64, f64); 2],
    ) -> Section<'a> {
        let own = self.sliced_flanks();
        Section {
            own,
            flank: own.flank(side),
            mate: &self.flanks[1 - self.sliced],
            side,
            z,
            tooth: teeth[self.sliced],
            of_mate: teeth[1 - self.sliced],
            hub: &pose.sliced,
            middle: pose.sliced.origin + z * pose.sliced.axes[2],
            per_base: own.per_base(side),
            evaluated: &self.evaluated,
        }
    }

    /// Returns the point of a section nearest to the mate, for unmodified flanks continued beyond their tips, or a
    /// point that is [`FAR`] from it; `guess` is an approximate length of roll.
    #[inline]
    fn nearest(
        &self,
        section: &Section<'_>,
        pair: i64,
        pose: &MeshPose,
        guess: f64,
    ) -> SectionPoint {
        let least = LEAST_ROLL * self.base_pitch;
        let found = &pose.found[side_index(section.side)];
        let of_pair = &found[pair.rem_euclid(KEPT as i64) as usize];
        let mut place = match of_pair.get().or(found[KEPT].get()) {
            Some([base, around]) => section.along(base, least, &around),
            None => section.at_roll(guess.max(least)),
        };
        section.least(&mut place, [least, f64::INFINITY], self.far, false);
        let bases = Some([place.base, place.near.base]);
        of_pair.set(bases);
        found[KEPT].set(bases);
        place
    }

    /// Returns the nearest points of the flanks of a section, from those of the unmodified flanks.
    #[inline]
    fn touch(
        &self,
        section: &Section<'_>,
        mut place: SectionPoint,
        pose: &MeshPose,
        derivatives: PointDerivatives,
    ) -> NearestPoints {
        let (i, j) = (self.sliced, 1 - self.sliced);
        let (own, mate, side, z) = (section.own, section.mate, section.side, section.z);
        let least = LEAST_ROLL * self.base_pitch;
        let near = &place.near;
        // Roll angle of the foot point on the mate.
        let foot = match mate {
            FlankForm::Involute(h) => near.roll - near.distance / h.flank(side).cos_helix,
            FlankForm::Plane(_) => near.roll - near.distance * near.gradient.y,
        };
        let mut rolls = [0.0; 2];
        rolls[i] = place.roll;
        rolls[j] = match mate {
            FlankForm::Involute(_) => foot,
            FlankForm::Plane(_) => self.length - place.roll,
        };
        let (mut path, mut of_rolls) = ([Vec3::zeros(); 2], [PointWrench::default(); 2]);
        if derivatives != PointDerivatives::Gap {
            let rolls = self.roll_slopes(section, pose, &place);
            match derivatives {
                PointDerivatives::Rolls => of_rolls = self.roll_wrenches(&rolls, pose, &place),
                _ => path = self.path(side, pose, &rolls),
            }
        }
        // The outward normal of the sliced gear points from a to b where that is a.
        let sign = if j == 1 { -1.0 } else { 1.0 };
        let touch = |gap: f64, x: &Vec3, outward: &Vec3| NearestPoints {
            gap,
            x: pose.mate.point(x),
            normal: pose.mate.turn(&(sign * outward)),
            roll: rolls,
            path,
            rolls: of_rolls,
        };
        let plain = !own.modified && !mate.is_modified();
        let tip = own.tip(side, z);
        let beyond = mate.is_beyond(side, foot, place.x.z);
        let inside = place.roll <= tip && !beyond;
        if (plain && inside) || near.distance > self.far {
            return touch(near.distance, &place.x, &near.gradient);
        }
        if beyond {
            let (gap, x, outward) = section.edge_of_mate(&place);
            return touch(gap, &x, &outward);
        }
        section.keep_within(&mut place, [least, tip]);
        section.least(&mut place, [least, tip], self.far, true);
        let [e, ..] = own.removed(section.tooth.0, side, place.roll, z);
        touch(place.near.distance + e, &place.x, &place.near.gradient)
    }

    /// Returns the derivatives of the lengths of roll of the sliced gear and of its mate by the velocity at the point and the
    /// angular velocity of the mate relative to the sliced gear, in the axes of the mate.
    fn roll_slopes(
        &self,
        section: &Section<'_>,
        pose: &MeshPose,
        place: &SectionPoint,
    ) -> [[Vec3; 2]; 2] {
        let (side, near, base) = (section.side, &place.near, &place.direction);
        let sigma = side.sign();
        let outward = sigma * pose.sliced.axes[2].cross(base);
        let normal = &near.gradient;
        let rb = section.own.flank(side).base_radius;
        let turning = -outward.dot(normal) / rb;
        let couple = base.cross(normal);
        let FlankForm::Involute(other) = section.mate else {
            // On a rack the place is that of the gear's own flank.
            let own = [Vec3::zeros(), couple / turning];
            return [own, own.map(|x| -x)];
        };
        let other = other.flank(side);
        let per_roll = place.roll / rb;
        let of_mate = Vec3::new(near.base.cos, near.base.sin, 0.0);
        let (across, roll) = (
            base.dot(&of_mate),
            near.roll.max(LEAST_ROLL * self.base_pitch),
        );
        let bend = other.cos_helix * across / roll;
        let by_roll = turning + bend * across * per_roll;
        let own_roll = [bend / by_roll * of_mate, couple / by_roll];
        // Foot point on the mate, which moves with the point on the sliced gear.
        let outward = sigma * Vec3::new(-near.base.sin, near.base.cos, 0.0);
        let lever = other.base_radius / roll;
        let along = (lever * across + outward.dot(base)) * per_roll;
        let still = lever * of_mate + sigma * other.tan_helix * Vec3::z();
        let foot = [along * own_roll[0] - still, along * own_roll[1]];
        [own_roll, foot]
    }

    /// Returns the derivative of the path coordinate by the motion of gear b relative to gear a, from those of both rolls.
    fn path(&self, side: Side, pose: &MeshPose, [own, mate]: &[[Vec3; 2]; 2]) -> [Vec3; 2] {
        let scale = self.roll_scale[side_index(side)];
        let (of_own, of_mate) = (scale[self.sliced], scale[1 - self.sliced]);
        [0, 1].map(|k| {
            let moves = 0.5 * (of_own * own[k] - of_mate * mate[k]);
            pose.mate.turn(&moves)
        })
    }

    /// Returns the derivatives of the lengths of roll of gear a and gear b by the motion of gear b relative to gear a.
    fn roll_wrenches(
        &self,
        rolls: &[[Vec3; 2]; 2],
        pose: &MeshPose,
        place: &SectionPoint,
    ) -> [PointWrench; 2] {
        let sign = if self.sliced == 0 { 1.0 } else { -1.0 };
        [0, 1].map(|gear| {
            let [force, moment] = &rolls[usize::from(gear != self.sliced)];
            PointWrench {
                point: pose.mate.point(&place.x),
                force: sign * pose.mate.turn(force),
                moment: sign * pose.mate.turn(moment),
            }
        })
    }
}

impl LinesOfAction {
    /// Returns the number of evaluated distances between flanks in space, each a correction of a nearest point; zero
    /// for lines of action.
    pub fn evaluated_places(&self) -> u64 {
        self.spatial
            .as_ref()
            .map_or(0, |spatial| spatial.evaluated())
    }

    /// Returns true if all pairs of a side are open by more than `reach` [m], from the distance of one of them.
    ///
    /// On parallel axes the unmodified flanks of all pairs and slices are equally far from each other, and their nearest places
    /// lie in the plane of action, apart by what their teeth and heights are. Turned to parallel axes about the nearest place of
    /// pair `p`, by the angle `Sigma` between the axes, the mate's distance from a point changes by `sigma = 2 sin(Sigma/2)`
    /// over the point's distance from that place at most (the gradient is a unit vector), and there not at all. The nearest
    /// place of `p` itself moves by `delta <= rho phi`, `cos(beta) sin(phi) = sigma`, since the slope there becomes `sigma` at
    /// most and grows by `cos(beta) cos(phi)/rho` at least; for the same reason no place farther than `delta` from the nearest
    /// one of a pair on parallel axes has a lesser distance for being turned back. With the distance `R` of both on parallel axes
    ///
    /// ```text
    /// d_k >= d_p - sigma (R + 3 delta)
    /// ```
    ///
    /// `p` is nearest to the middle of the zone, and others are a pitch out of it at most: `R` is less than the extent below by
    /// half the zone and one and a half pitches. These cover `sigma/sin(Sigma)`, and tip edges, whose distance from the own
    /// flank is that of the flanks less `sigma tan(beta)` of it at most; a length of roll is less than the tip radius. All of
    /// it holds outside the base cylinders, where flanks are.
    pub(super) fn is_apart(
        &self,
        spatial: &Spatial,
        line: &Line,
        gears: &MeshedGears<'_>,
        reach: f64,
    ) -> bool {
        let pose = gears.pose(spatial);
        let bound = &pose.least[side_index(line.side)];
        if bound.get().is_none() {
            bound.set(Some(self.least_distance(spatial, line.side, gears)));
        }
        bound
            .get()
            .is_some_and(|least| least > spatial.far.max(reach + spatial.stands_out))
    }

    /// Returns the smallest distance of the unmodified flanks of a side, if they are [`FAR`] from each other.
    fn least_distance(&self, spatial: &Spatial, side: Side, gears: &MeshedGears<'_>) -> f64 {
        let mut lines = self.lines.iter().filter(|line| line.side == side);
        let count = self.slices.len();
        let Some(line) = lines.nth(count / 2) else {
            return f64::NEG_INFINITY;
        };
        let [first, last] = [&self.slices[0], &self.slices[count - 1]];
        if first.rolls.is_some() {
            return f64::NEG_INFINITY;
        }
        let pair = self.nearest_to_middle(self.place(line, gears, 0));
        let s = self.both(line, gears, pair);
        let (section, guess) = self.section_of_pair(spatial, line, gears, pair, s);
        let pose = gears.pose(spatial);
        let distance = spatial.nearest(&section, pair, pose, guess).near.distance;
        if distance <= spatial.far {
            return f64::NEG_INFINITY;
        }
        let extent = (last.z - first.z) + (self.zone[1] - self.zone[0]) + 3.0 * spatial.base_pitch;
        let axis = &pose.sliced.axes[2];
        let tilt = axis.x.hypot(axis.y);
        distance - tilt * (extent + 4.0 * tilt * spatial.tip_radius(side))
    }

    /// Returns the slice of a pair and an approximate length of roll of its nearest point, from path coordinates that
    /// determine only the rotation of the teeth.
    #[inline]
    fn section_of_pair<'a>(
        &self,
        spatial: &'a Spatial,
        line: &Line,
        gears: &'a MeshedGears<'_>,
        pair: i64,
        s: [f64; 2],
    ) -> (Section<'a>, f64) {
        let teeth = self.teeth(line.side, pair);
        // Where the maps of the line have teeth turned to.
        let angles = [0, 1].map(|k| {
            let map = &line.map[k];
            let first = self.teeth(line.side, 0)[k].index as f64 * self.mesh.views[k].pitch;
            let turned = (s[k] - map.at_zero) / map.per_displacement - gears.of[k].frame().1;
            (teeth[k].index, spatial.phases[k] + first + turned)
        });
        let slice = &self.slices[line.slice];
        let guess = s[spatial.sliced];
        let maps = slice.rolls.as_ref();
        let guess = maps.map_or(guess, |maps| {
            maps[side_index(line.side)][spatial.sliced].roll(guess)
        });
        (
            spatial.section(line.side, slice.z, gears.pose(spatial), angles),
            guess,
        )
    }

    /// Returns a pair with its teeth, lengths of roll and gap, from path coordinates that determine only the rotation
    /// of the teeth.
    #[inline]
    pub(super) fn pair_in_space(
        &self,
        spatial: &Spatial,
        line: &Line,
        gears: &MeshedGears<'_>,
        pair: i64,
        s: [f64; 2],
    ) -> PairState {
        let (section, guess) = self.section_of_pair(spatial, line, gears, pair, s);
        let pose = gears.pose(spatial);
        let place = spatial.nearest(&section, pair, pose, guess);
        let touch = spatial.touch(&section, place, pose, gears.derivatives);
        let maps = self.slices[line.slice].rolls.as_ref();
        let maps = maps.map(|maps| maps[side_index(line.side)]);
        PairState {
            teeth: self.teeth(line.side, pair),
            s: maps.map_or(touch.roll, |maps| [0, 1].map(|k| maps[k].s(touch.roll[k]))),
            gap: touch.gap,
            scale: [1.0; 2],
            curvature: [0.0; 2],
            touch: Some(touch),
        }
    }
}
