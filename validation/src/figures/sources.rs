//! Commands that measure figures, and the places of figures in their records and printed output.

use super::anchors::{number_at_start, unit_at_start};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// Contents of the file of all sources.
const FILE: &str = include_str!("../../figures.toml");

/// Place of the number in a pattern.
const NUMBER: &str = "{}";

/// Name of this program in command lines.
const THIS: &str = "gearbench-validation";

/// A command that measures figures.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// First part of the names of the figures.
    pub name: String,
    /// Command line, run in the root of the repository.
    pub command: String,
    /// Places of the figures by key: paths in the record of `gearbench`, patterns of printed lines of other commands.
    pub figures: BTreeMap<String, String>,
}

/// Reads all sources of figures from `validation/figures.toml`.
///
/// # Errors
/// The file cannot be parsed: message of the TOML parser.
pub fn sources() -> Result<Vec<Source>, String> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        sources: Vec<Source>,
    }
    let file: File = toml::from_str(FILE).map_err(|e| e.to_string())?;
    Ok(file.sources)
}

impl Source {
    /// Runs the command in a folder and reads its figures.
    ///
    /// # Errors
    /// The command does not start, fails or writes no record, or a figure is missing in its record or output.
    pub fn measure(&self, root: &Path, gearbench: &Path) -> Result<BTreeMap<String, f64>, String> {
        let mut words = self.command.split_whitespace();
        let program = words.next().ok_or("an empty command")?;
        let records = program == "gearbench";
        let this = std::env::current_exe().map_err(|e| e.to_string())?;
        let program = match program {
            "gearbench" => gearbench,
            THIS => &this,
            other => Path::new(other),
        };
        let mut command = Command::new(program);
        command.args(words).current_dir(root).stdin(Stdio::null());
        let out = std::env::temp_dir().join(format!("gearbench-figures-{}", std::process::id()));
        if records {
            command
                .args(["--quiet", "--force", "--fresh", "--out"])
                .arg(&out);
        }
        let done = command.stderr(Stdio::inherit()).output();
        let done = done.map_err(|e| format!("`{}`: {e}", self.command))?;
        if !records {
            if !done.status.success() {
                return Err(format!("`{}` failed", self.command));
            }
            return self.printed(&String::from_utf8_lossy(&done.stdout));
        }
        let text = std::fs::read_to_string(out.join("results.json"));
        let _ = std::fs::remove_dir_all(&out);
        let text = text.map_err(|e| format!("`{}` has no record: {e}", self.command))?;
        let record: Value = serde_json::from_str(&text).map_err(|e| e.to_string())?;
        self.each("number at", |path| {
            at(&record, path).and_then(Value::as_f64)
        })
    }

    /// Reads the figures from the output of the command.
    pub(super) fn printed(&self, output: &str) -> Result<BTreeMap<String, f64>, String> {
        self.each("output line with", |pattern| largest(output, pattern))
    }

    /// Reads the figure at each place; `what` is missing where there is none.
    fn each(
        &self,
        what: &str,
        read: impl Fn(&str) -> Option<f64>,
    ) -> Result<BTreeMap<String, f64>, String> {
        let number = |(key, place): (&String, &String)| {
            let x = read(place);
            let x = x.ok_or_else(|| format!("`{}`: no {what} `{place}`", self.command))?;
            Ok((key.clone(), x))
        };
        self.figures.iter().map(number).collect()
    }
}

