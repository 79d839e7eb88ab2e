//! Arguments of `choose`.

use clap::Args;
use std::path::PathBuf;

/// Arguments of `choose`.
#[derive(Args, Clone, Debug)]
pub struct Choose {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Folder to write to [default: out/SCENE/choose]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
