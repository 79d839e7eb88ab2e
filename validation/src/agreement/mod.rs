//! Agreement of `compare` and `choose`. Both commands are run on typical scenes of users, and their records are
//! compared with each other and with their own messages.
//!
//! | contradiction | condition |
//! |---|---|
//! | models | one command calls the scene's own rigid gears adequate, the other not adequate, in the same metric and tolerance |
//! | finding | the finding of `compare` does not name the cheapest adequate run of its record, or names one where there is none |
//! | exit code | the exit code does not agree with the record |
//! | tolerance | an adequate model has an error against refined gears (twice the elements, half-spaces) above it |
//!
//! "Not decided" of one command does not contradict any verdict of the other; it is counted, with its reason.

mod scenes;

pub use scenes::{SCENES, UserScene, scene};

use gearbench::cli::exit::Exit;
use gearbench::experiment::machine;
use gearbench_reports::record::{Part, Results, Run};
use gearbench_reports::{Adequacy, Verdict, finding, load_results, yardstick_of};
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Result of `compare` and `choose` for one scene.
#[derive(Clone, Debug, Default)]
pub struct Row {
    pub number: usize,
    pub kind: &'static str,
    pub metric: &'static str,
    pub tolerance: f64,
    /// Exit codes of `compare` and `choose`.
    pub codes: [Option<i32>; 2],
    /// Adequacy of each model of the scene according to `compare`.
    pub models: Vec<(String, Option<Adequacy>)>,
    /// Error of the reference (yardstick) of each command.
    pub yardstick: [Option<f64>; 2],
    /// Verdict of `choose`, and the chosen level.
    pub choice: (Option<Verdict>, String),
    /// Adequacy of the scene's own rigid gears according to `choose`.
    pub own_rigid: Option<Adequacy>,
    /// Reason why something is not decided.
    pub reason: String,
    pub contradictions: Vec<String>,
}

/// Bounds on each command, so that forty scenes take less than an hour.
const BOUNDS: [&str; 2] = ["--timeout", "20"];
/// Budget of processor time of a choice [s].
const BUDGET: &str = "120";

/// Columns of the table; the commit is that of the program that ran the scene.
const COLUMNS: [&str; 15] = [
    "commit",
    "scene",
    "kind",
    "metric",
    "tolerance",
    "compare_exit",
    "compare_yardstick_rel",
    "compare_rigid",
    "compare_elastic",
    "choose_exit",
    "choose_yardstick_rel",
    "choose_answer",
    "choose_own_rigid",
    "contradictions",
    "reason",
];

/// Runs both commands on a scene in a folder of its own and compares their records.
///
/// # Errors
/// [`io::Error`]: the folder cannot be written, or the program not started.
pub fn compare_answers(of: &UserScene, gearbench: &Path, folder: &Path) -> io::Result<Row> {
    std::fs::create_dir_all(folder)?;
    let file = folder.join("scene.toml");
    std::fs::write(&file, &of.text)?;
    let said = |arguments: &[&str], name: &str| -> io::Result<(Option<i32>, Option<Results>)> {
        let out = folder.join(name);
        let done = Command::new(gearbench)
            .arg(name)
            .arg(&file)
            .args(arguments)
            .args(BOUNDS)
            .args(["--force", "--quiet", "--out"])
            .arg(&out)
            .output()?;
        std::fs::write(
            folder.join(format!("{name}.txt")),
            [done.stdout, done.stderr].concat(),
        )?;
        let record = load_results(&out.join("results.json")).ok();
        Ok((done.status.code(), record))
    };
    let tolerance = of.tolerance.to_string();
    let (compared_code, compared) = said(&["--yardstick", "refined", "--repeats", "1"], "compare")?;
    let (chosen_code, chosen) = said(
        &[
            "--metric",
            of.metric,
            "--tolerance",
            &tolerance,
            "--budget",
            BUDGET,
        ],
        "choose",
    )?;
    let mut row = Row {
        number: of.number,
        kind: of.kind.as_str(),
        metric: of.metric,
        tolerance: of.tolerance,
        codes: [compared_code, chosen_code],
        ..Row::default()
    };
    if let Some(record) = &compared {
        row.compared(record);
    }
    if let Some(record) = &chosen {
        row.chosen(record);
    }
    row.against_each_other();
    Ok(row)
}

