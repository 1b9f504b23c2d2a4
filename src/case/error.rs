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

/// A complaint about a place in the case; the file is added at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Complaint {
    /// path of the key
    pub place: String,
    /// what is wrong, and what to do
    pub message: String,
}

/// What is read, once it is found to be good.
pub type Checked<T> = Result<T, Complaint>;

/// The model speaks of its places in the words of a case.
impl From<ModelError> for Complaint {
    fn from(ModelError { place, message }: ModelError) -> Self {
        Self { place, message }
    }
}

impl Complaint {
    /// A complaint about the value at a place.
    pub fn new(place: impl Into<String>, message: impl ToString) -> Self {
        Self { place: place.into(), message: message.to_string() }
    }

    /// The error with the file that it concerns.
    pub fn in_file(self, file: &Path) -> CaseError {
        CaseError { file: file.to_owned(), place: self.place, message: self.message }
    }
}
