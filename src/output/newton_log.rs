//! `newton.csv`: a row per linear solve, those of failed attempts included. On how many contact points each
//! aid acted in its tangent ([`Acted`]) stands at the end.

use std::path::Path;

use super::csv::{Opening, Table};
use super::memory;
use crate::model::Model;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};
use crate::solve::IterationRecord;
use crate::solve::acted::Acted;

/// Writes `newton.csv`.
#[derive(Debug)]
pub struct NewtonLog(Table);

const COLUMNS: [&str; 15] = [
    "step",
    "increment",
    "attempt",
    "iteration",
    "time",
    "residual",
    "correction",
    "open",
    "stick",
    "slip",
    "linear_residual",
    "factorized",
    "stabilization",
    "flips",
    "pass",
];

impl NewtonLog {
    /// Create `newton.csv` in `folder`.
    ///
    /// # Errors
    /// [`Error::Output`] when it cannot be written.
    pub fn create(folder: &Path) -> Result<Self, Error> {
        Self::with(Table::create, folder)
    }

    /// The `newton.csv` that is there, to be restored.
    ///
    /// # Errors
    /// [`Error::Output`] when it cannot be opened.
    pub fn reopen(folder: &Path) -> Result<Self, Error> {
        Self::with(Table::reopen, folder)
    }

    fn with(open: Opening, folder: &Path) -> Result<Self, Error> {
        let header: Vec<String> = COLUMNS.iter().chain(&Acted::COLUMNS).map(|name| (*name).into()).collect();
        Ok(Self(open(&folder.join("newton.csv"), &header)?))
    }
}

impl Observer for NewtonLog {
    fn record(&mut self, _model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Self(table) = self;
        let time = attempt.old.time + attempt.dt;
        for (k, iteration) in attempt.iterations.iter().enumerate() {
            let IterationRecord { newton, contacts, flips, pass, stabilization, acted } = iteration;
            table.text(&attempt.step.name);
            [attempt.old.increment + 1, attempt.number, k + 1].into_iter().for_each(|count| table.count(count));
            [time, newton.residual, newton.correction].into_iter().for_each(|number| table.number(number));
            [contacts.open, contacts.stick, contacts.slip].into_iter().for_each(|count| table.count(count));
            table.number(newton.linear_residual);
            table.count(usize::from(newton.factorized));
            table.number(*stabilization);
            table.count(*flips);
            table.count(*pass);
            acted.counts().into_iter().for_each(|count| table.count(count));
            table.end_row()?;
        }
        table.share()
    }

    fn name(&self) -> &'static str {
        "newton"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        memory::of_table(&mut self.0)
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        memory::cut_table(&mut self.0, memory)
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.0.flush()
    }
}
