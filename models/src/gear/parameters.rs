//! Parameters of gear models: each model defines a struct; scenes and tables store them by key.

use super::row::ParameterInfo;
use crate::error::BuildError;
use crate::spec::{ModelSpec, Modelling, Parameters, Value};
use serde::de::{DeserializeOwned, Visitor};
use serde::{Deserializer, Serialize};
use std::fmt;

/// Parameters of a model: a struct of options whose fields are the keys.
pub trait ModelParameters: Default + Serialize + DeserializeOwned {
    /// Identifier of the model.
    const MODEL: &'static str;
    /// Keys of the model with their descriptions.
    const KEYS: &'static [ParameterInfo];

    /// Reads the struct from the parameters of a scene.
    ///
    /// # Errors
    /// The first key whose value is none that it takes.
    fn read(parameters: &Parameters) -> Result<Self, BuildError> {
        let json = |of: &Parameters| {
            let fields = of.iter().map(|(k, v)| (k.clone(), to_json(v)));
            serde_json::Value::Object(fields.collect())
        };
        serde_json::from_value(json(parameters)).map_err(|whole| {
            // All fields are options: the first key that fails by itself is the one to blame.
            let blamed = parameters.iter().find_map(|(key, value)| {
                let alone = Parameters::from([(key.clone(), value.clone())]);
                let error = serde_json::from_value::<Self>(json(&alone)).err()?;
                Some((key.as_str(), error))
            });
            let (key, why) = blamed.unwrap_or(("", whole));
            let info = Self::KEYS.iter().find(|p| p.key == key);
            let meaning = info.map_or(String::new(), |p| format!("`{key}`: {}", p.meaning));
            BuildError::parameter(Self::MODEL, key, (why.to_string(), meaning))
        })
    }

    /// Reads the parameters of a gear of this model, or returns `None`; invalid values are reported by the
    /// construction of the gear.
    fn of(spec: &ModelSpec) -> Option<Self> {
        (spec.id == Self::MODEL).then(|| Self::read(&spec.parameters).ok())?
    }

    /// Creates a gear of this model with these parameters.
    fn spec(&self) -> ModelSpec {
        let fields = match serde_json::to_value(self) {
            Ok(serde_json::Value::Object(fields)) => fields,
            _ => serde_json::Map::new(),
        };
        let parameters = fields
            .into_iter()
            .filter_map(|(key, value)| Some((key, from_json(value)?)))
            .collect();
        ModelSpec {
            id: Self::MODEL.into(),
            parameters,
        }
    }

    /// Changes the parameters of all gears of this model.
    fn change(modelling: &mut Modelling, change: impl Fn(&mut Self)) {
        for gear in &mut modelling.gears {
            if let Some(mut parameters) = Self::of(gear) {
                change(&mut parameters);
                *gear = parameters.spec();
            }
        }
    }
}

/// Converts a value; whole numbers become integers, which integer and float fields accept.
fn to_json(value: &Value) -> serde_json::Value {
    let number = |x: f64| {
        if x.fract() == 0.0 && x.is_sign_positive() && x <= 9e15 {
            serde_json::Value::from(x as u64)
        } else {
            serde_json::Value::from(x)
        }
    };
    match value {
        Value::Number(x) => number(*x),
        Value::Text(x) => x.as_str().into(),
        Value::List(x) => x.iter().map(|x| number(*x)).collect(),
        Value::Flag(x) => (*x).into(),
    }
}

/// Converts a given parameter back.
fn from_json(value: serde_json::Value) -> Option<Value> {
    match value {
        serde_json::Value::Number(x) => x.as_f64().map(Value::Number),
        serde_json::Value::String(x) => Some(Value::Text(x)),
        serde_json::Value::Bool(x) => Some(Value::Flag(x)),
        serde_json::Value::Array(x) => {
            let numbers = x.iter().map(serde_json::Value::as_f64);
            numbers.collect::<Option<Vec<f64>>>().map(Value::List)
        }
        serde_json::Value::Null | serde_json::Value::Object(_) => None,
    }
}

struct Number(&'static str);

impl Visitor<'_> for Number {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }

    fn visit_f64<E>(self, x: f64) -> Result<f64, E> {
        Ok(x)
    }

    fn visit_u64<E>(self, x: u64) -> Result<f64, E> {
        Ok(x as f64)
    }
}

/// Deserialises a number, for `#[serde(deserialize_with)]`.
///
/// # Errors
/// Anything else.
pub fn number<'de, D: Deserializer<'de>>(d: D) -> Result<Option<f64>, D::Error> {
    d.deserialize_any(Number("a number")).map(Some)
}

/// Deserialises a whole number, for `#[serde(deserialize_with)]`.
///
/// # Errors
/// Anything else.
pub fn whole<'de, D: Deserializer<'de>>(d: D) -> Result<Option<usize>, D::Error> {
    struct Whole;
    impl Visitor<'_> for Whole {
        type Value = usize;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a whole number, zero or more")
        }

        fn visit_u64<E: serde::de::Error>(self, x: u64) -> Result<usize, E> {
            usize::try_from(x).map_err(|_| E::custom("the number is too large"))
        }
    }
    d.deserialize_any(Whole).map(Some)
}
