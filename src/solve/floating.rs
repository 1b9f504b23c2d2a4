//! Detection of unconstrained rigid-body modes, which are reported by name.
//!
//! The rigid motions Φ of all bodies (x, y, rotation) are tested on the tangent: A = Φᵀ K Φ, scaled by ΦᵀD Φ with D the
//! diagonal of |K| (`Resistance`). A node outside all bodies has two motions of its own, tested on its block of K.

use nalgebra::{DVector, Matrix2, Matrix2x3, Vector2, Vector3};

use crate::linear::{SparseMatrix, norm};
use crate::mesh::configuration::Configuration;
use crate::mesh::joined::Joined;
use crate::model::resistance::{FREE, Frame, MOTIONS, Resistance};
use crate::model::{Model, Step};

/// Residual below which an equation counts as fulfilled, relative to the stiffest entry: far above round-off, far below the
/// equation of a platen.
const FULFILLED: f64 = 1e-9;

/// Maximum number of motions reported by name.
const MOST_NAMED: usize = 6;

/// Describes the first motion that the tangent at `u` does not resist, of what is there in a step.
pub fn null_motion(model: &Model, step: &Step, u: &[f64], tangent: &SparseMatrix) -> Option<String> {
    null_motion_of_bodies(model, step, u, tangent).or_else(|| null_motion_of_a_node(model, tangent))
}

/// Null motion of the first group of parts that has one.
fn null_motion_of_bodies(model: &Model, step: &Step, u: &[f64], tangent: &SparseMatrix) -> Option<String> {
    let parts = Parts::of(model, step);
    let motions = rigid_motions(&parts, &model.configuration(u));
    let (resistance, scales) = resistance(&parts, &motions, tangent)?;
    resistance.groups().iter().find_map(|group| {
        let motion = resistance.free_motion(group)?;
        // Followers of platens have equations other than forces: Φᵀ K Φ may vanish where K Φ does not.
        if !model.linkage.is_empty() {
            let mut of_part = vec![Vector3::zeros(); scales.len()];
            for (k, &part) in group.iter().enumerate() {
                of_part[part] = motion.fixed_rows::<3>(3 * k).component_div(&scales[part]);
            }
            let moved = |(part, motion): (&Option<usize>, &Matrix2x3<f64>)| -> [f64; 2] {
                part.map_or_else(Vector2::zeros, |part| motion * of_part[part]).into()
            };
            let way: Vec<f64> = parts.of_node.iter().zip(&motions).flat_map(moved).collect();
            if violates(tangent, &way) {
                return None;
            }
        }
        Some(describe(model, &parts, group, &motion))
    })
}

/// Parts of the model: bodies that share nodes move as one part.
struct Parts {
    /// Bodies of each part
    bodies: Vec<Vec<usize>>,
    /// Part of each node; `None` outside the bodies that are there
    of_node: Vec<Option<usize>>,
}

impl Parts {
    fn of(model: &Model, step: &Step) -> Self {
        let mut first: Vec<Option<usize>> = vec![None; model.mesh.nodes.len()];
        let mut joined = Joined::new(model.bodies.len());
        let there = model.bodies.iter().enumerate().filter(|(body, _)| step.has(*body));
        for (body, nodes) in there.map(|(body, own)| (body, &own.nodes)) {
            nodes.iter().for_each(|&node| joined.join(body, *first[node].get_or_insert(body)));
        }
        let mut bodies = joined.groups();
        bodies.retain(|bodies| step.has(bodies[0]));
        let mut part = vec![0; model.bodies.len()];
        bodies.iter().enumerate().for_each(|(k, bodies)| bodies.iter().for_each(|&body| part[body] = k));
        Self { of_node: first.into_iter().map(|body| body.map(|body| part[body])).collect(), bodies }
    }
}

