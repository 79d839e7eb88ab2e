//! Arguments of `reduce`.

use crate::cli::values::{number, positive_load};
use crate::tools::mesh::arguments::units;
use clap::Args;
use gearbench_reference::deck::Units;
use gearbench_reference::reduction::DIRECTIONS;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench reduce gear.inp                              print contents, modes and compliance, write no file
  gearbench reduce gear.inp.gz --modes 200 --out gear.npz
  gearbench reduce old.inp --gear wheel --mount held --max-frequency 80e3 --out wheel.npz
  gearbench reduce gear.inp --mount free,x,y,z,tilt_x,tilt_y --added-mass 0.4 --out floating.npz
  gearbench reduce turned.inp --axis 0,0.2,1 --axis-point 0.1,0,0 --out turned.npz
  gearbench reduce a.inp b.inp --modes 100 --out reduced/      writes reduced/a.npz and reduced/b.npz
  gearbench reduce spur_impact --modes 200 --out spur.npz      spur-pinion.npz, spur-wheel.npz
  gearbench reduce wheel.inp --matrices wheel.sti --out wheel.npz         stiffness and mass that CalculiX stored
  gearbench reduce wheel.inp --matrices wheel_STIF1.mtx --out wheel.npz   those of Abaqus
  gearbench reduce wheel.cdb --matrices wheel_stiff.hb --out wheel.npz    those of Ansys

The mesh of another program needs solid elements. The node sets `bore`, `flank_1l`, `flank_1r`, ... (l is the
counter-clockwise flank) define bore and flanks; without them, axis, bore, teeth and flanks are identified from the
surface of the mesh. The command deduces and prints the units; --units overrides them. For a scene, the command uses
the meshes of its elastic model, with the mounts and added inertias of its gears.

The file contains the flank nodes with their normals, natural frequencies, mode shapes at the flank nodes, and the
static compliance between the flank nodes and at the hub; docs/reduction-format.md describes it. The elastic model of
a scene reads it by `parameters = { reduction = \"gear.npz\" }`, with a path relative to the folder of the scene.

With --matrices, stiffness and mass are those that another program wrote for the deck; with --shapes, the modes lie in
the span of its mode shapes. docs/modal.md describes what the programs must be told.

