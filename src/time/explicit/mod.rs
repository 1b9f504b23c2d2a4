//! Explicit increments by central differences: [`crate::model::scheme`] has the equations, here are the longest stable increment and
//! the increment itself.
//!
//! ```text
//! Δt ≤ 2/ω,   ω² ≤ max over elements of (λ_e + max over its nodes of k/m)                                    (1)
//! λ_e = ‖A⁴‖^¼ ≥ largest eigenvalue of A = M_e^-½ K_e M_e^-½                                                   (2)
//! k: Σ |w_a| Σ |w_b| max(α_n, α_t) ℓ of the contact points at the node, and its springs                           (3)
//! Δt² ω² + 2 Δt c ≤ 4   or   Δt ≤ 4/(c + √(c² + 4 ω²)),   c: (2) of the viscous K_e                          (4)
//! ```
//! (1) holds because a sum of stiffnesses vibrates no faster than the fastest of its parts, each with its share of the
//! mass (Irons & Treharne), the shares of elements and contact being in the ratio of their ω²; (2) with the Frobenius
//! norm is at most 8^⅛ = 1.3 times the eigenvalue, commonly 1.05; (3) is Gershgorin's theorem. Every contact point that
//! faces the master counts, open or closed. `stability.rs` says when these are found again. (4) takes the place of Δt ≤ 2/ω in a viscous body, whose stress is that of
//! the mean velocity of the increment before, (u₁ − u₀)/Δt: with a damping ratio ζ = c/(2ω) it is 2/ω (√(1 + ζ²) − ζ).
//! Damping by the masses and dashpots act at the end of the increment and cost nothing.
//!
//! Contact answers in each increment as it does in an implicit one: the friction law takes the slip of the whole increment
//! and returns the traction at its end, an elastic predictor and a plastic corrector. No sign of a velocity is asked for, so
//! that stick and slip do not chatter; a point that sticks swings on its contact spring. If that is much stiffer than an
//! element, the swing is faster than any wave of the mesh and stays where it is: an impact rattles, unless the body is
//! viscous.
//!
//! Source: Irons & Treharne (1971), Proc. 3rd Conf. Matrix Methods in Struct. Mech., WPAFB; Belytschko, Liu, Moran &
//! Elkhodary (2014), Nonlinear Finite Elements for Continua and Structures, §6.2.

mod stability;

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;

use std::sync::Arc;

use crate::equations::energy::{contact_energy, friction_dissipation, work_of_drivers, work_of_fits};
use crate::equations::failure::TrialFailure;
use crate::equations::{Assembler, Trial};
use crate::model::boundary::Prescribed;
use crate::model::scheme::{start_acceleration, supported_rates};
use crate::model::state::State;
use crate::model::{Model, Step};
use crate::solve::failure::IncrementFailure;
use stability::Stability;

/// Share of its size that no element changes by more than in an increment: what strikes it is stopped by its stiffness
/// before it is turned inside out.
const MOST_CHANGE: f64 = 0.1;

/// How much shorter increments are after those before collapsed.
const CUT: f64 = 0.5;

/// Increments are not made shorter than this share of the safe ones.
const MOST_CAREFUL: f64 = 0.125;

/// Share of a step's end within which an output falls on it.
const ROUND_OFF: f64 = 1e-9;

/// What explicit increments of one step need besides the state.
#[derive(Clone)]
pub struct Explicit {
    model: Arc<Model>,
    step: Arc<Step>,
    /// Mass of every node, that of copies with the nodes they move with and with the copies as well [M]
    mass: Vec<f64>,
    /// Dashpots, absorbing sides and damping by the masses, one entry a node
    dampers: Vec<Damper>,
    /// Their forces at the last time [F]
    pulls: Vec<Vector2<f64>>,
    /// Viscous forces of the bodies at the last two times, which resist; empty if there are none [F]
    viscous: [Vec<f64>; 2],
    stability: Stability,
    /// Share of the safe increment that is taken: less after a collapse
    care: f64,
    /// The longest increment to take, when last looked at [T]
    stable: f64,
    /// Displacements at the end of the increment that is next
    displacement: Vec<f64>,
    /// Where each support goes in it
    places: Vec<[f64; 4]>,
}

