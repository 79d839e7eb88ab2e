//! The command line.

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench-validation sample tuning:7 > scene.toml     scene 7 of the set `tuning`
  gearbench-validation run tuning --scenes 1..12        compare choices with runs of all candidates
  gearbench-validation reduction reduction              compare elastic gears with full finite elements
  gearbench-validation run held-out --threads 2         use a set that was not used for development
  gearbench-validation coverage --model movable-teeth   do confidence intervals contain the true constants?
  gearbench-validation agreement                        do compare and choose contradict each other?
  gearbench-validation combinations                     which models, mounts, contacts and studies work together?
  gearbench-validation figures impact                   measure the figures of one source for the documents
  gearbench-validation summary damped.csv                print counts and ranges of stored results
  gearbench-validation identification                   compare constants with finite elements at other speeds

Exit code 1 means that fewer than 95 % of the choices are right, or that the median cost of the choices is more than
twice that of the cheapest adequate candidates.";

/// Are the choices of `gearbench choose` right? Validation on random scenes.
///
/// The file validation/sets.toml contains the seeds of the sets. On every scene all candidates are compared with a
/// reference over the whole scene, and the choice is compared with the cheapest candidate within the tolerance.
#[derive(Clone, Debug, Parser)]
#[command(name = "gearbench-validation", version, after_help = EXAMPLES, max_term_width = 100)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Print a random scene as a scene file
    Sample {
        /// The scene, for example tuning:7
        #[arg(value_name = "SET:NUMBER", value_parser = one)]
        scene: (String, usize),
    },
    /// Validate the choices on a set of random scenes
    Run(Run),
    /// Compare elastic gears with full finite elements on a set of random scenes
    Reduction(Reduction),
    /// Check that 95 % intervals of identified constants contain the true constants of synthetic data
    Coverage(Coverage),
    /// Run `compare` and `choose` on random scenes and compare their results
    Agreement(Agreement),
    /// Examine which toothings, mounts, models, contacts, integrators and studies work together, and write the table
    Combinations(Combinations),
    /// Compare identified constants with finite elements at other speeds, and with other stiffness formulas
    Identification(Identification),
    /// Measure the figures that README and book quote, store them, and write them into the documents
    Figures(Figures),
    /// Print counts and ranges of stored results, as the documents quote them
    Summary {
        /// Files of one kind: records of `run`, tables of `reduction`, `coverage` or `agreement`, numbers of benches, or
        /// Markdown
        #[arg(value_name = "FILE", required = true)]
        files: Vec<PathBuf>,
    },
}

/// Arguments of `agreement`.
#[derive(Args, Clone, Debug)]
pub struct Agreement {
    /// First and last scene [default: all 40]
    #[arg(long, value_name = "A..B", value_parser = range)]
    pub scenes: Option<[usize; 2]>,
    /// Folder for scenes, records and the table
    #[arg(long, value_name = "DIR", default_value = "out/agreement")]
    pub out: PathBuf,
}

/// Arguments of `combinations`.
#[derive(Args, Clone, Debug)]
pub struct Combinations {
    /// Run the scenes under the integrators alone, without the studies
    #[arg(long)]
    pub without_studies: bool,
    /// Examine the combinations with these words alone, separated by commas, such as helical,carrier,penalty
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Table to write; the list of reasons stands next to it
    #[arg(long, value_name = "FILE", default_value = "combinations.csv")]
    pub out: PathBuf,
}

/// Arguments of `figures`.
#[derive(Args, Clone, Debug)]
pub struct Figures {
    /// Sources of validation/figures.toml [default: all]
    #[arg(value_name = "SOURCE")]
    pub sources: Vec<String>,
    /// Write the stored figures into the documents, without measuring
    #[arg(long, conflicts_with = "sources")]
    pub text: bool,
}

