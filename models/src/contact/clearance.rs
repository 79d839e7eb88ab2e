//! Lower bounds of gaps, linear in the displacements of the hubs.

/// Lower bound of the gap between facing flanks of two gears whose teeth move with their hubs, linear in the hub
/// displacements. A rotating involute moves parallel to itself, so this holds for all points of the flanks, not only
/// on the line of action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineClearance {
    /// Gap at the assembled position [m].
    pub assembled: f64,
    /// Derivative by the displacement of each hub [m/rad], dimensionless for a rack.
    pub per_displacement: [f64; 2],
}

/// Lower bounds of the gaps between rigid flanks of both sides, linear in the hub displacements. As long as a bound is
/// positive, no point has a smaller gap at any displacement on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Gaps of left and of right flanks [m]; where a gap is not positive the flanks may touch.
    pub gaps: [f64; 2],
    /// Derivative of the gap of left flanks by the displacement of the first and of the second gear [m/rad or -]; that
    /// of right flanks is the opposite.
    pub per_displacement: [f64; 2],
}

impl Clearance {
    /// Returns the smaller gap of both sides after further displacements [m].
    pub fn after(&self, displacements: [f64; 2]) -> f64 {
        let change = self.per_displacement[0] * displacements[0]
            + self.per_displacement[1] * displacements[1];
        (self.gaps[0] + change).min(self.gaps[1] - change)
    }

    /// Returns the gap of each side as a linear function of further displacements.
    pub fn lines(&self) -> [LineClearance; 2] {
        [1.0, -1.0].map(|sign| LineClearance {
            assembled: self.gaps[usize::from(sign < 0.0)],
            per_displacement: self.per_displacement.map(|p| sign * p),
        })
    }
}
