//! Convergence criterion: equilibrium of each body and each contact, measured relative to its own forces.
//!
//! ```text
//! ‖r‖ ≤ max(tolerance ‖f‖, ‖ρ‖)                                                                              (1)
//! over the free dofs of         f: magnitudes, summed without sign, of
//!   every body                  all forces on its nodes
//!   both sides of a contact     the forces of that contact alone
//!   every node of no body       all forces on it
//! |u − ū| ≤ max(tolerance max |ū − u₀|, ε max |ū|)        prescribed dofs                                     (2)
//! ```
//!
//! One norm of the whole model would let a stiff body hide the residual of a soft one. ρ is the possible round-off at a node:
//! that of strains in every adjacent element, ε C h, and of the displacements, ε C |u|, with C = λ + 2G; at a closed
//! contact point ε α_n ℓ (h + |u|), with α_n in place of C and the tributary length ℓ; likewise in springs, and in rates,
//! which are differences of displacements over Δt. The distance of a model from the origin does not enter: positions are only
//! subtracted from each other.

use super::pore_flow;
use super::trial::Trial;
use super::{bars, links, supports};
use crate::contact::response::PairResponse;
use crate::contact::{ContactPair, ContactState};
use crate::linear::SparseMatrix;
use crate::mesh::configuration::Configuration;
use crate::model::boundary::Absorber;
use crate::model::coupled::{CoupledPart, CoupledParts};
use crate::model::pore_flow::PoreFlow;
use crate::model::{Body, Damping, Model, State, Step};

/// Error of a force in units of ε: every element adds a few to each node.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// The same for rates, as a fraction of it: they are exact differences of displacements, each known to ε of its size.
/// Oscillations of small amplitude far from the start exceed this, and must not be taken for round-off.
const RATES: f64 = 0.25;

/// Upper bound of displacements relevant for round-off, in multiples of the size and motion of what acts on the node: a larger
/// iterate has diverged and must not count as inaccurate.
const LOST: f64 = 10.0;

/// Part of the model whose equilibrium is checked separately.
#[derive(Clone, Debug)]
struct BalancedSet {
    nodes: Vec<usize>,
    /// Number of the contact whose forces are the reference; `None` for all forces
    contact: Option<usize>,
}

impl BalancedSet {
    /// Norm of nodal vectors
    fn norm(&self, values: &[f64]) -> f64 {
        self.nodes.iter().map(|&node| square(values, node)).sum::<f64>().sqrt()
    }

    /// ‖ρ‖ from ρ² of every node [F]
    fn hidden(&self, round_off: &[f64]) -> f64 {
        self.nodes.iter().map(|&node| round_off[node]).sum::<f64>().sqrt()
    }
}

/// Parts of a model, and the possible round-off at their nodes.
#[derive(Clone, Debug)]
pub(super) struct ConvergenceCriterion {
    parts: Vec<BalancedSet>,
    /// Σ (C h)², Σ C² and Σ (τ C)² of the elements at each node
    stiffness: Vec<[f64; 3]>,
    /// damping of the bodies for which these hold
    dampings: Vec<Damping>,
    /// Lengths of the edges of each contact
    edges: Vec<ContactEdges>,
    /// Parts of the model that act on each other
    coupled: CoupledParts,
    /// Norm of each contact's nodal forces at the last evaluation [F]
    contact_forces: Vec<f64>,
    /// Σ (α_n ℓ)² (1, h²) of the closed contact points at each node at the last evaluation
    contact_stiffness: Vec<[f64; 2]>,
    /// Magnitudes of one contact's forces, otherwise zero
    own: Vec<f64>,
}

