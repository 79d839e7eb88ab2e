//! The point search: candidates of a mesh at a state.

use super::coarse::{CoarseScratch, CoarseStep, FlankBoxes, ToothIndices};
use super::flanked::{Flanked, Near, Owner};
use super::projection::{Begin, Deformed, Hit};
use super::spur::{Spur, SpurScratch};
use super::surface::{FlankPoint, Rule, Shape};
use crate::Vec3;
use crate::contact::candidate::Candidate;
use crate::contact::clearance::Clearance;
use crate::contact::nodal::{
    GapBound, GearNodes, NodalParty, NodalPoint, NodalPoints, UNUSED, weighted,
};
use crate::contact::pairs::MeshGeometry;
use crate::contact::party::{Party, SearchWork, Wanted};
use crate::error::Reason;
use crate::gear::FlankDisplacement;
use crate::geometry::{Flanks, Side};
use crate::kinematics::{Locus, Point, Pose, Tooth};
use crate::spec::{CoarseSearch, Passes, PointContact};
use std::cell::RefCell;

/// Part of the base pitch up to which undeformed flanks are looked at.
const REACH: f64 = 0.02;
/// Part of the base pitch by which teeth may touch before and after the path of contact.
const BEFORE_AND_AFTER: f64 = 0.5;
/// Part of the last face by which a point may at most lie beyond the tip and still count.
pub(super) const MOST_PAST: f64 = 0.5;

/// Flank points of one gear against the flank surfaces of the other.
///
/// The search has no discrete state, no slots and no event functions: points open and close all the time, so the force
/// is clipped and runs with it do not locate events.
#[derive(Debug)]
pub struct FlankPoints {
    pub(super) gears: [Flanked; 2],
    rule: Rule,
    /// Penalty for the points of each gear [Pa/m]; 0 where they are not looked at.
    pub(super) penalty: [f64; 2],
    pub(super) reach: f64,
    /// All points within reach are wanted: gaps are averaged over them.
    hard: bool,
    pub(super) length: f64,
    helix_cos: f64,
    pub(super) base_pitch: f64,
    /// Path coordinates of the first gear at which its flanks are looked at [m].
    pub(super) zone: [f64; 2],
    lines: [Option<[Vec3; 2]>; 2],
    /// Which flanks are looked at.
    coarse: Box<dyn CoarseStep>,
    /// The search in the transverse plane, where flanks allow it.
    spur: Option<Spur>,
    pub(super) scratch: RefCell<Scratch>,
}

/// A flank at a state.
#[derive(Clone, Copy, Debug)]
struct Active {
    near: Near,
    pose: Pose,
    /// Its nodes in the buffer of positions.
    start: usize,
}

/// Buffers; they grow to the most that was ever active and stay.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    pub first: Vec<Near>,
    active: [Vec<Active>; 2],
    positions: [Vec<Vec3>; 2],
    coarse: CoarseScratch,
    pairs: Vec<[usize; 2]>,
    /// Clearance of each node of a flank [m].
    heights: Vec<f64>,
    /// Of the search in the transverse plane.
    pub spur: SpurScratch,
    pub work: SearchWork,
}

/// A point of gear `k`, the slave, that is projected on the other gear, the master.
pub(super) struct Found<'a> {
    pub k: usize,
    /// Slave and master.
    pub flanks: [&'a Deformed<'a>; 2],
    active: [&'a Active; 2],
    /// With the part of its area that is on the master.
    pub point: FlankPoint,
    pub x: Vec3,
    pub hit: Hit,
    /// `A' / A` of that area by the place along the master's face.
    pub weight_derivative: f64,
}

