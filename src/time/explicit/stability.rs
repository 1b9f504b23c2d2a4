//! Stability limit, (1) to (4) of [`super`], and its re-evaluation.
//!
//! The bound of an element is re-evaluated when its shape has changed: when a node has moved, relative to the first node, by
//! more than the fraction [`CHANGED`] of the element's size (area over diagonal). This is checked before the increment in which
//! it happens, with the known displacements at its end. All elements are compared as soon as two nodes may have moved so
//! far relative to each other that an element has changed by [`LATEST`]. The stiffness added by contacts is re-evaluated when a
//! point moves to another segment.
//!
//! This section evaluates the bounds (2) of [`super`] for one element. Identical elements share their bounds.
//!
//! The memory of explicit increments follows neither from the model nor from the state: the displacement at which each
//! element was last evaluated, and the result. A run resumed from a file takes the same increments with it.

use std::collections::HashMap;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Vector2};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::Explicit;
use crate::contact::master::Master;
use crate::contact::surface::{SegmentWeights, SlavePoint};
use crate::equations::sums::TrialFailure;
use crate::equations::wet_elements::trapped;
use crate::mesh::configuration::{Configuration, vector};
use crate::mesh::rigid::RigidBody;
use crate::model::element::Memory;
use crate::model::{Body, Model, State, Step};
use crate::solve::failure::IncrementFailure;

/// Change of an element, as a fraction of its size, at which its bound is re-evaluated; this is also about its accuracy.
const CHANGED: f64 = 0.04;

/// Possible change of an element, as a fraction of its size, at which the elements are compared.
const LATEST: f64 = 0.06;

/// Number of increments after which the contributions of contacts and springs are re-evaluated in any case.
const LOOK_AGAIN: usize = 200;

/// Number of elements below which a comparison takes less time than starting another thread.
const FEW: usize = 2048;

/// Bounds of the increment, as last evaluated. Clones share them until they are evaluated again.
#[derive(Clone)]
pub(super) struct Stability {
    pub(super) model: Arc<Model>,
    retardation: Vec<f64>,
    pub(super) elements: Arc<Vec<Element>>,
    /// Nodes of the elements, `stride` entries per element, padded with the first node
    nodes: Arc<[usize]>,
    /// Their displacements relative to the first node at the last evaluation of the element [L]
    seen: Arc<Vec<Vector2<f64>>>,
    stride: usize,
    /// k/m of (3) at every node [1/T²]
    softness: Arc<Vec<f64>>,
    /// Segment of the projection of every contact point
    segments: Vec<Option<usize>>,
    /// Increments since the contacts were evaluated
    since: usize,
    /// Whether some elements were re-evaluated since
    relooked: bool,
    /// Relative motion of nodes below which an element counts as unchanged [L]
    margin: f64,
    /// Elements whose stiffness depends on a temperature or a pressure
    heated: Vec<usize>,
}

impl Stability {
    /// Evaluates all elements.
    pub(super) fn new(model: &Arc<Model>, step: &Step, state: &State) -> Result<Self, IncrementFailure> {
        let count = model.mesh.elements.len();
        let stride = model.mesh.elements.iter().map(|element| element.nodes.len()).max().unwrap_or(0);
        let mut stability = Self {
            model: model.clone(),
            retardation: model.retardations(step),
            elements: Arc::new(vec![Element { bounds: [0.0; 2], size: 0.0 }; count]),
            nodes: model.mesh.elements.iter().flat_map(|element| filled(&element.nodes, stride)).collect(),
            seen: Arc::new(vec![Vector2::zeros(); stride * count]),
            stride,
            softness: Arc::default(),
            segments: Vec::new(),
            since: 0,
            relooked: false,
            margin: 0.0,
            heated: heated(model),
        };
        let first = alike(model);
        let distinct: Vec<usize> = (0..count).filter(|&e| first[e] == e).collect();
        stability.look(&distinct, state)?;
        let elements = Arc::make_mut(&mut stability.elements);
        (0..count).for_each(|e| elements[e] = elements[first[e]]);
        Ok(stability)
    }

    /// Record an increment in which no two nodes move by more than `way` against each other.
    pub(super) fn moved(&mut self, way: f64) {
        self.margin -= way;
        self.since += 1;
    }

