//! Linear system `q'' + D q' + K q = 0` with unit masses, and the limit of a method on it.
//!
//! With `M = L L^T` the coordinates are `L^T q`, so that `D` and `K` become `L^-1 D L^-T` and `L^-1 K L^-T`; all
//! methods of the table commute with that. Only the symmetric parts are kept: what contacts that move along the path and
//! friction add to the skew part is orders of magnitude below their stiffness and does not shift a limit.

use super::LimitError;
use faer::Mat;
use gearbench_integrators::linear_stability::{Stability, eigenvalues_of, first_exit};
use nalgebra::DMatrix;

/// Frequencies below this part of the highest are bodies that move freely: rounding, not modes.
const FREE: f64 = 1e-5;
/// Coupling of modes by dampers, over the largest damping, that counts as none.
const COUPLED: f64 = 1e-9;

/// Linear system with unit masses, complete or reduced to its fastest mode.
#[derive(Clone, Debug)]
pub enum Linear {
    /// Complete matrices of the system.
    Dense(Dense),
    /// Fastest mode of a large system.
    FastestMode(FastestMode),
}

/// Dense stiffness and damping matrices for unit masses.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    /// Symmetric stiffness matrix for unit masses [1/s^2].
    pub stiffness: DMatrix<f64>,
    /// Symmetric damping matrix for unit masses [1/s].
    pub damping: DMatrix<f64>,
    /// Part of the damping that acts at the velocities at the end of a half-step impulse ([`force_after`]), implicitly:
    /// dashpots and friction of flank points. Methods that predict velocities ([`Flip::predicts`]) do not evaluate it
    /// at the predicted ones. `None` if there is none.
    ///
    /// [`force_after`]: gearbench_integrators::SecondOrderSystem::force_after
    /// [`Flip::predicts`]: gearbench_integrators::linear_stability::Flip::predicts
    pub at_ends: Option<DMatrix<f64>>,
}

/// Fastest mode of a system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FastestMode {
    /// Undamped angular frequency [rad/s].
    pub omega: f64,
    /// Damping ratio: that of `phi^T D phi`, exact where dampers do not couple the modes.
    pub zeta: f64,
    /// Damping ratio of the dampers that act at predicted velocities, for methods that predict them; see
    /// [`Dense::at_ends`].
    pub zeta_predicted: f64,
}

impl Linear {
    /// Returns the highest undamped angular frequency [rad/s]; zero where nothing vibrates.
    pub fn highest(&self) -> f64 {
        match self {
            Linear::Dense(x) => x.highest(),
            Linear::FastestMode(x) => x.omega,
        }
    }

    /// Returns the largest stable step [s] of a method; `None` where every step is stable, or where the method's limit
    /// does not depend on `D` and `K` alone.
    pub fn largest_step(&self, stability: &Stability) -> Result<Option<f64>, LimitError> {
        match self {
            Linear::Dense(x) => x.largest_step(stability),
            Linear::FastestMode(x) => Ok(match stability {
                Stability::Impulses(_) => None,
                Stability::Flip(flip) if flip.predicts() => {
                    Some(flip.largest_step(x.omega, x.zeta_predicted))
                }
                other => other.largest_step(x.omega, x.zeta),
            }),
        }
    }
}

