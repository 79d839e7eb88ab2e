//! Meshes of Gmsh, `.msh` 4.1 and 2.2 as text or binary, as a [`Deck`] without material.
//!
//! Physical groups of volumes become element sets, those of surfaces, lines and points node sets, by their names in
//! lower case, or `physical_surface_3` where they have none. Without groups entities do: `volume1`, `surface12`.
//! Gmsh numbers the mid-side nodes of solids in another order than decks. Format: Gmsh reference manual 4.13, chapter
//! *File formats*, sections *MSH* and *Node ordering*.

mod kinds;
mod lines;
mod plain;
#[cfg(test)]
mod tests;

use super::data::{Deck, ElementBlock, Label};
use super::error::{DeckError, DeckErrorKind};
use super::reader::MARK;
use super::units::{Units, in_si};
use gearbench_solid_fe::Vec3;
use kinds::{other, solid};
use lines::{Lines, shown};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Names of entities by their dimension.
const DIMENSIONS: [&str; 4] = ["point", "line", "surface", "volume"];

/// Sections that are read; others are left out.
const SECTIONS: [&str; 5] = [
    "$MeshFormat",
    "$PhysicalNames",
    "$Entities",
    "$Nodes",
    "$Elements",
];

/// Returns true if a file is a mesh of Gmsh.
pub(super) fn is_msh(bytes: &[u8]) -> bool {
    let mark = "\u{feff}".as_bytes();
    let text = bytes.strip_prefix(mark).unwrap_or(bytes);
    text.trim_ascii_start().starts_with(b"$MeshFormat")
}

