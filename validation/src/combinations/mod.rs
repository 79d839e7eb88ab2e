//! The table of combinations: which toothing, mount, position of axes, model, contact, integrator and study work together.
//!
//! Every scene is built and run for a short time under each integrator, and its balance of energy is examined; then every
//! study is run on it. A cell has one of these outcomes:
//!
//! | outcome | meaning |
//! |---|---|
//! | runs | the run reached its end and its energy is explained within [`ENERGY`]; the study ended |
//! | refused N | the program said why it does not do this; N is the number of the reason |
//! | failed N | the run or the study started and did not end well |
//!
//! A scene that is refused when it is read has that outcome in all of its cells.

mod scenes;

use scenes::Model;
pub use scenes::{Combination, all};

use gearbench::context::Context;
use gearbench::experiment::conditions::Conditions;
use gearbench::experiment::configuration::Configuration;
use gearbench::experiment::run::{RunError, run};
use gearbench::scene_file::SceneFile;
use gearbench_integrators::Scheme;
use gearbench_integrators::table::{
    DOPRI5, HHT_ALPHA, NEWMARK, RK4, TRIGONOMETRIC, VELOCITY_VERLET,
};
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

/// Part of the largest entry of the ledger within which energy has to be explained [-].
pub const ENERGY: f64 = 0.02;
/// Bound on the processor time of a run.
const TIMEOUT: Duration = Duration::from_secs(5);

/// Integrators of the table with their steps.
fn schemes() -> [Scheme; 6] {
    [
        VELOCITY_VERLET.at_step(2e-7),
        RK4.at_step(2e-7),
        DOPRI5.at_tolerance(1e-6),
        NEWMARK.at_step(5e-7),
        HHT_ALPHA.at_step(5e-7),
        TRIGONOMETRIC.at_step(5e-7),
    ]
}

/// Studies of the table, with arguments that make them short.
const STUDIES: [(&str, &[&str]); 6] = [
    ("stiffness", &["--positions", "4"]),
    ("modes", &[]),
    ("response", &["--points", "3"]),
    ("sweep", &["--points", "2", "--cycles", "1"]),
    ("stability", &["--integrators", "rk4"]),
    (
        "run-up",
        &[
            "--from",
            "90",
            "--to",
            "110",
            "--over",
            "2e-3",
            "--samples",
            "1024",
        ],
    ),
];

/// The outcome of a cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It ran, and its energy is explained.
    Runs,
    /// The program refused it for a reason.
    Refused(String),
    /// It did not end well.
    Failed(String),
    /// It was not tried.
    NotTried,
}

/// The cells of one scene: under each integrator, and by each study.
#[derive(Clone, Debug)]
pub struct Row {
    pub of: Combination,
    pub runs: Vec<Outcome>,
    pub studies: Vec<Outcome>,
}

/// Names of the columns with outcomes.
pub fn columns() -> Vec<String> {
    let methods = schemes().map(|s| s.method.to_string());
    let studies = STUDIES.map(|(name, _)| name.to_owned());
    methods.into_iter().chain(studies).collect()
}

/// Runs a scene under all integrators, and all studies by the program, in a folder for their results.
///
/// # Errors
/// [`io::Error`]: a file cannot be written, or the program not started.
pub fn examine(
    context: &Context,
    of: Combination,
    studies: Option<(&Path, &Path)>,
) -> io::Result<Row> {
    let scene = of.scene();
    let file = match scene.load(context) {
        Ok(file) => file,
        Err(e) => {
            let why = Outcome::Refused(e.message().to_owned());
            return Ok(Row {
                of,
                runs: vec![why.clone(); schemes().len()],
                studies: vec![why; STUDIES.len()],
            });
        }
    };
    // The steps of explicit methods on whole meshes are those of the smallest element: a matter of time, not of what works.
    let is_tried = |scheme: &Scheme| {
        of.model != Model::FullOrder
            || scheme.method.info().implicit
            || scheme.method == TRIGONOMETRIC
    };
    let one = |scheme: &Scheme| match is_tried(scheme) {
        true => integrated(&file, scheme),
        false => Outcome::NotTried,
    };
    let runs = schemes().iter().map(one).collect();
    let studies = match studies {
        None => vec![Outcome::NotTried; STUDIES.len()],
        Some((program, folder)) => {
            let path = folder.join("combination.toml");
            std::fs::write(&path, file.text())?;
            let study = |(name, arguments): (&str, &[&str])| {
                studied(program, (&path, folder), (name, arguments))
            };
            STUDIES.into_iter().map(study).collect::<io::Result<_>>()?
        }
    };
    Ok(Row { of, runs, studies })
}

/// Runs a scene under an integrator.
fn integrated(file: &SceneFile, scheme: &Scheme) -> Outcome {
    let configuration = Configuration::of(file, &file.models[0]);
    let conditions = Conditions {
        timeout: TIMEOUT,
        samples: 51,
        repeats: 0,
        ..Conditions::of(file)
    };
    let grid = conditions.grid();
    let job = conditions.job(
        (&configuration.scene, &configuration.modelling),
        scheme,
        &grid,
    );
    match run(&job) {
        Err(e) => match e {
            RunError::Reference(_) | RunError::Interrupted | RunError::Journal(_) => {
                Outcome::Failed(e.to_string())
            }
            refused => Outcome::Refused(refused.to_string()),
        },
        Ok(made) if made.status.is_failure() => {
            let why = made.message.unwrap_or_else(|| made.status.to_string());
            Outcome::Failed(format!("{}: {why}", made.status))
        }
        Ok(made) => match made.ledger.residual_rel {
            Some(rest) if rest.abs() <= ENERGY => Outcome::Runs,
            Some(_) => Outcome::Failed("energy is not explained".into()),
            None => Outcome::Failed("the energy is not known".into()),
        },
    }
}

