//! `sections.csv`: normal force, shear force and bending moment at sections across bodies, at the rows of the history.
//!
//! ```text
//! F = ½ Σ_a (f_a of the elements before − f_a of those beyond)            a: nodes of the cut, f_a: nodal forces of the stresses
//! M = ½ Σ_a (x_a − c) × (…),   N = F·t,   Q = F·r                          c: place of the station by then
//! ```
//!
//! t is the direction of the axis by then, from a neighbour of the station to the other, and r is t turned by −90°; of a `linear` body places are those of the mesh. The nodal forces of each
//! element are in equilibrium, so that F and M are in equilibrium with all that acts on either part, whatever the mesh; of what acts at
//! the cut itself each part has a half, as has the integral over the elements adjacent to it.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;

use super::csv::{Rows, Sheet, Table};
use super::quantities::{SECTION, names};
use crate::mesh::configuration::Configuration;
use crate::model::element::Memory;
use crate::model::{Axis, Model, State, Station};
use crate::run::{Attempt, Error};

/// Observer that writes `sections.csv`.
pub type Sections = Sheet<SectionRows>;

/// Rows of `sections.csv`.
#[derive(Clone, Debug)]
pub struct SectionRows;

/// Forces of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionForces {
    /// Place of the station in the mesh [L]
    pub place: Vector2<f64>,
    /// N, positive in tension [F]
    pub axial_force: f64,
    /// Q = dM/ds [F]
    pub shear_force: f64,
    /// M, positive where the right of the way along the axis is pulled [F·L]
    pub moment: f64,
}

impl Rows for SectionRows {
    const NAME: &'static str = "sections";

    fn new(model: &Model) -> (Self, Vec<String>) {
        let station = |axis: &Axis, k: usize| {
            let name = format!("{}.{}", axis.name, k + 1);
            names(&SECTION).map(move |of| format!("{name}.{of}")).collect::<Vec<_>>()
        };
        let axes = model.requests.sections.iter();
        let columns = axes.flat_map(|axis| (0..axis.stations.len()).flat_map(|k| station(axis, k)));
        (Self, std::iter::once("time".into()).chain(columns).collect())
    }

    fn write(&mut self, table: &mut Table, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        table.number(state.time);
        for axis in &model.requests.sections {
            for SectionForces { place, axial_force, shear_force, moment } in along(axis, model, state) {
                table.numbers([place.x, place.y, axial_force, shear_force, moment]);
            }
        }
        table.end_row_as(attempt.row)
    }
}

/// Forces at the stations of an axis; not a number while its body is absent.
pub fn along(axis: &Axis, model: &Model, state: &State) -> Vec<SectionForces> {
    // Forces of a linear law are in equilibrium on the body as it lies in the mesh.
    let is_linear = model.bodies[axis.body].material.description().is_linear;
    let x = if is_linear { model.mesh.undeformed() } else { model.mesh.displaced(&state.displacement) };
    let is_there = state.has(axis.body);
    let elements: BTreeSet<usize> = axis.stations.iter().flat_map(|of| of.parts.iter().flatten()).copied().collect();
    let forces: BTreeMap<usize, Vec<f64>> = match is_there {
        true => elements.into_iter().map(|e| (e, nodal_forces(model, state, e))).collect(),
        false => BTreeMap::new(),
    };
    let places: Vec<Vector2<f64>> = axis.stations.iter().map(|station| now(station, model, &x)).collect();
    let last = places.len() - 1;
    let of = |(k, station): (usize, &Station)| {
        let along = (places[(k + 1).min(last)] - places[k.saturating_sub(1)]).normalize();
        let [force, moment] = match is_there {
            true => resultant(station, places[k], &forces, model, &x),
            false => [Vector2::repeat(f64::NAN); 2],
        };
        SectionForces {
            place: station.place,
            axial_force: force.dot(&along),
            shear_force: force.dot(&Vector2::new(along.y, -along.x)),
            moment: moment.x,
        }
    };
    axis.stations.iter().enumerate().map(of).collect()
}

/// Place of a station by now.
fn now(station: &Station, model: &Model, x: &Configuration) -> Vector2<f64> {
    let element = &model.mesh.elements[station.element];
    let shares = element.kind.values(station.at);
    let u = element.nodes.iter().zip(&shares).map(|(&node, share)| x.displacement(node) * *share);
    station.place + u.sum::<Vector2<f64>>()
}

/// F, and M in the first component of the second vector.
fn resultant(
    station: &Station,
    centre: Vector2<f64>,
    forces: &BTreeMap<usize, Vec<f64>>,
    model: &Model,
    x: &Configuration,
) -> [Vector2<f64>; 2] {
    let halves = if station.parts.iter().any(Vec::is_empty) { 1.0 } else { 0.5 };
    let (mut sum, mut moment) = (Vector2::zeros(), 0.0);
    for (part, sign) in station.parts.iter().zip([halves, -halves]) {
        for &e in part {
            for (&node, force) in model.mesh.elements[e].nodes.iter().zip(forces[&e].chunks_exact(2)) {
                if station.cut.binary_search(&node).is_ok() {
                    let force = Vector2::new(force[0], force[1]) * sign;
                    sum += force;
                    moment += (x.at(node) - centre).perp(&force);
                }
            }
        }
    }
    [sum, Vector2::new(moment, 0.0)]
}

/// Nodal forces of the stresses of an element.
fn nodal_forces(model: &Model, state: &State, e: usize) -> Vec<f64> {
    let (solid, u) = (model.solid(state, e), model.mesh.vectors(e, &state.displacement));
    let old = model.memories.of(e, &state.memory);
    let (mut new, mut force) = (old.to_vec(), vec![0.0; 2 * u.len()]);
    let memory = Memory { dt: 0.0, old, new: &mut new };
    match solid.evolve(&*model.body_of(e).material, memory, &u, &mut force, None) {
        Ok(_) => force,
        Err(_) => vec![f64::NAN; 2 * u.len()],
    }
}
