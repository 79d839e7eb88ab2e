//! One basis for all gears of a process that need the same: a comparison builds a scene once per entry, with the
//! same meshes. Studies share it as well: the key is the hash of all that a basis depends on, so that none of them can
//! change the result of another, and memory is taken once.
//!
//! A second request waits for the first. A basis with more modes serves requests for fewer; these use the lowest modes
//! of it, so that a result does not depend on earlier requests.
//!
//! Bases that no gear uses any more are kept for later requests, up to [`MOST_UNUSED`] of them: a scan makes a thousand
//! scenes whose gears differ.

use super::{Basis, ModeSelection, ReductionError, Request};
use crate::hash::Hash;
use crate::resources::Resources;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::HashMap;
use std::panic::resume_unwind;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Largest basis so far, with the selection of modes that it covers.
type Slot = Arc<Mutex<Option<(ModeSelection, Arc<Basis>)>>>;

/// Slots by the hash of their body, each with the number of its last request.
#[derive(Default)]
struct Bases {
    slots: HashMap<Hash, (Slot, u64)>,
    requests: u64,
}

static BASES: Mutex<Option<Bases>> = Mutex::new(None);

/// Largest number of bases that are kept though no gear uses them.
const MOST_UNUSED: usize = 32;

impl Bases {
    /// The slot of a body. Of the bases that no gear uses and no thread computes, those that were not requested for
    /// longest are dropped.
    fn slot(&mut self, body: Hash) -> Slot {
        self.requests += 1;
        let entry = self.slots.entry(body).or_default();
        entry.1 = self.requests;
        let slot = entry.0.clone();
        let mut unused: Vec<(u64, Hash)> = (self.slots.iter())
            .filter(|(_, (slot, _))| is_unused(slot))
            .map(|(body, (_, request))| (*request, *body))
            .collect();
        if let Some(excess) = unused.len().checked_sub(MOST_UNUSED) {
            unused.sort_unstable_by_key(|(request, _)| *request);
            for (_, body) in &unused[..excess] {
                self.slots.remove(body);
            }
        }
        slot
    }
}

/// True if nothing but the table has a slot and its basis.
fn is_unused(slot: &Slot) -> bool {
    let basis = |held: &Option<(ModeSelection, Arc<Basis>)>| {
        held.as_ref()
            .is_none_or(|(_, basis)| Arc::strong_count(basis) == 1)
    };
    Arc::strong_count(slot) == 1 && slot.try_lock().is_ok_and(|held| basis(&held))
}

impl ModeSelection {
    /// Returns true if the modes selected by `self` include those of `other`.
    fn holds(self, other: ModeSelection, found: &Basis) -> bool {
        let highest = found.omega.last().copied().unwrap_or(0.0) / std::f64::consts::TAU;
        match (self, other) {
            (ModeSelection::Count(n), ModeSelection::Count(m)) => n >= m,
            (ModeSelection::UpTo(f), ModeSelection::UpTo(g)) => f >= g,
            (ModeSelection::Count(_), ModeSelection::UpTo(g)) => highest > g,
            (ModeSelection::UpTo(_), ModeSelection::Count(m)) => found.omega.len() >= m,
        }
    }
}

/// The basis of a request, computed at most once, and not at all where the cache has it.
pub fn basis_of(request: &Request<'_>) -> Result<Arc<Basis>, ReductionError> {
    let wanted = request.wanted;
    // A basis that was not finished leaves an empty slot: nothing is lost with a poisoned lock.
    let slot = {
        let mut all = BASES.lock().unwrap_or_else(PoisonError::into_inner);
        all.get_or_insert_default().slot(request.body_hash())
    };
    let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((held, found)) = &*slot
        && held.holds(wanted, found)
    {
        return Ok(found.clone());
    }
    let cache = Resources::own().cache;
    let cached = apart(|| cache.basis(request, "a scene", || request.compute()))?;
    let found = cached.basis;
    *slot = Some((wanted, found.clone()));
    Ok(found)
}

/// Runs a job on dedicated threads, while the calling thread only waits.
///
/// A thread of rayon that waits for a part of its work takes up other work meanwhile. With the slot of a basis locked
/// that could be a gear that waits for the same slot, and both would wait for ever.
fn apart<R: Send>(job: impl FnOnce() -> R + Send) -> R {
    static THREADS: OnceLock<Option<ThreadPool>> = OnceLock::new();
    let threads = THREADS.get_or_init(|| ThreadPoolBuilder::new().build().ok());
    let Some(threads) = threads else { return job() };
    let own = Resources::own();
    let job = || own.within(job);
    let done = std::thread::scope(|scope| scope.spawn(|| threads.install(job)).join());
    done.unwrap_or_else(|panic| resume_unwind(panic))
}

/// Returns the number of modes of a basis that `wanted` selects, in whole families.
pub fn lowest(basis: &Basis, wanted: ModeSelection) -> usize {
    let mut count = match wanted {
        ModeSelection::Count(n) => n.min(basis.omega.len()),
        ModeSelection::UpTo(f) => {
            let limit = std::f64::consts::TAU * f;
            basis.omega.partition_point(|w| *w <= limit)
        }
    };
    while count > 0 && count < basis.family.len() && basis.family[count] == basis.family[count - 1]
    {
        count += 1;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear_mesh;
    use crate::reduction::Mounting;
    use crate::test_support::{coarse, stub};
    use gearbench_models::stiffness::Material;
    use rayon::prelude::*;

    /// A thousand bodies that differ: bases in use stay, of the others the last ones.
    #[test]
    fn bases_that_nothing_uses_are_dropped() {
        let body = |i: usize| {
            let mut hash = Hash::START;
            hash.count(i);
            hash
        };
        let mut bases = Bases::default();
        let used: Vec<Slot> = (0..50).map(|i| bases.slot(body(i))).collect();
        (50..1000).for_each(|i| drop(bases.slot(body(i))));
        assert!(bases.slots.len() <= used.len() + MOST_UNUSED + 1);
        assert!((0..50).all(|i| Arc::ptr_eq(&bases.slot(body(i)), &used[i])));
        assert!(bases.slots.contains_key(&body(999)) && !bases.slots.contains_key(&body(500)));
    }

    /// More gears than threads, all of them in the pool that the computation would use too.
    #[test]
    fn gears_that_are_built_in_parallel_share_a_basis_and_do_not_wait_for_each_other() {
        let sector = gear_mesh::sector(&stub(8, 0.0), &coarse(1, 1)).unwrap();
        let request = Request {
            along_profile: false,
            foreign: None,
            mesh: &sector,
            sector: true,
            material: Material::STEEL,
            mounting: Mounting::gear(true, 0.0),
            wanted: ModeSelection::Count(20),
        };
        let found: Vec<_> = (0..64)
            .into_par_iter()
            .map(|_| basis_of(&request).unwrap())
            .collect();
        assert!(found.iter().all(|b| Arc::ptr_eq(b, &found[0])));
    }
}
