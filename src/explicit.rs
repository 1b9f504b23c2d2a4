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

use std::sync::Arc;

use nalgebra::{DMatrix, Vector2};
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
    /// Coefficient of the dashpots at every dof [F T/L]
    damping: Vec<f64>,
    /// Longest stable increment when last looked at [T]
    stable: f64,
    /// Increments since then
    since: usize,
    displacement: Vec<f64>,
}

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
        let mut damping = vec![0.0; model.dofs()];
        step.loads.dashpots.iter().for_each(|dashpot| damping[dashpot.dof] += dashpot.coefficient);
        let mut explicit = Self {
            model,
            step,
            mass: masses(model),
            damping,
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
        let damping = self.dashpot_pull(state.time, &state.velocity);
        let mut acceleration: Vec<f64> =
            evaluation.force.iter().zip(&damping).enumerate().map(|(dof, (f, d))| (d - f) / self.mass[dof / 2]).collect();
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
            state.energy.kinetic = self.kinetic_energy(&state.velocity);
            let x = model.configuration(&state.displacement);
            state.energy.contact_elastic = contact_energy(model, &state.contacts, &x);
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
        state.energy.kinetic = self.kinetic_energy(&state.velocity);
        let x = self.model.configuration(&state.displacement);
        state.energy.contact_elastic = contact_energy(self.model, &state.contacts, &x);
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
        let moved = |dof: usize| state.displacement[dof] + dt * (state.velocity[dof] + 0.5 * dt * state.acceleration[dof]);
        u.iter_mut().enumerate().for_each(|(dof, u)| *u = moved(dof));
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

        let x = model.configuration(&u);
        state.energy.friction_dissipation += friction_dissipation(model, &state.contacts, &evaluation.contacts, &x);
        let increment: Vec<f64> = u.iter().zip(&state.displacement).map(|(new, old)| new - old).collect();
        state.energy.external_work += half_work(&state.external, &increment);
        state.energy.damping_dissipation -= half_work(&state.damping, &increment);

        let half: Vec<f64> =
            state.velocity.iter().zip(&state.acceleration).map(|(v, a)| v + 0.5 * dt * a).collect();
        let before: Vec<f64> = step.supports.iter().map(|support| state.velocity[support.dof]).collect();
        let pull = self.dashpot_pull(time, &half);
        for dof in 0..u.len() {
            let inertia = self.mass[dof / 2] + 0.5 * dt * self.damping[dof];
            state.acceleration[dof] = (pull[dof] - evaluation.force[dof]) / inertia;
            state.velocity[dof] = half[dof] + 0.5 * dt * state.acceleration[dof];
        }
        for ((support, places), before) in step.supports.iter().zip(places).zip(before) {
            (state.velocity[support.dof], state.acceleration[support.dof]) = supported_rates(places, before, dt);
        }
        state.damping = self.dashpot_pull(time, &state.velocity);
        state.force.clone_from(&evaluation.force);
        state.external.clone_from(&evaluation.loads);
        state.force.iter_mut().zip(&state.damping).for_each(|(force, pull)| *force -= pull);
        state.reaction.fill(0.0);
        for support in &step.supports {
            let dof = support.dof;
            let reaction = state.force[dof] + self.mass[dof / 2] * state.acceleration[dof];
            state.reaction[dof] = reaction;
            state.external[dof] += reaction;
        }

        let driven = work_of_drivers(model, step, [state.time, time], &increment);
        state.energy.external_work += half_work(&state.external, &increment) + driven;
        state.energy.damping_dissipation += driven - half_work(&state.damping, &increment);
        state.energy.strain = evaluation.strain_energy;
        state.contacts = std::mem::take(&mut evaluation.contacts);
        self.displacement = std::mem::replace(&mut state.displacement, u);
        state.time = time;
        state.dt = dt;
        state.increment += 1;
        Ok(())
    }

    /// c (v_driver − v) of every dof.
    fn dashpot_pull(&self, time: f64, velocity: &[f64]) -> Vec<f64> {
        let mut pull = vec![0.0; velocity.len()];
        for dashpot in &self.step.loads.dashpots {
            let driver = dashpot.driver_velocity(self.model.mesh.nodes[dashpot.dof / 2], time);
            pull[dashpot.dof] += dashpot.coefficient * (driver - velocity[dashpot.dof]);
        }
        pull
    }

    fn kinetic_energy(&self, velocity: &[f64]) -> f64 {
        let of = |(v, m): (&[f64], &f64)| 0.5 * m * (v[0] * v[0] + v[1] * v[1]);
        velocity.chunks_exact(2).zip(&self.mass).map(of).sum()
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

/// ½ Σ f Δu.
fn half_work(force: &[f64], increment: &[f64]) -> f64 {
    force.iter().zip(increment).map(|(f, du)| 0.5 * f * du).sum()
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
