//! Errors of the input, with their place and remedy.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::mesh::names::{in_line, printable};
use crate::model::builder::ModelError;

/// An error in a case.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}: {}{}", in_line(&file.to_string_lossy()), within(place), printable(message))]
pub struct CaseError {
    /// the case or mesh file
    pub file: PathBuf,
    /// path of the key, such as `bodies.block.material`
    pub place: String,
    /// error and remedy
    pub message: String,
}

fn within(place: &str) -> String {
    if place.is_empty() { String::new() } else { format!("{}: ", in_line(place)) }
}

impl ModelError {
    /// Returns the error with the file that it concerns.
    pub fn in_file(self, file: &Path) -> CaseError {
        CaseError { file: file.to_owned(), place: self.place, message: self.message }
    }
}
