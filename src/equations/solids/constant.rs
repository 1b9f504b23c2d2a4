//! Elements with constant stiffness, which is computed once and shared by elements for which it is bitwise equal.
//!
//! ```text
//! f_e = f_0 + K_e (u_e − u_1),   W_e = ½ (u_e − u_1)·(f_e + f_0),   f_v = τ K_e (v_e − v_1)
//! ```
//! f_0 are the forces of the initial stress.
//!
//! Motions are taken relative to the element's first node: a rigid translation causes no round-off, and the columns of K_e of
//! that node are not needed (in axisymmetry this holds for axial motions only, and all columns are stored). An element stores
//! them unless an earlier one has the same: 384 bytes for Q4, 256 for T3, 960 for T6, 1792 for Q8, 2560 for Q9. Equal elements
//! of a regular mesh differ in the last bits of their node positions unless these are exactly representable.
//!
//! # Blocks
//!
//! Constant elements are evaluated in blocks: neighbours of one kind and body, few enough that all data of their nodes fit into
//! the cache.
//!
//! A block gathers the motions of its nodes once and sums the forces of its elements; a node finds its sum in one block, or
//! in a few where blocks meet. The division into blocks depends on the mesh only: elements are ordered along the
//! Morton curve through their centres, independent of their numbers.
//!
//! The kernel is the loop over the elements of a block.

use std::collections::HashMap;
use std::collections::hash_map::{DefaultHasher, Entry};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use nalgebra::{Matrix2, Vector2, Vector4};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::runs::{BATCH, Places};
use crate::equations::coupling::Layout;
use crate::equations::sums::{TrialFailure, add_blocks};
use crate::equations::trial::nodal;
use crate::laws::bulk::Material;
use crate::laws::bulk::components::{components, plane};
use crate::linear::SparseMatrix;
use crate::mesh::shape::ElementKind;
use crate::model::element::Memory;
use crate::model::{Body, Model};

/// Number of blocks below which evaluation takes less time than starting another thread.
const FEW_BLOCKS: usize = 2;

/// Whether the tangent of an element is the same at every displacement: for a linear law at small strains with no or constant
/// internal variables; with F-bar the tangent varies nevertheless.
pub fn is_constant(model: &Model, element: usize) -> bool {
    let body = &model.bodies[model.body_of_element[element]];
    is_linear_elastic(body.law_of_elements()) && !model.solids[element].is_f_bar()
}

/// Whether the tangent of a law is the same at every strain, and symmetric.
pub(super) fn is_linear_elastic(material: &dyn Material) -> bool {
    let description = material.description();
    description.is_linear && description.is_symmetric && !description.evolves
}

/// Whether the viscous stress of a law is τ ∂P/∂F:Ḟ with the same ∂P/∂F at every F; not every linear law has one.
pub(in crate::equations) fn damps_by_stiffness(material: &dyn Material) -> bool {
    if !material.description().is_linear {
        return false;
    }
    let (deformation, rate) = (Matrix2::new(1.25, 0.5, -0.25, 0.75), Matrix2::new(0.5, -1.0, 0.75, 0.25));
    let Ok(response) = material.at_once(&deformation) else { return false };
    let elastic = response.tangent * Vector4::from_column_slice(rate.as_slice());
    let elastic = Matrix2::from_column_slice(elastic.as_slice());
    let motion = [&components(&deformation, 1.0), &components(&rate, 0.0)];
    let viscous = plane(&material.description().viscous_stress(motion));
    (viscous - elastic).norm() <= 1e-12 * elastic.norm()
}

/// Constant elements of a model.
pub(super) struct Constant {
    /// Whether each element is one
    pub is: Vec<bool>,
    /// Columns of the distinct K_e of each kind starting at the second node (in axisymmetry at the first), one matrix after the
    /// other [F/L]
    stiffness: [Vec<f64>; 5],
    /// Whether the section is axisymmetric
    ring: bool,
    blocks: Vec<Block>,
    /// Positions of each node's block forces
    pub places: Places,
    /// Forces of the blocks on their nodes, `stride` entries per block [F]
    pub forces: Vec<Vector2<f64>>,
    /// Viscous forces of the blocks, or the magnitudes of their elements' forces [F]
    pub others: Vec<Vector2<f64>>,
    stride: usize,
    /// Energy stored in each block [F·L]
    energies: Vec<f64>,
    /// Sum of all K_e on the pattern
    total: Option<SparseMatrix>,
    /// Sum of all τ K_e on the pattern
    viscous: Option<SparseMatrix>,
}

