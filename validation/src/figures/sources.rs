//! Commands that measure figures, and the places of figures in their records.

use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// Contents of the file of all sources.
const FILE: &str = include_str!("../../figures.toml");

/// First word of an output line with a figure: `figure KEY VALUE`.
const FIGURE: &str = "figure ";

/// A command that measures figures.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// First part of the names of the figures.
    pub name: String,
    /// Command line, run in the root of the repository.
    pub command: String,
    /// Paths of the figures in the record of `gearbench`, by key. Without them the command prints `figure KEY VALUE`.
    #[serde(default)]
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
    /// The command does not start or writes no record, or a figure is missing in it.
    pub fn measure(&self, root: &Path, gearbench: &Path) -> Result<BTreeMap<String, f64>, String> {
        let mut words = self.command.split_whitespace();
        let program = words.next().ok_or("an empty command")?;
        let out = std::env::temp_dir().join(format!("gearbench-figures-{}", std::process::id()));
        let mut command = match program {
            "gearbench" => Command::new(gearbench),
            other => Command::new(other),
        };
        command.args(words).current_dir(root).stdin(Stdio::null());
        if !self.figures.is_empty() {
            command
                .args(["--quiet", "--force", "--fresh", "--out"])
                .arg(&out);
        }
        let done = command.stderr(Stdio::inherit()).output();
        let done = done.map_err(|e| format!("`{}`: {e}", self.command))?;
        if self.figures.is_empty() {
            return Ok(stated(&String::from_utf8_lossy(&done.stdout)));
        }
        let text = std::fs::read_to_string(out.join("results.json"));
        let _ = std::fs::remove_dir_all(&out);
        let text = text.map_err(|e| format!("`{}` has no record: {e}", self.command))?;
        let record: Value = serde_json::from_str(&text).map_err(|e| e.to_string())?;
        let number = |(key, path): (&String, &String)| {
            let x = at(&record, path).and_then(Value::as_f64);
            let x = x.ok_or_else(|| format!("`{}`: no number at `{path}`", self.command))?;
            Ok((key.clone(), x))
        };
        self.figures.iter().map(number).collect()
    }
}

/// Figures that a program prints on standard output.
fn stated(output: &str) -> BTreeMap<String, f64> {
    let figure = |line: &str| {
        // The harness of tests prints the name of a test before the first line of its output.
        let at = line.find(FIGURE)?;
        let (key, x) = line[at + FIGURE.len()..].trim().split_once(' ')?;
        Some((key.to_owned(), x.trim().parse().ok()?))
    };
    output.lines().filter_map(figure).collect()
}

/// The value at a path such as `runs[model=elastic;variant=].metrics[against=fe].force_l2`: names of members, and in
/// brackets the first element of an array whose members have these values; an empty value is a missing member.
fn at<'v>(mut value: &'v Value, path: &str) -> Option<&'v Value> {
    for step in path.split('.') {
        let (name, condition) = match step.split_once('[') {
            Some((name, rest)) => (name, Some(rest.strip_suffix(']')?)),
            None => (step, None),
        };
        value = value.get(name)?;
        if let Some(condition) = condition {
            value = value.as_array()?.iter().find(|of| is(of, condition))?;
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
    }

    #[test]
    fn a_test_states_figures() {
        let output = "test impacts ... figure impact.force 0.0051\nother\nfigure peak -1e-5\n";
        let all = BTreeMap::from([("impact.force".into(), 0.0051), ("peak".into(), -1e-5)]);
        assert_eq!(stated(output), all);
    }
}
