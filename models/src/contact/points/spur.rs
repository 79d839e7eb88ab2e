//! Point search in two dimensions, where all flanks move with their hubs and are equal in every transverse plane.
//!
//! A point and a flank have the same transverse positions whatever their position over the width, so that one
//! projection serves all points of a line over it. All data are in the gear frames from the start; an evaluation needs
//! one pose of each gear relative to the other. Along a pair of flanks the gap grows from the point of smallest gap:
//! rows are searched outwards from there, until displacements can no longer close the gap.

use super::flanked::NearbyFlank;
use super::mesh_flanks::MeshFlanks;
use super::poses::MeshPoses;
use super::profile::Vec2;
use super::sections::PlaneTransform;
use super::spur_face::{FacePointSearch, Pair};
use crate::contact::gear_state::SearchWork;
use crate::contact::nodal::{GapBound, NodalGearState, NodalPoints, UNUSED};
use crate::geometry::Side;

pub(super) use super::sections::Spur;

/// Buffers of the search, reused between evaluations.
#[derive(Debug, Default)]
pub(super) struct SpurScratch {
    first: Vec<NearbyFlank>,
    pairs: Vec<OppositeFlanks>,
    /// Slot of the first node of each row, per gear; [`UNUSED`] for rows that are not registered.
    rows: [Vec<u32>; 2],
    /// Lower bound of the gap of each row of the slave [m], and the face of the master for which it was computed.
    clear: Vec<(f64, usize)>,
}

