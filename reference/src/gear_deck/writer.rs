//! Writer of gears as decks: one gear for CalculiX, Abaqus or Ansys, or an impact of two for CalculiX.
//!
//! Output is a function of the input alone; [`gearbench_fe_deck::writer`] prints the parts, so that
//! [`read_str`](crate::deck::read_str) returns the mesh bit for bit.

mod from_deck;
mod impact;
mod modal;

pub use impact::{Hub, Impact, ImpactGear, write_impact};
pub use modal::{ModalProgram, ModalRun};

use super::gears::surface_faces;
use crate::deck::archive;
use crate::deck::writer::{self, FirstLabels, heading, materials};
use crate::gear_mesh::{GearMesh, flank_set, letter};
use crate::mesh::Face;
use gearbench_models::Vec3;
use gearbench_models::geometry::FlankGrid;
use gearbench_models::stiffness::Material;
use std::collections::HashMap;
use std::io::{self, Write};

/// Why a gear or an impact cannot be written.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum WriteError {
    #[error(transparent)]
    Deck(#[from] writer::WriteError),
    #[error(
        "flank {flank}: row {row}, column {column} of its grid is not a face at the surface of the mesh"
    )]
    NoFace {
        flank: String,
        row: usize,
        column: usize,
    },
    #[error("gear {gear} has no flank {flank}; it has {known}")]
    NoFlank {
        gear: usize,
        flank: String,
        known: String,
    },
    #[error("{what} is {value}, but it has to be {range}")]
    Range {
        what: &'static str,
        value: f64,
        range: &'static str,
    },
}

impl From<io::Error> for WriteError {
    fn from(e: io::Error) -> Self {
        WriteError::Deck(e.into())
    }
}

/// Additional data of a deck of one gear.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GearDeck {
    /// Text under `*HEADING`.
    pub title: String,
    /// Steps that write matrices and modes; `None` writes the body alone.
    pub modal: Option<ModalRun>,
}

/// Writes a gear in its own frame as a deck: nodes, elements (set `gear`), node sets `bore` and `flank_1l`, ...,
/// surfaces `sflank_1l`, ..., material and section; for Ansys nodes, elements, components of nodes and material.
pub fn write(
    out: &mut dyn Write,
    gear: &GearMesh,
    material: &Material,
    options: &GearDeck,
) -> Result<(), WriteError> {
    if let Some(run) = options
        .modal
        .as_ref()
        .filter(|r| r.program == ModalProgram::Ansys)
    {
        return write_archive(out, gear, material, &options.title, run);
    }
    heading(out, &options.title)?;
    let gear = NumberedGear {
        gear,
        suffix: "",
        labels: FirstLabels::default(),
    };
    gear.mesh(out, &gear.gear.mesh.nodes)?;
    materials(out, &[*material], &["gear"])?;
    if let Some(run) = &options.modal {
        run.write(out)?;
    }
    Ok(())
}

/// Writes a gear and its modal analysis as an archive of Ansys.
fn write_archive(
    out: &mut dyn Write,
    gear: &GearMesh,
    material: &Material,
    title: &str,
    run: &ModalRun,
) -> Result<(), WriteError> {
    archive::body(out, &gear.mesh, material, title)?;
    archive::component(out, "BORE", &gear.bore)?;
    for f in &gear.flanks {
        let name = flank_set(f.tooth, f.side);
        let named = gear.mesh.node_sets.get(&name);
        archive::component(out, &name.to_uppercase(), named.unwrap_or(&f.nodes))?;
    }
    writeln!(out, "FINISH")?;
    run.write(out)?;
    Ok(())
}

/// A gear with its labels and the number in its names.
struct NumberedGear<'a> {
    gear: &'a GearMesh,
    suffix: &'a str,
    labels: FirstLabels,
}

impl NumberedGear<'_> {
    /// Writes the mesh with its nodes at given positions, its bore and its flanks.
    fn mesh(&self, out: &mut dyn Write, nodes: &[Vec3]) -> Result<(), WriteError> {
        let (mesh, suffix, labels) = (&self.gear.mesh, self.suffix, self.labels);
        labels.nodes(out, &format!("nall{suffix}"), nodes)?;
        labels.elements(out, &format!("gear{suffix}"), mesh)?;
        labels.node_set(out, &format!("bore{suffix}"), &self.gear.bore)?;
        let surface = surface_faces(mesh);
        for f in &self.gear.flanks {
            let name = format!("flank{suffix}_{}{}", f.tooth + 1, letter(f.side));
            // The named set has the mid-side nodes too.
            let named = mesh.node_sets.get(&flank_set(f.tooth, f.side));
            labels.node_set(out, &name, named.unwrap_or(&f.nodes))?;
            let faces = faces_of(f, &surface, &name)?;
            labels.surface(out, &format!("s{name}"), &faces)?;
        }
        Ok(())
    }
}

/// Returns the faces of the grid of a flank, row by row.
fn faces_of(
    f: &FlankGrid,
    surface: &HashMap<[u32; 4], Face>,
    name: &str,
) -> Result<Vec<Face>, WriteError> {
    let mut faces = Vec::with_capacity((f.rows - 1) * (f.columns - 1));
    for row in 1..f.rows {
        for column in 1..f.columns {
            let at = |r: usize, c: usize| f.nodes[r * f.columns + c];
            let mut corners = [
                at(row - 1, column - 1),
                at(row, column - 1),
                at(row, column),
                at(row - 1, column),
            ];
            corners.sort_unstable();
            faces.push(*surface.get(&corners).ok_or_else(|| WriteError::NoFace {
                flank: name.to_owned(),
                row: row - 1,
                column: column - 1,
            })?);
        }
    }
    Ok(faces)
}

#[cfg(test)]
mod tests;
