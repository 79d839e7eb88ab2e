//! Commit of a checkout. The build script of the command compiles this file as well.

use std::process::Command;

fn git(args: &[&str]) -> Option<String> {
    let done = Command::new("git").args(args).output().ok()?;
    (done.status.success()).then(|| String::from_utf8_lossy(&done.stdout).trim().to_owned())
}

/// Variable that names the commit where the sources are a copy without their history, as in a container.
pub const COMMIT_VARIABLE: &str = "GEARBENCH_COMMIT";

/// Commit of the checkout in the working folder, or `unknown`; `+` marks a tree with changes. The variable `GEARBENCH_COMMIT` replaces it.
pub fn commit_of_checkout() -> String {
    if let Some(named) = std::env::var(COMMIT_VARIABLE)
        .ok()
        .filter(|c| !c.is_empty())
    {
        return named;
    }
    let commit = git(&["rev-parse", "--short=12", "HEAD"]).unwrap_or_else(|| "unknown".into());
    let changes = git(&["status", "--porcelain", "--untracked-files=no"]);
    let mark = if changes.is_some_and(|c| !c.is_empty()) {
        "+"
    } else {
        ""
    };
    commit + mark
}
