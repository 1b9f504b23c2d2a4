//! Implementation of the commands.

#[macro_use]
mod say;
mod converge;
mod failure;
mod init;
mod interrupt;
mod place;
pub mod progress;
mod run;
mod safety;
mod threads;

use std::path::{Path, PathBuf};

use clap::ValueEnum;

pub use self::converge::{Study, converge};
pub use self::failure::Failure;
pub use self::init::{Template, init};
use self::place::{claim, default_folder};
pub use self::run::{Options, run};
pub use self::safety::{Stability, safety};
pub use self::say::{print, say};
use self::threads::use_threads;
pub use crate::case::convergence::WITHIN;
pub use crate::case::job::internal_error;
pub use crate::case::safety::Reduced;
use crate::case::{self, Opened, Written, law_test, units};
use crate::mesh::section::Section;
use crate::output::law::LawTable;
use crate::output::summary::{self, About, Ending, LawSummary};
use crate::output::{named, report};
use crate::run::error::Error;
use crate::run::law::{Hold, LawReport, PathPoint};

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Input that a schema describes.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Input {
    /// the case file of `fecontact run`
    Case,
    /// the test of `fecontact law`
    Law,
    /// quantities in the files of results
    Results,
}

/// Implements `fecontact check`.
///
/// # Errors
/// Returns [`Failure::BadInput`] if the case is invalid.
pub fn check(path: &Path, resolved: bool) -> Result<(), Failure> {
    use_threads(None)?;
    let written = Written::read(path)?;
    let mut opened = Opened::begin(written.clone())?;
    let (model, _) = opened.build()?;
    match resolved {
        true => print(&format!("{}\n", case::resolved(&written.case, &model))),
        false => print(&case::report(&opened.case, &model)),
    }
}

/// Implements `fecontact law`.
///
/// # Errors
/// Returns [`Failure`] if the test is invalid or stopped.
pub fn law(path: &Path, out: Option<PathBuf>) -> Result<(), Failure> {
    use_threads(None)?;
    let input = law_test::read(path)?;
    let test = law_test::build(&input, path)?;
    let folder = out.unwrap_or_else(|| default_folder(path));
    let mut folder = claim(&folder, &[path.to_owned()], &["law.csv", report::FILE], false)?;
    let about = About {
        case: path.display().to_string(),
        title: input.title,
        units: units::filled(&input.units, Section::PlaneStrain),
        friction: [("law".into(), input.friction)].into(),
        ..About::default()
    };
    let begun =
        LawSummary { ending: Ending::running(&folder.files), about: about.clone(), report: LawReport::default() };
    summary::write(&begun, &folder.path)?;
    let mut table = LawTable::create(&folder.path, &test)?;
    let (mut report, result) = test.run(|row| table.write(row));
    report.warnings.extend(units::concerns(&input.units, Section::PlaneStrain));
    let result = result.and(table.finish());
    folder.make_room_after(&result);
    let summary = LawSummary { ending: Ending::new(result.as_ref().err(), &folder.files), about, report };
    let written = summary::write(&summary, &folder.path);
    // The first failure is reported; if a table cannot be written, neither can a page.
    let wants_page = written.is_ok() && !matches!(result, Err(Error::Output { .. }));
    let page = wants_page.then(|| report::write(std::slice::from_ref(&folder.path), &folder.path.join(report::FILE)));
    result?;
    written?;
    page.transpose()?;
    conclude_law(&summary.report, &folder.path);
    Ok(())
}

/// Prints the last lines of a test on stderr.
fn conclude_law(report: &LawReport, folder: &Path) {
    let LawReport { steps, most_evaluations, peaks, dissipation, warnings } = report;
    say!("{steps} steps, at most {most_evaluations} evaluations of the law's equation per step");
    if let Some(PathPoint { time, slip, coefficient, mu }) = peaks.peak {
        say!("peak |q|/p = {coefficient:.6} at t = {time:.6}, slip = {slip:.6}, where mu was {mu:.6}");
    }
    for Hold { duration, peak } in &peaks.holds {
        say!("after a hold of {duration:.6}: peak |q|/p = {:.6} at t = {:.6}", peak.coefficient, peak.time);
    }
    say!("dissipation {dissipation:.6}");
    for warning in warnings {
        say!("warning: {warning}");
    }
    say!("results in {}", folder.display());
}

/// Implements `fecontact report`.
///
/// # Errors
/// Returns [`Failure`] if a folder cannot be read or the page cannot be written.
pub fn report(folders: &[PathBuf], out: Option<PathBuf>) -> Result<(), Failure> {
    use_threads(None)?;
    let file = out.unwrap_or_else(|| match folders {
        [folder] => folder.join(report::FILE),
        _ => Path::new("out").join(report::FILE),
    });
    report::write(folders, &file)?;
    print(&format!("{}\n", file.display()))
}

/// Implements `fecontact schema`.
///
/// # Errors
/// Returns [`Failure::Stopped`] if the schema cannot be printed.
pub fn schema(of: Input) -> Result<(), Failure> {
    let schema = match of {
        Input::Case => case::schema(),
        Input::Law => law_test::schema(),
        Input::Results => named::schema(),
    };
    print(&format!("{schema:#}\n"))
}
