//! Residual and tangent of the model at a trial displacement.
//!
//! ```text
//! F(u) = internal + contact − loads
//! r    = (1 − α_f) F₁ + α_f F₀ + M ((1 − α_m) a₁ + α_m a₀)        free dofs
//! r    = w (u − ū)                                                prescribed dofs, w: a stiffness for scale
//! ```
//!
//! Elements and contact points are evaluated in parallel and added in a fixed order: the same bits on any number of
//! threads.

mod damping;
pub mod energy;
mod equilibrium;
pub mod failure;
mod forces;

use std::sync::Arc;

use nalgebra::{DMatrix, Vector2};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::contact::force::{Closed, ContactState, Status};
use crate::contact::pair::{ContactIncrement, ContactPair, PairResponse, Presumption};
use crate::contact::surface::Master;
use crate::equations::failure::TrialFailure;
use crate::laws::bulk::InvertedElement;
use crate::linear::system::Request;
use crate::linear::system::{Contribution, System};
use crate::linear::{BlockPosition, Pattern, SparseMatrix};
use crate::mesh::configuration::Configuration;
use crate::model::boundary::{Absorber, Prescribed};
use crate::model::element::pressure::follower_pressure;
use crate::model::scheme::{Coefficients, supported_rates};
use crate::model::state::State;
use crate::model::{Model, Step};
use equilibrium::Equilibrium;

/// One increment to be solved: from where, to when, under which step.
#[derive(Clone, Copy, Debug)]
pub struct Trial<'a> {
    /// committed state
    pub old: &'a State,
    /// the step
    pub step: &'a Step,
    /// t at the end of the increment [T]
    pub time: f64,
    /// Δt [T]
    pub dt: f64,
    /// α_n of contacts under the augmented Lagrangian is this many times the one given
    pub stiffening: f64,
    /// Whether the bodies give way under the pressures that come up within the increment; central differences move first
    pub settles: bool,
}

impl<'a> Trial<'a> {
    /// The increment from a state to a time.
    pub fn new(old: &'a State, step: &'a Step, time: f64, dt: f64) -> Self {
        Self { old, step, time, dt, stiffening: 1.0, settles: true }
    }

    /// The increment to the time t + θ Δt at which the scheme asks for equilibrium.
    pub fn ahead(self) -> Trial<'a> {
        let theta = self.step.scheme.theta();
        if theta == 1.0 { self } else { Self { time: self.old.time + theta * self.dt, dt: theta * self.dt, ..self } }
    }

    /// What is left of the dashpots that stabilize at the end of the increment, 1 to 0; exactly 0 at the end of the step.
    pub fn stabilization_left(&self) -> f64 {
        1.0 - self.step.span.share(self.time)
    }

    /// ū of a support at the end of the increment; not finite where its expression has no value [L].
    pub fn prescribed(&self, support: &Prescribed, model: &Model) -> f64 {
        let (position, start) = self.place(support, model);
        support.value(position, self.time, self.step.span, start)
    }

    /// ū of a support at the start, thirds and end of the increment [L].
    pub fn thirds(&self, support: &Prescribed, model: &Model) -> [f64; 4] {
        let (position, start) = self.place(support, model);
        support.thirds(position, [self.time - self.dt, self.time], self.step.span, start)
    }

    /// Reference position of a support, and its displacement at the start of the step.
    fn place(&self, support: &Prescribed, model: &Model) -> (Vector2<f64>, Vector2<f64>) {
        let node = support.dof / 2;
        let start = &self.old.step_start.displacement[2 * node..][..2];
        (model.mesh.nodes[node], Vector2::new(start[0], start[1]))
    }
}

/// What was found at the last evaluated displacement, for the accepted state.
#[derive(Clone, Debug, Default)]
pub struct Evaluation {
    /// F [F]
    pub force: Vec<f64>,
    /// loads [F]
    pub loads: Vec<f64>,
    /// forces of dashpots on the nodes [F]
    pub damping: Vec<f64>,
    /// norm of the forces of those that stabilize [F]
    pub stabilization: f64,
    /// F + M a, at a prescribed dof the reaction [F]
    pub balance: Vec<f64>,
    /// v [L/T]
    pub velocity: Vec<f64>,
    /// a [L/T²]
    pub acceleration: Vec<f64>,
    /// trial states of all contact points
    pub contacts: Vec<Vec<ContactState>>,
    /// ∫ W dV [F·L]
    pub strain_energy: f64,
}

