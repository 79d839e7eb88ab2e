//! What the command does beside studies: meshes, reductions, lists, reports.

pub mod list;
pub mod mesh;
pub mod reduce;
pub mod report;
pub mod rerun;
