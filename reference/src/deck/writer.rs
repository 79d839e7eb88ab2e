//! Writer of decks: one gear for CalculiX, Abaqus or Ansys, or an impact of two for CalculiX.
//!
//! Output is a function of the input alone. Positions are printed in fixed notation with the shortest digits
//! that give the same bits back (17 at most): [`read_str`](super::read_str) returns the mesh bit for bit.
//! CalculiX looks at the first 20 characters of a number only; fixed notation loses less than 1e-16 m there,
//! where an exponent cut off would be wrong by orders.

mod apdl;
mod from_deck;
mod impact;
mod modal;

pub(super) use apdl::kind as ansys_kind;
pub use impact::{Hub, Impact, ImpactGear, write_impact};
pub use modal::{ModalProgram, ModalRun};

use super::gears::surface_faces;
use crate::gear_mesh::{GearMesh, letter};
use crate::mesh::Face;
use gearbench_models::Vec3;
use gearbench_models::stiffness::Material;
use std::io::{self, Write};

/// Why a deck cannot be written.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum WriteError {
    #[error("cannot write the deck: {0}")]
    Io(#[from] io::Error),
    #[error("{what} is {value}, but a deck needs a finite number")]
    NotFinite { what: String, value: f64 },
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
        return apdl::write(out, gear, material, &options.title, run);
    }
    heading(out, &options.title)?;
    let gear = NumberedGear {
        gear,
        suffix: "",
        first_node: 1,
        first_element: 1,
    };
    gear.mesh(out, &|x| x)?;
    materials(out, &[*material], &["gear"])?;
    if let Some(run) = &options.modal {
        run.write(out)?;
    }
    Ok(())
}

/// A gear with its labels and the number in its names.
struct NumberedGear<'a> {
    gear: &'a GearMesh,
    suffix: &'a str,
    first_node: u32,
    first_element: u32,
}

impl NumberedGear<'_> {
    fn mesh(&self, out: &mut dyn Write, place: &dyn Fn(Vec3) -> Vec3) -> Result<(), WriteError> {
        let (mesh, suffix) = (&self.gear.mesh, self.suffix);
        writeln!(out, "*NODE, NSET=nall{suffix}")?;
        for (label, &x) in (self.first_node..).zip(&mesh.nodes) {
            let x = place(x);
            let [a, b, c] = [x.x, x.y, x.z].map(|v| position(v, label));
            writeln!(out, "{label}, {}, {}, {}", a?, b?, c?)?;
        }
        let mut labels = self.first_element..;
        for block in &mesh.blocks {
            let kind = block.kind.name();
            writeln!(out, "*ELEMENT, TYPE={kind}, ELSET=gear{suffix}")?;
            for (nodes, label) in block.elements().zip(&mut labels) {
                write!(out, "{label}")?;
                for (i, n) in nodes.iter().enumerate() {
                    // A line has at most 16 entries; a comma at its end continues it.
                    let gap = if i == 10 { ",\n" } else { ", " };
                    write!(out, "{gap}{}", n + self.first_node)?;
                }
                writeln!(out)?;
            }
        }
        writeln!(out, "*NSET, NSET=bore{suffix}")?;
        self.list(out, &self.gear.bore)?;
        let faces = surface_faces(mesh);
        for f in &self.gear.flanks {
            let flank = format!("{}{}", f.tooth + 1, letter(f.side));
            let name = format!("flank{suffix}_{flank}");
            writeln!(out, "*NSET, NSET={name}")?;
            // The named set has the mid-side nodes too.
            let named = mesh.node_sets.get(&format!("flank_{flank}"));
            self.list(out, named.unwrap_or(&f.nodes))?;
            writeln!(out, "*SURFACE, NAME=s{name}, TYPE=ELEMENT")?;
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
                    let Some(Face { element, face }) = faces.get(&corners) else {
                        return Err(WriteError::NoFace {
                            flank: name,
                            row: row - 1,
                            column: column - 1,
                        });
                    };
                    writeln!(out, "{}, S{}", element + self.first_element, face + 1)?;
                }
            }
        }
        Ok(())
    }

    /// Labels of nodes, twelve in a line.
    fn list(&self, out: &mut dyn Write, nodes: &[u32]) -> io::Result<()> {
        for line in nodes.chunks(12) {
            let labels: Vec<String> = line
                .iter()
                .map(|n| (n + self.first_node).to_string())
                .collect();
            writeln!(out, "{}", labels.join(", "))?;
        }
        Ok(())
    }
}

/// Title lines; a line that starts with a star would be a keyword.
fn heading(out: &mut dyn Write, title: &str) -> io::Result<()> {
    writeln!(out, "*HEADING")?;
    for line in title.lines().map(|l| l.trim().trim_start_matches('*')) {
        writeln!(out, "{}", line.trim())?;
    }
    Ok(())
}

/// Materials and sections; equal materials are written once.
fn materials(out: &mut dyn Write, of: &[Material], sets: &[&str]) -> Result<(), WriteError> {
    let name = |i: usize| {
        let first = of.iter().position(|m| *m == of[i]).unwrap_or(i);
        format!("MATERIAL{}", first + 1)
    };
    for (i, m) in of.iter().enumerate() {
        if of[..i].contains(m) {
            continue;
        }
        let young = number(m.young, "Young's modulus")?;
        let poisson = number(m.poisson, "Poisson's ratio")?;
        let density = number(m.density, "density")?;
        writeln!(out, "*MATERIAL, NAME={}", name(i))?;
        writeln!(out, "*ELASTIC\n{young}, {poisson}\n*DENSITY\n{density}")?;
    }
    for (i, set) in sets.iter().enumerate() {
        writeln!(out, "*SOLID SECTION, ELSET={set}, MATERIAL={}", name(i))?;
    }
    Ok(())
}

/// A position in fixed notation.
fn position(x: f64, node: u32) -> Result<String, WriteError> {
    if x.is_finite() && x.abs() < 1e15 {
        // `Display` of Rust never takes an exponent.
        return Ok(format!("{x}"));
    }
    Err(WriteError::NotFinite {
        what: format!("a position of node {node}"),
        value: x,
    })
}

/// A parameter in 20 characters or less.
fn number(x: f64, what: &str) -> Result<String, WriteError> {
    if !x.is_finite() {
        return Err(WriteError::NotFinite {
            what: what.to_owned(),
            value: x,
        });
    }
    let shortest = format!("{x:e}");
    Ok(match shortest.len() <= 20 {
        true => shortest,
        false => format!("{x:.12e}"),
    })
}

#[cfg(test)]
mod tests;
