//! `history.csv`: a row per accepted increment.

use std::path::Path;

use super::csv::{Opening, Table};
use super::memory;
use crate::contact::force::ContactState;
use crate::contact::pair::ContactPair;
use crate::laws::friction::{Regime, observables};
use crate::model::state::{Energy, State};
use crate::model::{Model, WatchedSet};
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};

/// Writes `history.csv`.
#[derive(Debug)]
pub struct History {
    table: Table,
    /// Observables of each contact whose means are written
    observed: Vec<Vec<&'static str>>,
}

const INCREMENT: [&str; 4] = ["time", "dt", "step", "iterations"];
const ENERGIES: [&str; 7] = [
    "kinetic",
    "strain",
    "contact_elastic",
    "friction_dissipation",
    "damping_dissipation",
    "external_work",
    "energy_error",
];
const CONTACT: [&str; 8] = [
    "normal_force",
    "tangential_force",
    "contact_length",
    "slip_fraction",
    "mean_slip",
    "max_penetration",
    "max_elastic_slip",
    "mean_elastic_slip",
];
const WATCHED: [&str; 4] = ["ux", "uy", "fx", "fy"];

impl History {
    /// Create `history.csv` in `folder`.
    ///
    /// # Errors
    /// [`Error::Output`] when it cannot be written.
    pub fn create(folder: &Path, model: &Model) -> Result<Self, Error> {
        Self::with(Table::create, folder, model)
    }

    /// The `history.csv` that is there, to be restored.
    ///
    /// # Errors
    /// [`Error::Output`] when it cannot be opened.
    pub fn reopen(folder: &Path, model: &Model) -> Result<Self, Error> {
        Self::with(Table::reopen, folder, model)
    }

    fn with(open: Opening, folder: &Path, model: &Model) -> Result<Self, Error> {
        let of = |name: &str, columns: &[&str]| columns.iter().map(|c| format!("{name}.{c}")).collect::<Vec<_>>();
        let mut header: Vec<String> = INCREMENT.iter().chain(&ENERGIES).map(|c| (*c).into()).collect();
        header.extend(model.contacts.iter().flat_map(|pair| of(&pair.name, &CONTACT)));
        header.extend(model.watch.iter().flat_map(|set| of(&set.name, &WATCHED)));
        let further = |pair: &ContactPair| observables::further(pair.laws.iter().map(|law| &**law));
        let observed: Vec<Vec<&str>> = model.contacts.iter().map(further).collect();
        for (pair, names) in model.contacts.iter().zip(&observed) {
            header.extend(names.iter().map(|name| format!("{}.mean_{name}", pair.name)));
        }
        Ok(Self { table: open(&folder.join("history.csv"), &header)?, observed })
    }
}

impl Observer for History {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        let Self { table, observed } = self;
        table.number(state.time);
        table.number(state.dt);
        table.text(&attempt.step.name);
        table.count(attempt.iterations.len());
        energy_row(&state.energy).into_iter().for_each(|energy| table.number(energy));
        for (pair, states) in model.contacts.iter().zip(&state.contacts) {
            contact_row(pair, states).into_iter().for_each(|number| table.number(number));
        }
        for set in &model.watch {
            watched_row(set, state).into_iter().for_each(|number| table.number(number));
        }
        for ((pair, states), names) in model.contacts.iter().zip(&state.contacts).zip(observed) {
            names.iter().for_each(|name| table.number(mean(pair, states, name)));
        }
        table.end_row()?;
        table.share()
    }

    fn name(&self) -> &'static str {
        "history"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        memory::of_table(&mut self.table)
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        memory::cut_table(&mut self.table, memory)
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.table.flush()
    }
}

fn energy_row(energy: &Energy) -> [f64; ENERGIES.len()] {
    [
        energy.kinetic,
        energy.strain,
        energy.contact_elastic,
        energy.friction_dissipation,
        energy.damping_dissipation,
        energy.external_work,
        energy.error(),
    ]
}

/// The columns of one contact: forces are ∫ p ds and ∫ q ds, means are taken over the closed length.
fn contact_row(pair: &ContactPair, states: &[ContactState]) -> [f64; CONTACT.len()] {
    let (mut normal, mut tangential, mut closed, mut slipping, mut slip) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let (mut penetration, mut largest_elastic, mut elastic) = (0.0f64, 0.0f64, 0.0);
    for (point, state) in pair.points.iter().zip(states) {
        let (friction, length) = (&state.friction, state.length);
        if state.regime() == Regime::Open {
            continue;
        }
        normal += length * friction.pressure;
        tangential += length * friction.traction;
        closed += length;
        slipping += if state.regime() == Regime::Slip { length } else { 0.0 };
        slip += length * friction.plastic_slip;
        penetration = penetration.max(-state.clearance());
        largest_elastic = largest_elastic.max(pair.elastic_slip(point, friction).abs());
        elastic += length * pair.elastic_slip(point, friction);
    }
    let share = |part: f64| if closed > 0.0 { part / closed } else { 0.0 };
    [normal, tangential, closed, share(slipping), share(slip), penetration, largest_elastic, share(elastic)]
}

/// Mean of an observable over the closed length; 0 where nothing is closed.
fn mean(pair: &ContactPair, states: &[ContactState], name: &str) -> f64 {
    let (mut sum, mut closed) = (0.0, 0.0);
    for (point, state) in pair.points.iter().zip(states).filter(|(_, state)| state.regime() != Regime::Open) {
        sum += state.length * observables::value(pair.law(point), name, &state.friction);
        closed += state.length;
    }
    if closed > 0.0 { sum / closed } else { 0.0 }
}

/// Mean displacement and total reaction of a watched set.
fn watched_row(set: &WatchedSet, state: &State) -> [f64; WATCHED.len()] {
    let total = |values: &[f64], i: usize| set.nodes.iter().map(|&node| values[2 * node + i]).sum::<f64>();
    let mean = |i| total(&state.displacement, i) / set.nodes.len() as f64;
    [mean(0), mean(1), total(&state.reaction, 0), total(&state.reaction, 1)]
}
