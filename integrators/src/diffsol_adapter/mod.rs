//! The solvers of diffsol behind [`Integrator`]: first-order form, restarts at events, one loop for all.
//!
//! `y = (q, v)`, `y' = (v, M^-1 f)`, and the Jacobian product `(dv, M^-1 (df/dq dq + df/dv dv))` from the
//! system's analytic tangent (the change of the mass matrix with position is left out; it only steers
//! Newton). The absolute tolerance is `rtol` times the system's scales per coordinate; the relative one only
//! keeps Newton from chasing rounding: angles grow over many turns while the deflections that make the
//! forces stay small.
//!
//! **Events.** Event functions are read after each step and their root is found on the solver's own interpolant.
//! There the branch is switched and the solver is set back to that state: order one for BDF, a fresh
//! Jacobian, a first step from the system's characteristic time. diffsol's own root functions answer to any change of
//! sign, also of an event function that rises from a root where rounding left it a hair below.
//!
//! **What diffsol leaves open** and is handled here: an explicit solver accepts NaN (checked after each
//! step); callbacks cannot fail (a force that is not finite is remembered); its limit of Newton failures
//! counts over the whole run (lifted: within a step they end at the smallest step, over the run at the
//! plan's bounds).

mod kernel;
mod session;

use crate::archive::Archive;
use crate::error::StepError;
use crate::method::{
    Integrator, MethodInfo, Resolution, RestoreError, Sink, TimePlan, Tolerance, Work,
};
use crate::stepped::{first_step, step_exponent, tolerance_of};
use crate::system::{Change, SecondOrderSystem, State, StateView};
use diffsol::{NalgebraMat, OdeBuilder};
use session::{Session, SessionError};
use std::cell::{Cell, RefCell};

/// Relative tolerance of the solver: a few units of rounding of the coordinate itself.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Solvers of diffsol that the table of methods uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// Backward differentiation of variable order one to five.
    Bdf,
    /// TR-BDF2, a one-step method of order two.
    TrBdf2,
    /// ESDIRK 3(4), a singly diagonally implicit method of order three.
    Esdirk34,
    /// Tsitouras 5(4), an explicit Runge-Kutta method.
    Tsit45,
}

/// Integrator that runs a solver of diffsol.
#[derive(Clone, Copy, Debug)]
pub struct Diffsol {
    info: &'static MethodInfo,
    solver: Solver,
    free_flights: bool,
    /// True if a run ended and can be continued.
    ran: bool,
}

impl Diffsol {
    /// Combines a solver with its declared properties.
    pub fn new(info: &'static MethodInfo, solver: Solver) -> Self {
        Diffsol {
            info,
            solver,
            free_flights: false,
            ran: false,
        }
    }

    /// Returns the exponent of the tolerance in the first step after a restart; BDF starts at order one.
    fn starting_exponent(&self) -> f64 {
        match self.solver {
            Solver::Bdf => 0.5,
            _ => step_exponent(self.info),
        }
    }
}

/// Data that the callbacks share with the loop. Callbacks run only inside the constructor and `step` of a solver; the
/// loop borrows only outside of them.
struct Shared<'a> {
    sys: RefCell<&'a mut (dyn SecondOrderSystem + 'a)>,
    /// Discrete state of the current branch.
    discrete: RefCell<Vec<f64>>,
    evaluations: Cell<u64>,
    /// Time and coordinate of the first force that was not finite since the step began.
    not_finite: Cell<Option<(f64, usize)>>,
}

impl Shared<'_> {
    fn rhs(&self, y: &[f64], t: f64, dy: &mut [f64]) {
        let n = y.len() / 2;
        let (q, v) = y.split_at(n);
        let (dq, a) = dy.split_at_mut(n);
        dq.copy_from_slice(v);
        let discrete = self.discrete.borrow();
        let at = StateView {
            t,
            q,
            v,
            discrete: &discrete,
        };
        let mut sys = self.sys.borrow_mut();
        sys.force(at, a);
        sys.solve_mass(at, a);
        self.evaluations.set(self.evaluations.get() + 1);
        if self.not_finite.get().is_none() {
            let dof = a.iter().position(|x| !x.is_finite());
            self.not_finite.set(dof.map(|dof| (t, dof)));
        }
    }

    fn jacobian_times(&self, y: &[f64], t: f64, dy: &[f64], out: &mut [f64]) {
        let n = y.len() / 2;
        let (q, v) = y.split_at(n);
        let (dq, dv) = dy.split_at(n);
        let (top, a) = out.split_at_mut(n);
        top.copy_from_slice(dv);
        let discrete = self.discrete.borrow();
        let at = StateView {
            t,
            q,
            v,
            discrete: &discrete,
        };
        let mut sys = self.sys.borrow_mut();
        sys.tangent_times(at, dq, dv, a);
        sys.solve_mass(at, a);
    }

    fn event_functions(&self, at: StateView<'_>, out: &mut [f64]) {
        self.sys.borrow_mut().event_functions(at, out);
    }
}

