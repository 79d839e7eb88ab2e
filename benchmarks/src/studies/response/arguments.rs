//! Arguments of `response`.

use crate::cli::arguments::Output;
use crate::cli::values::{DEFAULT_SCENE, frequency};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench response loaded_mesh                     over the range of its mesh resonance
  gearbench response planetary --models rigid --from 100 --to 3000
  gearbench response my_scene.toml --points 400 --out out/response

The study computes the forced response of the whole scene to the tooth mesh excitation at a series of mesh
frequencies, without time integration. It computes the stiffness and the transmission error of each mesh from static
equilibria over the phases of the mesh cycle and solves for all harmonics together (harmonic balance). The response is
valid while the flanks remain in contact; the study reports frequencies at which the least force is negative, for
which `gearbench sweep` integrates in time. Loads and damping are taken at the speeds of the scene.

Results (--out DIR, default out/SCENE/response/):
  response.csv       transmission errors and mesh forces over the mesh frequency
  response_mounts.csv  forces of mounts
  response_limits.csv  quasi-static limit of each mesh";

/// Arguments of `response`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Response {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Models of the scene by label, separated by commas [default: the models of its study without full finite
    /// elements]
    #[arg(long, visible_alias = "model", value_name = "A,B")]
    pub models: Option<String>,
    /// Lowest frequency of the first mesh [Hz]; the frequencies of other meshes change in proportion
    #[arg(long, value_name = "HZ", value_parser = frequency, requires = "to")]
    pub from: Option<f64>,
    /// Highest frequency of the first mesh [Hz] [default: around its resonance]
    #[arg(long, value_name = "HZ", value_parser = frequency, requires = "from")]
    pub to: Option<f64>,
    /// Number of frequencies
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub points: u32,
    /// Number of phases of the mesh cycle at which the equilibrium is computed
    #[arg(long, value_name = "N", default_value_t = 96, value_parser = clap::value_parser!(u32).range(16..=512))]
    pub phases: u32,
    /// Where results go.
    #[command(flatten)]
    pub output: Output,
}