impl Constant {
    pub fn new(model: &Model, are_there: impl Fn(usize) -> bool) -> Self {
        let never = |body: usize| model.steps.iter().all(|step| model.damping(step, body).retardation == 0.0);
        let undamped = |body: usize| model.bodies[body].damping.retardation == 0.0 && never(body);
        let fit = |(k, body): (usize, &Body)| undamped(k) || damps_by_stiffness(body.law_of_elements());
        let fit: Vec<bool> = model.bodies.iter().enumerate().map(fit).collect();
        let is = |e: usize| are_there(e) && is_constant(model, e) && fit[model.body_of_element[e]];
        let is: Vec<bool> = (0..model.solids.len()).map(is).collect();
        let (mut stiffness, matrices) = distinct(model, &is);
        // A law with stress in the undeformed body is not proportional to the displacements.
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

    /// Computes the nodal forces of all elements in the blocks' `forces`, and the second result of a pass in `others`; the
    /// stored energies are kept.
    pub fn evaluate(&mut self, retardation: &[f64], pass: Pass) {
        let Self { stiffness, ring, blocks, forces, others, energies, .. } = self;
        let stride = self.stride.max(1);
        let places = forces.par_chunks_exact_mut(stride).zip(others.par_chunks_exact_mut(stride));
        let all = blocks.par_iter().zip(places).zip(energies).with_min_len(FEW_BLOCKS);
        all.for_each(|((block, (forces, others)), energy)| {
            let retardation = retardation[block.body];
            *energy = block.evaluate(&stiffness[block.kind as usize], *ring, retardation, pass, [forces, others]);
        });
    }

    /// Stored energy of all elements; an error for the first one with a non-finite strain.
    pub fn stored(&self, model: &Model, u: &[f64]) -> Result<f64, TrialFailure> {
        let energy: f64 = self.energies.iter().sum();
        if !energy.is_finite() {
            for e in (0..self.is.len()).filter(|&e| self.is[e]) {
                let (n, mut forces) = (model.mesh.elements[e].nodes.len(), [Vector2::zeros(); 9]);
                let material = model.bodies[model.body_of_element[e]].law_of_elements();
                let found = model.solids[e].nodal_forces(material, &nodal(model, e, u)[..n], &mut forces[..n]);
                found.map_err(|failure| TrialFailure::material(model, e, failure))?;
            }
        }
        Ok(energy)
    }

    /// Σ K_e on the current pattern; `None` if there are no constant elements.
    pub fn total(&mut self, model: &Model, layout: &Layout) -> Option<&SparseMatrix> {
        stored(&mut self.total, model, layout, &self.is, |_| 1.0)
    }

    /// Σ τ K_e on the current pattern; `None` if there is none.
    pub fn viscous(&mut self, model: &Model, retardation: &[f64], layout: &Layout) -> Option<&SparseMatrix> {
        stored(&mut self.viscous, model, layout, &self.is, |body| retardation[body])
    }

    /// Discards that sum because τ has changed.
    pub fn forget_viscous(&mut self) {
        self.viscous = None;
    }
}

/// Sum of the constant elements' matrices, each multiplied by a factor of its body; stored for this pattern or recomputed.
fn stored<'a>(
    sum: &'a mut Option<SparseMatrix>,
    model: &Model,
    layout: &Layout,
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

/// Number of stored entries of K_e of an element of n nodes.
fn length(n: usize, ring: bool) -> usize {
    2 * (n - first(ring)) * rows(n)
}

/// The stored columns.
fn columns(matrix: &[f64], n: usize, ring: bool) -> Vec<f64> {
    let mut stored = vec![0.0; length(n, ring)];
    let columns = matrix.chunks_exact(2 * n).skip(2 * first(ring));
    stored.chunks_exact_mut(rows(n)).zip(columns).for_each(|(stored, column)| stored[..2 * n].copy_from_slice(column));
    stored
}

/// K_e, column by column; `None` if the undeformed element has forces.
fn at_rest(model: &Model, e: usize) -> Option<Vec<f64>> {
    let n = model.mesh.elements[e].nodes.len();
    let (mut force, mut matrix) = ([0.0; 18], vec![0.0; 4 * n * n]);
    let (material, still) = (model.bodies[model.body_of_element[e]].law_of_elements(), [Vector2::zeros(); 9]);
    model.solids[e].force_and_tangent(material, &still[..n], &mut force[..2 * n], &mut matrix).ok()?;
    force.iter().all(|force| *force == 0.0).then_some(matrix)
}

/// The distinct K_e of each kind, and the index of each element's matrix.
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

/// Maximum number of nodes of a block.
const NODES: usize = 512;

/// Number of cells of the Morton curve along each side of the mesh.
const CELLS: f64 = 65535.0;

/// Number of rows of the stored matrix of an element of n nodes, padded with zeros to whole registers.
const fn rows(n: usize) -> usize {
    (2 * n).next_multiple_of(4)
}

/// Elements evaluated together.
struct Block {
    pub body: usize,
    pub kind: ElementKind,
    /// Nodes, ascending
    pub nodes: Vec<u32>,
    /// Index in `nodes` of each element's nodes
    pub places: Vec<u16>,
    /// Number of each element's matrix
    pub matrices: Vec<u32>,
    /// f_0 of each element, padded with zeros like its matrix, if the body has an initial stress [F]
    pub initial: Vec<f64>,
}

/// Divides the elements with a matrix into blocks, with the index of their matrices.
fn blocks(model: &Model, matrices: &[Option<u32>]) -> Vec<Block> {
    let mut order = Vec::with_capacity(matrices.len());
    let curve = curve(model);
    for (e, &matrix) in matrices.iter().enumerate() {
        let Some(matrix) = matrix else { continue };
        let kind = model.mesh.elements[e].kind;
        order.push(((model.body_of_element[e], kind as usize, curve(e), e), matrix));
    }
    order.sort_unstable();
    // Block in which each node was last found
    let mut seen = vec![usize::MAX; model.mesh.nodes.len()];
    let mut blocks: Vec<Block> = Vec::new();
    for &((body, _, _, e), matrix) in &order {
        let element = &model.mesh.elements[e];
        let fits = |block: &Block| {
            let new = element.nodes.iter().filter(|&&node| seen[node] != blocks.len() - 1).count();
            block.body == body && block.kind == element.kind && block.nodes.len() + new <= NODES
        };
        if !blocks.last().is_some_and(fits) {
            let [nodes, matrices] = [Vec::new(), Vec::new()];
            let (places, initial) = (Vec::new(), Vec::new());
            blocks.push(Block { body, kind: element.kind, nodes, matrices, places, initial });
        }
        let number = blocks.len() - 1;
        let block = &mut blocks[number];
        for &node in &element.nodes {
            if std::mem::replace(&mut seen[node], number) != number {
                block.nodes.push(node as u32);
            }
        }
        block.matrices.push(matrix);
    }
    let mut elements = order.iter().map(|((.., e), _)| *e);
    let elements: Vec<Vec<usize>> =
        blocks.iter().map(|block| elements.by_ref().take(block.matrices.len()).collect()).collect();
    find_places(model, &elements, &mut blocks);
    find_initial(model, &elements, &mut blocks);
    blocks
}

/// Sorts the nodes of every block, and finds the indices of its elements' nodes.
fn find_places(model: &Model, elements: &[Vec<usize>], blocks: &mut [Block]) {
    let mut place = vec![0u16; model.mesh.nodes.len()];
    for (block, own) in blocks.iter_mut().zip(elements) {
        block.nodes.sort_unstable();
        block.nodes.iter().enumerate().for_each(|(k, &node)| place[node as usize] = k as u16);
        block.places = own.iter().flat_map(|&e| model.mesh.elements[e].nodes.iter().map(|&node| place[node])).collect();
    }
}

/// Computes the nodal forces of the initial stress of bodies.
fn find_initial(model: &Model, elements: &[Vec<usize>], blocks: &mut [Block]) {
    let stressed = |block: &Block| {
        let body = &model.bodies[block.body];
        body.is_stressed() && body.skeleton.is_none()
    };
    if !blocks.iter().any(stressed) {
        return;
    }
    let all = model.initial_memory();
    blocks.par_iter_mut().zip(elements).filter(|(block, _)| stressed(block)).for_each(|(block, elements)| {
        let (n, material) = (block.kind.nodes(), &*model.bodies[block.body].material);
        block.initial = vec![0.0; rows(n) * elements.len()];
        for (&e, force) in elements.iter().zip(block.initial.chunks_exact_mut(rows(n))) {
            let old = model.memories.of(e, &all);
            let (memory, still) = (Memory { dt: 0.0, old, new: &mut old.to_vec() }, [Vector2::zeros(); 9]);
            // An element with a matrix has a response at zero displacement.
            let _ = model.solids[e].evolve(material, memory, &still[..n], &mut force[..2 * n], None);
        }
    });
}

/// Position of an element on the Morton curve, which interleaves the digits of its centre's coordinates.
fn curve(model: &Model) -> impl Fn(usize) -> u64 {
    let nodes = &model.mesh.nodes;
    let [low, high] = [f64::min, f64::max].map(|choose| {
        let first = nodes.first().copied().unwrap_or_default();
        nodes.iter().fold(first, |so_far, x| so_far.zip_map(x, choose))
    });
    move |e| {
        let element = &model.mesh.elements[e].nodes;
        let sum: Vector2<f64> = element.iter().map(|&node| model.mesh.nodes[node] - low).sum();
        let cell = |i: usize| (CELLS * (sum[i] / element.len() as f64 / (high - low)[i])) as u64;
        let digit = |number: u64, k: u32| (number >> k & 1) << (2 * k);
        (0..16).map(|k| digit(cell(0), k) | digit(cell(1), k) << 1).sum()
    }
}

/// Request for an evaluation of the blocks.
#[derive(Clone, Copy, Debug)]
pub(super) enum Pass<'a> {
    /// Forces at displacements, and on request the sums of their magnitudes
    Elastic { u: &'a [f64], scaled: bool },
    /// Viscous forces at velocities, and on request the sums of their magnitudes
    Viscous { v: &'a [f64], scaled: bool },
    /// Forces at displacements, and viscous ones at velocities
    Both { u: &'a [f64], v: &'a [f64] },
}

/// What the nodal forces of a block are computed from.
#[derive(Clone, Copy)]
struct Matrices<'a> {
    /// The distinct K_e of its kind
    stiffness: &'a [f64],
    /// Forces of the initial stress; empty if there is none
    initial: &'a [f64],
}

/// A motion of all nodes, and the factor of its forces.
#[derive(Clone, Copy)]
struct Motion<'a> {
    nodes: &'a [[f64; 2]],
    factor: f64,
}

