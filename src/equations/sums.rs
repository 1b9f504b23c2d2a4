//! Common parts of the terms of the equations: destination of their contributions, dependence of their tangents, and failures
//! of their evaluation.

use thiserror::Error;

use super::coupling::Layout;
use crate::laws::bulk::MaterialFailure;
use crate::laws::friction::LawFailure;
use crate::linear::{BlockPosition, SparseMatrix};
use crate::model::Model;
use crate::model::pore_flow::{MOST_CORNERS, MOST_NODES, OfNodes, WetElement};
use crate::model::scheme::time_text;
use crate::model::text::{number, vector};

/// Nodal forces and, on request, their magnitudes and tangent.
pub(super) struct Sums<'a> {
    /// F [F]
    pub force: &'a mut [f64],
    /// Sum of the magnitudes of all contributions at each dof: the scale of the residual [F]
    pub magnitudes: Option<&'a mut [f64]>,
    /// ∂F/∂u [F/L]
    pub tangent: Option<&'a mut SparseMatrix>,
    /// coupling of nodes
    pub layout: &'a Layout,
}

impl Sums<'_> {
    /// Adds a force at a dof.
    pub fn add(&mut self, dof: usize, force: f64) {
        self.force[dof] += force;
        if let Some(magnitudes) = &mut self.magnitudes {
            magnitudes[dof] += force.abs();
        }
    }

    /// Adds ∂f_row/∂u_column between two dofs of one node.
    pub fn stiffen(&mut self, row: usize, column: usize, stiffness: f64) {
        if let Some(tangent) = &mut self.tangent {
            let own = 2 * self.layout.original(row / 2);
            tangent.add(own + row % 2, own + column % 2, stiffness);
        }
    }

    /// Adds forces of some nodes.
    pub fn push(&mut self, nodes: &[usize], force: &[f64]) {
        for (&node, force) in nodes.iter().zip(force.chunks_exact(2)) {
            (0..2).for_each(|i| self.add(2 * node + i, force[i]));
        }
    }

    /// Adds the tangent of an element of some nodes, column by column.
    pub fn couple_element(&mut self, element: usize, nodes: usize, local: &[f64]) {
        if let Some(tangent) = &mut self.tangent {
            add_blocks(tangent, self.layout.blocks_of(element), local, nodes);
        }
    }

    /// Adds a tangent of some nodes, column by column.
    pub fn couple(&mut self, nodes: &[usize], local: &[f64]) {
        if let Some(tangent) = &mut self.tangent {
            let blocks = self.layout.blocks_between(nodes);
            add_blocks(tangent, &blocks, local, nodes.len());
        }
    }

    /// Adds ∂r/∂u, ∂r/∂p and ∂f/∂p of an element that water flows through, by its number among such elements: with −r = s Δm and f = −∫ b p ∂J/∂u dV they are
    /// −s ∂Δm/∂u, of which ∂f/∂p is the transpose, and −s ∂Δm/∂p s.
    pub fn couple_pressures(
        &mut self,
        number: usize,
        wet: &WetElement,
        scales: &[f64; MOST_CORNERS],
        PressureTangent { opens, takes }: &PressureTangent,
    ) {
        let Some(tangent) = &mut self.tangent else { return };
        let (nodes, in_mesh) = (wet.nodes.len(), wet.in_mesh);
        let mut scaled = *opens;
        for (scaled, scale) in scaled.iter_mut().zip(scales) {
            scaled.as_flattened_mut().iter_mut().for_each(|part| *part *= -scale);
        }
        let of_pressures = self.layout.blocks_of_water(number).chunks_exact(nodes + in_mesh);
        for (b, (blocks, [x, y])) in of_pressures.zip(&scaled).enumerate() {
            let (column, row) = blocks.split_at(nodes);
            let (solid, water) = column.split_at(in_mesh);
            for (k, (block, transposed)) in solid.iter().zip(row).enumerate() {
                tangent.add_column(*block, 0, [x[k], y[k]]);
                tangent.values[transposed.value(0, 0)] += x[k];
                tangent.values[transposed.value(0, 1)] += y[k];
            }
            for (a, block) in water.iter().enumerate() {
                tangent.values[block.value(0, 0)] -= scales[a] * scales[b] * takes[a][b];
            }
        }
    }

    /// Adds what the forces of the water in an element change by with the displacements, ∂f/∂u_x by column.
    pub fn stiffen_pressed(&mut self, wet: &WetElement, stiffness: &[OfNodes; MOST_NODES]) {
        let Some(tangent) = &mut self.tangent else { return };
        let columns = self.layout.blocks_of(wet.element).chunks_exact(wet.in_mesh);
        for (b, (blocks, [of_x, of_y])) in columns.zip(stiffness).enumerate() {
            for (a, block) in blocks.iter().enumerate() {
                tangent.add_block(*block, [[of_x[a], of_y[a]], [stiffness[a][1][b], 0.0]]);
            }
        }
    }
}

/// What the water of an element changes by, by corner.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PressureTangent {
    /// ∂Δm/∂u = ∫ b N ∂J/∂u dV of all nodes [L²]
    pub opens: [OfNodes; MOST_CORNERS],
    /// ∂Δm/∂p + Δt/β ∫ ∇N·∂v/∂∇p ∇N dV [L⁵/F]
    pub takes: [[f64; MOST_CORNERS]; MOST_CORNERS],
}

