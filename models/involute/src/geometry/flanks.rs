//! Flanks as structured grids of nodes.

use super::{Gear, Side};
use crate::Vec3;

/// Direction of the tooth tips in the gear frame, which defines the height of a point: it grows along a flank from
/// root to tip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tips {
    /// Tips point away from the axis: the height is the squared radius.
    Outwards,
    /// Tips point to the axis, on an internal gear: the height is the negative squared radius.
    Inwards,
    /// Tips point to -x, on a rack: the height is `-x`.
    Along,
}

impl Tips {
    /// Returns the height of a point of the transverse plane [m^2], for a rack [m].
    #[inline]
    pub fn height(self, [x, y]: [f64; 2]) -> f64 {
        match self {
            Tips::Outwards => x * x + y * y,
            Tips::Inwards => -(x * x + y * y),
            Tips::Along => -x,
        }
    }

    /// Returns the gradient of the height [m], for a rack [1].
    #[inline]
    pub fn gradient(self, [x, y]: [f64; 2]) -> [f64; 2] {
        match self {
            Tips::Outwards => [2.0 * x, 2.0 * y],
            Tips::Inwards => [-2.0 * x, -2.0 * y],
            Tips::Along => [-1.0, 0.0],
        }
    }

    /// Returns the radius [m] of a height; for a rack the height itself.
    #[inline]
    pub fn radius(self, height: f64) -> f64 {
        match self {
            Tips::Outwards => height.sqrt(),
            Tips::Inwards => (-height).sqrt(),
            Tips::Along => height,
        }
    }
}

/// A flank of one tooth as a structured grid of nodes, in the gear's own frame: axis z through the origin and
/// tooth 0 centred on +x; a rack as in [`super`], reference line on y, teeth pointing to -x.
///
/// Rows run along the profile from the root to the tip, columns over the width from -z to +z. So `across x along` points out of
/// the tooth on left flanks and into it on right ones, those of internal gears as well: their sides are the ones that
/// [one sees from the root](Gear::side_from_root).
#[derive(Clone, Debug, PartialEq)]
pub struct FlankGrid {
    /// Tooth, from 0, counter-clockwise.
    pub tooth: u32,
    /// Side of the flank, seen from the root.
    pub side: Side,
    /// Nodes along the profile, at least 2.
    pub rows: usize,
    /// Nodes over the width, at least 2.
    pub columns: usize,
    /// Node numbers of the gear, row by row.
    pub nodes: Vec<u32>,
    /// Undeformed positions of those nodes [m].
    pub positions: Vec<Vec3>,
}

impl FlankGrid {
    /// See [`Flanks::deviate`] for all flanks of a gear.
    pub fn deviate(&mut self, gear: &Gear) {
        if !gear.deviates() {
            return;
        }
        let side = gear.side_from_root(self.side);
        let (rb, sign) = (gear.r_base(), side.sign());
        let cos_helix = gear.base_helix_angle().cos();
        for x in &mut self.positions {
            let r = x.x.hypot(x.y);
            // The normal touches the base circle, an angle atan(s / r_b) behind the point.
            let normal = x.y.atan2(x.x) - sign * (gear.roll_length(r) / rb).atan();
            let removed = gear.tooth_deviation(i64::from(self.tooth), side, r) / cos_helix;
            let (sin, cos) = normal.sin_cos();
            *x -= sign * removed * Vec3::new(-sin, cos, 0.0);
        }
    }
}

/// All flanks of a gear. Its faces are numbered grid by grid, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flanks {
    grids: Vec<FlankGrid>,
    /// First face of each grid, and the number of all faces.
    first_face: Vec<u32>,
}

impl Flanks {
    /// Creates the flanks from the grids of a gear.
    #[must_use]
    pub fn new(grids: Vec<FlankGrid>) -> Self {
        let mut first_face = vec![0];
        for g in &grids {
            let faces = (g.rows.saturating_sub(1) * g.columns.saturating_sub(1)) as u32;
            first_face.push(first_face[first_face.len() - 1] + faces);
        }
        Flanks { grids, first_face }
    }

    /// Returns the grids of all flanks.
    pub fn grids(&self) -> &[FlankGrid] {
        &self.grids
    }

    /// Returns the index of the grid of a tooth's flank.
    pub fn find(&self, tooth: u32, side: Side) -> Option<usize> {
        self.grids
            .iter()
            .position(|g| g.tooth == tooth && g.side == side)
    }

    /// Moves the nodes of a gear's flanks by the deviations of their teeth, along the normal in the
    /// transverse plane; nothing else of the flanks changes.
    pub fn deviate(&mut self, gear: &Gear) {
        for grid in &mut self.grids {
            grid.deviate(gear);
        }
    }

    /// Returns the number of a face from its grid and its row and column there.
    #[inline]
    pub fn face(&self, grid: usize, row: usize, column: usize) -> u32 {
        self.first_face[grid] + (row * (self.grids[grid].columns - 1) + column) as u32
    }

    /// Returns the node numbers at the corners of a face: (row, column), (row + 1, column), (row + 1, column + 1),
    /// (row, column + 1). Local coordinates `xi` in [-1, 1]: the first along the profile, the second over the width.
    #[inline]
    pub fn corners(&self, face: u32) -> [u32; 4] {
        let grid = self.first_face.partition_point(|&first| first <= face) - 1;
        let g = &self.grids[grid];
        let within = (face - self.first_face[grid]) as usize;
        let (row, column) = (within / (g.columns - 1), within % (g.columns - 1));
        let at = |r: usize, c: usize| g.nodes[r * g.columns + c];
        [
            at(row, column),
            at(row + 1, column),
            at(row + 1, column + 1),
            at(row, column + 1),
        ]
    }

    /// Returns the bilinear shape functions of the corners.
    #[inline]
    pub fn weights(xi: [f64; 2]) -> [f64; 4] {
        let (a, b) = (0.5 * (1.0 + xi[0]), 0.5 * (1.0 + xi[1]));
        [(1.0 - a) * (1.0 - b), a * (1.0 - b), a * b, (1.0 - a) * b]
    }
}
