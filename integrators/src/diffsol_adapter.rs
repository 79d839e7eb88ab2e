//! The solvers of diffsol behind [`Integrator`]: first-order form, restarts at events, one loop for all.
//!
//! `y = (q, v)`, `y' = (v, M^-1 f)`, and the Jacobian product `(dv, M^-1 (df/dq dq + df/dv dv))` from the
//! system's analytic tangent (the change of the mass matrix with position is left out; it only steers
//! Newton). The absolute tolerance is `rtol` times the system's scales per coordinate; the relative one only
//! keeps Newton from chasing rounding: angles grow over many turns while the deflections that make the
//! forces stay small.
//!
//! **Events.** Guards are read after each step and their root is found on the solver's own interpolant.
//! There the branch is switched and a fresh solver starts on the same problem: order one for BDF, a fresh
//! Jacobian, a first step from the system's pace. diffsol's own root functions answer to any change of
//! sign, also of a guard that rises from a root where rounding left it a hair below.
//!
//! **What diffsol leaves open** and is handled here: an explicit solver accepts NaN (checked after each
//! step); callbacks cannot fail (a force that is not finite is remembered); its limit of Newton failures
//! counts over the whole run (lifted: within a step they end at the smallest step, over the run at the
//! plan's bounds).

use crate::bounds::Bounds;
use crate::events::{Root, Watch};
use crate::interpolation::hermite;
use crate::method::{
    AcceptedStep, Control, Dense, Integrator, MethodInfo, Sink, StepError, TimePlan, Tolerance,
    Work,
};
use crate::stepped::{
    MAX_EVENTS_AT_ONCE, first_not_finite, first_step, resolution_of_time, step_exponent, tolerance_of,
};
use crate::system::{At, Change, SecondOrderSystem, State};
use diffsol::error::OdeSolverError;
use diffsol::{
    BdfState, DiffsolError, NalgebraContext, NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder,
    OdeEquations, OdeEquationsImplicit, OdeSolverMethod, OdeSolverProblem, OdeSolverState,
    OdeSolverStopReason, RkState, Vector,
};
use std::cell::{Cell, RefCell};
use std::marker::PhantomData;

type Lu = NalgebraLU<f64>;

/// Relative tolerance: some units of rounding of the coordinate itself.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Which solver of diffsol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// Backward differentiation of variable order one to five.
    Bdf,
    /// TR-BDF2.
    TrBdf2,
    /// ESDIRK 3(4).
    Esdirk34,
    /// Tsitouras 5(4).
    Tsit45,
}

/// A method of diffsol.
#[derive(Clone, Copy, Debug)]
pub struct Diffsol {
    info: &'static MethodInfo,
    solver: Solver,
}

impl Diffsol {
    /// Gives a solver its declaration.
    pub fn new(info: &'static MethodInfo, solver: Solver) -> Self {
        Diffsol { info, solver }
    }

    /// The first step after a restart goes with this power of the tolerance; BDF starts at order one.
    fn starting_exponent(&self) -> f64 {
        match self.solver {
            Solver::Bdf => 0.5,
            _ => step_exponent(self.info),
        }
    }
}

/// What the callbacks share with the loop. Callbacks run only inside a solver's constructor and `step`, the
/// loop borrows only outside of them.
struct Shared<'a> {
    sys: RefCell<&'a mut (dyn SecondOrderSystem + 'a)>,
    /// Memory of the current branch.
    memory: RefCell<Vec<f64>>,
    /// Start of the current solver.
    start: RefCell<(Vec<f64>, Vec<f64>)>,
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
        let memory = self.memory.borrow();
        let at = At {
            t,
            q,
            v,
            memory: &memory,
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
        let memory = self.memory.borrow();
        let at = At {
            t,
            q,
            v,
            memory: &memory,
        };
        let mut sys = self.sys.borrow_mut();
        sys.tangent_times(at, dq, dv, a);
        sys.solve_mass(at, a);
    }

    fn guards(&self, at: At<'_>, out: &mut [f64]) {
        self.sys.borrow_mut().guards(at, out);
    }
}

