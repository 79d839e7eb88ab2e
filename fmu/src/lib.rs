//! Export of scenes of gearbench as functional mock-up units: the shared library of FMI 3.0 and FMI 2.0, for
//! co-simulation and model exchange.
//!
//! `gearbench fmu` packs this library with a scene ([`gearbench::fmu`]). A host loads it, unpacks the scene, and either
//! steps it (co-simulation: the scene's own integrator moves it over communication steps) or integrates its states
//! (model exchange: `q' = v`, `M v' = f`, with the event functions of the scene as event indicators).
//! | module | owns |
//! |---|---|
//! | [`instance`] | an instance: state, inputs, outputs, steps, copies of the state for the host |
//! | `jumps` | response to a jump of the speed of a moved hub |
//! | `slopes` | time derivatives of outputs |
//! | `exchange` | model exchange: derivatives, event functions, handling of events |
//! | `stored` | copies of the state as bytes |
//! | [`c`] | the functions of both standards, 75 and 44; all `unsafe` of the workspace |
//!
//! Wrong calls return an error and a message to the host's logger; a panic never crosses into C, but ends as
//! `fmi3Fatal`.

// The one place that speaks C.
#[allow(unsafe_code)]
pub mod c;
mod exchange;
pub mod instance;
mod jumps;
mod slopes;
mod stored;
