//! The search seam: candidate points between any two gears of a mesh.
//!
//! A search owns a part of the mesh's memory: which tooth pairs it looks at. With event location that part
//! changes only at its guards, so inside a step the set of candidates is fixed.

use super::candidate::{Candidate, Tooth};
use super::lines_of_action::LineClearance;
use super::nodal::{Margin, NodalParty, NodalPoints};
use crate::gear::GearModel;
use crate::geometry::Side;
use gearbench_integrators::system::At;

/// A gear with its slice of the state.
#[derive(Clone, Copy)]
pub struct Party<'a> {
    /// The gear.
    pub gear: &'a dyn GearModel,
    /// Its own coordinates, velocities and memory.
    pub at: At<'a>,
}

/// What a switched guard of a search did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ZoneChange {
    /// Slot of a pair that became a candidate.
    pub entered: Option<usize>,
    /// Slot of a pair that is none any more.
    pub left: Option<usize>,
}

/// What the last evaluation of a point search looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SearchWork {
    /// Pairs of flanks.
    pub pairs: usize,
    /// Flanks whose node positions were computed.
    pub flanks: usize,
    /// Nodes of these.
    pub nodes: usize,
    /// Points that were placed.
    pub points: usize,
    /// Points that were projected.
    pub projections: usize,
}

/// A lower bound of the gaps between rigid flanks, linear in the travels of both hubs for as long as it is positive:
/// no point has a smaller gap at any travels on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Of left and of right flanks [m]; they touch, or may, where it is not positive.
    pub gaps: [f64; 2],
    /// How that of left flanks changes by the travel of the first and of the second gear [m/rad or -]; that of right
    /// flanks changes by the opposite.
    pub per_travel: [f64; 2],
}

impl Clearance {
    /// The smaller of both sides after further travels [m].
    #[must_use]
    pub fn after(&self, travels: [f64; 2]) -> f64 {
        let change = self.per_travel[0] * travels[0] + self.per_travel[1] * travels[1];
        (self.gaps[0] + change).min(self.gaps[1] - change)
    }

    /// The gap of each side as a linear function of further travels.
    #[must_use]
    pub fn lines(&self) -> [LineClearance; 2] {
        [1.0, -1.0].map(|sign| LineClearance {
            assembled: self.gaps[usize::from(sign < 0.0)],
            per_travel: self.per_travel.map(|p| sign * p),
        })
    }
}

/// Which candidates are wanted.
#[derive(Clone, Copy, Debug)]
pub enum Wanted<'a> {
    /// Pairs in the search's memory whose slot is closed; per slot `(mode, impact speed)`.
    Closed(&'a [f64]),
    /// All pairs in the search's memory.
    Listed,
    /// Pairs that lie in the contact zone at this state, memory aside, with a gap [m] of at most so much.
    Touching(f64),
}

/// A search for candidate points; takes any mix of gear models.
pub trait ContactSearch {
    /// Number of contact slots: an upper bound of simultaneous candidates.
    fn slots(&self) -> usize;

    /// Length of the search's memory.
    fn memory(&self) -> usize;

    /// Number of the search's guards.
    fn guard_count(&self) -> usize;

    /// Whether its contacts may be followed by events. A search whose points open and close all the time has
    /// no slots and no guards; the scene then uses clipped forces whatever the integrator would like.
    fn locates(&self) -> bool {
        true
    }

    /// Sets the memory from a state.
    fn begin(&self, a: Party<'_>, b: Party<'_>, memory: &mut [f64]);

    /// Appends candidates.
    fn candidates(
        &self,
        a: Party<'_>,
        b: Party<'_>,
        memory: &[f64],
        wanted: Wanted<'_>,
        out: &mut Vec<Candidate>,
    );

    /// Appends the points of a mesh with a gear that has a [field](crate::gear::elastic::NormalField), of a gap within
    /// the margin before residual compliance, and the nodes that they lie on. Only searches of flank points have any.
    fn nodal_points(
        &self,
        _sides: [NodalParty<'_>; 2],
        _margin: &mut Margin,
        _out: &mut NodalPoints,
    ) {
    }

    /// A lower bound of the gaps of all points of rigid flanks at travels of both hubs; `None` where flanks move
    /// otherwise or the search does not know.
    fn clearance(&self, _travels: [f64; 2]) -> Option<Clearance> {
        None
    }

    /// Gaps [m] of all pairs in the search's memory by slot; other entries of `out` stay as they are.
    fn gaps(&self, a: Party<'_>, b: Party<'_>, memory: &[f64], out: &mut [f64]);

    /// Guards of the memory.
    fn guards(&self, a: Party<'_>, b: Party<'_>, memory: &[f64], out: &mut [f64]);

    /// [`Self::guards`] and [`Self::gaps`] at once, for searches that share work between them.
    fn watch(
        &self,
        a: Party<'_>,
        b: Party<'_>,
        memory: &[f64],
        guards: &mut [f64],
        gaps: &mut [f64],
    ) {
        self.guards(a, b, memory, guards);
        self.gaps(a, b, memory, gaps);
    }

    /// Flips what guard `i` watches.
    fn switch(&self, guard: usize, memory: &mut [f64]) -> ZoneChange;

    /// What the last evaluation looked at, for searches that count it.
    fn work(&self) -> SearchWork {
        SearchWork::default()
    }

    /// Ends of the line of action of a flank [m], for pictures; `None` for searches without lines.
    fn line(&self, _side: Side) -> Option<[crate::Vec3; 2]> {
        None
    }

    /// Teeth and flank side of a candidate.
    fn flank_of(&self, c: &Candidate) -> ([Tooth; 2], Side);
}
