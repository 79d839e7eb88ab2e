//! The interface of integration methods: their properties, the plan of a run and the counters of work.
//!
//! The method owns the loop and pushes accepted steps to a [`Sink`]: solvers of libraries borrow their
//! problem, so a pull-style `step()` would be self-referential. One-step methods implement [`OneStep`] and
//! get the loop, step control and event location from [`crate::stepped::Stepped`].

use crate::archive::{Archive, ArchiveError};
use crate::error::StepError;
use crate::system::{Change, Coeffs, SecondOrderSystem, Singular, State, StateView};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Kinds of step selection that a method supports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stepping {
    /// The method runs at fixed steps only.
    Fixed,
    /// The method runs under a tolerance only.
    Adaptive,
    /// The method runs at fixed steps or under a tolerance.
    Both,
}

/// One parameter of a method with its default and admissible range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name as written in `id(name=value)`.
    pub name: &'static str,
    /// Default value of the parameter.
    pub default: f64,
    /// Smallest and largest admissible value.
    pub range: (f64, f64),
    /// Description of the effect of the parameter, for help texts.
    pub meaning: &'static str,
}

/// Declared properties of a method. The conformance tests compare the method with each of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodInfo {
    /// Identifier on the command line and in records.
    pub id: &'static str,
    /// Name for reports.
    pub name: &'static str,
    /// Order of convergence on smooth problems; the highest one of a method of variable order.
    pub order: u32,
    /// True if the method solves equations in each step.
    pub implicit: bool,
    /// Supported kinds of step selection.
    pub stepping: Stepping,
    /// Slope of log(error) over log(rtol) under a tolerance; 0 when the method has none.
    pub tolerance_slope: f64,
    /// True if the method loses energy on a linear undamped oscillator at finite step. A method without such losses
    /// may still gain some energy (Tsitouras) or let it oscillate (symplectic methods).
    pub dissipative: bool,
    /// True if the method runs systems with a [`SecondOrderSystem::modal`] split only, and is exact for their
    /// oscillators.
    pub linear_part: bool,
    /// True if the method stores dense matrices of the first-order form, of twice the number of coordinates: memory
    /// grows with its square.
    pub dense_matrices: bool,
    /// Parameters of the method.
    pub parameters: &'static [Parameter],
    /// Publication that the method comes from.
    pub citation: &'static str,
}

/// Fixed step or tolerance of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// Fixed step [s].
    Step(f64),
    /// Relative tolerance; the absolute tolerance is this value times [`SecondOrderSystem::scales`].
    Tolerance(f64),
}

impl Resolution {
    /// Returns the fixed step [s], or `None` for a tolerance.
    pub fn step(self) -> Option<f64> {
        match self {
            Resolution::Step(h) => Some(h),
            Resolution::Tolerance(_) => None,
        }
    }

    /// Returns the relative tolerance, or `None` for a fixed step.
    pub fn tolerance(self) -> Option<f64> {
        match self {
            Resolution::Step(_) => None,
            Resolution::Tolerance(rtol) => Some(rtol),
        }
    }
}

/// End time, resolution and bounds of a run.
#[derive(Clone, Copy, Debug)]
pub struct TimePlan<'a> {
    /// End time [s].
    pub t_end: f64,
    /// Fixed step or relative tolerance.
    pub resolution: Resolution,
    /// True if contact events are located and the method restarts there.
    pub events: bool,
    /// Largest number of steps, rejected ones included.
    pub max_steps: u64,
    /// Bound on the processor time of the run, observers included. A run whose pace would exceed it by far is stopped
    /// early.
    pub time_limit: Option<Duration>,
    /// Flag that is set from outside to stop the run.
    pub cancel: Option<&'a AtomicBool>,
}

impl TimePlan<'_> {
    /// Creates a plan to `t_end` with event location and no bounds.
    pub fn new(t_end: f64, resolution: Resolution) -> Self {
        TimePlan {
            t_end,
            resolution,
            events: true,
            max_steps: u64::MAX,
            time_limit: None,
            cancel: None,
        }
    }
}

