//! `solid.pvd` and `contact.pvd`: what ParaView shows, one VTU file a frame.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use nalgebra::Vector2;
use rayon::prelude::*;
use vtkio::IOBuffer;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, UnstructuredGridPiece, Version,
    VertexNumbers, Vtk,
};

use super::csv::failed;
use super::{Attempt, Observer};
use crate::configuration::Configuration;
use crate::contact::force::{ContactState, Status};
use crate::contact::pair::ContactPair;
use crate::contact::surface::SlavePoint;
use crate::error::Error;
use crate::model::Model;
use crate::shape::ElementKind;
use crate::state::State;

/// Writes frames of the solids and of the interfaces, in the background while the run goes on.
#[derive(Debug)]
pub struct Fields {
    every: usize,
    /// `None` when there are no more
    frames: Option<SyncSender<Frame>>,
    /// `None` when it has ended
    writer: Option<JoinHandle<Result<(), Error>>>,
}

/// One moment, ready to be written.
struct Frame {
    time: f64,
    solid: UnstructuredGridPiece,
    contact: Option<UnstructuredGridPiece>,
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
    /// Start the series in `folder`, with the state at rest as the first frame; then every n-th accepted increment and
    /// the last of each step are written.
    ///
    /// # Errors
    /// [`Error::Output`] when a file cannot be written.
    pub fn create(folder: &Path, model: &Model, start: &State, every: usize) -> Result<Self, Error> {
        let mut solid = Collection::create(folder, "solid")?;
        let mut contact = (!model.contacts.is_empty()).then(|| Collection::create(folder, "contact")).transpose()?;
        let (frames, arriving): (_, Receiver<Frame>) = sync_channel(WAITING);
        let writer = std::thread::spawn(move || {
            for frame in arriving {
                solid.write(frame.time, frame.solid)?;
                if let (Some(contact), Some(piece)) = (&mut contact, frame.contact) {
                    contact.write(frame.time, piece)?;
                }
            }
            Ok(())
        });
        let mut fields = Self { every, frames: Some(frames), writer: Some(writer) };
        fields.write(model, start)?;
        Ok(fields)
    }

    /// Hand a frame to the writer. One that has ended has failed, and says why.
    fn write(&mut self, model: &Model, state: &State) -> Result<(), Error> {
        let contact = (!model.contacts.is_empty()).then(|| contact_frame(model, state));
        let frame = Frame { time: state.time, solid: solid_frame(model, state), contact };
        let taken = self.frames.as_ref().is_some_and(|frames| frames.send(frame).is_ok());
        if taken { Ok(()) } else { self.finish() }
    }
}

