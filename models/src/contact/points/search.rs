//! The point search: candidates of a mesh at a state.

use super::coarse_phase::{CoarseStep, FlankBoxes, ToothIndices};
use super::mesh_flanks::MeshFlanks;
use super::narrow_phase::{ProjectedPoint, Scratch};
use super::search_gear::SearchGear;
use super::spur::{Spur, SpurScratch};
use super::twisted::TwistedFlanks;
use super::twisted_pair::TwistedScratch;
use crate::Vec3;
use crate::contact::candidate::Candidate;
use crate::contact::clearance::Clearance;
use crate::contact::gear_state::{CandidateSelection, GearState, SearchWork};
use crate::contact::nodal::{
    GapBound, GearNodes, NodalGearState, NodalPoint, NodalPoints, UNUSED, weighted,
};
use crate::contact::pairs::MeshGeometry;
use crate::error::Reason;
use crate::gear::FlankDisplacement;
use crate::geometry::{Flanks, Side};
use crate::spec::{CoarseSearch, PointContact};
use std::cell::RefCell;

/// Search for contact of flank points of one gear with the flank surfaces of the other.
///
/// The search has no discrete state, no slots and no event functions: points open and close all the time, so the force
/// is clipped and runs with it do not locate events.
#[derive(Debug)]
pub struct FlankPoints {
    flanks: MeshFlanks,
    lines: [Option<[Vec3; 2]>; 2],
    /// Coarse phase, which finds the pairs of flanks.
    coarse: Box<dyn CoarseStep>,
    /// Search in the transverse plane, where the flanks allow it.
    spur: Option<Spur>,
    /// Search in twisted sections, where the flanks allow only that.
    twisted: Option<TwistedFlanks>,
    scratch: RefCell<Scratch>,
    spur_scratch: RefCell<SpurScratch>,
    twisted_scratch: RefCell<TwistedScratch>,
}

