//! The solvers of diffsol behind one object-safe trait.

use super::Solver;
use crate::interpolation::hermite;
use crate::method::Dense;
use crate::system::State;
use diffsol::{
    BdfState, DiffsolError, NalgebraContext, NalgebraLU, NalgebraMat, NalgebraVec, OdeEquations,
    OdeEquationsImplicit, OdeSolverMethod, OdeSolverProblem, OdeSolverState, OdeSolverStopReason,
    RkState, StateRefMut,
};
use std::cell::RefCell;
use std::marker::PhantomData;

type Lu = NalgebraLU<f64>;

/// Interface of a solver for the step loop, without the type parameters of diffsol.
pub(super) trait Kernel {
    /// Makes one accepted step and returns true if it ended at the stop time.
    fn step(&mut self) -> Result<bool, DiffsolError>;
    fn stop_at(&mut self, t: f64) -> Result<(), DiffsolError>;
    /// Restarts at `t` with step `h`; `fill` writes `y` and `y'`.
    fn restart(&mut self, t: f64, h: f64, fill: &mut dyn FnMut(&mut [f64], &mut [f64]));
    fn time(&self) -> f64;
    fn step_size(&self) -> f64;
    fn y(&self) -> &NalgebraVec<f64>;
    fn interpolate(&self, t: f64, y: &mut NalgebraVec<f64>) -> Result<(), DiffsolError>;
    fn counts(&self) -> Counts;
}

/// Counters of one solver.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    pub(super) rejected: u64,
    pub(super) newton_failures: u64,
    pub(super) newton_iterations: u64,
    pub(super) factorisations: u64,
}

struct Wrapped<'p, Eqn, S> {
    solver: S,
    /// True if the solver stores a Jacobian, which belongs to one branch.
    implicit: bool,
    problem: PhantomData<&'p Eqn>,
}

impl<'p, Eqn, S> Kernel for Wrapped<'p, Eqn, S>
where
    Eqn: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'p,
    S: OdeSolverMethod<'p, Eqn>,
{
    fn step(&mut self) -> Result<bool, DiffsolError> {
        Ok(self.solver.step()? == OdeSolverStopReason::TstopReached)
    }

    fn stop_at(&mut self, t: f64) -> Result<(), DiffsolError> {
        self.solver.set_stop_time(t)
    }

    fn restart(&mut self, t: f64, h: f64, fill: &mut dyn FnMut(&mut [f64], &mut [f64])) {
        if self.implicit {
            // A state that is set, not changed in place, brings a fresh Jacobian.
            let mut state = self.solver.state_clone();
            write(state.as_mut(), t, h, fill);
            self.solver.set_state(state);
            // Taken as changed, so that a multistep solver forgets its history.
            self.solver.state_mut();
        } else {
            write(self.solver.state_mut(), t, h, fill);
        }
    }

    fn time(&self) -> f64 {
        self.solver.state().t
    }

    fn step_size(&self) -> f64 {
        self.solver.state().h
    }

    fn y(&self) -> &NalgebraVec<f64> {
        self.solver.state().y
    }

    fn interpolate(&self, t: f64, y: &mut NalgebraVec<f64>) -> Result<(), DiffsolError> {
        self.solver.interpolate_inplace(t, y)
    }

    fn counts(&self) -> Counts {
        let s = self.solver.get_statistics();
        Counts {
            rejected: (s.number_of_error_test_failures + s.number_of_nonlinear_solver_fails) as u64,
            newton_failures: s.number_of_nonlinear_solver_fails as u64,
            newton_iterations: s.number_of_nonlinear_solver_iterations as u64,
            factorisations: s.number_of_linear_solver_setups as u64,
        }
    }
}

fn write(
    state: StateRefMut<'_, NalgebraVec<f64>>,
    t: f64,
    h: f64,
    fill: &mut dyn FnMut(&mut [f64], &mut [f64]),
) {
    fill(
        state.y.batch_as_mut_slice(0),
        state.dy.batch_as_mut_slice(0),
    );
    *state.t = t;
    *state.h = h;
}

/// Starts a solver from the state that the init callback of the problem writes.
pub(super) fn start<'p, Eqn>(
    solver: Solver,
    problem: &'p OdeSolverProblem<Eqn>,
) -> Result<Box<dyn Kernel + 'p>, DiffsolError>
where
    Eqn: OdeEquationsImplicit<
            T = f64,
            V = NalgebraVec<f64>,
            M = NalgebraMat<f64>,
            C = NalgebraContext,
        > + 'p,
{
    fn boxed<'p, Eqn, S>(solver: S, implicit: bool) -> Box<dyn Kernel + 'p>
    where
        Eqn: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'p,
        S: OdeSolverMethod<'p, Eqn> + 'p,
    {
        Box::new(Wrapped {
            solver,
            implicit,
            problem: PhantomData::<&'p Eqn>,
        })
    }
    let rk = || RkState::new_without_initialise(problem);
    Ok(match solver {
        Solver::Bdf => {
            let state = BdfState::new_without_initialise(problem)?;
            boxed(problem.bdf_solver::<Lu>(state)?, true)
        }
        Solver::TrBdf2 => boxed(problem.tr_bdf2_solver::<Lu>(rk()?)?, true),
        Solver::Esdirk34 => boxed(problem.esdirk34_solver::<Lu>(rk()?)?, true),
        Solver::Tsit45 => boxed(problem.tsit45_solver(rk()?)?, false),
    })
}

/// Dense output from the interpolant of the solver over `[from.t, to.t]`.
pub(super) struct KernelDense<'a> {
    pub(super) kernel: &'a dyn Kernel,
    pub(super) from: &'a State,
    pub(super) to: &'a State,
    pub(super) y: &'a RefCell<NalgebraVec<f64>>,
}

impl Dense for KernelDense<'_> {
    fn eval(&self, theta: f64, q: &mut [f64], v: &mut [f64]) {
        let mut y = self.y.borrow_mut();
        let t = self.from.t + theta * (self.to.t - self.from.t);
        if read(self.kernel, t, &mut y, q, v).is_err() {
            hermite(self.from, self.to, theta, q, v);
        }
    }
}

/// Reads the solution at a time inside the last step of the kernel.
pub(super) fn read(
    kernel: &dyn Kernel,
    t: f64,
    y: &mut NalgebraVec<f64>,
    q: &mut [f64],
    v: &mut [f64],
) -> Result<(), DiffsolError> {
    kernel.interpolate(t.min(kernel.time()), y)?;
    copy(y, q, v);
    Ok(())
}

pub(super) fn copy(y: &NalgebraVec<f64>, q: &mut [f64], v: &mut [f64]) {
    let y = y.batch_as_slice(0);
    q.copy_from_slice(&y[..q.len()]);
    v.copy_from_slice(&y[q.len()..]);
}
