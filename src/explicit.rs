//! Explicit increments by central differences: [`crate::time`] has the equations, here are the longest stable increment and
//! the increment itself.
//!
//! ```text
//! Δt ≤ 2/ω,   ω² ≤ max over elements of (λ_e + max over its nodes of k/m)                                    (1)
//! λ_e = ‖A⁴‖^¼ ≥ largest eigenvalue of A = M_e^-½ K_e M_e^-½                                                   (2)
//! k: Σ |w_a| Σ |w_b| max(α_n, α_t) ℓ of the contact points at the node, and its springs                           (3)
//! ```
//! (1) holds because a sum of stiffnesses vibrates no faster than the fastest of its parts, each with its share of the
//! mass (Irons & Treharne), the shares of elements and contact being in the ratio of their ω²; (2) with the Frobenius
//! norm is at most 8^⅛ = 1.3 times the eigenvalue, commonly 1.05; (3) is Gershgorin's theorem. Every contact point that
//! faces the master counts, open or closed.
//!
//! Contact answers in each increment as it does in an implicit one: the friction law takes the slip of the whole increment
//! and returns the traction at its end, an elastic predictor and a plastic corrector. No sign of a velocity is asked for, so
//! that stick and slip do not chatter; a point that sticks swings on its contact spring.
//!
//! Source: Irons & Treharne (1971), Proc. 3rd Conf. Matrix Methods in Struct. Mech., WPAFB; Belytschko, Liu, Moran &
//! Elkhodary (2014), Nonlinear Finite Elements for Continua and Structures, §6.2.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{DMatrix, Matrix2, Vector2};
use rayon::prelude::*;

use crate::assembly::{Assembler, Trial};
use crate::contact::surface::Master;
use crate::energy::{contact_energy, friction_dissipation, work_of_drivers};
use crate::error::{StepFailure, TrialFailure};
use crate::model::{Model, Step};
use crate::state::{State, StepStart};
use crate::time::{start_acceleration, supported_rates};

/// Increments after which the longest stable one is looked at again: in that time a deformation changes little.
const LOOK_AGAIN: usize = 200;

/// Share of a step's end within which an output falls on it.
const ROUND_OFF: f64 = 1e-9;

/// What explicit increments of one step need besides the state.
pub struct Explicit<'m> {
    model: &'m Model,
    step: &'m Step,
    /// Mass of every node [M]
    mass: Vec<f64>,
    /// Dashpots and absorbing sides, one entry a node
    dampers: Vec<Damper>,
    /// Longest stable increment when last looked at [T]
    stable: f64,
    /// Increments since then
    since: usize,
    displacement: Vec<f64>,
}

/// C of the force −C v on one node [F T/L].
#[derive(Clone, Copy)]
struct Damper {
    node: usize,
    coefficients: Matrix2<f64>,
}

/// Degrees of freedom that one thread moves at a time.
const CHUNK: usize = 8192;

impl<'m> Explicit<'m> {
    /// Begin a step: lump the masses, and find the accelerations that its loads begin with.
    ///
    /// # Errors
    /// [`StepFailure`] when the initial state cannot be evaluated.
    pub fn begin(
        model: &'m Model,
        step: &'m Step,
        state: &mut State,
        assembler: &mut Assembler,
    ) -> Result<Self, StepFailure> {
        state.step_start =
            Arc::new(StepStart { displacement: state.displacement.clone(), reaction: state.reaction.clone() });
        state.last_increment = None;
        let mut explicit = Self {
            model,
            step,
            mass: masses(model),
            dampers: dampers(step),
            stable: 0.0,
            since: LOOK_AGAIN,
            displacement: state.displacement.clone(),
        };
        explicit.stable = explicit.stable_increment(state)?;
        explicit.since = 0;
        explicit.start(state, assembler)?;
        Ok(explicit)
    }