Earlier reductions are read from a cache ($GEARBENCH_CACHE, else the user's cache folder; `off` disables it).";

/// Arguments of `reduce`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Reduce {
    /// Decks (.inp), meshes of Gmsh (.msh) or archives of Ansys (.cdb), also .gz; or the name of a shipped scene, or the path of a scene file
    /// (.toml)
    #[arg(value_name = "SCENE|DECK", required = true)]
    pub inputs: Vec<String>,
    /// File or folder to write to [default: no file is written]
    #[arg(long, value_name = "F.npz|DIR")]
    pub out: Option<PathBuf>,
    /// Overwrite an existing file even if this command did not write it
    #[arg(long)]
    pub force: bool,
    /// Files of the stiffness, the mass and the coordinates of the rows that another program wrote for the deck, separated
    /// by commas; the last two may be left out where their names follow from the first: F.sti (CalculiX), F_STIF1.mtx
    /// (Abaqus), F_stiff.hb (Ansys), F.npz
    #[arg(long, value_name = "FILE,...", value_delimiter = ',', num_args = 1)]
    pub matrices: Option<Vec<String>>,
    /// File of mode shapes that another program computed for the deck: .frd or .dat of CalculiX, .dat of Abaqus, .npz
    #[arg(long, value_name = "FILE")]
    pub shapes: Option<String>,
    /// Largest number of modes to store [default: 400, or all up to --max-frequency]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=5000))]
    pub modes: Option<u32>,
    /// Highest frequency of a mode to store [Hz]
    #[arg(long, value_name = "HZ", value_parser = positive_load)]
    pub max_frequency: Option<f64>,
    /// Criterion by which --modes selects the modes to store
    #[arg(long, value_name = "RULE", default_value = "frequency", value_parser = ["frequency", "flank-compliance"])]
    pub choose: String,
    /// Name of the gear to reduce [default: all]
    #[arg(long, value_name = "NAME")]
    pub gear: Option<String>,
    /// Units of a deck, one of m-kg-s, mm-t-s, mm-kg-s, mm-kg-ms, mm-g-ms [default: deduced from material or size]
    #[arg(long, value_name = "UNITS", value_parser = units)]
    pub units: Option<Units>,
    /// Direction of the gear's z axis in a deck; for a rack, the direction of its width [default: identified from the
    /// mesh]
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    pub axis: Option<[f64; 3]>,
    /// A point on that axis, for a rack on its reference line, in metres for all units [default: identified from the
    /// mesh]
    #[arg(long, value_name = "X,Y,Z", value_parser = position, allow_hyphen_values = true)]
    pub axis_point: Option<[f64; 3]>,
    /// Label of the scene's elastic model whose meshes are taken [default: its first]
    #[arg(long, value_name = "LABEL")]
    pub model: Option<String>,
    /// Also store how flanks move along their profile, which friction loads
    #[arg(long)]
    pub along_profile: bool,
    /// The hub is `free` to move or `held`, then, with commas, its free directions beside that in the gear's own frame:
    /// some of x, y, z, tilt_x, tilt_y, tilt_z [default: free; of a scene as its gear is mounted]
    #[arg(long, value_name = "MOUNT", value_parser = mount)]
    pub mount: Option<(bool, [bool; 6])>,
    /// Inertia added at the hub [kg m^2], for a rack mass [kg] [default: 0; for a scene the value of its gear]
    #[arg(long, value_name = "J", value_parser = not_negative)]
    pub added_inertia: Option<f64>,
    /// Mass added at a hub with out-of-plane translations [kg]; for a rack, see --added-inertia [default: 0; for a
    /// scene the value of its gear]
    #[arg(long, value_name = "KG", value_parser = not_negative)]
    pub added_mass: Option<f64>,
    /// Inertia added at a hub that can tilt, about each tilting axis [kg m^2] [default: 0; for a scene the value of its
    /// gear]
    #[arg(long, value_name = "J", value_parser = not_negative)]
    pub added_tilting: Option<f64>,
    /// Young's modulus [Pa] [default: value of the deck, else steel]
    #[arg(long, value_name = "PA", value_parser = modulus)]
    pub young: Option<f64>,
    /// Poisson's ratio [default: value of the deck, else steel]
    #[arg(long, value_name = "NU", value_parser = not_negative)]
    pub poisson: Option<f64>,
    /// Density [kg/m^3] [default: value of the deck, else steel]
    #[arg(long, value_name = "KG_M3", value_parser = positive_load)]
    pub density: Option<f64>,
}

/// Three numbers with commas between.
fn three(text: &str, expected: &str) -> Result<[f64; 3], String> {
    let all = text.split(',').map(|x| x.trim().parse::<f64>());
    let all: Vec<f64> = all
        .collect::<Result<_, _>>()
        .map_err(|_| expected.to_owned())?;
    let three = <[f64; 3]>::try_from(all).ok();
    three
        .filter(|x| x.iter().all(|x| x.is_finite()))
        .ok_or_else(|| expected.to_owned())
}

fn mount(text: &str) -> Result<(bool, [bool; 6]), String> {
    let mut words = text.split(',').map(str::trim);
    let free = match words.next() {
        Some("free") => true,
        Some("held") => false,
        _ => return Err("expected `free` or `held` first".into()),
    };
    let mut lateral = [false; 6];
    for word in words {
        let direction = DIRECTIONS.iter().position(|d| *d == word).ok_or_else(|| {
            format!(
                "expected some of {} after it, found `{word}`",
                DIRECTIONS.join(", ")
            )
        })?;
        lateral[direction] = true;
    }
    Ok((free, lateral))
}

fn direction(text: &str) -> Result<[f64; 3], String> {
    let expected = "expected a direction x,y,z other than 0,0,0, for example 0,0,1";
    let x = three(text, expected)?;
    (x != [0.0; 3]).then_some(x).ok_or_else(|| expected.into())
}

fn position(text: &str) -> Result<[f64; 3], String> {
    three(
        text,
        "expected a position x,y,z in metres, for example 0.1,0,0",
    )
}

fn modulus(text: &str) -> Result<f64, String> {
    let expected = "expected a positive number of pascals, for example 2.1e11";
    number(text, |x| *x > 0.0 && *x <= 1e15, expected)
}

fn not_negative(text: &str) -> Result<f64, String> {
    number(
        text,
        |x| (0.0..=1e9).contains(x),
        "expected a number of 0 or more",
    )
}
