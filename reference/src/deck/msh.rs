//! Meshes of Gmsh, `.msh` 4.1 and 2.2 as text, as a [`Deck`] without material.
//!
//! Physical groups of volumes become element sets, those of surfaces, lines and points node sets, by their names in
//! lower case, or `physical_surface_3` where they have none. Without groups entities do: `volume1`, `surface12`.
//! Gmsh numbers the mid-side nodes of solids in another order than decks. Format: Gmsh reference manual 4.13, chapter
//! *File formats*, sections *MSH* and *Node ordering*.

mod kinds;
mod lines;
#[cfg(test)]
mod tests;

use super::data::{Deck, ElementBlock, Label};
use super::error::{DeckError, DeckErrorKind, quote};
use super::reader::{MARK, in_si};
use super::units::Units;
use gearbench_models::Vec3;
use kinds::{other, solid};
use lines::{Lines, Row};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Names of entities by their dimension.
const DIMENSIONS: [&str; 4] = ["point", "line", "surface", "volume"];

/// Whether a text is such a mesh.
pub(super) fn is_msh(text: &str) -> bool {
    text.trim_start_matches('\u{feff}')
        .trim_start()
        .starts_with("$MeshFormat")
}

/// Reads a mesh from its text.
pub(super) fn read(name: &str, text: &str, units: Option<Units>) -> Result<Deck, DeckError> {
    let mut reader = Reader {
        lines: Lines::new(name, text),
        deck: Deck {
            name: name.into(),
            ..Deck::default()
        },
        names: HashMap::new(),
        groups: HashMap::new(),
        members: BTreeMap::new(),
        grouped: false,
        version: 0.0,
    };
    reader.all()?;
    Ok(in_si(reader.deck, units))
}

struct Reader<'a> {
    lines: Lines<'a>,
    deck: Deck,
    /// Names of physical groups by dimension and tag.
    names: HashMap<(usize, u32), String>,
    /// Physical groups of entities by dimension and tag.
    groups: HashMap<(usize, u32), Vec<u32>>,
    /// Members of the sets, elements that are no solids with [`MARK`].
    members: BTreeMap<String, Vec<u32>>,
    /// Some element belongs to a physical group.
    grouped: bool,
    version: f64,
}

impl<'a> Reader<'a> {
    fn all(&mut self) -> Result<(), DeckError> {
        let mut seen = HashSet::new();
        while let Some(line) = self.lines.next() {
            if !seen.insert(line) {
                let help = "one mesh in a file";
                let kind = DeckErrorKind::Syntax;
                return Err((self.lines.place()).error(
                    kind,
                    "",
                    "each section once",
                    quote(line),
                    help,
                ));
            }
            match line {
                "$MeshFormat" => self.format()?,
                "$PhysicalNames" => self.physical_names()?,
                "$Entities" => self.entities()?,
                "$Nodes" if self.version > 3.0 => self.nodes()?,
                "$Nodes" => self.plain_nodes()?,
                "$Elements" if self.version > 3.0 => self.elements()?,
                "$Elements" => self.plain_elements()?,
                _ => {}
            }
            let Some(name) = line.strip_prefix('$') else {
                let kind = DeckErrorKind::Syntax;
                let help = "was a count too small?";
                return Err((self.lines.place()).error(
                    kind,
                    "",
                    "a section such as $Nodes",
                    quote(line),
                    help,
                ));
            };
            // Sections of other data are left out.
            let known = [
                "$MeshFormat",
                "$PhysicalNames",
                "$Entities",
                "$Nodes",
                "$Elements",
            ];
            loop {
                match self.lines.next() {
                    Some(end) if end.strip_prefix("$End") == Some(name) => break,
                    Some(_) if !known.contains(&line) => {}
                    found => {
                        let found = found.map_or("the end of the file".to_owned(), quote);
                        let kind = DeckErrorKind::Syntax;
                        let help = "does the count of the section fit?";
                        return Err((self.lines.place()).error(
                            kind,
                            line,
                            format!("$End{name}"),
                            found,
                            help,
                        ));
                    }
                }
            }
        }
        let grouped = self.grouped;
        let is_group = |name: &str| !name.starts_with('\u{0}');
        for (name, members) in std::mem::take(&mut self.members) {
            if is_group(&name) == grouped {
                let name = name.trim_start_matches('\u{0}').to_owned();
                self.deck.element_sets.insert(name, members);
            }
        }
        self.deck.settle_others();
        self.deck.check_elements()
    }

