//! Solid elements: internal force, tangent, stress and mass of one element.
//!
//! Degrees of freedom of an element are ordered by node: component i of node a is 2a + i. Integrals are weighted according to
//! the [`Section`].
//!
//! The mass of one element is the same for both directions: component i of node a and component j of node b have M_ab δ_ij.
//!
//! # Follower pressure
//!
//! A follower pressure on an edge has the internal force
//!
//! ```text
//! f_a = p ∫ N_a w n̂ |x'| dξ,   n̂ |x'| = (x'_y, −x'_x) out of the body (on the left of the edge)
//! ```
//!
//! This is the load −p n̂ w da moved to the left-hand side, where w is the weight of the section at x.

mod solid;

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::linear::system::Contribution;
use crate::mesh::shape;
use crate::mesh::shape::{ElementKind, QuadraturePoint};
use crate::mesh::{Configuration, Section};
pub use solid::{Memory, SolidElement};

/// How the elements of a body are integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Formulation {
    /// Displacements only, full integration
    #[default]
    Displacement,
    /// Q4 with its mean volume change and mean pressure (F-bar): does not lock for ν → 1/2, nor where a body yields
    FBar,
    /// Q8 with 2 × 2 integration points instead of 3 × 3: does not lock for ν → 1/2, nor where a body yields. An element that shares
    /// no edge with another of its body can bend into an hourglass without forces
    Reduced,
}

impl Formulation {
    /// Quadrature of the stiffness of an element of a kind that it is made for.
    pub fn quadrature(self, kind: ElementKind) -> Vec<QuadraturePoint> {
        match self {
            Self::Displacement | Self::FBar => kind.quadrature(),
            Self::Reduced => kind.reduced_quadrature(),
        }
    }

    /// Whether it is made for a kind of elements.
    fn check(self, kind: ElementKind) -> Result<(), ElementError> {
        match (self, kind) {
            (Self::Displacement, _) | (Self::FBar, ElementKind::Q4) | (Self::Reduced, ElementKind::Q8) => Ok(()),
            (Self::FBar, _) => Err(ElementError::FBarNeedsQ4 { kind }),
            (Self::Reduced, _) => Err(ElementError::ReducedNeedsQ8 { kind }),
        }
    }
}

/// Reason why an element is invalid on its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ElementError {
    /// det(∂X/∂ξ) ≤ 0 at a quadrature point
    #[error(
        "the element is degenerate, too distorted or numbered clockwise (Jacobian {jacobian:.3e} at a quadrature point)"
    )]
    Degenerate {
        /// det(∂X/∂ξ), or NaN [L²]
        jacobian: f64,
    },
    /// F-bar was requested for an element that is not a four-node quadrilateral
    #[error("f_bar is for four-node quadrilaterals (Q4), not for {kind:?}")]
    FBarNeedsQ4 {
        /// kind of the element
        kind: ElementKind,
    },
    /// Reduced integration was asked of an element that is not an eight-node quadrilateral
    #[error("reduced integration is for eight-node quadrilaterals (Q8), not for {kind:?}")]
    ReducedNeedsQ8 {
        /// kind of the element
        kind: ElementKind,
    },
}

/// ∂N_a/∂X of all nodes and det(∂X/∂ξ) at the reference coordinates `at`.
///
/// ```text
/// ∂X/∂ξ = Σ_a (X_a − X_1) ⊗ ∂N_a/∂ξ,   ∂N_a/∂X = (∂X/∂ξ)⁻ᵀ ∂N_a/∂ξ
/// ```
/// Positions are relative to the first node, to avoid round-off far from the origin.
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

/// Consistent mass, n × n.
///
/// ```text
/// M_ab = ∫ ρ₀ N_a N_b dV
/// ```
///
/// # Errors
/// Returns [`ElementError::Degenerate`] if the element has no positive area at a quadrature point.
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
/// The same as for [`consistent_mass`].
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

/// Mass of an element with zero mass at the `massless` nodes: in its kinetic energy they move with the mean of the
/// others.
///
/// ```text
/// M̃ = Tᵀ M T,   (T v)_a = v_a, or the mean of all v_b that have mass if a is massless
/// ```
///
/// Total mass and momentum are conserved. A surface without inertia follows the contact at once, as in statics; with
/// inertia its nodes oscillate on the penalty stiffness faster than increments resolve, and undamped schemes then create
/// energy. An element with massless nodes only keeps its mass.
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

/// Internal force and tangent of a `pressure` (positive toward the body), a function of the reference position, on one edge at the
/// nodal positions `x`.
pub fn follower_pressure(edge: &[usize], pressure: impl Fn(Vector2<f64>) -> f64, x: &Configuration) -> Contribution {
    let mut result = Contribution::zero(edge.to_vec());
    for (xi, weight) in shape::gauss(edge.len()) {
        let values = shape::edge_values(edge.len(), xi);
        let slopes = shape::edge_derivatives(edge.len(), xi);
        let along = x.combine(&edge.iter().copied().zip(slopes.iter().copied()).collect::<Vec<_>>());
        let place: Vec<(usize, f64)> = edge.iter().copied().zip(values.iter().copied()).collect();
        let p = pressure(place.iter().map(|&(node, n)| x.reference(node) * n).sum());
        let (depth, slope) = (x.weight(&place), x.weight_slope(&place));
        for (a, n) in values.iter().enumerate() {
            let factor = p * n * weight * depth;
            result.force[2 * a] += factor * along.y;
            result.force[2 * a + 1] -= factor * along.x;
            for (b, d) in slopes.iter().enumerate() {
                result.tangent[(2 * a, 2 * b + 1)] += factor * d;
                result.tangent[(2 * a + 1, 2 * b)] -= factor * d;
            }
            for (b, (m, slope)) in values.iter().zip(slope.iter().cycle()).enumerate() {
                for (j, rate) in slope.iter().enumerate() {
                    let varied = p * n * weight * m * rate;
                    result.tangent[(2 * a, 2 * b + j)] += varied * along.y;
                    result.tangent[(2 * a + 1, 2 * b + j)] -= varied * along.x;
                }
            }
        }
    }
    result
}