/// First node whose columns are stored. Motions are relative to the first node, whose own columns then are not needed, except
/// for x in axisymmetry, where a common motion stretches the hoops.
const fn first(ring: bool) -> usize {
    if ring { 0 } else { 1 }
}

/// Dofs as nodal vectors.
fn all(motion: &[f64]) -> &[[f64; 2]] {
    motion.as_chunks().0
}

impl Block {
    /// Computes the nodal forces, and the second result of the pass, in `sums`; returns the energy stored by the first of its
    /// motions.
    pub fn evaluate(&self, stiffness: &[f64], ring: bool, tau: f64, pass: Pass, sums: [&mut [Vector2<f64>]; 2]) -> f64 {
        match ring {
            false => self.of_section::<false>(stiffness, tau, pass, sums),
            true => self.of_section::<true>(stiffness, tau, pass, sums),
        }
    }

    fn of_section<const RING: bool>(
        &self,
        stiffness: &[f64],
        tau: f64,
        pass: Pass,
        sums: [&mut [Vector2<f64>]; 2],
    ) -> f64 {
        let elastic = Matrices { stiffness, initial: &self.initial };
        let viscous = Matrices { stiffness, initial: &[] };
        let by = |motion, factor| Motion { nodes: all(motion), factor };
        match pass {
            Pass::Elastic { u, scaled: false } => self.of_kind::<1, false, RING>(elastic, [by(u, 1.0)], sums),
            Pass::Elastic { u, scaled: true } => self.of_kind::<1, true, RING>(elastic, [by(u, 1.0)], sums),
            Pass::Viscous { v, scaled: false } => self.of_kind::<1, false, RING>(viscous, [by(v, tau)], sums),
            Pass::Viscous { v, scaled: true } => self.of_kind::<1, true, RING>(viscous, [by(v, tau)], sums),
            Pass::Both { u, v } => self.of_kind::<2, false, RING>(elastic, [by(u, 1.0), by(v, tau)], sums),
        }
    }

