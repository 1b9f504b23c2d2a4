//! Equilibrium of the initial stress of bodies with their loads.
//!
//! ```text
//! r = f(σ₀) − loads − contact        at u = 0 and the start of the first step, at unsupported dofs
//! ```
//! f(σ₀) are the forces of the initial stress, contact those of initial tractions and fluids. The remaining r accelerates the
//! bodies, or is balanced by deformation in the first static increment.

use nalgebra::Vector2;

use super::boundary::Loads;
use super::element::{Memory, follower_pressure};
use super::text::number;
use super::{Body, Model, Step};
use crate::mesh::configuration::vector;

/// Residual fraction of the forces on a body that causes a warning: stresses and weights are given with a few digits, and straight edges that
/// stand for curves leave more than their round-off.
const OUT_OF_BALANCE: f64 = 1e-4;

/// Resultant that causes one, as a fraction of the loads: of a wrong weight, which is little of the forces between many elements.
const OF_LOADS: f64 = 3e-4;

/// Relative round-off of a resultant.
const ROUND_OFF: f64 = 1e-9;

/// Forces on every dof, and the sum of the magnitudes of their parts [F].
struct Forces {
    sum: Vec<f64>,
    magnitude: Vec<f64>,
    /// That of loads and contacts alone
    loads: Vec<f64>,
}

impl Forces {
    fn add(&mut self, node: usize, force: Vector2<f64>) {
        for i in 0..2 {
            self.sum[2 * node + i] += force[i];
            self.magnitude[2 * node + i] += force[i].abs();
        }
    }
}

/// Imbalance of a body: the resultant, and its ratio to the acting forces.
struct Imbalance {
    resultant: Vector2<f64>,
    /// Norm of all nodal forces
    forces: f64,
    share: f64,
    /// Ratio of the resultant to loads and contact forces
    of_loads: f64,
}

impl Imbalance {
    fn is_worth_telling(&self) -> bool {
        self.share > OUT_OF_BALANCE || self.of_loads > OF_LOADS
    }
}

/// Warnings about bodies whose initial stress is not in equilibrium.
pub(super) fn concerns(model: &Model) -> Vec<String> {
    let Some(step) = model.steps.first() else { return Vec::new() };
    let bodies = || model.bodies.iter().enumerate().filter(|(number, _)| step.has(*number)).map(|(_, body)| body);
    let stressed = || bodies().filter(|body| body.is_stressed());
    if stressed().next().is_none() {
        return Vec::new();
    }
    let [start, end] = [step.span.start, step.span.end].map(|time| forces(model, step, time));
    let concern = |body: &Body| {
        let found = imbalance(model, step, &start, body);
        let later = imbalance(model, step, &end, body);
        found.is_worth_telling().then(|| message(body, &found, &later, step))
    };
    stressed().filter_map(concern).collect()
}

fn message(body: &Body, found: &Imbalance, later: &Imbalance, step: &Step) -> String {
    let rounded = |force: f64| if force.abs() < ROUND_OFF * found.forces { 0.0 } else { force };
    let [x, y, percent] = [rounded(found.resultant.x), rounded(found.resultant.y), 100.0 * found.share].map(number);
    let cure = match !later.is_worth_telling() {
        true => format!(
            "it would be in equilibrium at the end of the step `{}`, whose loads grow from zero: give them as \
             expressions, such as \"-9.81\" for a gravity, which act from the start",
            step.name
        ),
        false => {
            let settle = match step.scheme.is_dynamic() {
                true => "let it settle in a static step before".into(),
                false => {
                    format!("let it settle in step `{}`, at the end of which displacements begin to count", step.name)
                }
            };
            format!(
                "check initial_stress against gravity and the density, loads on free sides, and what contacts carry at the start \
                 (initial, with of_bodies), or {settle}"
            )
        }
    };
    format!(
        "body `{}` is not in equilibrium under its initial stress: the imbalance is {percent} % of the acting forces, \
         with the resultant ({x}, {y}); {cure}",
        body.name
    )
}

