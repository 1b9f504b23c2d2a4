//! `history.csv`: one row per accepted increment, or those selected by an interval (`run/observer.rs`).

use std::slice;
use std::sync::Arc;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::bodies::{BodyMeans, Motion};
use super::csv;
use super::csv::{Rows, Sheet, Table};
use super::friction_history::FrictionHistory;
use super::quantities::{
    BAR, BODY, CONDUIT, CONTACT, EDGES, ENERGIES, FLUID_FORCE, HEAT, INCREMENT, OUTLET, PLASTIC, Quantity, RADIATED,
    RESULTANT, RIGID, SCATTER, WATCHED, WATER, WATER_ERROR, names,
};
use crate::bars::fields::Summary;
use crate::bars::{Bar, BarState};
use crate::contact::conduit::ConduitState;
use crate::contact::nodal_forces::Resultant;
use crate::contact::scatter::PointSequence;
use crate::contact::{ContactPair, ContactState};
use crate::equations::contacts;
use crate::laws::friction::{Regime, observables};
use crate::mesh::configuration::Configuration;
use crate::mesh::shape;
use crate::model::{Energy, Model, State, WatchedSet};
use crate::run::{Attempt, Error};

/// Observer that writes `history.csv`.
pub type History = Sheet<HistoryRows>;

/// Rows of `history.csv`.
#[derive(Clone, Debug)]
pub struct HistoryRows {
    /// Observables of each contact whose means are written
    observed: Vec<Vec<&'static str>>,
    /// Center of each undeformed slave surface, the reference point of moments
    middles: Vec<Vector2<f64>>,
    /// How the points of each contact follow each other
    surfaces: Vec<PointSequence>,
    bodies: Arc<[BodyMeans]>,
    /// ∫ N_a ds of the watched edge sets
    edges: Vec<EdgeMeans>,
    memory: Memory,
}

/// Names of the columns of a model's history.
pub fn columns(model: &Model) -> Vec<String> {
    HistoryRows::new(model).1
}

/// Memory from row to row.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Memory {
    /// Rotation of each body, with full turns; empty before the first increment [rad]
    rotations: Vec<f64>,
    /// Frictional heat of each contact so far [F·L]
    heat: Vec<f64>,
    /// Friction history of each contact so far
    courses: Vec<FrictionHistory>,
}

/// A watched set of edges: its name, and the tributary fraction of its length at each node.
type EdgeMeans = (String, Vec<(usize, f64)>);

impl Rows for HistoryRows {
    const NAME: &'static str = "history";

