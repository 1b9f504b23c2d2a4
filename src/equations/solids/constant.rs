//! Elements whose stiffness never changes: it is found once, and elements that have the same one in every bit share it.
//!
//! ```text
//! f_e = f_0 + K_e (u_e − u_1),   W_e = ½ (u_e − u_1)·(f_e + f_0),   f_v = τ K_e (v_e − v_1)
//! ```
//! f_0 are the forces of the initial stress.
//!
//! Motions are taken against the element's first node: a displacement of all nodes costs no digits, and K_e's columns of that
//! node are not needed (in rings only motions along the axis are, and all columns are kept). An element keeps them if none before it has the same ones: 384 bytes for Q4, 256 for T3, 960 for T6,
//! 1792 for Q8, 2560 for Q9. Equal elements of a regular mesh differ in the last bits of their nodes' places unless these are round.

use std::collections::HashMap;
use std::collections::hash_map::{DefaultHasher, Entry};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use nalgebra::{Matrix2, Vector2, Vector4};
use rayon::prelude::*;

use super::blocks::{Block, blocks, rows};
use super::kernel::{Pass, first};
use super::places::{BATCH, Places};
use super::runs::nodal;
use crate::equations::coupling::Layout;
use crate::equations::failure::TrialFailure;
use crate::equations::sums::add_blocks;
use crate::laws::bulk::{INITIAL_STRESS, Material};
use crate::linear::SparseMatrix;
use crate::mesh::shape::ElementKind;
use crate::model::{Body, Model};

/// Blocks that are done sooner than another thread wakes up.
const FEW_BLOCKS: usize = 2;

/// Whether the tangent of an element is the same at every displacement: a linear law at small strains that remembers nothing but
/// an initial stress; with F-bar the tangent changes nevertheless.
pub fn is_constant(model: &Model, element: usize) -> bool {
    let material = &model.bodies[model.body_of_element[element]].material;
    let remembers = !material.variables().is_empty() && *material.variables() != INITIAL_STRESS;
    material.is_linear() && material.is_symmetric() && !remembers && !model.solids[element].is_f_bar()
}

/// Whether the viscous stress of a law is τ ∂P/∂F:Ḟ with the same ∂P/∂F at every F. A linear law need not have such a one.
pub(in crate::equations) fn damps_by_stiffness(material: &dyn Material) -> bool {
    if !material.is_linear() {
        return false;
    }
    let (deformation, rate) = (Matrix2::new(1.25, 0.5, -0.25, 0.75), Matrix2::new(0.5, -1.0, 0.75, 0.25));
    let Ok(response) = material.respond(&deformation) else { return false };
    let elastic = response.tangent * Vector4::from_column_slice(rate.as_slice());
    let elastic = Matrix2::from_column_slice(elastic.as_slice());
    (material.viscous_stress([&deformation, &rate]) - elastic).norm() <= 1e-12 * elastic.norm()
}

/// The constant elements of a model.
pub(super) struct Constant {
    /// Whether each element is one
    pub is: Vec<bool>,
    /// Columns of the distinct K_e of each kind from those of the second node on (in rings of the first), one matrix after the
    /// other [F/L]
    stiffness: [Vec<f64>; 5],
    /// Whether they are rings
    ring: bool,
    blocks: Vec<Block>,
    /// Where each node finds its blocks' forces
    pub places: Places,
    /// Forces of the blocks on their nodes, `stride` places a block [F]
    pub forces: Vec<Vector2<f64>>,
    /// Viscous forces of the blocks, or the magnitudes of their elements' forces [F]
    pub others: Vec<Vector2<f64>>,
    stride: usize,
    /// What each block stores [F·L]
    energies: Vec<f64>,
    /// Sum of all K_e on the pattern
    total: Option<SparseMatrix>,
    /// Sum of all τ K_e on the pattern
    viscous: Option<SparseMatrix>,
}