impl ConvergenceCriterion {
    /// That of the bodies that are there.
    pub(super) fn new(model: &Model, is_there: impl Fn(usize) -> bool, step: Option<&Step>) -> Self {
        let count = model.mesh.nodes.len();
        let mut stiffness = vec![[0.0; 3]; count];
        let mut lone = vec![true; count];
        for (e, element) in model.mesh.elements.iter().enumerate() {
            if !is_there(model.body_of_element[e]) {
                element.nodes.iter().for_each(|&node| lone[node] = false);
                continue;
            }
            let body = &model.bodies[model.body_of_element[e]];
            let [solid, depth] = [model.solids[e].volume(), model.solids[e].mean_weight()];
            let modulus = body.material.description().p_wave_modulus * depth;
            let viscous = body.damping.retardation * modulus;
            for &node in &element.nodes {
                lone[node] = false;
                let node = model.ties.original(node);
                stiffness[node][0] += modulus * modulus * (solid / depth);
                stiffness[node][1] += modulus * modulus;
                stiffness[node][2] += viscous * viscous;
            }
        }
        let wet = model.flow.iter().flat_map(|flow| &flow.elements);
        for wet in wet.filter(|wet| is_there(model.body_of_element[wet.element])) {
            let [solid, depth] = [model.solids[wet.element].volume(), model.solids[wet.element].mean_weight()];
            let modulus = model.body_of(wet.element).material.description().p_wave_modulus * depth;
            for &node in &wet.nodes[wet.in_mesh..] {
                lone[node] = false;
                stiffness[node][0] += modulus * modulus * (solid / depth);
                stiffness[node][1] += modulus * modulus;
            }
        }
        let channels = model.flow.iter().flat_map(|flow| flow.channels.values().flatten().map(|(_, &k)| flow.node(k)));
        channels.for_each(|node| lone[node] = false);
        bars::stiffness(model, step, |node, [strained, moved]| {
            let node = model.ties.original(node);
            stiffness[node][0] += strained;
            stiffness[node][1] += moved;
        });
        bars::own_nodes(model).flatten().for_each(|&node| lone[node] = false);
        let bars = bars::own_nodes(model).map(|own| BalancedSet { nodes: own.clone(), contact: None });
        let of_body =
            |body: &Body| BalancedSet { nodes: model.ties.originals(body.nodes.iter().copied()), contact: None };
        let of_flow = |flow: &PoreFlow| BalancedSet { nodes: flow.nodes().collect(), contact: None };
        let water = model.flow.iter().map(of_flow);
        let there = model.bodies.iter().enumerate().filter(|(body, _)| is_there(*body));
        let bodies = there.map(|(_, body)| of_body(body));
        let of_contact = |(k, pair): (usize, &ContactPair)| BalancedSet {
            nodes: model.ties.originals(pair.nodes()),
            contact: Some(k),
        };
        let surfaces = model.contacts.iter().enumerate().map(of_contact);
        let lone = (0..count).filter(|&node| lone[node]).map(|node| BalancedSet { nodes: vec![node], contact: None });
        Self {
            parts: bodies.chain(water).chain(bars).chain(surfaces).chain(lone).collect(),
            stiffness,
            dampings: model.bodies.iter().map(|body| body.damping).collect(),
            edges: model.contacts.iter().map(|pair| ContactEdges::of(pair, &model.mesh.undeformed())).collect(),
            coupled: CoupledParts::of(model),
            contact_forces: vec![0.0; model.contacts.len()],
            contact_stiffness: vec![[0.0; 2]; count],
            own: vec![0.0; 2 * count],
        }
    }

    /// Sets the viscous stress of the bodies in a step.
    pub(super) fn retard(&mut self, model: &Model, step: &Step) {
        let dampings = model.dampings(step);
        if self.dampings == dampings {
            return;
        }
        self.stiffness.iter_mut().for_each(|[.., viscous]| *viscous = 0.0);
        for (e, element) in model.mesh.elements.iter().enumerate() {
            let body = model.body_of_element[e];
            let modulus = model.bodies[body].material.description().p_wave_modulus * model.solids[e].mean_weight();
            let viscous = dampings[body].retardation * modulus;
            let originals = element.nodes.iter().map(|&node| model.ties.original(node));
            originals.for_each(|node| self.stiffness[node][2] += viscous * viscous);
        }
        self.dampings = dampings;
    }

    /// Stores the magnitude of the forces of every contact, and its stiffness.
    pub(super) fn note_contacts(&mut self, model: &Model, stiffening: f64, responses: &[PairResponse]) {
        self.contact_stiffness.fill([0.0; 2]);
        for (k, (pair, responses)) in model.contacts.iter().zip(responses).enumerate() {
            let alpha_n = pair.normal_stiffness(stiffening);
            for (point, (state, closed)) in responses.numbered() {
                let edge = self.edges[k].at(point, state);
                let stiffness = if closed.is_open && !closed.is_bonded { 0.0 } else { alpha_n };
                let squared = (stiffness * state.length).powi(2);
                for (a, &node) in closed.nodes.iter().enumerate() {
                    // A node behind the surface has a part in friction, but bears no force of it; one that stands for pressures bears none at all.
                    if model.flow.as_ref().is_some_and(|flow| node >= flow.first)
                        || closed.force[2 * a..2 * a + 2] == [0.0; 2]
                    {
                        continue;
                    }
                    let original = model.ties.original(node);
                    self.contact_stiffness[original][0] += squared * edge.powi(2);
                    self.contact_stiffness[original][1] += squared;
                    (0..2).for_each(|i| self.own[2 * original + i] += closed.force[2 * a + i].abs());
                }
            }
            let mut sum = 0.0;
            for (_, closed) in responses.all_acting() {
                for &node in closed.nodes {
                    let original = model.ties.original(node);
                    for dof in [2 * original, 2 * original + 1] {
                        sum += std::mem::take(&mut self.own[dof]).powi(2);
                    }
                }
            }
            self.contact_forces[k] = sum.sqrt();
        }
    }
}

