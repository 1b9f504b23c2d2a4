//! Stress in force at the nodes of one side of a contact that comes under it.
//!
//! ```text
//! σ_a = mean over the elements behind the edges at node a of Σ_k c_k p_k(ξ_a),   Σ_q (Σ_k c_k p_k(ξ_q) − σ_q)² → min
//!                                                               p: 1 of T3, 1, ξ, η of T6, 1, ξ, η, ξη of quadrilaterals
//! ```
//!
//! A field that is linear in the element is met exactly. It is that of the side that was there before, of the slave if both were or none:
//! the other one comes with what its own initial stress is.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{DMatrix, Matrix2};

use super::Model;
use super::state::State;
use super::step::Step;
use crate::contact::pair::ContactPair;
use crate::mesh::shape::ElementKind;

/// Stress at the nodes of a side of a contact that comes with a step, in the state before.
pub(super) fn across(model: &Model, pair: &ContactPair, step: &Step, state: &State) -> BTreeMap<usize, Matrix2<f64>> {
    let was_there = |side: &[usize]| !side.is_empty() && side.iter().all(|body| !step.changed.contains(body));
    let [slave, master] = &pair.bodies;
    let of_slave = was_there(slave) || !was_there(master);
    let ends = |nodes: &[usize]| [nodes[0].min(nodes[1]), nodes[0].max(nodes[1])];
    let edges: BTreeSet<[usize; 2]> = match of_slave {
        true => {
            let shares = pair.points.iter().flat_map(|point| &point.length).filter(|share| share.tangent.len() > 1);
            shares.map(|share| ends(&[share.tangent[0].0, share.tangent[1].0])).collect()
        }
        false => pair.master.segments().iter().map(|segment| ends(&segment.ends)).collect(),
    };
    let mut sums: BTreeMap<usize, (Matrix2<f64>, f64)> = BTreeMap::new();
    for &body in if of_slave { slave } else { master } {
        for &e in &model.bodies[body].elements {
            let element = &model.mesh.elements[e];
            let sides = (0..element.kind.corners()).map(|side| element.kind.edge(side));
            let own = sides.filter(|(corners, _)| edges.contains(&ends(&corners.map(|corner| element.nodes[corner]))));
            let mut locals: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
            for (corners @ [a, b], middle) in own {
                let [one, other] = corners.map(|corner| corner_place(element.kind, corner));
                locals.extend([(a, one), (b, other)]);
                locals.extend(middle.map(|middle| (middle, [0, 1].map(|i| 0.5 * (one[i] + other[i])))));
            }
            if locals.is_empty() {
                continue;
            }
            let u = model.mesh.vectors(e, &state.displacement);
            let memory = model.memories.of(e, &state.memory);
            let solid = model.solid(state, e);
            let Ok(stresses) = solid.stresses(&*model.body_of(e).material, memory, &u) else { continue };
            let at: Vec<[f64; 2]> = solid.quadrature().iter().map(|point| point.at).collect();
            for (local, place) in locals {
                let weights = extrapolation(element.kind, &at, place);
                let sum = stresses.iter().zip(&weights).fold(Matrix2::zeros(), |sum, (stress, w)| {
                    sum + Matrix2::new(stress.xx, stress.xy, stress.xy, stress.yy) * *w
                });
                let entry = sums.entry(element.nodes[local]).or_default();
                *entry = (entry.0 + sum, entry.1 + 1.0);
            }
        }
    }
    sums.into_iter().map(|(node, (sum, count))| (node, sum / count)).collect()
}

/// Place of a corner of an element in its own coordinates.
fn corner_place(kind: ElementKind, corner: usize) -> [f64; 2] {
    match kind.corners() {
        3 => [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]][corner],
        _ => [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][corner],
    }
}

/// Weights of the values at points of an element in that of the polynomial that fits them, at a place.
fn extrapolation(kind: ElementKind, points: &[[f64; 2]], place: [f64; 2]) -> Vec<f64> {
    let count = if kind.corners() == 4 { 4 } else { 3 }.min(points.len());
    let terms = |[x, y]: [f64; 2]| [1.0, x, y, x * y].into_iter().take(count).collect::<Vec<_>>();
    let all: Vec<f64> = points.iter().flat_map(|point| terms(*point)).collect();
    let values = DMatrix::from_row_slice(points.len(), count, &all);
    let at = DMatrix::from_row_slice(1, count, &terms(place));
    // The points of a Gauss rule tell its polynomials apart.
    let normal = (values.transpose() * &values).try_inverse();
    normal.map_or_else(
        || vec![1.0 / points.len() as f64; points.len()],
        |normal| (at * normal * values.transpose()).iter().copied().collect(),
    )
}
