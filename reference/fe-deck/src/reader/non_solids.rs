//! Elements that are no solids: lines and surfaces beside them, as Gmsh writes them.
//!
//! Without a section of their own they have neither stiffness nor mass: they are ignored, and their sets become node
//! sets, which is their purpose. With one they are declined at the section.

use super::Reader;
use crate::data::{Deck, Label};
use crate::error::DeckError;
use crate::lexer::{Data, Keyword};
use gearbench_solid_fe::mesh::ElementKind;
use indexmap::IndexMap;
use std::collections::{BTreeMap, HashSet};

/// Marks the number of an element that is no solid, in sets of elements while a deck is read.
pub(crate) const MARK: u32 = 1 << 31;

/// Elements that are no solids.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct NonSolidElements {
    /// Nodes of elements that are not solids.
    pub(super) elements: IndexMap<Label, Vec<u32>>,
    /// How many there are of each type.
    pub(super) types: BTreeMap<String, u32>,
    /// Solids that are replaced by another kind, with a description.
    pub(super) taken: BTreeMap<String, u32>,
}

/// Returns the solid kind that an element type is read as. Hybrid, coupled and modified kinds have the nodes of a
/// plain one, and for a compressible isotropic solid the same stiffness up to the error of the element. Reduced
/// integration of linear hexahedra needs hourglass control, which differs between programs, so that incompatible modes
/// are used instead.
pub(super) fn solid(name: &str) -> Option<ElementKind> {
    let name = name.to_ascii_uppercase();
    if let Some(kind) = ElementKind::from_name(&name) {
        return Some(kind);
    }
    let rest = name.strip_prefix("C3D")?;
    let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let (nodes, letters) = rest.split_at(digits);
    let among = |known: &[&str]| known.contains(&letters);
    match nodes {
        "8" if among(&["R", "RH", "RT", "RHT", "IH"]) => Some(ElementKind::C3D8I),
        "8" if among(&["H", "T", "HT", "S", "HS"]) => Some(ElementKind::C3D8),
        "20" if among(&["H", "T", "HT"]) => Some(ElementKind::C3D20),
        "20" if among(&["RH", "RT", "RHT"]) => Some(ElementKind::C3D20R),
        "4" if among(&["H", "T", "HT"]) => Some(ElementKind::C3D4),
        "10" if among(&["H", "M", "MH", "HS", "I", "R", "T", "HT", "MT", "MHT"]) => {
            Some(ElementKind::C3D10)
        }
        "6" if among(&["H", "R", "T", "HT", "RH", "RT"]) => Some(ElementKind::C3D6),
        "15" if among(&["H", "T", "HT"]) => Some(ElementKind::C3D15),
        _ => None,
    }
}

/// Nodes of an element type that is no solid, if it may be passed over.
pub(super) fn nodes_of_other(name: &str) -> Option<usize> {
    let name = name.to_ascii_uppercase();
    let one = [
        "MASS", "ROTARYI", "SPRING1", "DASHPOT1", "DCOUP3D", "POINT3D",
    ];
    let two = [
        "SPRINGA", "SPRING2", "DASHPOTA", "DASHPOT2", "GAPUNI", "CONN3D2",
    ];
    match name.as_str() {
        n if one.contains(&n) => return Some(1),
        n if two.contains(&n) => return Some(2),
        "D" => return Some(3),
        "STRI3" => return Some(3),
        "STRI65" => return Some(6),
        _ => {}
    }
    // Trusses, beams, pipes; plane and axisymmetric bodies, shells, membranes, surfaces, rigid faces; fluids.
    for (prefix, sizes) in [
        ("T2D", "23"),
        ("T3D", "23"),
        ("B21", ""),
        ("CPS", "3468"),
        ("CPE", "3468"),
        ("CGAX", "3468"),
        ("CAX", "3468"),
        ("SFM3D", "3468"),
        ("M3D", "3468"),
        ("R2D", "2"),
        ("RAX", "2"),
        ("R3D", "34"),
        ("F3D", "468"),
        ("SC", "68"),
        ("S", "3468"),
    ] {
        let Some(size) = name.strip_prefix(prefix).and_then(|r| r.chars().next()) else {
            continue;
        };
        if sizes.contains(size) {
            return size.to_digit(10).map(|d| d as usize);
        }
    }
    let beam = name.strip_prefix("PIPE").or(name.strip_prefix('B'))?;
    match beam.as_bytes() {
        [b'2' | b'3', b'1' | b'3', ..] => Some(2),
        [b'2' | b'3', b'2', ..] => Some(3),
        _ => None,
    }
}

