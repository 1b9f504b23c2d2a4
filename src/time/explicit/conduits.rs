//! Water that flows along contacts in explicit increments, at the displacements that are known before the forces.
//!
//! The pressure at the end of an increment follows from the surfaces there, as the force of a spring 1/S per area does, by which the stable
//! increment is bounded ([`crate::contact::pair::ContactPair::stiffest`]). A transmissivity that goes with slip or pressure is that of the
//! increment before.

use super::Explicit;
use crate::contact::conduit::{ConduitState, Wall};
use crate::equations::{Assembler, Trial};
use crate::model::state::State;
use crate::solve::conduits::{Arrived, flow, press_by};
use crate::solve::failure::IncrementFailure;

impl Explicit {
    /// Evaluates the forces at the predicted displacements, with the water at the end of the increment, which is returned.
    pub(super) fn forces_in_water(
        &mut self,
        time: f64,
        velocity: Option<&[f64]>,
        state: &mut State,
        assembler: &mut Assembler,
    ) -> Result<Arrived, IncrementFailure> {
        let model = &*self.model.clone();
        if model.contacts.iter().all(|pair| pair.conduit.is_none()) {
            self.forces_with_pressures(time, velocity, state, assembler)?;
            return Ok(Arrived::new());
        }
        let arrived = flow(model, self.trial(time, state), |k, _| state.conduits[k].walls.clone())?;
        press_by(model, &arrived, state);
        self.forces_with_pressures(time, velocity, state, assembler)?;
        let found = &assembler.evaluation.contacts;
        let again = flow(model, self.trial(time, state), |k, conduit| conduit.walls(&found[k]))?;
        let separation = |(old, new): (&Wall, &Wall)| old.opening != new.opening;
        let opens = arrived.iter().zip(&again).any(|(old, new)| match (old, new) {
            (Some(old), Some(new)) => old.walls.iter().zip(&new.walls).any(separation),
            _ => false,
        });
        if opens {
            press_by(model, &again, state);
            self.forces_with_pressures(time, velocity, state, assembler)?;
            return Ok(again);
        }
        // The slip of this increment counts from the next one on.
        let slipped = arrived.into_iter().zip(again).map(|(old, new)| Some(ConduitState { walls: new?.walls, ..old? }));
        Ok(slipped.collect())
    }

    fn trial<'a>(&'a self, time: f64, state: &'a State) -> Trial<'a> {
        Trial { settles: false, ..Trial::new(state, &self.step, time, time - state.time) }
    }
}
