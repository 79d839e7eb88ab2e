//! Arguments that several commands take.

use super::values::{DEFAULT_BUDGET, DEFAULT_REPEATS, DEFAULT_TIMEOUT, positive};
use crate::experiment::budget::Budget;
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

/// Where results go.
#[derive(Args, Clone, Debug, Default)]
pub struct Output {
    /// Folder to write to [default: out/SCENE/STUDY]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// CSV file of measured curves, which the report draws with the curves of the study
    ///
    /// Columns have the names of the tables of the study. The first column of numbers is the abscissa, every further
    /// one is a curve, for example `mesh_frequency [kHz], transmission_error_rms [um]` for `sweep` and `response`.
    /// `gearbench help data` lists all columns.
    #[arg(long, value_name = "FILE")]
    pub measured: Vec<PathBuf>,
    /// Repeat all runs, including those that an interrupted study has finished
    #[arg(long)]
    pub fresh: bool,
    /// Replace the results of another study, scene or choice of models in the folder, or files of another program
    #[arg(long)]
    pub force: bool,
    /// The choice of models on the command line, which distinguishes two studies of one scene.
    #[arg(skip)]
    pub models: Option<String>,
}

/// How long a whole study may take that tries one thing after the other.
#[derive(Args, Clone, Copy, Debug)]
pub struct BudgetedOutput {
    /// Limit on the processor time of the whole study in seconds; runs that were not made within it are listed
    ///
    /// The limit includes all threads and the set-up. The result is based on the runs that were made.
    #[arg(long, value_name = "S", default_value_t = DEFAULT_BUDGET, value_parser = positive)]
    pub budget: f64,
}

impl BudgetedOutput {
    /// The bound, from now on.
    pub fn budget(&self) -> Budget {
        Budget::new(Duration::from_secs_f64(self.budget))
    }
}

/// Where results go, and how long a run may take.
#[derive(Args, Clone, Debug)]
pub struct BoundedOutput {
    /// Where results go.
    #[command(flatten)]
    pub output: Output,
    /// Limit on the processor time of one run in seconds; a run whose progress is far too slow for it ends early
    ///
    /// The limit counts the integration and the recording of its histories, but not the set-up of the model and other
    /// work of the machine.
    #[arg(long, value_name = "S", default_value_t = DEFAULT_TIMEOUT, value_parser = positive)]
    pub timeout: f64,
}

impl BoundedOutput {
    /// Bound of one run.
    pub fn timeout(&self) -> Duration {
        Duration::from_secs_f64(self.timeout)
    }
}

impl Default for BoundedOutput {
    fn default() -> Self {
        BoundedOutput {
            output: Output::default(),
            timeout: DEFAULT_TIMEOUT,
        }
    }
}

/// The same of a study whose runs are timed.
#[derive(Args, Clone, Debug)]
pub struct TimedOutput {
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub bounded: BoundedOutput,
    /// Number of timed repetitions of each run; the report shows their median and spread
    #[arg(long, value_name = "N", default_value_t = DEFAULT_REPEATS, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeats: u32,
}

impl Default for TimedOutput {
    fn default() -> Self {
        TimedOutput {
            bounded: BoundedOutput::default(),
            repeats: DEFAULT_REPEATS,
        }
    }
}

/// Whether a reference of other gears will do.
#[derive(Args, Clone, Debug, Default)]
pub struct AnyReference {
    /// Use the scene's reference even if it belongs to other gears, speeds or loads; the report states this
    #[arg(long)]
    pub any_reference: bool,
}
