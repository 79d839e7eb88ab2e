//! Lower bounds of gaps, linear in the displacements of the hubs.

/// What facing flanks of two gears whose teeth move with their hubs are apart at least, by the displacements of the
/// hubs: `assembled + per_displacement . displacement`. An involute that turns moves parallel to itself, so this holds for
/// all points of the flanks, not only on the line of action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineClearance {
    /// At the assembled position [m].
    pub assembled: f64,
    /// Its change by the displacement of each hub [m/rad], [-] for a rack.
    pub per_displacement: [f64; 2],
}

/// A lower bound of the gaps between rigid flanks, linear in the displacements of both hubs for as long as it is
/// positive: no point has a smaller gap at any displacements on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Of left and of right flanks [m]; they touch, or may, where it is not positive.
    pub gaps: [f64; 2],
    /// How that of left flanks changes by the displacement of the first and of the second gear [m/rad or -]; that of
    /// right flanks changes by the opposite.
    pub per_displacement: [f64; 2],
}

impl Clearance {
    /// The smaller of both sides after further displacements [m].
    pub fn after(&self, displacements: [f64; 2]) -> f64 {
        let change = self.per_displacement[0] * displacements[0]
            + self.per_displacement[1] * displacements[1];
        (self.gaps[0] + change).min(self.gaps[1] - change)
    }

    /// The gap of each side as a linear function of further displacements.
    pub fn lines(&self) -> [LineClearance; 2] {
        [1.0, -1.0].map(|sign| LineClearance {
            assembled: self.gaps[usize::from(sign < 0.0)],
            per_displacement: self.per_displacement.map(|p| sign * p),
        })
    }
}
