//! The observers of a run, and the files they write.

use std::path::Path;
use std::sync::Arc;

use crate::case::file::Case;
use crate::cli::progress::Progress;
use crate::model::Model;
use crate::output::checkpoint;
use crate::output::fields::Fields;
use crate::output::fronts::Fronts;
use crate::output::history::History;
use crate::output::newton_log::NewtonLog;
use crate::output::warnings::Warnings;
use crate::run::SavedRun;
use crate::run::error::Error;
use crate::run::observer::Observer;

/// What a run writes beside `summary.json`; folders of frames end in `/`.
pub(super) fn files(case: &Case, model: &Model) -> Vec<&'static str> {
    let mut files = vec!["history.csv", "newton.csv"];
    if case.output.fields {
        files.extend(["solid.pvd", "solid/"]);
        if !model.contacts.is_empty() {
            files.extend(["contact.pvd", "contact/"]);
        }
    }
    if case.output.fronts.is_some() {
        files.extend(["slip_map.csv", "fronts.csv"]);
    }
    if case.output.checkpoint.is_some_and(|minutes| minutes > 0.0) {
        files.extend([checkpoint::NEWEST, checkpoint::PREVIOUS]);
    }
    files
}

/// The observers of a run.
pub(super) struct Outputs {
    history: History,
    newton_log: NewtonLog,
    pub warnings: Warnings,
    fields: Option<Fields>,
    fronts: Option<Fronts>,
}

impl Outputs {
    /// Begin all files, or open those that the saved run has written.
    pub fn open(folder: &Path, model: &Arc<Model>, case: &Case, saved: Option<&SavedRun>) -> Result<Self, Error> {
        let goes_on = |name: &str| saved.is_some_and(|saved| saved.remembers(name));
        let start = saved.map_or_else(|| model.initial_state(), |saved| saved.simulation().state().clone());
        let every = case.output.every;
        let fields = case.output.fields.then(|| match goes_on("fields") {
            true => Fields::reopen(folder, model.clone(), every),
            false => Fields::create(folder, model.clone(), &start, every),
        });
        let fronts = case.output.fronts.map(|fronts| match goes_on("fronts") {
            true => Fronts::reopen(folder, model, &start, fronts.slip_rate),
            false => Fronts::create(folder, model, &start, fronts.slip_rate),
        });
        let mut warnings = Warnings::default();
        warnings.list = model.warnings();
        Ok(Self {
            history: if goes_on("history") { History::reopen(folder, model) } else { History::create(folder, model) }?,
            newton_log: if goes_on("newton") { NewtonLog::reopen(folder) } else { NewtonLog::create(folder) }?,
            warnings,
            fields: fields.transpose()?,
            fronts: fronts.transpose()?,
        })
    }

    /// All of them, and the progress if it is shown.
    pub fn observers<'a>(&'a mut self, progress: &'a mut Option<Progress>) -> Vec<&'a mut dyn Observer> {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut self.history, &mut self.newton_log, &mut self.warnings];
        observers.extend(self.fields.as_mut().map(|fields| fields as &mut dyn Observer));
        observers.extend(self.fronts.as_mut().map(|fronts| fronts as &mut dyn Observer));
        observers.extend(progress.as_mut().map(|progress| progress as &mut dyn Observer));
        observers
    }
}
