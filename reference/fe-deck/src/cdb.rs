//! Archives of Ansys (`.cdb`, as `CDWRITE` writes them) as a [`Deck`]: coded blocks of nodes, elements and components, and
//! materials.
//!
//! | command | read as |
//! |---|---|
//! | `NBLOCK` | nodes; rotations of nodal axes are not used |
//! | `ET`, `KEYOPT` | SOLID185, 186, 187, 285 and their older names (45, 95, 92) as solids of decks; other types are passed over |
//! | `EBLOCK,19,SOLID` | elements; repeated nodes make wedges and tetrahedra |
//! | `CMBLOCK` | node sets and element sets, in lower case |
//! | `MP`, `MPDATA` | `EX`, `PRXY` or `NUXY`, `DENS` at one temperature |
//!
//! Other commands are passed over and counted, except those that connect nodes. Format: *Mechanical APDL Programmer's
//! Reference*, chapter *Coded database files*.

pub mod writer;

use super::data::{Deck, DeckMaterial, ElementBlock, Label, Section};
use super::error::{DeckError, DeckErrorKind, Place, quote};
use super::units::{Units, in_si};
use crate::files::take_line;
use gearbench_solid_fe::Vec3;
use gearbench_solid_fe::mesh::ElementKind;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Commands that connect nodes or bodies, with the remedy.
const DECLINED: [&str; 8] = [
    "CE", "CP", "CERIG", "CPINTF", "CEINTF", "RBE3", "CPLGEN", "RBLOCK",
];

/// Returns true if a file is an archive of Ansys: it has a coded block of nodes.
pub(super) fn is_cdb(bytes: &[u8]) -> bool {
    bytes
        .split(|b| *b == b'\n')
        .any(|line| line.len() >= 7 && line[..7].eq_ignore_ascii_case(b"NBLOCK,"))
}

/// Reads an archive from its bytes.
pub(super) fn read(name: &str, bytes: &[u8], units: Option<Units>) -> Result<Deck, DeckError> {
    let mut reader = Reader {
        file: name.into(),
        rest: bytes,
        line: 0,
        deck: Deck {
            name: name.into(),
            ..Deck::default()
        },
        types: HashMap::new(),
        options: HashMap::new(),
        materials: BTreeMap::new(),
        passed: BTreeMap::new(),
    };
    reader.all()?;
    Ok(in_si(reader.deck, units))
}

/// Values of a material.
#[derive(Default)]
struct Values {
    young: Option<f64>,
    poisson: Option<f64>,
    density: Option<f64>,
    elements: Vec<u32>,
    place: Option<Place>,
}

struct Reader<'a> {
    file: Arc<str>,
    rest: &'a [u8],
    line: usize,
    deck: Deck,
    /// Element type by its number.
    types: HashMap<u32, u32>,
    /// KEYOPT(2) by the number of the element type.
    options: HashMap<u32, u32>,
    materials: BTreeMap<u32, Values>,
    /// Types of elements that are no solids, with how often they occur.
    passed: BTreeMap<u32, u32>,
}

/// Widths of the columns of a block.
struct Columns {
    whole: usize,
    number: usize,
}

