//! Arguments of `precision`.

use clap::Args;
use std::path::PathBuf;

/// Arguments of `precision`.
#[derive(Args, Clone, Debug)]
pub struct Precision {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Folder to write to [default: out/SCENE/precision]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
