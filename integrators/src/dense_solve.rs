//! Small dense linear algebra for Newton corrections of a few coordinates.
//!
//! Gaussian elimination with partial pivoting, row-major, in place. Systems with more than a few tens of
//! coordinates bring their own [`SecondOrderSystem::correct`].

use crate::system::{Coeffs, SecondOrderSystem, Singular, StateView};

/// Solves `A x = b` in place: `a` is row-major `n x n` and is destroyed, `b` becomes `x`.
pub fn solve_in_place(a: &mut [f64], b: &mut [f64]) -> Result<(), Singular> {
    eliminate(a, b.len(), |k, p| b.swap(k, p))?;
    substitute(a, b);
    Ok(())
}

/// Solves `A x = b` in place where entries farther than `reach` from the diagonal are zero, in `n reach^2` operations.
/// See [`solve_in_place`] for a full matrix.
pub fn solve_banded(a: &mut [f64], b: &mut [f64], reach: usize) -> Result<(), Singular> {
    let n = b.len();
    debug_assert_eq!(a.len(), n * n);
    for k in 0..n {
        // Rows that are swapped reach further by as much as they came up.
        let (below, right) = ((k + reach + 1).min(n), (k + 2 * reach + 1).min(n));
        let mut p = k;
        for i in k + 1..below {
            if a[i * n + k].abs() > a[p * n + k].abs() {
                p = i;
            }
        }
        let pivot = a[p * n + k];
        if pivot == 0.0 || !pivot.is_finite() {
            return Err(Singular);
        }
        if p != k {
            for j in k..right {
                a.swap(k * n + j, p * n + j);
            }
            b.swap(k, p);
        }
        let (head, tail) = a.split_at_mut((k + 1) * n);
        let row_k = &head[k * n..];
        for (i, row) in (k + 1..below).zip(tail.chunks_exact_mut(n)) {
            let l = row[k] / pivot;
            if l != 0.0 {
                for (x, y) in row[k + 1..right].iter_mut().zip(&row_k[k + 1..right]) {
                    *x -= l * y;
                }
                b[i] -= l * b[k];
            }
        }
    }
    for k in (0..n).rev() {
        let right = (k + 2 * reach + 1).min(n);
        let mut x = b[k];
        for j in k + 1..right {
            x -= a[k * n + j] * b[j];
        }
        b[k] = x / a[k * n + k];
    }
    Ok(())
}

/// LU factors of a dense matrix, for many right-hand sides.
#[derive(Clone, Debug, Default)]
pub struct Lu {
    a: Vec<f64>,
    /// Row that was exchanged with each pivot row.
    pivots: Vec<usize>,
}

impl Lu {
    /// Factorises a row-major `n x n` matrix; the caller receives the previous buffer in exchange.
    ///
    /// # Errors
    /// [`Singular`].
    pub fn set(&mut self, a: &mut Vec<f64>, n: usize) -> Result<(), Singular> {
        std::mem::swap(&mut self.a, a);
        self.pivots.clear();
        eliminate(&mut self.a, n, |_, p| self.pivots.push(p))
    }

    /// Solves `A x = b` in place: `b <- A^-1 b`.
    pub fn solve(&self, b: &mut [f64]) {
        for (k, &p) in self.pivots.iter().enumerate() {
            b.swap(k, p);
        }
        substitute(&self.a, b);
    }
}

/// Factorises `P A = L U` in place, with a unit diagonal in `L`. `swapped` is called once per column with the pair of
/// rows that are exchanged.
fn eliminate(
    a: &mut [f64],
    n: usize,
    mut swapped: impl FnMut(usize, usize),
) -> Result<(), Singular> {
    debug_assert_eq!(a.len(), n * n);
    for k in 0..n {
        let mut p = k;
        for i in k + 1..n {
            if a[i * n + k].abs() > a[p * n + k].abs() {
                p = i;
            }
        }
        let pivot = a[p * n + k];
        if pivot == 0.0 || !pivot.is_finite() {
            return Err(Singular);
        }
        swapped(k, p);
        if p != k {
            for j in 0..n {
                a.swap(k * n + j, p * n + j);
            }
        }
        let (head, tail) = a.split_at_mut((k + 1) * n);
        let row_k = &head[k * n..];
        for row in tail.chunks_exact_mut(n) {
            let l = row[k] / pivot;
            row[k] = l;
            if l != 0.0 {
                for (x, y) in row[k + 1..].iter_mut().zip(&row_k[k + 1..n]) {
                    *x -= l * y;
                }
            }
        }
    }
    Ok(())
}

