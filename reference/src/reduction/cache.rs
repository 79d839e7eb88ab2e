//! Bases that were computed before, kept on disk from run to run.
//!
//! A program [chooses](choose) its cache; a library leaves no files behind unasked, and so do tests.
//!
//! The name of a file is the hash of all data on which its basis depends ([`Request::key`]), including the version of
//! the computation: no file is ever out of date, it is only no longer used. Files are in `$GEARBENCH_CACHE`, otherwise
//! in the folder `gearbench` of the platform's caches (`$XDG_CACHE_HOME` or `~/.cache`, `~/Library/Caches`,
//! `%LOCALAPPDATA%`); `GEARBENCH_CACHE=off` switches the cache off. Beyond [`LIMIT`] the least recently used files are
//! deleted. A cache that cannot be read or written costs time, never a result.

use super::store::{self, Meta};
use super::{Basis, Request};
use crate::hash::Hash;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, SystemTime};

/// Bytes that the files may take together.
pub const LIMIT: u64 = 2 << 30;

/// The variable of the environment that names the folder, or `off`.
pub const VARIABLE: &str = "GEARBENCH_CACHE";

/// Age after which unfinished files of an interrupted run are deleted.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);

/// A folder of bases, or none.
#[derive(Debug, Default)]
pub struct Cache {
    folder: Option<PathBuf>,
    limit: u64,
    /// The first reason why something could not be kept.
    trouble: OnceLock<String>,
}

/// A basis, and whether it had been computed before.
#[derive(Clone, Debug)]
pub struct CachedBasis {
    /// Basis from the cache.
    pub basis: Arc<Basis>,
    /// It was read from the cache.
    pub hit: bool,
}

impl Cache {
    /// The cache that the environment names.
    pub fn standard() -> Self {
        Cache {
            folder: folder(std::env::consts::OS, |name| std::env::var_os(name)),
            limit: LIMIT,
            ..Cache::default()
        }
    }

    /// A cache in a folder of its own.
    pub fn at(folder: &Path, limit: u64) -> Self {
        Cache {
            folder: Some(folder.to_owned()),
            limit,
            ..Cache::default()
        }
    }

    /// Why something that was computed could not be kept for the next time, if so.
    pub fn trouble(&self) -> Option<&str> {
        self.trouble.get().map(String::as_str)
    }

    /// Where the files lie.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Returns the basis of a request, from the cache or computed; `source` describes the source of the mesh.
    pub fn basis<E>(
        &self,
        request: &Request<'_>,
        source: &str,
        compute: impl FnOnce() -> Result<Basis, E>,
    ) -> Result<CachedBasis, E> {
        let Some(folder) = &self.folder else {
            return Ok(CachedBasis {
                basis: Arc::new(compute()?),
                hit: false,
            });
        };
        let meta = Meta::new(request, source);
        let path = file(folder, meta.key);
        if let Ok(stored) = store::read(&path)
            && stored.meta.key == meta.key
        {
            // The time of the last use: what is used stays.
            let opened = fs::File::options().append(true).open(&path);
            let _ = opened.and_then(|f| f.set_modified(SystemTime::now()));
            return Ok(CachedBasis {
                basis: stored.basis,
                hit: true,
            });
        }
        let basis = Arc::new(compute()?);
        let kept = (fs::create_dir_all(folder).map_err(|e| e.to_string()))
            .and_then(|()| store::write(&path, &basis, &meta).map_err(|e| e.to_string()));
        match kept {
            Ok(_) => self.tidy(folder, &path),
            // A cache that cannot be written costs the same time again; who runs the program is told at its end.
            Err(e) => {
                let _ = self.trouble.set(format!("{}: {e}", folder.display()));
            }
        }
        Ok(CachedBasis { basis, hit: false })
    }

    /// Removes the files that were not used for longest beyond the limit, the newest last of all.
    fn tidy(&self, folder: &Path, newest: &Path) {
        let Ok(entries) = fs::read_dir(folder) else {
            return;
        };
        let now = SystemTime::now();
        let mut files = Vec::new();
        for entry in entries.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let Ok(data) = entry.metadata() else { continue };
            let used = data.modified().unwrap_or(SystemTime::UNIX_EPOCH);
            let ours = name
                .split_once('.')
                .filter(|n| Hash::from_hex(n.0).is_some());
            match ours.map(|n| n.1) {
                Some("npz") if data.is_file() => {
                    files.push((entry.path() == newest, used, data.len(), entry.path()));
                }
                // Half written by a run that was broken off.
                Some(rest)
                    if rest.starts_with("npz.")
                        && rest.ends_with(".part")
                        && now.duration_since(used).is_ok_and(|age| age > ABANDONED) =>
                {
                    let _ = fs::remove_file(entry.path());
                }
                _ => {}
            }
        }
        files.sort();
        let mut total: u64 = files.iter().map(|f| f.2).sum();
        for (_, _, size, path) in files {
            if total <= self.limit {
                break;
            }
            if fs::remove_file(path).is_ok() {
                total -= size;
            }
        }
    }
}

fn file(folder: &Path, key: Hash) -> PathBuf {
    folder.join(format!("{key}.npz"))
}

/// The folder that an environment names; `None` switches the cache off.
fn folder(system: &str, variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let set = |name: &str| variable(name).filter(|v| !v.is_empty());
    match set(VARIABLE) {
        Some(off) if off.eq_ignore_ascii_case("off") => return None,
        Some(folder) => return Some(PathBuf::from(folder)),
        None => {}
    }
    let home = || set("HOME").map(PathBuf::from);
    let caches = match system {
        "windows" => set("LOCALAPPDATA").map(PathBuf::from),
        "macos" => home().map(|h| h.join("Library/Caches")),
        _ => set("XDG_CACHE_HOME")
            .map(PathBuf::from)
            .filter(|p| p.is_absolute())
            .or_else(|| home().map(|h| h.join(".cache"))),
    };
    caches.map(|c| c.join("gearbench"))
}

#[cfg(test)]
mod tests;
