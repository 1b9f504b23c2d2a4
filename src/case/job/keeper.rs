//! Tasks between two increments: checkpoints, ends requested by signals, and a check that the folder still exists.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::{Ends, Warn};
use crate::case::again::Opened;
use crate::model::Model;
use crate::output::checkpoint::{self, Checkpoint, MeshPrint};
use crate::output::files::Lock;
use crate::run::{Error, Moment, Observer, Pause, RunBytes, SavedRun, Simulation};

/// Interval at which the existence of the folder is checked.
const LOOK: Duration = Duration::from_secs(1);

/// Time of the next checkpoint; explicit increments pause for it.
#[derive(Clone)]
struct Due {
    /// time between checkpoints; `None` for none
    pause: Option<Duration>,
    kept: Arc<Mutex<Instant>>,
}

impl Due {
    fn is_now(&self) -> bool {
        let kept = || self.kept.lock().unwrap_or_else(PoisonError::into_inner).elapsed();
        self.pause.is_some_and(|pause| kept() >= pause)
    }

    fn restart(&self) {
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }
}

/// Writes the checkpoints of a run.
pub(super) struct Keeper {
    folder: PathBuf,
    due: Due,
    ends: Ends,
    warn: Warn,
    looked: Instant,
    case: String,
    taken_over: usize,
    mesh: MeshPrint,
    /// reason why the last checkpoint could not be written, and the time of the first such failure
    pub concern: Option<String>,
}

impl Keeper {
    pub fn new(opened: &Opened, model: &Model, folder: &Path, warn: Warn, ends: Ends) -> Self {
        let minutes = opened.case.output.checkpoint.filter(|minutes| *minutes > 0.0);
        let pause = minutes.map(|minutes| Duration::try_from_secs_f64(60.0 * minutes).unwrap_or(Duration::MAX));
        Self {
            folder: folder.to_owned(),
            due: Due { pause, kept: Arc::new(Mutex::new(Instant::now())) },
            ends,
            warn,
            looked: Instant::now(),
            case: opened.document.to_string(),
            taken_over: opened.taken_over,
            mesh: MeshPrint::of(&model.mesh),
            concern: None,
        }
    }

    /// Returns the condition under which explicit increments pause: a checkpoint is due, or the end was requested.
    pub fn pause(&self) -> Pause {
        let (ends, due) = (self.ends.clone(), self.due.clone());
        Arc::new(move || ends().is_some() || due.is_now())
    }

    /// Called before every attempt, after the last one, and at one that stops the run.
    pub fn look(
        &mut self,
        simulation: &Simulation,
        observers: &mut [&mut dyn Observer],
        moment: Moment,
        lock: &Lock,
    ) -> Result<(), Error> {
        if self.looked.elapsed() >= LOOK {
            self.looked = Instant::now();
            if !lock.is_there() {
                let cause = "the folder, or the lock in it, was removed during the run".into();
                return Err(Error::Output { path: self.folder.clone(), cause });
            }
        }
        let ended = (self.ends)().filter(|_| !simulation.is_complete());
        let ends = ended.is_some() || simulation.is_complete() || moment == Moment::Stops;
        if self.due.pause.is_some() && (ends || self.due.is_now()) {
            self.keep(simulation, observers)?;
        }
        match ended {
            Some(ended) if moment == Moment::Between => Err(ended),
            _ => Ok(()),
        }
    }

    /// Writes a checkpoint. If that fails, the run continues with a warning.
    fn keep(&mut self, simulation: &Simulation, observers: &mut [&mut dyn Observer]) -> Result<(), Error> {
        let saved = SavedRun::new(simulation, observers)?;
        let (begun, complete) = (saved.simulation().begun(), saved.simulation().is_complete());
        let written =
            saved.bytes().and_then(|run| checkpoint::write(&self.folder, &self.checkpoint(begun, complete, run)));
        if let Err(error) = written
            && self.concern.is_none()
        {
            let concern = format!("no checkpoint at t = {}: {error}; the run continues", simulation.state().time);
            (self.warn)(&concern);
            self.concern = Some(concern);
        }
        self.due.restart();
        Ok(())
    }

    fn checkpoint(&self, begun: usize, complete: bool, run: RunBytes) -> Checkpoint {
        let Self { case, taken_over, mesh, .. } = self;
        let (case, program) = (case.clone(), env!("CARGO_PKG_VERSION").into());
        Checkpoint { program, case, taken_over: *taken_over, begun, complete, mesh: *mesh, run }
    }
}
