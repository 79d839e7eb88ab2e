//! The compliance of a gear whose teeth are all alike, without what modes carry that are made for some of its teeth.
//!
//! ```text
//! R = A - T T^T,     T_ki = b_ki / omega_i
//! ```
//!
//! `A` is kept by blocks, `T` by rows. Between the rows of the teeth that the modes are made for, which touch, `R` stands
//! ready; between any others it is put together when it is asked for.

use super::lines::{Sum, rows_of_sums};
use super::reduced::FlankCompliance;
use crate::cholesky::dot;

/// A row that belongs to none of the teeth.
const FAR: u32 = u32::MAX;

/// See the module.
#[derive(Clone, Debug)]
pub struct Lessened {
    whole: FlankCompliance,
    modes: usize,
    /// `T`, a row of `modes` for each row of the flanks.
    taken: Vec<f64>,
    /// Place of each row among those of the teeth, or [`FAR`].
    places: Vec<u32>,
    /// Rows of the teeth.
    near: usize,
    /// `R` between them, row-major.
    block: Vec<f64>,
}

impl Lessened {
    /// Of the compliance `whole` what `taken` leaves; `near` are the rows of the teeth, ascending.
    pub fn new(whole: FlankCompliance, modes: usize, taken: Vec<f64>, near: &[u32]) -> Self {
        let rows = taken.len() / modes.max(1);
        let mut places = vec![FAR; rows];
        for (place, row) in near.iter().enumerate() {
            places[*row as usize] = place as u32;
        }
        let mut made = Lessened {
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

    /// Number of rows of the flanks.
    pub fn rows(&self) -> usize {
        self.places.len()
    }

    fn row(&self, row: u32) -> &[f64] {
        &self.taken[row as usize * self.modes..][..self.modes]
    }

    fn composed(&self, i: u32, j: u32) -> f64 {
        self.whole.between(i, j, self.rows()) - dot(self.row(i), self.row(j))
    }

    /// Compliance between two rows [m/N].
    #[inline]
    pub fn between(&self, i: u32, j: u32) -> f64 {
        let [p, q] = [i, j].map(|row| self.places[row as usize]);
        if p == FAR || q == FAR {
            return self.composed(i, j);
        }
        self.block[p as usize * self.near + q as usize]
    }

    /// Adds `g_i . g_j` between the rows of the teeth; `given` has a row of `width` for each row of the flanks.
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

    /// The same between sums of rows, where `whole` is that of [`FlankCompliance`]: a sum belongs to the teeth with all its rows.
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
        Lessened::new(whole(&self.whole), self.modes, taken, &near)
    }

    /// All its numbers are finite, and there are as many as for `rows`; else what was found.
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
