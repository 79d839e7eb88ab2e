//! Arguments of `stiffness`.

use crate::cli::arguments::Output;
use crate::cli::values::{DEFAULT_POSITIONS, positions, positive_load, torque};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench stiffness spur_impact --models fe       finite elements, ISO 6336-1, analytic tooth compliance
  gearbench stiffness spur_impact --load 100        at 100 N per mm of face width
  gearbench stiffness my_scene.toml --torque 80 --positions 48 --out out/te

The study fixes both hubs and rotates the first gear until it carries the load, at positions over one base pitch. The
load is the load of the scene if it acts on the flanks of the start, else 300 N/mm. Mounts, speeds, damping and
friction of the scene have no influence. Forces, stiffness and transmission error refer to the transverse plane: the
force is the torque divided by the transverse base radius, the transmission error is r_b1 theta_1 + r_b2 theta_2. The
results are compared with the stiffness of ISO 6336-1 and with the analytic compliance of the same gears.

Results (--out DIR, default out/SCENE/stiffness/):
  index.html         the report: mesh stiffness, load sharing and transmission error of all models over the path
  results.json       the record, the input of `gearbench report` and `gearbench rerun`
  stiffness.csv      one line per model
  cycle_MODEL.csv    transmission error, stiffness and load of each tooth pair by position
  stiffness.svg      the chart";

/// Arguments of `stiffness`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Stiffness {
    /// Name of a shipped scene, or path of a scene file (.toml), with two gears
    pub scene: String,
    /// Models of the scene by label, separated by commas [default: the models of its study]
    #[arg(long, visible_alias = "model", value_name = "A,B")]
    pub models: Option<String>,
    /// Load along the line of action in the transverse plane per common face width [N/mm] [default: the load of the
    /// scene, else 300]
    #[arg(long, value_name = "N_PER_MM", value_parser = positive_load)]
    pub load: Option<f64>,
    /// Torque on the first gear [N m], in place of --load; the flank of the start carries it, independently of its sign
    #[arg(long, value_name = "NM", conflicts_with = "load", allow_negative_numbers = true, value_parser = torque)]
    pub torque: Option<f64>,
    /// Number of positions over one base pitch
    #[arg(long, value_name = "N", default_value_t = DEFAULT_POSITIONS, value_parser = positions)]
    pub positions: usize,
    /// Where results go.
    #[command(flatten)]
    pub output: Output,
}
