//! The bounds (2) of one element, of [`super`].

use nalgebra::{DMatrix, DVector, Vector2};
use serde::{Deserialize, Serialize};

use crate::equations::sums::TrialFailure;
use crate::model::Model;
use crate::model::element::Memory;

/// Share of its size to which an element may be crushed: increments would become shorter without end.
const CRUSHED: f64 = 1e-3;

/// One element, as last looked at.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Element {
    /// λ_e and c [1/T², 1/T]
    pub(super) bounds: [f64; 2],
    /// Area over diagonal; infinite where the law is linear, and the bounds depend on no displacement [L]
    pub(super) size: f64,
}

impl Element {
    /// Look at an element at the displacement `u`, with what its material remembers if something is imposed on it.
    pub(super) fn at(
        model: &Model,
        retardation: f64,
        e: usize,
        (u, memory): (&[f64], &[f64]),
    ) -> Result<Self, TrialFailure> {
        let nodes = &model.mesh.elements[e].nodes;
        let body = &model.bodies[model.body_of_element[e]];
        let local: Vec<Vector2<f64>> = nodes.iter().map(|&node| Vector2::new(u[2 * node], u[2 * node + 1])).collect();
        let size = if body.material.is_linear() { f64::INFINITY } else { size(model, e, &local) };
        let undeformed = size_at_rest(model, e);
        if size < CRUSHED * undeformed {
            return Err(TrialFailure::crushed(model, e, size / undeformed));
        }
        Ok(Self { bounds: bounds(model, retardation, e, (&local, memory))?, size })
    }
}

fn size_at_rest(model: &Model, e: usize) -> f64 {
    size(model, e, &vec![Vector2::zeros(); model.mesh.elements[e].nodes.len()])
}

/// Area of the polygon of an element's corners over its longest diagonal or side, at nodal displacements [L].
fn size(model: &Model, e: usize, u: &[Vector2<f64>]) -> f64 {
    let element = &model.mesh.elements[e];
    let corners = element.kind.corners();
    let place = |a: usize| model.mesh.nodes[element.nodes[a]] - model.mesh.nodes[element.nodes[0]] + (u[a] - u[0]);
    let places: Vec<Vector2<f64>> = (0..corners).map(place).collect();
    let area: f64 = (0..corners).map(|a| 0.5 * places[a].perp(&places[(a + 1) % corners])).sum();
    let pairs = (0..corners).flat_map(|a| (0..a).map(move |b| (a, b)));
    area.abs() / pairs.map(|(a, b)| (places[a] - places[b]).norm()).fold(f64::MIN_POSITIVE, f64::max)
}

/// λ_e and c of an element at nodal displacements and what its material remembers [1/T², 1/T].
fn bounds(
    model: &Model,
    retardation: f64,
    e: usize,
    (local, memory): (&[Vector2<f64>], &[f64]),
) -> Result<[f64; 2], TrialFailure> {
    let body = &model.bodies[model.body_of_element[e]];
    let n = 2 * local.len();
    let (mut force, mut tangent) = (vec![0.0; n], DMatrix::zeros(n, n));
    let (solid, law) = (&model.solids[e], &*body.material);
    let answer = match body.is_imposed() {
        false => solid.force_and_tangent(law, local, &mut force, tangent.as_mut_slice()).map(drop),
        // What is imposed stiffens.
        true => {
            let memory = Memory { dt: 0.0, old: memory, new: &mut memory.to_vec() };
            solid.evolve(law, memory, local, &mut force, Some(tangent.as_mut_slice())).map(drop)
        }
    };
    answer.map_err(|inverted| TrialFailure::inverted(model, e, inverted))?;
    let mass = model.element_lumped_mass(e);
    let elastic = largest_eigenvalue(&tangent, &mass);
    if retardation == 0.0 {
        return Ok([elastic, 0.0]);
    }
    // What remains of the viscous tangent at rest is its derivative with respect to the velocities.
    let (law, still) = ((&*body.material, retardation), vec![Vector2::zeros(); local.len()]);
    model.solids[e].viscous_tangent(law, [local, &still], &vec![1.0; n], tangent.as_mut_slice());
    Ok([elastic, largest_eigenvalue(&tangent, &mass)])
}

/// The bound (2) of a matrix and the lumped masses of its nodes.
fn largest_eigenvalue(matrix: &DMatrix<f64>, mass: &DVector<f64>) -> f64 {
    let n = matrix.nrows();
    let scaled = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (mass[i / 2] * mass[j / 2]).sqrt());
    let largest = scaled.amax();
    if largest == 0.0 {
        return 0.0;
    }
    let square = (&scaled / largest).pow(2);
    largest * (&square * &square).norm().powf(0.25)
}