/// Reads a mesh from its bytes.
pub(super) fn read(name: &str, bytes: &[u8], units: Option<Units>) -> Result<Deck, DeckError> {
    let mut reader = Reader {
        lines: Lines::new(name, bytes),
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

impl Reader<'_> {
    fn all(&mut self) -> Result<(), DeckError> {
        let mut seen = HashSet::new();
        while let Some(line) = self.lines.next() {
            self.lines.begin_text("");
            let syntax = DeckErrorKind::Syntax;
            let Some(name) = line.strip_prefix(b"$") else {
                let (expected, help) = ("a section such as $Nodes", "is a count too small?");
                return Err(self.lines.error(syntax, expected, shown(line), help));
            };
            if !seen.insert(line) {
                let (expected, help) = ("each section once", "one mesh in a file");
                return Err(self.lines.error(syntax, expected, shown(line), help));
            }
            let section = SECTIONS.into_iter().find(|s| s.as_bytes() == line);
            let end = format!("$End{}", String::from_utf8_lossy(name));
            match section {
                Some("$MeshFormat") => self.format()?,
                Some("$PhysicalNames") => self.physical_names()?,
                Some("$Entities") => self.entities()?,
                Some("$Nodes") if self.version > 3.0 => self.nodes()?,
                Some("$Nodes") => self.plain_nodes()?,
                Some("$Elements") if self.version > 3.0 => self.elements()?,
                Some("$Elements") => self.plain_elements()?,
                _ => self.lines.skip_to(&end),
            }
            self.lines.begin_text(section.unwrap_or_default());
            let found = self.lines.next();
            if found != Some(end.as_bytes()) {
                let found = found.map_or("the end of the file".to_owned(), shown);
                let help = "check the count of the section";
                return Err(self.lines.error(syntax, end, found, help));
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
        let lines = &mut self.lines;
        lines.begin_text("$MeshFormat");
        lines.row("version, 0 for text or 1 for binary, 8")?;
        self.version = lines.parsed("a version")?;
        let binary: u32 = lines.parsed("0 for text, 1 for binary")?;
        let unsupported = DeckErrorKind::Unsupported;
        let ways = "convert the file: `gmsh -format msh41 -save in.msh`";
        if !matches!(self.version, 4.1 | 2.2) {
            let found = self.version.to_string();
            return Err(lines.error(unsupported, "version 4.1 or 2.2", found, ways));
        }
        match binary {
            0 => Ok(()),
            1 => match lines.parsed::<u32>("8, the bytes of a number")? {
                8 => lines.turn_binary(self.version > 3.0),
                other => {
                    let expected = "numbers of 8 bytes";
                    Err(lines.error(unsupported, expected, other.to_string(), ways))
                }
            },
            other => {
                let expected = "0 for text, 1 for binary";
                Err(lines.error(unsupported, expected, other.to_string(), ways))
            }
        }
    }

    fn physical_names(&mut self) -> Result<(), DeckError> {
        let (lines, what) = (&mut self.lines, "dimension, tag, \"name\"");
        lines.begin_text("$PhysicalNames");
        lines.row("a count")?;
        for _ in 0..lines.parsed::<usize>("a count")? {
            lines.row(what)?;
            let (dimension, tag) = (lines.dimension()?, lines.signed(what)?);
            let name = lines.rest().trim_matches('"').to_ascii_lowercase();
            self.names
                .insert((dimension, tag), name.replace('\u{0}', ""));
        }
        Ok(())
    }

    fn entities(&mut self) -> Result<(), DeckError> {
        let lines = &mut self.lines;
        lines.begin("$Entities");
        lines.row("four counts")?;
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = lines.count("four counts")?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                lines.row("an entity")?;
                let tag = lines.signed("a tag")?;
                // Where it is, or the corners of its box.
                for _ in 0..if dimension == 0 { 1 } else { 2 } {
                    lines.position()?;
                }
                let mut groups = Vec::new();
                for _ in 0..lines.count("a count of groups")? {
                    groups.push(lines.signed("a group")?);
                }
                if dimension > 0 {
                    lines.pass_list("entities around it")?;
                }
                self.groups.insert((dimension, tag), groups);
            }
        }
        Ok(())
    }

    fn node(&mut self, tag: u32, x: Vec3) -> Result<(), DeckError> {
        if !self.deck.node_labels.insert(tag.into()) {
            let (kind, found) = (DeckErrorKind::Reference, format!("tag {tag} again"));
            return Err(self.lines.error(kind, "each node once", found, ""));
        }
        self.deck.nodes.push(x);
        Ok(())
    }

    /// The counts in front of blocks: how many there are, then of all, least and greatest tag.
    fn blocks(&mut self) -> Result<usize, DeckError> {
        self.lines.row("counts")?;
        let blocks = self.lines.count("a count of blocks")?;
        self.lines.pass_numbers(3)?;
        Ok(blocks)
    }

    fn nodes(&mut self) -> Result<(), DeckError> {
        self.lines.begin("$Nodes");
        for _ in 0..self.blocks()? {
            let (lines, what) = (&mut self.lines, "dimension, entity, parametric, count");
            lines.row(what)?;
            let dimension = lines.dimension()?;
            lines.signed(what)?;
            // Behind the position then stand as many coordinates as the entity has dimensions.
            let more = if lines.small(what)? > 0 { dimension } else { 0 };
            let count = lines.count(what)?;
            let mut tags = Vec::new();
            for _ in 0..count {
                lines.row("the tag of a node")?;
                tags.push(lines.tag("the tag of a node")?);
            }
            for tag in tags {
                self.lines.row("x, y, z")?;
                let x = self.lines.position()?;
                self.lines.pass_numbers(more)?;
                self.node(tag, x)?;
            }
        }
        Ok(())
    }

    fn elements(&mut self) -> Result<(), DeckError> {
        self.lines.begin("$Elements");
        for _ in 0..self.blocks()? {
            let (lines, what) = (&mut self.lines, "dimension, entity, type, count");
            lines.row(what)?;
            let (dimension, entity) = (lines.dimension()?, lines.signed(what)?);
            let (kind, count) = (lines.small(what)?, lines.count(what)?);
            let groups = self
                .groups
                .get(&(dimension, entity))
                .cloned()
                .unwrap_or_default();
            let sets = self.sets(dimension, entity, &groups);
            for _ in 0..count {
                self.lines.row("an element")?;
                let tag = self.lines.tag("the tag of an element")?;
                self.element(tag, kind, &sets)?;
            }
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

    fn element(&mut self, tag: u32, kind: u32, sets: &[String]) -> Result<(), DeckError> {
        let label = Label::from(tag);
        if self.deck.any_element(label).is_some() {
            let found = format!("tag {tag} again");
            return Err((self.lines).error(
                DeckErrorKind::Reference,
                "each element once",
                found,
                "",
            ));
        }
        let count = match (solid(kind), other(kind)) {
            (Some((kind, _)), _) => kind.nodes(),
            (None, Some((_, count))) => count,
            (None, None) => {
                let expected = "tetrahedra, wedges and hexahedra of the first or second order";
                let help =
                    "for the second order without nodes inside set Mesh.SecondOrderIncomplete = 1";
                return Err(self.lines.error(
                    DeckErrorKind::Unsupported,
                    expected,
                    format!("type {kind}"),
                    help,
                ));
            }
        };
        let mut nodes = Vec::with_capacity(count);
        for _ in 0..count {
            let tag = self.lines.tag("the tag of a node")?;
            let Some(node) = self.deck.node_labels.get_index_of(&Label::from(tag)) else {
                let found = format!("tag {tag}");
                return Err((self.lines).error(
                    DeckErrorKind::Reference,
                    "a node of $Nodes",
                    found,
                    "",
                ));
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
                        place: self.lines.place(),
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
