//! `probes.csv`: what gauges at points of the bodies read, at the rows of the history.

use std::path::Path;

use super::csv::{Opening, Table};
use super::gauge::Reading;
use super::memory;
use super::rows::Rows;
use crate::laws::bulk::CauchyStress;
use crate::model::Model;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};

/// Columns of every probe.
const READINGS: [&str; 11] =
    ["ux", "uy", "vx", "vy", "strain_xx", "strain_yy", "strain_xy", "stress_xx", "stress_yy", "stress_zz", "stress_xy"];

/// The strain of hoops, of every probe of rings behind its other columns.
const HOOP: &str = "strain_zz";

/// The columns of every probe of a model.
fn readings(model: &Model) -> impl Iterator<Item = &'static str> {
    READINGS.into_iter().chain(model.mesh.section.is_axisymmetric().then_some(HOOP))
}

/// Writes `probes.csv`.
#[derive(Debug)]
pub struct Probes {
    table: Table,
    rows: Rows,
}

impl Probes {
    /// Create `probes.csv` in `folder`.
    ///
    /// # Errors
    /// [`Error::Output`] when it cannot be written.
    pub fn create(folder: &Path, model: &Model) -> Result<Self, Error> {
        Self::with(Table::create, folder, model)
    }

    /// The `probes.csv` that is there, to be restored.
    ///
    /// # Errors
    /// [`Error::Output`] when it cannot be opened.
    pub fn reopen(folder: &Path, model: &Model) -> Result<Self, Error> {
        Self::with(Table::reopen, folder, model)
    }

    fn with(open: Opening, folder: &Path, model: &Model) -> Result<Self, Error> {
        let columns = model.probes.iter().flat_map(|probe| readings(model).map(|of| format!("{}.{of}", probe.name)));
        let header: Vec<String> = std::iter::once("time".into()).chain(columns).collect();
        Ok(Self { table: open(&folder.join("probes.csv"), &header)?, rows: Rows::default() })
    }
}

impl Observer for Probes {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        let row = self.rows.judge(model, attempt, state);
        self.table.number(state.time);
        for probe in &model.probes {
            let Reading { displacement: u, velocity: v, strain, hoop_strain, stress } =
                Reading::of(probe, model, state);
            let CauchyStress { xx, yy, zz, xy } = stress;
            let hoop = model.mesh.section.is_axisymmetric().then_some(hoop_strain);
            let all = [u.x, u.y, v.x, v.y].into_iter().chain(strain).chain([xx, yy, zz, xy]).chain(hoop);
            self.table.numbers(all);
        }
        self.table.end_row_as(row)?;
        self.table.share()
    }

    fn name(&self) -> &'static str {
        "probes"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        memory::written(&(self.table.standing()?, &self.rows))
    }

    fn check(&self, memory: &[u8]) -> Result<(), Error> {
        memory::check_table(&self.table, memory)
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        self.rows = memory::cut_table(&mut self.table, memory)?;
        Ok(())
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.table.flush()
    }
}
