//! Abaqus and CalculiX decks (`.inp`): reading, checking, writing.
//!
//! | part | owns |
//! |---|---|
//! | [`read`], [`read_str`] | a deck as it stands: [`Deck`]; what is not known is declined with its line |
//! | [`gears`] | its toothed bodies as [`GearMesh`](crate::mesh::GearMesh), each in its own frame |
//! | [`check_gtm`] | what a deck lacks for the preprocessing of elastic gears |
//! | [`write`](write()), [`write_impact`] | a gear, or two in contact, as a deck that CalculiX runs |
//!
//! The subset is that of gears in contact: hexahedra, sets, surfaces, one isotropic material per gear, rigid
//! bores, linear penalty contact, initial velocities, static, dynamic and frequency steps. Syntax after the
//! manuals of Abaqus (keywords) and CalculiX CrunchiX 2.20 (input deck format).

mod data;
mod error;
mod gears;
mod gtm;
mod lexer;
mod reader;
mod writer;

pub use data::{
    Boundary, ContactKind, ContactPair, Deck, DeckMaterial, ElementBlock, InitialVelocity,
    Interaction, Labels, Procedure, RigidBody, Section, Step, Target,
};
pub use error::{DeckError, DeckErrorKind, Place};
pub use gears::{BodyShape, DeckGear, gears, gears_with};
pub use gtm::{Finding, GtmRequirement, check_gtm};
pub use lexer::{MAX_DECK_BYTES, MAX_INCLUDE_DEPTH, Resolver};

pub use writer::{GearDeck, Hub, Impact, ImpactGear, WriteError, write, write_impact};

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Reads a deck from a file, `.inp` or gzip `.inp.gz`; includes count from the folder of the including file.
pub fn read(path: impl AsRef<Path>) -> Result<Deck, DeckError> {
    let name = path.as_ref().to_string_lossy().into_owned();
    let text = text_of(&name).map_err(|e| unreadable(&name, "a readable deck", &e))?;
    read_str(&name, &text, &mut text_of)
}

/// Reads a deck from its text. `resolver` is asked for the text of included files, by their names joined with
/// the folder of the including file's name.
pub fn read_str(name: &str, text: &str, resolver: &mut Resolver<'_>) -> Result<Deck, DeckError> {
    reader::read(name, text, resolver)
}

/// Reads an embedded deck, gzip or not; it may not include files.
pub fn read_bytes(name: &str, bytes: &[u8]) -> Result<Deck, DeckError> {
    let text = decode(bytes).map_err(|e| unreadable(name, "a deck as text or gzip", &e))?;
    read_str(name, &text, &mut |_| {
        Err(io::Error::other("an embedded deck includes no files"))
    })
}

fn unreadable(name: &str, expected: &str, e: &io::Error) -> DeckError {
    DeckError::new(DeckErrorKind::Io, "", expected, e.to_string(), "").at(name, 0)
}

fn text_of(name: &str) -> io::Result<String> {
    let mut bytes = Vec::new();
    File::open(name)?
        .take(MAX_DECK_BYTES as u64 + 1)
        .read_to_end(&mut bytes)?;
    decode(&bytes)
}

/// Text from bytes, unpacked when they are gzip. Titles in other encodings than UTF-8 are no reason to decline.
fn decode(bytes: &[u8]) -> io::Result<String> {
    let mut unpacked = Vec::new();
    let bytes = if bytes.starts_with(&[0x1f, 0x8b]) {
        flate2::read::MultiGzDecoder::new(bytes)
            .take(MAX_DECK_BYTES as u64 + 1)
            .read_to_end(&mut unpacked)?;
        &unpacked
    } else {
        bytes
    };
    if bytes.len() > MAX_DECK_BYTES {
        return Err(io::Error::other(format!(
            "more than {MAX_DECK_BYTES} bytes"
        )));
    }
    Ok(String::from_utf8_lossy(bytes).into_owned())
}
