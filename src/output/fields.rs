//! `solid.pvd`, `contact.pvd`, `bars.pvd` and `points.pvd`: frames for ParaView, one VTU file per frame. A frame is listed shortly after it
//! is complete, and removed from the list before it is deleted: the list is valid at any moment of a run.
//!
//! Disk space is checked before a frame is written.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::csv::failed;
use super::frames::{Shown, bars_frame, contact_frame, points_frame, solid_frame};
use super::gradients::Motions;
use super::recovery::NodalRecovery;
use super::vtu::Grid;
use super::{csv, files, named};
use crate::linear::memory::room_for;
use crate::model::boundary::Span;
use crate::model::{Model, State};
use crate::run::{Attempt, Error, Observer, Row};

/// Writes frames of the solids and of the interfaces, in the background while the run continues.
#[derive(Debug)]
pub struct Fields {
    folder: PathBuf,
    room: Room,
    /// Names of the series
    names: Vec<&'static str>,
    frames_of: Frames,
    /// Derivatives of displacements that frames show
    motions: Motions,
    /// Number of rows so far
    rows: usize,
    /// Times of the frames so far [T]
    times: Vec<f64>,
    /// Tasks for the writer; `None` when there are no more
    frames: Option<SyncSender<Task>>,
    /// `None` when the writer has ended
    writer: Option<JoinHandle<Result<(), Error>>>,
}

/// Selection and format of the frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    /// Selection of the states with frames
    pub of: Selection,
    /// Whether frames of the integration points are written
    pub points: bool,
    /// Whether values are written in double precision
    pub exact: bool,
    /// Whether what follows from stress and strain is written, too
    pub derived: bool,
}

/// States with frames, in addition to the first, those at times named by the model, and the last of each step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selection {
    /// Every n-th row of the history
    Rows(usize),
    /// This many per step: the first row of the history at or after the end of each equal part of its duration
    Parts(usize),
    /// No others
    Named,
}

/// Task for the thread that writes frames.
enum Task {
    /// Write this state
    Show(Box<Shown>),
    /// Remove all frames except those at these times
    Keep(Vec<f64>),
    /// Reply when all frames are written
    Tell(SyncSender<()>),
}

/// Relative round-off allowed in comparing times.
const ROUND_OFF: f64 = 1e-9;

/// Number of frames that may wait for the writer; a faster run waits, so that memory stays bounded.
const WAITING: usize = 1;

/// Longest delay before a frame is listed; a list is rewritten as a whole.
const UNLISTED: Duration = Duration::from_millis(200);

/// A time series of VTU files and the `.pvd` that lists them.
#[derive(Debug)]
struct Collection {
    folder: PathBuf,
    name: &'static str,
    times: Vec<f64>,
    /// Number of frames listed in the index, and the time of that listing
    listed: (usize, Option<Instant>),
    grid: Grid,
    /// Recovery of the solids, made for the first frame
    recovery: Option<NodalRecovery>,
    /// Whether what follows from stress and strain is written, too
    derived: bool,
}

impl Fields {
    /// Starts the series in `folder`, with the initial state as the first frame; `units` has the known labels of units.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if a file cannot be written.
    pub fn create(
        folder: &Path,
        model: Arc<Model>,
        start: &State,
        frames: Frames,
        motions: Motions,
        units: &BTreeMap<String, String>,
    ) -> Result<Self, Error> {
        let mut fields = Self::reopen(folder, model.clone(), frames, motions, units)?;
        fields.write(&model, start)?;
        Ok(fields)
    }

    /// Opens the existing series, to be restored.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if the disk space is insufficient.
    pub fn reopen(
        folder: &Path,
        model: Arc<Model>,
        frames: Frames,
        motions: Motions,
        units: &BTreeMap<String, String>,
    ) -> Result<Self, Error> {
        let (frames_of, rows) = (frames, 0);
        let names = [
            ("solid", true),
            ("contact", !model.contacts.is_empty()),
            ("bars", !model.bars.is_empty()),
            ("points", frames_of.points),
        ];
        let names: Vec<&str> = names.into_iter().filter(|(_, asked)| *asked).map(|(name, _)| name).collect();
        let collection = |name: &&'static str| Collection::create(folder, name, frames_of, units);
        let collections = names.iter().map(collection).collect::<Result<_, _>>()?;
        let (frames, arriving): (_, Receiver<Task>) = sync_channel(WAITING);
        let room = Room::of(folder, &model, motions.borrow().len());
        let writer = std::thread::Builder::new().name("frames".into());
        let writer = writer.spawn(move || {
            // The writer computes on one thread of its own: the threads of the run may be waiting for it.
            let alone = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
            alone
                .map_err(|cause| failed(Path::new("frames"), &cause))
                .and_then(|_alone| written(&model, collections, arriving))
        });
        let writer = writer.map_err(|cause| failed(&folder.join("solid"), &cause))?;
        let (folder, times) = (folder.to_owned(), Vec::new());
        Ok(Self { folder, room, names, frames_of, motions, rows, times, frames: Some(frames), writer: Some(writer) })
    }

