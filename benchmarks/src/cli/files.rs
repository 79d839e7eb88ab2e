//! Output files of commands. They are written completely or not at all, and never replace an input or a file of another
//! program.
//!
//! A file gets its name when it is complete and on disk. Until then it is `.NAME.PID-N.part` in the same folder,
//! created anew, so that no link is followed. A failure removes it. A killed process leaves it, and the next file of
//! that name removes it, as the system has freed the lock of its writer.

use super::refusal::Refusal;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// A file that is written under a temporary name until it is complete.
#[derive(Debug)]
pub struct StagedFile {
    file: File,
    part: PathBuf,
    path: PathBuf,
    kept: bool,
}

impl StagedFile {
    /// Creates the temporary file in the folder of the final file.
    ///
    /// # Errors
    /// When its folder cannot be written to.
    pub fn begin(path: &Path) -> io::Result<Self> {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let name = path.file_name().ok_or(ErrorKind::InvalidInput)?;
        remove_parts(path);
        let mut part = std::ffi::OsString::from(".");
        part.push(name);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        part.push(format!(".{}-{number}.part", std::process::id()));
        let part = path.with_file_name(part);
        let file = File::options().write(true).create_new(true).open(&part)?;
        // Without locks on this file system a part of a killed process stays.
        let _ = file.try_lock();
        Ok(StagedFile {
            file,
            part,
            path: path.to_owned(),
            kept: false,
        })
    }

    /// Renames the complete file to its final name.
    ///
    /// # Errors
    /// The file cannot be synced or renamed; an existing file then stays.
    pub fn commit(mut self) -> io::Result<()> {
        self.file.sync_all()?;
        fs::rename(&self.part, &self.path)?;
        self.kept = true;
        Ok(())
    }

    /// The path that the file has after [`StagedFile::commit`].
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Write for StagedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for StagedFile {
    fn drop(&mut self) {
        if !self.kept {
            let _ = fs::remove_file(&self.part);
        }
    }
}

/// Removes temporary files that killed processes left.
fn remove_parts(path: &Path) {
    let (Some(name), folder) = (path.file_name(), folder_of(path)) else {
        return;
    };
    let head = format!(".{}.", name.to_string_lossy());
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let part = entry.file_name().to_string_lossy().into_owned();
        let middle = (part.strip_prefix(&head)).and_then(|rest| rest.strip_suffix(".part"));
        let writer = middle.and_then(|m| m.split_once('-')?.0.parse::<u32>().ok());
        let others = writer.is_some_and(|pid| pid != std::process::id());
        if others && entry.file_type().is_ok_and(|t| t.is_file()) {
            let file = File::options().read(true).open(entry.path());
            if file.is_ok_and(|f| f.try_lock().is_ok()) {
                let _ = fs::remove_file(entry.path());
            }
        }
    }
}

/// The parent folder of a file.
pub fn folder_of(path: &Path) -> &Path {
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
    parent.unwrap_or(Path::new("."))
}

/// Writes a file completely or not at all.
///
/// # Errors
/// The file cannot be written; an existing file then stays.
pub fn write_whole(path: &Path, contents: impl AsRef<[u8]>) -> io::Result<()> {
    let mut staged = StagedFile::begin(path)?;
    staged.write_all(contents.as_ref())?;
    staged.commit()
}

/// True if two paths lead to the same file, through any links.
pub fn is_same(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        if let (Ok(a), Ok(b)) = (fs::metadata(a), fs::metadata(b)) {
            return (a.dev(), a.ino()) == (b.dev(), b.ino());
        }
    }
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Existing files that a command may replace.
#[derive(Clone, Copy, Debug)]
pub struct ReplaceableFiles<'a> {
    /// Input files of the command. None of them is ever overwritten.
    pub inputs: &'a [PathBuf],
    /// Text that marks the files of the command, near their beginning or their end: a file with it may be replaced.
    pub mark: Option<&'a str>,
    /// True if files without the mark may be replaced too (`--force`).
    pub force: bool,
}

