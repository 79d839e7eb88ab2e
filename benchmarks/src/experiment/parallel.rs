//! Parallel execution of independent pieces of work.

use gearbench_reference::resources::Resources;
use std::panic::resume_unwind;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locks a mutex, also one poisoned by a thread that panicked: the panic itself is reported elsewhere.
pub fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the number of threads that the command line asks for, else that of the processors.
pub fn thread_count(asked: Option<u32>) -> usize {
    let processors = || std::thread::available_parallelism().map_or(1, usize::from);
    asked.map_or_else(processors, |n| n as usize)
}

/// Processes every item on several threads, in their order; the first error ends the work.
///
/// Threads of their own, not those of rayon: work is timed and holds locks, and a thread of rayon that waits inside a
/// solver takes up another piece meanwhile.
pub fn in_parallel<T: Sync, E: Send>(
    threads: usize,
    items: &[T],
    work: impl Fn(&T) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let queue = Mutex::new(items.iter());
    let next = || lock(&queue).next();
    let one = || {
        while let Some(item) = next() {
            work(item).inspect_err(|_| *lock(&queue) = [].iter())?;
        }
        Ok(())
    };
    let own = Resources::own();
    std::thread::scope(|scope| {
        let all: Vec<_> = (0..threads.min(items.len()))
            .map(|_| scope.spawn(|| own.within(one)))
            .collect();
        all.into_iter()
            .map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic)))
            .fold(Ok(()), Result::and)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use gearbench_reference::limits::Memory;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn every_item_once_and_the_first_error_ends_it() {
        let items: Vec<usize> = (1..=100).collect();
        for threads in [1, 3, 200] {
            let sum = AtomicUsize::new(0);
            let done: Result<(), usize> = in_parallel(threads, &items, |i| {
                sum.fetch_add(*i, Ordering::Relaxed);
                Ok(())
            });
            assert_eq!((done, sum.into_inner()), (Ok(()), 5050));
        }
        let count = AtomicUsize::new(0);
        let failed = in_parallel(1, &items, |i| {
            count.fetch_add(1, Ordering::Relaxed);
            if *i == 7 { Err(*i) } else { Ok(()) }
        });
        assert_eq!((failed, count.into_inner()), (Err(7), 7));
        assert_eq!(in_parallel(4, &[] as &[u8], |_| Err(())), Ok(()));
    }

    #[test]
    fn its_threads_have_the_resources_of_the_study() {
        let small = Resources {
            memory: Memory::of(1.0),
            ..Resources::default()
        };
        let limits = Mutex::new(Vec::new());
        let work = |_: &u8| {
            lock(&limits).push(Resources::own().memory.limit());
            Ok::<_, ()>(())
        };
        small.within(|| in_parallel(2, &[0; 4], work)).unwrap();
        assert_eq!(*lock(&limits), [1.0; 4]);
    }
}
