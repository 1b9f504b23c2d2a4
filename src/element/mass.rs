//! Mass of one element, per direction: component i of node a and component j of node b share M_ab δ_ij.

use nalgebra::{DMatrix, DVector, Vector2};

use super::{ElementError, gradients};
use crate::shape::ElementKind;

/// Consistent mass, n × n.
///
/// ```text
/// M_ab = ∫ ρ₀ N_a N_b dV
/// ```
///
/// # Errors
/// [`ElementError::Degenerate`] when the element has no positive area at a quadrature point.
pub fn consistent_mass(
    kind: ElementKind,
    positions: &[Vector2<f64>],
    density: f64,
) -> Result<DMatrix<f64>, ElementError> {
    let mut mass = DMatrix::zeros(kind.nodes(), kind.nodes());
    for point in kind.mass_quadrature() {
        let (_, jacobian) = gradients(kind, point.at, positions)?;
        let values = DVector::from_vec(kind.values(point.at));
        mass.ger(density * point.weight * jacobian, &values, &values, 1.0);
    }
    Ok(mass)
}

/// Lumped mass of each node; all positive, and their sum is the mass of the element.
///
/// ```text
/// m_a = Σ_b M_ab                              linear elements: row sums                       (1)
/// m_a = M_aa (Σ_bc M_bc) / (Σ_b M_bb)         quadratic elements: scaled diagonal             (2)
/// ```
///
/// The row sums of quadratic elements are zero or negative at the corners, hence (2).
///
/// # Errors
/// As [`consistent_mass`].
///
/// Source: Hinton, Rock & Zienkiewicz (1976), Earthq. Engng Struct. Dyn. 4, 245, doi:10.1002/eqe.4290040305.
pub fn lumped_mass(kind: ElementKind, positions: &[Vector2<f64>], density: f64) -> Result<DVector<f64>, ElementError> {
    let mass = consistent_mass(kind, positions, 1.0)?;
    let linear = kind.nodes() == kind.corners();
    let volumes = if linear { mass.column_sum() } else { mass.diagonal() * (mass.sum() / mass.trace()) };
    Ok(density * volumes)
}
