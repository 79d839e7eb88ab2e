//! The system seam: `q' = v`, `M v' = f(t, q, v; discrete)`.
//!
//! Conventions, stated once:
//!
//! - `q`, `v` hold the free generalised coordinates and their rates only. A prescribed motion is a
//!   function of time inside the system, not a coordinate.
//! - [`SecondOrderSystem::force`] is pure in [`At`]: the same arguments give the same bits.
//! - **Event functions**: the system's current branch (which contacts are closed, which tooth pairs lie on the
//!   path of contact) is held in the discrete state. Event function `i` is positive while its part of the branch is
//!   valid; an integrator that locates events stops where an event function falls through zero and calls
//!   [`Events::transition`]. Without event location the system uses its clipped force instead, without discrete
//!   state ([`Events::begin`] says which).
//! - Only `begin`, `transition` and `commit` change the discrete state, and only between steps.

mod without;

use crate::free_flight::FlightPath;

/// A state: time [s], generalised coordinates, their rates, and what has history.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Time [s].
    pub t: f64,
    /// Generalised coordinates [rad or m], length `n`.
    pub q: Vec<f64>,
    /// Generalised velocities [rad/s or m/s], length `n`.
    pub v: Vec<f64>,
    /// Contact modes, impact speeds, tooth slots; constant within a step.
    pub discrete: Vec<f64>,
}

impl State {
    /// The borrowed view that the system's functions take.
    #[inline]
    pub fn at(&self) -> At<'_> {
        At {
            t: self.t,
            q: &self.q,
            v: &self.v,
            discrete: &self.discrete,
        }
    }

    /// Copies without allocating when the lengths agree.
    #[inline]
    pub fn copy_from(&mut self, other: &State) {
        self.t = other.t;
        self.q.clone_from(&other.q);
        self.v.clone_from(&other.v);
        self.discrete.clone_from(&other.discrete);
    }
}

/// A borrowed state: where a force, a tangent or an output is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// Time [s].
    pub t: f64,
    /// Generalised coordinates.
    pub q: &'a [f64],
    /// Generalised velocities.
    pub v: &'a [f64],
    /// Discrete state, constant within a step.
    pub discrete: &'a [f64],
}

/// The second half of a kick: velocities end at `before + time filter (a - steady)`, `a` the acceleration that is asked
/// for. A system whose forces answer to velocities stiffly may give them at that end, implicitly.
#[derive(Clone, Copy, Debug)]
pub struct HalfKick<'a> {
    /// Half a step [s].
    pub time: f64,
    /// Velocities before it, as the system sees them.
    pub before: &'a [f64],
    /// Acceleration that the method accounts for otherwise; empty where there is none.
    pub steady: &'a [f64],
    /// What the system sees of its accelerations' kicks; empty where it is all of all. What kicks is filtered once
    /// more on its way to the velocities that are seen, so that this is the square of the method's filter.
    pub filter: &'a [f64],
}

impl HalfKick<'_> {
    /// Time [s] for which an acceleration of a coordinate acts on the velocity that is seen.
    #[inline]
    pub fn weight(&self, i: usize) -> f64 {
        self.time * self.filter.get(i).copied().unwrap_or(1.0)
    }

    /// Velocities at the end by accelerations, less the steady ones.
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

/// Sizes of a system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// Number of free generalised coordinates.
    pub n: usize,
    /// Number of event functions (fixed; an event function that does not apply is held at +1).
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

/// What happened to a state between two steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Nothing: multistep history and cached accelerations stay valid.
    None,
    /// Coordinates were handed over or the force changed branch: the method starts afresh.
    Restart,
}

/// Energies [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Strain energy inside the bodies (tooth springs, modes).
    pub strain: f64,
    /// Elastic energy stored at the contacts.
    pub contact: f64,
}

impl Energy {
    /// Sum of all parts [J].
    pub fn total(&self) -> f64 {
        self.kinetic + self.strain + self.contact
    }
}

/// Powers [W] that change the total energy: `dE/dt = external - dissipated`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Power {
    /// Applied loads and prescribed motions.
    pub external: f64,
    /// That of loads whose work [`Report::work_of_loads`] knows.
    pub loads: f64,
    /// Damping and friction; positive when energy is lost.
    pub dissipated: f64,
}

/// What a system reports at a state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Energies.
    pub energy: Energy,
    /// Powers.
    pub power: Power,
    /// Named quantities, in the order of [`Report::channels`].
    pub channels: Vec<f64>,
}

