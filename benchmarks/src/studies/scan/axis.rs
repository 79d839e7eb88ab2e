//! Axes of a scan: keys of the scene with the values that they take.
//!
//! ```text
//! KEY=1e-6,2e-6,5e-6         listed values (numbers, "texts", true, tables in TOML)
//! KEY=10..100:10             ten values, evenly spaced;  10..100:10:log on a logarithmic scale
//! KEY=uniform(a,b)           a distribution that is sampled; see [`Distribution`]
//! KEY=seeds(200)             the numbers 1 to 200, one for each sample; seeds(1001,1200) those from 1001 on
//! KEY | KEY = 1 | 10, 2 | 5  keys that change together
//! ```

use crate::experiment::conditions::logarithmic;
use crate::scene_file::changes::KeyPath;
use crate::scene_file::format::number;
use statrs::distribution::{ContinuousCDF, Normal, Triangular};
use std::fmt;
use toml_edit::Value;

/// Largest number of values of a listed axis.
const MOST_VALUES: usize = 100_000;

/// Keys that change together, and the values that they take.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Paths of the keys in the scene file, at least one.
    pub keys: Vec<KeyPath>,
    /// The values.
    pub values: AxisValues,
}

/// Values of an axis: a list that is run through, or random ones.
#[derive(Clone, Debug)]
pub enum AxisValues {
    /// Every value occurs in combination with all values of other listed axes; each has one entry for each key.
    Listed(Vec<Vec<Value>>),
    /// Values of a distribution.
    Sampled(Distribution),
    /// The number of the sample.
    Seeds {
        /// Number of the first sample.
        first: i64,
        /// Number of samples.
        count: usize,
    },
}

/// Distribution of a value, by the names and parameters that textbooks give them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Uniform between two values.
    Uniform(f64, f64),
    /// The logarithm is uniform between those of two positive values.
    LogUniform(f64, f64),
    /// Normal, by mean and standard deviation.
    Normal(f64, f64),
    /// The logarithm is normal, by median and standard deviation of the natural logarithm.
    LogNormal(f64, f64),
    /// Triangular, by least, most likely and greatest value.
    Triangular(f64, f64, f64),
    /// Whole numbers between two, both included.
    Integers(i64, i64),
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let keys: Vec<String> = self.keys.iter().map(ToString::to_string).collect();
        write!(f, "{}={}", keys.join(" | "), self.values)
    }
}

impl fmt::Display for AxisValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AxisValues::Listed(all) => {
                let part = |v: &Value| v.to_string().trim().to_owned();
                let entry = |all: &Vec<Value>| all.iter().map(part).collect::<Vec<_>>().join(" | ");
                f.write_str(&all.iter().map(entry).collect::<Vec<_>>().join(","))
            }
            AxisValues::Sampled(distribution) => distribution.fmt(f),
            AxisValues::Seeds { first, count } => {
                write!(f, "seeds({first},{})", first + *count as i64 - 1)
            }
        }
    }
}

/// Text of a value without quotes.
pub fn text(value: &Value) -> String {
    match value.as_str() {
        Some(text) => text.to_owned(),
        None => value.to_string().trim().to_owned(),
    }
}

impl std::str::FromStr for Axis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected KEY=VALUES, such as gears.pinion.speed_rad_s=10,20,40 or meshes.1.centre_distance_m=normal(0.1001,1e-5)";
        let Some((keys, values)) = text.split_once('=') else {
            return Err(format!("`{text}` has no values: {expected}"));
        };
        let keys: Vec<KeyPath> = keys
            .split('|')
            .map(KeyPath::parse)
            .collect::<Result<_, _>>()?;
        let values = values.trim();
        if let Some(random) = sampled(values)? {
            if keys.len() > 1 {
                return Err("keys that change together need listed values".into());
            }
            return Ok(Axis {
                keys,
                values: random,
            });
        }
        let listed = match range(values)? {
            Some(range) => range.into_iter().map(|x| vec![number(x)]).collect(),
            None => apart(values, ',')
                .into_iter()
                .map(|entry| apart(entry, '|').into_iter().map(value).collect())
                .collect::<Vec<Vec<Value>>>(),
        };
        if values.is_empty() || listed.is_empty() {
            return Err(format!("`{text}` has no values: {expected}"));
        }
        if let Some(entry) = listed.iter().find(|entry| entry.len() != keys.len()) {
            let (found, wanted) = (entry.len(), keys.len());
            return Err(format!(
                "{wanted} keys change together, but a value has {found} parts; separate parts by |, values by commas"
            ));
        }
        Ok(Axis {
            keys,
            values: AxisValues::Listed(listed),
        })
    }
}

/// Splits a text at a character outside of quotes and brackets.
fn apart(text: &str, at: char) -> Vec<&str> {
    let (mut depth, mut quoted, mut begin) = (0_i32, false, 0);
    let mut parts = Vec::new();
    for (i, c) in text.char_indices() {
        match c {
            '"' => quoted = !quoted,
            '[' | '{' | '(' if !quoted => depth += 1,
            ']' | '}' | ')' if !quoted => depth -= 1,
            c if c == at && depth == 0 && !quoted => {
                parts.push(text[begin..i].trim());
                begin = i + c.len_utf8();
            }
            _ => {}
        }
    }
    parts.push(text[begin..].trim());
    parts
}

