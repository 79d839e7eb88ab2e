//! The search where all flanks move with their hubs and look the same in every transverse plane: in two dimensions.
//!
//! A point and a flank meet in the transverse plane whatever their place over the width, so that one projection serves
//! all points of a line over it. Everything stands in the gears' own frames from the start; an evaluation needs one
//! pose of each gear against the other. Along a pair of flanks the gap grows from the point that faces the other flank
//! best: rows are looked at from there on outwards, and no further than displacements can close the gap.

use super::flanked::{Flanked, Near};
use super::profile::{Profile, Vec2};
use super::projection::RIM;
use super::search::{FlankPoints, MOST_PAST};
use super::surface::{Rule, Shape};
use crate::Vec3;
use crate::contact::nodal::{GapBound, NodalParty, NodalPoint, NodalPoints, UNUSED};
use crate::contact::party::SearchWork;
use crate::geometry::Side;
use crate::kinematics::Pose;

/// Flanks of both gears as profiles.
#[derive(Clone, Debug)]
pub(super) struct Spur {
    profiles: [Vec<Profile>; 2],
    /// Places over the width of the points of each gear, as slave.
    cells: [Vec<Cell>; 2],
    /// Points along the profile of a face with their weights; none where points are nodes.
    along: Vec<(f64, f64)>,
    across: usize,
}

/// A place over the width.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// Height [m].
    z: f64,
    /// Column of the slave's face, place there, and index of the point among those of a face over the width (of the
    /// rule at nodes, column of the node).
    column: usize,
    b: f64,
    index: usize,
    /// Column of the master's face and place there.
    on: usize,
    b_on: f64,
}

/// Buffers; they grow and stay.
#[derive(Debug, Default)]
pub(super) struct SpurScratch {
    pairs: Vec<(f64, Near, Near, Side)>,
    /// Per gear: slot of the first node of each row, [`UNUSED`] where it was not met.
    rows: [Vec<u32>; 2],
    /// Gap that each row of the slave surely has [m], and the master's face it was held against.
    clear: Vec<(f64, usize)>,
}

/// Own frame of one gear seen from that of another.
#[derive(Clone, Copy, Debug)]
struct Turn {
    cos: f64,
    sin: f64,
    shift: Vec2,
}

impl Turn {
    fn between(from: &Pose, to: &Pose) -> Self {
        let d = from.origin - to.origin;
        Turn {
            cos: from.cos * to.cos + from.sin * to.sin,
            sin: from.sin * to.cos - from.cos * to.sin,
            shift: Vec2::new(to.cos * d.x + to.sin * d.y, to.cos * d.y - to.sin * d.x),
        }
    }

    #[inline]
    fn point(&self, x: &Vec2) -> Vec2 {
        Vec2::new(
            self.cos * x.x - self.sin * x.y + self.shift.x,
            self.sin * x.x + self.cos * x.y + self.shift.y,
        )
    }
}

impl Spur {
    /// Profiles of both gears, where their flanks allow it.
    pub fn new(gears: &[Flanked; 2], rule: &Rule) -> Option<Self> {
        let profiles = |g: &Flanked| -> Option<Vec<Profile>> {
            let first = &g.shapes[0];
            let alike = |s: &Shape| s.z == first.z && s.z.is_sorted_by(|a, b| a < b);
            (g.rigid && g.shapes.iter().all(alike))
                .then(|| g.shapes.iter().map(|s| Profile::new(s, rule, g.rack)))?
                .collect()
        };
        let profiles = [profiles(&gears[0])?, profiles(&gears[1])?];
        let cells = [0, 1].map(|k| cells(&gears[k].shapes[0], &gears[1 - k].shapes[0], rule));
        Some(Spur {
            profiles,
            cells,
            along: rule.along().to_vec(),
            across: rule.across().len(),
        })
    }

