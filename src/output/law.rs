//! `law.csv`: what a friction law driven alone answered.

use std::path::Path;

use super::csv::Table;
use crate::laws::friction::{FrictionResponse, FrictionState};
use crate::run::error::Error;
use crate::run::law_report::LawRow;

/// The columns of `law.csv`.
pub const COLUMNS: [&str; 12] = [
    "time",
    "slip",
    "pressure",
    "traction",
    "R",
    "mu",
    "structure",
    "plastic_slip",
    "dissipation",
    "dtraction_dslip",
    "dtraction_dpressure",
    "evaluations",
];

/// Writes `law.csv`.
#[derive(Debug)]
pub struct LawTable(Table);

impl LawTable {
    /// Create `law.csv` in `folder`.
    ///
    /// # Errors
    /// [`Error::Output`] when it cannot be written.
    pub fn create(folder: &Path) -> Result<Self, Error> {
        Ok(Self(Table::create(&folder.join("law.csv"), &COLUMNS)?))
    }

    /// Write a row.
    ///
    /// # Errors
    /// [`Error::Output`] when it cannot be written.
    pub fn write(&mut self, row: &LawRow) -> Result<(), Error> {
        let Self(table) = self;
        let LawRow { time, slip, structure, response } = row;
        let FrictionResponse { state, dtraction_dslip, dtraction_dpressure, evaluations } = response;
        let FrictionState { traction, pressure, mu, plastic_slip, dissipation, .. } = *state;
        for number in [*time, *slip, pressure, traction, state.ratio(), mu, *structure, plastic_slip, dissipation] {
            table.number(number);
        }
        table.number(*dtraction_dslip);
        table.number(*dtraction_dpressure);
        table.count(*evaluations);
        table.end_row()
    }

    /// Hand all rows to the system.
    ///
    /// # Errors
    /// [`Error::Output`] when they cannot be written.
    pub fn finish(mut self) -> Result<(), Error> {
        self.0.flush()
    }
}
