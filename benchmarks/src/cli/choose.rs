//! Arguments of `choose`.

use crate::study::choose::Metric;
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench choose spur_impact --metric force-aligned --tolerance 0.05
  gearbench choose hammer --metric impulse --tolerance 0.02
  gearbench choose my_scene.toml --metric peak --tolerance 0.1 --out out/peak
  gearbench choose --draw tuning:7 > scene.toml      scene 7 of the set `tuning`, drawn at random
  gearbench choose --check tuning --scenes 1..12     judge choices against all candidates, tried one by one
  gearbench choose --check held-out --threads 2

No finite-element transient runs: a ladder of models is climbed on a short part of the scene, and differences between
its rungs estimate the errors. The folder holds chosen.toml, the scene with the choice written in:
`gearbench compare out/SCENE/choose/chosen.toml` runs it. Exit code 1 says that nothing is adequate.

Sets of random scenes and their seeds stand in benchmarks/choose/sets.toml; those of `held-out` were never looked at
while the rules of the choice were made.";

/// Arguments of `choose`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Choose {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(required_unless_present_any = ["check", "draw"], conflicts_with_all = ["check", "draw"])]
    pub scene: Option<String>,
    /// What has to be right: force, force-aligned, peak, impulse, rebound, transmission-error or energy
    #[arg(long, value_name = "METRIC", default_value = "force-aligned", value_parser = metric)]
    pub metric: Metric,
    /// Largest relative error in it that is accurate enough, 0.05 for 5 %
    #[arg(long, value_name = "T", default_value_t = 0.05, value_parser = tolerance)]
    pub tolerance: f64,
    /// Folder to write to [default: out/SCENE/choose]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    /// Judging on random scenes.
    pub check: ChoiceCheck,
}

/// Judging choices on random scenes.
#[derive(Args, Clone, Debug)]
pub struct ChoiceCheck {
    /// Judge the choice on a set of random scenes, `tuning` or `held-out`
    #[arg(long, value_name = "SET")]
    pub check: Option<String>,
    /// Scenes of the set, from the first to the last [default: all]
    #[arg(long, value_name = "A..B", requires = "check", value_parser = range)]
    pub scenes: Option<[usize; 2]>,
    /// Scenes that are judged at the same time
    #[arg(long, value_name = "N", requires = "check", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub threads: u32,
    /// Print a random scene as a scene file, for example tuning:7
    #[arg(long, value_name = "SET:NUMBER", conflicts_with = "check", value_parser = one)]
    pub draw: Option<(String, usize)>,
}

fn range(text: &str) -> Result<[usize; 2], String> {
    let (a, b) = text.split_once("..").unwrap_or((text, text));
    match (a.trim().parse(), b.trim().parse()) {
        (Ok(a), Ok(b)) if 1 <= a && a <= b => Ok([a, b]),
        _ => Err("expected two numbers from 1 on, for example 1..12, both ends included".into()),
    }
}

fn one(text: &str) -> Result<(String, usize), String> {
    let parts = text.split_once(':');
    match parts.map(|(set, number)| (set, number.trim().parse())) {
        Some((set, Ok(number))) if !set.is_empty() => Ok((set.to_owned(), number)),
        _ => Err("expected a set and a number, for example tuning:7".into()),
    }
}

fn metric(text: &str) -> Result<Metric, String> {
    Metric::named(text.trim()).ok_or_else(|| {
        let known = Metric::ALL.map(Metric::name);
        format!("expected one of {}", known.join(", "))
    })
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x > 0.0 && x < 1.0 => Ok(x),
        _ => Err("expected a number between 0 and 1; 0.05 allows an error of 5 %".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Cli, Command};
    use clap::Parser;

    #[test]
    fn wishes_from_the_command_line() {
        let parse = |args: &[&str]| Cli::try_parse_from([&["gearbench", "choose"], args].concat());
        let given = parse(&["hammer", "--metric", "peak", "--tolerance", "0.02"]).unwrap();
        let Some(Command::Choose(c)) = given.command else {
            panic!("another command");
        };
        assert_eq!((c.metric, c.tolerance), (Metric::Peak, 0.02));
        for (bad, says) in [
            (["hammer", "--metric", "speed"], "force-aligned"),
            (["hammer", "--tolerance", "5"], "between 0 and 1"),
        ] {
            let e = parse(&bad).unwrap_err();
            assert_eq!(e.exit_code(), 2);
            assert!(e.to_string().contains(says), "{e}");
        }
    }
}
