//! `solid.pvd` and `contact.pvd`: what ParaView shows, one VTU file a frame.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use super::csv::failed;
use super::files;
use super::memory;
use super::vtu::{CellType, Grid};
use crate::contact::fields;
use crate::contact::force::ContactState;
use crate::contact::pair::ContactPair;
use crate::contact::surface::SlavePoint;
use crate::laws::bulk::CauchyStress;
use crate::mesh::configuration::Configuration;
use crate::model::Model;
use crate::model::state::State;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};
use nalgebra::Vector2;

/// Writes frames of the solids and of the interfaces, in the background while the run goes on.
#[derive(Debug)]
pub struct Fields {
    every: usize,
    /// Rows of the history so far
    rows: usize,
    /// Times of the frames so far [T]
    times: Vec<f64>,
    /// What the writer is to do; `None` when there is no more
    frames: Option<SyncSender<Task>>,
    /// `None` when it has ended
    writer: Option<JoinHandle<Result<(), Error>>>,
}

/// What the writer of frames is asked for.
enum Task {
    /// Write this state
    Show(Box<State>),
    /// Take back all frames but those of these times
    Keep(Vec<f64>),
    /// Say when all is written
    Tell(SyncSender<()>),
}

/// Frames that may wait for the writer; a run that is faster waits, so that memory stays bounded.
const WAITING: usize = 1;

/// A time series of VTU files and the `.pvd` that lists them.
#[derive(Debug)]
struct Collection {
    folder: PathBuf,
    name: &'static str,
    times: Vec<f64>,
}

impl Fields {
    /// Start the series in `folder`, with the state at rest as the first frame; then that of every n-th row of
    /// the history and the last of each step are written.
    ///
    /// # Errors
    /// [`Error::Output`] when a file cannot be written.
    pub fn create(folder: &Path, model: Arc<Model>, start: &State, every: usize) -> Result<Self, Error> {
        let mut fields = Self::reopen(folder, model, every)?;
        fields.write(start)?;
        Ok(fields)
    }

    /// The series that is there, to be restored.
    ///
    /// # Errors
    /// [`Error::Output`] when there is no place for it.
    pub fn reopen(folder: &Path, model: Arc<Model>, every: usize) -> Result<Self, Error> {
        let names = if model.contacts.is_empty() { &["solid"][..] } else { &["solid", "contact"] };
        let collections = names.iter().map(|name| Collection::create(folder, name)).collect::<Result<_, _>>()?;
        let (frames, arriving): (_, Receiver<Task>) = sync_channel(WAITING);
        let writer = std::thread::Builder::new().name("frames".into());
        let writer = writer.spawn(move || written(&model, collections, arriving));
        let writer = writer.map_err(|cause| failed(&folder.join("solid"), &cause))?;
        Ok(Self { every, rows: 0, times: Vec::new(), frames: Some(frames), writer: Some(writer) })
    }

    /// Hand a state to the writer. One that has ended has failed, and says why.
    fn write(&mut self, state: &State) -> Result<(), Error> {
        self.times.push(state.time);
        self.ask(Task::Show(Box::new(state.clone())))
    }

    fn ask(&mut self, task: Task) -> Result<(), Error> {
        let taken = self.frames.as_ref().is_some_and(|frames| frames.send(task).is_ok());
        if taken { Ok(()) } else { self.finish() }
    }

    /// Wait until all is written.
    fn settle(&mut self) -> Result<(), Error> {
        let (done, all_written) = sync_channel(1);
        self.ask(Task::Tell(done))?;
        // A writer that has ended says why.
        all_written.recv().or_else(|_| self.finish())
    }
}

/// What the writer does.
fn written(model: &Model, mut collections: Vec<Collection>, tasks: Receiver<Task>) -> Result<(), Error> {
    let mut grid = Grid::default();
    for task in tasks {
        match task {
            Task::Show(state) => {
                for collection in &mut collections {
                    match collection.name {
                        "solid" => solid_frame(model, &state, &mut grid),
                        _ => contact_frame(model, &state, &mut grid),
                    }
                    collection.write(state.time, &grid)?;
                }
            }
            Task::Keep(times) => collections.iter_mut().try_for_each(|collection| collection.keep(&times))?,
            // Whoever has asked may have gone.
            Task::Tell(done) => drop(done.send(())),
        }
    }
    Ok(())
}

impl Observer for Fields {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        self.rows += 1;
        if self.rows.is_multiple_of(self.every) || state.time >= attempt.step.span.end {
            self.write(state)
        } else {
            Ok(())
        }
    }

    fn name(&self) -> &'static str {
        "fields"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        self.settle()?;
        memory::written(&(self.rows, &self.times))
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        (self.rows, self.times) = memory::read(memory)?;
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

impl Collection {
    fn create(folder: &Path, name: &'static str) -> Result<Self, Error> {
        let frames = folder.join(name);
        files::folder(&frames).map_err(|cause| failed(&frames, &cause))?;
        Ok(Self { folder: folder.to_owned(), name, times: Vec::new() })
    }

    fn file(&self, number: usize) -> String {
        format!("{}/{number:05}.vtu", self.name)
    }

    /// Write one frame and list it, so that a running or killed run can be looked at.
    fn write(&mut self, time: f64, grid: &Grid) -> Result<(), Error> {
        let path = self.folder.join(self.file(self.times.len()));
        let written = grid.write(&path);
        if written.is_err() {
            // Half a frame is of no use.
            let _ = files::remove(&path);
        }
        written.map_err(|cause| failed(&path, &cause))?;
        self.times.push(time);
        self.list()
    }

