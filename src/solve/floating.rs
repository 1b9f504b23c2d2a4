//! Detection of unconstrained rigid-body modes, which are reported by name.
//!
//! The rigid motions Φ of all bodies (x, y, rotation) are tested on the tangent: A = Φᵀ K Φ, scaled by ΦᵀD Φ with D the
//! diagonal of |K|. A vanishing singular value of A is a motion without resistance. Groups of bodies not coupled by K
//! are tested separately. A node outside all bodies has two motions of its own, tested on its block of K.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};

use crate::linear::{LinearSolver, Multifrontal, Pattern, SparseMatrix, norm};
use crate::mesh::configuration::Configuration;
use crate::mesh::joined::Joined;
use crate::model::{Model, Step};

/// Relative stiffness below which a motion counts as free: far above round-off, far below any contact penalty.
const FREE: f64 = 1e-12;

/// Residual below which an equation counts as fulfilled, relative to the stiffest entry: far above round-off, far below the
/// equation of a platen.
const FULFILLED: f64 = 1e-9;

/// Number of parts up to which singular values are computed directly.
const FEW_PARTS: usize = 8;

/// Number of inverse iterations; each amplifies the null motion by another 1/√ε.
const ITERATIONS: usize = 4;

/// (√5 − 1)/2, whose multiples are evenly distributed modulo 1.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Maximum number of motions reported by name.
const MOST_NAMED: usize = 6;

const MOTIONS: [&str; 3] = ["along x", "along y", "in rotation"];

/// Describes the first motion that the tangent at `u` does not resist, of what is there in a step.
pub fn null_motion(model: &Model, step: &Step, u: &[f64], tangent: &SparseMatrix) -> Option<String> {
    null_motion_of_bodies(model, step, u, tangent).or_else(|| null_motion_of_a_node(model, tangent))
}

