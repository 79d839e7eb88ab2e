//! The interface of systems: `q' = v`, `M v' = f(t, q, v; discrete)`.
//!
//! Conventions, stated once:
//!
//! - `q`, `v` hold the free generalised coordinates and their rates only. A prescribed motion is a
//!   function of time inside the system, not a coordinate.
//! - [`SecondOrderSystem::force`] is pure in [`StateView`]: the same arguments give the same bits.
//! - **Event functions**: the system's current branch (which contacts are closed, which tooth pairs lie on the
//!   path of contact) is held in the discrete state. Event function `i` is positive while its part of the branch is
//!   valid; an integrator that locates events stops where an event function falls through zero and calls
//!   [`Events::transition`]. Without event location the system uses its clipped force instead, without discrete
//!   state ([`Events::begin`] says which).
//! - Only `begin`, `transition` and `commit` change the discrete state, and only between steps.

mod default_capabilities;

use crate::free_flight::FlightPath;

/// State of a system: time [s], generalised coordinates, their rates, and a discrete state with the history.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Time of the state [s].
    pub t: f64,
    /// Generalised coordinates [rad or m], length `n`.
    pub q: Vec<f64>,
    /// Generalised velocities [rad/s or m/s], length `n`.
    pub v: Vec<f64>,
    /// Contact modes, impact speeds, tooth slots; constant within a step.
    pub discrete: Vec<f64>,
}

impl State {
    /// Borrows the state for the functions of a system.
    #[inline]
    pub fn at(&self) -> StateView<'_> {
        StateView {
            t: self.t,
            q: &self.q,
            v: &self.v,
            discrete: &self.discrete,
        }
    }

    /// Copies another state, without allocation if the lengths agree.
    #[inline]
    pub fn copy_from(&mut self, other: &State) {
        self.t = other.t;
        self.q.clone_from(&other.q);
        self.v.clone_from(&other.v);
        self.discrete.clone_from(&other.discrete);
    }
}

/// A borrowed state at which a force, a tangent or an output is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct StateView<'a> {
    /// Time of the state [s].
    pub t: f64,
    /// Generalised coordinates [rad or m].
    pub q: &'a [f64],
    /// Generalised velocities [rad/s or m/s].
    pub v: &'a [f64],
    /// Discrete state, constant within a step.
    pub discrete: &'a [f64],
}

/// The impulse of the second half of a step: velocities end at `before + time filter (a - steady)` with the
/// acceleration `a` at the end. A system with strongly velocity-dependent forces may evaluate them implicitly at that
/// end.
#[derive(Clone, Copy, Debug)]
pub struct HalfStepImpulse<'a> {
    /// Half of the step size [s].
    pub time: f64,
    /// Velocities before the impulse.
    pub before: &'a [f64],
    /// Acceleration that the method integrates otherwise; empty where there is none.
    pub steady: &'a [f64],
    /// Factor on the velocity change of each coordinate; empty where all are one. The impulse is filtered, and
    /// filtered once more on its way to the velocities that the system receives, so that this is the square of the
    /// filter of the method.
    pub filter: &'a [f64],
}

impl HalfStepImpulse<'_> {
    /// Returns the factor [s] between the acceleration of coordinate `i` and the change of its velocity.
    #[inline]
    pub fn weight(&self, i: usize) -> f64 {
        self.time * self.filter.get(i).copied().unwrap_or(1.0)
    }

    /// Computes the velocities at the end from the accelerations `a`, less the steady ones.
    pub fn end(&self, a: &[f64], v: &mut Vec<f64>) {
        v.clear();
        v.extend(
            a.iter()
                .zip(self.before)
                .enumerate()
                .map(|(i, (a, before))| {
                    let steady = self.steady.get(i).copied().unwrap_or(0.0);
                    before + self.weight(i) * (a - steady)
                }),
        );
    }
}

/// Numbers of coordinates, event functions and discrete values of a system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// Number of free generalised coordinates.
    pub n: usize,
    /// Number of event functions. It is fixed; an event function that does not apply is +1.
    pub event_functions: usize,
    /// Length of the discrete state.
    pub discrete: usize,
}

/// Weights of the Newton matrix `m M + d D + k K` with `D = -df/dv`, `K = -df/dq`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coeffs {
    /// Weight of the mass matrix.
    pub m: f64,
    /// Weight of the damping matrix `-df/dv`.
    pub d: f64,
    /// Weight of the stiffness matrix `-df/dq`.
    pub k: f64,
}

/// Effect of an event or a commit on the state and the force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Neither state nor branch changed: multistep history and cached accelerations remain valid.
    None,
    /// Coordinates were handed over or the force changed branch: the method restarts.
    Restart,
}

