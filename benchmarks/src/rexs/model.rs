//! A model of REXS as it stands in a file: components with attributes, and relations between them.

use super::attributes::Attribute;
use super::units;
use crate::scene_file::SceneError;
use std::collections::BTreeMap;

/// Value of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number, word or truth value as text.
    Text(String),
    /// A list of numbers.
    Numbers(Vec<f64>),
    /// A value of a form that gearbench does not read: matrices, lists of texts.
    Other,
}

/// An attribute with its unit as in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct AttributeValue {
    /// Unit; empty if the file has none.
    pub unit: String,
    /// Value in that unit.
    pub value: Value,
}

/// A component: a gear, a flank, a shaft.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Component {
    /// Id, unique in the model.
    pub id: u64,
    /// Type, as `cylindrical_gear`.
    pub kind: String,
    /// Name given by the user; may be empty.
    pub name: String,
    /// Attributes by name.
    pub attributes: BTreeMap<String, AttributeValue>,
}

/// A relation between components.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Relation {
    /// Type, as `stage`.
    pub kind: String,
    /// Order among relations of one kind.
    pub order: Option<i64>,
    /// Roles with the ids of their components.
    pub refs: Vec<(String, u64)>,
}

/// Attributes of components in a load case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadCase {
    /// Id of the load case.
    pub id: u64,
    /// Components with the attributes of the case.
    pub components: Vec<Component>,
}

/// A model with its version.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Version of the standard, as `1.4`.
    pub version: String,
    /// Program that wrote the file.
    pub application: String,
    /// Components in the order of the file.
    pub components: Vec<Component>,
    /// Relations in the order of the file.
    pub relations: Vec<Relation>,
    /// Load cases of all load spectra.
    pub load_cases: Vec<LoadCase>,
}

impl Relation {
    /// The component with a role.
    pub fn role(&self, role: &str) -> Option<u64> {
        let found = self.refs.iter().find(|(name, _)| name == role)?;
        Some(found.1)
    }
}

impl Component {
    /// Names the component in messages.
    pub fn title(&self) -> String {
        match self.name.trim() {
            "" => format!("component {} ({})", self.id, self.kind),
            name => format!("component {} ({}, \"{name}\")", self.id, self.kind),
        }
    }

    /// The text of an attribute.
    pub fn text(&self, attribute: &Attribute) -> Option<&str> {
        match self.find(attribute)?.1.value {
            Value::Text(ref text) => Some(text),
            _ => None,
        }
    }

    /// True if a truth value is given and true.
    pub fn is_true(&self, attribute: &Attribute) -> bool {
        self.text(attribute) == Some("true")
    }

    /// The attribute with its name in the file.
    fn find(&self, attribute: &Attribute) -> Option<(&str, &AttributeValue)> {
        let mut names = attribute.names.iter();
        names.find_map(|name| Some((*name, self.attributes.get(*name)?)))
    }

    /// An attribute in SI units, angles in radians; `None` if the component does not have it.
    ///
    /// # Errors
    /// The value is no finite number, or the unit is unknown or of another quantity.
    pub fn number(&self, attribute: &Attribute) -> Result<Option<f64>, SceneError> {
        let Some((name, found)) = self.find(attribute) else {
            return Ok(None);
        };
        let refuse = |found: String, help: String| {
            Err(SceneError::plain(
                format!("{}: `{name}` is {found}", self.title()),
                help,
            ))
        };
        let Value::Text(text) = &found.value else {
            return refuse("a list".into(), "expected one number".into());
        };
        let Some(x) = text.trim().parse::<f64>().ok().filter(|x| x.is_finite()) else {
            return refuse(
                format!("{text:?}"),
                format!("expected a number in {}", attribute.unit),
            );
        };
        match units::factor(&found.unit, attribute.unit) {
            Some(factor) => Ok(Some(x * factor)),
            None => refuse(
                format!("given in {:?}", found.unit),
                format!("expected a number in {}", attribute.unit),
            ),
        }
    }

    /// A list of numbers in SI units; `None` if the component has none, or one that is no list.
    pub fn numbers(&self, name: &str, unit: &str) -> Option<Vec<f64>> {
        let found = self.attributes.get(name)?;
        let Value::Numbers(list) = &found.value else {
            return None;
        };
        let factor = units::factor(&found.unit, unit)?;
        Some(list.iter().map(|x| factor * x).collect())
    }

    /// The list of an attribute in SI units.
    pub fn list(&self, attribute: &Attribute) -> Option<Vec<f64>> {
        self.numbers(attribute.names[0], attribute.unit)
    }

    /// Adds an attribute in SI units, converted to the unit of version 2.0.
    pub fn set(&mut self, attribute: &Attribute, x: f64) {
        // Every unit of the table of attributes is known.
        let factor = units::factor(attribute.unit, attribute.unit).unwrap_or(1.0);
        self.put(attribute, Value::Text(format!("{}", rounded(x / factor))));
    }

    /// Adds a list in SI units.
    pub fn set_list(&mut self, attribute: &Attribute, list: &[f64]) {
        let factor = units::factor(attribute.unit, attribute.unit).unwrap_or(1.0);
        let list = list.iter().map(|x| rounded(x / factor)).collect();
        self.put(attribute, Value::Numbers(list));
    }

    /// Adds a word or a truth value.
    pub fn set_text(&mut self, attribute: &Attribute, text: &str) {
        self.put(attribute, Value::Text(text.to_owned()));
    }

    fn put(&mut self, attribute: &Attribute, value: Value) {
        let unit = attribute.unit.to_owned();
        let name = attribute.names[0].to_owned();
        self.attributes.insert(name, AttributeValue { unit, value });
    }
}

/// Rounds to 15 digits: a conversion of units leaves no digits of its own.
fn rounded(x: f64) -> f64 {
    format!("{x:.14e}").parse().unwrap_or(x)
}

impl Model {
    /// The component with an id.
    pub fn component(&self, id: u64) -> Option<&Component> {
        self.components.iter().find(|c| c.id == id)
    }

    /// Components of a type.
    pub fn of_kind<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = &'a Component> {
        self.components.iter().filter(move |c| c.kind == kind)
    }

    /// Relations of a type.
    pub fn relations_of<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = &'a Relation> {
        self.relations.iter().filter(move |r| r.kind == kind)
    }

    /// Components that relations of a type connect with one: those with role `to` where `id` has role `from`, in the order of
    /// the relations.
    pub fn related(&self, kind: &str, from: &str, id: u64, to: &str) -> Vec<&Component> {
        let mut found: Vec<&Relation> = self
            .relations_of(kind)
            .filter(|r| r.role(from) == Some(id))
            .collect();
        found.sort_by_key(|r| r.order);
        let ids = found.into_iter().filter_map(|r| r.role(to));
        ids.filter_map(|id| self.component(id)).collect()
    }
}
