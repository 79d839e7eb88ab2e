//! Arguments of `check`.

use crate::cli::arguments::Output;
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench init check                       check.toml, and a workflow that runs it
  gearbench check check.toml --update        store the baseline in check.baseline.jsonl, a file to commit
  gearbench check check.toml                 exit code 0 if all values are within tolerance, else 1
  gearbench check check.toml --quick         skip the cases that are marked slow
  gearbench check check.toml --history peak_force_n

Results have to agree with the baseline within tolerances, counts of work (steps, Newton iterations, ...) exactly. The
runtime is the processor time of one integration divided by that of a fixed kernel that is timed with it, so that
other work on the machine has little influence. The folder contains index.html, summary.md for a pull request and
junit.xml for a CI server. `gearbench help scene` describes check files.";

/// Arguments of `check`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Check {
    /// Check file (.toml)
    #[arg(value_name = "FILE", default_value = "check.toml")]
    pub file: PathBuf,
    /// Names of the cases to run, separated by commas [default: all]
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    pub cases: Vec<String>,
    /// Skip the cases that are marked slow
    #[arg(long)]
    pub quick: bool,
    /// Store the measured values as the new baseline and report the changes
    #[arg(long)]
    pub update: bool,
    /// Do not measure runtimes
    #[arg(long)]
    pub no_runtime: bool,
    /// Plot a quantity over the stored baselines, without any run
    #[arg(long, value_name = "QUANTITY", conflicts_with_all = ["update", "quick"], num_args = 0..=1, default_missing_value = "runtime")]
    pub history: Option<String>,
    /// Where results go.
    #[command(flatten)]
    pub output: Output,
}
