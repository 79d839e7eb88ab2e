//! Kinematic state of one gear for the contact search, and the selection and counters of a search.

use crate::gear::GearModel;
use gearbench_integrators::system::StateView;

/// A gear model with its part of the state.
#[derive(Clone, Copy)]
pub struct GearState<'a> {
    /// The gear model.
    pub gear: &'a dyn GearModel,
    /// Coordinates, velocities and discrete state of the gear.
    pub at: StateView<'a>,
}

/// Selection of the candidates that a search returns.
#[derive(Clone, Copy, Debug)]
pub enum CandidateSelection<'a> {
    /// Pairs in the discrete state of the search whose slot is closed; per slot `(mode, impact speed)`.
    Closed(&'a [f64]),
    /// All pairs in the discrete state of the search, open or closed according to their gaps.
    Listed,
    /// All pairs in the discrete state of the search, open or closed according to their slots.
    Watched(&'a [f64]),
    /// Pairs that lie in the contact zone at this state, whatever the discrete state, with a gap [m] up to this value.
    Touching(f64),
}

/// Slots that changed at an event function of the contact zone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ZoneChange {
    /// Slot of a pair that entered the contact zone.
    pub entered: Option<usize>,
    /// Slot of a pair that left the contact zone.
    pub left: Option<usize>,
}

/// Counters of the last evaluation of a point search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SearchWork {
    /// Number of flank pairs.
    pub pairs: usize,
    /// Number of flanks whose node positions were computed.
    pub flanks: usize,
    /// Number of nodes of these flanks.
    pub nodes: usize,
    /// Number of points whose positions were computed.
    pub points: usize,
    /// Number of points that were projected.
    pub projections: usize,
}
