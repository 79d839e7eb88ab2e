//! The command line: table of commands, messages, files and exit codes. The modules of studies and tools implement the
//! commands.

pub mod arguments;
pub mod command_line;
pub mod command_result;
#[cfg(test)]
mod document_commands;
#[cfg(test)]
mod documents_tests;
pub mod exit;
pub(crate) mod files;
pub(crate) mod folder_lock;
pub mod help;
mod measured;
pub mod progress;
mod refusal;
pub(crate) mod study_command;
pub mod study_folder;
pub mod terminal;
pub(crate) mod values;

use crate::context::Context;
use crate::experiment::machine;
use crate::fmu::{self, arguments::Fmu};
use crate::messages::OutputForm;
use crate::rexs::{
    self,
    arguments::{ExportArguments, ImportArguments},
};
use crate::studies::scan::{
    arguments::{Merge, Scan},
    merge,
};
use crate::tools::completions::{self, Completions};
use crate::tools::man::{self, Man};
use crate::tools::mesh::{self, arguments::Mesh};
use crate::tools::reduce::{self, arguments::Reduce};
use crate::tools::reference::{self, arguments::Reference};
use crate::tools::rerun::{self, Rerun};
use crate::tools::{init, init::Init, list, list::List, report, report::Report, view, view::View};
use clap::error::ErrorKind;
use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};
use command_result::CommandResult;
use exit::Exit;
use gearbench_reference::limits::Memory;
use gearbench_reports::scan::ScanIdentity;
use help::Help;
use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::OnceLock;
use study_command::StudyCommand;
use terminal::Refusal;
use values::{DEFAULT_MEMORY, gigabytes};

/// The text after the options of `--help`: examples and exit codes.
fn after_help() -> String {
    format!(
        "{EXAMPLES}\n\nExit codes:\n{}\n{}",
        Exit::table(),
        Exit::RULE
    )
}

const EXAMPLES: &str = "\
Examples:
  gearbench                                    the default comparison, equal to the next line
  gearbench compare spur_impact
  gearbench compare hammer --models rigid      one model of a shipped scene
  gearbench compare my_scene.toml --out out/a  a scene of your own
  gearbench init                               a commented scene as a starting point
  gearbench reference my_scene.toml --model fe --out fe.csv --add
  gearbench init own_gears                     an example with gears of other programs and data from a file
  gearbench list                               scenes, models, integrators, references

Results (--out DIR, default out/SCENE/STUDY/, printed at the end):
  index.html    the report, self-contained, opens offline
  results.json  versioned records of all runs, failed ones included
  *.csv         time series, SI units in the header
  *.svg         the charts

`gearbench help scene` describes scene files, `gearbench help limits` what gearbench does not do.";

/// The version with the commit of the program, as `--version` prints it.
fn version() -> &'static str {
    static VERSION: OnceLock<String> = OnceLock::new();
    VERSION.get_or_init(|| {
        format!(
            "{} (commit {})",
            env!("CARGO_PKG_VERSION"),
            machine::commit()
        )
    })
}

/// Which gear-contact model and which integrator are just accurate enough for a scene, and what do they cost?
///
/// gearbench simulates one scene with several gear models and integrators. It compares each run with a
/// finite-element reference and with the model's own converged solution, measures its processor time,
/// computes its balances of energy and impulse, and writes one report. Without a command it compares the
/// models of the scene spur_impact.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "gearbench",
    version = version(),
    help_template = help::template(),
    after_help = after_help(),
    disable_help_subcommand = true,
    max_term_width = 100
)]
pub struct Cli {
    /// Command to run; without one, `compare spur_impact`.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// Print one JSON object on standard output in place of text; for a refusal, on standard error
    #[arg(long, global = true, conflicts_with = "quiet")]
    json: bool,
    /// Print nothing but warnings and errors
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Largest memory that the command may use [GB]; work that needs more is refused
    #[arg(long, global = true, value_name = "GB", default_value_t = DEFAULT_MEMORY, value_parser = gigabytes)]
    memory: f64,
}

