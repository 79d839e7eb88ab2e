//! Why a study ends before its end. Runs that fail do not end one: they are rows.

use super::journal::JournalError;
use super::run::RunError;
use gearbench_reference::statics::StaticsError;

/// Why a study ends before its end.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A run could not start, or one that others are held against did not reach its end.
    #[error(transparent)]
    Run(#[from] RunError),
    /// There is no static equilibrium of the model with this label.
    #[error("{0}: {1}")]
    Statics(String, StaticsError),
    /// The scene, or the model with the label, is none for this study: why, and a way out.
    #[error("{0}")]
    Scene(String, &'static str),
    /// Finished runs cannot be read or kept.
    #[error(transparent)]
    Journal(#[from] JournalError),
}
