//! Arguments of `stability`.

use clap::Args;
use std::path::PathBuf;

/// Arguments of `stability`.
#[derive(Args, Clone, Debug)]
pub struct Stability {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Folder to write to [default: out/SCENE/stability]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
