//! The nodes of a gear that take part in contact at a state.

use super::spring::UNUSED;
use crate::gear::FlankDisplacement;
use gearbench_integrators::system::At;

/// Flank nodes of a gear near contact, with what is known of them. Buffers grow and stay.
#[derive(Clone, Debug, Default)]
pub struct GearNodes {
    /// The gear's node numbers, in the order in which they were met.
    pub nodes: Vec<u32>,
    /// The same along the profile, where the gear knows that.
    pub along: Vec<u32>,
    /// Outward displacement before residual compliance, `B q + r T` [m].
    pub displacement: Vec<f64>,
    /// Residual displacement `u` [m].
    pub residual: Vec<f64>,
    /// Force into the tooth [N].
    pub force: Vec<f64>,
    /// Force against the direction along the profile [N].
    pub rub: Vec<f64>,
    /// Index in the solve; [`UNUSED`] for nodes that no solved point lies on.
    pub index: Vec<u32>,
    /// Load `T` on the hub [N m] or [N].
    pub load: f64,
    /// A bound of the displacements before residual compliance [m], once asked for.
    bound: Option<f64>,
    /// Slot of each of the gear's flank nodes, valid where its stamp is the present one.
    slots: Vec<(u32, u32)>,
    stamp: u32,
    /// Residual displacements and forces of the last evaluation by flank node: where an active set begins.
    last: Vec<f64>,
    /// How much those displacements had changed since the evaluation before [m], where the node had been met there too, and
    /// the stamp of the last one.
    changes: Vec<(f64, u32)>,
    pressed: Vec<f64>,
}

impl GearNodes {
    /// Begins an evaluation with a load on the hub.
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
        self.rub.clear();
        self.index.clear();
        self.load = load;
        self.bound = None;
        self.stamp = self.stamp.wrapping_add(1);
        if self.stamp == 0 {
            self.slots.fill((0, 0));
            self.stamp = 1;
        }
    }

    /// A bound of the displacements of flank nodes before residual compliance [m].
    #[inline]
    pub fn bound(&mut self, field: &dyn FlankDisplacement, at: At<'_>) -> f64 {
        *self.bound.get_or_insert_with(|| {
            field.bound(at) + (field.largest_hub_compliance() * self.load).abs()
        })
    }

    /// Slots of consecutive nodes that were not met before; the first of them.
    pub fn meet_new(&mut self, field: &dyn FlankDisplacement, at: At<'_>, nodes: &[u32]) -> u32 {
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
        self.rub.resize(all, 0.0);
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

    /// Slots of nodes; their displacements are found when they are met for the first time.
    pub fn meet<const N: usize>(
        &mut self,
        field: &dyn FlankDisplacement,
        at: At<'_>,
        nodes: &[u32; N],
    ) -> [u32; N] {
        // Those that are new are met together.
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

    /// Values at slots; zeros for those of a gear without a field.
    #[inline]
    pub fn at(values: &[f64], slots: &[u32; 4]) -> [f64; 4] {
        if slots[0] == UNUSED {
            return [0.0; 4];
        }
        slots.map(|s| values[s as usize])
    }

    /// Total displacement at slots [m].
    #[inline]
    pub fn total(&self, slots: &[u32; 4]) -> [f64; 4] {
        let (a, u) = (
            Self::at(&self.displacement, slots),
            Self::at(&self.residual, slots),
        );
        [a[0] + u[0], a[1] + u[1], a[2] + u[2], a[3] + u[3]]
    }

    /// Whether the node at a slot carried a force in the last evaluation that met it.
    #[inline]
    pub fn was_pressed(&self, slot: u32) -> bool {
        self.pressed[self.nodes[slot as usize] as usize] > 0.0
    }

    /// Residual displacement of the node at a slot if it goes on as in the last two evaluations [m].
    #[inline]
    pub fn expected(&self, slot: u32) -> f64 {
        let node = self.nodes[slot as usize] as usize;
        let (change, stamp) = self.changes[node];
        let followed = stamp.wrapping_add(1) == self.stamp;
        self.last[node] + if followed { change } else { 0.0 }
    }
}

/// `w . a`.
#[inline]
pub fn weighted(w: &[f64; 4], a: &[f64; 4]) -> f64 {
    w[0] * a[0] + w[1] * a[1] + w[2] * a[2] + w[3] * a[3]
}