/// C of the force −C v on one node [F T/L].
#[derive(Clone, Copy)]
struct Damper {
    node: usize,
    coefficients: Matrix2<f64>,
}

/// Degrees of freedom that one thread moves at a time.
const CHUNK: usize = 8192;

impl Explicit {
    /// Begin explicit increments, at the start of a step or within it: lump the masses, and find the accelerations that the
    /// loads begin with.
    ///
    /// # Errors
    /// [`IncrementFailure`] when the state cannot be evaluated.
    pub fn begin(
        model: &Arc<Model>,
        step: &Arc<Step>,
        state: &mut State,
        assembler: &mut Assembler,
    ) -> Result<Self, IncrementFailure> {
        Self::with_care(1.0, model, step, state, assembler)
    }

    /// Shorter increments, from the state before others in which the mesh collapsed or the motion grew without bounds;
    /// `false` if they are as short as it makes sense.
    ///
    /// # Errors
    /// As [`Explicit::begin`].
    pub fn more_carefully(&mut self, state: &mut State, assembler: &mut Assembler) -> Result<bool, IncrementFailure> {
        if self.care <= MOST_CAREFUL {
            return Ok(false);
        }
        *self = Self::with_care(CUT * self.care, &self.model.clone(), &self.step.clone(), state, assembler)?;
        Ok(true)
    }

    fn with_care(
        care: f64,
        model: &Arc<Model>,
        step: &Arc<Step>,
        state: &mut State,
        assembler: &mut Assembler,
    ) -> Result<Self, IncrementFailure> {
        let mut explicit = Self {
            model: model.clone(),
            step: step.clone(),
            mass: masses(model),
            dampers: dampers(model, step),
            pulls: Vec::new(),
            viscous: [(); 2].map(|()| vec![0.0; if model.is_viscous() { model.dofs() } else { 0 }]),
            stability: Stability::new(model, state)?,
            care,
            stable: 0.0,
            displacement: state.displacement.clone(),
            places: Vec::new(),
        };
        explicit.stable = explicit.stable_increment(state);
        explicit.start(state, assembler)?;
        Ok(explicit)
    }

    /// The forces and accelerations at the start of the step.
    fn start(&mut self, state: &mut State, assembler: &mut Assembler) -> Result<(), IncrementFailure> {
        let (model, step) = (&*self.model.clone(), &*self.step.clone());
        let still = Trial::new(state, step, state.time, 0.0);
        assembler.forces(still, &state.displacement).map_err(IncrementFailure::Start)?;
        if model.is_viscous() {
            let gathered = assembler.gather_viscous(&state.displacement, &state.velocity, &mut self.viscous[1]);
            gathered.map_err(IncrementFailure::Start)?;
        }
        self.pulls = self.pull(state.time, &state.velocity);
        let damping = self.damping();
        let evaluation = &mut assembler.evaluation;
        model.ties.gather(2, &mut evaluation.force);
        model.ties.gather(2, &mut evaluation.loads);
        let mut acceleration: Vec<f64> = evaluation
            .force
            .iter()
            .zip(&damping)
            .enumerate()
            .map(|(dof, (f, d))| (d - f) / self.mass[dof / 2])
            .collect();
        let first = Trial::new(state, step, state.time + self.stable, self.stable);
        let mut external = evaluation.loads.clone();
        // A freed support has no reaction any more.
        let mut reaction = vec![0.0; model.dofs()];
        for support in &step.supports {
            let dof = support.dof;
            acceleration[dof] = start_acceleration(first.thirds(support, model), self.stable);
            reaction[dof] = evaluation.force[dof] - damping[dof] + self.mass[dof / 2] * acceleration[dof];
            external[dof] += reaction[dof];
        }
        state.reaction = reaction;
        state.force = evaluation.force.iter().zip(&damping).map(|(f, d)| f - d).collect();
        model.ties.spread(2, &mut acceleration);
        state.acceleration = acceleration;
        state.external = external;
        state.damping = damping;
        if state.increment == 0 {
            state.energy.kinetic = self.kinetic_energy(state, self.stable);
            state.energy.contact_elastic = contact_energy(model, &state.contacts);
            state.energy.initial = state.energy.kinetic + state.energy.contact_elastic;
        }
        Ok(())
    }

