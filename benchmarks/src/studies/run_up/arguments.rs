//! Arguments of `run-up`.

use crate::cli::arguments::Output;
use crate::cli::values::{positive, positive_load};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench run-up                                     the scene run_up: a pair on bearings through its resonances
  gearbench run-up planetary_run_up --gear sun
  gearbench run-up my_scene.toml --from 50 --to 1500 --over 0.5 --models rigid

A scene whose shafts are brought from one speed to another (a driven hub with a ramp of speed, a torque that is left over) runs
once. Transmission error and force of every mesh and the forces of bearings are cut into windows that overlap; spectra over the
speed of a reference gear show what resonates (frequency by speed), maps of orders what goes with which shaft, and orders of
meshes and shafts are followed over the speed. Without such a scene --from and --to drive it: its driven hub, or, where none is
driven, all hubs by torques that accelerate each alone and press no flank, while the member that puts most power in gives what
the loads of the others take at each speed: the speeds follow the ramp whatever the loads. Friction is not balanced; a run
that ends more than 2 % of the change of speed beside its ramp has failed, and says so. Amplitudes are half of peak to peak.

Results (--out DIR, default out/SCENE/run-up/), beside report and record:
  run_up_orders.csv         amplitudes of orders over the speed
  run_up_spectra.csv        amplitudes by speed and frequency
  run_up_order_spectra.csv  amplitudes by speed and order";

/// Arguments of `run-up`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct RunUp {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = "run_up")]
    pub scene: String,
    /// Models of the scene by label, between commas [default: those of its study, without full finite elements]
    #[arg(long, visible_alias = "model", value_name = "A,B")]
    pub models: Option<String>,
    /// The gear whose speed and turns count [default: the first that turns]
    #[arg(long, value_name = "NAME")]
    pub gear: Option<String>,
    /// Its speed at the start in rad/s, in place of what the scene does
    #[arg(long, value_name = "RAD_S", value_parser = positive_load, requires = "to")]
    pub from: Option<f64>,
    /// Its speed at the end in rad/s; below --from it runs down
    #[arg(long, value_name = "RAD_S", value_parser = positive_load, requires = "from")]
    pub to: Option<f64>,
    /// Time in seconds that this takes [default: the duration of the scene]
    #[arg(long, value_name = "S", value_parser = positive, requires = "from")]
    pub over: Option<f64>,
    /// Multiples of mesh orders that are followed and shown
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=50))]
    pub multiples: u32,
    /// Whole turns of the gear in a window of orders [default: a hundredth of the run]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub turns: Option<u32>,
    /// Time in seconds before which nothing is looked at [default: a fiftieth of the run]
    #[arg(long, value_name = "S", value_parser = positive)]
    pub onset: Option<f64>,
    /// Samples of the run
    #[arg(long, value_name = "N", default_value_t = 1 << 18, value_parser = clap::value_parser!(u32).range(1024..=16_777_216))]
    pub samples: u32,
    /// Bound on the processor time of a run in seconds [default: none]
    #[arg(long, value_name = "S", value_parser = positive)]
    pub timeout: Option<f64>,
    /// Where results go.
    #[command(flatten)]
    pub output: Output,
}
