//! Masses: their matrix, their forces, and the equations as the scheme blends them.

use nalgebra::DMatrix;

use super::coupling::Layout;
use super::dependence::Dependence;
use super::rates::{followed, missed, rates};
use super::sums::add_blocks;
use super::trial::Trial;
use super::turning::{self, Turning};
use crate::linear::SparseMatrix;
use crate::model::scheme::Coefficients;
use crate::model::{Model, Step};

/// M ∂a/∂u: the mass over Δt².
pub(super) fn dependence(step: &Step) -> Dependence {
    if step.scheme.coefficients().is_some() { Dependence::StepSize } else { Dependence::Nothing }
}

/// The mass matrix on the current pattern: consistent in the elements, and the point masses on the diagonal.
pub(super) fn mass(model: &Model, layout: &Layout) -> SparseMatrix {
    let mut mass = elements(model, layout, |_| 1.0);
    for point in &model.point_masses {
        let nodes = point.nodes.iter().map(|&node| layout.original(node));
        let dofs = nodes.flat_map(|node| [2 * node, 2 * node + 1]);
        dofs.for_each(|dof| mass.add_diagonal(dof, point.mass));
    }
    mass
}

/// Masses of the elements, each times what is said of its body.
pub(super) fn elements(model: &Model, layout: &Layout, share: impl Fn(usize) -> f64) -> SparseMatrix {
    let mut total = layout.matrix();
    for (e, element) in model.mesh.elements.iter().enumerate() {
        let mass = share(model.body_of_element[e]) * model.element_mass(e);
        let both = mass.kronecker(&DMatrix::identity(2, 2));
        add_blocks(&mut total, layout.blocks_of(e), both.as_slice(), element.nodes.len());
    }
    total
}

/// What inertia says at a trial displacement.
pub(super) struct Inertia {
    /// v [L/T]
    pub velocity: Vec<f64>,
    /// a [L/T²]
    pub acceleration: Vec<f64>,
    /// M a [F]
    pub force: Vec<f64>,
    /// M times the accelerations as (1) of [`crate::model::scheme`] weighs them [F]
    pub weighted: Vec<f64>,
    /// ∂(weighted a)/∂u of each dof: the factor of its column of M [1/T²]
    pub factors: Vec<f64>,
    /// rigid plates, of which the factors are not all
    turning: Vec<Turning>,
    /// the scheme and Δt
    scheme: (Coefficients, f64),
}

impl Inertia {
    /// In a dynamic increment with the mass matrix M; a prescribed dof's acceleration is its support's.
    pub fn at(model: &Model, trial: Trial, u: &[f64], mass: &SparseMatrix) -> Option<Self> {
        let Trial { old, step, dt, .. } = trial;
        let scheme = step.scheme.coefficients()?;
        let (velocity, acceleration) = rates(model, trial, u, scheme);
        let accelerations = old.acceleration.iter().zip(&acceleration);
        let mut weighted: Vec<f64> = accelerations.map(|(old, new)| blend(scheme.alpha_m, *old, *new)).collect();
        let mut factors = vec![(1.0 - scheme.alpha_m) * scheme.dacceleration(dt); u.len()];
        for support in &step.supports {
            let at = support.at;
            let along = blend(scheme.alpha_f, at.of(&old.acceleration), at.of(&acceleration));
            match at.inclined {
                None => (weighted[at.dof], factors[at.dof]) = (along, 0.0),
                Some(_) => {
                    let missed = missed(support, trial.prescribed(support, model), u);
                    let rest = (scheme.alpha_f - scheme.alpha_m) * scheme.dacceleration(dt) * missed;
                    at.set(along + rest, &mut weighted);
                }
            }
        }
        for (dof, base, leads) in followed(model, trial, u) {
            weighted[dof] = leads(&weighted) + factors[dof] * (u[dof] - base);
        }
        let turning = Turning::all(model, trial, u, scheme);
        let rate = (1.0 - scheme.alpha_m) * scheme.dacceleration(dt);
        turning.iter().for_each(|plate| plate.weighted(scheme, rate, &mut weighted));
        turning::spread(model, rate, u, &mut weighted);
        let [force, weighted] = mass.multiply_all([&acceleration, &weighted]);
        Some(Self { velocity, acceleration, force, weighted, factors, turning, scheme: (scheme, dt) })
    }

    /// (1) of [`crate::model::scheme`]: blend the forces and their tangent, and add those of the masses.
    pub fn add(
        &self,
        model: &Model,
        [old, force]: [&[f64]; 2],
        residual: &mut Vec<f64>,
        tangent: Option<(&mut SparseMatrix, &SparseMatrix)>,
    ) {
        let alpha_f = self.scheme.0.alpha_f;
        residual.clear();
        let blended = old.iter().zip(force).map(|(&old, &force)| blend(alpha_f, old, force));
        residual.extend(blended.zip(&self.weighted).map(|(force, inertia)| force + inertia));
        if let Some((tangent, mass)) = tangent {
            tangent.values.iter_mut().for_each(|value| *value *= 1.0 - alpha_f);
            self.stiffen(model, mass, tangent);
        }
    }

    /// Add the tangent of the weighted forces.
    pub fn stiffen(&self, model: &Model, mass: &SparseMatrix, tangent: &mut SparseMatrix) {
        tangent.add_columns(mass, &self.factors);
        self.turning.iter().for_each(|plate| plate.stiffen(model, self.scheme, &self.factors, mass, tangent));
    }
}

/// The share `weight` of the old value and the rest of the new one.
fn blend(weight: f64, old: f64, new: f64) -> f64 {
    weight * old + (1.0 - weight) * new
}

/// Stored: ½ vᵀ M v [F·L].
pub fn kinetic_energy(mass: &SparseMatrix, velocity: &[f64]) -> f64 {
    let momentum = mass.multiply(velocity);
    0.5 * momentum.iter().zip(velocity).map(|(p, v)| p * v).sum::<f64>()
}