impl Reader<'_> {
    /// Elements that are no solids.
    pub(super) fn other_elements(
        &mut self,
        k: &Keyword,
        name: &str,
        nodes: usize,
    ) -> Result<Vec<u32>, DeckError> {
        let first = self.deck.others.elements.len() as u32;
        while let Some(data) = self.lexer.data()? {
            let label = self.new_label(k, &data)?;
            let mut own = Vec::new();
            self.nodes_of_other(k, data, nodes, &mut own)?;
            self.deck.others.elements.insert(label, own);
        }
        let end = self.deck.others.elements.len() as u32;
        *self.deck.others.types.entry(name.to_owned()).or_default() += end - first;
        Ok((first..end).map(|e| e | MARK).collect())
    }

    /// As those of solids; nodes that are left out or 0 are none, and twice the same is no trouble.
    fn nodes_of_other(
        &mut self,
        k: &Keyword,
        mut data: Data,
        count: usize,
        out: &mut Vec<u32>,
    ) -> Result<(), DeckError> {
        let (mut seen, mut skip) = (0, 1);
        loop {
            for text in data.fields.get(skip..).unwrap_or_default() {
                seen += 1;
                if !text.is_empty() && text != "0" {
                    out.push(self.node_at(k, &data, text)?);
                }
            }
            if seen >= count {
                return Ok(());
            }
            match self.lexer.data()? {
                Some(more) => (data, skip) = (more, 0),
                None => return Ok(()),
            }
        }
    }
}

impl Deck {
    /// Returns the number of an element, with [`MARK`] for one that is not a solid.
    pub(crate) fn any_element(&self, label: Label) -> Option<u32> {
        let other = || self.others.elements.get_index_of(&label);
        match self.element_labels.get_index_of(&label) {
            Some(e) => Some(e as u32),
            None => other().map(|e| e as u32 | MARK),
        }
    }

    /// Adds an element that is no solid; gives its number among those.
    pub(crate) fn add_other(&mut self, label: Label, name: &str, nodes: Vec<u32>) -> u32 {
        let number = self.others.elements.len() as u32;
        self.others.elements.insert(label, nodes);
        match self.others.types.get_mut(name) {
            Some(count) => *count += 1,
            None => {
                self.others.types.insert(name.to_owned(), 1);
            }
        }
        number
    }

    /// Nodes of an element that may be no solid.
    pub(super) fn nodes_of_any(&self, element: u32) -> &[u32] {
        if element & MARK == 0 {
            return self.element(element);
        }
        let other = self.others.elements.get_index((element & !MARK) as usize);
        other.map_or(&[], |(_, nodes)| nodes)
    }

    /// Takes those that are no solids out of the sets; their sets become node sets.
    pub(crate) fn settle_others(&mut self) {
        let mut named = Vec::new();
        let sets = std::mem::take(&mut self.element_sets);
        for (name, members) in sets {
            let (others, solids): (Vec<u32>, Vec<u32>) =
                members.into_iter().partition(|e| e & MARK != 0);
            let only = solids.is_empty() && !others.is_empty();
            if !others.is_empty() && !self.node_sets.contains_key(&name) {
                let mut seen = HashSet::new();
                let nodes = others.iter().flat_map(|&e| self.nodes_of_any(e));
                let nodes = nodes.copied().filter(|n| seen.insert(*n)).collect();
                self.node_sets.insert(name.clone(), nodes);
                named.push(name.clone());
            }
            if !only {
                self.element_sets.insert(name, solids);
            }
        }
        for (words, count) in &self.others.taken {
            self.notes.push(format!("{words} ({count} elements)"));
        }
        if self.others.elements.is_empty() {
            return;
        }
        let types = self.others.types.iter();
        let types: Vec<String> = types.map(|(name, n)| format!("{n} {name}")).collect();
        let mut note = format!(
            "ignored elements that are not solids and have no section: {}",
            types.join(", ")
        );
        if !named.is_empty() {
            named.sort_unstable();
            let more = named.len().saturating_sub(8);
            named.truncate(8);
            note.push_str(&format!(
                "; their nodes are the node sets {}",
                named.join(", ")
            ));
            if more > 0 {
                note.push_str(&format!(" and {more} more"));
            }
        }
        self.notes.push(note);
    }
}
