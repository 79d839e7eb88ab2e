//! Exit codes of the command: one table for the terminal, `--help`, `--json` and the book.

use crate::experiment::interruption;
use gearbench_reports::Study;
use gearbench_reports::comparison::Kind;
use gearbench_reports::record::{Part, Results, Run, Status};
use std::process::ExitCode;

/// Exit status of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// The command produced its result.
    Done,
    /// The result exists, but does not meet a requirement.
    FellShort,
    /// The input, an argument or an output path is wrong.
    BadInput,
    /// A computation of the command failed.
    FailedRun,
    /// The command was stopped by a signal.
    Interrupted,
}

impl Exit {
    /// All exit codes, in the order of the table.
    pub const ALL: [Exit; 5] = [
        Exit::Done,
        Exit::FellShort,
        Exit::BadInput,
        Exit::FailedRun,
        Exit::Interrupted,
    ];

    /// Rule for results that were not judged, for the help.
    pub const RULE: &str = "\
What was not judged has not passed: under a scene's `tolerance` a run that could not be compared
ends with 1, as one beyond the tolerance does; `except` names models that are left out of that.";

    /// The number of the exit code.
    pub fn code(self) -> u8 {
        match self {
            Exit::Done => 0,
            Exit::FellShort => 1,
            Exit::BadInput => 2,
            Exit::FailedRun => 3,
            Exit::Interrupted => interruption::CODE,
        }
    }