impl FlankPoints {
    /// Builds the search of a mesh. `lines` are the ends of its lines of action, for figures.
    ///
    /// # Errors
    /// What is wrong with the settings or with the flanks of a gear (0 or 1), and a way out.
    pub fn new(
        search_gears: [SearchGear<'_>; 2],
        geometry: &MeshGeometry,
        settings: &PointContact,
        lines: [Option<[Vec3; 2]>; 2],
    ) -> Result<Self, (Option<usize>, Reason)> {
        let flanks = MeshFlanks::new(search_gears, geometry, settings)?;
        let gears = &flanks.gears;
        let by_indices = match settings.coarse {
            CoarseSearch::Auto => gears.iter().all(|g| g.involute),
            CoarseSearch::ToothIndices => true,
            CoarseSearch::Boxes => false,
        };
        let coarse: Box<dyn CoarseStep> = if by_indices {
            Box::new(ToothIndices)
        } else {
            Box::new(FlankBoxes::new(gears, flanks.reach, geometry.base_pitch))
        };
        let parallel = flanks.layout.is_none();
        let spur = (by_indices && parallel)
            .then(|| Spur::new(gears, &flanks.rule))
            .flatten();
        let twisted = (by_indices && spur.is_none())
            .then(|| TwistedFlanks::new(gears, &flanks.rule, geometry.base_pitch, parallel))
            .flatten();
        Ok(FlankPoints {
            coarse,
            spur,
            twisted,
            flanks,
            lines,
            scratch: RefCell::default(),
            spur_scratch: RefCell::default(),
            twisted_scratch: RefCell::default(),
        })
    }

    /// Appends candidates.
    pub fn candidates(
        &self,
        a: GearState<'_>,
        b: GearState<'_>,
        selection: CandidateSelection<'_>,
        out: &mut Vec<Candidate>,
    ) {
        let limit = match selection {
            CandidateSelection::Closed(_) => 0.0,
            CandidateSelection::Listed | CandidateSelection::Watched(_) => self.flanks.reach,
            CandidateSelection::Touching(gap) => gap.min(self.flanks.reach),
        };
        let gear_states = [&a, &b];
        let mut scratch = self.scratch.borrow_mut();
        (self.flanks).each_point(&*self.coarse, gear_states, limit, &mut scratch, |found| {
            out.push(self.candidate(found));
        });
    }

    /// Appends the points of a mesh with a gear that has a [flank displacement](crate::gear::FlankDisplacement), with
    /// a gap within `gap_bound` before residual compliance, and registers their nodes.
    pub fn nodal_points(
        &self,
        mut sides: [NodalGearState<'_>; 2],
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        let poses = self
            .flanks
            .poses([&sides[0].gear_state, &sides[1].gear_state]);
        let apart = self
            .flanks
            .clearance(poses.displacements)
            .map_or(f64::NEG_INFINITY, |c| c.after([0.0; 2]) - poses.beside);
        if apart > self.flanks.reach {
            self.scratch.borrow_mut().work = SearchWork::default();
            return;
        }
        let [a, b] = &mut sides;
        let displaced = a.bound() + b.bound();
        if apart > displaced.min(self.flanks.reach) {
            self.scratch.borrow_mut().work = SearchWork::default();
            return;
        }
        // Nodes next to loaded ones may rise: points that nearly touch count as well.
        let mut limit = displaced + gap_bound.gap_after(displaced - apart);
        limit = limit.min(self.flanks.reach);
        if self.flanks.hard {
            limit = self.flanks.reach;
            gap_bound.least = f64::INFINITY;
        }
        if let Some(spur) = &self.spur {
            let buffers = &mut self.spur_scratch.borrow_mut();
            let work = spur.points(&self.flanks, sides, &poses, limit, buffers, gap_bound, out);
            self.scratch.borrow_mut().work = work;
            return;
        }
        if let Some(twisted) = &self.twisted {
            let buffers = &mut self.twisted_scratch.borrow_mut();
            let work = twisted.points(&self.flanks, sides, &poses, limit, buffers, gap_bound, out);
            self.scratch.borrow_mut().work = work;
            return;
        }
        let [a, b] = sides;
        let gear_states = [a.gear_state, b.gear_state];
        let mut nodes = [(a.field, a.nodes), (b.field, b.nodes)];
        let parts = gear_states.each_ref();
        let mut scratch = self.scratch.borrow_mut();
        (self.flanks).each_point(&*self.coarse, parts, limit, &mut scratch, |found| {
            self.nodal_point(found, &gear_states, &mut nodes, gap_bound, out);
        });
    }

    /// Returns lower bounds of the gaps of all points of rigid flanks at displacements of both hubs; `None` where
    /// flanks or hubs move otherwise or no bound is known.
    pub fn clearance(&self, displacements: [f64; 2]) -> Option<Clearance> {
        let parallel = self.flanks.layout.is_none();
        parallel.then(|| self.flanks.clearance(displacements))?
    }

    /// Returns the counters of the last evaluation.
    pub fn work(&self) -> SearchWork {
        self.scratch.borrow().work
    }

    /// Returns the ends of the line of action of a flank [m], for figures.
    pub fn line(&self, side: Side) -> Option<[Vec3; 2]> {
        self.lines[usize::from(side == Side::Right)]
    }

    #[inline]
    fn candidate(&self, found: &ProjectedPoint<'_>) -> Candidate {
        let ProjectedPoint {
            k,
            flanks: [slave, _],
            point: p,
            hit,
            taper,
            ..
        } = found;
        // The flank's normal points from the master to the slave, the candidate's from the first gear to
        // the second.
        let points = self.flanks.points(found);
        let sign = if *k == 0 { -1.0 } else { 1.0 };
        // Where it is open the gap is the distance.
        let mut aside = [Vec3::zeros(); 2];
        let mut factor = 1.0;
        if hit.gap < 0.0 {
            // d(m g) = m n . (dx - dX) + g grad m . dx
            factor = taper.factor;
            aside[*k] = sign * hit.gap * taper.gradient;
        }
        let normal = sign * factor * hit.normal;
        Candidate {
            along: None,
            slot: usize::from(slave.shape.side == Side::Right),
            points,
            normal,
            aside,
            taper: taper.factor,
            scale: [1.0, 1.0],
            curvature: [0.0; 2],
            gap: factor * hit.gap,
            stiffness: self.flanks.penalty[*k] * p.area,
            stiffness_s: 0.0,
            s: 0.0,
            share: self.flanks.share(*k, p.area),
        }
    }

    /// Returns a point with the nodes of its faces, for gears with a field.
    fn nodal_point(
        &self,
        found: &ProjectedPoint<'_>,
        gear_states: &[GearState<'_>; 2],
        nodes: &mut [(Option<&dyn FlankDisplacement>, &mut GearNodes); 2],
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        let ProjectedPoint {
            k,
            flanks: [slave, master],
            point: p,
            x,
            hit,
            taper,
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
                slots[gear] = nodes.meet(*field, gear_states[gear].at, &corners);
                let a = GearNodes::at(&nodes.displacement, &slots[gear]);
                gap0 -= weighted(&weights[gear], &a);
            }
        }
        if !gap_bound.takes(gap0) {
            return;
        }
        let points = self.flanks.points(found);
        let other = (0..2).find(|&i| nodes[i].0.is_none() && !self.flanks.gears[i].rigid);
        let partner = other.map(|i| {
            out.partners.push(points[i]);
            out.partners.len() as u32 - 1
        });
        let mut point = NodalPoint {
            mesh: 0,
            slot: u8::from(slave.shape.side == Side::Right),
            slave: k as u8,
            partner,
            line: None,
            teeth: points.map(|p| p.tooth),
            x: *x,
            normal: hit.normal,
            sensitivity: hit.sensitivity(x),
            place: [hit.a, hit.b],
            slots,
            weights,
            gap0,
            stiffness: self.flanks.penalty[k] * p.area,
            share: self.flanks.share(k, p.area),
            taper_gradient: Vec3::zeros(),
        };
        self.flanks.taper(&mut point, taper);
        out.points.push(point);
    }
}
