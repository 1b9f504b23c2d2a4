//! Results folders as sources of a page: names, cases and units; errors of the page.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::output::summary::About;
use crate::run::error::Error;

/// Error of the page.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A folder cannot be read or understood.
    #[error("{}: {cause}", path.display())]
    Unreadable {
        /// the file or folder
        path: PathBuf,
        /// description of the defect
        cause: String,
    },
    /// The page cannot be written.
    #[error(transparent)]
    Output(#[from] Error),
}

/// A results folder.
#[derive(Clone, Debug)]
pub struct Source {
    /// path
    pub folder: PathBuf,
    /// its name in legends
    pub name: String,
    /// content of its `summary.json`; empty while it runs
    pub about: About,
}

/// Returns the folders with distinct names and the content of their `summary.json`, which is empty if it cannot be read.
///
/// # Errors
/// Returns [`ReportError::Unreadable`] if two folders have different units.
pub fn sources(folders: &[PathBuf]) -> Result<Vec<Source>, ReportError> {
    let last = |folder: &PathBuf| {
        let whole = folder.canonicalize().unwrap_or_else(|_| folder.clone());
        whole.file_name().map_or_else(|| folder.display().to_string(), |name| name.to_string_lossy().into_owned())
    };
    let names: Vec<String> = folders.iter().map(last).collect();
    let source = |(folder, name): (&PathBuf, &String)| {
        let unique = names.iter().filter(|other| *other == name).count() == 1;
        let name = if unique { name.clone() } else { folder.display().to_string() };
        Source { folder: folder.clone(), name, about: about(folder) }
    };
    let sources: Vec<Source> = folders.iter().zip(&names).map(source).collect();
    for (k, one) in sources.iter().enumerate() {
        sources[k + 1..].iter().try_for_each(|other| check_units(one, other))?;
    }
    Ok(sources)
}

fn about(folder: &Path) -> About {
    let text = std::fs::read_to_string(folder.join("summary.json"));
    text.ok().and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()
}

/// Checks that two folders use the same units.
fn check_units(one: &Source, other: &Source) -> Result<(), ReportError> {
    let differs = |(of, unit): &(&String, &String)| other.about.units.get(*of).is_some_and(|theirs| theirs != *unit);
    match one.about.units.iter().find(differs) {
        Some((of, unit)) => {
            let cause = format!("{of} is in {}, but in {unit} in {}", other.about.units[of], one.folder.display());
            Err(ReportError::Unreadable { path: other.folder.clone(), cause })
        }
        None => Ok(()),
    }
}
