//! Stiffness and mass matrices and mode shapes that other programs wrote, for the reduction of their meshes.
//!
//! | part | owns |
//! |---|---|
//! | [`read`], [`read_shapes`] | files by the endings of their names, and the files that belong to them |
//! | `calculix`, `abaqus`, `harwell_boeing`, `arrays` | matrices of CalculiX, Abaqus, Ansys, and of any program by numpy |
//! | `shapes` | mode shapes that CalculiX and Abaqus print |
//! | `entries` | a symmetric matrix from a triangle or from both |
//! | `on_mesh` | the matrices over the nodes of a gear in its own frame, in SI units, with the checks of an unconstrained body |
//!
//! The matrices are those of the whole unconstrained body: the reduction ties the bore to the hub itself, as it does
//! with its own matrices. `docs/modal.md` describes what each program must be told.

mod abaqus;
mod arrays;
mod calculix;
mod entries;
mod error;
mod harwell_boeing;
mod lines;
mod on_mesh;
mod shapes;
#[cfg(test)]
mod tests;

pub use entries::SymmetricEntries;
pub use error::{MatrixError, MatrixErrorKind};
pub use on_mesh::{ForeignBody, MeshFrame};

use crate::deck::MAX_DECK_BYTES;
use crate::files;
use entries::Listed;
use error::refused;
use faer::Mat;
use indexmap::IndexSet;
use std::io;
use std::path::Path;

/// A row of the matrices: the displacement of a node in a direction, 1 to 3 along the axes of the file, 4 to 6 rotations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Coordinate {
    /// Label of the node in the deck.
    pub node: u32,
    /// Direction, from 1.
    pub direction: u8,
}

/// Stiffness and mass over the same coordinates, in the units of their program.
#[derive(Clone, Debug, PartialEq)]
pub struct SystemMatrices {
    /// Files from which they were read.
    pub files: Vec<String>,
    /// Coordinate of each row; `None` for three rows per node in ascending order of the labels.
    pub coordinates: Option<Vec<Coordinate>>,
    /// Number of rows.
    pub size: usize,
    /// Stiffness matrix.
    pub stiffness: SymmetricEntries,
    /// Mass matrix.
    pub mass: SymmetricEntries,
}

/// Mode shapes over coordinates, of any scale.
#[derive(Clone, Debug)]
pub struct Shapes {
    /// File from which they were read.
    pub file: String,
    /// Coordinate of each row.
    pub coordinates: Vec<Coordinate>,
    /// Shapes, coordinates x modes.
    pub values: Mat<f64>,
    /// Natural frequencies that the file states [Hz of its unit of time]; NaN where it states none.
    pub frequencies: Vec<f64>,
}

/// Returns the bytes of a file by its name.
pub type FileReader<'a> = dyn FnMut(&str) -> io::Result<Vec<u8>> + 'a;

/// Bytes of a file on disk.
///
/// # Errors
/// Errors of the system; files that are no regular ones or too large are refused.
pub fn from_disk(name: &str) -> io::Result<Vec<u8>> {
    files::read(Path::new(name), MAX_DECK_BYTES as u64)
}

/// The name of a file with another part, if it has the one.
fn with(name: &str, part: &str, other: &str) -> Option<String> {
    let lower = name.to_ascii_lowercase();
    let at = lower.rfind(part)?;
    // The case of the name is kept: programs on Linux distinguish it.
    let upper = name[at..at + part.len()]
        .bytes()
        .any(|b| b.is_ascii_uppercase());
    let other = match upper {
        true => other.to_ascii_uppercase(),
        false => other.to_owned(),
    };
    Some(format!(
        "{}{other}{}",
        &name[..at],
        &name[at + part.len()..]
    ))
}

fn ends(name: &str, ending: &str) -> bool {
    name.to_ascii_lowercase().ends_with(ending)
}

fn bytes_of(
    name: &str,
    expected: &str,
    files: &mut FileReader<'_>,
) -> Result<Vec<u8>, MatrixError> {
    files(name).map_err(|e| {
        let help = "give the files as --matrices STIFFNESS,MASS,COORDINATES";
        refused(MatrixErrorKind::Io, name, expected, e.to_string(), help)
    })
}

