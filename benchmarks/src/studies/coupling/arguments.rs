//! Arguments of `coupling`.

use crate::cli::arguments::BoundedOutput;
use crate::cli::values::{DEFAULT_SCENE, number, positive, time};
use crate::experiment::conditions::logarithmic;
use clap::Args;
use gearbench_reports::coupling::{Extrapolation, Motion};

const EXAMPLES: &str = "\
Examples:
  gearbench coupling                                  the scene spur_impact with the models of its study
  gearbench coupling loaded_mesh --duration 1e-3 --models rigid,elastic
  gearbench coupling spur_impact --extrapolations quadratic --motions linear,cubic
  gearbench coupling my_scene.toml --steps 1e-7:1e-4:16 --tolerance 0.01

The host simulates the movable hubs with their inertia and loads; the gears are a subsystem whose hub motion the host
prescribes. In each communication step the host moves first, with forces extrapolated from their last values; the
gears follow with interpolated motion. Each run is compared with the same model under the same integrator without
coupling: error of the force history, final speeds, and the energy that the coupling adds or removes. A run is
accurate if its error is within --tolerance. It has failed if the gears cannot be integrated further or if the
coupling adds more than half of the vibration energy.

The study adds to an elastic model its variant with plain truncation (the lowest modes, without residual compliance),
unless the scene has one or --models is given.

Results besides report and record (--out DIR, default out/SCENE/coupling/):
  coupling.csv          one line per run";

/// Most steps on a line.
const MOST: usize = 400;

/// Arguments of `coupling`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Coupling {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Models of the scene by label, separated by commas [default: the models of its study without full finite
    /// elements]
    #[arg(long, visible_alias = "model", value_name = "A,B")]
    pub models: Option<String>,
    /// Communication steps with a unit (1us:100us), or in seconds [default: the step of the gears and its doubles up to
    /// 4/omega, where omega is the frequency of the hubs on their teeth]
    #[arg(long, value_name = "FROM:TO[:POINTS]", value_parser = steps)]
    pub steps: Option<Steps>,
    /// Extrapolations of the forces on hubs: constant, linear, quadratic [default: all]
    #[arg(long, value_name = "X,Y", value_delimiter = ',', value_parser = extrapolation)]
    pub extrapolations: Vec<Extrapolation>,
    /// Interpolations of the motion of hubs: linear, cubic
    #[arg(long, value_name = "X,Y", value_delimiter = ',', value_parser = motion, default_value = "linear")]
    pub motions: Vec<Motion>,
    /// Integrator of the gears, X@STEP [default: the first explicit one of the model with a step, else rk4]
    #[arg(long, value_name = "X@STEP")]
    pub integrator: Option<String>,
    /// Largest relative L2 error of the force history of an accurate run
    #[arg(long, value_name = "E", default_value_t = 0.05, value_parser = tolerance)]
    pub tolerance: f64,
    /// Simulated time in seconds [default: the duration of the scene]
    #[arg(long, value_name = "S", value_parser = positive)]
    pub duration: Option<f64>,
    /// Number of simultaneous runs [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub run: BoundedOutput,
}

/// Communication steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps(pub Vec<f64>);

fn steps(text: &str) -> Result<Steps, String> {
    const EXPECTED: &str = "expected FROM:TO or FROM:TO:POINTS, 0 < FROM < TO, for example 100ns:100us:12, or in seconds 1e-7:1e-4:12";
    let of = |text: &str| time(text).map_err(|_| EXPECTED.to_owned());
    let parts: Vec<&str> = text.split(':').collect();
    let (from, to, points) = match parts.as_slice() {
        [from, to] => (of(from)?, of(to)?, 12),
        [from, to, points] => {
            let n = points.trim().parse().ok();
            let n = n.filter(|n| (2..=MOST).contains(n));
            let wrong = || format!("`{points}` points; expected 2 to {MOST}");
            (of(from)?, of(to)?, n.ok_or_else(wrong)?)
        }
        _ => return Err(EXPECTED.into()),
    };
    match from < to {
        true => Ok(Steps(logarithmic(from, to, points))),
        false => Err(EXPECTED.into()),
    }
}

fn extrapolation(text: &str) -> Result<Extrapolation, String> {
    let found = Extrapolation::ALL
        .into_iter()
        .find(|x| x.as_str() == text.trim());
    found.ok_or_else(|| "expected constant, linear or quadratic".into())
}

fn motion(text: &str) -> Result<Motion, String> {
    let found = Motion::ALL.into_iter().find(|x| x.as_str() == text.trim());
    found.ok_or_else(|| "expected linear or cubic".into())
}

fn tolerance(text: &str) -> Result<f64, String> {
    let expected = "expected a relative error between 0 and 1, for example 0.05";
    number(text, |x| *x > 0.0 && *x < 1.0, expected)
}

#[cfg(test)]
mod arguments_tests {
    use super::*;

    #[test]
    fn what_is_asked_for_is_read() {
        assert_eq!(steps("1e-6:4e-6:3").unwrap().0.len(), 3);
        assert_eq!(steps("1e-6:1e-4").unwrap().0.len(), 12);
        assert_eq!(steps("1us:4us:3"), steps("1e-6:4e-6:3"));
        for wrong in ["1e-4:1e-6", "1e-6", "0:1", "1e-6:1e-4:1", "a:b", "1:2:3:4"] {
            assert!(steps(wrong).is_err(), "{wrong}");
        }
        assert_eq!(extrapolation("linear"), Ok(Extrapolation::Linear));
        assert!(motion("square").is_err() && tolerance("0").is_err());
    }
}
