//! Condensed equations of the nodes at contacts, for models that are linear otherwise.
//!
//! ```text
//! r(u) = A u − b + (1 − α_f) f(u_K)                    f: contact; A: bodies, masses, dashpots and supports, constant
//! ρ(x) = ρ₀ + S (x − x₀) + (1 − α_f) f(x)              S: A condensed on the nodes K at contacts; ρ₀: A u₀ − b condensed
//! ```
//!
//! x are the displacements of the nodes K at contacts, x₀ and u₀ the start values. r = 0 where ρ(x) = 0 and the other nodes
//! follow x; rigid motion and distance from the origin do not enter.
//!
//! In small sliding, x of slave nodes are jumps relative to their fixed opposite positions (see below): with as many nodes on
//! both sides ρ has half as many equations, and its tangent takes an eighth of the operations.
//!
//! If all slave nodes are jumps, nothing opens and the pressure is linear, the equations of the normal jumps are constant and
//! eliminated as well ([`crate::linear::Eliminated`]): again an eighth of the operations.
//!
//! Linear bodies are condensed on the nodes at contacts.
//!
//! # Jumps
//!
//! If the opposite position of a slave node never changes, contact acts on its jump only.
//!
//! ```text
//! u_s = J_s + Σ N_a u_a        u = T y: J in place of u_s         N_a: weights of the projection, in small sliding
//! r_a ← r_a + N_a r_s          L r: the contact forces f on s and −N_a f on a cancel in a
//! L A T y = L b                                                   only where s and a are free: a support's equation stays
//! ```
//!
//! The nodes of the master therefore need not be among those on which linear bodies are condensed, and a body constrained only
//! by contact is constrained by its jumps. A node has no jump if it participates in more than its own point, is tied to
//! another, or is supported while its opposite nodes are not: the contact force on these would not cancel.

use std::sync::Arc;

use super::Assembler;
use super::sums::Dependence;
use super::supports::fixed;
use super::term::Term;
use super::trial::Trial;
use crate::contact::nodal_forces::Closed;
use crate::contact::pair::ContactPair;
use crate::contact::response::PairResponse;
use crate::contact::small_sliding::SmallPoint;
use crate::linear::system::{Request, System};
use crate::linear::{Condensed, Eliminated, Pattern, SparseMatrix, Steady, norm};
use crate::model::{Model, Step};

/// What the tangent of all terms except contact depends on in a step.
fn dependence(model: &Model, step: &Step) -> Dependence {
    let others = Term::ALL.into_iter().filter(|term| *term != Term::Interfaces);
    others.map(|term| term.dependence(model, step)).max().unwrap_or(Dependence::Nothing)
}

/// Whether it is the same in all increments of one length.
pub fn is_linear(model: &Model, step: &Step) -> bool {
    !bound_at_contacts(model, step) && model.linkage.rigid.is_empty() && dependence(model, step) <= Dependence::StepSize
}

/// Whether it depends on the length of the increment, if it is.
pub fn depends_on_length(model: &Model, step: &Step) -> bool {
    dependence(model, step) == Dependence::StepSize
}

/// Whether a node at a contact has an inclined support, or is follower or leader of other nodes: its equations are then no sums
/// of its forces.
fn bound_at_contacts(model: &Model, step: &Step) -> bool {
    let inclined = step.supports.iter().map(|support| support.at).filter(|at| at.inclined.is_some());
    let mut nodes: Vec<usize> = inclined.map(|at| at.node()).chain(model.linkage.nodes()).collect();
    nodes.sort_unstable();
    let is = |node: usize| nodes.binary_search(&model.ties.original(node)).is_ok();
    !nodes.is_empty() && model.contacts.iter().any(|pair| pair.nodes().any(is))
}

/// ρ(x) of an increment from one start value on.
pub struct CondensedEquations<'a> {
    nodes: &'a ContactNodes,
    bodies: &'a Condensed,
    /// x₀ [L]
    start: Vec<f64>,
    /// ρ₀ [F]
    constant: Vec<f64>,
    /// x where the bodies were evaluated last [L], and ρ₀ + S (x − x₀) there [F]
    last: Vec<f64>,
    of_bodies: Vec<f64>,
    /// Weight 1 − α_f of the contact forces at the end of the increment.
    share: f64,
    /// Whether a dof has an equation of forces, not that of a support or copy
    free: Vec<bool>,
    /// Square of the possible round-off of the bodies at the nodes of each contact [F²]
    hidden: Vec<f64>,
    /// |u|² of these nodes, as far as relevant for round-off [L²]
    ways: Vec<Vec<f64>>,
    /// Norm of the forces in the bodies [F]
    forces: f64,
}

