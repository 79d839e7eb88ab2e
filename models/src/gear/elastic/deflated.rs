//! Deflated compliance of a cyclic gear: without the compliance that modes fitted to some of its teeth carry.
//!
//! ```text
//! R = A - T T^T,     T_ki = b_ki / omega_i
//! ```
//!
//! `A` is stored by blocks, `T` by rows. Between the rows of the teeth for which the modes were fitted, which touch,
//! `R` is stored; between any others it is computed when needed.

use super::lines::{Sum, rows_of_sums};
use super::reduced::FlankCompliance;
use crate::cholesky::dot;

/// Index of a row that belongs to none of the selected teeth.
const FAR: u32 = u32::MAX;

/// Deflated compliance `R = A - T T^T` of a cyclic gear; see the module for its terms.
#[derive(Clone, Debug)]
pub struct Deflated {
    whole: FlankCompliance,
    modes: usize,
    /// Matrix `T`, a row of `modes` entries for each row of the flanks.
    taken: Vec<f64>,
    /// Index of each row among those of the selected teeth, or [`FAR`].
    places: Vec<u32>,
    /// Number of rows of the selected teeth.
    near: usize,
    /// Block of `R` between these rows, row-major.
    block: Vec<f64>,
}

impl Deflated {
    /// Subtracts the compliance of the rows `taken` from `whole`; `near` has the rows of the selected teeth,
    /// ascending.
    pub fn new(whole: FlankCompliance, modes: usize, taken: Vec<f64>, near: &[u32]) -> Self {
        let rows = taken.len() / modes.max(1);
        let mut places = vec![FAR; rows];
        for (place, row) in near.iter().enumerate() {
            places[*row as usize] = place as u32;
        }
        let mut made = Deflated {
            whole,
            modes,
            taken,
            places,
            near: near.len(),
            block: vec![0.0; near.len() * near.len()],
        };
        for (p, &i) in near.iter().enumerate() {
            for (q, &j) in near[..=p].iter().enumerate() {
                let c = made.composed(i, j);
                made.block[p * near.len() + q] = c;
                made.block[q * near.len() + p] = c;
            }
        }
        made
    }

    /// Returns the number of rows of the flanks.
    pub fn rows(&self) -> usize {
        self.places.len()
    }

    fn row(&self, row: u32) -> &[f64] {
        &self.taken[row as usize * self.modes..][..self.modes]
    }

    fn composed(&self, i: u32, j: u32) -> f64 {
        self.whole.between(i, j, self.rows()) - dot(self.row(i), self.row(j))
    }

    /// Returns the compliance between two rows [m/N].
    #[inline]
    pub fn between(&self, i: u32, j: u32) -> f64 {
        let [p, q] = [i, j].map(|row| self.places[row as usize]);
        if p == FAR || q == FAR {
            return self.composed(i, j);
        }
        self.block[p as usize * self.near + q as usize]
    }

    /// Adds `g_i . g_j` between the rows of the selected teeth; `given` has `width` entries for each row of the
    /// flanks.
    pub fn give(&mut self, given: &[f64], width: usize) {
        let near: Vec<(usize, usize)> = (self.places.iter().enumerate())
            .filter(|(_, p)| **p != FAR)
            .map(|(row, p)| (row, *p as usize))
            .collect();
        let row = |row: usize| &given[row * width..][..width];
        for &(i, p) in &near {
            for &(j, q) in &near {
                self.block[p * self.near + q] += dot(row(i), row(j));
            }
        }
    }

    /// Returns the deflated compliance between sums of rows; `whole` transforms a [`FlankCompliance`] accordingly. A
    /// sum belongs to the selected teeth if all its rows do.
    pub(super) fn over(
        &self,
        sums: &[Sum],
        whole: impl Fn(&FlankCompliance) -> FlankCompliance,
    ) -> Self {
        let is_near = |sum: &Sum| sum.iter().all(|(row, _)| self.places[*row] != FAR);
        let near: Vec<u32> = (0..sums.len() as u32)
            .filter(|s| is_near(&sums[*s as usize]))
            .collect();
        let taken = rows_of_sums(&self.taken, self.modes, sums);
        Deflated::new(whole(&self.whole), self.modes, taken, &near)
    }

    /// Returns a description of the problem if numbers are not finite or do not match the number of `rows`.
    pub(super) fn problem(&self, rows: usize) -> Option<String> {
        if self.rows() != rows {
            return Some(format!(
                "compliances of {} rows, expected {rows}",
                self.rows()
            ));
        }
        let numbers = self.taken.iter().chain(&self.block);
        if !numbers.copied().all(f64::is_finite) {
            return Some("a number is not finite".into());
        }
        self.whole.problem(rows)
    }
}