/// Energies of a system [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy of all bodies [J].
    pub kinetic: f64,
    /// Strain energy inside the bodies [J], of tooth springs and modes.
    pub strain: f64,
    /// Elastic energy of the contacts [J].
    pub contact: f64,
}

impl Energy {
    /// Returns the sum of all energies [J].
    pub fn total(&self) -> f64 {
        self.kinetic + self.strain + self.contact
    }
}

/// Powers [W] that change the total energy: `dE/dt = external - dissipated`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Power {
    /// Power of applied loads and prescribed motions [W].
    pub external: f64,
    /// Power of the loads whose work [`Report::work_of_loads`] returns [W].
    pub loads: f64,
    /// Power of damping and friction [W], positive when energy is lost.
    pub dissipated: f64,
}

/// Energies, powers and named quantities that a system reports at a state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Energies at the state [J].
    pub energy: Energy,
    /// Powers at the state [W].
    pub power: Power,
    /// Named quantities, in the order of [`Report::channels`].
    pub channels: Vec<f64>,
}

/// A contact between two members of a system, with its force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MemberContact {
    /// Index of the group of contacts, such as the index of a mesh.
    pub group: usize,
    /// Numbers of the two members: tooth numbers, which count on over the turns of a gear.
    pub members: [i64; 2],
    /// Magnitude of the vector sum of its forces [N].
    pub force: f64,
    /// State of each member that moves relative to its body on a spring.
    pub sprung: [Option<SprungMember>; 2],
}

/// A member of a contact that moves relative to its body on a spring and a damper, as a movable tooth does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SprungMember {
    /// Radial part of the contact force on the member [N], positive away from the axis.
    pub radial: f64,
    /// Tangential part of the contact force on the member [N], positive counter-clockwise; for a rack along its
    /// motion.
    pub tangential: f64,
    /// Force of spring and damper on the member [N], with the sign of the tangential part.
    pub spring: f64,
    /// Displacement of the member relative to its body [rad], for a rack [m].
    pub deflection: f64,
}

/// Error of a matrix that cannot be inverted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the Newton matrix is singular")]
pub struct Singular;

/// Split of a system into oscillators, one per coordinate, and a remainder: `a = -omega^2 q - 2 zeta omega v +
/// remainder(t, q, v)`.
///
/// Lengths: all slices have length [`Layout::n`].
pub trait ModalSplit {
    /// Writes the angular frequency [rad/s] and the damping ratio of each coordinate. They are constant over a run and
    /// zero for rigid-body motions.
    fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]);

    /// Receives the compliance per unit of acceleration [s^2] by which the quasi-static response of each oscillator
    /// under the method falls short of `1/omega^2`; zeros for methods that resolve the oscillators. A system that
    /// solves for a local compliance can add it there as `B diag(lag) B^T`. Called at the start of a run, after
    /// [`Events::begin`], which resets it.
    fn prepare(&mut self, _lag: &[f64]) {}

    /// Returns true for a state of static equilibrium from which the system starts.
    fn starts_balanced(&self, _s: &State) -> bool {
        false
    }

    /// Computes the remainder of the acceleration: contact, loads, everything except the oscillators. It is a pure
    /// function of `at`.
    fn remainder(&mut self, at: StateView<'_>, a: &mut [f64]);

    /// Computes the remainder at the end of an impulse, either at the predicted velocities of `at` or implicitly.
    fn remainder_after(&mut self, at: StateView<'_>, _kick: &HalfStepImpulse<'_>, a: &mut [f64]) {
        self.remainder(at, a);
    }

    /// Computes the part of the remainder from steady loads without contact; returns the time until which it is
    /// constant.
    fn steady(&mut self, at: StateView<'_>, a: &mut [f64]) -> f64;

    /// Returns a time until which the remainder equals that of [`Self::steady`] on a motion from `s` without contact,
    /// or `s.t` where a contact is closed or no bound is known.
    fn free_until(&mut self, s: &State) -> f64;
}

/// A second-order system with the functions that every method needs. Optional capabilities are traits of their own,
/// which a system provides by returning them.
///
/// Lengths: `f`, `a`, `x`, `q`, `v` have length [`Layout::n`].
pub trait SecondOrderSystem {
    /// Returns the sizes of the system, which are constant over a run.
    fn layout(&self) -> Layout;

    /// Writes typical magnitudes of coordinates and velocities; a relative tolerance multiplies them.
    fn scales(&self, q: &mut [f64], v: &mut [f64]);

    /// Returns a time in which the force changes noticeably [s], for the first step of an adaptive method after a
    /// restart. It is infinite where no motion is fast.
    fn characteristic_time(&self, _at: StateView<'_>) -> f64 {
        f64::INFINITY
    }

    /// Computes the generalised forces `f(t, q, v; discrete)` without inertia. It is pure and bitwise repeatable.
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]);

    /// Computes the forces at the end of an impulse, either at the predicted velocities of `at` or implicitly.
    fn force_after(&mut self, at: StateView<'_>, _kick: &HalfStepImpulse<'_>, f: &mut [f64]) {
        self.force(at, f);
    }

    /// Solves with the mass matrix in place: `f <- M^-1 f`.
    fn solve_mass(&mut self, at: StateView<'_>, f_to_a: &mut [f64]);

    /// Multiplies by the mass matrix: `y = M x`.
    fn apply_mass(&mut self, at: StateView<'_>, x: &[f64], y: &mut [f64]);

    /// Solves for the Newton correction `x = (c.m M + c.d D + c.k K)^-1 rhs`. The default forms the matrix column by
    /// column from [`Self::tangent_times`]; systems with structure override it.
    fn correct(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        crate::dense_solve::correct_by_columns(self, at, c, rhs_to_x)
    }

    /// Returns the number of factorisations so far for systems that store factors, or `None` where every correction
    /// factorises.
    fn factorisations(&self) -> Option<u64> {
        None
    }

    /// Applies the tangent to a direction: `df = (df/dq) dq + (df/dv) dv`.
    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]);

    /// Returns the branches and breakpoints of the force, or `None` where the force is smooth for all times.
    fn events(&mut self) -> Option<&mut dyn Events> {
        None
    }

    /// Returns the split into linear oscillators and a remainder, for methods that are exact for the linear part;
    /// `None` where there is no such split.
    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        None
    }

    /// Returns the closed-form motion without contact, or `None` where the system has none.
    fn free_flight(&mut self) -> Option<&mut dyn FreeFlight> {
        None
    }

    /// Returns energies, powers and named quantities, or `None` where the system reports nothing.
    fn report(&mut self) -> Option<&mut dyn Report> {
        None
    }
}

