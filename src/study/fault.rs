//! Why a study ends without a result.

use thiserror::Error;

use crate::film::OutputError;

/// Why a study did not come to its end.
#[derive(Debug, Error)]
pub enum Fault {
    /// What was asked for makes no sense; the text names the remedy.
    #[error("{0}")]
    Invalid(String),
    /// A file could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The caller stopped it; the finished runs are kept.
    #[error("the study was interrupted; its finished runs are kept")]
    Interrupted,
}