impl Spur {
    /// Finds the points of a mesh at a state; `limit` is the largest gap that displacements can close.
    #[allow(clippy::too_many_arguments)]
    pub fn points(
        &self,
        of: &MeshFlanks,
        mut sides: [NodalGearState<'_>; 2],
        poses: &MeshPoses,
        limit: f64,
        buffers: &mut SpurScratch,
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) -> SearchWork {
        let mut work = SearchWork::default();
        let SpurScratch { first, pairs, .. } = buffers;
        facing(of, poses, limit, first, pairs);
        if !buffers.pairs.is_empty() {
            let poses = poses.poses;
            let turns = [
                PlaneTransform::between(&poses[0], &poses[1]),
                PlaneTransform::between(&poses[1], &poses[0]),
            ];
            let pairs = std::mem::take(&mut buffers.pairs);
            for (_, a, b, side) in &pairs {
                work.pairs += 1;
                work.flanks += 2;
                let pair = Pair {
                    spur: self,
                    of,
                    near: [*a, *b],
                    side: *side,
                    poses: &poses,
                    turns: &turns,
                    limit,
                };
                pair.points(&mut sides, buffers, &mut work, gap_bound, out);
            }
            buffers.pairs = pairs;
        }
        work.nodes = sides.iter().map(|s| s.nodes.nodes.len()).sum();
        work
    }
}

/// Pair of flanks: their distance along the path, the flanks, and their side.
pub(super) type OppositeFlanks = (f64, NearbyFlank, NearbyFlank, Side);

/// Returns the opposite flanks within the limit, the nearest pair first.
pub(super) fn facing(
    of: &MeshFlanks,
    poses: &MeshPoses,
    limit: f64,
    first: &mut Vec<NearbyFlank>,
    pairs: &mut Vec<OppositeFlanks>,
) {
    pairs.clear();
    let limit =
        of.along(limit) + of.gears[0].deviation_bound + of.gears[1].deviation_bound + poses.beside;
    let by = &poses.displacements;
    for side in Side::BOTH {
        first.clear();
        of.gears[0].each_near(side, by[0], of.zone, |near| first.push(near));
        for near in first.iter() {
            let facing = of.length - near.s;
            let range = [facing - limit, facing + 0.5 * of.base_pitch];
            of.gears[1].each_near(side, by[1], range, |other| {
                pairs.push((facing - other.s, *near, other, side));
            });
        }
    }
    pairs.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
}

impl Pair<'_> {
    /// Finds the points of both passes, with either gear as slave.
    fn points(
        &self,
        sides: &mut [NodalGearState<'_>; 2],
        buffers: &mut SpurScratch,
        work: &mut SearchWork,
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        for k in 0..2 {
            buffers.rows[k].clear();
            buffers.rows[k].resize(self.shape(k).rows, UNUSED);
        }
        let start = self.start();
        for k in 0..2 {
            if self.of.penalty[k] > 0.0 {
                self.hold(k, &start[k], sides, buffers, work, gap_bound, out);
            }
        }
    }

    /// Returns the positions of smallest gap in both gear frames: where the line of action crosses the flanks, or,
    /// outside a flank, at the end of that flank.
    fn start(&self) -> [Vec2; 2] {
        let (first, second) = (self.profile(0), self.profile(1));
        let x = first.at_height(self.of.gears[0].height_on_path(self.near[0].s));
        let y = second.at_height(second.height(&self.turns[0].point(&x)));
        let x = first.at_height(first.height(&self.turns[1].point(&y)));
        [x, y]
    }

    /// Finds the points of gear `k` on the other.
    #[allow(clippy::too_many_arguments)]
    fn hold(
        &self,
        k: usize,
        start: &Vec2,
        sides: &mut [NodalGearState<'_>; 2],
        buffers: &mut SpurScratch,
        work: &mut SearchWork,
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        let m = 1 - k;
        let (slave, master) = (self.profile(k), self.profile(m));
        let turn = &self.turns[k];
        let SpurScratch { rows, clear, .. } = buffers;
        // Rows from the best place outwards, until they stand off.
        clear.clear();
        clear.resize(slave.faces() + 1, (f64::INFINITY, 0));
        let height = slave.height(start);
        let (middle, _) = slave.row_at(height, slave.near(height));
        let mut from = master.near(master.height(&turn.point(start)));
        let mut look = |row: usize, clear: &mut Vec<(f64, usize)>| {
            clear[row] = master.clearance(&turn.point(&slave.knots[row]), from);
            from = clear[row].1;
            clear[row].0 <= self.limit + slave.dip(row.min(slave.faces() - 1), master, [from; 2])
        };
        let (mut low, mut high) = (middle, middle + 1);
        let mut on = look(low, clear);
        while on && low > 0 {
            low -= 1;
            on = look(low, clear);
        }
        let mut on = look(high, clear);
        while on && high < slave.faces() {
            high += 1;
            on = look(high, clear);
        }
        let clearance_bound = |row: usize| {
            let (a, b) = (clear[row], clear[row + 1]);
            a.0.min(b.0) > self.limit + slave.dip(row, master, [a.1, b.1])
        };
        while low < high && clearance_bound(low) {
            low += 1;
        }
        while high > low && clearance_bound(high - 1) {
            high -= 1;
        }
        if low == high {
            return;
        }
        let faced = clear[low..=high].iter().filter(|c| c.0.is_finite());
        let range = faced.fold((usize::MAX, 0), |(l, h), c| (l.min(c.1), h.max(c.1)));
        if range.0 > range.1 {
            return;
        }
        let [of_slave, of_master] = {
            let (first, second) = sides.split_at_mut(1);
            if k == 0 {
                [&mut first[0], &mut second[0]]
            } else {
                [&mut second[0], &mut first[0]]
            }
        };
        let (first, second) = rows.split_at_mut(1);
        let [slave_rows, master_rows] = if k == 0 {
            [&mut first[0], &mut second[0]]
        } else {
            [&mut second[0], &mut first[0]]
        };
        self.meet(k, low..=high, of_slave, slave_rows);
        self.meet(m, range.0..=range.1 + 1, of_master, master_rows);
        let mut face = FacePointSearch {
            pair: self,
            k,
            of_slave,
            of_master,
            slave_rows,
            master_rows,
            clear: clear.as_slice(),
        };
        let middle = middle.clamp(low, high - 1);
        face.points(middle, work, gap_bound, out);
        for row in (low..high).filter(|row| *row != middle) {
            face.points(row, work, gap_bound, out);
        }
    }
}
