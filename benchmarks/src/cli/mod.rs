//! The command line: definitions and help texts. What the commands do is the studies' business.

mod choice_check;
mod choose;
mod precision;
mod stability;

pub use choose::Choose;
pub use precision::Precision;
pub use stability::Stability;

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench                                    the default comparison, the same as
  gearbench compare spur_impact
  gearbench compare hammer --models rigid      one model of a shipped scene
  gearbench compare my_scene.toml --out out/a  a scene of your own
  gearbench list                               scenes, models, integrators, references

Results (--out DIR, default out/SCENE/STUDY/, printed at the end):
  index.html    the report, self-contained, opens offline
  results.json  versioned records of all runs, failed ones included
  *.csv         time series, SI units in the header
  *.svg         the charts

Scene files are described in benchmarks/scenes/README.md.

Exit codes:
  0  done
  1  a result fell short of what was asked
  2  bad input: file, line, what was expected, a way out
  3  a run failed to finish";

/// Which gear-contact model and which integrator is just good enough for a scene, and what does it cost?
///
/// gearbench simulates one scene under several gear models and integrators, measures every run against a
/// finite-element reference and against the model's own converged solution, times it, keeps an energy and
/// an impulse ledger, and writes one report. Without a command it compares the scene spur_impact.
#[derive(Clone, Debug, Parser)]
#[command(name = "gearbench", version, after_help = EXAMPLES, max_term_width = 100)]
pub struct Cli {
    /// What to do; left out, `compare spur_impact`.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// The commands.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Compare the models and integrators of a scene, against its reference
    Compare(Compare),
    /// Error against cost of every model, integrator and resolution of a scene, with its Pareto front
    Precision(Precision),
    /// Where methods fail: maps over step size and stiffness, damping, speed or modes, with theory beside
    Stability(Stability),
    /// The cheapest model, integrator and step that keep a tolerance on a scene, and why
    Choose(Choose),
    /// Fit stiffness, tooth mass and touch time of the models to the scene's reference
    Identify(Identify),
    /// Static mesh stiffness, load sharing and transmission error of the models of a scene
    Stiffness(Stiffness),
    /// Error of the elastic model by number of modes, against full finite elements on the same mesh
    Modes(Modes),
    /// Results over the penalty of the contact, beside hard contact
    Penalty(Penalty),
    /// Run under load at speed after speed: transmission error, bearing forces, spectra, resonances
    Sweep(Sweep),
    /// Mesh the gears of a scene with hexahedra, as a deck for CalculiX or Abaqus and for ParaView
    Mesh(Mesh),
    /// Reduce gears of a deck or a scene to modes and static compliance, stored for the elastic model and for numpy
    Reduce(Reduce),
    /// List shipped scenes, gear models with their parameters, integrators and references
    List,
    /// Write the report of a results folder again
    Report(Report),
}

const COMPARE_EXAMPLES: &str = "\
Examples:
  gearbench compare spur_impact --integrators dopri5,bdf
  gearbench compare spur_impact --integrators dopri5@1e-9,rk4@200ns
  gearbench compare spur_impact --integrators 'generalised-alpha(rho_inf=0.5)@1e-6'
  gearbench compare spur_impact --models rigid,rigid-iso6336 --out out/norm
  gearbench compare hammer --no-events --repeats 1

A run that fails (blow-up, Newton failure, energy growth, ...) is a row of the report, not an abort.
Errors against the reference are those of the model, errors against `self` those of the integrator.";

/// Arguments of `compare`.
#[derive(Args, Clone, Debug)]
#[command(after_help = COMPARE_EXAMPLES)]
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
    /// Folder to write to [default: out/SCENE/compare]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Timed repeats of every run; the report shows their median and spread
    #[arg(long, value_name = "N", default_value_t = DEFAULT_REPEATS, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeats: u32,
    /// Wall-clock bound of one integration in seconds; beyond it a run is recorded as a timeout
    #[arg(long, value_name = "S", default_value_t = DEFAULT_TIMEOUT, value_parser = positive)]
    pub timeout: f64,
    /// Do not locate contact events: shows what a method loses when steps run across them
    #[arg(long)]
    pub no_events: bool,
}

/// The scene that is compared when none is named.
pub const DEFAULT_SCENE: &str = "spur_impact";
/// Timed repeats when the command line does not say.
pub const DEFAULT_REPEATS: u32 = 3;