    /// The meaning of the exit code, as in the table of the help.
    pub fn meaning(self) -> &'static str {
        match self {
            Exit::Done => "done",
            Exit::FellShort => {
                "a run is inaccurate (beyond the scene's tolerance), nothing is adequate or it is not decided, or a check moved"
            }
            Exit::BadInput => "bad input: file, line, what was expected, a way out",
            Exit::FailedRun => "a run failed to finish, or a model could not be solved",
            Exit::Interrupted => {
                "interrupted (Ctrl-C, SIGTERM): what was finished is reported, the same command goes on"
            }
        }
    }

    /// The table of exit codes with their meanings, one line each.
    pub fn table() -> String {
        let lines = Exit::ALL.map(|e| format!("  {:<5}{}", e.code(), e.meaning()));
        lines.join("\n")
    }

    /// The exit code of several scenes: that of the worst.
    pub fn worst(of: impl IntoIterator<Item = Exit>) -> Exit {
        let rank = |exit: &Exit| [Exit::Done, Exit::FellShort].iter().position(|e| e == exit);
        // What is none of both has failed.
        let worst = of.into_iter().max_by_key(|e| rank(e).unwrap_or(2));
        worst.unwrap_or(Exit::Done)
    }

    /// The exit code of a study all of whose runs have to be sound: a failed run decides, then a run beyond the
    /// tolerance or not judged by it, unless the tolerance of the scene excepts its model (`except`).
    pub fn of_every_run(results: &Results) -> Exit {
        let excepted = |r: &Run| {
            (results.tolerance.as_ref()).is_some_and(|t| t.except.contains(&r.model_label()))
        };
        // A comparison that asks for no tolerance shows errors, whatever they are.
        let asked = results.tolerance.is_some() || results.study() != Study::Compare;
        // A run that was not judged by the tolerance of the scene has not passed it.
        let falls_short = |r: &Run| match r.status {
            Status::Inaccurate => true,
            // Other studies have judgements of their own.
            Status::Unchecked => results.tolerance.is_some() && results.study() == Study::Compare,
            _ => false,
        };
        let mut runs = results.runs.iter();
        if runs.clone().any(|r| r.status.is_failure()) {
            Exit::FailedRun
        } else if asked && runs.any(|r| falls_short(r) && !excepted(r)) {
            Exit::FellShort
        } else {
            Exit::Done
        }
    }

    /// The exit code of a comparison. If its yardstick is one that it computed, a model of the scene, or a reference
    /// that states its own error, one adequate run is enough. If the scene has a reference that counts as exact, all
    /// runs have to be sound.
    pub fn of_comparison(results: &Results) -> Exit {
        let made = match &results.part {
            Part::Compare(part) => {
                (part.yardstick.as_ref()).filter(|y| y.kind != Kind::Stored || y.error.is_some())
            }
            _ => None,
        };
        let asked = results.tolerance.as_ref().zip(made);
        let Some((_, yardstick)) =
            asked.filter(|(t, y)| t.against == y.id && y.kind != Kind::Named)
        else {
            return Exit::of_every_run(results);
        };
        if results.runs.iter().any(|r| r.status.is_failure()) {
            return Exit::FailedRun;
        }
        let other =
            |r: &&Run| yardstick.kind == Kind::Refined || r.model_label() != yardstick.title;
        match (results.runs.iter().filter(other)).any(|r| r.status == Status::Converged) {
            true => Exit::Done,
            false => Exit::FellShort,
        }
    }

    /// The exit code of a study that continues until methods fail (errors against cost, errors over modes), where
    /// failures are results. Without any comparison it falls short, and without any sound run it has failed.
    pub fn of_any_run(results: &Results) -> Exit {
        let sound = |r: &&Run| r.status.holds();
        let mut ended = results.runs.iter().filter(|r| !r.status.is_failure());
        let judged = |r: &Run| r.status == Status::Converged || !r.metrics.is_empty();
        if results.runs.is_empty() || ended.clone().filter(sound).any(judged) {
            Exit::Done
        } else if ended.next().is_some() {
            Exit::FellShort
        } else {
            Exit::FailedRun
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(exit.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gearbench_reports::record::Tolerance;

    fn record(statuses: &[(&str, Status)]) -> Results {
        let run = |(model, status): &(&str, Status)| Run {
            model: (*model).into(),
            status: *status,
            ..Run::default()
        };
        Results {
            tolerance: Some(Tolerance {
                metric: Default::default(),
                limit: 0.05,
                against: "self".into(),
                except: vec!["shown".into()],
            }),
            runs: statuses.iter().map(run).collect(),
            ..Results::default()
        }
    }

    #[test]
    fn a_run_beyond_the_tolerance_gates_unless_its_model_is_shown_for_its_error() {
        use Status::{Converged, Inaccurate, Timeout, Unchecked};
        let holds = |statuses: &[(&str, Status)], every, any| {
            let r = record(statuses);
            let found = (Exit::of_every_run(&r), Exit::of_any_run(&r));
            assert_eq!(found, (every, any), "{statuses:?}");
        };
        let (done, short, failed) = (Exit::Done, Exit::FellShort, Exit::FailedRun);
        holds(&[("a", Converged), ("a", Converged)], done, done);
        holds(&[("a", Converged), ("shown", Inaccurate)], done, done);
        holds(&[("a", Converged), ("a", Inaccurate)], short, done);
        holds(&[("shown", Inaccurate), ("a", Inaccurate)], short, short);
        holds(&[("a", Inaccurate), ("a", Timeout)], failed, short);
        holds(&[("a", Converged), ("a", Unchecked)], short, done);
        holds(&[("a", Converged), ("shown", Unchecked)], done, done);
        holds(&[("a", Unchecked), ("a", Unchecked)], short, short);
        holds(&[("a", Unchecked), ("a", Timeout)], failed, short);
        // Without a tolerance a comparison shows errors and judges nothing.
        let without = Results {
            tolerance: None,
            ..record(&[("a", Unchecked), ("a", Inaccurate)])
        };
        assert_eq!(Exit::of_every_run(&without), done);
        holds(&[("a", Timeout), ("a", Timeout)], failed, failed);
    }

    #[test]
    fn the_book_has_the_table() {
        let page = include_str!("../../../docs/book/src/reference/commands.md");
        for e in Exit::ALL {
            let row = format!("| {} | {} |", e.code(), e.meaning());
            assert!(page.contains(&row), "{row}");
        }
    }
}
