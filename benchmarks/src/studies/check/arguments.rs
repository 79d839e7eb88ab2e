//! Arguments of `check`.

use crate::cli::arguments::Output;
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench init check                       check.toml, and a workflow that runs it
  gearbench check check.toml --update        store the baseline: check.baseline.jsonl beside it, to be committed
  gearbench check check.toml                 exit code 0 when everything holds, 1 when something moved
  gearbench check check.toml --quick         without the cases that are marked slow
  gearbench check check.toml --history peak_force_n

Results are held within tolerances, counts of work (steps, Newton iterations, ...) exactly; runtime is the processor time of
one integration over that of a fixed kernel timed beside it, so that a busy machine does not count. The folder has index.html,
summary.md for a pull request and junit.xml for a CI server. `gearbench help scene` describes check files.";

/// Arguments of `check`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Check {
    /// The file that says what is checked (.toml)
    #[arg(value_name = "FILE", default_value = "check.toml")]
    pub file: PathBuf,
    /// Only these cases, by name between commas
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    pub cases: Vec<String>,
    /// Leave out the cases that are marked slow
    #[arg(long)]
    pub quick: bool,
    /// Store what was measured as the new baseline, and say what moved
    #[arg(long)]
    pub update: bool,
    /// Do not measure runtimes
    #[arg(long)]
    pub no_runtime: bool,
    /// Draw a quantity over the stored baselines, and run nothing
    #[arg(long, value_name = "QUANTITY", conflicts_with_all = ["update", "quick"], num_args = 0..=1, default_missing_value = "runtime")]
    pub history: Option<String>,
    /// Where results go.
    #[command(flatten)]
    pub output: Output,
}