fn substitute(a: &[f64], b: &mut [f64]) {
    let n = b.len();
    for i in 1..n {
        let mut x = b[i];
        for j in 0..i {
            let l = a[i * n + j];
            if l != 0.0 {
                x -= l * b[j];
            }
        }
        b[i] = x;
    }
    for k in (0..n).rev() {
        let mut x = b[k];
        for j in k + 1..n {
            x -= a[k * n + j] * b[j];
        }
        b[k] = x / a[k * n + k];
    }
}

/// Largest number of coordinates for which the Newton matrix is stored on the stack.
const ON_STACK: usize = 8;

/// Solves for a Newton correction with a matrix that is formed column by column: `n` tangent products and a dense
/// elimination. It allocates above eight coordinates.
pub fn correct_by_columns<S: SecondOrderSystem + ?Sized>(
    sys: &mut S,
    at: StateView<'_>,
    c: Coeffs,
    rhs_to_x: &mut [f64],
) -> Result<(), Singular> {
    let n = rhs_to_x.len();
    if n <= ON_STACK {
        let mut a = [0.0; ON_STACK * ON_STACK];
        let mut columns = [0.0; 5 * ON_STACK];
        by_columns(sys, at, c, &mut a[..n * n], &mut columns[..5 * n], rhs_to_x)
    } else {
        by_columns(
            sys,
            at,
            c,
            &mut vec![0.0; n * n],
            &mut vec![0.0; 5 * n],
            rhs_to_x,
        )
    }
}

/// Forms the matrix in `a` and solves; `columns` is work space for five columns. Both have to be zero.
fn by_columns<S: SecondOrderSystem + ?Sized>(
    sys: &mut S,
    at: StateView<'_>,
    c: Coeffs,
    a: &mut [f64],
    columns: &mut [f64],
    rhs_to_x: &mut [f64],
) -> Result<(), Singular> {
    let n = rhs_to_x.len();
    let (unit, rest) = columns.split_at_mut(n);
    let (dq, rest) = rest.split_at_mut(n);
    let (dv, rest) = rest.split_at_mut(n);
    let (df, m) = rest.split_at_mut(n);
    for j in 0..n {
        unit[j] = 1.0;
        dq[j] = c.k;
        dv[j] = c.d;
        sys.tangent_times(at, dq, dv, df);
        sys.apply_mass(at, unit, m);
        for i in 0..n {
            a[i * n + j] = c.m * m[i] - df[i];
        }
        unit[j] = 0.0;
        dq[j] = 0.0;
        dv[j] = 0.0;
    }
    solve_in_place(a, rhs_to_x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_is_solved_as_the_whole_matrix_bit_by_bit() {
        let (n, reach) = (23, 3);
        let mut seed = 1_u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / f64::from(1 << 24) - 0.5
        };
        // Nothing says that the diagonal is the pivot.
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            for j in i.saturating_sub(reach)..(i + reach + 1).min(n) {
                a[i * n + j] = next();
            }
        }
        let b: Vec<f64> = (0..n).map(|_| next()).collect();
        let (mut whole, mut banded) = (b.clone(), b);
        solve_in_place(&mut a.clone(), &mut whole).unwrap();
        solve_banded(&mut a, &mut banded, reach).unwrap();
        assert_eq!(whole, banded);
    }

    #[test]
    fn solves_with_pivoting() {
        let mut a = vec![0.0, 2.0, 1.0, 1.0, -1.0, 3.0, 4.0, 0.5, -2.0];
        let x = [1.5, -2.0, 0.25];
        let mut b: Vec<f64> = (0..3)
            .map(|i| (0..3).map(|j| a[3 * i + j] * x[j]).sum())
            .collect();
        solve_in_place(&mut a, &mut b).unwrap();
        for (got, want) in b.iter().zip(x) {
            assert!((got - want).abs() < 1e-14, "{got} {want}");
        }
    }

    #[test]
    fn many_right_hand_sides_are_solved_alike() {
        let number = |i: usize| ((7 * i * i + 3 * i) as f64).sin();
        let n = 9;
        let matrix: Vec<f64> = (0..n * n).map(number).collect();
        let mut lu = Lu::default();
        lu.set(&mut matrix.clone(), n).unwrap();
        for column in 0..3 {
            let mut b: Vec<f64> = (0..n).map(|i| number(i + 100 * column)).collect();
            let mut alone = b.clone();
            lu.solve(&mut b);
            solve_in_place(&mut matrix.clone(), &mut alone).unwrap();
            assert_eq!(b, alone);
        }
    }

    #[test]
    fn refuses_a_singular_matrix() {
        assert_eq!(
            solve_in_place(&mut [1.0, 2.0, 2.0, 4.0], &mut [1.0, 1.0]),
            Err(Singular)
        );
    }
}
