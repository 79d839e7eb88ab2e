//! Finite-element references for gear contact.
//!
//! | module | owns |
//! |---|---|
//! | [`gear_mesh`] | structured meshes of gears and racks |
//! | [`gear_deck`] | toothed bodies in decks: their recognition, checks and writers |
//! | [`matrices`] | stiffness, mass and mode shapes that other programs wrote |
//! | [`reduction`] | modes, static compliance and their reduction to the data of the elastic gear |
//! | [`statics`] | loaded tooth contact: load sharing, mesh stiffness, transmission error |
//! | `mesh_source` | where a model of finite elements takes its mesh from: its parameters |
//! | [`full_order`] | the gear model `fe`: all nodal displacements, in the same scenes as every other model |
//! | [`data`] | references as data: histories whatever their origin, and the reader of tables |
//! | [`stored`] | references of other programs, embedded in this one: what they carry, and how they are read |
//! | `vector` | sums and rotations of vectors that several modules need |
//! | [`recognise`] | a gear from its surface alone: axis, bore, teeth, flanks, involute |
//! | [`resources`] | what a study may take from the machine: memory, cache |
//! | [`hash`] | the hash that names stored results |
//! | [`file_kind`] | files of this field by the endings of their names, and what can be done with each |
//!
//! The crate [`gearbench_solid_fe`] owns finite elements that are no matter of gears: `mesh`, `element`, `assembly`,
//! `solve`, `modes` and `limits`. The crate [`gearbench_fe_deck`] owns decks that are no matter of gears: it is `deck` here, with
//! `files` and [`Refusal`]. They have their names here as well.
//!
//! The data lie beside the sources in `reference/calculix/`, each case with its deck, results, parameters
//! and a `SOURCE.md` that says who computed what and how; `regenerate.sh` there runs a deck again.
//! Everything is in SI units; the conventions of a case stand in its `SOURCE.md`.

pub mod data;
pub mod file_kind;
pub mod full_order;
pub mod gear_deck;
pub mod gear_mesh;
mod groups;
pub mod hash;
pub mod matrices;
mod mesh_source;
pub mod recognise;
pub mod reduction;
pub mod resources;
pub mod statics;
pub mod stored;
#[cfg(test)]
mod test_support;
mod vector;

pub use gearbench_fe_deck::{self as deck, Refusal, files};
pub use gearbench_solid_fe::{assembly, element, limits, mesh, modes, solve};
pub use mesh_source::MeshParameters;
pub use stored::{ExternalReference, REFERENCES, StoredReference, reference};

use gearbench_models::gear::table::Model;

/// The gear models of this crate.
pub static MODELS: &[Model] = &[full_order::table::ROW, reduction::table::ROW];