/// Wall-clock bound of one integration [s] when the command line does not say.
pub const DEFAULT_TIMEOUT: f64 = 120.0;

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 1e6 => Ok(x),
        _ => Err("expected a positive number of seconds".into()),
    }
}

impl Default for Compare {
    /// What `gearbench` does without a command.
    fn default() -> Self {
        Compare {
            scene: DEFAULT_SCENE.to_owned(),
            models: None,
            integrators: None,
            out: None,
            repeats: DEFAULT_REPEATS,
            timeout: DEFAULT_TIMEOUT,
            no_events: false,
        }
    }
}

const IDENTIFY_EXAMPLES: &str = "\
Examples:
  gearbench identify spur_impact                    fit and print, with 95 % confidence intervals
  gearbench identify spur_impact --model rigid
  gearbench identify spur_impact --write            also write the calibration file

The scene needs a reference. With --write the constants go to the calibration file that models with
`calibration = \"impact\"` read: NAME.calibration.toml beside a scene file, and for a shipped scene
benchmarks/calibrations/NAME.toml (run it in the repository and build again: it is embedded).";

/// Arguments of `identify`.
#[derive(Args, Clone, Debug)]
#[command(after_help = IDENTIFY_EXAMPLES)]
pub struct Identify {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Fit this model only [default: every model with a calibration]
    #[arg(long, value_name = "LABEL")]
    pub model: Option<String>,
    /// Write the calibration file of the scene
    #[arg(long)]
    pub write: bool,
}

const STIFFNESS_EXAMPLES: &str = "\
Examples:
  gearbench stiffness spur_impact --models fe       finite elements, ISO 6336-1, analytic tooth compliance
  gearbench stiffness spur_impact --load 100        at 100 N per mm of face width
  gearbench stiffness my_scene.toml --torque 80 --positions 48 --out out/te

Both hubs are held: the first gear is turned until it carries the load, at positions over one base pitch. Mounts,
loads, speeds, damping and friction of the scene play no part. Beside the models stand the stiffness of ISO 6336-1
and the analytic compliance of the same gears.

Results (--out DIR, default out/SCENE/stiffness/):
  stiffness.csv      one line per model
  cycle_MODEL.csv    transmission error, stiffness and load of each tooth pair by position
  stiffness.svg      the chart";

/// Arguments of `stiffness`.
#[derive(Args, Clone, Debug)]
#[command(after_help = STIFFNESS_EXAMPLES)]
pub struct Stiffness {
    /// Name of a shipped scene, or path of a scene file (.toml), with two gears
    pub scene: String,
    /// Models of the scene by label, between commas [default: those of its study]
    #[arg(long, visible_alias = "model", value_name = "A,B")]
    pub models: Option<String>,
    /// Load along the line of action over the common face width [N/mm]
    #[arg(long, value_name = "N_PER_MM", default_value_t = DEFAULT_LOAD, value_parser = positive_load)]
    pub load: f64,
    /// Torque on the first gear [N m], in place of --load
    #[arg(long, value_name = "NM", conflicts_with = "load", value_parser = positive_load)]
    pub torque: Option<f64>,
    /// Positions over one base pitch
    #[arg(long, value_name = "N", default_value_t = DEFAULT_POSITIONS, value_parser = positions)]
    pub positions: usize,
    /// Folder to write to [default: out/SCENE/stiffness]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Load over the width [N/mm] when the command line does not say.
pub const DEFAULT_LOAD: f64 = 300.0;
/// Positions over a base pitch when the command line does not say.
pub const DEFAULT_POSITIONS: usize = 24;

fn positive_load(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 1e9 => Ok(x),
        _ => Err("expected a positive number".into()),
    }
}

fn positions(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(n) if (2..=2000).contains(&n) => Ok(n),
        _ => Err("expected a whole number from 2 to 2000".into()),
    }
}

const MODES_EXAMPLES: &str = "\
Examples:
  gearbench modes                                   the scene spur_impact
  gearbench modes spur_impact_large --counts 0,25,50,100
  gearbench modes my_scene.toml --models elastic,fe --no-refine

Runs the elastic model with few and many modes, chosen by frequency and by flank compliance, with the cut modes kept as
residual compliance and plainly truncated (at 80 kHz and with 200 modes, as published, among others), and holds every
run against full finite elements on the same mesh, computed once, and against the scene's reference.

The scene needs an elastic model and a model `fe` on the same mesh with the same contact. Integrators are those of the
two; plain truncation takes those of an elastic model with `residual = false`, if the scene has one.";

