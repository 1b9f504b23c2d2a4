//! Why there are no figures.

use std::path::PathBuf;

use thiserror::Error;

use crate::output::interface::read::Unreadable;
use crate::run::error::Error;

/// Why there are no figures.
#[derive(Debug, Error)]
pub enum PlotError {
    /// A folder cannot be read or understood.
    #[error("{}: {cause}", path.display())]
    Unreadable {
        /// the file or folder
        path: PathBuf,
        /// what is wrong
        cause: String,
    },
    /// A figure cannot be written.
    #[error(transparent)]
    Output(#[from] Error),
}

impl From<Unreadable> for PlotError {
    fn from(Unreadable { path, cause }: Unreadable) -> Self {
        Self::Unreadable { path, cause }
    }
}
