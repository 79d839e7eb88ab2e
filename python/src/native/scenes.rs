//! Scenes: read, written, checked and changed by the reader of scene files.

use super::errors::{input_error, scene_error};
use super::laws::{GivenLaw, with_laws};
use super::values::{of_table, to_table, to_value};
use gearbench::context::Context;
use gearbench::messages::OutputForm;
use gearbench::scene_file::format::{
    KeyPath, SceneTable, TableDescription, check_table, laid_out, set_at, tables,
};
use gearbench::scene_file::{SHIPPED, Selection, load_for};
use gearbench_reference::reduction::cache::Cache;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::sync::Arc;
use toml_edit::DocumentMut;

/// The context of a call: warnings are kept, nothing is printed, reductions are cached as by the command.
pub fn context() -> Context {
    let mut context = Context::default();
    context.messages.form = OutputForm::Json;
    context.resources.cache = Arc::new(Cache::standard());
    context
}

/// Loads a scene by name or path without building its models: its text and its warnings.
#[pyfunction]
fn load_scene(py: Python<'_>, name: &str) -> PyResult<(String, Vec<String>)> {
    let context = context();
    let loaded = py.detach(|| load_for(&context, name, Selection::None));
    let file = loaded.map_err(|e| scene_error(py, &e))?;
    Ok((file.text().to_owned(), context.messages.warnings()))
}

/// Checks the text of a scene as a file of this name, without building its models: its warnings.
#[pyfunction]
#[pyo3(signature = (name, text, laws=vec![]))]
fn check_scene(
    py: Python<'_>,
    name: &str,
    text: &str,
    laws: Vec<GivenLaw>,
) -> PyResult<Vec<String>> {
    let context = with_laws(context().with_scene(name, text), laws, &Arc::default());
    let loaded = py.detach(|| load_for(&context, name, Selection::None));
    loaded.map_err(|e| scene_error(py, &e))?;
    Ok(context.messages.warnings())
}

/// Reads the tables of a scene: each value that is not the default.
#[pyfunction]
fn read_scene<'py>(py: Python<'py>, name: &str, text: &str) -> PyResult<Bound<'py, PyDict>> {
    let document: DocumentMut = (canonical(py, name, text)?.parse())
        .map_err(|e: toml_edit::TomlError| input_error(py, &e.to_string(), ""))?;
    of_table(py, document.as_table())
}

/// Writes the tables of a scene as the text of a file, which is read and checked value by value.
#[pyfunction]
fn write_scene(py: Python<'_>, name: &str, tables: &Bound<'_, PyAny>) -> PyResult<String> {
    canonical(py, name, &laid_out(to_table(tables)?).to_string())
}

fn canonical(py: Python<'_>, name: &str, text: &str) -> PyResult<String> {
    let read = SceneTable::parse(&context(), name, text);
    let written = read.map_err(|e| scene_error(py, &e))?.to_toml();
    written.map_err(|e| input_error(py, &e.to_string(), "give whole numbers below 2^63"))
}

/// True if two texts are the same scene.
#[pyfunction]
fn scenes_are_equal(py: Python<'_>, one: &str, other: &str) -> PyResult<bool> {
    let read = |text| SceneTable::parse(&context(), "scene", text);
    let one = read(one).map_err(|e| scene_error(py, &e))?;
    Ok(one == read(other).map_err(|e| scene_error(py, &e))?)
}

/// Changes values in the text of a scene by the paths of their keys; comments and layout stay.
#[pyfunction]
fn change_scene(py: Python<'_>, text: &str, changes: &Bound<'_, PyDict>) -> PyResult<String> {
    let help = "`gearbench help scene` lists the keys of a scene";
    let mut document: DocumentMut = text
        .parse()
        .map_err(|e: toml_edit::TomlError| input_error(py, &e.to_string(), ""))?;
    for (key, value) in changes {
        let key: String = key.extract()?;
        let path = KeyPath::parse(&key).map_err(|e| input_error(py, &e, help))?;
        let value = to_value(&value, &mut vec![key.clone()])?
            .ok_or_else(|| input_error(py, &format!("`{key}` has no value"), help))?;
        set_at(&mut document, &path, &value).map_err(|e| input_error(py, &e, help))?;
    }
    Ok(document.to_string())
}

/// Checks one table by the type that reads it.
#[pyfunction]
fn check_keys(py: Python<'_>, type_name: &str, keys: &Bound<'_, PyAny>) -> PyResult<()> {
    let mut document = DocumentMut::new();
    for (key, value) in to_table(keys)? {
        document.insert(&key, toml_edit::Item::Value(value));
    }
    let name = type_name.strip_suffix("Table").unwrap_or(type_name);
    match check_table(type_name, name, &document.to_string()) {
        Some(checked) => checked.map_err(|e| scene_error(py, &e)),
        None => Err(pyo3::exceptions::PyKeyError::new_err(type_name.to_owned())),
    }
}

/// Describes all tables of the format: name of the type, and name, meaning, type and necessity of each key.
#[pyfunction]
fn scene_tables(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let of = |table: TableDescription| {
        let keys = table.keys.into_iter();
        let keys: Vec<_> = keys
            .map(|k| (k.name, k.meaning, k.type_name, k.is_required))
            .collect();
        (table.name, keys).into_pyobject(py)
    };
    let all = tables().into_iter().map(of);
    PyList::new(py, all.collect::<PyResult<Vec<_>>>()?)
}

/// Names of the scenes that are part of the package.
#[pyfunction]
fn shipped_scenes() -> Vec<&'static str> {
    SHIPPED.iter().map(|s| s.name).collect()
}

/// Adds the functions to the module.
///
/// # Errors
/// Errors of Python.
pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(load_scene, module)?)?;
    module.add_function(wrap_pyfunction!(check_scene, module)?)?;
    module.add_function(wrap_pyfunction!(read_scene, module)?)?;
    module.add_function(wrap_pyfunction!(write_scene, module)?)?;
    module.add_function(wrap_pyfunction!(scenes_are_equal, module)?)?;
    module.add_function(wrap_pyfunction!(change_scene, module)?)?;
    module.add_function(wrap_pyfunction!(check_keys, module)?)?;
    module.add_function(wrap_pyfunction!(scene_tables, module)?)?;
    module.add_function(wrap_pyfunction!(shipped_scenes, module)?)
}
