//! Changes of values in the text of a scene: comments and layout stay.

use toml_edit::{InlineTable, Item, Table, TableLike, Value};

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
