//! From lines to a [`Deck`]: one function per keyword, in `model.rs`, `properties.rs`, `contact.rs` and `step.rs`.
//!
//! | what | owns |
//! |---|---|
//! | `assembly` | parts, instances and where they stand |
//! | `non_solids` | elements that are no solids, and their sets |
//! | `passed` | keywords that change no body, and those that do |
//! | `finish` | what can only be checked at the end of the deck |
//!
//! An unknown keyword is declined with its line: without it the reader might build a different body than the deck
//! describes. Known keywords that do not change a body are ignored and counted.

mod assembly;
mod contact;
mod finish;
mod model;
mod non_solids;
mod passed;
mod properties;
mod step;
#[cfg(test)]
mod tests;

pub(crate) use non_solids::{MARK, NonSolidElements};

use super::data::{Deck, Label, Step, Target};
use super::error::{DeckError, DeckErrorKind, Place, quote};
use super::lexer::{Data, Keyword, Lexer, Line, Resolver, is_foreign};
use super::units::{Units, in_si};
use std::collections::{BTreeMap, HashSet};

/// Reads a deck; the resolver returns includes. Without `units` they are determined.
pub(crate) fn read(
    name: &str,
    text: &str,
    units: Option<Units>,
    resolver: &mut Resolver<'_>,
) -> Result<Deck, DeckError> {
    let mut reader = Reader {
        lexer: Lexer::new(name, text, resolver)?,
        deck: Deck {
            name: name.into(),
            ..Deck::default()
        },
        material: None,
        interaction: None,
        step: None,
        parts: BTreeMap::new(),
        scope: None,
        transforms: Vec::new(),
        passed_surfaces: HashSet::new(),
    };
    (reader.all().and_then(|()| reader.finish())).map_err(|e| without_foreign_text(name, e))?;
    Ok(in_si(reader.deck, units))
}

/// Removes text quoted from a file outside the folder of the deck from an error: it may be any file of the machine,
/// and messages end in logs.
fn without_foreign_text(deck: &str, error: DeckError) -> DeckError {
    if *error.file == *deck || !is_foreign(deck, &error.file) {
        return error;
    }
    DeckError {
        context: "".into(),
        found: "an invalid line, not shown because the file is outside the folder of the deck"
            .into(),
        help: "include files from the folder of the deck only".into(),
        ..error
    }
}

/// A step that is being read.
struct OpenStep {
    step: Step,
    /// False until the procedure was read.
    procedure: bool,
}

struct Reader<'a> {
    lexer: Lexer<'a>,
    deck: Deck,
    /// Name of the material that `*ELASTIC` and `*DENSITY` belong to.
    material: Option<String>,
    /// Name of the interaction that `*SURFACE BEHAVIOR` belongs to.
    interaction: Option<String>,
    step: Option<OpenStep>,
    /// Parts by their names.
    parts: BTreeMap<String, Deck>,
    /// The part or instance that is being read: `deck` is its own then.
    scope: Option<assembly::Scope>,
    /// Node sets with axes of their own for conditions.
    transforms: Vec<String>,
    /// Surfaces that are no faces of solids.
    passed_surfaces: HashSet<String>,
}

