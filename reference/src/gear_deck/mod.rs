//! Toothed bodies in decks: their recognition, checks and writers.
//!
//! | part | owns |
//! |---|---|
//! | [`gears`] | the toothed bodies of a deck as [`GearMesh`](crate::gear_mesh::GearMesh), each in its own frame |
//! | [`check_gtm`] | what a deck lacks for the preprocessing of elastic gears |
//! | [`write`](write()), [`write_impact`] | a gear for CalculiX, Abaqus or Ansys, or two in contact for CalculiX |
//!
//! The crate [`gearbench_fe_deck`] reads and writes decks as such ([`crate::deck`]).

#[cfg(test)]
mod archive_tests;
mod gears;
mod gtm;
mod writer;

pub use gears::{BodyShape, DeckGear, gears, gears_known, gears_with};
pub use gtm::{Finding, GtmRequirement, check_gtm};
pub use writer::{
    GearDeck, Hub, Impact, ImpactGear, ModalProgram, ModalRun, WriteError, write, write_impact,
};
