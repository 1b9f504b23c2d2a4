//! `fecontact run`: a case from its beginning, from the end of another, or from its last checkpoint.

mod told;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use self::told::Told;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::place::default_folder;
use super::progress::{Progress, Voice};
use super::threads::use_threads;
use crate::case::job::{Company, Job, Outcome, last};
use crate::case::{Opened, Written};
use crate::output::report;
use crate::run::error::Error;
use crate::run::observer::Observer;

/// How a case is run.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// folder of the results
    pub out: Option<PathBuf>,
    /// threads
    pub threads: Option<usize>,
    /// whether nothing is told
    pub quiet: bool,
    /// whether it goes on from the last checkpoint
    pub resume: bool,
}

/// `fecontact run`.
///
/// # Errors
/// [`Failure`].
pub fn run(path: &Path, options: Options) -> Result<(), Failure> {
    let Options { out, threads, quiet, resume } = options;
    use_threads(threads)?;
    let voice = Voice::new(quiet);
    let place = out.unwrap_or_else(|| default_folder(path));
    let (opened, damage) = match resume {
        true => last(&place, |checkpoint| Opened::resume(Written::read(path)?, checkpoint), &|text| voice.warn(text))?,
        false => (Opened::begin(Written::read(path)?)?, None),
    };
    let mut job = Job::open(opened, damage, &place)?;
    let told = Told::start(&job, &voice);
    let outcome = job.run(company(&voice))?;
    told.end(&outcome, &job);
    // The first failure is the one to be told.
    let wants_page = job.opened.case.output.report && outcome.is_readable();
    let page = wants_page.then(|| report::write(std::slice::from_ref(&job.folder.path), &place.join(report::FILE)));
    let Outcome { ended, written, .. } = outcome;
    ended?;
    page.transpose()?;
    Ok(written?)
}

/// Warnings and progress on stderr; signals end the run.
fn company(voice: &Voice) -> Company<'static> {
    let (speaker, interrupt) = (voice.clone(), Interrupt::watch());
    let progress =
        (!matches!(voice, Voice::Silent)).then(|| Box::new(Progress::new(voice.clone())) as Box<dyn Observer>);
    Company {
        warn: Arc::new(move |warning| speaker.warn(warning)),
        ends: Arc::new(move || interrupt.came().then_some(Error::Interrupted)),
        progress,
    }
}