/// Eigenvalues of a symmetric matrix, ascending.
fn symmetric_eigenvalues(a: &DMatrix<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = a.clone().symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

impl Dense {
    /// Creates the system from `M`, `D`, `K`, and the part of `D` that acts at the velocities at the end of an impulse.
    ///
    /// # Errors
    /// [`LimitError::Matrices`] where the mass is not positive definite or an entry is not finite.
    pub fn of(
        m: DMatrix<f64>,
        (d, at_ends): (DMatrix<f64>, Option<DMatrix<f64>>),
        k: DMatrix<f64>,
    ) -> Result<Dense, LimitError> {
        let ends = at_ends.iter().flatten();
        if !m
            .iter()
            .chain(&d)
            .chain(ends)
            .chain(&k)
            .all(|x| x.is_finite())
        {
            return Err(LimitError::Matrices("its tangent is not finite"));
        }
        let Some(chol) = m.cholesky() else {
            return Err(LimitError::Matrices("its mass is not positive definite"));
        };
        let l = chol.l();
        let scaled = |x: DMatrix<f64>| {
            let left = l.solve_lower_triangular(&x).unwrap_or(x);
            let both = l.solve_lower_triangular(&left.transpose()).unwrap_or(left);
            0.5 * (&both + both.transpose())
        };
        Ok(Dense {
            damping: scaled(d),
            at_ends: at_ends.map(scaled),
            stiffness: scaled(k),
        })
    }

    /// Returns the number of coordinates.
    pub fn n(&self) -> usize {
        self.stiffness.nrows()
    }

    /// Returns the system without dampers.
    pub fn undamped(&self) -> Dense {
        Dense {
            stiffness: self.stiffness.clone(),
            damping: DMatrix::zeros(self.n(), self.n()),
            at_ends: None,
        }
    }

    /// True if the damping matrix is zero.
    pub fn is_undamped(&self) -> bool {
        self.damping.iter().all(|x| *x == 0.0)
    }

    fn highest(&self) -> f64 {
        let highest = symmetric_eigenvalues(&self.stiffness).pop();
        highest.unwrap_or(0.0).max(0.0).sqrt()
    }

    /// Returns the angular frequencies [rad/s] and damping ratios of the modes that vibrate; `None` where dampers
    /// couple them.
    pub fn modes(&self) -> Option<Vec<[f64; 2]>> {
        let n = self.n();
        let eigen = self.stiffness.clone().symmetric_eigen();
        let rotated = eigen.eigenvectors.transpose() * &self.damping * &eigen.eigenvectors;
        let largest = rotated.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let coupled =
            |i: usize| (0..n).any(|j| i != j && rotated[(i, j)].abs() > COUPLED * largest);
        if (0..n).any(coupled) {
            return None;
        }
        let highest = eigen.eigenvalues.max().max(0.0).sqrt();
        let of_mode = |i: usize| {
            let omega = eigen.eigenvalues[i].max(0.0).sqrt();
            (omega > FREE * highest).then(|| [omega, 0.5 * rotated[(i, i)] / omega])
        };
        Some((0..n).filter_map(of_mode).collect())
    }

    /// Computes the eigenvalues `[re, im]` [1/s] of the system in first order, without those of rigid-body motion.
    ///
    /// # Errors
    /// [`LimitError::Matrices`] where they could not be found.
    pub fn eigenvalues(&self) -> Result<Vec<[f64; 2]>, LimitError> {
        if let Some(modes) = self.modes() {
            let pairs = modes.into_iter().flat_map(|[w, z]| eigenvalues_of(w, z));
            return Ok(pairs.collect());
        }
        // In units of the fastest mode's time the entries of ((0, 1), (-K, -D)) are of size one.
        let n = self.n();
        let w = self.highest();
        let matrix = Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => 0.0,
            (true, false) => f64::from(u8::from(i == j - n)),
            (false, true) => -self.stiffness[(i - n, j)] / (w * w),
            (false, false) => -self.damping[(i - n, j - n)] / w,
        });
        let values = eigenvalues(&matrix)?;
        Ok(values
            .into_iter()
            .filter(|z| z[0].hypot(z[1]) > FREE)
            .map(|z| z.map(|x| x * w))
            .collect())
    }

    fn largest_step(&self, stability: &Stability) -> Result<Option<f64>, LimitError> {
        let highest = self.highest();
        if highest == 0.0 {
            return Ok(None);
        }
        match stability {
            Stability::Polynomial(r) if self.is_undamped() => {
                Ok(Some(first_exit(r, [0.0, highest])))
            }
            Stability::Polynomial(r) => {
                let exits = self.eigenvalues()?.into_iter().map(|z| first_exit(r, z));
                Ok(Some(exits.fold(f64::INFINITY, f64::min)))
            }
            Stability::Flip(flip) => {
                let mut high = flip.largest_step(highest, 0.0);
                let damping = match &self.at_ends {
                    Some(at_ends) if flip.predicts() => &self.damping - at_ends,
                    _ => self.damping.clone(),
                };
                if damping.iter().all(|x| *x == 0.0) || flip.d == 0.0 {
                    return Ok(Some(high));
                }
                let mut low = 0.0;
                while high - low > 1e-6 * high {
                    let h = 0.5 * (low + high);
                    let mut matrix = -flip.d * h * &damping - flip.k * h * h * &self.stiffness;
                    for i in 0..self.n() {
                        matrix[(i, i)] += 4.0;
                    }
                    if matrix.cholesky().is_some() {
                        low = h;
                    } else {
                        high = h;
                    }
                }
                Ok(Some(low))
            }
            Stability::Impulses(_) | Stability::Unconditional | Stability::Controlled => Ok(None),
        }
    }
}

/// Computes the eigenvalues `[re, im]` of a matrix with entries of order one, and checks them by the traces of the
/// matrix and of its square.
pub(super) fn eigenvalues(matrix: &Mat<f64>) -> Result<Vec<[f64; 2]>, LimitError> {
    let fail = LimitError::Matrices("its eigenvalues could not be found");
    let values = matrix.eigenvalues().map_err(|_| fail.clone())?;
    let n = matrix.nrows();
    let trace: f64 = (0..n).map(|i| matrix[(i, i)]).sum();
    let (mut square, mut size) = (0.0, 0.0);
    for i in 0..n {
        for j in 0..n {
            square += matrix[(i, j)] * matrix[(j, i)];
            size += (matrix[(i, j)] * matrix[(j, i)]).abs();
        }
    }
    let sum: f64 = values.iter().map(|z| z.re).sum();
    let squares: f64 = values.iter().map(|z| z.re * z.re - z.im * z.im).sum();
    let scale = size.max(1.0);
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-8 * scale;
    if close(sum, trace) && close(squares, square) {
        Ok(values.into_iter().map(|z| [z.re, z.im]).collect())
    } else {
        Err(fail)
    }
}
