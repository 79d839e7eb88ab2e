//! The search seam: candidate points between any two gears of a mesh.
//!
//! A search owns a part of the mesh's memory: which tooth pairs it looks at. With event location that part
//! changes only at its guards, so inside a step the set of candidates is fixed.

use super::candidate::Candidate;
use super::clearance::Clearance;
use super::nodal::{Margin, NodalParty, NodalPoints};
use super::party::{Party, SearchWork, Wanted, ZoneChange};
use crate::geometry::Side;
use crate::kinematics::Tooth;

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

    /// Appends the points of a mesh with a gear that has a [field](crate::gear::NormalField), of a gap within
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