    /// The safe share of (1), but no more than the step allows [T].
    fn stable_increment(&mut self, state: &State) -> f64 {
        let longest = self.stability.longest_increment(&self.step, &self.mass, state);
        self.safe(longest)
    }

    fn safe(&self, longest: f64) -> f64 {
        (self.step.scheme.safety() * self.care * longest).min(self.step.increments.max)
    }

    /// Equal increments to a time, none longer than is stable. The energies and the damping of the state are complete at the
    /// end only, the work and dissipation in between having been summed.
    ///
    /// # Errors
    /// [`IncrementFailure`] when an element inverts, a friction law fails, a load has no value, or the motion has none.
    pub fn go_to(
        &mut self,
        time: f64,
        state: &mut State,
        assembler: &mut Assembler,
    ) -> Result<usize, IncrementFailure> {
        let mut increments = 0;
        while state.time < time {
            let end = self.next(time, state)?;
            self.advance(end, state, assembler).map_err(IncrementFailure::Start)?;
            increments += 1;
        }
        state.damping = self.damping();
        state.energy.kinetic = self.kinetic_energy(state, state.dt);
        state.energy.contact_elastic = contact_energy(&self.model, &state.contacts);
        match state.energy.kinetic.is_finite() {
            true => Ok(increments),
            false => Err(IncrementFailure::Unbounded),
        }
    }

    /// End of the next increment on the way to a time, and the displacements there. Where an element changes, or a contact
    /// does, the longest stable increment is found again.
    fn next(&mut self, time: f64, state: &State) -> Result<f64, IncrementFailure> {
        let end = part(state.time, time, self.stable);
        let way = self.predict(end, state)?;
        self.stability.moved(way);
        let changed = self.stability.changed(&self.displacement);
        self.stability.look(&changed, state)?;
        match self.stability.contacts_changed(state) {
            true => self.stable = self.stable_increment(state),
            false if changed.is_empty() => return Ok(end),
            // What became longer waits for the next look at all.
            false => self.stable = self.safe(self.stability.longest_of(&changed)).min(self.stable),
        }
        let end = part(state.time, time, self.stable);
        self.predict(end, state)?;
        let excess = self.stability.largest_change(&changed, &self.displacement) / (MOST_CHANGE * self.care);
        if excess <= 1.0 || !excess.is_finite() {
            return Ok(end);
        }
        let end = part(state.time, time, (end - state.time) / excess);
        self.predict(end, state)?;
        Ok(end)
    }

