//! Flanks of gears whose axes are not parallel, or whose hubs move sideways: where the slices of a pair touch.
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

use super::lines::{Line, LinesOfAction, Mover, PairState, side_index};
use crate::Vec3;
use crate::geometry::{Near, Side};
use crate::kinematics::{HubFrame, Tooth};
pub use flanks::{FlankForm, Helicoid, Plane};

/// Corrections of the length of roll.
const MAX_CORRECTIONS: usize = 40;

/// Change of the length of roll, over the base radius, after which it is found: Newton's corrections are squares of each
/// other.
const FOUND: f64 = 1e-6;

/// Gap over the base pitch from which on one correction is enough: nothing touches.
const FAR: f64 = 5e-3;

/// Least length of roll, over the base pitch: nearer to the base circle no flank is looked at.
const LEAST_ROLL: f64 = 0.01;

/// Where the flanks of a slice come nearest.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// [m]
    pub gap: f64,
    /// [m]
    pub x: Vec3,
    /// What the gap changes by: `dg = -n . (v_a - v_b)`; a unit vector on plain flanks.
    pub normal: Vec3,
    /// Lengths of roll of both flanks, as if they went on beyond their tips [m].
    pub roll: [f64; 2],
    /// How the path coordinate moves, `ds = f . v + m . w` with the velocity `v` at the contact point and the spin `w` of
    /// gear b over gear a.
    pub path: [Vec3; 2],
}

/// The flanks of a mesh in space.
#[derive(Clone, Debug)]
pub struct Spatial {
    /// Those of both gears.
    pub flanks: [FlankForm; 2],
    /// The gear whose transverse sections the slices are; never a rack.
    pub sliced: usize,
    /// Distance between the tangent points [m].
    pub length: f64,
    /// Path coordinate per length of roll of both gears, on left and right flanks.
    pub roll_scale: [[f64; 2]; 2],
    /// Base pitch [m].
    pub base_pitch: f64,
    /// Angle (place on the slide) of tooth 0 of both gears at the assembled position.
    pub phases: [f64; 2],
}

impl Spatial {
    /// Where the flanks of a slice at the height `z` of the sliced gear come nearest; teeth and their angles are those of
    /// gear a and gear b, `roll` a guess of the length of roll of the sliced gear.
    pub fn touch(
        &self,
        side: Side,
        z: f64,
        frames: [&HubFrame; 2],
        teeth: [(i64, f64); 2],
        roll: f64,
    ) -> Touch {
        let (i, j) = (self.sliced, 1 - self.sliced);
        let FlankForm::Involute(own) = &self.flanks[i] else {
            unreachable!("a rack is never the sliced gear")
        };
        let mate = &self.flanks[j];
        let [tooth, of_mate] = [i, j].map(|k| (teeth[k].0, side, teeth[k].1));
        let least = LEAST_ROLL * self.base_pitch;
        // The least distance of unmodified flanks that go on beyond their tips.
        let found = self.least(
            side,
            z,
            frames,
            [tooth, of_mate],
            (least, f64::INFINITY, roll),
            false,
        );
        let (rho, near, x, base) = found;
        let tip = own.tip(side, z);
        // Of the foot on the mate.
        let foot = match mate {
            FlankForm::Involute(h) => near.roll - near.distance / h.flank(side).cos_helix,
            FlankForm::Plane(_) => near.roll - near.distance * near.gradient.y,
        };
        let mut rolls = [0.0; 2];
        rolls[i] = rho;
        rolls[j] = match mate {
            FlankForm::Involute(_) => foot,
            FlankForm::Plane(_) => self.length - rho,
        };
        let path = self.path(side, frames, (rho, &base), &near);
        let outward = |gradient: &Vec3| {
            // From a to b: against the outward normal of b, along that of a.
            let normal = frames[j].turn(gradient);
            if j == 1 { -normal } else { normal }
        };
        let touch = |gap: f64, x: Vec3, normal: Vec3| Touch {
            gap,
            x,
            normal,
            roll: rolls,
            path,
        };
        let plain = !own.modified && !mate.is_modified();
        let beyond = mate.is_beyond(side, foot, mate.height(frames[j], &x));
        let inside = rho <= tip && !beyond;
        if (plain && inside) || near.distance > 4.0 * FAR * self.base_pitch {
            return touch(near.distance, x, outward(&near.gradient));
        }
        if beyond {
            return self.edge_of_mate(side, z, frames, [tooth, of_mate], &x, touch);
        }
        let (rho, near, x, _) =
            self.least(side, z, frames, [tooth, of_mate], (least, tip, rho), true);
        let [e, _, _] = own.removed(tooth.0, side, rho, z);
        touch(near.distance + e, x, outward(&near.gradient))
    }

