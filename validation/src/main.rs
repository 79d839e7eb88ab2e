//! Validation of the model choice: on random scenes every candidate is run, and the choice is compared with the
//! cheapest adequate candidate.
//!
//! | module | owns |
//! |---|---|
//! | [`agreement`] | agreement of `compare` and `choose` on scenes in the style of users |
//! | [`arguments`] | the command line |
//! | [`sampling`] | random scenes: sets, seeds, distributions |
//! | [`validate`] | one scene: its reference, all candidates, the choice |
//! | [`choices`] | validated choices and their table |
//! | [`campaign`] | a set of scenes, in parallel, with a journal |
//! | [`reduction`] | elastic gears compared with full finite elements on the same scenes |
//! | [`combinations`] | which toothings, mounts, models, contacts, integrators and studies work together |
//! | [`coverage`] | coverage of the intervals of identified constants on synthetic data |
//! | [`figures`] | figures in the documents: commands, stored values, comparison |
//! | [`identification`] | identified constants compared with finite elements at other speeds |
//! | [`summary`] | counts and ranges of stored results |

mod agreement;
mod arguments;
mod campaign;
mod choices;
mod combinations;
mod coverage;
mod figures;
mod identification;
mod reduction;
mod sampling;
mod summary;
mod validate;

use arguments::{Cli, Command};
use campaign::{Plan, check};
use choices::{Outcome, ValidatedChoice, share, shares};
use clap::Parser;
use gearbench::cli::arguments::Output;
use gearbench::cli::command_result::CommandResult;
use gearbench::cli::exit::Exit;
use gearbench::cli::progress::Display;
use gearbench::cli::study_folder::StudyFolder;
use gearbench::cli::terminal::{self, Refusal};
use gearbench::context::Context;
use gearbench::experiment::conditions::silent;
use gearbench::experiment::journal::{JOURNAL, Journal, Subject};
use gearbench::experiment::machine;
use gearbench::experiment::runner::Runner;
use gearbench::messages::Messages;
use gearbench_reference::reduction::cache::Cache;
use gearbench_reports::record::{Part, Results};
use sampling::SampleError;
use std::fmt::Write as _;
use std::process::ExitCode;
use std::sync::Arc;
use validate::ValidationError;

/// Required share of adequate choices, and largest median of the cost ratio.
const ASKED: (f64, f64) = (0.95, 2.0);

/// Accepted range of the share of 95 % intervals that contain the true value.
const COVERAGE: [f64; 2] = [0.90, 0.99];

fn main() -> ExitCode {
    machine::set_commit(machine::commit_of_checkout());
    let mut context = Context::default();
    context.resources.cache = Arc::new(Cache::standard());
    let told = terminal::command_line("gearbench-validation");
    let done = (context.resources).within(|| match Cli::parse().command {
        Command::Sample { scene } => print(&context, &scene.0, scene.1),
        Command::Run(args) => validate(&context, &args, &told),
        Command::Reduction(args) => reduce(&context, &args),
        Command::Coverage(args) => cover(&context, &args),
        Command::Agreement(args) => agree(&context, &args),
        Command::Combinations(args) => combine(&context, &args),
        Command::Identification(args) => carry(&context, &args, &told),
        Command::Figures(args) => quote(&context, &args),
        Command::Summary { files } => summary(&context, &files),
    });
    terminal::end(&context, &told, done)
}

/// Runs both commands on each scene in turn, and writes the table after each.
fn agree(context: &Context, args: &arguments::Agreement) -> Result<CommandResult, Refusal> {
    let [first, last] = args.scenes.unwrap_or([1, agreement::SCENES]);
    let fail = |e: std::io::Error| Refusal::Files(format!("{}: {e}", args.out.display()));
    if last > agreement::SCENES {
        return Err(Refusal::Input(miette::miette!(
            "there are {} scenes",
            agreement::SCENES
        )));
    }
    let program = agreement::next_to_this();
    let file = args.out.join("agreement.csv");
    let mut rows: Vec<agreement::Row> = Vec::new();
    for number in first..=last {
        let of = agreement::scene(number).map_err(|e| Refusal::Failed(e.to_string()))?;
        let folder = args.out.join(format!("scene-{number:02}"));
        let row = agreement::compare_answers(&of, &program, &folder).map_err(fail)?;
        context.messages.print_line(&format!(
            "scene {number}, {}: {}",
            row.kind,
            match row.contradictions.is_empty() {
                true => "no contradiction".into(),
                false => row.contradictions.join("; "),
            }
        ));
        rows.push(row);
        let csv = agreement::csv(&rows).map_err(|e| fail(e.into()))?;
        std::fs::write(&file, csv).map_err(fail)?;
    }
    let contradicted = rows.iter().filter(|r| !r.contradictions.is_empty()).count();
    let undecided = |i: usize| rows.iter().filter(|r| r.undecided()[i]).count();
    context.messages.print_line(&format!(
        "{} scenes, {contradicted} with a contradiction; not decided by compare {}, by choose {}",
        rows.len(),
        undecided(0),
        undecided(1)
    ));
    context
        .messages
        .print_line(&format!("table: {}", file.display()));
    Ok(CommandResult::done().ending(match contradicted {
        0 => Exit::Done,
        _ => Exit::FellShort,
    }))
}