    /// (7), and where the supports go; returns how far two nodes move against each other at most [L].
    fn predict(&mut self, time: f64, state: &State) -> Result<f64, IncrementFailure> {
        let (model, step, dt) = (&*self.model.clone(), &*self.step.clone(), time - state.time);
        let old = (&state.displacement, &state.velocity, &state.acceleration);
        let ways = self.displacement.par_chunks_mut(CHUNK).enumerate().map(|(chunk, u)| {
            let (u0, v, a) = (&old.0[CHUNK * chunk..], &old.1[CHUNK * chunk..], &old.2[CHUNK * chunk..]);
            let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
            let rates = v.chunks_exact(2).zip(a.chunks_exact(2));
            for ((u, u0), (v, a)) in u.chunks_exact_mut(2).zip(u0.chunks_exact(2)).zip(rates) {
                for i in 0..2 {
                    let way = dt * (v[i] + 0.5 * dt * a[i]);
                    u[i] = u0[i] + way;
                    low[i] = if way < low[i] { way } else { low[i] };
                    high[i] = if way > high[i] { way } else { high[i] };
                }
            }
            (low, high)
        });
        let ways: Vec<([f64; 2], [f64; 2])> = ways.collect();
        let mut low = ways.iter().fold([f64::INFINITY; 2], |low, (of, _)| [0, 1].map(|i| low[i].min(of[i])));
        let mut high = ways.iter().fold([f64::NEG_INFINITY; 2], |high, (_, of)| [0, 1].map(|i| high[i].max(of[i])));
        let trial = Trial::new(state, step, time, dt);
        self.places.clear();
        self.places.extend(step.supports.iter().map(|support| trial.thirds(support, model)));
        for (support, places) in step.supports.iter().zip(&self.places) {
            if !places.iter().all(|place| place.is_finite()) {
                let node = model.mesh.node_tags[support.dof / 2];
                return Err(IncrementFailure::Start(TrialFailure::Undefined { node, time }));
            }
            self.displacement[support.dof] = places[3];
            let (i, way) = (support.dof % 2, places[3] - state.displacement[support.dof]);
            (low[i], high[i]) = (low[i].min(way), high[i].max(way));
        }
        model.ties.spread(2, &mut self.displacement);
        Ok((high[0] - low[0]).hypot(high[1] - low[1]))
    }

    /// One increment in place, to the displacements predicted.
    fn advance(&mut self, time: f64, state: &mut State, assembler: &mut Assembler) -> Result<(), TrialFailure> {
        let (model, step) = (&*self.model.clone(), &*self.step.clone());
        let dt = time - state.time;
        let u = std::mem::take(&mut self.displacement);
        let trial = Trial { settles: false, ..Trial::new(state, step, time, dt) };
        assembler.forces(trial, &u)?;
        self.resist(dt, &u, state, assembler)?;
        let evaluation = &mut assembler.evaluation;
        model.ties.gather(2, &mut evaluation.force);
        model.ties.gather(2, &mut evaluation.loads);

        if !model.contacts.is_empty() {
            state.energy.friction_dissipation += friction_dissipation(&state.contacts, &evaluation.contacts);
        }
        let way = |dof: usize, old: &[f64]| u[dof] - old[dof];
        let ways: Vec<f64> = step.supports.iter().map(|support| way(support.dof, &state.displacement)).collect();
        let damped = |damper: &Damper| [0, 1].map(|i| way(2 * damper.node + i, &state.displacement)).into();
        let damped: Vec<Vector2<f64>> = self.dampers.iter().map(damped).collect();
        let mut work = work_of_drivers(model, step, [state.time, time], |dof| way(dof, &state.displacement));
        let mut dissipated = work + self.viscous_work(&u, &state.displacement) - mean_work(&self.pulls, &damped);

        let before: Vec<f64> = step.supports.iter().map(|support| state.velocity[support.dof]).collect();
        work += self.accelerate(dt, state, &evaluation.force, &evaluation.loads, &u);
        std::mem::swap(&mut state.force, &mut evaluation.force);
        std::mem::swap(&mut state.external, &mut evaluation.loads);
        self.damp(time, dt, state);
        for ((support, &places), before) in step.supports.iter().zip(&self.places).zip(before) {
            let dof = support.dof;
            (state.velocity[dof], state.acceleration[dof]) = supported_rates(places, before, dt);
        }
        model.ties.spread(2, &mut state.velocity);
        model.ties.spread(2, &mut state.acceleration);
        self.pulls = self.pull(time, &state.velocity);
        for (damper, pull) in self.dampers.iter().zip(&self.pulls) {
            (0..2).for_each(|i| state.force[2 * damper.node + i] -= pull[i]);
        }
        for (Prescribed { dof, .. }, way) in step.supports.iter().zip(&ways) {
            let reaction = state.force[*dof] + self.mass[dof / 2] * state.acceleration[*dof];
            state.reaction[*dof] = reaction;
            state.external[*dof] += reaction;
            work += 0.5 * reaction * way;
        }
        dissipated -= mean_work(&self.pulls, &damped);

        work += work_of_fits(model, [&state.contacts, &evaluation.contacts], [state.time, time]);
        state.energy.external_work += work;
        state.energy.damping_dissipation += dissipated;
        state.energy.strain = evaluation.strain_energy;
        state.contacts = std::mem::take(&mut evaluation.contacts);
        self.displacement = std::mem::replace(&mut state.displacement, u);
        state.time = time;
        state.dt = dt;
        state.increment += 1;
        Ok(())
    }

