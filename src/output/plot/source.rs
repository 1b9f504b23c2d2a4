//! Result folders: their names, their cases and their units.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::error::PlotError;
use crate::output::summary::About;

/// A result folder.
#[derive(Clone, Debug)]
pub struct Source {
    /// where it lies
    pub folder: PathBuf,
    /// its name in legends
    pub name: String,
    /// what its `summary.json` says; nothing while it runs
    pub about: About,
}

/// The folders with their names, made different from each other where necessary, and what is known about them.
///
/// # Errors
/// [`PlotError::Unreadable`], also where two folders have different units.
pub fn sources(folders: &[PathBuf]) -> Result<Vec<Source>, PlotError> {
    folders.iter().try_for_each(|folder| about(folder).map(drop))?;
    sources_of(folders)
}

/// As [`sources`], nothing being known about a folder whose `summary.json` cannot be understood.
///
/// # Errors
/// [`PlotError::Unreadable`] where two folders have different units.
pub fn sources_of(folders: &[PathBuf]) -> Result<Vec<Source>, PlotError> {
    let last = |folder: &PathBuf| {
        let whole = folder.canonicalize().unwrap_or_else(|_| folder.clone());
        whole.file_name().map_or_else(|| folder.display().to_string(), |name| name.to_string_lossy().into_owned())
    };
    let names: Vec<String> = folders.iter().map(last).collect();
    let source = |(folder, name): (&PathBuf, &String)| {
        let unique = names.iter().filter(|other| *other == name).count() == 1;
        let name = if unique { name.clone() } else { folder.display().to_string() };
        Source { folder: folder.clone(), name, about: about(folder).unwrap_or_default() }
    };
    let sources: Vec<Source> = folders.iter().zip(&names).map(source).collect();
    for pair in sources.windows(2) {
        check_units(&pair[0], &pair[1])?;
    }
    Ok(sources)
}

fn about(folder: &Path) -> Result<About, PlotError> {
    let path = folder.join("summary.json");
    let Ok(text) = std::fs::read_to_string(&path) else { return Ok(About::default()) };
    serde_json::from_str(&text).map_err(|cause| PlotError::Unreadable { path, cause: cause.to_string() })
}

/// Millimetres are not drawn over metres.
fn check_units(one: &Source, other: &Source) -> Result<(), PlotError> {
    let differs = |(of, unit): &(&String, &String)| other.about.units.get(*of).is_some_and(|theirs| theirs != *unit);
    match one.about.units.iter().find(differs) {
        Some((of, unit)) => {
            let cause = format!("{of} is in {}, but in {unit} in {}", other.about.units[of], one.folder.display());
            Err(PlotError::Unreadable { path: other.folder.clone(), cause })
        }
        None => Ok(()),
    }
}

/// Labels of units, as far as the case gives them.
#[derive(Clone, Debug)]
pub struct Units(BTreeMap<String, String>);

impl Units {
    /// As the folders give them.
    pub fn of(sources: &[Source]) -> Self {
        Self(sources.iter().flat_map(|source| source.about.units.clone()).collect())
    }

    /// The label of a quantity, or nothing.
    pub fn get(&self, of: &str) -> String {
        self.0.get(of).cloned().unwrap_or_default()
    }

    /// The label of a quantity, or else what it is made of, such as N/mm².
    pub fn derived(&self, of: &str, [first, second]: [&str; 2], joint: &str) -> String {
        match (self.0.get(of), self.0.get(first), self.0.get(second)) {
            (Some(unit), ..) => unit.clone(),
            (None, Some(first), Some(second)) => format!("{first}{}", joint.replace('_', second)),
            _ => String::new(),
        }
    }

    /// Of a stress.
    pub fn stress(&self) -> String {
        self.derived("stress", ["force", "length"], "/_²")
    }

    /// Of an energy.
    pub fn energy(&self) -> String {
        self.derived("energy", ["force", "length"], "·_")
    }
}

/// Of what a figure is: the title of the case, and the names of folders that are overlaid.
pub fn subtitle(sources: &[Source]) -> String {
    let title = &sources[0].about.title;
    let names: Vec<&str> = sources.iter().map(|source| source.name.as_str()).collect();
    match (title.as_str(), sources.len()) {
        ("", _) => names.join(" · "),
        (title, 1) => title.into(),
        (title, _) if sources.iter().all(|source| source.about.title == title) => {
            format!("{title}: {}", names.join(" · "))
        }
        _ => names.join(" · "),
    }
}
