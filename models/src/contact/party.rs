//! What a search for contacts is told and what it tells.

use crate::gear::GearModel;
use gearbench_integrators::system::At;

/// A gear with its slice of the state.
#[derive(Clone, Copy)]
pub struct Party<'a> {
    /// The gear.
    pub gear: &'a dyn GearModel,
    /// Its own coordinates, velocities and discrete state.
    pub at: At<'a>,
}

/// Which candidates are wanted.
#[derive(Clone, Copy, Debug)]
pub enum Wanted<'a> {
    /// Pairs in the search's discrete state whose slot is closed; per slot `(mode, impact speed)`.
    Closed(&'a [f64]),
    /// All pairs in the search's discrete state, open or closed as their gaps tell.
    Listed,
    /// The same, open or closed as their slots say.
    Watched(&'a [f64]),
    /// Pairs that lie in the contact zone at this state, discrete state aside, with a gap [m] of at most so much.
    Touching(f64),
}

/// What a switched event function of a search did.
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
