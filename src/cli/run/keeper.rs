//! What happens between two increments: checkpoints, the end that a signal asks for, and whether the folder is still there.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::case::Opened;
use crate::cli::interrupt::Interrupt;
use crate::model::Model;
use crate::output::checkpoint::{self, Checkpoint, MeshPrint};
use crate::output::lock::Lock;
use crate::run::error::Error;
use crate::run::observer::Observer;
use crate::run::{RunBytes, SavedRun, Simulation};

/// How often the folder is looked for.
const LOOK: Duration = Duration::from_secs(1);

/// Keeps checkpoints.
pub(super) struct Keeper {
    folder: PathBuf,
    /// time between checkpoints; `None` for none
    pause: Option<Duration>,
    kept: Instant,
    looked: Instant,
    case: String,
    taken_over: usize,
    mesh: MeshPrint,
    /// why the last checkpoint could not be written, and when the first such was due
    pub concern: Option<String>,
}

impl Keeper {
    pub fn new(opened: &Opened, model: &Model, folder: &Path) -> Self {
        let minutes = opened.case.output.checkpoint.filter(|minutes| *minutes > 0.0);
        Self {
            folder: folder.to_owned(),
            pause: minutes.map(|minutes| Duration::try_from_secs_f64(60.0 * minutes).unwrap_or(Duration::MAX)),
            kept: Instant::now(),
            looked: Instant::now(),
            case: opened.document.to_string(),
            taken_over: opened.taken_over,
            mesh: MeshPrint::of(&model.mesh),
            concern: None,
        }
    }

    /// Before every attempt, and after the last one.
    pub fn look(
        &mut self,
        simulation: &Simulation,
        observers: &mut [&mut dyn Observer],
        interrupt: &Interrupt,
        lock: &Lock,
    ) -> Result<(), Error> {
        if self.looked.elapsed() >= LOOK {
            self.looked = Instant::now();
            if !lock.is_there() {
                let cause = "the folder, or the lock in it, was taken away while the run went on".into();
                return Err(Error::Output { path: self.folder.clone(), cause });
            }
        }
        let ends = interrupt.came() || simulation.is_complete();
        if self.pause.is_some_and(|pause| ends || self.kept.elapsed() >= pause) {
            self.keep(simulation, observers)?;
        }
        match interrupt.came() && !simulation.is_complete() {
            true => Err(Error::Interrupted),
            false => Ok(()),
        }
    }

    /// Write a checkpoint. A run that cannot keep one goes on all the same, and says so.
    fn keep(&mut self, simulation: &Simulation, observers: &mut [&mut dyn Observer]) -> Result<(), Error> {
        let saved = SavedRun::new(simulation, observers)?;
        let (begun, complete) = (saved.simulation().begun(), saved.simulation().is_complete());
        let written =
            saved.bytes().and_then(|run| checkpoint::write(&self.folder, &self.checkpoint(begun, complete, run)));
        if let Err(error) = written
            && self.concern.is_none()
        {
            let concern = format!("no checkpoint at t = {}: {error}; the run goes on", simulation.state().time);
            say!("warning: {concern}");
            self.concern = Some(concern);
        }
        self.kept = Instant::now();
        Ok(())
    }

    fn checkpoint(&self, begun: usize, complete: bool, run: RunBytes) -> Checkpoint {
        let Self { case, taken_over, mesh, .. } = self;
        let (case, program) = (case.clone(), env!("CARGO_PKG_VERSION").into());
        Checkpoint { program, case, taken_over: *taken_over, begun, complete, mesh: *mesh, run }
    }
}