/// Runs a study by the program.
fn studied(
    program: &Path,
    (scene, folder): (&Path, &Path),
    (name, arguments): (&str, &[&str]),
) -> io::Result<Outcome> {
    let done = Command::new(program)
        .arg(name)
        .arg(scene)
        .args(arguments)
        .args(["--quiet", "--force", "--out"])
        .arg(folder.join(name))
        .output()?;
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    Ok(match done.status.code() {
        Some(0 | 1) => Outcome::Runs,
        Some(2) => Outcome::Refused(said),
        _ => Outcome::Failed(said),
    })
}

/// Reduces a reason to its kind: numbers and quoted names are left out, so that equal refusals are one.
fn kind_of(reason: &str) -> String {
    let line = reason
        .lines()
        .map(str::trim)
        .find(|l| !l.is_empty())
        .unwrap_or("");
    let line = line.trim_start_matches(['x', '×', ' ']);
    let mut out = String::new();
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '`' => {
                quoted = !quoted;
                if quoted {
                    out.push_str("`..`");
                }
            }
            _ if quoted => {}
            '0'..='9' | '.' | '-' | '+' if out.ends_with('#') => {}
            '0'..='9' => out.push('#'),
            c => out.push(c),
        }
    }
    out.chars().take(160).collect()
}

/// Reasons with the number of their cells, numbered in the order in which they are first met.
#[derive(Clone, Debug, Default)]
pub struct Reasons(Vec<(String, usize)>);

impl Reasons {
    fn number(&mut self, reason: &str) -> usize {
        let kind = kind_of(reason);
        let place = self.0.iter().position(|(known, _)| *known == kind);
        let place = place.unwrap_or_else(|| {
            self.0.push((kind, 0));
            self.0.len() - 1
        });
        self.0[place].1 += 1;
        place + 1
    }
}

/// Returns the table and the list of its reasons as CSV.
///
/// # Errors
/// [`csv::Error`]: a row that cannot be written.
pub fn csv(rows: &[Row]) -> Result<[Vec<u8>; 2], csv::Error> {
    let comment = b"# gearbench-validation combinations\n".to_vec();
    let mut table = csv::Writer::from_writer(comment.clone());
    let head = ["toothing", "mount", "axes", "model", "contact"].map(String::from);
    table.write_record(head.into_iter().chain(columns()))?;
    let mut reasons = Reasons::default();
    for row in rows {
        let of = row.of;
        let mut record = vec![
            of.toothing.to_string(),
            of.mount.to_string(),
            of.axes.to_string(),
            of.model.to_string(),
            of.contact.to_string(),
        ];
        record.extend(
            row.runs
                .iter()
                .chain(&row.studies)
                .map(|outcome| match outcome {
                    Outcome::Runs => "runs".to_owned(),
                    Outcome::NotTried => String::new(),
                    Outcome::Refused(why) => format!("refused {}", reasons.number(why)),
                    Outcome::Failed(why) => format!("failed {}", reasons.number(why)),
                }),
        );
        table.write_record(record)?;
    }
    let mut list = csv::Writer::from_writer(comment);
    list.write_record(["number", "cells", "reason"])?;
    for (i, (reason, cells)) in reasons.0.iter().enumerate() {
        list.write_record([(i + 1).to_string(), cells.to_string(), reason.clone()])?;
    }
    let bytes =
        |w: csv::Writer<Vec<u8>>| w.into_inner().map_err(|e| csv::Error::from(e.into_error()));
    Ok([bytes(table)?, bytes(list)?])
}

/// Counts the outcomes of some rows: run, refused, failed.
pub fn counts(rows: &[Row]) -> BTreeMap<&'static str, usize> {
    let mut found = BTreeMap::new();
    for outcome in rows.iter().flat_map(|r| r.runs.iter().chain(&r.studies)) {
        let name = match outcome {
            Outcome::Runs => "run",
            Outcome::Refused(_) => "refused",
            Outcome::Failed(_) => "failed",
            Outcome::NotTried => "not tried",
        };
        *found.entry(name).or_default() += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_refusals_are_one() {
        let a = kind_of("  × the gear `first` has 20 teeth of 3.5e-3 m");
        assert_eq!(
            a,
            kind_of("the gear `p1` has 28 teeth of 3.25e-3 m\n  help: none")
        );
        assert_ne!(a, kind_of("the gear `first` has no teeth"));
    }

    /// The stored table is what a part of it, of rigid gears and movable teeth, gives now.
    #[test]
    fn the_stored_table_holds() {
        let stored = include_str!("../../results/combinations.csv");
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .from_reader(stored.as_bytes());
        let stored: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let all = all();
        assert_eq!(stored.len(), all.len());
        let context = Context::default();
        let light = |of: &Combination| matches!(of.model, Model::Rigid | Model::MovableTeeth);
        let mut tried = 0;
        for (of, stored) in all
            .iter()
            .zip(&stored)
            .filter(|(of, _)| light(of))
            .step_by(11)
        {
            let row = examine(&context, *of, None).unwrap();
            for (outcome, stored) in row.runs.iter().zip(stored.iter().skip(5)) {
                let now = match outcome {
                    Outcome::Runs => "runs",
                    Outcome::Refused(_) => "refused",
                    Outcome::Failed(_) => "failed",
                    Outcome::NotTried => "",
                };
                let word = stored.split(' ').next().unwrap();
                // A cell that was not tried is empty.
                if word.is_empty() {
                    continue;
                }
                assert_eq!(now, word, "{of:?}: {outcome:?}");
            }
            tried += 1;
        }
        assert!(tried > 10, "{tried}");
    }
}