    /// Sends a state to the writer. A writer that has ended has failed and returns its error.
    fn write(&mut self, model: &Model, state: &State) -> Result<(), Error> {
        self.room.check()?;
        self.times.push(state.time);
        let motions = self.motions.borrow().clone();
        self.ask(Task::Show(Box::new(Shown::new(model, state, motions))))
    }

    /// Whether no frame has been written since the end of the last completed equal part of a step.
    fn is_in_a_new_part(&self, span: Span, parts: usize, time: f64) -> bool {
        let ended =
            |time: f64| (parts as f64 * (time - span.start) / (span.end - span.start) * (1.0 + ROUND_OFF)).floor();
        let last = self.times.last().copied().unwrap_or(span.start);
        ended(time) > ended(last.max(span.start))
    }

    fn ask(&mut self, task: Task) -> Result<(), Error> {
        let taken = self.frames.as_ref().is_some_and(|frames| frames.send(task).is_ok());
        if taken { Ok(()) } else { self.finish() }
    }

    /// Waits until all frames are written.
    fn settle(&mut self) -> Result<(), Error> {
        let (done, all_written) = sync_channel(1);
        self.ask(Task::Tell(done))?;
        // A writer that has ended returns its error.
        all_written.recv().or_else(|_| self.finish())
    }
}

/// Loop of the writer; complete frames are listed even if it fails.
fn written(model: &Model, mut collections: Vec<Collection>, tasks: Receiver<Task>) -> Result<(), Error> {
    let done = followed(model, &mut collections, tasks);
    done.and(listed(&mut collections))
}

/// Carries out the tasks until there are no more.
fn followed(model: &Model, collections: &mut [Collection], tasks: Receiver<Task>) -> Result<(), Error> {
    loop {
        match tasks.recv_timeout(UNLISTED) {
            Ok(Task::Show(shown)) => {
                collections.iter_mut().try_for_each(|collection| collection.show(model, &shown))?
            }
            Ok(Task::Keep(times)) => collections.iter_mut().try_for_each(|collection| collection.keep(&times))?,
            Ok(Task::Tell(done)) => {
                listed(collections)?;
                // The receiver may have been dropped.
                let _ = done.send(());
            }
            Err(RecvTimeoutError::Timeout) => listed(collections)?,
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
    }
}

fn listed(collections: &mut [Collection]) -> Result<(), Error> {
    collections.iter_mut().try_for_each(Collection::list)
}

impl Observer for Fields {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        let is_row = attempt.row != Row::Pending;
        self.rows += usize::from(is_row);
        let is_due = match self.frames_of.of {
            Selection::Rows(every) => self.rows.is_multiple_of(every),
            Selection::Parts(parts) => self.is_in_a_new_part(attempt.step.span, parts, state.time),
            Selection::Named => false,
        };
        match is_due && is_row || attempt.ends_step(state) || model.requests.is_time(state.time) {
            true => self.write(model, state),
            false => Ok(()),
        }
    }

    fn name(&self) -> &'static str {
        "fields"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        self.settle()?;
        csv::remembered(&(self.rows, &self.times))
    }

    fn check(&self, memory: &[u8]) -> Result<(), Error> {
        let (_, times) = csv::recalled::<(usize, Vec<f64>)>(memory)?;
        let frames =
            self.names.iter().flat_map(|name| (0..times.len()).map(|number| self.folder.join(file(name, number))));
        match frames.into_iter().find(|path| !path.is_file()) {
            None => Ok(()),
            Some(path) => Err(failed(&path, &"existed when the checkpoint was written, and is missing")),
        }
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        (self.rows, self.times) = csv::recalled::<(usize, Vec<f64>)>(memory)?;
        self.ask(Task::Keep(self.times.clone()))?;
        self.settle()
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.frames = None;
        match self.writer.take().map(JoinHandle::join) {
            None => Ok(()),
            Some(Ok(written)) => written,
            Some(Err(defect)) => std::panic::resume_unwind(defect),
        }
    }
}

