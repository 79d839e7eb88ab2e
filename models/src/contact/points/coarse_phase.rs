//! Coarse phase of the point search: the pairs of flanks that may touch at a state.
//!
//! [`CoarseStep`] is the interface. The result of a step may contain too many pairs, never too few. The narrow phase
//! is the same for every step, and pairs are in one order, so that the forces of flanks that both steps find are equal
//! to the last bit.
//!
//! - [`ToothIndices`] looks up sorted path coordinates. It asks that flanks follow the involutes of the toothing that
//!   the scene names, so that one number tells where they are.
//! - [`FlankBoxes`] asks nothing of tooth numbers, of the shape of flanks, or of the poses of the gears: every flank
//!   has a box in its own frame, and two trees of boxes are held against each other in the relative pose (parry). Flanks move
//!   as their gears do, so that no tree is ever refitted. It serves what the indices cannot: flanks of meshes of any
//!   origin, later crossed axes.
//!
//! Where both serve the indices are faster: of 20 on 30 teeth with next to no points a search takes 1.8 us with
//! indices and 57 us with boxes, 32 times as long. Measured by
//!
//! ```text
//! cargo test --release -p gearbench-tests --test analytic coarse -- --ignored --nocapture
//! ```

use super::flanked::{FlankedGear, NearbyFlank};
use super::mesh_flanks::MeshFlanks;
use super::poses::MeshPoses;
use super::surface::Shape;
use crate::Vec3;
use crate::geometry::Side;
use crate::kinematics::Pose;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::math::{self, Rotation, Vector};
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use std::fmt::Debug;

/// Buffers of the coarse phase, reused between evaluations.
#[derive(Debug, Default)]
pub(super) struct CoarseScratch {
    /// Result: left flanks, then right ones, each by the path coordinates of the first and the second gear.
    pub pairs: Vec<[NearbyFlank; 2]>,
    near: [Vec<NearbyFlank>; 2],
    found: Vec<[usize; 2]>,
}

/// A method that finds the pairs of flanks that may touch.
pub(super) trait CoarseStep: Debug + Send {
    /// Appends the pairs of a side to `scratch.pairs`, where both gears have finite poses.
    fn pairs(&self, of: &MeshFlanks, side: Side, poses: &MeshPoses, scratch: &mut CoarseScratch);
}

/// Coarse phase by path coordinates: flanks near the line of centres, and the flanks opposite to them.
#[derive(Clone, Copy, Debug)]
pub(super) struct ToothIndices;

impl CoarseStep for ToothIndices {
    fn pairs(&self, of: &MeshFlanks, side: Side, poses: &MeshPoses, scratch: &mut CoarseScratch) {
        let CoarseScratch { pairs, near, .. } = scratch;
        near[0].clear();
        let by = &poses.displacements;
        of.gears[0].each_near(side, by[0], of.zone, |first| near[0].push(first));
        let reach = of.reach_along() + poses.beside;
        for first in &near[0] {
            let facing = of.length - first.s;
            let range = [facing - reach, facing + 0.5 * of.base_pitch];
            of.gears[1].each_near(side, by[1], range, |second| {
                pairs.push([*first, second]);
            });
        }
    }
}

/// Largest overlap of flanks relative to the base pitch: a flank that is deeper lies behind the tooth, not in it.
const DEEPEST: f64 = 0.25;

/// Coarse phase by trees of bounding boxes of the undeformed flanks.
#[derive(Debug)]
pub(super) struct FlankBoxes {
    /// Trees of both sides of each gear.
    trees: [[Tree; 2]; 2],
    /// Largest overlap of flanks, including displacements [m].
    deepest: f64,
}

/// Flanks of one side of a gear in its own frame.
#[derive(Debug)]
struct Tree {
    boxes: Bvh,
    flanks: Vec<Flank>,
}

#[derive(Debug)]
struct Flank {
    shape: usize,
    nodes: Vec<Vec3>,
    centre: Vec3,
    /// Mean unit normal, out of the tooth.
    normal: Vec3,
    /// Height of the lowest node along the mean normal [m].
    lowest: f64,
}

impl FlankBoxes {
    /// Builds the trees; `reach` [m] is the largest gap of returned points, and the largest displacement of each gear.
    pub fn new(gears: &[FlankedGear; 2], reach: f64, base_pitch: f64) -> Self {
        let tree = |g: &FlankedGear, side: Side| {
            let of_side = (0..g.shapes.len()).filter(|&i| g.shapes[i].side == side);
            let flanks: Vec<Flank> = of_side.map(|i| Flank::new(g, i)).collect();
            let boxes: Vec<Aabb> = (flanks.iter())
                .map(|f| {
                    f.bounds()
                        .loosened(reach + beyond_the_nodes(&g.shapes[f.shape]))
                })
                .collect();
            Tree {
                boxes: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes),
                flanks,
            }
        };
        FlankBoxes {
            trees: [0, 1].map(|k| Side::BOTH.map(|side| tree(&gears[k], side))),
            deepest: DEEPEST * base_pitch + 2.0 * reach,
        }
    }
}

