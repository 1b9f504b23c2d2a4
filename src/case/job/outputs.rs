//! The observers of a run, and the files they write.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use super::aloud::Aloud;
use crate::case::file::{ArrivalInput, Case};
use crate::model::Model;
use crate::output::checkpoint;
use crate::output::fields::{Fields, Frames};
use crate::output::folder::INTERFACE;
use crate::output::friction_course::FrictionCourse;
use crate::output::fronts::{Arrive, Fronts};
use crate::output::history::History;
use crate::output::interface::InterfaceStore;
use crate::output::newton_log::NewtonLog;
use crate::output::probes::Probes;
use crate::output::report;
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
        let goes_on = |name: &str| saved.is_some_and(|saved| saved.remembers(name));
        let start = saved.map_or_else(|| model.initial_state(), |saved| saved.simulation().state().clone());
        let frames = Frames { every: case.output.every(), points: case.output.points };
        let fields = case.output.fields.then(|| match goes_on("fields") {
            true => Fields::reopen(folder, model.clone(), frames),
            false => Fields::create(folder, model.clone(), &start, frames),
        });
        let interface = (!model.contacts.is_empty()).then(|| match goes_on("interface") {
            true => Ok(InterfaceStore::reopen(folder, model, &start, &case.units)),
            false => InterfaceStore::create(folder, model, &start, &case.units),
        });
        let probes = (!model.probes.is_empty()).then(|| match goes_on("probes") {
            true => Probes::reopen(folder, model),
            false => Probes::create(folder, model),
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
            history: if goes_on("history") { History::reopen(folder, model) } else { History::create(folder, model) }?,
            newton_log: if goes_on("newton") { NewtonLog::reopen(folder) } else { NewtonLog::create(folder) }?,
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
