//! `interface.zarr`: contact quantities over time and place, in a store that xarray opens directly.
//!
//! | array | dimensions | meaning |
//! |---|---|---|
//! | `time` | `time` | t of the rows of `history.csv` [T] |
//! | `C.position`, `C.x`, `C.y`, `C.line` | `C.point` | undeformed points of contact C: arc length along the slave, coordinates, number of the continuous line [L] |
//! | `C.slip`, `C.pressure` … | `time`, `C.point` | quantities of every contact ([`IN_STORE`]); slip rates are mean plastic slip rates since the previous row |
//! | `C.theta` … | | further observables of a law, by their names; NaN where another law acts |
//!
//! Times and places are exact; quantities that vary in time are rounded, with a relative error of 2⁻¹⁶ ([`codec`]).

mod arrays;
pub mod codec;
pub mod derivatives;
pub mod read;
mod zarr;

use std::collections::BTreeMap;
use std::path::Path;

use self::arrays::{along, attributes, prefixes, quantity, time};
use self::zarr::{Saved, Store};
use super::csv;
use super::quantities::IN_STORE;
use crate::contact::pair;
use crate::contact::{ContactPair, ContactState};
use crate::laws::friction::observables;
use crate::model::{Model, State};
use crate::run::{Attempt, Error, Observer, Row};
pub use zarr::{files_of, forget, is_own};

/// Folder of the store in the results folder.
pub const STORE: &str = "interface.zarr";

/// Observer that writes `interface.zarr` at the rows of the history.
#[derive(Debug)]
pub struct InterfaceStore {
    store: Store,
    /// Names of the quantities of each contact
    names: Vec<Vec<&'static str>>,
    /// Record that is written only if an event follows
    pending: Option<Record>,
    /// Time of the last record, and slip of every contact and point at that time
    last: (f64, Vec<Vec<f64>>),
}

/// Index of the slip among the quantities of the store, ...
const SLIP: usize = 0;
/// ... and its rate.
const SLIP_RATE: usize = 2;

/// Time, and the quantities of all contacts in sequence.
type Record = Vec<Vec<f64>>;

/// Saved memory: of the store, the pending record, and the last record.
type Memory = (Saved, Option<Record>, (f64, Vec<Vec<f64>>));

impl InterfaceStore {
    /// Creates the store in `folder`; `start` is the state before the first increment. `units` contains the known labels of
    /// `length`, `force`, `time` and `stress`.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if it cannot be written.
    pub fn create(
        folder: &Path,
        model: &Model,
        start: &State,
        units: &BTreeMap<String, String>,
    ) -> Result<Self, Error> {
        let mut store = Self::reopen(folder, model, start, units);
        store.store.create()?;
        Ok(store)
    }

    /// Opens the existing store, to be restored.
    pub fn reopen(folder: &Path, model: &Model, start: &State, units: &BTreeMap<String, String>) -> Self {
        let further = |pair: &ContactPair| observables::further(pair.laws.iter().map(|law| &law.description));
        let in_fluid = |pair: &ContactPair| pair.holds_fluid().then_some("fluid_pressure");
        let names = |pair: &ContactPair| {
            let flows = pair.conduit.is_some().then_some(["water_flow", "aperture"]).into_iter().flatten();
            IN_STORE.map(|of| of.name).into_iter().chain(further(pair)).chain(in_fluid(pair)).chain(flows).collect()
        };
        let names: Vec<Vec<&str>> = model.contacts.iter().map(names).collect();
        let prefixes = prefixes(model);
        let mut fixed = Vec::new();
        let mut growing = vec![(time(units), Vec::new())];
        for ((pair, prefix), names) in model.contacts.iter().zip(&prefixes).zip(&names) {
            fixed.extend(along(model, pair, prefix, units));
            let quantity = |name: &&str| (quantity(pair, prefix, name, units), vec![pair.points.len()]);
            growing.extend(names.iter().map(quantity));
        }
        let slips = |states: &Vec<ContactState>| states.iter().map(|state| state.friction.plastic_slip).collect();
        Self {
            store: Store::new(folder.join(STORE), attributes(model), fixed, growing),
            names,
            pending: None,
            last: (start.time, start.contacts.iter().map(slips).collect()),
        }
    }

    /// Creates the record of a state; its slip rates still refer to its increment.
    fn record_of(&self, model: &Model, state: &State) -> Record {
        let mut record = vec![vec![state.time]];
        for ((pair, states), names) in model.contacts.iter().zip(&state.contacts).zip(&self.names) {
            record.extend(names.iter().map(|name| pair::field_values(pair, states, state.time, state.dt, name)));
        }
        record
    }

    fn write(&mut self, mut record: Record) -> Result<(), Error> {
        let (time, mut first) = (record[0][0], 1);
        let (before, slips) = &mut self.last;
        for (names, old) in self.names.iter().zip(slips) {
            let slip = record[first + SLIP].clone();
            record[first + SLIP_RATE] =
                slip.iter().zip(&*old).map(|(new, old)| (new - old) / (time - *before)).collect();
            *old = slip;
            first += names.len();
        }
        *before = time;
        self.store.push(&record)
    }
}

/// Records to be written now, after a new one that may be pending.
fn due(pending: &mut Option<Record>, new: Record, row: Row) -> Vec<Record> {
    let before = pending.take();
    match row {
        Row::Pending => {
            *pending = Some(new);
            Vec::new()
        }
        Row::Written => vec![new],
        Row::AfterTheHeld => before.into_iter().chain([new]).collect(),
    }
}

impl Observer for InterfaceStore {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        let record = self.record_of(model, state);
        due(&mut self.pending, record, attempt.row).into_iter().try_for_each(|record| self.write(record))?;
        self.store.share()
    }

    fn name(&self) -> &'static str {
        "interface"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        csv::remembered(&(self.store.save()?, &self.pending, &self.last))
    }

    fn check(&self, memory: &[u8]) -> Result<(), Error> {
        self.store.check(&csv::recalled::<Memory>(memory)?.0)
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        let saved;
        (saved, self.pending, self.last) = csv::recalled::<Memory>(memory)?;
        self.store.restore(saved)
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.store.finish()
    }
}
