//! `history.csv`: a row per accepted increment.

use std::path::Path;

use super::csv::Table;
use crate::contact::force::{ContactState, Status};
use crate::contact::pair::ContactPair;
use crate::model::state::{Energy, State};
use crate::model::{Model, WatchedSet};
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};

/// Writes `history.csv`.
#[derive(Debug)]
pub struct History(Table);

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
        let of = |name: &str, columns: &[&str]| columns.iter().map(|c| format!("{name}.{c}")).collect::<Vec<_>>();
        let mut header: Vec<String> = INCREMENT.iter().chain(&ENERGIES).map(|c| (*c).into()).collect();
        header.extend(model.contacts.iter().flat_map(|pair| of(&pair.name, &CONTACT)));
        header.extend(model.watch.iter().flat_map(|set| of(&set.name, &WATCHED)));
        Ok(Self(Table::create(&folder.join("history.csv"), &header)?))
    }
}

impl Observer for History {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        let Self(table) = self;
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
        table.end_row()?;
        table.share()
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.0.flush()
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
        if state.status() == Status::Open {
            continue;
        }
        normal += length * friction.pressure;
        tangential += length * friction.traction;
        closed += length;
        slipping += if state.status() == Status::Slip { length } else { 0.0 };
        slip += length * friction.plastic_slip;
        penetration = penetration.max(-state.gap);
        largest_elastic = largest_elastic.max(pair.elastic_slip(point, friction).abs());
        elastic += length * pair.elastic_slip(point, friction);
    }
    let share = |part: f64| if closed > 0.0 { part / closed } else { 0.0 };
    [normal, tangential, closed, share(slipping), share(slip), penetration, largest_elastic, share(elastic)]
}

/// Mean displacement and total reaction of a watched set.
fn watched_row(set: &WatchedSet, state: &State) -> [f64; WATCHED.len()] {
    let total = |values: &[f64], i: usize| set.nodes.iter().map(|&node| values[2 * node + i]).sum::<f64>();
    let mean = |i| total(&state.displacement, i) / set.nodes.len() as f64;
    [mean(0), mean(1), total(&state.reaction, 0), total(&state.reaction, 1)]
}