/// Numbers of contact points by status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactCounts {
    /// open
    pub open: usize,
    /// sticking
    pub stick: usize,
    /// slipping
    pub slip: usize,
}

impl ContactCounts {
    /// Count the points of all pairs.
    pub fn of(contacts: &[Vec<ContactState>]) -> Self {
        let mut counts = Self::default();
        for state in contacts.iter().flatten() {
            match state.status() {
                Status::Open => counts.open += 1,
                Status::Stick => counts.stick += 1,
                Status::Slip => counts.slip += 1,
            }
        }
        counts
    }
}

/// Seconds spent by phase.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seconds {
    /// solids, loads and sums
    pub assembly: f64,
    /// search, friction and contact forces
    pub contact: f64,
}

/// Nodes that the equations couple besides those of elements and loads. The order of elimination depends on it, and so the
/// last bits of what is solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coupling {
    /// Nodes of each contact point, and of those it may slide to
    groups: Vec<Vec<usize>>,
    /// Segments ahead of each foot that there will be room for, when this turns out too small
    ahead: usize,
}

/// Assembles a model; owns the pattern and the buffers that are used again.
pub struct Assembler {
    model: Arc<Model>,
    pattern: Arc<Pattern>,
    /// Position of the block of every node pair of every element, in the current pattern
    blocks: Vec<BlockPosition>,
    /// Where each element's blocks start
    block_starts: Vec<usize>,
    mass: Option<SparseMatrix>,
    /// η M of the bodies' damping
    damping_mass: Option<SparseMatrix>,
    /// w of prescribed dofs [F/L]
    weight: f64,
    /// Sum of the forces' magnitudes at each dof [F]
    magnitudes: Vec<f64>,
    equilibrium: Equilibrium,
    /// What was found at the last evaluated displacement
    pub evaluation: Evaluation,
    buffers: Buffers,
    /// For explicit increments, once they begin
    gather: Option<forces::Gather>,
    coupling: Arc<Coupling>,
    /// Time spent
    pub seconds: Seconds,
}

/// What a batch of elements adds, one after another.
#[derive(Clone, Debug, Default)]
struct Buffers {
    forces: Vec<f64>,
    tangents: Vec<f64>,
    energies: Vec<Result<f64, InvertedElement>>,
}

/// Most segments ahead of a foot that the pattern gets room for.
const FARTHEST: usize = 8;

/// Elements whose forces and tangents are held at once before they are added.
const BATCH: usize = 1024;

/// Elements that are done sooner than another thread wakes up.
const FEW: usize = 64;

