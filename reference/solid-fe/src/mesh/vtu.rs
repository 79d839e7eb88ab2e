//! Meshes for ParaView: unstructured grids of VTK in XML (`.vtu`) with arrays inline as base64; [frames](write_frame) of runs
//! have them appended raw.
//!
//! After the VTK file formats (The VTK User's Guide, 11th ed., section 19.3): version 1.0, little endian, every
//! array behind the number of its bytes as `UInt64`. Nodes of quadratic hexahedra have the order of decks.
//! Written here, not by a library: the format is one page, and what exists reads and writes all of VTK.

mod frame;

pub use frame::{write_collection, write_frame};

use super::{ElementKind, Mesh, Shape};
use crate::Vec3;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gearbench_involute::geometry::swept::Cells;
use std::io::{self, Write};

/// VTK's number of a kind of cell.
fn cell_type(kind: ElementKind) -> u8 {
    match (kind.shape(), kind.is_quadratic()) {
        (Shape::Tetrahedron, false) => 10,
        (Shape::Hexahedron, false) => 12,
        (Shape::Wedge, false) => 13,
        (Shape::Tetrahedron, true) => 24,
        (Shape::Hexahedron, true) => 25,
        (Shape::Wedge, true) => 26,
    }
}

/// A linear wedge of VTK has its first triangle the other way round.
const LINEAR_WEDGE: [usize; 6] = [0, 2, 1, 3, 5, 4];

