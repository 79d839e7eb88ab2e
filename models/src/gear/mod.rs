//! Gears: what a gear model must tell the contact and the integrator, and the models.
//!
//! | module | owns |
//! |---|---|
//! | [`model`] | the trait [`GearModel`] |
//! | [`parameters`] | parameters of models as structs that the models own |
//! | [`table`] | the table of gear models: a new model is one line there |
//! | [`rigid`], [`movable_teeth`], [`elastic`] | the models of this crate |
//! | [`free_flight`], [`normal_field`] | what some of them tell beyond the trait |

pub mod elastic;
mod free_flight;
mod model;
pub mod movable_teeth;
mod normal_field;
pub mod parameters;
pub mod rigid;
pub mod table;

pub use free_flight::Flight;
pub use model::{Coordinates, GearModel, HubState, Magnitudes, Oscillators};
pub use normal_field::NormalField;
