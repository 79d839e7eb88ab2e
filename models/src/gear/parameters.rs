//! Parameters of gear models: each model declares one struct, whose fields are the keys of scenes and whose comments say
//! what they mean ([`declare_parameters!`](crate::declare_parameters)). Scenes hold that struct; files, records and fits
//! reach its fields by their keys.

use crate::error::BuildError;
use crate::spec::{ModelSpec, Modelling};
use serde::de::{DeserializeOwned, Visitor};
use serde::{Deserializer, Serialize};
use serde_json::Value;
use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;

/// A parameter of a model, with its description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterInfo {
    /// Key of the parameter, with its unit.
    pub key: &'static str,
    /// Description of the effect of the parameter.
    pub meaning: &'static str,
    /// True if the parameter must be given.
    pub required: bool,
}

/// Compares two texts at compile time.
const fn same(a: &[u8], b: &[u8]) -> bool {
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}

/// Describes the parameters of a struct: those of an included part, then its own from their keys and comments. `required`
/// are the keys that must be given, `N` is the total number.
///
/// # Panics
/// At compile time, for another number.
#[must_use]
pub const fn described<const N: usize>(
    part: Option<&[ParameterInfo]>,
    own: &[(&'static str, &'static str)],
    required: &[&str],
) -> [ParameterInfo; N] {
    let part = match part {
        Some(part) => part,
        None => &[],
    };
    assert!(part.len() + own.len() == N, "N is the total number");
    let mut all = [ParameterInfo {
        key: "",
        meaning: "",
        required: false,
    }; N];
    let mut i = 0;
    while i < N {
        if i < part.len() {
            all[i] = part[i];
        } else {
            let (key, comment) = own[i - part.len()];
            (all[i].key, all[i].meaning) = (key, comment.trim_ascii());
            let mut k = 0;
            while k < required.len() {
                all[i].required |= same(key.as_bytes(), required[k].as_bytes());
                k += 1;
            }
        }
        i += 1;
    }
    all
}