    /// (8) for dofs without dashpots; returns the mean work of the external forces but the new reactions.
    fn accelerate(&self, dt: f64, state: &mut State, force: &[f64], loads: &[f64], u: &[f64]) -> f64 {
        let State { displacement, velocity, acceleration, external, .. } = state;
        let chunks = velocity.par_chunks_mut(CHUNK).zip(acceleration.par_chunks_mut(CHUNK)).enumerate();
        let sums = chunks.map(|(chunk, (velocity, acceleration))| {
            let first = CHUNK * chunk;
            let mut work = 0.0;
            for (k, (v, a)) in velocity.iter_mut().zip(acceleration).enumerate() {
                let dof = first + k;
                let new = -force[dof] / self.mass[dof / 2];
                *v += 0.5 * dt * (*a + new);
                *a = new;
                work += 0.5 * (external[dof] + loads[dof]) * (u[dof] - displacement[dof]);
            }
            work
        });
        let sums: Vec<f64> = sums.collect();
        sums.iter().sum()
    }

    /// (8) for dofs with dashpots, of which [`Explicit::accelerate`] knows nothing: (M + ½ Δt C) (a − a_free) = C (v_driver
    /// − v_free) with what it found.
    fn damp(&self, time: f64, dt: f64, state: &mut State) {
        if self.dampers.is_empty() {
            return;
        }
        for (Damper { node, coefficients }, pull) in self.dampers.iter().zip(self.pull(time, &state.velocity)) {
            let inertia = Matrix2::identity() * self.mass[*node] + coefficients * (0.5 * dt);
            let Some(inverse) = inertia.try_inverse() else { continue };
            let change = inverse * pull;
            for i in 0..2 {
                state.acceleration[2 * node + i] += change[i];
                state.velocity[2 * node + i] += 0.5 * dt * change[i];
            }
        }
    }

    /// Force of every damper on its node [F].
    fn pull(&self, time: f64, velocity: &[f64]) -> Vec<Vector2<f64>> {
        let resist = |Damper { node, coefficients }: &Damper| {
            -coefficients * Vector2::new(velocity[2 * node], velocity[2 * node + 1])
        };
        let mut pulls: Vec<Vector2<f64>> = self.dampers.iter().map(resist).collect();
        for dashpot in self.step.loads.dashpots.iter().filter(|dashpot| dashpot.driver.is_some()) {
            let node = self.model.ties.original(dashpot.dof / 2);
            if let Ok(k) = self.dampers.binary_search_by_key(&node, |damper| damper.node) {
                let driver = dashpot.driver_velocity(self.model.mesh.nodes[dashpot.dof / 2], time);
                pulls[k][dashpot.dof % 2] += dashpot.coefficient * driver;
            }
        }
        pulls
    }

    /// Forces of dampers and viscous bodies on all dofs at the last time [F].
    fn damping(&self) -> Vec<f64> {
        let mut damping: Vec<f64> = self.viscous[1].iter().map(|resisting| -resisting).collect();
        damping.resize(self.model.dofs(), 0.0);
        for (damper, pull) in self.dampers.iter().zip(&self.pulls) {
            (0..2).for_each(|i| damping[2 * damper.node + i] += pull[i]);
        }
        damping
    }

