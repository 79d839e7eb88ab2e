//! Arguments of `identify`.

use crate::cli::arguments::{Insist, Output};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench identify spur_impact                    fit and print, with 95 % confidence intervals
  gearbench identify spur_impact --model rigid
  gearbench identify spur_impact --write            also write the calibration file

The scene needs a reference. With --write the constants go to the calibration file that models with
`calibration = \"impact\"` read: NAME.calibration.toml beside a scene file, and for a shipped scene
benchmarks/calibrations/NAME.toml (run it in the repository and build again: it is embedded).";

/// Arguments of `identify`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Identify {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Fit this model only [default: every model with a calibration]
    #[arg(long, value_name = "LABEL")]
    pub model: Option<String>,
    /// Write the calibration file of the scene
    #[arg(long)]
    pub write: bool,
    /// Where an interrupted start keeps what it has finished.
    #[command(flatten)]
    pub output: Output,
    /// Whether a reference of other gears will do.
    #[command(flatten)]
    pub insist: Insist,
}