    /// Whether the contributions of contacts must be re-evaluated.
    pub(super) fn contacts_changed(&self, state: &State) -> bool {
        let stale = self.since > LOOK_AGAIN && (self.relooked || !self.model.contacts.is_empty());
        stale || segments(state).zip(&self.segments).any(|(now, seen)| now != *seen)
    }

    /// Elements that changed by more than [`CHANGED`] at the displacements `u`, and at intervals the heated ones.
    pub(super) fn changed(&mut self, u: &[f64]) -> Vec<usize> {
        let mut changed = self.deformed(u);
        if self.since > LOOK_AGAIN && !self.heated.is_empty() {
            changed.extend(&self.heated);
            changed.sort_unstable();
            changed.dedup();
        }
        self.relooked |= !changed.is_empty();
        changed
    }

    /// Elements deformed by the motion of their nodes; all are compared, unless none can have changed.
    fn deformed(&mut self, u: &[f64]) -> Vec<usize> {
        if self.margin >= 0.0 {
            return Vec::new();
        }
        let compare = |first: usize| {
            let (mut changed, mut margin) = (Vec::new(), f64::INFINITY);
            for e in first..(first + FEW).min(self.elements.len()) {
                let (change, size) = (self.change(e, u), self.elements[e].size);
                if change > CHANGED * size {
                    changed.push(e);
                } else {
                    margin = margin.min(LATEST * size - change);
                }
            }
            (changed, margin)
        };
        let parts = (0..self.elements.len().div_ceil(FEW)).into_par_iter().map(|part| compare(FEW * part));
        let (changed, margin) = parts.reduce(
            || (Vec::new(), f64::INFINITY),
            |(mut changed, margin), (more, other)| {
                changed.extend(more);
                (changed, margin.min(other))
            },
        );
        self.margin = margin;
        changed
    }

    /// Largest change of the elements re-evaluated last, at the displacements `u`, as a fraction of their size.
    pub(super) fn largest_change(&mut self, elements: &[usize], u: &[f64]) -> f64 {
        let mut largest = 0.0f64;
        for &e in elements {
            let (change, size) = (self.change(e, u), self.elements[e].size);
            largest = largest.max(change / size);
            self.margin = self.margin.min(LATEST * size - change);
        }
        largest
    }

    /// Largest motion of an element's nodes relative to its first since its last check [L].
    fn change(&self, e: usize, u: &[f64]) -> f64 {
        let places = self.stride * e..self.stride * (e + 1);
        let (nodes, seen) = (&self.nodes[places.clone()], &self.seen[places]);
        let first = vector(u, nodes[0]);
        let square = |(node, seen): (&usize, &Vector2<f64>)| (vector(u, *node) - first - seen).norm_squared();
        nodes.iter().zip(seen).map(square).fold(0.0, f64::max).sqrt()
    }

    /// Re-evaluates some elements.
    pub(super) fn look(&mut self, elements: &[usize], state: &State) -> Result<(), IncrementFailure> {
        if elements.is_empty() {
            return Ok(());
        }
        let (model, retardation, u) = (&self.model, &self.retardation, &state.displacement);
        let look = |&e: &usize| {
            let memory = model.memories.of(e, &state.memory);
            Element::at(model, retardation[model.body_of_element[e]], e, u, memory)
        };
        let found: Vec<Result<Element, TrialFailure>> = elements.par_iter().with_min_len(64).map(look).collect();
        let (own, seen) = (Arc::make_mut(&mut self.elements), Arc::make_mut(&mut self.seen));
        for (&e, element) in elements.iter().zip(found) {
            own[e] = element.map_err(IncrementFailure::Start)?;
            let places = self.stride * e..self.stride * (e + 1);
            let first = vector(u, self.nodes[places.start]);
            for (seen, &node) in seen[places.clone()].iter_mut().zip(&self.nodes[places]) {
                *seen = vector(u, node) - first;
            }
        }
        Ok(())
    }

