//! Which nodes elements join to bodies.

use crate::deck::Deck;

pub(super) use crate::groups::Groups;

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
pub(in crate::gear_deck) fn count(deck: &Deck) -> usize {
    let mut groups = joined(deck);
    let elements = 0..deck.element_count() as u32;
    let first = elements.map(|e| groups.find(deck.element(e)[0]));
    first.collect::<std::collections::HashSet<u32>>().len()
}
