//! Output folder of a command.

use std::path::{Path, PathBuf};

use super::failure::Failure;
use crate::output::folder::Folder;

/// Default folder: `out/<name of the file>` in the current folder.
pub(super) fn default_folder(path: &Path) -> PathBuf {
    Path::new("out").join(path.file_stem().unwrap_or("case".as_ref()))
}

/// Locks the output folder and prepares it.
pub(super) fn claim(folder: &Path, inputs: &[PathBuf], outputs: &[&str], goes_on: bool) -> Result<Folder, Failure> {
    Folder::claim(folder, inputs, outputs, goes_on).map_err(|error| Failure::BadInput(error.to_string()))
}
