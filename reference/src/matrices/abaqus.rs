//! Matrices of Abaqus: `*MATRIX OUTPUT, FORMAT=MATRIX INPUT` (or `LABELS`) writes a line for each entry with node and
//! direction of its row, node and direction of its column, and the value. `FORMAT=COORDINATE` numbers rows and columns
//! instead, with three rows for each node in ascending order of the labels.

use super::Coordinate;
use super::calculix;
use super::entries::Listed;
use super::error::MatrixError;
use super::lines::Lines;
use indexmap::IndexSet;

/// The entries of a matrix over coordinates that several files share.
pub(super) fn matrix(
    name: &str,
    bytes: &[u8],
    shared: &mut IndexSet<Coordinate>,
) -> Result<Listed, MatrixError> {
    let mut lines = Lines::new(name, bytes);
    let mut listed = Listed::default();
    let expected = "node, direction, node, direction and a value";
    while let Some(line) = lines.next_filled() {
        let text = line.text.trim_start();
        if text.starts_with('*') {
            // `*MATRIX INPUT` and comments.
            continue;
        }
        let words: Vec<&str> = (text.split([',', ' ', '\t']).filter(|w| !w.is_empty())).collect();
        let [a, i, b, j, value] = words.as_slice() else {
            return Err(line.error(expected, &line.text, ""));
        };
        let mut place = |node: &str, direction: &str| {
            let node: i64 = line.whole(node, "the label of a node")?;
            let direction: u8 = line.whole(direction, "a direction 1 to 6")?;
            let label = u32::try_from(node.unsigned_abs()).ok();
            let fits = label.filter(|n| (1..INTERNAL).contains(n));
            let (Some(label), 1..) = (fits, direction) else {
                return Err(line.error(expected, &line.text, ""));
            };
            // Abaqus marks nodes inside of it by a sign.
            let node = if node < 0 { label + INTERNAL } else { label };
            Ok(shared.insert_full(Coordinate { node, direction }).0 as u32)
        };
        let (row, column) = (place(a, i)?, place(b, j)?);
        listed.push(name, row, column, line.number(value, "a finite value")?)?;
    }
    Ok(listed)
}

/// Labels beyond this one are those of nodes inside Abaqus.
const INTERNAL: u32 = 1 << 31;

/// True if the lines of a file number rows and columns instead of nodes and directions.
pub(super) fn is_numbered(bytes: &[u8]) -> bool {
    let mut lines = Lines::new("", bytes);
    let first = std::iter::from_fn(|| lines.next_filled())
        .find(|l| !l.text.trim_start().starts_with(['*', '%']));
    first.is_some_and(|l| {
        let words = l.text.split([',', ' ', '\t']).filter(|w| !w.is_empty());
        words.count() == 3
    })
}

/// Entries of a file that numbers rows and columns.
pub(super) fn numbered(name: &str, bytes: &[u8]) -> Result<Listed, MatrixError> {
    calculix::triplets(name, bytes)
}