    fn of_kind<const M: usize, const SCALED: bool, const RING: bool>(
        &self,
        matrices: Matrices,
        motions: [Motion; M],
        sums: [&mut [Vector2<f64>]; 2],
    ) -> f64 {
        match self.kind {
            ElementKind::T3 => self.dispatched::<3, { rows(3) }, M, SCALED, RING>(matrices, motions, sums),
            ElementKind::T6 => self.dispatched::<6, { rows(6) }, M, SCALED, RING>(matrices, motions, sums),
            ElementKind::Q4 => self.dispatched::<4, { rows(4) }, M, SCALED, RING>(matrices, motions, sums),
            ElementKind::Q8 => self.dispatched::<8, { rows(8) }, M, SCALED, RING>(matrices, motions, sums),
            ElementKind::Q9 => self.dispatched::<9, { rows(9) }, M, SCALED, RING>(matrices, motions, sums),
        }
    }

    fn dispatched<const N: usize, const R: usize, const M: usize, const SCALED: bool, const RING: bool>(
        &self,
        matrices: Matrices,
        motions: [Motion; M],
        sums: [&mut [Vector2<f64>]; 2],
    ) -> f64 {
        let mut moved = [[[0.0; 2]; M]; NODES];
        for (moved, &node) in moved.iter_mut().zip(&self.nodes) {
            moved.iter_mut().zip(&motions).for_each(|(moved, motion)| *moved = motion.nodes[node as usize]);
        }
        let factors = motions.map(|motion| motion.factor);
        let mut total = [[[0.0; 2]; 2]; NODES];
        let elements = Elements::<N, R, M, SCALED, RING> {
            block: self,
            stiffness: matrices.stiffness,
            initial: matrices.initial,
            moved: &moved,
            factors,
            total: &mut total,
        };
        let energy = Arch::new().dispatch(elements);
        let [forces, others] = sums;
        for (place, total) in total[..self.nodes.len()].iter().enumerate() {
            forces[place] = Vector2::from(total[0]);
            if SCALED || M == 2 {
                others[place] = Vector2::from(total[1]);
            }
        }
        energy
    }
}