/// The best adequacy of each model, with its best run.
fn answers(record: &Results) -> Vec<(String, Option<Adequacy>, Option<f64>)> {
    let yardstick = yardstick_of(record);
    let Some(tolerance) = &record.tolerance else {
        return Vec::new();
    };
    let mut labels: Vec<String> = record.runs.iter().map(Run::model_label).collect();
    labels.dedup();
    let of_label = |label: String| {
        let own = record.runs.iter().filter(|r| r.model_label() == label);
        let error = |r: &Run| {
            let found = r.against(&tolerance.against)?.get(tolerance.metric)?;
            Some(found.abs()).filter(|e| e.is_finite())
        };
        let least = own
            .filter(|r| !r.status.is_failure())
            .filter_map(error)
            .min_by(f64::total_cmp);
        let answer = least.and_then(|e| Some(yardstick.as_ref()?.verdict(e, tolerance.limit)));
        (label, answer, least)
    };
    labels.into_iter().map(of_label).collect()
}

impl Row {
    fn compared(&mut self, record: &Results) {
        let found = answers(record);
        let yardstick = yardstick_of(record);
        self.yardstick[0] = yardstick.as_ref().and_then(|y| y.error);
        let limit = record.tolerance.as_ref().map_or(f64::NAN, |t| t.limit);
        for (label, answer, error) in &found {
            if *answer == Some(Adequacy::Adequate) && error.is_none_or(|e| e > limit) {
                let what = format!("tolerance: {label} is adequate with an error of {error:?}");
                self.contradictions.push(what);
            }
        }
        let any = |wanted| found.iter().any(|(_, a, _)| *a == Some(wanted));
        let refused = record.runs.iter().any(|r| r.status.is_failure());
        // A failed run has an exit code above those of the results.
        let expected = if any(Adequacy::Adequate) {
            Some(0)
        } else {
            Some(1)
        };
        if self.codes[0] != expected && !(refused && self.codes[0] == Some(3)) {
            let what = format!("exit code: compare ended with {:?}", self.codes[0]);
            self.contradictions.push(what);
        }
        let said = finding(record).unwrap_or_default().join(" ");
        let names_one = said.contains("The cheapest run within the scene's tolerance");
        if names_one != any(Adequacy::Adequate) {
            self.contradictions.push(format!("finding: {said}"));
        }
        if let (true, Some(cheapest)) = (names_one, self.cheapest(record))
            && !said.contains(&cheapest)
        {
            let what = format!("finding: `{cheapest}` is not in: {said}");
            self.contradictions.push(what);
        }
        self.models = found.into_iter().map(|(label, a, _)| (label, a)).collect();
        if let Some(y) = yardstick.filter(|y| !y.note.is_empty()) {
            self.reason = y.note.clone();
        }
    }

    /// Label and integrator of the cheapest adequate run of a record, in the form of the finding.
    fn cheapest(&self, record: &Results) -> Option<String> {
        let (yardstick, tolerance) = (yardstick_of(record)?, record.tolerance.as_ref()?);
        let adequate = |r: &&Run| {
            let error = r
                .against(&tolerance.against)
                .and_then(|m| m.get(tolerance.metric));
            let holds = |e: f64| yardstick.verdict(e.abs(), tolerance.limit) == Adequacy::Adequate;
            !r.status.is_failure() && error.is_some_and(holds)
        };
        let cheapest = record.runs.iter().filter(adequate);
        let cheapest = cheapest.min_by(|a, b| a.cost_s().total_cmp(&b.cost_s()))?;
        Some(format!(
            "{} under {}",
            cheapest.model_label(),
            cheapest.integrator
        ))
    }

