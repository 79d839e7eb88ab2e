//! Arguments of `truncation`.

use crate::cli::arguments::{AnyReference, TimedOutput};
use crate::cli::values::DEFAULT_SCENE;
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench truncation                                   the scene spur_impact
  gearbench truncation spur_impact_large --counts 0,25,50,100
  gearbench truncation my_scene.toml --models elastic,fe --no-refine

The study runs the elastic model with a series of mode counts. Modes are selected by frequency and by flank
compliance; the truncated modes are either retained as residual compliance or neglected (plain truncation, among
others at 80 kHz and with 200 modes, as published). Each run is compared with one run of full finite elements on the
same mesh and with the reference of the scene.

The scene needs an elastic model and a model `fe` with the same mesh and the same contact. The study uses their
integrators; plain truncation uses the integrators of an elastic model with `residual = false`, if the scene has one.";

/// Arguments of `truncation`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Truncation {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Labels of the elastic model and of the full model [default: the first of each kind]
    #[arg(long, value_name = "A,B")]
    pub models: Option<String>,
    /// Numbers of modes per gear, separated by commas [default: 0,10,25,35,50,75,100,150,200,300]
    #[arg(long, value_name = "N,M", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(0..=2000))]
    pub counts: Vec<u32>,
    /// Integrator of the full model [default: newmark with a fifth of its step in the scene]
    #[arg(long, value_name = "X@STEP")]
    pub reference_integrator: Option<String>,
    /// Do not determine the least number of modes for errors of 2, 1 and 0.5 %
    #[arg(long)]
    pub no_refine: bool,
    /// Where results go, how long a run may take, how often it is timed.
    #[command(flatten)]
    pub run: TimedOutput,
    /// Whether a reference of other gears will do.
    #[command(flatten)]
    pub insist: AnyReference,
}