/// The commands.
#[derive(Clone, Debug, Subcommand)]
pub(crate) enum Command {
    /// Write a commented scene as a starting point: a pair, a rack, a train, or a shipped scene
    Init(Init),
    /// Run a study of a scene.
    #[command(flatten)]
    Study(StudyCommand),
    /// Mesh the gears of a scene with hexahedra, as a deck for CalculiX or Abaqus and for ParaView
    Mesh(Mesh),
    /// Reduce gears of a deck or a scene to modes and static compliance, stored for the elastic model and for numpy
    Reduce(Reduce),
    /// Run a model and store its results as a reference: a CSV file, and the lines that add it to the scene
    Reference(Reference),
    /// Pack a model of a scene as an FMU (FMI 3.0 or 2.0) for co-simulation and model exchange
    Fmu(Fmu),
    /// Read a gearbox of REXS (.rexs, .rexsj, .rexsz) and write it as a scene
    Import(ImportArguments),
    /// Write a scene as REXS, with its mesh stiffness
    Export(ExportArguments),
    /// List shipped scenes, gear models with their parameters, integrators, references and the contents of the cache
    List(List),
    /// Print help on a command, or a document: scene, limits, data, fmus, rexs
    Help(Help),
    /// Rewrite the report of a results folder
    Report(Report),
    /// Open the report of a result in a browser, or a gallery of all results in a folder
    View(View),
    /// Join the parts of a scan that were run with --shard
    Merge(Merge),
    /// Repeat a study from its record and compare the results
    Rerun(Rerun),
    /// Print a script that completes commands and options in a shell
    Completions(Completions),
    /// Print the manual page, or write those of all commands
    Man(Man),
}

impl Command {
    /// Runs the command; records store the command line `command_line`.
    fn run(self, context: &Context, told: &str) -> Result<CommandResult, Refusal> {
        match self {
            Command::Init(args) => init::run(context, &args),
            Command::Study(study) => study.run(context, told),
            Command::Mesh(args) => mesh::run(context, &args, told),
            Command::Reduce(args) => reduce::run(context, &args),
            Command::Reference(args) => reference::run(context, &args, told),
            Command::Fmu(args) => fmu::command::run(context, &args),
            Command::Import(args) => rexs::command::import(context, &args),
            Command::Export(args) => rexs::command::export(context, &args),
            Command::List(args) => list::run(context, &args),
            Command::Help(args) => help::run(context, &args),
            Command::Report(args) => report::run(context, &args),
            Command::View(args) => view::run(context, &args),
            Command::Merge(args) => merge::run(context, &args),
            Command::Rerun(args) => again(context, &args),
            Command::Completions(args) => completions::run(context, &args),
            Command::Man(args) => man::run(context, &args),
        }
    }
}

/// Parses the command line, runs the command in a context and returns its exit code.
pub fn main(context: Context) -> ExitCode {
    if let Err(e) = context.interruption.catch_signals() {
        context
            .messages
            .warn(&format!("signals cannot be caught: {e}"));
    }
    match Cli::read(std::env::args_os()) {
        Ok(cli) => run(context, cli),
        Err(e) => refuse(context, &e),
    }
}

impl Cli {
    /// Parses the words of a command line, beginning with the program.
    ///
    /// # Errors
    /// The error names the wrong argument, or contains the requested help text.
    fn read(
        words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
    ) -> Result<Self, clap::Error> {
        let matches = Cli::command().try_get_matches_from(words)?;
        let mut cli = Cli::from_arg_matches(&matches)?;
        if let (Some(Command::Study(study)), Some((_, given))) =
            (&mut cli.command, matches.subcommand())
        {
            study.output().models = models(given);
        }
        Ok(cli)
    }
}

/// The labels of models that a command line selects, separated by commas.
fn models(given: &ArgMatches) -> Option<String> {
    let text = |id| given.try_get_one::<String>(id).ok().flatten().cloned();
    text("models").or_else(|| text("model"))
}

/// The selected models in the command line of a record; `None` if the line is not that of a study.
fn models_of(command_line: &str) -> Option<Option<String>> {
    let words = std::iter::once("gearbench".to_owned()).chain(command_line::split(command_line));
    match Cli::read(words).ok()?.command {
        Some(Command::Study(mut study)) => Some(study.output().models.clone()),
        None => Some(None),
        _ => None,
    }
}

