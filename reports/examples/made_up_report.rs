//! Writes reports of made-up data, to look at the layout: `made_up_report [DIR]`.

#[path = "../tests/reports/made_up/mod.rs"]
mod made_up;

use gearbench_reports::{ReportError, write_results};
use std::path::PathBuf;

fn main() -> Result<(), ReportError> {
    let dir = std::env::args_os()
        .nth(1)
        .map_or_else(|| PathBuf::from("out/made-up"), PathBuf::from);
    write_results(&dir.join("impact"), &made_up::impact_results())?;
    write_results(&dir.join("rotation"), &made_up::rotation_results())?;
    write_results(&dir.join("penalty"), &made_up::penalty_results())?;
    write_results(&dir.join("sweep"), &made_up::sweep_results())?;
    write_results(&dir.join("identify"), &made_up::identify_results())?;
    Ok(())
}