/// What the loop needs of a solver; its type parameters end here.
trait Kernel {
    /// One accepted step. True when it ended at the stop time.
    fn step(&mut self) -> Result<bool, DiffsolError>;
    fn stop_at(&mut self, t: f64) -> Result<(), DiffsolError>;
    fn time(&self) -> f64;
    fn step_size(&self) -> f64;
    fn y(&self) -> &NalgebraVec<f64>;
    fn interpolate(&self, t: f64, y: &mut NalgebraVec<f64>) -> Result<(), DiffsolError>;
    fn counts(&self) -> Counts;
}

/// Statistics of one solver.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    rejected: u64,
    newton_failures: u64,
    newton_iterations: u64,
    factorisations: u64,
}

struct Wrapped<'p, Eqn, S> {
    solver: S,
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

/// A fresh solver at the start that the problem's init callback gives.
fn start<'p, Eqn>(
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
    fn boxed<'p, Eqn, S>(solver: S) -> Box<dyn Kernel + 'p>
    where
        Eqn: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'p,
        S: OdeSolverMethod<'p, Eqn> + 'p,
    {
        Box::new(Wrapped {
            solver,
            problem: PhantomData::<&'p Eqn>,
        })
    }
    Ok(match solver {
        Solver::Bdf => {
            boxed(problem.bdf_solver::<Lu>(BdfState::new_without_initialise(problem)?)?)
        }
        Solver::TrBdf2 => {
            boxed(problem.tr_bdf2_solver::<Lu>(RkState::new_without_initialise(problem)?)?)
        }
        Solver::Esdirk34 => {
            boxed(problem.esdirk34_solver::<Lu>(RkState::new_without_initialise(problem)?)?)
        }
        Solver::Tsit45 => {
            boxed(problem.tsit45_solver(RkState::new_without_initialise(problem)?)?)
        }
    })
}

/// The solver's interpolant over `[from.t, to.t]`.
struct KernelDense<'a> {
    kernel: &'a dyn Kernel,
    from: &'a State,
    to: &'a State,
    y: &'a RefCell<NalgebraVec<f64>>,
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

