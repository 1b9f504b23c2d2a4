//! One increment of central differences, (7) and (8) of [`crate::model::scheme`], in place.

use nalgebra::Matrix2;
use rayon::prelude::*;

use super::plates::DamperForces;
use super::pressures::moving;
use super::{CHUNK, Explicit};
use crate::equations::damping;
use crate::equations::{Assembler, Evaluation, Trial};
use crate::model::boundary::Absorber;
use crate::model::scheme::{start_acceleration, supported_rates};
use crate::model::support::Direction;
use crate::model::{Model, State, Step};
use crate::solve::conduits::receive;
use crate::solve::failure::IncrementFailure;
use crate::time::accept::{accept, heat, take_stock};
use crate::time::beginning::{keep_to_supports, launch};

impl Explicit {
    /// Sets the initial velocities of nodes at the start of the step; the change of ½ Σ m v² counts as external work.
    pub fn launch(model: &Model, step: &Step, state: &mut State) {
        if step.launch.is_empty() {
            return;
        }
        let mass = masses(model);
        let before = energy_of_motion(model, &mass, &state.velocity);
        launch(model, step, state);
        // The energy audit of a run starts with the initial motion.
        if state.increment > 0 {
            let change = energy_of_motion(model, &mass, &state.velocity) - before;
            state.energy.external_work += change;
            state.energy.kinetic += change;
        }
    }

    /// After implicit increments the velocities have the kinetic energy of lumped masses; the change of kinetic energy by
    /// lumping counts as external work.
    pub fn lump(&self, state: &mut State) {
        if state.energy.kinetic > 0.0 {
            let kinetic = self.kinetic_energy(state, self.stable);
            state.energy.external_work += kinetic - state.energy.kinetic;
            state.energy.kinetic = kinetic;
        }
    }

    /// Computes the forces and accelerations at the start of the step.
    pub(super) fn start(&mut self, state: &mut State, assembler: &mut Assembler) -> Result<(), IncrementFailure> {
        let (model, step) = (&*self.model.clone(), &*self.step.clone());
        keep_to_supports(model, step, self.stable, state);
        let still = Trial::new(state, step, state.time, 0.0);
        assembler.evaluation.damping.fill(0.0);
        if model.is_viscous(step) {
            // Viscous stress is evaluated with the velocity of the previous increment: v₁ = v½ + ½ Δt a₁.
            let rates = state.velocity.iter().zip(&state.acceleration);
            self.mean_velocity.clear();
            self.mean_velocity.extend(rates.map(|(v, a)| v - 0.5 * state.dt * a));
        }
        let velocity = model.is_viscous(step).then_some(&self.mean_velocity[..]);
        assembler.forces(still, &state.displacement, velocity).map_err(IncrementFailure::Start)?;
        let found = &mut assembler.evaluation;
        heat(step, found, state);
        self.add_damper_forces(state.time, &state.velocity, found);
        let moving = 2 * moving(model);
        found.force[moving..].fill(0.0);
        let accelerations = found.force[..moving].iter().enumerate().map(|(dof, force)| -force / self.mass[dof / 2]);
        state.acceleration = accelerations.collect();
        state.acceleration.resize(found.force.len(), 0.0);
        state.force.clone_from(&found.force);
        state.damping.clone_from(&found.damping);
        state.external.clone_from(&found.loads);
        let first = Trial::new(state, step, state.time + self.stable, self.stable);
        let starts: Vec<f64> =
            step.supports.iter().map(|support| start_acceleration(first.thirds(support, model), self.stable)).collect();
        // A released support has no reaction any more.
        state.reaction.fill(0.0);
        self.plates.begin(0.0, state);
        self.plates.accelerate(model, 0.0, &self.displacement, &found.force, |k| starts[k], state);
        step.supports.iter().zip(&starts).for_each(|(support, start)| support.at.set(*start, &mut state.acceleration));
        self.plates.spread(model, &self.displacement, state);
        for (support, start) in step.supports.iter().zip(starts) {
            let at = support.at;
            let of_plate = self.plates.reaction(at, &state.force, &state.acceleration);
            let reaction = of_plate.unwrap_or_else(|| at.of(&state.force) + self.mass[at.node()] * start);
            at.put(reaction, &mut state.reaction);
            at.add(reaction, &mut state.external);
        }
        model.ties.spread(2, &mut state.acceleration);
        if state.increment == 0 {
            take_stock(model, self.kinetic_energy(state, self.stable), state);
        }
        Ok(())
    }