/// A contact between two members of a system that carries force, or may.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// What it belongs to: the place of a mesh.
    pub group: usize,
    /// The members that touch: teeth by number, which goes on over the turns of a gear.
    pub members: [i64; 2],
    /// Magnitude of the vector sum of its forces [N].
    pub force: f64,
    /// State of each member that moves on a spring of its own.
    pub sprung: [Option<SprungMember>; 2],
}

/// A member of a contact that moves against its body on a spring and a damper, as a movable tooth does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SprungMember {
    /// Radial part of the contact force on the member, positive away from the axis [N].
    pub radial: f64,
    /// Tangential part, positive counter-clockwise, of a rack along its slide [N].
    pub tangential: f64,
    /// Force of spring and damper on the member, positive as the tangential part [N].
    pub spring: f64,
    /// Displacement of the member relative to its body [rad], of a rack [m].
    pub deflection: f64,
}

/// A tangent that could not be inverted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the Newton matrix is singular")]
pub struct Singular;

/// A system that is oscillators, one per coordinate, and a remainder:
/// `a = -omega^2 q - 2 zeta omega v + remainder(t, q, v)`.
///
/// Lengths: all slices have length [`Layout::n`].
pub trait ModalSplit {
    /// Angular frequency [rad/s] and damping ratio of each coordinate; constant over a run, zero for the motion of a
    /// rigid body.
    fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]);

    /// Tells how much less than `1/omega^2` the method lets each oscillator give to a remainder that lasts, per unit of
    /// acceleration [s^2]; zeros for methods that resolve the oscillators. A system that solves for a local
    /// compliance can add it there, `B diag(quasi_static) B^T`. Called at the start of a run, after
    /// [`Events::begin`], which forgets what an earlier run told.
    fn prepare(&mut self, _lag: &[f64]) {}

    /// True for a state of static equilibrium that the system starts in.
    fn starts_balanced(&self, _s: &State) -> bool {
        false
    }

    /// The remainder of the acceleration: contact, loads, whatever is not the oscillators. Pure in `at`.
    fn remainder(&mut self, at: At<'_>, a: &mut [f64]);

    /// The remainder at the end of a kick: at the velocities of `at`, which predict it, or implicitly.
    fn remainder_after(&mut self, at: At<'_>, _kick: &HalfKick<'_>, a: &mut [f64]) {
        self.remainder(at, a);
    }

    /// The remainder that steady loads make while nothing touches; the time until which it is constant.
    fn steady(&mut self, at: At<'_>, a: &mut [f64]) -> f64;

    /// A time until which the remainder surely is that of [`Self::steady`], were the system to move on from `s` without
    /// contact; `s.t` where something touches or nothing is known.
    fn free_until(&mut self, s: &State) -> f64;
}

/// A second-order system: what every method needs. What only some systems have is a capability of its own, which a
/// system offers by returning it.
///
/// Lengths: `f`, `a`, `x`, `q`, `v` have length [`Layout::n`].
pub trait SecondOrderSystem {
    /// Sizes; constant over a run.
    fn layout(&self) -> Layout;

    /// Typical magnitudes of coordinates and velocities; a relative tolerance multiplies them.
    fn scales(&self, q: &mut [f64], v: &mut [f64]);

    /// A time in which the force changes noticeably [s]: first step after a restart of an adaptive
    /// method. Infinite when nothing is fast.
    fn characteristic_time(&self, _at: At<'_>) -> f64 {
        f64::INFINITY
    }

    /// Generalised forces `f(t, q, v; discrete)` without inertia. Pure and bitwise repeatable.
    fn force(&mut self, at: At<'_>, f: &mut [f64]);

    /// The forces at the end of a kick: at the velocities of `at`, which predict it, or implicitly.
    fn force_after(&mut self, at: At<'_>, _kick: &HalfKick<'_>, f: &mut [f64]) {
        self.force(at, f);
    }

    /// `f <- M^-1 f`.
    fn solve_mass(&mut self, at: At<'_>, f_to_a: &mut [f64]);

    /// `y = M x`.
    fn apply_mass(&mut self, at: At<'_>, x: &[f64], y: &mut [f64]);

    /// `x = (c.m M + c.d D + c.k K)^-1 rhs`, the Newton correction. The default forms the matrix column by
    /// column from [`Self::tangent_times`]; systems with structure use it.
    fn correct(&mut self, at: At<'_>, c: Coeffs, rhs_to_x: &mut [f64]) -> Result<(), Singular> {
        crate::dense_solve::correct_by_columns(self, at, c, rhs_to_x)
    }

    /// Factorisations that corrections needed so far, for systems that keep factors; `None` where every correction
    /// factorises afresh.
    fn factorisations(&self) -> Option<u64> {
        None
    }

    /// `df = (df/dq) dq + (df/dv) dv`: the tangent applied to a direction.
    fn tangent_times(&mut self, at: At<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]);

    /// Branches and breakpoints; `None` where the force is one smooth function for all times.
    fn events(&mut self) -> Option<&mut dyn Events> {
        None
    }

    /// The system as independent linear oscillators and a rest, for methods that are exact for the linear part;
    /// `None` where it is not one.
    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        None
    }

    /// Motion without contact in closed form; `None` where the system knows none.
    fn free_flight(&mut self) -> Option<&mut dyn FreeFlight> {
        None
    }

    /// Energies, powers and named quantities; `None` where the system reports nothing.
    fn report(&mut self) -> Option<&mut dyn Report> {
        None
    }
}

/// The branches of a system: how long the present one is valid, and what comes after it.
pub trait Events {
    /// Prepares the discrete state at the start of a run. `located`: the integrator locates events and relies on
    /// event functions; otherwise the force must be clipped and free of branches in discrete state.
    fn begin(&mut self, _s: &mut State, _located: bool) {}

    /// Event functions of the current branch; `out` has length [`Layout::event_functions`].
    fn event_functions(&mut self, _at: At<'_>, out: &mut [f64]) {
        out.fill(1.0);
    }

    /// Flips the part of the branch that event function `i` watches.
    fn transition(&mut self, _s: &mut State, _event: usize) -> Change {
        Change::None
    }

    /// Called once after each accepted step.
    fn commit(&mut self, _s: &mut State) -> Change {
        Change::None
    }

    /// Next time after `t` at which a load has a breakpoint, or infinity.
    fn next_breakpoint(&self, _t: f64) -> f64 {
        f64::INFINITY
    }
}

/// Motion while nothing touches and all loads are steady.
pub trait FreeFlight {
    /// The motion from `s` on in closed form: the time until which it surely holds, with the motion in `path`
    /// where the time is `later` than a time; `s.t` where something touches or nothing is known.
    fn flight_path(&mut self, s: &State, later: f64, path: &mut FlightPath) -> f64;

    /// The motion from `s` on in closed form whether contacts are closed or not, where all of them are springs and dampers
    /// of constant stiffness: the time of the next event, or until which loads are steady, with the motion and the event
    /// functions to switch at its end in `path`; `s.t` where it is not known. Asked where events are located.
    fn linear_path(&mut self, s: &State, _path: &mut FlightPath) -> f64 {
        s.t
    }

    /// Work [J] of steady loads and prescribed motions between two states of one flight, where it is known in closed
    /// form; `from` and `to` have the discrete state of the flight.
    fn steady_work(&mut self, _from: At<'_>, _to: At<'_>) -> Option<f64> {
        None
    }
}

/// What a system tells observers.
pub trait Report {
    /// Names of the channels in [`Outputs`].
    fn channels(&self) -> &[String] {
        &[]
    }

    /// False where nothing but inertia and elasticity acts, so that all powers are zero at all times: observers
    /// then need the energies of a few states only.
    fn has_powers(&self) -> bool {
        true
    }

    /// True where a contact force may jump at first touch or change much within a step, so that histories look into
    /// steps; without dampers at the contacts it grows from zero.
    fn has_jumps(&self) -> bool {
        self.has_powers()
    }

    /// Energies, powers and channels at a state.
    fn output(&mut self, at: At<'_>, out: &mut Outputs);

    /// Channels at a state, without the energies and powers, which may cost more than all channels.
    fn sample(&mut self, at: At<'_>, out: &mut Outputs) {
        self.output(at, out);
    }

    /// Work [J] of loads between the states at the ends of a step, where it is known by what they moved, instead of the
    /// integral of [`Power::loads`].
    fn work_of_loads(&mut self, _from: At<'_>, _to: At<'_>) -> Option<f64> {
        None
    }

    /// The contacts that are closed at the state that was last reported of, which is `at`, each pair of members once, in order.
    fn touches(&mut self, _at: At<'_>, out: &mut Vec<Touch>) {
        out.clear();
    }
}