impl ConvergenceCriterion {
    /// Returns the largest relative residual of a part, (1) and (2).
    pub(super) fn imbalance(
        &self,
        model: &Model,
        mass: Option<&SparseMatrix>,
        trial: Trial,
        u: &[f64],
        magnitudes: &[f64],
        residual: &[f64],
    ) -> f64 {
        let tolerance = model.newton.tolerance;
        let mut round_off = None;
        let measure = |number: usize, residual: f64| {
            let forces = self.forces(&self.parts[number], magnitudes);
            if residual <= tolerance * forces {
                return forces;
            }
            let round_off = round_off.get_or_insert_with(|| self.round_off(model, mass, trial, u, magnitudes));
            forces.max(self.parts[number].hidden(round_off) / tolerance)
        };
        self.largest(model, trial.step, residual, measure).max(missed(model, trial, u))
    }

    /// max(‖f‖, ‖ρ‖/tolerance) of every part, for residuals that differ little from the one last evaluated [F].
    pub(super) fn measures(
        &self,
        model: &Model,
        mass: Option<&SparseMatrix>,
        trial: Trial,
        u: &[f64],
        magnitudes: &[f64],
        tolerance: f64,
    ) -> Vec<f64> {
        let round_off = self.round_off(model, mass, trial, u, magnitudes);
        let of = |part: &BalancedSet| self.forces(part, magnitudes).max(part.hidden(&round_off) / tolerance);
        self.parts.iter().map(of).collect()
    }

    /// Returns the largest residual of a part relative to its measure, a function of its number and its residual, (1).
    pub(super) fn largest(
        &self,
        model: &Model,
        step: &Step,
        residual: &[f64],
        mut measure: impl FnMut(usize, f64) -> f64,
    ) -> f64 {
        let free = supports::free(model, step, residual);
        let share = |(number, part): (usize, &BalancedSet)| {
            let residual = part.norm(&free);
            if residual == 0.0 { 0.0 } else { residual / measure(number, residual) }
        };
        // NaN is not an equilibrium.
        let worse = |most: f64, share: f64| if share.is_nan() { f64::INFINITY } else { most.max(share) };
        self.parts.iter().enumerate().map(share).fold(0.0, worse)
    }

    /// ‖f‖ of a part [F]
    fn forces(&self, part: &BalancedSet, magnitudes: &[f64]) -> f64 {
        part.contact.map_or_else(|| part.norm(magnitudes), |k| self.contact_forces[k])
    }

    /// Norm of the nodal forces of each contact at the last evaluation [F].
    pub(super) fn contact_forces(&self) -> &[f64] {
        &self.contact_forces
    }

    /// Largest displacement of each coupled part that is relevant for round-off; no solution lies beyond it [L].
    fn farthest(&self, old: &State) -> Vec<f64> {
        let moved = |part: &CoupledPart| {
            let u = part.nodes.iter().flat_map(|nodes| &old.displacement[2 * nodes.start..2 * nodes.end]);
            u.fold(0.0, |most: f64, u| most.max(u.abs()))
        };
        self.coupled.parts.iter().map(|part| LOST * (part.size + moved(part))).collect()
    }

    /// |u|² of some nodes, as far as relevant [L²].
    pub(super) fn ways(&self, old: &State, u: &[f64], nodes: &[usize]) -> Vec<f64> {
        let farthest = self.farthest(old);
        nodes.iter().map(|&node| square(u, node).min(farthest[self.coupled.of_node[node]].powi(2))).collect()
    }

    /// Contribution of the contacts last noted to ρ², at nodes with these [`ways`](Self::ways) [F²].
    pub(super) fn contact_round_off(&self, nodes: &[usize], ways: &[f64]) -> f64 {
        let of = |(&node, way): (&usize, &f64)| {
            let [normal, tangential] = self.contact_stiffness[node];
            normal + tangential * way
        };
        ROUND_OFF * ROUND_OFF * nodes.iter().zip(ways).map(of).sum::<f64>()
    }