/// Arguments of `modes`.
#[derive(Args, Clone, Debug)]
#[command(after_help = MODES_EXAMPLES)]
pub struct Modes {
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
    /// Folder to write to [default: out/SCENE/modes]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Timed repeats of every run
    #[arg(long, value_name = "N", default_value_t = DEFAULT_REPEATS, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeats: u32,
    /// Wall-clock bound of one integration in seconds
    #[arg(long, value_name = "S", default_value_t = DEFAULT_TIMEOUT, value_parser = positive)]
    pub timeout: f64,
}

const PENALTY_EXAMPLES: &str = "\
Examples:
  gearbench penalty                                  the elastic gears of spur_impact, points at nodes
  gearbench penalty spur_impact --from 1e14 --to 1e16 --points 5
  gearbench penalty my_scene.toml --model elastic --hard elastic-without-penalty

Runs one model with penalty after penalty and finds its static transmission error under --load. The same model with hard
contact, if the scene has one (--hard, or the label with -hard behind it), is the limit that all are held against. Points
must be of one kind: a penalty at nodes comes to hard contact at nodes, not to that of averaged gaps.";

/// Arguments of `penalty`.
#[derive(Args, Clone, Debug)]
#[command(after_help = PENALTY_EXAMPLES)]
pub struct Penalty {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// The model by label [default: the first with a hard twin LABEL-hard, else `elastic`]
    #[arg(long, value_name = "LABEL")]
    pub model: Option<String>,
    /// The same model with hard contact by label [default: LABEL-hard, if the scene has it]
    #[arg(long, value_name = "LABEL")]
    pub hard: Option<String>,
    /// Softest penalty [Pa/m]
    #[arg(long, value_name = "PA_PER_M", default_value_t = 1e13, value_parser = penalty)]
    pub from: f64,
    /// Stiffest penalty [Pa/m]
    #[arg(long, value_name = "PA_PER_M", default_value_t = 1e17, value_parser = penalty)]
    pub to: f64,
    /// Number of penalties, evenly over the decades
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub points: u32,
    /// Load of the static equilibria over the common face width [N/mm]
    #[arg(long, value_name = "N_PER_MM", default_value_t = DEFAULT_LOAD, value_parser = positive_load)]
    pub load: f64,
    /// Positions of the static cycle over one base pitch
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = positions)]
    pub positions: usize,
    /// Folder to write to [default: out/SCENE/penalty]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Wall-clock bound of one integration in seconds
    #[arg(long, value_name = "S", default_value_t = DEFAULT_TIMEOUT, value_parser = positive)]
    pub timeout: f64,
}

fn penalty(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 1e25 => Ok(x),
        _ => Err("expected a positive number of Pa/m, for example 1e15".into()),
    }
}

const SWEEP_EXAMPLES: &str = "\
Examples:
  gearbench sweep                                    the scene loaded_mesh
  gearbench sweep loaded_mesh --models rigid --points 100
  gearbench sweep my_scene.toml --from 200 --to 6000 --out out/run_up

At every speed each model runs until it has settled; then transmission error, contact force and bearing forces are taken
over whole mesh cycles. The static transmission error under the same load is the limit of slow running; models `fe` of
the scene stand beside it at rest.

The scene has one mesh of two gears with constant torques that press the flank of its start: on both gears in balance,
or on one while the other is driven. Speeds are those of [study] sweep in the scene; without, around the mesh resonance.

Results (--out DIR, default out/SCENE/sweep/), beside report and record:
  sweep.csv         one line per speed: transmission error, forces, harmonics
  sweep_cycles.csv  one mean mesh cycle of each run
  statics.csv       the static transmission error";

/// Arguments of `sweep`.
#[derive(Args, Clone, Debug)]
#[command(after_help = SWEEP_EXAMPLES)]
pub struct Sweep {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = "loaded_mesh")]
    pub scene: String,
    /// Models of the scene by label, between commas [default: those of its study]
    #[arg(long, value_name = "A,B")]
    pub models: Option<String>,
    /// Lowest mesh frequency in hertz
    #[arg(long, value_name = "HZ", value_parser = positive_load, requires = "to")]
    pub from: Option<f64>,
    /// Highest mesh frequency in hertz
    #[arg(long, value_name = "HZ", value_parser = positive_load, requires = "from")]
    pub to: Option<f64>,
    /// Number of speeds
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub points: Option<u32>,
    /// Whole mesh cycles that are measured
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub cycles: Option<u32>,
    /// Positions of the static cycle over one base pitch
    #[arg(long, value_name = "N", default_value_t = DEFAULT_POSITIONS, value_parser = positions)]
    pub positions: usize,
    /// Folder to write to [default: out/SCENE/sweep]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Wall-clock bound of one integration in seconds
    #[arg(long, value_name = "S", default_value_t = DEFAULT_TIMEOUT, value_parser = positive)]
    pub timeout: f64,
}

