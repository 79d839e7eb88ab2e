//! Parts, their instances, and the poses of these.
//!
//! A part is read into a deck of its own; an instance is a copy of it with what the instance adds, moved by a
//! translation and then a turn about the axis through two points (manual of Abaqus, *INSTANCE). Names of its sets
//! get that of the instance in front, as `pinion-1.bore`; labels count within each instance.

use super::model::field;
use super::non_solids::MARK;
use super::{Reader, at_most, known, named, number_or_zero, options};
use crate::data::{Deck, Label};
use crate::error::{DeckError, DeckErrorKind, Place, quote};
use crate::lexer::Keyword;
use gearbench_solid_fe::Vec3;
use gearbench_solid_fe::limits;
use nalgebra::{Rotation3, Unit};

/// A part or an instance that is being read; the assembly waits.
pub(super) struct Scope {
    /// Name in lower case.
    name: String,
    outer: Deck,
    place: Place,
    /// Pose of an instance.
    stands: Option<InstancePose>,
}

/// Pose of an instance: `x -> point + turn (x + shift - point)`.
struct InstancePose {
    shift: Vec3,
    point: Vec3,
    turn: Rotation3<f64>,
}

impl InstancePose {
    fn of(&self, x: &Vec3) -> Vec3 {
        self.point + self.turn * (x + self.shift - self.point)
    }
}

impl Reader<'_> {
    /// That a keyword does not belong to the assembly or the model while a part is open.
    pub(super) fn in_scope(&self, k: &Keyword) -> Result<(), DeckError> {
        let Some(scope) = &self.scope else {
            return Ok(());
        };
        let elsewhere = matches!(
            k.key.as_str(),
            "PART"
                | "ASSEMBLY"
                | "ENDASSEMBLY"
                | "INSTANCE"
                | "MATERIAL"
                | "ELASTIC"
                | "DENSITY"
                | "RIGIDBODY"
                | "BOUNDARY"
                | "SURFACEINTERACTION"
                | "SURFACEBEHAVIOR"
                | "FRICTION"
                | "CONTACTPAIR"
                | "CONTACTDAMPING"
                | "INITIALCONDITIONS"
                | "STEP"
                | "STATIC"
                | "DYNAMIC"
                | "FREQUENCY"
                | "ENDSTEP"
        );
        if !elsewhere {
            return Ok(());
        }
        let end = match scope.stands {
            Some(_) => "*END INSTANCE",
            None => "*END PART",
        };
        Err(k.syntax(
            format!("{end} of {} first", quote(&scope.name)),
            "a keyword for the whole model",
            format!("it was opened in line {}", scope.place.line),
        ))
    }

    pub(super) fn part(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [name] = options(k, ["NAME"], &[])?;
        let name = named(k, "NAME", name)?;
        if self.parts.contains_key(&name) {
            return Err(super::model::twice(k, "part", &name));
        }
        self.open(name, k, Deck::default(), None);
        Ok(())
    }

    fn open(&mut self, name: String, k: &Keyword, inner: Deck, stands: Option<InstancePose>) {
        let outer = std::mem::replace(&mut self.deck, inner);
        self.scope = Some(Scope {
            name,
            outer,
            place: k.place.clone(),
            stands,
        });
    }

    pub(super) fn end_part(&mut self, k: &Keyword) -> Result<(), DeckError> {
        match self.scope.take() {
            Some(Scope {
                name,
                outer,
                stands: None,
                ..
            }) => {
                let mut part = std::mem::replace(&mut self.deck, outer);
                // A keyword that is ignored in a part counts once, however many instances the part has.
                for (keyword, count) in std::mem::take(&mut part.passed_over) {
                    *self.deck.passed_over.entry(keyword).or_default() += count;
                }
                self.parts.insert(name, part);
                Ok(())
            }
            scope => {
                self.scope = scope;
                Err(k.syntax("*PART before it", "none", ""))
            }
        }
    }

    pub(super) fn assembly(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        options(k, [], &["NAME"])?;
        Ok(())
    }

    /// The open part or instance has to be closed at the end of the deck.
    pub(super) fn closed(&self) -> Result<(), DeckError> {
        let Some(scope) = &self.scope else {
            return Ok(());
        };
        let what = match scope.stands {
            Some(_) => ["*INSTANCE", "*END INSTANCE"],
            None => ["*PART", "*END PART"],
        };
        let found = format!("the end of the deck after line {}", self.lexer.place().line);
        let kind = DeckErrorKind::Syntax;
        Err((scope.place).error(kind, what[0], what[1], found, "close it"))
    }

    pub(super) fn instance(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [name, part] = options(k, ["NAME", "PART"], &[])?;
        let name = named(k, "NAME", name)?;
        let part = named(k, "PART", part)?;
        known(&k.place, &k.text, "part", &part, &self.parts)?;
        if self.instance_number(&name).is_some() {
            return Err(super::model::twice(k, "instance", &name));
        }
        let stands = self.standing(k)?;
        let part = self.parts[&part].clone();
        self.room(k, &part)?;
        self.open(name, k, part, Some(stands));
        Ok(())
    }

    /// Reads the pose: no line, one with a translation, or a second with two points and an angle.
    fn standing(&mut self, k: &Keyword) -> Result<InstancePose, DeckError> {
        let mut stands = InstancePose {
            shift: Vec3::zeros(),
            point: Vec3::zeros(),
            turn: Rotation3::identity(),
        };
        let mut lines = 0;
        while let Some(data) = self.lexer.data()? {
            lines += 1;
            let vector = |first: usize| -> Result<Vec3, DeckError> {
                Ok(Vec3::new(
                    number_or_zero(k, &data, first)?,
                    number_or_zero(k, &data, first + 1)?,
                    number_or_zero(k, &data, first + 2)?,
                ))
            };
            match lines {
                1 => {
                    at_most(k, &data, 3)?;
                    stands.shift = vector(0)?;
                }
                2 => {
                    at_most(k, &data, 7)?;
                    let angle = number_or_zero(k, &data, 6)?.to_radians();
                    stands.point = vector(0)?;
                    let along = vector(3)? - stands.point;
                    match Unit::try_new(along, 0.0) {
                        Some(axis) if axis.iter().all(|x| x.is_finite()) => {
                            stands.turn = Rotation3::from_axis_angle(&axis, angle);
                        }
                        _ if angle == 0.0 => {}
                        _ => {
                            return Err(data.syntax(
                                k,
                                "two different points on the axis of the turn, then an angle in degrees",
                                quote(&data.fields.join(", ")),
                                "",
                            ));
                        }
                    }
                }
                _ => {
                    return Err(data.syntax(
                        k,
                        "a line with a translation and one with a turn",
                        format!("{} more", quote(field(&data, 0))),
                        "",
                    ));
                }
            }
        }
        Ok(stands)
    }

    /// That another copy of a part has room in the memory.
    fn room(&self, k: &Keyword, part: &Deck) -> Result<(), DeckError> {
        let size = |deck: &Deck| -> f64 {
            let sets = deck.node_sets.iter().chain(&deck.element_sets);
            let sets: usize = sets.map(|(name, s)| name.len() + s.len()).sum();
            let blocks: usize = deck.blocks.iter().map(|b| b.connectivity.len()).sum();
            let others: usize = deck.others.elements.values().map(Vec::len).sum();
            let labels = deck.nodes.len() + deck.element_labels.len() + deck.others.elements.len();
            200.0 * labels as f64 + 8.0 * (sets + blocks + others) as f64
        };
        let needed = size(&self.deck) + 2.0 * size(part);
        let checked = limits::check("the instances of the deck", needed, "use fewer instances");
        checked.map_err(|e| {
            let kind = DeckErrorKind::Limit;
            let expected = format!("at most {} of memory", e.allowed);
            (k.place).error(kind, k.text.clone(), expected, e.needed, e.way_out)
        })
    }

    pub(super) fn end_instance(&mut self, k: &Keyword) -> Result<(), DeckError> {
        match self.scope.take() {
            Some(Scope {
                name,
                outer,
                stands: Some(stands),
                ..
            }) => {
                let instance = std::mem::replace(&mut self.deck, outer);
                self.deck.join(&name, instance, &stands);
                Ok(())
            }
            scope => {
                self.scope = scope;
                Err(k.syntax("*INSTANCE before it", "none", ""))
            }
        }
    }

    /// Number of an instance, from 1.
    pub(super) fn instance_number(&self, name: &str) -> Option<u32> {
        let mut all = self.deck.instances.iter();
        let place = all.position(|i| i.eq_ignore_ascii_case(name))?;
        Some(place as u32 + 1)
    }

    /// Returns the instance of an option, or 0 without one.
    pub(super) fn named_instance(&self, k: &Keyword, name: Option<&str>) -> Result<u32, DeckError> {
        let Some(name) = name else {
            return Ok(0);
        };
        self.instance_number(name).ok_or_else(|| {
            k.reference(
                "INSTANCE=name of an instance above",
                quote(name),
                format!("there are {}", quote(&self.deck.instances.join(", "))),
            )
        })
    }
}