/// The number of largest magnitude among the lines that contain a pattern; its sign is that of the line.
fn largest(output: &str, pattern: &str) -> Option<f64> {
    let numbers = output.lines().filter_map(|line| number_in(line, pattern));
    numbers.max_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// The number at `{}` in a line that contains the pattern; `*` is any text. The unit after `{}`, if any, converts it.
fn number_in(line: &str, pattern: &str) -> Option<f64> {
    let (before, after) = pattern.split_once(NUMBER)?;
    line.char_indices().find_map(|(start, _)| {
        let (x, rest) = number_at_start(&line[start..])?;
        let head = &line[..start];
        if head.ends_with(|c: char| c.is_ascii_alphanumeric() || c == '.') {
            return None;
        }
        let mut parts = before.rsplit('*');
        let head = head.strip_suffix(parts.next()?)?;
        parts.try_fold(head, |text, part| Some(text.rsplit_once(part)?.0))?;
        let mut parts = after.split('*');
        let rest = rest.strip_prefix(parts.next()?)?;
        parts.try_fold(rest, |text, part| Some(text.split_once(part)?.1))?;
        Some(x * unit_at_start(after))
    })
}

/// The value at a path such as `runs[model=elastic;variant=].metrics[against=fe].force_l2`: names of members, and in
/// brackets the first element of an array whose members have these values, where an empty value is a missing member, or
/// the place of an element from 0.
fn at<'v>(mut value: &'v Value, path: &str) -> Option<&'v Value> {
    for step in path.split('.') {
        let (name, condition) = match step.split_once('[') {
            Some((name, rest)) => (name, Some(rest.strip_suffix(']')?)),
            None => (step, None),
        };
        value = value.get(name)?;
        if let Some(condition) = condition {
            let elements = value.as_array()?;
            value = match condition.parse::<usize>() {
                Ok(place) => elements.get(place)?,
                Err(_) => elements.iter().find(|of| is(of, condition))?,
            };
        }
    }
    Some(value)
}

fn is(of: &Value, condition: &str) -> bool {
    condition.split(';').all(|one| match one.split_once('=') {
        Some((key, "")) => of.get(key).is_none_or(Value::is_null),
        Some((key, wanted)) => match of.get(key) {
            Some(Value::String(text)) => text == wanted,
            Some(Value::Number(x)) => {
                let close = |w: f64| x.as_f64().is_some_and(|x| (x - w).abs() <= 1e-9 * w.abs());
                wanted.parse().is_ok_and(close)
            }
            _ => false,
        },
        None => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_path_leads_to_its_value() {
        let record = json!({"runs": [
            {"model": "elastic", "variant": "nodes", "x": 1.0},
            {"model": "elastic", "modes": 100, "metrics": [{"against": "fe", "x": 3.0}]},
        ]});
        let number = |path| at(&record, path).and_then(Value::as_f64);
        assert_eq!(number("runs[model=elastic].x"), Some(1.0));
        let path = "runs[model=elastic;variant=].metrics[against=fe].x";
        assert_eq!(number(path), Some(3.0));
        assert_eq!(number("runs[modes=100].metrics[against=fe].x"), Some(3.0));
        assert_eq!(number("runs[modes=50].x"), None);
        assert_eq!(number("runs[1].metrics[0].x"), Some(3.0));
        assert_eq!(number("runs[2].x"), None);
    }

    #[test]
    fn a_pattern_finds_its_number() {
        let line =
            "test space ... rack, 3 points: force -0.05 %, [1.2e-3, 4.0] at 10 m^2/N, peak 7181.";
        for (pattern, x) in [
            ("force {} %", -5e-4),
            ("force {}", -0.05),
            ("rack*force {} %*peak", -5e-4),
            ("[{}, 4", 1.2e-3),
            ("[*, {}]", 4.0),
            ("at {} m^2/N", 10.0),
            ("peak {}", 7181.0),
            ("rack, {} points", 3.0),
        ] {
            assert_eq!(number_in(line, pattern), Some(x), "{pattern}");
        }
        for pattern in ["force {} N", "peak*force {}", "force {}*rack", "space {}"] {
            assert_eq!(number_in(line, pattern), None, "{pattern}");
        }
    }

    #[test]
    fn the_largest_of_all_lines_is_the_figure() {
        let source = |pattern: &str| Source {
            name: "forces".into(),
            command: "cargo test".into(),
            figures: BTreeMap::from([("error".into(), pattern.into())]),
        };
        let output = "rigid: error 2e-9\nelastic: error -1e-8\nteeth: error 5e-9\n";
        let values = |x| Ok(BTreeMap::from([("error".into(), x)]));
        assert_eq!(source("error {}").printed(output), values(-1e-8));
        assert_eq!(source("teeth*error {}").printed(output), values(5e-9));
        assert_eq!(
            source("peak {}").printed(output).unwrap_err(),
            "`cargo test`: no output line with `peak {}`"
        );
    }
}
