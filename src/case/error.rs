//! Bad input, with the place where it stands and what to do.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::mesh::names::{in_line, printable};
use crate::model::builder::ModelError;

/// Something in a case that cannot be run.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}: {}{}", in_line(&file.to_string_lossy()), within(place), printable(message))]
pub struct CaseError {
    /// the case or mesh file
    pub file: PathBuf,
    /// path of the key, such as `bodies.block.material`
    pub place: String,
    /// what is wrong, and what to do
    pub message: String,
}

fn within(place: &str) -> String {
    if place.is_empty() { String::new() } else { format!("{}: ", in_line(place)) }
}

impl ModelError {
    /// The error with the file that it concerns.
    pub fn in_file(self, file: &Path) -> CaseError {
        CaseError { file: file.to_owned(), place: self.place, message: self.message }
    }
}