    /// (1) or (4) with the masses of the nodes, after an evaluation of all contacts [T].
    pub(super) fn longest_increment(&mut self, step: &Step, mass: &[f64], state: &State) -> f64 {
        self.segments.clear();
        self.segments.extend(segments(state));
        (self.since, self.relooked) = (0, false);
        self.add_stiffness(step, mass, state);
        let softness = Arc::make_mut(&mut self.softness).iter_mut().zip(mass);
        softness.for_each(|(added, mass)| *added = if *mass > 0.0 { *added / mass } else { 0.0 });
        let lone = self.softness.iter().map(|softness| longest(*softness, 0.0)).fold(f64::INFINITY, f64::min);
        self.longest_of(0..self.elements.len()).min(lone)
    }

    /// (1) or (4) of some elements, with the contributions of contacts as last evaluated [T].
    pub(super) fn longest_of(&self, elements: impl Iterator<Item = usize>) -> f64 {
        let of_element = |e: usize| {
            let [elastic, viscous] = self.elements[e].bounds;
            let nodes = self.model.mesh.elements[e].nodes.iter();
            longest(elastic + nodes.map(|&node| self.softness[node]).fold(0.0, f64::max), viscous)
        };
        elements.map(of_element).fold(f64::INFINITY, f64::min)
    }

    /// Writes k of (3) at every node divided by its softness [F/L].
    fn add_stiffness(&mut self, step: &Step, mass: &[f64], state: &State) {
        let Self { model, softness: added, .. } = self;
        let x = model.configuration(&state.displacement);
        let added = Arc::make_mut(added);
        added.clear();
        added.resize(model.mesh.nodes.len(), 0.0);
        for (pair, states) in model.contacts.iter().zip(&state.contacts) {
            for (slave, state) in pair.points.iter().zip(states) {
                let Some(master_point) = state.master_point else { continue };
                let stiffness = pair.stiffest(slave) * slave.current_length(&x);
                let faced = match &pair.master {
                    Master::Mesh(surface) => surface.segments[master_point.segment].position(master_point.xi),
                    Master::Rigid(rigid) => rigid_weights(rigid.body.as_ref(), slave, mass, &x),
                };
                let weights = || slave.position.iter().chain(&faced);
                let total: f64 = weights().map(|(_, w)| w.abs()).sum();
                weights().for_each(|(node, w)| added[*node] += stiffness * w.abs() * total);
            }
        }
        let there = model.bars.iter().enumerate().filter(|(bar, _)| step.bars.has(*bar));
        there.for_each(|(_, bar)| bar.bounds(|node, stiffness| added[node] += stiffness));
        step.loads.springs.iter().for_each(|spring| added[spring.dof / 2] += spring.stiffness);
        model.ties.gather(1, added);
        model.ties.spread(1, added);
    }
}

/// Displacement of a contact point per displacement of the nodes of a rigid body with mass; zero if its motion is prescribed.
fn rigid_weights(body: Option<&RigidBody>, slave: &SlavePoint, mass: &[f64], x: &Configuration) -> SegmentWeights {
    let Some(body) = body else { return SegmentWeights::default() };
    let lever = (slave.at(x) - x.at(body.reference)).norm() / body.radius;
    let weights = [(body.reference, 1.0), (body.turning, lever)];
    weights.into_iter().filter(|(node, _)| mass[*node] > 0.0).collect()
}

/// Elements of bodies whose stiffness changes without their shape: with thermal expansion, unless their law is linear, and with stiffness
/// from pressure.
fn heated(model: &Model) -> Vec<usize> {
    let heated = |body: &Body| body.thermal.is_some() && !body.material.description().is_linear;
    let bodies = model.bodies.iter().filter(|body| heated(body) || body.material.at_pressure(0.0).is_some());
    bodies.flat_map(|body| body.elements.iter().copied()).collect()
}

/// Nodes of an element, padded with its first node to `stride` entries.
fn filled(nodes: &[usize], stride: usize) -> impl Iterator<Item = usize> {
    let first = nodes.iter().take(1).cycle();
    nodes.iter().chain(first).take(stride).copied()
}

/// Segment of the projection of every contact point; `None` without a projection.
fn segments(state: &State) -> impl Iterator<Item = Option<usize>> {
    state.contacts.iter().flatten().map(|contact| contact.master_point.map(|master_point| master_point.segment))
}

/// (4) from ω² and c [T].
fn longest(square: f64, viscous: f64) -> f64 {
    4.0 / (viscous + (viscous * viscous + 4.0 * square).sqrt())
}