/// Adds a dense tangent of `n` nodes (column-major, two dofs per node) at the given blocks (column by column).
pub(super) fn add_blocks(matrix: &mut SparseMatrix, blocks: &[BlockPosition], local: &[f64], n: usize) {
    for (columns, blocks) in local.chunks_exact(4 * n).zip(blocks.chunks_exact(n)) {
        for (j, column) in columns.chunks_exact(2 * n).enumerate() {
            for (pair, block) in column.chunks_exact(2).zip(blocks) {
                let target = &mut matrix.values[block.value(0, j)..][..2];
                target[0] += pair[0];
                target[1] += pair[1];
            }
        }
    }
}

/// Dependence of a tangent during a step; each level includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dependence {
    /// Constant during the step
    Nothing,
    /// Δt
    StepSize,
    /// t, Δt
    Time,
    /// u, t, Δt and the state at the start of the increment
    Displacement,
}

/// Reason why the equations could not be evaluated at a trial state.
#[derive(Clone, Debug, PartialEq, Error)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub enum TrialFailure {
    /// An element is inverted.
    #[error(
        "element {element} of body `{body}` is inverted (det F = {jacobian:.3e}) at ({}, {})", number(at[0]), number(at[1])
    )]
    Inverted {
        /// its tag in the mesh file
        element: u64,
        /// its body
        body: String,
        /// its centre in the mesh
        at: [f64; 2],
        /// det F
        jacobian: f64,
    },
    /// An element is compressed to a small fraction of its size.
    #[error(
        "element {element} of body `{body}` is compressed to {share:.1e} of its size at ({}, {})", number(at[0]), number(at[1])
    )]
    Crushed {
        /// its tag in the mesh file
        element: u64,
        /// its body
        body: String,
        /// its centre in the mesh
        at: [f64; 2],
        /// remaining fraction of its size
        share: f64,
    },
    /// The place where an element comes is too narrow for it.
    #[error(
        "element {element} of body `{body}` at ({}, {}) would be added with {:.0} % of its size in the mesh: the nodes \
         that it shares with other bodies have moved relative to its other nodes, which stay where they were; add the \
         body earlier", number(at[0]), number(at[1]), 100.0 * share
    )]
    Narrow {
        /// its tag in the mesh file
        element: u64,
        /// its body
        body: String,
        /// its centre in the mesh
        at: [f64; 2],
        /// least share of its size
        share: f64,
    },
    /// A material law failed.
    #[error("element {element} of body `{body}` at ({}, {}): {cause}", number(at[0]), number(at[1]))]
    Material {
        /// its tag in the mesh file
        element: u64,
        /// its body
        body: String,
        /// its centre in the mesh
        at: [f64; 2],
        /// failure reported by the law
        cause: MaterialFailure,
    },
    /// A friction law failed.
    #[error("contact `{contact}`, point {point}: {cause}")]
    Friction {
        /// contact pair
        contact: String,
        /// slave point
        point: usize,
        /// failure reported by the law
        cause: LawFailure,
    },
    /// A fluid pressure is negative or not finite.
    #[error(
        "contact `{contact}`: its fluid_pressure is {} at {} and time {}: it must be a finite number, zero or positive",
        number(*pressure), vector(*at), time_text(*time)
    )]
    FluidPressure {
        /// contact pair
        contact: String,
        /// reference position of the slave point
        at: [f64; 2],
        /// p_w
        pressure: f64,
        /// run time
        time: f64,
    },
    /// A support or load expression has no finite value.
    #[error("a support or load at node {node} is not a finite number at time {}: check its expression", time_text(*time))]
    Undefined {
        /// its tag in the mesh file
        node: u64,
        /// run time
        time: f64,
    },
}

impl TrialFailure {
    /// Returns the failure of a material law in an element, with its tag and body.
    pub(crate) fn material(model: &Model, e: usize, cause: MaterialFailure) -> Self {
        let (element, body, at) = named(model, e);
        match cause {
            MaterialFailure::Inverted { jacobian } => Self::Inverted { element, body, at, jacobian },
            _ => Self::Material { element, body, at, cause },
        }
    }

    /// Returns the failure of an element that comes into a narrow place.
    pub(crate) fn narrow(model: &Model, e: usize, share: f64) -> Self {
        let (element, body, at) = named(model, e);
        Self::Narrow { element, body, at, share }
    }

    /// Returns the failure of an element compressed to a small fraction of its size.
    pub(crate) fn crushed(model: &Model, e: usize, share: f64) -> Self {
        let (element, body, at) = named(model, e);
        Self::Crushed { element, body, at, share }
    }
}

/// Tag, body and centre of an element.
fn named(model: &Model, e: usize) -> (u64, String, [f64; 2]) {
    let nodes = &model.mesh.elements[e].nodes;
    let centre = [0, 1].map(|i| nodes.iter().map(|&node| model.mesh.nodes[node][i]).sum::<f64>() / nodes.len() as f64);
    (model.mesh.element_tags[e], model.bodies[model.body_of_element[e]].name.clone(), centre)
}
