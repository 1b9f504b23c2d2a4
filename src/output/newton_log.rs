//! `newton.csv`: a row per linear solve, those of failed attempts included.

use std::path::Path;

use super::csv::Table;
use super::{Attempt, Observer};
use crate::error::Error;
use crate::model::Model;

/// Writes `newton.csv`.
#[derive(Debug)]
pub struct NewtonLog(Table);

impl NewtonLog {
    /// Create `newton.csv` in `folder`.
    ///
    /// # Errors
    /// [`Error::Output`] when it cannot be written.
    pub fn create(folder: &Path) -> Result<Self, Error> {
        let header = "step,increment,attempt,iteration,time,residual,correction,open,stick,slip,linear_residual";
        Ok(Self(Table::create(&folder.join("newton.csv"), &[header.into()])?))
    }
}

impl Observer for NewtonLog {
    fn record(&mut self, _model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let time = attempt.old.time + attempt.dt;
        for (k, iteration) in attempt.iterations.iter().enumerate() {
            let (newton, contacts) = (&iteration.newton, &iteration.contacts);
            self.0.line(&format!(
                "{},{},{},{},{time:?},{:?},{:?},{},{},{},{:?}",
                attempt.step.name,
                attempt.old.increment + 1,
                attempt.number,
                k + 1,
                newton.residual,
                newton.correction,
                contacts.open,
                contacts.stick,
                contacts.slip,
                newton.linear_residual,
            ))?;
        }
        self.0.flush()
    }
}
