//! `fecontact run`: a case from its beginning, from the end of another, or from its last checkpoint.
//!
//! This file also prints the texts on stderr at the start and at the end of a run.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::failure::Failure;
use super::interrupt::Interrupt;
use super::place::default_folder;
use super::progress::{Progress, Voice};
use super::say::{LOG, log_to};
use super::threads::use_threads;
use crate::case::job::{Callbacks, Job, Outcome};
use crate::case::{Opened, Written, warnings};
use crate::model::scheme::time_text;
use crate::model::{Energy, Model};
use crate::output::report;
use crate::output::summary::Summary;
use crate::run::{Error, Observer};

/// Options of `fecontact run`.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// results folder
    pub out: Option<PathBuf>,
    /// number of threads
    pub threads: Option<usize>,
    /// whether only warnings and the last line are printed
    pub quiet: bool,
    /// whether the run resumes from its last checkpoint, if there is one
    pub resume: bool,
}

/// Implements `fecontact run`.
///
/// # Errors
/// Returns [`Failure`] if the case is invalid or the run stopped.
pub fn run(path: &Path, options: Options) -> Result<(), Failure> {
    let Options { out, threads, quiet, resume } = options;
    use_threads(threads)?;
    let voice = Voice::new(quiet);
    let place = out.unwrap_or_else(|| default_folder(path));
    let opened = |checkpoint| match checkpoint {
        Some(checkpoint) => Opened::resume(Written::read(path)?, checkpoint),
        None => Opened::begin(Written::read(path)?),
    };
    let mut job = match resume {
        true => Job::resume(&place, opened, &|text| voice.warn(text))?,
        false => Job::open(opened(None)?, &place)?,
    };
    let goes_on = job.opened.resumes() && !job.begins_anew;
    if let Err(cause) = log_to(&job.folder.path, goes_on) {
        voice.warn(&format!("{}: {cause}", job.folder.path.join(LOG).display()));
    }
    let messages = Messages::start(&job, &voice);
    let outcome = job.run(callbacks(&voice))?;
    messages.end(&outcome, &job);
    // The first failure is reported.
    let wants_page = job.opened.case.output.report && outcome.is_readable();
    let page = wants_page.then(|| report::write(std::slice::from_ref(&job.folder.path), &place.join(report::FILE)));
    let Outcome { ended, written, .. } = outcome;
    ended?;
    page.transpose()?;
    Ok(written?)
}

/// Warnings and progress on stderr; signals end the run.
fn callbacks(voice: &Voice) -> Callbacks<'static> {
    let (speaker, interrupt) = (voice.clone(), Interrupt::watch());
    let progress =
        (!matches!(voice, Voice::Quiet)).then(|| Box::new(Progress::new(voice.clone())) as Box<dyn Observer>);
    Callbacks {
        warn: Arc::new(move |warning| speaker.warn(warning)),
        ends: Arc::new(move || interrupt.came().then_some(Error::Interrupted)),
        progress,
    }
}

/// Prints information for the user at the start and at the end of a run.
struct Messages(Voice);

impl Messages {
    /// Prints, before the first increment, warnings and choices, or the state from which the run resumes.
    pub fn start(Job { opened, model, folder, saved, damage, begins_anew }: &Job, voice: &Voice) -> Self {
        if *begins_anew {
            voice.say(&format!("{}: no checkpoint yet, the run begins anew", folder.path.display()));
        }
        let saved = saved.as_ref().filter(|_| opened.resumes());
        if let Some(damage) = damage {
            voice.warn(&format!("{damage}; the previous checkpoint is used"));
        }
        match saved.map(|saved| saved.simulation().state()) {
            Some(state) => {
                voice.say(&format!("resuming at t = {} after {} increments", time_text(state.time), state.increment));
            }
            None => {
                warnings(&opened.case, model).iter().for_each(|warning| voice.warn(warning));
                model.choices().iter().for_each(|choice| voice.say(choice));
            }
        }
        Self(voice.clone())
    }

    /// Prints the results after the last increment.
    pub fn end(&self, Outcome { summary, supplied, ended, .. }: &Outcome, job: &Job) {
        match (&self.0, ended) {
            (Voice::Quiet, Ok(())) => conclude(summary, &job.model, &job.folder.path),
            // The reason why it stopped is the last line.
            (Voice::Quiet, Err(_)) => {}
            _ => {
                conclude(summary, &job.model, &job.folder.path);
                account(summary, &job.model, *supplied);
            }
        }
    }
}

/// Prints the cost of a run and the path of its results in one line on stderr.
fn conclude(summary: &Summary, model: &Model, folder: &Path) {
    let report = &summary.report;
    say!(
        "{} increments, {} cut-backs, {} rejected, {} linear solves of {} dofs in {:.2} s; results in {}",
        report.increments,
        report.cutbacks,
        report.rejected,
        report.newton_iterations,
        model.unknowns(),
        report.wall_s.total,
        folder.display()
    );
}

/// Prints the following lines: friction, rejected attempts, energies.
fn account(summary: &Summary, model: &Model, supplied: f64) {
    let report = &summary.report;
    summary.friction_course.iter().for_each(|(name, course)| say!("contact `{name}`: {course}"));
    if let Some(share) = summary.energy_in_penalties {
        say!("contact penalties: {:.2} % of the elastic energy when that was largest", 100.0 * share);
    }
    if !report.given_up.is_empty() {
        say!("rejected attempts: {} (see column `reason` of newton.csv)", most_first(&report.given_up));
    }
    if model.steps.iter().any(|step| step.scheme.is_dynamic() || step.rupture.is_some()) {
        audit(&report.energy, supplied);
    }
}

/// Rejected attempts by reason, the most frequent first.
fn most_first(given_up: &BTreeMap<String, usize>) -> String {
    let mut reasons: Vec<_> = given_up.iter().collect();
    reasons.sort_by_key(|(_, count)| Reverse(**count));
    reasons.iter().map(|(reason, count)| format!("{count} × {reason}")).collect::<Vec<_>>().join(", ")
}

/// Prints the energy balance of a dynamic run; `supplied` is the largest energy supplied.
fn audit(energy: &Energy, supplied: f64) {
    let share = if supplied > 0.0 { 100.0 * energy.error() / supplied } else { 0.0 };
    let yielded = match energy.plastic_dissipation > 0.0 {
        true => format!(", {:.6e} by yielding", energy.plastic_dissipation),
        false => String::new(),
    };
    let radiated = if energy.radiated > 0.0 { format!(", {:.6e} radiated", energy.radiated) } else { String::new() };
    say!("energy: {:.6e} initial, {:.6e} external work", energy.initial, energy.external_work);
    say!(
        "        {:.6e} kinetic, {:.6e} strain, {:.6e} in contacts",
        energy.kinetic,
        energy.strain,
        energy.contact_elastic
    );
    say!(
        "        {:.6e} dissipated by friction, {:.6e} by damping{yielded}{radiated}, {:.1e} ({share:.4} %) unaccounted for",
        energy.friction_dissipation,
        energy.damping_dissipation,
        energy.error()
    );
}
