//! Abaqus and CalculiX decks (`.inp`), meshes of Gmsh (`.msh`) and archives of Ansys (`.cdb`): reading, checking, writing.
//!
//! | part | owns |
//! |---|---|
//! | [`read`], [`read_str`] | a deck as it stands: [`Deck`]; what is not known is declined with its line |
//! | [`gears`] | its toothed bodies as [`GearMesh`](crate::gear_mesh::GearMesh), each in its own frame |
//! | [`check_gtm`] | what a deck lacks for the preprocessing of elastic gears |
//! | [`write`](write()), [`write_impact`] | a gear for CalculiX, Abaqus or Ansys, or two in contact for CalculiX |
//!
//! The reader supports the parts of a deck that define a body (solid elements, parts and their instances, sets,
//! surfaces, isotropic materials) and those of an impact of gears: rigid bores, linear penalty contact, initial
//! velocities, static, dynamic and frequency steps. Keywords that do not change a body are ignored and counted; those
//! that would are declined with their line ([`Deck::told`]). The syntax follows the manuals of Abaqus (keywords) and
//! CalculiX CrunchiX 2.20 (input deck format).

mod cdb;
mod data;
mod error;
mod gears;
mod gtm;
mod lexer;
mod msh;
mod reader;
mod units;
mod writer;

pub use data::{
    Boundary, ContactKind, ContactPair, Deck, DeckMaterial, ElementBlock, InitialVelocity,
    Interaction, Label, Labels, NonlinearProperty, Procedure, RigidBody, Section, Step, Target,
};
pub(crate) use error::quote;
pub use error::{DeckError, DeckErrorKind, Place};
pub use gears::{BodyShape, DeckGear, gears, gears_known, gears_with};
pub use gtm::{Finding, GtmRequirement, check_gtm};
pub use lexer::{MAX_DECK_BYTES, MAX_INCLUDE_DEPTH, MAX_INCLUDES, MAX_LINE_BYTES, Resolver};

pub use units::Units;
pub use writer::{
    GearDeck, Hub, Impact, ImpactGear, ModalProgram, ModalRun, WriteError, write, write_impact,
};

use crate::resources::Resources;
use crate::{files, limits};
use std::borrow::Cow;
use std::io::{self, Read};
use std::path::Path;

/// Reads a deck from a file: `.inp`, a mesh of Gmsh `.msh`, text or binary, or an archive of Ansys `.cdb`, distinguished
/// by their content, all optionally compressed by gzip. Includes are relative to the folder of the including file. All data are
/// converted to SI units, from those that are determined ([`Deck::units_from`]).
pub fn read(path: impl AsRef<Path>) -> Result<Deck, DeckError> {
    read_in(path, None)
}

/// As [`read`], from these units.
pub fn read_in(path: impl AsRef<Path>, units: Option<Units>) -> Result<Deck, DeckError> {
    let name = path.as_ref().to_string_lossy().into_owned();
    let bytes = bytes_of(&name).map_err(|e| unreadable(&name, "a readable deck", &e))?;
    read_bytes_in(&name, &bytes, units, &mut text_of)
}

/// Reads a deck from its text. `resolver` returns the text of included files, by their names joined with the folder of
/// the including file.
pub fn read_str(name: &str, text: &str, resolver: &mut Resolver<'_>) -> Result<Deck, DeckError> {
    read_str_in(name, text, None, resolver)
}

/// As [`read_str`], from these units.
pub fn read_str_in(
    name: &str,
    text: &str,
    units: Option<Units>,
    resolver: &mut Resolver<'_>,
) -> Result<Deck, DeckError> {
    read_bytes_in(name, text.as_bytes(), units, resolver)
}

/// Reads an embedded deck, gzip or not; it may not include files.
pub fn read_bytes(name: &str, bytes: &[u8]) -> Result<Deck, DeckError> {
    let bytes = unpacked(bytes).map_err(|e| unreadable(name, "a deck as text or gzip", &e))?;
    read_bytes_in(name, &bytes, None, &mut |_| {
        Err(io::Error::other("an embedded deck without included files"))
    })
}

/// Reads bytes that are not compressed. Titles in encodings other than UTF-8 are accepted.
fn read_bytes_in(
    name: &str,
    bytes: &[u8],
    units: Option<Units>,
    resolver: &mut Resolver<'_>,
) -> Result<Deck, DeckError> {
    match () {
        () if msh::is_msh(bytes) => msh::read(name, bytes, units),
        () if cdb::is_cdb(bytes) => cdb::read(name, bytes, units),
        () => reader::read(name, &String::from_utf8_lossy(bytes), units, resolver),
    }
}

fn unreadable(name: &str, expected: &str, e: &io::Error) -> DeckError {
    DeckError::new(DeckErrorKind::Io, "", expected, e.to_string(), "").at(name, 0)
}

fn bytes_of(name: &str) -> io::Result<Vec<u8>> {
    let bytes = files::read(Path::new(name), MAX_DECK_BYTES as u64)?;
    if is_gzip(&bytes) {
        return Ok(unpacked(&bytes)?.into_owned());
    }
    check_memory(bytes.len())?;
    Ok(bytes)
}

fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b])
}

/// Memory of a deck relative to the bytes of its text: the text itself, nodes, elements and their labels.
const MEMORY_OVER_TEXT: f64 = 4.0;

fn check_memory(bytes: usize) -> io::Result<()> {
    let what = format!("a deck of {bytes} bytes");
    limits::check(what, MEMORY_OVER_TEXT * bytes as f64, "use fewer elements")
        .map_err(io::Error::other)
}

fn text_of(name: &str) -> io::Result<String> {
    Ok(String::from_utf8_lossy(&bytes_of(name)?).into_owned())
}

/// Bytes, unpacked when they are gzip.
fn unpacked(bytes: &[u8]) -> io::Result<Cow<'_, [u8]>> {
    let bytes = match is_gzip(bytes) {
        false => Cow::Borrowed(bytes),
        true => {
            let mut unpacked = Vec::new();
            let most =
                (Resources::own().memory.limit() / MEMORY_OVER_TEXT).min(MAX_DECK_BYTES as f64);
            flate2::read::MultiGzDecoder::new(bytes)
                .take(most as u64 + 1)
                .read_to_end(&mut unpacked)
                .map_err(|e| {
                    io::Error::other(format!(
                        "a gzip archive that is incomplete, damaged or followed by other bytes ({e})"
                    ))
                })?;
            check_memory(unpacked.len())?;
            Cow::Owned(unpacked)
        }
    };
    match bytes.len() {
        0..=MAX_DECK_BYTES => Ok(bytes),
        _ => Err(io::Error::other(format!(
            "more than {MAX_DECK_BYTES} bytes"
        ))),
    }
}
