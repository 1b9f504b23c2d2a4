//! Figures of result folders, finished or still growing: from `history.csv`, `newton.csv` or `law.csv` to SVG.
//!
//! Several folders are overlaid, each under its name. Curves differ by dashes and marks as well as by colour.

mod axis;
mod chart;
mod interface;
mod law;
mod read;
mod run;
mod snapshots;
mod space_time;
mod svg;
mod thin;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use thiserror::Error;

use self::interface::Interface;
use self::space_time::Map;
use super::csv::failed;
use super::summary::About;
use crate::run::error::Error;

/// Files that [`draw`] may write.
pub const FIGURES: [&str; 11] = [
    "law.svg",
    "displacement.svg",
    "friction.svg",
    "friction_path.svg",
    "slip.svg",
    "slip_fraction.svg",
    "energy.svg",
    "newton.svg",
    "slip_rate.svg",
    "events.svg",
    "traction.svg",
];

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

/// Draw the figures of result folders into `out`; several folders are overlaid. Returns the files written.
///
/// # Errors
/// [`PlotError`].
pub fn draw(folders: &[PathBuf], out: &Path) -> Result<Vec<PathBuf>, PlotError> {
    let unreadable = |path: &Path, cause: &str| PlotError::Unreadable { path: path.to_owned(), cause: cause.into() };
    let is_law = |folder: &PathBuf| folder.join("law.csv").is_file();
    let is_run = |folder: &PathBuf| folder.join("history.csv").is_file();
    if let Some(folder) = folders.iter().find(|folder| !folder.is_dir()) {
        return Err(unreadable(folder, "is not a folder; give a folder of results"));
    }
    if let Some(folder) = folders.iter().find(|folder| !is_law(folder) && !is_run(folder)) {
        return Err(unreadable(folder, "has neither history.csv nor law.csv: it is no folder of results"));
    }
    let sources = sources(folders)?;
    let mut written = Vec::new();
    let mut write = |name: &str, svg: String| {
        std::fs::create_dir_all(out).map_err(|cause| failed(out, &cause))?;
        let path = out.join(name);
        std::fs::write(&path, svg).map_err(|cause| failed(&path, &cause))?;
        written.push(path);
        Ok(())
    };
    match folders.iter().filter(|folder| is_law(folder)).count() {
        0 => run::figures(&sources, |name, figure| write(name, figure.svg()))?,
        laws if laws == folders.len() => write("law.svg", law::figure(&sources)?.svg())?,
        _ => return Err(unreadable(&folders[0], "runs and laws driven alone cannot be drawn over each other")),
    }
    if let [source] = &sources[..] {
        for (number, interface) in Interface::read(&source.folder)? {
            draw_interface(&interface, number, source, &mut write)?;
        }
    }
    Ok(written)
}

/// The figures of what happened along one interface. Those of the first contact have the plain names, others are told
/// apart by their numbers.
fn draw_interface(
    interface: &Interface,
    number: usize,
    source: &Source,
    mut write: impl FnMut(&str, String) -> Result<(), PlotError>,
) -> Result<(), PlotError> {
    let name = source.about.friction.keys().nth(number).map_or("the interface", String::as_str);
    let file = |what: &str| if number == 0 { format!("{what}.svg") } else { format!("{what}_{number}.svg") };
    let map = Map { interface, name, source };
    write(&file("slip_rate"), map.whole())?;
    if let Some(events) = map.events() {
        write(&file("events"), events)?;
    }
    write(&file("traction"), snapshots::figure(interface, name, source).svg())
}

/// A result folder.
#[derive(Clone, Debug)]
struct Source {
    folder: PathBuf,
    /// its name in legends
    name: String,
    /// what its `summary.json` says; nothing while it runs
    about: About,
}

/// The folders with their names, made different from each other where necessary, and what is known about them.
fn sources(folders: &[PathBuf]) -> Result<Vec<Source>, PlotError> {
    let last = |folder: &PathBuf| {
        let whole = folder.canonicalize().unwrap_or_else(|_| folder.clone());
        whole.file_name().map_or_else(|| folder.display().to_string(), |name| name.to_string_lossy().into_owned())
    };
    let names: Vec<String> = folders.iter().map(last).collect();
    let source = |(folder, name): (&PathBuf, &String)| {
        let unique = names.iter().filter(|other| *other == name).count() == 1;
        let name = if unique { name.clone() } else { folder.display().to_string() };
        Ok(Source { folder: folder.clone(), name, about: about(folder)? })
    };
    let sources = folders.iter().zip(&names).map(source).collect::<Result<Vec<_>, PlotError>>()?;
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
struct Units(BTreeMap<String, String>);

impl Units {
    fn of(sources: &[Source]) -> Self {
        Self(sources.iter().flat_map(|source| source.about.units.clone()).collect())
    }

    /// The label of a quantity, or nothing.
    fn get(&self, of: &str) -> String {
        self.0.get(of).cloned().unwrap_or_default()
    }

    /// The label of a quantity, or else what it is made of, such as N/mm².
    fn derived(&self, of: &str, [first, second]: [&str; 2], joint: &str) -> String {
        match (self.0.get(of), self.0.get(first), self.0.get(second)) {
            (Some(unit), ..) => unit.clone(),
            (None, Some(first), Some(second)) => format!("{first}{}", joint.replace('_', second)),
            _ => String::new(),
        }
    }

    fn stress(&self) -> String {
        self.derived("stress", ["force", "length"], "/_²")
    }

    fn energy(&self) -> String {
        self.derived("energy", ["force", "length"], "·_")
    }
}

/// Of what a figure is: the title of the case, and the names of folders that are overlaid.
fn subtitle(sources: &[Source]) -> String {
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