    fn new(model: &Model) -> (Self, Vec<String>) {
        let of = |name: &str, columns: &[Quantity]| {
            names(columns).map(|column| format!("{name}.{column}")).collect::<Vec<_>>()
        };
        let mut header: Vec<String> = names(&INCREMENT).chain(names(&ENERGIES)).collect();
        header.extend(model.contacts.iter().flat_map(|pair| of(&pair.name, &CONTACT)));
        header.extend(model.requests.watch.iter().flat_map(|set| of(&set.name, &WATCHED)));
        header.extend(radiates(model).then(|| RADIATED.name.into()));
        let further = |pair: &ContactPair| observables::further(pair.laws.iter().map(|law| &law.description));
        let observed: Vec<Vec<&str>> = model.contacts.iter().map(further).collect();
        for (pair, names) in model.contacts.iter().zip(&observed) {
            header.extend(names.iter().map(|name| format!("{}.mean_{name}", pair.name)));
        }
        let edges: Vec<EdgeMeans> = model.requests.watch.iter().filter_map(|set| edge_means(model, set)).collect();
        header.extend(model.contacts.iter().flat_map(|pair| of(&pair.name, &RESULTANT)));
        header.extend(model.bodies.iter().flat_map(|body| of(&body.name, &BODY)));
        header.extend(edges.iter().flat_map(|(name, _)| of(name, &EDGES)));
        let in_fluid = model.contacts.iter().filter(|pair| pair.holds_fluid());
        header.extend(in_fluid.flat_map(|pair| of(&pair.name, &[FLUID_FORCE])));
        header.extend(model.contacts.iter().flat_map(|pair| of(&pair.name, &HEAT)));
        header.extend(model.contacts.iter().flat_map(|pair| of(&pair.name, &[SCATTER])));
        header.extend(model.mesh.rigid_bodies.iter().flat_map(|body| of(&body.name, &RIGID)));
        header.extend(yields(model).then(|| PLASTIC.name.into()));
        header.extend(model.bars.iter().flat_map(|bar| of(&bar.name, &BAR)));
        let with_water = model.contacts.iter().filter(|pair| pair.conduit.is_some());
        header.extend(with_water.flat_map(|pair| of(&pair.name, &CONDUIT)));
        if let Some(flow) = &model.flow {
            header.extend(flow.bodies.iter().flat_map(|&body| of(&model.bodies[body].name, &WATER)));
            header.extend(flow.outlets.iter().flat_map(|outlet| of(outlet, &OUTLET)));
            header.push(WATER_ERROR.name.into());
        }
        let undeformed = model.mesh.undeformed();
        let rows = Self {
            observed,
            middles: model.contacts.iter().map(|pair| pair.middle(&undeformed)).collect(),
            surfaces: model.contacts.iter().map(|pair| PointSequence::new(&pair.points, &undeformed)).collect(),
            bodies: model.bodies.iter().map(|body| BodyMeans::new(model, body)).collect(),
            edges,
            memory: Memory {
                rotations: Vec::new(),
                heat: vec![0.0; model.contacts.len()],
                courses: vec![FrictionHistory::default(); model.contacts.len()],
            },
        };
        (rows, header)
    }

    fn write(&mut self, table: &mut Table, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        table.number(state.time);
        table.number(state.dt);
        table.text(&attempt.step.name);
        table.count(attempt.iterations.len());
        table.numbers(self.values(model, attempt.old, state));
        table.end_row_as(attempt.row)
    }

    fn save(&self) -> Result<Vec<u8>, Error> {
        csv::remembered(&self.memory)
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        self.memory = csv::recalled::<Memory>(memory)?;
        Ok(())
    }
}

impl HistoryRows {
    /// Numbers of the row of an accepted increment behind those of the increment itself ([`INCREMENT`]).
    pub(super) fn values(&mut self, model: &Model, old: &State, state: &State) -> Vec<f64> {
        let Self { observed, middles, surfaces, bodies, edges, memory } = self;
        let mut row = Vec::from(energy_row(&state.energy));
        let x = model.configuration(&state.displacement);
        for ((pair, states), course) in model.contacts.iter().zip(&state.contacts).zip(&mut memory.courses) {
            let columns @ [normal, tangential, _, slipping, ..] =
                contact_row(pair, states, pair.bodies.iter().flatten().all(|&body| state.has(body)).then_some(&x));
            course.note(state.time, normal, tangential, slipping);
            row.extend(columns);
        }
        row.extend(model.requests.watch.iter().flat_map(|set| watched_row(set, state)));
        row.extend(radiates(model).then_some(state.energy.radiated));
        for ((pair, states), names) in model.contacts.iter().zip(&state.contacts).zip(observed) {
            row.extend(names.iter().map(|name| mean(pair, states, state.time, name)));
        }
        let x = model.configuration(&state.displacement);
        for ((pair, states), middle) in model.contacts.iter().zip(&state.contacts).zip(middles) {
            let Resultant { force, moment } = pair.resultant(states, &x, *middle);
            row.extend([force.x, force.y, moment]);
        }
        if memory.rotations.is_empty() {
            memory.rotations = bodies.iter().map(|body| body.motion(model, old).rotation).collect();
        }
        for (body, rotation) in bodies.iter().zip(&mut memory.rotations) {
            let motion = body.motion(model, state);
            *rotation = nearest_turn(*rotation, motion.rotation);
            let Motion { momentum: p, angular_momentum, centre: c, .. } = motion;
            row.extend([p.x, p.y, angular_momentum, c.x, c.y, *rotation]);
        }
        for (_, shares) in edges {
            let mean =
                |i: usize| -> f64 { shares.iter().map(|(node, share)| share * state.displacement[2 * node + i]).sum() };
            row.extend([mean(0), mean(1)]);
        }
        for (_, states) in model.contacts.iter().zip(&state.contacts).filter(|(pair, _)| pair.holds_fluid()) {
            row.push(states.iter().map(|state| state.length * (state.fluid + state.pores)).sum());
        }
        for (heat, (old_states, new)) in memory.heat.iter_mut().zip(old.contacts.iter().zip(&state.contacts)) {
            let more = contacts::dissipated(slice::from_ref(old_states), slice::from_ref(new));
            *heat += more;
            row.extend([*heat, more / (state.time - old.time)]);
        }
        row.extend(surfaces.iter().zip(&state.contacts).map(|(points, states)| points.scatter(states)));
        for body in &model.mesh.rigid_bodies {
            row.extend([body.angle(&x), body.radius * state.reaction[2 * body.turning]]);
        }
        row.extend(yields(model).then_some(state.energy.plastic_dissipation));
        row.extend(model.bars.iter().zip(&state.bars).flat_map(|(bar, state)| bar_row(bar, state)));
        let with_water = model.contacts.iter().enumerate().filter(|(_, pair)| pair.conduit.is_some());
        row.extend(with_water.flat_map(|(k, _)| conduit_row(&state.conduits[k], &state.contacts[k])));
        row.extend(water_row(model, state));
        row
    }
}

