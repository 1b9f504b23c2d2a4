//! The linearized equations of one iteration, and what one element or contact point adds to them.

use nalgebra::{DMatrix, DVector};

use super::SparseMatrix;

/// Request to the equations at a trial displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// The residual at an iterate is enough.
    Residual,
    /// The residual between iterates, for a line search.
    Between,
    /// The tangent as well.
    Tangent,
}

/// Residual r and tangent K = ∂r/∂u at a trial displacement.
#[derive(Clone, Debug)]
pub struct System {
    /// r: out-of-balance force of every dof; at a prescribed dof, `weight`·(u − ū) [F]
    pub residual: Vec<f64>,
    /// K, at a prescribed dof a row of the identity times `weight` [F/L]
    pub tangent: SparseMatrix,
    /// Norm of the forces at work: every element's and contact point's share counted without its sign [F]
    pub forces: f64,
    /// Largest ‖r‖/‖f‖ of all parts that must be in equilibrium by themselves, forces that round-off hides not counted as
    /// small [-]
    pub imbalance: f64,
}

/// Contribution of one contact point or point element: forces and tangent of its nodes, two dofs per node.
#[derive(Clone, Debug, PartialEq)]
pub struct Contribution {
    /// The nodes, in the order of the entries
    pub nodes: Vec<usize>,
    /// Internal force, length 2 × nodes [F]
    pub force: DVector<f64>,
    /// ∂force/∂u [F/L]
    pub tangent: DMatrix<f64>,
}

impl Contribution {
    /// A contribution of zero on the given nodes.
    pub fn zero(nodes: Vec<usize>) -> Self {
        let n = 2 * nodes.len();
        Self { nodes, force: DVector::zeros(n), tangent: DMatrix::zeros(n, n) }
    }
}
