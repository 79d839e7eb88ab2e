//! The contact search of a mesh: tooth pairs on lines of action, points of flanks, or lines of flanks. Each accepts
//! any combination of gear models.

use super::candidate::Candidate;
use super::gear_state::{CandidateSelection, GearState};
use super::nodal::{GapBound, NodalGearState, NodalPoints};
use super::pairs::{FlankLines, LinesOfAction};
use super::points::FlankPoints;
use crate::Vec3;
use crate::geometry::Side;
use crate::kinematics::Tooth;

/// Method by which a mesh finds its candidate points.
#[derive(Debug)]
pub enum Search {
    /// Tooth pairs, each with its own slot. The search has a part of the discrete state of the mesh: the range of
    /// pairs that it evaluates. With event location that part changes only at its event functions, so that the set of
    /// candidates is constant inside a step.
    Pairs(Box<LinesOfAction>),
    /// Points of flanks. They open and close continually, so that there are no slots and no event functions: forces
    /// are clipped and no event is located.
    Points(Box<FlankPoints>),
    /// Lines of elastic flanks, which open and close continually as points do.
    Lines(Box<FlankLines>),
}

impl Search {
    /// Returns the search for tooth pairs, if it is one.
    #[inline]
    pub fn pairs(&self) -> Option<&LinesOfAction> {
        match self {
            Search::Pairs(pairs) => Some(pairs),
            Search::Points(_) | Search::Lines(_) => None,
        }
    }

    /// Returns the search for flank points, if it is one.
    #[inline]
    pub fn points(&self) -> Option<&FlankPoints> {
        match self {
            Search::Points(points) => Some(points),
            Search::Pairs(_) | Search::Lines(_) => None,
        }
    }

    /// Returns the search for flank lines, if it is one.
    #[inline]
    pub fn lines(&self) -> Option<&FlankLines> {
        match self {
            Search::Lines(lines) => Some(lines),
            Search::Pairs(_) | Search::Points(_) => None,
        }
    }

    /// Appends the points of gears with a [flank displacement](crate::gear::FlankDisplacement); tooth pairs have none.
    #[inline]
    pub fn nodal_points(
        &self,
        sides: [NodalGearState<'_>; 2],
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        match self {
            Search::Points(points) => points.nodal_points(sides, gap_bound, out),
            Search::Lines(lines) => lines.nodal_points(sides, gap_bound, out),
            Search::Pairs(_) => {}
        }
    }

    /// Appends candidates; `discrete` is the discrete state of [`Search::Pairs`].
    #[inline]
    pub fn candidates(
        &self,
        a: GearState<'_>,
        b: GearState<'_>,
        discrete: &[f64],
        selection: CandidateSelection<'_>,
        out: &mut Vec<Candidate>,
    ) {
        match self {
            Search::Pairs(pairs) => pairs.candidates(a, b, discrete, selection, out),
            Search::Points(points) => points.candidates(a, b, selection, out),
            // Their gears have fields.
            Search::Lines(_) => {}
        }
    }

    /// Returns the ends of the line of action of a flank [m], for figures.
    pub fn line(&self, side: Side) -> Option<[Vec3; 2]> {
        match self {
            Search::Pairs(pairs) => pairs.line(side),
            Search::Points(points) => points.line(side),
            Search::Lines(lines) => lines.pairs().line(side),
        }
    }

    /// Returns the teeth and the flank side of a candidate.
    pub fn flank_of(&self, c: &Candidate) -> ([Tooth; 2], Side) {
        let side = match self {
            Search::Pairs(pairs) => pairs.side_of(c),
            _ if c.slot == 0 => Side::Left,
            _ => Side::Right,
        };
        ([c.points[0].tooth, c.points[1].tooth], side)
    }
}
