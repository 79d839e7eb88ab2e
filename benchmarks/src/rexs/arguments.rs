//! Arguments of `import` and `export`.

use clap::Args;
use std::path::PathBuf;

const IMPORT: &str = "\
Examples:
  gearbench import gearbox.rexs                           gearbox.toml, and what was taken, assumed and left
  gearbench import gearbox.rexsz --out scenes/gearbox.toml --bearings
  gearbench import gearbox.rexsj --load-case 2 --rigid-shafts

REXS 1.0 to 2.0 as XML (.rexs), JSON (.rexsj), or either in a zip (.rexsz). The scene has the gears with their modifications,
planetary stages, shafts with their sections, and the loads of one load case; speeds and open torques follow from the
numbers of teeth. `gearbench help rexs` lists the attributes.";

const EXPORT: &str = "\
Examples:
  gearbench export loaded_mesh --rexs loaded_mesh.rexs
  gearbench export my_scene.toml --rexs my_scene.rexsj --model rigid

The file has gears, stages, shafts, materials and loads as REXS 2.0, with the stiffness of each mesh: c' and c_gamma of
ISO 6336, and the stiffness over a pitch of a model with a stiffness law. `gearbench help rexs` lists the attributes.";

/// Arguments of `import`.
#[derive(Args, Clone, Debug)]
#[command(after_help = IMPORT)]
pub struct ImportArguments {
    /// File of REXS: .rexs, .rexsj or .rexsz
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Scene file to write [default: NAME.toml]
    #[arg(long, value_name = "F.toml")]
    pub out: Option<PathBuf>,
    /// Rigid shafts, whatever their sections
    #[arg(long)]
    pub rigid_shafts: bool,
    /// Carry the shafts on the bearings of the file; without it shafts turn about fixed axes
    #[arg(long, conflicts_with = "rigid_shafts")]
    pub bearings: bool,
    /// Id of the load case [default: the first]
    #[arg(long, value_name = "ID")]
    pub load_case: Option<u64>,
    /// Overwrite an existing file even if this command did not write it
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `export`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXPORT)]
pub struct ExportArguments {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// File of REXS to write: XML, or JSON if its name ends in .rexsj
    #[arg(long, value_name = "FILE")]
    pub rexs: PathBuf,
    /// Model whose mesh stiffness is exported, by its label [default: the first with a stiffness law]
    #[arg(long, value_name = "LABEL")]
    pub model: Option<String>,
    /// Overwrite an existing file even if this command did not write it
    #[arg(long)]
    pub force: bool,
}