    /// The forces and accelerations at the start of the step.
    fn start(&self, state: &mut State, assembler: &mut Assembler) -> Result<(), StepFailure> {
        let (model, step) = (self.model, self.step);
        let still = Trial { old: state, step, time: state.time, dt: 0.0 };
        assembler.forces(still, &state.displacement).map_err(StepFailure::Start)?;
        let evaluation = &assembler.evaluation;
        let mut damping = vec![0.0; model.dofs()];
        self.pull(state.time, &state.velocity, &mut damping);
        let mut acceleration: Vec<f64> = evaluation
            .force
            .iter()
            .zip(&damping)
            .enumerate()
            .map(|(dof, (f, d))| (d - f) / self.mass[dof / 2])
            .collect();
        let first = Trial { old: state, step, time: state.time + self.stable, dt: self.stable };
        let mut external = evaluation.loads.clone();
        for support in &step.supports {
            let dof = support.dof;
            acceleration[dof] = start_acceleration(first.thirds(support, model), self.stable);
            external[dof] += evaluation.force[dof] - damping[dof] + self.mass[dof / 2] * acceleration[dof];
        }
        state.force = evaluation.force.iter().zip(&damping).map(|(f, d)| f - d).collect();
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

    /// Equal increments to a time, none longer than is stable. The energies of the state are complete at the end only,
    /// the work and dissipation in between having been summed.
    ///
    /// # Errors
    /// [`StepFailure`] when an element inverts, a friction law fails, a load has no value, or the motion has none.
    pub fn go_to(&mut self, time: f64, state: &mut State, assembler: &mut Assembler) -> Result<usize, StepFailure> {
        let mut increments = 0;
        while state.time < time {
            if self.since >= LOOK_AGAIN {
                self.stable = self.stable_increment(state)?;
                self.since = 0;
            }
            let left = time - state.time;
            let count = (left / self.stable - ROUND_OFF).ceil().max(1.0);
            let end = if count == 1.0 { time } else { state.time + left / count };
            self.advance(end, state, assembler).map_err(StepFailure::Start)?;
            self.since += 1;
            increments += 1;
        }
        state.energy.kinetic = self.kinetic_energy(state, state.dt);
        state.energy.contact_elastic = contact_energy(self.model, &state.contacts);
        match state.energy.kinetic.is_finite() {
            true => Ok(increments),
            false => Err(StepFailure::Unbounded),
        }
    }

    /// One increment in place.
    fn advance(&mut self, time: f64, state: &mut State, assembler: &mut Assembler) -> Result<(), TrialFailure> {
        let (model, step) = (self.model, self.step);
        let dt = time - state.time;
        let mut u = std::mem::take(&mut self.displacement);
        let old = (&state.displacement, &state.velocity, &state.acceleration);
        u.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, u)| {
            let (u0, v, a) = (&old.0[CHUNK * chunk..], &old.1[CHUNK * chunk..], &old.2[CHUNK * chunk..]);
            for (((u, u0), v), a) in u.iter_mut().zip(u0).zip(v).zip(a) {
                *u = u0 + dt * (v + 0.5 * dt * a);
            }
        });
        let trial = Trial { old: state, step, time, dt };
        let places: Vec<[f64; 4]> = step.supports.iter().map(|support| trial.thirds(support, model)).collect();
        for (support, places) in step.supports.iter().zip(&places) {
            if !places.iter().all(|place| place.is_finite()) {
                return Err(TrialFailure::Undefined { node: model.mesh.node_tags[support.dof / 2], time });
            }
            u[support.dof] = places[3];
        }
        assembler.forces(trial, &u)?;
        let evaluation = &mut assembler.evaluation;

