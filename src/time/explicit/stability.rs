//! The longest stable increment, (1) to (4) of [`super`], and when it has to be found again.
//!
//! An element has its own bound until its shape has changed: a node moved, against its first one, by more than the share
//! [`CHANGED`] of the element's size, which is its area over its diagonal. That is told before the increment in which it
//! happens, from the displacements at its end, which are known. All elements are compared as soon as nodes may have moved
//! so far against each other that one has changed by [`LATEST`]. What contacts add is found again when a point meets another segment.

use std::sync::Arc;

use nalgebra::Vector2;
use rayon::prelude::*;

use super::alike::alike;
use super::element::Element;
use crate::contact::master::Master;
use crate::contact::surface::SegmentWeights;
use crate::equations::sums::TrialFailure;
use crate::model::state::State;
use crate::model::{Model, Step};
use crate::solve::failure::IncrementFailure;

/// Share of its size by which an element may change before it is looked at again: its bound is exact to about as much.
const CHANGED: f64 = 0.04;

/// Share of its size by which an element may have changed before it is compared.
const LATEST: f64 = 0.06;

/// Increments after which what contacts and springs add is looked at in any case.
const LOOK_AGAIN: usize = 200;

/// Elements that are compared sooner than another thread wakes up.
const FEW: usize = 2048;

/// What bounds the increment, as last looked at.
#[derive(Clone)]
pub(super) struct Stability {
    pub(super) model: Arc<Model>,
    pub(super) retardation: Vec<f64>,
    pub(super) elements: Vec<Element>,
    /// Nodes of the elements, `stride` places an element, filled up with the first one
    pub(super) nodes: Vec<usize>,
    /// Their displacements against the first one when the element was looked at [L]
    pub(super) seen: Vec<Vector2<f64>>,
    pub(super) stride: usize,
    /// k/m of (3) at every node [1/T²]
    pub(super) softness: Vec<f64>,
    /// Segment that every contact point met
    pub(super) segments: Vec<Option<usize>>,
    /// Increments since contacts were looked at
    pub(super) since: usize,
    /// Whether some elements were looked at again since
    pub(super) relooked: bool,
    /// How far nodes may move against each other until an element may have changed [L]
    pub(super) margin: f64,
    /// Elements whose stiffness depends on a temperature
    pub(super) heated: Vec<usize>,
}

impl Stability {
    /// Look at all elements.
    pub(super) fn new(model: &Arc<Model>, step: &Step, state: &State) -> Result<Self, IncrementFailure> {
        let count = model.mesh.elements.len();
        let stride = model.mesh.elements.iter().map(|element| element.nodes.len()).max().unwrap_or(0);
        let mut stability = Self {
            model: model.clone(),
            retardation: model.retardations(step),
            elements: vec![Element { bounds: [0.0; 2], size: 0.0 }; count],
            nodes: model.mesh.elements.iter().flat_map(|element| filled(&element.nodes, stride)).collect(),
            seen: vec![Vector2::zeros(); stride * count],
            stride,
            softness: Vec::new(),
            segments: Vec::new(),
            since: 0,
            relooked: false,
            margin: 0.0,
            heated: heated(model),
        };
        let first = alike(model);
        let distinct: Vec<usize> = (0..count).filter(|&e| first[e] == e).collect();
        stability.look(&distinct, state)?;
        (0..count).for_each(|e| stability.elements[e] = stability.elements[first[e]]);
        Ok(stability)
    }

    /// Take note of an increment in which no two nodes move by more than `way` against each other.
    pub(super) fn moved(&mut self, way: f64) {
        self.margin -= way;
        self.since += 1;
    }

    /// Whether what contacts add must be looked at again.
    pub(super) fn contacts_changed(&self, state: &State) -> bool {
        let stale = self.since > LOOK_AGAIN && (self.relooked || !self.model.contacts.is_empty());
        stale || segments(state).zip(&self.segments).any(|(now, seen)| now != *seen)
    }

    /// Elements that changed by more than [`CHANGED`] at the displacements `u`, and now and then those that may be heated.
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

    /// Elements that changed by their nodes' motion; all are compared, unless none can have.
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

    /// The largest change of elements that were just looked at again, at the displacements `u`, as a share of their size.
    pub(super) fn largest_change(&mut self, elements: &[usize], u: &[f64]) -> f64 {
        let mut largest = 0.0f64;
        for &e in elements {
            let (change, size) = (self.change(e, u), self.elements[e].size);
            largest = largest.max(change / size);
            self.margin = self.margin.min(LATEST * size - change);
        }
        largest
    }

