//! A symmetric sparse matrix as a list of its entries.

use super::error::{MatrixError, MatrixErrorKind, refused};
use crate::limits;

/// Relative difference up to which two mirrored entries are the same number: programs print ten digits or more.
const SAME: f64 = 1e-9;

/// Bytes of an entry while a matrix is read and assembled.
const ENTRY_BYTES: f64 = 96.0;

/// The entries of a matrix as a file lists them: a triangle, whatever the order, or both.
#[derive(Debug, Default)]
pub(super) struct Listed {
    entries: Vec<(u32, u32, f64)>,
    /// Number of entries at which memory is next compared with the limit.
    checked: usize,
}

/// A symmetric matrix: row, column and value of each entry at or above the diagonal, once each, in ascending order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SymmetricEntries(pub(super) Vec<(u32, u32, f64)>);

impl Listed {
    /// Adds an entry; rows and columns count from 0.
    pub(super) fn push(
        &mut self,
        name: &str,
        row: u32,
        column: u32,
        value: f64,
    ) -> Result<(), MatrixError> {
        if self.entries.len() >= self.checked {
            self.checked = (2 * self.entries.len()).max(1 << 16);
            let what = format!("a matrix of {} entries", self.checked);
            limits::check(
                what,
                ENTRY_BYTES * self.checked as f64,
                "use fewer elements",
            )
            .map_err(|e| {
                let expected = format!("at most {} of memory", e.allowed);
                refused(MatrixErrorKind::Limit, name, expected, e.to_string(), "")
            })?;
        }
        self.entries.push((row, column, value));
        Ok(())
    }

    /// Number of rows that the entries need.
    pub(super) fn size(&self) -> usize {
        let last = self.entries.iter().map(|(r, c, _)| *r.max(c));
        last.max().map_or(0, |n| n as usize + 1)
    }

    /// The matrix, with mirrored entries joined.
    pub(super) fn symmetric(mut self, name: &str) -> Result<SymmetricEntries, MatrixError> {
        let place = |(r, c, _): &(u32, u32, f64)| (*r.min(c), *r.max(c));
        self.entries.sort_by_key(place);
        let mut once: Vec<(u32, u32, f64)> = Vec::with_capacity(self.entries.len());
        let mut last: Option<(u32, u32, f64)> = None;
        for entry in self.entries {
            let (low, high) = place(&entry);
            match last {
                Some(before) if place(&before) == (low, high) => {
                    let [(r, c, v), (s, d, w)] = [before, entry];
                    let at = |r: u32, c: u32| format!("({}, {})", r + 1, c + 1);
                    let kind = MatrixErrorKind::Syntax;
                    if (r, c) == (s, d) {
                        let (expected, found) = ("each entry once", format!("{} twice", at(r, c)));
                        return Err(refused(kind, name, expected, found, ""));
                    }
                    if (v - w).abs() > SAME * v.abs().max(w.abs()) {
                        let found = format!("{v:e} at {} and {w:e} at {}", at(r, c), at(s, d));
                        let help = "matrices of friction, damping or rotation are not used";
                        let expected = "a symmetric matrix";
                        return Err(refused(kind, name, expected, found, help));
                    }
                    // The third entry at a place is one too many.
                    last = Some((s, d, w));
                }
                _ => {
                    once.push((low, high, entry.2));
                    last = Some(entry);
                }
            }
        }
        Ok(SymmetricEntries(once))
    }
}