impl Reader<'_> {
    fn all(&mut self) -> Result<(), DeckError> {
        while let Some(line) = self.lexer.next()? {
            match line {
                Line::Keyword(keyword) => self.keyword(&keyword)?,
                Line::Data(data) => {
                    return Err(data.place.error(
                        DeckErrorKind::Syntax,
                        "",
                        "a keyword line",
                        format!("the data line {}", quote(&data.fields.join(", "))),
                        "the keyword before it has no further data lines; a comment starts with **",
                    ));
                }
            }
        }
        Ok(())
    }

    fn keyword(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.in_scope(k)?;
        match k.key.as_str() {
            "HEADING" => self.heading(),
            "PART" => self.part(k),
            "ENDPART" => self.end_part(k),
            "ASSEMBLY" => self.assembly(k),
            "ENDASSEMBLY" => Ok(()),
            "INSTANCE" => self.instance(k),
            "ENDINSTANCE" => self.end_instance(k),
            "NODE" => self.node(k),
            "ELEMENT" => self.element(k),
            "NSET" => self.nset(k),
            "ELSET" => self.elset(k),
            "SURFACE" => self.surface(k),
            "MATERIAL" => self.material(k),
            "ELASTIC" => self.elastic(k),
            "DENSITY" => self.density(k),
            "SOLIDSECTION" => self.solid_section(k),
            "RIGIDBODY" => self.rigid_body(k),
            "TRANSFORM" => self.transform(k),
            "BOUNDARY" => self.boundary(k),
            "SURFACEINTERACTION" => self.surface_interaction(k),
            "SURFACEBEHAVIOR" => self.surface_behavior(k),
            "FRICTION" | "CONTACTDAMPING" => self.more_of_interaction(k),
            "CONTACTPAIR" => self.contact_pair(k),
            "INITIALCONDITIONS" => self.initial_conditions(k),
            "STEP" => self.begin_step(k),
            "ENDSTEP" => self.end_step(k),
            "STATIC" => self.static_(k),
            "DYNAMIC" => self.dynamic(k),
            "FREQUENCY" => self.frequency(k),
            key if step::REQUESTS.contains(&key) => self.request(k),
            _ => self.other_keyword(k),
        }
    }

    fn outside_step(&self, k: &Keyword) -> Result<(), DeckError> {
        match self.step {
            None => Ok(()),
            Some(_) => Err(k.syntax(
                "model data before the first *STEP",
                "model data inside a step",
                "move them in front of *STEP",
            )),
        }
    }

    /// Takes the next data line, which the keyword needs.
    fn need_data(&mut self, k: &Keyword, what: &str) -> Result<Data, DeckError> {
        match self.lexer.data()? {
            Some(data) => Ok(data),
            None => Err(k.syntax(format!("a data line with {what}"), "none", "")),
        }
    }

    /// A node by its label or a node set by its name.
    fn target(&self, k: &Keyword, data: &Data) -> Result<Target, DeckError> {
        let field = data.fields.first().map_or("", String::as_str);
        if self.is_label(field) {
            return Ok(Target::Node(self.node_at(k, data, field)?));
        }
        let name = field.to_ascii_lowercase();
        known(
            &data.place,
            &k.text,
            "node set",
            &name,
            &self.deck.node_sets,
        )?;
        Ok(Target::Set(name))
    }

    /// Returns true if a field is a label, possibly of an instance as `pinion-1.5`, and not a name.
    fn is_label(&self, field: &str) -> bool {
        if field.starts_with(|c: char| c.is_ascii_digit()) && !field.contains('.') {
            return true;
        }
        match field.rsplit_once('.') {
            Some((instance, number)) => {
                number.parse::<u32>().is_ok() && self.instance_number(instance).is_some()
            }
            None => false,
        }
    }

    /// A label in a field, of an instance if that is given or named in front.
    fn label_at(
        &self,
        k: &Keyword,
        data: &Data,
        field: &str,
        instance: u32,
    ) -> Result<Label, DeckError> {
        if let Some((name, number)) = field.rsplit_once('.')
            && let Some(instance) = self.instance_number(name)
        {
            let number = label(k, data, number)?;
            return Ok(Label { instance, number });
        }
        let number = label(k, data, field)?;
        Ok(Label { instance, number })
    }

    fn node_at(&self, k: &Keyword, data: &Data, field: &str) -> Result<u32, DeckError> {
        self.node_in(k, data, field, 0)
    }

    fn node_in(
        &self,
        k: &Keyword,
        data: &Data,
        field: &str,
        instance: u32,
    ) -> Result<u32, DeckError> {
        let of = |label| self.deck.node_labels.get_index_of(&label).map(|n| n as u32);
        self.labelled(k, data, field, instance, ("a node", "*NODE"), of)
    }

    /// Returns the number of an element, with [`non_solids::MARK`] for one that is not a solid.
    fn element_in(
        &self,
        k: &Keyword,
        data: &Data,
        field: &str,
        instance: u32,
    ) -> Result<u32, DeckError> {
        let of = |label| self.deck.any_element(label);
        self.labelled(k, data, field, instance, ("an element", "*ELEMENT"), of)
    }

    /// Returns the internal number of a label in a field; `what` is its kind, with the keyword that defines it.
    fn labelled(
        &self,
        k: &Keyword,
        data: &Data,
        field: &str,
        instance: u32,
        what: (&str, &str),
        number: impl Fn(Label) -> Option<u32>,
    ) -> Result<u32, DeckError> {
        let label = self.label_at(k, data, field, instance)?;
        number(label).ok_or_else(|| {
            data.reference(
                k,
                format!("{} defined above", what.0),
                format!("label {}", quote(field).trim_matches('`')),
                format!("put {} with this label in front", what.1),
            )
        })
    }
}