    /// The point of the section that is nearest to the mate: its roll, what the mate says of it, its place in space and the
    /// direction of its base radius; with modifications where `exact`.
    fn least(
        &self,
        side: Side,
        z: f64,
        frames: [&HubFrame; 2],
        [tooth, of_mate]: [(i64, Side, f64); 2],
        (low, high, start): (f64, f64, f64),
        exact: bool,
    ) -> (f64, Near, Vec3, Vec3) {
        let (i, j) = (self.sliced, 1 - self.sliced);
        let FlankForm::Involute(own) = &self.flanks[i] else {
            unreachable!("a rack is never the sliced gear")
        };
        let rb = own.flank(side).base_radius;
        let mut rho = start.clamp(low, high);
        let (mut from, mut to) = (low, high);
        let mut found = false;
        let (mut p, mut of_base) = own.flank(side).point(tooth.2, rho, z);
        for correction in 0.. {
            let x = frames[i].point(&p);
            let base = frames[i].turn(&of_base);
            let place = frames[j].point_back(&x);
            // Far flanks are recognised by their distance, which otherwise only the last correction needs; modified ones
            // need their slope.
            let near = match &self.flanks[j] {
                FlankForm::Involute(h) if !exact && correction != 0 && !found => {
                    h.flank(side).directed(&place)
                }
                flank => flank.near(of_mate, &place, exact),
            };
            let has_distance = exact || correction == 0 || found;
            let removed = if exact {
                own.removed(tooth.0, side, rho, z)[1]
            } else {
                0.0
            };
            let per_roll = rho / rb;
            let slope = per_roll * base.dot(&frames[j].turn(&near.gradient)) + removed;
            // Curvature of both involutes; a modification bends little beside them.
            let bend = match &self.flanks[j] {
                FlankForm::Involute(h) => {
                    let other = near.roll.max(low);
                    h.flank(side).cos_helix * (rho + other) / other
                }
                FlankForm::Plane(p) => p.cos * (1.0 + p.tan_pressure.powi(2)).sqrt(),
            };
            let bend = per_roll / rb * bend;
            let step = -slope / bend;
            let ends = (rho == low && step < 0.0) || (rho == high && step > 0.0);
            let far = !exact
                && correction == 0
                && near.distance - 0.5 * slope * slope / bend > FAR * self.base_pitch;
            if correction == MAX_CORRECTIONS || ends || found || far {
                let near = match has_distance {
                    true => near,
                    false => self.flanks[j].near(of_mate, &place, exact),
                };
                return (rho, near, x, base);
            }
            // Modifications bend the flank as well, which the curvature leaves out.
            let enough = if exact { 1e-5 * FOUND } else { FOUND };
            found = step.abs() <= enough * rb;
            // Kinks of modifications: the sign of the slope brackets the least.
            if slope > 0.0 {
                to = rho;
            } else {
                from = rho;
            }
            let next = rho + step;
            let before = rho;
            rho = if correction > 4 && !(from..=to).contains(&next) {
                0.5 * (from + to)
            } else {
                next.clamp(low, high)
            };
            let flank = own.flank(side);
            (p, of_base) = flank.point_onwards((tooth.2, z), &of_base, rho, rho - before);
        }
        unreachable!("the corrections end")
    }

    /// The tip edge of the mate in the plane of the slice, on the flank of the sliced gear.
    fn edge_of_mate(
        &self,
        side: Side,
        z: f64,
        frames: [&HubFrame; 2],
        [tooth, of_mate]: [(i64, Side, f64); 2],
        x: &Vec3,
        touch: impl Fn(f64, Vec3, Vec3) -> Touch,
    ) -> Touch {
        let (i, j) = (self.sliced, 1 - self.sliced);
        let FlankForm::Involute(own) = &self.flanks[i] else {
            unreachable!("a rack is never the sliced gear")
        };
        let axis = frames[i].axes[2];
        let mut height = frames[j].point_back(x).z;
        let (mut edge, mut tangent) = (*x, axis);
        for _ in 0..3 {
            let (p, t) = match &self.flanks[j] {
                FlankForm::Involute(h) => {
                    let (flank, tip) = (h.flank(side), h.tip(side, height));
                    let (p, base) = flank.point(of_mate.2, tip, height);
                    let turn = flank.tan_helix / flank.base_radius;
                    let along = Vec3::new(-turn * p.y, turn * p.x, 1.0);
                    // On a cone the edge moves along the profile as well.
                    let rise = h.tip_rise(side, height) * tip / flank.base_radius;
                    (p, along + rise * base)
                }
                FlankForm::Plane(plane) => {
                    let off = side.sign() * (plane.half_thickness - plane.tip * plane.tan_pressure);
                    let along = of_mate.2 + height * plane.tan_helix - off;
                    (
                        Vec3::new(along, plane.tip, height),
                        Vec3::new(plane.tan_helix, 0.0, 1.0),
                    )
                }
            };
            edge = frames[j].point(&p);
            tangent = frames[j].turn(&t);
            let off = axis.dot(&(edge - frames[i].origin)) - z;
            height -= off / axis.dot(&tangent);
            edge -= off / axis.dot(&tangent) * tangent;
        }
        let near = own.near(tooth, &frames[i].point_back(&edge), true);
        let (removed, by_height) = match &self.flanks[j] {
            FlankForm::Involute(h) => {
                let [e, by_roll, by_z] = h.removed(of_mate.0, side, h.tip(side, height), height);
                (e, by_z + by_roll * h.tip_rise(side, height))
            }
            FlankForm::Plane(_) => (0.0, 0.0),
        };
        // The edge slides along itself to stay in the plane.
        let normal = frames[i].turn(&near.gradient);
        let along = (normal.dot(&tangent) + by_height) / axis.dot(&tangent);
        let normal = normal - along * axis;
        let from_a = if i == 0 { normal } else { -normal };
        touch(near.distance + removed, edge, from_a)
    }

