//! Resources of a study on its machine: a limit of memory, and a cache of reductions that were computed before.
//!
//! A thread works [within](Resources::within) the resources of a study. They belong to the thread because a gear model
//! is built by a function of the scene alone, to which nothing else can be handed; studies in threads of their own thus
//! do not share them. The memory of a thread is that of [`Memory::own`]; a thread that another one starts begins with
//! [default](Resources::default) resources.

use crate::limits::Memory;
use crate::reduction::cache::Cache;
use std::cell::RefCell;
use std::sync::Arc;

thread_local! {
    static CACHE: RefCell<Arc<Cache>> = RefCell::default();
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
        Resources {
            memory: Memory::own(),
            cache: CACHE.with_borrow(Arc::clone),
        }
    }

    /// Works within these resources, until the end of the work or its panic.
    pub fn within<R>(&self, work: impl FnOnce() -> R) -> R {
        struct Before(Arc<Cache>);
        impl Drop for Before {
            fn drop(&mut self) {
                CACHE.set(std::mem::take(&mut self.0));
            }
        }
        let _before = Before(CACHE.replace(self.cache.clone()));
        self.memory.within(work)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::DEFAULT;

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
