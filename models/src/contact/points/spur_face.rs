//! Points of a face of one gear on the profile of the other's flank.

use super::flanked::NearbyFlank;
use super::mesh_flanks::MeshFlanks;
use super::profile::{Profile, Vec2};
use super::projection::{MOST_PAST, TipTaper};
use super::sections::{PlaneTransform, Spur};
use super::surface::Shape;
use crate::Vec3;
use crate::contact::gear_state::SearchWork;
use crate::contact::nodal::{GapBound, NodalGearState, NodalPoint, NodalPoints, UNUSED};
use crate::geometry::Side;
use crate::kinematics::Pose;

/// A pair of flanks at a state.
pub(super) struct Pair<'a> {
    pub spur: &'a Spur,
    pub of: &'a MeshFlanks,
    pub near: [NearbyFlank; 2],
    pub side: Side,
    pub poses: &'a [Pose; 2],
    /// Transformations from the frame of the first gear to that of the second, and back.
    pub turns: &'a [PlaneTransform; 2],
    pub limit: f64,
}

impl Pair<'_> {
    pub fn profile(&self, k: usize) -> &Profile {
        &self.spur.profiles[k][self.near[k].shape]
    }

    pub fn shape(&self, k: usize) -> &Shape {
        &self.of.gears[k].shapes[self.near[k].shape]
    }

    /// Registers rows of nodes of a gear.
    pub fn meet(
        &self,
        k: usize,
        rows: std::ops::RangeInclusive<usize>,
        side: &mut NodalGearState<'_>,
        slots: &mut [u32],
    ) {
        let Some(field) = side.field else { return };
        let shape = self.shape(k);
        let columns = shape.columns;
        let (mut row, end) = (*rows.start(), (*rows.end()).min(shape.rows - 1));
        while row <= end {
            if slots[row] != UNUSED {
                row += 1;
                continue;
            }
            let new = (row..=end).take_while(|&r| slots[r] == UNUSED).count();
            let nodes = &shape.nodes[row * columns..(row + new) * columns];
            let first = side.nodes.meet_new(field, side.gear_state.at, nodes);
            for i in 0..new {
                slots[row + i] = first + (i * columns) as u32;
            }
            row += new;
        }
    }
}

/// Search for the points of one gear's flank on the other's.
pub(super) struct FacePointSearch<'a, 'b, 'c> {
    pub pair: &'a Pair<'b>,
    pub k: usize,
    pub of_slave: &'a mut NodalGearState<'c>,
    pub of_master: &'a mut NodalGearState<'c>,
    pub slave_rows: &'a mut Vec<u32>,
    pub master_rows: &'a mut Vec<u32>,
    pub clear: &'a [(f64, usize)],
}