/// Arguments of `coverage`.
#[derive(Args, Clone, Debug)]
pub struct Coverage {
    /// A shipped scene with a stored reference
    #[arg(default_value = "spur_impact")]
    pub scene: String,
    /// A model with a calibration
    #[arg(long, value_name = "LABEL", default_value = "movable-teeth")]
    pub model: String,
    /// Number of synthetic data sets
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub sets: u32,
    /// Seed of noise and offsets
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Table to write
    #[arg(long, value_name = "FILE", default_value = "coverage.csv")]
    pub out: PathBuf,
}

/// Arguments of `identification`.
#[derive(Args, Clone, Debug)]
pub struct Identification {
    /// Shipped scenes with finite elements
    #[arg(default_values = ["spur_impact", "rack_pinion"])]
    pub scenes: Vec<String>,
    /// Tables to write, in Markdown
    #[arg(long, value_name = "FILE", default_value = "identification.md")]
    pub out: PathBuf,
}

/// Arguments of `reduction`.
#[derive(Args, Clone, Debug)]
pub struct Reduction {
    /// A set of validation/sets.toml
    pub set: String,
    /// First and last scene of the set [default: all]
    #[arg(long, value_name = "A..B", value_parser = range)]
    pub scenes: Option<[usize; 2]>,
    /// Damping ratio of the mesh mode of both models; scenes without loads are then left out [default: undamped]
    #[arg(long, value_name = "RATIO")]
    pub mesh_ratio: Option<f64>,
    /// Table to write
    #[arg(long, value_name = "FILE", default_value = "reduction.csv")]
    pub out: PathBuf,
}

/// Numbers of scenes, ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scenes(pub Vec<usize>);

/// Arguments of `run`.
#[derive(Args, Clone, Debug)]
pub struct Run {
    /// A set of validation/sets.toml
    pub set: String,
    /// Scenes of the set, for example 1..5,18 [default: all]
    #[arg(long, value_name = "A..B,C", value_parser = list)]
    pub scenes: Option<Scenes>,
    /// Number of scenes, the first with one impact, to compare with full finite elements [default: the number of the
    /// set]
    #[arg(long, value_name = "N")]
    pub full_order: Option<usize>,
    /// Number of scenes that are validated simultaneously
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub threads: u32,
    /// Folder to write to [default: out/SET/choice-check]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Repeat all scenes, including those in the journal of the folder
    #[arg(long)]
    pub fresh: bool,
}

fn range(text: &str) -> Result<[usize; 2], String> {
    let (a, b) = text.split_once("..").unwrap_or((text, text));
    match (a.trim().parse(), b.trim().parse()) {
        (Ok(a), Ok(b)) if 1 <= a && a <= b => Ok([a, b]),
        _ => Err(
            "expected two numbers, at least 1, for example 1..12 with both ends included".into(),
        ),
    }
}

fn list(text: &str) -> Result<Scenes, String> {
    let mut all = Vec::new();
    for part in text.split(',') {
        let [first, last] = range(part)?;
        all.extend(first..=last);
    }
    all.sort_unstable();
    all.dedup();
    Ok(Scenes(all))
}

fn one(text: &str) -> Result<(String, usize), String> {
    let parts = text.split_once(':');
    match parts.map(|(set, number)| (set, number.trim().parse())) {
        Some((set, Ok(number))) if !set.is_empty() => Ok((set.to_owned(), number)),
        _ => Err("expected a set and a number, for example tuning:7".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line() {
        Cli::command().debug_assert();
        let parse = |args: &[&str]| Cli::try_parse_from([&["gearbench-validation"], args].concat());
        let Ok(Cli {
            command: Command::Run(run),
        }) = parse(&["run", "tuning", "--scenes", "18,3..5,4"])
        else {
            panic!("not understood");
        };
        assert_eq!(run.scenes, Some(Scenes(vec![3, 4, 5, 18])));
        assert_eq!(run.threads, 1);
        for wrong in [
            &["run"][..],
            &["run", "tuning", "--scenes", "5..3"],
            &["run", "tuning", "--scenes", "3,"],
            &["sample", "tuning"],
            &["sample", ":7"],
        ] {
            assert_eq!(parse(wrong).unwrap_err().exit_code(), 2);
        }
    }
}