/// Elements of N nodes with R rows of stored entries, at M motions of their nodes.
struct Elements<'a, const N: usize, const R: usize, const M: usize, const SCALED: bool, const RING: bool> {
    block: &'a Block,
    stiffness: &'a [f64],
    /// Nodal forces of each element to be added to those of the first motion, if there are any
    initial: &'a [f64],
    /// Motions of the block's nodes
    moved: &'a [[[f64; 2]; M]; NODES],
    /// Factors of their forces
    factors: [f64; M],
    /// The forces of the first motion, and those of the second or the magnitudes
    total: &'a mut [[[f64; 2]; 2]; NODES],
}

impl<const N: usize, const R: usize, const M: usize, const SCALED: bool, const RING: bool> WithSimd
    for Elements<'_, N, R, M, SCALED, RING>
{
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { block, stiffness, initial, moved, factors, total } = self;
        let mut initial = initial.as_chunks::<R>().0.iter();
        let length = 2 * (N - first(RING)) * R;
        let mut twice = simd.splat_f64s(0.0);
        for (places, &matrix) in block.places.as_chunks::<N>().0.iter().zip(&block.matrices) {
            // The remainder only proves to the compiler that the index is within the block.
            let places = places.map(|place| place as usize % NODES);
            let matrix = &stiffness[length * matrix as usize..][..length];
            let mut motions = [[0.0; R]; M];
            for (m, motion) in motions.iter_mut().enumerate() {
                for (a, &place) in places.iter().enumerate().skip(first(RING)) {
                    let against = |i: usize| match RING && i == 0 {
                        true => moved[place][m][i],
                        false => moved[place][m][i] - moved[places[0]][m][i],
                    };
                    (0..2).for_each(|i| motion[2 * a + i] = factors[m] * against(i));
                }
            }
            let mut forces = [[simd.splat_f64s(0.0); R]; M];
            if let Some(initial) = initial.next().map(|own| S::as_simd_f64s(own).0) {
                forces[0].iter_mut().zip(initial).for_each(|(f, own)| *f = *own);
                twice = dot(simd, initial, S::as_simd_f64s(&motions[0]).0, twice);
            }
            for (dof, column) in matrix.as_chunks::<R>().0.iter().enumerate() {
                let column = S::as_simd_f64s(column).0;
                for (forces, motion) in forces.iter_mut().zip(&motions) {
                    let moved = simd.splat_f64s(motion[2 * first(RING) + dof]);
                    forces.iter_mut().zip(column).for_each(|(f, k)| *f = simd.mul_add_e_f64s(*k, moved, *f));
                }
            }
            twice = dot(simd, &forces[0], S::as_simd_f64s(&motions[0]).0, twice);
            for (m, forces) in forces.iter().enumerate() {
                let mut own = [0.0; R];
                S::as_mut_simd_f64s(&mut own).0.iter_mut().zip(forces).for_each(|(own, f)| *own = *f);
                for (a, &place) in places.iter().enumerate() {
                    for i in 0..2 {
                        total[place][m][i] += own[2 * a + i];
                        if SCALED {
                            total[place][1][i] += own[2 * a + i].abs();
                        }
                    }
                }
            }
        }
        0.5 * simd.reduce_sum_f64s(twice)
    }
}

/// sum + a·x, register by register.
#[inline(always)]
fn dot<S: Simd>(simd: S, a: &[S::f64s], x: &[S::f64s], sum: S::f64s) -> S::f64s {
    a.iter().zip(x).fold(sum, |sum, (a, x)| simd.mul_add_e_f64s(*a, *x, sum))
}