    /// The points of a mesh at a state, `limit` the largest gap that displacements can close.
    pub fn points(
        &self,
        of: &FlankPoints,
        mut sides: [NodalParty<'_>; 2],
        displacements: [f64; 2],
        limit: f64,
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        let mut scratch = of.scratch.borrow_mut();
        let mut first = std::mem::take(&mut scratch.first);
        let mut buffers = std::mem::take(&mut scratch.spur);
        let mut work = SearchWork::default();
        self.find_pairs(of, displacements, limit, &mut first, &mut buffers.pairs);
        if !buffers.pairs.is_empty() {
            let poses = [0, 1].map(|k| of.gears[k].placement.pose(displacements[k]));
            let turns = [
                Turn::between(&poses[0], &poses[1]),
                Turn::between(&poses[1], &poses[0]),
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
                pair.points(&mut sides, &mut buffers, &mut work, gap_bound, out);
            }
            buffers.pairs = pairs;
        }
        work.nodes = sides.iter().map(|s| s.nodes.nodes.len()).sum();
        scratch.first = first;
        scratch.spur = buffers;
        scratch.work = work;
    }

    /// Flanks that face each other within the limit, the nearest pair first.
    fn find_pairs(
        &self,
        of: &FlankPoints,
        displacements: [f64; 2],
        limit: f64,
        first: &mut Vec<Near>,
        pairs: &mut Vec<(f64, Near, Near, Side)>,
    ) {
        pairs.clear();
        let limit = limit + of.gears[0].deviation_bound + of.gears[1].deviation_bound;
        for side in Side::BOTH {
            first.clear();
            of.gears[0].each_near(side, displacements[0], of.zone, |near| first.push(near));
            for near in first.iter() {
                let facing = of.length - near.s;
                let range = [facing - limit, facing + 0.5 * of.base_pitch];
                of.gears[1].each_near(side, displacements[1], range, |other| {
                    pairs.push((facing - other.s, *near, other, side));
                });
            }
        }
        pairs.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
    }
}

/// Places over the width at which points of a slave meet a master.
fn cells(slave: &Shape, master: &Shape, rule: &Rule) -> Vec<Cell> {
    let mut all = Vec::new();
    let mut add = |column: usize, b: f64, index: usize| {
        let z = slave.z[column] + b * (slave.z[column + 1] - slave.z[column]);
        let (on, b_on) = master.column_at(z);
        if (-RIM..=1.0 + RIM).contains(&b_on) {
            all.push(Cell {
                z,
                column,
                b,
                index,
                on,
                b_on,
            });
        }
    };
    if rule.is_nodes() {
        for c in 0..slave.columns {
            let column = c.min(slave.columns - 2);
            add(column, (c - column) as f64, c);
        }
    } else {
        for column in 0..slave.columns - 1 {
            for (index, &(b, _)) in rule.across().iter().enumerate() {
                add(column, b, index);
            }
        }
    }
    all
}

/// A pair of flanks at a state.
struct Pair<'a> {
    spur: &'a Spur,
    of: &'a FlankPoints,
    near: [Near; 2],
    side: Side,
    poses: &'a [Pose; 2],
    /// From the frame of the first gear to that of the second, and back.
    turns: &'a [Turn; 2],
    limit: f64,
}