impl<'a> CondensedEquations<'a> {
    /// Creates the condensed equations about the displacement u₀ with known ρ₀, at which the `bodies` without contact were just
    /// evaluated.
    pub fn new(
        nodes: &'a ContactNodes,
        bodies: &'a Condensed,
        trial: Trial,
        u: &[f64],
        constant: Vec<f64>,
        assembler: &Assembler,
        system: &System,
    ) -> Self {
        let fixed = fixed(assembler.model(), trial.step);
        let free = nodes.nodes.iter().flat_map(|&node| [!fixed[2 * node], !fixed[2 * node + 1]]).collect();
        let share = contact_share(trial.step);
        let (model, criterion) = (assembler.model(), &assembler.equilibrium);
        let mass = assembler.inert(trial.step);
        let round_off = criterion.round_off(model, mass, trial, u, &assembler.magnitudes);
        let hidden = |side: &Vec<usize>| side.iter().map(|&node| round_off[node]).sum::<f64>();
        let hidden = nodes.sides.iter().map(hidden).collect();
        let ways = nodes.sides.iter().map(|side| criterion.ways(trial.old, u, side)).collect();
        let (start, forces) = (nodes.gather(u), system.forces);
        let (last, of_bodies) = (start.clone(), constant.clone());
        Self { nodes, bodies, start, constant, last, of_bodies, share, free, hidden, ways, forces }
    }

    /// Computes ρ at `x` with the given responses of the contact points, and its tangent on request.
    pub fn assemble(
        &mut self,
        assembler: &mut Assembler,
        trial: Trial,
        x: &[f64],
        responses: &[PairResponse],
        request: Request,
        system: &mut System,
    ) {
        assembler.note_contacts(trial, responses);
        self.evaluate_bodies(x);
        system.residual.clone_from(&self.of_bodies);
        if request == Request::Tangent {
            self.bodies.copy_to(&mut system.tangent.values);
        }
        let (mut dofs, mut rates) = (Vec::new(), Vec::new());
        for (_, closed) in responses.iter().flat_map(PairResponse::all_acting) {
            let closed = self.of_jump(closed, &mut rates);
            self.find(assembler.model(), closed.nodes, &mut dofs);
            self.add(&closed, &dofs, request, system);
        }
        self.measure(assembler, system);
    }

    /// Computes ρ₀ + S (x − x₀); a tangent often follows a residual at the same x.
    fn evaluate_bodies(&mut self, x: &[f64]) {
        if self.last == x {
            return;
        }
        let Self { bodies, start, constant, last, of_bodies, .. } = self;
        of_bodies.clone_from(constant);
        let columns = bodies.stiffness.chunks_exact(x.len()).zip(&bodies.reach);
        for ((column, reach), (x, start)) in columns.zip(x.iter().zip(start)) {
            let way = x - *start;
            let rows = of_bodies[reach.clone()].iter_mut().zip(&column[reach.clone()]);
            rows.for_each(|(force, s)| *force += s * way);
        }
        x.clone_into(last);
    }

    /// Contribution of a closed point to the equations of its jump, if it has one: contact acts on that node only.
    fn of_jump<'b>(&self, closed: Closed<'b>, rates: &'b mut Vec<f64>) -> Closed<'b> {
        let Some(k) = closed.nodes.iter().position(|node| self.nodes.jumps.has(*node)) else { return closed };
        let own = 2 * k..2 * k + 2;
        let columns = closed.tangent.chunks_exact(2 * closed.nodes.len()).skip(own.start).take(2);
        rates.clear();
        rates.extend(columns.flat_map(|column| &column[own.clone()]));
        Closed { nodes: &closed.nodes[k..=k], force: &closed.force[own], tangent: rates, ..closed }
    }

    /// Finds the dofs of some nodes among those at contacts.
    fn find(&self, model: &Model, nodes: &[usize], dofs: &mut Vec<usize>) {
        let place = |node: usize| self.nodes.places[model.ties.original(node)].expect("nodes at contacts are retained");
        dofs.clear();
        dofs.extend(nodes.iter().flat_map(|&node| [0, 1].map(|i| 2 * place(node) as usize + i)));
    }

