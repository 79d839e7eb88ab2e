//! Narrow phase of the point search: projection of the points of one flank on the deformed surface of the other.

use super::coarse_phase::{CoarseScratch, CoarseStep};
use super::flanked::NearbyFlank;
use super::mesh_flanks::MeshFlanks;
use super::poses::MeshPoses;
use super::projection::{DeformedSurface, MOST_PAST, Projection, ProjectionStart, TipTaper};
use super::rule::FlankPoint;
use super::surface::Shape;
use crate::Vec3;
use crate::contact::gear_state::{GearState, SearchWork};
use crate::geometry::{Side, Tips};
use crate::kinematics::{Locus, Point, Pose};

/// A flank whose nodes are evaluated at a state.
#[derive(Clone, Copy, Debug)]
struct Active {
    near: NearbyFlank,
    pose: Pose,
    /// Index of its first node in the buffer of positions.
    start: usize,
}

/// Buffers of the narrow phase, reused between evaluations.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    active: [Vec<Active>; 2],
    positions: [Vec<Vec3>; 2],
    coarse: CoarseScratch,
    pairs: Vec<[usize; 2]>,
    /// Height of each node of a flank over the other flank [m].
    heights: Vec<f64>,
    pub work: SearchWork,
}

/// A point of gear `k`, the slave, with its projection on the other gear, the master.
pub(super) struct ProjectedPoint<'a> {
    pub k: usize,
    /// Flanks of slave and master.
    pub flanks: [&'a DeformedSurface<'a>; 2],
    active: [&'a Active; 2],
    pub point: FlankPoint,
    pub x: Vec3,
    pub hit: Projection,
    /// Taper of the point at the tip of the master.
    pub taper: TipTaper,
}

