//! Independent jobs on two threads.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The results of `job(0)` to `job(count - 1)`, in order; two threads take the jobs in turn.
pub(crate) fn in_turn<S: Send>(count: usize, job: impl Fn(usize) -> S + Sync) -> Vec<S> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                return done;
            }
            done.push((i, job(i)));
        }
    };
    let mut all = std::thread::scope(|scope| {
        let other = (count > 1).then(|| scope.spawn(work));
        let mut all = work();
        if let Some(other) = other {
            all.extend(other.join().unwrap_or_else(|panic| resume_unwind(panic)));
        }
        all
    });
    all.sort_by_key(|(i, _)| *i);
    all.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn results_come_in_order() {
        for count in [0, 1, 2, 37] {
            let squares = super::in_turn(count, |i| i * i);
            assert!(squares.iter().enumerate().all(|(i, s)| *s == i * i));
            assert_eq!(squares.len(), count);
        }
    }
}
