//! Linear systems in the form that integrators require.

use super::linear::Dense;
use gearbench_integrators::{Change, HalfStepImpulse, system::Singular};
use gearbench_integrators::{
    Coeffs, Events, Layout, ModalSplit, SecondOrderSystem, State, StateView,
};
use nalgebra::{DMatrix, DVector, DVectorView, Dyn, LU};

/// `q'' + D q' + K q = 0` in the modes of `K`: independent oscillators, or coupled by dampers.
#[derive(Clone, Debug)]
pub(super) struct Vibrations {
    /// Squared angular frequencies [1/s^2].
    pub square: DVector<f64>,
    /// Damping matrix of the modes, diagonal or full.
    pub damping: Damping,
    /// Highest angular frequency [rad/s].
    pub highest: f64,
    /// Part of the dampers that acts at the velocities at the end of an impulse.
    at_ends: Option<EndDampers>,
}

/// Dampers that act implicitly at the end of an impulse.
#[derive(Clone, Debug)]
struct EndDampers {
    /// Damping matrix in the modes of the stiffness [1/s].
    damping: DMatrix<f64>,
    /// Matrix `1 + time D`, factorised for the duration of the impulses.
    factor: Option<(f64, LU<f64, Dyn, Dyn>)>,
}

impl EndDampers {
    /// Replaces the velocities `v` from the other forces by those at the end of an impulse of duration `time` [s].
    fn solve(&mut self, time: f64, v: &mut DVector<f64>) -> bool {
        let n = v.len();
        let factor = match &mut self.factor {
            Some((of, factor)) if *of == time => factor,
            stale => {
                let matrix = DMatrix::identity(n, n) + time * &self.damping;
                &mut stale.insert((time, matrix.lu())).1
            }
        };
        factor.solve_mut(v)
    }
}

/// Damping matrix in the modes of the stiffness [1/s].
#[derive(Clone, Debug)]
pub(super) enum Damping {
    Diagonal(DVector<f64>),
    Full(DMatrix<f64>),
}

impl Vibrations {
    /// Creates independent oscillators from angular frequencies [rad/s] and damping ratios.
    pub(super) fn independent(modes: &[[f64; 2]]) -> Self {
        Vibrations {
            square: DVector::from_iterator(modes.len(), modes.iter().map(|m| m[0] * m[0])),
            damping: Damping::Diagonal(DVector::from_iterator(
                modes.len(),
                modes.iter().map(|[w, z]| 2.0 * z * w),
            )),
            highest: modes.iter().fold(0.0, |m, x| m.max(x[0])),
            at_ends: None,
        }
    }

    /// Returns the oscillators of a system whose dampers couple the modes.
    pub(super) fn coupled(dense: &Dense) -> Self {
        let eigen = dense.stiffness.clone().symmetric_eigen();
        let in_modes = |d: &DMatrix<f64>| eigen.eigenvectors.transpose() * d * &eigen.eigenvectors;
        let damping = in_modes(&dense.damping);
        let at_ends = dense.at_ends.as_ref().map(|d| EndDampers {
            damping: in_modes(d),
            factor: None,
        });
        let square = eigen.eigenvalues.map(|x| x.max(0.0));
        Vibrations {
            highest: square.max().sqrt(),
            square,
            damping: Damping::Full(damping),
            at_ends,
        }
    }

    pub(super) fn n(&self) -> usize {
        self.square.len()
    }
}