/// The command of a whole scan, and its arguments, from the command of a part of it; `None` if it is not readable.
pub(crate) fn whole_scan(of_part: &str) -> Option<(String, Scan)> {
    let mut words = command_line::split(of_part);
    for option in ["--shard", "--out"] {
        let with_value = |w: &String| {
            w.strip_prefix(option)
                .is_some_and(|rest| rest.starts_with('='))
        };
        words.retain(|w| !with_value(w));
        if let Some(i) = words.iter().position(|w| w == option) {
            words.drain(i..(i + 2).min(words.len()));
        }
    }
    let all = std::iter::once("gearbench".to_owned()).chain(words.iter().cloned());
    match Cli::read(all).ok()?.command? {
        Command::Study(StudyCommand::Scan(args)) => {
            Some((command_line::join("gearbench", &words), *args))
        }
        _ => None,
    }
}

/// An argument of a study, as its command declares it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArgumentDescription {
    /// Name of the option without dashes, or of the positional argument.
    pub name: String,
    /// Meaning of the argument.
    pub help: String,
    /// Default value as text; empty if there is none.
    pub default: String,
    /// Kind of its values.
    pub kind: ArgumentKind,
    /// True if the argument is a position and not an option.
    pub is_positional: bool,
    /// True if the option can be given several times.
    pub is_repeated: bool,
}

/// Kind of the values of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArgumentKind {
    /// An option without value.
    Flag,
    /// A whole number.
    Whole,
    /// A number.
    Number,
    /// A text, or a value that is written as one.
    Text,
}

/// A study, as its command declares it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudyDescription {
    /// Name of the command.
    pub name: String,
    /// Purpose of the study.
    pub about: String,
    /// Its arguments, with those of all commands.
    pub arguments: Vec<ArgumentDescription>,
}

/// Commands besides the studies that a program runs by [`study`]: they write files, and return what they have found.
const FILE_COMMANDS: [&str; 6] = ["reduce", "mesh", "reference", "fmu", "import", "export"];

/// Returns the descriptions of all studies, and of the commands that write files of gears and models.
#[must_use]
pub fn studies() -> Vec<StudyDescription> {
    let command = Cli::command();
    let global: Vec<&clap::Arg> = (command.get_arguments())
        .filter(|a| a.get_id() == "memory")
        .collect();
    let names = StudyCommand::GROUPS.iter().map(|(name, _)| *name);
    (names.chain(FILE_COMMANDS))
        .filter_map(|name| command.find_subcommand(name))
        .map(|study| StudyDescription {
            name: study.get_name().to_owned(),
            about: text_of(study.get_about()),
            arguments: (study.get_arguments().chain(global.iter().copied()))
                .filter(|a| !["help", "version"].contains(&a.get_id().as_str()))
                .map(ArgumentDescription::of)
                .collect(),
        })
        .collect()
}

fn text_of(text: Option<&clap::builder::StyledStr>) -> String {
    text.map(ToString::to_string).unwrap_or_default()
}

impl ArgumentDescription {
    fn of(argument: &clap::Arg) -> Self {
        use clap::ArgAction;
        use std::any::TypeId;
        let values = argument.get_value_parser().type_id();
        let is = |types: &[TypeId]| types.iter().any(|t| values == *t);
        let whole = [
            TypeId::of::<u32>(),
            TypeId::of::<u64>(),
            TypeId::of::<usize>(),
        ];
        let kind = match argument.get_action() {
            ArgAction::SetTrue | ArgAction::SetFalse => ArgumentKind::Flag,
            _ if is(&whole) => ArgumentKind::Whole,
            _ if is(&[TypeId::of::<f64>()]) => ArgumentKind::Number,
            _ => ArgumentKind::Text,
        };
        let defaults = argument.get_default_values().iter();
        let defaults: Vec<_> = defaults.map(|d| d.to_string_lossy()).collect();
        ArgumentDescription {
            name: argument
                .get_long()
                .map_or_else(|| argument.get_id().to_string(), str::to_owned),
            help: text_of(argument.get_help()),
            default: match kind {
                ArgumentKind::Flag => String::new(),
                _ => defaults.join(","),
            },
            kind,
            is_positional: argument.is_positional(),
            is_repeated: matches!(argument.get_action(), ArgAction::Append)
                && argument.get_value_delimiter().is_none(),
        }
    }
}

