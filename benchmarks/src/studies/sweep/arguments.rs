//! Arguments of `sweep`.

use crate::cli::arguments::Bounded;
use crate::cli::values::{DEFAULT_POSITIONS, positions, positive_load};
use clap::Args;
use clap::builder::PossibleValuesParser;
use clap::builder::TypedValueParser as _;
use gearbench_reports::sweep::Branch;

const EXAMPLES: &str = "\
Examples:
  gearbench sweep                                    the scene loaded_mesh
  gearbench sweep loaded_mesh --models rigid --points 100
  gearbench sweep my_scene.toml --from 200 --to 6000 --out out/run_up

The speed goes up and down again, each run from the state in which the last one ended: with backlash gears may run in
two ways at one speed, in contact or hammering, and stay in the one they come from. At every speed each model runs
until it has settled; then transmission error, contact force and bearing forces are taken
over whole mesh cycles. The static transmission error under the same load is the limit of slow running; models `fe` of
the scene stand beside it at rest.

The scene has one mesh of two gears with torques that press the flank of its start: constant ones on both gears in
balance, or on one while the other is driven or, where loads are viscous, given the torque that holds the speed. Speeds are those of [study] sweep in the scene; without, around the mesh resonance.

Results (--out DIR, default out/SCENE/sweep/), beside report and record:
  sweep.csv         one line per speed: transmission error, forces, harmonics
  sweep_cycles.csv  one mean mesh cycle of each run
  sweep_orders.csv  transmission error at the orders of the shafts, where whole turns were measured (--turns)
  statics.csv       the static transmission error";

/// A branch by its word.
fn branch() -> impl clap::builder::TypedValueParser<Value = Branch> {
    let words = PossibleValuesParser::new(Branch::ALL.map(Branch::as_str));
    words.map(|word| {
        let found = Branch::ALL.into_iter().find(|b| b.as_str() == word);
        found.unwrap_or_default()
    })
}

/// Arguments of `sweep`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Sweep {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = "loaded_mesh")]
    pub scene: String,
    /// Models of the scene by label, between commas [default: those of its study]
    #[arg(long, value_name = "A,B")]
    pub models: Option<String>,
    /// Lowest mesh frequency in hertz
    #[arg(long, value_name = "HZ", value_parser = positive_load, requires = "to")]
    pub from: Option<f64>,
    /// Highest mesh frequency in hertz
    #[arg(long, value_name = "HZ", value_parser = positive_load, requires = "from")]
    pub to: Option<f64>,
    /// Number of speeds
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub points: Option<u32>,
    /// Whole mesh cycles that are measured
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub cycles: Option<u32>,
    /// Whole turns of the first gear that are measured in place of cycles: gives the orders of its shaft
    #[arg(long, value_name = "N", conflicts_with = "cycles", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub turns: Option<u32>,
    /// How runs come to their speed, between commas: up, down (each from the speed before), fresh [default: up,down]
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = branch())]
    pub branches: Option<Vec<Branch>>,
    /// Positions of the static cycle over one base pitch
    #[arg(long, value_name = "N", default_value_t = DEFAULT_POSITIONS, value_parser = positions)]
    pub positions: usize,
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub run: Bounded,
}
