//! Constant elements in blocks: neighbours of one kind and body, so few that all that their nodes need stays at hand.
//!
//! A block gathers its nodes' motions once and adds up its elements' forces by itself; a node finds its sum in one block, or
//! in a few where blocks meet. Which elements form a block depends on the mesh alone: elements follow each other along
//! Morton's curve through their centres, whatever their numbers are.

use nalgebra::Vector2;
use rayon::prelude::*;

use crate::mesh::shape::ElementKind;
use crate::model::Model;
use crate::model::element::Memory;

/// Most nodes of a block.
pub(super) const NODES: usize = 512;

/// Cells along each side of the mesh that Morton's curve tells apart.
const CELLS: f64 = 65535.0;

/// Rows of the matrix of an element of n nodes as it is kept, filled up with zeros to whole registers.
pub(super) const fn rows(n: usize) -> usize {
    (2 * n).next_multiple_of(4)
}

/// Elements that are evaluated together.
pub(super) struct Block {
    pub body: usize,
    pub kind: ElementKind,
    /// Nodes, ascending
    pub nodes: Vec<u32>,
    /// Place in `nodes` of each element's nodes
    pub places: Vec<u16>,
    /// Number of each element's matrix
    pub matrices: Vec<u32>,
    /// f_0 of each element, filled up with zeros as its matrix is, if the body has an initial stress [F]
    pub initial: Vec<f64>,
}

/// Blocks of the elements that have a matrix, and which it is.
pub(super) fn blocks(model: &Model, matrices: &[Option<u32>]) -> Vec<Block> {
    let mut order = Vec::with_capacity(matrices.len());
    let curve = curve(model);
    for (e, &matrix) in matrices.iter().enumerate() {
        let Some(matrix) = matrix else { continue };
        let kind = model.mesh.elements[e].kind;
        order.push(((model.body_of_element[e], kind as usize, curve(e), e), matrix));
    }
    order.sort_unstable();
    // Block in which each node was seen last
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

/// Sort the nodes of every block, and find the places of its elements' nodes.
fn find_places(model: &Model, elements: &[Vec<usize>], blocks: &mut [Block]) {
    let mut place = vec![0u16; model.mesh.nodes.len()];
    for (block, own) in blocks.iter_mut().zip(elements) {
        block.nodes.sort_unstable();
        block.nodes.iter().enumerate().for_each(|(k, &node)| place[node as usize] = k as u16);
        block.places = own.iter().flat_map(|&e| model.mesh.elements[e].nodes.iter().map(|&node| place[node])).collect();
    }
}

/// Find what the initial stress of bodies puts on the nodes of their elements.
fn find_initial(model: &Model, elements: &[Vec<usize>], blocks: &mut [Block]) {
    let stressed = |block: &Block| model.bodies[block.body].initial_stress.is_some();
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
            // An element that has a matrix has an answer where nothing has moved.
            let _ = model.solids[e].evolve(material, memory, &still[..n], &mut force[..2 * n], None);
        }
    });
}

/// Where an element lies on Morton's curve: the digits of its centre's coordinates in turn.
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