impl Reader<'_> {
    fn next(&mut self) -> Option<String> {
        let line = take_line(&mut self.rest)?;
        self.line += 1;
        // Characters beyond ASCII would spoil columns of fixed width.
        Some(
            line.iter()
                .map(|b| if b.is_ascii() { char::from(*b) } else { '?' })
                .collect(),
        )
    }

    fn place(&self) -> Place {
        Place {
            file: self.file.clone(),
            line: self.line,
        }
    }

    fn error(
        &self,
        kind: DeckErrorKind,
        context: &str,
        expected: &str,
        found: impl Into<String>,
        help: &str,
    ) -> DeckError {
        self.place().error(kind, context, expected, found, help)
    }

    fn syntax(&self, context: &str, expected: &str, found: &str) -> DeckError {
        self.error(DeckErrorKind::Syntax, context, expected, quote(found), "")
    }

    fn all(&mut self) -> Result<(), DeckError> {
        while let Some(line) = self.next() {
            let command = line.split('!').next().unwrap_or_default().trim().to_owned();
            if command.is_empty() {
                continue;
            }
            let fields: Vec<&str> = command.split(',').map(str::trim).collect();
            let key = fields[0].to_ascii_uppercase();
            match key.as_str() {
                "NBLOCK" => self.nodes()?,
                "EBLOCK" => self.elements(&fields)?,
                "CMBLOCK" => self.component(&fields)?,
                "ET" => self.element_type(&fields)?,
                "KEYOPT" | "KEYOP" => self.option(&fields)?,
                "MP" => self.property(&fields, [1, 2], 3)?,
                "MPDATA" => match fields
                    .get(1)
                    .is_some_and(|f| f.to_ascii_uppercase().starts_with('R'))
                {
                    true => self.property(&fields, [3, 4], 6)?,
                    false => self.property(&fields, [1, 2], 4)?,
                },
                "N" | "E" | "EN"
                    if fields
                        .get(1)
                        .is_some_and(|f| !f.to_ascii_uppercase().starts_with('R')) =>
                {
                    let help = "write the archive by CDWRITE with blocked format";
                    let expected = "nodes and elements in NBLOCK and EBLOCK";
                    let kind = DeckErrorKind::Unsupported;
                    return Err(self.error(kind, &key, expected, quote(&command), help));
                }
                other if DECLINED.contains(&other) => {
                    let help = "let connected parts share their nodes, and remove the command";
                    let expected = "nodes that are connected by their elements only";
                    let kind = DeckErrorKind::Unsupported;
                    return Err(self.error(kind, other, expected, quote(&command), help));
                }
                "TB" | "TBDATA" => self.nonlinear(&fields, &command),
                _ => {
                    let word: String = (key.chars())
                        .take_while(|c| !c.is_whitespace() && *c != '=')
                        .collect();
                    // Commands are words; data lines of other blocks begin with numbers or brackets.
                    if word.starts_with(|c: char| c.is_ascii_alphabetic() || matches!(c, '/' | '*'))
                    {
                        *self.deck.passed_over.entry(word).or_default() += 1;
                    }
                }
            }
        }
        for (number, count) in std::mem::take(&mut self.passed) {
            self.deck.notes.push(format!(
                "{count} elements of type {number} are no solids and are ignored"
            ));
        }
        for (number, values) in std::mem::take(&mut self.materials) {
            let name = format!("material {number}");
            let place = values.place.unwrap_or_else(|| self.place());
            let material = self
                .deck
                .materials
                .entry(name.clone())
                .or_insert(DeckMaterial {
                    elastic: None,
                    density: None,
                    beyond: None,
                    place: place.clone(),
                });
            material.elastic = values.young.zip(values.poisson);
            material.density = values.density;
            if !values.elements.is_empty() {
                if let Some(beyond) = &material.beyond {
                    let kind = DeckErrorKind::Unsupported;
                    let help = "remove the table if the elastic part of the material is sufficient";
                    let expected = format!("linear elasticity of {name}: EX and PRXY");
                    let found = quote(&beyond.keyword);
                    return Err(beyond.place.error(kind, "TB", expected, found, help));
                }
                self.deck.element_sets.insert(name.clone(), values.elements);
                self.deck.sections.push(Section {
                    set: name.clone(),
                    material: name,
                    place,
                });
            }
        }
        self.deck.check_elements()
    }

    fn nonlinear(&mut self, fields: &[&str], command: &str) {
        // Tables of materials change a body; the density may be one.
        if fields[0].eq_ignore_ascii_case("TB")
            && let Some(number) = fields.get(2).and_then(|f| f.parse::<u32>().ok())
        {
            let place = self.place();
            self.materials.entry(number).or_default();
            let material = self.deck.materials.entry(format!("material {number}"));
            material.or_insert_with(|| DeckMaterial {
                elastic: None,
                density: None,
                beyond: Some(super::data::NonlinearProperty {
                    keyword: command.to_owned(),
                    reason: "the material is linear elastic and isotropic".to_owned(),
                    place: place.clone(),
                }),
                place,
            });
        }
    }

    fn whole(&self, context: &str, text: &str) -> Result<u32, DeckError> {
        let number = text.trim().parse();
        number.map_err(|_| self.syntax(context, "a whole number", text))
    }

    fn number(&self, context: &str, text: &str) -> Result<f64, DeckError> {
        let number = text.trim().replace(['D', 'd'], "e").parse::<f64>();
        let number = number.ok().filter(|x| x.is_finite());
        number.ok_or_else(|| self.syntax(context, "a finite number", text))
    }

    fn element_type(&mut self, fields: &[&str]) -> Result<(), DeckError> {
        let [_, number, kind, ..] = fields else {
            return Err(self.syntax("ET", "a number and a type", &fields.join(",")));
        };
        let number = self.whole("ET", number)?;
        let digits = kind.trim_start_matches(|c: char| !c.is_ascii_digit());
        let kind = self.whole("ET", digits)?;
        self.types.insert(number, kind);
        for (option, value) in fields.iter().skip(3).enumerate() {
            if option == 1 && !value.is_empty() {
                let value = self.whole("ET", value)?;
                self.options.insert(number, value);
            }
        }
        Ok(())
    }

    fn option(&mut self, fields: &[&str]) -> Result<(), DeckError> {
        let [_, number, option, value, ..] = fields else {
            return Ok(());
        };
        if *option == "2" {
            let (number, value) = (self.whole("KEYOPT", number)?, self.whole("KEYOPT", value)?);
            self.options.insert(number, value);
        }
        Ok(())
    }

    /// A property of a material: its name and the number of the material at `at`, values from `first` on.
    fn property(&mut self, fields: &[&str], at: [usize; 2], first: usize) -> Result<(), DeckError> {
        let [label, number] = at.map(|i| fields.get(i).copied().unwrap_or_default());
        let label = label.to_ascii_uppercase();
        if !matches!(label.as_str(), "EX" | "PRXY" | "NUXY" | "DENS") {
            let other = matches!(label.as_str(), "EY" | "EZ" | "GXY" | "GYZ" | "GXZ");
            if other {
                let kind = DeckErrorKind::Unsupported;
                let help = "only isotropic materials are read";
                return Err(self.error(kind, "MP", "EX, PRXY and DENS", quote(&label), help));
            }
            return Ok(());
        }
        let number = self.whole("MP", number)?;
        let text = fields.get(first).copied().unwrap_or_default();
        let value = self.number("MP", text)?;
        if let Some(other) = fields.iter().skip(first + 1).find(|f| !f.is_empty()) {
            let kind = DeckErrorKind::Unsupported;
            let help = "give the value at the temperature of operation";
            let expected = "one value, not a function of temperature";
            return Err(self.error(kind, "MP", expected, quote(other), help));
        }
        let place = self.place();
        let values = self.materials.entry(number).or_default();
        values.place.get_or_insert(place);
        match label.as_str() {
            "EX" => values.young = Some(value),
            "DENS" => values.density = Some(value),
            _ => values.poisson = Some(value),
        }
        Ok(())
    }

    /// Reads the format line of a block, such as `(3i9,6e21.13e3)`.
    fn columns(&mut self, context: &str) -> Result<Columns, DeckError> {
        let line = self.next().unwrap_or_default();
        let lower = line.to_ascii_lowercase();
        let width = |letters: &[char]| -> Option<usize> {
            let (_, rest) = lower.split_once(letters)?;
            let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
            digits.parse().ok().filter(|w| (1..=100).contains(w))
        };
        match width(&['i']) {
            Some(whole) => Ok(Columns {
                whole,
                number: width(&['e', 'g', 'f']).unwrap_or(0),
            }),
            None => Err(self.syntax(context, "a format such as (19i9)", &line)),
        }
    }

    fn ended(&self, context: &str) -> DeckError {
        let kind = DeckErrorKind::Syntax;
        let help = "the archive is incomplete";
        self.error(
            kind,
            context,
            "the end of the block, -1",
            "the end of the file",
            help,
        )
    }

    fn nodes(&mut self) -> Result<(), DeckError> {
        let columns = self.columns("NBLOCK")?;
        if columns.number == 0 {
            let kind = DeckErrorKind::Syntax;
            let expected = "a format such as (3i9,6e21.13e3)";
            return Err(self.error(kind, "NBLOCK", expected, "no width of positions", ""));
        }
        loop {
            let line = self.next().ok_or_else(|| self.ended("NBLOCK"))?;
            let text = line.trim();
            if text == "-1" || text.to_ascii_uppercase().starts_with("N,") {
                return Ok(());
            }
            let label = self.whole("NBLOCK", line.get(..columns.whole).unwrap_or(&line))?;
            let from = 3 * columns.whole;
            let mut x = Vec3::zeros();
            for (axis, x) in x.iter_mut().enumerate() {
                let start = from + axis * columns.number;
                let end = (start + columns.number).min(line.len());
                // Trailing zeros of a node are left out.
                if let Some(text) = line.get(start..end).filter(|t| !t.trim().is_empty()) {
                    *x = self.number("NBLOCK", text)?;
                }
            }
            if label == 0 || !self.deck.node_labels.insert(label.into()) {
                let (kind, found) = (DeckErrorKind::Reference, format!("node {label}"));
                return Err(self.error(kind, "NBLOCK", "each node once, from 1", found, ""));
            }
            self.deck.nodes.push(x);
        }
    }

    fn elements(&mut self, fields: &[&str]) -> Result<(), DeckError> {
        let solid = fields
            .get(2)
            .is_some_and(|f| f.eq_ignore_ascii_case("SOLID"));
        if !solid {
            let kind = DeckErrorKind::Unsupported;
            let help = "write the archive by CDWRITE with blocked format";
            return Err(self.error(
                kind,
                "EBLOCK",
                "EBLOCK,19,SOLID",
                quote(&fields.join(",")),
                help,
            ));
        }
        let columns = self.columns("EBLOCK")?;
        let of_line = |reader: &Self, line: &str| -> Result<Vec<u32>, DeckError> {
            let mut all = Vec::new();
            let mut at = 0;
            while let Some(text) = line.get(at..(at + columns.whole).min(line.len())) {
                if text.trim().is_empty() {
                    break;
                }
                all.push(reader.whole("EBLOCK", text)?);
                at += columns.whole;
            }
            Ok(all)
        };
        loop {
            let line = self.next().ok_or_else(|| self.ended("EBLOCK"))?;
            if line.trim() == "-1" {
                return Ok(());
            }
            let mut all = of_line(self, &line)?;
            let (Some(&count), Some(&label)) = (all.get(8), all.get(10)) else {
                return Err(self.syntax("EBLOCK", "eleven numbers and the nodes", &line));
            };
            let (material, kind) = (all[0], all[1]);
            let mut nodes = all.split_off(11);
            let count = count as usize;
            if count > 20 {
                return Err(self.syntax("EBLOCK", "at most 20 nodes", &line));
            }
            while nodes.len() < count {
                let line = self.next().ok_or_else(|| self.ended("EBLOCK"))?;
                let more = of_line(self, &line)?;
                if more.is_empty() {
                    return Err(self.syntax("EBLOCK", "further nodes of the element", &line));
                }
                nodes.extend(more);
            }
            nodes.truncate(count);
            self.element(label, material, kind, &nodes)?;
        }
    }

    fn element(
        &mut self,
        label: u32,
        material: u32,
        number: u32,
        nodes: &[u32],
    ) -> Result<(), DeckError> {
        let Some(&kind) = self.types.get(&number) else {
            let (error, found) = (DeckErrorKind::Reference, format!("type {number}"));
            let help = "ET comes before the elements";
            return Err(self.error(error, "EBLOCK", "an element type of ET", found, help));
        };
        let option = self.options.get(&number).copied().unwrap_or(0);
        let Some((kind, order)) = solid(kind, option, nodes) else {
            // Contact, surface and mass elements beside the solids.
            if matches!(kind, 45 | 92 | 95 | 185..=187 | 285) {
                let error = DeckErrorKind::Unsupported;
                let expected = "a hexahedron, wedge or tetrahedron";
                let found = format!("element {label} of type {kind} with another shape");
                let help = "pyramids are not read: mesh the gear without them";
                return Err(self.error(error, "EBLOCK", expected, found, help));
            }
            *self.passed.entry(kind).or_default() += 1;
            return Ok(());
        };
        let first = self.deck.element_labels.len() as u32;
        if !self.deck.element_labels.insert(Label::from(label)) {
            let (error, found) = (DeckErrorKind::Reference, format!("element {label} again"));
            return Err(self.error(error, "EBLOCK", "each element once", found, ""));
        }
        let mut connectivity = Vec::with_capacity(order.len());
        for place in order {
            let label = nodes[*place];
            let node = self.deck.node_labels.get_index_of(&Label::from(label));
            let Some(node) = node else {
                let (error, found) = (DeckErrorKind::Reference, format!("node {label}"));
                return Err(self.error(error, "EBLOCK", "a node of NBLOCK", found, ""));
            };
            connectivity.push(node as u32);
        }
        self.materials
            .entry(material)
            .or_default()
            .elements
            .push(first);
        let place = self.place();
        match self.deck.blocks.last_mut() {
            Some(block) if block.kind == kind => block.connectivity.extend(connectivity),
            _ => self.deck.blocks.push(ElementBlock {
                kind,
                set: None,
                first,
                connectivity,
                place,
            }),
        }
        Ok(())
    }

    fn component(&mut self, fields: &[&str]) -> Result<(), DeckError> {
        let [_, name, what, count, ..] = fields else {
            return Err(self.syntax(
                "CMBLOCK",
                "a name, NODE or ELEM, a count",
                &fields.join(","),
            ));
        };
        let name = name.to_ascii_lowercase();
        let of_nodes = what.to_ascii_uppercase().starts_with("NODE");
        let count = self.whole("CMBLOCK", count)? as usize;
        let columns = self.columns("CMBLOCK")?;
        let mut members: Vec<u32> = Vec::new();
        let (mut read, mut last) = (0, 0_u32);
        while read < count {
            let line = self.next().ok_or_else(|| self.ended("CMBLOCK"))?;
            let mut at = 0;
            let before = read;
            while let Some(text) = line.get(at..(at + columns.whole).min(line.len())) {
                if text.trim().is_empty() || read == count {
                    break;
                }
                at += columns.whole;
                read += 1;
                let value: i64 = (text.trim().parse())
                    .map_err(|_| self.syntax("CMBLOCK", "a whole number", text))?;
                // A negative number ends a range.
                let (from, to) = match value < 0 {
                    true => (u64::from(last) + 1, value.unsigned_abs()),
                    false => (value.unsigned_abs(), value.unsigned_abs()),
                };
                let labels = match of_nodes {
                    true => &self.deck.node_labels,
                    false => &self.deck.element_labels,
                };
                if to > u64::from(u32::MAX) || to < from || to - from > labels.len() as u64 {
                    return Err(self.syntax(
                        "CMBLOCK",
                        "a label, or the end of a range as a negative number",
                        text,
                    ));
                }
                for label in from..=to {
                    // Members without a place in the mesh, such as elements that are passed over, are left out.
                    if let Some(i) = labels.get_index_of(&Label::from(label as u32)) {
                        members.push(i as u32);
                    }
                }
                last = to as u32;
            }
            if read == before {
                return Err(self.syntax("CMBLOCK", "further members", &line));
            }
        }
        let mut seen = std::collections::HashSet::new();
        members.retain(|m| seen.insert(*m));
        let sets = match of_nodes {
            true => &mut self.deck.node_sets,
            false => &mut self.deck.element_sets,
        };
        sets.insert(name.clone(), members);
        let place = self.place();
        self.deck.defined.entry(name).or_insert(place);
        Ok(())
    }
}