impl Assembler {
    /// An assembler of a model.
    pub fn new(model: &Arc<Model>) -> Self {
        let block_starts = std::iter::once(0)
            .chain(model.mesh.elements.iter().scan(0, |sum, element| {
                *sum += element.nodes.len().pow(2);
                Some(*sum)
            }))
            .collect();
        let mut assembler = Self {
            model: model.clone(),
            pattern: Arc::new(Pattern::new(model.mesh.nodes.len(), std::iter::empty())),
            blocks: Vec::new(),
            block_starts,
            mass: None,
            damping_mass: None,
            weight: weight(model),
            magnitudes: vec![0.0; model.dofs()],
            equilibrium: Equilibrium::new(model),
            evaluation: Evaluation::default(),
            buffers: Buffers::default(),
            gather: None,
            coupling: Arc::new(Coupling { groups: Vec::new(), ahead: 1 }),
            seconds: Seconds::default(),
        };
        assembler.set_pattern();
        assembler
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Which nodes are coupled at present.
    pub fn coupling(&self) -> Arc<Coupling> {
        self.coupling.clone()
    }

    /// Couple the nodes as they were coupled before.
    pub fn couple(&mut self, coupling: &Arc<Coupling>) {
        if !Arc::ptr_eq(coupling, &self.coupling) {
            self.coupling = coupling.clone();
            self.set_pattern();
        }
    }

    /// A system on the current pattern.
    pub fn system(&self) -> System {
        System {
            residual: vec![0.0; self.model.dofs()],
            tangent: SparseMatrix::zero(self.pattern.clone()),
            forces: 0.0,
            imbalance: f64::INFINITY,
        }
    }

    /// Couple the nodes of all elements, loads and the given groups; find every element's blocks in the new pattern.
    fn set_pattern(&mut self) {
        let groups = &self.coupling.clone().groups;
        let model = &*self.model.clone();
        let elements = model.mesh.elements.iter().map(|element| &element.nodes[..]);
        let edges = model.steps.iter().flat_map(|step| step.loads.pressures.iter().flat_map(|load| &load.edges));
        let all = elements.chain(edges.map(|edge| &edge[..])).chain(groups.iter().map(|group| &group[..]));
        let tied = self.tied(all.clone());
        let pattern = Pattern::new(model.mesh.nodes.len(), all.chain(tied.iter().map(|group| &group[..])));
        self.blocks.clear();
        for element in &model.mesh.elements {
            let nodes: Vec<usize> = element.nodes.iter().map(|&node| model.ties.original(node)).collect();
            for &column in &nodes {
                let block = |&row| pattern.block(row, column).expect("the pattern couples all nodes of an element");
                self.blocks.extend(nodes.iter().map(block));
            }
        }
        self.pattern = Arc::new(pattern);
        self.mass = None;
        self.damping_mass = None;
    }

    /// The groups that have copies in them, as the nodes that those move with, and every copy with its own.
    fn tied<'a>(&self, groups: impl Iterator<Item = &'a [usize]>) -> Vec<Vec<usize>> {
        let ties = &self.model.ties;
        if ties.pairs().is_empty() {
            return Vec::new();
        }
        let originals = |group: &[usize]| -> Vec<usize> { group.iter().map(|&node| ties.original(node)).collect() };
        let moved = groups.map(|group| (group, originals(group))).filter(|(group, originals)| group != originals);
        let mut tied: Vec<Vec<usize>> = moved.map(|(_, originals)| originals).collect();
        tied.extend(ties.pairs().iter().map(|&(copy, original)| vec![copy, original]));
        tied
    }

    /// The dof that a dof moves with.
    fn original(&self, dof: usize) -> usize {
        2 * self.model.ties.original(dof / 2) + dof % 2
    }

    /// Replace the equations of copies by w (x_copy − x_original) = 0.
    pub fn tie(&self, matrix: &mut SparseMatrix, weight: f64) {
        for &(copy, original) in self.model.ties.pairs() {
            for d in 0..2 {
                matrix.replace_row(2 * copy + d, weight);
                let coupled = matrix.pattern.block(copy, original).expect("the pattern couples copies");
                matrix.values[coupled.value(d, d)] = -weight;
            }
        }
    }

    /// Residual at the displacement `u`, no presumption made.
    ///
    /// # Errors
    /// [`TrialFailure`] when an element inverts, a friction law fails, or a load has no value.
    pub fn residual(&mut self, trial: Trial, u: &[f64], system: &mut System) -> Result<(), TrialFailure> {
        let responses = self.interfaces(trial, u, |_, _| Presumption::default())?;
        self.assemble(trial, u, &responses, Request::Residual, system)
    }

    /// Responses of all contact points at the displacement `u`, with what is presumed about a point of a pair: for a tangent
    /// alone, a residual that may be accepted knows no presumptions.
    ///
    /// # Errors
    /// [`TrialFailure`] when a friction law fails.
    pub fn interfaces(
        &mut self,
        trial: Trial,
        u: &[f64],
        presumed: impl Fn(usize, usize) -> Presumption + Sync,
    ) -> Result<Vec<PairResponse>, TrialFailure> {
        if self.model.contacts.is_empty() {
            return Ok(Vec::new());
        }
        let clock = std::time::Instant::now();
        let [before, x] = [&trial.old.displacement, u].map(|u| self.model.configuration(u));
        let fading = 1.0 - self.model.steps[0].span.share(trial.time);
        let during = ContactIncrement { dt: trial.dt, fading, stiffening: trial.stiffening, settles: trial.settles };
        let pairs = self.model.contacts.iter().zip(&trial.old.contacts).enumerate();
        let respond = |(number, (pair, old)): (usize, (&ContactPair, &Vec<ContactState>))| {
            let responses = pair.respond(old, &before, during, |point| presumed(number, point), &x);
            let contact = || pair.name.clone();
            responses.map_err(|(point, cause)| TrialFailure::Friction { contact: contact(), point, cause })
        };
        let responses = pairs.map(respond).collect();
        self.seconds.contact += clock.elapsed().as_secs_f64();
        responses
    }

