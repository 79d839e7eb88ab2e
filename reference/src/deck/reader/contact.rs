//! Surfaces, interactions and contact pairs.

use super::model::{field, twice};
use super::{Reader, at_most, known, named, number, options};
use crate::deck::data::{ContactKind, ContactPair, Interaction};
use crate::deck::error::{DeckError, quote};
use crate::deck::lexer::Keyword;
use crate::mesh::Face;
use std::collections::HashSet;

impl Reader<'_> {
    pub(super) fn surface(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [name, kind] = options(k, ["NAME", "TYPE"], &["INTERNAL"])?;
        let name = named(k, "NAME", name)?;
        if kind.is_some_and(|t| !t.eq_ignore_ascii_case("ELEMENT")) {
            return Err(k.unsupported(
                "TYPE=ELEMENT",
                quote(kind.unwrap_or("")),
                "name the surface by element faces",
            ));
        }
        let mut faces = Vec::new();
        let mut seen = HashSet::new();
        while let Some(data) = self.lexer.data()? {
            at_most(k, &data, 2)?;
            let face = match field(&data, 1).to_ascii_uppercase().as_str() {
                "S1" => 0,
                "S2" => 1,
                "S3" => 2,
                "S4" => 3,
                "S5" => 4,
                "S6" => 5,
                other => {
                    return Err(data.syntax(k, "a face S1 to S6", quote(other), ""));
                }
            };
            let text = field(&data, 0);
            let deck = &self.deck;
            let mut add = |element| {
                let kind = deck.block(element).kind;
                if usize::from(face) >= kind.faces().len() {
                    return Err(data.syntax(
                        k,
                        format!("a face S1 to S{} of {}", kind.faces().len(), kind.name()),
                        quote(field(&data, 1)),
                        "",
                    ));
                }
                let face = Face { element, face };
                if seen.insert(face) {
                    faces.push(face);
                }
                Ok(())
            };
            if text.starts_with(|c: char| c.is_ascii_digit()) {
                add(self.element_at(k, &data, text)?)?;
            } else {
                let set = text.to_ascii_lowercase();
                let sets = &self.deck.element_sets;
                known(&data.place, &k.text, "element set", &set, sets)?;
                sets[&set].iter().copied().try_for_each(add)?;
            }
        }
        self.deck
            .defined
            .entry(name.clone())
            .or_insert_with(|| k.place.clone());
        if self.deck.surfaces.insert(name.clone(), faces).is_some() {
            return Err(twice(k, "surface", &name));
        }
        Ok(())
    }

    pub(super) fn surface_interaction(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [name] = options(k, ["NAME"], &[])?;
        let name = named(k, "NAME", name)?;
        let interaction = Interaction {
            stiffness: None,
            place: k.place.clone(),
        };
        if self
            .deck
            .interactions
            .insert(name.clone(), interaction)
            .is_some()
        {
            return Err(twice(k, "surface interaction", &name));
        }
        self.interaction = Some(name);
        Ok(())
    }

    pub(super) fn surface_behavior(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [kind] = options(k, ["PRESSURE-OVERCLOSURE"], &[])?;
        if !kind.is_some_and(|t| t.eq_ignore_ascii_case("LINEAR")) {
            return Err(k.unsupported(
                "PRESSURE-OVERCLOSURE=LINEAR",
                quote(kind.unwrap_or("none")),
                "give the contact a linear penalty",
            ));
        }
        let data = self.need_data(k, "the pressure over overclosure [Pa/m]")?;
        at_most(k, &data, 1)?;
        let stiffness = number(k, &data, field(&data, 0))?;
        if stiffness <= 0.0 {
            return Err(data.syntax(k, "a stiffness above 0", stiffness.to_string(), ""));
        }
        let interaction = self
            .interaction
            .as_ref()
            .and_then(|name| self.deck.interactions.get_mut(name));
        match interaction {
            Some(interaction) => {
                interaction.stiffness = Some(stiffness);
                Ok(())
            }
            None => Err(k.syntax("*SURFACE INTERACTION before it", "none", "")),
        }
    }

    pub(super) fn contact_pair(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [interaction, kind] = options(k, ["INTERACTION", "TYPE"], &[])?;
        let interaction = named(k, "INTERACTION", interaction)?;
        let kind: String = kind
            .unwrap_or("")
            .chars()
            .filter(|c| !c.is_whitespace())
            .map(|c| c.to_ascii_uppercase())
            .collect();
        let kind = match kind.as_str() {
            "SURFACETOSURFACE" => ContactKind::SurfaceToSurface,
            "NODETOSURFACE" => ContactKind::NodeToSurface,
            other => {
                return Err(k.unsupported(
                    "TYPE=SURFACE TO SURFACE or NODE TO SURFACE",
                    quote(other),
                    "programs differ in what they take without it, so say which",
                ));
            }
        };
        while let Some(data) = self.lexer.data()? {
            at_most(k, &data, 2)?;
            let pair = ContactPair {
                slave: field(&data, 0).to_ascii_lowercase(),
                master: field(&data, 1).to_ascii_lowercase(),
                interaction: interaction.clone(),
                kind,
                place: data.place,
            };
            self.deck.contact_pairs.push(pair);
        }
        Ok(())
    }
}
