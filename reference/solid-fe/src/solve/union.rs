//! Union of the patterns of two lower triangles.

use super::Scalar;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};

/// The union of two patterns, and the entries of both matrices on it.
pub fn union<T: Scalar>(
    a: SparseColMatRef<'_, usize, T>,
    b: SparseColMatRef<'_, usize, T>,
) -> (SymbolicSparseColMat<usize>, Vec<[T; 2]>) {
    let n = a.ncols();
    let mut starts = vec![0];
    let (mut rows, mut entries) = (Vec::new(), Vec::new());
    for j in 0..n {
        let mut left = a.row_idx_of_col(j).zip(a.val_of_col(j)).peekable();
        let mut right = b.row_idx_of_col(j).zip(b.val_of_col(j)).peekable();
        loop {
            let row = match (left.peek(), right.peek()) {
                (None, None) => break,
                (Some(x), None) => x.0,
                (None, Some(y)) => y.0,
                (Some(x), Some(y)) => x.0.min(y.0),
            };
            let mut value = [T::real(0.0); 2];
            if let Some((_, x)) = left.next_if(|x| x.0 == row) {
                value[0] = *x;
            }
            if let Some((_, y)) = right.next_if(|y| y.0 == row) {
                value[1] = *y;
            }
            rows.push(row);
            entries.push(value);
        }
        starts.push(rows.len());
    }
    let pattern = SymbolicSparseColMat::new_checked(n, n, starts, None, rows);
    (pattern, entries)
}
