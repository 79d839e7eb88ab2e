//! Check files: cases of scenes, models and integrators, the quantities to compare, and their tolerances.

use super::quantity::{Quantity, USUAL};
use crate::scene_file::SceneError;
use crate::scene_file::reading::keys::keys;
use crate::scene_file::reading::values::{Factor, NotNegative, OrderedTable, Positive, is_default};
use crate::scene_file::reading::{Document, Place};
use gearbench_reference::file_kind::{self, Input};
use gearbench_reference::files;
use serde::{Deserialize, Serialize};
use std::path::{Component, Path, PathBuf};

keys! {
    /// A check file: cases with their stored quantities.
    struct CheckTable {
        /// version of the format, 1
        schema: CheckSchema,
        /// one line for the report
        #[serde(default, skip_serializing_if = "is_default")]
        title: String,
        /// file of the stored baselines, from the folder of this file, default its name with .baseline.jsonl
        baseline: Option<String>,
        /// counts of work (steps, Newton iterations, ...), "exact" (default) or "report"
        #[serde(default, skip_serializing_if = "is_default")]
        work: WorkRule,
        /// runtime in units of the kernel, { factor, all, gate }
        #[serde(default, skip_serializing_if = "is_default")]
        runtime: RuntimeTable,
        /// tolerated differences of quantities, by key: tolerances.peak_force_n = { relative, absolute, most }
        #[serde(default, skip_serializing_if = "is_default")]
        tolerances: OrderedTable<DifferenceTable>,
        /// tables [[cases]]
        cases: Vec<CaseTable>,
    }

    /// Limits of computing times in a check.
    #[derive(Default)]
    struct RuntimeTable {
        /// ratio to the baseline from which on a run is slower, default 1.35
        factor: Option<Factor>,
        /// the same of the median of that ratio over all entries, where there are eight or more, default 1.25
        all: Option<Factor>,
        /// whether a slower run fails the check (on the processor of the baseline), default true
        gate: Option<bool>,
    }

    /// Allowed differences of a quantity in a check.
    #[derive(Copy)]
    struct DifferenceTable {
        /// greatest difference over the baseline, default 1e-6
        relative: Option<NotNegative>,
        /// greatest difference in the unit of the quantity; the larger of the two counts
        absolute: Option<NotNegative>,
        /// greatest magnitude, whatever the baseline
        most: Option<Positive>,
    }

    /// A case of a check.
    struct CaseTable {
        /// name in the report, default that of the scene
        name: Option<String>,
        /// name of a shipped scene, or path of a scene file from the folder of this file
        scene: String,
        /// labels of models of the scene, default those of its study
        models: Option<Vec<String>>,
        /// methods as on the command line, such as ["rk4@1us", "dopri5@1e-8"], default those of the scene
        integrators: Option<Vec<String>>,
        /// quantities, default peak force, impulse, last speeds, energy drift, force and transmission error (root mean square), error against references
        metrics: Option<Vec<String>>,
        /// as above, for this case
        #[serde(default, skip_serializing_if = "is_default")]
        tolerances: OrderedTable<DifferenceTable>,
        /// left out by --quick
        #[serde(default, skip_serializing_if = "is_default")]
        slow: bool,
    }
}

/// The version of the format.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "u32")]
pub struct CheckSchema;

impl TryFrom<u32> for CheckSchema {
    type Error = String;

    fn try_from(schema: u32) -> Result<Self, String> {
        (schema == 1).then_some(CheckSchema).ok_or_else(|| {
            format!(
                "the check has schema {schema}, expected 1: a newer file needs a newer gearbench"
            )
        })
    }
}

/// Rule for a work count (steps, force evaluations) that differs from the baseline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WorkRule {
    /// The difference fails the check.
    #[default]
    Exact,
    /// The difference is reported and does not fail the check.
    Report,
}

/// Default relative tolerance of a quantity [-].
const RELATIVE: f64 = 1e-6;
/// Default absolute tolerance of ratios (errors, drifts) and of all other quantities, for rounding on another machine.
const ABSOLUTE_RATIO: f64 = 1e-8;
const ABSOLUTE: f64 = 1e-12;
/// Ratio of runtimes from which on a run is slower.
const FACTOR: f64 = 1.35;
/// Median of these ratios from which on the program is slower.
const ALL: f64 = 1.25;

/// Permitted deviation of a quantity from its baseline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tolerance {
    /// Relative tolerance over the baseline [-].
    pub(super) relative: f64,
    /// Absolute tolerance in the unit of the quantity.
    pub(super) absolute: f64,
    /// Upper limit of the magnitude, in the unit of the quantity.
    pub(super) most: Option<f64>,
}