    /// Residual, and tangent on request, at the displacement `u` with the given responses of the contact points.
    ///
    /// # Errors
    /// [`TrialFailure`] when an element inverts, or a load has no value.
    pub fn assemble(
        &mut self,
        trial: Trial,
        u: &[f64],
        responses: &[PairResponse],
        request: Request,
        system: &mut System,
    ) -> Result<(), TrialFailure> {
        let clock = std::time::Instant::now();
        let model = self.model.clone();
        let x = model.configuration(u);
        let tangent = request == Request::Tangent;
        if tangent {
            self.cover(responses, trial.old);
            if !Arc::ptr_eq(&system.tangent.pattern, &self.pattern) {
                system.tangent = SparseMatrix::zero(self.pattern.clone());
            }
            system.tangent.clear();
        }
        let mut values = tangent.then_some(&mut system.tangent);
        self.magnitudes.fill(0.0);
        let mut force = vec![0.0; u.len()];
        let strain_energy = self.add_solids(u, &mut force, values.as_deref_mut())?;
        self.equilibrium.note_contacts(&self.model, trial, responses);
        for (_, closed) in responses.iter().flatten() {
            if let Some(Closed { contribution, .. }) = closed {
                self.add(contribution, &mut force, values.as_deref_mut());
            }
        }
        let mut loads = self.add_loads(trial, u, &x, &mut force, values.as_deref_mut())?;
        self.add_dashpots(trial, u, &mut force, values.as_deref_mut())?;
        for values in [&mut force, &mut loads, &mut self.evaluation.damping, &mut self.magnitudes] {
            self.model.ties.gather(2, values);
        }
        self.evaluation.contacts =
            responses.iter().map(|pair| pair.iter().map(|(state, _)| *state).collect()).collect();
        self.evaluation.strain_energy = strain_energy;
        self.evaluation.loads = loads;
        self.evaluation.force = force;
        self.balance(trial, u, values, &mut system.residual);
        self.prescribe(trial, u, tangent, system)?;
        self.measure(trial, u, system);
        self.seconds.assembly += clock.elapsed().as_secs_f64();
        Ok(())
    }

    /// Make sure the pattern has room for all contact points. If it has not, it gets room for one segment more behind
    /// each foot and a few ahead, where the point slides to. Every time the room turns out too small there will be twice
    /// as much, so that the pattern seldom changes as points slide.
    fn cover(&mut self, responses: &[PairResponse], old: &State) {
        let original = |node: &usize| self.model.ties.original(*node);
        let coupled = |closed: &Closed| {
            let nodes: Vec<usize> = closed.contribution.nodes.iter().map(original).collect();
            nodes.iter().all(|&a| nodes.iter().all(|&b| self.pattern.block(a, b).is_some()))
        };
        if responses.iter().flatten().filter_map(|(_, closed)| closed.as_ref()).all(coupled) {
            return;
        }
        let ahead = self.coupling.ahead;
        let mut groups = Vec::new();
        for ((pair, responses), old) in self.model.contacts.iter().zip(responses).zip(&old.contacts) {
            for ((slave, (state, closed)), old) in pair.points.iter().zip(responses).zip(old) {
                let Some(foot) = state.foot.or(old.foot) else { continue };
                let mut nodes: Vec<usize> = slave.position.iter().map(|&(node, _)| node).collect();
                nodes.extend(closed.iter().flat_map(|closed| &closed.contribution.nodes));
                if let Master::Mesh(surface) = &pair.master {
                    let way = old.foot.and_then(|from| surface.path(from, foot)).unwrap_or_default();
                    let slip: f64 = way.iter().map(|(_, from, to)| to - from).sum();
                    let [behind, ahead] = if slip < 0.0 { [ahead, 1] } else { [1, ahead] };
                    let back = std::iter::successors(Some(foot.segment), |&segment| surface.previous(segment));
                    let forth = std::iter::successors(Some(foot.segment), |&segment| surface.next(segment));
                    let around = back.take(1 + behind).chain(forth.take(1 + ahead));
                    nodes.extend(around.flat_map(|segment| surface.segments[segment].nodes()));
                }
                nodes.sort_unstable();
                nodes.dedup();
                groups.push(nodes);
            }
        }
        self.coupling = Arc::new(Coupling { groups, ahead: FARTHEST.min(2 * ahead) });
        self.set_pattern();
    }