/// Branches of a system: event functions that bound the validity of the present branch, and its transitions.
pub trait Events {
    /// Prepares the discrete state at the start of a run. With `located` the integrator locates events and relies on
    /// event functions; otherwise the force has to be clipped and independent of branches in the discrete state.
    fn begin(&mut self, _s: &mut State, _located: bool) {}

    /// Computes the event functions of the current branch; `out` has length [`Layout::event_functions`].
    fn event_functions(&mut self, _at: StateView<'_>, out: &mut [f64]) {
        out.fill(1.0);
    }

    /// Switches the part of the branch that event function `i` bounds.
    fn transition(&mut self, _s: &mut State, _event: usize) -> Change {
        Change::None
    }

    /// Updates the discrete state after an accepted step; called once per step.
    fn commit(&mut self, _s: &mut State) -> Change {
        Change::None
    }

    /// Returns the next time after `t` at which a load has a breakpoint, or infinity.
    fn next_breakpoint(&self, _t: f64) -> f64 {
        f64::INFINITY
    }
}

/// Closed-form motion of a system under steady loads.
pub trait FreeFlight {
    /// Computes the free flight from `s` on and returns the time until which it is certainly valid. `path` is set if
    /// that time exceeds `later`; returns `s.t` where a contact is closed or no bound is known.
    fn flight_path(&mut self, s: &State, later: f64, path: &mut FlightPath) -> f64;

    /// Returns the work [J] of steady loads and prescribed motions between two states of one flight where a closed
    /// form exists; `from` and `to` have the discrete state of the flight.
    fn steady_work(&mut self, _from: StateView<'_>, _to: StateView<'_>) -> Option<f64> {
        None
    }
}

/// Quantities that a system reports to observers.
pub trait Report {
    /// Returns the names of the channels in [`Outputs`].
    fn channels(&self) -> &[String] {
        &[]
    }

    /// Returns false where only inertia and elasticity act, so that all powers are zero at all times and observers
    /// need the energies of a few states only.
    fn has_powers(&self) -> bool {
        true
    }

    /// Returns true where a contact force may jump at first contact or change much within a step, so that histories
    /// need values inside steps. Without dampers at the contacts it grows from zero.
    fn has_jumps(&self) -> bool {
        self.has_powers()
    }

    /// Computes energies, powers and channels at a state.
    fn output(&mut self, at: StateView<'_>, out: &mut Outputs);

    /// Computes the channels at a state without energies and powers, which may cost more than all channels.
    fn sample(&mut self, at: StateView<'_>, out: &mut Outputs) {
        self.output(at, out);
    }

    /// Returns the work [J] of loads between the states at the ends of a step from the displacements of their points
    /// of action, instead of the integral of [`Power::loads`].
    fn work_of_loads(&mut self, _from: StateView<'_>, _to: StateView<'_>) -> Option<f64> {
        None
    }

    /// Lists the closed contacts at the state of the last report, which is `at`, each pair of members once, in order.
    fn touches(&mut self, _at: StateView<'_>, out: &mut Vec<MemberContact>) {
        out.clear();
    }
}
