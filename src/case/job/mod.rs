//! A case run into a folder of results: from its beginning, from the end of another, or from its last checkpoint.
//!
//! [`Job::open`] and [`Job::resume`] read, check and lock the folder; [`Job::run`] solves and leaves results behind however it ends. Who asked for
//! it hears warnings, shows progress and may end it ([`Callbacks`]).
//!
//! Who watches a run.

pub mod defect;
mod keeper;
mod outputs;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;
use thiserror::Error;

use super::again::is_same;
use super::report::understood;
use super::{CaseError, Opened};
use crate::model::Model;
use crate::output::checkpoint::{self, Checkpoint, Unusable};
use crate::output::events;
use crate::output::folder::Folder;
use crate::output::friction_history::FrictionHistory;
use crate::output::fronts::Fronts;
use crate::output::summary::{self, About, Ending, Summary};
pub use crate::output::warnings::Warn;
use crate::output::warnings::Warnings;
use crate::run::control::RunReport;
use crate::run::error::Error;
use crate::run::observer::Observer;
use crate::run::{SavedRun, Simulation, watch_with};
use keeper::Keeper;
use outputs::{Outputs, files};

/// Why a job cannot begin; nothing was written.
#[derive(Debug, Error)]
pub enum Refused {
    /// The case is bad.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// Results cannot go there.
    #[error("{}: --out: {}", .0.display(), .1)]
    Folder(PathBuf, String),
    /// There is nothing to resume from.
    #[error("{}: --resume: {}", .0.display(), .1)]
    Checkpoint(PathBuf, checkpoint::Unusable),
    /// There is no checkpoint, and what is in the folder is not this case's own unfinished run.
    #[error(
        "{}: --resume: there is no checkpoint, and {}: choose another --out, or leave --resume out to begin anew", .0.display(), .1
    )]
    Anew(PathBuf, String),
    /// The run cannot resume from the results in the folder.
    #[error(transparent)]
    Run(#[from] Error),
}

/// Why a job did not come to its end; what it has found is kept.
#[derive(Debug)]
pub enum Failed {
    /// The run stopped with an error.
    Stopped(Error),
    /// The program itself is wrong.
    Defect(String),
}

/// A case, checked, with the folder of its results locked.
pub struct Job {
    /// the case
    pub opened: Opened,
    /// its model
    pub model: Arc<Model>,
    /// where results go
    pub folder: Folder,
    /// from where it begins, unless at the beginning
    pub saved: Option<SavedRun>,
    /// what was wrong with a newer checkpoint
    pub damage: Option<String>,
    /// whether it was to resume a run that has left no checkpoint yet, and begins anew
    pub begins_anew: bool,
}

/// Outcome of a job.
pub struct Outcome {
    /// as in `summary.json`
    pub summary: Summary,
    /// the most energy that there was [F·L]
    pub supplied: f64,
    /// how it ended
    pub ended: Result<(), Failed>,
    /// whether the summary could be written
    pub written: Result<(), Error>,
}

impl Outcome {
    /// Whether the results can be read again.
    pub fn is_readable(&self) -> bool {
        let full = matches!(&self.ended, Err(Failed::Stopped(Error::Output { .. }) | Failed::Defect(_)));
        !full && self.written.is_ok()
    }
}

impl Job {
    /// Build the model of a case, and lock the folder of its results.
    ///
    /// # Errors
    /// [`Refused`].
    pub fn open(mut opened: Opened, place: &Path) -> Result<Self, Refused> {
        let (model, saved) = opened.build()?;
        Self::claim(opened, model, saved, place)
    }

    /// Go on with the run in a folder: from its last checkpoint, or anew where the folder is absent or empty, or holds this
    /// case's own unfinished run without a checkpoint yet, so that a job that is queued again always says the same. The case is
    /// opened at the checkpoint, or at its beginning; `warn` is told where another version has written the checkpoint.
    ///
    /// # Errors
    /// [`Refused`].
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