impl ReplaceableFiles<'_> {
    /// Checks, before any computation, that a file may be written.
    ///
    /// # Errors
    /// [`Refusal`] with help.
    pub fn check(&self, path: &Path) -> Result<(), Refusal> {
        let refuse = |what: &str, help: &str| {
            Err(Refusal::Input(miette::miette!(
                help = help.to_owned(),
                "{}: {what}",
                path.display()
            )))
        };
        if self.inputs.iter().any(|input| is_same(input, path)) {
            return refuse(
                "the file is an input of the command and would be overwritten by its output",
                "choose another name with --out",
            );
        }
        match fs::metadata(path) {
            Err(e) if e.kind() == ErrorKind::NotFound => Ok(()),
            Err(e) => Err(Refusal::Files(format!("{}: {e}", path.display()))),
            Ok(found) if !found.is_file() => refuse(
                "this is not a regular file",
                "choose another name with --out",
            ),
            Ok(_) if self.force || self.mark.is_some_and(|mark| has_mark(path, mark)) => Ok(()),
            Ok(_) => refuse(
                "the file exists already and was not written by this command",
                "name another file with --out, or overwrite it with --force",
            ),
        }
    }
}

/// True if a text occurs in the first or last 64 KiB of a file.
fn has_mark(path: &Path, mark: &str) -> bool {
    const PART: u64 = 1 << 16;
    let read = || -> io::Result<Vec<u8>> {
        let mut file = File::open(path)?;
        let length = file.metadata()?.len();
        let mut bytes = Vec::new();
        (&mut file).take(PART).read_to_end(&mut bytes)?;
        file.seek(SeekFrom::Start(length.saturating_sub(PART)))?;
        file.take(PART).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    let mark = mark.as_bytes();
    read().is_ok_and(|bytes| bytes.windows(mark.len()).any(|w| w == mark))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_whole_or_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write_whole(&path, "before").unwrap();
        // A failure on the way leaves the old file, and nothing else.
        let mut staged = StagedFile::begin(&path).unwrap();
        staged.write_all(b"half of wh").unwrap();
        drop(staged);
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
        // Files of a killed process are removed, those of a running process are kept.
        let (dead, alive) = (
            folder.path().join(".a.csv.1-0.part"),
            folder.path().join(".a.csv.2-0.part"),
        );
        fs::write(&dead, "half").unwrap();
        fs::write(&alive, "half").unwrap();
        let writer = File::open(&alive).unwrap();
        writer.lock().unwrap();
        write_whole(&path, "after").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "after");
        assert!(!dead.exists() && alive.exists());
        drop(writer);
        write_whole(&path, "after all").unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn no_link_is_followed() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("mine"), "mine").unwrap();
        std::os::unix::fs::symlink(at("mine"), at("out.csv")).unwrap();
        std::os::unix::fs::symlink(at("mine"), at("out.csv.part")).unwrap();
        write_whole(&at("out.csv"), "output").unwrap();
        assert_eq!(fs::read_to_string(at("mine")).unwrap(), "mine");
        assert_eq!(fs::read_to_string(at("out.csv")).unwrap(), "output");
    }

    #[test]
    fn inputs_and_foreign_files_are_not_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let inputs = [at("scene.toml")];
        let check = |name: &str, force| {
            let of = ReplaceableFiles {
                inputs: &inputs,
                mark: Some("made by gearbench"),
                force,
            };
            of.check(&at(name)).is_ok()
        };
        fs::write(at("scene.toml"), "# made by gearbench").unwrap();
        fs::write(at("measured.csv"), "1,2").unwrap();
        fs::write(
            at("own.csv"),
            format!("{}made by gearbench", " ".repeat(200_000)),
        )
        .unwrap();
        assert!(check("nothing there.csv", false) && check("own.csv", false));
        assert!(!check("measured.csv", false) && check("measured.csv", true));
        assert!(!check("scene.toml", false) && !check("scene.toml", true));
        assert!(!check(".", true), "a folder");
        fs::hard_link(at("scene.toml"), at("the same.toml")).unwrap();
        assert!(!check("the same.toml", true));
    }
}