impl Deck {
    /// Adds an instance, with its name in front of those of its sets.
    fn join(&mut self, name: &str, from: Deck, stands: &InstancePose) {
        self.instances.push(name.to_owned());
        let instance = self.instances.len() as u32;
        let first_node = self.nodes.len() as u32;
        let first_element = self.element_labels.len() as u32;
        let first_other = self.others.elements.len() as u32;
        let named = |own: String| format!("{name}.{own}");
        let label = |l: Label| Label {
            instance,
            number: l.number,
        };
        let element = |e: u32| match e & MARK {
            0 => e + first_element,
            _ => ((e & !MARK) + first_other) | MARK,
        };
        self.nodes.extend(from.nodes.iter().map(|x| stands.of(x)));
        self.node_labels
            .extend(from.node_labels.into_iter().map(label));
        self.element_labels
            .extend(from.element_labels.into_iter().map(label));
        for mut block in from.blocks {
            block.first += first_element;
            block.set = block.set.map(named);
            block.connectivity.iter_mut().for_each(|n| *n += first_node);
            self.blocks.push(block);
        }
        for (l, mut nodes) in from.others.elements {
            nodes.iter_mut().for_each(|n| *n += first_node);
            self.others.elements.insert(label(l), nodes);
        }
        for (to, of) in [
            (&mut self.others.types, from.others.types),
            (&mut self.others.taken, from.others.taken),
            (&mut self.passed_over, from.passed_over),
        ] {
            for (key, count) in of {
                *to.entry(key).or_default() += count;
            }
        }
        for (own, mut nodes) in from.node_sets {
            nodes.iter_mut().for_each(|n| *n += first_node);
            self.node_sets.insert(named(own), nodes);
        }
        for (own, mut elements) in from.element_sets {
            elements.iter_mut().for_each(|e| *e = element(*e));
            self.element_sets.insert(named(own), elements);
        }
        for (own, mut faces) in from.surfaces {
            faces.iter_mut().for_each(|f| f.element += first_element);
            self.surfaces.insert(named(own), faces);
        }
        for (own, place) in from.defined {
            self.defined.entry(named(own)).or_insert(place);
        }
        self.sections.extend(from.sections.into_iter().map(|mut s| {
            s.set = named(s.set);
            s
        }));
    }
}
