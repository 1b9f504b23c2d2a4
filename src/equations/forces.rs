//! Forces alone, as explicit increments need them: no tangent, and sums that run in parallel over the nodes.

use nalgebra::Vector2;
use rayon::prelude::*;

use super::{Assembler, FEW, Trial};
use crate::contact::pair::Presumption;
use crate::equations::failure::TrialFailure;
use crate::laws::bulk::InvertedElement;
use crate::model::Model;

/// The forces of all elements on their nodes, and where each node finds its own.
#[derive(Clone, Debug)]
pub(super) struct Gather {
    /// Places of an element in `forces`
    stride: usize,
    /// Where the places of each node start, and where the last one's end
    starts: Vec<usize>,
    /// Places in `forces`, in the order of the elements
    places: Vec<usize>,
    forces: Vec<Vector2<f64>>,
    energies: Vec<Result<f64, InvertedElement>>,
}

/// Nodes whose sums are done sooner than another thread wakes up.
const FEW_NODES: usize = 1024;

impl Gather {
    pub(super) fn new(model: &Model) -> Self {
        let elements = &model.mesh.elements;
        let stride = elements.iter().map(|element| element.nodes.len()).max().unwrap_or(0);
        let mut starts = vec![0; model.mesh.nodes.len() + 1];
        elements.iter().flat_map(|element| &element.nodes).for_each(|&node| starts[node + 1] += 1);
        (1..starts.len()).for_each(|node| starts[node] += starts[node - 1]);
        let mut next = starts.clone();
        let mut places = vec![0; *starts.last().unwrap_or(&0)];
        for (e, element) in elements.iter().enumerate() {
            for (a, &node) in element.nodes.iter().enumerate() {
                places[next[node]] = e * stride + a;
                next[node] += 1;
            }
        }
        let forces = vec![Vector2::zeros(); elements.len() * stride];
        Self { stride, starts, places, forces, energies: Vec::new() }
    }
}

/// Values of an element's nodes, from those of all dofs.
fn nodal(model: &Model, e: usize, all: &[f64]) -> [Vector2<f64>; 9] {
    let mut local = [Vector2::zeros(); 9];
    for (local, &node) in local.iter_mut().zip(&model.mesh.elements[e].nodes) {
        *local = Vector2::new(all[2 * node], all[2 * node + 1]);
    }
    local
}

impl Assembler {
    /// Internal, contact and external forces at the displacement `u`, without those of dashpots, and everything else that
    /// an accepted state takes over from the evaluation but rates and reactions.
    ///
    /// # Errors
    /// [`TrialFailure`] when an element inverts, a friction law fails, or a load has no value.
    pub fn forces(&mut self, trial: Trial, u: &[f64]) -> Result<(), TrialFailure> {
        let responses = self.interfaces(trial, u, |_, _| Presumption::default())?;
        let clock = std::time::Instant::now();
        let mut force = std::mem::take(&mut self.evaluation.force);
        force.resize(u.len(), 0.0);
        let strain_energy = self.gather_solids(u, &mut force)?;
        for closed in responses.iter().flatten().filter_map(|(_, closed)| closed.as_ref()) {
            let contribution = &closed.contribution;
            for (a, &node) in contribution.nodes.iter().enumerate() {
                force[2 * node] += contribution.force[2 * a];
                force[2 * node + 1] += contribution.force[2 * a + 1];
            }
        }
        let mut loads = std::mem::take(&mut self.evaluation.loads);
        loads.clear();
        loads.resize(u.len(), 0.0);
        let model = self.model.clone();
        self.subtract_loads(trial, u, &model.configuration(u), &mut loads, None);
        for (dof, (load, force)) in loads.iter_mut().zip(&mut force).enumerate() {
            *force += *load;
            *load = -*load;
            if !load.is_finite() {
                return Err(self.undefined(dof, trial.time));
            }
        }
        self.evaluation.loads = loads;
        self.evaluation.contacts =
            responses.into_iter().map(|pair| pair.into_iter().map(|(state, _)| state).collect()).collect();
        self.evaluation.strain_energy = strain_energy;
        self.evaluation.force = force;
        self.seconds.assembly += clock.elapsed().as_secs_f64();
        Ok(())
    }

    /// Write the internal forces of the solids over `force`; returns the stored energy.
    pub fn gather_solids(&mut self, u: &[f64], force: &mut [f64]) -> Result<f64, TrialFailure> {
        let model = &*self.model.clone();
        let one = |e: usize, forces: &mut [Vector2<f64>]| {
            let local = nodal(model, e, u);
            let material = &*model.bodies[model.body_of_element[e]].material;
            model.solids[e].nodal_forces(material, &local[..forces.len()], forces)
        };
        self.gather_elements(one, force)
    }

    /// Write the viscous forces of the bodies at displacements `u` and velocities `v` over `force`.
    ///
    /// # Errors
    /// None: a viscous stress needs no volume.
    pub fn gather_viscous(&mut self, u: &[f64], v: &[f64], force: &mut [f64]) -> Result<(), TrialFailure> {
        let model = &*self.model.clone();
        let one = |e: usize, forces: &mut [Vector2<f64>]| {
            let body = &model.bodies[model.body_of_element[e]];
            match body.damping.stiffness > 0.0 {
                true => {
                    let [u, v] = [u, v].map(|all| nodal(model, e, all));
                    let n = forces.len();
                    model.solids[e].viscous_forces(
                        (&*body.material, body.damping.stiffness),
                        [&u[..n], &v[..n]],
                        forces,
                    );
                }
                false => forces.fill(Vector2::zeros()),
            }
            Ok(0.0)
        };
        self.gather_elements(one, force).map(drop)
    }

    /// Write the sums at the nodes of what every element puts there over `force`; returns the sum of what it says.
    fn gather_elements(
        &mut self,
        element: impl Fn(usize, &mut [Vector2<f64>]) -> Result<f64, InvertedElement> + Sync,
        force: &mut [f64],
    ) -> Result<f64, TrialFailure> {
        let model = &*self.model.clone();
        let Gather { stride, starts, places, forces, energies } = self.gather.get_or_insert_with(|| Gather::new(model));
        let one =
            |(e, forces): (usize, &mut [Vector2<f64>])| element(e, &mut forces[..model.mesh.elements[e].nodes.len()]);
        let elements = forces.par_chunks_mut((*stride).max(1)).enumerate().with_min_len(FEW);
        elements.map(one).collect_into_vec(energies);
        let sum = |(node, force): (usize, &mut [f64])| {
            let of = &places[starts[node]..starts[node + 1]];
            let total: Vector2<f64> = of.iter().map(|&place| forces[place]).sum();
            (force[0], force[1]) = (total.x, total.y);
        };
        force.par_chunks_mut(2).enumerate().with_min_len(FEW_NODES).for_each(sum);
        let mut energy = 0.0;
        let failed = energies.iter().enumerate().find_map(|(e, stored)| match stored {
            Ok(stored) => {
                energy += stored;
                None
            }
            Err(inverted) => Some((e, *inverted)),
        });
        match failed {
            None => Ok(energy),
            Some((e, inverted)) => Err(self.inverted(e, inverted)),
        }
    }
}