impl Pair<'_> {
    fn profile(&self, k: usize) -> &Profile {
        &self.spur.profiles[k][self.near[k].shape]
    }

    fn shape(&self, k: usize) -> &Shape {
        &self.of.gears[k].shapes[self.near[k].shape]
    }

    /// Points of both passes.
    fn points(
        &self,
        sides: &mut [NodalParty<'_>; 2],
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

    /// Places in both own frames where the flanks face each other best: where the line of action crosses them, or,
    /// where it leaves a flank, at the end of that flank.
    fn start(&self) -> [Vec2; 2] {
        let (first, second) = (self.profile(0), self.profile(1));
        let rb = self.of.gears[0].base_radius.unwrap_or(0.0);
        let x = first.at_height(rb * rb + self.near[0].s * self.near[0].s);
        let y = second.at_height(second.height(&self.turns[0].point(&x)));
        let x = first.at_height(first.height(&self.turns[1].point(&y)));
        [x, y]
    }

    /// Meets rows of nodes of a gear.
    fn meet(
        &self,
        k: usize,
        rows: std::ops::RangeInclusive<usize>,
        side: &mut NodalParty<'_>,
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
            let first = side.nodes.meet_new(field, side.party.at, nodes);
            for i in 0..new {
                slots[row + i] = first + (i * columns) as u32;
            }
            row += new;
        }
    }

    /// Points of gear `k` against the other.
    #[allow(clippy::too_many_arguments)]
    fn hold(
        &self,
        k: usize,
        start: &Vec2,
        sides: &mut [NodalParty<'_>; 2],
        buffers: &mut SpurScratch,
        work: &mut SearchWork,
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        let m = 1 - k;
        let (slave, master) = (self.profile(k), self.profile(m));
        let chord_bound = &self.shape(k).chord_bound;
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
            clear[row].0 <= self.limit + chord_bound[row.min(chord_bound.len() - 1)]
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
        let clearance_bound =
            |row: usize| clear[row].0.min(clear[row + 1].0) > self.limit + chord_bound[row];
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
        let mut face = Held {
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

/// Points of one gear's flank held against the other's.
struct Held<'a, 'b, 'c> {
    pair: &'a Pair<'b>,
    k: usize,
    of_slave: &'a mut NodalParty<'c>,
    of_master: &'a mut NodalParty<'c>,
    slave_rows: &'a mut Vec<u32>,
    master_rows: &'a mut Vec<u32>,
    clear: &'a [(f64, usize)],
}

impl Held<'_, '_, '_> {
    /// Largest displacement of the nodes of rows that were met.
    fn rise(side: &NodalParty<'_>, slots: &[u32], columns: usize) -> f64 {
        let met = slots.iter().filter(|s| **s != UNUSED);
        met.fold(f64::NEG_INFINITY, |most, &slot| {
            let of_row = &side.nodes.displacement[slot as usize..][..columns];
            of_row.iter().fold(most, |m, a| m.max(*a))
        })
    }

    /// Displacement at a place of a face; zero without a field.
    #[inline]
    fn at(
        side: &NodalParty<'_>,
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

    /// Slots of the corners of a face; none without a field.
    #[inline]
    fn corners(rows: &[u32], row: usize, column: usize) -> [u32; 4] {
        if rows[row] == UNUSED {
            return [UNUSED; 4];
        }
        let (below, above) = (rows[row] + column as u32, rows[row + 1] + column as u32);
        [below, above, above + 1, below + 1]
    }

    /// Points of a face of the slave.
    fn points(
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
        // With the displacements at hand the face may stand off.
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
        if c0.0.min(c1.0) - rise > gap_bound.gap() + s_shape.chord_bound[row] {
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
            work.projections += 1;
            let Some(foot) = master.project(&x, face, place, past) else {
                continue;
            };
            if foot.gap > pair.limit {
                continue;
            }
            // The part of its length that is on the flank: points leave over the tip without a jump.
            let (on, slope) = if foot.row + 2 == m_shape.rows {
                let on = 0.5 + 0.5 * (1.0 - foot.a) / past;
                let fades = (0.0..=1.0).contains(&on);
                (on.clamp(0.0, 1.0), if fades { -0.5 / past } else { 0.0 })
            } else {
                (1.0, 0.0)
            };
            if on == 0.0 {
                continue;
            }
            pair.meet(m, foot.row..=foot.row + 1, self.of_master, self.master_rows);
            let turn = |n: &Vec2| m_pose.turn(&Vec3::new(n.x, n.y, 0.0));
            let space = s_pose.point(&Vec3::new(own.x, own.y, 0.0));
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
                let area = on
                    * if nodes {
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
                out.points.push(NodalPoint {
                    mesh: 0,
                    slot: u8::from(pair.side == Side::Right),
                    slave: k as u8,
                    partner: None,
                    teeth,
                    x: Vec3::new(space.x, space.y, cell.z),
                    normal,
                    sensitivity: [sensitivity, Vec3::zeros()],
                    place: [foot.a, cell.b_on],
                    slots,
                    weights,
                    gap0,
                    stiffness: of.penalty[k] * area,
                    share: area * of.penalty[k] / (of.penalty[0] + of.penalty[1]),
                    weight_derivative: slope / on,
                });
            }
        }
    }
}

/// Bilinear weights of the corners, as [`super::Flanks::weights`].
#[inline]
fn weights(a: f64, b: f64) -> [f64; 4] {
    [(1.0 - a) * (1.0 - b), a * (1.0 - b), a * b, (1.0 - a) * b]
}
