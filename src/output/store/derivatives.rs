//! `gradients.zarr`: derivatives of contact quantities by values of the case, over time and place, at the rows of the history.
//!
//! | array | dimensions | meaning |
//! |---|---|---|
//! | `time` | `time` | t of the rows of `history.csv` [T] |
//! | `C.position`, `C.x`, `C.y`, `C.line` | `C.point` | undeformed points of contact C, as in `interface.zarr` |
//! | `C.slip`, `C.pressure`, `C.traction` | `time`, `by`, `C.point` | their derivatives |
//! | `x`, `y` | `node` | undeformed nodes [L], on request with |
//! | `displacement` | `time`, `by`, `node`, `component` | the derivatives of u_x and u_y |
//!
//! The attribute `by` lists the places of the values in the case. Rounding is that of `interface.zarr`.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::json;

use super::arrays::{along, attributes, derivatives, of_nodes, prefixes, time};
use super::zarr::{Saved, Store};
use super::{Record, due};
use crate::contact::pair;
use crate::model::{Model, State};
use crate::run::{Error, Row};

/// Folder of the store in the results folder.
pub const STORE: &str = "gradients.zarr";

/// Quantities of contacts that are differentiated.
const QUANTITIES: [&str; 3] = ["slip", "pressure", "traction"];

/// Saved memory: of the store, and the pending record.
pub type Memory = (Saved, Option<Record>);

/// The store.
#[derive(Debug)]
pub struct DerivativeStore {
    store: Store,
    /// Record that is written only if an event follows
    pending: Option<Record>,
    /// Number of values of each array and place of a value
    widths: Vec<usize>,
    /// Whether those of displacements are stored
    of_nodes: bool,
}

impl DerivativeStore {
    /// Opens a store in `folder`, to be created or restored, of derivatives `by` values at these places of the case.
    pub fn new(
        folder: &Path,
        model: &Model,
        by: &[&str],
        of_displacements: bool,
        units: &BTreeMap<String, String>,
    ) -> Self {
        let (mut fixed, mut widths) = (Vec::new(), Vec::new());
        let mut growing = vec![(time(units), Vec::new())];
        for (pair, prefix) in model.contacts.iter().zip(prefixes(model)) {
            fixed.extend(along(model, pair, &prefix, units));
            let count = pair.points.len();
            let described = QUANTITIES.map(|name| (derivatives(pair, &prefix, name), vec![by.len(), count]));
            growing.extend(described);
            widths.extend(QUANTITIES.map(|_| count));
        }
        if of_displacements {
            let (places, moved) = of_nodes(model);
            let nodes = model.mesh.own_nodes();
            fixed.extend(places);
            growing.push((moved, vec![by.len(), nodes, 2]));
            widths.push(2 * nodes);
        }
        let mut attributes = attributes(model);
        attributes.insert("by".into(), json!(by));
        let store = Store::new(folder.join(STORE), attributes, fixed, growing);
        Self { store, pending: None, widths, of_nodes: of_displacements }
    }

    /// Creates its files.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if they cannot be written.
    pub fn create(&mut self) -> Result<(), Error> {
        self.store.create()
    }

    /// The values of a state whose derivatives are stored.
    pub fn values(&self, model: &Model, state: &State) -> Vec<f64> {
        let contacts = model.contacts.iter().zip(&state.contacts);
        let of_contact = |(of, states): (&_, &Vec<_>)| {
            QUANTITIES.map(|name| pair::field_values(of, states, state.time, state.dt, name)).concat()
        };
        let mut values: Vec<f64> = contacts.flat_map(of_contact).collect();
        if self.of_nodes {
            values.extend(&state.displacement[..2 * model.mesh.own_nodes()]);
        }
        values
    }

    /// Adds the derivatives at a time, by every value in turn.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if they cannot be written.
    pub fn add(&mut self, time: f64, by_each: &[Vec<f64>], row: Row) -> Result<(), Error> {
        let (mut record, mut first) = (vec![vec![time]], 0);
        for width in &self.widths {
            record.push(by_each.iter().flat_map(|values| &values[first..first + width]).copied().collect());
            first += width;
        }
        due(&mut self.pending, record, row).iter().try_for_each(|record| self.store.push(record))?;
        self.store.share()
    }

    /// Number of values by each place.
    pub fn width(&self) -> usize {
        self.widths.iter().sum()
    }

    /// Saves its memory for a checkpoint.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if its files cannot be written.
    pub fn save(&mut self) -> Result<Memory, Error> {
        Ok((self.store.save()?, self.pending.clone()))
    }

    /// Checks that what was saved is unchanged.
    ///
    /// # Errors
    /// Returns [`Error::Output`] with what is missing or was changed.
    pub fn check(&self, (saved, _): &Memory) -> Result<(), Error> {
        self.store.check(saved)
    }

    /// Resumes from what was saved.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if later records cannot be removed.
    pub fn restore(&mut self, (saved, pending): Memory) -> Result<(), Error> {
        self.pending = pending;
        self.store.restore(saved)
    }

    /// Writes the last records.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if they cannot be written.
    pub fn finish(&mut self) -> Result<(), Error> {
        self.store.finish()
    }
}
