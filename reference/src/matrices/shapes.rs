//! Mode shapes that programs print: `.frd` and `.dat` of CalculiX, `.dat` of Abaqus.
//!
//! | file | what is read |
//! |---|---|
//! | `.frd` of CalculiX (`*NODE FILE`, `U`) | datasets `DISP` with the mark `MODAL`, six digits |
//! | `.dat` of CalculiX (`*NODE PRINT`, `U`) | tables `displacements (vx,vy,vz)`, seven digits |
//! | `.dat` of Abaqus (`*NODE PRINT`, `U`) | tables with the columns `U1`, `U2`, `U3` below `E I G E N V A L U E  N U M B E R`, five digits |

use super::error::{MatrixError, MatrixErrorKind, refused};
use super::lines::{Line, Lines};
use super::{Coordinate, Shapes};
use crate::limits;
use faer::Mat;
use indexmap::IndexSet;

/// Shapes while a file is read: nodes in the order of the first mode.
struct Printed<'a> {
    name: &'a str,
    nodes: IndexSet<u32>,
    /// Three displacements for each node, mode by mode.
    modes: Vec<Vec<[f64; 3]>>,
    given: Vec<bool>,
    frequencies: Vec<f64>,
    bytes: f64,
}

impl<'a> Printed<'a> {
    fn new(name: &'a str) -> Self {
        Printed {
            name,
            nodes: IndexSet::new(),
            modes: Vec::new(),
            given: Vec::new(),
            frequencies: Vec::new(),
            bytes: 0.0,
        }
    }

    /// Begins the table of another mode.
    fn begin(&mut self, frequency: f64) -> Result<(), MatrixError> {
        self.complete()?;
        let nodes = self.nodes.len();
        self.bytes += 72.0 * nodes as f64;
        let what = format!("{} mode shapes", self.modes.len() + 1);
        limits::check(what, self.bytes, "print fewer modes").map_err(|e| {
            let expected = format!("at most {} of memory", e.allowed);
            refused(
                MatrixErrorKind::Limit,
                self.name,
                expected,
                e.to_string(),
                "",
            )
        })?;
        self.modes.push(vec![[0.0; 3]; nodes]);
        self.given = vec![false; nodes];
        self.frequencies.push(frequency);
        Ok(())
    }

    /// Checks that the last mode has all nodes of the first.
    fn complete(&self) -> Result<(), MatrixError> {
        let Some(missing) = self.given.iter().position(|g| !g) else {
            return Ok(());
        };
        let node = self.nodes.get_index(missing).copied().unwrap_or(0);
        let found = format!("none of node {node} in mode {}", self.modes.len());
        let expected = "displacements of the same nodes in each mode";
        Err(refused(
            MatrixErrorKind::Syntax,
            self.name,
            expected,
            found,
            "the file is incomplete",
        ))
    }

    fn add(&mut self, line: &Line<'_>, node: u32, u: [f64; 3]) -> Result<(), MatrixError> {
        let first = self.modes.len() <= 1;
        let Some(mode) = self.modes.last_mut() else {
            return Ok(());
        };
        let place = match self.nodes.get_index_of(&node) {
            Some(place) => place,
            None if first => {
                mode.push([0.0; 3]);
                self.given.push(false);
                self.nodes.insert_full(node).0
            }
            None => {
                let expected = "a node of the first mode";
                return Err(line.error(expected, &line.text, ""));
            }
        };
        if self.given[place] {
            return Err(line.error("each node once in a mode", &line.text, ""));
        }
        (mode[place], self.given[place]) = (u, true);
        Ok(())
    }

    fn finish(self) -> Result<Shapes, MatrixError> {
        self.complete()?;
        if self.modes.is_empty() || self.nodes.is_empty() {
            let help =
                "CalculiX: *NODE FILE with U in the frequency step; Abaqus: *NODE PRINT with U";
            let expected = "displacements of the nodes in modes";
            return Err(refused(
                MatrixErrorKind::Syntax,
                self.name,
                expected,
                "none",
                help,
            ));
        }
        let coordinates = self.nodes.iter().flat_map(|node| {
            (1..=3).map(|direction| Coordinate {
                node: *node,
                direction,
            })
        });
        Ok(Shapes {
            file: self.name.to_owned(),
            coordinates: coordinates.collect(),
            values: Mat::from_fn(3 * self.nodes.len(), self.modes.len(), |i, j| {
                self.modes[j][i / 3][i % 3]
            }),
            frequencies: self.frequencies,
        })
    }
}

