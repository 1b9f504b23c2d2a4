//! The observers of a run, and the files they write.
//!
//! Warnings that are told as they come, each once.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use super::Warn;
use crate::case::file::{ArrivalInput, Case};
use crate::model::Model;
use crate::output::fields::{Fields, Frames};
use crate::output::folder::INTERFACE;
use crate::output::friction_course::FrictionCourse;
use crate::output::fronts::{Arrive, Fronts};
use crate::output::history::History;
use crate::output::interface::InterfaceStore;
use crate::output::newton_log::NewtonLog;
use crate::output::probes::Probes;
use crate::output::warnings::Warnings;
use crate::output::{checkpoint, report};
use crate::run::SavedRun;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};

/// What a run writes beside `summary.json`; folders of frames end in `/`.
pub(super) fn files(case: &Case, model: &Model) -> Vec<&'static str> {
    let mut files = vec!["history.csv", "newton.csv"];
    if case.output.fields {
        files.extend(["solid.pvd", "solid/"]);
        if !model.contacts.is_empty() {
            files.extend(["contact.pvd", "contact/"]);
        }
        if case.output.points {
            files.extend(["points.pvd", "points/"]);
        }
    }
    if !model.contacts.is_empty() {
        files.push(INTERFACE);
    }
    if !model.probes.is_empty() {
        files.push("probes.csv");
    }
    if case.output.fronts.is_some() {
        files.extend(["fronts.csv", "events.csv"]);
    }
    if case.output.checkpoint.is_some_and(|minutes| minutes > 0.0) {
        files.extend([checkpoint::NEWEST, checkpoint::PREVIOUS]);
    }
    if case.output.report {
        files.push(report::FILE);
    }
    files
}

/// Which frames a case asks for.
fn frames(case: &Case) -> Frames {
    Frames { every: case.output.every(), points: case.output.points }
}

/// The observers whose files are there already, to be gone on with.
#[derive(Default)]
struct Earlier {
    history: Option<History>,
    newton_log: Option<NewtonLog>,
    interface: Option<InterfaceStore>,
    probes: Option<Probes>,
    fields: Option<Fields>,
}

impl Earlier {
    /// Open what the saved run has written, and look whether it is as it was: before anything changes.
    fn open(folder: &Path, model: &Arc<Model>, case: &Case, saved: &SavedRun) -> Result<Self, Error> {
        let goes_on = |name: &str| saved.remembers(name);
        let asked = (goes_on("interface") && !model.contacts.is_empty(), goes_on("fields") && case.output.fields);
        let start = saved.simulation().state();
        let earlier = Self {
            history: goes_on("history").then(|| History::reopen(folder, model)).transpose()?,
            newton_log: goes_on("newton").then(|| NewtonLog::reopen(folder, model)).transpose()?,
            interface: asked.0.then(|| InterfaceStore::reopen(folder, model, start, &case.units)),
            probes: goes_on("probes").then(|| Probes::reopen(folder, model)).transpose()?,
            fields: asked.1.then(|| Fields::reopen(folder, model.clone(), frames(case))).transpose()?,
        };
        let Self { history, newton_log, interface, probes, fields } = &earlier;
        let observers = [
            history.as_ref().map(|history| history as &dyn Observer),
            newton_log.as_ref().map(|log| log as &dyn Observer),
            interface.as_ref().map(|interface| interface as &dyn Observer),
            probes.as_ref().map(|probes| probes as &dyn Observer),
            fields.as_ref().map(|fields| fields as &dyn Observer),
        ];
        saved.check(&observers.into_iter().flatten().collect::<Vec<_>>())?;
        Ok(earlier)
    }
}

/// The observers of a run.
pub(super) struct Outputs {
    history: History,
    newton_log: NewtonLog,
    pub aloud: Aloud,
    interface: Option<InterfaceStore>,
    probes: Option<Probes>,
    fields: Option<Fields>,
    pub fronts: Option<Fronts>,
}