/// Values of a field, one per node or per element.
#[derive(Clone, Copy, Debug)]
pub enum Values<'a> {
    /// Scalar values.
    Scalars(&'a [f64]),
    /// Whole numbers.
    Integers(&'a [i32]),
    /// Vectors, such as displacements.
    Vectors(&'a [Vec3]),
}

impl Values<'_> {
    fn len(self) -> usize {
        match self {
            Values::Scalars(v) => v.len(),
            Values::Integers(v) => v.len(),
            Values::Vectors(v) => v.len(),
        }
    }
}

/// A named field of a file.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// Name of the field in ParaView.
    pub name: &'a str,
    /// Values of the field.
    pub values: Values<'a>,
}

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum VtuError {
    #[error("cannot write the VTU file: {0}")]
    Io(#[from] io::Error),
    #[error("field `{name}` has {found} values; the mesh has {expected} {what}")]
    Length {
        name: String,
        found: usize,
        expected: usize,
        what: &'static str,
    },
}

/// Writes a mesh with fields at its nodes and elements.
pub fn write(
    out: &mut dyn Write,
    mesh: &Mesh,
    at_nodes: &[Field<'_>],
    at_elements: &[Field<'_>],
) -> Result<(), VtuError> {
    let (points, cells) = (mesh.nodes.len(), mesh.element_count());
    for (fields, expected, what) in [
        (at_nodes, points, "nodes"),
        (at_elements, cells, "elements"),
    ] {
        for f in fields {
            if f.values.len() != expected {
                return Err(VtuError::Length {
                    name: f.name.to_owned(),
                    found: f.values.len(),
                    expected,
                    what,
                });
            }
        }
    }
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
    )?;
    writeln!(
        out,
        "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">"
    )?;
    for (tag, fields) in [("PointData", at_nodes), ("CellData", at_elements)] {
        writeln!(out, "<{tag}>")?;
        for f in fields {
            field(out, f)?;
        }
        writeln!(out, "</{tag}>")?;
    }
    writeln!(out, "<Points>")?;
    field(
        out,
        &Field {
            name: "Points",
            values: Values::Vectors(&mesh.nodes),
        },
    )?;
    writeln!(out, "</Points>\n<Cells>")?;
    let elements = || {
        let blocks = mesh.blocks.iter();
        blocks.flat_map(|b| b.elements().map(move |nodes| (b.kind, nodes)))
    };
    let connectivity = elements().flat_map(|(kind, nodes)| {
        (0..nodes.len()).map(move |i| match kind {
            ElementKind::C3D6 => i64::from(nodes[LINEAR_WEDGE[i]]).to_le_bytes(),
            _ => i64::from(nodes[i]).to_le_bytes(),
        })
    });
    array(out, "connectivity", "Int64", 1, connectivity)?;
    let offsets = elements().scan(0, |end, (_, nodes)| {
        *end += nodes.len() as i64;
        Some(end.to_le_bytes())
    });
    array(out, "offsets", "Int64", 1, offsets)?;
    let types = elements().map(|(kind, _)| [cell_type(kind)]);
    array(out, "types", "UInt8", 1, types)?;
    writeln!(out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")?;
    Ok(())
}

/// The elements of a mesh as cells.
pub fn cells(mesh: &Mesh) -> Cells {
    let mut cells = Cells::default();
    for block in &mesh.blocks {
        for nodes in block.elements() {
            let node = |i: usize| match block.kind {
                ElementKind::C3D6 => nodes[LINEAR_WEDGE[i]],
                _ => nodes[i],
            };
            cells.push(cell_type(block.kind), (0..nodes.len()).map(node));
        }
    }
    cells
}

fn escaped(text: &str) -> String {
    (text.replace('&', "&amp;").replace('<', "&lt;")).replace('"', "&quot;")
}

fn field(out: &mut dyn Write, f: &Field<'_>) -> io::Result<()> {
    match f.values {
        Values::Scalars(v) => array(out, f.name, "Float64", 1, v.iter().map(|x| x.to_le_bytes())),
        Values::Integers(v) => array(out, f.name, "Int32", 1, v.iter().map(|x| x.to_le_bytes())),
        Values::Vectors(v) => {
            let bytes = v.iter().flat_map(|x| [x.x, x.y, x.z].map(f64::to_le_bytes));
            array(out, f.name, "Float64", 3, bytes)
        }
    }
}

/// One array: its head, the number of its bytes, its bytes.
fn array<const N: usize>(
    out: &mut dyn Write,
    name: &str,
    kind: &str,
    components: usize,
    values: impl Iterator<Item = [u8; N]>,
) -> io::Result<()> {
    let mut bytes = vec![0; 8];
    bytes.extend(values.flatten());
    let length = (bytes.len() - 8) as u64;
    bytes[..8].copy_from_slice(&length.to_le_bytes());
    let name = escaped(name);
    writeln!(
        out,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">"
    )?;
    out.write_all(STANDARD.encode(&bytes).as_bytes())?;
    writeln!(out, "\n</DataArray>")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{ElementKind, brick};

    /// Bytes of a named array, decoded bit by bit.
    fn read(text: &str, name: &str) -> Vec<u8> {
        let from = text.find(&format!("Name=\"{name}\"")).expect(name);
        let body = text[from..].split_once('>').unwrap().1;
        let body = body.split_once('<').unwrap().0.trim();
        let mut bits = Vec::new();
        for c in body.bytes().filter(|&c| c != b'=') {
            let v = match c {
                b'A'..=b'Z' => c - b'A',
                b'a'..=b'z' => c - b'a' + 26,
                b'0'..=b'9' => c - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                other => panic!("{other} is no digit"),
            };
            bits.extend((0..6).rev().map(|k| v >> k & 1));
        }
        let bytes: Vec<u8> = bits
            .chunks_exact(8)
            .map(|b| b.iter().fold(0, |v, &bit| v << 1 | bit))
            .collect();
        let length = u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
        assert_eq!(bytes.len(), 8 + length, "{name}");
        bytes[8..].to_vec()
    }

    fn floats(bytes: &[u8]) -> Vec<f64> {
        bytes
            .chunks_exact(8)
            .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
            .collect()
    }

    #[test]
    fn what_is_written_reads_back_bit_for_bit() {
        for kind in [ElementKind::C3D8, ElementKind::C3D20] {
            let mesh = brick(kind, [2, 3, 4], [0.03, 0.02, 0.01]);
            let u: Vec<Vec3> = mesh.nodes.iter().map(|x| x * 1e-3).collect();
            let jacobian: Vec<f64> = crate::mesh::element_qualities(&mesh)
                .map(|q| q.scaled_jacobian)
                .collect();
            let numbers: Vec<i32> = (0..mesh.nodes.len() as i32).map(|i| 7 - i).collect();
            let fields = [
                Field {
                    name: "u",
                    values: Values::Vectors(&u),
                },
                Field {
                    name: "numbers",
                    values: Values::Integers(&numbers),
                },
            ];
            let cells = [Field {
                name: "a < \"b\" & c",
                values: Values::Scalars(&jacobian),
            }];
            let mut out = Vec::new();
            write(&mut out, &mesh, &fields, &cells).unwrap();
            let text = String::from_utf8(out).unwrap();
            let flat = |v: &[Vec3]| v.iter().flat_map(|x| [x.x, x.y, x.z]).collect::<Vec<_>>();
            assert_eq!(floats(&read(&text, "Points")), flat(&mesh.nodes));
            assert_eq!(floats(&read(&text, "u")), flat(&u));
            assert_eq!(
                floats(&read(&text, "a &lt; &quot;b&quot; &amp; c")),
                jacobian
            );
            let whole = |name| -> Vec<u32> {
                let bytes = read(&text, name);
                let each = bytes.chunks_exact(8);
                each.map(|b| i64::from_le_bytes(b.try_into().unwrap()) as u32)
                    .collect()
            };
            assert_eq!(whole("connectivity"), mesh.blocks[0].connectivity);
            let n = kind.nodes() as u32;
            let ends: Vec<u32> = (1..=mesh.element_count() as u32).map(|i| i * n).collect();
            assert_eq!(whole("offsets"), ends);
            let types = read(&text, "types");
            assert!(types.len() == mesh.element_count());
            assert!(types.iter().all(|&t| t == if n == 8 { 12 } else { 25 }));
            let read_numbers: Vec<i32> = read(&text, "numbers")
                .chunks_exact(4)
                .map(|b| i32::from_le_bytes(b.try_into().unwrap()))
                .collect();
            assert_eq!(read_numbers, numbers);
        }
    }

    #[test]
    fn cells_of_mixed_kinds_have_their_own_lengths() {
        let mut mesh = Mesh::new(ElementKind::C3D4, vec![Vec3::zeros(); 7], vec![0, 1, 2, 3]);
        crate::mesh::push(&mut mesh.blocks, ElementKind::C3D6, 1..7);
        let mut out = Vec::new();
        write(&mut out, &mesh, &[], &[]).unwrap();
        let text = String::from_utf8(out).unwrap();
        let whole = |name| -> Vec<u64> {
            let bytes = read(&text, name);
            let each = bytes.chunks_exact(8);
            each.map(|b| u64::from_le_bytes(b.try_into().unwrap()))
                .collect()
        };
        assert_eq!(whole("connectivity"), [0, 1, 2, 3, 1, 3, 2, 4, 6, 5]);
        assert_eq!(whole("offsets"), [4, 10]);
        assert_eq!(read(&text, "types"), [10, 13]);
    }

    #[test]
    fn fields_of_another_length_are_refused() {
        let mesh = Mesh::new(ElementKind::C3D8, vec![], vec![]);
        let mut out = Vec::new();
        let field = Field {
            name: "u",
            values: Values::Scalars(&[1.0]),
        };
        let e = write(&mut out, &mesh, &[field], &[])
            .unwrap_err()
            .to_string();
        assert!(e.contains("`u`") && e.contains("0 nodes"), "{e}");
        assert!(out.is_empty());
    }
}
