//! Eigenmodes: shift-invert block Lanczos, and cyclic symmetry.
//!
//! Modes of `K phi = omega^2 M phi`, the lowest first, orthonormal in M: `phi_i^T M phi_j = delta_ij`.
//!
//! | part | owns |
//! |---|---|
//! | [`lowest`] | lowest modes of any symmetric pair, [`Options`], [`Modes`], the count that proves none is missing |
//! | `lanczos` | the iteration, for real and Hermitian matrices |
//! | `ritz` | modes within the span of given shapes |
//! | [`cyclic`] | modes of a body of equal sectors from one of them |
//!
//! A body free in the mount has modes of zero frequency; a shift below zero keeps the factor positive definite.

pub mod cyclic;
mod dense;
mod lanczos;
mod ritz;
mod symmetric;
#[cfg(test)]
mod tests;

pub use lanczos::{Report, Target};
pub use ritz::ritz;
pub use symmetric::Symmetric;

use crate::assembly::tie::Reduced;
use crate::limits::{self, TooMuchMemory};
use crate::solve::{Cholesky, Scalar, SolveError, Symbolic, negative_eigenvalues};
use faer::{Mat, MatRef};
use std::sync::Arc;

/// How to find modes.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Shift sigma of `(K - sigma M)^-1 M` [rad²/s²], below the whole spectrum; `None`: slightly below zero.
    pub shift: Option<f64>,
    /// Vectors per step; should be the largest multiplicity or more. `None`: 8, and 4 for the harmonics of a
    /// cyclic gear, whose modes are simple.
    pub block: Option<usize>,
    /// True if the inertia of a shifted matrix shall prove that no mode is missing (one more factorisation).
    pub verify: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            shift: None,
            block: None,
            verify: true,
        }
    }
}

/// Eigenvalues, ascending, and orthonormal eigenvectors of a dense symmetric matrix, of which the lower triangle is read.
///
/// # Errors
/// [`ModesError::Matrix`] where an entry is not finite.
pub fn symmetric_eigen(a: MatRef<'_, f64>) -> Result<(Vec<f64>, Mat<f64>), ModesError> {
    dense::eigen(a)
}

/// Vectors per step for a whole body.
const BLOCK: usize = 8;

/// Lowest modes of a pair of matrices.
#[derive(Clone, Debug)]
pub struct Modes<T: Scalar = f64> {
    /// Squares of the angular frequencies [rad²/s²], ascending.
    pub omega2: Vec<f64>,
    /// Shapes, unknowns x modes, orthonormal in M [1/sqrt(kg)].
    pub vectors: Mat<T>,
    /// `|K phi - omega^2 M phi| / |K phi|` of each mode; of a rigid-body mode over `|sigma M phi|` instead.
    pub residuals: Vec<f64>,
    /// Counters of the work.
    pub report: Report,
}

impl<T: Scalar> Modes<T> {
    /// Frequencies [Hz]; zero for a rigid-body mode whose square came out below zero by rounding.
    pub fn frequencies(&self) -> Vec<f64> {
        let to_hz = |w2: &f64| w2.max(0.0).sqrt() / std::f64::consts::TAU;
        self.omega2.iter().map(to_hz).collect()
    }
}

/// Error of a search for modes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum ModesError {
    #[error("shifted stiffness matrix: {0}")]
    Solve(#[from] SolveError),
    #[error("the stiffness matrix has {stiffness} unknowns, the mass matrix {mass}")]
    Sizes { stiffness: usize, mass: usize },
    #[error("{wanted} modes wanted of a body with {unknowns} free coordinates: ask for fewer")]
    TooMany { wanted: usize, unknowns: usize },
    #[error("{0}")]
    Matrix(&'static str),
    #[error(
        "{found} of {wanted} modes found in {steps} steps: the problem is ill-conditioned or the shift far off"
    )]
    NotConverged {
        found: usize,
        wanted: usize,
        steps: usize,
    },
    #[error(
        "{counted} modes lie below {frequency:.6e} Hz, but {found} were found: the block is smaller than the \
         multiplicity of a mode; raise `block`"
    )]
    Missed {
        counted: usize,
        found: usize,
        frequency: f64,
    },
    #[error("sector mesh: {0}")]
    Sector(String),
    #[error(transparent)]
    TooLarge(#[from] TooMuchMemory),
}

/// Number of stored vectors of the size of a mode, per mode.
const BASIS: f64 = 4.0;

/// Shift relative to the median of `K_ii / M_ii`, which is about the square of the highest frequency: far above
/// rounding, far below the first elastic mode of a body.
const RELATIVE_SHIFT: f64 = -1e-6;

/// A shift slightly below zero that suits the matrices.
pub(crate) fn default_shift<T: Scalar>(k: &Symmetric<T>, m: &Symmetric<T>) -> f64 {
    let mut ratios: Vec<f64> = (k.diagonal().zip(m.diagonal()))
        .filter(|(_, m)| *m > 0.0)
        .map(|(k, m)| k / m)
        .collect();
    if ratios.is_empty() {
        return -1.0;
    }
    let middle = ratios.len() / 2;
    let (_, median, _) = ratios.select_nth_unstable_by(middle, f64::total_cmp);
    if *median > 0.0 {
        RELATIVE_SHIFT * *median
    } else {
        -1.0
    }
}

