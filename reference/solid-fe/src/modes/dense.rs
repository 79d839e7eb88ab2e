//! Dense eigenproblems: the projected one of each iteration, and whole problems that are small.

use super::{Modes, ModesError, Report, Symmetric};
use crate::solve::Scalar;
use faer::diag::DiagMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::solvers::Llt;
use faer::{Accum, Mat, MatRef, Par, Side};

/// Eigenvalues, ascending, and eigenvectors of a Hermitian matrix, of which the lower triangle is read.
///
/// The matrix is scaled to a largest entry of one first: faer's divide and conquer deflates by an absolute
/// tolerance and loses accuracy otherwise.
pub(super) fn eigen<T: Scalar>(a: MatRef<'_, T>) -> Result<(Vec<f64>, Mat<T>), ModesError> {
    const FAILED: ModesError =
        ModesError::Matrix("a projected eigenproblem has no finite solution");
    let n = a.nrows();
    let mut largest = 0.0_f64;
    for j in 0..n {
        for i in j..n {
            let entry = a[(i, j)].modulus2();
            if !entry.is_finite() {
                return Err(FAILED);
            }
            largest = largest.max(entry);
        }
    }
    let scale = largest.sqrt();
    if scale == 0.0 {
        return Ok((vec![0.0; n], Mat::identity(n, n)));
    }
    let factor = T::real(1.0 / scale);
    let scaled = Mat::from_fn(n, n, |i, j| a[(i, j)] * factor);
    let mut values = vec![T::real(0.0); n];
    let mut vectors = Mat::zeros(n, n);
    let request =
        self_adjoint_evd_scratch::<T>(n, ComputeEigenvectors::Yes, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(request);
    self_adjoint_evd(
        scaled.as_ref(),
        DiagMut::from_slice_mut(&mut values),
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut memory),
        Default::default(),
    )
    .map_err(|_| FAILED)?;
    let values = values
        .iter()
        .map(|v| scale * faer::traits::math_utils::real(v))
        .collect();
    Ok((values, vectors))
}

/// Lowest modes of a small problem by a full decomposition: `M = L L^H`, `C = L^-1 (K - sigma M) L^-H`.
pub(super) fn lowest<T: Scalar>(
    k: &Symmetric<T>,
    m: &Symmetric<T>,
    count: usize,
    shift: f64,
) -> Result<Modes<T>, ModesError> {
    let n = k.size();
    let full = |a: &Symmetric<T>| {
        let identity = Mat::<T>::identity(n, n);
        let mut full = Mat::zeros(n, n);
        a.apply(identity.as_ref(), full.as_mut());
        full
    };
    let (k_full, m_full) = (full(k), full(m));
    let factor = Llt::new(m_full.as_ref(), Side::Lower)
        .map_err(|_| ModesError::Matrix("the mass matrix is not positive definite"))?;
    let l = factor.L();
    let mut c = k_full;
    faer::linalg::triangular_solve::solve_lower_triangular_in_place(l, c.as_mut(), Par::Seq);
    let mut c = c.adjoint().to_owned();
    faer::linalg::triangular_solve::solve_lower_triangular_in_place(l, c.as_mut(), Par::Seq);
    let (omega2, mut vectors) = eigen(c.as_ref())?;
    faer::linalg::triangular_solve::solve_upper_triangular_in_place(
        l.adjoint(),
        vectors.as_mut(),
        Par::Seq,
    );
    let vectors = vectors.subcols(0, count).to_owned();
    let omega2 = omega2[..count].to_vec();
    let residuals = residuals(k, m, &omega2, vectors.as_ref(), shift);
    Ok(Modes {
        omega2,
        vectors,
        residuals,
        report: Report {
            subspace: n,
            verified: count,
            ..Report::default()
        },
    })
}

/// `|K phi - omega^2 M phi| / max(|K phi|, |sigma M phi|)`.
pub(super) fn residuals<T: Scalar>(
    k: &Symmetric<T>,
    m: &Symmetric<T>,
    omega2: &[f64],
    vectors: MatRef<'_, T>,
    shift: f64,
) -> Vec<f64> {
    let (n, count) = (vectors.nrows(), vectors.ncols());
    let (mut kv, mut mv) = (Mat::zeros(n, count), Mat::zeros(n, count));
    k.apply(vectors, kv.as_mut());
    m.apply(vectors, mv.as_mut());
    (0..count)
        .map(|j| {
            let (mut rest, mut elastic, mut inertial) = (0.0, 0.0, 0.0);
            for i in 0..n {
                rest += (kv[(i, j)] - T::real(omega2[j]) * mv[(i, j)]).modulus2();
                elastic += kv[(i, j)].modulus2();
                inertial += mv[(i, j)].modulus2();
            }
            (rest / elastic.max(shift * shift * inertial)).sqrt()
        })
        .collect()
}

/// Returns the product `A B`.
pub(super) fn product<T: Scalar>(a: MatRef<'_, T>, b: MatRef<'_, T>) -> Mat<T> {
    let mut c = Mat::zeros(a.nrows(), b.ncols());
    let one = T::real(1.0);
    matmul(c.as_mut(), Accum::Replace, a, b, one, Par::Seq);
    c
}

/// Returns the product `A^H B`.
pub(super) fn adjoint_product<T: Scalar>(a: MatRef<'_, T>, b: MatRef<'_, T>) -> Mat<T> {
    let mut c = Mat::zeros(a.ncols(), b.ncols());
    let one = T::real(1.0);
    matmul(c.as_mut(), Accum::Replace, a.adjoint(), b, one, Par::Seq);
    c
}
