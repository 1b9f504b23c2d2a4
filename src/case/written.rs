//! A case as it is written, in a file or by a program.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::error::CaseError;
use super::file::Case;
use super::read;

/// A case as it is written.
#[derive(Clone, Debug)]
pub struct Written {
    /// its file, or where it would stand
    pub path: PathBuf,
    /// the case as JSON
    pub document: Value,
    /// what it says
    pub case: Case,
}

impl Written {
    /// Read a case file.
    ///
    /// # Errors
    /// [`CaseError`] when the file cannot be read or is not a case.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        let (document, case) = read::read_document(path)?;
        Ok(Self { path: path.to_owned(), document, case })
    }

    /// A case from its text; `path` is where it would stand.
    ///
    /// # Errors
    /// As [`Written::read`].
    pub fn from_text(text: &str, path: &Path) -> Result<Self, CaseError> {
        let (document, case) = read::read_document_text(text, path)?;
        Ok(Self { path: path.to_owned(), document, case })
    }
}