    /// How the path coordinate moves with the motion of gear b over gear a.
    fn path(
        &self,
        side: Side,
        frames: [&HubFrame; 2],
        (rho, base): (f64, &Vec3),
        near: &Near,
    ) -> [Vec3; 2] {
        let (i, j) = (self.sliced, 1 - self.sliced);
        let FlankForm::Involute(own) = &self.flanks[i] else {
            unreachable!("a rack is never the sliced gear")
        };
        let sigma = side.sign();
        let outward = sigma * frames[i].axes[2].cross(base);
        let normal = frames[j].turn(&near.gradient);
        let rb = own.flank(side).base_radius;
        let turning = -outward.dot(&normal) / rb;
        let couple = base.cross(&normal);
        let FlankForm::Involute(other) = &self.flanks[j] else {
            // On a rack the place is that of the gear's own flank.
            return [Vec3::zeros(), couple / turning];
        };
        let other = other.flank(side);
        let per_roll = rho / rb;
        let of_mate = frames[j].turn(&near.base);
        let (across, roll) = (
            base.dot(&of_mate),
            near.roll.max(LEAST_ROLL * self.base_pitch),
        );
        let bend = other.cos_helix * across / roll;
        let by_roll = turning + bend * across * per_roll;
        let own_roll = [bend / by_roll * of_mate, couple / by_roll];
        // Of the foot on the mate, which goes along with the point on the sliced gear.
        let axis = frames[j].axes[2];
        let outward = sigma * axis.cross(&of_mate);
        let lever = other.base_radius / roll;
        let along = (lever * across + outward.dot(base)) * per_roll;
        let still = lever * of_mate + sigma * other.tan_helix * axis;
        let foot = [along * own_roll[0] - still, along * own_roll[1]];
        let scale = self.roll_scale[side_index(side)];
        [0, 1].map(|k| 0.5 * (scale[i] * own_roll[k] - scale[j] * foot[k]))
    }
}

impl LinesOfAction {
    /// Where a pair stands: its teeth, lengths of roll and gap, by path coordinates that only tell how far its teeth have
    /// turned.
    pub(super) fn pair_in_space(
        &self,
        spatial: &Spatial,
        line: &Line,
        movers: [&Mover<'_>; 2],
        teeth: [Tooth; 2],
        s: [f64; 2],
    ) -> PairState {
        let frames = movers.map(Mover::frame);
        // Where the maps of the line have teeth turned to.
        let angles = [0, 1].map(|k| {
            let map = &line.map[k];
            let first = self.teeth(line.side, 0)[k].index as f64 * self.mesh.views[k].pitch;
            let turned = (s[k] - map.at_zero) / map.per_displacement - frames[k].1;
            (teeth[k].index, spatial.phases[k] + first + turned)
        });
        let z = self.slices[line.slice].z;
        let maps = &self.slices[line.slice].rolls;
        let maps = maps.as_ref().map(|maps| maps[side_index(line.side)]);
        let guess = s[spatial.sliced];
        let guess = maps.map_or(guess, |maps| maps[spatial.sliced].roll(guess));
        let touch = spatial.touch(line.side, z, [&frames[0].0, &frames[1].0], angles, guess);
        PairState {
            teeth,
            s: maps.map_or(touch.roll, |maps| [0, 1].map(|k| maps[k].s(touch.roll[k]))),
            gap: touch.gap,
            scale: [1.0; 2],
            curvature: [0.0; 2],
            touch: Some(touch),
        }
    }
}