/// A value in TOML; a text needs no quotes.
fn value(text: &str) -> Value {
    let whole = text.parse::<i64>().ok().map(Value::from);
    let decimal = || {
        text.parse::<f64>()
            .ok()
            .filter(|x| x.is_finite())
            .map(number)
    };
    whole
        .or_else(decimal)
        .or_else(|| text.parse().ok())
        .unwrap_or_else(|| text.into())
}

/// Values of `FROM..TO:N` and `FROM..TO:N:log`; `None` for other texts.
fn range(text: &str) -> Result<Option<Vec<f64>>, String> {
    let Some((from, rest)) = text.split_once("..") else {
        return Ok(None);
    };
    let expected = || {
        format!(
            "`{text}` is no range: expected FROM..TO:N, or FROM..TO:N:log between positive values"
        )
    };
    let (rest, log) = rest
        .strip_suffix(":log")
        .map_or((rest, false), |rest| (rest, true));
    let (to, n) = rest.split_once(':').ok_or_else(expected)?;
    let end = |text: &str| text.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let [from, to] = [from, to].map(end);
    let n = n
        .trim()
        .parse()
        .ok()
        .filter(|n| (2..=MOST_VALUES).contains(n));
    let (Some(from), Some(to), Some(n)) = (from, to, n) else {
        return Err(expected());
    };
    if log && !(from > 0.0 && to > 0.0) {
        return Err(expected());
    }
    Ok(Some(match log {
        true => logarithmic(from, to, n).into_iter().map(rounded).collect(),
        false => (0..n - 1)
            .map(|i| rounded(from + (to - from) * i as f64 / (n - 1) as f64))
            .chain([to])
            .collect(),
    }))
}

/// A value to fifteen digits, as one would write it: 0.05 in place of 0.049999999999999996.
fn rounded(x: f64) -> f64 {
    format!("{x:.14e}").parse().unwrap_or(x)
}

/// Random values of `NAME(PARAMETERS)`; `None` for other texts.
fn sampled(text: &str) -> Result<Option<AxisValues>, String> {
    let Some((name, rest)) = text.split_once('(') else {
        return Ok(None);
    };
    if !name.trim().chars().all(|c| c.is_ascii_alphabetic()) || name.trim().is_empty() {
        return Ok(None);
    }
    let refuse = |expected: &str| Err(format!("`{text}`: expected {expected}"));
    let Some(inside) = rest.strip_suffix(')') else {
        return refuse("a closing bracket");
    };
    let parameters: Result<Vec<f64>, _> = inside.split(',').map(|p| p.trim().parse()).collect();
    let parameters = match parameters {
        Ok(all) if all.iter().all(|x: &f64| x.is_finite()) => all,
        _ => return refuse("numbers between the brackets"),
    };
    let found = match (name.trim(), parameters.as_slice()) {
        ("uniform", &[a, b]) if a < b => Distribution::Uniform(a, b),
        ("loguniform", &[a, b]) if 0.0 < a && a < b => Distribution::LogUniform(a, b),
        ("normal", &[mean, deviation]) if deviation > 0.0 => Distribution::Normal(mean, deviation),
        ("lognormal", &[median, sigma]) if median > 0.0 && sigma > 0.0 => {
            Distribution::LogNormal(median, sigma)
        }
        ("triangular", &[a, c, b]) if a <= c && c <= b && a < b => {
            Distribution::Triangular(a, c, b)
        }
        ("integers", &[a, b])
            if a <= b && a.fract() == 0.0 && b.fract() == 0.0 && a.abs().max(b.abs()) < 1e15 =>
        {
            Distribution::Integers(a as i64, b as i64)
        }
        ("seeds", &[n]) if n >= 1.0 && n.fract() == 0.0 && n < 1e9 => {
            return Ok(Some(AxisValues::Seeds {
                first: 1,
                count: n as usize,
            }));
        }
        ("seeds", &[a, b])
            if a >= 0.0
                && a <= b
                && a.fract() == 0.0
                && b.fract() == 0.0
                && b < 1e15
                && b - a < 1e9 =>
        {
            return Ok(Some(AxisValues::Seeds {
                first: a as i64,
                count: (b - a) as usize + 1,
            }));
        }
        _ => {
            return refuse(
                "uniform(FROM,TO), loguniform(FROM,TO), normal(MEAN,DEVIATION), lognormal(MEDIAN,SIGMA), \
                 triangular(LEAST,MOST_LIKELY,GREATEST), integers(FROM,TO), seeds(N) or seeds(FROM,TO), with parameters in order",
            );
        }
    };
    Ok(Some(AxisValues::Sampled(found)))
}