impl Constant {
    pub fn new(model: &Model) -> Self {
        let never = |body: usize| model.steps.iter().all(|step| model.damping(step, body).retardation == 0.0);
        let undamped = |body: usize| model.bodies[body].damping.retardation == 0.0 && never(body);
        let fit = |(k, body): (usize, &Body)| undamped(k) || damps_by_stiffness(&*body.material);
        let fit: Vec<bool> = model.bodies.iter().enumerate().map(fit).collect();
        let is: Vec<bool> =
            (0..model.solids.len()).map(|e| is_constant(model, e) && fit[model.body_of_element[e]]).collect();
        let (mut stiffness, matrices) = distinct(model, &is);
        // A law that stresses the undeformed body is not proportional to the displacements.
        let is: Vec<bool> = matrices.iter().map(Option::is_some).collect();
        stiffness.iter_mut().for_each(Vec::shrink_to_fit);
        let blocks = blocks(model, &matrices);
        let stride = blocks.iter().map(|block| block.nodes.len()).max().unwrap_or(0);
        let of_block = |(first, block): (usize, &'_ Block)| {
            let own = block.nodes.iter().enumerate();
            own.map(move |(k, &node)| ((first * stride + k) as u32, node as usize)).collect::<Vec<_>>()
        };
        let nodes: Vec<(u32, usize)> = blocks.iter().enumerate().flat_map(of_block).collect();
        let zeros = || vec![Vector2::zeros(); stride * blocks.len()];
        Self {
            is,
            stiffness,
            ring: model.mesh.section.is_axisymmetric(),
            places: Places::new(model.mesh.nodes.len(), nodes.iter().copied()),
            forces: zeros(),
            others: zeros(),
            stride,
            energies: vec![0.0; blocks.len()],
            blocks,
            total: None,
            viscous: None,
        }
    }

    /// Number of distinct matrices.
    pub fn matrices(&self) -> usize {
        let of = |(kind, all): (ElementKind, &Vec<f64>)| all.len() / length(kind.nodes(), self.ring);
        KINDS.into_iter().zip(&self.stiffness).map(of).sum()
    }

    /// Write what all elements put on the nodes over the blocks' `forces`, and what a pass is asked for besides over `others`;
    /// what they store is kept.
    pub fn evaluate(&mut self, retardation: &[f64], pass: Pass) {
        let Self { stiffness, ring, blocks, forces, others, energies, .. } = self;
        let stride = self.stride.max(1);
        let places = forces.par_chunks_exact_mut(stride).zip(others.par_chunks_exact_mut(stride));
        let all = blocks.par_iter().zip(places).zip(energies).with_min_len(FEW_BLOCKS);
        all.for_each(|((block, (forces, others)), energy)| {
            let retardation = retardation[block.body];
            *energy = block.evaluate((&stiffness[block.kind as usize], *ring), retardation, pass, [forces, others]);
        });
    }

    /// What all elements store, or which is the first whose strain is not finite.
    pub fn stored(&self, model: &Model, u: &[f64]) -> Result<f64, TrialFailure> {
        let energy: f64 = self.energies.iter().sum();
        if !energy.is_finite() {
            for e in (0..self.is.len()).filter(|&e| self.is[e]) {
                let (n, mut forces) = (model.mesh.elements[e].nodes.len(), [Vector2::zeros(); 9]);
                let material = &*model.bodies[model.body_of_element[e]].material;
                let found = model.solids[e].nodal_forces(material, &nodal(model, e, u)[..n], &mut forces[..n]);
                found.map_err(|failure| TrialFailure::inverted(model, e, failure))?;
            }
        }
        Ok(energy)
    }

    /// Σ K_e on the current pattern; nothing if there are none.
    pub fn total(&mut self, model: &Model, layout: &Layout) -> Option<&SparseMatrix> {
        kept(&mut self.total, (model, layout), &self.is, |_| 1.0)
    }

    /// Σ τ K_e on the current pattern; nothing if there are none.
    pub fn viscous(&mut self, model: &Model, retardation: &[f64], layout: &Layout) -> Option<&SparseMatrix> {
        kept(&mut self.viscous, (model, layout), &self.is, |body| retardation[body])
    }

    /// Have that sum found again: τ has changed.
    pub fn forget_viscous(&mut self) {
        self.viscous = None;
    }
}