/// Fraction of its size to which an element may be compressed; beyond it increments would shorten without limit.
const CRUSHED: f64 = 1e-3;

/// One element as last evaluated.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Element {
    /// λ_e and c [1/T², 1/T]
    bounds: [f64; 2],
    /// Area over diagonal; infinite for a linear law, whose bounds do not depend on the displacement [L]
    size: f64,
}

impl Element {
    /// Evaluates an element at the displacement `u`, with the internal variables of its material if strain is imposed on it.
    pub(super) fn at(
        model: &Model,
        retardation: f64,
        e: usize,
        u: &[f64],
        memory: &[f64],
    ) -> Result<Self, TrialFailure> {
        let body = &model.bodies[model.body_of_element[e]];
        let local = model.mesh.vectors(e, u);
        let size = if body.material.description().is_linear { f64::INFINITY } else { size(model, e, &local) };
        let undeformed = size_at_rest(model, e);
        if size < CRUSHED * undeformed {
            return Err(TrialFailure::crushed(model, e, size / undeformed));
        }
        let trapped = model.flow.as_ref().and_then(|flow| flow.wet(e)).map(|wet| trapped(wet, u)).transpose();
        let trapped = trapped.map_err(|failure| TrialFailure::material(model, e, failure))?;
        Ok(Self { bounds: bounds(model, retardation, e, &local, memory, trapped)?, size })
    }
}

fn size_at_rest(model: &Model, e: usize) -> f64 {
    size(model, e, &vec![Vector2::zeros(); model.mesh.elements[e].nodes.len()])
}

/// Area of the polygon of an element's corners over its longest diagonal or side, at nodal displacements [L].
fn size(model: &Model, e: usize, u: &[Vector2<f64>]) -> f64 {
    let element = &model.mesh.elements[e];
    let corners = element.kind.corners();
    let place = |a: usize| model.mesh.nodes[element.nodes[a]] - model.mesh.nodes[element.nodes[0]] + (u[a] - u[0]);
    let places: Vec<Vector2<f64>> = (0..corners).map(place).collect();
    let area: f64 = (0..corners).map(|a| 0.5 * places[a].perp(&places[(a + 1) % corners])).sum();
    let pairs = (0..corners).flat_map(|a| (0..a).map(move |b| (a, b)));
    area.abs() / pairs.map(|(a, b)| (places[a] - places[b]).norm()).fold(f64::MIN_POSITIVE, f64::max)
}

/// λ_e and c of an element at nodal displacements, internal variables of its material and the stiffness of trapped water [1/T², 1/T].
fn bounds(
    model: &Model,
    retardation: f64,
    e: usize,
    local: &[Vector2<f64>],
    memory: &[f64],
    trapped: Option<DMatrix<f64>>,
) -> Result<[f64; 2], TrialFailure> {
    let body = &model.bodies[model.body_of_element[e]];
    let n = 2 * local.len();
    let (mut force, mut tangent) = (vec![0.0; n], DMatrix::zeros(n, n));
    let (solid, law) = (&model.solids[e], &*body.material);
    let answer = match law.description().variables.is_empty() {
        true => solid.force_and_tangent(law, local, &mut force, tangent.as_mut_slice()).map(drop),
        // What is imposed stiffens, and what has yielded is another body.
        false => {
            let memory = Memory { dt: 0.0, old: memory, new: &mut memory.to_vec() };
            solid.evolve(law, memory, local, &mut force, Some(tangent.as_mut_slice())).map(drop)
        }
    };
    answer.map_err(|failure| TrialFailure::material(model, e, failure))?;
    let mass = model.element_lumped_mass(e);
    trapped.into_iter().for_each(|trapped| tangent += trapped);
    let elastic = largest_eigenvalue(&tangent, &mass);
    if retardation == 0.0 {
        return Ok([elastic, 0.0]);
    }
    // The viscous tangent at zero displacement increment is the derivative with respect to the velocities.
    let still = vec![Vector2::zeros(); local.len()];
    model.solids[e].viscous_tangent(law, retardation, [local, &still], &vec![1.0; n], tangent.as_mut_slice());
    Ok([elastic, largest_eigenvalue(&tangent, &mass)])
}