    fn format(&mut self) -> Result<(), DeckError> {
        let mut row = self.lines.row("$MeshFormat", "version, 0 for text, 8")?;
        self.version = row.parsed("a version")?;
        let binary: u32 = row.parsed("0 for text")?;
        let ways = "save it as text: `gmsh -format msh41 -save in.msh`, or Mesh.Binary = 0";
        if binary != 0 {
            return Err(row.error(
                DeckErrorKind::Unsupported,
                "a mesh as text",
                "a binary one".into(),
                ways,
            ));
        }
        match self.version {
            4.1 | 2.2 => Ok(()),
            v => Err(row.error(
                DeckErrorKind::Unsupported,
                "version 4.1 or 2.2",
                v.to_string(),
                ways,
            )),
        }
    }

    fn physical_names(&mut self) -> Result<(), DeckError> {
        let what = "dimension, tag, \"name\"";
        let count = self
            .lines
            .row("$PhysicalNames", "a count")?
            .count("a count")?;
        for _ in 0..count {
            let mut row = self.lines.row("$PhysicalNames", what)?;
            let (dimension, tag) = (row.dimension()?, row.signed(what)?);
            let rest: Vec<&str> = row.words.collect();
            let name = rest.join(" ").trim_matches('"').to_ascii_lowercase();
            self.names
                .insert((dimension, tag), name.replace('\u{0}', ""));
        }
        Ok(())
    }

