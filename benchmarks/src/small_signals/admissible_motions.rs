//! Space of admissible motions in coordinates of unit mass: the motions that satisfy the constraints, without
//! rigid-body ones.
//!
//! With `M = L L^T` and `y = L^T x` the constrained directions are mapped to the first axes by Householder reflections.
//! The remaining `n - h` coordinates span the admissible motions; stiffness and damping are matrices over them,
//! accurate to rounding relative to their own size. Constrained directions have no frequency.

use super::LoadedStateError;
use faer::Mat;
use gearbench_reference::modes::symmetric_eigen;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// A direction is linearly dependent if its relative remainder is smaller.
const DEPENDENT: f64 = 1e-10;
/// Largest residual of an eigenvector, relative to the size of the matrix.
const RESIDUAL: f64 = 1e-10;

/// Admissible motions in coordinates of unit mass.
#[derive(Clone, Debug)]
pub struct AdmissibleMotions {
    mass: Cholesky<f64, Dyn>,
    /// Unit normals of the Householder reflections; the first k entries of the k-th are zero.
    reflections: Vec<DVector<f64>>,
}

/// Eigenvalues [rad^2/s^2], ascending, and eigenvectors in the coordinates of a space.
#[derive(Clone, Debug)]
pub struct Modes {
    /// Squares of the angular frequencies, ascending [rad^2/s^2].
    pub squares: Vec<f64>,
    /// Eigenvectors as the columns of a matrix.
    pub vectors: DMatrix<f64>,
    /// Largest `|K u - lambda u|`, relative to the size of the matrix.
    pub residual: f64,
}

impl AdmissibleMotions {
    /// The space of all motions, without constraints.
    pub fn new(mass: &DMatrix<f64>) -> Result<AdmissibleMotions, LoadedStateError> {
        let mass = (mass.clone().cholesky()).ok_or(LoadedStateError::Matrices(
            "its mass is not positive definite",
        ))?;
        Ok(AdmissibleMotions {
            mass,
            reflections: Vec::new(),
        })
    }

    /// Adds the constraints `C x = 0`.
    pub fn constrain(&mut self, rows: &[Vec<f64>]) {
        for row in rows {
            let row = self.over_mass(row);
            self.constrain_along(row);
        }
    }

    /// Constrains the motion along a vector `y`.
    pub fn constrain_along(&mut self, along: DVector<f64>) {
        let (k, size) = (self.reflections.len(), along.norm());
        let mut normal = along;
        self.reflect(&mut normal);
        normal.rows_mut(0, k).fill(0.0);
        let left = normal.norm();
        if k == normal.len() || left <= DEPENDENT * size {
            return;
        }
        normal[k] += left.copysign(normal[k]);
        normal.normalize_mut();
        self.reflections.push(normal);
    }

    /// Number of constrained directions.
    pub fn constraints(&self) -> usize {
        self.reflections.len()
    }

    /// Number of admissible motions.
    pub fn motions(&self) -> usize {
        self.mass.l_dirty().nrows() - self.constraints()
    }

    /// Computes `L^-1 f` with the Cholesky factor `L` of the mass matrix.
    fn over_mass(&self, f: &[f64]) -> DVector<f64> {
        let mut y = DVector::from_column_slice(f);
        self.mass.l_dirty().solve_lower_triangular_mut(&mut y);
        y
    }

    fn reflect(&self, y: &mut DVector<f64>) {
        for normal in &self.reflections {
            let along = 2.0 * normal.dot(y);
            y.axpy(-along, normal, 1.0);
        }
    }

    /// Projects a force on the coordinates of the space.
    pub fn force(&self, f: &[f64]) -> DVector<f64> {
        let mut y = self.over_mass(f);
        self.reflect(&mut y);
        y.rows(self.constraints(), self.motions()).into_owned()
    }

    /// The force over the coordinates of the scene of a force in the space.
    pub fn force_of(&self, u: &DVector<f64>) -> Vec<f64> {
        (self.mass.l() * self.whole(u)).as_slice().to_vec()
    }

    /// Projects a velocity on the coordinates of the space.
    pub fn velocity(&self, v: &[f64]) -> DVector<f64> {
        let mut y = self.all_velocity(v);
        self.reflect(&mut y);
        y.rows(self.constraints(), self.motions()).into_owned()
    }

    /// Converts a velocity to coordinates `y` of unit mass.
    pub fn all_velocity(&self, v: &[f64]) -> DVector<f64> {
        self.mass.l().transpose() * DVector::from_column_slice(v)
    }

    /// The part of a velocity along the first constrained directions.
    pub fn held_velocity(&self, v: &[f64], first: usize) -> Vec<f64> {
        let mut y = self.all_velocity(v);
        self.reflect(&mut y);
        y.rows_mut(first, self.constraints() + self.motions() - first)
            .fill(0.0);
        for normal in self.reflections.iter().rev() {
            let along = 2.0 * normal.dot(&y);
            y.axpy(-along, normal, 1.0);
        }
        self.displacement_of(&y)
    }

