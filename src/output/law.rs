//! What driving a friction law alone leaves behind: `law.csv`, and what the rows amount to.

use std::path::Path;

use serde::Serialize;

use super::csv::Table;
use crate::error::Error;
use crate::friction::{FrictionResponse, FrictionState};

/// One step along the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawRow {
    /// t [T]
    pub time: f64,
    /// total slip since the start [L]
    pub slip: f64,
    /// what the law answered
    pub response: FrictionResponse,
    /// 1/R* [-]
    pub structure: f64,
}

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

/// A moment of the path, as far as peaks and holds are concerned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Moment {
    /// t [T]
    pub time: f64,
    /// total slip [L]
    pub slip: f64,
    /// |q|/p: apparent friction coefficient [-]
    pub coefficient: f64,
    /// μ: what the interface could carry [-]
    pub mu: f64,
}

impl Moment {
    /// From the numbers of a row; without pressure there is no coefficient.
    pub fn new([time, slip, pressure, traction, mu]: [f64; 5]) -> Self {
        let coefficient = if pressure > 0.0 { traction.abs() / pressure } else { 0.0 };
        Self { time, slip, coefficient, mu }
    }
}

/// A time without slip, and the peak of friction in the slip that follows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Hold {
    /// its length [T]
    pub duration: f64,
    /// the highest |q|/p until the next hold
    pub peak: Moment,
}

/// Peaks of |q|/p: over all steps, and after every hold.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Peaks {
    /// the highest |q|/p at the end of a step, the first where several are equal
    pub peak: Option<Moment>,
    /// holds that slip has followed
    pub holds: Vec<Hold>,
    #[serde(skip)]
    last: Option<Moment>,
    /// start of the hold that is going on
    #[serde(skip)]
    rest_since: Option<f64>,
}

impl Peaks {
    /// Take note of the next row.
    pub fn note(&mut self, now: Moment) {
        let higher = |than: &Moment| now.coefficient > than.coefficient;
        let Some(last) = self.last.replace(now) else { return };
        if self.peak.as_ref().is_none_or(higher) {
            self.peak = Some(now);
        }
        if now.slip == last.slip {
            self.rest_since.get_or_insert(last.time);
        } else if let Some(start) = self.rest_since.take() {
            self.holds.push(Hold { duration: last.time - start, peak: now });
        } else if let Some(hold) = self.holds.last_mut().filter(|hold| higher(&hold.peak)) {
            hold.peak = now;
        }
    }
}

/// What a test of a law amounts to.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LawReport {
    /// steps answered
    pub steps: usize,
    /// most evaluations of the law's scalar equation in one step
    pub most_evaluations: usize,
    /// peak of |q|/p, and holds
    #[serde(flatten)]
    pub peaks: Peaks,
    /// work dissipated by friction [F/L]
    pub dissipation: f64,
    /// warnings
    pub warnings: Vec<String>,
}

impl LawReport {
    /// Take note of the next row.
    pub fn note(&mut self, row: &LawRow) {
        let FrictionResponse { state, evaluations, .. } = row.response;
        let FrictionState { pressure, traction, mu, dissipation, .. } = state;
        // The first row is the start.
        self.steps += usize::from(self.peaks.last.is_some());
        self.peaks.note(Moment::new([row.time, row.slip, pressure, traction, mu]));
        self.most_evaluations = self.most_evaluations.max(evaluations);
        self.dissipation = dissipation;
    }
}