/// Limits of the runtimes, as ratios to the baseline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Runtime {
    /// Ratio of runtimes above which an entry counts as slower.
    pub(super) factor: f64,
    /// Median of the ratios over all entries above which the program counts as slower.
    pub(super) all: f64,
    /// True if an exceeded runtime limit fails the check; otherwise it is only reported.
    pub(super) gate: bool,
}

/// Acceptance rules for the entries of a case: work counts, runtimes and tolerances.
#[derive(Clone, Debug)]
pub(super) struct Rules {
    pub(super) work: WorkRule,
    pub(super) runtime: Runtime,
    tolerances: Vec<(Quantity, DifferenceTable)>,
}

impl Rules {
    /// Returns the tolerance of a quantity by its key in baselines. Later settings override earlier ones.
    pub(super) fn tolerance(&self, key: &str) -> Tolerance {
        let quantity = Quantity::of_key(key);
        let given = || {
            let all = self.tolerances.iter().rev();
            all.filter(|(q, _)| Some(*q) == quantity).map(|(_, t)| t)
        };
        let ratio = quantity.is_some_and(Quantity::is_ratio);
        let absolute = if ratio { ABSOLUTE_RATIO } else { ABSOLUTE };
        Tolerance {
            relative: given()
                .find_map(|t| Some(t.relative?.0))
                .unwrap_or(RELATIVE),
            absolute: given()
                .find_map(|t| Some(t.absolute?.0))
                .unwrap_or(absolute),
            most: given().find_map(|t| Some(t.most?.0)),
        }
    }
}

/// Case of a check: a scene with models, integrators, quantities and acceptance rules.
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) name: String,
    /// Name of a shipped scene, or path.
    pub(super) scene: String,
    /// Labels of the models, separated by commas.
    pub(super) models: Option<String>,
    /// Integrators as on the command line, separated by commas.
    pub(super) integrators: Option<String>,
    pub(super) metrics: Vec<Quantity>,
    pub(super) rules: Rules,
    pub(super) slow: bool,
    /// Index of the case in the file.
    index: usize,
}

/// Content of a check file.
#[derive(Clone, Debug)]
pub(super) struct CheckFile {
    pub(super) title: String,
    /// Path of the file with the baselines.
    pub(super) baseline: PathBuf,
    pub(super) cases: Vec<Case>,
    /// Limits of the runtimes of all cases together.
    pub(super) runtime: Runtime,
    document: Document,
}

impl CheckFile {
    /// Reads and validates a check file.
    ///
    /// # Errors
    /// [`SceneError`] with line and a way out.
    pub(super) fn read(path: &Path) -> Result<Self, SceneError> {
        if let Some(kind) = file_kind::foreign(path, Input::Scene) {
            let why = format!("{} is {}, not a check file", path.display(), kind.name);
            return Err(SceneError::plain(why, kind.way_out_of(path)));
        }
        let text = files::read_text(path, files::MOST_OF_TEXT).map_err(|e| {
            SceneError::plain(
                format!("{}: {e}", path.display()),
                "expected a readable check file in TOML; `gearbench init check` writes one",
            )
        })?;
        Self::parse(path, &text)
    }

    fn parse(path: &Path, text: &str) -> Result<Self, SceneError> {
        let name = path.display().to_string();
        let (document, keys): (_, CheckTable) = Document::read(&name, text, |_| Vec::new())?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let root = document.at("");
        let CheckTable {
            schema: CheckSchema,
            ..
        } = keys;
        let all = tolerances(keys.tolerances, &root.key("tolerances"))?;
        let runtime = Runtime {
            factor: keys.runtime.factor.map_or(FACTOR, f64::from),
            all: keys.runtime.all.map_or(ALL, f64::from),
            gate: keys.runtime.gate.unwrap_or(true),
        };
        let rules = Rules {
            work: keys.work,
            runtime,
            tolerances: all,
        };
        for (key, factor, usual) in [
            ("factor", runtime.factor, FACTOR),
            ("all", runtime.all, ALL),
        ] {
            if factor <= 1.0 {
                return root.key("runtime").key(key).refuse(
                    format!("a factor of {factor} makes every run too slow"),
                    "expected more than 1",
                    format!("{usual} exceeds the noise on a busy machine"),
                );
            }
        }
        let mut cases: Vec<Case> = Vec::new();
        for (index, keys) in keys.cases.into_iter().enumerate() {
            let at = root.key("cases").member(index);
            let case = case(index, keys, (&rules, folder), &at)?;
            if cases.iter().any(|c| c.name == case.name) {
                return at.first(&["name", "scene"]).refuse(
                    format!("two cases are called `{}`", case.name),
                    "again",
                    "give one of them another `name`",
                );
            }
            cases.push(case);
        }
        let baseline = match keys.baseline {
            Some(name) => {
                let below = Path::new(&name).components();
                let mut below =
                    below.map(|c| matches!(c, Component::Normal(_) | Component::CurDir));
                if name.trim().is_empty() || !below.all(|inside| inside) {
                    return root.key("baseline").refuse(
                        format!("the baseline `{name}` is not in the folder of the check file or below it"),
                        "not here",
                        "name a file in the folder of the check file, such as \"check.baseline.jsonl\"",
                    );
                }
                folder.join(name)
            }
            None => path.with_extension("baseline.jsonl"),
        };
        Ok(CheckFile {
            title: keys.title.trim().to_owned(),
            baseline,
            cases,
            runtime,
            document,
        })
    }

