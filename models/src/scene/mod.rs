//! The assembled scene: gears on their mounts, loads and meshes as one second-order system.
//!
//! `M q'' = f_int(q, q') + f_load(t, q') + sum_c (w_c N_c + t_c F_c)`: `w = dg/dq` is the contact row, `t` the
//! sliding row. Newton corrections solve the gears' own blocks and add the contacts as low-rank terms
//! (Woodbury), so a gear brings whatever structure its coordinates have. Where a gear has many coordinates of which
//! contacts touch few, both are condensed to these.
//!
//! Planetary sets are seen from their carriers (`carriers`).
//!
//! Shafts join hubs by links, springs or constraints (`shafts`); bodies without teeth stand behind the gears.
//!
//! Contacts of flank points have no event functions: a scene with such a mesh reports none and is never located.
//!
//! Discrete state layout: `[located, gears..., meshes...]`; a mesh has the discrete state of its search, then `(mode,
//! impact speed)` per contact slot, with mode 1 closed and 0 open, then the history of its friction.
mod active;
mod assembled;
mod assembly;
mod assembly_lines;
mod assembly_points;
mod bodies;
mod carriers;
pub mod channels;
mod checks;
mod condensed;
mod contacts;
mod correction;
mod coupled;
mod deformed;
mod direct;
mod events;
mod free_flight;
mod friction;
mod hubs;
mod low_rank;
mod members;
mod mesh_assembly;
mod modal;
mod nodal;
mod nodal_newton;
mod outputs;
mod placement;
mod scales;
mod shafts;
mod small_signals;
mod system;
mod workspace;

pub use assembled::Scene;
pub use bodies::GearPicture;
pub use channels::{Channel, OfGear, OfMesh};
pub use contacts::{ContactExtent, ContactForce};
pub use deformed::DeformedFlank;
pub use friction::MeshFriction;
pub use hubs::hub_of;
pub use members::{SceneGear, SceneMesh};
pub use mesh_assembly::touches_in_space;
pub use modal::Coupling;
pub use small_signals::{LinearisedScene, Mechanism, StrainIn};
