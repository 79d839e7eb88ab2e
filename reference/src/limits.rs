//! The memory that a program may take: estimates beyond it are refused before it is taken.
//!
//! One limit for the whole process, because its parts share the machine; set once by the command, else [`DEFAULT`].

use std::sync::atomic::{AtomicU64, Ordering};

/// Default limit of memory [bytes].
pub const DEFAULT: f64 = 2e9;

static LIMIT: AtomicU64 = AtomicU64::new(0);
/// Bytes that results take which stay to the end of a study.
static RESERVED: AtomicU64 = AtomicU64::new(0);

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

/// Counts bytes that remain allocated, such as the histories of finished runs: estimates are compared with the rest.
pub fn reserve(bytes: u64) {
    RESERVED.fetch_add(bytes, Ordering::Relaxed);
}

/// Counts bytes as free again that were [reserved](reserve).
pub fn release(bytes: u64) {
    // More is never released than was reserved.
    let less = |all: u64| Some(all.saturating_sub(bytes));
    let _ = RESERVED.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less);
}

/// Something that would take more memory than it may.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{what} would need about {needed} of memory, but {allowed} are allowed: {way_out}, or raise the limit with --memory"
)]
pub struct TooMuchMemory {
    /// Name of the data that need the memory.
    pub what: String,
    /// Estimated memory as text.
    pub needed: String,
    /// Limit of memory as text.
    pub allowed: String,
    /// Changes that reduce the memory.
    pub way_out: String,
}

/// Checks an estimate [bytes] against the limit.
///
/// # Errors
/// [`TooMuchMemory`] beyond it.
pub fn check(what: impl Into<String>, bytes: f64, way_out: &str) -> Result<(), TooMuchMemory> {
    let allowed = memory();
    let reserved = RESERVED.load(Ordering::Relaxed) as f64;
    if reserved + bytes <= allowed {
        return Ok(());
    }
    let what = match reserved > 0.01 * allowed {
        true => format!("{}, with {} of results", what.into(), gigabytes(reserved)),
        false => what.into(),
    };
    Err(TooMuchMemory {
        what,
        needed: gigabytes(reserved + bytes),
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
