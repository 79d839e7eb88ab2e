//! Arguments of `fmu`.

use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench fmu loaded_mesh                               loaded_mesh.fmu: torques on both hubs are inputs
  gearbench fmu hammer --model rigid --method rk4@1us --out hammer.fmu
  gearbench fmu loaded_mesh --move pinion                 the host prescribes the motion of the pinion

The FMU supports co-simulation and model exchange under FMI 3.0. The command needs the shared library of gearbench-fmu
and searches for it in the folder of this program and in ../lib. In a checkout of gearbench,
`cargo build --release -p gearbench-fmu` builds it. `gearbench help fmus` describes inputs, outputs and accuracy.";

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
    /// Shared library of gearbench-fmu [default: the one in the folder of this program, or in ../lib]
    #[arg(long, value_name = "FILE")]
    pub library: Option<PathBuf>,
    /// File to write [default: SCENE.fmu]
    #[arg(long, value_name = "F.fmu")]
    pub out: Option<PathBuf>,
    /// Overwrite an existing file even if this command did not write it
    #[arg(long)]
    pub force: bool,
}
