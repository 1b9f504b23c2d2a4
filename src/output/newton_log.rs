//! `newton.csv`: a row per linear solve, those of failed attempts included; an attempt that was given up before its first
//! solve has a row as well, its `iteration` 0. On how many contact points each aid acted in its tangent ([`Acted`]), what became
//! of the attempt ([`crate::run::observer::Verdict`]) and why it was given up ([`Attempt::reason`]) stand at the end.

use std::path::Path;

use super::csv;
use super::csv::{Opening, Table};
use super::quantities::{NEWTON, VERDICT, names};
use crate::mesh::names::in_line;
use crate::model::Model;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer, Verdict};
use crate::solve::IterationRecord;
use crate::solve::contact_iteration::Acted;

/// Writes `newton.csv`.
#[derive(Debug)]
pub struct NewtonLog(Table);

/// Cells of an attempt without a solve, from `residual` to `pass`.
const NOTHING: [&str; 10] = ["NaN", "NaN", "0", "0", "0", "NaN", "0", "NaN", "0", "0"];

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

    /// The first cells of a row: whose it is.
    fn begin_row(&mut self, attempt: &Attempt, iteration: usize) {
        let Self(table) = self;
        table.text(&attempt.step.name);
        [attempt.old.increment + 1, attempt.number, iteration].into_iter().for_each(|count| table.count(count));
        table.number(attempt.old.time + attempt.dt);
    }

    /// The last cells: what became of the attempt. A comma would end the cell.
    fn end_row(&mut self, attempt: &Attempt, reason: &str) -> Result<(), Error> {
        let Self(table) = self;
        table.text(attempt.verdict.name());
        table.text(reason);
        table.end_row()
    }

    fn with(open: Opening, folder: &Path) -> Result<Self, Error> {
        let header = names(&NEWTON).chain(Acted::COLUMNS.map(String::from)).chain(names(&VERDICT)).collect();
        Ok(Self(open(&folder.join("newton.csv"), header)?))
    }
}

impl Observer for NewtonLog {
    fn record(&mut self, _model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let reason = attempt.reason().map_or_else(String::new, |reason| in_line(&reason).replace(',', ";"));
        for (k, iteration) in attempt.iterations.iter().enumerate() {
            let IterationRecord { newton, contacts, flips, pass, stabilization, acted } = iteration;
            self.begin_row(attempt, k + 1);
            let Self(table) = self;
            table.numbers([newton.residual, newton.correction]);
            [contacts.open, contacts.stick, contacts.slip].into_iter().for_each(|count| table.count(count));
            table.number(newton.linear_residual);
            table.count(usize::from(newton.factorized));
            table.number(*stabilization);
            table.count(*flips);
            table.count(*pass);
            acted.counts().into_iter().for_each(|count| table.count(count));
            self.end_row(attempt, &reason)?;
        }
        if attempt.iterations.is_empty() && attempt.verdict != Verdict::Accepted {
            self.begin_row(attempt, 0);
            NOTHING.iter().chain(&["0"; Acted::COLUMNS.len()]).for_each(|cell| self.0.text(cell));
            self.end_row(attempt, &reason)?;
        }
        self.0.share()
    }

    fn name(&self) -> &'static str {
        "newton"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        csv::table_memory(&mut self.0)
    }

    fn check(&self, memory: &[u8]) -> Result<(), Error> {
        csv::check_table(&self.0, memory)
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        csv::cut_table(&mut self.0, memory)
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.0.flush()
    }
}