impl History {
    /// Friction histories of the contacts, in their order.
    pub fn courses(&self) -> &[FrictionHistory] {
        &self.rows.memory.courses
    }
}

/// Water of the bodies in which it flows, flow through its outlets, and their balance.
fn water_row(model: &Model, state: &State) -> Vec<f64> {
    let Some(flow) = &model.flow else { return Vec::new() };
    let mut row = Vec::new();
    for (k, &body) in flow.bodies.iter().enumerate() {
        let [taken, excess] = model.water_of(body, state).unwrap_or_default();
        let degree = if state.has(body) { state.water.consolidation(k) } else { f64::NAN };
        row.extend([excess, degree, taken]);
    }
    for k in 0..flow.outlets.len() {
        let outlet = state.water.outlets.get(k).copied().unwrap_or_default();
        row.extend([outlet.rate, outlet.volume]);
    }
    row.extend(model.balance_of_water(state).map(|[error, _]| error));
    row
}

/// Whether slip radiates, which adds a column to the energies.
fn radiates(model: &Model) -> bool {
    model.contacts.iter().any(|pair| pair.radiation > 0.0)
}

/// Forces of a bar, and its bond.
fn bar_row(bar: &Bar, state: &BarState) -> [f64; BAR.len()] {
    let Summary { ends, axial, moment, shear, slip, slipping } = bar.summary(state);
    [ends[0], ends[1], axial[0], axial[1], moment, shear, slip, slipping]
}

/// Volumes of the water that flows along a contact, and its largest pressure, flow and aperture.
fn conduit_row(water: &ConduitState, points: &[ContactState]) -> [f64; CONDUIT.len()] {
    let pressure = water.pressure.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let water_points = || points.iter().filter_map(|point| point.water);
    let flow = water_points().map(|at| at.flow.abs()).fold(0.0, f64::max);
    let aperture = water_points().map(|at| at.aperture).fold(0.0, f64::max);
    [water.amounts.injected, water.amounts.leaked, water.mass_error, pressure, flow, aperture]
}

/// Whether some body or bar yields, and the energies have a column for it.
fn yields(model: &Model) -> bool {
    model.bars.iter().any(|bar| bar.limit.is_finite())
        || model.bodies.iter().any(|body| body.material.description().flow.is_some())
}

fn energy_row(energy: &Energy) -> [f64; ENERGIES.len()] {
    [
        energy.kinetic,
        energy.strain,
        energy.contact_elastic,
        energy.friction_dissipation,
        energy.damping_dissipation,
        energy.external_work,
        energy.error(),
    ]
}