/// Counters of the work of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Number of accepted steps.
    pub steps: u64,
    /// Number of steps rejected by the error estimate or repeated to hit an event.
    pub rejected: u64,
    /// Number of force evaluations, without those of observers.
    pub force_evaluations: u64,
    /// Number of Newton iterations.
    pub newton_iterations: u64,
    /// Number of factorisations of the Newton matrix.
    pub factorisations: u64,
    /// Number of located events.
    pub events: u64,
    /// Number of restarts of the method.
    pub restarts: u64,
}

impl Work {
    /// Computes a Newton correction and counts its factorisations: those that the system reports, or one where it
    /// stores no factors.
    pub(crate) fn correct(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        at: StateView<'_>,
        c: Coeffs,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        let before = sys.factorisations();
        let result = sys.correct(at, c, rhs_to_x);
        self.factorisations += match (before, sys.factorisations()) {
            (Some(before), Some(after)) => after - before,
            _ => 1,
        };
        result
    }
}

/// Dense output: the solution inside an accepted step.
pub trait Dense {
    /// Computes coordinates and velocities at the fraction `theta` in [0, 1] of the step.
    fn eval(&self, theta: f64, q: &mut [f64], v: &mut [f64]);

    /// Returns the order of the method, or its highest order where it varies. Integrals over the step need no higher
    /// accuracy.
    fn order(&self) -> u32 {
        u32::MAX
    }
}

/// An accepted step, before events switch or commit the discrete state.
pub struct AcceptedStep<'a> {
    /// State at the start of the step; its discrete state is valid through the step.
    pub from: &'a State,
    /// State at its end, with the discrete state of the step.
    pub to: &'a State,
    /// Solution inside the step.
    pub dense: &'a dyn Dense,
    /// True for a step without contact under steady loads, for which the dense output is exact.
    pub flight: bool,
}

/// Decision of a sink after an accepted step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// The run continues.
    Continue,
    /// The run ends here without an error.
    Stop,
}

/// Receiver of accepted steps, such as a recorder or an energy ledger.
pub trait Sink {
    /// Receives an accepted step and decides whether the run continues.
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control;

    /// Receives the state before and after a change of branch or a hand-over at one instant.
    fn restarted(&mut self, _sys: &mut dyn SecondOrderSystem, _before: &State, _after: &State) {}

    /// Returns false if the sink does not need [`Self::restarted`], so that the loop can skip copies of the state.
    fn wants_restarts(&self) -> bool {
        true
    }

    /// Returns the wall time that the sink itself has used so far. It is no cost of the method, but counts against the
    /// time limit of the run.
    fn spent(&self) -> Duration {
        Duration::ZERO
    }
}

/// A sink that ignores all steps, for timing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NullSink;

impl Sink for NullSink {
    #[inline]
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, _step: &AcceptedStep<'_>) -> Control {
        Control::Continue
    }
    fn wants_restarts(&self) -> bool {
        false
    }
}

/// A method that can integrate a system over a plan.
pub trait Integrator {
    /// Returns the declared properties of the method.
    fn info(&self) -> &'static MethodInfo;

    /// Switches closed-form free flights ([`SecondOrderSystem::flight_path`]) on or off; returns false where the
    /// method cannot do so.
    fn free_flight(&mut self, on: bool) -> bool {
        !on
    }

