//! Time integration of second-order systems whose force changes branch at contact.
//!
//! The system is `q' = v`, `M(t, q) v' = f(t, q, v; memory)` ([`SecondOrderSystem`]). It knows nothing of
//! gears. What has history (contact modes, impact speeds, tooth slots) lives in [`State::memory`] and
//! changes only between steps, so that inside a step the force is one smooth function and a method keeps
//! its declared order through contact events.
//!
//! | room | owns |
//! |---|---|
//! | [`system`] | the system seam: state, force, mass, tangent, guards |
//! | [`method`] | the method seam: [`Integrator`], [`OneStep`], plans, work counters, errors |
//! | [`stepped`] | the loop of all one-step methods: step control, event location, table knots |
//! | [`explicit`] | semi-implicit Euler, velocity Verlet, RK4, Dormand-Prince 5(4) |
//! | [`implicit`] | the generalised-alpha family (Newmark-beta, HHT-alpha) and the diffsol methods |
//! | [`observers`] | energy ledger, grid recorder: what watches a run without changing it |
//! | [`table`] | the table of methods: a new method is one file and one line there |

mod bounds;
pub mod dense_solve;
pub mod diffsol_adapter;
mod events;
pub mod explicit;
pub mod implicit;
pub mod interpolation;
pub mod method;
pub mod observers;
pub mod stepped;
pub mod system;
pub mod table;

pub use method::{
    AcceptedStep, Control, Dense, Integrator, MethodInfo, NullSink, OneStep, Parameter, Resolution,
    Sink, StepError, Stepping, TimePlan, Work,
};
pub use stepped::Stepped;
pub use system::{At, Change, Coeffs, Energy, Layout, Outputs, Power, SecondOrderSystem, State};
pub use table::{METHODS, Method, method};
