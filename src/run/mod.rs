//! Runs: steps, increments, cut-back, and observers of every attempt.

mod access;
mod attempt;
pub mod error;
pub mod law;
pub mod observer;

cfg_if::cfg_if! {
    if #[cfg(feature = "internals")] {
        pub mod control;
        pub mod simulation;
    } else {
        pub(crate) mod control;
        pub(crate) mod simulation;
    }
}

use std::sync::Arc;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::model::{Model, State};
pub use access::{Axis, Unknown};
pub use control::{Candidate, Increment, RunReport, WallSeconds};
pub use error::Error;
pub use observer::{Attempt, Observer, Row};
pub use simulation::{NotResumable, Pause, Saved, Simulation};

pub use crate::equations::ContactCounts;
pub use crate::solve::IterationRecord;
pub use crate::solve::newton::Iteration;

/// Runs all steps of a model. The report is returned for a stopped run as well.
///
/// # Errors
/// Returns [`Error`] if no increment is short enough to be solved or an observer cannot write.
pub fn run(model: &Arc<Model>, observers: &mut [&mut dyn Observer]) -> (RunReport, Result<State, Error>) {
    let mut simulation = Simulation::new(model.clone());
    let result = watch(&mut simulation, observers);
    (simulation.report(), result.map(|()| simulation.state().clone()))
}

/// Continues a run to its end and passes every attempt to the observers.
///
/// # Errors
/// The same as for [`run`].
pub fn watch(simulation: &mut Simulation, observers: &mut [&mut dyn Observer]) -> Result<(), Error> {
    watch_with(simulation, observers, &mut |_, _, _| Ok(()))
}

/// Moment between two attempts at which a callback is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Moment {
    /// Before an attempt, or after the last one
    Between,
    /// After an attempt that stops the run, in the state before it; a run saved here repeats that attempt
    Stops,
}

/// Callback before every attempt, after the last one, and at an attempt that stops the run. It can save the run and its
/// observers, or end the run by returning an error.
pub type Between<'a> = dyn FnMut(&Simulation, &mut [&mut dyn Observer], Moment) -> Result<(), Error> + 'a;

/// Continues a run as [`watch`], with a callback between the attempts.
///
/// # Errors
/// The same as for [`run`], and the errors of the callback.
pub fn watch_with(
    simulation: &mut Simulation,
    observers: &mut [&mut dyn Observer],
    between: &mut Between,
) -> Result<(), Error> {
    let mut result = attempts(simulation, observers, between);
    let waiting = Instant::now();
    for observer in observers.iter_mut() {
        result = result.and(observer.finish());
    }
    simulation.observed(waiting.elapsed().as_secs_f64());
    result
}

fn attempts(
    simulation: &mut Simulation,
    observers: &mut [&mut dyn Observer],
    between: &mut Between,
) -> Result<(), Error> {
    loop {
        let clock = Instant::now();
        between(simulation, observers, Moment::Between)?;
        simulation.observed(clock.elapsed().as_secs_f64());
        let candidate = match simulation.try_increment() {
            Ok(Some(candidate)) => candidate,
            Ok(None) => return Ok(()),
            Err(error) => {
                between(simulation, observers, Moment::Stops)?;
                return Err(error);
            }
        };
        let clock = Instant::now();
        if candidate.is_paused() {
            simulation.apply(candidate)?;
            continue;
        }
        if candidate.stops() {
            between(simulation, observers, Moment::Stops)?;
        }
        let attempt = simulation.attempt_of(&candidate);
        observers.iter_mut().try_for_each(|observer| observer.record(simulation.model(), &attempt))?;
        simulation.observed(clock.elapsed().as_secs_f64());
        simulation.apply(candidate)?;
    }
}

/// Saved memory of each observer, by its name.
type Memories = Vec<(String, Vec<u8>)>;

/// Saved run with its observers.
#[derive(Clone)]
#[must_use]
pub struct SavedRun {
    simulation: Saved,
    observers: Memories,
}

/// Saved run read from a file, before it is combined with its model.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RunBytes {
    simulation: Vec<u8>,
    observers: Memories,
}

impl SavedRun {
    /// Saves a run and its observers.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if an observer cannot save its memory.
    pub fn new(simulation: &Simulation, observers: &mut [&mut dyn Observer]) -> Result<Self, Error> {
        let memory = |observer: &mut &mut dyn Observer| observer.save().map(|memory| (observer.name().into(), memory));
        let observers = observers.iter_mut().map(memory).collect::<Result<_, _>>()?;
        Ok(Self { simulation: simulation.save(), observers })
    }

    /// Returns the saved run in bytes, for a file.
    ///
    /// # Errors
    /// The same as for [`Saved::bytes`].
    pub fn bytes(self) -> Result<RunBytes, Error> {
        Ok(RunBytes { simulation: self.simulation.bytes()?, observers: self.observers })
    }

    /// Restores a saved run from the bytes of a file.
    ///
    /// # Errors
    /// Returns [`NotResumable`] if the bytes are unreadable or belong to another model.
    pub fn from_bytes(bytes: RunBytes, model: &Arc<Model>) -> Result<Self, NotResumable> {
        Ok(Self { simulation: Saved::from_bytes(&bytes.simulation, model)?, observers: bytes.observers })
    }

    /// The saved run without its observers.
    pub fn simulation(&self) -> &Saved {
        &self.simulation
    }

    /// Returns its state as the start of another run with its own observers; see [`Saved::begin`].
    pub fn begin(self) -> Self {
        Self { simulation: self.simulation.begin(), observers: Vec::new() }
    }

    /// Checks whether the observers, matched by name, can resume from the saved run; see [`Observer::check`].
    ///
    /// # Errors
    /// Returns [`Error::Output`] with the first mismatch.
    pub fn check(&self, observers: &[&mut dyn Observer]) -> Result<(), Error> {
        observers
            .iter()
            .try_for_each(|observer| self.memory(observer.name()).map_or(Ok(()), |memory| observer.check(memory)))
    }

    fn memory(&self, observer: &str) -> Option<&[u8]> {
        self.observers.iter().find(|(name, _)| name == observer).map(|(_, memory)| &**memory)
    }

    /// Resumes a single observer, if it was saved.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if it cannot resume.
    pub(crate) fn restore(&self, observer: &mut dyn Observer) -> Result<(), Error> {
        self.memory(observer.name()).map_or(Ok(()), |memory| observer.restore(memory))
    }

    /// Whether memory is saved for an observer of this name.
    pub fn remembers(&self, observer: &str) -> bool {
        self.memory(observer).is_some()
    }

    /// Resumes the run. The observers, matched by name, remove their later output; an observer that was not saved starts
    /// here.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if an observer cannot resume.
    pub fn resume(self, model: &Arc<Model>, observers: &mut [&mut dyn Observer]) -> Result<Simulation, Error> {
        observers.iter_mut().try_for_each(|observer| self.restore(*observer))?;
        Ok(Simulation::resume(model.clone(), self.simulation))
    }
}