/// The sum of the constant elements' matrices, each times what is said of its body: as it was found on this pattern, or anew.
fn kept<'a>(
    sum: &'a mut Option<SparseMatrix>,
    (model, layout): (&Model, &Layout),
    is: &[bool],
    factor: impl Fn(usize) -> f64,
) -> Option<&'a SparseMatrix> {
    let factor = |e: usize| factor(model.body_of_element[e]);
    if !(0..is.len()).any(|e| is[e] && factor(e) != 0.0) {
        return None;
    }
    if sum.as_ref().is_none_or(|sum| !Arc::ptr_eq(&sum.pattern, &layout.pattern)) {
        let mut total = layout.matrix();
        let elements: Vec<usize> = (0..is.len()).filter(|&e| is[e] && factor(e) != 0.0).collect();
        for batch in elements.chunks(BATCH) {
            let found: Vec<Vec<f64>> = batch.par_iter().map(|&e| at_rest(model, e).unwrap_or_default()).collect();
            for (&e, mut matrix) in batch.iter().zip(found) {
                matrix.iter_mut().for_each(|value| *value *= factor(e));
                add_blocks(&mut total, layout.blocks_of(e), &matrix, model.mesh.elements[e].nodes.len());
            }
        }
        *sum = Some(total);
    }
    sum.as_ref()
}

const KINDS: [ElementKind; 5] = [ElementKind::T3, ElementKind::T6, ElementKind::Q4, ElementKind::Q8, ElementKind::Q9];

/// Numbers that are kept of the K_e of an element of n nodes.
fn length(n: usize, ring: bool) -> usize {
    2 * (n - first(ring)) * rows(n)
}

/// The columns that are kept.
fn columns(matrix: &[f64], n: usize, ring: bool) -> Vec<f64> {
    let mut kept = vec![0.0; length(n, ring)];
    let columns = matrix.chunks_exact(2 * n).skip(2 * first(ring));
    kept.chunks_exact_mut(rows(n)).zip(columns).for_each(|(kept, column)| kept[..2 * n].copy_from_slice(column));
    kept
}

/// K_e, column by column; nothing if the undeformed element has forces.
fn at_rest(model: &Model, e: usize) -> Option<Vec<f64>> {
    let n = model.mesh.elements[e].nodes.len();
    let (mut force, mut matrix) = ([0.0; 18], vec![0.0; 4 * n * n]);
    let (material, still) = (&*model.bodies[model.body_of_element[e]].material, [Vector2::zeros(); 9]);
    model.solids[e].force_and_tangent(material, &still[..n], &mut force[..2 * n], &mut matrix).ok()?;
    force.iter().all(|force| *force == 0.0).then_some(matrix)
}

/// The distinct K_e of each kind, and which of them each element has.
fn distinct(model: &Model, is: &[bool]) -> ([Vec<f64>; 5], Vec<Option<u32>>) {
    let mut stiffness: [Vec<f64>; 5] = Default::default();
    let mut numbers = vec![None; is.len()];
    let mut seen: HashMap<(ElementKind, u64), u32> = HashMap::new();
    let elements: Vec<usize> = (0..is.len()).filter(|&e| is[e]).collect();
    for batch in elements.chunks(BATCH) {
        let found: Vec<Option<Vec<f64>>> = batch.par_iter().map(|&e| at_rest(model, e)).collect();
        for (&e, matrix) in batch.iter().zip(found) {
            let Some(matrix) = matrix else { continue };
            let kind = model.mesh.elements[e].kind;
            let (own, all) =
                (columns(&matrix, kind.nodes(), model.mesh.section.is_axisymmetric()), &mut stiffness[kind as usize]);
            let next = (all.len() / own.len()) as u32;
            let number = match seen.entry((kind, hash(&own))) {
                Entry::Vacant(entry) => *entry.insert(next),
                Entry::Occupied(entry) if same(&all[*entry.get() as usize * own.len()..][..own.len()], &own) => {
                    *entry.get()
                }
                Entry::Occupied(_) => next,
            };
            if number == next {
                all.extend(own);
            }
            numbers[e] = Some(number);
        }
    }
    (stiffness, numbers)
}

fn hash(values: &[f64]) -> u64 {
    let mut hasher = DefaultHasher::new();
    values.iter().for_each(|value| value.to_bits().hash(&mut hasher));
    hasher.finish()
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}
