//! Changes of values in the text of a scene: comments and layout stay. A path of names between dots selects a key, such
//! as `gears.pinion.speed_rad_s`; entries of lists are selected by name, by number or all of them, as
//! `shafts.*.damping_s`.

use std::fmt;
use toml_edit::{DocumentMut, InlineTable, Item, Table, TableLike, Value};

/// A table in a table, made where there is none.
pub fn inner<'t>(table: &'t mut dyn TableLike, key: &str) -> Option<&'t mut dyn TableLike> {
    if !table.contains_key(key) {
        table.insert(key, Item::Value(InlineTable::new().into()));
    }
    table.get_mut(key)?.as_table_like_mut()
}

/// Sets a value in a table and keeps the comments and spaces around it.
pub fn set(table: &mut dyn TableLike, key: &str, mut value: Value) {
    if let Some(old) = table.get(key).and_then(Item::as_value) {
        *value.decor_mut() = old.decor().clone();
    }
    match table.get_mut(key) {
        Some(item @ Item::Value(_)) => *item = Item::Value(value),
        // A table under a header of its own keeps that.
        Some(Item::Table(own)) if value.is_inline_table() => {
            fill(own, value);
        }
        _ => {
            table.insert(key, Item::Value(value));
        }
    }
}

/// Copies the entries of an inline table into a table of several lines.
fn fill(own: &mut Table, value: Value) {
    let Value::InlineTable(new) = value else {
        return;
    };
    own.retain(|key, _| new.contains_key(key));
    for (key, value) in new {
        set(own, &key, value);
    }
}

/// Path of a key in a scene file: names between dots, or in quotes where a name contains a dot; entries of a list by
/// their label, name or number from 1; `*` for all entries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyPath(Vec<String>);

impl KeyPath {
    /// Reads a path.
    ///
    /// # Errors
    /// A sentence about a name that is missing.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut names = vec![String::new()];
        let mut quoted = false;
        for c in text.trim().chars() {
            match c {
                '"' => quoted = !quoted,
                '.' if !quoted => names.push(String::new()),
                c => names.last_mut().into_iter().for_each(|n| n.push(c)),
            }
        }
        if quoted || names.iter().any(String::is_empty) {
            let expected = "expected names between dots, such as gears.pinion.speed_rad_s";
            return Err(format!("`{}` is no key: {expected}", text.trim()));
        }
        Ok(KeyPath(names))
    }

    /// The names of the path.
    pub fn names(&self) -> &[String] {
        &self.0
    }
}

impl fmt::Display for KeyPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, name) in self.0.iter().enumerate() {
            f.write_str(if i > 0 { "." } else { "" })?;
            match name.contains('.') {
                true => write!(f, "\"{name}\"")?,
                false => f.write_str(name)?,
            }
        }
        Ok(())
    }
}

/// Name of the keys by which the path of a key names an entry of a list.
const NAMES: [&str; 5] = ["label", "name", "model", "body", "gear"];
/// Name of all entries.
const ALL: &str = "*";

/// Writes a value at every place that a path names; keys that do not exist yet are added.
///
/// # Errors
/// A sentence that names the part of the path that does not exist.
pub fn set_at(document: &mut DocumentMut, path: &KeyPath, value: &Value) -> Result<(), String> {
    visit(document, path, &mut |table, key| {
        set(table, key, value.clone())
    })
}

/// Returns the numbers at all places that a path names; places without one are passed over.
///
/// # Errors
/// As [`set_at`].
pub fn numbers_at(document: &DocumentMut, path: &KeyPath) -> Result<Vec<f64>, String> {
    let mut found = Vec::new();
    // Tables on the way that do not exist are made, so that a copy is visited.
    visit(&mut document.clone(), path, &mut |table, key| {
        let value = table.get(key).and_then(Item::as_value);
        let number = value.and_then(|v| v.as_float().or(v.as_integer().map(|i| i as f64)));
        found.extend(number);
    })?;
    Ok(found)
}

/// A function that is called with a table and one of its keys.
type Visit<'v> = &'v mut dyn FnMut(&mut dyn TableLike, &str);

fn visit(document: &mut DocumentMut, path: &KeyPath, at: Visit<'_>) -> Result<(), String> {
    in_table(document.as_table_mut(), path.names(), at).map_err(|e| format!("`{path}`: {e}"))
}

fn in_table(table: &mut dyn TableLike, path: &[String], at: Visit<'_>) -> Result<(), String> {
    let (name, rest) = match path {
        [] => return Err("the path of the key is empty".into()),
        [name, rest @ ..] => (name.as_str(), rest),
    };
    if name == ALL {
        let names: Vec<String> = table.iter().map(|(k, _)| k.to_owned()).collect();
        let mut of_one = |name: String| {
            let path: Vec<String> = std::iter::once(name).chain(rest.iter().cloned()).collect();
            in_table(table, &path, at)
        };
        return names.into_iter().try_for_each(&mut of_one);
    }
    if rest.is_empty() {
        at(table, name);
        return Ok(());
    }
    if !table.contains_key(name) {
        inner(table, name);
    }
    let item = table.get_mut(name);
    let item = item.ok_or_else(|| format!("there is no `{name}`"))?;
    in_item(item, name, rest, at)
}