/// The bound (2) of a matrix and the lumped masses of its nodes.
fn largest_eigenvalue(matrix: &DMatrix<f64>, mass: &DVector<f64>) -> f64 {
    let n = matrix.nrows();
    let root = mass.map(|mass| mass.sqrt().recip());
    let scaled = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] * root[i / 2] * root[j / 2]);
    let largest = scaled.amax();
    if largest == 0.0 {
        return 0.0;
    }
    largest * squared(&squared(&(scaled / largest))).norm().powf(0.25)
}

/// The square of a matrix of an element: too small for a general product of matrices, which divides them into blocks.
fn squared(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let n = matrix.nrows();
    let mut square = DMatrix::zeros(n, n);
    let columns = matrix.as_slice().chunks_exact(n);
    for (sum, factors) in square.as_mut_slice().chunks_exact_mut(n).zip(columns.clone()) {
        for (column, factor) in columns.clone().zip(factors) {
            sum.iter_mut().zip(column).for_each(|(sum, entry)| *sum += factor * entry);
        }
    }
    square
}

/// For each element, the first element of a linear body with bitwise the same shape and masses, and therefore the same bounds
/// at any displacement; the element itself if its law is not linear.
fn alike(model: &Model) -> Vec<usize> {
    let mut seen = HashMap::new();
    let first = |e: usize| {
        let (body, solid) = (model.body_of_element[e], &model.solids[e]);
        if !model.bodies[body].material.description().is_linear || solid.is_f_bar() {
            return e;
        }
        let mass = model.element_lumped_mass(e);
        let (first, like) = seen.entry((body, solid.volume().to_bits())).or_insert_with(|| (e, mass.clone()));
        if *solid == model.solids[*first] && mass == *like { *first } else { e }
    };
    (0..model.solids.len()).map(first).collect()
}

/// Stored memory of explicit increments.
#[derive(Serialize, Deserialize)]
pub struct ExplicitMemory {
    care: f64,
    stable: f64,
    elements: Vec<Element>,
    seen: Vec<[f64; 2]>,
    softness: Vec<f64>,
    segments: Vec<Option<usize>>,
    since: usize,
    relooked: bool,
    margin: f64,
}

impl ExplicitMemory {
    /// Whether it belongs to this model.
    pub fn fits(&self, model: &Model) -> bool {
        let elements = model.mesh.elements.len();
        let points: usize = model.contacts.iter().map(|pair| pair.points.len()).sum();
        self.elements.len() == elements
            && self.seen.len() == elements * stride(model)
            && self.softness.len() == model.mesh.nodes.len()
            && self.segments.len() == points
    }
}

impl Explicit {
    /// Returns the memory for a checkpoint.
    pub fn memory(&self) -> ExplicitMemory {
        let Stability { elements, seen, softness, segments, since, relooked, margin, .. } = &self.stability;
        let seen = seen.iter().map(|&seen| seen.into()).collect();
        let (elements, softness) = (elements.to_vec(), softness.to_vec());
        let (segments, since, relooked, margin) = (segments.clone(), *since, *relooked, *margin);
        let (care, stable) = (self.care, self.stable);
        ExplicitMemory { care, stable, elements, seen, softness, segments, since, relooked, margin }
    }

    /// Resumes from a stored memory.
    pub fn again(model: &Arc<Model>, step: &Arc<Step>, memory: ExplicitMemory) -> Self {
        let ExplicitMemory { care, stable, elements, seen, softness, segments, since, relooked, margin } = memory;
        let stride = stride(model);
        let stability = Stability {
            model: model.clone(),
            retardation: model.retardations(step),
            elements: Arc::new(elements),
            nodes: model.mesh.elements.iter().flat_map(|element| filled(&element.nodes, stride)).collect(),
            seen: Arc::new(seen.into_iter().map(Vector2::from).collect()),
            stride,
            softness: Arc::new(softness),
            segments,
            since,
            relooked,
            margin,
            heated: heated(model),
        };
        Self { stable, ..Self::of(model, step, stability, care) }
    }
}

/// Largest number of nodes of an element.
fn stride(model: &Model) -> usize {
    model.mesh.elements.iter().map(|element| element.nodes.len()).max().unwrap_or(0)
}
