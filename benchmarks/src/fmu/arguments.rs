//! Arguments of `fmu`.

use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench fmu loaded_mesh                               loaded_mesh.fmu: torques on both hubs are inputs
  gearbench fmu hammer --model rigid --method rk4@1us --out hammer.fmu
  gearbench fmu loaded_mesh --move pinion                 the host moves the pinion, and gets its forces

The file serves co-simulation and model exchange under FMI 3.0. It needs the shared library of gearbench-fmu, which
is looked for in the folder of this program and in ../lib, and is built in a checkout of gearbench with
cargo build --release -p gearbench-fmu. `gearbench help fmus` describes inputs, outputs and what coupling costs in accuracy.";

/// Arguments of `fmu`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Fmu {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Model, by its label in the scene [default: the first of the study]
    #[arg(long, value_name = "LABEL")]
    pub model: Option<String>,
    /// Integrator of co-simulation with step or tolerance, such as rk4@1us [default: the first of the model, or of the
    /// study]
    #[arg(long, value_name = "METHOD")]
    pub method: Option<String>,
    /// Gears whose hubs the host moves, between commas
    #[arg(long = "move", value_name = "GEAR,..", value_delimiter = ',')]
    pub moved: Vec<String>,
    /// Shared library of gearbench-fmu [default: the one in the folder of this program, or in ../lib]
    #[arg(long, value_name = "FILE")]
    pub library: Option<PathBuf>,
    /// File to write [default: SCENE.fmu]
    #[arg(long, value_name = "F.fmu")]
    pub out: Option<PathBuf>,
    /// Write over a file that is there, though it is not one that this command has written
    #[arg(long)]
    pub force: bool,
}
