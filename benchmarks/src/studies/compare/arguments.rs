//! Arguments of `compare`.

use crate::cli::arguments::{AnyReference, TimedOutput};
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
  gearbench compare beveloid beveloid_corrected      two scenes in one report, with common charts
  gearbench compare spur_impact --models elastic --vtu 60 --vtu-window 0,1.5e-4

A run that fails (blow-up, Newton failure, energy growth, ...) is a row of the report and does not stop the study.
The error against the yardstick is the error of the model, the error against `self` is that of the integrator.";

/// Arguments of `compare`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Compare {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Further scenes whose results share charts and tables with those of the first, each with its own models, references
    /// and tolerance
    #[arg(value_name = "SCENE")]
    pub further: Vec<String>,
    /// Models of the scene by label, separated by commas [default: the models of its study]
    #[arg(long, value_name = "A,B")]
    pub models: Option<String>,
    /// Integrators separated by commas: id or id(name=value), optionally with @STEP or @RTOL
    ///
    /// A value with a unit of time is a step (rk4@500ns, trigonometric@1us), a bare number a step in seconds for
    /// methods with fixed steps and a relative tolerance for adaptive ones. Without it, the value of the scene applies.
    /// [default: the integrators of the scene's study]
    #[arg(long, value_name = "X,Y")]
    pub integrators: Option<String>,
    /// Yardstick of the comparison: `refined`, or the label of a model
    ///
    /// `refined` is a model of elastic gears that the study makes: twice the elements, half-space contact where the
    /// flanks permit it, and an estimate of its own error. [default: the reference of the scene; if it has none but a
    /// tolerance for models, `refined`; else its most detailed model]
    #[arg(long, value_name = "WHAT")]
    pub yardstick: Option<String>,
    /// Where results go, how long a run may take, how often it is timed.
    #[command(flatten)]
    pub run: TimedOutput,
    /// Number of frames of each run to write for ParaView, evenly spaced: displaced bodies of all gears with contact
    /// forces and pressures
    ///
    /// The file OUT/vtu/RUN.pvd of a run lists its frames and their times.
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
    /// Do not locate contact events, which shows the error of a method whose steps cross them
    #[arg(long)]
    pub no_events: bool,
    /// Whether a reference of other gears will do.
    #[command(flatten)]
    pub insist: AnyReference,
}

impl Default for Compare {
    /// What `gearbench` does without a command.
    fn default() -> Self {
        Compare {
            scene: DEFAULT_SCENE.to_owned(),
            further: Vec::new(),
            models: None,
            integrators: None,
            yardstick: None,
            run: TimedOutput::default(),
            vtu: None,
            vtu_window: Vec::new(),
            no_events: false,
            insist: AnyReference::default(),
        }
    }
}
