//! Abaqus and CalculiX decks (`.inp`), meshes of Gmsh (`.msh`) and archives of Ansys (`.cdb`): reading, checking, writing.
//!
//! | part | owns |
//! |---|---|
//! | [`read`], [`read_str`] | a deck as it stands: [`Deck`]; what is not known is declined with its line |
//! | [`Deck::mesh`] | the whole deck as one mesh with its sets |
//! | [`Units`] | the system of units, determined from materials or size, and the conversion to SI units |
//! | [`writer`] | a mesh as a deck, whole or in parts |
//! | [`archive`] | a mesh as an archive of Ansys, whole or in parts |
//! | [`Refusal`] | why a file is refused: position, expected and actual content, remedy |
//! | [`files`] | regular files of a bounded size |
//!
//! The reader supports the parts of a deck that define a body (solid elements, parts and their instances, sets,
//! surfaces, isotropic materials) and those of an impact: rigid bodies, linear penalty contact, initial
//! velocities, static, dynamic and frequency steps. Keywords that do not change a body are ignored and counted; those
//! that would are declined with their line ([`Deck::told`]). The syntax follows the manuals of Abaqus (keywords) and
//! CalculiX CrunchiX 2.20 (input deck format). The crate has no knowledge of gears.
//!
//! # Example
//!
//! A box with a set is written and read again:
//!
//! ```
//! use gearbench_fe_deck::{read_str, writer};
//! use gearbench_solid_fe::Material;
//! use gearbench_solid_fe::mesh::{ElementKind, brick};
//!
//! let mut mesh = brick(ElementKind::C3D20, [4, 2, 1], [0.2, 0.1, 0.05]);
//! let end = (0..).zip(&mesh.nodes).filter(|(_, x)| x.x == 0.0).map(|(n, _)| n).collect();
//! mesh.node_sets.insert("end".to_owned(), end);
//!
//! let mut text = Vec::new();
//! writer::write(&mut text, &mesh, &Material::STEEL, "a box")?;
//!
//! let no_includes = &mut |name: &str| Err(std::io::Error::other(name.to_owned()));
//! let deck = read_str("box.inp", std::str::from_utf8(&text)?, no_includes)?;
//! assert_eq!(deck.mesh().nodes, mesh.nodes);
//! assert_eq!(deck.mesh().blocks, mesh.blocks);
//! assert_eq!(deck.node_sets["end"], mesh.node_sets["end"]);
//! assert_eq!(deck.material("material1"), Some(Material::STEEL));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cdb;
mod data;
mod error;
pub mod files;
mod lexer;
mod msh;
mod reader;
mod refusal;
#[cfg(test)]
mod test_support;
mod units;
pub mod writer;

pub use cdb::writer as archive;
pub use data::{
    Boundary, ContactKind, ContactPair, Deck, DeckMaterial, ElementBlock, InitialVelocity,
    Interaction, Label, Labels, NonlinearProperty, Procedure, RigidBody, Section, Step, Target,
};
pub use error::{DeckError, DeckErrorKind, Place, quote};
pub use lexer::{MAX_DECK_BYTES, MAX_INCLUDE_DEPTH, MAX_INCLUDES, MAX_LINE_BYTES, Resolver};
pub use refusal::Refusal;
pub use units::Units;

use gearbench_solid_fe::limits::{self, Memory};
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
            let most = (Memory::own().limit() / MEMORY_OVER_TEXT).min(MAX_DECK_BYTES as f64);
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
