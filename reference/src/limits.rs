//! The memory that a program may take: estimates beyond it are refused before it is taken.
//!
//! One limit for the whole process, because its parts share the machine; set once by the command, else [`DEFAULT`].

use std::sync::atomic::{AtomicU64, Ordering};

/// The limit when nobody sets one [bytes].
pub const DEFAULT: f64 = 2e9;

static LIMIT: AtomicU64 = AtomicU64::new(0);

/// Sets the limit [bytes].
pub fn set_memory(bytes: f64) {
    LIMIT.store(bytes.to_bits(), Ordering::Relaxed);
}

/// The limit [bytes].
pub fn memory() -> f64 {
    match LIMIT.load(Ordering::Relaxed) {
        0 => DEFAULT,
        bits => f64::from_bits(bits),
    }
}

/// Something that would take more memory than it may.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{what} would take about {needed} of memory, where {allowed} are allowed: {way_out}, or raise the limit with --memory"
)]
pub struct TooMuchMemory {
    /// What.
    pub what: String,
    /// Estimate in words.
    pub needed: String,
    /// Limit in words.
    pub allowed: String,
    /// What would take less.
    pub way_out: String,
}

/// Checks an estimate [bytes] against the limit.
///
/// # Errors
/// [`TooMuchMemory`] beyond it.
pub fn check(what: impl Into<String>, bytes: f64, way_out: &str) -> Result<(), TooMuchMemory> {
    let allowed = memory();
    if bytes <= allowed {
        return Ok(());
    }
    Err(TooMuchMemory {
        what: what.into(),
        needed: gigabytes(bytes),
        allowed: gigabytes(allowed),
        way_out: way_out.into(),
    })
}

fn gigabytes(bytes: f64) -> String {
    match bytes * 1e-9 {
        x if x < 10.0 => format!("{x:.1} GB"),
        x => format!("{x:.0} GB"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_large_says_by_how_much() {
        assert_eq!(check("a matrix", DEFAULT, "take less"), Ok(()));
        let text = check("a matrix", 7.12e9, "take less").unwrap_err();
        let text = text.to_string();
        assert!(text.contains("7.1 GB") && text.contains("2.0 GB"), "{text}");
        assert!(text.contains("take less") && text.contains("--memory"));
    }
}