/// Runs a study, joins the parts of a scan, or runs a command that writes files of gears and models, from the words of the
/// command line, without the program, in a context; the record stores the command.
/// A program has the record [returned](crate::context::RecordUse::Returned).
///
/// # Errors
/// A refusal of an argument or of the scene, or the failure of the study, as the command reports it.
pub fn study(mut context: Context, words: &[String]) -> Result<CommandResult, Refusal> {
    let line = command_line::join("gearbench", words);
    let all = std::iter::once("gearbench".to_owned()).chain(words.iter().cloned());
    let cli = Cli::read(all).map_err(|e| refusal_of(&e))?;
    let command = match cli.command {
        Some(
            command @ (Command::Study(_)
            | Command::Merge(_)
            | Command::Reduce(_)
            | Command::Mesh(_)
            | Command::Reference(_)
            | Command::Fmu(_)
            | Command::Import(_)
            | Command::Export(_)),
        ) => command,
        _ => return Err(Refusal::Input(miette::miette!("`{line}` is no study"))),
    };
    context.resources.memory = Memory::of(cli.memory * 1e9);
    context.resources.within(|| command.run(&context, &line))
}

/// Returns what the cells of a scan are computed from, by the words of its command line, without running any.
///
/// # Errors
/// A refusal of an argument or of the scene.
pub fn scan_identity(context: &Context, words: &[String]) -> Result<ScanIdentity, Refusal> {
    let all = std::iter::once("gearbench".to_owned()).chain(words.iter().cloned());
    match Cli::read(all).map_err(|e| refusal_of(&e))?.command {
        Some(Command::Study(StudyCommand::Scan(scan))) => {
            (context.resources).within(|| crate::studies::scan::command::identity(context, &scan))
        }
        _ => Err(Refusal::Input(miette::miette!("this is no scan"))),
    }
}

/// Runs a command in a context and reports how it ended.
pub fn run(mut context: Context, cli: Cli) -> ExitCode {
    context.messages.form = match (cli.json, cli.quiet) {
        (true, _) => OutputForm::Json,
        (_, true) => OutputForm::Quiet,
        _ => OutputForm::Lines,
    };
    // Before anything is read or built: estimates are compared with it from the first file on.
    context.resources.memory = Memory::of(cli.memory * 1e9);
    let told = terminal::command_line("gearbench");
    let done = (context.resources).within(|| match cli.command {
        None => StudyCommand::default().run(&context, "gearbench"),
        Some(command) => command.run(&context, &told),
    });
    terminal::end(&context, &told, done)
}

/// Repeats a study from its record. As a record is external input, its command has to be the study of the record, and
/// all output of the study goes into the given folder.
fn again(context: &Context, args: &Rerun) -> Result<CommandResult, Refusal> {
    let again = rerun::prepare(context, args)?;
    let shown = again.command();
    let refuse = |help: String| {
        Refusal::Input(miette::miette!(
            help = help,
            "the command of the record, `{shown}`, cannot be repeated"
        ))
    };
    let words = std::iter::once("gearbench").chain(again.words.iter().map(String::as_str));
    let command = match Cli::read(words) {
        Ok(cli) => cli.command,
        Err(e) if e.kind() == ErrorKind::DisplayHelp || e.kind() == ErrorKind::DisplayVersion => {
            return Err(refuse("it prints help and runs no study".into()));
        }
        Err(_) => {
            return Err(refuse(
                "a record of another version may contain a command that has a different name now"
                    .into(),
            ));
        }
    };
    let study = match command {
        Some(Command::Study(study)) if again.names_its_study() => Some(study),
        _ => None,
    };
    let study = study.ok_or_else(|| {
        refuse(format!(
            "the record belongs to the study `{}`: only `gearbench {0} ..` repeats it",
            again.study()
        ))
    })?;
    let context = Context {
        rerun: again.sources.clone(),
        ..context.clone()
    };
    let answer = study.confined_to(again.out.clone()).run(&context, shown)?;
    again.compare(&context, answer)
}

/// Prints the requested help, or an error in the arguments in the form of all refusals.
fn refuse(mut context: Context, e: &clap::Error) -> ExitCode {
    if !e.use_stderr() {
        context
            .messages
            .print_text(e.render().to_string().trim_end());
        return terminal::end(&context, "", Ok(CommandResult::done()));
    }
    if std::env::args_os().any(|a| a == "--json") {
        context.messages.form = OutputForm::Json;
    }
    terminal::end(
        &context,
        &terminal::command_line("gearbench"),
        Err(refusal_of(e)),
    )
}