/// Returns the largest distance of the surface of a flank, continued beyond the tip, from the box of its nodes [m].
fn beyond_the_nodes(shape: &Shape) -> f64 {
    let most = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(*x));
    most(&shape.chord_bound) + most(&shape.lengths)
}

impl Flank {
    fn new(g: &FlankedGear, shape: usize) -> Self {
        let nodes = g.grids.grids()[shape].positions.clone();
        let s = &g.shapes[shape];
        let at = |row: usize, column: usize| nodes[row * s.columns + column];
        let mut normal = Vec3::zeros();
        for row in 1..s.rows {
            for column in 1..s.columns {
                let rising = at(row, column) - at(row - 1, column - 1);
                let falling = at(row - 1, column) - at(row, column - 1);
                normal += s.side.sign() * falling.cross(&rising);
            }
        }
        let normal = normal.normalize();
        let centre = nodes.iter().sum::<Vec3>() / nodes.len() as f64;
        let heights = nodes.iter().map(|x| normal.dot(&(x - centre)));
        Flank {
            shape,
            lowest: heights.fold(f64::INFINITY, f64::min),
            centre,
            normal,
            nodes,
        }
    }

    fn bounds(&self) -> Aabb {
        let corner = |pick: fn(f64, f64) -> f64, start: f64| {
            let all = self.nodes.iter();
            let [x, y, z] = all.fold([start; 3], |m, p| [0, 1, 2].map(|i| pick(m[i], p[i])));
            Vector::new(x, y, z)
        };
        Aabb::new(
            corner(f64::min, f64::INFINITY),
            corner(f64::max, f64::NEG_INFINITY),
        )
    }

    /// Returns true if another flank rises above this one, or is at most `deepest` below it; `pose` maps the other's
    /// frame to this one.
    fn is_faced_by(&self, other: &Flank, pose: &math::Pose, deepest: f64) -> bool {
        let vector = |x: &Vec3| Vector::new(x.x, x.y, x.z);
        let normal = pose.rotation.inverse() * vector(&self.normal);
        let normal = Vec3::new(normal.x, normal.y, normal.z);
        let offset = vector(&self.normal).dot(pose.translation - vector(&self.centre));
        let least = self.lowest - deepest - offset;
        other.nodes.iter().any(|x| normal.dot(x) >= least)
    }
}

fn in_space(pose: &Pose) -> math::Pose {
    let vector = |x: &Vec3| Vector::new(x.x, x.y, x.z);
    let [x, y, z] = pose.axes.each_ref().map(vector);
    math::Pose::from_parts(
        vector(&pose.origin),
        Rotation::from_mat3(&math::Mat3::from_cols(x, y, z)),
    )
}

impl CoarseStep for FlankBoxes {
    fn pairs(&self, of: &MeshFlanks, side: Side, poses: &MeshPoses, scratch: &mut CoarseScratch) {
        let CoarseScratch { pairs, near, found } = scratch;
        let [first, second] = [0, 1].map(|k| in_space(&poses.poses[k]));
        // From the second gear's frame to the first's, and back.
        let pose = first.inverse() * second;
        let back = pose.inverse();
        let trees = [0, 1].map(|k| &self.trees[k][usize::from(side == Side::Right)]);
        let may_touch = |a: &Aabb, b: &Aabb| a.intersects(&b.transform_by(&pose));
        let leaves =
            (trees[0].boxes).leaf_pairs(&trees[1].boxes, |a, b| may_touch(&a.aabb(), &b.aabb()));
        found.clear();
        for (i, j) in leaves {
            let (a, b) = (&trees[0].flanks[i as usize], &trees[1].flanks[j as usize]);
            if a.is_faced_by(b, &pose, self.deepest) && b.is_faced_by(a, &back, self.deepest) {
                found.push([a.shape, b.shape]);
            }
        }
        // In the order of path coordinates, about the middle of the zone.
        let middle = 0.5 * (of.zone[0] + of.zone[1]);
        for (k, about) in [middle, of.length - middle].into_iter().enumerate() {
            near[k].clear();
            of.gears[k].each_about(side, poses.displacements[k], about, |flank| {
                near[k].push(flank)
            });
        }
        for a in near[0].iter() {
            for b in near[1].iter() {
                if found.contains(&[a.shape, b.shape]) {
                    pairs.push([*a, *b]);
                }
            }
        }
    }
}