    /// Adds the forces and the tangent of a closed point with these dofs.
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

    /// Largest residual of a contact relative to its own forces; the bodies are updated.
    fn measure(&self, assembler: &Assembler, system: &mut System) {
        let (tolerance, criterion) = (assembler.model().newton.tolerance, &assembler.equilibrium);
        system.imbalance = 0.0;
        system.forces = self.forces + norm(criterion.contact_forces());
        let share = |dof: usize| self.nodes.jumps.share(self.nodes.nodes[dof / 2]);
        let square = |dof: usize| if self.free[dof] { share(dof) * system.residual[dof].powi(2) } else { 0.0 };
        let own = self.nodes.sides.iter().zip(&self.ways).map(|(side, ways)| criterion.contact_round_off(side, ways));
        let hidden = self.hidden.iter().zip(own).map(|(of_bodies, of_contact)| (of_bodies + of_contact).sqrt());
        for (part, (forces, hidden)) in self.nodes.parts.iter().zip(criterion.contact_forces().iter().zip(hidden)) {
            let residual = part.iter().map(|&k| square(2 * k) + square(2 * k + 1)).sum::<f64>().sqrt();
            let share = if residual == 0.0 { 0.0 } else { residual / forces.max(hidden / tolerance) };
            // NaN is not an equilibrium.
            system.imbalance = if share.is_nan() { f64::INFINITY } else { system.imbalance.max(share) };
        }
    }
}

/// Nodes at contacts: those of the slaves, and all that they may slide to unless the slave nodes are jumps. Copies are
/// represented by their originals.
pub struct ContactNodes {
    /// The nodes, body after body, in each along its longer extent
    pub nodes: Vec<usize>,
    /// Index of each node among them
    places: Vec<Option<u32>>,
    jumps: Jumps,
    /// Indices of the nodes of each contact
    parts: Vec<Vec<usize>>,
    /// All nodes of each contact
    sides: Vec<Vec<usize>>,
}

impl ContactNodes {
    /// Collects the nodes of all contacts of a model.
    pub fn new(model: &Model) -> Self {
        let together: Vec<Vec<Vec<usize>>> = model.contacts.iter().map(|pair| nodes_of(model, pair)).collect();
        let jumps = Jumps::new(model, &together.concat());
        Self::counted_by(model, &together, jumps)
    }

    /// Collects the nodes of both sides of all contacts, with absolute displacements (no jumps).
    pub fn of_both_sides(model: &Model) -> Self {
        let together: Vec<Vec<Vec<usize>>> = model.contacts.iter().map(|pair| nodes_of(model, pair)).collect();
        Self::counted_by(model, &together, Jumps::none(model))
    }

    fn counted_by(model: &Model, together: &[Vec<Vec<usize>>], jumps: Jumps) -> Self {
        // A point with a jump acts on that jump only: none of its opposite nodes has equations of contact.
        let own = |nodes: &Vec<usize>| match nodes.iter().find(|node| jumps.has(**node)) {
            Some(slave) => vec![*slave],
            None => nodes.clone(),
        };
        let of_pairs: Vec<Vec<usize>> =
            together.iter().map(|pair| sorted(pair.iter().flat_map(own).collect())).collect();
        let copies = model.ties.pairs().iter().filter(|(_, original)| of_pairs.iter().flatten().any(|n| n == original));
        let nodes = sorted(of_pairs.iter().flatten().copied().chain(copies.map(|(copy, _)| *copy)).collect());
        let nodes = along_contacts(model, nodes);
        let mut places = vec![None; model.mesh.nodes.len()];
        nodes.iter().enumerate().for_each(|(place, &node)| places[node] = Some(place as u32));
        let place = |node: &usize| places[*node].map(|place| place as usize);
        let parts = of_pairs.iter().map(|nodes| nodes.iter().filter_map(place).collect()).collect();
        let sides = together.iter().map(|pair| sorted(pair.concat())).collect();
        Self { nodes, places, jumps, parts, sides }
    }

    /// Index of a node among them.
    pub(super) fn place(&self, node: usize) -> Option<usize> {
        self.places[node].map(|place| place as usize)
    }

