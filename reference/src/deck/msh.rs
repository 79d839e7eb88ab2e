//! Meshes of Gmsh, `.msh` 4.1 and 2.2 as text, as a [`Deck`] without material.
//!
//! Physical groups of volumes become element sets, those of surfaces, lines and points node sets, by their names in
//! lower case, or `physical_surface_3` where they have none. Without groups entities do: `volume1`, `surface12`.
//! Gmsh numbers the mid-side nodes of solids in another order than decks. Format: Gmsh reference manual 4.13, chapter
//! *File formats*, sections *MSH* and *Node ordering*.

use super::data::{Deck, ElementBlock, Label};
use super::error::{DeckError, DeckErrorKind, Place, quote};
use super::reader::{MARK, in_si};
use super::units::Units;
use crate::mesh::ElementKind;
use gearbench_models::Vec3;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::str::SplitWhitespace;
use std::sync::Arc;

/// Names of entities by their dimension.
const DIMENSIONS: [&str; 4] = ["point", "line", "surface", "volume"];

/// For each node of a deck its place in Gmsh's order.
const C3D10: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8];
const C3D15: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11];
const C3D20: &[usize] = &[
    0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15,
];
const SAME: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7];

/// Solid kind of one of Gmsh's types, with its order. Hexahedra get the kinds that bend well.
fn solid(kind: u32) -> Option<(ElementKind, &'static [usize])> {
    Some(match kind {
        4 => (ElementKind::C3D4, SAME),
        5 => (ElementKind::C3D8I, SAME),
        6 => (ElementKind::C3D6, SAME),
        11 => (ElementKind::C3D10, C3D10),
        17 => (ElementKind::C3D20, C3D20),
        18 => (ElementKind::C3D15, C3D15),
        _ => return None,
    })
}

/// Name and number of nodes of a type that is no solid.
fn other(kind: u32) -> Option<(&'static str, usize)> {
    Some(match kind {
        1 => ("lines", 2),
        2 => ("triangles", 3),
        3 => ("quadrilaterals", 4),
        8 => ("quadratic lines", 3),
        9 => ("quadratic triangles", 6),
        10 => ("quadrilaterals of 9 nodes", 9),
        15 => ("points", 1),
        16 => ("quadratic quadrilaterals", 8),
        _ => return None,
    })
}

/// Whether a text is such a mesh.
pub(super) fn is_msh(text: &str) -> bool {
    text.trim_start_matches('\u{feff}')
        .trim_start()
        .starts_with("$MeshFormat")
}

/// Reads a mesh from its text.
pub(super) fn read(name: &str, text: &str, units: Option<Units>) -> Result<Deck, DeckError> {
    let mut reader = Reader {
        lines: Lines {
            file: name.into(),
            lines: text.lines(),
            at: 0,
        },
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

/// The lines of the file, blank ones left out.
struct Lines<'a> {
    file: Arc<str>,
    lines: std::str::Lines<'a>,
    at: usize,
}

/// A line with what is left of it.
struct Row<'a> {
    place: Place,
    section: &'static str,
    words: SplitWhitespace<'a>,
}

impl<'a> Lines<'a> {
    fn next(&mut self) -> Option<&'a str> {
        loop {
            self.at += 1;
            let line = self.lines.next()?.trim();
            if !line.is_empty() {
                return Some(line);
            }
        }
    }

    fn place(&self) -> Place {
        Place {
            file: self.file.clone(),
            line: self.at,
        }
    }

    /// The next line of a section.
    fn row(&mut self, section: &'static str, what: &str) -> Result<Row<'a>, DeckError> {
        match self.next() {
            Some(line) if !line.starts_with('$') => Ok(Row {
                place: self.place(),
                section,
                words: line.split_whitespace(),
            }),
            found => {
                let kind = DeckErrorKind::Syntax;
                let found = found.map_or("the end of the file".to_owned(), quote);
                Err((self.place()).error(kind, section, what, found, "is the file whole?"))
            }
        }
    }
}

impl Row<'_> {
    fn error(&self, kind: DeckErrorKind, expected: &str, found: String, help: &str) -> DeckError {
        self.place.error(kind, self.section, expected, found, help)
    }

    fn parsed<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, DeckError> {
        let word = self.words.next().unwrap_or_default();
        let value = word.parse();
        value.map_err(|_| self.error(DeckErrorKind::Syntax, what, quote(word), ""))
    }

    fn count(&mut self, what: &str) -> Result<usize, DeckError> {
        self.parsed(what)
    }

    /// A tag: a whole number from 1 on.
    fn tag(&mut self, what: &str) -> Result<u32, DeckError> {
        match self.parsed::<u32>(what)? {
            0 => Err(self.error(DeckErrorKind::Syntax, what, "0".into(), "")),
            tag => Ok(tag),
        }
    }

    /// A tag of an entity or a group, which may be negative where only its direction counts.
    fn signed(&mut self, what: &str) -> Result<u32, DeckError> {
        Ok(self.parsed::<i32>(what)?.unsigned_abs())
    }

    fn dimension(&mut self) -> Result<usize, DeckError> {
        match self.parsed::<usize>("a dimension from 0 to 3")? {
            d @ 0..=3 => Ok(d),
            d => Err(self.error(
                DeckErrorKind::Syntax,
                "a dimension from 0 to 3",
                d.to_string(),
                "",
            )),
        }
    }

    fn position(&mut self) -> Result<Vec3, DeckError> {
        let mut x = Vec3::zeros();
        for k in 0..3 {
            x[k] = self.parsed("a finite number")?;
            if !x[k].is_finite() {
                let found = x[k].to_string();
                return Err(self.error(DeckErrorKind::Syntax, "a finite number", found, ""));
            }
        }
        Ok(x)
    }
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

#[cfg(test)]
mod tests;
