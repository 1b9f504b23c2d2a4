//! Report of results: one page for a browser, without a network or another program.
//!
//! The numbers of the folders are packed into the page ([`table`]), and unpacked and drawn by the scripts in `page/`.
//! Where there are too many, some are omitted, which the page reports. Defects in a folder are reported on the page; the
//! remaining data are shown.

mod newton;
mod run;
mod series;
mod source;
pub mod table;

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use self::run::Run;
pub use self::source::ReportError;
use self::source::sources;
use super::csv::failed;
use super::{files, named};
use table::Pack;

/// Name of the page in a folder of results.
pub const FILE: &str = "report.html";

/// Marker of pages written by this program.
const OURS: &str = "<meta name=\"generator\" content=\"fecontact report\">";

/// Upper bound of the packed numbers; the whole page then stays below 30 MB [bytes].
const ROOM: usize = 28_000_000;

/// Scripts of the page, in the order of execution.
const SCRIPTS: [&str; 26] = [
    include_str!("page/uplot/uPlot.iife.min.js"),
    include_str!("page/dom.js"),
    include_str!("page/data.js"),
    include_str!("page/clock.js"),
    include_str!("page/colours.js"),
    include_str!("page/export.js"),
    include_str!("page/differences.js"),
    include_str!("page/paper.js"),
    include_str!("page/chart.js"),
    include_str!("page/head.js"),
    include_str!("page/scene.js"),
    include_str!("page/plain.js"),
    include_str!("page/fields.js"),
    include_str!("page/stage.js"),
    include_str!("page/bars.js"),
    include_str!("page/bodies.js"),
    include_str!("page/histories.js"),
    include_str!("page/pairs.js"),
    include_str!("page/law.js"),
    include_str!("page/surfaces.js"),
    include_str!("page/profiles.js"),
    include_str!("page/map.js"),
    include_str!("page/rates.js"),
    include_str!("page/interface.js"),
    include_str!("page/events.js"),
    include_str!("page/main.js"),
];

/// Whether a file is a page of this program, not a user's file of the same name.
pub fn is_page(path: &Path) -> bool {
    files::bears(path, OURS)
}

/// Writes the page of result folders, finished or still growing; several are overlaid.
///
/// # Errors
/// Returns [`ReportError`] if a folder cannot be read or the page cannot be written.
pub fn write(folders: &[PathBuf], file: &Path) -> Result<(), ReportError> {
    if file.is_dir() {
        return Err(failed(file, &"is a folder: give the name of the page").into());
    }
    if file.symlink_metadata().is_ok() && !is_page(file) {
        let cause = "is in the way: it was not written by fecontact; move it, or choose another --out";
        return Err(failed(file, &cause).into());
    }
    let page = page(folders)?;
    if let Some(folder) = file.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|cause| failed(folder, &cause))?;
    }
    Ok(files::replace(file, page.as_bytes()).map_err(|cause| failed(file, &cause))?)
}

/// Returns the page of result folders.
///
/// # Errors
/// Returns [`ReportError::Unreadable`] if a folder cannot be read.
pub fn page(folders: &[PathBuf]) -> Result<String, ReportError> {
    let unreadable = |path: &Path, cause: &str| ReportError::Unreadable { path: path.to_owned(), cause: cause.into() };
    for folder in folders {
        if !folder.is_dir() {
            return Err(unreadable(folder, "is not a folder; give a folder of results"));
        }
        if !["history.csv", "law.csv", "summary.json"].iter().any(|file| folder.join(file).is_file()) {
            let cause = "has neither history.csv nor law.csv nor summary.json: it is not a folder of results";
            return Err(unreadable(folder, cause));
        }
    }
    let sources = sources(folders)?;
    let mut pack = Pack::default();
    let share = ROOM / sources.len().max(1);
    let runs: Vec<Value> = sources.iter().map(|source| Run::new(source, share).show(&mut pack)).collect();
    let units = sources.iter().flat_map(|source| source.about.units.clone()).collect();
    let data = json!({ "version": env!("CARGO_PKG_VERSION"), "runs": runs, "labels": named::labels(&units) });
    Ok(assembled(&data, &pack))
}

/// Assembles the page from its data.
fn assembled(data: &Value, pack: &Pack) -> String {
    // The data must not close their HTML element.
    let json = data.to_string().replace('<', "\\u003c");
    let licence = include_str!("page/uplot/LICENSE");
    let scripts = SCRIPTS.map(|script| format!("<script>\n{script}\n</script>\n")).concat();
    let parts = [
        ("{{style}}", [include_str!("page/uplot/uPlot.min.css"), include_str!("page/style.css")].concat()),
        ("{{data}}", json),
        ("{{numbers}}", pack.text.clone()),
        ("{{scripts}}", format!("<!-- uPlot:\n{licence}-->\n{scripts}")),
    ];
    let mut page = String::with_capacity(parts.iter().map(|(_, part)| part.len()).sum::<usize>() + 8192);
    let mut rest = include_str!("page/index.html");
    for (mark, part) in &parts {
        let (before, after) = rest.split_once(mark).unwrap_or((rest, ""));
        page += before;
        page += part;
        rest = after;
    }
    page + rest
}
