//! Limit of memory: estimates beyond it are refused before anything is allocated.
//!
//! A thread works [within](Memory::within) a limit. The limit belongs to the thread, so that it needs no argument in
//! each function between the caller and the estimate, and so that threads of different tasks do not share it. A thread
//! that another one starts has the [default](Memory::default) limit, unless it gets that of the other ([`carried`]).

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Default limit of memory [bytes].
pub const DEFAULT: f64 = 2e9;

thread_local! {
    static OWN: RefCell<Memory> = RefCell::default();
}

/// Memory that the parts of a task share; a clone is the same memory.
#[derive(Clone, Debug)]
pub struct Memory {
    /// Limit [bytes].
    limit: f64,
    /// Bytes of results that remain to the end of the task.
    reserved: Arc<AtomicU64>,
}

impl Default for Memory {
    /// The memory [`DEFAULT`].
    fn default() -> Self {
        Memory::of(DEFAULT)
    }
}

impl Memory {
    /// Returns the memory of this thread.
    pub fn own() -> Self {
        OWN.with_borrow(Memory::clone)
    }

    /// Works within this memory, until the end of the work or its panic.
    pub fn within<R>(&self, work: impl FnOnce() -> R) -> R {
        struct Before(Memory);
        impl Drop for Before {
            fn drop(&mut self) {
                OWN.set(std::mem::take(&mut self.0));
            }
        }
        let _before = Before(OWN.replace(self.clone()));
        work()
    }

    /// A memory with a limit [bytes].
    pub fn of(limit: f64) -> Self {
        Memory {
            limit,
            reserved: Arc::default(),
        }
    }

    /// The limit [bytes].
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// Counts bytes that remain allocated, such as the histories of finished runs: estimates are compared with the rest.
    pub fn reserve(&self, bytes: u64) {
        self.reserved.fetch_add(bytes, Ordering::Relaxed);
    }

    /// Counts bytes as free again that were [reserved](Self::reserve).
    pub fn release(&self, bytes: u64) {
        // More is never released than was reserved.
        let less = |all: u64| Some(all.saturating_sub(bytes));
        let _ = (self.reserved).fetch_update(Ordering::Relaxed, Ordering::Relaxed, less);
    }

    fn check(&self, what: String, bytes: f64, way_out: &str) -> Result<(), TooMuchMemory> {
        let reserved = self.reserved.load(Ordering::Relaxed) as f64;
        if reserved + bytes <= self.limit {
            return Ok(());
        }
        let what = match reserved > 0.01 * self.limit {
            true => format!("{what}, with {} of results", gigabytes(reserved)),
            false => what,
        };
        Err(TooMuchMemory {
            what,
            needed: gigabytes(reserved + bytes),
            allowed: gigabytes(self.limit),
            way_out: way_out.into(),
        })
    }
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

/// Checks an estimate [bytes] against the memory of this thread ([`Memory::own`]).
///
/// # Errors
/// [`TooMuchMemory`] beyond it.
pub fn check(what: impl Into<String>, bytes: f64, way_out: &str) -> Result<(), TooMuchMemory> {
    Memory::own().check(what.into(), bytes, way_out)
}

/// Returns work for other threads, which do it within the memory of this thread.
pub fn carried<A, R>(work: impl Fn(A) -> R + Send + Sync) -> impl Fn(A) -> R + Send + Sync {
    let own = Memory::own();
    move |of| own.within(|| work(of))
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
    use rayon::prelude::*;

    /// The pool is that of both tasks.
    #[test]
    fn tasks_in_parallel_have_memory_of_their_own() {
        let small = Memory::of(1e6);
        let refused = || {
            let work = carried(|_: u32| check("a matrix", 1e8, "take less").is_err());
            let all: Vec<bool> = (0..100).into_par_iter().map(work).collect();
            all.iter().filter(|refused| **refused).count()
        };
        let (one, other) = std::thread::scope(|scope| {
            let one = scope.spawn(|| small.within(refused));
            let other = scope.spawn(refused);
            (one.join().unwrap(), other.join().unwrap())
        });
        assert_eq!((one, other), (100, 0));
    }

    #[test]
    fn what_is_too_large_says_by_how_much() {
        assert_eq!(check("a matrix", DEFAULT, "take less"), Ok(()));
        let text = check("a matrix", 7.12e9, "take less").unwrap_err();
        let text = text.to_string();
        assert!(text.contains("7.1 GB") && text.contains("2.0 GB"), "{text}");
        assert!(text.contains("take less") && text.contains("--memory"));
    }
}