/// That a name is defined.
fn known<T>(
    place: &Place,
    context: &str,
    what: &str,
    name: &str,
    map: &BTreeMap<String, T>,
) -> Result<(), DeckError> {
    if map.contains_key(name) {
        return Ok(());
    }
    let mut names: Vec<&str> = map.keys().map(String::as_str).take(8).collect();
    if map.len() > names.len() {
        names.push("...");
    }
    let help = match names.is_empty() {
        true => format!("there is no {what} yet"),
        false => format!("there are {}", quote(&names.join(", "))),
    };
    Err(place.error(
        DeckErrorKind::Reference,
        context,
        format!("a defined {what}"),
        quote(name),
        help,
    ))
}

/// Returns the values of the requested options, in that order; other options are declined, except those in
/// `pass_over`, which have no effect here.
fn options<'k, const N: usize>(
    k: &'k Keyword,
    names: [&str; N],
    pass_over: &[&str],
) -> Result<[Option<&'k str>; N], DeckError> {
    let mut found = [None; N];
    for option in &k.options {
        match names.iter().position(|n| *n == option.key) {
            Some(i) => found[i] = Some(option.value.as_deref().unwrap_or("")),
            None if pass_over.contains(&option.key.as_str()) => {}
            None => {
                let list: Vec<&str> = names.iter().chain(pass_over).copied().collect();
                let expected = match list.is_empty() {
                    true => "no options".to_owned(),
                    false => format!("options among {}", list.join(", ")),
                };
                return Err(k.unsupported(
                    expected,
                    quote(&option.key),
                    "the option may change the model and is therefore not ignored",
                ));
            }
        }
    }
    Ok(found)
}

/// The value of an option that has to be there, as a name in lower case.
fn named(k: &Keyword, option: &str, value: Option<&str>) -> Result<String, DeckError> {
    match value {
        Some(value) if !value.is_empty() => Ok(value.to_ascii_lowercase()),
        _ => Err(k.syntax(format!("{option}=name"), "no name", "")),
    }
}

/// A label: a whole number from 1 on.
fn label(k: &Keyword, data: &Data, field: &str) -> Result<u32, DeckError> {
    whole(k, data, field, "a label from 1 to 4294967295")
}

/// A whole number from 1 on.
fn whole(k: &Keyword, data: &Data, field: &str, expected: &str) -> Result<u32, DeckError> {
    match field.parse::<u32>() {
        Ok(n) if n > 0 => Ok(n),
        _ => Err(data.syntax(k, expected, quote(field), "")),
    }
}

/// A direction 1 to 3.
fn direction(k: &Keyword, data: &Data, field: &str) -> Result<u8, DeckError> {
    match field {
        "1" => Ok(1),
        "2" => Ok(2),
        "3" => Ok(3),
        _ => Err(data.unsupported(
            k,
            "a direction 1, 2 or 3",
            quote(field),
            "nodes of solid elements have no other directions",
        )),
    }
}

/// A finite number; Fortran's `1.d5` is read too.
fn number(k: &Keyword, data: &Data, field: &str) -> Result<f64, DeckError> {
    // `inf`, `nan` and `infinity` are numbers to Rust and not to a deck.
    let digits = field.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let value = match field.parse::<f64>() {
        Ok(x) => Some(x),
        Err(_) => field.replace(['d', 'D'], "e").parse::<f64>().ok(),
    };
    match value {
        Some(x) if digits && x.is_finite() => Ok(x),
        _ => Err(data.syntax(k, "a finite number", quote(field), "")),
    }
}

/// The number in a field; a field left out counts as 0.
fn number_or_zero(k: &Keyword, data: &Data, field: usize) -> Result<f64, DeckError> {
    match data.fields.get(field) {
        Some(text) if !text.is_empty() => number(k, data, text),
        _ => Ok(0.0),
    }
}

/// That a data line has no more fields than it may have.
fn at_most(k: &Keyword, data: &Data, count: usize) -> Result<(), DeckError> {
    if data.fields.len() <= count {
        return Ok(());
    }
    Err(data.unsupported(
        k,
        format!("at most {count} values in the line"),
        data.fields.len().to_string(),
        "a further value may change the model and is therefore not ignored",
    ))
}
