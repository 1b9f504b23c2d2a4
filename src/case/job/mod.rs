//! A case run into a folder of results: from its beginning, from the end of another, or from its last checkpoint.
//!
//! [`Job::open`] and [`Job::resume`] read, check and lock the folder; [`Job::run`] solves, and writes results however the run
//! ends. The caller receives warnings and progress, and may end the run ([`Callbacks`]).

pub mod internal_error;
mod keeper;
mod outputs;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;
use thiserror::Error;

use super::again::is_same;
use super::report::understood;
use super::{CaseError, Opened, units, warnings};
use crate::model::Model;
use crate::output::checkpoint::{self, Checkpoint, Unusable};
use crate::output::events;
use crate::output::files::FolderError;
use crate::output::folder::Folder;
use crate::output::friction_history::FrictionHistory;
use crate::output::fronts::Fronts;
use crate::output::gradients::Account;
use crate::output::summary::{self, About, Ending, Summary};
pub use crate::output::warnings::Warn;
use crate::output::warnings::Warnings;
use crate::run::{Error, Observer, RunReport, SavedRun, Simulation, watch_with};
use keeper::Keeper;
use outputs::{Outputs, files};

/// Reason why a job cannot start; nothing was written.
#[derive(Debug, Error)]
pub enum Refused {
    /// The case is invalid.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// Results cannot be written to the folder.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// There is nothing to resume from.
    #[error("{}: --resume: {}", .0.display(), .1)]
    Checkpoint(PathBuf, checkpoint::Unusable),
    /// There is no checkpoint, and the folder does not contain this case's own unfinished run.
    #[error(
        "{}: --resume: there is no checkpoint, and {}: choose another --out, or leave --resume out to begin anew", .0.display(), .1
    )]
    Anew(PathBuf, String),
    /// The run cannot resume from the results in the folder.
    #[error(transparent)]
    Run(#[from] Error),
}

/// Reason why a job did not finish; its results are kept.
#[derive(Debug)]
pub enum Failed {
    /// The run stopped with an error.
    Stopped(Error),
    /// An internal error of the program.
    Internal(String),
}

/// A checked case, with its results folder locked.
pub struct Job {
    /// the case
    pub opened: Opened,
    /// its model
    pub model: Arc<Model>,
    /// results folder
    pub folder: Folder,
    /// saved run with which it starts, if any
    pub saved: Option<SavedRun>,
    /// defect of a newer checkpoint
    pub damage: Option<String>,
    /// whether the run to be resumed has left no checkpoint yet, and is started anew
    pub begins_anew: bool,
}

/// Outcome of a job.
pub struct Outcome {
    /// content of `summary.json`
    pub summary: Summary,
    /// largest energy supplied [F·L]
    pub supplied: f64,
    /// how it ended
    pub ended: Result<(), Failed>,
    /// whether the summary could be written
    pub written: Result<(), Error>,
}

impl Outcome {
    /// Whether the results are readable.
    pub fn is_readable(&self) -> bool {
        let full = matches!(&self.ended, Err(Failed::Stopped(Error::Output { .. }) | Failed::Internal(_)));
        !full && self.written.is_ok()
    }
}

impl Job {
    /// Builds the model of a case, and locks its results folder.
    ///
    /// # Errors
    /// Returns [`Refused`] if the case is invalid or the folder cannot be used.
    pub fn open(mut opened: Opened, place: &Path) -> Result<Self, Refused> {
        let (model, saved) = opened.build()?;
        Self::claim(opened, model, saved, place)
    }

