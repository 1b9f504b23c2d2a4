//! The equations of the nodes at contacts alone, where all else is linear.
//!
//! ```text
//! r(u) = A u − b + (1 − α_f) f(u_K)                    f: contact; A: bodies, masses, dashpots and supports, constant
//! ρ(x) = ρ₀ + S (x − x₀) + (1 − α_f) f(x)              S: A condensed on the nodes K at contacts; ρ₀: A u₀ − b condensed
//! ```
//!
//! x are the displacements of K, x₀ and u₀ those to start from. r = 0 where ρ(x) = 0 and the others follow x; how far the
//! bodies are from the origin, or have moved, does not enter.

use std::sync::Arc;

use super::Assembler;
use super::dependence::Dependence;
use super::term::Term;
use super::trial::Trial;
use crate::contact::closed::Closed;
use crate::contact::master::Master;
use crate::contact::pair::ContactPair;
use crate::contact::response::PairResponse;
use crate::linear::system::{Request, System};
use crate::linear::{Condensed, Pattern, SparseMatrix, norm};
use crate::model::{Model, Step};

/// Whether everything but contact adds the same tangent in all increments of one length in a step.
pub fn is_linear(model: &Model, step: &Step) -> bool {
    let others = Term::ALL.into_iter().filter(|term| *term != Term::Interfaces);
    others.map(|term| term.dependence(model, step)).all(|dependence| dependence <= Dependence::StepSize)
}

/// The nodes at contacts: those of the slaves, and all that they may slide to. Copies come with the nodes they move with.
pub struct ContactNodes {
    /// The nodes, ascending
    pub nodes: Vec<usize>,
    /// Place of each node among them
    places: Vec<Option<u32>>,
    /// Places of the nodes of each contact
    parts: Vec<Vec<usize>>,
    /// All coupled with each other: the values of a matrix are those of a dense one, column by column
    pattern: Arc<Pattern>,
}

impl ContactNodes {
    /// The nodes of all contacts of a model.
    pub fn new(model: &Model) -> Self {
        let of_pairs: Vec<Vec<usize>> = model.contacts.iter().map(|pair| nodes_of(model, pair)).collect();
        let copies = model.ties.pairs().iter().filter(|(_, original)| of_pairs.iter().flatten().any(|n| n == original));
        let mut nodes: Vec<usize> = of_pairs.iter().flatten().copied().chain(copies.map(|(copy, _)| *copy)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut places = vec![None; model.mesh.nodes.len()];
        nodes.iter().enumerate().for_each(|(place, &node)| places[node] = Some(place as u32));
        let place = |node: &usize| places[*node].map(|place| place as usize);
        let parts = of_pairs.iter().map(|nodes| nodes.iter().filter_map(place).collect()).collect();
        let all: Vec<usize> = (0..nodes.len()).collect();
        let pattern = Arc::new(Pattern::new(nodes.len(), std::iter::once(&all[..])));
        Self { nodes, places, parts, pattern }
    }

    /// A system of their equations.
    pub fn system(&self) -> System {
        System {
            residual: vec![0.0; 2 * self.nodes.len()],
            tangent: SparseMatrix::zero(self.pattern.clone()),
            forces: 0.0,
            imbalance: f64::INFINITY,
        }
    }

    /// Values at their dofs from those at all.
    pub fn gather(&self, all: &[f64]) -> Vec<f64> {
        self.nodes.iter().flat_map(|&node| [all[2 * node], all[2 * node + 1]]).collect()
    }

    /// Write the values at their dofs over those of all.
    pub fn scatter(&self, own: &[f64], all: &mut [f64]) {
        for (values, &node) in own.chunks_exact(2).zip(&self.nodes) {
            all[2 * node..2 * node + 2].copy_from_slice(values);
        }
    }
}

/// Nodes that a contact couples, or may come to couple.
fn nodes_of(model: &Model, pair: &ContactPair) -> Vec<usize> {
    let mut nodes: Vec<usize> = Vec::new();
    for point in &pair.points {
        nodes.extend(point.position.iter().map(|&(node, _)| node));
        nodes.extend(point.length.iter().flat_map(|share| share.tangent.iter().map(|&(node, _)| node)));
    }
    if let Master::Mesh(surface) = &pair.master {
        nodes.extend(surface.segments.iter().flat_map(|segment| segment.nodes()));
    }
    nodes.iter_mut().for_each(|node| *node = model.ties.original(*node));
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// ρ(x) of an increment from one start value on.
pub struct CondensedEquations<'a> {
    nodes: &'a ContactNodes,
    bodies: &'a Condensed,
    /// x₀ [L]
    start: Vec<f64>,
    /// ρ₀ [F]
    constant: Vec<f64>,
    /// 1 − α_f
    share: f64,
    /// Whether a dof has an equation of forces, not of its support or of a copy
    free: Vec<bool>,
    /// Norm of what round-off can leave at the nodes of each contact [F]
    hidden: Vec<f64>,
    /// Norm of the forces in the bodies [F]
    forces: f64,
}

impl<'a> CondensedEquations<'a> {
    /// From the displacement u₀, where ρ₀ is given; `bodies` without contact were just evaluated there.
    pub fn new(
        (nodes, bodies): (&'a ContactNodes, &'a Condensed),
        trial: Trial,
        u: &[f64],
        constant: Vec<f64>,
        (assembler, system): (&Assembler, &System),
    ) -> Self {
        let mut free = vec![true; constant.len()];
        let mut take = |dof: usize| {
            if let Some(place) = nodes.places[dof / 2] {
                free[2 * place as usize + dof % 2] = false;
            }
        };
        trial.step.supports.iter().for_each(|support| take(support.dof));
        assembler.model().ties.pairs().iter().flat_map(|&(copy, _)| [2 * copy, 2 * copy + 1]).for_each(take);
        let share = trial.step.scheme.coefficients().map_or(1.0, |scheme| 1.0 - scheme.alpha_f);
        let round_off = assembler.round_off(trial, u);
        let hidden = |part: &Vec<usize>| part.iter().map(|&k| round_off[nodes.nodes[k]]).sum::<f64>().sqrt();
        let hidden = nodes.parts.iter().map(hidden).collect();
        Self { nodes, bodies, start: nodes.gather(u), constant, share, free, hidden, forces: system.forces }
    }

