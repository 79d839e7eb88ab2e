//! Resources of a study on its machine: a limit of memory, and a cache of reductions that were computed before.
//!
//! A thread works [within](Resources::within) the resources of a study. They belong to the thread because a gear model
//! is built by a function of the scene alone, to which nothing else can be handed; studies in threads of their own thus
//! do not share them. A thread that was started by another begins with [default](Resources::default) resources, unless
//! it is given those of the other ([`carried`]).

use crate::limits::Memory;
use crate::reduction::cache::Cache;
use std::cell::RefCell;
use std::sync::Arc;

thread_local! {
    static OWN: RefCell<Resources> = RefCell::default();
}

/// Limit of memory and cache of a study; a clone shares both.
#[derive(Clone, Debug, Default)]
pub struct Resources {
    /// Memory that estimates are compared with.
    pub memory: Memory,
    /// Bases of earlier runs; by default none are kept.
    pub cache: Arc<Cache>,
}

impl Resources {
    /// The resources of this thread.
    pub fn own() -> Self {
        OWN.with_borrow(Resources::clone)
    }

    /// Works within these resources, until the end of the work or its panic.
    pub fn within<R>(&self, work: impl FnOnce() -> R) -> R {
        struct Before(Resources);
        impl Drop for Before {
            fn drop(&mut self) {
                OWN.set(std::mem::take(&mut self.0));
            }
        }
        let _before = Before(OWN.replace(self.clone()));
        work()
    }
}

/// Returns work for other threads, which do it within the resources of this thread.
pub fn carried<A, R>(work: impl Fn(A) -> R + Send + Sync) -> impl Fn(A) -> R + Send + Sync {
    let own = Resources::own();
    move |of| own.within(|| work(of))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::{DEFAULT, check};
    use rayon::prelude::*;

    /// The pool is that of both studies.
    #[test]
    fn studies_in_parallel_have_memory_of_their_own() {
        let small = Resources {
            memory: Memory::of(1e6),
            ..Resources::default()
        };
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
    fn resources_end_with_the_work_or_its_panic() {
        let small = Resources {
            memory: Memory::of(1.0),
            ..Resources::default()
        };
        let failed = std::panic::catch_unwind(|| small.within(|| panic!("no way")));
        assert!(failed.is_err());
        assert_eq!(Resources::own().memory.limit(), DEFAULT);
        small.within(|| assert_eq!(Resources::own().memory.limit(), 1.0));
        assert_eq!(Resources::own().memory.limit(), DEFAULT);
    }
}
