//! Bars term: forces of segments, angles and bonds of [`crate::bars`], and the energies that they store and dissipate.

use super::sums::{Dependence, Sums};
use super::trial::Trial;
use crate::bars::grip::Grip;
use crate::bars::{Bar, BarState};
use crate::laws::bulk::CauchyStress;
use crate::model::{Model, Step};

/// The tangent depends on the displacements, if there is any bar.
pub(super) fn dependence(model: &Model) -> Dependence {
    if model.bars.is_empty() { Dependence::Nothing } else { Dependence::Displacement }
}

/// Sums of the energies of all bars in an increment [F·L].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct BarEnergies {
    /// stored by stretching and bending
    pub stored: f64,
    /// dissipated by yielding
    pub plastic: f64,
    /// work of jacks
    pub jacked: f64,
}

/// Adds the forces of all bars that are there and, on request, their tangents; their states are left in `states`.
pub(super) fn add(model: &Model, trial: Trial, u: &[f64], states: &mut Vec<BarState>, sums: &mut Sums) -> BarEnergies {
    let mut energies = BarEnergies::default();
    states.clear();
    let share = elapsed(trial);
    let (mut force, mut tangent) = (Vec::new(), Vec::new());
    for (k, (bar, old)) in model.bars.iter().zip(&trial.old.bars).enumerate() {
        if !trial.step.bars.has(k) {
            states.push(BarState { plastic: 0.0, friction: 0.0, jacked: 0.0, ..old.clone() });
            continue;
        }
        let jack = trial.step.bars.jack(k, old, share);
        let pressures = pressures(model, trial, bar);
        let state = bar.respond(old, u, jack, &pressures, |nodes, answer, vectors| {
            vectors.forces(answer, &mut force);
            sums.push(nodes, &force);
            if sums.tangent.is_some() {
                vectors.tangent(answer, &mut tangent);
                sums.couple(nodes, &tangent);
            }
        });
        energies.stored += state.strain;
        energies.plastic += state.plastic;
        energies.jacked += state.jacked;
        states.push(state);
    }
    energies
}

/// Adds the viscous forces of bars that damp by their stiffness, at displacements and velocities with ∂v/∂u, and subtracts them from the
/// `damping` on the nodes.
pub(super) fn resist(
    model: &Model,
    trial: Trial,
    [u, velocity, dvelocity]: [&[f64]; 3],
    damping: &mut [f64],
    sums: &mut Sums,
) {
    let (mut force, mut tangent, mut by_rate) = (Vec::new(), Vec::new(), Vec::new());
    for (k, bar) in model.bars_in(trial.step).filter(|(_, bar)| bar.retardation > 0.0) {
        bar.resist(&trial.old.bars[k], [u, velocity], |vectors, [place, rate]| {
            let nodes = vectors.nodes();
            vectors.forces(&place, &mut force);
            sums.push(nodes, &force);
            for (node, force) in nodes.iter().zip(force.chunks_exact(2)) {
                (0..2).for_each(|i| damping[2 * node + i] -= force[i]);
            }
            if sums.tangent.is_none() {
                return;
            }
            vectors.tangent(&place, &mut tangent);
            vectors.tangent(&rate, &mut by_rate);
            let columns = tangent.chunks_exact_mut(2 * nodes.len()).zip(by_rate.chunks_exact(2 * nodes.len()));
            for (column, (own, by_rate)) in columns.enumerate() {
                let factor = dvelocity[2 * nodes[column / 2] + column % 2];
                own.iter_mut().zip(by_rate).for_each(|(own, by_rate)| *own += by_rate * factor);
            }
            sums.couple(nodes, &tangent);
        });
    }
}

/// Pressure of the bodies across a bar at its bonded points, at the start of an increment: mean over the element; empty where it does not
/// count [F/L²].
fn pressures(model: &Model, Trial { old, .. }: Trial, bar: &Bar) -> Vec<f64> {
    if bar.grips.iter().all(|grip| grip.mu == 0.0) {
        return Vec::new();
    }
    let pressure = |grip: &Grip| {
        let e = grip.element;
        let memory = model.memories.of(e, &old.memory);
        let u = model.mesh.vectors(e, &old.displacement);
        // Accepted states contain no element whose material law fails.
        let stresses = model.solid(old, e).stresses(&*model.body_of(e).material, memory, &u).unwrap_or_default();
        let n = grip.normal_direction(&old.displacement);
        let across = |stress: &CauchyStress| {
            let [xx, yy, _, xy] = stress.components();
            -(n.x * n.x * xx + n.y * n.y * yy + 2.0 * n.x * n.y * xy)
        };
        let sum: f64 = stresses.iter().map(across).sum();
        if stresses.is_empty() { 0.0 } else { sum / stresses.len() as f64 }
    };
    bar.grips.iter().map(pressure).collect()
}

/// Share of the rest of the step that an increment covers.
fn elapsed(Trial { old, step, time, .. }: Trial) -> f64 {
    let rest = step.span.end - old.time;
    if rest > 0.0 { ((time - old.time) / rest).clamp(0.0, 1.0) } else { 1.0 }
}

/// Energy stored in the bond of all bars [F·L].
pub fn bonded(states: &[BarState]) -> f64 {
    states.iter().map(|state| state.bonded).sum()
}

/// Energy dissipated by bond in the last increment [F·L].
pub(super) fn dissipated(states: &[BarState]) -> f64 {
    states.iter().map(|state| state.friction).sum()
}

/// Nodes of bars that belong to no element, and all others of those bars: parts of the equilibrium.
pub(super) fn own_nodes(model: &Model) -> impl Iterator<Item = &Vec<usize>> {
    model.bars.iter().map(|bar| &bar.own).filter(|own| !own.is_empty())
}

/// Squares of the stiffness of bars at every node, per length of round-off and per displacement: as [`super::convergence`] counts
/// those of elements [F², F²/L²].
pub(super) fn stiffness(model: &Model, step: Option<&Step>, mut add: impl FnMut(usize, [f64; 2])) {
    let there = |k: usize| step.is_none_or(|step| step.bars.has(k));
    for (_, bar) in model.bars.iter().enumerate().filter(|(k, _)| there(*k)) {
        for segment in &bar.segments {
            let l = segment.length;
            let stiff = bar.ea / l + bar.ei / (l * l * l);
            let per_length = stiff * l;
            let both = [per_length * per_length, stiff * stiff];
            segment.vectors.nodes().iter().for_each(|&node| add(node, both));
        }
        for grip in &bar.grips {
            let stiff = grip.length * (grip.bond.stiffness() + grip.normal);
            grip.vectors.nodes().iter().for_each(|&node| add(node, [0.0, stiff * stiff]));
        }
    }
}
