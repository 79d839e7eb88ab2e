//! Writes reports of made-up data, to look at the layout: `made_up_report [DIR]`.

#[path = "../tests/support/mod.rs"]
mod support;

use gearbench_reports::{ReportError, write_results};
use std::path::PathBuf;

fn main() -> Result<(), ReportError> {
    let dir = std::env::args_os()
        .nth(1)
        .map_or_else(|| PathBuf::from("out/made-up"), PathBuf::from);
    write_results(&dir.join("impact"), &support::impact_results())?;
    write_results(&dir.join("rotation"), &support::rotation_results())?;
    write_results(&dir.join("modes"), &support::mode_results())?;
    write_results(&dir.join("penalty"), &support::penalty_results())?;
    write_results(&dir.join("sweep"), &support::sweep_results())?;
    Ok(())
}
