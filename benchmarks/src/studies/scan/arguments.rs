//! Arguments of `scan` and `merge`.

use super::axis::Axis;
use super::design::Design;
use super::output::Output;
use crate::cli::arguments::{BoundedOutput, Output as Folder};
use crate::cli::values::DEFAULT_SCENE;
use clap::Args;
use gearbench_reports::scan::Sampling;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench scan spur_impact --vary gears.pinion.speed_rad_s=10..100:10 --models rigid
  gearbench scan pair.toml --vary 'meshes.1.backlash_m=normal(80e-6,5e-6)' --samples 200
  gearbench scan pair.toml --vary 'models.*.contact.friction.mu=0.02,0.05,0.1' --outputs efficiency,peak_force_n
  gearbench scan pair.toml --vary 'gears.pinion.deviations.class=6,8' --vary 'gears.pinion.deviations.seed=seeds(200)'
  gearbench scan spur_impact --vary 'gears.pinion.speed_rad_s | duration_s = 20 | 4e-4, 40 | 2e-4'
  gearbench scan pair.toml --vary 'gears.*.face_width_m=uniform(0.01,0.02)' ... --samples 1024 --indices
  gearbench scan spur_impact --models rigid --against elastic --vary gears.pinion.speed_rad_s=10..100:10
  gearbench scan pair.toml ... --shard 3/50 --out shards/3          then: gearbench merge shards/* --out all

Values of a key: a list (1,2,5), FROM..TO:N, FROM..TO:N:log, or a distribution: uniform(FROM,TO), loguniform(FROM,TO),
normal(MEAN,DEVIATION), lognormal(MEDIAN,SIGMA), triangular(LEAST,MOST_LIKELY,GREATEST), integers(FROM,TO), seeds(N), seeds(FROM,TO).
Listed values are combined with each other; distributions are sampled. A key is the path of a key in the scene file:
entries of lists by label, name or number from 1, * for all entries; a key that the scene does not have is added.

A cell is a scene with its values; every model runs in it under its integrator. Runs that fail, and scenes that are
refused, are rows. Results besides report and record (--out DIR, default out/SCENE/scan/):
  cells.csv            one row per run: cell, values of the keys, model, integrator, status, outputs
  timings.csv          processor time of each run
  scan_statistics.csv  statistics over the samples
  scan_indices.csv     sensitivity indices (--indices)";

/// Arguments of `scan`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Scan {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Key of the scene and its values; may be given several times
    #[arg(long, value_name = "KEY=VALUES", required = true)]
    pub vary: Vec<Axis>,
    /// Number of samples of the distributions
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub samples: Option<u64>,
    /// How distributions are sampled: sobol (scrambled Sobol sequence), latin (Latin hypercube) or random
    #[arg(long, value_name = "KIND", default_value_t = Sampling::Sobol)]
    pub sampling: Sampling,
    /// Seed of the samples
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
    /// Compute Sobol indices: shares of the variance of each output that the keys cause; takes samples times (number of
    /// distributions + 2) cells
    #[arg(long)]
    pub indices: bool,
    /// Models of the scene by label, separated by commas [default: the models of its study]
    #[arg(long, value_name = "A,B")]
    pub models: Option<String>,
    /// Integrators separated by commas: id or id(name=value), optionally with @STEP or @RTOL [default: of those
    /// of the scene for each model, the first adaptive one, else the first]
    #[arg(long, value_name = "X,Y")]
    pub integrators: Option<String>,
    /// Quantities of a run, separated by commas: keys of metrics, speeds_end, efficiency, steps [default: peak_force_n, rms_force_n,
    /// impulse_ns, transmission_error_pp_m; with --against also errors]
    #[arg(long, value_name = "Q,R", value_delimiter = ',')]
    pub outputs: Vec<Output>,
    /// Label of a model that runs first in every cell, and that the errors of the others refer to
    #[arg(long, value_name = "LABEL")]
    pub against: Option<String>,
    /// Run part I of N parts only; `gearbench merge` joins the parts
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub shard: Option<[u64; 2]>,
    /// Number of threads [default: number of processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub run: BoundedOutput,
}

impl Scan {
    /// The design that the arguments state.
    ///
    /// # Errors
    /// A sentence with what was expected.
    pub fn design(&self) -> Result<Design, String> {
        let samples = self.samples.map(|n| n as usize);
        Design::new(
            self.vary.clone(),
            (self.sampling, samples, self.seed),
            self.indices,
        )
    }
}

fn shard(text: &str) -> Result<[u64; 2], String> {
    let parts = text
        .split_once('/')
        .and_then(|(i, n)| Some([i.parse().ok()?, n.parse().ok()?]));
    let holds = |[i, n]: &[u64; 2]| (1..=*n).contains(i) && *n <= 1_000_000_000;
    parts
        .filter(holds)
        .ok_or_else(|| "expected I/N with I from 1 to N, for example 3/50".into())
}

const MERGE_EXAMPLES: &str = "\
Examples:
  gearbench merge shards/* --out out/pair/scan
  for i in $(seq 50); do gearbench scan pair.toml ... --shard $i/50 --out shards/$i; done; gearbench merge shards/*

The result is that of the scan in one piece, byte for byte, but for times. A part that is missing, doubled or of another
scan (another scene, version, seed or option) is named, and nothing is written. Rows are copied one by one: the memory
does not grow with their number.";

/// Arguments of `merge`.
#[derive(Args, Clone, Debug)]
#[command(after_help = MERGE_EXAMPLES)]
pub struct Merge {
    /// Folders of all parts of a scan, in any order
    #[arg(value_name = "FOLDER", required = true)]
    pub parts: Vec<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: Folder,
}
