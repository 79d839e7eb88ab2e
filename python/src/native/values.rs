//! Values of Python as TOML, and the reverse.

use super::errors::input_error;
use gearbench::scene_file::format::number;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PyString};
use toml_edit::{Array, InlineTable, Item, TableLike, Value};

/// Deepest nesting of tables and lists.
const DEEPEST: usize = 40;

/// Converts a mapping to a table. Entries that are `None` are left out.
///
/// # Errors
/// `TypeError` for a value that TOML does not have, with the path of its key.
pub fn to_table(of: &Bound<'_, PyAny>) -> PyResult<InlineTable> {
    match to_value(of, &mut Vec::new())? {
        Some(Value::InlineTable(table)) => Ok(table),
        _ => Err(PyTypeError::new_err("expected a mapping of keys to values")),
    }
}

/// Converts one value; `None` for `None`.
///
/// # Errors
/// As [`to_table`].
pub fn to_value(of: &Bound<'_, PyAny>, path: &mut Vec<String>) -> PyResult<Option<Value>> {
    if path.len() > DEEPEST {
        return Err(unsuitable(of, path));
    }
    Ok(Some(if of.is_none() {
        return Ok(None);
    } else if of.is_instance_of::<PyBool>() {
        of.extract::<bool>()?.into()
    } else if of.is_instance_of::<PyInt>() {
        of.extract::<i64>()?.into()
    } else if of.is_instance_of::<PyFloat>() {
        number(of.extract()?)
    } else if of.is_instance_of::<PyString>() {
        of.extract::<String>()?.into()
    } else if let Ok(mapping) = of.cast::<PyMapping>() {
        let mut table = InlineTable::new();
        for entry in mapping.items()?.iter() {
            let (key, value): (String, Bound<'_, PyAny>) = entry.extract()?;
            path.push(key.clone());
            if let Some(value) = to_value(&value, path)? {
                table.insert(&key, value);
            }
            path.pop();
        }
        table.into()
    } else if of.hasattr("tolist")? {
        // Arrays and numbers of numpy.
        return to_value(&of.call_method0("tolist")?, path);
    } else if of.hasattr("__fspath__")? {
        of.call_method0("__fspath__")?.extract::<String>()?.into()
    } else if let Ok(members) = of.try_iter() {
        let mut list = Array::new();
        for (i, member) in members.enumerate() {
            path.push(i.to_string());
            let member = member?;
            let value = to_value(&member, path)?.ok_or_else(|| unsuitable(&member, path))?;
            list.push(value);
            path.pop();
        }
        list.into()
    } else {
        return Err(unsuitable(of, path));
    }))
}

fn unsuitable(of: &Bound<'_, PyAny>, path: &[String]) -> PyErr {
    let kind = of.get_type();
    let kind = kind
        .name()
        .map_or_else(|_| "value".to_owned(), |n| n.to_string());
    input_error(
        of.py(),
        &format!("`{}`: a scene cannot contain a {kind}", path.join(".")),
        "give a number, a text, a list, or a table of these",
    )
}

/// Converts a value of TOML to numbers, texts, lists and dictionaries.
///
/// # Errors
/// Errors of Python.
pub fn of_value<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::String(text) => PyString::new(py, text.value()).into_any(),
        Value::Integer(n) => (*n.value()).into_pyobject(py)?.into_any(),
        Value::Float(x) => PyFloat::new(py, *x.value()).into_any(),
        Value::Boolean(flag) => PyBool::new(py, *flag.value()).to_owned().into_any(),
        Value::Datetime(time) => PyString::new(py, &time.value().to_string()).into_any(),
        Value::Array(list) => {
            let members = list.iter().map(|v| of_value(py, v));
            PyList::new(py, members.collect::<PyResult<Vec<_>>>()?)?.into_any()
        }
        Value::InlineTable(table) => of_table(py, table)?.into_any(),
    })
}

/// Converts a table to a dictionary in its order.
///
/// # Errors
/// Errors of Python.
pub fn of_table<'py>(py: Python<'py>, table: &dyn TableLike) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for (key, item) in table.iter() {
        let value = match item {
            Item::Value(value) => of_value(py, value)?,
            Item::Table(table) => of_table(py, table)?.into_any(),
            Item::ArrayOfTables(list) => {
                let members = list.iter().map(|t| of_table(py, t));
                PyList::new(py, members.collect::<PyResult<Vec<_>>>()?)?.into_any()
            }
            Item::None => continue,
        };
        all.set_item(key, value)?;
    }
    Ok(all)
}
