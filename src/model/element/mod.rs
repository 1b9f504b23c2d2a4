//! Solid elements: internal force, tangent, stress and mass of one element.
//!
//! Degrees of freedom of an element are ordered by node: component i of node a is 2a + i. Integrals are
//! weighted as the [`Section`](crate::mesh::section::Section) says.

use nalgebra::{Matrix2, Vector2};
use thiserror::Error;

use crate::mesh::shape::ElementKind;

mod mass;
pub mod pressure;
mod solid;

pub use mass::{consistent_mass, lumped_mass, redistributed};
pub use solid::{Memory, SolidElement};

/// An element that cannot be built on its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ElementError {
    /// det(∂X/∂ξ) ≤ 0 at a quadrature point
    #[error(
        "the element is degenerate, too distorted or numbered clockwise (Jacobian {jacobian:.3e} at a quadrature point)"
    )]
    Degenerate {
        /// det(∂X/∂ξ), or not a number [L²]
        jacobian: f64,
    },
    /// F-bar was asked of an element that is not a four-node quadrilateral
    #[error("f_bar is for four-node quadrilaterals (Q4), not for {kind:?}")]
    FBarNeedsQ4 {
        /// kind of the element
        kind: ElementKind,
    },
}

/// ∂N_a/∂X of all nodes and det(∂X/∂ξ) at the reference coordinates `at`.
///
/// ```text
/// ∂X/∂ξ = Σ_a (X_a − X_1) ⊗ ∂N_a/∂ξ,   ∂N_a/∂X = (∂X/∂ξ)⁻ᵀ ∂N_a/∂ξ
/// ```
/// Positions count from the first node, so that nothing is lost far from the origin.
fn gradients(
    kind: ElementKind,
    at: [f64; 2],
    positions: &[Vector2<f64>],
) -> Result<(Vec<Vector2<f64>>, f64), ElementError> {
    let derivatives: Vec<_> = kind.derivatives(at).into_iter().map(Vector2::from).collect();
    let map: Matrix2<f64> = positions.iter().zip(&derivatives).map(|(x, d)| (x - positions[0]) * d.transpose()).sum();
    let jacobian = map.determinant();
    match map.transpose().try_inverse() {
        Some(inverse) if jacobian > 0.0 => Ok((derivatives.iter().map(|d| inverse * d).collect(), jacobian)),
        _ => Err(ElementError::Degenerate { jacobian }),
    }
}