    fn claim(opened: Opened, model: Arc<Model>, saved: Option<SavedRun>, place: &Path) -> Result<Self, Refused> {
        let inputs: Vec<PathBuf> = opened.inputs.iter().cloned().chain([opened.path.clone()]).collect();
        let outputs = files(&opened.case, &model);
        let folder = Folder::claim(place, &inputs, &outputs, opened.resumes());
        let folder = folder.map_err(|(path, cause)| Refused::Folder(path, cause))?;
        Ok(Self { opened, model, folder, saved, damage: None, begins_anew: false })
    }

    /// Run the job to its end, or until it stops.
    ///
    /// # Errors
    /// [`Refused::Run`] where it cannot go on from its checkpoint; nothing has changed then.
    pub fn run(&mut self, callbacks: Callbacks) -> Result<Outcome, Refused> {
        let about = about(&self.opened, &self.model);
        let Self { opened, model, folder, saved, damage, .. } = self;
        let summary = |ending, report, warnings| Summary::new(ending, about.clone(), model, report, warnings);
        let first = summary(Ending::running(&folder.files), RunReport::default(), model.warnings());
        let mut work = Work::default();
        let result = defect::catch(|| work.go(opened, model, folder, saved.take(), &first, callbacks));
        let result = match (result, opened.resumes(), &work.simulation) {
            (Ok(Err(error)), true, None) => return Err(error.into()),
            (result, ..) => result,
        };
        folder.forget_what_never_came();
        let ending = match &result {
            Ok(result) => Ending::new(result.as_ref().err(), &folder.files),
            Err(defect) => Ending::defect(defect, &folder.files),
        };
        if let Ok(result) = &result {
            folder.make_room_after(result);
        }
        let report = work.simulation.map(|simulation| simulation.report()).unwrap_or_default();
        work.warnings.extend(damage.take().map(|damage| format!("{damage}; the previous checkpoint was used")));
        let last = Summary {
            chatter: work.chatter,
            friction_course: work.courses,
            energy_in_penalties: work.energy_in_penalties,
            ..summary(ending, report, work.warnings)
        };
        let written = summary::write(&last, &folder.path);
        let ended = result.map_err(Failed::Defect).and_then(|ended| ended.map_err(Failed::Stopped));
        Ok(Outcome { summary: last, supplied: work.supplied, ended, written })
    }
}

/// Data about the case for readers of the results.
fn about(Opened { case, path, document, .. }: &Opened, model: &Model) -> About {
    About {
        case: path.display().to_string(),
        title: case.title.clone(),
        section: Some(model.mesh.section.to_string()),
        units: case.units.clone(),
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

/// A case as it is written, but for a mesh given node by node.
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
    /// `None` until it has begun
    simulation: Option<Simulation>,
    warnings: Vec<String>,
    /// restarts of slip, if the case asks for fronts
    chatter: Option<BTreeMap<String, f64>>,
    courses: BTreeMap<String, FrictionHistory>,
    /// how much of the elastic energy was in penalties of contacts [-]
    energy_in_penalties: Option<f64>,
    /// the most energy that there was [F·L]
    supplied: f64,
}

impl Work {
    /// Begin or resume, and run to the end.
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
        // The summary identifies the files, so it comes first; that of a resumed run stays valid until the run
        // continues.
        if !resumes {
            summary::write(first, &folder.path)?;
        }
        let warnings = Warnings::reporting(model.warnings(), warn);
        let frames = opened.case.output.frames(opened.case.steps.len() - opened.taken_over);
        let mut outputs = Outputs::open(&folder.path, model, &opened.case, frames, saved.as_ref(), warnings)?;
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
        result
    }
}

/// Why a run is to end before its time, if it is.
pub type Ends = Arc<dyn Fn() -> Option<Error> + Send + Sync>;

/// Callbacks and observers of a run.
pub struct Callbacks<'a> {
    /// receives warnings when they arise, except those of the model
    pub warn: Warn,
    /// is asked between two increments, and within explicit ones
    pub ends: Ends,
    /// shows how far it is
    pub progress: Option<Box<dyn Observer + 'a>>,
}