impl SecondOrderSystem for Vibrations {
    fn layout(&self) -> Layout {
        Layout {
            n: self.n(),
            ..Layout::default()
        }
    }

    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        q.fill(1.0);
        v.fill(self.highest);
    }

    fn characteristic_time(&self, _at: StateView<'_>) -> f64 {
        1.0 / self.highest
    }

    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.tangent_times(at, at.q, at.v, f);
    }

    fn force_after(&mut self, at: StateView<'_>, kick: &HalfStepImpulse<'_>, f: &mut [f64]) {
        self.force(at, f);
        let Some(ends) = &mut self.at_ends else {
            return;
        };
        let seen = DVectorView::from_slice(at.v, at.v.len());
        let mut forces = DVector::from_column_slice(f);
        forces.gemv(1.0, &ends.damping, &seen, 1.0);
        let mut v = Vec::new();
        kick.end(forces.as_slice(), &mut v);
        let mut v = DVector::from_vec(v);
        // Methods with filtered impulses integrate oscillators exactly; the remaining forces act as impulses.
        if !ends.solve(kick.time, &mut v) {
            v.fill(f64::NAN);
        }
        forces.gemv(-1.0, &ends.damping, &v, 1.0);
        f.copy_from_slice(forces.as_slice());
    }

    fn solve_mass(&mut self, _at: StateView<'_>, _f: &mut [f64]) {}

    fn apply_mass(&mut self, _at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        y.copy_from_slice(x);
    }

    fn correct(&mut self, _at: StateView<'_>, c: Coeffs, x: &mut [f64]) -> Result<(), Singular> {
        match &self.damping {
            Damping::Diagonal(d) => {
                for ((x, d), k) in x.iter_mut().zip(d).zip(&self.square) {
                    *x /= c.m + c.d * d + c.k * k;
                }
                Ok(())
            }
            Damping::Full(d) => {
                let mut matrix = c.d * d;
                for (i, k) in self.square.iter().enumerate() {
                    matrix[(i, i)] += c.m + c.k * k;
                }
                let solved = matrix.lu().solve(&DVector::from_column_slice(x));
                x.copy_from_slice(solved.ok_or(Singular)?.as_slice());
                Ok(())
            }
        }
    }

    fn tangent_times(&mut self, _at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        match &self.damping {
            Damping::Diagonal(d) => {
                for (f, (d, v)) in df.iter_mut().zip(d.iter().zip(dv)) {
                    *f = -d * v;
                }
            }
            Damping::Full(d) => {
                let mut out = DVector::zeros(df.len());
                out.gemv(-1.0, d, &DVectorView::from_slice(dv, dv.len()), 0.0);
                df.copy_from_slice(out.as_slice());
            }
        }
        for (f, (k, q)) in df.iter_mut().zip(self.square.iter().zip(dq)) {
            *f -= k * q;
        }
    }
}

/// Undamped oscillators with a linear coupling, `q'' + Omega^2 q = -K_c q`.
#[derive(Clone, Debug)]
pub(super) struct CoupledOscillators {
    pub omega: Vec<f64>,
    /// Remaining stiffness at the trial step [1/s^2].
    pub rest: DMatrix<f64>,
}

impl SecondOrderSystem for CoupledOscillators {
    fn layout(&self) -> Layout {
        Layout {
            n: self.omega.len(),
            ..Layout::default()
        }
    }

    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        q.fill(1.0);
        v.fill(1.0);
    }

    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.remainder(at, f);
        for (f, (w, q)) in f.iter_mut().zip(self.omega.iter().zip(at.q)) {
            *f -= w * w * q;
        }
    }

    fn solve_mass(&mut self, _at: StateView<'_>, _f: &mut [f64]) {}

    fn apply_mass(&mut self, _at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        y.copy_from_slice(x);
    }

    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], _dv: &[f64], df: &mut [f64]) {
        self.force(StateView { q: dq, ..at }, df);
    }

    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        Some(self)
    }
    fn events(&mut self) -> Option<&mut dyn Events> {
        Some(self)
    }
}

impl Events for CoupledOscillators {
    fn commit(&mut self, _s: &mut State) -> Change {
        Change::None
    }
}

impl ModalSplit for CoupledOscillators {
    fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]) {
        omega.copy_from_slice(&self.omega);
        zeta.fill(0.0);
    }

    fn remainder(&mut self, at: StateView<'_>, a: &mut [f64]) {
        let mut out = DVector::zeros(a.len());
        let q = DVectorView::from_slice(at.q, at.q.len());
        out.gemv(-1.0, &self.rest, &q, 0.0);
        a.copy_from_slice(out.as_slice());
    }

    fn steady(&mut self, at: StateView<'_>, _a: &mut [f64]) -> f64 {
        at.t
    }

    fn free_until(&mut self, s: &State) -> f64 {
        s.t
    }
}
