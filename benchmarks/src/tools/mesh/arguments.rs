//! Arguments of `mesh`.

use clap::{Arg, Args};
use gearbench_reference::deck::Units;
use gearbench_reference::gear_deck::ModalProgram;
use gearbench_reference::gear_mesh::GearMeshParams;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  gearbench mesh spur_impact                             print sizes and quality of the meshes, write no file
  gearbench mesh spur_impact --gear pinion --out pinion.inp
  gearbench mesh spur_impact --flank 20 --fine-teeth 1,2,20 --out fine.inp --vtu fine.vtu
  gearbench mesh my_scene.toml --element C3D20R --sector --out sector.inp
  gearbench mesh old_deck.inp --vtu old_deck.vtu         quality of the mesh of another program
  gearbench mesh my_scene.toml --gear wheel --modal calculix --out wheel.inp      then: ccx wheel
  gearbench mesh my_scene.toml --gear wheel --modal ansys --modes 50 --out wheel.cdb

A deck contains one gear in its own frame, with the axis along z, tooth 1 on +x, and lengths in metres. Its node sets
are bore, flank_1l, flank_1r, ... (l is the counter-clockwise flank of a tooth, in internal gears the clockwise one,
so that flanks with the same letter mesh); its surfaces are sflank_1l, ... With --modal, the deck also has the steps
that write stiffness and mass of the unconstrained gear and modes with fixed bore; `gearbench reduce DECK --matrices`
reads the matrices, and docs/modal.md describes the programs. A sector also has the sets cut_low and
cut_high: node i of one is node i of the other rotated by one pitch. For several gears, each file has the name of its
gear appended.";

/// Arguments of `mesh`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES, mut_args = with_default)]
pub struct Mesh {
    /// Name of a shipped scene, path of a scene file (.toml), of a deck (.inp), a mesh of Gmsh (.msh) or an archive of
    /// Ansys (.cdb), also .gz
    #[arg(value_name = "SCENE|DECK")]
    pub input: String,
    /// Write a deck: F.inp, or F.cdb with --modal ansys
    #[arg(long, value_name = "F.inp")]
    pub out: Option<PathBuf>,
    /// Add a modal analysis and the output of its matrices for a program: calculix, abaqus or ansys
    #[arg(long, value_name = "PROGRAM", value_parser = program)]
    pub modal: Option<ModalProgram>,
    /// Number of modes of the modal analysis [default: 100]
    #[arg(long, value_name = "N", requires = "modal", value_parser = clap::value_parser!(u32).range(1..=5000))]
    pub modes: Option<u32>,
    /// Write a file for ParaView, with the sets and the quality of the elements
    #[arg(long, value_name = "F.vtu")]
    pub vtu: Option<PathBuf>,
    /// Overwrite an existing file even if this command did not write it
    #[arg(long)]
    pub force: bool,
    /// Name of the gear to mesh [default: all]
    #[arg(long, value_name = "NAME")]
    pub gear: Option<String>,
    /// Units of a deck, one of m-kg-s, mm-t-s, mm-kg-s, mm-kg-ms, mm-g-ms [default: deduced from material or size]
    #[arg(long, value_name = "UNITS", value_parser = units)]
    pub units: Option<Units>,
    /// Kind of element: C3D8, C3D8I, C3D20 or C3D20R [default: C3D8I]
    #[arg(long, value_name = "KIND")]
    pub element: Option<String>,
    /// Elements along the involute flank
    #[arg(long, value_name = "N")]
    pub flank: Option<usize>,
    /// Elements along the fillet
    #[arg(long, value_name = "N")]
    pub fillet: Option<usize>,
    /// Elements on the root arc, from the fillet to the middle of the tooth space
    #[arg(long, value_name = "N")]
    pub root: Option<usize>,
    /// Elements across the tooth
    #[arg(long, value_name = "N")]
    pub across: Option<usize>,
    /// Layers of elements under flank, fillet and root, whose thickness grows inwards
    #[arg(long, value_name = "N")]
    pub layers: Option<usize>,
    /// Layers from the root to the bore or the back of a rack
    #[arg(long, value_name = "N")]
    pub rim: Option<usize>,
    /// Layers over the face width
    #[arg(long, value_name = "N")]
    pub width: Option<usize>,
    /// Mesh one pitch only, for cyclic symmetry
    #[arg(long)]
    pub sector: bool,
    /// Numbers of the teeth with the full resolution, from 1, separated by commas; the other teeth are coarse
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..))]
    pub fine_teeth: Vec<u32>,
}

/// Adds the default of the mesh generator to the help of a number of elements.
fn with_default(argument: Arg) -> Arg {
    let usual = GearMeshParams::default();
    let number = match argument.get_id().as_str() {
        "flank" => usual.tooth.flank,
        "fillet" => usual.tooth.fillet,
        "root" => usual.tooth.root,
        "across" => usual.tooth.across,
        "layers" => usual.layers,
        "rim" => usual.rim,
        "width" => usual.width,
        _ => return argument,
    };
    let help = argument.get_help().map(ToString::to_string);
    argument.help(format!("{} [default: {number}]", help.unwrap_or_default()))
}

/// A program by its name.
fn program(text: &str) -> Result<ModalProgram, String> {
    let named = |(name, _): &&(&str, ModalProgram)| name.eq_ignore_ascii_case(text);
    let found = ModalProgram::ALL.iter().find(named);
    found.map(|p| p.1).ok_or_else(|| {
        let known = ModalProgram::ALL.map(|p| p.0);
        format!("expected one of {}", known.join(", "))
    })
}

/// Units by their name.
pub(in crate::tools) fn units(text: &str) -> Result<Units, String> {
    Units::from_name(text).ok_or_else(|| {
        let known = Units::ALL.map(|u| u.name);
        format!("expected one of {}", known.join(", "))
    })
}