/// The refusal of wrong arguments.
fn refusal_of(e: &clap::Error) -> Refusal {
    let text = e.render().to_string();
    let mut parts = text.split("\n\n").map(str::trim).filter(|p| !p.is_empty());
    let message = parts.next().unwrap_or_default();
    let message = message.strip_prefix("error: ").unwrap_or(message);
    let help: Vec<&str> = parts.collect();
    Refusal::Input(miette::miette!(help = help.join("\n"), "{message}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::compare::arguments::Compare;

    fn parse(arguments: &str) -> Result<Cli, clap::Error> {
        Cli::read(arguments.split_whitespace())
    }

    fn compare(arguments: &str) -> Compare {
        match parse(arguments).unwrap().command {
            Some(Command::Study(StudyCommand::Compare(c))) => c,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn definitions_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn no_command_is_the_default_comparison() {
        assert!(parse("gearbench").unwrap().command.is_none());
        let (a, b) = (compare("gearbench compare"), Compare::default());
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }

    #[test]
    fn arguments() {
        let what = "hammer --models rigid --integrators rk4@1e-7,bdf";
        let c = compare(&format!(
            "gearbench compare {what} --out x --repeats 5 --no-events"
        ));
        let found = (c.scene.as_str(), c.models.as_deref());
        assert_eq!(found, ("hammer", Some("rigid")));
        assert_eq!((c.run.repeats, c.no_events), (5, true));
        let e = parse("gearbench compare --repeats 0").unwrap_err();
        assert_eq!(e.exit_code(), 2);
        let e = parse("gearbench comapre").unwrap_err().to_string();
        assert!(e.contains("compare"), "{e}");
    }

    /// A program has the record of a study with its histories, without a folder in the working directory.
    #[test]
    fn a_study_returns_its_record_and_reports_its_progress() {
        use crate::context::{ProgressObserver, RecordUse};
        use std::sync::{Arc, Mutex};
        let seen: Arc<Mutex<Vec<usize>>> = Arc::default();
        let own = seen.clone();
        let observer = move |done, _: usize, _: &str| own.lock().unwrap().push(done);
        let mut context = Context {
            record: RecordUse::Returned,
            progress: Some(ProgressObserver(Arc::new(observer))),
            ..Context::default()
        };
        context.messages.form = OutputForm::Json;
        let words = "compare hammer --models rigid --integrators dopri5@1e-5 --repeats 1";
        let words: Vec<String> = words.split(' ').map(str::to_owned).collect();
        let result = study(context.clone(), &words).unwrap();
        let record = result.record.unwrap();
        let histories = record.runs[0].histories.as_ref().unwrap();
        assert!(histories.series.is_some() || record.runs[0].series.is_some());
        assert!(result.exit == Exit::Done && !seen.lock().unwrap().is_empty());
        assert!(!std::path::Path::new("out/hammer").exists());
        let refused = study(context.clone(), &["compare".into(), "hamer".into()]);
        assert!(matches!(refused, Err(Refusal::Input(_))));
        assert!(study(context, &["list".into()]).is_err());
    }

    /// Programs offer the arguments of studies under their names, with the kinds of their values.
    #[test]
    fn studies_describe_their_arguments() {
        let all = studies();
        assert_eq!(all.len(), StudyCommand::GROUPS.len() + FILE_COMMANDS.len());
        let compare = all.iter().find(|s| s.name == "compare").unwrap();
        let kind = |name: &str| {
            let found = compare.arguments.iter().find(|a| a.name == name);
            found.map(|a| (a.kind, a.is_positional, a.default.as_str()))
        };
        assert_eq!(
            kind("scene"),
            Some((ArgumentKind::Text, true, "spur_impact"))
        );
        assert_eq!(kind("repeats"), Some((ArgumentKind::Whole, false, "3")));
        assert_eq!(kind("timeout"), Some((ArgumentKind::Number, false, "30")));
        assert_eq!(kind("no-events"), Some((ArgumentKind::Flag, false, "")));
        assert_eq!(kind("memory"), Some((ArgumentKind::Number, false, "2")));
        assert_eq!(kind("help"), None);
    }

    #[test]
    fn help_teaches() {
        let help = Cli::command().render_long_help().to_string();
        let words = "gearbench compare spur_impact|results.json|Exit codes|index.html|identify|mesh|\
                     Analyse:|Documents (gearbench help NAME)|--json";
        for word in words.split('|') {
            assert!(help.contains(word), "{word} is missing in\n{help}");
        }
    }
}
