//! Arguments of `fmu`.

use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench fmu loaded_mesh                               loaded_mesh.fmu: torques on both hubs are inputs
  gearbench fmu hammer --model rigid --method rk4@1us --out hammer.fmu
  gearbench fmu loaded_mesh --move pinion                 the host prescribes the motion of the pinion
  gearbench fmu loaded_mesh --fmi 2                       for hosts that read FMI 2.0 only

The FMU supports co-simulation and model exchange. It contains the shared library of gearbench-fmu, which is searched for in
the folder of this program and in ../lib; a program that was built in a checkout of gearbench builds it there if it is
missing or old. `gearbench help fmus` describes inputs, outputs and accuracy.";

/// Arguments of `fmu`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Fmu {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Model, by its label in the scene [default: the first of the study]
    #[arg(long, value_name = "LABEL")]
    pub model: Option<String>,
    /// Integrator for co-simulation with step or tolerance, such as rk4@1us [default: the first of the model, or of the
    /// study]
    #[arg(long, value_name = "METHOD")]
    pub method: Option<String>,
    /// Gears whose hub motion the host prescribes, separated by commas
    #[arg(long = "move", value_name = "GEAR,..", value_delimiter = ',')]
    pub moved: Vec<String>,
    /// Version of the standard FMI: 2 or 3
    #[arg(long, value_name = "VERSION", default_value_t = 3, value_parser = clap::value_parser!(u32).range(2..=3))]
    pub fmi: u32,
    /// Shared library of gearbench-fmu [default: the one in the folder of this program, in ../lib, or built in the
    /// checkout of gearbench]
    #[arg(long, value_name = "FILE")]
    pub library: Option<PathBuf>,
    /// File to write [default: SCENE.fmu]
    #[arg(long, value_name = "F.fmu")]
    pub out: Option<PathBuf>,
    /// Overwrite an existing file even if this command did not write it
    #[arg(long)]
    pub force: bool,
}
