//! What a gear tells of its flight: its motion while no contact and only a steady load acts on it.
//!
//! A gear in flight is a frame that moves as `theta_0 + theta' t + theta'' t^2 / 2` and oscillators about the rest that
//! the load leaves: modes of an elastic gear, springs of movable teeth. Their energy about that rest never grows, so
//! that it bounds for the whole flight how far flanks stand off those of a rigid gear that moves as the frame.

/// A gear in flight, seen from a state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeFlight {
    /// Displacement [rad] or [m], speed and acceleration of the frame.
    pub frame: [f64; 3],
    /// How far its flanks may stand outward of those of the frame by the displacements of their points [m].
    pub outward: f64,
    /// How far the displacement of a tooth may be from that of the frame [rad] or [m].
    pub displacement: f64,
    /// Energy of its oscillators about their rest [J].
    pub energy: f64,
}
