//! Nodes, elements and sets.

use super::{Reader, at_most, known, label, named, number_or_zero, options, whole};
use crate::deck::data::ElementBlock;
use crate::deck::error::{DeckError, quote};
use crate::deck::lexer::{Data, Keyword};
use crate::mesh::ElementKind;
use gearbench_models::Vec3;
use std::collections::HashSet;

/// What a set is made of.
#[derive(Clone, Copy)]
enum Of {
    Nodes,
    Elements,
}

impl Reader<'_> {
    pub(super) fn heading(&mut self, k: &Keyword) -> Result<(), DeckError> {
        options(k, [], &[])?;
        while let Some(data) = self.lexer.data()? {
            self.deck.heading.push(data.fields.join(", "));
        }
        Ok(())
    }

    pub(super) fn node(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [set] = options(k, ["NSET"], &[])?;
        let set = set.map(|s| named(k, "NSET", Some(s))).transpose()?;
        let mut new = Vec::new();
        while let Some(data) = self.lexer.data()? {
            at_most(k, &data, 4)?;
            let label = label(k, &data, field(&data, 0))?;
            let x = Vec3::new(
                number_or_zero(k, &data, 1)?,
                number_or_zero(k, &data, 2)?,
                number_or_zero(k, &data, 3)?,
            );
            let (dense, new_label) = self.deck.node_labels.insert_full(label);
            if !new_label {
                return Err(data.reference(
                    k,
                    "each node once",
                    format!("label {label} again"),
                    "renumber one of them",
                ));
            }
            self.deck.nodes.push(x);
            new.push(dense as u32);
        }
        if let Some(set) = set {
            self.extend(k, Of::Nodes, set, new);
        }
        Ok(())
    }

    pub(super) fn element(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [kind, set] = options(k, ["TYPE", "ELSET"], &[])?;
        let name = named(k, "TYPE", kind)?;
        let Some(kind) = ElementKind::from_name(&name) else {
            return Err(k.unsupported(
                format!(
                    "an element among {}",
                    ElementKind::ALL.map(ElementKind::name).join(", ")
                ),
                quote(&name.to_ascii_uppercase()),
                "mesh the gear with these solids",
            ));
        };
        let set = set.map(|s| named(k, "ELSET", Some(s))).transpose()?;
        let first = self.deck.element_labels.len() as u32;
        let mut block = ElementBlock {
            kind,
            set: set.clone(),
            first,
            connectivity: Vec::new(),
            place: k.place.clone(),
        };
        let mut sorted: Vec<u32> = Vec::new();
        while let Some(mut data) = self.lexer.data()? {
            let label = label(k, &data, field(&data, 0))?;
            if !self.deck.element_labels.insert(label) {
                return Err(data.reference(
                    k,
                    "each element once",
                    format!("label {label} again"),
                    "renumber one of them",
                ));
            }
            let start = block.connectivity.len();
            let mut skip = 1;
            loop {
                for text in &data.fields[skip.min(data.fields.len())..] {
                    let node = self.node_at(k, &data, text)?;
                    block.connectivity.push(node);
                }
                let count = block.connectivity.len() - start;
                if count == kind.nodes() {
                    break;
                }
                let more = if count < kind.nodes() {
                    self.lexer.data()?
                } else {
                    None
                };
                let Some(more) = more else {
                    return Err(data.syntax(
                        k,
                        format!("{} nodes of element {label}", kind.nodes()),
                        count.to_string(),
                        if count < kind.nodes() {
                            "an element goes on in the next line until it has its nodes"
                        } else {
                            "is it an element of another type?"
                        },
                    ));
                };
                (data, skip) = (more, 0);
            }
            sorted.clear();
            sorted.extend_from_slice(&block.connectivity[start..]);
            sorted.sort_unstable();
            if sorted.windows(2).any(|w| w[0] == w[1]) {
                return Err(data.unsupported(
                    k,
                    format!("{} different nodes of element {label}", kind.nodes()),
                    "one of them twice",
                    "a collapsed hexahedron is a wedge; mesh with hexahedra only",
                ));
            }
        }
        let end = self.deck.element_labels.len() as u32;
        if let Some(set) = set {
            self.extend(k, Of::Elements, set, (first..end).collect());
        }
        if end > first {
            self.deck.blocks.push(block);
        }
        Ok(())
    }

    pub(super) fn nset(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let [set, generate, _] = options(k, ["NSET", "GENERATE", "UNSORTED"], &["INTERNAL"])?;
        let set = named(k, "NSET", set)?;
        let members = self.members(k, Of::Nodes, generate.is_some())?;
        self.extend(k, Of::Nodes, set, members);
        Ok(())
    }

    pub(super) fn elset(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let [set, generate, _] = options(k, ["ELSET", "GENERATE", "UNSORTED"], &["INTERNAL"])?;
        let set = named(k, "ELSET", set)?;
        let members = self.members(k, Of::Elements, generate.is_some())?;
        self.extend(k, Of::Elements, set, members);
        Ok(())
    }

    /// The data lines of a set: labels, names of sets, or ranges.
    fn members(&mut self, k: &Keyword, of: Of, generate: bool) -> Result<Vec<u32>, DeckError> {
        self.outside_step(k)?;
        let mut members = Vec::new();
        let mut taken: HashSet<String> = HashSet::new();
        while let Some(data) = self.lexer.data()? {
            if generate {
                self.range(k, of, &data, &mut members)?;
                continue;
            }
            for text in &data.fields {
                if text.starts_with(|c: char| c.is_ascii_digit()) {
                    members.push(self.member(k, of, &data, text)?);
                    continue;
                }
                let name = text.to_ascii_lowercase();
                let (what, sets) = match of {
                    Of::Nodes => ("node set", &self.deck.node_sets),
                    Of::Elements => ("element set", &self.deck.element_sets),
                };
                known(&data.place, &k.text, what, &name, sets)?;
                // A set named a hundred times adds its members once: a deck cannot grow by repetition.
                if !taken.contains(&name) {
                    members.extend_from_slice(&sets[&name]);
                    taken.insert(name);
                }
            }
        }
        Ok(members)
    }

    fn member(&self, k: &Keyword, of: Of, data: &Data, text: &str) -> Result<u32, DeckError> {
        match of {
            Of::Nodes => self.node_at(k, data, text),
            Of::Elements => self.element_at(k, data, text),
        }
    }

    /// `first, last, increment`, all of which have to be defined.
    fn range(
        &self,
        k: &Keyword,
        of: Of,
        data: &Data,
        members: &mut Vec<u32>,
    ) -> Result<(), DeckError> {
        at_most(k, data, 3)?;
        let first = label(k, data, field(data, 0))?;
        let last = label(k, data, field(data, 1))?;
        let step = match data.fields.get(2) {
            Some(text) => whole(k, data, text, "an increment from 1")?,
            None => 1,
        };
        let labels = match of {
            Of::Nodes => &self.deck.node_labels,
            Of::Elements => &self.deck.element_labels,
        };
        if last < first {
            return Err(data.syntax(
                k,
                "first label, last label, increment",
                format!("{first} to {last}"),
                "put the smaller label first",
            ));
        }
        let mut label = first;
        loop {
            // The first undefined label ends the loop, so that it never runs longer than the deck has labels.
            let Some(dense) = labels.get_index_of(&label) else {
                return Err(data.reference(
                    k,
                    format!("all of {first} to {last} by {step} defined above"),
                    format!("none with label {label}"),
                    "generate existing labels only",
                ));
            };
            members.push(dense as u32);
            match label.checked_add(step) {
                Some(next) if next <= last => label = next,
                _ => return Ok(()),
            }
        }
    }

    /// Adds to a set, each member once.
    fn extend(&mut self, k: &Keyword, of: Of, name: String, members: Vec<u32>) {
        let sets = match of {
            Of::Nodes => &mut self.deck.node_sets,
            Of::Elements => &mut self.deck.element_sets,
        };
        let place = || k.place.clone();
        self.deck.defined.entry(name.clone()).or_insert_with(place);
        let set = sets.entry(name).or_default();
        let mut seen: HashSet<u32> = set.iter().copied().collect();
        set.extend(members.into_iter().filter(|m| seen.insert(*m)));
    }
}

/// A field of a data line; one left out is empty.
pub(super) fn field(data: &Data, i: usize) -> &str {
    data.fields.get(i).map_or("", String::as_str)
}

/// A second definition.
pub(super) fn twice(k: &Keyword, what: &str, name: &str) -> DeckError {
    k.reference(
        format!("each {what} once"),
        format!("{} again", quote(name)),
        "rename one of them",
    )
}