/// A = Φᵀ K Φ, scaled by ΦᵀD Φ of each part, and these scales; `None` if one vanishes or is not finite.
fn resistance(
    parts: &Parts,
    motions: &[Matrix2x3<f64>],
    tangent: &SparseMatrix,
) -> Option<(Resistance, Vec<Vector3<f64>>)> {
    let mut scales = vec![Vector3::zeros(); parts.bodies.len()];
    let mut resistance = Resistance::nothing(parts.bodies.len());
    for (column, part) in parts.of_node.iter().enumerate() {
        let Some(part) = *part else { continue };
        for &row in tangent.pattern.neighbours(column) {
            let Some(other) = parts.of_node[row] else { continue };
            let block = tangent.pattern.coupled(row, column);
            let stiffness = Matrix2::from_fn(|i, j| tangent.values[block.value(i, j)]);
            if row == column {
                let diagonal = stiffness.diagonal().abs();
                scales[part] += motions[column].map(|m| m * m).tr_mul(&diagonal);
            }
            if stiffness != Matrix2::zeros() {
                *resistance.blocks.entry((other, part)).or_default() +=
                    motions[row].transpose() * stiffness * motions[column];
            }
        }
    }
    if scales.iter().flatten().any(|scale| !(*scale > 0.0 && scale.is_finite())) {
        return None;
    }
    scales.iter_mut().for_each(|scale| *scale = scale.map(f64::sqrt));
    for (&(row, column), block) in &mut resistance.blocks {
        block.component_div_assign(&(scales[row] * scales[column].transpose()));
    }
    Some((resistance, scales))
}

/// Whether a displacement violates equations of K.
fn violates(tangent: &SparseMatrix, way: &[f64]) -> bool {
    let stiffest = tangent.values.iter().fold(0.0f64, |most, k| most.max(k.abs()));
    norm(&tangent.multiply(way)) > FULFILLED * stiffest * norm(way)
}

fn null_motion_of_a_node(model: &Model, tangent: &SparseMatrix) -> Option<String> {
    let mut lone = vec![true; model.mesh.nodes.len()];
    model.bodies.iter().flat_map(|body| &body.nodes).for_each(|&node| lone[node] = false);
    if let Some(flow) = &model.flow {
        lone[flow.nodes()].fill(false);
    }
    (0..lone.len()).filter(|&node| lone[node]).find_map(|node| {
        let block = tangent.pattern.coupled(node, node);
        let stiffness = Matrix2::from_fn(|i, j| tangent.values[block.value(i, j)]);
        let along = free_direction(&stiffness)?;
        if let Some(body) = model.mesh.rigid_bodies.iter().find(|body| body.nodes().contains(&node)) {
            let component = usize::from(along[0].abs() <= along[1].abs());
            let motion = MOTIONS[if node == body.turning { 2 } else { component }];
            return Some(format!("nothing resists the motion of the rigid body `{}` {motion}", body.name));
        }
        let motion = if along[0].abs() > along[1].abs() { MOTIONS[0] } else { MOTIONS[1] };
        Some(format!("nothing resists the motion of {} {motion}", model.lone_name(node)))
    })
}

/// A direction without stiffness: an axis, or the null vector of the block scaled to unit diagonal.
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

/// Motion of every node with its part; zero outside all bodies.
fn rigid_motions(parts: &Parts, x: &Configuration) -> Vec<Matrix2x3<f64>> {
    let mut nodes = vec![Vec::new(); parts.bodies.len()];
    parts.of_node.iter().enumerate().for_each(|(node, part)| part.iter().for_each(|&part| nodes[part].push(node)));
    let frames: Vec<Frame> = nodes.iter().map(|nodes| Frame::of(nodes.iter().map(|&node| x.at(node)))).collect();
    let motion = |(node, part): (usize, &Option<usize>)| {
        part.map_or_else(Matrix2x3::zeros, |part| frames[part].motion(x.at(node)))
    };
    parts.of_node.iter().enumerate().map(motion).collect()
}

fn describe(model: &Model, parts: &Parts, group: &[usize], motion: &DVector<f64>) -> String {
    let largest = motion.amax();
    let name = |part: usize| {
        let names: Vec<String> =
            parts.bodies[part].iter().map(|&body| format!("`{}`", model.bodies[body].name)).collect();
        format!("{} {}", if names.len() == 1 { "body" } else { "bodies" }, names.join(" and "))
    };
    let moving: Vec<usize> = (0..motion.len()).filter(|&k| motion[k].abs() > 0.1 * largest).collect();
    let mut free: Vec<String> =
        moving.iter().take(MOST_NAMED).map(|&k| format!("{} {}", name(group[k / 3]), MOTIONS[k % 3])).collect();
    if moving.len() > MOST_NAMED {
        free.push(format!("{} more", moving.len() - MOST_NAMED));
    }
    format!("nothing resists the motion of {}", free.join(" with "))
}
