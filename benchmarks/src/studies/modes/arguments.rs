//! Arguments of `modes`.

use crate::cli::arguments::Output;
use crate::cli::values::{DEFAULT_SCENE, frequency, number};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench modes driveline                          motor, gears and load on elastic shafts
  gearbench modes loaded_mesh --models elastic --count 60
  gearbench modes my_scene.toml --up-to 5000 --out out/modes

The study linearises the whole scene about its equilibrium under its loads (ramps at their final value, harmonics at
their mean, viscous loads at the speeds of the train). The resultant load that accelerates a free train as a rigid
mechanism causes no deflection and is removed. A scene without loads that starts with a negative gap is linearised
about its initial state. Full finite elements have too many coordinates; use elastic gears, whose modes are reduced
from the same mesh.

Results (--out DIR, default out/SCENE/modes/):
  modes.csv          frequencies, damping ratios, shares of energy
  modes_shapes.csv   displacements of gears and bodies in each mode";

/// Arguments of `modes`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Modes {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Models of the scene by label, separated by commas [default: the models of its study without full finite
    /// elements]
    #[arg(long, visible_alias = "model", value_name = "A,B")]
    pub models: Option<String>,
    /// Largest number of frequencies to list for each model, the lowest first
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=2000))]
    pub count: u32,
    /// List frequencies up to this one [Hz]
    #[arg(long, value_name = "HZ", value_parser = frequency)]
    pub up_to: Option<f64>,
    /// Relative distance below which frequencies count as equal
    #[arg(long, value_name = "X", default_value_t = 1e-6, value_parser = distance)]
    pub group: f64,
    /// Where results go.
    #[command(flatten)]
    pub output: Output,
}

fn distance(text: &str) -> Result<f64, String> {
    number(
        text,
        |x| (0.0..=0.1).contains(x),
        "expected a number from 0 to 0.1, for example 1e-4",
    )
}
