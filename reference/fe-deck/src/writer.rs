//! Writer of decks for CalculiX and Abaqus: a whole mesh, or its parts.
//!
//! Output is a function of the input alone. Positions are printed in fixed notation with the shortest digits
//! that give the same bits back (17 at most): [`read_str`](crate::read_str) returns the mesh bit for bit.
//! CalculiX looks at the first 20 characters of a number only; fixed notation loses less than 1e-16 m there,
//! where an exponent cut off would be wrong by orders.

use gearbench_solid_fe::mesh::{Face, Mesh};
use gearbench_solid_fe::{Material, Vec3};
use std::io::{self, Write};

/// Why a deck cannot be written.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum WriteError {
    #[error("cannot write the deck: {0}")]
    Io(#[from] io::Error),
    #[error("{what} is {value}, but a deck needs a finite number")]
    NotFinite { what: String, value: f64 },
}

/// Labels of the first node and of the first element of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FirstLabels {
    /// Label of node 0.
    pub node: u32,
    /// Label of element 0.
    pub element: u32,
}

impl Default for FirstLabels {
    /// Labels from 1.
    fn default() -> Self {
        FirstLabels {
            node: 1,
            element: 1,
        }
    }
}

/// Writes a mesh of one material: nodes (set `nall`), elements (set `eall`), node sets, surfaces, material and section.
///
/// # Errors
/// [`WriteError::NotFinite`], and what the system says.
pub fn write(
    out: &mut dyn Write,
    mesh: &Mesh,
    material: &Material,
    title: &str,
) -> Result<(), WriteError> {
    let labels = FirstLabels::default();
    heading(out, title)?;
    labels.nodes(out, "nall", &mesh.nodes)?;
    labels.elements(out, "eall", mesh)?;
    for (name, nodes) in &mesh.node_sets {
        labels.node_set(out, name, nodes)?;
    }
    for (name, faces) in &mesh.face_sets {
        labels.surface(out, name, faces)?;
    }
    materials(out, &[*material], &["eall"])
}

impl FirstLabels {
    /// Writes nodes in a set.
    ///
    /// # Errors
    /// [`WriteError::NotFinite`], and what the system says.
    pub fn nodes<'a>(
        self,
        out: &mut dyn Write,
        set: &str,
        nodes: impl IntoIterator<Item = &'a Vec3>,
    ) -> Result<(), WriteError> {
        writeln!(out, "*NODE, NSET={set}")?;
        for (label, x) in (self.node..).zip(nodes) {
            let [a, b, c] = [x.x, x.y, x.z].map(|v| position(v, label));
            writeln!(out, "{label}, {}, {}, {}", a?, b?, c?)?;
        }
        Ok(())
    }

    /// Writes the elements of a mesh in a set.
    ///
    /// # Errors
    /// An error of the operating system while the text is written.
    pub fn elements(self, out: &mut dyn Write, set: &str, mesh: &Mesh) -> io::Result<()> {
        let mut labels = self.element..;
        for block in &mesh.blocks {
            let kind = block.kind.name();
            writeln!(out, "*ELEMENT, TYPE={kind}, ELSET={set}")?;
            for (nodes, label) in block.elements().zip(&mut labels) {
                write!(out, "{label}")?;
                for (i, n) in nodes.iter().enumerate() {
                    // A line has at most 16 entries; a comma at its end continues it.
                    let gap = if i == 10 { ",\n" } else { ", " };
                    write!(out, "{gap}{}", n + self.node)?;
                }
                writeln!(out)?;
            }
        }
        Ok(())
    }

    /// Writes a set of nodes, twelve labels in a line.
    ///
    /// # Errors
    /// An error of the operating system while the text is written.
    pub fn node_set(self, out: &mut dyn Write, name: &str, nodes: &[u32]) -> io::Result<()> {
        writeln!(out, "*NSET, NSET={name}")?;
        for line in nodes.chunks(12) {
            let labels: Vec<String> = line.iter().map(|n| (n + self.node).to_string()).collect();
            writeln!(out, "{}", labels.join(", "))?;
        }
        Ok(())
    }

    /// Writes a surface of element faces.
    ///
    /// # Errors
    /// An error of the operating system while the text is written.
    pub fn surface(self, out: &mut dyn Write, name: &str, faces: &[Face]) -> io::Result<()> {
        writeln!(out, "*SURFACE, NAME={name}, TYPE=ELEMENT")?;
        for Face { element, face } in faces {
            writeln!(out, "{}, S{}", element + self.element, face + 1)?;
        }
        Ok(())
    }
}

