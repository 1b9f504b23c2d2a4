//! Water that flows along contacts in explicit increments: beside the motion, at the displacements that are known before the forces.
//!
//! The pressure at the end of an increment follows from the surfaces there, as the force of a spring 1/S per area does, by which the stable
//! increment is bounded ([`crate::contact::pair::ContactPair::stiffest`]). A transmissivity that goes with slip or pressure is that of the
//! increment before.

use super::Explicit;
use crate::contact::conduit::{Conduit, ConduitState, Course, Wall};
use crate::contact::force::ContactState;
use crate::equations::{Assembler, Trial};
use crate::model::Model;
use crate::model::state::State;
use crate::solve::failure::IncrementFailure;

impl Explicit {
    /// Evaluates the forces at the predicted displacements, with the water at the end of the increment, which is returned.
    pub(super) fn forces_in_water(
        &self,
        time: f64,
        velocity: Option<&[f64]>,
        state: &mut State,
        assembler: &mut Assembler,
    ) -> Result<Vec<Option<ConduitState>>, IncrementFailure> {
        let model = &*self.model;
        let flows = model.contacts.iter().any(|pair| pair.conduit.is_some());
        let mut arrived = Vec::new();
        if flows {
            arrived = self.flow(time, state, |k, _| state.conduits[k].walls.clone())?;
            press(model, &arrived, state);
        }
        self.forces(time, velocity, state, assembler)?;
        if !flows {
            return Ok(arrived);
        }
        let found = std::mem::take(&mut assembler.evaluation.contacts);
        let again = self.flow(time, state, |k, conduit| conduit.walls(&found[k]))?;
        assembler.evaluation.contacts = found;
        let separation = |(old, new): (&Wall, &Wall)| old.opening != new.opening;
        let opens = arrived.iter().zip(&again).any(|(old, new)| match (old, new) {
            (Some(old), Some(new)) => old.walls.iter().zip(&new.walls).any(separation),
            _ => false,
        });
        if opens {
            press(model, &again, state);
            self.forces(time, velocity, state, assembler)?;
            return Ok(again);
        }
        // The slip of this increment counts from the next one on.
        let slipped = arrived.into_iter().zip(again).map(|(old, new)| Some(ConduitState { walls: new?.walls, ..old? }));
        Ok(slipped.collect())
    }

    /// Evaluates the forces at the predicted displacements.
    fn forces(
        &self,
        time: f64,
        velocity: Option<&[f64]>,
        state: &State,
        assembler: &mut Assembler,
    ) -> Result<(), IncrementFailure> {
        let trial = Trial { settles: false, ..Trial::new(state, &self.step, time, time - state.time) };
        assembler.forces(trial, &self.displacement, velocity).map_err(IncrementFailure::Start)
    }

    /// Water at the end of an increment in which the surfaces come to be what is told of each contact.
    fn flow(
        &self,
        time: f64,
        state: &State,
        walls: impl Fn(usize, &Conduit) -> Vec<Wall>,
    ) -> Result<Vec<Option<ConduitState>>, IncrementFailure> {
        let one = |(k, pair): (usize, &crate::contact::pair::ContactPair)| {
            let Some(conduit) = pair.conduit.as_ref().filter(|_| self.step.joins(pair)) else { return Ok(None) };
            let (old, walls) = (&state.conduits[k], walls(k, conduit));
            let course = Course {
                span: [state.time, time],
                walls: [&old.walls, &walls],
                rates: None,
                gives_way: [&[], &[]],
                steps: None,
            };
            let failed = |why: String| IncrementFailure::Water { contact: pair.name.clone(), why };
            let reached = conduit.march(&old.pressure, &course);
            let reached =
                reached.map_err(|fast| failed(format!("its pressure has no value from t = {:e} on", fast.time)))?;
            if let Some((_, pressure)) = conduit.bad(&reached.pressure, pair.modulus) {
                return Err(failed(format!(
                    "its pressure would be {pressure:e}: the surfaces open faster than water flows in; raise the \
                    initial pressure of the ground water (`initial`)"
                )));
            }
            let volume = conduit.gained([&old.pressure, &reached.pressure], [&old.walls, &walls]);
            let rate = 1.0 / (time - state.time);
            Ok(Some(ConduitState {
                rates: walls.iter().zip(&old.walls).map(|(new, old)| new.combined(rate, *old, -rate)).collect(),
                amounts: old.amounts.combined(1.0, reached.amounts, 1.0),
                mass_error: old.mass_error + volume - reached.amounts.injected + reached.amounts.leaked,
                uncertainty: 0.0,
                pressure: reached.pressure,
                walls,
            }))
        };
        self.model.contacts.iter().enumerate().map(one).collect()
    }
}

/// Gives the contacts the pressures at the end of the increment.
fn press(model: &Model, arrived: &[Option<ConduitState>], state: &mut State) {
    for ((pair, water), states) in model.contacts.iter().zip(arrived).zip(&mut state.contacts) {
        let (Some(conduit), Some(water)) = (&pair.conduit, water) else { continue };
        let points = conduit.points(&water.pressure, &water.walls);
        states.iter_mut().zip(points).for_each(|(state, water): (&mut ContactState, _)| state.water = Some(water));
    }
}
