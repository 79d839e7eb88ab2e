//! Arguments of `compare`.

use crate::cli::arguments::{Insist, Timed};
use crate::cli::values::DEFAULT_SCENE;
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench compare spur_impact --integrators dopri5,bdf
  gearbench compare spur_impact --integrators dopri5@1e-9,rk4@200ns
  gearbench compare spur_impact --integrators 'generalised-alpha(rho_inf=0.5)@1e-6'
  gearbench compare spur_impact --models rigid,rigid-iso6336 --out out/norm
  gearbench compare pair.toml --yardstick refined
  gearbench compare hammer --no-events --repeats 1
  gearbench compare spur_impact --models elastic --vtu 60 --vtu-window 0,1.5e-4

A run that fails (blow-up, Newton failure, energy growth, ...) is a row of the report, not an abort.
Errors against the yardstick are those of the model, errors against `self` those of the integrator.";

/// Arguments of `compare`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Compare {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Models of the scene by label, between commas [default: those of its study]
    #[arg(long, value_name = "A,B")]
    pub models: Option<String>,
    /// Integrators between commas: id, id(name=value), each optionally with @STEP or @RTOL
    ///
    /// A value with a unit of time is a step (rk4@500ns, trigonometric@1us), a bare number a step in seconds for
    /// methods of fixed steps and a relative tolerance for adaptive ones; left out, the scene's own.
    /// [default: those of the scene's study]
    #[arg(long, value_name = "X,Y")]
    pub integrators: Option<String>,
    /// Yardstick of the comparison: `refined`, or the label of a model
    ///
    /// `refined` are elastic gears with twice the elements, on half-spaces where flanks may touch so, made for the
    /// comparison together with an estimate of their own error.
    /// [default: the reference of the scene; where it has none and a tolerance for models, `refined`; else its most detailed
    /// model]
    #[arg(long, value_name = "WHAT")]
    pub yardstick: Option<String>,
    /// Where results go, how long a run may take, how often it is timed.
    #[command(flatten)]
    pub run: Timed,
    /// Write so many frames of every run for ParaView, evenly over it: the bodies of all gears, displaced, with contact
    /// forces and pressures
    ///
    /// A run has a file OUT/vtu/RUN.pvd, which names its frames and their times.
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub vtu: Option<u32>,
    /// First and last time of these frames in seconds [default: the whole run]
    #[arg(
        long,
        value_name = "FROM,TO",
        value_delimiter = ',',
        num_args = 1,
        requires = "vtu"
    )]
    pub vtu_window: Vec<f64>,
    /// Do not locate contact events: shows what a method loses when steps run across them
    #[arg(long)]
    pub no_events: bool,
    /// Whether a reference of other gears will do.
    #[command(flatten)]
    pub insist: Insist,
}

impl Default for Compare {
    /// What `gearbench` does without a command.
    fn default() -> Self {
        Compare {
            scene: DEFAULT_SCENE.to_owned(),
            models: None,
            integrators: None,
            yardstick: None,
            run: Timed::default(),
            vtu: None,
            vtu_window: Vec::new(),
            no_events: false,
            insist: Insist::default(),
        }
    }
}