impl Distribution {
    /// The value below which a share of all values lies (the quantile), for a share between 0 and 1, both excluded.
    pub fn quantile(self, share: f64) -> f64 {
        // Parameters were checked when they were read; the fallback is the middle of the values.
        match self {
            Self::Uniform(a, b) => a + (b - a) * share,
            Self::LogUniform(a, b) => a * ((b / a).ln() * share).exp(),
            Self::Normal(mean, deviation) => mean + deviation * standard_normal(share),
            Self::LogNormal(median, sigma) => median * (sigma * standard_normal(share)).exp(),
            Self::Triangular(a, c, b) => {
                Triangular::new(a, b, c).map_or(c, |d| d.inverse_cdf(share))
            }
            Self::Integers(a, b) => {
                let n = (b - a + 1) as f64;
                (a as f64 + (n * share).floor()).min(b as f64)
            }
        }
    }

    /// The value of a share as it is written into the scene.
    pub fn value(self, share: f64) -> Value {
        match self {
            Self::Integers(..) => (self.quantile(share) as i64).into(),
            _ => number(self.quantile(share)),
        }
    }
}

fn standard_normal(share: f64) -> f64 {
    Normal::standard().inverse_cdf(share)
}

impl fmt::Display for Distribution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Uniform(a, b) => write!(f, "uniform({a},{b})"),
            Self::LogUniform(a, b) => write!(f, "loguniform({a},{b})"),
            Self::Normal(a, b) => write!(f, "normal({a},{b})"),
            Self::LogNormal(a, b) => write!(f, "lognormal({a},{b})"),
            Self::Triangular(a, c, b) => write!(f, "triangular({a},{c},{b})"),
            Self::Integers(a, b) => write!(f, "integers({a},{b})"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(text: &str) -> Vec<String> {
        match text.parse::<Axis>().unwrap().values {
            AxisValues::Listed(all) => (all.iter())
                .map(|entry| {
                    let parts: Vec<String> = entry.iter().map(|v| v.to_string()).collect();
                    parts.join("|")
                })
                .collect(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn values_are_listed_ranged_or_joined() {
        // The arithmetic gives 0.049999999999999996.
        assert_eq!(range("0..0.06:7").unwrap().unwrap()[5], 0.05);
        assert_eq!(listed("a.b=1,2.5,1e-6"), ["1", "2.5", "1e-6"]);
        assert_eq!(
            listed("a=hertz,\"x,y\",true"),
            ["\"hertz\"", "\"x,y\"", "true"]
        );
        assert_eq!(listed("a=[1, 2],{ k = 1 }"), ["[1, 2]", "{ k = 1 }"]);
        assert_eq!(listed("a=1..3:3"), ["1.0", "2.0", "3.0"]);
        assert_eq!(listed("a=1e-6..1e-2:3:log").len(), 3);
        assert_eq!(listed("a | b = 1 | 10, 2 | 5"), ["1|10", "2|5"]);
        let axis: Axis = "models.\"rigid-5.72\".contact.friction=0.1"
            .parse()
            .unwrap();
        assert_eq!(
            axis.keys[0].names(),
            ["models", "rigid-5.72", "contact", "friction"]
        );
        assert_eq!(
            axis.keys[0].to_string(),
            "models.\"rigid-5.72\".contact.friction"
        );
    }

    #[test]
    fn wrong_values_are_refused_with_what_was_expected() {
        for (text, expected) in [
            ("a", "has no values"),
            ("a=", "has no values"),
            ("a..b=1", "no key"),
            ("a=1..2", "FROM..TO:N"),
            ("a=-1..2:3:log", "positive"),
            ("a=uniform(2,1)", "uniform(FROM,TO)"),
            ("a=gauss(0,1)", "normal(MEAN,DEVIATION)"),
            ("a=normal(0,x)", "numbers"),
            ("a|b=1,2", "separate parts by |"),
            ("a|b=uniform(0,1)", "listed"),
        ] {
            let e = text.parse::<Axis>().unwrap_err();
            assert!(e.contains(expected), "{text}: {e}");
        }
    }

    /// Quantiles against values of tables: of the standard normal distribution, and of distributions in closed form.
    #[test]
    fn quantiles() {
        let near = |a: f64, b: f64| assert!((a - b).abs() <= 1e-9 * b.abs().max(1.0), "{a} {b}");
        near(
            Distribution::Normal(0.0, 1.0).quantile(0.975),
            1.959_963_984_540_054,
        );
        near(Distribution::Normal(3.0, 2.0).quantile(0.5), 3.0);
        near(Distribution::LogNormal(2.0, 0.5).quantile(0.5), 2.0);
        near(Distribution::LogUniform(1.0, 100.0).quantile(0.5), 10.0);
        near(Distribution::Triangular(0.0, 1.0, 4.0).quantile(0.25), 1.0);
        let whole = Distribution::Integers(1, 6);
        assert_eq!(
            [1e-9, 0.5, 1.0 - 1e-9].map(|u| whole.quantile(u)),
            [1.0, 4.0, 6.0]
        );
    }
}