impl Observer for Fields {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        match attempt.accepted {
            Some(state) if state.increment % self.every == 0 || state.time >= attempt.step.span.end => {
                self.write(model, state)
            }
            _ => Ok(()),
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
    fn write(&mut self, time: f64, piece: UnstructuredGridPiece) -> Result<(), Error> {
        let file = format!("{}/{:05}.vtu", self.name, self.frames.len());
        let path = self.folder.join(&file);
        let vtk = Vtk {
            version: Version::new_xml(1, 0),
            title: String::new(),
            byte_order: ByteOrder::LittleEndian,
            data: DataSet::inline(piece),
            file_path: None,
        };
        let out = File::create(&path).map_err(|cause| failed(&path, &cause))?;
        vtk.write_xml(BufWriter::new(out)).map_err(|cause| failed(&path, &cause))?;
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

fn solid_frame(model: &Model, state: &State) -> UnstructuredGridPiece {
    let elements = &model.mesh.elements;
    let stresses = nodal_stresses(model, state);
    let von_mises: Vec<f64> = stresses
        .iter()
        .map(|&[xx, yy, zz, xy]| {
            (0.5 * ((xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2)) + 3.0 * xy * xy).sqrt()
        })
        .collect();
    let pressure: Vec<f64> = stresses.iter().map(|[xx, yy, zz, _]| -(xx + yy + zz) / 3.0).collect();
    let body: Vec<i32> = model.body_of_element.iter().map(|&body| body as i32).collect();
    UnstructuredGridPiece {
        points: points(&model.mesh.nodes),
        cells: cells(elements.iter().map(|element| (cell_type(element.kind), element.nodes.clone()))),
        data: Attributes {
            point: vec![
                vectors("displacement", &state.displacement),
                vectors("velocity", &state.velocity),
                vectors("acceleration", &state.acceleration),
                vectors("reaction", &state.reaction),
                array("stress", 4, stresses.concat()),
                array("von_mises", 1, von_mises),
                array("pressure", 1, pressure),
            ],
            // A body has one material, and a material serves one body: the two ids agree.
            cell: vec![array("body", 1, body.clone()), array("material", 1, body)],
        },
    }
}

/// Cauchy stress (xx, yy, zz, xy) at the nodes, averaged over the elements that meet there. An element that the
/// material law cannot answer leaves no trace: it never occurs in an accepted state.
fn nodal_stresses(model: &Model, state: &State) -> Vec<[f64; 4]> {
    let elements = &model.mesh.elements;
    let stresses_of = |e: usize| {
        let mut u = [Vector2::zeros(); 9];
        for (u, &node) in u.iter_mut().zip(&elements[e].nodes) {
            *u = Vector2::new(state.displacement[2 * node], state.displacement[2 * node + 1]);
        }
        let material = &*model.bodies[model.body_of_element[e]].material;
        model.solids[e].nodal_stresses(material, &u[..elements[e].nodes.len()])
    };
    let all: Vec<_> = (0..elements.len()).into_par_iter().with_min_len(64).map(stresses_of).collect();
    let mut sums = vec![([0.0; 4], 0.0); model.mesh.nodes.len()];
    for (element, stresses) in elements.iter().zip(all) {
        for (stress, &node) in stresses.iter().flatten().zip(&element.nodes) {
            let (sum, count) = &mut sums[node];
            for (sum, part) in sum.iter_mut().zip([stress.xx, stress.yy, stress.zz, stress.xy]) {
                *sum += part;
            }
            *count += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| sum.map(|s| if count > 0.0 { s / count } else { 0.0 })).collect()
}

/// A contact point.
struct Place<'a> {
    pair: &'a ContactPair,
    slave: &'a SlavePoint,
}

fn contact_frame(model: &Model, state: &State) -> UnstructuredGridPiece {
    let points_of = |pair: &ContactPair, x: &Configuration| pair.points.iter().map(|p| p.at(x)).collect::<Vec<_>>();
    let undeformed = Configuration::undeformed(&model.mesh.nodes);
    let reference: Vec<Vector2<f64>> = model.contacts.iter().flat_map(|pair| points_of(pair, &undeformed)).collect();
    let x = model.configuration(&state.displacement);
    let current: Vec<Vector2<f64>> = model.contacts.iter().flat_map(|pair| points_of(pair, &x)).collect();
    let displacement: Vec<f64> = reference.iter().zip(&current).flat_map(|(a, b)| [b.x - a.x, b.y - a.y]).collect();

    let mut lines: Vec<(CellType, Vec<usize>)> = Vec::new();
    let mut contact_id: Vec<i32> = Vec::new();
    let mut first = 0;
    for (number, pair) in model.contacts.iter().enumerate() {
        for line in pair.lines() {
            let kind = if line.len() == 1 { CellType::Vertex } else { CellType::PolyLine };
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
    let scalar = |name: &str, value: &dyn Fn(&Place, &ContactState) -> f64| {
        array(name, 1, all.iter().map(|(place, state)| value(place, state)).collect::<Vec<f64>>())
    };
    let rate = if state.dt > 0.0 { 1.0 / state.dt } else { 0.0 };
    UnstructuredGridPiece {
        points: points(&reference),
        cells: cells(lines.into_iter()),
        data: Attributes {
            point: vec![
                vectors("displacement", &displacement),
                scalar("gap", &|_, s| s.gap),
                scalar("pressure", &|_, s| s.friction.pressure),
                scalar("traction", &|_, s| s.friction.traction),
                scalar("slip", &|_, s| s.friction.plastic_slip),
                scalar("elastic_slip", &|at, s| at.pair.elastic_slip(at.slave, &s.friction)),
                scalar("slip_rate", &|_, s| s.friction.plastic_increment * rate),
                scalar("R", &|_, s| s.friction.ratio()),
                scalar("mu", &|_, s| s.friction.mu),
                scalar("structure", &|at, s| at.pair.law(at.slave).structure(s.friction.mu)),
                scalar("state", &|_, s| match s.status() {
                    Status::Open => 0.0,
                    Status::Stick => 1.0,
                    Status::Slip => 2.0,
                }),
                scalar("dissipation", &|_, s| s.friction.dissipation),
            ],
            cell: vec![array("contact", 1, contact_id)],
        },
    }
}

fn points(positions: &[Vector2<f64>]) -> IOBuffer {
    IOBuffer::F64(positions.iter().flat_map(|x| [x.x, x.y, 0.0]).collect())
}

fn cells(cells: impl Iterator<Item = (CellType, Vec<usize>)>) -> Cells {
    let (mut connectivity, mut offsets, mut types) = (Vec::new(), Vec::new(), Vec::new());
    for (kind, nodes) in cells {
        connectivity.extend(nodes.iter().map(|&node| node as u64));
        offsets.push(connectivity.len() as u64);
        types.push(kind);
    }
    Cells { cell_verts: VertexNumbers::XML { connectivity, offsets }, types }
}

fn cell_type(kind: ElementKind) -> CellType {
    match kind {
        ElementKind::T3 => CellType::Triangle,
        ElementKind::T6 => CellType::QuadraticTriangle,
        ElementKind::Q4 => CellType::Quad,
        ElementKind::Q8 => CellType::QuadraticQuad,
        ElementKind::Q9 => CellType::BiquadraticQuad,
    }
}

fn array(name: &str, components: u32, values: impl Into<IOBuffer>) -> Attribute {
    Attribute::DataArray(DataArray::scalars(name, components).with_data(values))
}

/// A vector of two components a node, as the three that VTK wants.
fn vectors(name: &str, values: &[f64]) -> Attribute {
    let three: Vec<f64> = values.chunks_exact(2).flat_map(|v| [v[0], v[1], 0.0]).collect();
    array(name, 3, three)
}