    /// Integrates from `s` to the end of the plan. `s` ends at the last accepted state; `work` is also counted when
    /// the run fails.
    fn run(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError>;

    /// Continues from the state in which the last run of this method ended. Discrete state, grid of fixed steps and
    /// internal data of the method are kept, so that a run in pieces equals the whole run. With [`Change::Restart`]
    /// the method restarts as at a breakpoint, for forces that jumped in between. A method that has not run yet begins
    /// a run.
    fn resume(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        change: Change,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError>;

    /// Returns a copy with all internal data: together with a copy of the state it restores a run.
    fn duplicate(&self) -> Box<dyn Integrator>;

    /// Traverses all internal data: a method of the same kind that reads what this one wrote continues its run on a
    /// system of the same kind. `resolution` is that of the run.
    ///
    /// # Errors
    /// The bytes are not such data, or the method refuses the system.
    fn archive(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        resolution: Resolution,
        archive: &mut Archive<'_>,
    ) -> Result<(), RestoreError>;
}

/// Reason why a method cannot be restored from bytes.
#[derive(Debug, thiserror::Error)]
pub enum RestoreError {
    /// The bytes are not those of the method.
    #[error(transparent)]
    Bytes(#[from] ArchiveError),
    /// The method refuses the system.
    #[error(transparent)]
    Step(#[from] StepError),
}

/// A one-step method. A step never changes `from`, so that it may be repeated with another size.
pub trait OneStep {
    /// Returns the declared properties of the method.
    fn info(&self) -> &'static MethodInfo;

    /// Prepares a run and refuses systems that the method cannot run; called once per run.
    fn begin(
        &mut self,
        _sys: &mut dyn SecondOrderSystem,
        _resolution: Resolution,
    ) -> Result<(), StepError> {
        Ok(())
    }

    /// Moves the static equilibrium that a system starts in to the state that steps of the method leave at rest, where
    /// the two differ. It is called once, after [`Self::begin`].
    fn balance(
        &mut self,
        _sys: &mut dyn SecondOrderSystem,
        _s: &mut State,
        _resolution: Resolution,
        _work: &mut Work,
    ) {
    }

    /// Traverses the data that the next step depends on. Before a traversal that reads, [`Self::begin`] was called.
    ///
    /// # Errors
    /// The bytes are not the data of the method.
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError>;

    /// Sizes buffers and evaluates the data of the first step; called at the start and after every restart.
    fn restart(&mut self, sys: &mut dyn SecondOrderSystem, s: &State, work: &mut Work);

    /// Makes one step of size `h` [s]. `to` has the right lengths and the discrete state of `from`. Returns the error
    /// estimate relative to `tolerance` (accepted when <= 1), or 0 for methods without one.
    fn step(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        from: &State,
        h: f64,
        tolerance: &Tolerance,
        to: &mut State,
        work: &mut Work,
    ) -> Result<f64, StepError>;

    /// Returns the time up to which one step from `s` is exact because no contact closes before, whatever the size
    /// `h`; at most `s.t + h` where there is none.
    fn free_flight_end(&mut self, _sys: &mut dyn SecondOrderSystem, s: &State, _h: f64) -> f64 {
        s.t
    }

    /// Returns the step of at most `h` [s] that suits the method best under a tolerance.
    fn preferred_step(&self, h: f64) -> f64 {
        h
    }

    /// Moves cached end values to the start after an accepted step without a change of branch.
    fn advance(&mut self);

    /// Interpolates the solution inside the last step; the default is the cubic Hermite interpolant of `q` from both
    /// ends, and its derivative.
    fn interpolate(&self, from: &State, to: &State, theta: f64, q: &mut [f64], v: &mut [f64]) {
        crate::interpolation::hermite(from, to, theta, q, v);
    }
}

/// Relative tolerance and scales of each coordinate.
#[derive(Clone, Debug, Default)]
pub struct Tolerance {
    /// Relative tolerance; 0 for fixed steps.
    pub rtol: f64,
    /// Typical magnitudes of the coordinates.
    pub q: Vec<f64>,
    /// Typical magnitudes of the velocities.
    pub v: Vec<f64>,
}

impl Tolerance {
    /// Reads the scales of a system for a relative tolerance.
    pub fn of(sys: &dyn SecondOrderSystem, rtol: f64) -> Self {
        let n = sys.layout().n;
        let mut tol = Tolerance {
            rtol,
            q: vec![1.0; n],
            v: vec![1.0; n],
        };
        sys.scales(&mut tol.q, &mut tol.v);
        // A scale that is no magnitude would turn the error estimate into infinity or NaN.
        for scale in tol.q.iter_mut().chain(&mut tol.v) {
            if !(scale.is_finite() && *scale > 0.0) {
                *scale = 1.0;
            }
        }
        tol
    }
}
