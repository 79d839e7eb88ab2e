//! Comparison of two fingerprints.

use super::{BITS, List};
use std::collections::BTreeMap;

/// Names that were changed on purpose, read from a text of lines `OLD -> NEW`.
///
/// `OLD` is a part of a key, such as `.maps[`, and is replaced wherever it stands in a key; with `value PART: ` in front
/// it is a part of the values whose key contains `PART`. Remarks begin with `#`.
#[derive(Clone, Debug, Default)]
pub struct Renames(Vec<(Option<String>, String, String)>);

impl Renames {
    /// Reads the lines of renamed keys.
    ///
    /// # Panics
    /// If a line is none.
    #[must_use]
    pub fn of_text(text: &str) -> Renames {
        let read = |line: &str| {
            let value = line.strip_prefix("value ").and_then(|l| l.split_once(": "));
            let (part, rest) = value.map_or((None, line), |(part, rest)| (Some(part.into()), rest));
            let names = rest.split_once(" -> ");
            let (old, new) = names.unwrap_or_else(|| panic!("no ` -> ` in {line}"));
            (part, old.into(), new.into())
        };
        let lines = text
            .lines()
            .filter(|l| !l.starts_with('#') && !l.is_empty());
        Renames(lines.map(read).collect())
    }

    /// Returns an old list under the new names.
    #[must_use]
    pub fn apply(&self, old: &List) -> List {
        let mut new = List::default();
        for (key, value) in &old.0 {
            let (mut key, mut value) = (key.clone(), value.clone());
            for (part, from, to) in &self.0 {
                match part {
                    None => key = key.replace(from, to),
                    Some(part) if key.contains(part) => value = value.replace(from, to),
                    Some(_) => {}
                }
            }
            new.add(key, value);
        }
        new
    }
}

/// Difference of two lists under one key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Difference {
    /// The value changed: old, new.
    Changed(String, String),
    /// The key is new.
    Added(String),
    /// The key was removed.
    Removed(String),
}

/// Returns all keys with different values.
#[must_use]
pub fn differences(old: &List, new: &List) -> BTreeMap<String, Difference> {
    let mut found = BTreeMap::new();
    for (key, a) in &old.0 {
        match new.0.get(key) {
            Some(b) if a == b => {}
            Some(b) => drop(found.insert(key.clone(), Difference::Changed(a.clone(), b.clone()))),
            None => drop(found.insert(key.clone(), Difference::Removed(a.clone()))),
        }
    }
    let added = new.0.iter().filter(|(k, _)| !old.0.contains_key(*k));
    found.extend(added.map(|(k, v)| (k.clone(), Difference::Added(v.clone()))));
    found
}

/// Returns the stored form of a list: without the bits, which differ between machines, and of long lists only the
/// sums.
#[must_use]
pub fn golden_form(list: &List) -> List {
    let left_out = [BITS, ".first", ".last", ".len"];
    let kept = (list.0.iter()).filter(|(k, _)| !left_out.iter().any(|end| k.ends_with(end)));
    List(kept.map(|(k, v)| (k.clone(), v.clone())).collect())
}

/// Relative difference of numbers that is attributed to rounding.
const ALLOWED: f64 = 1e-9;

/// Returns the unit at the end of a key, `_j` or `_rel`; values of one unit are compared in size.
fn unit(name: &str) -> &str {
    name.rfind('_').map_or("", |i| &name[i..])
}

/// Returns the differences from a stored list: numbers with a decimal point are compared within 1e-9 of themselves or
/// of the largest neighbour of the same unit (for pure numbers, of one), anything else exactly. New keys are accepted.
#[must_use]
pub fn off_golden(stored: &List, now: &List) -> BTreeMap<String, Difference> {
    let number = |v: &str| v.contains(['.', 'e']).then(|| v.parse::<f64>().ok())?;
    let group = |key: &str| {
        let key = [".sum", ".magnitude", ".first", ".last"]
            .iter()
            .find_map(|s| key.strip_suffix(s).map(|k| format!("{k}[]")))
            .unwrap_or_else(|| key.to_owned());
        let (parent, name) = key.rsplit_once(['.', '[']).unwrap_or(("", &key));
        (parent.to_owned(), unit(name).to_owned())
    };
    let mut scales: BTreeMap<(String, String), f64> = BTreeMap::new();
    for (key, value) in &stored.0 {
        if let Some(x) = number(value) {
            let of = group(key);
            let least = if ["_rel", "_l2", "_aligned"].contains(&&*of.1) {
                1.0
            } else {
                0.0
            };
            let scale = scales.entry(of).or_insert(least);
            *scale = scale.max(x.abs());
        }
    }
    let mut found = differences(stored, &golden_form(now));
    found.retain(|key, difference| match difference {
        Difference::Added(_) => false,
        Difference::Removed(_) => true,
        Difference::Changed(a, b) => match (number(a), number(b)) {
            (Some(x), Some(y)) => {
                let scale = scales.get(&group(key)).copied().unwrap_or(0.0);
                !y.is_finite() || (x - y).abs() > ALLOWED * scale
            }
            _ => true,
        },
    });
    found
}
