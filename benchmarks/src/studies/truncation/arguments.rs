//! Arguments of `truncation`.

use crate::cli::arguments::{Insist, Timed};
use crate::cli::values::DEFAULT_SCENE;
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench truncation                                   the scene spur_impact
  gearbench truncation spur_impact_large --counts 0,25,50,100
  gearbench truncation my_scene.toml --models elastic,fe --no-refine

Runs the elastic model with few and many modes, chosen by frequency and by flank compliance, with the cut modes kept as
residual compliance and plainly truncated (at 80 kHz and with 200 modes, as published, among others), and holds every
run against full finite elements on the same mesh, computed once, and against the scene's reference.

The scene needs an elastic model and a model `fe` on the same mesh with the same contact. Integrators are those of the
two; plain truncation takes those of an elastic model with `residual = false`, if the scene has one.";

/// Arguments of `truncation`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Truncation {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// The elastic model and the full one by label [default: the first of each kind]
    #[arg(long, value_name = "A,B")]
    pub models: Option<String>,
    /// Numbers of modes per gear, between commas [default: 0,10,25,35,50,75,100,150,200,300]
    #[arg(long, value_name = "N,M", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(0..=2000))]
    pub counts: Vec<u32>,
    /// Integrator of the full model [default: newmark at a fifth of its step in the scene]
    #[arg(long, value_name = "X@STEP")]
    pub reference_integrator: Option<String>,
    /// Do not narrow down the fewest modes that reach 2, 1 and 0.5 %
    #[arg(long)]
    pub no_refine: bool,
    /// Where results go, how long a run may take, how often it is timed.
    #[command(flatten)]
    pub run: Timed,
    /// Whether a reference of other gears will do.
    #[command(flatten)]
    pub insist: Insist,
}
