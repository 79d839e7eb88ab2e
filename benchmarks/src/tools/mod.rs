//! Commands that are not studies: scenes to start from, meshes, reductions, lists, reports.

pub mod completions;
pub mod init;
pub mod list;
pub mod man;
pub mod mesh;
pub mod reduce;
pub mod reference;
pub mod report;
pub mod rerun;
pub mod view;
