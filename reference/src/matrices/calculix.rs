//! Matrix storage of CalculiX: `*FREQUENCY, SOLVER=MATRIXSTORAGE` writes stiffness (`.sti`) and mass (`.mas`) as lines
//! of row, column and value, and the coordinate of each row (`.dof`) as node and direction with a point between.
//! Matrix Market files and the coordinate format of Abaqus have the same lines.

use super::Coordinate;
use super::entries::Listed;
use super::error::MatrixError;
use super::lines::Lines;

/// Largest number of rows.
const MOST_ROWS: u32 = 1 << 30;

/// Reads lines of row, column and value, separated by blanks or commas.
pub(super) fn triplets(name: &str, bytes: &[u8]) -> Result<Listed, MatrixError> {
    let mut lines = Lines::new(name, bytes);
    let mut listed = Listed::default();
    let expected = "a row, a column and a value";
    let market = bytes.starts_with(b"%%MatrixMarket");
    let mut size = None;
    while let Some(line) = lines.next_filled() {
        if market && line.text.starts_with('%') {
            let words = line.text.to_ascii_lowercase();
            let banner = words.starts_with("%%matrixmarket");
            let fits = ["matrix", "coordinate", "real"];
            if banner
                && !fits
                    .iter()
                    .all(|w| words.split_whitespace().any(|x| x == *w))
            {
                let expected = "`%%MatrixMarket matrix coordinate real symmetric` (or general)";
                return Err(line.error(expected, &line.text, "write the matrix in this form"));
            }
            continue;
        }
        let mut words = line.text.split([' ', '\t', ',']).filter(|w| !w.is_empty());
        let (Some(row), Some(column), Some(value), None) =
            (words.next(), words.next(), words.next(), words.next())
        else {
            return Err(line.error(expected, &line.text, ""));
        };
        if market && size.is_none() {
            let count = |w| line.whole::<usize>(w, "the number of rows, columns and entries");
            let [rows, columns, _] = [count(row)?, count(column)?, count(value)?];
            if rows != columns {
                return Err(line.error("a square matrix", &line.text, ""));
            }
            size = Some(rows);
            continue;
        }
        let [row, column] = [row, column].map(|word| {
            let number = line.whole::<i64>(word, "a row and a column")?;
            let fits = u32::try_from(number).ok().filter(|n| (1..=MOST_ROWS).contains(n));
            fits.map(|n| n - 1).ok_or_else(|| {
                let help = "Abaqus gives coordinates inside of it negative numbers: `FORMAT=MATRIX INPUT` names nodes";
                line.error("rows and columns that count from 1", word, help)
            })
        });
        listed.push(name, row?, column?, line.number(value, "a finite value")?)?;
    }
    Ok(listed)
}

/// Reads the coordinates of rows: `node.direction` a line, or the mapping file of Ansys (row, node, name of the
/// direction).
pub(super) fn coordinates(name: &str, bytes: &[u8]) -> Result<Vec<Coordinate>, MatrixError> {
    let mut lines = Lines::new(name, bytes);
    let mut all: Vec<Coordinate> = Vec::new();
    while let Some(line) = lines.next_filled() {
        let words: Vec<&str> = line.text.split_whitespace().collect();
        let digits = |w: &str| w.bytes().all(|b| b.is_ascii_digit());
        let (node, direction) = match words.as_slice() {
            [one] => match one.split_once('.') {
                Some((node, direction)) => {
                    let direction: u8 = line.whole(direction, "a direction 1 to 6")?;
                    (line.whole(node, "a node")?, direction)
                }
                None => return Err(line.error("`node.direction`", one, "")),
            },
            // Titles come before the first row.
            [first, ..] if !digits(first) && all.is_empty() => continue,
            [row, node, direction, ..] => {
                let row: usize = line.whole(row, "the number of a row")?;
                if row != all.len() + 1 {
                    let expected = format!("row {}", all.len() + 1);
                    return Err(line.error(
                        &expected,
                        &line.text,
                        "rows are listed in their order",
                    ));
                }
                let names = ["UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ"];
                let at = names.iter().position(|n| n.eq_ignore_ascii_case(direction));
                let direction = at.ok_or_else(|| {
                    let help = "only structural analyses are read";
                    line.error("UX, UY, UZ, ROTX, ROTY or ROTZ", direction, help)
                })?;
                (line.whole(node, "a node")?, direction as u8 + 1)
            }
            _ => {
                let expected = "`node.direction`, or row, node and direction";
                return Err(line.error(expected, &line.text, ""));
            }
        };
        if !(1..=6).contains(&direction) {
            return Err(line.error("a direction 1 to 6", &line.text, ""));
        }
        all.push(Coordinate { node, direction });
    }
    Ok(all)
}