        if !model.contacts.is_empty() {
            state.energy.friction_dissipation += friction_dissipation(&state.contacts, &evaluation.contacts);
        }
        let way = |dof: usize, old: &[f64]| u[dof] - old[dof];
        let supported = step.supports.iter().map(|support| support.dof);
        let damped = self.dampers.iter().flat_map(|damper| [2 * damper.node, 2 * damper.node + 1]);
        let special: Vec<(usize, f64)> =
            supported.chain(damped).map(|dof| (dof, way(dof, &state.displacement))).collect();
        let damped = &special[step.supports.len()..];
        let mut dissipated = work_on(&state.damping, damped);
        let mut work = work_of_drivers(model, step, [state.time, time], |dof| way(dof, &state.displacement));
        dissipated -= work;

        let before: Vec<f64> = step.supports.iter().map(|support| state.velocity[support.dof]).collect();
        work += self.accelerate(dt, state, &evaluation.force, &evaluation.loads, &u);
        std::mem::swap(&mut state.force, &mut evaluation.force);
        std::mem::swap(&mut state.external, &mut evaluation.loads);
        self.damp(time, dt, state);
        for ((support, places), before) in step.supports.iter().zip(places).zip(before) {
            let dof = support.dof;
            (state.velocity[dof], state.acceleration[dof]) = supported_rates(places, before, dt);
        }
        if !self.dampers.is_empty() {
            self.pull(time, &state.velocity, &mut state.damping);
            damped.iter().for_each(|&(dof, _)| state.force[dof] -= state.damping[dof]);
        }
        for (support, (dof, way)) in step.supports.iter().zip(&special) {
            let reaction = state.force[*dof] + self.mass[dof / 2] * state.acceleration[*dof];
            state.reaction[support.dof] = reaction;
            state.external[*dof] += reaction;
            work += 0.5 * reaction * way;
        }
        dissipated += work_on(&state.damping, damped);

        state.energy.external_work += work;
        state.energy.damping_dissipation -= dissipated;
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
        let mut pull = std::mem::take(&mut state.damping);
        self.pull(time, &state.velocity, &mut pull);
        for Damper { node, coefficients } in &self.dampers {
            let inertia = Matrix2::identity() * self.mass[*node] + coefficients * (0.5 * dt);
            let Some(inverse) = inertia.try_inverse() else { continue };
            let change = inverse * Vector2::new(pull[2 * node], pull[2 * node + 1]);
            for i in 0..2 {
                state.acceleration[2 * node + i] += change[i];
                state.velocity[2 * node + i] += 0.5 * dt * change[i];
            }
        }
        state.damping = pull;
    }

    /// Write the forces of dashpots and absorbing sides over `pull`, which is zero elsewhere.
    fn pull(&self, time: f64, velocity: &[f64], pull: &mut [f64]) {
        for Damper { node, coefficients } in &self.dampers {
            let force = -coefficients * Vector2::new(velocity[2 * node], velocity[2 * node + 1]);
            (pull[2 * node], pull[2 * node + 1]) = (force.x, force.y);
        }
        for dashpot in &self.step.loads.dashpots {
            pull[dashpot.dof] +=
                dashpot.coefficient * dashpot.driver_velocity(self.model.mesh.nodes[dashpot.dof / 2], time);
        }
    }

    /// ½ v₋ᵀ M v₊ of the velocities half an increment before and after: by (7) and (8) its change is exactly the mean force
    /// times the way, so that what the audit of energies leaves is not the scheme's own swing, ⅛ Δt² aᵀ M a.
    fn kinetic_energy(&self, state: &State, dt: f64) -> f64 {
        let motion = state.velocity.chunks_exact(2).zip(state.acceleration.chunks_exact(2)).zip(&self.mass);
        let square = |v: &[f64]| v[0] * v[0] + v[1] * v[1];
        motion.map(|((v, a), m)| 0.5 * m * (square(v) - 0.25 * dt * dt * square(a))).sum()
    }

    /// The safe share of (1), but no more than the step allows [T].
    fn stable_increment(&self, state: &State) -> Result<f64, StepFailure> {
        let model = self.model;
        let added = self.added_stiffness(state);
        let softness = |node: usize| if self.mass[node] > 0.0 { added[node] / self.mass[node] } else { 0.0 };
        let of_element = |e: usize| {
            let fastest = element_bound(model, e, &state.displacement)?;
            let nodes = model.mesh.elements[e].nodes.iter();
            Ok(fastest + nodes.map(|&node| softness(node)).fold(0.0, f64::max))
        };
        let elements: Vec<Result<f64, TrialFailure>> =
            (0..model.mesh.elements.len()).into_par_iter().with_min_len(64).map(of_element).collect();
        let mut fastest = (0..added.len()).map(softness).fold(0.0, f64::max);
        for bound in elements {
            fastest = bound.map_err(StepFailure::Start)?.max(fastest);
        }
        let safety = self.step.scheme.safety();
        Ok((safety * 2.0 / fastest.sqrt()).min(self.step.increments.max))
    }

    /// k of (3) at every node [F/L].
    fn added_stiffness(&self, state: &State) -> Vec<f64> {
        let model = self.model;
        let x = model.configuration(&state.displacement);
        let mut added = vec![0.0; self.mass.len()];
        for (pair, states) in model.contacts.iter().zip(&state.contacts) {
            for (slave, state) in pair.points.iter().zip(states) {
                let Some(foot) = state.foot else { continue };
                let stiffness = pair.alpha_n.max(pair.law(slave).stiffness()) * slave.current_length(&x);
                let mut weights = slave.position.clone();
                if let Master::Mesh(surface) = &pair.master {
                    weights.extend(surface.segments[foot.segment].position(foot.xi));
                }
                let total: f64 = weights.iter().map(|(_, w)| w.abs()).sum();
                weights.iter().for_each(|(node, w)| added[*node] += stiffness * w.abs() * total);
            }
        }
        self.step.loads.springs.iter().for_each(|spring| added[spring.dof / 2] += spring.stiffness);
        added
    }
}