    fn entities(&mut self) -> Result<(), DeckError> {
        let mut row = self.lines.row("$Entities", "four counts")?;
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = row.count("four counts")?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let mut row = self.lines.row("$Entities", "an entity")?;
                let tag = row.signed("a tag")?;
                // Where it is, or the corners of its box.
                for _ in 0..if dimension == 0 { 1 } else { 2 } {
                    row.position()?;
                }
                let mut groups = Vec::new();
                for _ in 0..row.count("a count of groups")? {
                    groups.push(row.signed("a group")?);
                }
                self.groups.insert((dimension, tag), groups);
            }
        }
        Ok(())
    }

    fn node(&mut self, row: &Row<'_>, tag: u32, x: Vec3) -> Result<(), DeckError> {
        if !self.deck.node_labels.insert(tag.into()) {
            let found = format!("tag {tag} again");
            return Err(row.error(DeckErrorKind::Reference, "each node once", found, ""));
        }
        self.deck.nodes.push(x);
        Ok(())
    }

    fn nodes(&mut self) -> Result<(), DeckError> {
        let blocks = self
            .lines
            .row("$Nodes", "counts")?
            .count("a count of blocks")?;
        for _ in 0..blocks {
            let what = "dimension, entity, parametric, count";
            let mut row = self.lines.row("$Nodes", what)?;
            row.dimension()?;
            row.signed(what)?;
            row.count(what)?;
            let count = row.count(what)?;
            let mut tags = Vec::new();
            for _ in 0..count {
                tags.push(
                    self.lines
                        .row("$Nodes", "the tag of a node")?
                        .tag("the tag of a node")?,
                );
            }
            for tag in tags {
                let mut row = self.lines.row("$Nodes", "x, y, z")?;
                let x = row.position()?;
                self.node(&row, tag, x)?;
            }
        }
        Ok(())
    }

    fn plain_nodes(&mut self) -> Result<(), DeckError> {
        let count = self.lines.row("$Nodes", "a count")?.count("a count")?;
        for _ in 0..count {
            let mut row = self.lines.row("$Nodes", "tag, x, y, z")?;
            let (tag, x) = (row.tag("the tag of a node")?, row.position()?);
            self.node(&row, tag, x)?;
        }
        Ok(())
    }

    fn elements(&mut self) -> Result<(), DeckError> {
        let blocks = self
            .lines
            .row("$Elements", "counts")?
            .count("a count of blocks")?;
        for _ in 0..blocks {
            let what = "dimension, entity, type, count";
            let mut row = self.lines.row("$Elements", what)?;
            let (dimension, entity) = (row.dimension()?, row.signed(what)?);
            let (kind, count) = (row.parsed(what)?, row.count(what)?);
            let groups = self
                .groups
                .get(&(dimension, entity))
                .cloned()
                .unwrap_or_default();
            let sets = self.sets(dimension, entity, &groups);
            for _ in 0..count {
                let mut row = self.lines.row("$Elements", "an element")?;
                let tag = row.tag("the tag of an element")?;
                self.element(row, tag, kind, &sets)?;
            }
        }
        Ok(())
    }

    fn plain_elements(&mut self) -> Result<(), DeckError> {
        let count = self.lines.row("$Elements", "a count")?.count("a count")?;
        for _ in 0..count {
            let what = "tag, type, count of tags, tags, nodes";
            let mut row = self.lines.row("$Elements", what)?;
            let (tag, kind) = (row.tag(what)?, row.parsed(what)?);
            let mut tags = [0; 2];
            for i in 0..row.count(what)? {
                let value = row.signed(what)?;
                if let Some(tag) = tags.get_mut(i) {
                    *tag = value;
                }
            }
            let dimension = match kind {
                15 => 0,
                1 | 8 => 1,
                2 | 3 | 9 | 10 | 16 => 2,
                _ => 3,
            };
            let group = Some(tags[0]).filter(|g| *g > 0);
            let sets = self.sets(dimension, tags[1], group.as_slice());
            self.element(row, tag, kind, &sets)?;
        }
        Ok(())
    }

    /// Names of the sets of an entity; the one of the entity itself is marked, for it counts only without groups.
    fn sets(&mut self, dimension: usize, entity: u32, groups: &[u32]) -> Vec<String> {
        self.grouped |= !groups.is_empty();
        let name = DIMENSIONS[dimension];
        let mut sets = vec![format!("\u{0}{name}{entity}")];
        sets.extend(
            groups
                .iter()
                .map(|&g| match self.names.get(&(dimension, g)) {
                    Some(name) => name.clone(),
                    None => format!("physical_{name}_{g}"),
                }),
        );
        sets
    }

    fn element(
        &mut self,
        mut row: Row<'_>,
        tag: u32,
        kind: u32,
        sets: &[String],
    ) -> Result<(), DeckError> {
        let label = Label::from(tag);
        if self.deck.any_element(label).is_some() {
            let found = format!("tag {tag} again");
            return Err(row.error(DeckErrorKind::Reference, "each element once", found, ""));
        }
        let count = match (solid(kind), other(kind)) {
            (Some((kind, _)), _) => kind.nodes(),
            (None, Some((_, count))) => count,
            (None, None) => {
                let expected = "tetrahedra, wedges and hexahedra of the first or second order";
                let help =
                    "for the second order without nodes inside set Mesh.SecondOrderIncomplete = 1";
                return Err(row.error(
                    DeckErrorKind::Unsupported,
                    expected,
                    format!("type {kind}"),
                    help,
                ));
            }
        };
        let mut nodes = Vec::with_capacity(count);
        for _ in 0..count {
            let tag = row.tag("the tag of a node")?;
            let Some(node) = self.deck.node_labels.get_index_of(&Label::from(tag)) else {
                let found = format!("tag {tag}");
                return Err(row.error(DeckErrorKind::Reference, "a node of $Nodes", found, ""));
            };
            nodes.push(node as u32);
        }
        let number = match (solid(kind), other(kind)) {
            (Some((kind, order)), _) => {
                let number = self.deck.element_labels.len() as u32;
                self.deck.element_labels.insert(label);
                let nodes = order.iter().take(count).map(|&i| nodes[i]);
                match self.deck.blocks.last_mut() {
                    Some(block) if block.kind == kind => block.connectivity.extend(nodes),
                    _ => self.deck.blocks.push(ElementBlock {
                        kind,
                        set: None,
                        first: number,
                        connectivity: nodes.collect(),
                        place: row.place,
                    }),
                }
                number
            }
            (None, other) => {
                let name = other.map_or("others", |o| o.0);
                self.deck.add_other(label, name, nodes) | MARK
            }
        };
        for set in sets {
            match self.members.get_mut(set) {
                Some(members) => members.push(number),
                None => {
                    self.members.insert(set.clone(), vec![number]);
                }
            }
        }
        Ok(())
    }
}
