//! The free flight of a gear: its motion under a steady load without contact.
//!
//! A gear in flight is a frame that moves as `theta_0 + theta' t + theta'' t^2 / 2` and oscillators about their static
//! deflection under the load: modes of an elastic gear, springs of movable teeth. Their energy about that deflection
//! never grows, so that it bounds, for the whole flight, the distance of the flanks from those of a rigid gear that
//! moves as the frame.

/// Bounds of the motion of a gear in free flight, from an initial state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeFlight {
    /// Displacement [rad or m], speed and acceleration of the frame.
    pub frame: [f64; 3],
    /// Largest outward distance of its flanks from those of the frame by displacements of their points [m].
    pub outward: f64,
    /// Largest difference between the displacement of a tooth and that of the frame [rad or m].
    pub displacement: f64,
}
