//! Bodies that nothing holds: motions without resistance, named.
//!
//! The rigid motions Φ of all bodies (x, y, rotation) are tried on the tangent: A = Φᵀ K Φ, scaled by ΦᵀD Φ with D the
//! diagonal of |K|. A vanishing singular value of A is a motion that meets no force. A node outside all bodies has its
//! own two motions, which are tried on its block of K.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use crate::configuration::Configuration;
use crate::linear::SparseMatrix;
use crate::model::Model;

/// Relative stiffness below which a motion counts as free: far above round-off, far below any contact penalty.
const FREE: f64 = 1e-12;

const MOTIONS: [&str; 3] = ["along x", "along y", "in rotation"];

/// The first motion that the tangent at `u` does not resist, in words.
pub fn null_motion(model: &Model, u: &[f64], tangent: &SparseMatrix) -> Option<String> {
    null_motion_of_bodies(model, u, tangent).or_else(|| null_motion_of_a_node(model, tangent))
}

fn null_motion_of_bodies(model: &Model, u: &[f64], tangent: &SparseMatrix) -> Option<String> {
    let x = model.configuration(u);
    let modes: Vec<Vec<f64>> = model.bodies.iter().flat_map(|body| rigid_motions(&body.nodes, &x, u.len())).collect();
    let diagonal = tangent.diagonal();
    let scales: Vec<f64> =
        modes.iter().map(|mode| mode.iter().zip(&diagonal).map(|(m, d)| m * m * d.abs()).sum::<f64>().sqrt()).collect();
    if scales.is_empty() || scales.iter().any(|scale| *scale == 0.0 || !scale.is_finite()) {
        return None;
    }
    let images: Vec<Vec<f64>> = modes.iter().map(|mode| tangent.multiply(mode)).collect();
    let resistance = DMatrix::from_fn(modes.len(), modes.len(), |i, j| {
        modes[i].iter().zip(&images[j]).map(|(m, k)| m * k).sum::<f64>() / (scales[i] * scales[j])
    });
    let decomposed = resistance.svd(false, true);
    let (smallest, value) = decomposed.singular_values.argmin();
    let motion = decomposed.v_t?.row(smallest).transpose();
    (value < FREE).then(|| describe(model, &motion))
}

fn null_motion_of_a_node(model: &Model, tangent: &SparseMatrix) -> Option<String> {
    let mut lone = vec![true; model.mesh.nodes.len()];
    model.bodies.iter().flat_map(|body| &body.nodes).for_each(|&node| lone[node] = false);
    (0..lone.len()).filter(|&node| lone[node]).find_map(|node| {
        let block = tangent.pattern.block(node, node)?;
        let stiffness = Matrix2::from_fn(|i, j| tangent.values[block.value(i, j)]);
        let along = free_direction(&stiffness)?;
        let tag = model.mesh.node_tags[node];
        let motion = if along[0].abs() > along[1].abs() { MOTIONS[0] } else { MOTIONS[1] };
        Some(format!("nothing resists the motion of node {tag} {motion}"))
    })
}

/// A direction without stiffness: an axis, or the null vector of the block scaled to a unit diagonal.
fn free_direction(stiffness: &Matrix2<f64>) -> Option<Vector2<f64>> {
    let scale = stiffness.diagonal().map(|k| k.abs().sqrt());
    if let Some(axis) = (0..2).find(|&axis| scale[axis] == 0.0) {
        return Some(Vector2::ith(axis, 1.0));
    }
    if !scale.iter().all(|scale| scale.is_finite()) {
        return None;
    }
    let decomposed = stiffness.component_div(&(scale * scale.transpose())).svd(false, true);
    let (smallest, value) = decomposed.singular_values.argmin();
    let direction = decomposed.v_t?.row(smallest).transpose().component_div(&scale);
    (value < FREE).then_some(direction)
}

/// Unit motions of a set of nodes along x, along y, and about their centre.
fn rigid_motions(nodes: &[usize], x: &Configuration, dofs: usize) -> [Vec<f64>; 3] {
    let centre = nodes.iter().map(|&node| x.at(node)).sum::<Vector2<f64>>() / nodes.len().max(1) as f64;
    let radius = nodes.iter().fold(f64::MIN_POSITIVE, |r, &node| r.max((x.at(node) - centre).norm()));
    let mut modes = [0, 1, 2].map(|_| vec![0.0; dofs]);
    for &node in nodes {
        let arm = (x.at(node) - centre) / radius;
        modes[0][2 * node] = 1.0;
        modes[1][2 * node + 1] = 1.0;
        modes[2][2 * node] = -arm.y;
        modes[2][2 * node + 1] = arm.x;
    }
    modes
}

fn describe(model: &Model, motion: &DVector<f64>) -> String {
    let largest = motion.amax();
    let free: Vec<String> = (0..motion.len())
        .filter(|&k| motion[k].abs() > 0.1 * largest)
        .map(|k| format!("body `{}` {}", model.bodies[k / 3].name, MOTIONS[k % 3]))
        .collect();
    format!("nothing resists the motion of {}", free.join(" with "))
}
