//! Files that others wrote, read within bounds: only regular files, and no more of them than a reader takes.
//!
//! A fifo or a device would keep a reader waiting for ever or never end, and a file that is far too large would fill the
//! memory before anything of it is judged. Every reader of the program goes through [`read`] or [`read_text`].

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Bytes that a file written by hand may have: a scene, a calibration, a list of checks.
pub const MOST_OF_TEXT: u64 = 16_000_000;

/// Checks that a path is a regular file of at most so many bytes, and returns how many it has.
///
/// # Errors
/// What the system says, or what the path is in place of such a file.
pub fn check(path: &Path, most: u64) -> io::Result<u64> {
    let data = path.metadata()?;
    if data.is_dir() {
        return Err(io::Error::new(
            ErrorKind::IsADirectory,
            "it is a folder, where a file is expected",
        ));
    }
    if !data.is_file() {
        return Err(io::Error::other(
            "it is a device or a pipe, where a regular file is expected",
        ));
    }
    match data.len() {
        n if n > most => Err(too_large(n, most)),
        n => Ok(n),
    }
}

fn too_large(bytes: u64, most: u64) -> io::Error {
    io::Error::new(
        ErrorKind::FileTooLarge,
        format!("it has {bytes} bytes or more, at most {most} are read"),
    )
}

/// Reads a regular file of at most `most` bytes, also where its size is not known beforehand.
///
/// # Errors
/// Those of [`check`], and what the system says.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let size = check(path, most)?;
    let mut bytes = Vec::with_capacity(size as usize);
    File::open(path)?
        .take(most.saturating_add(1))
        .read_to_end(&mut bytes)?;
    match bytes.len() as u64 {
        n if n > most => Err(too_large(n, most)),
        _ => Ok(bytes),
    }
}

/// Reads a text in UTF-8 of at most so many bytes.
///
/// # Errors
/// Those of [`read`], and [`ErrorKind::InvalidData`] for other encodings.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read(path, most)?)
        .map_err(|e| io::Error::new(ErrorKind::InvalidData, format!("it is not UTF-8 ({e})")))
}

/// Takes the first line off the bytes of a text, without its end; `None` if nothing is left.
pub fn take_line<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    if rest.is_empty() {
        return None;
    }
    let end = rest.iter().position(|b| *b == b'\n');
    let (line, after) = match end {
        Some(end) => (&rest[..end], &rest[end + 1..]),
        None => (*rest, &rest[rest.len()..]),
    };
    *rest = after;
    Some(line.strip_suffix(b"\r").unwrap_or(line))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_regular_file_of_its_size_is_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        std::fs::write(&path, "12345").unwrap();
        assert_eq!(read(&path, 5).unwrap(), b"12345");
        assert_eq!(read_text(&path, 5).unwrap(), "12345");
        let e = read(&path, 4).unwrap_err();
        assert_eq!(e.kind(), ErrorKind::FileTooLarge);
        assert!(e.to_string().contains("at most 4"), "{e}");
        let e = read(folder.path(), 9).unwrap_err();
        assert!(e.to_string().contains("folder"), "{e}");
        std::fs::write(&path, [0xff]).unwrap();
        let e = read_text(&path, 5).unwrap_err();
        assert_eq!(e.kind(), ErrorKind::InvalidData);
        let e = read(&folder.path().join("none"), 5).unwrap_err();
        assert_eq!(e.kind(), ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_pipes_are_no_files() {
        let folder = tempfile::tempdir().unwrap();
        let fifo = folder.path().join("fifo");
        let made = std::process::Command::new("mkfifo").arg(&fifo).status();
        assert!(made.unwrap().success());
        for path in [fifo.as_path(), Path::new("/dev/zero")] {
            let e = read(path, 5).unwrap_err().to_string();
            assert!(e.contains("regular file"), "{e}");
        }
    }
}
