//! Checks that are possible only after the whole deck was read.

use super::{Reader, known};
use crate::data::{Deck, Target};
use crate::error::{DeckError, DeckErrorKind};
use gearbench_solid_fe::element::Inside;
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

impl Reader<'_> {
    pub(super) fn finish(&mut self) -> Result<(), DeckError> {
        self.closed()?;
        if let Some(open) = &self.step {
            return Err(open.step.place.error(
                DeckErrorKind::Syntax,
                "*STEP",
                "*END STEP",
                format!("the end of the deck after line {}", self.lexer.place().line),
                "close the step",
            ));
        }
        self.sections()?;
        self.deck.settle_others();
        self.contacts()?;
        self.transformed();
        let idle: Vec<&str> = (self.parts.iter())
            .filter(|(_, part)| !part.nodes.is_empty())
            .map(|(name, _)| name.as_str())
            .collect();
        if self.deck.instances.is_empty() && !idle.is_empty() {
            let error = |found: String| {
                DeckError::new(
                    DeckErrorKind::Reference,
                    "*PART",
                    "an *INSTANCE of this part in an *ASSEMBLY",
                    found,
                    "a part becomes a body through an instance",
                )
                .at(&self.deck.name, 0)
            };
            return Err(error(format!("none of {}", idle.join(", "))));
        }
        self.deck.check_elements()
    }

    /// Sections name sets of solids and materials that are linear and isotropic.
    fn sections(&self) -> Result<(), DeckError> {
        let deck = &self.deck;
        for s in &deck.sections {
            let context = "*SOLID SECTION";
            known(&s.place, context, "element set", &s.set, &deck.element_sets)?;
            let members = &deck.element_sets[&s.set];
            if let Some(&other) = members.iter().find(|e| **e & super::non_solids::MARK != 0) {
                let label = deck
                    .others
                    .elements
                    .get_index((other & !super::non_solids::MARK) as usize);
                let label = label.map_or(0, |(l, _)| l.number);
                return Err(s.place.error(
                    DeckErrorKind::Unsupported,
                    context,
                    "solid elements in its set",
                    format!("element {label} of another type"),
                    "remove it, or mesh it as a solid",
                ));
            }
            if members.is_empty() {
                continue;
            }
            known(&s.place, context, "material", &s.material, &deck.materials)?;
            if let Some(beyond) = &deck.materials[&s.material].beyond {
                return Err(beyond.place.error(
                    DeckErrorKind::Unsupported,
                    beyond.keyword.clone(),
                    format!("linear elasticity of material `{}`: E and nu", s.material),
                    "more",
                    format!(
                        "{}; remove the line if the elastic part of the material is sufficient",
                        beyond.reason
                    ),
                ));
            }
        }
        Ok(())
    }

    fn contacts(&mut self) -> Result<(), DeckError> {
        let passed = &self.passed_surfaces;
        let before = self.deck.contact_pairs.len();
        self.deck
            .contact_pairs
            .retain(|p| !passed.contains(&p.slave) && !passed.contains(&p.master));
        for _ in self.deck.contact_pairs.len()..before {
            self.count_passed("*CONTACT PAIR".to_owned());
        }
        let deck = &self.deck;
        for p in &deck.contact_pairs {
            let context = "*CONTACT PAIR";
            known(&p.place, context, "surface", &p.slave, &deck.surfaces)?;
            known(&p.place, context, "surface", &p.master, &deck.surfaces)?;
            let interactions = &deck.interactions;
            known(
                &p.place,
                context,
                "surface interaction",
                &p.interaction,
                interactions,
            )?;
        }
        Ok(())
    }

    /// Marks the conditions that count in axes of their own: in all three directions at zero it is the same.
    fn transformed(&mut self) {
        let deck = &mut self.deck;
        let sets = self.transforms.iter();
        let nodes = sets.flat_map(|set| deck.node_sets.get(set).into_iter().flatten());
        let turned: HashSet<u32> = nodes.copied().collect();
        let (mut marked, node_sets) = (0, &deck.node_sets);
        let steps = deck.steps.iter_mut().flat_map(|s| &mut s.boundaries);
        for b in deck.boundaries.iter_mut().chain(steps) {
            let at = match &b.target {
                Target::Node(node) => turned.contains(node),
                Target::Set(set) => node_sets
                    .get(set)
                    .is_some_and(|s| s.iter().any(|n| turned.contains(n))),
            };
            b.own_axes = at && (b.directions != [1, 3] || b.value != 0.0);
            marked += usize::from(b.own_axes);
        }
        if marked > 0 {
            deck.notes
                .push(format!("{marked} conditions are in local axes"));
        }
    }
}

impl Deck {
    /// Refuses solid elements on the same nodes under two labels, which would count twice.
    fn check_twins(&self) -> Result<(), DeckError> {
        let mut nodes = Vec::new();
        let mut hashed: Vec<(u64, u32)> = Vec::with_capacity(self.element_count());
        for e in 0..self.element_count() as u32 {
            nodes.clear();
            nodes.extend_from_slice(self.element(e));
            nodes.sort_unstable();
            let mut hash = DefaultHasher::new();
            nodes.hash(&mut hash);
            hashed.push((hash.finish(), e));
        }
        hashed.sort_unstable();
        let sorted = |e: u32| {
            let mut nodes = self.element(e).to_vec();
            nodes.sort_unstable();
            nodes
        };
        let twins = hashed.windows(2).filter(|w| w[0].0 == w[1].0);
        let twins = twins.map(|w| [w[0].1, w[1].1]);
        match twins.clone().find(|[a, b]| sorted(*a) == sorted(*b)) {
            None => Ok(()),
            Some([a, b]) => Err(self.block(b).place.error(
                DeckErrorKind::Reference,
                "*ELEMENT",
                "each solid element once",
                format!(
                    "elements {} and {} on the same nodes",
                    self.element_name(a),
                    self.element_name(b)
                ),
                "remove one of them: its stiffness and its mass would count twice",
            )),
        }
    }

    /// Refuses elements that are turned inside out and elements that are there twice, with their labels.
    pub(crate) fn check_elements(&self) -> Result<(), DeckError> {
        self.check_twins()?;
        let mut x = Vec::new();
        for block in &self.blocks {
            let inside = Inside::new(block.kind);
            let elements = block.connectivity.chunks_exact(block.kind.nodes());
            for (e, nodes) in (block.first..).zip(elements) {
                x.clear();
                x.extend(nodes.iter().map(|&n| self.nodes[n as usize]));
                if let Some(determinant) = inside.wrong(&x) {
                    return Err(block.place.error(
                        DeckErrorKind::Gear,
                        "*ELEMENT",
                        "elements with a positive Jacobian",
                        format!(
                            "element {} with the Jacobian {determinant:.3e}",
                            self.element_name(e)
                        ),
                        "check the order of its nodes and the shape of the mesh there",
                    ));
                }
            }
        }
        Ok(())
    }
}
