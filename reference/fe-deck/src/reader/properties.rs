//! Materials, sections, rigid bodies, boundary and initial conditions.

use super::model::{field, twice};
use super::passed::name;
use super::{Reader, at_most, known, named, number, number_or_zero, options, whole};
use crate::data::{Boundary, DeckMaterial, InitialVelocity, RigidBody, Section};
use crate::error::DeckError;
use crate::lexer::{Data, Keyword};

/// Highest number of a degree of freedom of any element: temperatures over the thickness of shells.
const MOST_DIRECTIONS: u32 = 31;

impl Reader<'_> {
    pub(super) fn material(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [name] = options(
            k,
            ["NAME"],
            &["RTOL", "SRATEFACTOR", "STRAINRATEREGULARIZATION"],
        )?;
        let name = named(k, "NAME", name)?;
        let material = DeckMaterial {
            elastic: None,
            density: None,
            beyond: None,
            place: k.place.clone(),
        };
        if self.deck.materials.insert(name.clone(), material).is_some() {
            return Err(twice(k, "material", &name));
        }
        self.material = Some(name);
        Ok(())
    }

    /// The material a property belongs to.
    pub(super) fn open_material(&mut self, k: &Keyword) -> Result<&mut DeckMaterial, DeckError> {
        self.material
            .as_ref()
            .and_then(|name| self.deck.materials.get_mut(name))
            .ok_or_else(|| k.syntax("*MATERIAL before it", "none", ""))
    }

    /// Reads a line of numbers, optionally followed by their temperature; `None` when further lines make them depend
    /// on it.
    fn one_line(
        &mut self,
        k: &Keyword,
        what: &str,
        count: usize,
    ) -> Result<Option<Vec<f64>>, DeckError> {
        let data = self.need_data(k, what)?;
        if !(count..=count + 1).contains(&data.fields.len()) {
            return Err(data.unsupported(
                k,
                format!("one line with {what}"),
                format!("{} values", data.fields.len()),
                "the material is isotropic",
            ));
        }
        let fields = data.fields.iter().take(count);
        let values: Vec<f64> = fields
            .map(|f| number(k, &data, f))
            .collect::<Result<_, _>>()?;
        let mut constant = true;
        while let Some(more) = self.lexer.data()? {
            for (field, value) in more.fields.iter().zip(&values) {
                constant &= number(k, &more, field)? == *value;
            }
        }
        Ok(constant.then_some(values))
    }

    pub(super) fn elastic(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let [kind] = options(
            k,
            ["TYPE"],
            &["MODULI", "DEPENDENCIES", "COMPRESSION", "NOCOMPRESSION"],
        )?;
        self.open_material(k)?;
        if kind
            .is_some_and(|t| !t.eq_ignore_ascii_case("ISO") && !t.eq_ignore_ascii_case("ISOTROPIC"))
        {
            return self.beyond(k, "the material is isotropic");
        }
        let values = self.one_line(k, "Young's modulus [Pa] and Poisson's ratio", 2)?;
        let Some(values) = values else {
            return self.beyond(k, "the material does not depend on temperature");
        };
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
        options(k, [], &["DEPENDENCIES"])?;
        self.open_material(k)?;
        let Some(values) = self.one_line(k, "the density [kg/m^3]", 1)? else {
            return self.beyond(k, "the density does not depend on temperature");
        };
        let density = values[0];
        if density <= 0.0 {
            return Err(k.syntax("a density above 0", density.to_string(), ""));
        }
        self.open_material(k)?.density = Some(density);
        Ok(())
    }

    pub(super) fn solid_section(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        // An orientation turns nothing of an isotropic material, controls are of other programs' elements.
        let other = [
            "ORIENTATION",
            "CONTROLS",
            "STACKDIRECTION",
            "SYMMETRIC",
            "ORDER",
            "LAYUP",
        ];
        let [set, material] = options(k, ["ELSET", "MATERIAL"], &other)?;
        self.deck.sections.push(Section {
            set: named(k, "ELSET", set)?,
            material: named(k, "MATERIAL", material)?,
            place: k.place.clone(),
        });
        // Thicknesses are those of plane elements: solids have none.
        while self.lexer.data()?.is_some() {}
        Ok(())
    }

    /// Axes for the conditions of some nodes: checked at the end against those.
    pub(super) fn transform(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let [set, _] = options(k, ["NSET", "TYPE"], &[])?;
        let set = named(k, "NSET", set)?;
        if self.scope.is_none() {
            self.transforms.push(set);
        }
        self.count_passed(name(k));
        while let Some(data) = self.lexer.data()? {
            at_most(k, &data, 6)?;
            for i in 0..data.fields.len() {
                number_or_zero(k, &data, i)?;
            }
        }
        Ok(())
    }

    pub(super) fn rigid_body(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        // A body of elements, or one whose tie or pins are told apart, is no bore on its hub.
        let own = ["NSET", "REFNODE", "ROTNODE"];
        if k.options.iter().any(|o| !own.contains(&o.key.as_str())) {
            return self.pass_over(k);
        }
        let [set, reference, rotation] = options(k, own, &[])?;
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
        // Values from another model or program are not part of the deck.
        let elsewhere = [
            "SUBMODEL",
            "USER",
            "BASEMOTION",
            "MASSFLOW",
            "REGIONTYPE",
            "TYPE",
        ];
        if k.options
            .iter()
            .any(|o| elsewhere.contains(&o.key.as_str()))
        {
            return self.pass_over(k);
        }
        if let Some(open) = &mut self.step {
            let new = |o: &crate::lexer::KeywordOption| {
                o.key == "OP"
                    && o.value
                        .as_ref()
                        .is_some_and(|v| v.eq_ignore_ascii_case("NEW"))
            };
            open.step.boundaries_anew |= k.options.iter().any(new);
        }
        while let Some(data) = self.lexer.data()? {
            let target = self.target(k, &data)?;
            let spans: Vec<[u8; 2]> = match named_directions(field(&data, 1)) {
                Some(spans) => spans.to_vec(),
                None => {
                    at_most(k, &data, 5)?;
                    let what = "a direction from 1 on";
                    // CalculiX has temperatures in direction 0 too.
                    let first = match field(&data, 1) {
                        "0" => 11,
                        text => whole(k, &data, text, what)?,
                    };
                    let last = match field(&data, 2) {
                        "" | "0" => first,
                        text => whole(k, &data, text, what)?,
                    };
                    if let Some(beyond) = [first, last].into_iter().find(|d| *d > MOST_DIRECTIONS) {
                        return Err(data.syntax(
                            k,
                            format!("directions up to {MOST_DIRECTIONS}"),
                            format!("direction {beyond}"),
                            "displacements are directions 1 to 3",
                        ));
                    }
                    if last < first {
                        return Err(data.syntax(
                            k,
                            "node, first direction, last direction, value",
                            format!("directions {first} to {last}"),
                            "",
                        ));
                    }
                    // Rotations, temperatures and potentials are no motions of solids.
                    match first {
                        1..=3 => vec![[first as u8, last.min(3) as u8]],
                        _ => {
                            self.count_passed("*BOUNDARY of directions beyond 3".to_owned());
                            Vec::new()
                        }
                    }
                }
            };
            let value = match spans.len() {
                1 => number_or_zero(k, &data, 3)?,
                _ => 0.0,
            };
            for directions in spans {
                let boundary = Boundary {
                    target: target.clone(),
                    directions,
                    value,
                    own_axes: false,
                };
                match &mut self.step {
                    Some(open) => open.step.boundaries.push(boundary),
                    None => self.deck.boundaries.push(boundary),
                }
            }
        }
        Ok(())
    }

    pub(super) fn initial_conditions(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let kind = k.options.iter().find(|o| o.key == "TYPE");
        let kind = kind.and_then(|o| o.value.as_deref());
        // Temperatures and stresses at first change nothing of a linear body.
        if !kind.is_some_and(|t| t.eq_ignore_ascii_case("VELOCITY")) {
            return self.pass_over(k);
        }
        while let Some(data) = self.lexer.data()? {
            at_most(k, &data, 3)?;
            let condition = InitialVelocity {
                target: self.target(k, &data)?,
                direction: super::direction(k, &data, field(&data, 1))?,
                value: number(k, &data, field(&data, 2))?,
            };
            self.deck.initial_velocities.push(condition);
        }
        Ok(())
    }
}

/// Directions that go by a name.
fn named_directions(name: &str) -> Option<&'static [[u8; 2]]> {
    Some(match name.to_ascii_uppercase().as_str() {
        "ENCASTRE" | "PINNED" => &[[1, 3]],
        "XSYMM" => &[[1, 1]],
        "YSYMM" => &[[2, 2]],
        "ZSYMM" => &[[3, 3]],
        "XASYMM" => &[[2, 3]],
        "YASYMM" => &[[1, 1], [3, 3]],
        "ZASYMM" => &[[1, 2]],
        _ => return None,
    })
}
