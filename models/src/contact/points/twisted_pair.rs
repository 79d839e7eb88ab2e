//! Point search between [twisted](super::twisted) flanks: sections select the points, surfaces locate them.

use super::corners::{Corners, weights};
use super::flanked::NearbyFlank;
use super::mesh_flanks::MeshFlanks;
use super::patch::Patch;
use super::poses::MeshPoses;
use super::profile::Profile;
use super::projection::{DeformedSurface, MOST_PAST, ProjectionStart, TipTaper};
use super::rule::FlankPoint;
use super::sections::Cell;
use super::spur::{OppositeFlanks, facing};
use super::surface::Shape;
use super::twisted::{BESIDE, SectionMap, TwistedCell, TwistedFlanks};
use crate::Vec3;
use crate::contact::gear_state::SearchWork;
use crate::contact::nodal::{GapBound, NodalGearState, NodalPoint, NodalPoints};
use crate::geometry::Side;
use crate::kinematics::{Pose, Tooth};

/// Buffers of the search, reused between evaluations.
#[derive(Debug, Default)]
pub(super) struct TwistedScratch {
    first: Vec<NearbyFlank>,
    pairs: Vec<OppositeFlanks>,
    /// Maps from the sections of each gear, as slave, to those of the other.
    maps: [Vec<SectionMap>; 2],
    /// Lower bound of the gap of each row of the slave in a section [m], and the face of the master for which it was
    /// computed.
    clear: Vec<(f64, usize)>,
}

impl TwistedFlanks {
    /// Finds the points of a mesh at a state; `limit` is the largest gap that displacements can close.
    #[allow(clippy::too_many_arguments)]
    pub fn points(
        &self,
        of: &MeshFlanks,
        mut sides: [NodalGearState<'_>; 2],
        poses: &MeshPoses,
        limit: f64,
        buffers: &mut TwistedScratch,
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) -> SearchWork {
        let mut work = SearchWork::default();
        let TwistedScratch {
            first,
            pairs,
            maps,
            clear,
        } = buffers;
        facing(of, poses, limit, first, pairs);
        if !pairs.is_empty() {
            let poses = &poses.poses;
            let frames = [0, 1].map(|k| self.relative_frame(&poses[k], &poses[1 - k]));
            for k in 0..2 {
                self.maps(k, &frames[k], &mut maps[k]);
            }
            for (_, a, b, side) in &*pairs {
                let near = [a, b];
                work.pairs += 1;
                work.flanks += 2;
                for k in (0..2).filter(|k| of.penalty[*k] > 0.0) {
                    let mut pass = Pass {
                        twisted: self,
                        of,
                        profiles: [0, 1].map(|k| &self.profiles[k][near[k].shape]),
                        shapes: [0, 1].map(|k| &of.gears[k].shapes[near[k].shape]),
                        patches: &self.patches[1 - k][near[1 - k].shape],
                        points: [0, 1].map(|k| &*self.points[k][near[k].shape]),
                        s: a.s,
                        teeth: [0, 1].map(|k| of.tooth(k, near[k])),
                        side: *side,
                        k,
                        poses,
                        frame: &frames[k],
                        limit,
                        clear: &mut *clear,
                        sides: &mut sides,
                        gap_bound: &mut *gap_bound,
                        out: &mut *out,
                        work: &mut work,
                    };
                    for (cell, map) in self.cells[k].iter().zip(&maps[k]) {
                        pass.cell(cell, map);
                    }
                }
            }
        }
        work.nodes = sides.iter().map(|s| s.nodes.nodes.len()).sum();
        work
    }
}

/// A face of the slave at a position over the width.
struct SlaveFace<'a> {
    row: usize,
    cell: Cell,
    map: &'a SectionMap,
    of_slave: Corners,
    /// Corners of the face of the master opposite to the last point.
    of_master: Corners,
    /// Largest gap that displacements can close there [m].
    rise: f64,
    /// Face of the master at which the next search starts.
    master_face: usize,
    /// True if one of its points may touch.
    near: bool,
}

