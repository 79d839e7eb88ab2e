//! Row search on the flanks of conical gears, whose radii grow along the axis: a squared radius determines a row only
//! at a given height.

use super::surface::Shape;
use crate::Vec3;

/// Radii of the nodes of a flank of a conical gear.
#[derive(Clone, Debug)]
pub(super) struct Cone {
    /// Tangent of the angle of the tip cone.
    pub slope: f64,
    rows: usize,
    /// Squared radius [m^2] of each node, column by column.
    squares: Vec<f64>,
}

impl Cone {
    /// Builds the table from the nodes of a flank, row by row.
    pub fn new(slope: f64, [rows, columns]: [usize; 2], positions: &[Vec3]) -> Self {
        let nodes = (0..columns).flat_map(|c| (0..rows).map(move |r| r * columns + c));
        Cone {
            slope,
            rows,
            squares: nodes.map(|i| positions[i].xy().norm_squared()).collect(),
        }
    }

    /// Returns the squared radius [m^2] of a point moved along the tip cone to the middle of the face.
    pub fn carried(&self, x: &Vec3) -> f64 {
        (x.xy().norm() - self.slope * x.z).powi(2)
    }

    /// Returns the row whose strip contains a squared radius at a position in a column of faces, and the position in
    /// the strip, from 0 to 1.
    #[inline]
    pub fn row_at(&self, height: f64, (column, b): (usize, f64)) -> (usize, f64) {
        let (near, far) = self.squares[column * self.rows..].split_at(self.rows);
        let b = b.clamp(0.0, 1.0);
        let at = |row: usize| near[row] + b * (far[row] - near[row]);
        let mut row = 0;
        while row + 2 < self.rows && height >= at(row + 1) {
            row += 1;
        }
        (row, (height - at(row)) / (at(row + 1) - at(row)))
    }
}

impl Shape {
    /// Adds the tip cone of a conical gear by its slope; 0 for a cylindrical gear.
    #[must_use]
    pub fn on_cone(mut self, slope: f64) -> Self {
        if slope == 0.0 {
            return self;
        }
        let cone = Cone::new(slope, [self.rows, self.columns], &self.positions);
        let middle = self.positions.iter().skip(self.columns / 2);
        let carried = middle.step_by(self.columns).map(|x| cone.carried(x));
        self.heights = carried.collect();
        self.cone = Some(cone);
        self
    }
}
