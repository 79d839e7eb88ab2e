//! Arguments of `reference`.

use crate::cli::values::{number, positive};
use clap::Args;
use std::path::PathBuf;

/// Bound on the processor time of one integration [s]: references take their time.
const PATIENT: f64 = 3600.0;
/// Default number of digits, as in other CSV files.
const DIGITS: u8 = 10;

const EXAMPLES: &str = "\
Examples:
  gearbench reference my_scene.toml --model fe --out fe.csv --add
  gearbench reference my_scene.toml --model fe --method hht-alpha@5e-7 --speed pinion=60 \\
      --duration 1e-4 --out fe_60.csv --add
  gearbench reference loaded_mesh --model elastic --load wheel=-40 --out loaded.csv

The command runs one model of a scene, repeats the run with half the step (a tenth of the tolerance), and writes
contact force, speeds, angles and transmission error as a CSV file. The header contains SI units; comments contain the
command, the commit, the conditions and the estimated error of the reference. The command prints the lines that add
the reference to the scene, and --add writes them. Models are then compared with it (compare, precision, truncation)
and fitted to it (identify). A reference for other speeds, loads, distances or durations than those of the scene is
by identify and by `choose --references`.";

/// A gear and a number, as in `pinion=60`.
fn of_gear(text: &str) -> Result<(String, f64), String> {
    let expected = "expected GEAR=NUMBER, as in pinion=60";
    let (gear, x) = text.split_once('=').ok_or(expected)?;
    Ok((
        gear.trim().to_owned(),
        number(x, |x| x.is_finite(), expected)?,
    ))
}

/// A length that is not endless.
fn length(text: &str) -> Result<f64, String> {
    number(text, |x| x.abs() < 1e3, "expected a number of metres")
}

/// Arguments of `reference`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Reference {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Model to run, by its label in the scene
    #[arg(long, value_name = "LABEL")]
    pub model: String,
    /// Integrator with step or tolerance, such as hht-alpha@5e-7 [default: the first of the model, else dopri5@1e-10]
    #[arg(long, value_name = "METHOD")]
    pub method: Option<String>,
    /// Initial speed of a gear, or constant speed of a driven gear, in rad/s (rack: m/s), in place of the scene's
    #[arg(long, value_name = "GEAR=SPEED", value_parser = of_gear, allow_hyphen_values = true)]
    pub speed: Vec<(String, f64)>,
    /// Constant torque on a gear in N m (rack: force in N), in place of its loads
    #[arg(long, value_name = "GEAR=LOAD", value_parser = of_gear, allow_hyphen_values = true)]
    pub load: Vec<(String, f64)>,
    /// Initial gap of all meshes in metres
    #[arg(long, value_name = "M", value_parser = length, allow_hyphen_values = true)]
    pub gap: Option<f64>,
    /// Centre distance of the only mesh in metres
    #[arg(long, value_name = "M", value_parser = length)]
    pub distance: Option<f64>,
    /// Simulated time in seconds
    #[arg(long, value_name = "S", value_parser = positive)]
    pub duration: Option<f64>,
    /// CSV file to write
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Digits of the numbers of the file, up to 17, which lose nothing; times have 13 or more
    #[arg(long, value_name = "N", default_value_t = DIGITS, value_parser = clap::value_parser!(u8).range(6..=17))]
    pub digits: u8,
    /// Overwrite an existing file even if this command did not write it
    #[arg(long)]
    pub force: bool,
    /// Name of the reference in the scene [default: the name of the file, with -reference appended if a model has it]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// Append the lines of the reference to the scene file
    #[arg(long)]
    pub add: bool,
    /// Exclude the reference from fits and use it for validation (role = "validate")
    #[arg(long)]
    pub validate: bool,
    /// Limit on the processor time of one integration in seconds
    #[arg(long, value_name = "S", default_value_t = PATIENT, value_parser = positive)]
    pub timeout: f64,
}
