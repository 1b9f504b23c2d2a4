//! `law.csv`: responses of a friction law in a law test.

use std::path::Path;

use super::csv::Table;
use super::quantities::{BONDED, LAW, MACHINE, OPENED, names};
use crate::laws::friction::{Cohesion, ContactLaw, FrictionResponse, observables};
use crate::run::error::Error;
use crate::run::law::{LawMachine, LawRow, LawTest};

/// Writes `law.csv`.
#[derive(Debug)]
pub struct LawTable<'a> {
    table: Table,
    law: &'a ContactLaw,
}

impl<'a> LawTable<'a> {
    /// Creates `law.csv` of a test in `folder`; further observables of its law have columns at the end, and so have the gap of one
    /// that opens, the opening and the rest of a bond, a slider and derivatives.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if it cannot be written.
    pub fn create(folder: &Path, test: &'a LawTest) -> Result<Self, Error> {
        let law = &test.law;
        let further = further(law).map(String::from);
        let gap = (!law.description.opening.is_empty()).then(|| OPENED.name.into());
        let bond = names(&BONDED).filter(|_| is_bonded(law));
        let machine = names(&MACHINE).filter(|_| test.slider.is_some());
        let header = names(&LAW).chain(further).chain(gap).chain(bond).chain(machine).chain(test.derivatives());
        let header = header.collect();
        Ok(Self { table: Table::create(&folder.join("law.csv"), header)?, law })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if it cannot be written.
    pub fn write(&mut self, row: &LawRow) -> Result<(), Error> {
        let Self { table, law } = self;
        let LawRow { time, slip, response, gap, bond, machine, derivatives, .. } = row;
        let FrictionResponse { state, dtraction_dslip, dtraction_dpressure, evaluations, .. } = response;
        let observed = |name: &str| law.observe(name, state);
        let mut write = |numbers: &[f64]| numbers.iter().for_each(|number| table.number(*number));
        let of_friction = [state.pressure, state.traction, state.dissipation];
        let [pressure, traction, dissipation] =
            bond.map_or(of_friction, |bond| [bond.pressure, bond.traction, bond.dissipation]);
        write(&[*time, *slip, pressure, traction]);
        write(&observables::ALWAYS.map(|(name, _)| observed(name)));
        write(&[state.plastic_slip, dissipation, *dtraction_dslip, *dtraction_dpressure]);
        table.count(*evaluations);
        table.numbers(further(law).map(observed));
        if !law.description.opening.is_empty() {
            table.number(*gap);
        }
        if let Some(bond) = bond {
            table.numbers([bond.opening, bond.intact]);
        }
        if let Some(LawMachine { load_point, force, slip_rate, .. }) = *machine {
            table.numbers([load_point, force, slip_rate]);
        }
        table.numbers(derivatives.iter().copied());
        table.end_row()
    }

    /// Writes all pending rows to the system.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if they cannot be written.
    pub fn finish(mut self) -> Result<(), Error> {
        self.table.flush()
    }
}

/// Whether a bond in parallel with friction has columns of its own.
fn is_bonded(law: &ContactLaw) -> bool {
    matches!(law.cohesion, Some(Cohesion::Parallel(_)))
}

/// Further observables of a law that are not columns of its bond.
fn further(law: &ContactLaw) -> impl Iterator<Item = &'static str> {
    let bonded = is_bonded(law);
    let is_other = move |name: &&str| !(bonded && names(&BONDED).any(|own| own == **name));
    observables::further([&law.description]).into_iter().filter(is_other)
}