/// Reads the solution at a time inside the kernel's last step.
fn read(
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

fn copy(y: &NalgebraVec<f64>, q: &mut [f64], v: &mut [f64]) {
    let y = y.batch_as_slice(0);
    q.copy_from_slice(&y[..q.len()]);
    v.copy_from_slice(&y[q.len()..]);
}

impl Integrator for Diffsol {
    fn info(&self) -> &'static MethodInfo {
        self.info
    }

    fn run(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError> {
        let rtol = tolerance_of(plan, self.info)?;
        let n = sys.layout().n;
        let tolerance = Tolerance::of(sys, rtol);
        sys.begin(s, plan.events);
        if s.t >= plan.t_end {
            return Ok(());
        }
        let h = first_step(sys, s, plan, rtol, self.starting_exponent());
        if !(h.is_finite() && h > 0.0) {
            return Err(StepError::StepTooSmall { t: s.t, h });
        }
        let shared = Shared {
            sys: RefCell::new(sys),
            memory: RefCell::new(s.memory.clone()),
            start: RefCell::new((s.q.clone(), s.v.clone())),
            evaluations: Cell::new(0),
            not_finite: Cell::new(None),
        };
        let library = |e: DiffsolError, t: f64| StepError::Library {
            method: self.info.id,
            t,
            message: e.to_string(),
        };
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
                    let start = shared.start.borrow();
                    y[..n].copy_from_slice(&start.0);
                    y[n..].copy_from_slice(&start.1);
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

        let mut run = Run::new(&shared, s, plan);
        let result = loop {
            match self.segment(&shared, &problem, s, plan, sink, work, &mut run) {
                Ok(Some(h)) => {
                    let mut start = shared.start.borrow_mut();
                    start.0.copy_from_slice(&s.q);
                    start.1.copy_from_slice(&s.v);
                    problem.t0 = s.t;
                    let pace = first_step(
                        &**shared.sys.borrow(),
                        s,
                        plan,
                        rtol,
                        self.starting_exponent(),
                    );
                    problem.h0 = h.min(pace);
                }
                Ok(None) => break Ok(()),
                Err(Failed::Step(e)) => break Err(e),
                Err(Failed::Library(e)) => break Err(library(e, s.t)),
            }
        };
        work.force_evaluations += shared.evaluations.get();
        result
    }
}

/// Why a segment failed.
enum Failed {
    Step(StepError),
    Library(DiffsolError),
}

impl From<DiffsolError> for Failed {
    fn from(e: DiffsolError) -> Self {
        Failed::Library(e)
    }
}

impl From<StepError> for Failed {
    fn from(e: StepError) -> Self {
        Failed::Step(e)
    }
}

/// What lasts over the segments of a run.
struct Run {
    t_begin: f64,
    bounds: Bounds,
    watch: Watch,
    events: bool,
    events_here: u32,
    knot: f64,
    to: State,
    y: RefCell<NalgebraVec<f64>>,
}

impl Run {
    fn new(shared: &Shared<'_>, s: &State, plan: &TimePlan<'_>) -> Self {
        let sys = shared.sys.borrow();
        let layout = sys.layout();
        Run {
            t_begin: s.t,
            bounds: Bounds::default(),
            watch: Watch::new(layout.guards),
            events: plan.events && layout.guards > 0,
            events_here: 0,
            knot: sys.next_knot(s.t),
            to: s.clone(),
            y: RefCell::new(NalgebraVec::zeros(2 * layout.n, NalgebraContext::default())),
        }
    }
}

impl Diffsol {
    /// Runs one solver until its branch ends. Returns the last step size when the run goes on from there.
    #[allow(clippy::too_many_arguments)]
    fn segment<Eqn>(
        &self,
        shared: &Shared<'_>,
        problem: &OdeSolverProblem<Eqn>,
        s: &mut State,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
        run: &mut Run,
    ) -> Result<Option<f64>, Failed>
    where
        Eqn: OdeEquationsImplicit<
                T = f64,
                V = NalgebraVec<f64>,
                M = NalgebraMat<f64>,
                C = NalgebraContext,
            >,
    {
        if run.events {
            shared.guards(s.at(), &mut run.watch.before);
        }
        let stop = plan.t_end.min(run.knot);
        let mut kernel = start(self.solver, problem)?;
        // Less than time resolves before a knot or the end (diffsol: 100 epsilon) is stepped over.
        let least = (100.0 * f64::EPSILON * (s.t.abs() + problem.h0))
            .max(resolution_of_time(s.t, plan));
        let sliver = stop - s.t <= 2.0 * least;
        if sliver {
            s.t = stop;
            run.to.t = stop;
            self.between(shared, s, plan, sink, run, work, false);
            return Ok((s.t < plan.t_end).then(|| kernel.step_size()));
        }
        kernel.stop_at(stop)?;
        let mut seen = Counts::default();
        loop {
            run.bounds.check(plan, s.t, work)?;
            shared.not_finite.set(None);
            let h = kernel.step_size();
            let stepped = kernel.step();
            let counts = kernel.counts();
            work.rejected += counts.rejected - seen.rejected;
            work.newton_iterations += counts.newton_iterations - seen.newton_iterations;
            work.factorisations += counts.factorisations - seen.factorisations;
            run.bounds.add(counts.rejected - seen.rejected);
            let reached = match stepped {
                Ok(reached) => reached,
                Err(e) => {
                    return Err(explain(e, shared, s.t, h, counts, seen));
                }
            };
            seen = counts;
            let to = &mut run.to;
            copy(kernel.y(), &mut to.q, &mut to.v);
            to.t = if reached { stop } else { kernel.time() };
            if let Some(dof) = first_not_finite(to) {
                let (t, dof) = shared.not_finite.get().unwrap_or((to.t, dof));
                return Err(StepError::NonFinite { t, dof }.into());
            }

            let mut located = false;
            let mut progressed = true;
            if run.events {
                shared.guards(to.at(), &mut run.watch.after);
                if run.watch.any_fell() {
                    located = true;
                    progressed = self.locate(shared, &*kernel, s, run)?;
                }
            }
            if progressed {
                let step = AcceptedStep {
                    from: s,
                    to: &run.to,
                    dense: &KernelDense {
                        kernel: &*kernel,
                        from: s,
                        to: &run.to,
                        y: &run.y,
                    },
                };
                let control = sink.accepted(&mut **shared.sys.borrow_mut(), &step);
                work.steps += 1;
                progressed = run.to.t - s.t > 1e-12 * (plan.t_end - run.t_begin);
                std::mem::swap(s, &mut run.to);
                if control == Control::Stop {
                    return Ok(None);
                }
            }
            if located && !progressed {
                run.events_here += 1;
                if run.events_here > MAX_EVENTS_AT_ONCE {
                    return Err(StepError::Chatter {
                        t: s.t,
                        events: run.events_here,
                    }
                    .into());
                }
            } else {
                run.events_here = 0;
            }
            let restart = self.between(shared, s, plan, sink, run, work, located);
            if s.t >= plan.t_end {
                return Ok(None);
            }
            if restart {
                return Ok(Some(h));
            }
            run.watch.advance();
        }
    }

    /// Finds the first event in the last step and leaves the state there in `run.to`. False when it lies at
    /// the start of the step.
    fn locate(
        &self,
        shared: &Shared<'_>,
        kernel: &dyn Kernel,
        s: &State,
        run: &mut Run,
    ) -> Result<bool, Failed> {
        let (to, y, watch) = (&mut run.to, run.y.get_mut(), &mut run.watch);
        let h = to.t - s.t;
        let mut failed = None;
        let mut look = |theta: f64, out: &mut [f64]| {
            to.t = s.t + theta * h;
            match read(kernel, to.t, y, &mut to.q, &mut to.v) {
                Ok(()) => shared.guards(to.at(), out),
                Err(e) => {
                    out.fill(0.0);
                    failed = Some(e);
                }
            }
        };
        let root = watch.first_root(1e-15, &mut look);
        if let Root::Inside(theta) = root {
            look(theta, &mut watch.here);
            watch.select();
        }
        match failed {
            Some(e) => Err(e.into()),
            None => Ok(root != Root::Start),
        }
    }

    /// What happens to a state between two steps: switches, `commit`, the next knot. True when the solver
    /// has to start afresh.
    #[allow(clippy::too_many_arguments)]
    fn between(
        &self,
        shared: &Shared<'_>,
        s: &mut State,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        run: &mut Run,
        work: &mut Work,
        located: bool,
    ) -> bool {
        let mut sys = shared.sys.borrow_mut();
        let keep = sink.wants_restarts();
        if keep {
            run.to.copy_from(s);
        }
        let mut restart = located;
        if located {
            work.events += run.watch.falling.len() as u64;
            for &guard in &run.watch.falling {
                sys.switch(s, guard);
            }
        }
        restart |= sys.commit(s) == Change::Restart;
        if s.t >= run.knot {
            run.knot = sys.next_knot(s.t);
            restart = true;
        }
        if restart {
            if keep {
                sink.restarted(&mut **sys, &run.to, s);
            }
            if s.t < plan.t_end {
                work.restarts += 1;
            }
        }
        run.to.memory.copy_from_slice(&s.memory);
        shared.memory.borrow_mut().copy_from_slice(&s.memory);
        restart
    }
}

/// Says in the words of [`StepError`] why a step failed that started at `t` with size `h`.
fn explain(
    e: DiffsolError,
    shared: &Shared<'_>,
    t: f64,
    h: f64,
    counts: Counts,
    seen: Counts,
) -> Failed {
    if let Some((t, dof)) = shared.not_finite.get() {
        return StepError::NonFinite { t, dof }.into();
    }
    let newton = counts.newton_failures - seen.newton_failures;
    let errors = counts.rejected - seen.rejected - newton;
    match e {
        DiffsolError::OdeSolverError(
            OdeSolverError::StepSizeTooSmall { .. }
            | OdeSolverError::TooManyErrorTestFailures { .. }
            | OdeSolverError::TooManyNonlinearSolverFailures { .. },
        ) => if newton > errors {
            StepError::NewtonDiverged {
                t,
                h,
                residual: f64::INFINITY,
                iterations: (counts.newton_iterations - seen.newton_iterations) as u32,
            }
        } else {
            StepError::StepTooSmall { t, h }
        }
        .into(),
        e => Failed::Library(e),
    }
}
