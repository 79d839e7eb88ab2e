//! The shared library of FMUs: search beside the program, and build in the checkout that the program comes from.
//!
//! A library that is older than the program may number variables differently. A program with its checkout then has cargo
//! check it, which takes a second if nothing changed.

use super::command::bad;
use crate::cli::terminal::Refusal;
use crate::context::Context;
use crate::messages::OutputForm;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::SystemTime;

/// Name of the package of the library.
const PACKAGE: &str = "gearbench-fmu";
/// Arguments of cargo that build the library with the features that the workspace has.
const BUILD: [&str; 6] = [
    "build",
    "--release",
    "--locked",
    "--workspace",
    "--lib",
    "--message-format=json-render-diagnostics",
];

/// Name of the shared library on this system.
fn name() -> String {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    format!("{DLL_PREFIX}gearbench_fmu{DLL_SUFFIX}")
}

/// Paths at which the library of an installed program may be: its folder and `../lib`.
pub(super) fn places() -> Vec<PathBuf> {
    let name = name();
    let program = std::env::current_exe().ok();
    let folder = program.as_deref().and_then(Path::parent);
    folder.map_or_else(Vec::new, |folder| {
        let lib = folder.parent().map(|p| p.join("lib").join(&name));
        [Some(folder.join(&name)), lib]
            .into_iter()
            .flatten()
            .collect()
    })
}

/// The checkout in which this program was compiled; `None` for released programs, which run elsewhere.
fn checkout() -> Option<PathBuf> {
    if option_env!("GEARBENCH_RELEASE").is_some() {
        return None;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?;
    let manifest = std::fs::read_to_string(root.join("fmu").join("Cargo.toml")).ok()?;
    let own = format!("name = \"{PACKAGE}\"");
    manifest
        .lines()
        .any(|line| line == own)
        .then(|| root.to_owned())
}

/// Time of the last change of a file.
fn changed(path: &Path) -> Option<SystemTime> {
    path.metadata().and_then(|data| data.modified()).ok()
}

/// Reads the shared library: the named one, the one beside the program, or the one that cargo builds in the checkout.
///
/// # Errors
/// There is no library, or cargo cannot build it.
pub(super) fn read(context: &Context, named: Option<&Path>) -> Result<Vec<u8>, Refusal> {
    let path = match named {
        Some(path) => path.to_owned(),
        None => find(context)?,
    };
    std::fs::read(&path).map_err(|e| {
        let why = format!("the shared library of {PACKAGE}, {}: {e}", path.display());
        bad(why, way_out())
    })
}

fn way_out() -> String {
    let name = name();
    format!(
        "`{name}` is part of gearbench: put it into the folder of this program, or name it with --library; in a checkout of \
         gearbench `cargo build --release -p {PACKAGE}` makes target/release/{name}"
    )
}

fn find(context: &Context) -> Result<PathBuf, Refusal> {
    let places = places();
    let found = places.iter().find(|path| path.is_file());
    let Some(root) = checkout() else {
        let shown: Vec<String> = places.iter().map(|p| p.display().to_string()).collect();
        return found.cloned().ok_or_else(|| {
            let why = format!(
                "an FMU needs the shared library `{}`, which is neither {}",
                name(),
                shown.join(" nor ")
            );
            bad(why, way_out())
        });
    };
    let program = std::env::current_exe().ok();
    let program = program.as_deref().and_then(changed);
    match found {
        Some(path) if changed(path) >= program => Ok(path.clone()),
        _ => build(context, &root),
    }
}

/// Builds the library in a checkout and returns its path.
fn build(context: &Context, root: &Path) -> Result<PathBuf, Refusal> {
    let line = format!("cargo {}", BUILD[..5].join(" "));
    let quiet = context.messages.form != OutputForm::Lines;
    context.messages.print_line(&format!(
        "the shared library of FMUs: {line} (in {})",
        root.display()
    ));
    let fail = |why: String| {
        let why = format!("`{line}` in {}: {why}", root.display());
        bad(why, way_out())
    };
    let errors = if quiet {
        Stdio::piped()
    } else {
        Stdio::inherit()
    };
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let done = cargo
        .args(BUILD)
        .current_dir(root)
        .stderr(errors)
        .output()
        .map_err(|e| fail(e.to_string()))?;
    if !done.status.success() {
        let told = String::from_utf8_lossy(&done.stderr);
        let last = told.lines().rfind(|line| !line.trim().is_empty());
        return Err(fail(last.unwrap_or("the build failed").to_owned()));
    }
    let library = artifact(&done.stdout).map_err(|e| fail(e.to_string()))?;
    library.ok_or_else(|| fail(format!("cargo names no library `{}`", name())))
}

/// The library among the files that cargo lists.
fn artifact(messages: &[u8]) -> io::Result<Option<PathBuf>> {
    let name = name();
    for line in messages.split(|b| *b == b'\n').filter(|l| !l.is_empty()) {
        let message: serde_json::Value = serde_json::from_slice(line)?;
        let files = message["filenames"].as_array();
        let mut paths = files.into_iter().flatten().filter_map(|f| f.as_str());
        if let Some(path) = paths.find(|p| Path::new(p).file_name() == Some(name.as_ref())) {
            return Ok(Some(path.into()));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_found_in_the_messages_of_cargo() {
        let name = name();
        let lines = format!(
            "{{\"reason\":\"compiler-artifact\",\"filenames\":[\"/t/liba.rlib\"]}}\n\
             {{\"reason\":\"compiler-artifact\",\"filenames\":[\"/t/x.rlib\",\"/t/{name}\"]}}\n\
             {{\"reason\":\"build-finished\",\"success\":true}}\n"
        );
        let path = artifact(lines.as_bytes()).unwrap();
        assert_eq!(path.unwrap(), Path::new("/t").join(&name));
        assert!(artifact(b"").unwrap().is_none());
        assert!(artifact(b"no JSON\n").is_err());
        // This test runs in a checkout.
        assert!(checkout().unwrap().join("fmu/src/lib.rs").is_file());
    }
}
