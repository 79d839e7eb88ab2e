//! Factors against exact solutions of Laplacians, orders against each other, sweeps against faer's.

use super::*;
use crate::test_support::product;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Par};
use std::sync::Arc;

/// Lower triangle of a vector Laplacian on an n x n x n grid with `dofs` unknowns per node, 27 neighbours.
pub(crate) fn brick(n: [usize; 3], dofs: usize, shift: f64) -> SparseColMat<usize, f64> {
    let index = |x: usize, y: usize, z: usize| (x * n[1] + y) * n[2] + z;
    let mut triplets = Vec::new();
    for x in 0..n[0] {
        for y in 0..n[1] {
            for z in 0..n[2] {
                let a = index(x, y, z);
                for (ox, oy, oz) in (x..=x + 2).flat_map(|p| {
                    (y..=y + 2).flat_map(move |q| (z..=z + 2).map(move |r| (p, q, r)))
                }) {
                    if ox == 0 || oy == 0 || oz == 0 || ox > n[0] || oy > n[1] || oz > n[2] {
                        continue;
                    }
                    let b = index(ox - 1, oy - 1, oz - 1);
                    for da in 0..dofs {
                        for db in 0..dofs {
                            let (i, j) = (a * dofs + da, b * dofs + db);
                            if i >= j {
                                let value = match (a == b, da == db) {
                                    (true, true) => 27.0 * dofs as f64 + shift,
                                    (true, false) => 0.3,
                                    (false, true) => -1.0,
                                    (false, false) => 0.1,
                                };
                                triplets.push(Triplet::new(i, j, value));
                            }
                        }
                    }
                }
            }
        }
    }
    let size = n[0] * n[1] * n[2] * dofs;
    SparseColMat::try_new_from_triplets(size, size, &triplets).unwrap()
}

fn wave(n: usize) -> Vec<f64> {
    (0..n).map(|i| (0.7 * i as f64).sin() + 0.2).collect()
}

#[test]
fn every_order_and_both_sweeps_solve() {
    let a = brick([7, 6, 5], 3, 0.0);
    let exact = wave(a.ncols());
    let b = product(&a, &exact);
    for order in ordering::both(a.symbolic()) {
        let symbolic = Arc::new(Symbolic::ordered(a.symbolic(), &order).unwrap());
        let mut factor = Cholesky::with_symbolic(a.as_ref(), symbolic, Some(Par::Seq)).unwrap();
        let mut x = b.clone();
        factor.solve(&mut x);
        let mut many = Mat::from_fn(b.len(), 3, |i, j| b[i] * (j + 1) as f64);
        factor.solve_many(many.as_mut(), Par::Seq);
        for i in 0..x.len() {
            assert!((x[i] - exact[i]).abs() < 1e-12, "{} at {i}", x[i]);
            assert!((many[(i, 2)] - 3.0 * exact[i]).abs() < 1e-12);
        }
        assert!(factor.bytes() >= 8 * factor.factor_nonzeros());
    }
}

#[test]
fn counted_fill_is_that_of_the_factor() {
    // A chain has no fill in any good order: n diagonal entries and n - 1 below.
    let n = 50;
    let chain: Vec<_> = (0..n)
        .flat_map(|i| {
            [
                Triplet::new(i, i, 2.0),
                Triplet::new((i + 1).min(n - 1), i, if i + 1 < n { -1.0 } else { 0.0 }),
            ]
        })
        .collect();
    let a = SparseColMat::try_new_from_triplets(n, n, &chain).unwrap();
    let factor = Cholesky::new(a.as_ref()).unwrap();
    assert_eq!(factor.factor_nonzeros(), 2 * n - 1);
    // A full matrix: n (n + 1) / 2.
    let full = brick([2, 2, 2], 3, 0.0);
    let factor = Cholesky::new(full.as_ref()).unwrap();
    assert_eq!(factor.factor_nonzeros(), 24 * 25 / 2);
}

#[test]
fn another_matrix_of_the_pattern_reuses_the_analysis() {
    let (a, b) = (brick([4, 4, 4], 3, 0.0), brick([4, 4, 4], 3, 5.0));
    let mut factor = Cholesky::new(a.as_ref()).unwrap();
    factor.refactor(b.as_ref()).unwrap();
    let exact = wave(b.ncols());
    let mut x = product(&b, &exact);
    factor.solve(&mut x);
    assert!(x.iter().zip(&exact).all(|(x, e)| (x - e).abs() < 1e-12));
    let other = brick([4, 4, 3], 3, 0.0);
    assert_eq!(
        factor.refactor(other.as_ref()),
        Err(SolveError::OtherPattern)
    );
}

#[test]
fn indefinite_matrices_are_refused_and_counted() {
    // Diagonal -1, 2, -3, 4: the pivot names the unknown.
    let d: Vec<_> = [-1.0, 2.0, -3.0, 4.0]
        .iter()
        .enumerate()
        .map(|(i, v)| Triplet::new(i, i, *v))
        .collect();
    let a = SparseColMat::try_new_from_triplets(4, 4, &d).unwrap();
    let error = Cholesky::new(a.as_ref()).unwrap_err();
    assert!(
        matches!(error, SolveError::NotPositiveDefinite { unknown: 0 | 2 }),
        "{error}"
    );
    let symbolic = Symbolic::new(a.symbolic()).unwrap();
    assert_eq!(negative_eigenvalues(a.as_ref(), &symbolic), Ok(2));
}

#[test]
fn empty_and_not_square() {
    let none: [Triplet<usize, usize, f64>; 0] = [];
    let empty = SparseColMat::<usize, f64>::try_new_from_triplets(0, 0, &none).unwrap();
    Cholesky::new(empty.as_ref()).unwrap().solve(&mut []);
    let wide = SparseColMat::<usize, f64>::try_new_from_triplets(2, 3, &none).unwrap();
    assert_eq!(
        Cholesky::new(wide.as_ref()).unwrap_err(),
        SolveError::NotSquare {
            rows: 2,
            columns: 3
        }
    );
}
