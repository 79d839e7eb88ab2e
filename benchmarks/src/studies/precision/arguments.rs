//! Arguments of `precision`.

use super::plan::Plan;
use crate::cli::arguments::{AnyReference, BoundedOutput, BudgetedOutput};
use crate::cli::values::{DEFAULT_REPEATS, metric, number, time};
use clap::{Arg, Args};
use gearbench_reports::Metric;

const EXAMPLES: &str = "\
Examples:
  gearbench precision spur_impact                     every model, integrator, step and number of modes of its study
  gearbench precision spur_impact --metric force-aligned,peak,rebound
  gearbench precision rack_pinion --against fe-nodes --models elastic-nodes,fe-nodes
  gearbench precision hammer --integrators rk4,dopri5 --steps 500ns,1us,2us --rtols 1e-3,1e-5
  gearbench precision my_scene.toml --modes 0,25,100 --timeout 10

Every model runs under every integrator at a series of steps or tolerances, the coarsest of which may fail. Elastic
models also run with a series of mode counts. The error against the model's own converged solution is the error of the
integrator; the error against a reference is that of the model. Failed and timed-out runs are rows of the tables and
crosses at the edge of the charts. The cost is the processor time without set-up; the counts of steps, force
evaluations and factorisations are recorded as well.

References are the stored reference of the scene and its models `fe` with a fine step. Each model is compared with the
references that have its contact. Without a reference, the elastic model with the most modes serves as one. A
reference named with --against applies to all models, and the report states where contacts differ.

If a run exceeds --timeout, runs of its model and integrator with finer resolution are left out. References and
converged solutions have a limit on their steps instead: if a solution exceeds it, the next coarser tolerance is used,
and the finding reports this.

Metrics: force, force-aligned, peak, impulse, rebound, transmission-error, angle, torque, torque-peak, energy; or
their keys in results.json.

Defaults come from [study] precision of the scene. Results besides report and record (--out DIR, default
out/SCENE/precision/):
  precision.csv   one line per run and reference: errors, cost, work, whether it is on the Pareto front";

/// Default limit on the processor time of one run [s].
const TIMEOUT: &str = "20";

/// Compute error and cost of every model, integrator and resolution of a scene, and the Pareto front
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES, mut_args = with_timeout)]
pub struct Precision {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Models of the scene by label, separated by commas [default: the models of its study]
    #[arg(long, value_name = "A,B")]
    pub models: Option<String>,
    /// What is compared, and with what.
    #[command(flatten)]
    pub asked: PrecisionOptions,
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub bounded: BoundedOutput,
    /// Least number of timed repetitions of each run; short runs are repeated more often
    #[arg(long, value_name = "N", default_value_t = DEFAULT_REPEATS, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeats: u32,
    /// How long the whole study may take.
    #[command(flatten)]
    pub budget: BudgetedOutput,
    /// Whether a reference of other gears will do.
    #[command(flatten)]
    pub insist: AnyReference,
    /// Variants, references and metrics, once the scene is known.
    #[arg(skip)]
    pub(super) plan: Plan,
}

fn with_timeout(argument: Arg) -> Arg {
    match argument.get_id() == "timeout" {
        true => argument.default_value(TIMEOUT),
        false => argument,
    }
}

/// What the command line asks for; what it leaves out is the scene's.
#[derive(Args, Clone, Debug, Default)]
pub struct PrecisionOptions {
    /// Metrics separated by commas, the main one first [default: the metric of the scene's tolerance]
    #[arg(long = "metric", visible_alias = "metrics", value_name = "M,N", value_delimiter = ',', value_parser = metric)]
    pub metrics: Vec<Metric>,
    /// References separated by commas: the stored one by its program (calculix), a model `fe` or `elastic` by its label
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    pub against: Vec<String>,
    /// Integrators separated by commas: id or id(name=value); @STEP or @RTOL gives one resolution in place of the
    /// series
    ///
    /// A value with a unit of time is a step (rk4@500ns, trigonometric@1us), a bare number a step in seconds for
    /// methods with fixed steps and a tolerance for adaptive ones. [default: the integrators of the scene]
    #[arg(long, value_name = "X,Y")]
    pub integrators: Option<String>,
    /// Numbers of modes per gear of elastic models, separated by commas
    #[arg(long, value_name = "N,M", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(0..=2000))]
    pub modes: Vec<u32>,
    /// Steps of methods with fixed steps, separated by commas, such as 500ns,1us,2e-6
    #[arg(long, value_name = "H,H", value_delimiter = ',', value_parser = time)]
    pub steps: Vec<f64>,
    /// Tolerances of adaptive methods, separated by commas
    #[arg(long, value_name = "R,R", value_delimiter = ',', value_parser = tolerance)]
    pub rtols: Vec<f64>,
}

fn tolerance(text: &str) -> Result<f64, String> {
    let expected = "expected a tolerance between 0 and 1, for example 1e-6";
    number(text, |x| *x > 0.0 && *x < 1.0, expected)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::study_command::StudyCommand;
    use crate::cli::{Cli, Command};
    use clap::Parser;

    fn parse(arguments: &str) -> Result<Precision, clap::Error> {
        let all = ["gearbench", "precision"].into_iter();
        match Cli::try_parse_from(all.chain(arguments.split_whitespace()))?.command {
            Some(Command::Study(StudyCommand::Precision(p))) => Ok(p),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn lists_and_units() {
        let steps = "--steps 500ns,1us,2e-6 --rtols 1e-3,1e-5 --modes 0,35";
        let metrics = "--metric force-aligned,peak,energy_drift_rel";
        let p = parse(&format!("hammer {steps} {metrics}")).unwrap();
        assert_eq!(p.bounded.timeout, 20.0);
        assert_eq!(p.asked.steps, [500.0 * 1e-9, 1e-6, 2e-6]);
        assert_eq!(
            (p.asked.rtols, p.asked.modes),
            (vec![1e-3, 1e-5], vec![0, 35])
        );
        let metrics = [
            Metric::ForceL2Aligned,
            Metric::PeakForceRel,
            Metric::EnergyDrift,
        ];
        assert_eq!(p.asked.metrics, metrics);
        let wrong =
            "--steps fast|--steps -1us|--rtols 2|--modes -1|--timeout 0|--metric farce|--metric ,";
        for wrong in wrong.split('|') {
            let e = parse(&format!("hammer {wrong}")).unwrap_err();
            assert_eq!(e.exit_code(), 2, "{wrong}");
        }
        assert!(parse("").is_err());
    }
}