/// Examines all combinations and writes their table, and the list of reasons next to it.
fn combine(context: &Context, args: &arguments::Combinations) -> Result<CommandResult, Refusal> {
    let fail = |e: std::io::Error| Refusal::Files(format!("{}: {e}", args.out.display()));
    let mut all = combinations::all();
    all.retain(|of| of.has(&args.only));
    if all.is_empty() {
        return Err(Refusal::Input(miette::miette!(
            help = "the words are those of the columns of the table, such as helical, elastic shaft, movable-teeth",
            "no combination has all of: {}",
            args.only.join(", ")
        )));
    }
    let folder = tempfile::tempdir().map_err(fail)?;
    let program = agreement::next_to_this();
    let studies = (!args.without_studies).then_some((program.as_path(), folder.path()));
    let display = Display::new(all.len());
    let mut rows = Vec::with_capacity(all.len());
    for of in &all {
        if context.interruption.is_requested() {
            break;
        }
        let what = format!(
            "{}, {}, {}, {}",
            of.toothing, of.mount, of.model, of.contact
        );
        display.report_progress(rows.len(), all.len(), &what);
        rows.push(combinations::examine(context, *of, studies).map_err(fail)?);
    }
    drop(display);
    let [table, reasons] = combinations::csv(&rows).map_err(|e| fail(e.into()))?;
    std::fs::write(&args.out, table).map_err(fail)?;
    let name = args.out.file_stem().unwrap_or_default().to_string_lossy();
    let list = args.out.with_file_name(format!("{name}_reasons.csv"));
    std::fs::write(&list, reasons).map_err(fail)?;
    for (outcome, cells) in combinations::counts(&rows) {
        context
            .messages
            .print_line(&format!("{outcome}: {cells} cells"));
    }
    Ok(CommandResult::done())
}

/// Measures the figures of the documents again and writes them into the documents.
fn quote(context: &Context, args: &arguments::Figures) -> Result<CommandResult, Refusal> {
    let root = figures::repository();
    let mut stored = figures::Figures::load(&root).map_err(Refusal::Failed)?;
    if !args.text {
        let program = agreement::next_to_this();
        stored
            .measure(&root, &args.sources, &program, &|line| {
                context.messages.print_line(line)
            })
            .map_err(Refusal::Failed)?;
    }
    let changed = stored.write(&root).map_err(Refusal::Failed)?;
    for difference in &changed {
        context.messages.print_line(&difference.to_string());
    }
    context.messages.print_line(&format!(
        "{} figures and rows of the documents changed",
        changed.len()
    ));
    Ok(CommandResult::done())
}

/// Prints counts and ranges of stored results.
fn summary(context: &Context, files: &[std::path::PathBuf]) -> Result<CommandResult, Refusal> {
    for line in summary::lines(files).map_err(Refusal::Failed)? {
        context.messages.print_line(&line);
    }
    Ok(CommandResult::done())
}

fn refuse_sample(e: SampleError) -> Refusal {
    match e {
        SampleError::Set { .. } | SampleError::Number { .. } => Refusal::Input(miette::miette!(
            help = "validation/sets.toml contains the sets and their sizes",
            "{e}"
        )),
        e => Refusal::Failed(e.to_string()),
    }
}

fn refuse(e: ValidationError) -> Refusal {
    match e {
        ValidationError::Sample(e) => refuse_sample(e),
        e @ ValidationError::Journal(_) => Refusal::Files(e.to_string()),
        e => Refusal::Failed(e.to_string()),
    }
}

/// Prints a random scene as a scene file.
fn print(context: &Context, set: &str, number: usize) -> Result<CommandResult, Refusal> {
    let set = sampling::set(set).map_err(refuse_sample)?;
    let sample = sampling::sample(&set, number).map_err(refuse_sample)?;
    context.messages.print_text(sample.text.trim_end());
    Ok(CommandResult::done())
}

