//! Arguments of `sweep`.

use crate::cli::arguments::BoundedOutput;
use crate::cli::values::{DEFAULT_POSITIONS, positions, positive_load};
use clap::Args;
use clap::builder::PossibleValuesParser;
use clap::builder::TypedValueParser as _;
use gearbench_reports::sweep::Branch;

const EXAMPLES: &str = "\
Examples:
  gearbench sweep                                    the scene loaded_mesh
  gearbench sweep loaded_mesh --models rigid --points 100
  gearbench sweep beveloid beveloid_corrected        two scenes in one report, with common charts
  gearbench sweep my_scene.toml --from 200 --to 6000 --out out/run_up

The speed increases and then decreases in steps. Each run starts from the final state of the run before it, since
gears with backlash can have two steady motions at one speed, with continuous contact or with impacts. At every speed
each model runs until it is steady; then transmission error, contact force and bearing forces are measured over whole
mesh cycles. The static transmission error under the same load is the limit for low speeds; it is also computed for
the models `fe` of the scene.

The scene needs one mesh of two gears with torques that load the flank of its start: constant and balanced torques on
both gears, or a torque on one gear while the other is driven. With viscous loads, the study sets the driving torque
that keeps the speed. The range of speeds is that of [study] sweep in the scene, else a range about the mesh
resonance.

Results besides report and record (--out DIR, default out/SCENE/sweep/):
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
    /// Further scenes whose results share charts and tables with those of the first, each with its own models and range of
    /// speeds
    #[arg(value_name = "SCENE")]
    pub further: Vec<String>,
    /// Models of the scene by label, separated by commas [default: the models of its study]
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
    /// Number of whole mesh cycles of the measurement
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub cycles: Option<u32>,
    /// Number of whole revolutions of the first gear in place of cycles, which also gives the orders of its shaft
    #[arg(long, value_name = "N", conflicts_with = "cycles", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub turns: Option<u32>,
    /// Branches of the sweep, separated by commas: up and down continue from the speed before, fresh starts anew at
    /// each speed [default: up,down]
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = branch())]
    pub branches: Option<Vec<Branch>>,
    /// Number of positions of the static cycle over one base pitch
    #[arg(long, value_name = "N", default_value_t = DEFAULT_POSITIONS, value_parser = positions)]
    pub positions: usize,
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub run: BoundedOutput,
}