    /// Creates a system of their equations, all coupled with each other: the values are those of a dense matrix, column by
    /// column.
    pub fn system(&self) -> System {
        let all: Vec<usize> = (0..self.nodes.len()).collect();
        let pattern = Arc::new(Pattern::new(all.len(), std::iter::once(&all[..])));
        System {
            residual: vec![0.0; 2 * self.nodes.len()],
            tangent: SparseMatrix::zero(pattern),
            forces: 0.0,
            imbalance: f64::INFINITY,
        }
    }

    /// Gathers x from the displacements of all nodes.
    pub fn gather(&self, u: &[f64]) -> Vec<f64> {
        self.nodes.iter().flat_map(|&node| self.jumps.of(node, u)).collect()
    }

    /// Writes the displacements of these nodes for given x; the others are unchanged.
    pub fn scatter(&self, x: &[f64], u: &mut [f64]) {
        for (values, &node) in x.chunks_exact(2).zip(&self.nodes) {
            u[2 * node..2 * node + 2].copy_from_slice(values);
        }
        self.jumps.resolve(u);
    }

    /// Extends the pattern of the bodies to jumps, with these nodes coupled with each other.
    pub fn around(&self, bodies: &Pattern) -> Arc<Pattern> {
        Arc::new(self.jumps.pattern(bodies, &self.nodes))
    }

    /// Transforms the tangent of the bodies to jumps, on that pattern.
    pub fn counted(&self, model: &Model, step: &Step, bodies: &SparseMatrix, pattern: &Arc<Pattern>) -> SparseMatrix {
        let mut sum = SparseMatrix::zero(pattern.clone());
        self.jumps.matrix(bodies, &fixed(model, step), &mut sum);
        sum
    }

    /// Whether all of them are jumps, so that half of their equations are constant while nothing opens.
    pub fn halves(&self) -> bool {
        self.nodes.iter().all(|node| self.jumps.has(*node))
    }

    /// Eliminates their normal equations from S of the bodies, if all of them are jumps.
    pub fn eliminated(&self, model: &Model, step: &Step, bodies: &Condensed) -> Option<Eliminated> {
        let (fixed, share) = (fixed(model, step), contact_share(step));
        let steady = |&node: &usize| {
            let steady = self.jumps.steady(node, &fixed)?;
            Some(Steady { stiffness: share * steady.stiffness, ..steady })
        };
        Eliminated::new(&bodies.stiffness, self.nodes.iter().map(steady).collect::<Option<_>>()?).ok()
    }

    /// Transforms the right-hand side accordingly.
    pub fn balanced(&self, model: &Model, step: &Step, residual: &[f64]) -> Vec<f64> {
        let mut balanced = residual.to_vec();
        self.jumps.balance(&fixed(model, step), &mut balanced);
        balanced
    }

    /// Displacements of all nodes from a solution in jumps.
    pub fn resolved(&self, mut solution: Vec<f64>) -> Vec<f64> {
        self.jumps.resolve(&mut solution);
        solution
    }
}

/// Weight 1 − α_f of the contact forces at the end of the increment.
fn contact_share(step: &Step) -> f64 {
    step.scheme.coefficients().map_or(1.0, |scheme| 1.0 - scheme.alpha_f)
}

/// Orders ascending nodes by their bodies, those of no body last, and in each along the longer extent of them.
fn along_contacts(model: &Model, nodes: Vec<usize>) -> Vec<usize> {
    let mut own = vec![model.bodies.len(); model.mesh.nodes.len()];
    for (body, nodes) in model.bodies.iter().map(|body| &body.nodes).enumerate().rev() {
        nodes.iter().for_each(|&node| own[node] = body);
    }
    let at = |node: usize| model.mesh.nodes[node];
    let ordered = (0..=model.bodies.len()).flat_map(|body| {
        let mut of_body: Vec<usize> = nodes.iter().copied().filter(|&node| own[node] == body).collect();
        let extent = |i: usize| {
            let ends = of_body.iter().map(|&node| at(node)[i]);
            ends.clone().fold(f64::NEG_INFINITY, f64::max) - ends.fold(f64::INFINITY, f64::min)
        };
        let axis = usize::from(extent(1) > extent(0));
        of_body.sort_by(|&a, &b| at(a)[axis].total_cmp(&at(b)[axis]));
        of_body
    });
    ordered.collect()
}