/// Compares elastic gears with full finite elements and writes a table.
fn reduce(context: &Context, args: &arguments::Reduction) -> Result<CommandResult, Refusal> {
    let set = sampling::set(&args.set).map_err(refuse_sample)?;
    let [first, last] = args.scenes.unwrap_or([1, set.scenes]);
    // A killed campaign continues with the same command.
    let kept = args.out.with_extension(JOURNAL);
    let subject = Subject {
        study: "validation".into(),
        scene: args.set.clone(),
        models: None,
    };
    let journal =
        Journal::open(&kept, &subject, false).map_err(|e| Refusal::Files(e.to_string()))?;
    let runner = Arc::new(Runner::new(context.clone(), journal, &silent));
    let mut rows = Vec::new();
    for number in first..=last {
        let row = reduction::compare(&set, number, args.mesh_ratio, &runner).map_err(refuse)?;
        let Some(row) = row else { continue };
        context.messages.print_line(&format!(
            "{}: {}, {}, force {}",
            row.scene,
            row.kind,
            row.status.join(", "),
            row.error
                .map(|e| e.map_or_else(|| "-".into(), |e| format!("{:.3} %", 100.0 * e)))
                .join(", ")
        ));
        rows.push(row);
        // Finished results are kept when the rest is stopped.
        std::fs::write(&args.out, reduction::csv(&rows))
            .map_err(|e| Refusal::Files(format!("{}: {e}", args.out.display())))?;
    }
    std::fs::remove_file(&kept).map_err(|e| Refusal::Files(format!("{}: {e}", kept.display())))?;
    let ended = rows.iter().filter(|r| r.ended()).count();
    let within = rows.iter().filter(|r| r.is_within()).count();
    context.messages.print_line(&format!(
        "{} scenes (seed {}): {ended} ended both ways, {within} within {} % in force and {} % in transmission error",
        rows.len(),
        set.seed,
        100.0 * reduction::LIMIT,
        100.0 * reduction::LIMIT_OF_TRANSMISSION_ERROR
    ));
    let enough = within as f64 >= ASKED.0 * rows.len() as f64 && ended == rows.len();
    Ok(CommandResult::done().ending(if enough { Exit::Done } else { Exit::FellShort }))
}

/// Checks the coverage of intervals on synthetic data and writes a table.
fn cover(context: &Context, args: &arguments::Coverage) -> Result<CommandResult, Refusal> {
    let plan = coverage::Plan {
        scene: args.scene.clone(),
        model: args.model.clone(),
        sets: args.sets as usize,
        seed: args.seed,
    };
    let display = Display::new(plan.sets);
    let rows = coverage::check(&plan, |done| {
        display.report_progress(done, plan.sets, "fitted")
    });
    drop(display);
    let rows = rows.map_err(refuse)?;
    write_to(&args.out, &coverage::csv(&plan, &rows))?;
    let found = coverage::coverage(&rows);
    for (key, part, open) in &found {
        context.messages.print_line(&format!(
            "{key}: the 95 % interval contains the true value in {:.1} % of {} sets; {open} times not identifiable",
            100.0 * part,
            plan.sets
        ));
    }
    let [low, high] = COVERAGE;
    let good = found.iter().all(|(_, part, _)| (low..=high).contains(part));
    Ok(CommandResult::done().ending(if good { Exit::Done } else { Exit::FellShort }))
}

/// Fits models to full finite elements, compares them with these at other speeds, and writes the tables.
fn carry(
    context: &Context,
    args: &arguments::Identification,
    command: &str,
) -> Result<CommandResult, Refusal> {
    let kept = args.out.with_extension(JOURNAL);
    let subject = Subject {
        study: "validation".into(),
        scene: "identification".into(),
        models: None,
    };
    let journal =
        Journal::open(&kept, &subject, false).map_err(|e| Refusal::Files(e.to_string()))?;
    let runner = Runner::new(context.clone(), journal, &silent);
    let mut all = Vec::new();
    for scene in &args.scenes {
        all.push(
            identification::carry(scene, &runner, &|line| context.messages.print_line(line))
                .map_err(refuse)?,
        );
    }
    let text = identification::markdown(&all, command);
    context.messages.print_text(&text);
    write_to(&args.out, &text)?;
    std::fs::remove_file(&kept).map_err(|e| Refusal::Files(format!("{}: {e}", kept.display())))?;
    let movable = |f: &&identification::FittedModel| !f.name.starts_with("rigid");
    let good = (all.iter()).all(|c| {
        c.fits
            .iter()
            .filter(movable)
            .any(identification::is_within_bars)
    });
    Ok(CommandResult::done().ending(if good { Exit::Done } else { Exit::FellShort }))
}

fn write_to(path: &std::path::Path, text: &str) -> Result<(), Refusal> {
    std::fs::write(path, text).map_err(|e| Refusal::Files(format!("{}: {e}", path.display())))
}

