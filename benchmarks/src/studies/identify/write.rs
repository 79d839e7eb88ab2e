//! Writing of the calibration file: constants and their origin, in addition to the entries that it already contains.
//!
//! Comments at its head say by which command, from which data and how sure each calibration is, a tag in front of each
//! line; those of other calibrations stay, and so do comments between the tables.

use super::plan::Identification;
use crate::cli::files::write_whole;
use crate::cli::terminal::Refusal;
use crate::experiment::machine;
use crate::scene_file::calibration::{CalibrationKind, Constants, FITTED_TO, of_gear};
use crate::scene_file::{Calibration, ModelChoice, SceneFile};
use gearbench_reference::files;
use gearbench_reports::identify::{DataKind, DataRecord, FitRecord, Outcome};
use std::fmt::Display;
use std::io::ErrorKind;
use std::path::PathBuf;
use toml_edit::{Array, DocumentMut, Item, Table, Value};

/// Writes the constants that the data determine, with `force` all fitted ones.
pub fn write(
    scene: &SceneFile,
    (to, data): (CalibrationKind, &str),
    found: &[(&ModelChoice, Identification)],
    command: &str,
    force: bool,
) -> Result<PathBuf, Refusal> {
    let path = scene.calibration_path();
    let fail = |e: &dyn Display| Refusal::Files(format!("{}: {e}", path.display()));
    let before = match files::read_text(&path, files::MOST_OF_TEXT) {
        Err(e) if e.kind() == ErrorKind::NotFound => String::new(),
        read => read.map_err(|e| fail(&e))?,
    };
    Calibration::parse(&path.display().to_string(), &before)?;
    let sets: Vec<(&FitRecord, Constants)> = (found.iter())
        .map(|(_, f)| {
            let mut constants = if force { f.all.clone() } else { f.constants() };
            // Parameters that the fit does not determine stay as they are stored.
            let old = scene.model(&f.record.label);
            let old = old.and_then(|c| c.calibration.as_ref()?.stored.clone());
            for (key, x) in old.map(|old| old.parameters).unwrap_or_default() {
                constants.parameters.entry(key).or_insert(x);
            }
            let fitted = |d: &&DataRecord| !d.validation && d.kind != DataKind::Compliance;
            let histories = f.record.data.iter().filter(fitted);
            constants.fitted_to = histories.map(|d| d.name.clone()).collect();
            (&f.record, constants)
        })
        .collect();
    let by = format!("written by {command}");
    let commit = format!("commit {}, {}", machine::commit(), machine::now());
    let from = format!("fitted to {data}; for {}", to.holds_for());
    let text = written(&before, to, &[by, from, commit], &sets).map_err(|e| fail(&e))?;
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
    if let Some(parent) = parent
        && !parent.is_dir()
    {
        return Err(Refusal::Files(format!(
            "{}: the folder does not exist; run this from the root of the repository for a shipped scene",
            parent.display()
        )));
    }
    write_whole(&path, &text).map_err(|e| fail(&e))?;
    Ok(path)
}

/// The text of the file after a fit.
fn written(
    before: &str,
    to: CalibrationKind,
    provenance: &[String],
    sets: &[(&FitRecord, Constants)],
) -> Result<String, toml_edit::TomlError> {
    let comments = before.lines().take_while(|l| l.starts_with('#')).count();
    let body: Vec<&str> = before.lines().skip(comments).collect();
    let mut document: DocumentMut = body.join("\n").parse()?;
    for (record, constants) in sets {
        let calibration = document.entry(to.as_str()).or_insert_with(|| {
            let mut table = Table::new();
            table.set_implicit(true);
            Item::Table(table)
        });
        let label = &mut calibration[&record.label];
        if !label.is_table() {
            *label = Item::Table(Table::new());
        }
        let all = constants.by_key();
        if let Some(table) = label.as_table_mut() {
            let of =
                |gear: Option<&str>, key: &str| all.iter().any(|(k, _)| of_gear(k) == (gear, key));
            table.retain(|key, item| match item.as_table_like_mut() {
                Some(own) => {
                    let keys: Vec<String> = own.iter().map(|(k, _)| k.to_owned()).collect();
                    (keys.iter().filter(|k| !of(Some(key), k))).for_each(|k| {
                        own.remove(k);
                    });
                    !own.is_empty()
                }
                None => of(None, key),
            });
        }
        for (key, x) in &all {
            let (gear, key) = of_gear(key);
            let label = match gear {
                None => &mut *label,
                Some(gear) => {
                    let own = &mut label[gear];
                    if !own.is_table_like() {
                        let mut table = Table::new();
                        table.set_dotted(true);
                        *own = Item::Table(table);
                    }
                    own
                }
            };
            let decor = label
                .get(key)
                .and_then(|i| Some(i.as_value()?.decor().clone()));
            // Written with all digits, as a power of ten.
            let mut value: Value = format!("{x:e}").parse()?;
            if let Some(decor) = decor {
                *value.decor_mut() = decor;
            }
            label[key] = Item::Value(value);
        }
        if !constants.fitted_to.is_empty() {
            let names: Array = constants.fitted_to.iter().collect();
            document[to.as_str()][&record.label][FITTED_TO] = Item::Value(names.into());
        }
    }
    let tag = format!("# {}:", to.as_str());
    let mut head: Vec<String> = (before.lines().take(comments))
        .filter(|l| !l.starts_with(&tag))
        .map(str::to_owned)
        .collect();
    let labels = sets.iter().map(|(record, _)| fit_line(record));
    let lines = provenance.iter().cloned().chain(labels);
    head.extend(lines.map(|line| format!("{tag} {}", line.replace(['\n', '\r'], " "))));
    let body = document.to_string();
    Ok(format!("{}\n\n{}\n", head.join("\n"), body.trim()))
}