fn in_item(item: &mut Item, name: &str, path: &[String], at: Visit<'_>) -> Result<(), String> {
    if let Some(table) = item.as_table_like_mut() {
        return in_table(table, path, at);
    }
    let no_entries = || format!("`{name}` has no entries to name");
    match item {
        Item::ArrayOfTables(all) => {
            let all = all.iter_mut().map(|t| t as &mut dyn TableLike);
            in_list(all.collect(), name, path, at)
        }
        Item::Value(Value::Array(all)) => {
            let tables = all.iter_mut().map(|v| v.as_inline_table_mut());
            let tables: Option<Vec<_>> =
                tables.map(|t| t.map(|t| t as &mut dyn TableLike)).collect();
            in_list(tables.ok_or_else(no_entries)?, name, path, at)
        }
        _ => Err(no_entries()),
    }
}

/// Writes a value into the entries of a list that the first name of the path selects: by number from 1, by label, or all.
fn in_list(
    mut all: Vec<&mut dyn TableLike>,
    list: &str,
    path: &[String],
    at: Visit<'_>,
) -> Result<(), String> {
    let [name, rest @ ..] = path else {
        return Err(format!("`{list}` is a list: name an entry of it"));
    };
    let labels: Vec<String> = all.iter().map(|entry| label_of(&**entry)).collect();
    let chosen: Vec<usize> = if name == ALL {
        (0..all.len()).collect()
    } else if let Some(i) = labels.iter().position(|l| l == name) {
        vec![i]
    } else {
        let number = name
            .parse::<usize>()
            .ok()
            .filter(|i| (1..=all.len()).contains(i));
        number.map(|i| i - 1).into_iter().collect()
    };
    if chosen.is_empty() {
        let known: Vec<String> = (labels.iter().enumerate())
            .map(|(i, l)| {
                if l.is_empty() {
                    (i + 1).to_string()
                } else {
                    l.clone()
                }
            })
            .collect();
        return Err(format!(
            "`{list}` has no entry `{name}`; it has {}",
            known.join(", ")
        ));
    }
    for i in chosen {
        in_table(&mut *all[i], rest, at)?;
    }
    Ok(())
}

fn label_of(entry: &dyn TableLike) -> String {
    let text = |key: &&str| entry.get(key)?.as_str().map(str::to_owned);
    NAMES.iter().find_map(text).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(text: &str, key: &str, value: &str) -> Result<String, String> {
        let mut document: DocumentMut = text.parse().unwrap();
        set_at(
            &mut document,
            &KeyPath::parse(key).unwrap(),
            &value.parse().unwrap(),
        )?;
        Ok(document.to_string())
    }

    const SCENE: &str = "a = 1 # kept\n[gears.x]\nspeed = 2\n[gears.y]\nspeed = 3\n[[models]]\nmodel = \"rigid\"\n\
                         [[models]]\nlabel = \"soft\"\nmodel = \"rigid\"\ncontact = { k = 1 }\n";

    #[test]
    fn values_are_replaced_and_added() {
        let of = |key, value| changed(SCENE, key, value).unwrap();
        assert!(of("a", "5").starts_with("a = 5 # kept\n"));
        assert!(of("gears.y.speed", "7").contains("[gears.y]\nspeed = 7\n"));
        assert_eq!(of("gears.*.speed", "7").matches("speed = 7").count(), 2);
        assert!(of("models.soft.contact.k", "4").contains("k = 4"));
        assert!(of("models.1.contact.k", "4").contains("contact = { k = 4 }\n[[models]]\nlabel"));
        assert!(
            of("models.rigid.contact.k", "4").contains("contact = { k = 4 }\n[[models]]\nlabel")
        );
        assert_eq!(of("models.*.gap", "4").matches("gap = 4").count(), 2);
        assert!(of("study.samples", "9").contains("study = { samples = 9 }"));
        let e = changed(SCENE, "models.stiff.k", "1").unwrap_err();
        assert!(e.contains("rigid, soft"), "{e}");
        assert!(
            changed(SCENE, "a.b", "1")
                .unwrap_err()
                .contains("no entries")
        );
    }

    #[test]
    fn numbers_are_read_at_all_places_of_a_path() {
        let document: DocumentMut = SCENE.parse().unwrap();
        let of = |key| numbers_at(&document, &KeyPath::parse(key).unwrap()).unwrap();
        assert_eq!(of("gears.*.speed"), [2.0, 3.0]);
        assert_eq!(of("models.soft.contact.k"), [1.0]);
        assert!(of("gears.x.torque").is_empty() && of("study.samples").is_empty());
    }
}