/// The lowest modes of `K phi = omega^2 M phi`.
///
/// ```
/// use faer::sparse::{SparseColMat, Triplet};
/// use gearbench_solid_fe::assembly::tie::Reduced;
/// use gearbench_solid_fe::modes::{Options, lowest};
///
/// // Ten unit masses in a row between two walls, unit springs: omega_i = 2 sin(i pi / 22).
/// let n = 10;
/// let spring = |i: usize| [(i, i, 2.0), ((i + 1).min(n - 1), i, if i + 1 < n { -1.0 } else { 0.0 })];
/// let k: Vec<_> = (0..n).flat_map(spring).map(|(i, j, v)| Triplet::new(i, j, v)).collect();
/// let stiffness = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &k).unwrap();
/// let m: Vec<_> = (0..n).map(|i| Triplet::new(i, i, 1.0)).collect();
/// let mass = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &m).unwrap();
/// let modes = lowest(&Reduced { stiffness, mass }, 3, &Options::default()).unwrap();
/// let exact = 2.0 * (std::f64::consts::PI / 22.0).sin();
/// assert!((modes.omega2[0] - exact * exact).abs() < 1e-12);
/// ```
pub fn lowest(pair: &Reduced, count: usize, options: &Options) -> Result<Modes, ModesError> {
    find(pair, Target::Count(count), options)
}

/// Number of unknowns below which all modes of a body are computed.
const FEW_UNKNOWNS: usize = 600;

/// The lowest modes, or all up to a bound, of a pair of lower triangles.
pub fn find(pair: &Reduced, target: Target, options: &Options) -> Result<Modes, ModesError> {
    let (k, m) = (pair.stiffness.as_ref(), pair.mass.as_ref());
    if k.ncols() != m.ncols() {
        return Err(ModesError::Sizes {
            stiffness: k.ncols(),
            mass: m.ncols(),
        });
    }
    let (k, m) = (Symmetric::new(k)?, Arc::new(Symmetric::new(m)?));
    let n = k.size();
    let shift = options.shift.unwrap_or_else(|| default_shift(&k, &m));
    let block = options.block.unwrap_or(BLOCK).max(1);
    match target {
        Target::Count(count) if count > n => {
            return Err(ModesError::TooMany {
                wanted: count,
                unknowns: n,
            });
        }
        Target::Count(count) if lanczos::is_small(n, count, block) => {
            return dense::lowest(&k, &m, count, shift);
        }
        Target::Above(omega2) if n <= FEW_UNKNOWNS => {
            let mut all = dense::lowest(&k, &m, n, shift)?;
            let count = all.omega2.partition_point(|w2| *w2 <= omega2);
            all.omega2.truncate(count);
            all.residuals.truncate(count);
            all.vectors = all.vectors.subcols(0, count).to_owned();
            return Ok(all);
        }
        _ => {}
    }
    if let Target::Count(count) = target {
        let what = format!("{count} modes of {n} unknowns");
        limits::check(
            what,
            BASIS * 8.0 * count as f64 * n as f64,
            "ask for fewer modes, or use fewer elements",
        )?;
    }
    let shifted = k.minus(shift, &m);
    let symbolic = Arc::new(Symbolic::new(shifted.symbolic())?);
    let factor = Cholesky::with_symbolic(shifted.as_ref(), symbolic.clone(), None)?;
    drop(shifted);
    let mut iteration = lanczos::Lanczos::new(m.clone(), shift, block);
    iteration.report.factorisations = 1;
    iteration.report.factor_bytes = factor.bytes();
    iteration.run(&factor, target)?;
    let count = match target {
        Target::Count(count) => count,
        Target::Above(omega2) => iteration.found()?.partition_point(|w2| *w2 <= omega2),
    };
    let mut modes = iteration.modes(&factor, &k, count)?;
    if options.verify && count > 1 {
        verify(&k, &m, &symbolic, block, &mut modes)?;
    }
    Ok(modes)
}

/// Squares of frequencies that differ by less, relatively, are those of a pair: rounding decides which is the lower.
const PAIR: f64 = 1e-6;

/// Counts the modes below a gap near the end of the computed ones.
fn verify(
    k: &Symmetric<f64>,
    m: &Symmetric<f64>,
    symbolic: &Symbolic,
    block: usize,
    modes: &mut Modes,
) -> Result<(), ModesError> {
    let w2 = &modes.omega2;
    let last = w2.len() - 1;
    let from = last.saturating_sub(block.max(4));
    let gap = |i: &usize| (w2[i + 1] - w2[*i]) / w2[i + 1].abs().max(f64::MIN_POSITIVE);
    let widest = (from..last).max_by(|a, b| gap(a).total_cmp(&gap(b)));
    // Between the two of a pair there is nothing to count in.
    let Some(i) = widest.filter(|i| gap(i) > PAIR) else {
        return Ok(());
    };
    let bound = 0.5 * (w2[i] + w2[i + 1]);
    let counted = negative_eigenvalues(k.minus(bound, m).as_ref(), symbolic)?;
    if counted != i + 1 {
        return Err(ModesError::Missed {
            counted,
            found: i + 1,
            frequency: bound.max(0.0).sqrt() / std::f64::consts::TAU,
        });
    }
    modes.report.verified = counted;
    modes.report.factorisations += 1;
    Ok(())
}
