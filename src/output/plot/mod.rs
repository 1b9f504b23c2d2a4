//! Figures of result folders, finished or still growing: from `history.csv`, `newton.csv` or `law.csv` to SVG.
//!
//! Several folders are overlaid, each under its name. Curves differ by dashes and marks as well as by colour.

mod axis;
mod chart;
mod colours;
pub(super) mod convergence;
pub mod error;
mod interface;
mod law;
pub(super) mod read;
mod run;
mod snapshots;
pub(super) mod source;
mod space_time;
mod svg;
mod thin;

use std::path::{Path, PathBuf};

pub use self::error::PlotError;
use self::interface::Interface;
use self::source::{Source, sources};
use self::space_time::Map;
use super::csv::failed;
use super::files;

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

/// Whether a file is a figure of ours: what a user has drawn under the same name is not.
pub fn is_figure(path: &Path) -> bool {
    use std::io::Read;
    let plain = path.symlink_metadata().is_ok_and(|known| known.is_file());
    let mut start = Vec::new();
    let read = |file: std::fs::File| file.take(1024).read_to_end(&mut start);
    plain && std::fs::File::open(path).and_then(read).is_ok() && String::from_utf8_lossy(&start).contains(svg::OURS)
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
    // What cannot be read is told before anything is drawn.
    let interfaces = if let [source] = &sources[..] { Interface::read(&source.folder)? } else { Vec::new() };
    let mut written = Vec::new();
    let mut write = |name: &str, svg: String| {
        std::fs::create_dir_all(out).map_err(|cause| failed(out, &cause))?;
        let path = out.join(name);
        if path.symlink_metadata().is_ok() && !is_figure(&path) {
            return Err(failed(
                &path,
                &"is in the way: it is no figure drawn by fecontact; move it, or choose another --out",
            )
            .into());
        }
        files::replace(&path, svg.as_bytes()).map_err(|cause| failed(&path, &cause))?;
        written.push(path);
        Ok(())
    };
    match folders.iter().filter(|folder| is_law(folder)).count() {
        0 => run::figures(&sources, |name, figure| write(name, figure.svg()))?,
        laws if laws == folders.len() => write("law.svg", law::figure(&sources)?.svg())?,
        _ => return Err(unreadable(&folders[0], "runs and laws driven alone cannot be drawn over each other")),
    }
    for (number, (name, interface)) in interfaces.iter().enumerate() {
        draw_interface(interface, (number, name), &sources[0], &mut write)?;
    }
    Ok(written)
}

/// The figures of what happened along one interface. Those of the first contact have the plain names, others are told
/// apart by their numbers.
fn draw_interface(
    interface: &Interface,
    (number, name): (usize, &str),
    source: &Source,
    mut write: impl FnMut(&str, String) -> Result<(), PlotError>,
) -> Result<(), PlotError> {
    let file = |what: &str| if number == 0 { format!("{what}.svg") } else { format!("{what}_{number}.svg") };
    let map = Map { interface, name, source };
    write(&file("slip_rate"), map.whole())?;
    if let Some(events) = map.events() {
        write(&file("events"), events)?;
    }
    write(&file("traction"), snapshots::figure(interface, name, source).svg())
}