    /// ρ at `x` with the given responses of the contact points, and its tangent on request.
    pub fn assemble(
        &self,
        assembler: &mut Assembler,
        trial: Trial,
        x: &[f64],
        responses: &[PairResponse],
        request: Request,
        system: &mut System,
    ) {
        assembler.note_contacts(trial, responses);
        let size = x.len();
        system.residual.clone_from(&self.constant);
        for (column, (x, start)) in self.bodies.stiffness.chunks_exact(size).zip(x.iter().zip(&self.start)) {
            let way = x - start;
            system.residual.iter_mut().zip(column).for_each(|(residual, s)| *residual += s * way);
        }
        if request == Request::Tangent {
            system.tangent.values.copy_from_slice(&self.bodies.stiffness);
        }
        let mut dofs = Vec::new();
        for (_, closed) in responses.iter().flat_map(PairResponse::all_closed) {
            self.find(assembler.model(), closed.nodes, &mut dofs);
            self.add(&closed, &dofs, request, system);
        }
        self.measure(assembler, system);
    }

    /// Write the dofs of some nodes among those at contacts over `dofs`.
    fn find(&self, model: &Model, nodes: &[usize], dofs: &mut Vec<usize>) {
        let place = |node: usize| self.nodes.places[model.ties.original(node)].expect("nodes at contacts are kept");
        dofs.clear();
        dofs.extend(nodes.iter().flat_map(|&node| [0, 1].map(|i| 2 * place(node) as usize + i)));
    }

    /// Add the forces and the tangent of a closed point with these dofs.
    fn add(&self, closed: &Closed, dofs: &[usize], request: Request, system: &mut System) {
        let size = system.residual.len();
        for (&row, force) in dofs.iter().zip(closed.force).filter(|(row, _)| self.free[**row]) {
            system.residual[row] += self.share * force;
        }
        if request == Request::Tangent {
            for (&column, rates) in dofs.iter().zip(closed.tangent.chunks_exact(dofs.len())) {
                let column = &mut system.tangent.values[column * size..][..size];
                for (&row, rate) in dofs.iter().zip(rates).filter(|(row, _)| self.free[**row]) {
                    column[row] += self.share * rate;
                }
            }
        }
    }

    /// How far the worst contact is from equilibrium, measured by its own forces; bodies follow.
    fn measure(&self, assembler: &Assembler, system: &mut System) {
        let tolerance = assembler.model().newton.tolerance;
        system.imbalance = 0.0;
        system.forces = self.forces + norm(assembler.contact_forces());
        let square = |dof: usize| if self.free[dof] { system.residual[dof].powi(2) } else { 0.0 };
        let parts = self.nodes.parts.iter().zip(assembler.contact_forces().iter().zip(&self.hidden));
        for (part, (forces, hidden)) in parts {
            let residual = part.iter().map(|&k| square(2 * k) + square(2 * k + 1)).sum::<f64>().sqrt();
            let share = if residual == 0.0 { 0.0 } else { residual / forces.max(hidden / tolerance) };
            // Not a number is no equilibrium.
            system.imbalance = if share.is_nan() { f64::INFINITY } else { system.imbalance.max(share) };
        }
    }
}
