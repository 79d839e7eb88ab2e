//! Reading of table files of the user, for references and measured curves, with bounds on size and memory.

use super::error::{SceneError, Source};
use gearbench_reference::data::{self, TableError};
use gearbench_reference::file_kind::{self, Input};
use gearbench_reference::{files, limits};
use std::io::ErrorKind;
use std::path::Path;

/// Memory of a table relative to the size of its text: lines, cells, numbers, and derived data.
const MEMORY_OVER_TEXT: f64 = 14.0;

/// The text of a table.
pub struct TableText {
    /// Name of the file.
    pub name: String,
    /// The decoded text of the file.
    pub decoded: String,
    /// True if the file is encoded in Latin-1.
    pub latin: bool,
}

/// Reason why a file is not a text table, with help.
pub struct UnreadableTable {
    /// The message, with the name of the file.
    pub why: String,
    /// The help: how to provide a readable file.
    pub help: String,
}

impl UnreadableTable {
    /// Converts to an error without a place in a scene.
    pub fn plain(self) -> SceneError {
        SceneError::plain(self.why, self.help)
    }
}

impl TableText {
    /// Creates an error at a line of the table; `what` names the kind of table.
    pub fn error(&self, e: &TableError, what: &str) -> SceneError {
        let message = format!("{what}: {e}");
        Source::new(&self.name, &self.decoded).error(e.at.clone(), message, "here", e.help.clone())
    }
}

/// Reads a table of at most `largest` bytes; `from` explains what paths are relative to.
///
/// # Errors
/// [`UnreadableTable`] if the file is not a text table, or too large.
pub fn text(path: &Path, largest: u64, from: &str) -> Result<TableText, UnreadableTable> {
    let name = path.display().to_string();
    let refuse = |why: String, help: &str| UnreadableTable {
        why,
        help: help.to_owned(),
    };
    if let Some(kind) = file_kind::foreign(path, Input::Table) {
        let why = format!("`{name}` is {}, not a table", kind.name);
        return Err(refuse(why, &kind.way_out_of(path)));
    }
    let shorter = "keep every n-th row, or the columns needed";
    let size = files::check(path, largest).map_err(|e| {
        let help = match e.kind() {
            ErrorKind::NotFound => from,
            ErrorKind::FileTooLarge => shorter,
            _ => "expected a readable CSV file with a line of names",
        };
        refuse(format!("{name}: {e}"), help)
    })?;
    let what = format!("the table {name} of {size} bytes");
    limits::check(what, MEMORY_OVER_TEXT * size as f64, shorter)
        .map_err(|e| refuse(e.to_string(), shorter))?;
    let bytes = files::read(path, largest)
        .map_err(|e| refuse(format!("{name}: {e}"), "expected a readable CSV file"))?;
    let (decoded, latin) =
        data::decode(&bytes).map_err(|e| refuse(format!("{name}: {e}"), &e.help))?;
    Ok(TableText {
        name,
        decoded,
        latin,
    })
}
