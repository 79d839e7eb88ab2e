//! Arguments of `choose`.

use crate::cli::arguments::{Bounded, Budgeted};
use crate::cli::values::{metric, number};
use clap::Args;
use gearbench_reports::Metric;

const EXAMPLES: &str = "\
Examples:
  gearbench choose spur_impact --metric force-aligned --tolerance 0.05
  gearbench choose hammer --metric impulse --tolerance 0.02
  gearbench choose my_scene.toml --metric peak --tolerance 0.1 --out out/peak
  gearbench choose my_scene.toml --references      and compare what was chosen with what was measured
  gearbench choose my_scene.toml --runs 1000       for many runs of the scene, over which the set-up is distributed
  gearbench choose my_scene.toml --timeout 5 --budget 60

No finite-element transient runs: a hierarchy of models is refined on a short part of the scene, and differences between
its levels estimate the errors. Modes, contact and mesh are levels of it: flanks touch on half-spaces where they may, and
all models are compared with elastic gears of twice the elements, the yardstick. The folder holds chosen.toml, the scene with the choice written in:
`gearbench compare out/SCENE/choose/chosen.toml --out out/chosen` runs it. What --budget leaves untried is listed, and the
answer is of what was tried. Every level is judged with the yardstick's own error: adequate where both together keep the
tolerance, not adequate where the error is beyond it by more than that, else not decided. Exit code 1 says that nothing is adequate, or
that it is not decided: the yardstick is too far off itself, the history does not repeat, or a reference (--references) is
further from the choice than was asked for.";

/// Arguments of `choose`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Choose {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// What has to be right: force, force-aligned, peak, impulse, rebound, transmission-error or energy
    #[arg(long, value_name = "METRIC", default_value = "force-aligned", value_parser = of_models)]
    pub metric: Metric,
    /// Largest relative error in it that is accurate enough, 0.05 for 5 %
    #[arg(long, value_name = "T", default_value_t = 0.05, value_parser = tolerance)]
    pub tolerance: f64,
    /// Also run the choice over the whole scene, at the speeds and loads of each reference of the scene, and hold it against
    /// these
    #[arg(long)]
    pub references: bool,
    /// Number of runs of the scene that are planned: the cheapest is the one with the least processor time of one set-up and
    /// so many runs
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    pub runs: u64,
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub run: Bounded,
    /// How long the whole study may take.
    #[command(flatten)]
    pub budget: Budgeted,
}

/// A metric that one model can be held against another in.
fn of_models(text: &str) -> Result<Metric, String> {
    let found = metric(text)?;
    match found.is_of_measurements() {
        false => Ok(found),
        true => Err(format!(
            "`{text}` is told of references alone, and choices are estimated between models: ask for a force, and hold the choice against references with --references"
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
            (["hammer", "--metric", "speed"], "force-aligned"),
            (["hammer", "--metric", "torque"], "--references"),
            (["hammer", "--tolerance", "5"], "between 0 and 1"),
        ] {
            let e = parse(&bad).unwrap_err();
            assert_eq!(e.exit_code(), 2);
            assert!(e.to_string().contains(says), "{e}");
        }
    }
}