/// Path of a frame of a series in the folder of results.
fn file(series: &str, number: usize) -> String {
    format!("{series}/{number:05}.vtu")
}

impl Collection {
    fn create(
        folder: &Path,
        name: &'static str,
        asked: Frames,
        units: &BTreeMap<String, String>,
    ) -> Result<Self, Error> {
        let frames = folder.join(name);
        files::folder(&frames).map_err(|cause| failed(&frames, &cause))?;
        let (folder, grid) = (folder.to_owned(), Grid::new(asked.exact, named::of_frames(name, units)));
        let (times, recovery, derived) = (Vec::new(), None, asked.derived);
        Ok(Self { folder, name, times, listed: (0, None), grid, recovery, derived })
    }

    fn file(&self, number: usize) -> String {
        file(self.name, number)
    }

    /// Writes one frame and lists it, so that the results of a running or killed run can be viewed.
    fn show(&mut self, model: &Model, shown: &Shown) -> Result<(), Error> {
        let path = self.folder.join(self.file(self.times.len()));
        match self.name {
            "solid" => {
                let recovery = self.recovery.get_or_insert_with(|| NodalRecovery::new(model));
                solid_frame(model, shown, recovery, self.derived, &mut self.grid);
            }
            "bars" => bars_frame(model, shown, &mut self.grid),
            "points" => points_frame(model, shown, self.derived, &mut self.grid),
            _ => contact_frame(model, shown, &mut self.grid),
        }
        let written = self.grid.write(&path);
        if written.is_err() {
            // An incomplete frame is deleted.
            let _ = files::remove(&path);
        }
        written.map_err(|cause| failed(&path, &cause))?;
        self.times.push(shown.state.time);
        let is_early = self.listed.1.is_some_and(|last| last.elapsed() < UNLISTED);
        if is_early { Ok(()) } else { self.list() }
    }

    /// Keeps the frames of these times and removes later ones.
    fn keep(&mut self, times: &[f64]) -> Result<(), Error> {
        times.clone_into(&mut self.times);
        // Removed frames are first deleted from the list.
        self.listed.0 = usize::MAX;
        self.list()?;
        for number in times.len().. {
            let path = self.folder.join(self.file(number));
            if path.symlink_metadata().is_err() {
                break;
            }
            files::remove(&path).map_err(|cause| failed(&path, &cause))?;
        }
        Ok(())
    }

    /// Lists the frames, unless all are listed.
    fn list(&mut self) -> Result<(), Error> {
        if self.listed.0 == self.times.len() {
            return Ok(());
        }
        let mut text =
            String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
        for (number, time) in self.times.iter().enumerate() {
            text += &format!("<DataSet timestep=\"{time}\" part=\"0\" file=\"{}\"/>\n", self.file(number));
        }
        text += "</Collection>\n</VTKFile>\n";
        let path = self.folder.join(format!("{}.pvd", self.name));
        self.listed = (self.times.len(), Some(Instant::now()));
        files::replace(&path, text.as_bytes()).map_err(|cause| failed(&path, &cause))
    }
}

/// Bytes per node or contact point in a frame: the state, fourteen numbers, and their text.
const PER_NODE: usize = 600;

/// Bytes per node of a derivative of displacements in a frame: three numbers, and their text.
const PER_DERIVATIVE: usize = 80;

/// Memory and disk space needed by a frame.
#[derive(Debug)]
struct Room {
    folder: PathBuf,
    bytes: usize,
}

impl Room {
    /// Disk space needed by a model's frames in a folder, with so many derivatives of displacements.
    pub fn of(folder: &Path, model: &Model, derivatives: usize) -> Self {
        let points: usize = model.contacts.iter().map(|pair| pair.points.len()).sum();
        let nodes = model.mesh.nodes.len();
        let bytes = PER_NODE * (nodes + points) + PER_DERIVATIVE * derivatives * nodes;
        Self { folder: folder.join("solid"), bytes }
    }

    /// Checks that a frame fits.
    ///
    /// # Errors
    /// Returns [`Error::Output`] with the needed and the free space if it does not.
    pub fn check(&self) -> Result<(), Error> {
        let message =
            |cause| failed(&self.folder, &format!("a frame takes {cause}; leave them out (\"fields\": false)"));
        room_for(self.bytes, 0).map_err(message)
    }
}
