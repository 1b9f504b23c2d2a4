//! The run: step after step, increment after increment, with cut-back, and observers that see every attempt.

mod attempt;
pub mod error;
pub mod law;
pub mod observer;

cfg_if::cfg_if! {
    if #[cfg(feature = "internals")] {
        pub mod access;
        pub mod control;
        pub mod simulation;
    } else {
        pub(crate) mod access;
        pub(crate) mod control;
        pub(crate) mod simulation;
    }
}

use std::sync::Arc;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::model::{Model, State};
use crate::run::error::Error;
use crate::run::observer::Observer;
pub use access::{Axis, Unknown};
pub use control::{Candidate, Increment, RunReport, WallSeconds};
pub use simulation::{NotResumable, Pause, Saved, Simulation};

pub use crate::equations::ContactCounts;
pub use crate::solve::IterationRecord;
pub use crate::solve::newton::Iteration;

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
    watch_with(simulation, observers, &mut |_, _, _| Ok(()))
}

/// Moment between the attempts of a run at which a callback is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Moment {
    /// Before an attempt, or after the last one
    Between,
    /// After an attempt that stops the run, as before it: what is saved here makes that attempt again
    Stops,
}

/// Callback before every attempt, after the last one, and where one stops the run: it can save the run and its
/// observers, or end the run by an error.
pub type Between<'a> = dyn FnMut(&Simulation, &mut [&mut dyn Observer], Moment) -> Result<(), Error> + 'a;

/// As [`watch`], with a callback between the attempts.
///
/// # Errors
/// As [`run`], and those of what is done.
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

/// Memory of each observer, by its name.
type Memories = Vec<(String, Vec<u8>)>;

/// A run and its observers as they were.
#[derive(Clone)]
#[must_use]
pub struct SavedRun {
    simulation: Saved,
    observers: Memories,
}

/// A saved run for a file, before its model is at hand.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RunBytes {
    simulation: Vec<u8>,
    observers: Memories,
}

impl SavedRun {
    /// A run and its observers as they are.
    ///
    /// # Errors
    /// [`Error::Output`] when an observer cannot tell what it has written.
    pub fn new(simulation: &Simulation, observers: &mut [&mut dyn Observer]) -> Result<Self, Error> {
        let memory = |observer: &mut &mut dyn Observer| observer.save().map(|memory| (observer.name().into(), memory));
        let observers = observers.iter_mut().map(memory).collect::<Result<_, _>>()?;
        Ok(Self { simulation: simulation.save(), observers })
    }

    /// The saved run in bytes, for a file.
    ///
    /// # Errors
    /// As [`Saved::bytes`].
    pub fn bytes(self) -> Result<RunBytes, Error> {
        Ok(RunBytes { simulation: self.simulation.bytes()?, observers: self.observers })
    }

    /// A saved run from the bytes of a file.
    ///
    /// # Errors
    /// [`NotResumable`].
    pub fn from_bytes(bytes: RunBytes, model: &Arc<Model>) -> Result<Self, NotResumable> {
        Ok(Self { simulation: Saved::from_bytes(&bytes.simulation, model)?, observers: bytes.observers })
    }

    /// The run without its observers.
    pub fn simulation(&self) -> &Saved {
        &self.simulation
    }

    /// The place it has come to, for another run with its own observers to begin from: [`Saved::begin`].
    pub fn begin(self) -> Self {
        Self { simulation: self.simulation.begin(), observers: Vec::new() }
    }

    /// Whether observers, found by their names, can go on from what was saved: [`Observer::check`].
    ///
    /// # Errors
    /// [`Error::Output`] with the first thing that is not as it was.
    pub fn check(&self, observers: &[&mut dyn Observer]) -> Result<(), Error> {
        observers
            .iter()
            .try_for_each(|observer| self.memory(observer.name()).map_or(Ok(()), |memory| observer.check(memory)))
    }

    fn memory(&self, observer: &str) -> Option<&[u8]> {
        self.observers.iter().find(|(name, _)| name == observer).map(|(_, memory)| &**memory)
    }

    /// Whether an observer of this name has something to go on from.
    pub fn remembers(&self, observer: &str) -> bool {
        self.memory(observer).is_some()
    }

    /// The run as it was; the observers, found by their names, take back what they have written since. One that was not there
    /// begins here.
    ///
    /// # Errors
    /// [`Error::Output`] when an observer cannot.
    pub fn resume(self, model: &Arc<Model>, observers: &mut [&mut dyn Observer]) -> Result<Simulation, Error> {
        for observer in observers.iter_mut() {
            if let Some(memory) = self.memory(observer.name()) {
                observer.restore(memory)?;
            }
        }
        Ok(Simulation::resume(model.clone(), self.simulation))
    }
}
