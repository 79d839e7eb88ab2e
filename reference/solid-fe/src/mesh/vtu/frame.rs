//! Frames of a run: several bodies in one grid, arrays behind the text; and the collection of such files with their times.

use super::{Field, Values, VtuError, escaped};
use crate::Vec3;
use gearbench_involute::geometry::swept::Cells;
use std::io::{self, Write};

/// Writes bodies, one after the other, as one grid at a time of a run [s] with fields at all their nodes. Arrays are
/// appended in binary form, so that files stay small.
pub fn write_frame(
    out: &mut dyn Write,
    time: f64,
    bodies: &[(&[Vec3], &Cells)],
    at_nodes: &[Field<'_>],
) -> Result<(), VtuError> {
    let points: usize = bodies.iter().map(|(nodes, _)| nodes.len()).sum();
    let count: usize = bodies.iter().map(|(_, cells)| cells.kinds.len()).sum();
    for f in at_nodes {
        if f.values.len() != points {
            return Err(VtuError::Length {
                name: f.name.to_owned(),
                found: f.values.len(),
                expected: points,
                what: "nodes",
            });
        }
    }
    let mut appended = AppendedArrays::default();
    let time = appended.array("TimeValue", "Float64", 1, [time.to_le_bytes()]);
    let time = time.replace("NumberOfComponents=\"1\"", "NumberOfTuples=\"1\"");
    let heads: Vec<String> = at_nodes.iter().map(|f| appended.field(f)).collect();
    let nodes: Vec<Vec3> = bodies
        .iter()
        .flat_map(|(nodes, _)| *nodes)
        .copied()
        .collect();
    let nodes = appended.field(&Field {
        name: "Points",
        values: Values::Vectors(&nodes),
    });
    // Nodes and ends of cells go on from body to body.
    let mut shifted: [Vec<i32>; 2] = Default::default();
    let mut before = [0; 2];
    for (nodes, cells) in bodies {
        shifted[0].extend(cells.nodes.iter().map(|n| (n + before[0]) as i32));
        shifted[1].extend(cells.ends.iter().map(|n| (n + before[1]) as i32));
        before = [
            before[0] + nodes.len() as u32,
            before[1] + cells.nodes.len() as u32,
        ];
    }
    let [nodes_of, ends] = [("connectivity", &shifted[0]), ("offsets", &shifted[1])]
        .map(|(name, x)| appended.array(name, "Int32", 1, x.iter().map(|x| x.to_le_bytes())));
    let kinds = bodies.iter().flat_map(|(_, cells)| &cells.kinds);
    let kinds = appended.array("types", "UInt8", 1, kinds.map(|k| [*k]));
    writeln!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <UnstructuredGrid>\n<FieldData>\n{time}</FieldData>\n\
         <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{count}\">\n<PointData>\n{}</PointData>\n\
         <Points>\n{nodes}</Points>\n<Cells>\n{nodes_of}{ends}{kinds}</Cells>\n</Piece>\n</UnstructuredGrid>\n\
         <AppendedData encoding=\"raw\">",
        heads.concat()
    )?;
    out.write_all(b"_")?;
    out.write_all(&appended.bytes)?;
    writeln!(out, "\n</AppendedData>\n</VTKFile>")?;
    Ok(())
}

/// Writes a collection for ParaView (`.pvd`): files with their times [s].
pub fn write_collection(out: &mut dyn Write, frames: &[(f64, String)]) -> io::Result<()> {
    writeln!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>"
    )?;
    for (time, file) in frames {
        writeln!(
            out,
            "<DataSet timestep=\"{time:e}\" group=\"\" part=\"0\" file=\"{}\"/>",
            escaped(file)
        )?;
    }
    writeln!(out, "</Collection>\n</VTKFile>")
}

/// Arrays behind the text of a file.
#[derive(Default)]
struct AppendedArrays {
    bytes: Vec<u8>,
}

impl AppendedArrays {
    /// Adds an array; its element in the text.
    fn array<const N: usize>(
        &mut self,
        name: &str,
        kind: &str,
        components: usize,
        values: impl IntoIterator<Item = [u8; N]>,
    ) -> String {
        let offset = self.bytes.len();
        self.bytes.extend([0; 8]);
        self.bytes.extend(values.into_iter().flatten());
        let length = (self.bytes.len() - offset - 8) as u64;
        self.bytes[offset..offset + 8].copy_from_slice(&length.to_le_bytes());
        format!(
            "<DataArray type=\"{kind}\" Name=\"{}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>\n",
            escaped(name)
        )
    }

    fn field(&mut self, f: &Field<'_>) -> String {
        match f.values {
            Values::Scalars(v) => {
                self.array(f.name, "Float64", 1, v.iter().map(|x| x.to_le_bytes()))
            }
            Values::Integers(v) => {
                self.array(f.name, "Int32", 1, v.iter().map(|x| x.to_le_bytes()))
            }
            Values::Vectors(v) => {
                let bytes = v.iter().flat_map(|x| [x.x, x.y, x.z].map(f64::to_le_bytes));
                self.array(f.name, "Float64", 3, bytes)
            }
        }
    }
}
