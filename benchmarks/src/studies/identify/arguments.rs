//! Arguments of `identify`.

use crate::cli::arguments::{Insist, Output};
use crate::cli::values::positive_load;
use crate::scene_file::calibration::FittedTo;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

const EXAMPLES: &str = "\
Examples:
  gearbench identify spur_impact                    fit and print, with 95 % confidence intervals
  gearbench identify spur_impact --model rigid
  gearbench identify spur_impact --write            also write the calibration file
  gearbench identify spur_impact --to running --load 27 --write
                                                    fitted to the impact and to finite elements at rest at once

A calibration holds for what it was fitted to: `impact` for single impacts, `static` for standing and slow running under
load, `running` for both. `impact` and `running` need a reference of the scene, `static` and `running` a model of finite
elements (--against). With --write the constants go to the calibration file that models with
`calibration = \"impact\"` read: NAME.calibration.toml beside a scene file, and for a shipped scene
benchmarks/calibrations/NAME.toml (run it in the repository and build again: it is embedded).";

/// What to fit to, by its name.
fn fitted_to() -> impl TypedValueParser<Value = FittedTo> {
    let words = PossibleValuesParser::new(FittedTo::ALL.map(FittedTo::as_str));
    words.map(|word| FittedTo::named(&word).unwrap_or_default())
}

/// Arguments of `identify`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Identify {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Fit this model only [default: every model with a calibration]
    #[arg(long, value_name = "LABEL")]
    pub model: Option<String>,
    /// What to fit to: impact, static or running (both at once)
    #[arg(long, value_name = "WHAT", default_value = "impact", value_parser = fitted_to())]
    pub to: FittedTo,
    /// Model at rest whose compliance is fitted [default: the first of finite elements]
    #[arg(long, value_name = "LABEL")]
    pub against: Option<String>,
    /// Load at rest over the common face width [N/mm]
    #[arg(long, value_name = "N/MM", default_value_t = 100.0, value_parser = positive_load)]
    pub load: f64,
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