impl Outputs {
    /// Begin all files, or open those that the saved run has written.
    pub fn open(
        folder: &Path,
        model: &Arc<Model>,
        case: &Case,
        saved: Option<&SavedRun>,
        aloud: Aloud,
    ) -> Result<Self, Error> {
        let start = saved.map_or_else(|| model.initial_state(), |saved| saved.simulation().state().clone());
        let earlier = match saved {
            Some(saved) => Earlier::open(folder, model, case, saved)?,
            None => Earlier::default(),
        };
        let fields = case.output.fields.then(|| match earlier.fields {
            Some(fields) => Ok(fields),
            None => Fields::create(folder, model.clone(), &start, frames(case)),
        });
        let interface = (!model.contacts.is_empty()).then(|| match earlier.interface {
            Some(interface) => Ok(interface),
            None => InterfaceStore::create(folder, model, &start, &case.units),
        });
        let probes = (!model.probes.is_empty()).then(|| match earlier.probes {
            Some(probes) => Ok(probes),
            None => Probes::create(folder, model),
        });
        let fronts = case.output.fronts.map(|fronts| {
            let arrive = match fronts.arrival {
                None => Arrive::Rate,
                Some(ArrivalInput::R(value)) => Arrive::R(value),
                Some(ArrivalInput::Mu(value)) => Arrive::Mu(value),
            };
            Fronts::new(folder, model, &start, fronts.slip_rate, arrive)
        });
        Ok(Self {
            history: earlier.history.map_or_else(|| History::create(folder, model), Ok)?,
            newton_log: earlier.newton_log.map_or_else(|| NewtonLog::create(folder, model), Ok)?,
            aloud,
            interface: interface.transpose()?,
            probes: probes.transpose()?,
            fields: fields.transpose()?,
            fronts,
        })
    }

    /// How the friction of the contacts went, by their names; of those that bore any.
    pub fn courses(&self, model: &Model) -> BTreeMap<String, FrictionCourse> {
        let named = model.contacts.iter().zip(self.history.courses());
        let borne = named.filter(|(_, course)| course.is_friction());
        borne.map(|(pair, course)| (pair.name.clone(), course.clone())).collect()
    }

    /// All of them.
    pub fn observers<'a, 'b: 'a>(&'b mut self) -> Vec<&'a mut (dyn Observer + 'a)> {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut self.history, &mut self.newton_log, &mut self.aloud];
        observers.extend(self.interface.as_mut().map(|interface| interface as &mut dyn Observer));
        observers.extend(self.probes.as_mut().map(|probes| probes as &mut dyn Observer));
        observers.extend(self.fields.as_mut().map(|fields| fields as &mut dyn Observer));
        observers.extend(self.fronts.as_mut().map(|fronts| fronts as &mut dyn Observer));
        observers
    }
}

/// The warnings of a run, and who tells them.
pub(super) struct Aloud {
    pub warnings: Warnings,
    warn: Warn,
    /// how many have been told
    told: usize,
}

impl Aloud {
    /// With the warnings that have been told already.
    pub fn new(list: Vec<String>, warn: Warn) -> Self {
        let told = list.len();
        let mut warnings = Warnings::default();
        warnings.list = list;
        Self { warnings, warn, told }
    }

    fn tell(&mut self) {
        self.warnings.list[self.told..].iter().for_each(|warning| (self.warn)(warning));
        self.told = self.warnings.list.len();
    }
}

impl Observer for Aloud {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let recorded = self.warnings.record(model, attempt);
        self.tell();
        recorded
    }

    fn name(&self) -> &'static str {
        self.warnings.name()
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        self.warnings.save()
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        self.warnings.restore(memory)?;
        // Those were told when they came.
        self.told = self.warnings.list.len();
        Ok(())
    }

    fn finish(&mut self) -> Result<(), Error> {
        let finished = self.warnings.finish();
        self.tell();
        finished
    }
}