    /// Returns an error about a case, with its place in the file.
    pub(super) fn about(&self, case: &Case, message: String, help: &str) -> SceneError {
        let at = self.document.at("").key("cases").member(case.index);
        at.first(&["scene"]).error(message, "of this case", help)
    }

    /// Returns the selected cases: those with the given names, and without slow ones if `quick`.
    ///
    /// # Errors
    /// [`SceneError`] for a name that is none.
    pub(super) fn select(&self, names: &[String], quick: bool) -> Result<Vec<&Case>, SceneError> {
        for name in names {
            if !self.cases.iter().any(|c| c.name == *name) {
                let known: Vec<&str> = self.cases.iter().map(|c| c.name.as_str()).collect();
                return Err(SceneError::plain(
                    format!("the check has no case `{name}`"),
                    format!("it has {}", known.join(", ")),
                ));
            }
        }
        let asked = |c: &&Case| names.is_empty() || names.contains(&c.name);
        let kept = |c: &&Case| !(quick && c.slow);
        Ok(self.cases.iter().filter(asked).filter(kept).collect())
    }
}

fn case(
    index: usize,
    keys: CaseTable,
    (rules, folder): (&Rules, &Path),
    at: &Place<'_>,
) -> Result<Case, SceneError> {
    let own = tolerances(keys.tolerances, &at.key("tolerances"))?;
    let metrics = match keys.metrics {
        None => USUAL.to_vec(),
        Some(words) => (words.iter().enumerate())
            .map(|(i, word)| quantity(word, &at.key("metrics").member(i)))
            .collect::<Result<_, _>>()?,
    };
    let is_path = keys.scene.ends_with(".toml") || keys.scene.contains('/');
    let name = (keys.name).unwrap_or_else(|| {
        let stem = Path::new(&keys.scene).file_stem();
        stem.unwrap_or_default().to_string_lossy().into_owned()
    });
    Ok(Case {
        name,
        scene: match is_path {
            true => folder.join(&keys.scene).display().to_string(),
            false => keys.scene,
        },
        models: keys.models.map(|m| m.join(",")),
        integrators: keys.integrators.map(|m| m.join(",")),
        metrics,
        rules: Rules {
            tolerances: [rules.tolerances.clone(), own].concat(),
            ..rules.clone()
        },
        slow: keys.slow,
        index,
    })
}

fn tolerances(
    keys: OrderedTable<DifferenceTable>,
    at: &Place<'_>,
) -> Result<Vec<(Quantity, DifferenceTable)>, SceneError> {
    let all = keys.0.into_iter();
    all.map(|(key, t)| Ok((quantity(&key, &at.key(&key))?, t)))
        .collect()
}

fn quantity(word: &str, at: &Place<'_>) -> Result<Quantity, SceneError> {
    let known: Vec<&str> = Quantity::all().map(Quantity::key).collect();
    word.parse().map_err(|_| {
        let near = crate::scene_file::did_you_mean(word, &known);
        at.error(
            format!("there is no quantity `{word}`"),
            "not known",
            format!("{near}there are {}", known.join(", ")),
        )
    })
}

#[cfg(test)]
mod tests;

/// Acceptance rules for tests of other modules.
#[cfg(test)]
pub(super) mod tests_support {
    use super::*;

    /// Returns the acceptance rules of a check file with the given additional line.
    pub(in super::super) fn rules(line: &str) -> Rules {
        let text = format!("schema = 1\n{line}\n[[cases]]\nscene = \"spur_impact\"\n");
        let file = CheckFile::parse(Path::new("check.toml"), &text);
        file.unwrap_or_else(|e| panic!("{}", e.to_text())).cases[0]
            .rules
            .clone()
    }
}
