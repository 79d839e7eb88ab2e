//! Implements `gearbench check FILE`: runs the cases of a check file and compares the results with its baseline.

use super::arguments::Check;
use super::baseline::{Baseline, Baselines};
use super::comparison::{LIKELY, gone, judge, middle, program, slow_limit};
use super::file::{Case, CheckFile};
use super::measure::{Entry, Group, LoadedCase, load};
use super::summary::summarise;
use crate::cli::arguments::Output;
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, absolute, refuse_run};
use crate::context::Context;
use crate::experiment::machine;
use crate::experiment::run::RunError;
use crate::experiment::runner::Runner;
use gearbench_reports::check::{CheckRecord, CheckedEntry, MeasuredEntry, Stored};
use gearbench_reports::record::{Part, Results, Status};
use std::path::Path;

/// Quantity whose history the page of a check draws.
const USUAL_HISTORY: &str = "runtime";

/// Moments at which runtimes are measured, most; those near the limit at further ones.
const PASSES: usize = 4;
const NEAR_PASSES: usize = 8;
/// Distance from the limit at which a runtime is near it [-].
const NEAR: f64 = 0.05;

/// Runs the check and writes its folder.
pub fn run(context: &Context, args: &Check, command: &str) -> Result<CommandResult, Refusal> {
    let file = CheckFile::read(&args.file)?;
    let before = Baselines::read(&file.baseline)?;
    let mut baselines = before.clone();
    let stem = args.file.file_stem().unwrap_or_default().to_string_lossy();
    let name = stem.into_owned();
    let record = CheckRecord {
        file: args.file.display().to_string(),
        stored: baselines.newest().map(|b| b.stored.clone()),
        quantity: args.history.clone().unwrap_or_else(|| USUAL_HISTORY.into()),
        ..CheckRecord::default()
    };
    let results = |record: CheckRecord| Results {
        header: machine::header(&name, &file.title, command),
        part: Part::Check(record),
        ..Results::default()
    };
    if args.history.is_some() {
        let known = baselines.quantities();
        if !known.contains(&record.quantity.as_str()) {
            return Err(Refusal::Input(miette::miette!(
                help = format!("they have {}", known.join(", ")),
                "the stored baselines have no quantity `{}`",
                record.quantity
            )));
        }
        let history = baselines.history(&record.quantity, &[]);
        let usual = Path::new("out").join(&name).join("history");
        let output = Output {
            out: args.output.out.clone().or(Some(usual)),
            ..args.output.clone()
        };
        let folder = StudyFolder::open(context, &output, &name, "check")?;
        let drawn = results(CheckRecord { history, ..record });
        return folder.finish(drawn, |_| Exit::Done, |_, _| {});
    }
    if baselines.newest().is_none() && !args.update {
        return Err(Refusal::Input(miette::miette!(
            help = "`--update` runs the check and stores what it measures; commit the file",
            "{}: the baseline for the comparison is missing",
            file.baseline.display()
        )));
    }
    let cases = file.select(&args.cases, args.quick)?;
    let loaded = cases.iter().map(|case| load(context, &file, case));
    let loaded = loaded.collect::<Result<Vec<_>, _>>()?;
    let mut folder = StudyFolder::open(context, &args.output, &name, "check")?;
    // The file keeps the lines of former versions as they are.
    let mut named = baselines.clone();
    for one in &loaded {
        named.name_speeds(&one.case.name, one.gears());
    }
    let newest = named.newest().cloned().unwrap_or_default();
    let total = loaded.iter().map(LoadedCase::len).sum();
    let made = folder.run(total, |runner| -> Result<_, RunError> {
        let mut groups = measure(&loaded, (runner, total))?;
        if !(args.no_runtime || runner.is_interrupted()) {
            let doubt = RepeatRule {
                newest: &newest,
                update: args.update,
                all: file.runtime.all,
            };
            time(&mut groups, &doubt, runner)?;
        }
        Ok(groups
            .into_iter()
            .flat_map(|g| g.entries)
            .collect::<Vec<_>>())
    });
    let mut entries = made.map_err(|e| folder.refuse(refuse_run(e)))?;
    let stopped = context.interruption.is_requested();
    entries.retain(|e| e.measured.status != Status::Interrupted);
    let here = machine::machine();
    let same = here.cpu == newest.stored.cpu;
    let mut checked: Vec<CheckedEntry> = Vec::new();
    for entry in &entries {
        let (now, rules) = (entry.measured.clone(), &entry.case.rules);
        let before = newest.entries.iter().find(|b| b.is(&now));
        checked.push(judge(now, before, rules, same));
    }
    let now: Vec<MeasuredEntry> = checked.iter().map(|c| c.measured.clone()).collect();
    let left = left_out(&newest, &file, &cases, &now);
    if !stopped {
        // Without all entries neither the program as a whole nor absent entries can be judged.
        checked.extend(program(&now, &newest.entries, &file.runtime, same));
        checked.extend(left.gone.iter().map(gone));
    }
    let record = CheckRecord {
        entries: checked,
        history: named.history(&record.quantity, &now),
        ..record
    };
    let holds = record.holds();
    let update = args.update && !stopped;
    let stored = match update {
        false => None,
        // Entries that were not run keep their baselines.
        true if !holds || newest.entries.is_empty() => {
            let entries = now.into_iter().chain(left.kept).collect();
            let stored = Stored {
                commit: machine::commit().into(),
                created: machine::now(),
                cpu: here.cpu,
                ..Stored::default()
            };
            if Baselines::read(&file.baseline)? != before {
                return Err(Refusal::Files(format!(
                    "{}: another process has stored a baseline while the check ran; run it again",
                    file.baseline.display()
                )));
            }
            baselines.add(stored, entries);
            baselines.write(&file.baseline)?;
            Some(absolute(file.baseline.clone()))
        }
        true => None,
    };
    let exit = match holds || update {
        true => Exit::Done,
        false => Exit::FellShort,
    };
    let answer = folder.finish(
        results(record.clone()),
        |_| exit,
        |messages, _| summarise(messages, &record),
    )?;
    if update {
        context.messages.print_line(&match &stored {
            Some(path) => format!("stored: {}", path.display()),
            None => "no value has moved: the baseline is unchanged".into(),
        });
    }
    Ok(match stored {
        Some(path) => answer.with("stored", path),
        None => answer,
    })
}

