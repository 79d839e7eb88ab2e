//! The functions and classes of the extension module.

mod errors;
mod laws;
mod records;
mod scenes;
mod simulation;
mod studies;
mod values;

use pyo3::prelude::*;

/// Functions and classes on which the package gearbench is built.
#[pymodule(gil_used = true)]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    gearbench::experiment::machine::set_commit(env!("GEARBENCH_COMMIT"));
    module.add("version", env!("CARGO_PKG_VERSION"))?;
    module.add("commit", gearbench::experiment::machine::commit())?;
    scenes::add(module)?;
    studies::add(module)?;
    simulation::add(module)
}
