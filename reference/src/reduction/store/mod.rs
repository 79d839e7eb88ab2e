//! A [`Basis`] on disk: one `.npz` file, a zip archive of `.npy` arrays that numpy opens by itself.
//!
//! The format is described in `docs/reduction-format.md`, names, shapes, units and signs: [`SCHEMA`] is its version.
//! Numbers are 8 bytes wide, little endian, the last axis fastest, and come back bit by bit. Newer versions are
//! refused; arrays that this version does not know are passed over.
//!
//! Files are not trusted: shapes are compared with each other before memory is allocated, checksums are compared, and
//! invalid numbers are refused with the name of their array ([`StoreError`]).

pub(crate) mod archive;
mod checks;
mod error;
mod fields;
mod inertia;
mod meta;
mod names;
mod npy;
mod out_of_plane;
mod physics;
#[cfg(test)]
pub(super) mod tests;

pub use error::{StoreError, StoreErrorKind};

use super::{Basis, ModeSelection, Request};
use crate::assembly::tie::HubMotion;
use crate::files;
use crate::hash::Hash;
use crate::resources::Resources;
use archive::Reader;
use error::unusable_file;
use gearbench_models::stiffness::Material;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// Version of the format that is written, and the newest that is read.
pub const SCHEMA: u64 = 1;

/// Largest file that is read [bytes].
pub const MAX_FILE_BYTES: u64 = 1 << 34;

/// Which way the hub moves, or would move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Motion {
    /// A gear turns about z.
    Turn,
    /// A translating rack.
    Slide,
}

impl From<HubMotion> for Motion {
    fn from(m: HubMotion) -> Self {
        match m {
            HubMotion::Turn | HubMotion::TurnAbout(_) => Motion::Turn,
            HubMotion::Slide(_) => Motion::Slide,
        }
    }
}

/// Where a basis comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Meta {
    /// Program and version that wrote it.
    pub program: String,
    /// Description of the source of the mesh: a file or a generator.
    pub source: String,
    /// Hash of the mesh: nodes, elements, bore and flanks.
    pub mesh: Hash,
    /// Hash of everything that the basis depends on.
    pub key: Hash,
    /// Which way the hub moves.
    pub motion: Motion,
    /// Material of the gear.
    pub material: Material,
    /// Kinds of the elements, as [`Mesh::kind_names`](crate::mesh::Mesh::kind_names) has them.
    pub element: String,
    /// Teeth of the whole gear.
    pub teeth: u32,
    /// Nodes of the mesh.
    pub nodes: usize,
    /// Elements of the mesh.
    pub elements: usize,
    /// Description of the requested modes.
    pub asked: String,
}

impl Meta {
    /// Returns the metadata of a basis that was computed from this request; `source` describes the source of the mesh.
    pub fn new(request: &Request<'_>, source: &str) -> Self {
        let mesh = &request.mesh.mesh;
        Meta {
            program: concat!("gearbench ", env!("CARGO_PKG_VERSION")).to_owned(),
            source: source.to_owned(),
            mesh: request.mesh_hash(),
            key: request.key(),
            motion: request.mounting.motion.into(),
            material: request.material,
            element: mesh.kind_names(),
            teeth: request.mesh.teeth,
            nodes: mesh.nodes.len(),
            elements: mesh.element_count(),
            asked: match request.wanted {
                ModeSelection::Count(n) => format!("{n} modes"),
                ModeSelection::UpTo(f) => format!("modes up to {f} Hz"),
            },
        }
    }
}

/// A basis as a file has it.
#[derive(Clone, Debug)]
pub struct Stored {
    /// Basis from the file.
    pub basis: Arc<Basis>,
    /// Where it comes from.
    pub meta: Meta,
}

/// Writes a basis to a file, which is whole or not there; returns its size in bytes.
pub fn write(path: &Path, basis: &Basis, meta: &Meta) -> Result<u64, StoreError> {
    let name = path.to_string_lossy();
    if let Some(problem) = checks::problem(basis, meta) {
        return Err(problem.at(&name, 0));
    }
    let part = part_of(path);
    let whole: io::Result<_> = File::create(&part).and_then(|file| {
        let mut out = fields::write(BufWriter::new(file), basis, meta)?;
        out.flush()?;
        out.get_ref().metadata()
    });
    let kept = whole.and_then(|m| fs::rename(&part, path).map(|()| m.len()));
    kept.map_err(|e| {
        let _ = fs::remove_file(&part);
        let help = "choose another name for the output";
        unusable_file(&name, "a place to write to", e.to_string(), help)
    })
}

/// Returns a temporary name next to a file that no other writer uses.
fn part_of(path: &Path) -> PathBuf {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    let mut name = path.as_os_str().to_owned();
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    name.push(format!(".{}-{number}.part", std::process::id()));
    PathBuf::from(name)
}

/// Reads a basis from a file.
pub fn read(path: &Path) -> Result<Stored, StoreError> {
    let name = path.to_string_lossy();
    let fail = |found: String| {
        let help = "`gearbench reduce DECK --out F.npz` makes one";
        unusable_file(&name, "a readable reduction (.npz)", found, help)
    };
    let most = (MAX_FILE_BYTES as f64).min(Resources::own().memory.limit()) as u64;
    let bytes = files::read(path, most).map_err(|e| fail(e.to_string()))?;
    read_bytes(&name, &bytes)
}

/// Reads a basis from a file that is to run in a scene: it has to be that of an elastic body.
///
/// # Errors
/// Those of [`read`], and what no elastic body can be.
pub fn read_body(path: &Path) -> Result<Stored, StoreError> {
    let stored = read(path)?;
    match physics::problem(&stored.basis, &stored.meta) {
        Some(problem) => Err(problem.at(&path.to_string_lossy(), 0)),
        None => Ok(stored),
    }
}

/// Reads a basis from the bytes of a file; `name` is used in refusals.
pub fn read_bytes(name: &str, bytes: &[u8]) -> Result<Stored, StoreError> {
    Reader::new(bytes)
        .and_then(|reader| fields::read(&reader))
        .map_err(|e| e.at(name, 0))
}

/// The bytes of a file; for tests and for writing elsewhere than to a file.
pub fn to_bytes(basis: &Basis, meta: &Meta) -> Result<Vec<u8>, StoreError> {
    if let Some(problem) = checks::problem(basis, meta) {
        return Err(problem);
    }
    fields::write(Vec::new(), basis, meta)
        .map_err(|e| unusable_file("", "an archive in memory", e.to_string(), ""))
}