/// A fit in a line, its model first.
fn fit_line(record: &FitRecord) -> String {
    format!("{}: {}", record.label, errors_and_intervals(record))
}

/// Returns errors and intervals of a fit in one line.
pub(super) fn errors_and_intervals(record: &FitRecord) -> String {
    let errors = record.data.iter().map(|d| {
        let held = if d.validation { ", not fitted" } else { "" };
        format!("{:.4} ({} of {}{held})", d.l2, d.kind, d.name)
    });
    let intervals = record.parameters.iter().map(|p| match p.outcome {
        Outcome::Identified => {
            let end = |x: Option<f64>| x.map_or_else(|| "open".into(), |x| format!("{x:.4e}"));
            format!("{} {} to {}", p.key, end(p.low), end(p.high))
        }
        other => format!("{} {other}", p.key),
    });
    format!(
        "relative L2 errors {}; 95 % intervals: {}",
        errors.collect::<Vec<_>>().join(", "),
        intervals.collect::<Vec<_>>().join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene_file::calibration::{GAP, STIFFNESS};

    #[test]
    fn other_calibrations_and_comments_stay() {
        let before = "# impact: written long ago\n# static: older\n\n[impact.rigid]\n# measured\n\
                      stiffness_n_per_m2 = 1e10 # here\ngap_m = 1e-6\npinion.tooth_mass_kg = 3 # weighed\npinion.tooth_damping_ns_per_m = 3\n\n[static.rigid]\nstiffness_n_per_m2 = 2e10\n";
        let record = FitRecord {
            label: "odd \"label\" é".into(),
            ..FitRecord::default()
        };
        let rigid = FitRecord {
            label: "rigid".into(),
            ..FitRecord::default()
        };
        let constants = Constants::of([
            (STIFFNESS, 1.0 / 3.0 * 1e10),
            (GAP, 2e-6),
            ("pinion.tooth_mass_kg", 1e-3),
            ("pinion.tooth_stiffness_n_per_m", 5e8),
        ]);
        let sets = [(&rigid, constants.clone()), (&record, constants.clone())];
        let text = written(before, CalibrationKind::Impact, &["by hand".into()], &sets).unwrap();
        assert!(text.starts_with("# static: older\n# impact: by hand\n# impact: rigid:"));
        assert!(
            text.contains("# measured\n") && text.contains("# here\n"),
            "{text}"
        );
        assert!(
            text.contains("pinion.tooth_mass_kg = 1e-3 # weighed\n"),
            "{text}"
        );
        assert!(!text.contains("long ago") && !text.contains("damping"));
        let read = Calibration::parse("x.toml", &text).unwrap();
        assert_eq!(read.get("impact", "rigid"), Some(&constants));
        assert_eq!(read.get("impact", &record.label), Some(&constants));
        assert!(read.get("static", "rigid").is_some());
        // Into nothing as well.
        let text = written("", CalibrationKind::Static, &[], &sets).unwrap();
        let read = Calibration::parse("x.toml", &text).unwrap();
        assert_eq!(read.get("static", "rigid"), Some(&constants));
    }
}
