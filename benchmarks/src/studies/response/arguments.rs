//! Arguments of `response`.

use crate::cli::arguments::Output;
use crate::cli::values::{DEFAULT_SCENE, frequency};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench response loaded_mesh                     over the range of its mesh resonance
  gearbench response planetary --models rigid --from 100 --to 3000
  gearbench response my_scene.toml --points 400 --out out/response

What the whole scene answers to the passing of its teeth, mesh frequency after mesh frequency, without running: each mesh
follows its own stiffness and transmission error through its cycle, found in the equilibrium of the loads at phase after
phase, and all harmonics are balanced together. It holds while flanks stay in contact; where the least force falls below zero
it says so, and `gearbench sweep` runs. Loads and damping are those of the scene's own speeds.

Results (--out DIR, default out/SCENE/response/):
  response.csv       transmission errors and mesh forces over the mesh frequency
  response_mounts.csv  forces of mounts
  response_limits.csv  meshes that run slowly";

/// Arguments of `response`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Response {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Models of the scene by label, between commas [default: those of its study, without full finite elements]
    #[arg(long, visible_alias = "model", value_name = "A,B")]
    pub models: Option<String>,
    /// Lowest frequency of the first mesh [Hz]; meshes of other frequencies turn along
    #[arg(long, value_name = "HZ", value_parser = frequency, requires = "to")]
    pub from: Option<f64>,
    /// Highest frequency of the first mesh [Hz] [default: around its resonance]
    #[arg(long, value_name = "HZ", value_parser = frequency, requires = "from")]
    pub to: Option<f64>,
    /// Number of frequencies
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub points: u32,
    /// Phases of a mesh cycle at which the scene is looked at
    #[arg(long, value_name = "N", default_value_t = 96, value_parser = clap::value_parser!(u32).range(16..=512))]
    pub phases: u32,
    /// Where results go.
    #[command(flatten)]
    pub output: Output,
}