    /// The frames of these times are kept, and those after them taken back.
    fn keep(&mut self, times: &[f64]) -> Result<(), Error> {
        times.clone_into(&mut self.times);
        let missing = (0..times.len()).map(|number| self.folder.join(self.file(number))).find(|path| !path.is_file());
        if let Some(path) = missing {
            return Err(failed(&path, &"was there when the checkpoint was written, and is gone"));
        }
        for number in times.len().. {
            let path = self.folder.join(self.file(number));
            if path.symlink_metadata().is_err() {
                break;
            }
            files::remove(&path).map_err(|cause| failed(&path, &cause))?;
        }
        self.list()
    }

    fn list(&self) -> Result<(), Error> {
        let mut text =
            String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
        for (number, time) in self.times.iter().enumerate() {
            text += &format!("<DataSet timestep=\"{time}\" part=\"0\" file=\"{}\"/>\n", self.file(number));
        }
        text += "</Collection>\n</VTKFile>\n";
        let path = self.folder.join(format!("{}.pvd", self.name));
        files::replace(&path, text.as_bytes()).map_err(|cause| failed(&path, &cause))
    }
}

fn solid_frame(model: &Model, state: &State, grid: &mut Grid) {
    let stresses = nodal_stresses(model, state);
    // A body has one material, and a material serves one body: the two ids agree.
    let body = || model.body_of_element.iter().map(|&body| body as i32);
    let elements = model.mesh.elements.iter();
    grid.restart(&model.mesh.nodes, elements.map(|element| (element.kind.into(), &element.nodes[..])));
    grid.vectors("displacement", &state.displacement);
    grid.vectors("velocity", &state.velocity);
    grid.vectors("acceleration", &state.acceleration);
    grid.vectors("reaction", &state.reaction);
    grid.at_points("stress", 4, stresses.iter().flat_map(|s| [s.xx, s.yy, s.zz, s.xy]));
    grid.at_points("von_mises", 1, stresses.iter().map(CauchyStress::von_mises));
    grid.at_points("pressure", 1, stresses.iter().map(CauchyStress::pressure));
    grid.at_cells("body", body());
    grid.at_cells("material", body());
}

/// Cauchy stress at the nodes, averaged over the elements that meet there. An element that the
/// material law cannot answer leaves no trace: it never occurs in an accepted state.
fn nodal_stresses(model: &Model, state: &State) -> Vec<CauchyStress> {
    let (elements, memories) = (&model.mesh.elements, model.memories());
    let stresses_of = |e: usize| {
        let mut u = [Vector2::zeros(); 9];
        for (u, &node) in u.iter_mut().zip(&elements[e].nodes) {
            *u = Vector2::new(state.displacement[2 * node], state.displacement[2 * node + 1]);
        }
        let material = &*model.bodies[model.body_of_element[e]].material;
        model.solids[e].nodal_stresses(material, &state.memory[memories[e].clone()], &u[..elements[e].nodes.len()])
    };
    let mut sums = vec![([0.0; 4], 0.0); model.mesh.nodes.len()];
    for (element, stresses) in elements.iter().zip((0..elements.len()).map(stresses_of)) {
        for (stress, &node) in stresses.iter().flatten().zip(&element.nodes) {
            let (sum, count) = &mut sums[node];
            for (sum, part) in sum.iter_mut().zip([stress.xx, stress.yy, stress.zz, stress.xy]) {
                *sum += part;
            }
            *count += 1.0;
        }
    }
    let mean = |(sum, count): ([f64; 4], f64)| {
        let [xx, yy, zz, xy] = sum.map(|s| if count > 0.0 { s / count } else { 0.0 });
        CauchyStress { xx, yy, zz, xy }
    };
    sums.into_iter().map(mean).collect()
}

/// A contact point.
struct Place<'a> {
    pair: &'a ContactPair,
    slave: &'a SlavePoint,
}

fn contact_frame(model: &Model, state: &State, grid: &mut Grid) {
    let points_of = |pair: &ContactPair, x: &Configuration| pair.points.iter().map(|p| p.at(x)).collect::<Vec<_>>();
    let undeformed = model.mesh.undeformed();
    let reference: Vec<Vector2<f64>> = model.contacts.iter().flat_map(|pair| points_of(pair, &undeformed)).collect();
    let x = model.configuration(&state.displacement);
    let current: Vec<Vector2<f64>> = model.contacts.iter().flat_map(|pair| points_of(pair, &x)).collect();
    let displacement: Vec<f64> = reference.iter().zip(&current).flat_map(|(a, b)| [b.x - a.x, b.y - a.y]).collect();

    let mut lines: Vec<(CellType, Vec<usize>)> = Vec::new();
    let mut contact_id: Vec<i32> = Vec::new();
    let mut first = 0;
    for (number, pair) in model.contacts.iter().enumerate() {
        for line in pair.lines() {
            let kind = if line.len() == 1 { CellType::VERTEX } else { CellType::POLY_LINE };
            lines.push((kind, line.map(|k| first + k).collect()));
            contact_id.push(number as i32);
        }
        first += pair.points.len();
    }
    let states = model.contacts.iter().zip(&state.contacts).flat_map(|(pair, states)| {
        let points = pair.points.iter().zip(states);
        points.map(move |(slave, state)| (Place { pair, slave }, state))
    });
    let all: Vec<(Place, &ContactState)> = states.collect();
    grid.restart(&reference, lines.iter().map(|(kind, nodes)| (*kind, &nodes[..])));
    grid.vectors("displacement", &displacement);
    for name in fields::names(&model.contacts) {
        let value = |(place, s): &(Place, &ContactState)| fields::value(place.pair, place.slave, s, state.dt, name);
        grid.at_points(name, 1, all.iter().map(value));
    }
    grid.at_cells("contact", contact_id.into_iter());
}