impl Integrator for Diffsol {
    fn info(&self) -> &'static MethodInfo {
        self.info
    }

    fn free_flight(&mut self, on: bool) -> bool {
        self.free_flights = on;
        true
    }

    fn run(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError> {
        self.ran = false;
        self.integrate(sys, s, plan, sink, work)
    }

    /// Continues a run. The solvers of diffsol keep only the branch between two calls: they restart in each piece.
    fn resume(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        _change: Change,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError> {
        self.integrate(sys, s, plan, sink, work)
    }

    fn duplicate(&self) -> Box<dyn Integrator> {
        Box::new(*self)
    }

    fn archive(
        &mut self,
        _sys: &mut dyn SecondOrderSystem,
        _resolution: Resolution,
        archive: &mut Archive<'_>,
    ) -> Result<(), RestoreError> {
        Ok(archive.flag(&mut self.ran)?)
    }
}

impl Diffsol {
    /// Integrates a run, or its next piece.
    fn integrate(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError> {
        let rtol = tolerance_of(plan, self.info)?;
        let n = sys.layout().n;
        if n == 0 {
            return Err(StepError::Unsupported {
                method: self.info.id,
                what: "a system without coordinates",
            });
        }
        let tolerance = Tolerance::of(sys, rtol);
        if !std::mem::take(&mut self.ran) {
            sys.begin(s, plan.events);
        }
        if s.t >= plan.t_end {
            return Ok(());
        }
        let exponent = self.starting_exponent();
        let h = first_step(sys, s, plan, rtol, exponent);
        if !(h.is_finite() && h > 0.0) {
            return Err(StepError::StepTooSmall { t: s.t, h });
        }
        let shared = Shared {
            sys: RefCell::new(sys),
            discrete: RefCell::new(s.discrete.clone()),
            evaluations: Cell::new(0),
            not_finite: Cell::new(None),
        };
        let library = |e: diffsol::DiffsolError, t: f64| StepError::Library {
            method: self.info.id,
            t,
            message: e.to_string(),
        };
        let (q, v) = (s.q.clone(), s.v.clone());
        let mut problem = OdeBuilder::<NalgebraMat<f64>>::new()
            .t0(s.t)
            .h0(h)
            .rtol(ROUNDING)
            .atol(tolerance.q.iter().chain(&tolerance.v).map(|x| rtol * x))
            .rhs_implicit(
                |y, _p, t, dy| shared.rhs(y, t, dy),
                |y, _p, t, v, jv| shared.jacobian_times(y, t, v, jv),
            )
            .init(
                |_p, _t, y| {
                    y[..n].copy_from_slice(&q);
                    y[n..].copy_from_slice(&v);
                },
                2 * n,
            )
            .build()
            .map_err(|e| library(e, s.t))?;
        let options = &mut problem.ode_options;
        options.max_nonlinear_solver_failures = usize::MAX;
        options.min_timestep = 1e-16 * (plan.t_end - s.t);
        // A contact lasts some ten steps. diffsol's defaults (steps stay or double) would decide the error
        // there by the first step, and climb slowly through the flight after it.
        options.min_timestep_growth = Some(1.2);
        options.max_timestep_growth = Some(10.0);

        let result = match kernel::start(self.solver, &problem) {
            Ok(mut kernel) => {
                let first = |s: &State| first_step(&**shared.sys.borrow(), s, plan, rtol, exponent);
                Session::new(&shared, s, plan, sink, work, self.free_flights)
                    .run(&mut *kernel, &first)
            }
            Err(e) => Err(SessionError::Library(e)),
        };
        work.force_evaluations += shared.evaluations.get();
        self.ran = result.is_ok();
        result.map_err(|e| match e {
            SessionError::Step(e) => e,
            SessionError::Library(e) => library(e, s.t),
        })
    }
}