    /// Add internal forces and tangents of the solids; returns the stored energy.
    fn add_solids(
        &mut self,
        u: &[f64],
        force: &mut [f64],
        mut tangent: Option<&mut SparseMatrix>,
    ) -> Result<f64, TrialFailure> {
        let model = &*self.model.clone();
        let wants_tangent = tangent.is_some();
        let widest = model.mesh.elements.iter().map(|element| element.nodes.len()).max().unwrap_or(0);
        let (dofs, stride) = (2 * widest, if wants_tangent { 4 * widest * widest } else { 1 });
        let batch = BATCH.min(model.mesh.elements.len());
        let Buffers { mut forces, mut tangents, mut energies } = std::mem::take(&mut self.buffers);
        forces.resize(batch * dofs, 0.0);
        tangents.resize(tangents.len().max(batch * stride), 0.0);
        energies.clear();
        let mut energy = 0.0;
        for first in (0..model.mesh.elements.len()).step_by(BATCH) {
            let elements = first..(first + BATCH).min(model.mesh.elements.len());
            let one = |(e, (force, tangent)): (usize, (&mut [f64], &mut [f64]))| {
                let nodes = &model.mesh.elements[e].nodes;
                let mut local = [Vector2::zeros(); 9];
                for (local, &node) in local.iter_mut().zip(nodes) {
                    *local = Vector2::new(u[2 * node], u[2 * node + 1]);
                }
                let n = 2 * nodes.len();
                let (solid, material) = (&model.solids[e], &*model.bodies[model.body_of_element[e]].material);
                if wants_tangent {
                    solid.force_and_tangent(material, &local[..nodes.len()], &mut force[..n], &mut tangent[..n * n])
                } else {
                    solid.force(material, &local[..nodes.len()], &mut force[..n])
                }
            };
            if elements.len() < FEW {
                let arrays = forces.chunks_mut(dofs).zip(tangents.chunks_mut(stride));
                energies.extend(elements.clone().zip(arrays).map(one));
            } else {
                let arrays = forces.par_chunks_mut(dofs).zip(tangents.par_chunks_mut(stride));
                elements.clone().into_par_iter().zip(arrays).with_min_len(FEW).map(one).collect_into_vec(&mut energies);
            }
            for (k, (e, stored)) in elements.zip(energies.drain(..)).enumerate() {
                energy += stored.map_err(|inverted| self.inverted(e, inverted))?;
                let nodes = &model.mesh.elements[e].nodes;
                let local = &forces[k * dofs..];
                for (a, &node) in nodes.iter().enumerate() {
                    for i in 0..2 {
                        force[2 * node + i] += local[2 * a + i];
                        self.magnitudes[2 * node + i] += local[2 * a + i].abs();
                    }
                }
                if let Some(tangent) = tangent.as_deref_mut() {
                    let n = nodes.len();
                    let blocks = &self.blocks[self.block_starts[e]..self.block_starts[e + 1]];
                    add_blocks(tangent, blocks, &tangents[k * stride..k * stride + 4 * n * n], n);
                }
            }
        }
        self.buffers = Buffers { forces, tangents, energies };
        Ok(energy)
    }

    fn inverted(&self, element: usize, inverted: InvertedElement) -> TrialFailure {
        let body = self.model.bodies[self.model.body_of_element[element]].name.clone();
        let element = self.model.mesh.element_tags[element];
        TrialFailure::Inverted { element, body, jacobian: inverted.jacobian }
    }

    /// Add one contribution to the forces and the tangent.
    fn add(&mut self, contribution: &Contribution, force: &mut [f64], tangent: Option<&mut SparseMatrix>) {
        let nodes = &contribution.nodes;
        for (a, &node) in nodes.iter().enumerate() {
            for i in 0..2 {
                force[2 * node + i] += contribution.force[2 * a + i];
                self.magnitudes[2 * node + i] += contribution.force[2 * a + i].abs();
            }
        }
        if let Some(tangent) = tangent {
            let pattern = &self.pattern;
            let nodes: Vec<usize> = nodes.iter().map(|&node| self.model.ties.original(node)).collect();
            let block = |row, column| pattern.block(row, column).expect("the pattern was extended to cover this point");
            let blocks: Vec<BlockPosition> =
                nodes.iter().flat_map(|&column| nodes.iter().map(move |&row| block(row, column))).collect();
            add_blocks(tangent, &blocks, contribution.tangent.as_slice(), nodes.len());
        }
    }