impl MeshFlanks {
    /// Calls `found` for all points with a gap up to `limit`.
    pub fn each_point(
        &self,
        step: &dyn CoarseStep,
        gear_states: [&GearState<'_>; 2],
        limit: f64,
        scratch: &mut Scratch,
        mut found: impl FnMut(&ProjectedPoint<'_>),
    ) {
        self.find_pairs(step, gear_states, scratch);
        let mut work = SearchWork {
            pairs: scratch.pairs.len(),
            flanks: scratch.active.iter().map(Vec::len).sum(),
            nodes: scratch.positions.iter().map(Vec::len).sum(),
            ..SearchWork::default()
        };
        let mut heights = std::mem::take(&mut scratch.heights);
        for pair in &scratch.pairs {
            for k in 0..2 {
                if self.penalty[k] > 0.0 {
                    let buffers = (&*scratch, &mut heights, &mut work);
                    self.hold_points(k, *pair, buffers, limit, &mut found);
                }
            }
        }
        scratch.heights = heights;
        scratch.work = work;
    }

    /// Finds the flanks near the line of centres and the flanks opposite to them (first and second step).
    fn find_pairs(
        &self,
        step: &dyn CoarseStep,
        gear_states: [&GearState<'_>; 2],
        scratch: &mut Scratch,
    ) {
        let poses = self.poses(gear_states);
        scratch.pairs.clear();
        for k in 0..2 {
            scratch.active[k].clear();
            scratch.positions[k].clear();
        }
        if !poses.is_finite() {
            return;
        }
        let mut coarse = std::mem::take(&mut scratch.coarse);
        coarse.pairs.clear();
        for side in Side::BOTH {
            step.pairs(self, side, &poses, &mut coarse);
        }
        for [near, other] in &coarse.pairs {
            let a = self.activate(0, *near, gear_states[0], &poses, scratch);
            let b = self.activate(1, *other, gear_states[1], &poses, scratch);
            scratch.pairs.push([a, b]);
        }
        scratch.coarse = coarse;
    }

    /// Returns the index of a flank among the active ones; the nodes of a new flank are evaluated.
    fn activate(
        &self,
        k: usize,
        near: NearbyFlank,
        gear_state: &GearState<'_>,
        poses: &MeshPoses,
        scratch: &mut Scratch,
    ) -> usize {
        let (active, positions) = (&mut scratch.active[k], &mut scratch.positions[k]);
        if let Some(i) = active.iter().position(|a| a.near.shape == near.shape) {
            return i;
        }
        let g = &self.gears[k];
        let shape = &g.shapes[near.shape];
        let start = positions.len();
        positions.resize(start + shape.nodes.len(), Vec3::zeros());
        let pose = if let Some(surface) = gear_state.gear.surface() {
            surface
                .nodes
                .positions(gear_state.at, &shape.nodes, &mut positions[start..]);
            poses.poses[k]
        } else {
            let tooth = self.tooth(k, &near);
            let displacement = gear_state.gear.tooth_displacement(gear_state.at, tooth);
            let pose = g.pose(gear_state, displacement);
            let undeformed = &g.grids.grids()[near.shape].positions;
            for (x, u) in positions[start..].iter_mut().zip(undeformed) {
                *x = pose.point(u);
            }
            pose
        };
        active.push(Active { near, pose, start });
        active.len() - 1
    }

    fn deformed<'a>(
        &'a self,
        k: usize,
        scratch: &'a Scratch,
        active: usize,
    ) -> DeformedSurface<'a> {
        let a = &scratch.active[k][active];
        let shape = &self.gears[k].shapes[a.near.shape];
        DeformedSurface {
            shape,
            x: &scratch.positions[k][a.start..][..shape.nodes.len()],
            pose: &a.pose,
            patches: None,
        }
    }

    /// Returns the height of a point on the flanks of gear `k`, as in [`Shape::heights`].
    #[inline]
    fn height(&self, k: usize, pose: &Pose, x: &Vec3) -> f64 {
        match self.gears[k].tips {
            Tips::Outwards => pose.off_axis(x).norm_squared(),
            Tips::Inwards => -pose.off_axis(x).norm_squared(),
            Tips::Along => -pose.axes[0].dot(&(x - pose.origin)),
        }
    }

    /// Returns the position of a point on the last face by its height, and the gradient of the position [1/m].
    #[inline]
    fn tip_place(&self, m: usize, master: &DeformedSurface<'_>, x: &Vec3) -> (f64, Vec3) {
        let heights = &master.shape.heights;
        let (low, tip) = (heights[heights.len() - 2], heights[heights.len() - 1]);
        let per = (tip - low).recip();
        let pose = master.pose;
        if let Some(cone) = &master.shape.cone {
            let off = pose.off_axis(x);
            let radius = off.norm();
            let carried = radius - cone.slope * pose.height(x);
            let gradient = off / radius - cone.slope * pose.axes[2];
            return (
                (carried * carried - low) * per,
                2.0 * per * carried * gradient,
            );
        }
        let gradient = match self.gears[m].tips {
            Tips::Outwards => 2.0 * pose.off_axis(x),
            Tips::Inwards => -2.0 * pose.off_axis(x),
            Tips::Along => -pose.axes[0],
        };
        ((self.height(m, pose, x) - low) * per, per * gradient)
    }

    /// Returns a point of gear `k`, on its mesh or on its rigid flank.
    #[inline]
    fn point(&self, k: usize, active: &Active, face: u32, [a, b]: [f64; 2], x: Vec3) -> Point {
        let g = &self.gears[k];
        let locus = if g.own {
            Locus::Quadrature {
                face,
                xi: [2.0 * a - 1.0, 2.0 * b - 1.0],
            }
        } else {
            let height = self.height(k, &active.pose, &x);
            Locus::Flank {
                radius: g.tips.radius(height),
                zeta: 2.0 * active.pose.height(&x) / g.face_width,
            }
        };
        Point {
            tooth: self.tooth(k, &active.near),
            locus,
            x,
        }
    }

    /// Projects the points of gear `k` on the other flank of a pair (third step). Faces whose corners are all clearly
    /// above the other flank are skipped.
    fn hold_points(
        &self,
        k: usize,
        pair: [usize; 2],
        (scratch, heights, work): (&Scratch, &mut Vec<f64>, &mut SearchWork),
        limit: f64,
        mut found: impl FnMut(&ProjectedPoint<'_>),
    ) {
        let m = 1 - k;
        let slave = self.deformed(k, scratch, pair[k]);
        let master = self.deformed(m, scratch, pair[m]);
        let active = [&scratch.active[k][pair[k]], &scratch.active[m][pair[m]]];
        heights.clear();
        heights.extend(
            slave
                .x
                .iter()
                .map(|x| self.clearance_bound(m, &master, x).1),
        );
        let columns = slave.shape.columns;
        let keep = |row: usize, column: usize| {
            let i = row * columns + column;
            let least = heights[i]
                .min(heights[i + 1])
                .min(heights[i + columns])
                .min(heights[i + columns + 1]);
            least <= limit + slave.shape.chord_bound[row]
        };
        let tip = master.shape.lengths[master.shape.lengths.len() - 1];
        slave.shape.points(&self.rule, keep, |p| {
            work.points += 1;
            let x = slave
                .shape
                .face(slave.x, slave.pose, p.row, p.column)
                .position(slave.shape, p.a, p.b);
            let (begin, clearance) = self.clearance_bound(m, &master, &x);
            if clearance > limit {
                return;
            }
            let past = (0.5 * p.length / tip).min(MOST_PAST);
            let Some(taper) = TipTaper::new(self.tip_place(m, &master, &x), past) else {
                return;
            };
            work.projections += 1;
            let Some(hit) = master.project(&x, begin) else {
                return;
            };
            if hit.gap > limit {
                return;
            }
            found(&ProjectedPoint {
                k,
                flanks: [&slave, &master],
                active,
                point: p,
                x,
                hit,
                taper,
            });
        });
    }

    /// Returns the start of the projection of a point on the master, and a lower bound of its gap [m]: infinite more
    /// than a face beyond root, tip or sides.
    #[inline]
    fn clearance_bound(
        &self,
        m: usize,
        master: &DeformedSurface<'_>,
        x: &Vec3,
    ) -> (ProjectionStart, f64) {
        let (column, b) = master.shape.column_at(master.pose.height(x));
        let height = self.height(m, master.pose, x);
        let (row, a) = master.shape.row_at(height, (column, b));
        let begin = ProjectionStart {
            row,
            column,
            place: [a, b],
        };
        let near = |t: f64| (-1.0..=2.0).contains(&t);
        if !(near(a) && near(b)) {
            return (begin, f64::INFINITY);
        }
        let face = master.shape.face(master.x, master.pose, row, column);
        let over = face.height_over(master.shape.side, x);
        (begin, over - master.shape.chord_bound[row])
    }

    /// Returns the contact points on both gears.
    #[inline]
    pub fn points(&self, found: &ProjectedPoint<'_>) -> [Point; 2] {
        let ProjectedPoint {
            k,
            flanks: [slave, master],
            active: [s_active, m_active],
            point: p,
            x,
            hit,
            ..
        } = found;
        let number = |shape: &Shape, row, column| shape.face_number(row, column);
        let of_slave = self.point(
            *k,
            s_active,
            number(slave.shape, p.row, p.column),
            [p.a, p.b],
            *x,
        );
        let of_master = self.point(
            1 - k,
            m_active,
            number(master.shape, hit.row, hit.column),
            [hit.a, hit.b],
            hit.spot.x,
        );
        if *k == 0 {
            [of_slave, of_master]
        } else {
            [of_master, of_slave]
        }
    }
}