    /// Continues the run in a folder: from its last checkpoint, or anew if the folder is absent or empty, or contains this
    /// case's own unfinished run without a checkpoint yet, so that a requeued job can always use the same command. `open` reads
    /// the case for the checkpoint or for a new start; `warn` reports a checkpoint written by another version.
    ///
    /// # Errors
    /// Returns [`Refused`] if the case is invalid or the run cannot be resumed.
    pub fn resume(
        place: &Path,
        open: impl FnOnce(Option<Checkpoint>) -> Result<Opened, CaseError>,
        warn: &dyn Fn(&str),
    ) -> Result<Self, Refused> {
        let (checkpoint, damage) = match checkpoint::newest(place) {
            Ok((checkpoint, damage)) => (Some(checkpoint), damage),
            Err((_, Unusable::Missing)) if !place.join(checkpoint::PREVIOUS).exists() => (None, None),
            Err((file, why)) => return Err(Refused::Checkpoint(file, why)),
        };
        let begins_anew = checkpoint.is_none();
        if let Some(Checkpoint { program, .. }) =
            checkpoint.as_ref().filter(|of| of.program != env!("CARGO_PKG_VERSION"))
        {
            warn(&format!(
                "the checkpoint is of version {program}: the last digits may differ from those of an uninterrupted run"
            ));
        }
        let mut opened = open(checkpoint)?;
        let (model, saved) = opened.build()?;
        if begins_anew {
            let refused = |why: String| Refused::Anew(place.to_owned(), why);
            let begun = summary::unfinished(place).map_err(refused)?;
            if let Some(begun) = begun.filter(|begun| !is_same(&begun.given, &given(&opened.document))) {
                return Err(refused(format!(
                    "the folder holds the run of another case, or of this one before a change ({})",
                    begun.case
                )));
            }
        }
        Ok(Self { damage, begins_anew, ..Self::claim(opened, model, saved, place)? })
    }

    /// Locks the results folder of a model, whose run begins anew or with a saved one.
    ///
    /// # Errors
    /// Returns [`Refused::Folder`] if the folder cannot be used.
    pub fn claim(opened: Opened, model: Arc<Model>, saved: Option<SavedRun>, place: &Path) -> Result<Self, Refused> {
        let inputs: Vec<PathBuf> = opened.inputs.iter().cloned().chain([opened.path.clone()]).collect();
        let outputs = files(&opened.case, &model);
        let folder = Folder::claim(place, &inputs, &outputs, opened.resumes())?;
        Ok(Self { opened, model, folder, saved, damage: None, begins_anew: false })
    }

    /// Runs the job to its end, or until it stops.
    ///
    /// # Errors
    /// Returns [`Refused::Run`] if it cannot resume from its checkpoint; nothing has changed then.
    pub fn run(&mut self, callbacks: Callbacks) -> Result<Outcome, Refused> {
        let about = about(&self.opened, &self.model);
        let Self { opened, model, folder, saved, damage, .. } = self;
        let summary = |ending, report, warnings| Summary::new(ending, about.clone(), model, report, warnings);
        let first = summary(Ending::running(&folder.files), RunReport::default(), warnings(&opened.case, model));
        let mut work = Work::default();
        let result = internal_error::catch(|| work.go(opened, model, folder, saved.take(), &first, callbacks));
        let result = match (result, opened.resumes(), &work.simulation) {
            (Ok(Err(error)), true, None) => return Err(error.into()),
            (result, ..) => result,
        };
        folder.forget_what_never_came();
        let ending = match &result {
            Ok(result) => Ending::new(result.as_ref().err(), &folder.files),
            Err(error) => Ending::internal_error(error, &folder.files),
        };
        if let Ok(result) = &result {
            folder.make_room_after(result);
        }
        let report = work.simulation.map(|simulation| simulation.report()).unwrap_or_default();
        work.warnings.extend(damage.take().map(|damage| format!("{damage}; the previous checkpoint was used")));
        let last = Summary {
            chatter: work.chatter,
            friction_course: work.courses,
            gradients: work.gradients,
            energy_in_penalties: work.energy_in_penalties,
            ..summary(ending, report, work.warnings)
        };
        let written = summary::write(&last, &folder.path);
        let ended = result.map_err(Failed::Internal).and_then(|ended| ended.map_err(Failed::Stopped));
        Ok(Outcome { summary: last, supplied: work.supplied, ended, written })
    }
}

