//! Time integration of second-order systems whose force changes branch at contact.
//!
//! The system is
//!
//! ```text
//! q' = v,    M(t, q) v' = f(t, q, v; discrete)
//! ```
//!
//! ([`SecondOrderSystem`]), in SI units; the crate has no knowledge of gears. Quantities with a history (contact
//! modes, impact speeds, tooth slots) are in [`State::discrete`] and change only between steps, so that inside a step
//! the force is one smooth function and a method keeps its declared order through contact events.
//!
//! **Events.** *Event functions* of the system bound the validity of its branch: event function `i` is positive until
//! its part of the branch ends. The loop finds where an event function falls through zero, ends the step there, calls
//! [`Events::transition`] and restarts the method. With [`TimePlan::events`] off the system clips its force instead,
//! and orders above one are lost at damped contacts.
//!
//! **Steps.** A method declares in [`MethodInfo`] whether it runs at a fixed step, under a tolerance, or
//! both ([`Resolution`]). A tolerance `rtol` bounds the estimated error of each step by `rtol` times the
//! system's own magnitudes ([`SecondOrderSystem::scales`]), not by the coordinate itself: angles grow over
//! many turns while deflections stay small. Declared are also the order and the slope of the error over
//! the tolerance; the tests of this crate hold every row of [`METHODS`] to both.
//!
//! **Results** are passed step by step to a [`Sink`] with dense output; integrators print nothing. A run that fails
//! returns the time and the magnitude of the failure ([`StepError`]) and the last accepted state.
//!
//! | module | owns |
//! |---|---|
//! | [`system`] | the system seam: state, force, mass, tangent, event functions |
//! | [`method`] | the method seam: [`Integrator`], [`OneStep`], plans, work counters, errors |
//! | [`stepped`] | the loop of all one-step methods: step control, event location, table breakpoints |
//! | [`explicit`] | semi-implicit Euler, velocity Verlet, RK4, Dormand-Prince 5(4), Tsitouras 5(4) |
//! | [`implicit`] | the generalised-alpha family (Newmark-beta, HHT-alpha), BDF, TR-BDF2, ESDIRK 3(4) |
//! | [`modal`] | the trigonometric method: exact for linear oscillators, flight in one step |
//! | [`free_flight`] | motion without contact in closed form, for the loops of all methods |
//! | [`diffsol_adapter`] | the loop of the methods that diffsol provides |
//! | [`clock`] | processor time, the measure of bounds and costs |
//! | [`interpolation`], [`dense_solve`] | Hermite interpolants; small dense linear algebra |
//! | [`linear_stability`] | the largest stable step of each method on linear systems |
//! | [`mod@equilibrium`] | static equilibrium by Newton's method on the system's own tangent |
//! | [`observers`] | energy ledger, grid recorder: what watches a run without changing it |
//! | [`spec`], [`scheme`] | which method, at which step, as data and as text |
//! | [`table`] | the table of methods: a new method is one file and one line there |
//!
//! # Example
//!
//! A mass on a spring with two methods of the table, against `cos t`:
//!
//! ```
//! use gearbench_integrators::{
//!     Layout, StateView, NullSink, Resolution, SecondOrderSystem, State, TimePlan, Work, method,
//! };
//!
//! /// `m q'' = -k q` with `m = 2 kg`, `k = 2 N/m`.
//! struct MassSpring;
//!
//! impl SecondOrderSystem for MassSpring {
//!     fn layout(&self) -> Layout {
//!         Layout { n: 1, ..Layout::default() }
//!     }
//!     fn scales(&self, q: &mut [f64], v: &mut [f64]) {
//!         q[0] = 1.0; // [m]
//!         v[0] = 1.0; // [m/s]
//!     }
//!     fn characteristic_time(&self, _at: StateView<'_>) -> f64 {
//!         1.0 // sqrt(m / k) [s]
//!     }
//!     fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
//!         f[0] = -2.0 * at.q[0];
//!     }
//!     fn solve_mass(&mut self, _at: StateView<'_>, f_to_a: &mut [f64]) {
//!         f_to_a[0] /= 2.0;
//!     }
//!     fn apply_mass(&mut self, _at: StateView<'_>, x: &[f64], y: &mut [f64]) {
//!         y[0] = 2.0 * x[0];
//!     }
//!     fn tangent_times(&mut self, _at: StateView<'_>, dq: &[f64], _dv: &[f64], df: &mut [f64]) {
//!         df[0] = -2.0 * dq[0];
//!     }
//! }
//!
//! for (name, resolution, allowed) in [
//!     ("dopri5", Resolution::Tolerance(1e-9), 1e-7),
//!     ("generalised-alpha(rho_inf=0.9)", Resolution::Step(1e-3), 1e-5),
//! ] {
//!     let mut integrator = method(name)?;
//!     let mut s = State { q: vec![1.0], v: vec![0.0], ..State::default() };
//!     let mut work = Work::default();
//!     let plan = TimePlan::new(10.0, resolution);
//!     integrator
//!         .run(&mut MassSpring, &mut s, &plan, &mut NullSink, &mut work)
//!         ?;
//!     assert!((s.q[0] - 10f64.cos()).abs() < allowed, "{name}: {}", s.q[0]);
//!     assert!(work.steps > 0 && work.force_evaluations >= work.steps);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod archive;
mod bounds;
pub mod clock;
pub mod dense_solve;
pub mod diffsol_adapter;
pub mod equilibrium;
pub mod error;
mod events;
pub mod explicit;
pub mod free_flight;
pub mod implicit;
pub mod interpolation;
pub mod linear_stability;
pub mod method;
pub mod modal;
pub mod observers;
pub mod scheme;
pub mod spec;
pub mod stepped;
pub mod system;
pub mod table;

pub use archive::{Archive, ArchiveError};
pub use bounds::{Bound, integration_time};
pub use equilibrium::{EquilibriumError, EquilibriumOptions, equilibrium};
pub use error::StepError;
pub use free_flight::FlightPath;
pub use method::{
    AcceptedStep, Control, Dense, Integrator, MethodInfo, NullSink, OneStep, Parameter, Resolution,
    RestoreError, Sink, Stepping, TimePlan, Work,
};
pub use scheme::Scheme;
pub use spec::{MethodError, MethodSpec};
pub use stepped::Stepped;
pub use system::{
    Change, Coeffs, Energy, Events, FreeFlight, HalfStepImpulse, Layout, MemberContact, ModalSplit,
    Outputs, Power, Report, SecondOrderSystem, SprungMember, State, StateView,
};
pub use table::{METHODS, Method, method};