    /// ½ v₋ᵀ M v₊ of the velocities half an increment before and after: by (7) and (8) its change is exactly the mean force
    /// times the displacement increment, so the energy audit is free of the scheme's own oscillation ⅛ Δt² aᵀ M a [F·L].
    pub(super) fn kinetic_energy(&self, state: &State, dt: f64) -> f64 {
        let square = |v: &[f64]| v[0] * v[0] + v[1] * v[1];
        let of = |node: usize| {
            let [v, a] = [&state.velocity, &state.acceleration].map(|rates| &rates[2 * node..2 * node + 2]);
            0.5 * self.mass[node] * (square(v) - 0.25 * dt * dt * square(a))
        };
        let copies: f64 = self.model.ties.pairs().iter().map(|&(copy, _)| of(copy)).sum();
        (0..self.mass.len()).map(of).sum::<f64>() - copies + self.plates.turning_energy(state, dt)
    }

    /// Makes one increment to the predicted displacements.
    pub(super) fn advance(
        &mut self,
        time: f64,
        state: &mut State,
        assembler: &mut Assembler,
    ) -> Result<(), IncrementFailure> {
        let (model, step) = (&*self.model.clone(), &*self.step.clone());
        let dt = time - state.time;
        let is_viscous = model.is_viscous(step);
        let mut mean_velocity = std::mem::take(&mut self.mean_velocity);
        if is_viscous {
            let ways = self.displacement.iter().zip(&state.displacement);
            mean_velocity.clear();
            mean_velocity.extend(ways.map(|(new, old)| (new - old) / dt));
        }
        let velocity = is_viscous.then_some(&mean_velocity[..]);
        let arrived = self.forces_in_water(time, velocity, state, assembler);
        self.mean_velocity = mean_velocity;
        let arrived = arrived?;
        if !is_viscous && !self.dampers.is_empty() {
            assembler.evaluation.damping.fill(0.0);
        }
        let found = &mut assembler.evaluation;
        self.plates.begin(dt, state);
        self.accelerate(dt, state, &found.force);
        let (places, supported) = (&self.places, |(places, before)| supported_rates(places, before, dt).1);
        self.plates.accelerate(model, dt, &self.displacement, &found.force, |k| supported(places[k]), state);
        self.damp(time, dt, state);
        for (support, &(places, before)) in step.supports.iter().zip(&self.places) {
            let (velocity, acceleration) = supported_rates(places, before, dt);
            support.at.set(velocity, &mut state.velocity);
            support.at.set(acceleration, &mut state.acceleration);
        }
        model.ties.spread(2, &mut state.velocity);
        model.ties.spread(2, &mut state.acceleration);
        self.plates.spread(model, &self.displacement, state);
        self.add_damper_forces(time, &state.velocity, found);
        let reaction = |at: Direction| {
            let of_plate = self.plates.reaction(at, &found.force, &state.acceleration);
            of_plate.unwrap_or_else(|| at.of(&found.force) + self.mass[at.node()] * at.of(&state.acceleration))
        };
        found.reactions.clear();
        found.reactions.extend(step.supports.iter().map(|support| reaction(support.at)));
        accept(model, step, time, &mut self.displacement, found, state);
        self.note_rates(&self.displacement, state);
        receive(model, arrived, state);
        Ok(())
    }