/// Declares the parameters of a gear model: a struct of options. The fields are the keys, the comments their meanings, and
/// `required(..)` lists the keys that must be given. `model "id"` makes the struct that of a model; without it, the struct
/// is a part that others include by `flatten name: Struct`, whose keys come first.
#[macro_export]
macro_rules! declare_parameters {
    (
        $(#[$outer:meta])*
        $visibility:vis struct $name:ident $(model $model:literal)? {
            $( $(#[doc = $doc:literal])+ $(#[serde($($serde:tt)*)])* $key:ident: $type:ty, )*
            $(flatten $part:ident: $inner:ty,)?
        }
        $(required($($required:ident),+))?
    ) => {
        $(#[$outer])*
        #[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
        #[serde(default)]
        #[allow(rustdoc::broken_intra_doc_links, reason = "meanings name vectors as [x, y, z]")]
        $visibility struct $name {
            $( $(#[doc = $doc])+ $(#[serde($($serde)*)])* pub $key: Option<$type>, )*
            $(
                /// Parameters that several models have.
                #[serde(flatten)]
                pub $part: $inner,
            )?
        }

        impl $name {
            /// Keys of the parameters with their descriptions.
            pub const KEYS: &'static [$crate::gear::parameters::ParameterInfo] = {
                use $crate::gear::parameters::ParameterInfo;
                const REQUIRED: &[&str] = &[$($(stringify!($required)),+)?];
                const OWN: &[(&str, &str)] = &[$((stringify!($key), concat!($($doc),+))),*];
                const PART: Option<&[ParameterInfo]> = [$(Some(<$inner>::KEYS),)? None][0];
                const ALL: [ParameterInfo; OWN.len() $(+ <$inner>::KEYS.len())?] =
                    $crate::gear::parameters::described(PART, OWN, REQUIRED);
                &ALL
            };
        }

        $(
            impl $crate::gear::parameters::ModelParameters for $name {
                const MODEL: &'static str = $model;
                const KEYS: &'static [$crate::gear::parameters::ParameterInfo] = Self::KEYS;
            }
        )?
    };
}

/// Values of given parameters by their keys, as files and records hold them.
pub type Values = BTreeMap<String, Value>;

/// Parameters of a model: a struct of options whose fields are the keys, made by
/// [`declare_parameters!`](crate::declare_parameters).
pub trait ModelParameters:
    Clone + fmt::Debug + Default + PartialEq + Serialize + DeserializeOwned + Send + Sync + 'static
{
    /// Identifier of the model.
    const MODEL: &'static str;
    /// Keys of the model with their descriptions.
    const KEYS: &'static [ParameterInfo];

    /// Reads the struct from values by key.
    ///
    /// # Errors
    /// The first key that is not known, or whose value is none that it takes.
    fn read(values: Values) -> Result<Self, BuildError> {
        let is_known = |key: &str| Self::KEYS.iter().any(|p| p.key == key);
        if let Some(key) = values.keys().find(|key| !is_known(key)) {
            let known: Vec<&str> = Self::KEYS.iter().map(|p| p.key).collect();
            let way_out = match known.is_empty() {
                true => "it has no parameters".to_string(),
                false => format!("its parameters are {}", known.join(", ")),
            };
            let why = ("is not known", way_out);
            return Err(BuildError::parameter(Self::MODEL, key, why));
        }
        let refuse = |key: &str, why: String| {
            let info = Self::KEYS.iter().find(|p| p.key == key);
            let meaning = info.map_or(String::new(), |p| format!("`{key}`: {}", p.meaning));
            BuildError::parameter(Self::MODEL, key, (why, meaning))
        };
        // JSON has no number that is not finite: a null stands for it.
        if let Some((key, _)) = values.iter().find(|(_, x)| x.is_null()) {
            return Err(refuse(key, "is no finite number".into()));
        }
        let fields: serde_json::Map<String, Value> = (values.into_iter())
            .map(|(k, x)| (k, whole_numbers(x)))
            .collect();
        serde_json::from_value(Value::Object(fields.clone())).map_err(|whole| {
            // All fields are options: the first key that fails by itself is the one to blame.
            let blamed = fields.into_iter().find_map(|(key, value)| {
                let alone = serde_json::Map::from_iter([(key.clone(), value)]);
                let error = serde_json::from_value::<Self>(Value::Object(alone)).err()?;
                Some((key, error))
            });
            let (key, why) = blamed.unwrap_or((String::new(), whole));
            refuse(&key, why.to_string())
        })
    }

    /// Creates a gear of this model with parameters by their keys.
    ///
    /// # Errors
    /// The first key that is not known, or whose value is none that it takes.
    fn by_key<K: Into<String>, V: Into<Value>>(
        values: impl IntoIterator<Item = (K, V)>,
    ) -> Result<ModelSpec, BuildError> {
        let values = values.into_iter().map(|(k, x)| (k.into(), x.into()));
        Ok(Self::read(values.collect())?.spec())
    }

    /// Returns the parameters of a gear, if it is of this model.
    fn of(spec: &ModelSpec) -> Option<&Self> {
        spec.parameters.any().downcast_ref()
    }

    /// Creates a gear of this model with these parameters.
    fn spec(self) -> ModelSpec {
        ModelSpec {
            parameters: Box::new(self),
        }
    }

    /// Changes the parameters of all gears of this model.
    fn change(modelling: &mut Modelling, change: impl Fn(&mut Self)) {
        for gear in &mut modelling.gears {
            if let Some(mut parameters) = Self::of(gear).cloned() {
                change(&mut parameters);
                *gear = parameters.spec();
            }
        }
    }
}

/// Parameters of a gear of any model; implemented for the struct of each.
pub(crate) trait AnyParameters: fmt::Debug + Send + Sync {
    fn any(&self) -> &dyn Any;
    fn copied(&self) -> Box<dyn AnyParameters>;
    fn model(&self) -> &'static str;
    /// The given parameters by their keys.
    fn values(&self) -> Values;
    /// Parameters of the same model from values by key.
    fn read_again(&self, values: Values) -> Result<Box<dyn AnyParameters>, BuildError>;
}

impl<T: ModelParameters> AnyParameters for T {
    fn any(&self) -> &dyn Any {
        self
    }

    fn copied(&self) -> Box<dyn AnyParameters> {
        Box::new(self.clone())
    }

    fn model(&self) -> &'static str {
        T::MODEL
    }

    fn values(&self) -> Values {
        let fields = match serde_json::to_value(self) {
            Ok(Value::Object(fields)) => fields,
            _ => serde_json::Map::new(),
        };
        (fields.into_iter())
            .filter(|(_, value)| !value.is_null())
            .collect()
    }

    fn read_again(&self, values: Values) -> Result<Box<dyn AnyParameters>, BuildError> {
        Ok(Box::new(T::read(values)?))
    }
}

/// Makes integers of whole numbers, which fields of integers and of floats accept.
fn whole_numbers(value: Value) -> Value {
    match value {
        Value::Number(x) => match x.as_f64() {
            Some(x) if x.fract() == 0.0 && x.is_sign_positive() && x <= 9e15 => {
                Value::from(x as u64)
            }
            _ => Value::Number(x),
        },
        Value::Array(all) => all.into_iter().map(whole_numbers).collect(),
        other => other,
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

    fn visit_i64<E>(self, x: i64) -> Result<f64, E> {
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