    /// ρ² at every node [F²].
    pub(super) fn round_off(
        &self,
        model: &Model,
        mass: Option<&SparseMatrix>,
        trial: Trial,
        u: &[f64],
        magnitudes: &[f64],
    ) -> Vec<f64> {
        let Trial { old, step, .. } = trial;
        let stiffness = &self.stiffness;
        let of_part = self.farthest(old);
        let farthest = |node: usize| of_part[self.coupled.of_node[node]];
        let nodes = 0..model.mesh.nodes.len();
        let mut squares: Vec<f64> = nodes
            .map(|node| {
                let [strained, moved, _] = stiffness[node];
                let [normal, tangential] = self.contact_stiffness[node];
                let way = square(u, node).min(farthest(node).powi(2));
                strained + normal + (moved + tangential) * way + square(magnitudes, node)
            })
            .collect();
        for spring in &step.loads.springs {
            let node = spring.dof / 2;
            squares[node] += (spring.stiffness * u[spring.dof].abs().min(farthest(node))).powi(2);
        }
        for (dof, force) in pore_flow::prescribed(model, trial, u) {
            squares[dof / 2] += force * force;
        }
        let of_dof = |(dof, u): (usize, &f64)| RATES * (u.abs() + trial.way(dof, false).abs());
        let way: Vec<f64> = old.displacement.iter().enumerate().map(of_dof).collect();
        let scheme = trial.integration();
        if let (Some(scheme), Some(mass)) = (scheme, mass) {
            let [inertia] = mass.multiply_symmetric([&way]);
            let (dacceleration, dvelocity) = (scheme.dacceleration(), scheme.dvelocity());
            for (node, squared) in squares.iter_mut().enumerate() {
                *squared += square(&inertia, node) * dacceleration.powi(2);
                *squared += stiffness[node][2] * square(&way, node) * dvelocity.powi(2);
            }
        }
        let dvelocity = trial.dvelocity();
        for dashpot in &step.loads.dashpots {
            squares[dashpot.dof / 2] += (dashpot.coefficient * dvelocity * way[dashpot.dof]).powi(2);
        }
        for Absorber { node, coefficients } in &step.loads.absorbers {
            squares[*node] += (coefficients.norm() * dvelocity).powi(2) * square(&way, *node);
        }
        model.ties.gather(1, &mut squares);
        for follower in &model.linkage.followers {
            follower.leaders.iter().for_each(|(leader, _)| squares[*leader] += squares[follower.node]);
        }
        squares.iter_mut().for_each(|squared| *squared *= ROUND_OFF * ROUND_OFF);
        squares
    }
}

/// Largest |u − ū| relative to the largest prescribed motion, (2), or to the round-off of the largest displacement of any
/// dof: a support at rest is satisfied within the round-off of the linear solution. Copies are prescribed by their originals.
pub(super) fn missed(model: &Model, trial: Trial, u: &[f64]) -> f64 {
    let (mut missed, mut motion) = (links::missed(model, u), 0.0f64);
    let mut farthest = u.iter().fold(0.0f64, |most, u| most.max(u.abs()));
    for support in &trial.step.supports {
        let target = trial.prescribed(support, model);
        missed = missed.max((support.at.of(u) - target).abs());
        motion = motion.max((target - support.at.of(&trial.old.displacement)).abs());
        farthest = farthest.max(target.abs());
    }
    for &(copy, original) in model.ties.pairs() {
        for (copy, original) in [(2 * copy, 2 * original), (2 * copy + 1, 2 * original + 1)] {
            missed = missed.max((u[copy] - u[original]).abs());
        }
    }
    if missed == 0.0 { 0.0 } else { missed / motion.max(ROUND_OFF * farthest / model.newton.tolerance) }
}

/// Squared length of a node's vector.
fn square(values: &[f64], node: usize) -> f64 {
    values[2 * node].powi(2) + values[2 * node + 1].powi(2)
}

/// Lengths of the edges of a contact [L]
#[derive(Clone, Debug)]
struct ContactEdges {
    /// of the longest edge at each slave point; 0 without edges
    slave: Vec<f64>,
    /// of each segment of the master; none of a rigid body
    master: Vec<f64>,
}

impl ContactEdges {
    fn of(pair: &ContactPair, x: &Configuration) -> Self {
        let segments = pair.master.segments().iter();
        Self {
            slave: pair.points.iter().map(|point| point.edge_length(x).unwrap_or(0.0)).collect(),
            master: segments.map(|segment| x.between(segment.ends[0], segment.ends[1]).norm()).collect(),
        }
    }

    /// The longer of the edges that meet at a point: gaps are measured on them, and on no others.
    fn at(&self, point: usize, state: &ContactState) -> f64 {
        let faced = state.master_point.and_then(|master_point| self.master.get(master_point.segment));
        self.slave[point].max(faced.copied().unwrap_or(0.0))
    }
}
