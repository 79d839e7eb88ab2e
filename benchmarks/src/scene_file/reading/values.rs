//! Values with limits, and names that the scene itself defines.

use gearbench_integrators::spec::ids;
use gearbench_integrators::{MethodError, MethodSpec};
use gearbench_reports::Metric;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, Unexpected, Visitor};
use serde::{Serialize, Serializer};
use std::fmt;
use std::marker::PhantomData;
use std::sync::LazyLock;

macro_rules! limited {
    ($($(#[$doc:meta])* $name:ident, $expected:literal, $fits:expr;)*) => { $(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let x = f64::deserialize(deserializer)?;
                let fits: fn(f64) -> bool = $fits;
                match fits(x) {
                    true => Ok($name(x)),
                    false => Err(D::Error::invalid_value(Unexpected::Float(x), &$expected)),
                }
            }
        }

        impl From<$name> for f64 {
            fn from(x: $name) -> f64 {
                x.0
            }
        }

        impl From<f64> for $name {
            /// Takes a value as it is; it is checked when the table is read.
            fn from(x: f64) -> $name {
                $name(x)
            }
        }
    )* };
}

limited! {
    /// A number greater than zero.
    Positive, "more than 0", |x| x > 0.0;
    /// A number of zero or more.
    NotNegative, "zero or more", |x| x >= 0.0;
    /// A share between 0 and 1, such as a tolerance.
    Share, "more than 0 and less than 1", |x| x > 0.0 && x < 1.0;
    /// A ratio of step sizes.
    Factor, "more than 0 and less than 1000000", |x| x > 0.0 && x < 1e6;
}

/// An angle in degrees.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(transparent)]
pub struct Degrees(pub f64);

impl Degrees {
    /// The angle [rad].
    pub fn radians(self) -> f64 {
        self.0.to_radians()
    }
}

/// True for a value that a file need not have.
pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// An integer between two limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(transparent)]
pub struct Count<const LEAST: u32, const MOST: u32>(pub usize);

impl<'de, const LEAST: u32, const MOST: u32> Deserialize<'de> for Count<LEAST, MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let n = u32::deserialize(deserializer)?;
        if (LEAST..=MOST).contains(&n) {
            return Ok(Count(n as usize));
        }
        let expected = if MOST == u32::MAX {
            format!("at least {LEAST}")
        } else {
            format!("{LEAST} to {MOST}")
        };
        let found = Unexpected::Unsigned(n.into());
        Err(D::Error::invalid_value(found, &expected.as_str()))
    }
}

macro_rules! words_of_the_scene {
    ($($(#[$doc:meta])* $name:ident, $known:literal;)*) => { $(
        $(#[$doc])*
        #[derive(
            Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, serde::Deserialize, serde::Serialize,
        )]
        #[serde(rename = $known)]
        pub struct $name(pub String);

        impl From<&str> for $name {
            fn from(text: &str) -> Self {
                $name(text.to_owned())
            }
        }
    )* };
}

words_of_the_scene! {
    /// Name of a gear.
    GearName, "<gear>";
    /// Label of one of the models.
    Label, "<model>";
    /// Id of a gear model.
    ModelId, "<gear model>";
    /// Name of a contact law of the program.
    ForceLawName, "<contact law>";
    /// Name of a calibration.
    CalibrationName, "<calibration>";
}

/// A list without duplicates.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(rename = "<distinct>")]
pub struct Distinct<T>(pub Vec<T>);

impl Distinct<Label> {
    /// Converts the list to plain labels.
    pub(crate) fn labels(self) -> Vec<String> {
        self.0.into_iter().map(|l| l.0).collect()
    }
}

/// One value, or a list of values.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub enum OneOrMany<T> {
    /// One value.
    #[serde(rename = "<table>")]
    One(T),
    /// A list of values.
    #[serde(rename = "<list>")]
    Many(Vec<T>),
}

impl<T: Default> Default for OneOrMany<T> {
    fn default() -> Self {
        OneOrMany::One(T::default())
    }
}

/// A table with user-defined names, in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderedTable<T>(pub Vec<(String, T)>);

impl<T> Default for OrderedTable<T> {
    fn default() -> Self {
        OrderedTable(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OrderedTable<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<T>(PhantomData<T>);

        impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
            type Value = OrderedTable<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let entries = std::iter::from_fn(|| map.next_entry().transpose());
                entries.collect::<Result<_, _>>().map(OrderedTable)
            }
        }
        deserializer.deserialize_map(Entries(PhantomData))
    }
}

impl<T: Serialize> Serialize for OrderedTable<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// An integrator: id or id(name=value).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method(pub MethodSpec);

impl Serialize for Method {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

static METHOD_IDS: LazyLock<Vec<&'static str>> = LazyLock::new(ids);

impl<'de> Deserialize<'de> for Method {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map(Method).map_err(|e| match e {
            MethodError::Unknown(id) => D::Error::unknown_variant(&id, &METHOD_IDS),
            e => D::Error::custom(format!(
                "{e}; give parameters in parentheses: id(name=value)"
            )),
        })
    }
}

macro_rules! metrics {
    ($($(#[$doc:meta])* $name:ident, $holds:expr, $known:expr;)*) => { $(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name(pub Metric);

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.0.key())
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                static KNOWN: LazyLock<Vec<&'static str>> = LazyLock::new(|| $known);
                let word = String::deserialize(deserializer)?;
                match word.parse() {
                    Ok(metric) if $holds(metric) => Ok($name(metric)),
                    _ => Err(D::Error::unknown_variant(&word, &KNOWN)),
                }
            }
        }
    )* };
}

/// A quantity of interest: a metric, or the last speeds of all gears.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct QuantityKey(&'static str);

/// Last speeds of all gears, and of the first two gears in scenes of former versions.
const LAST_SPEEDS: [&str; 3] = ["speeds_end", "omega1_end", "omega2_end"];

impl QuantityKey {
    /// Returns the metric; `None` for speeds.
    pub(crate) fn metric(self) -> Option<Metric> {
        self.0.parse().ok()
    }
}

impl From<Metric> for QuantityKey {
    fn from(metric: Metric) -> Self {
        QuantityKey(metric.key())
    }
}

impl<'de> Deserialize<'de> for QuantityKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        static KNOWN: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
            let metrics = Metric::ALL.into_iter().map(Metric::key);
            metrics.chain(LAST_SPEEDS.into_iter().take(1)).collect()
        });
        let word = String::deserialize(deserializer)?;
        let metric = word.parse().ok().map(Metric::key);
        let speeds = || LAST_SPEEDS.into_iter().find(|key| *key == word);
        (metric.or_else(speeds).map(QuantityKey))
            .ok_or_else(|| D::Error::unknown_variant(&word, &KNOWN))
    }
}

metrics! {
    /// A metric; errors list the keys of records, and names of the command line are valid as well.
    MetricKey, |_| true, Metric::ALL.map(Metric::key).to_vec();
    /// A relative error; errors list the names of the command line, and keys of records are valid as well.
    MetricOption, Metric::is_error, Metric::ALL.into_iter().filter_map(Metric::option).collect();
}