/// Reads stiffness and mass. `names` are the file of the stiffness, that of the mass and that of the coordinates; those
/// that are left out have the names that the programs give them.
///
/// | stiffness | mass | coordinates |
/// |---|---|---|
/// | `F.sti` | `F.mas` | `F.dof` |
/// | `F_STIF1.mtx` | `F_MASS1.mtx` | in these files |
/// | `F_stiff.hb` | `F_mass.hb` | `F_stiff.mapping` |
/// | `F.npz` | in this file | in this file |
///
/// # Errors
/// A file that cannot be read or has another form, with its line.
pub fn read(names: &[String], files: &mut FileReader<'_>) -> Result<SystemMatrices, MatrixError> {
    let [first, rest @ ..] = names else {
        let help = "for example --matrices gear.sti";
        return Err(refused(
            MatrixErrorKind::Io,
            "",
            "a file of the stiffness",
            "none",
            help,
        ));
    };
    let bytes = bytes_of(first, "a readable file of the stiffness", files)?;
    if ends(first, ".npz") {
        return arrays::matrices(first, &bytes);
    }
    let (mass, map) = match () {
        () if ends(first, ".sti") => (with(first, ".sti", ".mas"), with(first, ".sti", ".dof")),
        () if ends(first, ".mtx") => (with(first, "_stif", "_mass"), None),
        () => {
            let stem = Path::new(first).with_extension("mapping");
            let map = stem.to_string_lossy().into_owned();
            (with(first, "stiff", "mass"), Some(map))
        }
    };
    let Some(mass) = rest.first().cloned().or(mass) else {
        let expected = "the file of the mass";
        let help = "its name does not follow from this one: give --matrices STIFFNESS,MASS";
        return Err(refused(MatrixErrorKind::Io, first, expected, "none", help));
    };
    let mass_bytes = bytes_of(&mass, "a readable file of the mass", files)?;
    let mut all = vec![first.clone(), mass.clone()];
    let each = [(first.as_str(), &bytes), (mass.as_str(), &mass_bytes)];
    let by_nodes = ends(first, ".mtx") && !abaqus::is_numbered(&bytes);
    let mut shared: IndexSet<Coordinate> = IndexSet::new();
    let mut matrix = |(name, bytes): (&str, &Vec<u8>)| -> Result<Listed, MatrixError> {
        match () {
            () if by_nodes => abaqus::matrix(name, bytes, &mut shared),
            () if ends(first, ".mtx") => abaqus::numbered(name, bytes),
            () if ends(first, ".sti") => calculix::triplets(name, bytes),
            () => harwell_boeing::matrix(name, bytes),
        }
    };
    let [stiffness, mass_matrix] = [matrix(each[0])?, matrix(each[1])?];
    let size = stiffness.size().max(mass_matrix.size());
    let coordinates = match rest.get(1).cloned().or(map) {
        _ if by_nodes => Some(shared.into_iter().collect()),
        Some(map) => {
            let found = bytes_of(&map, "a readable file of the coordinates", files)?;
            let coordinates = calculix::coordinates(&map, &found)?;
            if coordinates.len() < size {
                let expected = format!("a coordinate for each of the {size} rows of {first}");
                let found = coordinates.len().to_string();
                return Err(refused(MatrixErrorKind::Syntax, &map, expected, found, ""));
            }
            all.push(map);
            Some(coordinates)
        }
        None => None,
    };
    Ok(SystemMatrices {
        files: all,
        size: coordinates.as_ref().map_or(size, Vec::len),
        coordinates,
        stiffness: stiffness.symmetric(first)?,
        mass: mass_matrix.symmetric(&mass)?,
    })
}

/// Reads mode shapes: `.frd` of CalculiX, `.dat` of CalculiX or Abaqus, `.npz`.
///
/// # Errors
/// A file that cannot be read or has another form, with its line.
pub fn read_shapes(name: &str, files: &mut FileReader<'_>) -> Result<Shapes, MatrixError> {
    let bytes = files(name).map_err(|e| {
        let expected = "a readable file of mode shapes";
        refused(MatrixErrorKind::Io, name, expected, e.to_string(), "")
    })?;
    match () {
        () if ends(name, ".npz") => arrays::shapes(name, &bytes),
        () if ends(name, ".frd") => shapes::frd(name, &bytes),
        () if ends(name, ".dat") => shapes::dat(name, &bytes),
        () => {
            let expected = "a file of mode shapes: .frd, .dat or .npz";
            let help = "docs/modal.md describes the files";
            Err(refused(
                MatrixErrorKind::Io,
                name,
                expected,
                "another ending",
                help,
            ))
        }
    }
}