/// Sorts a list and removes duplicates.
fn sorted(mut nodes: Vec<usize>) -> Vec<usize> {
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// Groups of nodes that a contact couples or may couple: those of each point separately if they never change.
fn nodes_of(model: &Model, pair: &ContactPair) -> Vec<Vec<usize>> {
    if let Some(small) = &pair.small {
        let of_point = |(k, point): (usize, &Option<SmallPoint>)| {
            let behind = pair.pores.iter().flat_map(|pores| pores[k].nodes.iter().copied());
            Some(model.ties.originals(point.as_ref()?.nodes.iter().copied().chain(behind)))
        };
        return small.points.iter().enumerate().filter_map(of_point).collect();
    }
    let along = pair.points.iter().flat_map(|point| &point.length).flat_map(|share| &share.tangent);
    vec![model.ties.originals(pair.nodes().chain(along.map(|&(node, _)| node)))]
}

/// A slave node with its opposite position.
struct Jump {
    slave: usize,
    /// Nodes of the master and N_a, which sum to one; empty on a rigid body
    master_points: Vec<(usize, f64)>,
    /// Constant contribution of contact to its normal equation while closed: n and α_n ℓ
    steady: Steady,
}

/// Slave nodes expressed as jumps.
struct Jumps {
    jumps: Vec<Jump>,
    /// Number of each node's jump
    numbers: Vec<Option<u32>>,
}

impl Jumps {
    /// Creates the jumps of a model, valid in all its steps; `together` contains the nodes coupled by contacts, each point of
    /// small sliding separately.
    pub fn new(model: &Model, together: &[Vec<usize>]) -> Self {
        let mut uses = vec![0; model.mesh.nodes.len()];
        together.iter().flatten().for_each(|&node| uses[node] += 1);
        let mut tied = vec![false; uses.len()];
        model.ties.pairs().iter().for_each(|&(copy, original)| (tied[copy], tied[original]) = (true, true));
        let fixed: Vec<Vec<bool>> = model.steps.iter().map(|step| fixed(model, step)).collect();
        let left_over = |slave: usize, master_point: usize| {
            fixed.iter().any(|fixed| (0..2).any(|i| fixed[2 * slave + i] && !fixed[2 * master_point + i]))
        };
        let fits = |Jump { slave, master_points, .. }: &Jump| {
            let free = uses[*slave] == 1 && !tied[*slave];
            free && master_points
                .iter()
                .all(|&(master_point, _)| !tied[master_point] && !left_over(*slave, master_point))
        };
        // Friction that goes by pores depends on the nodes behind the surface too.
        let pairs = model.contacts.iter().filter(|pair| pair.pores.is_none());
        let jumps: Vec<Jump> = pairs.flat_map(of_pair).filter(fits).collect();
        let mut numbers = vec![None; uses.len()];
        jumps.iter().enumerate().for_each(|(number, jump)| numbers[jump.slave] = Some(number as u32));
        Self { jumps, numbers }
    }

    /// No jumps: all nodes with absolute displacements.
    pub fn none(model: &Model) -> Self {
        Self { jumps: Vec::new(), numbers: vec![None; model.mesh.nodes.len()] }
    }

    /// Whether a node is expressed as a jump.
    pub fn has(&self, node: usize) -> bool {
        self.numbers[node].is_some()
    }

    fn master_points(&self, node: usize) -> &[(usize, f64)] {
        self.numbers[node].map_or(&[], |number| &self.jumps[number as usize].master_points)
    }

    /// Contribution of contact to the equation of a node's normal jump while it is closed, in equations that are not `fixed`.
    pub fn steady(&self, node: usize, fixed: &[bool]) -> Option<Steady> {
        let Steady { direction, stiffness } = self.jumps[self.numbers[node]? as usize].steady;
        let share: f64 = (0..2).filter(|i| !fixed[2 * node + i]).map(|i| direction[i].powi(2)).sum();
        Some(Steady { direction, stiffness: share * stiffness })
    }

    /// 1 + Σ N_a²: the residual of all equations is that of a jump times its square root, if the master's is zero in L r.
    pub fn share(&self, node: usize) -> f64 {
        1.0 + self.master_points(node).iter().map(|(_, weight)| weight * weight).sum::<f64>()
    }

    /// J of a node, or u of one without a jump.
    pub fn of(&self, node: usize, u: &[f64]) -> [f64; 2] {
        let at = |node: usize| [u[2 * node], u[2 * node + 1]];
        let base = self.base(node, u);
        [0, 1].map(|i| at(node)[i] - base[i])
    }

    /// Σ N_a u_a; the motion of the first node is subtracted first to avoid round-off of a common motion.
    fn base(&self, node: usize, u: &[f64]) -> [f64; 2] {
        let Some((&(first, _), others)) = self.master_points(node).split_first() else { return [0.0; 2] };
        [0, 1].map(|i| {
            let common = u[2 * first + i];
            common
                + others.iter().map(|&(master_point, weight)| weight * (u[2 * master_point + i] - common)).sum::<f64>()
        })
    }

    /// Computes u from y, in place.
    pub fn resolve(&self, y: &mut [f64]) {
        for &Jump { slave, .. } in &self.jumps {
            let base = self.base(slave, y);
            (0..2).for_each(|i| y[2 * slave + i] += base[i]);
        }
    }

    /// Computes L r, in place.
    pub fn balance(&self, fixed: &[bool], r: &mut [f64]) {
        for Jump { slave, master_points, .. } in &self.jumps {
            for &(master_point, weight) in master_points {
                let free = |i: &usize| !fixed[2 * slave + i] && !fixed[2 * master_point + i];
                (0..2).filter(free).for_each(|i| r[2 * master_point + i] += weight * r[2 * slave + i]);
            }
        }
    }

    /// Pattern of L A T for A with the pattern `plain`, all `retained` nodes coupled with each other.
    pub fn pattern(&self, plain: &Pattern, retained: &[usize]) -> Pattern {
        let with_master_points = |node: usize| {
            std::iter::once(node).chain(self.master_points(node).iter().map(|&(master_point, _)| master_point))
        };
        let groups = (0..plain.nodes()).flat_map(|column| {
            let coupled = plain.neighbours(column).iter().filter(move |row| **row <= column);
            coupled.map(move |&row| with_master_points(row).chain(with_master_points(column)).collect::<Vec<_>>())
        });
        let groups: Vec<Vec<usize>> = groups.chain([retained.to_vec()]).collect();
        Pattern::new(plain.nodes(), groups.iter().map(|group| &group[..]))
    }

    /// Adds L A T to a matrix with a sufficient pattern.
    pub fn matrix(&self, plain: &SparseMatrix, fixed: &[bool], sum: &mut SparseMatrix) {
        let nodes = plain.pattern.nodes();
        let pairs =
            (0..nodes).flat_map(|column| plain.pattern.neighbours(column).iter().map(move |&row| (row, column)));
        for (row, column) in pairs {
            let from = plain.pattern.coupled(row, column);
            let itself = |node: usize| std::iter::once((node, 1.0)).chain(self.master_points(node).iter().copied());
            for (to_column, by_column) in itself(column) {
                for (to_row, by_row) in itself(row) {
                    let to = sum.pattern.coupled(to_row, to_column);
                    let balanced = |i: &usize| to_row == row || !fixed[2 * row + i] && !fixed[2 * to_row + i];
                    for i in (0..2).filter(balanced) {
                        for j in 0..2 {
                            sum.values[to.value(i, j)] += by_row * by_column * plain.values[from.value(i, j)];
                        }
                    }
                }
            }
        }
    }
}

/// Points of a pair whose position is a single node with fixed opposite nodes.
fn of_pair(pair: &ContactPair) -> impl Iterator<Item = Jump> {
    let small = pair.small.iter().filter(|_| !pair.tied);
    let points = small.flat_map(|small| &small.points).zip(&pair.points);
    points.filter_map(|(point, slave)| match slave.position[..] {
        [(node, _)] => jump(node, point.as_ref()?, pair.alpha_n),
        _ => None,
    })
}

fn jump(slave: usize, point: &SmallPoint, alpha_n: f64) -> Option<Jump> {
    if point.lever.is_some() {
        return None;
    }
    let (mut own, mut master_points) = (0.0, Vec::new());
    for (&node, &weight) in point.nodes.iter().zip(&point.weights) {
        if node == slave { own += weight } else { master_points.push((node, -weight)) }
    }
    let steady = Steady { direction: point.normal, stiffness: alpha_n * point.length };
    (own == 1.0).then_some(Jump { slave, master_points, steady })
}
