//! Results folder: determines which of its files may be replaced.
//!
//! `summary.json` lists the files that its run writes. A later run removes these and no others: a user's file of the same name
//! is reported, and nothing is written.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::files::{FolderError, Lock};
use super::summary::SUMMARY;
use super::{checkpoint, files, gradients, report, store};
use crate::run::error::Error;

/// Files written by the commands; a name that ends in `/` is a folder of numbered frames.
const KNOWN: [&str; 22] = [
    "history.csv",
    "newton.csv",
    "slip_map.csv",
    "fronts.csv",
    "events.csv",
    "law.csv",
    "solid.pvd",
    "solid/",
    "points.pvd",
    "points/",
    "probes.csv",
    "sections.csv",
    gradients::FILE,
    INTERFACE,
    GRADIENTS,
    "contact.pvd",
    "contact/",
    "bars.pvd",
    "bars/",
    checkpoint::NEWEST,
    checkpoint::PREVIOUS,
    report::FILE,
];

/// Names of figures drawn next to results by earlier versions, ...
const FIGURES: [&str; 11] = [
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
/// ... with this text near their beginning; other files are a user's own.
const OUR_FIGURE: &str = "data-drawn-by=\"fecontact\"";

/// Store of the interfaces, a folder of a separate kind.
pub const INTERFACE: &str = "interface.zarr/";

/// Store of derivatives along them.
pub const GRADIENTS: &str = "gradients.zarr/";

/// Whether a folder of results is a store.
fn is_store(name: &str) -> bool {
    [INTERFACE, GRADIENTS].contains(&name)
}

/// Results folder locked by this process.
#[derive(Debug)]
pub struct Folder {
    /// path
    pub path: PathBuf,
    /// held while the folder is written
    pub lock: Lock,
    /// files written by the runs in it, including this one
    pub files: Vec<String>,
}

impl Folder {
    /// Locks a folder, creating it if necessary; `inputs` are the files read by the run, `outputs` those written. Earlier
    /// results are removed, unless the run continues them.
    ///
    /// # Errors
    /// Returns [`FolderError`] with the path that prevents it, and the reason.
    pub fn claim(path: &Path, inputs: &[PathBuf], outputs: &[&str], goes_on: bool) -> Result<Self, FolderError> {
        if let Some(input) = inputs.iter().find(|input| is_written(input, path, outputs)) {
            let cause = "is an input of this run, which would overwrite it: choose another --out";
            return Err(FolderError::new(input, cause));
        }
        let made = !path.exists();
        std::fs::create_dir_all(path).map_err(|cause| FolderError::unwritable(path, cause))?;
        let claimed = Lock::take(path).and_then(|lock| {
            let earlier = earlier(path)?;
            in_the_way(path, outputs, &earlier)?;
            let mut files: Vec<String> = outputs.iter().map(|name| (*name).into()).collect();
            match goes_on {
                true => files.extend(earlier.into_iter().filter(|name| !outputs.contains(&name.as_str()))),
                false => clear(path, &earlier).map_err(|(file, cause)| FolderError::unwritable(&file, cause))?,
            }
            Ok(Self { path: path.to_owned(), lock, files })
        });
        if claimed.is_err() && made {
            // The folder is kept if it is no longer empty.
            let _ = std::fs::remove_dir(path);
        }
        claimed
    }

    /// Removes files of a completed run that were never written from the list; a short run has no second checkpoint.
    pub fn forget_what_never_came(&mut self) {
        self.files.retain(|name| name != checkpoint::PREVIOUS || self.path.join(name).exists());
    }

    /// Releases the reserved disk space after a write error, so that the error can be recorded.
    pub fn make_room_after(&mut self, result: &Result<(), Error>) {
        if matches!(result, Err(Error::Output { .. })) {
            self.lock.give_room();
        }
    }
}

/// Whether an input file is at a path that the run will write.
fn is_written(input: &Path, folder: &Path, outputs: &[&str]) -> bool {
    let (Ok(input), Ok(folder)) = (input.canonicalize(), folder.canonicalize()) else { return false };
    let Ok(below) = input.strip_prefix(folder) else { return false };
    outputs.iter().chain([&SUMMARY]).any(|name| match name.strip_suffix('/') {
        Some(store) if is_store(name) => below.starts_with(store) && store::is_own(&input),
        Some(frames) => below.parent() == Some(Path::new(frames)) && is_frame(&input),
        None => below == Path::new(name),
    })
}

/// Files written by earlier runs, according to their summary; empty without one.
fn earlier(folder: &Path) -> Result<Vec<String>, FolderError> {
    let path = folder.join(SUMMARY);
    if path.symlink_metadata().is_err() {
        return Ok(Vec::new());
    }
    let foreign = || FolderError::new(&path, "was not written by an earlier run: move it, or choose another --out");
    if !path.symlink_metadata().is_ok_and(|known| known.is_file()) {
        return Err(foreign());
    }
    let text = std::fs::read_to_string(&path).map_err(|_| foreign())?;
    let summary: Value = serde_json::from_str(&text).map_err(|_| foreign())?;
    let files = summary["files"].as_array().filter(|_| summary["version"].is_string()).ok_or_else(foreign)?;
    let names = files.iter().filter_map(Value::as_str);
    Ok(names.filter(|name| KNOWN.contains(name)).map(String::from).collect())
}

/// Refuses output paths at which something other than earlier results exists.
fn in_the_way(folder: &Path, outputs: &[&str], earlier: &[String]) -> Result<(), FolderError> {
    let cause = "is in the way: no earlier run wrote it; move it, or choose another --out";
    let strange = |path: PathBuf| Err(FolderError::new(&path, cause));
    for name in outputs {
        let path = folder.join(name.trim_end_matches('/'));
        let Ok(known) = path.symlink_metadata() else { continue };
        let is_right = if name.ends_with('/') { known.is_dir() } else { known.is_file() };
        if !is_right {
            return strange(path);
        }
        if earlier.iter().any(|file| file == name) || (*name == report::FILE && report::is_page(&path)) {
            continue;
        }
        match name.ends_with('/') {
            false => return strange(path),
            true => parts(&path, name).into_iter().next().map_or(Ok(()), strange)?,
        }
    }
    Ok(())
}

/// Removes the files of earlier runs.
fn clear(folder: &Path, earlier: &[String]) -> Result<(), (PathBuf, std::io::Error)> {
    let remove = |path: PathBuf| files::remove(&path).map_err(|cause| (path, cause));
    for name in earlier {
        let path = folder.join(name.trim_end_matches('/'));
        match name.ends_with('/') {
            true => {
                parts(&path, name).into_iter().try_for_each(remove)?;
                store::forget(&path);
            }
            false => {
                remove(files::aside(&path))?;
                remove(path)?;
            }
        }
    }
    let figures = FIGURES.iter().map(|name| folder.join(name));
    figures.filter(|path| files::bears(path, OUR_FIGURE)).try_for_each(remove)?;
    Some(folder.join(report::FILE)).filter(|path| report::is_page(path)).map_or(Ok(()), remove)
}

/// Files of the program in a folder of a given kind.
fn parts(folder: &Path, name: &str) -> Vec<PathBuf> {
    // An unreadable folder contains nothing to remove.
    if is_store(name) { store::files_of(folder).unwrap_or_default() } else { frames(folder) }
}

/// Frames in a folder; none where it is a link.
fn frames(folder: &Path) -> Vec<PathBuf> {
    if !folder.symlink_metadata().is_ok_and(|known| known.is_dir()) {
        return Vec::new();
    }
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    entries.flatten().map(|entry| entry.path()).filter(|path| is_frame(path)).collect()
}

/// Whether a file has the name of a frame: at least five digits.
fn is_frame(path: &Path) -> bool {
    let name = path.file_stem().and_then(|name| name.to_str()).unwrap_or_default();
    path.extension() == Some("vtu".as_ref()) && name.len() >= 5 && name.bytes().all(|byte| byte.is_ascii_digit())
}
