//! One increment of central differences, (7) and (8) of [`crate::model::scheme`], in place.

use nalgebra::Matrix2;
use rayon::prelude::*;

use super::{CHUNK, Explicit};
use crate::equations::dampers::{self, NodeDamper};
use crate::equations::failure::TrialFailure;
use crate::equations::{Assembler, Evaluation, Trial};
use crate::model::Model;
use crate::model::scheme::supported_rates;
use crate::model::state::State;
use crate::time::accept::accept;

impl Explicit {
    /// One increment to the displacements predicted.
    pub(super) fn advance(
        &mut self,
        time: f64,
        state: &mut State,
        assembler: &mut Assembler,
    ) -> Result<(), TrialFailure> {
        let (model, step) = (&*self.model.clone(), &*self.step.clone());
        let dt = time - state.time;
        if model.is_viscous() {
            let ways = self.displacement.iter().zip(&state.displacement);
            self.mean_velocity.iter_mut().zip(ways).for_each(|(velocity, (new, old))| *velocity = (new - old) / dt);
        }
        let velocity = model.is_viscous().then_some(&self.mean_velocity[..]);
        assembler.forces(
            Trial { settles: false, ..Trial::new(state, step, time, dt) },
            &self.displacement,
            velocity,
        )?;
        if velocity.is_none() && !self.dampers.is_empty() {
            assembler.evaluation.damping.fill(0.0);
        }
        let found = &mut assembler.evaluation;
        self.accelerate(dt, state, &found.force);
        self.damp(time, dt, state);
        for (support, &(places, before)) in step.supports.iter().zip(&self.places) {
            let dof = support.dof;
            (state.velocity[dof], state.acceleration[dof]) = supported_rates(places, before, dt);
        }
        model.ties.spread(2, &mut state.velocity);
        model.ties.spread(2, &mut state.acceleration);
        self.add_pulls(time, &state.velocity, found);
        let reaction = |dof: usize| found.force[dof] + self.mass[dof / 2] * state.acceleration[dof];
        found.reactions.clear();
        found.reactions.extend(step.supports.iter().map(|support| reaction(support.dof)));
        accept(model, step, time, &mut self.displacement, found, state);
        Ok(())
    }

    /// (8) for dofs without dashpots.
    fn accelerate(&self, dt: f64, state: &mut State, force: &[f64]) {
        let State { velocity, acceleration, .. } = state;
        let chunks = velocity.par_chunks_mut(CHUNK).zip(acceleration.par_chunks_mut(CHUNK));
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

    /// (8) for dofs with dashpots, of which [`Explicit::accelerate`] knows nothing: (M + ½ Δt C) (a − a_free) = C (v_driver
    /// − v_free) with what it found.
    fn damp(&mut self, time: f64, dt: f64, state: &mut State) {
        dampers::pull(&self.model, &self.step, &self.dampers, time, &state.velocity, &mut self.pulls);
        for (NodeDamper { node, coefficients }, pull) in self.dampers.iter().zip(&self.pulls) {
            let inertia = Matrix2::identity() * self.mass[*node] + coefficients * (0.5 * dt);
            let Some(inverse) = inertia.try_inverse() else { continue };
            let change = inverse * pull;
            for i in 0..2 {
                state.acceleration[2 * node + i] += change[i];
                state.velocity[2 * node + i] += 0.5 * dt * change[i];
            }
        }
    }

    /// Subtract the forces of the dampers at a velocity from what was found, and count them as damping.
    pub(super) fn add_pulls(&mut self, time: f64, velocity: &[f64], found: &mut Evaluation) {
        dampers::pull(&self.model, &self.step, &self.dampers, time, velocity, &mut self.pulls);
        for (damper, pull) in self.dampers.iter().zip(&self.pulls) {
            for i in 0..2 {
                found.force[2 * damper.node + i] -= pull[i];
                found.damping[2 * damper.node + i] += pull[i];
            }
        }
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
    model.ties.gather(1, &mut mass);
    model.ties.spread(1, &mut mass);
    mass
}

/// ½ v₋ᵀ M v₊ of the velocities half an increment before and after: by (7) and (8) its change is exactly the mean force
/// times the way, so that what the audit of energies leaves is not the scheme's own swing, ⅛ Δt² aᵀ M a [F·L].
pub(super) fn kinetic_energy(model: &Model, mass: &[f64], state: &State, dt: f64) -> f64 {
    let square = |v: &[f64]| v[0] * v[0] + v[1] * v[1];
    let of = |node: usize| {
        let [v, a] = [&state.velocity, &state.acceleration].map(|rates| &rates[2 * node..2 * node + 2]);
        0.5 * mass[node] * (square(v) - 0.25 * dt * dt * square(a))
    };
    let copies: f64 = model.ties.pairs().iter().map(|&(copy, _)| of(copy)).sum();
    (0..mass.len()).map(of).sum::<f64>() - copies
}
