//! The command line: the table of commands, messages, files and exit codes. What the commands do is the business of
//! studies and tools.

pub mod answer;
pub mod arguments;
pub mod exit;
pub(crate) mod files;
pub mod help;
pub mod progress;
mod refusal;
pub mod study_folder;
pub mod terminal;
pub(crate) mod values;

use crate::fmu::{self, arguments::Fmu};
use crate::studies::check::{self, arguments::Check};
use crate::studies::choose::{self, arguments::Choose};
use crate::studies::compare::{self, arguments::Compare};
use crate::studies::coupling::{self, arguments::Coupling};
use crate::studies::identify::{self, arguments::Identify};
use crate::studies::modes::{self, arguments::Modes};
use crate::studies::penalty::{self, arguments::Penalty};
use crate::studies::precision::{self, arguments::Precision};
use crate::studies::response::{self, arguments::Response};
use crate::studies::run_up::{self, arguments::RunUp};
use crate::studies::stability::{self, arguments::Stability};
use crate::studies::stiffness::{self, arguments::Stiffness};
use crate::studies::sweep::{self, arguments::Sweep};
use crate::studies::truncation::{self, arguments::Truncation};
use crate::tools::completions::{self, Completions};
use crate::tools::mesh::{self, arguments::Mesh};
use crate::tools::reduce::{self, arguments::Reduce};
use crate::tools::reference::{self, arguments::Reference};
use crate::tools::rerun::{self, Rerun};
use crate::tools::{init, init::Init, list, list::List, report, report::Report};
use answer::Answer;
use clap::{Parser, Subcommand};
use exit::Exit;
use gearbench_reference::limits;
use help::Help;
use std::process::ExitCode;
use terminal::{Manner, Refusal};
use values::{DEFAULT_MEMORY, gigabytes};

/// What stands at the end of `--help`.
fn after_help() -> String {
    format!(
        "{EXAMPLES}\n\nExit codes:\n{}\n{}",
        Exit::table(),
        Exit::RULE
    )
}

const EXAMPLES: &str = "\
Examples:
  gearbench                                    the default comparison, the same as
  gearbench compare spur_impact
  gearbench compare hammer --models rigid      one model of a shipped scene
  gearbench compare my_scene.toml --out out/a  a scene of your own
  gearbench init                               a commented scene to start from
  gearbench reference my_scene.toml --model fe --out fe.csv --add
  gearbench init own_gears                     gears of other programs and data from a file
  gearbench list                               scenes, models, integrators, references

Results (--out DIR, default out/SCENE/STUDY/, printed at the end):
  index.html    the report, self-contained, opens offline
  results.json  versioned records of all runs, failed ones included
  *.csv         time series, SI units in the header
  *.svg         the charts

`gearbench help scene` describes scene files, `gearbench help limits` what gearbench does not do.";

/// Version and commit.
const VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    " (commit ",
    env!("GEARBENCH_COMMIT"),
    ")"
);

/// Which gear-contact model and which integrator is just good enough for a scene, and what does it cost?
///
/// gearbench simulates one scene under several gear models and integrators, measures every run against a
/// finite-element reference and against the model's own converged solution, times it, keeps an energy and
/// an impulse ledger, and writes one report. Without a command it compares the scene spur_impact.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "gearbench",
    version = VERSION,
    help_template = help::template(),
    after_help = after_help(),
    disable_help_subcommand = true,
    max_term_width = 100
)]
pub struct Cli {
    /// What to do; left out, `compare spur_impact`.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// Answer with one JSON object on standard output (a refusal: on standard error) in place of lines for people
    #[arg(long, global = true, conflicts_with = "quiet")]
    json: bool,
    /// Print nothing but warnings and errors
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Refuse what would take more memory than this [GB]
    #[arg(long, global = true, value_name = "GB", default_value_t = DEFAULT_MEMORY, value_parser = gigabytes)]
    memory: f64,
}

/// The commands.
#[derive(Clone, Debug, Subcommand)]
pub(crate) enum Command {
    /// Write a commented scene to start from: a pair, a rack, a train, or a shipped one
    Init(Init),
    /// Compare the models and integrators of a scene, against its reference
    Compare(Compare),
    /// Error against cost of every model, integrator and resolution of a scene, with its Pareto front
    Precision(Precision),
    /// Where methods fail: maps over step size and stiffness, damping, speed or modes, with theory beside
    Stability(Stability),
    /// The cheapest model, integrator and step that keep a tolerance on a scene, and why
    Choose(Choose),
    /// Fit stiffness, tooth mass and touch time of the models to the scene's reference
    Identify(Identify),
    /// Static mesh stiffness, load sharing and transmission error of the models of a scene
    Stiffness(Stiffness),
    /// Error of the elastic model by number of modes, against full finite elements on the same mesh
    Truncation(Truncation),
    /// Natural frequencies and shapes of the whole scene about its loaded state
    Modes(Modes),
    /// Frequency response to the passing of teeth: transmission error and forces of mounts, without running
    Response(Response),
    /// Results over the penalty of the contact, beside hard contact
    Penalty(Penalty),
    /// Run under load at speed after speed: transmission error, bearing forces, spectra, resonances
    Sweep(Sweep),
    /// Gears as a sub-system whose hubs a host moves: error, energy and stability over the communication step
    Coupling(Coupling),
    /// Run from one speed to another: spectra and orders over the speed, resonances
    RunUp(RunUp),
    /// Hold results, work and runtime of chosen runs against a stored baseline, for CI
    Check(Check),
    /// Mesh the gears of a scene with hexahedra, as a deck for CalculiX or Abaqus and for ParaView
    Mesh(Mesh),
    /// Reduce gears of a deck or a scene to modes and static compliance, stored for the elastic model and for numpy
    Reduce(Reduce),
    /// Run a model as a reference for others: a CSV file, and the lines of the scene that name it
    Reference(Reference),
    /// Pack a model of a scene as an FMU (FMI 3.0) for co-simulation and model exchange
    Fmu(Fmu),
    /// List shipped scenes, gear models with their parameters, integrators and references
    List(List),
    /// Help on a command, or a document: scene, limits, data, fmus
    Help(Help),
    /// Write the report of a results folder again
    Report(Report),
    /// Make a study again from its record, and hold it against that
    Rerun(Rerun),
    /// Print a script that completes commands and options in a shell
    Completions(Completions),
}