fn measure<'l>(
    loaded: &'l [LoadedCase<'l>],
    (runner, total): (&Runner<'_>, usize),
) -> Result<Vec<Group<'l>>, RunError> {
    let mut all = Vec::new();
    let mut done = 0;
    for one in loaded {
        all.extend(one.measure(runner, (done, total))?);
        done += one.len();
    }
    Ok(all)
}

/// Measures runtimes: of all entries once, and of those that leave doubt at other moments again.
fn time(
    groups: &mut [Group<'_>],
    doubt: &RepeatRule<'_>,
    runner: &Runner<'_>,
) -> Result<(), RunError> {
    let total = groups.iter().map(|g| g.entries.len()).sum();
    for pass in 0..NEAR_PASSES {
        let together = doubt.repeats_all(groups, pass);
        let mut done = 0;
        for group in &mut *groups {
            for i in 0..group.entries.len() {
                if runner.is_interrupted() {
                    return Ok(());
                }
                let entry = &group.entries[i];
                if pass == 0 || together || doubt.of(entry, pass) {
                    let what = format!("runtime of {}", entry.measured.name());
                    runner.report_progress(done, total, &what);
                    group.time(i)?;
                }
                done += 1;
            }
        }
    }
    Ok(())
}

/// Rule for the runtimes that must be measured again: slow or almost slow ones, and later those so near the limit that
/// either verdict would be chance.
struct RepeatRule<'a> {
    newest: &'a Baseline,
    /// True if the results become a new baseline: every entry is then timed as often as a slow one.
    update: bool,
    /// Limit of the median over all entries.
    all: f64,
}

impl RepeatRule<'_> {
    fn baseline(&self, entry: &Entry<'_>) -> Option<&MeasuredEntry> {
        self.newest.entries.iter().find(|b| b.is(&entry.measured))
    }

    /// True if a runtime ratio, as a fraction of its limit, is still inconclusive after this number of passes.
    fn about(part: f64, pass: usize) -> bool {
        match pass < PASSES {
            true => part > LIKELY,
            false => (part - 1.0).abs() < NEAR,
        }
    }

    /// True if the runtime of a single entry must be measured again.
    fn of(&self, entry: &Entry<'_>, pass: usize) -> bool {
        let from = slow_limit(self.baseline(entry), &entry.case.rules);
        let part = (entry.measured.runtime.zip(from)).map(|(now, from)| now / from);
        (self.update && pass < PASSES) || part.is_some_and(|part| Self::about(part, pass))
    }

    /// True if the median of all runtimes must be measured again.
    fn repeats_all(&self, groups: &[Group<'_>], pass: usize) -> bool {
        let entries = groups.iter().flat_map(|g| &g.entries);
        let ratio = |e: &Entry<'_>| Some(e.measured.runtime? / self.baseline(e)?.runtime?);
        let ratios: Vec<f64> = entries.filter_map(ratio).collect();
        middle(&ratios).is_some_and(|ratio| Self::about(ratio / self.all, pass))
    }
}

/// Entries of a baseline that were not run.
struct SkippedEntries {
    /// Entries whose case was not selected.
    kept: Vec<MeasuredEntry>,
    /// The check does not have them any more.
    gone: Vec<MeasuredEntry>,
}

fn left_out(
    newest: &Baseline,
    file: &CheckFile,
    cases: &[&Case],
    now: &[MeasuredEntry],
) -> SkippedEntries {
    let missing = newest
        .entries
        .iter()
        .filter(|b| !now.iter().any(|n| n.is(b)));
    let asked = |b: &&MeasuredEntry| {
        let known = file.cases.iter().any(|c| c.name == b.case);
        !known || cases.iter().any(|c| c.name == b.case)
    };
    let (gone, kept) = missing.cloned().partition(|b| asked(&b));
    SkippedEntries { kept, gone }
}
