//! Low-rank terms of a Newton correction, each on the few members that it involves.
//!
//! ```text
//! A = A0 - U V,    x = x0 + Z y,    (D - V Z) y = V x0,    Z = A0^-1 U
//! ```
//!
//! with a row of `V` and a column of `U` for each term; `D` is one for a force that depends on `x` and zero for a
//! rigid link. A term has entries of its own members alone, so that two terms couple in `V Z` only through a common
//! member: for a train the equations form a band, and the cost of a correction grows with its length.

use gearbench_integrators::dense_solve::{solve_banded, solve_in_place};
use gearbench_integrators::system::Singular;
use std::ops::Range;

/// Part of a term on one member.
#[derive(Clone, Debug)]
struct Part {
    member: usize,
    /// Range of the coordinates of the member in the scene.
    on: Range<usize>,
    /// Index of its first entry.
    from: usize,
}

/// Low-rank terms; buffers are reused.
#[derive(Debug, Default)]
pub(super) struct LowRank {
    /// Row and column of the term under construction, over all coordinates; zero between terms.
    pub row: Vec<f64>,
    pub column: Vec<f64>,
    /// Parts of all terms, the end of the parts of each term, and its entry of `D`.
    parts: Vec<Part>,
    terms: Vec<(usize, f64)>,
    /// Entries of rows and columns.
    v: Vec<f64>,
    z: Vec<f64>,
    /// Terms of each member, with the index of the part on this member.
    of_member: Vec<Vec<(usize, usize)>>,
    small: Vec<f64>,
    rhs: Vec<f64>,
}

impl LowRank {
    /// Removes all terms, for `n` coordinates of a number of members.
    pub fn begin(&mut self, n: usize, members: usize) {
        self.row.resize(n, 0.0);
        self.column.resize(n, 0.0);
        self.of_member.resize_with(members, Vec::new);
        self.of_member.iter_mut().for_each(Vec::clear);
        self.parts.clear();
        self.terms.clear();
        self.v.clear();
        self.z.clear();
    }

    /// Adds the present row and column as a term on these members, in ascending order.
    pub fn push(&mut self, members: impl Iterator<Item = (usize, Range<usize>)>, unit: f64) {
        for (member, on) in members {
            let from = self.v.len();
            self.of_member[member].push((self.terms.len(), self.parts.len()));
            for (all, own) in [
                (&mut self.row, &mut self.v),
                (&mut self.column, &mut self.z),
            ] {
                own.extend_from_slice(&all[on.clone()]);
                all[on.clone()].fill(0.0);
            }
            self.parts.push(Part { member, on, from });
        }
        self.terms.push((self.parts.len(), unit));
        debug_assert!(self.row.iter().chain(&self.column).all(|x| *x == 0.0));
    }

    /// Computes `Z = A0^-1 U` by members; `correct` solves for the coordinates of one member.
    pub fn correct(
        &mut self,
        mut correct: impl FnMut(usize, &mut [f64]) -> Result<(), Singular>,
    ) -> Result<(), Singular> {
        for part in &self.parts {
            if !part.on.is_empty() {
                correct(part.member, &mut self.z[part.from..][..part.on.len()])?;
            }
        }
        Ok(())
    }

    /// Returns the parts of a term.
    fn of_term(&self, term: usize) -> &[Part] {
        let from = if term == 0 { 0 } else { self.terms[term - 1].0 };
        &self.parts[from..self.terms[term].0]
    }

    /// Computes `x` from `x0` in place.
    pub fn solve(&mut self, x: &mut [f64]) -> Result<(), Singular> {
        let n = self.terms.len();
        let mut small = std::mem::take(&mut self.small);
        let mut rhs = std::mem::take(&mut self.rhs);
        small.clear();
        small.resize(n * n, 0.0);
        rhs.clear();
        let mut reach = 0;
        for i in 0..n {
            let line = &mut small[i * n..][..n];
            let mut on_x = 0.0;
            for part in self.of_term(i) {
                let v = &self.v[part.from..][..part.on.len()];
                for &(j, other) in &self.of_member[part.member] {
                    let z = &self.z[self.parts[other].from..][..v.len()];
                    line[j] = v.iter().zip(z).fold(line[j], |sum, (v, z)| sum + v * z);
                    reach = reach.max(i.abs_diff(j));
                }
                on_x = (v.iter().zip(&x[part.on.clone()])).fold(on_x, |sum, (v, x)| sum + v * x);
            }
            line.iter_mut().for_each(|a| *a = -*a);
            line[i] += self.terms[i].1;
            rhs.push(on_x);
        }
        let solved = if 3 * reach < n {
            solve_banded(&mut small, &mut rhs, reach)
        } else {
            solve_in_place(&mut small, &mut rhs)
        };
        if solved.is_ok() {
            for (i, y) in rhs.iter().enumerate() {
                for part in self.of_term(i) {
                    let z = &self.z[part.from..][..part.on.len()];
                    for (x, z) in x[part.on.clone()].iter_mut().zip(z) {
                        *x += y * z;
                    }
                }
            }
        }
        (self.small, self.rhs) = (small, rhs);
        solved
    }
}
