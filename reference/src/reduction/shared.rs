//! One basis for all gears of a process that need the same: a comparison builds a scene once per entry, with the
//! same meshes.
//!
//! Who comes second waits for the first. A basis with more modes serves those who want fewer; they take the lowest
//! of it, so a result does not depend on who came before.

use super::{Basis, Mounting, ReductionError, Request, Wanted, cache};
use crate::mesh::GearMesh;
use gearbench_models::Vec3;
use gearbench_models::stiffness::Material;
use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::sync::{Arc, Mutex, PoisonError};

/// What a basis belongs to: mesh, material, mounting. Two hashes of everything that enters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Key([u64; 2]);

impl Key {
    /// Of a mesh, or of the sector of a gear whose teeth are all alike.
    #[must_use]
    pub fn new(mesh: &GearMesh, sector: bool, material: &Material, mounting: &Mounting) -> Self {
        let hash = |seed: u64| {
            let mut h = DefaultHasher::new();
            seed.hash(&mut h);
            (sector, mounting.free, mesh.teeth).hash(&mut h);
            mounting
                .motion
                .of(&Vec3::x())
                .iter()
                .for_each(|x| x.to_bits().hash(&mut h));
            for x in [
                mounting.added_inertia,
                material.young,
                material.poisson,
                material.density,
            ] {
                x.to_bits().hash(&mut h);
            }
            for x in mesh.mesh.nodes.iter().flat_map(|x| x.iter()) {
                x.to_bits().hash(&mut h);
            }
            mesh.mesh.kind.hash(&mut h);
            mesh.mesh.connectivity.hash(&mut h);
            mesh.bore.hash(&mut h);
            for g in &mesh.flanks {
                (g.tooth, g.side, g.rows, g.columns).hash(&mut h);
                g.nodes.hash(&mut h);
            }
            h.finish()
        };
        Key([hash(0), hash(0x9e37_79b9_7f4a_7c15)])
    }
}

/// The largest basis so far and what it holds.
type Slot = Arc<Mutex<Option<(Wanted, Arc<Basis>)>>>;

static BASES: Mutex<Option<HashMap<Key, Slot>>> = Mutex::new(None);

impl Wanted {
    /// Whether what was asked for `self` holds what `other` asks for.
    fn holds(self, other: Wanted, found: &Basis) -> bool {
        let highest = found.omega.last().copied().unwrap_or(0.0) / std::f64::consts::TAU;
        match (self, other) {
            (Wanted::Count(n), Wanted::Count(m)) => n >= m,
            (Wanted::UpTo(f), Wanted::UpTo(g)) => f >= g,
            (Wanted::Count(_), Wanted::UpTo(g)) => highest > g,
            (Wanted::UpTo(_), Wanted::Count(m)) => found.omega.len() >= m,
        }
    }
}

/// The basis of a mesh (`sector`: of the gear that the sector of tooth 0 makes), computed at most once, and not at all
/// where the cache has it.
///
/// # Errors
/// As [`Request::compute`].
pub fn basis_of(
    mesh: &GearMesh,
    sector: bool,
    material: &Material,
    mounting: &Mounting,
    wanted: Wanted,
) -> Result<Arc<Basis>, ReductionError> {
    let key = Key::new(mesh, sector, material, mounting);
    // A basis that was not finished leaves an empty slot: nothing is lost with a poisoned lock.
    let slot = {
        let mut all = BASES.lock().unwrap_or_else(PoisonError::into_inner);
        all.get_or_insert_default().entry(key).or_default().clone()
    };
    let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((held, found)) = &*slot
        && held.holds(wanted, found)
    {
        return Ok(found.clone());
    }
    let request = Request {
        mesh,
        sector,
        material: *material,
        mounting: *mounting,
        wanted,
    };
    let cached = cache::in_use().basis(&request, "a scene", || request.compute())?;
    let found = cached.basis;
    *slot = Some((wanted, found.clone()));
    Ok(found)
}

/// Number of modes of a basis that `wanted` asks for, whole families.
#[must_use]
pub fn lowest(basis: &Basis, wanted: Wanted) -> usize {
    let mut count = match wanted {
        Wanted::Count(n) => n.min(basis.omega.len()),
        Wanted::UpTo(f) => {
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
