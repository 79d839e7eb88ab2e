//! Arguments of `penalty`.

use crate::cli::arguments::BoundedOutput;
use crate::cli::values::{DEFAULT_LOAD, DEFAULT_SCENE, number, positions, positive_load};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench penalty                                  the elastic gears of spur_impact, contact points at nodes
  gearbench penalty spur_impact --from 1e14 --to 1e16 --points 5
  gearbench penalty my_scene.toml --model elastic --hard elastic-without-penalty

The study runs one model with a series of penalties and computes its static transmission error under --load. The limit
for comparison is the same model with hard contact, if the scene has one (--hard, or the label with -hard appended).
Both need the same contact points: a penalty at nodes converges to hard contact at nodes, not to hard contact of
averaged gaps.";

/// Arguments of `penalty`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Penalty {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Label of the model [default: the first with a variant LABEL-hard, else the first with contact at flank points]
    #[arg(long, visible_alias = "models", value_name = "LABEL")]
    pub model: Option<String>,
    /// Label of the same model with hard contact [default: LABEL-hard, if the scene has it]
    #[arg(long, value_name = "LABEL")]
    pub hard: Option<String>,
    /// Softest penalty [Pa/m]
    #[arg(long, value_name = "PA_PER_M", default_value_t = 1e13, value_parser = penalty)]
    pub from: f64,
    /// Stiffest penalty [Pa/m]
    #[arg(long, value_name = "PA_PER_M", default_value_t = 1e17, value_parser = penalty)]
    pub to: f64,
    /// Number of penalties, evenly spaced on a logarithmic scale
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub points: u32,
    /// Load of the static equilibria in the transverse plane per common face width [N/mm]
    #[arg(long, value_name = "N_PER_MM", default_value_t = DEFAULT_LOAD, value_parser = positive_load)]
    pub load: f64,
    /// Number of positions of the static cycle over one base pitch
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = positions)]
    pub positions: usize,
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub run: BoundedOutput,
}

fn penalty(text: &str) -> Result<f64, String> {
    let expected = "expected a positive number of Pa/m, for example 1e15";
    number(text, |x| *x > 0.0 && *x <= 1e25, expected)
}
