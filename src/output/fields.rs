//! `solid.pvd` and `contact.pvd`: what ParaView shows, one VTU file a frame.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use super::csv::failed;
use super::vtu::{CellType, Grid};
use crate::contact::force::ContactState;
use crate::contact::pair::ContactPair;
use crate::contact::surface::SlavePoint;
use crate::laws::bulk::CauchyStress;
use crate::laws::friction::{Regime, observables};
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
    /// States to be written; `None` when there are no more
    frames: Option<SyncSender<State>>,
    /// `None` when it has ended
    writer: Option<JoinHandle<Result<(), Error>>>,
}

/// Frames that may wait for the writer; a run that is faster waits, so that memory stays bounded.
const WAITING: usize = 1;

/// A time series of VTU files and the `.pvd` that lists them.
#[derive(Debug)]
struct Collection {
    folder: PathBuf,
    name: &'static str,
    frames: Vec<(f64, String)>,
}

impl Fields {
    /// Start the series in `folder`, with the state at rest as the first frame; then that of every n-th row of
    /// the history and the last of each step are written.
    ///
    /// # Errors
    /// [`Error::Output`] when a file cannot be written.
    pub fn create(folder: &Path, model: Arc<Model>, start: &State, every: usize) -> Result<Self, Error> {
        let mut solid = Collection::create(folder, "solid")?;
        let mut contact = (!model.contacts.is_empty()).then(|| Collection::create(folder, "contact")).transpose()?;
        let (frames, arriving): (_, Receiver<State>) = sync_channel(WAITING);
        let writer = std::thread::spawn(move || {
            let mut grid = Grid::default();
            for state in arriving {
                solid_frame(&model, &state, &mut grid);
                solid.write(state.time, &grid)?;
                if let Some(contact) = &mut contact {
                    contact_frame(&model, &state, &mut grid);
                    contact.write(state.time, &grid)?;
                }
            }
            Ok(())
        });
        let mut fields = Self { every, rows: 0, frames: Some(frames), writer: Some(writer) };
        fields.write(start)?;
        Ok(fields)
    }

    /// Hand a state to the writer. One that has ended has failed, and says why.
    fn write(&mut self, state: &State) -> Result<(), Error> {
        let taken = self.frames.as_ref().is_some_and(|frames| frames.send(state.clone()).is_ok());
        if taken { Ok(()) } else { self.finish() }
    }
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

    fn finish(&mut self) -> Result<(), Error> {
        self.frames = None;
        match self.writer.take().map(JoinHandle::join) {
            None => Ok(()),
            Some(Ok(written)) => written,
            Some(Err(_)) => Err(failed(Path::new("solid.pvd"), &"the writer of frames broke off")),
        }
    }
}

impl Collection {
    fn create(folder: &Path, name: &'static str) -> Result<Self, Error> {
        let frames = folder.join(name);
        std::fs::create_dir_all(&frames).map_err(|cause| failed(&frames, &cause))?;
        Ok(Self { folder: folder.to_owned(), name, frames: Vec::new() })
    }

    /// Write one frame and list it, so that a running or killed run can be looked at.
    fn write(&mut self, time: f64, grid: &Grid) -> Result<(), Error> {
        let file = format!("{}/{:05}.vtu", self.name, self.frames.len());
        let path = self.folder.join(&file);
        grid.write(&path).map_err(|cause| failed(&path, &cause))?;
        self.frames.push((time, file));
        self.list()
    }

    fn list(&self) -> Result<(), Error> {
        let mut text =
            String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
        for (time, file) in &self.frames {
            text += &format!("<DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>\n");
        }
        text += "</Collection>\n</VTKFile>\n";
        let path = self.folder.join(format!("{}.pvd", self.name));
        std::fs::write(&path, text).map_err(|cause| failed(&path, &cause))
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

/// How a regime is written.
fn number(regime: Regime) -> f64 {
    match regime {
        Regime::Open => 0.0,
        Regime::Stick => 1.0,
        Regime::Slip => 2.0,
    }
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
    let rate = if state.dt > 0.0 { 1.0 / state.dt } else { 0.0 };
    grid.restart(&reference, lines.iter().map(|(kind, nodes)| (*kind, &nodes[..])));
    grid.vectors("displacement", &displacement);
    let mut scalar = |name: &str, value: &dyn Fn(&Place, &ContactState) -> f64| {
        grid.at_points(name, 1, all.iter().map(|(place, state)| value(place, state)));
    };
    scalar("gap", &|_, s| s.gap);
    scalar("pressure", &|_, s| s.friction.pressure);
    scalar("traction", &|_, s| s.friction.traction);
    scalar("slip", &|_, s| s.friction.plastic_slip);
    scalar("elastic_slip", &|at, s| at.pair.elastic_slip(at.slave, &s.friction));
    scalar("slip_rate", &|_, s| s.friction.plastic_increment * rate);
    let observed = |name: &'static str| {
        move |at: &Place, s: &ContactState| observables::value(at.pair.law(at.slave), name, &s.friction)
    };
    observables::ALWAYS.iter().for_each(|(name, _)| scalar(name, &observed(name)));
    scalar("state", &|_, s| number(s.regime()));
    scalar("dissipation", &|_, s| s.friction.dissipation);
    let laws = model.contacts.iter().flat_map(|pair| &pair.laws).map(|law| &**law);
    observables::further(laws).into_iter().for_each(|name| scalar(name, &observed(name)));
    grid.at_cells("contact", contact_id.into_iter());
}