/// Kind of a deck for an element of Ansys, and for each of its nodes the place in the list of Ansys.
fn solid(number: u32, option: u32, nodes: &[u32]) -> Option<(ElementKind, &'static [usize])> {
    const C3D4: &[usize] = &[0, 1, 2, 4];
    const C3D4_ALONE: &[usize] = &[0, 1, 2, 3];
    const C3D6: &[usize] = &[0, 1, 2, 4, 5, 6];
    const C3D10: &[usize] = &[0, 1, 2, 4, 8, 9, 11, 16, 17, 18];
    const C3D15: &[usize] = &[0, 1, 2, 4, 5, 6, 8, 9, 11, 12, 13, 15, 16, 17, 18];
    let same = |a: usize, b: usize| nodes.get(a) == nodes.get(b);
    let brick = |kind: ElementKind| (kind, writer::kind(kind).2);
    // K = L and M = N = O = P make a tetrahedron, K = L and O = P a wedge.
    let tetrahedron = nodes.len() >= 8 && same(2, 3) && same(4, 5) && same(5, 6) && same(6, 7);
    let wedge = nodes.len() >= 8 && same(2, 3) && same(6, 7) && !same(4, 5);
    let whole = nodes.len() >= 8 && !(same(2, 3) || same(4, 5) || same(6, 7));
    match (number, nodes.len()) {
        (45 | 185, 8) if tetrahedron => Some((ElementKind::C3D4, C3D4)),
        (45 | 185, 8) if wedge => Some((ElementKind::C3D6, C3D6)),
        // Enhanced strains and, with the default, extra shapes of SOLID45 are those of incompatible modes.
        (185, 8) if whole && option == 0 => Some(brick(ElementKind::C3D8)),
        (45 | 185, 8) if whole => Some(brick(ElementKind::C3D8I)),
        (95 | 186, 20) if tetrahedron => Some((ElementKind::C3D10, C3D10)),
        (95 | 186, 20) if wedge => Some((ElementKind::C3D15, C3D15)),
        (186, 20) if whole && option == 0 => Some(brick(ElementKind::C3D20R)),
        (95 | 186, 20) if whole => Some(brick(ElementKind::C3D20)),
        (92 | 187, 10) => Some(brick(ElementKind::C3D10)),
        (285, 4) => Some((ElementKind::C3D4, C3D4_ALONE)),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