/// Writes title lines under `*HEADING`, without stars at their beginning, which would make a keyword of them.
///
/// # Errors
/// An error of the operating system while the text is written.
pub fn heading(out: &mut dyn Write, title: &str) -> io::Result<()> {
    writeln!(out, "*HEADING")?;
    for line in title.lines().map(|l| l.trim().trim_start_matches('*')) {
        writeln!(out, "{}", line.trim())?;
    }
    Ok(())
}

/// Writes materials and a section for each of the element sets; equal materials are written once.
///
/// # Errors
/// [`WriteError::NotFinite`], and what the system says.
pub fn materials(out: &mut dyn Write, of: &[Material], sets: &[&str]) -> Result<(), WriteError> {
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

/// Returns a coordinate of a node in fixed notation.
///
/// # Errors
/// [`WriteError::NotFinite`].
pub fn position(x: f64, node: u32) -> Result<String, WriteError> {
    if x.is_finite() && x.abs() < 1e15 {
        // `Display` of Rust never takes an exponent.
        return Ok(format!("{x}"));
    }
    Err(WriteError::NotFinite {
        what: format!("a position of node {node}"),
        value: x,
    })
}

/// Returns a parameter in 20 characters or less.
///
/// # Errors
/// [`WriteError::NotFinite`].
pub fn number(x: f64, what: &str) -> Result<String, WriteError> {
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
mod tests {
    use super::*;
    use crate::test_support::parsed;
    use gearbench_solid_fe::mesh::{ElementKind, brick};

    /// Meshes of every kind come back with their sets, surfaces and material.
    #[test]
    fn meshes_come_back_bit_for_bit() {
        for kind in ElementKind::ALL {
            let mut mesh = brick(kind, [2, 3, 1], [0.3, 0.2, 0.07]);
            mesh.node_sets.insert("some".to_owned(), vec![0, 3, 4]);
            let surface = mesh.boundary();
            mesh.face_sets.insert("surface".to_owned(), surface);
            let mut text = Vec::new();
            write(&mut text, &mesh, &Material::STEEL, "a box\n*of steel").unwrap();
            let deck = parsed("a.inp", std::str::from_utf8(&text).unwrap());
            assert_eq!(deck.heading, ["a box", "of steel"]);
            let again = deck.mesh();
            assert_eq!((&again.nodes, &again.blocks), (&mesh.nodes, &mesh.blocks));
            assert_eq!(again.node_sets["some"], mesh.node_sets["some"], "{kind:?}");
            assert_eq!(again.face_sets, mesh.face_sets, "{kind:?}");
            assert_eq!(deck.material("material1"), Some(Material::STEEL));
        }
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        let mut mesh = brick(ElementKind::C3D8, [1, 1, 1], [1.0; 3]);
        mesh.nodes[2].y = f64::NAN;
        let e = write(&mut Vec::new(), &mesh, &Material::STEEL, "").unwrap_err();
        assert!(e.to_string().contains("position of node 3 is NaN"), "{e}");
    }

    #[test]
    fn numbers_fit_into_twenty_characters() {
        for x in [
            2.1e11,
            -1.234_567_890_123_456_7e-5,
            f64::MIN_POSITIVE,
            -f64::MAX,
            0.0,
        ] {
            let text = number(x, "x").unwrap();
            assert!(text.len() <= 20, "{text}");
            let back: f64 = text.parse().unwrap();
            assert!((back - x).abs() <= 1e-12 * x.abs());
        }
        // CalculiX cuts at 20 characters.
        for x in [0.1 / 3.0, -1e-3 / 7.0, -1e-9 / 3.0, 1.0 / 3.0, 123.456] {
            let text = position(x, 1).unwrap();
            assert_eq!(text.parse::<f64>().unwrap(), x);
            let cut: f64 = text[..text.len().min(20)].parse().unwrap();
            assert!((cut - x).abs() <= 1e-16 * x.abs().max(1.0), "{text}");
        }
    }
}
