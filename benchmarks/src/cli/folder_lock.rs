//! The lock of an output folder, which allows one process at a time to write there.
//!
//! The lock is one of the operating system on the file `.lock`, which the system frees when its process ends, however it
//! ends. The file names the owner for a second process.

use super::refusal::Refusal;
use super::terminal;
use crate::experiment::machine;
use crate::messages::Messages;
use serde::{Deserialize, Serialize};
use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Name of the lock file in the folder.
pub const LOCK: &str = ".lock";

/// The process that holds the lock of a folder.
#[derive(Debug, Serialize, Deserialize)]
struct Owner {
    pid: u32,
    host: String,
    since: String,
    command: String,
}

impl Owner {
    fn this_process() -> Self {
        let host = fs::read_to_string("/proc/sys/kernel/hostname").ok();
        let host = host.or_else(|| {
            std::env::var("HOSTNAME")
                .or(std::env::var("COMPUTERNAME"))
                .ok()
        });
        let host = host.map(|h| h.trim().to_owned()).unwrap_or_default();
        Owner {
            pid: std::process::id(),
            host,
            since: machine::now(),
            command: terminal::command_line("gearbench"),
        }
    }
}

/// The lock of a folder; dropping it releases the folder.
#[derive(Debug)]
pub struct FolderLock {
    file: File,
    path: PathBuf,
}

impl FolderLock {
    /// Acquires the lock of a folder.
    ///
    /// # Errors
    /// [`Refusal::Input`] with the owner where another process has it, [`Refusal::Files`] where the folder cannot be
    /// written to.
    pub fn take(messages: &Messages, folder: &Path) -> Result<Self, Refusal> {
        let path = folder.join(LOCK);
        let fail = |e: io::Error| Refusal::Files(format!("{}: {e}", path.display()));
        loop {
            if fs::symlink_metadata(&path).is_ok_and(|m| !m.is_file()) {
                return Err(fail(io::Error::other("is not a regular file; remove it")));
            }
            let mut file = (File::options()
                .read(true)
                .write(true)
                .create(true)
                .truncate(false))
            .open(&path)
            .map_err(fail)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(locked_refusal(folder, &mut file)),
                Err(TryLockError::Error(e)) if e.kind() == ErrorKind::Unsupported => {
                    messages.warn(&format!(
                        "{}: this file system has no locks; let one process at a time write there",
                        folder.display()
                    ));
                }
                Err(TryLockError::Error(e)) => return Err(fail(e)),
            }
            // The owner before may have removed the file between the two calls: then this is the lock of nothing.
            if !is_at(&file, &path) {
                continue;
            }
            let owner = serde_json::to_string(&Owner::this_process()).unwrap_or_default();
            let written = file
                .set_len(0)
                .and_then(|()| file.write_all(owner.as_bytes()));
            written.map_err(fail)?;
            return Ok(FolderLock { file, path });
        }
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // Removed while it is locked: nobody else can have it.
        let _ = fs::remove_file(&self.path);
        let _ = self.file.unlock();
    }
}

/// True if an open file is still the one at a path.
fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let ids = |m: fs::Metadata| (m.dev(), m.ino());
        let (open, there) = (file.metadata().map(ids), fs::metadata(path).map(ids));
        matches!((open, there), (Ok(a), Ok(b)) if a == b)
    }
    #[cfg(not(unix))]
    {
        // A file that is open is not removed there.
        let _ = file;
        path.exists()
    }
}

/// The refusal for a folder that another process writes to.
fn locked_refusal(folder: &Path, file: &mut File) -> Refusal {
    let mut owner = None;
    // A new owner may not have written its name yet.
    for _ in 0..20 {
        let mut text = String::new();
        let read = file.rewind().and_then(|()| file.read_to_string(&mut text));
        owner = read
            .ok()
            .and_then(|_| serde_json::from_str::<Owner>(&text).ok());
        if owner.is_some() {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let owner = owner.map_or_else(
        || "another process works in this folder".to_owned(),
        |o| {
            format!(
                "process {} on {} works in this folder since {}: `{}`",
                o.pid, o.host, o.since, o.command
            )
        },
    );
    Refusal::Input(miette::miette!(
        help = "wait for its end, or name another folder with --out",
        "{}: {owner}",
        folder.display()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_has_one_owner() {
        let folder = tempfile::tempdir().unwrap();
        for _ in 0..3 {
            let lock = FolderLock::take(&Messages::default(), folder.path()).unwrap();
            // Another open file of this process is as that of another process.
            let refusal = FolderLock::take(&Messages::default(), folder.path()).unwrap_err();
            let text = format!("{:?}", refusal.into_report().1);
            let pid = format!("process {}", std::process::id());
            assert!(text.contains(&pid), "{text}");
            drop(lock);
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        }
        // The file of a killed process is no lock.
        fs::write(folder.path().join(LOCK), "{\"pid\":1}").unwrap();
        FolderLock::take(&Messages::default(), folder.path()).unwrap();
    }
}
