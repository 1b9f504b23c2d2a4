//! Observers of a run, and the files they write.
//!
//! Each warning is reported once, when it arises.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use crate::case::again::Opened;
use crate::case::file::Case;
use crate::case::units;
use crate::model::Model;
use crate::output::fields::{Fields, Frames};
use crate::output::folder::{GRADIENTS, INTERFACE};
use crate::output::friction_history::FrictionHistory;
use crate::output::fronts::Fronts;
use crate::output::gradients::{self, Asked, Gradients, Motions};
use crate::output::history::History;
use crate::output::newton_log::NewtonLog;
use crate::output::probes::Probes;
use crate::output::sections::Sections;
use crate::output::store::InterfaceStore;
use crate::output::warnings::{Warn, Warnings};
use crate::output::{checkpoint, report};
use crate::run::{Error, Observer, SavedRun};

/// Files written by a run in addition to `summary.json`; folders of frames end in `/`.
pub(super) fn files(case: &Case, model: &Model) -> Vec<&'static str> {
    let mut files = vec!["history.csv", "newton.csv"];
    if case.output.fields {
        files.extend(["solid.pvd", "solid/"]);
        if !model.contacts.is_empty() {
            files.extend(["contact.pvd", "contact/"]);
        }
        if !model.bars.is_empty() {
            files.extend(["bars.pvd", "bars/"]);
        }
        if case.output.points {
            files.extend(["points.pvd", "points/"]);
        }
    }
    if !model.contacts.is_empty() {
        files.push(INTERFACE);
    }
    if !model.requests.probes.is_empty() {
        files.push("probes.csv");
    }
    if !model.requests.sections.is_empty() {
        files.push("sections.csv");
    }
    if !case.gradients.is_empty() {
        files.extend([gradients::FILE, GRADIENTS]);
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

/// Observers of a run, according to the case.
pub(super) struct Outputs {
    history: Option<History>,
    newton_log: Option<NewtonLog>,
    pub warnings: Warnings,
    interface: Option<InterfaceStore>,
    probes: Option<Probes>,
    sections: Option<Sections>,
    fields: Option<Fields>,
    pub fronts: Option<Fronts>,
    pub gradients: Option<Gradients>,
}

impl Outputs {
    /// Creates all files, or opens those written by the saved run.
    pub fn open(
        folder: &Path,
        model: &Arc<Model>,
        Opened { case, neighbours, .. }: &Opened,
        frames: Frames,
        saved: Option<&SavedRun>,
        warnings: Warnings,
        warn: Warn,
    ) -> Result<Self, Error> {
        let start = saved.map_or_else(|| model.initial_state(), |saved| saved.simulation().state().clone());
        let goes_on = |name: &str| saved.is_some_and(|saved| saved.remembers(name));
        let labels = units::filled(&case.units, model.mesh.section);
        let (has_contacts, has_fields) = (!model.contacts.is_empty(), case.output.fields);
        let store = || InterfaceStore::reopen(folder, model, &start, &labels);
        let asked = Asked {
            units: &labels,
            of_displacements: case.output.displacement_gradients,
            goes_on: goes_on("gradients"),
        };
        let gradients = neighbours.as_ref().map(|of| Gradients::new(folder, model, of, asked, warn)).transpose()?;
        let motions = gradients.as_ref().map_or_else(Motions::default, Gradients::motions);
        let series = || Fields::reopen(folder, model.clone(), frames, motions.clone(), &labels);
        let mut outputs = Self {
            history: goes_on("history").then(|| History::reopen(folder, model)).transpose()?,
            newton_log: goes_on("newton").then(|| NewtonLog::reopen(folder, model)).transpose()?,
            warnings,
            interface: (goes_on("interface") && has_contacts).then(store),
            probes: goes_on("probes").then(|| Probes::reopen(folder, model)).transpose()?,
            sections: goes_on("sections").then(|| Sections::reopen(folder, model)).transpose()?,
            fields: (goes_on("fields") && has_fields).then(series).transpose()?,
            fronts: case.output.fronts.map(|criterion| Fronts::new(folder, model, &start, criterion)),
            gradients,
        };
        // A run is resumed only if all its files are unchanged.
        saved.map_or(Ok(()), |saved| saved.check(&outputs.observers()))?;
        if outputs.history.is_none() {
            outputs.history = Some(History::create(folder, model)?);
        }
        if outputs.newton_log.is_none() {
            outputs.newton_log = Some(NewtonLog::create(folder, model)?);
        }
        if outputs.interface.is_none() && has_contacts {
            outputs.interface = Some(InterfaceStore::create(folder, model, &start, &labels)?);
        }
        if outputs.probes.is_none() && !model.requests.probes.is_empty() {
            outputs.probes = Some(Probes::create(folder, model)?);
        }
        if outputs.sections.is_none() && !model.requests.sections.is_empty() {
            outputs.sections = Some(Sections::create(folder, model)?);
        }
        if outputs.fields.is_none() && has_fields {
            // Their first frame shows the derivatives with which the run goes on.
            let gradients = outputs.gradients.as_mut();
            saved.zip(gradients).map_or(Ok(()), |(saved, gradients)| saved.restore(gradients))?;
            outputs.fields = Some(Fields::create(folder, model.clone(), &start, frames, motions, &labels)?);
        }
        Ok(outputs)
    }

    /// Friction histories of the contacts by name; only those that carried friction.
    pub fn courses(&self, model: &Model) -> BTreeMap<String, FrictionHistory> {
        let courses = self.history.iter().flat_map(History::courses);
        let named = model.contacts.iter().zip(courses);
        let of_friction = named.filter(|(_, course)| course.is_friction());
        of_friction.map(|(pair, course)| (pair.name.clone(), course.clone())).collect()
    }

    /// Returns all observers.
    pub fn observers<'a, 'b: 'a>(&'b mut self) -> Vec<&'a mut (dyn Observer + 'a)> {
        fn watch<'a>(observer: &'a mut Option<impl Observer + 'a>) -> Option<&'a mut (dyn Observer + 'a)> {
            observer.as_mut().map(|observer| observer as &mut dyn Observer)
        }
        let Self { history, newton_log, warnings, interface, probes, sections, fields, fronts, gradients } = self;
        let warnings: Option<&mut dyn Observer> = Some(warnings);
        let all = [
            watch(history),
            watch(newton_log),
            warnings,
            watch(interface),
            watch(probes),
            watch(sections),
            // Before the frames that show its derivatives.
            watch(gradients),
            watch(fields),
            watch(fronts),
        ];
        all.into_iter().flatten().collect()
    }
}
