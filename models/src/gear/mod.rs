//! Gears: the interface between gear models, contact and integrator, and the models.
//!
//! | module | owns |
//! |---|---|
//! | `model` | the trait [`GearModel`] |
//! | `hub_body` | the data that every gear has: [`HubBody`] |
//! | `capabilities` | what only some gears can do: flank surface, linear motion, teeth, size, coupled mass |
//! | `body` | bodies of finite elements, for pictures |
//! | `capability_functions` | what follows for any gear from what it hands out |
//! | [`parameters`] | parameters of models as structs that the models own |
//! | [`properties`] | properties of a model that studies ask for before a gear is built |
//! | `row` | a row of the table: what a model declares and is built from |
//! | [`table`] | the table of gear models: a new model is one line there |
//! | [`rigid`], [`movable_teeth`], [`elastic`] | the models of this crate |

mod body;
pub mod capabilities;
mod capability_functions;
pub mod elastic;
mod flank_displacement;
mod free_flight;
mod hub_body;
mod model;
pub mod movable_teeth;
pub mod parameters;
pub mod properties;
pub mod rigid;
mod row;
pub mod table;

pub use body::{BodyLoad, DisplacedNodes, MeshedBody, Recovery};
pub use capabilities::{
    CoupledMass, DeformedLines, FlankNodes, FlankSurface, LargeGear, LinearMotion, Oscillators,
    ToothCoordinates, ToothSpring,
};
pub use capability_functions::{add_response, condense_by, condensed, respond_by, work_on_hub};
pub use flank_displacement::FlankDisplacement;
pub use free_flight::FreeFlight;
pub use hub_body::{HubBody, HubState, Magnitudes};
pub use model::GearModel;
