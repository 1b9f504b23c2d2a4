//! Mass of one element, per direction: component i of node a and component j of node b share M_ab δ_ij.

use nalgebra::{DMatrix, DVector, Vector2};

use super::{ElementError, gradients};
use crate::mesh::section::Section;
use crate::mesh::shape::ElementKind;

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
    section: Section,
    positions: &[Vector2<f64>],
    density: f64,
) -> Result<DMatrix<f64>, ElementError> {
    let mut mass = DMatrix::zeros(kind.nodes(), kind.nodes());
    for point in kind.mass_quadrature() {
        let (_, jacobian) = gradients(kind, point.at, positions)?;
        let values = DVector::from_vec(kind.values(point.at));
        let place = positions.iter().zip(values.iter()).map(|(x, n)| x * *n).sum();
        mass.ger(density * point.weight * jacobian * section.weight(place), &values, &values, 1.0);
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
pub fn lumped_mass(
    kind: ElementKind,
    section: Section,
    positions: &[Vector2<f64>],
    density: f64,
) -> Result<DVector<f64>, ElementError> {
    let mass = consistent_mass(kind, section, positions, 1.0)?;
    let linear = kind.nodes() == kind.corners();
    let volumes = if linear { mass.column_sum() } else { mass.diagonal() * (mass.sum() / mass.trace()) };
    Ok(density * volumes)
}

/// An element's mass without any at the nodes that are `massless`: in its kinetic energy they move with the mean of the
/// others.
///
/// ```text
/// M̃ = Tᵀ M T,   (T v)_a = v_a, or the mean of all v_b that have mass if a is massless
/// ```
///
/// The mass as a whole and the momentum stay. A surface without inertia follows the contact at once, as in statics; with
/// inertia its nodes bounce on the penalty stiffness faster than increments resolve, and schemes without damping then create
/// energy. An element all of whose nodes are massless keeps its mass.
///
/// Source: Khenous, Laborde & Renard (2008), Eur. J. Mech. A 27, 918; Hager, Hüeber & Wohlmuth (2008), Int. J. Numer. Meth.
/// Eng. 73, 205 (mass kept in the strip of elements).
pub fn redistributed(mass: DMatrix<f64>, massless: impl Fn(usize) -> bool) -> DMatrix<f64> {
    let n = mass.nrows();
    let heavy: Vec<usize> = (0..n).filter(|&node| !massless(node)).collect();
    if heavy.len() == n || heavy.is_empty() {
        return mass;
    }
    let mut motion = DMatrix::zeros(n, n);
    for node in 0..n {
        match massless(node) {
            true => heavy.iter().for_each(|&other| motion[(node, other)] = 1.0 / heavy.len() as f64),
            false => motion[(node, node)] = 1.0,
        }
    }
    motion.transpose() * mass * motion
}