/// Null motion of the first group of parts that has one.
fn null_motion_of_bodies(model: &Model, step: &Step, u: &[f64], tangent: &SparseMatrix) -> Option<String> {
    let parts = Parts::of(model, step);
    let resistance = Resistance::new(model, &parts, u, tangent)?;
    resistance.groups().iter().find_map(|group| {
        let motion = resistance.null_motion(group)?;
        // Followers of platens have equations other than forces: Φᵀ K Φ may vanish where K Φ does not.
        if !model.linkage.is_empty() && resistance.moves_equations(model, &parts, u, tangent, group, &motion) {
            return None;
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

/// A = Φᵀ K Φ by pairs of parts that K couples, and its scales.
struct Resistance {
    blocks: BTreeMap<(usize, usize), Matrix3<f64>>,
    /// ΦᵀD Φ of each part
    scales: Vec<Vector3<f64>>,
    parts: usize,
}

impl Resistance {
    /// `None` if a scale vanishes or is not finite.
    fn new(model: &Model, parts: &Parts, u: &[f64], tangent: &SparseMatrix) -> Option<Self> {
        let x = model.configuration(u);
        let motions = rigid_motions(parts, &x);
        let mut scales = vec![Vector3::zeros(); parts.bodies.len()];
        let mut blocks: BTreeMap<(usize, usize), Matrix3<f64>> = BTreeMap::new();
        for (column, part) in parts.of_node.iter().enumerate() {
            let Some(part) = *part else { continue };
            for &row in tangent.pattern.neighbours(column) {
                let (Some(other), Some(block)) = (parts.of_node[row], tangent.pattern.block(row, column)) else {
                    continue;
                };
                let stiffness = Matrix2::from_fn(|i, j| tangent.values[block.value(i, j)]);
                if row == column {
                    let diagonal = stiffness.diagonal().abs();
                    scales[part] += motions[column].map(|m| m * m).tr_mul(&diagonal);
                }
                if stiffness != Matrix2::zeros() {
                    *blocks.entry((other, part)).or_default() += motions[row].transpose() * stiffness * motions[column];
                }
            }
        }
        if scales.iter().flatten().any(|scale| !(*scale > 0.0 && scale.is_finite())) {
            return None;
        }
        for (&(row, column), block) in &mut blocks {
            block.component_div_assign(&(scales[row].map(f64::sqrt) * scales[column].map(f64::sqrt).transpose()));
        }
        Some(Self { blocks, scales, parts: parts.bodies.len() })
    }

    /// Groups of parts that are coupled, directly or through others.
    fn groups(&self) -> Vec<Vec<usize>> {
        let mut joined = Joined::new(self.parts);
        self.blocks.keys().for_each(|&(row, column)| joined.join(row, column));
        joined.groups()
    }

    /// Motion of the parts of a group, three numbers each, without resistance: by singular values in a small group, by
    /// inverse iteration with sparse factors in a large one, where a vanishing pivot is replaced by √ε.
    fn null_motion(&self, group: &[usize]) -> Option<DVector<f64>> {
        if group.len() <= FEW_PARTS {
            let size = 3 * group.len();
            let at =
                |i: usize, j: usize| self.blocks.get(&(group[i / 3], group[j / 3])).map_or(0.0, |b| b[(i % 3, j % 3)]);
            let decomposed = DMatrix::from_fn(size, size, at).svd(false, true);
            let (smallest, value) = decomposed.singular_values.argmin();
            let motion = decomposed.v_t?.row(smallest).transpose();
            return (value < FREE).then_some(motion);
        }
        let matrix = self.sparse(group);
        let mut solver = Multifrontal::default();
        solver.factorize(&matrix).ok()?;
        // No motion of a few parts is orthogonal to this one.
        let mut motion: Vec<f64> = (0..matrix.size()).map(|dof| 1.0 + (dof as f64 * GOLDEN).fract()).collect();
        for _ in 0..ITERATIONS {
            solver.solve(&mut motion);
            let size = norm(&motion);
            motion.iter_mut().for_each(|m| *m /= size);
            if norm(&matrix.multiply(&motion)) < FREE {
                return Some(DVector::from_fn(3 * group.len(), |k, _| motion[4 * (k / 3) + k % 3]));
            }
        }
        None
    }

    /// Whether a motion of a group violates equations of K.
    fn moves_equations(
        &self,
        model: &Model,
        parts: &Parts,
        u: &[f64],
        tangent: &SparseMatrix,
        group: &[usize],
        motion: &DVector<f64>,
    ) -> bool {
        let motions = rigid_motions(parts, &model.configuration(u));
        let mut of_part = vec![Vector3::zeros(); self.parts];
        for (k, &part) in group.iter().enumerate() {
            of_part[part] = motion.fixed_rows::<3>(3 * k).component_div(&self.scales[part].map(f64::sqrt));
        }
        let moved = |(part, motion): (&Option<usize>, &Matrix2x3<f64>)| -> [f64; 2] {
            part.map_or_else(Vector2::zeros, |part| motion * of_part[part]).into()
        };
        let way: Vec<f64> = parts.of_node.iter().zip(&motions).flat_map(moved).collect();
        let stiffest = tangent.values.iter().fold(0.0f64, |most, k| most.max(k.abs()));
        norm(&tangent.multiply(&way)) > FULFILLED * stiffest * norm(&way)
    }

    /// A of a group, two nodes of two dofs for the three motions of a part; the fourth dof is fixed.
    fn sparse(&self, group: &[usize]) -> SparseMatrix {
        let place: BTreeMap<usize, usize> = group.iter().enumerate().map(|(k, &part)| (part, k)).collect();
        let within =
            || self.blocks.iter().filter_map(|((row, column), b)| Some((*place.get(row)?, *place.get(column)?, b)));
        let coupled: Vec<[usize; 4]> =
            within().map(|(row, column, _)| [2 * row, 2 * row + 1, 2 * column, 2 * column + 1]).collect();
        let pattern = Pattern::new(2 * group.len(), coupled.iter().map(|nodes| &nodes[..]));
        let mut matrix = SparseMatrix::zero(Arc::new(pattern));
        for (row, column, block) in within() {
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                if let Some(at) = matrix.pattern.block(2 * row + i / 2, 2 * column + j / 2) {
                    matrix.values[at.value(i % 2, j % 2)] = block[(i, j)];
                }
            }
        }
        (0..group.len()).for_each(|k| matrix.add_diagonal(4 * k + 3, 1.0));
        matrix
    }
}

fn null_motion_of_a_node(model: &Model, tangent: &SparseMatrix) -> Option<String> {
    let mut lone = vec![true; model.mesh.nodes.len()];
    model.bodies.iter().flat_map(|body| &body.nodes).for_each(|&node| lone[node] = false);
    if let Some(flow) = &model.flow {
        lone[flow.first..flow.first + flow.count() / 2].fill(false);
    }
    (0..lone.len()).filter(|&node| lone[node]).find_map(|node| {
        let block = tangent.pattern.block(node, node)?;
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

/// Motion of every node with its part along x, along y, and about the part's centre; zero outside all bodies.
fn rigid_motions(parts: &Parts, x: &Configuration) -> Vec<Matrix2x3<f64>> {
    let mut centres = vec![(Vector2::zeros(), 0.0); parts.bodies.len()];
    let owned = || parts.of_node.iter().enumerate().filter_map(|(node, part)| Some((node, (*part)?)));
    for (node, part) in owned() {
        centres[part].0 += x.at(node);
        centres[part].1 += 1.0;
    }
    let arm = |node: usize, part: usize| x.at(node) - centres[part].0 / centres[part].1;
    let mut radii = vec![f64::MIN_POSITIVE; parts.bodies.len()];
    owned().for_each(|(node, part)| radii[part] = radii[part].max(arm(node, part).norm()));
    let mut motions = vec![Matrix2x3::zeros(); parts.of_node.len()];
    for (node, part) in owned() {
        let arm = arm(node, part) / radii[part];
        motions[node] = Matrix2x3::new(1.0, 0.0, -arm.y, 0.0, 1.0, arm.x);
    }
    motions
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
