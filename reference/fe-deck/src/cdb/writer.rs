//! A mesh as an archive of Ansys (`.cdb`): coded blocks of nodes and elements, components, material, commands.
//!
//! Elements of decks become SOLID185, 186 and 187 with the integration that is nearest to theirs:
//!
//! | deck | Ansys | KEYOPT(2) |
//! |---|---|---|
//! | C3D8, C3D6, C3D4 | SOLID185 | 0, full integration with mean volume strain |
//! | C3D8I | SOLID185 | 3, simplified enhanced strain: nine inner coordinates, as incompatible modes |
//! | C3D20, C3D15 | SOLID186 | 1, full integration |
//! | C3D20R | SOLID186 | 0, reduced integration |
//! | C3D10 | SOLID187 | - |

use crate::writer::{WriteError, number};
use gearbench_solid_fe::Material;
use gearbench_solid_fe::mesh::{ElementKind, Mesh};
use std::io::{self, Write};

/// Type of Ansys, KEYOPT(2), and for each of its nodes the node of the deck: degenerate shapes repeat some.
pub(crate) fn kind(kind: ElementKind) -> (u32, u32, &'static [usize]) {
    const BRICK: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7];
    const WEDGE: &[usize] = &[0, 1, 2, 2, 3, 4, 5, 5];
    const TETRAHEDRON: &[usize] = &[0, 1, 2, 2, 3, 3, 3, 3];
    const BRICK20: &[usize] = &[
        0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19,
    ];
    const WEDGE15: &[usize] = &[
        0, 1, 2, 2, 3, 4, 5, 5, 6, 7, 2, 8, 9, 10, 5, 11, 12, 13, 14, 14,
    ];
    const TETRAHEDRON10: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9];
    match kind {
        ElementKind::C3D8 => (185, 0, BRICK),
        ElementKind::C3D8I => (185, 3, BRICK),
        ElementKind::C3D6 => (185, 0, WEDGE),
        ElementKind::C3D4 => (185, 0, TETRAHEDRON),
        ElementKind::C3D20 => (186, 1, BRICK20),
        ElementKind::C3D20R => (186, 0, BRICK20),
        ElementKind::C3D15 => (186, 1, WEDGE15),
        ElementKind::C3D10 => (187, 0, TETRAHEDRON10),
    }
}

/// A number of 25 characters with 17 digits, as the format `e25.16e3` of Fortran reads it.
fn fixed(x: f64, node: usize) -> Result<String, WriteError> {
    if !x.is_finite() {
        return Err(WriteError::NotFinite {
            what: format!("a position of node {node}"),
            value: x,
        });
    }
    let text = format!("{x:.16e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let sign = if exponent < 0 { '-' } else { '+' };
    let text = format!("{digits}E{sign}{:03}", exponent.abs());
    Ok(format!("{text:>25}"))
}

/// Writes a mesh as an archive: body and node sets, as components in upper case.
///
/// # Errors
/// [`WriteError`] for numbers that are not finite, and what the system says.
pub fn write(
    out: &mut dyn Write,
    mesh: &Mesh,
    material: &Material,
    title: &str,
) -> Result<(), WriteError> {
    body(out, mesh, material, title)?;
    for (name, nodes) in &mesh.node_sets {
        component(out, &name.to_uppercase(), nodes)?;
    }
    writeln!(out, "FINISH")?;
    Ok(())
}

/// Writes the beginning of an archive: title, element types, material, nodes and elements. Components may follow, and
/// `FINISH` ends it.
///
/// # Errors
/// [`WriteError`] for numbers that are not finite, and what the system says.
pub fn body(
    out: &mut dyn Write,
    mesh: &Mesh,
    material: &Material,
    title: &str,
) -> Result<(), WriteError> {
    for line in title.lines() {
        writeln!(out, "! {line}")?;
    }
    writeln!(out, "/PREP7")?;
    for (i, block) in mesh.blocks.iter().enumerate() {
        let (number, option, _) = kind(block.kind);
        writeln!(out, "ET,{0},{number}\nKEYOPT,{0},2,{option}", i + 1)?;
    }
    writeln!(
        out,
        "MP,EX,1,{}\nMP,PRXY,1,{}\nMP,DENS,1,{}",
        number(material.young, "Young's modulus")?,
        number(material.poisson, "Poisson's ratio")?,
        number(material.density, "density")?
    )?;
    let nodes = mesh.nodes.len();
    writeln!(out, "NBLOCK,6,SOLID,{nodes},{nodes}\n(3i9,6e25.16e3)")?;
    for (label, x) in (1..).zip(&mesh.nodes) {
        let [a, b, c] = [x.x, x.y, x.z].map(|x| fixed(x, label));
        writeln!(out, "{label:9}{0:9}{0:9}{1}{2}{3}", 0, a?, b?, c?)?;
    }
    writeln!(out, "N,R5.3,LOC,       -1,")?;
    let elements = mesh.element_count();
    writeln!(out, "EBLOCK,19,SOLID,{elements},{elements}\n(19i9)")?;
    let mut labels = 1..;
    for (i, block) in mesh.blocks.iter().enumerate() {
        let (_, _, order) = kind(block.kind);
        for (element, label) in block.elements().zip(&mut labels) {
            // Material, type, constants, section, axes, birth, solid, shape, nodes, unused, label.
            for value in [
                1,
                i as u32 + 1,
                1,
                1,
                0,
                0,
                0,
                0,
                order.len() as u32,
                0,
                label,
            ] {
                write!(out, "{value:9}")?;
            }
            for (at, node) in order.iter().enumerate() {
                if at == 8 {
                    writeln!(out)?;
                }
                write!(out, "{:9}", element[*node] + 1)?;
            }
            writeln!(out)?;
        }
    }
    writeln!(out, "{:9}", -1)?;
    Ok(())
}

/// Writes a component of nodes, numbered from 0.
///
/// # Errors
/// An error of the operating system while the text is written.
pub fn component(out: &mut dyn Write, name: &str, nodes: &[u32]) -> io::Result<()> {
    writeln!(out, "CMBLOCK,{name},NODE,{}\n(8i10)", nodes.len())?;
    for line in nodes.chunks(8) {
        for node in line {
            write!(out, "{:10}", node + 1)?;
        }
        writeln!(out)?;
    }
    Ok(())
}