    /// Subtract the loads from the forces; returns the loads.
    fn add_loads(
        &mut self,
        trial: Trial,
        u: &[f64],
        x: &Configuration,
        force: &mut [f64],
        tangent: Option<&mut SparseMatrix>,
    ) -> Result<Vec<f64>, TrialFailure> {
        let internal = force.to_vec();
        self.subtract_loads(trial, u, x, force, tangent);
        let loads: Vec<f64> = internal.iter().zip(&*force).map(|(internal, force)| internal - force).collect();
        for (dof, load) in loads.iter().enumerate() {
            if !load.is_finite() {
                return Err(self.undefined(dof, trial.time));
            }
            self.magnitudes[dof] += load.abs();
        }
        Ok(loads)
    }

    fn undefined(&self, dof: usize, time: f64) -> TrialFailure {
        TrialFailure::Undefined { node: self.model.mesh.node_tags[dof / 2], time }
    }

    /// Subtract the loads from the forces.
    fn subtract_loads(
        &mut self,
        trial: Trial,
        u: &[f64],
        x: &Configuration,
        force: &mut [f64],
        mut tangent: Option<&mut SparseMatrix>,
    ) {
        let Trial { old, step, time, .. } = trial;
        for (force, prestress) in force.iter_mut().zip(&self.model.prestress) {
            *force -= prestress;
        }
        for load in &step.loads.dead {
            for &(node, weight, position) in &load.shares {
                force[2 * node + load.component] -= weight * load.amplitude.value(position, time);
            }
        }
        for load in &step.loads.pressures {
            for edge in &load.edges {
                let middle =
                    edge.iter().map(|&node| self.model.mesh.nodes[node]).sum::<Vector2<f64>>() / edge.len() as f64;
                let contribution = follower_pressure(edge, load.amplitude.value(middle, time), x);
                self.add(&contribution, force, tangent.as_deref_mut());
            }
        }
        for spring in &step.loads.springs {
            let position = self.model.mesh.nodes[spring.dof / 2];
            let driver = spring.driver.as_ref().map_or(0.0, |driver| driver.value(position, time));
            force[spring.dof] -= spring.stiffness * (driver - u[spring.dof]);
            if let Some(tangent) = tangent.as_deref_mut() {
                tangent.add_diagonal(self.original(spring.dof), spring.stiffness);
            }
        }
        for &dof in &step.released {
            force[dof] -= old.step_start.reaction[dof] * (1.0 - step.span.share(time));
        }
    }

