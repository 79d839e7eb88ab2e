//! Export of a scene as a functional mock-up unit (FMI 3.0 or FMI 2.0).
//!
//! One file serves co-simulation and model exchange. It has the description, the scene with all that it reads, and the
//! shared library of the crate `gearbench-fmu`, which reads the scene again and steps it. Both sides number variables by
//! [`interface::Interface`], made anew from the scene on each side and compared by its hash.
//!
//! | module | owns |
//! |---|---|
//! | [`coupled`] | the scene with the inputs of a host: a load on every free hub, a prescribed motion of every moved one |
//! | [`interface`] | variables, their names, units and roles |
//! | [`description`] | `modelDescription.xml` |
//! | [`settings`] | settings of the library in addition to the scene; opening of unpacked resources |
//! | [`package`] | contents and archive |
//! | `library` | the shared library: search, and build in a checkout |
//! | `command` | `gearbench fmu` |

pub mod arguments;
pub(crate) mod command;
pub mod coupled;
pub mod description;
pub mod interface;
mod library;
pub mod package;
pub mod settings;