/// Validates choices on a set of random scenes and writes the results.
fn validate(
    context: &Context,
    args: &arguments::Run,
    command: &str,
) -> Result<CommandResult, Refusal> {
    let name = args.set.as_str();
    let mut set = sampling::set(name).map_err(refuse_sample)?;
    set.full_order = args.full_order.unwrap_or(set.full_order);
    let scenes = match &args.scenes {
        Some(some) => some.0.clone(),
        None => (1..=set.scenes).collect(),
    };
    if let Some(number) = scenes.iter().find(|n| **n > set.scenes) {
        return Err(refuse_sample(SampleError::Number {
            number: *number,
            last: set.scenes,
            set: set.name,
        }));
    }
    let output = Output {
        out: args.out.clone(),
        fresh: args.fresh,
        ..Output::default()
    };
    let mut folder = StudyFolder::open(&Context::default(), &output, name, choices::NAME)?;
    let runner = folder.runner(&silent);
    let plan = Plan {
        set: set.clone(),
        scenes: scenes.clone(),
        threads: args.threads as usize,
    };
    let total = scenes.len();
    let display = Display::new(total);
    let choices = check(&plan, &runner, |row, done| {
        display.report_progress(done, total, &format!("{}: {}", row.scene, row.outcome));
    });
    drop(display);
    let rows = choices.map_err(refuse)?;
    let rejected: u32 = rows.iter().map(|c| c.rejected).sum();
    let results = Results {
        header: machine::header(
            name,
            &format!("Model choice on random scenes: {name}"),
            command,
        ),
        part: Part::Tabular(choices::table(&rows)),
        settings: vec![
            ("seed".into(), set.seed.to_string()),
            ("scenes".into(), in_words(&scenes)),
            (
                "against full finite elements as well".into(),
                format!(
                    "the first {} scenes of one impact without damping",
                    set.full_order
                ),
            ),
            (
                "validated at the same time".into(),
                args.threads.to_string(),
            ),
            ("rejected, because not sound".into(), rejected.to_string()),
        ],
        ..Results::default()
    };
    let all: Vec<&ValidatedChoice> = rows.iter().collect();
    let answer = folder.finish(
        results,
        |_| exit(&all),
        |messages, _| summarise(messages, &rows),
    )?;
    let path = folder.path().join("candidates.csv");
    std::fs::write(&path, candidates_csv(&rows))
        .map_err(|e| Refusal::Files(format!("{}: {e}", path.display())))?;
    context
        .messages
        .print_line(&format!("candidates: {}", path.display()));
    Ok(answer)
}

/// Numbers in the form of the command line, `1..5, 18`.
fn in_words(ascending: &[usize]) -> String {
    let spans = ascending.chunk_by(|a, b| a + 1 == *b);
    let span = |of: &[usize]| match of {
        [first, .., last] => format!("{first}..{last}"),
        _ => of.iter().map(usize::to_string).collect(),
    };
    spans.map(span).collect::<Vec<_>>().join(", ")
}

fn exit(all: &[&ValidatedChoice]) -> Exit {
    let s = share("all", all);
    let met = s.met as f64 >= ASKED.0 * s.scenes as f64;
    let cheap = s.cost_ratio[1].is_none_or(|r| r <= ASKED.1);
    if met && cheap {
        Exit::Done
    } else {
        Exit::FellShort
    }
}

fn summarise(messages: &Messages, all: &[ValidatedChoice]) {
    for s in shares(all) {
        let number = |x: Option<f64>| x.map_or_else(|| "-".into(), |x| format!("{x:.2}"));
        messages.print_line(&format!(
            "{:24} {:3} scenes  met {:3} ({} rightly none)  cost ratio {} (90 % below {})  predicted/true error {}",
            s.name,
            s.scenes,
            s.met,
            s.rightly_none,
            number(s.cost_ratio[1]),
            number(s.cost_ratio[3]),
            number(s.prediction[1])
        ));
    }
    for row in all.iter().filter(|r| !r.outcome.is_met()) {
        messages.print_line(&format!(
            "{}: {}, {} {} to {} %: {} [{}]",
            row.scene,
            row.outcome,
            row.kind,
            row.metric,
            100.0 * row.tolerance,
            row.why_missed(),
            row.chosen.as_deref().unwrap_or("none")
        ));
    }
    let unvalidated = all
        .iter()
        .filter(|r| r.outcome == Outcome::NotValidated)
        .count();
    if unvalidated > 0 {
        messages.print_line(&format!("{unvalidated} scenes could not be validated"));
    }
}

/// All candidates of all scenes as CSV.
fn candidates_csv(rows: &[ValidatedChoice]) -> String {
    let mut out = String::from("scene,metric,tolerance,candidate,status,error,cost_s\n");
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.6e}"));
    for row in rows {
        for t in &row.tried {
            let quoted = |text: &str| format!("\"{}\"", text.replace('"', "'"));
            // Writing to a string cannot fail.
            let _ = writeln!(
                out,
                "{},{},{},{},{},{},{}",
                row.scene,
                row.metric,
                row.tolerance,
                quoted(&t.name),
                quoted(&t.status),
                number(t.error),
                number(t.cost_s)
            );
        }
    }
    out
}