    /// How far the nodes of an element have moved against its first one since it was looked at [L].
    fn change(&self, e: usize, u: &[f64]) -> f64 {
        let places = self.stride * e..self.stride * (e + 1);
        let (nodes, seen) = (&self.nodes[places.clone()], &self.seen[places]);
        let of = |node: usize| Vector2::new(u[2 * node], u[2 * node + 1]);
        let first = of(nodes[0]);
        let square = |(node, seen): (&usize, &Vector2<f64>)| (of(*node) - first - seen).norm_squared();
        nodes.iter().zip(seen).map(square).fold(0.0, f64::max).sqrt()
    }

    /// Look at some elements again.
    pub(super) fn look(&mut self, elements: &[usize], state: &State) -> Result<(), IncrementFailure> {
        let (model, retardation, u) = (&self.model, &self.retardation, &state.displacement);
        let look = |&e: &usize| {
            let memory = model.memories.of(e, &state.memory);
            Element::at(model, retardation[model.body_of_element[e]], e, (u, memory))
        };
        let found: Vec<Result<Element, TrialFailure>> = elements.par_iter().with_min_len(64).map(look).collect();
        for (&e, element) in elements.iter().zip(found) {
            self.elements[e] = element.map_err(IncrementFailure::Start)?;
            let places = self.stride * e..self.stride * (e + 1);
            let of = |node: usize| Vector2::new(u[2 * node], u[2 * node + 1]);
            let first = of(self.nodes[places.start]);
            for (seen, &node) in self.seen[places.clone()].iter_mut().zip(&self.nodes[places]) {
                *seen = of(node) - first;
            }
        }
        Ok(())
    }

    /// (1) or (4), with the masses of the nodes, after a look at all contacts [T].
    pub(super) fn longest_increment(&mut self, step: &Step, mass: &[f64], state: &State) -> f64 {
        self.segments.clear();
        self.segments.extend(segments(state));
        (self.since, self.relooked) = (0, false);
        self.add_stiffness(step, state);
        let softness = self.softness.iter_mut().zip(mass);
        softness.for_each(|(added, mass)| *added = if *mass > 0.0 { *added / mass } else { 0.0 });
        let lone = self.softness.iter().map(|softness| longest(*softness, 0.0)).fold(f64::INFINITY, f64::min);
        self.longest_of(0..self.elements.len()).min(lone)
    }

    /// (1) or (4) of some elements, with what contacts add as last looked at [T].
    pub(super) fn longest_of(&self, elements: impl Iterator<Item = usize>) -> f64 {
        let of_element = |e: usize| {
            let [elastic, viscous] = self.elements[e].bounds;
            let nodes = self.model.mesh.elements[e].nodes.iter();
            longest(elastic + nodes.map(|&node| self.softness[node]).fold(0.0, f64::max), viscous)
        };
        elements.map(of_element).fold(f64::INFINITY, f64::min)
    }

    /// Write k of (3) at every node over its softness [F/L].
    fn add_stiffness(&mut self, step: &Step, state: &State) {
        let Self { model, softness: added, .. } = self;
        let x = model.configuration(&state.displacement);
        added.clear();
        added.resize(model.mesh.nodes.len(), 0.0);
        for (pair, states) in model.contacts.iter().zip(&state.contacts) {
            for (slave, state) in pair.points.iter().zip(states) {
                let Some(foot) = state.foot else { continue };
                let stiffness = pair.stiffest(slave) * slave.current_length(&x);
                let faced = match &pair.master {
                    Master::Mesh(surface) => surface.segments[foot.segment].position(foot.xi),
                    Master::Rigid(_) => SegmentWeights::default(),
                };
                let weights = || slave.position.iter().chain(&faced);
                let total: f64 = weights().map(|(_, w)| w.abs()).sum();
                weights().for_each(|(node, w)| added[*node] += stiffness * w.abs() * total);
            }
        }
        step.loads.springs.iter().for_each(|spring| added[spring.dof / 2] += spring.stiffness);
        model.ties.gather(1, added);
        model.ties.spread(1, added);
    }
}

/// Elements of bodies that expand when they are heated; those of a linear law are as stiff as before.
pub(super) fn heated(model: &Model) -> Vec<usize> {
    let bodies = model.bodies.iter().filter(|body| body.thermal.is_some() && !body.material.is_linear());
    bodies.flat_map(|body| body.elements.iter().copied()).collect()
}

/// The nodes of an element and as often the first one as it takes to fill `stride` places.
pub(super) fn filled(nodes: &[usize], stride: usize) -> impl Iterator<Item = usize> {
    let first = nodes.iter().take(1).cycle();
    nodes.iter().chain(first).take(stride).copied()
}

/// Segment that every contact point meets; `None` where it faces no master.
fn segments(state: &State) -> impl Iterator<Item = Option<usize>> {
    state.contacts.iter().flatten().map(|contact| contact.foot.map(|foot| foot.segment))
}

/// (4) from ω² and c [T].
fn longest(square: f64, viscous: f64) -> f64 {
    4.0 / (viscous + (viscous * viscous + 4.0 * square).sqrt())
}
