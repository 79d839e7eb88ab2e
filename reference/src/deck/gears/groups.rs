//! Which nodes elements join to bodies.

use crate::deck::data::Deck;

/// Groups of nodes that elements join.
pub(super) struct Groups(Vec<u32>);

impl Groups {
    pub(super) fn new(n: usize) -> Self {
        Groups((0..n as u32).collect())
    }

    pub(super) fn find(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }

    /// Joins two groups; the smaller number leads.
    pub(super) fn join(&mut self, i: u32, j: u32) {
        let (i, j) = (self.find(i), self.find(j));
        self.0[i.max(j) as usize] = i.min(j);
    }
}

/// Nodes that elements join.
pub(super) fn joined(deck: &Deck) -> Groups {
    let mut groups = Groups::new(deck.nodes.len());
    for block in &deck.blocks {
        for element in block.connectivity.chunks_exact(block.kind.nodes()) {
            for &n in &element[1..] {
                groups.join(element[0], n);
            }
        }
    }
    groups
}

/// How many bodies a deck has.
pub(in crate::deck) fn count(deck: &Deck) -> usize {
    let mut groups = joined(deck);
    let elements = 0..deck.element_count() as u32;
    let first = elements.map(|e| groups.find(deck.element(e)[0]));
    first.collect::<std::collections::HashSet<u32>>().len()
}
