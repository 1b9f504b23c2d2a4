//! The equations of the nodes at contacts alone, where all else is linear.
//!
//! ```text
//! r(u) = A u − b + (1 − α_f) f(u_K)                    f: contact; A: bodies, masses, dashpots and supports, constant
//! ρ(x) = ρ₀ + S (x − x₀) + (1 − α_f) f(x)              S: A condensed on the nodes K at contacts; ρ₀: A u₀ − b condensed
//! ```
//!
//! x are the displacements of K, x₀ and u₀ those to start from. r = 0 where ρ(x) = 0 and the others follow x; how far the
//! bodies are from the origin, or have moved, does not enter.
//!
//! In small sliding, nodes of the slave are counted from what they face for good, and x are their jumps (see `jumps.rs`): with
//! equal nodes on both sides ρ has half as many equations, and its tangent takes an eighth of the operations.
//!
//! Where all nodes are counted so, nothing opens and the pressure is linear, the equations of the jumps along the normal do not
//! vary, and are eliminated as well ([`crate::linear::Eliminated`]): an eighth of the operations again.

use super::Assembler;
use super::contact_nodes::{ContactNodes, contact_share};
use super::dependence::Dependence;
use super::jumps::fixed;
use super::term::Term;
use super::trial::Trial;
use crate::contact::master::Master;
use crate::contact::nodal_forces::Closed;
use crate::contact::pair::ContactPair;
use crate::contact::response::PairResponse;
use crate::linear::system::{Request, System};
use crate::linear::{Condensed, norm};
use crate::model::{Model, Step};

/// Whether everything but contact adds the same tangent in all increments of one length in a step.
pub fn is_linear(model: &Model, step: &Step) -> bool {
    if bound_at_contacts(model, step) || !model.linkage.rigid.is_empty() {
        return false;
    }
    let others = Term::ALL.into_iter().filter(|term| *term != Term::Interfaces);
    others.map(|term| term.dependence(model, step)).all(|dependence| dependence <= Dependence::StepSize)
}

/// Whether that tangent is another one in increments of another length.
pub fn depends_on_length(model: &Model, step: &Step) -> bool {
    let mut others = Term::ALL.into_iter().filter(|term| *term != Term::Interfaces);
    others.any(|term| term.dependence(model, step) == Dependence::StepSize)
}

/// Whether a node at a contact is held along an inclined direction, or follows others or leads them: its equations are no sums of
/// its forces.
fn bound_at_contacts(model: &Model, step: &Step) -> bool {
    let inclined = step.supports.iter().map(|support| support.at).filter(|at| at.inclined.is_some());
    let mut nodes: Vec<usize> = inclined.map(|at| at.node()).chain(model.linkage.nodes()).collect();
    nodes.sort_unstable();
    let is = |node: usize| nodes.binary_search(&model.ties.original(node)).is_ok();
    let of = |pair: &ContactPair| {
        let slaves = pair.points.iter().flat_map(|point| &point.position).map(|(node, _)| *node);
        let masters = match &pair.master {
            Master::Mesh(surface) => &surface.segments[..],
            Master::Rigid(_) => &[],
        };
        slaves.chain(masters.iter().flat_map(|segment| segment.nodes())).any(is)
    };
    !nodes.is_empty() && model.contacts.iter().any(of)
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
    /// Square of what round-off in the bodies can leave at the nodes of each contact [F²]
    hidden: Vec<f64>,
    /// |u|² of these nodes, as far as round-off of it counts [L²]
    ways: Vec<Vec<f64>>,
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
        let fixed = fixed(assembler.model(), trial.step);
        let free = nodes.nodes.iter().flat_map(|&node| [!fixed[2 * node], !fixed[2 * node + 1]]).collect();
        let share = contact_share(trial.step);
        let round_off = assembler.round_off(trial, u);
        let hidden = |side: &Vec<usize>| side.iter().map(|&node| round_off[node]).sum::<f64>();
        let hidden = nodes.sides.iter().map(hidden).collect();
        let ways = nodes.sides.iter().map(|side| assembler.ways(trial, u, side)).collect();
        Self { nodes, bodies, start: nodes.gather(u), constant, share, free, hidden, ways, forces: system.forces }
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
        let (mut dofs, mut rates) = (Vec::new(), Vec::new());
        for (_, closed) in responses.iter().flat_map(PairResponse::all_acting) {
            let closed = self.of_jump(closed, &mut rates);
            self.find(assembler.model(), closed.nodes, &mut dofs);
            self.add(&closed, &dofs, request, system);
        }
        self.measure(assembler, system);
    }

    /// What a closed point adds to the equations of its jump, if it has one: contact acts on that node alone.
    fn of_jump<'b>(&self, closed: Closed<'b>, rates: &'b mut Vec<f64>) -> Closed<'b> {
        let Some(k) = closed.nodes.iter().position(|node| self.nodes.jumps.has(*node)) else { return closed };
        let own = 2 * k..2 * k + 2;
        let columns = closed.tangent.chunks_exact(2 * closed.nodes.len()).skip(own.start).take(2);
        rates.clear();
        rates.extend(columns.flat_map(|column| &column[own.clone()]));
        Closed { nodes: &closed.nodes[k..=k], force: &closed.force[own], tangent: rates, ..closed }
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
        let share = |dof: usize| self.nodes.jumps.share(self.nodes.nodes[dof / 2]);
        let square = |dof: usize| if self.free[dof] { share(dof) * system.residual[dof].powi(2) } else { 0.0 };
        let own = self.nodes.sides.iter().zip(&self.ways).map(|(side, ways)| assembler.contact_round_off(side, ways));
        let hidden = self.hidden.iter().zip(own).map(|(of_bodies, of_contact)| (of_bodies + of_contact).sqrt());
        for (part, (forces, hidden)) in self.nodes.parts.iter().zip(assembler.contact_forces().iter().zip(hidden)) {
            let residual = part.iter().map(|&k| square(2 * k) + square(2 * k + 1)).sum::<f64>().sqrt();
            let share = if residual == 0.0 { 0.0 } else { residual / forces.max(hidden / tolerance) };
            // Not a number is no equilibrium.
            system.imbalance = if share.is_nan() { f64::INFINITY } else { system.imbalance.max(share) };
        }
    }
}
