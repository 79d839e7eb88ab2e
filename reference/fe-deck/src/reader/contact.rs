//! Surfaces, interactions and contact pairs.

use super::model::{field, twice};
use super::non_solids::MARK;
use super::{Reader, known, named, number};
use crate::data::{ContactKind, ContactPair, Interaction};
use crate::error::{DeckError, quote};
use crate::lexer::{Keyword, KeywordOption};
use gearbench_solid_fe::mesh::Face;
use std::collections::HashSet;

impl Reader<'_> {
    pub(super) fn surface(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let (name, kind) = (option(k, "NAME"), option(k, "TYPE"));
        let name = named(k, "NAME", name)?;
        let own = |o: &KeywordOption| ["NAME", "TYPE", "INTERNAL"].contains(&o.key.as_str());
        if kind.is_some_and(|t| !t.eq_ignore_ascii_case("ELEMENT")) || !k.options.iter().all(own) {
            return self.pass_surface(k, name);
        }
        let mut faces = Vec::new();
        let mut seen = HashSet::new();
        while let Some(data) = self.lexer.data()? {
            let face = match field(&data, 1).to_ascii_uppercase().as_str() {
                "S1" => 0,
                "S2" => 1,
                "S3" => 2,
                "S4" => 3,
                "S5" => 4,
                "S6" => 5,
                other if other.starts_with('S') && other.len() == 2 => {
                    return Err(data.syntax(k, "a face S1 to S6", quote(other), ""));
                }
                // Free faces of a set, edges, and sides of shells.
                _ => return self.pass_surface(k, name),
            };
            let text = field(&data, 0);
            let deck = &self.deck;
            let mut add = |element| {
                if element & MARK != 0 {
                    return Ok(());
                }
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
            if self.is_label(text) {
                add(self.element_in(k, &data, text, 0)?)?;
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
        let name = named(k, "NAME", option(k, "NAME"))?;
        let interaction = Interaction {
            stiffness: None,
            more: Vec::new(),
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
        // Abaqus has the thickness out of the plane below it.
        while self.lexer.data()?.is_some() {}
        Ok(())
    }

    pub(super) fn surface_behavior(&mut self, k: &Keyword) -> Result<(), DeckError> {
        // Within a step the keyword changes the interaction of the model, which is not read.
        if self.step.is_some() {
            return self.pass_over(k);
        }
        let kind = option(k, "PRESSURE-OVERCLOSURE");
        if !kind.is_some_and(|t| t.eq_ignore_ascii_case("LINEAR")) {
            return self.more_of_interaction(k);
        }
        let data = self.need_data(k, "the pressure over overclosure [Pa/m]")?;
        let stiffness = number(k, &data, field(&data, 0))?;
        if stiffness <= 0.0 {
            return Err(data.syntax(k, "a stiffness above 0", stiffness.to_string(), ""));
        }
        while self.lexer.data()?.is_some() {}
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

    /// Stores further properties of an interaction beyond a linear penalty, which are ignored.
    pub(super) fn more_of_interaction(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let interaction = self
            .interaction
            .as_ref()
            .and_then(|name| self.deck.interactions.get_mut(name));
        if let Some(interaction) = interaction {
            interaction.more.push(k.text.clone());
        }
        self.pass_over(k)
    }

    /// A surface that is no set of faces.
    fn pass_surface(&mut self, k: &Keyword, name: String) -> Result<(), DeckError> {
        self.passed_surfaces.insert(name);
        self.pass_over(k)
    }

    pub(super) fn contact_pair(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let Some(interaction) = option(k, "INTERACTION") else {
            return self.pass_over(k);
        };
        let interaction = interaction.to_ascii_lowercase();
        let kind: String = option(k, "TYPE")
            .unwrap_or("")
            .chars()
            .filter(|c| !c.is_whitespace())
            .map(|c| c.to_ascii_uppercase())
            .collect();
        let kind = match kind.as_str() {
            "SURFACETOSURFACE" => ContactKind::SurfaceToSurface,
            "NODETOSURFACE" => ContactKind::NodeToSurface,
            _ => ContactKind::Other,
        };
        while let Some(data) = self.lexer.data()? {
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

/// Returns the value of an option, if it has one.
fn option<'k>(k: &'k Keyword, name: &str) -> Option<&'k str> {
    let option = k.options.iter().find(|o| o.key == name)?;
    option.value.as_deref()
}