impl FlankPoints {
    /// Builds the search of a mesh. `lines` are the ends of its lines of action, for pictures.
    ///
    /// # Errors
    /// What is wrong with the settings or with the flanks of a gear (0 or 1), and a way out.
    pub fn new(
        owners: [Owner<'_>; 2],
        geometry: &MeshGeometry,
        settings: &PointContact,
        lines: [Option<[Vec3; 2]>; 2],
    ) -> Result<Self, (Option<usize>, Reason)> {
        if let Some(problem) = settings.problem() {
            return Err((None, problem));
        }
        let rule = Rule::new(settings.rule);
        let flanked =
            |k: usize| Flanked::new(owners[k], settings.surface, &rule).map_err(|e| (Some(k), e));
        let gears = [flanked(0)?, flanked(1)?];
        let p = settings.penalty;
        let penalty = match settings.passes {
            Passes::Auto if gears[0].own || !gears[1].own => [p, 0.0],
            Passes::Auto | Passes::Second => [0.0, p],
            Passes::First => [p, 0.0],
            Passes::Both => [0.5 * p, 0.5 * p],
        };
        let width = gears[0].face_width.min(gears[1].face_width);
        let beside =
            BEFORE_AND_AFTER * geometry.base_pitch + 0.5 * width * geometry.base_helix.tan().abs();
        let reach = settings.reach.unwrap_or(REACH * geometry.base_pitch);
        let by_indices = match settings.coarse {
            CoarseSearch::Auto => gears.iter().all(|g| g.involute),
            CoarseSearch::ToothIndices => true,
            CoarseSearch::Boxes => false,
        };
        let coarse: Box<dyn CoarseStep> = if by_indices {
            Box::new(ToothIndices)
        } else {
            Box::new(FlankBoxes::new(&gears, reach, geometry.base_pitch))
        };
        Ok(FlankPoints {
            coarse,
            spur: by_indices.then(|| Spur::new(&gears, &rule)).flatten(),
            gears,
            rule,
            penalty,
            hard: settings.hard,
            reach,
            length: geometry.length,
            helix_cos: geometry.base_helix.cos(),
            base_pitch: geometry.base_pitch,
            zone: [geometry.zone[0] - beside, geometry.zone[1] + beside],
            lines,
            scratch: RefCell::default(),
        })
    }

    /// First and second step: flanks about the line of centres, and the flanks they face.
    fn find_pairs(&self, parties: [&Party<'_>; 2], scratch: &mut Scratch) {
        let displacement = parties.map(|p| p.gear.hub().displacement(p.at.t, p.at.q));
        scratch.pairs.clear();
        for k in 0..2 {
            scratch.active[k].clear();
            scratch.positions[k].clear();
        }
        if !displacement.iter().all(|t| t.is_finite()) {
            return;
        }
        let mut coarse = std::mem::take(&mut scratch.coarse);
        coarse.pairs.clear();
        for side in Side::BOTH {
            self.coarse.pairs(self, side, displacement, &mut coarse);
        }
        for [near, other] in &coarse.pairs {
            let a = self.activate(0, *near, parties[0], displacement[0], scratch);
            let b = self.activate(1, *other, parties[1], displacement[1], scratch);
            scratch.pairs.push([a, b]);
        }
        scratch.coarse = coarse;
    }

    /// Path coordinates by which flanks may be apart and points still within reach [m].
    pub(super) fn reach_along(&self) -> f64 {
        self.reach / self.helix_cos
    }

    /// Index of a flank among the active ones; its nodes are placed when it is new.
    fn activate(
        &self,
        k: usize,
        near: Near,
        party: &Party<'_>,
        displacement: f64,
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
        let pose = if let Some(surface) = party.gear.surface() {
            surface
                .nodes
                .positions(party.at, &shape.nodes, &mut positions[start..]);
            g.placement.pose(displacement)
        } else {
            let tooth = self.tooth(k, &near);
            let pose = g
                .placement
                .pose(party.gear.tooth_displacement(party.at, tooth));
            let undeformed = &g.grids.grids()[near.shape].positions;
            for (x, u) in positions[start..].iter_mut().zip(undeformed) {
                *x = pose.point(u);
            }
            pose
        };
        active.push(Active { near, pose, start });
        active.len() - 1
    }

    pub(super) fn tooth(&self, k: usize, near: &Near) -> Tooth {
        Tooth {
            index: near.tooth,
            mesh: self.gears[k].mesh,
        }
    }

    fn deformed<'a>(&'a self, k: usize, scratch: &'a Scratch, active: usize) -> Deformed<'a> {
        let a = &scratch.active[k][active];
        let shape = &self.gears[k].shapes[a.near.shape];
        Deformed {
            shape,
            x: &scratch.positions[k][a.start..][..shape.nodes.len()],
            pose: &a.pose,
        }
    }

    /// Height of a point on the flanks of gear `k`, as [`Shape::heights`] has it.
    #[inline]
    fn height(&self, k: usize, pose: &Pose, x: &Vec3) -> f64 {
        let r = x - pose.origin;
        if self.gears[k].rack {
            -(pose.cos * r.x + pose.sin * r.y)
        } else {
            r.x * r.x + r.y * r.y
        }
    }

    /// A point of gear `k`: on its mesh, or on its rigid flank.
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
                radius: if g.rack { height } else { height.sqrt() },
                zeta: 2.0 * x.z / g.face_width,
            }
        };
        Point {
            tooth: self.tooth(k, &active.near),
            locus,
            x,
        }
    }

    /// Third step: the points of gear `k`'s flank against the other flank of a pair. Faces whose corners all
    /// stand clearly off the other flank are passed over.
    fn hold_points(
        &self,
        k: usize,
        pair: [usize; 2],
        (scratch, heights, work): (&Scratch, &mut Vec<f64>, &mut SearchWork),
        limit: f64,
        mut found: impl FnMut(&Found<'_>),
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
            work.projections += 1;
            let past = (0.5 * p.length / tip).min(MOST_PAST);
            let Some(hit) = master.project(&x, begin, past) else {
                return;
            };
            if hit.gap > limit {
                return;
            }
            // The part of its length that is on the flank: points leave over the tip without a jump.
            let (on, slope) = if hit.row + 2 == master.shape.rows {
                let on = 0.5 + 0.5 * (1.0 - hit.a) / past;
                let fades = (0.0..=1.0).contains(&on);
                (on.clamp(0.0, 1.0), if fades { -0.5 / past } else { 0.0 })
            } else {
                (1.0, 0.0)
            };
            if on == 0.0 {
                return;
            }
            let point = FlankPoint {
                area: on * p.area,
                ..p
            };
            found(&Found {
                k,
                flanks: [&slave, &master],
                active,
                point,
                x,
                hit,
                weight_derivative: slope / on,
            });
        });
    }

    /// Where the projection of a point on the master begins, and a gap that it surely has [m]: infinite more
    /// than a face beyond root, tip or sides.
    #[inline]
    fn clearance_bound(&self, m: usize, master: &Deformed<'_>, x: &Vec3) -> (Begin, f64) {
        let (row, a) = master.shape.row_at(self.height(m, master.pose, x));
        let (column, b) = master.shape.column_at(x.z);
        let begin = Begin {
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

    /// The points on both gears.
    #[inline]
    fn points(&self, found: &Found<'_>) -> [Point; 2] {
        let Found {
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
            hit.x,
        );
        if *k == 0 {
            [of_slave, of_master]
        } else {
            [of_master, of_slave]
        }
    }

    #[inline]
    fn candidate(&self, found: &Found<'_>) -> Candidate {
        let Found {
            k,
            flanks: [slave, _],
            point: p,
            hit,
            ..
        } = found;
        // The flank's normal points from the master to the slave, the candidate's from the first gear to
        // the second.
        let points = self.points(found);
        let normal = if *k == 0 { -hit.normal } else { hit.normal };
        Candidate {
            slot: usize::from(slave.shape.side == Side::Right),
            points,
            normal,
            scale: [1.0, 1.0],
            gap: hit.gap,
            stiffness: self.penalty[*k] * p.area,
            stiffness_s: 0.0,
            s: 0.0,
            share: p.area * self.penalty[*k] / (self.penalty[0] + self.penalty[1]),
        }
    }
}

impl FlankPoints {
    /// Calls `found` for all points with a gap up to `limit`.
    fn each_point(&self, parties: [&Party<'_>; 2], limit: f64, mut found: impl FnMut(&Found<'_>)) {
        let mut scratch = self.scratch.borrow_mut();
        self.find_pairs(parties, &mut scratch);
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

    /// A point with the nodes that it lies on, on gears with a field.
    fn nodal_point(
        &self,
        found: &Found<'_>,
        parties: &[Party<'_>; 2],
        nodes: &mut [(Option<&dyn FlankDisplacement>, &mut GearNodes); 2],
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        let Found {
            k,
            flanks: [slave, master],
            point: p,
            x,
            hit,
            weight_derivative,
            ..
        } = found;
        let (k, m) = (*k, 1 - k);
        let (mut slots, mut weights) = ([[UNUSED; 4]; 2], [[0.0; 4]; 2]);
        let mut gap0 = hit.gap;
        let places = [
            (k, slave.shape, p.row, p.column, [p.a, p.b]),
            (m, master.shape, hit.row, hit.column, [hit.a, hit.b]),
        ];
        for (gear, shape, row, column, [a, b]) in places {
            let (field, nodes) = &mut nodes[gear];
            if let Some(field) = field {
                let corners = shape.corners(row, column);
                weights[gear] = Flanks::weights([2.0 * a - 1.0, 2.0 * b - 1.0]);
                slots[gear] = nodes.meet(*field, parties[gear].at, &corners);
                let a = GearNodes::at(&nodes.displacement, &slots[gear]);
                gap0 -= weighted(&weights[gear], &a);
            }
        }
        if !gap_bound.takes(gap0) {
            return;
        }
        let points = self.points(found);
        let other = (0..2).find(|&i| nodes[i].0.is_none() && !self.gears[i].rigid);
        let partner = other.map(|i| {
            out.partners.push(points[i]);
            out.partners.len() as u32 - 1
        });
        out.points.push(NodalPoint {
            mesh: 0,
            slot: u8::from(slave.shape.side == Side::Right),
            slave: k as u8,
            partner,
            teeth: points.map(|p| p.tooth),
            x: *x,
            normal: hit.normal,
            sensitivity: master.sensitivity(x, hit),
            place: [hit.a, hit.b],
            slots,
            weights,
            gap0,
            stiffness: self.penalty[k] * p.area,
            share: p.area * self.penalty[k] / (self.penalty[0] + self.penalty[1]),
            weight_derivative: *weight_derivative,
        });
    }
}

impl FlankPoints {
    /// Appends candidates.
    pub fn candidates(
        &self,
        a: Party<'_>,
        b: Party<'_>,
        wanted: Wanted<'_>,
        out: &mut Vec<Candidate>,
    ) {
        let limit = match wanted {
            Wanted::Closed(_) => 0.0,
            Wanted::Listed => self.reach,
            Wanted::Touching(gap) => gap.min(self.reach),
        };
        let parties = [&a, &b];
        self.each_point(parties, limit, |found| {
            out.push(self.candidate(found));
        });
    }

    /// A lower bound of the gaps of all points of rigid flanks at displacements of both hubs; `None` where flanks move
    /// otherwise or the search does not know.
    #[must_use]
    pub fn clearance(&self, displacements: [f64; 2]) -> Option<Clearance> {
        let mut gaps = [0.0; 2];
        for (side, gap) in Side::BOTH.into_iter().zip(&mut gaps) {
            let [a, b] = [0, 1].map(|k| self.gears[k].foremost(side, displacements[k]));
            let along = self.length - a? - b?;
            let nearest = along - self.base_pitch * (along / self.base_pitch).round();
            *gap = nearest * self.helix_cos;
        }
        Some(Clearance {
            gaps,
            per_displacement: [0, 1].map(|k| -self.helix_cos * self.gears[k].per_displacement()),
        })
    }

    /// Appends the points of a mesh with a gear that has a [flank displacement](crate::gear::FlankDisplacement), of a
    /// gap within the gap_bound before residual compliance, and the nodes that they lie on.
    pub fn nodal_points(
        &self,
        mut sides: [NodalParty<'_>; 2],
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        let displacements = [0, 1].map(|k| {
            let p = &sides[k].party;
            p.gear.hub().displacement(p.at.t, p.at.q)
        });
        let apart = self
            .clearance(displacements)
            .map_or(f64::NEG_INFINITY, |c| c.after([0.0; 2]));
        if apart > self.reach {
            self.scratch.borrow_mut().work = SearchWork::default();
            return;
        }
        let [a, b] = &mut sides;
        let mut limit = (a.bound() + b.bound()).min(self.reach);
        if apart > limit {
            self.scratch.borrow_mut().work = SearchWork::default();
            return;
        }
        if self.hard {
            limit = self.reach;
            gap_bound.least = f64::INFINITY;
        }
        if let Some(spur) = &self.spur {
            spur.points(self, sides, displacements, limit, gap_bound, out);
            return;
        }
        let [a, b] = sides;
        let parties = [a.party, b.party];
        let mut nodes = [(a.field, a.nodes), (b.field, b.nodes)];
        self.each_point(parties.each_ref(), limit, |found| {
            self.nodal_point(found, &parties, &mut nodes, gap_bound, out);
        });
    }

    /// What the last evaluation looked at.
    #[must_use]
    pub fn work(&self) -> SearchWork {
        self.scratch.borrow().work
    }

    /// Ends of the line of action of a flank [m], for pictures.
    #[must_use]
    pub fn line(&self, side: Side) -> Option<[Vec3; 2]> {
        self.lines[usize::from(side == Side::Right)]
    }
}
