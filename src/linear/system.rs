//! Linearized equations of one iteration, and the contribution of one element or contact point.

use nalgebra::{DMatrix, DVector};

use super::SparseMatrix;

/// Request to the equations at a trial displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Residual only, at an iterate.
    Residual,
    /// Residual between iterates, for a line search.
    Between,
    /// Residual and tangent.
    Tangent,
}

/// Residual r and tangent K = ∂r/∂u at a trial displacement.
#[derive(Clone, Debug)]
pub struct System {
    /// r: residual force of every dof; at a prescribed dof, `weight`·(u − ū) [F]
    pub residual: Vec<f64>,
    /// K; at a prescribed dof, a row of the identity times `weight` [F/L]
    pub tangent: SparseMatrix,
    /// Norm of all forces: the sum of the magnitudes of the contributions of every element and contact point [F]
    pub forces: f64,
    /// Largest ‖r‖/‖f‖ of all parts that must be in equilibrium separately, where forces below round-off are not counted as
    /// small [-]
    pub imbalance: f64,
}

/// Contribution of one contact point or point element: forces and tangent of its nodes, two dofs per node.
#[derive(Clone, Debug, PartialEq)]
pub struct Contribution {
    /// Nodes, in the order of the entries
    pub nodes: Vec<usize>,
    /// Internal force, length 2 × nodes [F]
    pub force: DVector<f64>,
    /// ∂force/∂u [F/L]
    pub tangent: DMatrix<f64>,
}

impl Contribution {
    /// Creates a zero contribution on the given nodes.
    pub fn zero(nodes: Vec<usize>) -> Self {
        let n = 2 * nodes.len();
        Self { nodes, force: DVector::zeros(n), tangent: DMatrix::zeros(n, n) }
    }
}
