//! Stored baselines: one line of JSON for each entry, a whole set of lines for each baseline, the newest last. A file of
//! lines goes well with version control: an update adds lines and changes none.

use super::quantity::FORMER_SPEEDS;
use crate::cli::files::write_whole;
use crate::cli::terminal::Refusal;
use gearbench_reference::files;
use gearbench_reports::check::{MeasuredEntry, Stored, Trend};
use gearbench_reports::record::speed_end;
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::Path;

/// One line of a baseline file: a measured entry with the number, date and machine of its baseline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct BaselineLine {
    #[serde(flatten)]
    stored: Stored,
    #[serde(flatten)]
    measured: MeasuredEntry,
}

/// Stored results of one run of a check, with which later runs are compared.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Baseline {
    /// Number, time and machine of the baseline.
    pub(super) stored: Stored,
    /// Measured results of the baseline, one entry per case, model and integrator.
    pub(super) entries: Vec<MeasuredEntry>,
}

/// All baselines of a file, the newest last.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Baselines(Vec<Baseline>);

/// Largest file that is read [bytes].
const MOST_BYTES: u64 = 200 << 20;

impl Baselines {
    /// Reads the baselines of a file; the result is empty if the file does not exist.
    ///
    /// # Errors
    /// [`Refusal::Input`] with the line that is no entry.
    pub(super) fn read(path: &Path) -> Result<Self, Refusal> {
        let bad = |what: String, help: &str| {
            Refusal::Input(miette::miette!(
                help = help.to_owned(),
                "{}: {what}",
                path.display()
            ))
        };
        let text = match files::read_text(path, MOST_BYTES) {
            Ok(text) => text,
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Baselines::default()),
            Err(e) => {
                let help = "`baseline` is the file that --update writes";
                return Err(bad(e.to_string(), help));
            }
        };
        Self::parse(&text).map_err(|(line, what)| {
            let help = "restore the line from version control, or remove the file and store a baseline with --update";
            bad(format!("line {line}: expected a stored entry, found: {what}"), help)
        })
    }

    fn parse(text: &str) -> Result<Self, (usize, String)> {
        let mut all: Vec<Baseline> = Vec::new();
        for (i, line) in text
            .lines()
            .enumerate()
            .filter(|(_, l)| !l.trim().is_empty())
        {
            let BaselineLine { stored, measured } =
                serde_json::from_str(line).map_err(|e| (i + 1, e.to_string()))?;
            match all.last_mut() {
                Some(last) if last.stored.baseline == stored.baseline => {
                    last.entries.push(measured);
                }
                Some(last) if last.stored.baseline > stored.baseline => {
                    let what = format!(
                        "baseline {} after {}",
                        stored.baseline, last.stored.baseline
                    );
                    return Err((i + 1, what));
                }
                _ => all.push(Baseline {
                    stored,
                    entries: vec![measured],
                }),
            }
        }
        Ok(Baselines(all))
    }

    /// Names the last speeds of the entries of a case after its gears: baselines of former versions have those of the first
    /// two gears by their numbers.
    pub(super) fn name_speeds<'g>(&mut self, case: &str, gears: impl Iterator<Item = &'g str>) {
        let names: Vec<(&str, String)> = FORMER_SPEEDS
            .into_iter()
            .zip(gears.map(speed_end))
            .collect();
        let entries = self.0.iter_mut().flat_map(|b| &mut b.entries);
        for entry in entries.filter(|e| e.case == case) {
            for (former, name) in &names {
                if let Some(x) = entry.metrics.remove(*former) {
                    entry.metrics.insert(name.clone(), x);
                }
            }
        }
    }

    /// Returns the newest baseline, with which runs are compared.
    pub(super) fn newest(&self) -> Option<&Baseline> {
        self.0.last()
    }

    /// Appends a baseline with the next number.
    pub(super) fn add(&mut self, stored: Stored, entries: Vec<MeasuredEntry>) {
        let baseline = self.newest().map_or(1, |b| b.stored.baseline + 1);
        self.0.push(Baseline {
            stored: Stored { baseline, ..stored },
            entries,
        });
    }

    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// [`Refusal::Files`] when it cannot be written.
    pub(super) fn write(&self, path: &Path) -> Result<(), Refusal> {
        let fail = |e: std::io::Error| Refusal::Files(format!("{}: {e}", path.display()));
        let mut text = String::new();
        for Baseline { stored, entries } in &self.0 {
            for measured in entries {
                let line = BaselineLine {
                    stored: stored.clone(),
                    measured: measured.clone(),
                };
                text.push_str(&serde_json::to_string(&line).map_err(|e| fail(e.into()))?);
                text.push('\n');
            }
        }
        write_whole(path, &text).map_err(fail)
    }

    /// Returns the history of a quantity for every entry over the baselines, with the present run last.
    pub(super) fn history(&self, quantity: &str, now: &[MeasuredEntry]) -> Vec<Trend> {
        let value = |m: &MeasuredEntry| match quantity {
            "runtime" => m.runtime,
            key => (m.metrics.get(key).copied()).or_else(|| Some(*m.work.get(key)? as f64)),
        };
        let next = self.newest().map_or(1, |b| b.stored.baseline + 1);
        let stored = (self.0.iter()).flat_map(|b| b.entries.iter().map(|m| (b.stored.baseline, m)));
        let all = stored.chain(now.iter().map(|m| (next, m)));
        let mut trends: Vec<Trend> = Vec::new();
        for (number, measured) in all {
            let (entry, Some(value)) = (measured.name(), value(measured)) else {
                continue;
            };
            match trends.iter_mut().find(|t| t.entry == entry) {
                Some(trend) => trend.points.push((number, value)),
                None => trends.push(Trend {
                    entry,
                    points: vec![(number, value)],
                }),
            }
        }
        trends
    }

    /// Returns the keys of all quantities in the baselines.
    pub(super) fn quantities(&self) -> Vec<&str> {
        let entries = || self.0.iter().flat_map(|b| &b.entries);
        let metrics = entries().flat_map(|e| e.metrics.keys());
        let work = entries().flat_map(|e| e.work.keys());
        let mut all: Vec<&str> = metrics.chain(work).map(String::as_str).collect();
        all.push("runtime");
        all.sort_unstable();
        all.dedup();
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(peak: f64) -> MeasuredEntry {
        MeasuredEntry {
            case: "a".into(),
            model: "rigid".into(),
            method: "rk4@1e-6".into(),
            metrics: [("peak_force_n".to_owned(), peak)].into(),
            work: [("steps".to_owned(), 160)].into(),
            runtime: Some(0.1),
            ..MeasuredEntry::default()
        }
    }

    /// Baselines survive writing and reading bit by bit, and an update changes no existing line.
    #[test]
    fn baselines_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("check.baseline.jsonl");
        let mut all = Baselines::read(&path).unwrap();
        assert!(all.newest().is_none());
        all.add(
            Stored::default(),
            vec![measured(0.1 + 0.2), measured(1.0 / 3.0)],
        );
        all.write(&path).unwrap();
        let first = std::fs::read_to_string(&path).unwrap();
        all.add(Stored::default(), vec![measured(2.0)]);
        all.write(&path).unwrap();
        assert!(std::fs::read_to_string(&path).unwrap().starts_with(&first));
        let again = Baselines::read(&path).unwrap();
        assert_eq!(again, all);
        assert_eq!(again.newest().map(|b| b.stored.baseline), Some(2));
        let history = again.history("peak_force_n", &[measured(4.0)]);
        let last: Vec<(u32, f64)> = history[0].points[2..].to_vec();
        assert_eq!(last, [(2, 2.0), (3, 4.0)]);
        assert!(again.quantities().contains(&"steps"));
    }

    /// Last speeds of a former baseline are those of the first two gears.
    #[test]
    fn former_speeds_have_names() {
        let mut former = measured(1.0);
        former.metrics.insert("omega1_end".into(), -7.5);
        former.metrics.insert("omega2_end".into(), -8.3);
        let mut all = Baselines::default();
        all.add(Stored::default(), vec![former]);
        all.name_speeds("another", ["x", "y"].into_iter());
        all.name_speeds("a", ["pinion", "wheel", "third"].into_iter());
        let metrics = &all.newest().unwrap().entries[0].metrics;
        let keys: Vec<&str> = metrics.keys().map(String::as_str).collect();
        let wanted = [
            "peak_force_n",
            "speed_end_pinion_rad_s",
            "speed_end_wheel_rad_s",
        ];
        assert_eq!((keys, metrics[wanted[2]]), (wanted.to_vec(), -8.3));
    }

    #[test]
    fn a_line_that_is_no_entry_is_named() {
        let (line, _) = Baselines::parse("\n{\"baseline\":1}\n{oops\n").unwrap_err();
        assert_eq!(line, 3);
        let later = "{\"baseline\":2}\n{\"baseline\":1}\n";
        assert!(Baselines::parse(later).unwrap_err().1.contains("1 after 2"));
    }
}
