//! Changes of keys in the text of a scene.

use super::axis::KeyPath;
use crate::scene_file::changes;
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// Name of the keys by which the path of a key names an entry of a list.
const NAMES: [&str; 3] = ["label", "name", "model"];
/// Name of all entries.
const ALL: &str = "*";

/// Writes a value at every place that a path names; keys that do not exist yet are added.
///
/// # Errors
/// A sentence that names the part of the path that does not exist.
pub fn set(document: &mut DocumentMut, path: &KeyPath, value: &Value) -> Result<(), String> {
    in_table(document.as_table_mut(), path.names(), value).map_err(|e| format!("`{path}`: {e}"))
}

fn in_table(table: &mut dyn TableLike, path: &[String], value: &Value) -> Result<(), String> {
    let (name, rest) = match path {
        [] => return Err("the path of the key is empty".into()),
        [name, rest @ ..] => (name.as_str(), rest),
    };
    if name == ALL {
        let names: Vec<String> = table.iter().map(|(k, _)| k.to_owned()).collect();
        let of_one = |name: String| {
            let path: Vec<String> = std::iter::once(name).chain(rest.iter().cloned()).collect();
            in_table(table, &path, value)
        };
        return names.into_iter().try_for_each(of_one);
    }
    if rest.is_empty() {
        changes::set(table, name, value.clone());
        return Ok(());
    }
    if !table.contains_key(name) {
        changes::inner(table, name);
    }
    let item = table.get_mut(name);
    let item = item.ok_or_else(|| format!("there is no `{name}`"))?;
    in_item(item, name, rest, value)
}

fn in_item(item: &mut Item, name: &str, path: &[String], value: &Value) -> Result<(), String> {
    if let Some(table) = item.as_table_like_mut() {
        return in_table(table, path, value);
    }
    let no_entries = || format!("`{name}` has no entries to name");
    match item {
        Item::ArrayOfTables(all) => {
            let all = all.iter_mut().map(|t| t as &mut dyn TableLike);
            in_list(all.collect(), name, path, value)
        }
        Item::Value(Value::Array(all)) => {
            let tables = all.iter_mut().map(|v| v.as_inline_table_mut());
            let tables: Option<Vec<_>> =
                tables.map(|t| t.map(|t| t as &mut dyn TableLike)).collect();
            in_list(tables.ok_or_else(no_entries)?, name, path, value)
        }
        _ => Err(no_entries()),
    }
}

/// Writes a value into the entries of a list that the first name of the path selects: by number from 1, by label, or all.
fn in_list(
    mut all: Vec<&mut dyn TableLike>,
    list: &str,
    path: &[String],
    value: &Value,
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
        in_table(&mut *all[i], rest, value)?;
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
    use crate::studies::scan::axis::Axis;

    fn changed(text: &str, key: &str, value: &str) -> Result<String, String> {
        let mut document: DocumentMut = text.parse().unwrap();
        let axis: Axis = format!("{key}={value}").parse().unwrap();
        set(&mut document, &axis.keys[0], &value.parse().unwrap())?;
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
}