impl FacePointSearch<'_, '_, '_> {
    /// Returns the largest displacement of the nodes of registered rows.
    fn rise(side: &NodalGearState<'_>, slots: &[u32], columns: usize) -> f64 {
        let met = slots.iter().filter(|s| **s != UNUSED);
        met.fold(f64::NEG_INFINITY, |most, &slot| {
            let of_row = &side.nodes.displacement[slot as usize..][..columns];
            of_row.iter().fold(most, |m, a| m.max(*a))
        })
    }

    /// Returns the displacement at a position on a face; zero without a field.
    #[inline]
    fn at(
        side: &NodalGearState<'_>,
        rows: &[u32],
        (row, a): (usize, f64),
        (column, b): (usize, f64),
    ) -> f64 {
        if rows[row] == UNUSED {
            return 0.0;
        }
        let at = |row: usize| {
            let of_row = &side.nodes.displacement[rows[row] as usize + column..][..2];
            of_row[0] + b * (of_row[1] - of_row[0])
        };
        let (below, above) = (at(row), at(row + 1));
        below + a * (above - below)
    }

    /// Returns the slots of the corners of a face; [`UNUSED`] without a field.
    #[inline]
    fn corners(rows: &[u32], row: usize, column: usize) -> [u32; 4] {
        if rows[row] == UNUSED {
            return [UNUSED; 4];
        }
        let (below, above) = (rows[row] + column as u32, rows[row + 1] + column as u32);
        [below, above, above + 1, below + 1]
    }

    /// Finds the points of a face of the slave.
    pub fn points(
        &mut self,
        row: usize,
        work: &mut SearchWork,
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        let (pair, k) = (self.pair, self.k);
        let m = 1 - k;
        let (spur, of) = (pair.spur, pair.of);
        let (slave, master) = (pair.profile(k), pair.profile(m));
        let (s_shape, m_shape) = (pair.shape(k), pair.shape(m));
        // With the given displacements the face may have a gap.
        let (c0, c1) = (self.clear[row], self.clear[row + 1]);
        let faces = [c0.1.min(c1.1), c0.1.max(c1.1)];
        let mut rise = 0.0;
        if self.of_slave.field.is_some() {
            rise += Self::rise(
                self.of_slave,
                &self.slave_rows[row..=row + 1],
                s_shape.columns,
            );
        }
        if self.of_master.field.is_some() {
            let rows = &self.master_rows[faces[0]..=faces[1] + 1];
            rise += Self::rise(self.of_master, rows, m_shape.columns);
        }
        if c0.0.min(c1.0) - rise > gap_bound.gap() + slave.dip(row, master, faces) {
            return;
        }
        let nodes = spur.along.is_empty();
        let last = row + 2 == s_shape.rows;
        let count = if nodes {
            1 + usize::from(last)
        } else {
            spur.along.len()
        };
        let tip = m_shape.lengths[m_shape.lengths.len() - 1];
        let s_pose = &pair.poses[k];
        let m_pose = &pair.poses[m];
        let mut from = c0.1;
        let teeth = [0, 1].map(|g| of.tooth(g, &pair.near[g]));
        for i in 0..count {
            let (at, a, length) = if nodes {
                let below = s_shape.lengths[(row + i).saturating_sub(1)];
                let above = s_shape.lengths[(row + i).min(row)];
                (row + i, i as f64, 0.5 * (below + above))
            } else {
                let (a, w) = spur.along[i];
                (row * count + i, a, w * s_shape.lengths[row])
            };
            work.points += 1;
            let own = &slave.points[at];
            let x = pair.turns[k].point(own);
            let (face, place) = master.row_at(master.height(&x), from);
            from = face;
            if !(-1.0..=2.0).contains(&place) {
                continue;
            }
            let past = (0.5 * length / tip).min(MOST_PAST);
            if master.clearance_bound(&x, face) - rise > gap_bound.gap() {
                continue;
            }
            let (height, gradient) = master.tip_place(&x);
            let gradient = m_pose.turn(&Vec3::new(gradient.x, gradient.y, 0.0));
            let Some(taper) = TipTaper::new((height, gradient), past) else {
                continue;
            };
            work.projections += 1;
            let Some(foot) = master.project(&x, face, place) else {
                continue;
            };
            if foot.gap > pair.limit {
                continue;
            }
            pair.meet(m, foot.row..=foot.row + 1, self.of_master, self.master_rows);
            let turn = |n: &Vec2| m_pose.turn(&Vec3::new(n.x, n.y, 0.0));
            let (normal, sensitivity) = (turn(&foot.normal), turn(&foot.sensitivity));
            for cell in &spur.cells[k] {
                let of_slave = Self::at(
                    self.of_slave,
                    self.slave_rows,
                    (row, a),
                    (cell.column, cell.b),
                );
                let of_master = Self::at(
                    self.of_master,
                    self.master_rows,
                    (foot.row, foot.a),
                    (cell.on, cell.b_on),
                );
                let gap0 = foot.gap - of_slave - of_master;
                if !gap_bound.takes(gap0) {
                    continue;
                }
                let area = if nodes {
                    s_shape.areas[(row + i) * s_shape.columns + cell.index]
                } else {
                    let face = row * (s_shape.columns - 1) + cell.column;
                    s_shape.areas[(face * count + i) * spur.across + cell.index]
                };
                let s_slots = Self::corners(self.slave_rows, row, cell.column);
                let m_slots = Self::corners(self.master_rows, foot.row, cell.on);
                let s_weights = weights(a, cell.b);
                let m_weights = weights(foot.a, cell.b_on);
                let (slots, weights) = if k == 0 {
                    ([s_slots, m_slots], [s_weights, m_weights])
                } else {
                    ([m_slots, s_slots], [m_weights, s_weights])
                };
                let mut point = NodalPoint {
                    mesh: 0,
                    slot: u8::from(pair.side == Side::Right),
                    slave: k as u8,
                    partner: None,
                    line: None,
                    teeth,
                    x: s_pose.point(&Vec3::new(own.x, own.y, cell.z)),
                    normal,
                    sensitivity: [sensitivity, Vec3::zeros()],
                    place: [foot.a, cell.b_on],
                    slots,
                    weights,
                    gap0,
                    stiffness: of.penalty[k] * area,
                    share: of.share(k, area),
                    taper_gradient: Vec3::zeros(),
                };
                of.taper(&mut point, &taper);
                out.points.push(point);
            }
        }
    }
}

/// Returns the bilinear weights of the corners, as [`super::Flanks::weights`].
#[inline]
fn weights(a: f64, b: f64) -> [f64; 4] {
    [(1.0 - a) * (1.0 - b), a * (1.0 - b), a * b, (1.0 - a) * b]
}
