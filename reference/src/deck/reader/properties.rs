//! Materials, sections, rigid bodies, boundary and initial conditions.

use super::model::{field, twice};
use super::{Reader, at_most, direction, known, named, number, number_or_zero, options};
use crate::deck::data::{Boundary, DeckMaterial, InitialVelocity, RigidBody, Section};
use crate::deck::error::{DeckError, quote};
use crate::deck::lexer::{Data, Keyword};

impl Reader<'_> {
    pub(super) fn material(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [name] = options(k, ["NAME"], &[])?;
        let name = named(k, "NAME", name)?;
        let material = DeckMaterial {
            elastic: None,
            density: None,
            place: k.place.clone(),
        };
        if self.deck.materials.insert(name.clone(), material).is_some() {
            return Err(twice(k, "material", &name));
        }
        self.material = Some(name);
        Ok(())
    }

    /// The material a property belongs to.
    fn open_material(&mut self, k: &Keyword) -> Result<&mut DeckMaterial, DeckError> {
        self.material
            .as_ref()
            .and_then(|name| self.deck.materials.get_mut(name))
            .ok_or_else(|| k.syntax("*MATERIAL before it", "none", ""))
    }

    /// One line of numbers; a second would make them depend on temperature.
    fn one_line(&mut self, k: &Keyword, what: &str, count: usize) -> Result<Vec<f64>, DeckError> {
        let data = self.need_data(k, what)?;
        if data.fields.len() != count {
            return Err(data.unsupported(
                k,
                format!("one line with {what}"),
                format!("{} values", data.fields.len()),
                "the material is isotropic and does not depend on temperature",
            ));
        }
        let values = data.fields.iter().map(|f| number(k, &data, f)).collect();
        if let Some(more) = self.lexer.data()? {
            return Err(more.unsupported(
                k,
                format!("one line with {what}"),
                "a second line",
                "the material does not depend on temperature",
            ));
        }
        values
    }

    pub(super) fn elastic(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let [kind] = options(k, ["TYPE"], &[])?;
        if kind
            .is_some_and(|t| !t.eq_ignore_ascii_case("ISO") && !t.eq_ignore_ascii_case("ISOTROPIC"))
        {
            return Err(k.unsupported("an isotropic material", quote(kind.unwrap_or("")), ""));
        }
        self.open_material(k)?;
        let values = self.one_line(k, "Young's modulus [Pa] and Poisson's ratio", 2)?;
        let (young, poisson) = (values[0], values[1]);
        if young <= 0.0 || poisson <= -1.0 || poisson >= 0.5 {
            return Err(k.syntax(
                "E > 0 and -1 < nu < 0.5",
                format!("E = {young}, nu = {poisson}"),
                "",
            ));
        }
        self.open_material(k)?.elastic = Some((young, poisson));
        Ok(())
    }

    pub(super) fn density(&mut self, k: &Keyword) -> Result<(), DeckError> {
        options(k, [], &[])?;
        self.open_material(k)?;
        let density = self.one_line(k, "the density [kg/m^3]", 1)?[0];
        if density <= 0.0 {
            return Err(k.syntax("a density above 0", density.to_string(), ""));
        }
        self.open_material(k)?.density = Some(density);
        Ok(())
    }

    pub(super) fn solid_section(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [set, material] = options(k, ["ELSET", "MATERIAL"], &[])?;
        self.deck.sections.push(Section {
            set: named(k, "ELSET", set)?,
            material: named(k, "MATERIAL", material)?,
            place: k.place.clone(),
        });
        // Abaqus writes an empty or a lone "1." line of section data for solids.
        while let Some(data) = self.lexer.data()? {
            at_most(k, &data, 1)?;
            if number_or_zero(k, &data, 0)? != 1.0 && !field(&data, 0).is_empty() {
                return Err(data.unsupported(
                    k,
                    "no section data of a solid",
                    quote(field(&data, 0)),
                    "",
                ));
            }
        }
        Ok(())
    }

    pub(super) fn rigid_body(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [set, reference, rotation] = options(k, ["NSET", "REFNODE", "ROTNODE"], &[])?;
        let set = named(k, "NSET", set)?;
        known(&k.place, &k.text, "node set", &set, &self.deck.node_sets)?;
        // The options are labels: checked as those of data lines are.
        let as_data = |text: &str| Data {
            place: k.place.clone(),
            fields: vec![text.to_owned()],
        };
        let at = |text: &str| self.node_at(k, &as_data(text), text);
        let body = RigidBody {
            set,
            reference: at(reference.unwrap_or(""))?,
            rotation: rotation.map(at).transpose()?,
            place: k.place.clone(),
        };
        self.deck.rigid_bodies.push(body);
        Ok(())
    }

    pub(super) fn boundary(&mut self, k: &Keyword) -> Result<(), DeckError> {
        options(k, [], &[])?;
        while let Some(data) = self.lexer.data()? {
            at_most(k, &data, 4)?;
            let target = self.target(k, &data)?;
            let first = direction(k, &data, field(&data, 1))?;
            let last = match field(&data, 2) {
                "" => first,
                text => direction(k, &data, text)?,
            };
            if last < first {
                return Err(data.syntax(
                    k,
                    "node, first direction, last direction, value",
                    format!("directions {first} to {last}"),
                    "",
                ));
            }
            let boundary = Boundary {
                target,
                directions: [first, last],
                value: number_or_zero(k, &data, 3)?,
            };
            match &mut self.step {
                Some(open) => open.step.boundaries.push(boundary),
                None => self.deck.boundaries.push(boundary),
            }
        }
        Ok(())
    }

    pub(super) fn initial_conditions(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [kind] = options(k, ["TYPE"], &[])?;
        if !kind.is_some_and(|t| t.eq_ignore_ascii_case("VELOCITY")) {
            return Err(k.unsupported("TYPE=VELOCITY", quote(kind.unwrap_or("no type")), ""));
        }
        while let Some(data) = self.lexer.data()? {
            at_most(k, &data, 3)?;
            let condition = InitialVelocity {
                target: self.target(k, &data)?,
                direction: direction(k, &data, field(&data, 1))?,
                value: number(k, &data, field(&data, 2))?,
            };
            self.deck.initial_velocities.push(condition);
        }
        Ok(())
    }
}
