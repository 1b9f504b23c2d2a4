//! `newton.csv`: one row per linear solve, including those of failed attempts; an attempt rejected before its first
//! solve has one row with `iteration` 0. The last columns contain the number of contact points at which each convergence aid
//! acted in its tangent ([`Acted`]), the outcome of the attempt ([`crate::run::observer::Verdict`]) and the reason of a
//! rejection ([`Attempt::reason`]).

use super::csv::{Rows, Sheet, Table};
use super::quantities::{NEWTON, VERDICT, names};
use crate::mesh::names::in_line;
use crate::model::Model;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Verdict};
use crate::solve::IterationRecord;
use crate::solve::contact_iteration::Acted;

/// Observer that writes `newton.csv`.
pub type NewtonLog = Sheet<NewtonRows>;

/// Rows of `newton.csv`.
#[derive(Debug)]
pub struct NewtonRows;

/// Cells of an attempt without a solve, from `residual` to `pass`.
const NOTHING: [&str; 10] = ["NaN", "NaN", "0", "0", "0", "NaN", "0", "NaN", "0", "0"];

impl Rows for NewtonRows {
    const NAME: &'static str = "newton";

    fn new(_model: &Model) -> (Self, Vec<String>) {
        (Self, names(&NEWTON).chain(Acted::COLUMNS.map(String::from)).chain(names(&VERDICT)).collect())
    }

    fn write(&mut self, table: &mut Table, _model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let reason = attempt.reason().map_or_else(String::new, |reason| in_line(&reason).replace(',', ";"));
        for (k, iteration) in attempt.iterations.iter().enumerate() {
            let IterationRecord { newton, contacts, flips, pass, stabilization, acted } = iteration;
            begin_row(table, attempt, k + 1);
            table.numbers([newton.residual, newton.correction]);
            [contacts.open, contacts.stick, contacts.slip].into_iter().for_each(|count| table.count(count));
            table.number(newton.linear_residual);
            table.count(usize::from(newton.factorized));
            table.number(*stabilization);
            table.count(*flips);
            table.count(*pass);
            acted.counts().into_iter().for_each(|count| table.count(count));
            end_row(table, attempt, &reason)?;
        }
        if attempt.iterations.is_empty() && attempt.verdict != Verdict::Accepted {
            begin_row(table, attempt, 0);
            NOTHING.iter().chain(&["0"; Acted::COLUMNS.len()]).for_each(|cell| table.text(cell));
            end_row(table, attempt, &reason)?;
        }
        Ok(())
    }
}

/// Writes the first cells of a row, which identify the attempt.
fn begin_row(table: &mut Table, attempt: &Attempt, iteration: usize) {
    table.text(&attempt.step.name);
    [attempt.old.increment + 1, attempt.number, iteration].into_iter().for_each(|count| table.count(count));
    table.number(attempt.old.time + attempt.dt);
}

/// Writes the last cells: outcome and reason. A comma would end the cell.
fn end_row(table: &mut Table, attempt: &Attempt, reason: &str) -> Result<(), Error> {
    table.text(attempt.verdict.name());
    table.text(reason);
    table.end_row()
}
