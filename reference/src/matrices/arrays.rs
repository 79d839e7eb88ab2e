//! Matrices and mode shapes as arrays of numpy (`.npz`), from whatever program; `docs/modal.md` lists the names.

use super::entries::Listed;
use super::error::{MatrixError, MatrixErrorKind, refused};
use super::{Coordinate, Shapes, SystemMatrices};
use crate::reduction::store::StoreError;
use crate::reduction::store::archive::{Axis, Reader};
use faer::Mat;

/// Help for an array that does not fit.
const HELP: &str = "docs/modal.md lists the arrays";

fn of_store(name: &str, e: StoreError) -> MatrixError {
    let array = e.context;
    let expected = match array.is_empty() {
        true => e.expected.into_string(),
        false => format!("{} of array {array}", e.expected),
    };
    refused(MatrixErrorKind::Syntax, name, expected, e.found, HELP)
}

/// An open archive.
struct Arrays<'a> {
    name: &'a str,
    reader: Reader<'a>,
}

impl<'a> Arrays<'a> {
    fn open(name: &'a str, bytes: &'a [u8]) -> Result<Self, MatrixError> {
        let reader = Reader::new(bytes).map_err(|_| {
            let found = format!("{} bytes that are none", bytes.len());
            refused(
                MatrixErrorKind::Syntax,
                name,
                "a zip archive of arrays (.npz)",
                found,
                HELP,
            )
        })?;
        Ok(Arrays { name, reader })
    }

    fn whole(&self, array: &str, axis: Axis) -> Result<Vec<i64>, MatrixError> {
        let found = self.reader.i64s(array, axis);
        found.map_err(|e| of_store(self.name, e))
    }

    fn coordinates(&self) -> Result<Vec<Coordinate>, MatrixError> {
        let nodes = self.whole("coordinate_node", Axis::Any("coordinates"))?;
        let directions = self.whole("coordinate_direction", Axis::Is(nodes.len()))?;
        let pairs = nodes.into_iter().zip(directions);
        pairs
            .map(|(node, direction)| match (u32::try_from(node), direction) {
                (Ok(node), 1..=6) => Ok(Coordinate {
                    node,
                    direction: direction as u8,
                }),
                _ => {
                    let found = format!("node {node}, direction {direction}");
                    let expected = "labels of nodes and directions 1 to 6";
                    Err(refused(
                        MatrixErrorKind::Syntax,
                        self.name,
                        expected,
                        found,
                        HELP,
                    ))
                }
            })
            .collect()
    }

    fn matrix(&self, what: &str, size: usize) -> Result<Listed, MatrixError> {
        let of = |part: &str| format!("{what}_{part}");
        let rows = self.whole(&of("rows"), Axis::Any("entries"))?;
        let columns = self.whole(&of("columns"), Axis::Is(rows.len()))?;
        let values = self.reader.f64s(&of("values"), &[Axis::Is(rows.len())]);
        let (_, values) = values.map_err(|e| of_store(self.name, e))?;
        let mut listed = Listed::default();
        for ((row, column), value) in rows.into_iter().zip(columns).zip(values) {
            let place = |i: i64| u32::try_from(i).ok().filter(|i| (*i as usize) < size);
            let (Some(row), Some(column)) = (place(row), place(column)) else {
                let expected = format!("rows and columns of {what} from 0 to {size} - 1");
                let found = format!("({row}, {column})");
                return Err(refused(
                    MatrixErrorKind::Syntax,
                    self.name,
                    expected,
                    found,
                    HELP,
                ));
            };
            listed.push(self.name, row, column, value)?;
        }
        Ok(listed)
    }
}

/// Reads stiffness, mass and their coordinates.
pub(super) fn matrices(name: &str, bytes: &[u8]) -> Result<SystemMatrices, MatrixError> {
    let arrays = Arrays::open(name, bytes)?;
    let coordinates = arrays.coordinates()?;
    let size = coordinates.len();
    Ok(SystemMatrices {
        files: vec![name.to_owned()],
        stiffness: arrays.matrix("stiffness", size)?.symmetric(name)?,
        mass: arrays.matrix("mass", size)?.symmetric(name)?,
        coordinates: Some(coordinates),
        size,
    })
}

/// Reads mode shapes.
pub(super) fn shapes(name: &str, bytes: &[u8]) -> Result<Shapes, MatrixError> {
    let arrays = Arrays::open(name, bytes)?;
    let coordinates = arrays.coordinates()?;
    let of = |e| of_store(name, e);
    let axes = [Axis::Is(coordinates.len()), Axis::Any("modes")];
    let (shape, values) = arrays.reader.f64s("shapes", &axes).map_err(of)?;
    let modes = shape[1];
    let (_, frequencies) = (arrays.reader)
        .f64s("frequencies_hz", &[Axis::Is(modes)])
        .map_err(of)?;
    Ok(Shapes {
        file: name.to_owned(),
        values: Mat::from_fn(coordinates.len(), modes, |i, j| values[i * modes + j]),
        coordinates,
        frequencies,
    })
}
