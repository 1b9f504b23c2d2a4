//! The run: step after step, increment after increment, with cut-back, and observers that see every attempt.

pub mod access;
mod attempt;
mod begin;
pub mod control;
pub mod error;
pub mod law;
pub mod law_path;
pub mod law_report;
pub mod observer;
pub mod report;
pub mod simulation;

use std::sync::Arc;
use std::time::Instant;

use crate::model::Model;
use crate::model::state::State;
use crate::run::error::Error;
use crate::run::observer::Observer;
use crate::run::report::RunReport;
pub use access::{Axis, Unknown};
pub use control::{Candidate, Increment};
pub use simulation::{Saved, Simulation};

/// Run all steps of a model. The report comes back from a stopped run as well.
///
/// # Errors
/// [`Error`] when an increment cannot be made small enough, or an observer cannot write.
pub fn run(model: &Arc<Model>, observers: &mut [&mut dyn Observer]) -> (RunReport, Result<State, Error>) {
    let mut simulation = Simulation::new(model.clone());
    let result = watch(&mut simulation, observers);
    (simulation.report(), result.map(|()| simulation.state().clone()))
}

/// Go on with a run to its end, and tell observers of every attempt.
///
/// # Errors
/// As [`run`].
pub fn watch(simulation: &mut Simulation, observers: &mut [&mut dyn Observer]) -> Result<(), Error> {
    let mut result = attempts(simulation, observers);
    let waiting = Instant::now();
    for observer in observers.iter_mut() {
        result = result.and(observer.finish());
    }
    simulation.observed(waiting.elapsed().as_secs_f64());
    result
}

/// A run and its observers as they were.
#[derive(Clone)]
pub struct SavedRun {
    simulation: Saved,
    observers: Vec<Vec<u8>>,
}

impl SavedRun {
    /// A run and its observers as they are.
    ///
    /// # Errors
    /// [`Error::Output`] when an observer cannot tell what it has written.
    pub fn new(simulation: &Simulation, observers: &mut [&mut dyn Observer]) -> Result<Self, Error> {
        let observers = observers.iter_mut().map(|observer| observer.save()).collect::<Result<_, _>>()?;
        Ok(Self { simulation: simulation.save(), observers })
    }

    /// The run as it was; the observers, the same in the same order, take back what they have written since.
    ///
    /// # Errors
    /// [`Error::Output`] when an observer cannot.
    pub fn resume(self, model: &Arc<Model>, observers: &mut [&mut dyn Observer]) -> Result<Simulation, Error> {
        observers.iter_mut().zip(&self.observers).try_for_each(|(observer, memory)| observer.restore(memory))?;
        Ok(Simulation::resume(model.clone(), self.simulation))
    }
}

fn attempts(simulation: &mut Simulation, observers: &mut [&mut dyn Observer]) -> Result<(), Error> {
    while let Some(candidate) = simulation.attempt()? {
        let clock = Instant::now();
        let told = simulation.told(&candidate);
        observers.iter_mut().try_for_each(|observer| observer.record(simulation.model(), &told))?;
        simulation.observed(clock.elapsed().as_secs_f64());
        simulation.follow(candidate)?;
    }
    Ok(())
}