    /// Add the viscous forces of the bodies at `u`, under the mean velocity of the increment, to the evaluated forces.
    fn resist(&mut self, dt: f64, u: &[f64], state: &State, assembler: &mut Assembler) -> Result<(), TrialFailure> {
        if !self.model.is_viscous() {
            return Ok(());
        }
        self.viscous.reverse();
        let velocity: Vec<f64> = u.iter().zip(&state.displacement).map(|(new, old)| (new - old) / dt).collect();
        assembler.gather_viscous(u, &velocity, &mut self.viscous[1])?;
        let force = assembler.evaluation.force.iter_mut();
        force.zip(&self.viscous[1]).for_each(|(force, viscous)| *force += viscous);
        Ok(())
    }

    /// What the viscous forces take over an increment: mean force × way [F·L].
    fn viscous_work(&self, u: &[f64], old: &[f64]) -> f64 {
        let [before, now] = &self.viscous;
        let forces = before.iter().zip(now);
        forces.zip(u.iter().zip(old)).map(|((f0, f1), (u1, u0))| 0.5 * (f0 + f1) * (u1 - u0)).sum()
    }

    /// ½ v₋ᵀ M v₊ of the velocities half an increment before and after: by (7) and (8) its change is exactly the mean force
    /// times the way, so that what the audit of energies leaves is not the scheme's own swing, ⅛ Δt² aᵀ M a.
    fn kinetic_energy(&self, state: &State, dt: f64) -> f64 {
        let square = |v: &[f64]| v[0] * v[0] + v[1] * v[1];
        let of = |node: usize| {
            let [v, a] = [&state.velocity, &state.acceleration].map(|rates| &rates[2 * node..2 * node + 2]);
            0.5 * self.mass[node] * (square(v) - 0.25 * dt * dt * square(a))
        };
        let copies: f64 = self.model.ties.pairs().iter().map(|&(copy, _)| of(copy)).sum();
        (0..self.mass.len()).map(of).sum::<f64>() - copies
    }
}

/// End of the first of equal increments from one time to another, none longer than `longest`.
fn part(start: f64, end: f64, longest: f64) -> f64 {
    let left = end - start;
    let count = (left / longest - ROUND_OFF).ceil().max(1.0);
    if count == 1.0 { end } else { start + left / count }
}

/// ½ Σ f·Δu: half the work of forces that act at one end of an increment.
fn mean_work(forces: &[Vector2<f64>], ways: &[Vector2<f64>]) -> f64 {
    forces.iter().zip(ways).map(|(force, way)| 0.5 * force.dot(way)).sum()
}

/// Dashpots, absorbing sides and damping by the masses of each node.
fn dampers(model: &Model, step: &Step) -> Vec<Damper> {
    let mut total: BTreeMap<usize, Matrix2<f64>> = BTreeMap::new();
    for body in model.bodies.iter().filter(|body| body.damping.mass > 0.0) {
        for &e in &body.elements {
            for (&node, mass) in model.mesh.elements[e].nodes.iter().zip(model.element_lumped_mass(e).iter()) {
                let node = model.ties.original(node);
                *total.entry(node).or_default() += Matrix2::from_diagonal_element(body.damping.mass * mass);
            }
        }
    }
    for dashpot in &step.loads.dashpots {
        total.entry(model.ties.original(dashpot.dof / 2)).or_default()[(dashpot.dof % 2, dashpot.dof % 2)] +=
            dashpot.coefficient;
    }
    for absorber in &step.loads.absorbers {
        *total.entry(model.ties.original(absorber.node)).or_default() += absorber.coefficients;
    }
    total.into_iter().map(|(node, coefficients)| Damper { node, coefficients }).collect()
}

/// Mass of every node [M].
fn masses(model: &Model) -> Vec<f64> {
    let mut mass = vec![0.0; model.mesh.nodes.len()];
    for e in 0..model.mesh.elements.len() {
        for (&node, share) in model.mesh.elements[e].nodes.iter().zip(model.element_lumped_mass(e).iter()) {
            mass[node] += share;
        }
    }
    for point in &model.point_masses {
        point.nodes.iter().for_each(|&node| mass[node] += point.mass);
    }
    model.ties.gather(1, &mut mass);
    model.ties.spread(1, &mut mass);
    mass
}