    /// Subtract the forces of the dashpots, and add the damping of bodies.
    fn add_dashpots(
        &mut self,
        trial: Trial,
        u: &[f64],
        force: &mut [f64],
        mut tangent: Option<&mut SparseMatrix>,
    ) -> Result<(), TrialFailure> {
        let mut damping = vec![0.0; u.len()];
        for dashpot in &trial.step.loads.dashpots {
            let dof = dashpot.dof;
            let driver = dashpot.driver_velocity(self.model.mesh.nodes[dof / 2], trial.time);
            let (velocity, dvelocity) = velocity(&self.model, trial, u, dof);
            let pull = dashpot.coefficient * (driver - velocity);
            if !pull.is_finite() {
                return Err(TrialFailure::Undefined { node: self.model.mesh.node_tags[dof / 2], time: trial.time });
            }
            force[dof] -= pull;
            damping[dof] += pull;
            self.magnitudes[dof] += pull.abs();
            if let Some(tangent) = tangent.as_deref_mut() {
                tangent.add_diagonal(self.original(dof), dashpot.coefficient * dvelocity);
            }
        }
        for Absorber { node, coefficients } in &trial.step.loads.absorbers {
            let rates = [0, 1].map(|i| velocity(&self.model, trial, u, 2 * node + i));
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let (velocity, dvelocity) = rates[j];
                let pull = -coefficients[(i, j)] * velocity;
                force[2 * node + i] -= pull;
                damping[2 * node + i] += pull;
                self.magnitudes[2 * node + i] += pull.abs();
                if let Some(tangent) = tangent.as_deref_mut() {
                    tangent.add_own(self.model.ties.original(*node), (i, j), coefficients[(i, j)] * dvelocity);
                }
            }
        }
        self.stabilize(trial, u, force, tangent.as_deref_mut(), &mut damping);
        self.add_damping(trial, u, force, tangent, &mut damping);
        self.evaluation.damping = damping;
        Ok(())
    }

    /// Subtract the forces of the dashpots that stabilize a static step and fade away in it.
    fn stabilize(
        &mut self,
        trial: Trial,
        u: &[f64],
        force: &mut [f64],
        mut tangent: Option<&mut SparseMatrix>,
        damping: &mut [f64],
    ) {
        self.evaluation.stabilization = 0.0;
        let left = trial.stabilization_left();
        if trial.dt == 0.0 || left == 0.0 {
            return;
        }
        let mut squares = 0.0;
        for (dof, start) in trial.step.stabilization.iter().enumerate() {
            let stiffness = left * start / trial.dt;
            let pull = -stiffness * (u[dof] - trial.old.displacement[dof]);
            force[dof] -= pull;
            damping[dof] += pull;
            self.magnitudes[dof] += pull.abs();
            squares += pull * pull;
            if let Some(tangent) = tangent.as_deref_mut() {
                tangent.add_diagonal(self.original(dof), stiffness);
            }
        }
        self.evaluation.stabilization = squares.sqrt();
    }

    /// Velocities, accelerations, and the out-of-balance force of every dof as if none were prescribed.
    fn balance(&mut self, trial: Trial, u: &[f64], tangent: Option<&mut SparseMatrix>, residual: &mut Vec<f64>) {
        let Trial { old, step, dt, .. } = trial;
        let Some(scheme) = step.scheme.coefficients() else {
            self.evaluation.velocity = vec![0.0; u.len()];
            self.evaluation.acceleration = vec![0.0; u.len()];
            self.evaluation.balance.clone_from(&self.evaluation.force);
            residual.clone_from(&self.evaluation.force);
            return;
        };
        let (velocity, acceleration) = self.rates(trial, u, scheme);
        let blend = |old: f64, new: f64, weight: f64| weight * old + (1.0 - weight) * new;
        let mut weighted: Vec<f64> =
            old.acceleration.iter().zip(&acceleration).map(|(&a0, &a1)| blend(a0, a1, scheme.alpha_m)).collect();
        for Prescribed { dof, .. } in &step.supports {
            weighted[*dof] = blend(old.acceleration[*dof], acceleration[*dof], scheme.alpha_f);
        }
        let mass = self.mass();
        let (inertia, weighted_inertia) = (mass.multiply(&acceleration), mass.multiply(&weighted));
        if let Some(tangent) = tangent {
            let c = (1.0 - scheme.alpha_m) * scheme.dacceleration(dt);
            for value in &mut tangent.values {
                *value *= 1.0 - scheme.alpha_f;
            }
            // A prescribed dof's acceleration is its support's.
            let mut factors = vec![c; u.len()];
            step.supports.iter().for_each(|support| factors[support.dof] = 0.0);
            tangent.add_columns(mass, &factors);
        }
        let force = &self.evaluation.force;
        *residual =
            (0..u.len()).map(|dof| blend(old.force[dof], force[dof], scheme.alpha_f) + weighted_inertia[dof]).collect();
        for (magnitude, inertia) in self.magnitudes.iter_mut().zip(&inertia) {
            *magnitude += inertia.abs();
        }
        self.evaluation.balance = force.iter().zip(&inertia).map(|(force, inertia)| force + inertia).collect();
        self.evaluation.velocity = velocity;
        self.evaluation.acceleration = acceleration;
    }

    /// Velocity and acceleration at `u`; prescribed dofs have those of their supports.
    fn rates(&self, trial: Trial, u: &[f64], scheme: Coefficients) -> (Vec<f64>, Vec<f64>) {
        let Trial { old, step, dt, .. } = trial;
        let free =
            |dof: usize| scheme.rates(u[dof] - old.displacement[dof], (old.velocity[dof], old.acceleration[dof]), dt);
        let (mut velocity, mut acceleration): (Vec<f64>, Vec<f64>) = (0..u.len()).map(free).unzip();
        for support in &step.supports {
            let dof = support.dof;
            let places = trial.thirds(support, &self.model);
            (velocity[dof], acceleration[dof]) = supported_rates(places, old.velocity[dof], dt);
        }
        self.model.ties.spread(2, &mut velocity);
        self.model.ties.spread(2, &mut acceleration);
        (velocity, acceleration)
    }

    /// Replace the equations of prescribed dofs by w (u − ū) = 0, and those of copies.
    fn prescribe(&self, trial: Trial, u: &[f64], tangent: bool, system: &mut System) -> Result<(), TrialFailure> {
        for support in &trial.step.supports {
            let dof = support.dof;
            let target = trial.prescribed(support, &self.model);
            if !target.is_finite() {
                return Err(TrialFailure::Undefined { node: self.model.mesh.node_tags[dof / 2], time: trial.time });
            }
            system.residual[dof] = self.weight * (u[dof] - target);
            if tangent {
                system.tangent.replace_row(dof, self.weight);
            }
        }
        for &(copy, original) in self.model.ties.pairs() {
            for d in 0..2 {
                system.residual[2 * copy + d] = self.weight * (u[2 * copy + d] - u[2 * original + d]);
            }
        }
        if tangent {
            self.tie(&mut system.tangent, self.weight);
        }
        Ok(())
    }

    /// The mass matrix on the current pattern: consistent in the elements, and the point masses on the diagonal.
    pub fn mass(&mut self) -> &SparseMatrix {
        let model = &*self.model.clone();
        let (blocks, starts, pattern) = (&self.blocks, &self.block_starts, &self.pattern);
        self.mass.get_or_insert_with(|| {
            let mut mass = SparseMatrix::zero(pattern.clone());
            for (e, element) in model.mesh.elements.iter().enumerate() {
                let n = element.nodes.len();
                let both = model.element_mass(e).kronecker(&DMatrix::identity(2, 2));
                add_blocks(&mut mass, &blocks[starts[e]..starts[e + 1]], both.as_slice(), n);
            }
            for point in &model.point_masses {
                let nodes = point.nodes.iter().map(|&node| model.ties.original(node));
                let dofs = nodes.flat_map(|node| [2 * node, 2 * node + 1]);
                dofs.for_each(|dof| mass.add_diagonal(dof, point.mass));
            }
            mass
        })
    }
}