/// Data about the case for readers of the results.
fn about(Opened { case, path, document, .. }: &Opened, model: &Model) -> About {
    About {
        case: path.display().to_string(),
        title: case.title.clone(),
        section: Some(model.mesh.section.to_string()),
        units: units::filled(&case.units, model.mesh.section),
        friction: case
            .contacts
            .iter()
            .filter_map(|(name, contact)| Some((name.clone(), contact.friction.parameters()?.clone())))
            .collect(),
        wave_speeds: events::wave_speeds(model),
        front_slip_rate: case.output.fronts.map(|fronts| fronts.slip_rate),
        understood: understood(case, model),
        given: given(document),
    }
}

/// Returns a case as written, except for a mesh given node by node.
fn given(document: &Value) -> Value {
    let mut given = document.clone();
    let is_of_nodes = document.get("mesh").is_some_and(|mesh| mesh.get("nodes").is_some());
    if let Some(case) = given.as_object_mut().filter(|_| is_of_nodes) {
        case.remove("mesh");
    }
    given
}

/// Results of a run that are kept however it ends.
#[derive(Default)]
struct Work {
    /// `None` before the start
    simulation: Option<Simulation>,
    warnings: Vec<String>,
    /// repeated onsets of slip, if the case requests fronts
    chatter: Option<BTreeMap<String, f64>>,
    courses: BTreeMap<String, FrictionHistory>,
    /// what is known of derivatives, if the case requests them
    gradients: Option<BTreeMap<String, Account>>,
    /// fraction of the elastic energy stored in contact penalties [-]
    energy_in_penalties: Option<f64>,
    /// largest energy supplied [F·L]
    supplied: f64,
}

impl Work {
    /// Starts or resumes the run and continues it to its end.
    fn go(
        &mut self,
        opened: &Opened,
        model: &Arc<Model>,
        folder: &Folder,
        saved: Option<SavedRun>,
        first: &Summary,
        Callbacks { warn, ends, mut progress }: Callbacks,
    ) -> Result<(), Error> {
        let resumes = opened.resumes();
        let mut keeper = Keeper::new(opened, model, &folder.path, warn.clone(), ends);
        // The summary identifies the files, so it is written first; that of a resumed run stays valid until the run
        // continues.
        if !resumes {
            summary::write(first, &folder.path)?;
        }
        let warnings = Warnings::reporting(warnings(&opened.case, model), warn.clone());
        let frames = opened.case.output.frames(opened.case.steps.len() - opened.taken_over);
        let mut outputs = Outputs::open(&folder.path, model, opened, frames, saved.as_ref(), warnings, warn)?;
        let mut observers = outputs.observers();
        if let Some(progress) = &mut progress {
            observers.push(&mut **progress);
        }
        let simulation = match saved {
            Some(saved) => saved.resume(model, &mut observers)?,
            None => Simulation::new(model.clone()),
        };
        let simulation = self.simulation.insert(simulation);
        simulation.pause_when(keeper.pause());
        if resumes {
            summary::write(first, &folder.path)?;
        }
        let result = watch_with(simulation, &mut observers, &mut |simulation, observers, moment| {
            keeper.look(simulation, observers, moment, &folder.lock)
        });
        drop(observers);
        self.courses = outputs.courses(model);
        self.chatter = outputs.fronts.as_ref().map(Fronts::chatter);
        self.supplied = outputs.warnings.audit.supplied;
        self.energy_in_penalties = outputs.warnings.audit.give.share().filter(|_| !model.contacts.is_empty());
        self.warnings = std::mem::take(&mut outputs.warnings.list);
        self.warnings.extend(keeper.concern);
        if let Some(gradients) = outputs.gradients {
            self.warnings.extend(gradients.warnings.iter().cloned());
            self.gradients = Some(gradients.accounts());
        }
        result
    }
}

/// Returns the reason to end a run early, if there is one.
pub type Ends = Arc<dyn Fn() -> Option<Error> + Send + Sync>;

/// Callbacks and observers of a run.
pub struct Callbacks<'a> {
    /// receives warnings when they arise, except those of the model
    pub warn: Warn,
    /// called between two increments, and within explicit ones
    pub ends: Ends,
    /// observer of the progress
    pub progress: Option<Box<dyn Observer + 'a>>,
}