/// ½ Σ f Δu over some dofs and their ways.
fn work_on(force: &[f64], ways: &[(usize, f64)]) -> f64 {
    ways.iter().map(|&(dof, way)| 0.5 * force[dof] * way).sum()
}

/// Dashpots and absorbing sides of each node.
fn dampers(step: &Step) -> Vec<Damper> {
    let mut total: BTreeMap<usize, Matrix2<f64>> = BTreeMap::new();
    for dashpot in &step.loads.dashpots {
        total.entry(dashpot.dof / 2).or_default()[(dashpot.dof % 2, dashpot.dof % 2)] += dashpot.coefficient;
    }
    for absorber in &step.loads.absorbers {
        *total.entry(absorber.node).or_default() += absorber.coefficients;
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
    mass
}

/// λ_e of (2) at the displacement `u` [1/T²].
fn element_bound(model: &Model, e: usize, u: &[f64]) -> Result<f64, TrialFailure> {
    let nodes = &model.mesh.elements[e].nodes;
    let body = &model.bodies[model.body_of_element[e]];
    let local: Vec<Vector2<f64>> = nodes.iter().map(|&node| Vector2::new(u[2 * node], u[2 * node + 1])).collect();
    let n = 2 * nodes.len();
    let (mut force, mut tangent) = (vec![0.0; n], DMatrix::zeros(n, n));
    let answer = model.solids[e].force_and_tangent(&*body.material, &local, &mut force, tangent.as_mut_slice());
    answer.map_err(|inverted| TrialFailure::Inverted {
        element: model.mesh.element_tags[e],
        body: body.name.clone(),
        jacobian: inverted.jacobian,
    })?;
    let mass = model.element_lumped_mass(e);
    let scaled = DMatrix::from_fn(n, n, |i, j| tangent[(i, j)] / (mass[i / 2] * mass[j / 2]).sqrt());
    let largest = scaled.amax();
    if largest == 0.0 {
        return Ok(0.0);
    }
    let square = (&scaled / largest).pow(2);
    Ok(largest * (&square * &square).norm().powf(0.25))
}
