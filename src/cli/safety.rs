//! `fecontact safety`: the factor by which strengths may be divided at the end of a run.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::failure::Failure;
use super::interrupt::Interrupt;
use super::place::default_folder;
use super::say::print;
use super::threads::use_threads;
use crate::case::Written;
use crate::case::safety::{Reduced, Trial};
use crate::case::safety_trials::{GROWTH, Trials, Unfound};
use crate::run::error::Error;

/// Options of `fecontact safety`.
#[derive(Clone, Debug)]
pub struct Stability {
    /// what is reduced
    pub reduced: Reduced,
    /// largest distance between a factor that stands and one that fails
    pub within: f64,
    /// largest factor that is tried
    pub most: f64,
    /// folder of the results
    pub out: Option<PathBuf>,
    /// number of threads
    pub threads: Option<usize>,
}

/// Implements `fecontact safety`: the case and every trial are run into folders of their own.
///
/// # Errors
/// Returns [`Failure`] if the case is invalid or its own run stopped, or if the strengths never fail.
pub fn safety(path: &Path, stability: Stability) -> Result<(), Failure> {
    let Stability { reduced, within, most, out, threads } = stability;
    use_threads(threads)?;
    let positive = |name: &str, value: f64, least: f64| match value > least && value.is_finite() {
        true => Ok(()),
        false => Err(Failure::BadInput(format!("--{name}: is {value}: must be above {least}"))),
    };
    positive("within", within, 0.0)?;
    positive("most", most, 1.0)?;
    let place = out.unwrap_or_else(|| default_folder(path));
    let (written, interrupt) = (Written::read(path)?, Interrupt::watch());
    let ends = Arc::new(move || interrupt.came().then_some(Error::Interrupted));
    let warn = |warning: &str| say!("warning: {warning}");
    let mut trials = Trials::begin(written, reduced, [within, most], &place, &warn, ends)?;
    while let Some(Trial { factor, stands, reached, growth, .. }) = trials.next_trial()? {
        let found = match stands {
            true => "stands".into(),
            false if growth > GROWTH => format!("fails at {:.1} % of the step", 100.0 * reached),
            false => format!("fails, without an equilibrium from {:.1} % of the step on", 100.0 * reached),
        };
        print(&format!("F = {factor}: {found}; displacement {growth:.1} times the elastic one\n"))?;
    }
    let stands = trials.search.stands;
    let Some(fails) = trials.search.fails else {
        return Err(Failure::Stopped(format!(
            "the strengths stand even when divided by {stands}: give a larger --most"
        )));
    };
    let folder = trials.folder(fails);
    print(&format!("factor of safety: {stands} to {fails}; the mechanism is in {}\n", folder.display()))?;
    Ok(())
}

impl From<Unfound> for Failure {
    fn from(unfound: Unfound) -> Self {
        match unfound {
            Unfound::Refused(refused) => refused.into(),
            Unfound::Failed(failed) => failed.into(),
        }
    }
}