/// w: the largest stiffness of the materials and springs; a model of points alone has that of its contacts.
fn weight(model: &Model) -> f64 {
    let materials = model.bodies.iter().map(|body| body.material.stiffness());
    let springs = model.steps.iter().flat_map(|step| step.loads.springs.iter().map(|spring| spring.stiffness));
    let contacts = model.contacts.iter().flat_map(|pair| pair.points.iter().map(|point| pair.alpha_n * point.area));
    let largest = |stiffness: &mut dyn Iterator<Item = f64>| stiffness.reduce(f64::max).filter(|w| *w > 0.0);
    largest(&mut materials.chain(springs)).or_else(|| largest(&mut { contacts })).unwrap_or(1.0)
}

/// v of one dof at the end of the increment, and ∂v/∂u: what the scheme or the support says (see [`Assembler::rates`])
/// or, in statics, the mean of the increment. An increment of no length leaves v as it is.
fn velocity(model: &Model, trial: Trial, u: &[f64], dof: usize) -> (f64, f64) {
    let Trial { old, step, dt, .. } = trial;
    let dof = 2 * model.ties.original(dof / 2) + dof % 2;
    let (increment, before) = (u[dof] - old.displacement[dof], old.velocity[dof]);
    if dt == 0.0 {
        return (before, 0.0);
    }
    let Some(scheme) = step.scheme.coefficients() else { return (increment / dt, 1.0 / dt) };
    match step.supports.binary_search_by_key(&dof, |support| support.dof) {
        Ok(support) => (supported_rates(trial.thirds(&step.supports[support], model), before, dt).0, 0.0),
        Err(_) => (scheme.rates(increment, (before, old.acceleration[dof]), dt).0, scheme.dvelocity(dt)),
    }
}

/// Add a dense tangent of `n` nodes (column-major, two dofs a node) at the given blocks (column by column).
fn add_blocks(matrix: &mut SparseMatrix, blocks: &[BlockPosition], local: &[f64], n: usize) {
    for (columns, blocks) in local.chunks_exact(4 * n).zip(blocks.chunks_exact(n)) {
        for (j, column) in columns.chunks_exact(2 * n).enumerate() {
            for (pair, block) in column.chunks_exact(2).zip(blocks) {
                let target = &mut matrix.values[block.value(0, j)..][..2];
                target[0] += pair[0];
                target[1] += pair[1];
            }
        }
    }
}