/// Reads the modes of an `.frd` file.
pub(super) fn frd(name: &str, bytes: &[u8]) -> Result<Shapes, MatrixError> {
    let mut lines = Lines::new(name, bytes);
    let mut printed = Printed::new(name);
    let mut frequency = None;
    let mut inside = false;
    while let Some(line) = lines.next() {
        let text = line.text.as_ref();
        match text.split_whitespace().next().unwrap_or_default() {
            "100C" | "100CL" => {
                let modal = text.contains("MODAL");
                let word = text.split_whitespace().nth(2).unwrap_or_default();
                frequency = match modal {
                    true => Some(line.number(word, "the frequency of a mode")?),
                    false => None,
                };
            }
            "-4" => {
                inside = text.split_whitespace().nth(1) == Some("DISP");
                if let Some(frequency) = frequency.filter(|_| inside) {
                    printed.begin(frequency)?;
                }
            }
            "-3" => inside = false,
            _ if inside && frequency.is_some() && text.starts_with(" -1") => {
                // Columns of fixed width: numbers may follow each other without a blank.
                let column = |from: usize, to: usize| text.get(from..to.min(text.len()));
                let expected = "a node and three displacements";
                let (Some(node), [Some(x), Some(y), Some(z)]) = (
                    column(3, 13),
                    [13, 25, 37].map(|from| column(from, from + 12)),
                ) else {
                    return Err(line.error(expected, text, "write the file as text, not binary"));
                };
                let u = [x, y, z].map(|word| line.number(word, expected));
                let [x, y, z] = u;
                printed.add(&line, line.whole(node, expected)?, [x?, y?, z?])?;
            }
            _ => {}
        }
    }
    printed.finish()
}

/// Reads the tables of modes in a `.dat` file of CalculiX or Abaqus.
pub(super) fn dat(name: &str, bytes: &[u8]) -> Result<Shapes, MatrixError> {
    /// Which tables follow.
    enum Table {
        None,
        /// A table of displacements has begun.
        Rows,
    }
    let mut lines = Lines::new(name, bytes);
    let mut printed = Printed::new(name);
    let mut table = Table::None;
    // Abaqus: number of the mode whose tables follow.
    let mut number: Option<usize> = None;
    let mut abaqus: Vec<f64> = Vec::new();
    let mut list = false;
    while let Some(line) = lines.next() {
        let text = line.text.trim();
        let joined: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        if joined.starts_with("EIGENVALUENUMBER") {
            let digits = joined.trim_start_matches(|c: char| !c.is_ascii_digit());
            number = Some(line.whole(digits, "the number of a mode")?);
            (table, list) = (Table::None, false);
            continue;
        }
        if joined == "EIGENVALUEOUTPUT" {
            list = true;
            continue;
        }
        if joined.starts_with("PARTICIPATIONFACTORS") {
            list = false;
        }
        let words: Vec<&str> = text.split_whitespace().collect();
        if text.starts_with("displacements (vx,vy,vz)") {
            let time = words.last().copied().unwrap_or_default();
            printed.begin(line.number(time, "the frequency of a mode")?)?;
            table = Table::Rows;
            continue;
        }
        if number.is_some() && ["U1", "U2", "U3"].iter().all(|u| words.contains(u)) {
            let mode = number.unwrap_or(1);
            // A long table goes on over pages with the same head.
            if printed.modes.len() != mode {
                let frequency = abaqus.get(mode.wrapping_sub(1)).copied();
                printed.begin(frequency.unwrap_or(f64::NAN))?;
                if printed.modes.len() != mode {
                    let expected = format!("the displacements of mode {}", printed.modes.len());
                    return Err(line.error(&expected, &format!("mode {mode}"), ""));
                }
            }
            table = Table::Rows;
            continue;
        }
        // Mode, eigenvalue, circular frequency, frequency, then others.
        if list && words.len() >= 4 && words[0].parse::<usize>() == Ok(abaqus.len() + 1) {
            abaqus.push(line.number(words[3], "the frequency of a mode")?);
            continue;
        }
        if matches!(table, Table::Rows) {
            match words.as_slice() {
                [] => {}
                [node, x, y, z] => {
                    let Ok(node) = node.parse::<u32>() else {
                        table = Table::None;
                        continue;
                    };
                    let expected = "a node and three displacements";
                    let [x, y, z] = [x, y, z].map(|word| line.number(word, expected));
                    printed.add(&line, node, [x?, y?, z?])?;
                }
                // The second line of a head.
                [note, ..] if *note == "NOTE" || note.starts_with("FOOT") => {}
                _ => table = Table::None,
            }
        }
    }
    printed.finish()
}
