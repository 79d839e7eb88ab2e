//! The flank nodes of a gear that take part in contact at a state.

use super::spring::UNUSED;
use crate::gear::FlankDisplacement;
use gearbench_integrators::system::StateView;

/// Flank nodes of a gear near contact, with their displacements and forces. Buffers are reused.
#[derive(Clone, Debug, Default)]
pub struct GearNodes {
    /// Node numbers of the gear, in the order of registration.
    pub nodes: Vec<u32>,
    /// Numbers of the same nodes for displacements along the profile, where the gear supports these.
    pub along: Vec<u32>,
    /// Outward displacement before residual compliance, `B q + r T` [m].
    pub displacement: Vec<f64>,
    /// Residual displacement `u` [m].
    pub residual: Vec<f64>,
    /// Force into the tooth [N].
    pub force: Vec<f64>,
    /// Friction force against the direction along the profile [N].
    pub friction_force: Vec<f64>,
    /// Index of the node in the solve; [`UNUSED`] for nodes without solved points.
    pub index: Vec<u32>,
    /// Load `T` on the hub [N m or N].
    pub load: f64,
    /// Bound of the displacements before residual compliance [m]; `None` until it is needed.
    bound: Option<f64>,
    /// Slot of each flank node of the gear, valid if its stamp is the present one.
    slots: Vec<(u32, u32)>,
    stamp: u32,
    /// Residual displacements and forces of the last evaluation by flank node, from which an active-set search starts.
    last: Vec<f64>,
    /// Change of those displacements since the evaluation before [m], for nodes registered in both, with the stamp of
    /// the last evaluation.
    changes: Vec<(f64, u32)>,
    pressed: Vec<f64>,
}

impl GearNodes {
    /// Starts an evaluation with a load on the hub.
    pub fn begin(&mut self, load: f64) {
        for ((&node, &u), &f) in self.nodes.iter().zip(&self.residual).zip(&self.force) {
            let (change, stamp) = &mut self.changes[node as usize];
            let followed = stamp.wrapping_add(1) == self.stamp;
            let last = &mut self.last[node as usize];
            (*change, *stamp) = (if followed { u - *last } else { 0.0 }, self.stamp);
            *last = u;
            self.pressed[node as usize] = f;
        }
        self.nodes.clear();
        self.along.clear();
        self.displacement.clear();
        self.residual.clear();
        self.force.clear();
        self.friction_force.clear();
        self.index.clear();
        self.load = load;
        self.bound = None;
        self.stamp = self.stamp.wrapping_add(1);
        if self.stamp == 0 {
            self.slots.fill((0, 0));
            self.stamp = 1;
        }
    }

    /// Returns a bound of the displacements of flank nodes before residual compliance [m].
    #[inline]
    pub fn bound(&mut self, field: &dyn FlankDisplacement, at: StateView<'_>) -> f64 {
        *self.bound.get_or_insert_with(|| {
            field.bound(at) + (field.largest_hub_compliance() * self.load).abs()
        })
    }

    /// Registers consecutive nodes that are not registered yet, and returns the slot of the first.
    pub fn meet_new(
        &mut self,
        field: &dyn FlankDisplacement,
        at: StateView<'_>,
        nodes: &[u32],
    ) -> u32 {
        let first = self.nodes.len();
        let all = first + nodes.len();
        self.nodes.extend_from_slice(nodes);
        if let Some(further) = field.along_profile() {
            self.along.extend(nodes.iter().map(|node| node + further));
        }
        self.displacement.resize(all, 0.0);
        let new = &mut self.displacement[first..];
        field.displacements(at.q, nodes, new);
        if self.load != 0.0 {
            // The residual displacements are zero yet: room for the compliances.
            self.residual.resize(all, 0.0);
            let by_load = &mut self.residual[first..];
            field.hub_compliance(nodes, by_load);
            for (a, r) in new.iter_mut().zip(by_load) {
                *a += *r * self.load;
                *r = 0.0;
            }
        }
        self.residual.resize(all, 0.0);
        self.force.resize(all, 0.0);
        self.friction_force.resize(all, 0.0);
        self.index.resize(all, UNUSED);
        if let Some(&most) = nodes.iter().max()
            && most as usize >= self.last.len()
        {
            self.last.resize(most as usize + 1, 0.0);
            self.changes.resize(most as usize + 1, (0.0, 0));
            self.pressed.resize(most as usize + 1, 0.0);
        }
        first as u32
    }

    /// Registers nodes and returns their slots; displacements are computed when a node is registered first.
    pub fn meet<const N: usize>(
        &mut self,
        field: &dyn FlankDisplacement,
        at: StateView<'_>,
        nodes: &[u32; N],
    ) -> [u32; N] {
        // New nodes are registered together.
        let (mut new, mut count) = ([0; N], 0);
        let mut next = self.nodes.len() as u32;
        let slots = nodes.map(|node| {
            let i = node as usize;
            if i >= self.slots.len() {
                self.slots.resize(i + 1, (0, 0));
            }
            let (stamp, slot) = &mut self.slots[i];
            if *stamp != self.stamp {
                (*stamp, *slot) = (self.stamp, next);
                new[count] = node;
                (count, next) = (count + 1, next + 1);
            }
            *slot
        });
        if count > 0 {
            self.meet_new(field, at, &new[..count]);
        }
        slots
    }

    /// Returns the values at slots, or zeros for a gear without a field.
    #[inline]
    pub fn at(values: &[f64], slots: &[u32; 4]) -> [f64; 4] {
        if slots[0] == UNUSED {
            return [0.0; 4];
        }
        slots.map(|s| values[s as usize])
    }

    /// Returns the total displacement at slots [m].
    #[inline]
    pub fn total(&self, slots: &[u32; 4]) -> [f64; 4] {
        let (a, u) = (
            Self::at(&self.displacement, slots),
            Self::at(&self.residual, slots),
        );
        [a[0] + u[0], a[1] + u[1], a[2] + u[2], a[3] + u[3]]
    }

    /// Returns true if the node at a slot was loaded in the last evaluation in which it was registered.
    #[inline]
    pub fn was_pressed(&self, slot: u32) -> bool {
        self.pressed[self.nodes[slot as usize] as usize] > 0.0
    }

    /// Extrapolates the residual displacement of the node at a slot from the last two evaluations [m].
    #[inline]
    pub fn expected(&self, slot: u32) -> f64 {
        let node = self.nodes[slot as usize] as usize;
        let (change, stamp) = self.changes[node];
        let followed = stamp.wrapping_add(1) == self.stamp;
        self.last[node] + if followed { change } else { 0.0 }
    }
}

/// Returns the weighted sum `w . a`.
#[inline]
pub fn weighted(w: &[f64; 4], a: &[f64; 4]) -> f64 {
    w[0] * a[0] + w[1] * a[1] + w[2] * a[2] + w[3] * a[3]
}