    fn chosen(&mut self, record: &Results) {
        let Part::Choose(part) = &record.part else {
            return;
        };
        let choice = &part.choice;
        self.yardstick[1] = choice.yardstick_error;
        let level = choice.chosen.and_then(|i| choice.tried.get(i));
        self.choice = (
            choice.verdict,
            level.map_or(String::new(), |t| t.level.clone()),
        );
        let own = choice
            .levels
            .iter()
            .find(|l| l.name.contains("own `rigid`"));
        self.own_rigid = own.filter(|l| l.failure.is_none()).map(|l| l.adequate);
        let expected = match choice.verdict {
            Some(Verdict::Adequate) => Some(0),
            _ => Some(1),
        };
        if self.codes[1] != expected {
            let what = format!(
                "exit code: choose ended with {:?}, {:?}",
                self.codes[1], choice.verdict
            );
            self.contradictions.push(what);
        }
        let least = choice.predicted_error;
        if choice.verdict == Some(Verdict::Adequate) && least.is_none_or(|e| e > choice.tolerance) {
            let what = format!("tolerance: choose answers adequate with an error of {least:?}");
            self.contradictions.push(what);
        }
        if choice.verdict == Some(Verdict::NotDecided) {
            let why = match (&choice.not_repeatable, choice.yardstick_error) {
                (Some(why), _) => why.clone(),
                (None, Some(e)) => format!("the yardstick of choose is off by {:.2} %", 100.0 * e),
                (None, None) => "the yardstick of choose has no known error".into(),
            };
            self.reason = why;
        }
    }

    fn against_each_other(&mut self) {
        let rigid = self.models.iter().find(|(label, _)| label == "rigid");
        let pair = rigid.and_then(|(_, a)| *a).zip(self.own_rigid);
        if let Some(
            (Adequacy::Adequate, Adequacy::NotAdequate)
            | (Adequacy::NotAdequate, Adequacy::Adequate),
        ) = pair
        {
            let what = format!("models: compare and choose on rigid gears: {pair:?}");
            self.contradictions.push(what);
        }
    }

    /// True, by command, if the command decided nothing (`compare`, then `choose`).
    pub fn undecided(&self) -> [bool; 2] {
        let some = |wanted| self.models.iter().any(|(_, a)| *a == Some(wanted));
        [
            !some(Adequacy::Adequate) && some(Adequacy::NotDecided),
            self.choice.0 == Some(Verdict::NotDecided),
        ]
    }
}

/// All rows as CSV, after a line with the command.
///
/// # Errors
/// [`csv::Error`]: a row that cannot be written.
pub fn csv(rows: &[Row]) -> Result<Vec<u8>, csv::Error> {
    let mut out = csv::Writer::from_writer(b"# gearbench-validation agreement\n".to_vec());
    out.write_record(COLUMNS)?;
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.6e}"));
    let code = |x: Option<i32>| x.map_or_else(String::new, |x| x.to_string());
    for r in rows {
        let of = |label: &str| {
            let found = r.models.iter().find(|(l, _)| l == label);
            let answer = found.and_then(|(_, a)| *a);
            answer.map_or_else(|| "no run".to_owned(), |a| a.to_string())
        };
        let answer = match &r.choice {
            (Some(Verdict::Adequate), level) => level.clone(),
            (Some(verdict), _) => verdict.to_string(),
            (None, _) if r.codes[1] == Some(Exit::BadInput.code().into()) => "refused".to_owned(),
            (None, _) => "no answer".to_owned(),
        };
        out.write_record([
            machine::header("", "", "").commit,
            r.number.to_string(),
            r.kind.to_owned(),
            r.metric.to_owned(),
            r.tolerance.to_string(),
            code(r.codes[0]),
            number(r.yardstick[0]),
            of("rigid"),
            of("elastic"),
            code(r.codes[1]),
            number(r.yardstick[1]),
            answer,
            r.own_rigid.map_or_else(String::new, |a| a.to_string()),
            r.contradictions.join("; "),
            match r.undecided().contains(&true) {
                true => r.reason.clone(),
                false => String::new(),
            },
        ])?;
    }
    out.into_inner().map_err(|e| e.into_error().into())
}

/// The path of the program `gearbench` in the folder of this program.
pub fn next_to_this() -> PathBuf {
    let own = std::env::current_exe().unwrap_or_default();
    own.with_file_name(format!("gearbench{}", std::env::consts::EXE_SUFFIX))
}