    /// (8) for dofs without dashpots.
    fn accelerate(&self, dt: f64, state: &mut State, force: &[f64]) {
        let State { velocity, acceleration, .. } = state;
        let moving = 2 * moving(&self.model);
        let chunks = velocity[..moving].par_chunks_mut(CHUNK).zip(acceleration[..moving].par_chunks_mut(CHUNK));
        let chunks = chunks.zip(force.par_chunks(CHUNK).zip(self.mass.par_chunks(CHUNK / 2)));
        chunks.for_each(|((velocity, acceleration), (force, mass))| {
            let rates = velocity.chunks_exact_mut(2).zip(acceleration.chunks_exact_mut(2));
            for ((v, a), (force, mass)) in rates.zip(force.chunks_exact(2).zip(mass)) {
                for i in 0..2 {
                    let new = -force[i] / mass;
                    v[i] += 0.5 * dt * (a[i] + new);
                    a[i] = new;
                }
            }
        });
    }

    /// (8) for dofs with dashpots, which [`Explicit::accelerate`] ignores: (M + ½ Δt C) (a − a_free) = C (v_driver − v_free)
    /// with its result a_free.
    fn damp(&mut self, time: f64, dt: f64, state: &mut State) {
        damping::damper_forces(&self.model, &self.step, &self.dampers, time, &state.velocity, &mut self.forces);
        let alone = self.dampers.iter().zip(&self.forces).filter(|(damper, _)| !self.plates.has(damper.node));
        for (Absorber { node, coefficients }, force) in alone {
            let inertia = Matrix2::identity() * self.mass[*node] + coefficients * (0.5 * dt);
            let Some(inverse) = inertia.try_inverse() else { continue };
            let change = inverse * force;
            for i in 0..2 {
                state.acceleration[2 * node + i] += change[i];
                state.velocity[2 * node + i] += 0.5 * dt * change[i];
            }
        }
        let damping = DamperForces { dampers: &self.dampers, forces: &self.forces };
        self.plates.damp(&self.model, dt, damping, &self.displacement, &self.mass, state);
    }

    /// Subtracts the damper forces at a velocity from the forces found, and books their work as damping.
    pub(super) fn add_damper_forces(&mut self, time: f64, velocity: &[f64], found: &mut Evaluation) {
        damping::damper_forces(&self.model, &self.step, &self.dampers, time, velocity, &mut self.forces);
        for (damper, force) in self.dampers.iter().zip(&self.forces) {
            for i in 0..2 {
                found.force[2 * damper.node + i] -= force[i];
                found.damping[2 * damper.node + i] += force[i];
            }
        }
        [&mut found.force, &mut found.damping].into_iter().for_each(|forces| self.model.linkage.gather(forces));
    }
}

/// Mass of every node [M].
pub(super) fn masses(model: &Model) -> Vec<f64> {
    let mut mass = vec![0.0; model.mesh.nodes.len()];
    for e in 0..model.mesh.elements.len() {
        for (&node, share) in model.mesh.elements[e].nodes.iter().zip(model.element_lumped_mass(e).iter()) {
            mass[node] += share;
        }
    }
    for point in &model.point_masses {
        point.nodes.iter().for_each(|&node| mass[node] += point.mass);
    }
    for bar in &model.bars {
        bar.nodal_masses(&model.massless).for_each(|(node, own)| mass[node] += own);
    }
    model.mesh.rigid_bodies.iter().for_each(|body| mass[body.turning] += body.turning_mass());
    model.ties.gather(1, &mut mass);
    model.ties.spread(1, &mut mass);
    mass
}

/// ½ Σ m v² [F·L].
fn energy_of_motion(model: &Model, mass: &[f64], velocity: &[f64]) -> f64 {
    let of = |node: usize| 0.5 * mass[node] * (velocity[2 * node].powi(2) + velocity[2 * node + 1].powi(2));
    let copies: f64 = model.ties.pairs().iter().map(|&(copy, _)| of(copy)).sum();
    (0..mass.len()).map(of).sum::<f64>() - copies
}
