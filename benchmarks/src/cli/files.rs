//! Files of commands that have no folder of their own: written whole or not at all.

use std::io;
use std::path::Path;

/// Writes a file under another name first, and gives it its own when it is whole.
///
/// # Errors
/// When it cannot be written; what was there before stays.
pub fn write_whole(path: &Path, contents: impl AsRef<[u8]>) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let staged = path.with_file_name(name);
    std::fs::write(&staged, contents)?;
    std::fs::rename(&staged, path)
}