const MESH_EXAMPLES: &str = "\
Examples:
  gearbench mesh spur_impact                             nothing is written: sizes and quality of the meshes
  gearbench mesh spur_impact --gear pinion --out pinion.inp
  gearbench mesh spur_impact --flank 20 --fine-teeth 1,2,20 --out fine.inp --vtu fine.vtu
  gearbench mesh my_scene.toml --element C3D20R --sector --out sector.inp
  gearbench mesh old_deck.inp --vtu old_deck.vtu         quality of a mesh from elsewhere

A deck holds one gear in its own frame: axis z, tooth 1 on +x, metre. Its sets are bore, flank_1l, flank_1r, ...
(l: the counter-clockwise flank), its surfaces sflank_1l, ...; a sector also has cut_low and cut_high, where node i
of one is node i of the other turned by a pitch. Several gears make several files, NAME appended to each.";

/// Arguments of `mesh`.
#[derive(Args, Clone, Debug)]
#[command(after_help = MESH_EXAMPLES)]
pub struct Mesh {
    /// Name of a shipped scene, path of a scene file (.toml) or of a deck (.inp, .inp.gz)
    #[arg(value_name = "SCENE|DECK")]
    pub input: String,
    /// Write a deck
    #[arg(long, value_name = "F.inp")]
    pub out: Option<PathBuf>,
    /// Write a file for ParaView, with the sets and the quality of the elements
    #[arg(long, value_name = "F.vtu")]
    pub vtu: Option<PathBuf>,
    /// Only this gear [default: all]
    #[arg(long, value_name = "NAME")]
    pub gear: Option<String>,
    /// Kind of element: C3D8, C3D8I, C3D20 or C3D20R [default: C3D8I]
    #[arg(long, value_name = "KIND")]
    pub element: Option<String>,
    /// Elements along the involute flank [default: 8]
    #[arg(long, value_name = "N")]
    pub flank: Option<usize>,
    /// Elements along the fillet [default: 4]
    #[arg(long, value_name = "N")]
    pub fillet: Option<usize>,
    /// Elements on the root arc, from the fillet to the middle of the tooth space [default: 2]
    #[arg(long, value_name = "N")]
    pub root: Option<usize>,
    /// Elements across the tooth [default: 6]
    #[arg(long, value_name = "N")]
    pub across: Option<usize>,
    /// Layers of the skin under flank, fillet and root, which grow inwards [default: 2]
    #[arg(long, value_name = "N")]
    pub layers: Option<usize>,
    /// Layers from the root to the bore or the back of a rack [default: 4]
    #[arg(long, value_name = "N")]
    pub rim: Option<usize>,
    /// Layers over the face width [default: 4]
    #[arg(long, value_name = "N")]
    pub width: Option<usize>,
    /// One pitch only, for cyclic symmetry
    #[arg(long)]
    pub sector: bool,
    /// Only these teeth as fine as asked for, the others coarse; numbers from 1, between commas
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..))]
    pub fine_teeth: Vec<u32>,
}

const REDUCE_EXAMPLES: &str = "\
Examples:
  gearbench reduce gear.inp                              nothing is written: what the deck holds, modes, compliance
  gearbench reduce gear.inp.gz --modes 200 --out gear.npz
  gearbench reduce old.inp --gear wheel --mount held --max-frequency 80e3 --out wheel.npz
  gearbench reduce a.inp b.inp --modes 100 --out reduced/      one file each: reduced/a.npz, reduced/b.npz
  gearbench reduce spur_impact --modes 200 --out spur.npz      spur-pinion.npz, spur-wheel.npz

A deck from elsewhere needs hexahedra, SI units, a node set `bore` and node sets of the flanks that may touch,
`flank_1l`, `flank_1r`, ... (l: the counter-clockwise flank). Of a scene the meshes of its elastic model are taken,
with the mounts and added inertias of its gears.

What the file holds: flank nodes with normals, frequencies and mode shapes there, static compliance between the flank
nodes and towards the hub; docs/reduction-format.md describes it. The elastic model of a scene takes it by
`parameters = { reduction = \"gear.npz\" }`, paths from the folder of the scene.