/// Columns of one contact. The forces are ∫ p ds and ∫ q ds, with radiation damping ∫ (q + η v) ds; means are taken over the
/// closed length. The deepest penetration is looked for in the configuration `x`, if all bodies are there.
fn contact_row(pair: &ContactPair, states: &[ContactState], x: Option<&Configuration>) -> [f64; CONTACT.len()] {
    let (mut normal, mut tangential, mut closed, mut slipping, mut slip) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let (mut penetration, mut largest_elastic, mut elastic) = (0.0f64, 0.0f64, 0.0);
    for (point, state) in pair.points.iter().zip(states) {
        let (friction, length) = (&state.friction, state.length);
        if !state.acts() {
            continue;
        }
        let [pressure, traction] = state.tractions();
        normal += length * pressure;
        tangential += length * traction;
        if state.regime() == Regime::Open {
            continue;
        }
        closed += length;
        slipping += if pair.regime(point, state) == Regime::Slip { length } else { 0.0 };
        slip += length * friction.plastic_slip;
        penetration = penetration.max(-state.clearance());
        largest_elastic = largest_elastic.max(pair.elastic_slip(point, state).abs());
        elastic += length * pair.elastic_slip(point, state);
    }
    if let Some(x) = x {
        let of_master = pair.deepest_master_node(states, x).map(|(_, depth, _)| depth);
        penetration =
            of_master.into_iter().chain(pair.deepest(x).map(|deepest| deepest.depth)).fold(penetration, f64::max);
    }
    let share = |part: f64| if closed > 0.0 { part / closed } else { 0.0 };
    [normal, tangential, closed, share(slipping), share(slip), penetration, largest_elastic, share(elastic)]
}

/// Mean of an observable over the closed length; 0 where nothing is closed.
fn mean(pair: &ContactPair, states: &[ContactState], time: f64, name: &str) -> f64 {
    let (mut sum, mut closed) = (0.0, 0.0);
    for (point, state) in pair.points.iter().zip(states).filter(|(_, state)| state.regime() != Regime::Open) {
        sum += state.length * pair.observed(point, name, state, time);
        closed += state.length;
    }
    if closed > 0.0 { sum / closed } else { 0.0 }
}

/// Mean displacement and total reaction of a watched set.
fn watched_row(set: &WatchedSet, state: &State) -> [f64; WATCHED.len()] {
    let total = |nodes: &[usize], values: &[f64], i: usize| nodes.iter().map(|&node| values[2 * node + i]).sum::<f64>();
    let mean = |i| total(&set.nodes, &state.displacement, i) / set.nodes.len() as f64;
    [mean(0), mean(1), total(&set.constrained[0], &state.reaction, 0), total(&set.constrained[1], &state.reaction, 1)]
}

/// Tributary fractions of a watched edge set; `None` where it has no length of its own.
///
/// ```text
/// ū = ∫ u ds/∫ ds                         along the undeformed edges, over the area of rings
/// ```
fn edge_means(model: &Model, set: &WatchedSet) -> Option<EdgeMeans> {
    if set.edges.is_empty() {
        return None;
    }
    let x = model.mesh.undeformed();
    let mut shares: Vec<(usize, f64)> = Vec::new();
    for edge in &set.edges {
        let count = edge.nodes.len();
        for (xi, weight) in shape::gauss(3) {
            let slope: Vec<(usize, f64)> = edge.nodes.iter().copied().zip(shape::edge_derivatives(count, xi)).collect();
            let at: Vec<(usize, f64)> = edge.nodes.iter().copied().zip(shape::edge_values(count, xi)).collect();
            let length = weight * x.combine(&slope).norm() * x.weight(&at);
            shares.extend(at.into_iter().map(|(node, n)| (node, n * length)));
        }
    }
    let length: f64 = shares.iter().map(|(_, share)| share).sum();
    shares.iter_mut().for_each(|(_, share)| *share /= length);
    Some((set.name.clone(), shares))
}

/// Adds full turns to an angle so that it is closest to the previous one.
fn nearest_turn(before: f64, angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle + turn * ((before - angle) / turn).round()
}
