//! Arguments of `run-up`.

use crate::cli::arguments::Output;
use crate::cli::values::{positive, positive_load};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench run-up                                     the scene run_up: a pair on bearings through its resonances
  gearbench run-up planetary_run_up --gear sun
  gearbench run-up my_scene.toml --from 50 --to 1500 --over 0.5 --models rigid

The study runs a scene once while its shafts change speed (a driven hub with a ramp of speed, or an unbalanced
torque). It divides transmission error and force of every mesh and the bearing forces into overlapping windows.
Spectra over the speed of a reference gear show resonances, order maps assign vibrations to shafts, and the orders of
meshes and shafts are tracked over the speed. --from and --to prescribe a speed ramp of the driven hub. If no hub is
driven, torques accelerate each hub separately, without load on the flanks, and the member with the largest input
power balances the loads of the others at each speed, so that the speeds follow the ramp. Friction is not balanced: a
run has failed if its final speed deviates from the ramp by more than 2 % of the change of speed. Amplitudes are half
of the peak-to-peak values.

Results besides report and record (--out DIR, default out/SCENE/run-up/):
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
    /// Models of the scene by label, separated by commas [default: the models of its study without full finite
    /// elements]
    #[arg(long, visible_alias = "model", value_name = "A,B")]
    pub models: Option<String>,
    /// Reference gear of speeds and revolutions [default: the first that turns]
    #[arg(long, value_name = "NAME")]
    pub gear: Option<String>,
    /// Initial speed of the reference gear in rad/s, in place of the motion in the scene
    #[arg(long, value_name = "RAD_S", value_parser = positive_load, requires = "to")]
    pub from: Option<f64>,
    /// Final speed of the reference gear in rad/s; below --from, the study is a run-down
    #[arg(long, value_name = "RAD_S", value_parser = positive_load, requires = "from")]
    pub to: Option<f64>,
    /// Duration of the speed ramp in seconds [default: the duration of the scene]
    #[arg(long, value_name = "S", value_parser = positive, requires = "from")]
    pub over: Option<f64>,
    /// Number of multiples of the mesh orders that are tracked
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=50))]
    pub multiples: u32,
    /// Whole revolutions of the reference gear in a window of orders [default: a hundredth of the run]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub turns: Option<u32>,
    /// Start of the evaluation in seconds [default: a fiftieth of the run]
    #[arg(long, value_name = "S", value_parser = positive)]
    pub onset: Option<f64>,
    /// Number of samples of the run
    #[arg(long, value_name = "N", default_value_t = 1 << 18, value_parser = clap::value_parser!(u32).range(1024..=16_777_216))]
    pub samples: u32,
    /// Limit on the processor time of a run in seconds [default: none]
    #[arg(long, value_name = "S", value_parser = positive)]
    pub timeout: Option<f64>,
    /// Where results go.
    #[command(flatten)]
    pub output: Output,
}
