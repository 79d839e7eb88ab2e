//! A symmetric or Hermitian sparse matrix kept as its lower triangle, and its products with blocks of vectors.

use super::ModesError;
use crate::solve::{Scalar, union};
use faer::sparse::{SparseColMat, SparseColMatRef};
use faer::{MatMut, MatRef};

/// Columns of a product taken together.
const PANEL: usize = 4;

/// Lower triangle of a symmetric (Hermitian) matrix without stored zeros.
#[derive(Clone, Debug)]
pub struct Symmetric<T> {
    start: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<T>,
    /// The input matrix. Stored zeros are left out of the product but kept in sums.
    whole: SparseColMat<usize, T>,
}

impl<T: Scalar> Symmetric<T> {
    /// Takes over a lower triangle.
    pub fn new(a: SparseColMatRef<'_, usize, T>) -> Result<Self, ModesError> {
        if a.nrows() != a.ncols() {
            return Err(ModesError::Matrix(
                "a stiffness or mass matrix is not square",
            ));
        }
        let n = a.ncols();
        let mut start = Vec::with_capacity(n + 1);
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        start.push(0);
        for j in 0..n {
            for (i, &v) in a.row_idx_of_col(j).zip(a.val_of_col(j)) {
                if i < j {
                    return Err(ModesError::Matrix(
                        "a stiffness or mass matrix has entries above its diagonal: give the lower triangle",
                    ));
                }
                if !v.modulus2().is_finite() {
                    return Err(ModesError::Matrix(
                        "a stiffness or mass matrix holds a number that is not finite",
                    ));
                }
                if v.modulus2() != 0.0 {
                    rows.push(i as u32);
                    values.push(v);
                }
            }
            start.push(rows.len());
        }
        let pattern = (a.symbolic().to_owned()).map_err(|_| {
            ModesError::Matrix("a stiffness or mass matrix does not fit into memory")
        })?;
        Ok(Self {
            start,
            rows,
            values,
            whole: SparseColMat::new(pattern, a.val().to_vec()),
        })
    }

    /// Returns the number of rows and columns.
    pub fn size(&self) -> usize {
        self.start.len() - 1
    }

    /// Diagonal, its real part.
    pub fn diagonal(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.size()).map(|j| {
            let at = self.start[j];
            let first = at < self.start[j + 1] && self.rows[at] as usize == j;
            if first {
                faer::traits::math_utils::real(&self.values[at])
            } else {
                0.0
            }
        })
    }

    /// `A - sigma B` on the union of both patterns, stored zeros included.
    pub fn minus(&self, sigma: f64, b: &Self) -> SparseColMat<usize, T> {
        let (pattern, entries) = union(self.whole.as_ref(), b.whole.as_ref());
        let sigma = T::real(sigma);
        let difference = |[a, b]: [T; 2]| {
            let mut value = T::real(0.0);
            value += a;
            value -= sigma * b;
            value
        };
        SparseColMat::new(pattern, entries.into_iter().map(difference).collect())
    }

    /// `y = A x` for all columns.
    pub fn apply(&self, x: MatRef<'_, T>, mut y: MatMut<'_, T>) {
        let n = self.size();
        let zero = [T::real(0.0); PANEL];
        let (mut from, mut to) = (vec![zero; n], vec![zero; n]);
        let mut first = 0;
        while first < x.ncols() {
            let width = PANEL.min(x.ncols() - first);
            for k in 0..PANEL {
                let column = if k < width {
                    x.col(first + k).try_as_col_major()
                } else {
                    None
                };
                if let Some(column) = column {
                    from.iter_mut()
                        .zip(column.as_slice())
                        .for_each(|(f, x)| f[k] = *x);
                    continue;
                }
                for i in 0..n {
                    from[i][k] = if k < width {
                        x[(i, first + k)]
                    } else {
                        T::real(0.0)
                    };
                }
            }
            to.fill(zero);
            for j in 0..n {
                let xj = from[j];
                let mut sum = to[j];
                let range = self.start[j]..self.start[j + 1];
                for (&i, &v) in self.rows[range.clone()].iter().zip(&self.values[range]) {
                    let i = i as usize;
                    if i == j {
                        for k in 0..PANEL {
                            sum[k] += v * xj[k];
                        }
                    } else {
                        let c = v.conjugate();
                        let (xi, yi) = (&from[i], &mut to[i]);
                        for k in 0..PANEL {
                            sum[k] += c * xi[k];
                            yi[k] += v * xj[k];
                        }
                    }
                }
                to[j] = sum;
            }
            for k in 0..width {
                for i in 0..n {
                    y[(i, first + k)] = to[i][k];
                }
            }
            first += width;
        }
    }
}
