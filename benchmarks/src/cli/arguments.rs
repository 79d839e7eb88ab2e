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
    /// Measured curves (CSV) to compare the tables of the study with: columns are called as in those tables
    ///
    /// The first column of numbers is the abscissa, every further one is a curve, for example `mesh_frequency [kHz],
    /// transmission_error_rms [um]` for `sweep` and `response`. The page draws them; docs/data.md has all columns.
    #[arg(long, value_name = "FILE")]
    pub measured: Vec<PathBuf>,
    /// Start over: do not go on with runs that an interrupted start has finished
    #[arg(long)]
    pub fresh: bool,
    /// Replace what the folder holds of another study, scene or choice of models, or of another program
    #[arg(long)]
    pub force: bool,
    /// The choice of models on the command line, which distinguishes two studies of one scene.
    #[arg(skip)]
    pub models: Option<String>,
}

/// How long a whole study may take that tries one thing after the other.
#[derive(Args, Clone, Copy, Debug)]
pub struct Budgeted {
    /// Processor time in seconds that the whole study may take; what is not tried within it is listed
    ///
    /// All threads count, set-up included. The answer is of what was tried.
    #[arg(long, value_name = "S", default_value_t = DEFAULT_BUDGET, value_parser = positive)]
    pub budget: f64,
}

impl Budgeted {
    /// The bound, from now on.
    pub fn budget(&self) -> Budget {
        Budget::new(Duration::from_secs_f64(self.budget))
    }
}

/// Where results go, and how long a run may take.
#[derive(Args, Clone, Debug)]
pub struct Bounded {
    /// Where results go.
    #[command(flatten)]
    pub output: Output,
    /// Bound on the processor time of one integration in seconds; a run that would take far longer at its pace ends at once
    ///
    /// The time that recording takes does not count, nor does other work on the machine.
    #[arg(long, value_name = "S", default_value_t = DEFAULT_TIMEOUT, value_parser = positive)]
    pub timeout: f64,
}

impl Bounded {
    /// Bound of one integration.
    pub fn timeout(&self) -> Duration {
        Duration::from_secs_f64(self.timeout)
    }
}

impl Default for Bounded {
    fn default() -> Self {
        Bounded {
            output: Output::default(),
            timeout: DEFAULT_TIMEOUT,
        }
    }
}

/// The same of a study whose runs are timed.
#[derive(Args, Clone, Debug)]
pub struct Timed {
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub bounded: Bounded,
    /// Timed repeats of every run; the report shows their median and spread
    #[arg(long, value_name = "N", default_value_t = DEFAULT_REPEATS, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeats: u32,
}

impl Default for Timed {
    fn default() -> Self {
        Timed {
            bounded: Bounded::default(),
            repeats: DEFAULT_REPEATS,
        }
    }
}

/// Whether a reference of other gears will do.
#[derive(Args, Clone, Debug, Default)]
pub struct Insist {
    /// Take the scene's reference though it is of other gears, speeds or loads; the report says so
    #[arg(long)]
    pub any_reference: bool,
}