    /// Norm of a force, weighted by the inverse mass.
    pub fn size_of(&self, f: &[f64]) -> f64 {
        self.over_mass(f).norm()
    }

    /// Converts coordinates `y` of unit mass to a displacement.
    pub fn displacement_of(&self, y: &DVector<f64>) -> Vec<f64> {
        let mut x = y.clone();
        self.mass.l_dirty().tr_solve_lower_triangular_mut(&mut x);
        x.as_slice().to_vec()
    }

    /// Converts coordinates of the space to coordinates `y` of all motions.
    pub fn whole(&self, u: &DVector<f64>) -> DVector<f64> {
        let mut y = DVector::zeros(self.constraints() + self.motions());
        y.rows_mut(self.constraints(), self.motions()).copy_from(u);
        for normal in self.reflections.iter().rev() {
            let along = 2.0 * normal.dot(&y);
            y.axpy(-along, normal, 1.0);
        }
        y
    }

    /// Converts coordinates of the space to a displacement.
    pub fn displacement(&self, u: &DVector<f64>) -> Vec<f64> {
        self.displacement_of(&self.whole(u))
    }

    /// Projects a matrix over displacements on the coordinates of the space.
    pub fn matrix(&self, a: &DMatrix<f64>) -> DMatrix<f64> {
        let mut a = a.clone();
        for _ in 0..2 {
            self.mass.l_dirty().solve_lower_triangular_mut(&mut a);
            for normal in &self.reflections {
                let along = a.tr_mul(normal);
                a.ger(-2.0, normal, &along, 1.0);
            }
            a.transpose_mut();
        }
        let (from, n) = (self.constraints(), self.motions());
        a.view((from, from), (n, n)).into_owned()
    }

    /// Computes the modes of the symmetric part of a stiffness matrix.
    pub fn modes(&self, stiffness: &DMatrix<f64>) -> Result<Modes, LoadedStateError> {
        let a = self.matrix(stiffness);
        let a = 0.5 * (&a + a.transpose());
        let n = a.nrows();
        if n == 0 {
            return Ok(Modes {
                squares: Vec::new(),
                vectors: a,
                residual: 0.0,
            });
        }
        let whole = Mat::from_fn(n, n, |i, j| a[(i, j)]);
        let found = symmetric_eigen(whole.as_ref());
        let (squares, vectors) = found.map_err(|_| LoadedStateError::Matrices(NOT_FINITE))?;
        let vectors = DMatrix::from_fn(n, n, |i, j| vectors[(i, j)]);
        let values = DMatrix::from_diagonal(&DVector::from_column_slice(&squares));
        let left = &a * &vectors - &vectors * values;
        let size = a.norm();
        let worst = left.column_iter().map(|c| c.norm()).fold(0.0, f64::max);
        let residual = if size > 0.0 { worst / size } else { 0.0 };
        // NaN does not count as a small residual.
        if residual.is_nan() || residual > RESIDUAL {
            return Err(LoadedStateError::Matrices("its modes could not be found"));
        }
        Ok(Modes {
            squares,
            vectors,
            residual,
        })
    }
}

const NOT_FINITE: &str = "its tangent is not finite";

#[cfg(test)]
mod tests {
    use super::*;

    /// Three masses on a line: a rigid bar between two of them makes the pair vibrate as one; removing the rigid-body
    /// motion does not change the other modes.
    #[test]
    fn what_is_held_has_no_frequency() {
        let mass = DMatrix::from_diagonal(&DVector::from_column_slice(&[2.0, 1.0, 3.0]));
        let k = 12.0;
        let spring = DVector::from_column_slice(&[0.0, -1.0, 1.0]);
        let stiffness = k * &spring * spring.transpose();
        let mut space = AdmissibleMotions::new(&mass).unwrap();
        space.constrain(&[vec![1.0, -1.0, 0.0], vec![2.0, -2.0, 0.0]]);
        assert_eq!((space.constraints(), space.motions()), (1, 2));
        let modes = space.modes(&stiffness).unwrap();
        let exact = k * (1.0 / 3.0 + 1.0 / 3.0);
        assert!(modes.squares[0].abs() < 1e-12 && (modes.squares[1] / exact - 1.0).abs() < 1e-14);
        let x = space.displacement(&modes.vectors.column(1).into_owned());
        assert!(
            (x[0] - x[1]).abs() < 1e-14 && (x[0] + x[2]).abs() < 1e-14,
            "{x:?}"
        );
        let rigid = space.whole(&modes.vectors.column(0).into_owned());
        space.constrain_along(rigid);
        let modes = space.modes(&stiffness).unwrap();
        assert!(modes.squares.len() == 1 && (modes.squares[0] / exact - 1.0).abs() < 1e-14);
    }
}