/// Forces of the bodies' initial stress minus the loads on them, at a time of the first step.
fn forces(model: &Model, step: &Step, time: f64) -> Forces {
    let none = || vec![0.0; model.dofs()];
    let mut forces = Forces { sum: none(), magnitude: none(), loads: none() };
    let stressed = (0..model.bodies.len()).filter(|&body| model.bodies[body].is_stressed() && step.has(body));
    for (node, force) in stressed.flat_map(|body| of_stress(model, body)) {
        forces.add(node, force);
    }
    let inner = forces.magnitude.clone();
    add_loads(model, &step.loads, time, &mut forces);
    let undeformed = model.mesh.undeformed();
    let contacts = model.contacts.iter().filter(|pair| step.joins(pair));
    for (node, force) in contacts.flat_map(|pair| pair.initial_forces(&undeformed)) {
        forces.add(node, -force);
    }
    for (node, force) in model.prestress.chunks_exact(2).enumerate() {
        forces.add(node, -Vector2::new(force[0], force[1]));
    }
    forces.loads = forces.magnitude.iter().zip(&inner).map(|(all, inner)| all - inner).collect();
    model.ties.gather(2, &mut forces.sum);
    model.ties.gather(2, &mut forces.loads);
    model.ties.gather(2, &mut forces.magnitude);
    forces
}

/// Forces of the initial stress of a body on its nodes, element by element, before anything has moved [F].
pub fn of_stress(model: &Model, body: usize) -> Vec<(usize, Vector2<f64>)> {
    let (initial, material) = (model.initial_memory(), &*model.bodies[body].material);
    let of = |&e: &usize| {
        let (old, nodes) = (model.memories.of(e, &initial), &model.mesh.elements[e].nodes);
        let (mut new, mut force) = (old.to_vec(), vec![0.0; 2 * nodes.len()]);
        let memory = Memory { dt: 0.0, old, new: &mut new };
        let still = vec![Vector2::zeros(); nodes.len()];
        // The law has a response in the undeformed body.
        let _ = model.solids[e].evolve(material, memory, &still, &mut force, None);
        let forces: Vec<_> = force.chunks_exact(2).map(|f| Vector2::new(f[0], f[1])).collect();
        nodes.iter().copied().zip(forces)
    };
    model.bodies[body].elements.iter().flat_map(of).collect()
}

fn add_loads(model: &Model, loads: &Loads, time: f64, forces: &mut Forces) {
    for load in &loads.dead {
        for (node, value) in load.forces(time) {
            let mut force = Vector2::zeros();
            force[load.component] = -value;
            forces.add(node, force);
        }
    }
    let x = model.mesh.undeformed();
    for (load, edge) in loads.pressures.iter().flat_map(|load| load.edges.iter().map(move |edge| (load, edge))) {
        let pressure = follower_pressure(edge, |position| load.amplitude.value(position, time), &x);
        for (a, &node) in edge.iter().enumerate() {
            forces.add(node, vector(pressure.force.as_slice(), a));
        }
    }
    for spring in &loads.springs {
        let driver = spring.driver.as_ref().map_or(0.0, |d| d.value(model.mesh.nodes[spring.dof / 2], time));
        let mut force = Vector2::zeros();
        force[spring.dof % 2] = -spring.stiffness * driver;
        forces.add(spring.dof / 2, force);
    }
}

/// Imbalance of the forces on the free dofs of a body.
fn imbalance(model: &Model, step: &Step, forces: &Forces, body: &Body) -> Imbalance {
    let (mut resultant, mut square, mut all, mut loads) = (Vector2::zeros(), 0.0, 0.0, 0.0);
    for node in model.ties.originals(body.nodes.iter().copied()) {
        let mut free = vector(&forces.sum, node);
        for dof in [2 * node, 2 * node + 1] {
            all += forces.magnitude[dof].powi(2);
            loads += forces.loads[dof];
            if let Ok(k) = step.supports.binary_search_by_key(&dof, |support| support.at.dof) {
                let constrained = step.supports[k].at.vector();
                free -= constrained * constrained.dot(&free);
            }
        }
        resultant += free;
        square += free.norm_squared();
    }
    let share = if square > 0.0 { (square / all).sqrt() } else { 0.0 };
    let forces = all.sqrt();
    let of_loads = if resultant.norm() > ROUND_OFF * forces { resultant.norm() / loads } else { 0.0 };
    Imbalance { resultant: -resultant, forces, share, of_loads }
}
