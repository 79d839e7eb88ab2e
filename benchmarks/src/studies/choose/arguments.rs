//! Arguments of `choose`.

use crate::cli::arguments::{BoundedOutput, BudgetedOutput};
use crate::cli::values::{metric, number};
use clap::Args;
use gearbench_reports::Metric;

const EXAMPLES: &str = "\
Examples:
  gearbench choose spur_impact --metric force-aligned --tolerance 0.05
  gearbench choose hammer --metric impulse --tolerance 0.02
  gearbench choose my_scene.toml --metric peak --tolerance 0.1 --out out/peak
  gearbench choose my_scene.toml --references      also compare the choice with the references
  gearbench choose my_scene.toml --runs 1000       for many runs of the scene, which share the set-up
  gearbench choose my_scene.toml --timeout 5 --budget 60

The study runs no transient simulation with full finite elements. It refines a hierarchy of models on a short part of
the scene and estimates errors from the differences between the levels. Levels differ in modes, contact and mesh; the
contact uses half-spaces where the flanks permit it. The yardstick of all models is a model of elastic gears with
twice the elements. The folder contains chosen.toml, the scene with the choice: `gearbench compare
out/SCENE/choose/chosen.toml --out out/chosen` runs it. Candidates that --budget excludes are listed, and the choice
is made among the others. The judgement of a level includes the error of the yardstick: a level is adequate if both
errors together are within the tolerance, not adequate if its error exceeds the tolerance by more than the error of
the yardstick, and undecided otherwise. Exit code 1 means that no level is adequate or that the result is undecided:
the error of the yardstick is too large, the history does not repeat, or the error against a reference (--references)
exceeds the tolerance.";

/// Arguments of `choose`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Choose {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Metric of the tolerance: force, force-aligned, peak, impulse, rebound, transmission-error or energy
    #[arg(long, value_name = "METRIC", default_value = "force-aligned", value_parser = of_models)]
    pub metric: Metric,
    /// Largest permissible relative error of the metric, 0.05 for 5 %
    #[arg(long, value_name = "T", default_value_t = 0.05, value_parser = tolerance)]
    pub tolerance: f64,
    /// Also run the choice over the whole scene, at the speeds and loads of each reference, and compare it with the
    /// references
    #[arg(long)]
    pub references: bool,
    /// Planned number of runs of the scene; the cheapest candidate has the least processor time for one set-up and all
    /// these runs
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    pub runs: u64,
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub run: BoundedOutput,
    /// How long the whole study may take.
    #[command(flatten)]
    pub budget: BudgetedOutput,
}

/// A metric that one model can be held against another in.
fn of_models(text: &str) -> Result<Metric, String> {
    let found = metric(text)?;
    match found.is_of_measurements() {
        false => Ok(found),
        true => Err(format!(
            "`{text}` is defined for references only, but a choice compares models: use a metric of the force, and compare the choice with references by --references"
        )),
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    let expected = "expected a number between 0 and 1; 0.05 allows an error of 5 %";
    number(text, |x| *x > 0.0 && *x < 1.0, expected)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::study_command::StudyCommand;
    use crate::cli::{Cli, Command};
    use clap::Parser;

    #[test]
    fn wishes_from_the_command_line() {
        let parse = |args: &[&str]| Cli::try_parse_from([&["gearbench", "choose"], args].concat());
        let given = parse(&["hammer", "--metric", "peak", "--tolerance", "0.02"]).unwrap();
        let Some(Command::Study(StudyCommand::Choose(c))) = given.command else {
            panic!("another command");
        };
        assert_eq!((c.metric, c.tolerance), (Metric::PeakForceRel, 0.02));
        for (bad, says) in [
            (["hammer", "--metric", "velocity"], "force-aligned"),
            (["hammer", "--metric", "torque"], "--references"),
            (["hammer", "--tolerance", "5"], "between 0 and 1"),
        ] {
            let e = parse(&bad).unwrap_err();
            assert_eq!(e.exit_code(), 2);
            assert!(e.to_string().contains(says), "{e}");
        }
    }
}