/// Search for the points of the slave `k` of a pair of flanks on the other.
struct Pass<'a, 'b> {
    twisted: &'a TwistedFlanks,
    of: &'a MeshFlanks,
    profiles: [&'a Profile; 2],
    shapes: [&'a Shape; 2],
    /// Faces of the master as polynomials.
    patches: &'a [Patch],
    /// Points of both flanks, in the order of their areas.
    points: [&'a [Vec3]; 2],
    /// Path coordinate of the flank of the first gear at height zero [m].
    s: f64,
    teeth: [Tooth; 2],
    side: Side,
    k: usize,
    poses: &'a [Pose; 2],
    /// Frame of the slave in that of the master.
    frame: &'a Pose,
    limit: f64,
    clear: &'a mut Vec<(f64, usize)>,
    sides: &'a mut [NodalGearState<'b>; 2],
    gap_bound: &'a mut GapBound,
    out: &'a mut NodalPoints,
    work: &'a mut SearchWork,
}

impl<'a> Pass<'a, '_> {
    /// Converts a gap in a section to a lower bound of the gap in space.
    #[inline]
    fn in_space(&self, gap: f64) -> f64 {
        let along = if gap > 0.0 {
            self.of.helix_cos * gap
        } else {
            gap
        };
        along - self.twisted.doubt(along, 0.0)
    }

    /// Finds the points at a position over the width: rows from the smallest gap outwards, until they are clearly
    /// open.
    fn cell(&mut self, of_cell: &TwistedCell, map: &SectionMap) {
        let (slave, master) = (self.profiles[self.k], self.profiles[1 - self.k]);
        let mut cell = of_cell.cell;
        let path = self.s + self.side.sign() * self.twisted.path_by_height(self.of, cell.z);
        let start = TwistedFlanks::facing(self.profiles, self.k, (self.of, path), &map.turn);
        if !self.twisted.parallel {
            let z = TwistedFlanks::height(self.frame, of_cell, &start);
            (cell.on, cell.b_on) = self.shapes[1 - self.k].column_at(z);
            if !(-BESIDE..=1.0 + BESIDE).contains(&cell.b_on) {
                return;
            }
        }
        let height = slave.height(&start);
        let (middle, _) = slave.row_at(height, slave.near(height));
        let mut from = master.near(master.height(&map.point(&start)));
        self.clear.clear();
        self.clear.resize(slave.faces() + 1, (f64::INFINITY, 0));
        let mut look = |row: usize| {
            let (gap, face) = master.clearance(&map.point(&slave.knots[row]), from);
            from = face;
            let gap = self.in_space(gap);
            self.clear[row] = (gap, face);
            gap <= self.limit + slave.dip(row.min(slave.faces() - 1), master, [face; 2])
        };
        let (mut low, mut high) = (middle, middle + 1);
        let mut on = look(low);
        while on && low > 0 {
            low -= 1;
            on = look(low);
        }
        let mut on = look(high);
        while on && high < slave.faces() {
            high += 1;
            on = look(high);
        }
        let place = slave.row_at(height, middle).1;
        self.face(middle, place, cell, map);
        for row in (low..high).filter(|row| *row != middle) {
            let from = if row < middle { 1.0 } else { 0.0 };
            self.face(row, from, cell, map);
        }
    }

    /// Finds the points of a face of the slave at a position over the width, outwards from the nearest one.
    fn face(&mut self, row: usize, from: f64, cell: Cell, map: &SectionMap) {
        let (k, m) = (self.k, 1 - self.k);
        let (s_shape, m_shape) = (self.shapes[k], self.shapes[m]);
        let (c0, c1) = (self.clear[row], self.clear[row + 1]);
        let dip = self.profiles[k].dip(row, self.profiles[m], [c0.1, c1.1]);
        let least = c0.0.min(c1.0) - dip;
        if least > self.limit {
            return;
        }
        // With the given displacements the face may have a gap.
        let of_slave = Corners::of(&mut self.sides[k], s_shape, row, cell.column);
        let of_master = Corners::of(&mut self.sides[m], m_shape, c0.1, cell.on);
        let mut highest = of_master.highest();
        let others = c0.1.min(c1.1)..=c0.1.max(c1.1);
        for face in others.filter(|face| *face != c0.1) {
            let corners = Corners::of(&mut self.sides[m], m_shape, face, cell.on);
            highest = highest.max(corners.highest());
        }
        let rise = of_slave.highest() + highest;
        if least - rise > self.gap_bound.gap() {
            return;
        }
        let count = match self.twisted.along.len() {
            0 => 1 + usize::from(row + 2 == s_shape.rows),
            count => count,
        };
        let mut on = SlaveFace {
            row,
            cell,
            map,
            of_slave,
            rise,
            of_master,
            master_face: c0.1,
            near: false,
        };
        // Along a convex flank the gap grows outwards of the nearest point, which need not be the first one.
        let middle = ((from * count as f64) as usize).min(count);
        for i in middle..count {
            if !self.may_touch(&mut on, i, count) {
                break;
            }
        }
        for i in (0..middle).rev() {
            if !self.may_touch(&mut on, i, count) {
                break;
            }
        }
    }

    /// Evaluates point `i` of `count` of a face; returns false where it and all points further out are clearly open. A
    /// clearly open point proves that once another one was nearer.
    #[inline]
    fn may_touch(&mut self, on: &mut SlaveFace<'_>, i: usize, count: usize) -> bool {
        let (twisted, k, m) = (self.twisted, self.k, 1 - self.k);
        let (slave, master) = (self.profiles[k], self.profiles[m]);
        let (s_shape, m_shape) = (self.shapes[k], self.shapes[m]);
        let (row, cell) = (on.row, on.cell);
        let nodes = twisted.along.is_empty();
        let (at, a, length) = if nodes {
            let below = s_shape.lengths[(row + i).saturating_sub(1)];
            let above = s_shape.lengths[(row + i).min(row)];
            (row + i, i as f64, 0.5 * (below + above))
        } else {
            let (a, w) = twisted.along[i];
            (row * count + i, a, w * s_shape.lengths[row])
        };
        self.work.points += 1;
        let x = on.map.point(&slave.points[at]);
        let (face, place) = master.row_at(master.height(&x), on.master_face);
        on.master_face = face;
        if !(-1.0..=2.0).contains(&place) {
            return true;
        }
        let tip = m_shape.lengths[m_shape.lengths.len() - 1];
        let past = (0.5 * length / tip).min(MOST_PAST);
        // A point that faces the flank and has a positive gap.
        let least = self.in_space(master.clearance_bound(&x, face));
        let least_doubt = twisted.doubt(least, on.rise.abs());
        if (0.0..=1.0).contains(&place)
            && (least > self.limit || least - on.rise - least_doubt > self.gap_bound.gap())
        {
            return !on.near;
        }
        let s_weights = weights(a, cell.b);
        // Where the projection in the section leaves the flank the one in space decides.
        let mut begin = ProjectionStart {
            row: face,
            column: cell.on,
            place: [place, cell.b_on],
        };
        if let Some(foot) = master.project_nearly(&x, face, place) {
            let drift = twisted.twists[m].drift(&(x - foot.gap * foot.normal));
            let w = -foot.normal.dot(&drift);
            let cos2 = (1.0 + w * w).recip();
            let gap = cos2.sqrt() * foot.gap;
            let doubt = twisted.doubt(gap, on.rise.abs());
            if gap - doubt > self.limit || gap - on.rise - doubt > self.gap_bound.gap() {
                return !on.near;
            }
            on.near = true;
            if on.of_master.face != (foot.row, cell.on) {
                on.of_master = Corners::of(&mut self.sides[m], m_shape, foot.row, cell.on);
            }
            let of_master = &on.of_master;
            let m_weights = weights(foot.a, cell.b_on);
            let (up, down) = (on.of_slave.at(&s_weights), of_master.at(&m_weights));
            let doubt = twisted.doubt(gap, up.abs() + down.abs());
            if gap - up - down - doubt > self.gap_bound.gap() {
                return true;
            }
            let along = foot.gap * w * cos2;
            let width = m_shape.z[cell.on + 1] - m_shape.z[cell.on];
            begin.row = foot.row;
            begin.place = [
                foot.a + along * foot.sensitivity.dot(&drift),
                cell.b_on - along / width,
            ];
        }
        let number = if nodes {
            (row + i) * s_shape.columns + cell.index
        } else {
            let face = row * (s_shape.columns - 1) + cell.column;
            (face * count + i) * twisted.across + cell.index
        };
        let point = FlankPoint {
            row,
            column: cell.column,
            a,
            b: cell.b,
            area: s_shape.areas[number],
            length,
        };
        let own = &self.points[k][number];
        self.point((&point, own), &s_weights, on, begin, past);
        true
    }

    /// Projects a point on the surface of the master, in the frame of the master.
    fn point(
        &mut self,
        (p, own): (&FlankPoint, &Vec3),
        s_weights: &[f64; 4],
        on: &mut SlaveFace<'_>,
        begin: ProjectionStart,
        past: f64,
    ) {
        let (k, m) = (self.k, 1 - self.k);
        let m_shape = self.shapes[m];
        let x = self.frame.point(own);
        let (height, gradient) = self.profiles[m].tip_place(&x.xy());
        let pose = &self.poses[m];
        let gradient = pose.turn(&Vec3::new(gradient.x, gradient.y, 0.0));
        let Some(taper) = TipTaper::new((height, gradient), past) else {
            return;
        };
        self.work.projections += 1;
        let surface = DeformedSurface {
            shape: m_shape,
            x: &m_shape.positions,
            pose: &Pose::STILL,
            patches: Some(self.patches),
        };
        let Some(hit) = surface.project(&x, begin) else {
            return;
        };
        if hit.gap > self.limit {
            return;
        }
        if on.of_master.face != (hit.row, hit.column) {
            on.of_master = Corners::of(&mut self.sides[m], m_shape, hit.row, hit.column);
        }
        let (of_slave, of_master) = (&on.of_slave, &on.of_master);
        let m_weights = weights(hit.a, hit.b);
        let gap0 = hit.gap - of_slave.at(s_weights) - of_master.at(&m_weights);
        if !self.gap_bound.takes(gap0) {
            return;
        }
        let (slots, weights) = if k == 0 {
            ([of_slave.slots, of_master.slots], [*s_weights, m_weights])
        } else {
            ([of_master.slots, of_slave.slots], [m_weights, *s_weights])
        };
        let mut point = NodalPoint {
            mesh: 0,
            slot: u8::from(self.side == Side::Right),
            slave: k as u8,
            partner: None,
            line: None,
            teeth: self.teeth,
            x: self.poses[k].point(own),
            normal: pose.turn(&hit.normal),
            sensitivity: hit.sensitivity(&x).map(|e| pose.turn(&e)),
            place: [hit.a, hit.b],
            slots,
            weights,
            gap0,
            stiffness: self.of.penalty[k] * p.area,
            share: self.of.share(k, p.area),
            taper_gradient: Vec3::zeros(),
        };
        self.of.taper(&mut point, &taper);
        self.out.points.push(point);
    }
}