impl Command {
    /// Does it; records say that it was `told` so.
    fn run(self, told: &str) -> Result<Answer, Refusal> {
        match self {
            Command::Init(args) => init::run(&args),
            Command::Compare(args) => compare::command::run(&args, told),
            Command::Precision(args) => precision::command::run(&args, told),
            Command::Stability(args) => stability::command::run(&args, told),
            Command::Choose(args) => choose::command::run(&args, told),
            Command::Identify(args) => identify::command::run(&args, told),
            Command::Stiffness(args) => stiffness::command::run(&args, told),
            Command::Truncation(args) => truncation::command::run(&args, told),
            Command::Modes(args) => modes::command::run(&args, told),
            Command::Response(args) => response::command::run(&args, told),
            Command::Penalty(args) => penalty::command::run(&args, told),
            Command::Sweep(args) => sweep::command::run(&args, told),
            Command::Coupling(args) => coupling::command::run(&args, told),
            Command::RunUp(args) => run_up::command::run(&args, told),
            Command::Check(args) => check::command::run(&args, told),
            Command::Mesh(args) => mesh::run(&args, told),
            Command::Reduce(args) => reduce::run(&args),
            Command::Reference(args) => reference::run(&args, told),
            Command::Fmu(args) => fmu::command::run(&args),
            Command::List(args) => list::run(&args),
            Command::Help(args) => help::run(&args),
            Command::Report(args) => report::run(&args),
            Command::Rerun(args) => again(&args),
            Command::Completions(args) => completions::run(&args),
        }
    }
}

/// Reads the command line, does what it says, and says how that ended.
pub fn main() -> ExitCode {
    match Cli::try_parse() {
        Ok(cli) => run(cli),
        Err(e) => refuse(&e),
    }
}

/// Runs the command and says how it ended.
pub fn run(cli: Cli) -> ExitCode {
    terminal::choose(match (cli.json, cli.quiet) {
        (true, _) => Manner::Json,
        (_, true) => Manner::Quiet,
        _ => Manner::Lines,
    });
    // Before anything is read or built: estimates are compared with it from the first file on.
    limits::set_memory(cli.memory * 1e9);
    let told = terminal::told("gearbench");
    let done = match cli.command {
        None => Command::Compare(Compare::default()).run("gearbench"),
        Some(command) => command.run(&told),
    };
    terminal::end(&told, done)
}

/// Makes a study again from its record.
fn again(args: &Rerun) -> Result<Answer, Refusal> {
    let again = rerun::prepare(args)?;
    let words = std::iter::once("gearbench").chain(again.words.iter().map(String::as_str));
    let command = Cli::try_parse_from(words).ok().and_then(|cli| cli.command);
    let Some(command) = command else {
        return Err(Refusal::Input(miette::miette!(
            help = "a record of another version may have a command that is called otherwise now",
            "the command of the record, `{}`, is none that can be made again",
            again.command()
        )));
    };
    let answer = command.run(again.command())?;
    again.compare(answer)
}

/// Shows the help that was asked for, or what is wrong with the arguments, in the form of all refusals.
fn refuse(e: &clap::Error) -> ExitCode {
    if !e.use_stderr() {
        terminal::put(e.render().to_string().trim_end());
        return terminal::end("", Ok(Answer::done()));
    }
    if std::env::args_os().any(|a| a == "--json") {
        terminal::choose(Manner::Json);
    }
    let text = e.render().to_string();
    let mut parts = text.split("\n\n").map(str::trim).filter(|p| !p.is_empty());
    let message = parts.next().unwrap_or_default();
    let message = message.strip_prefix("error: ").unwrap_or(message);
    let help: Vec<&str> = parts.collect();
    let report = miette::miette!(help = help.join("\n"), "{message}");
    terminal::end(&terminal::told("gearbench"), Err(Refusal::Input(report)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn parse(arguments: &str) -> Result<Cli, clap::Error> {
        Cli::try_parse_from(arguments.split_whitespace())
    }

    fn compare(arguments: &str) -> Compare {
        match parse(arguments).unwrap().command {
            Some(Command::Compare(c)) => c,
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