What was computed before comes from a cache ($GEARBENCH_CACHE, else the user's cache folder; `off` for none).";

/// Arguments of `reduce`.
#[derive(Args, Clone, Debug)]
#[command(after_help = REDUCE_EXAMPLES)]
pub struct Reduce {
    /// Decks (.inp, .inp.gz); or the name of a shipped scene, or the path of a scene file (.toml)
    #[arg(value_name = "SCENE|DECK", required = true)]
    pub inputs: Vec<String>,
    /// Write to this file, or into this folder [default: nothing is written]
    #[arg(long, value_name = "F.npz|DIR")]
    pub out: Option<PathBuf>,
    /// Modes to store, most [default: 400, or all up to --max-frequency]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=5000))]
    pub modes: Option<u32>,
    /// Highest frequency of a mode to store [Hz]
    #[arg(long, value_name = "HZ", value_parser = positive_load)]
    pub max_frequency: Option<f64>,
    /// Which modes to store where --modes leaves some out
    #[arg(long, value_name = "RULE", default_value = "frequency", value_parser = ["frequency", "flank-compliance"])]
    pub choose: String,
    /// Only this gear [default: all]
    #[arg(long, value_name = "NAME")]
    pub gear: Option<String>,
    /// Label of the scene's elastic model whose meshes are taken [default: its first]
    #[arg(long, value_name = "LABEL")]
    pub model: Option<String>,
    /// The hub is free to move or held [default: free; of a scene as its gear is mounted]
    #[arg(long, value_name = "MOUNT", value_parser = ["free", "held"])]
    pub mount: Option<String>,
    /// Inertia added at the hub [kg m^2], mass of a rack [kg] [default: 0; of a scene that of its gear]
    #[arg(long, value_name = "J", value_parser = not_negative)]
    pub added_inertia: Option<f64>,
    /// Young's modulus [Pa] [default: as the deck says, else steel]
    #[arg(long, value_name = "PA", value_parser = modulus)]
    pub young: Option<f64>,
    /// Poisson's ratio [default: as the deck says, else steel]
    #[arg(long, value_name = "NU", value_parser = not_negative)]
    pub poisson: Option<f64>,
    /// Density [kg/m^3] [default: as the deck says, else steel]
    #[arg(long, value_name = "KG_M3", value_parser = positive_load)]
    pub density: Option<f64>,
}

fn modulus(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 1e15 => Ok(x),
        _ => Err("expected a positive number of pascals, for example 2.1e11".into()),
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.0..=1e9).contains(&x) => Ok(x),
        _ => Err("expected a number of 0 or more".into()),
    }
}

/// Arguments of `report`.
#[derive(Args, Clone, Debug)]
pub struct Report {
    /// Folder with a results.json
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn compare(arguments: &[&str]) -> Compare {
        match Cli::try_parse_from(arguments).unwrap().command {
            Some(Command::Compare(c)) => c,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn definitions_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn no_command_is_the_default_comparison() {
        assert!(
            Cli::try_parse_from(["gearbench"])
                .unwrap()
                .command
                .is_none()
        );
        let (a, b) = (compare(&["gearbench", "compare"]), Compare::default());
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }

    #[test]
    fn arguments() {
        let c = compare(&[
            "gearbench",
            "compare",
            "hammer",
            "--models",
            "rigid",
            "--integrators",
            "rk4@1e-7,bdf",
            "--out",
            "x",
            "--repeats",
            "5",
            "--no-events",
        ]);
        assert_eq!(
            (
                c.scene.as_str(),
                c.models.as_deref(),
                c.repeats,
                c.no_events
            ),
            ("hammer", Some("rigid"), 5, true)
        );
        let e = Cli::try_parse_from(["gearbench", "compare", "--repeats", "0"]).unwrap_err();
        assert_eq!(e.exit_code(), 2);
        let e = Cli::try_parse_from(["gearbench", "comapre"])
            .unwrap_err()
            .to_string();
        assert!(e.contains("compare"), "{e}");
    }

    #[test]
    fn help_teaches() {
        let help = Cli::command().render_long_help().to_string();
        for word in [
            "gearbench compare spur_impact",
            "results.json",
            "Exit codes",
            "index.html",
            "identify",
            "mesh",
        ] {
            assert!(help.contains(word), "{word} is missing in\n{help}");
        }
    }
}
