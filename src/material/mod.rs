//! The bulk-law contract: stress and tangent of a hyperelastic material in plane strain.

use std::fmt::Debug;

use nalgebra::{Matrix2, Matrix4};
use thiserror::Error;

/// Stress, tangent and stored energy at one deformation gradient (plane strain: F₃₃ = 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialResponse {
    /// P: first Piola–Kirchhoff stress, in plane part [F/L²]
    pub stress: Matrix2<f64>,
    /// ∂P_iJ/∂F_kL at row i + 2J, column k + 2L (column-major order of the 2×2 matrices) [F/L²]
    pub tangent: Matrix4<f64>,
    /// W: stored energy per reference volume [F/L²]
    pub energy: f64,
    /// σ_zz: out-of-plane Cauchy stress [F/L²]
    pub stress_zz: f64,
}

/// The deformation has no volume left: J = det F ≤ 0, or not a number.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the material is turned inside out (J = {jacobian:.3e})")]
pub struct InvertedElement {
    /// J = det F [-]
    pub jacobian: f64,
}

/// A bulk law without memory: P and ∂P/∂F at F (plane strain).
pub trait Material: Debug + Send + Sync {
    /// ρ₀: mass per reference volume [M/L³]
    fn density(&self) -> f64;

    /// Constrained modulus λ + 2G of the undeformed material: the stiffness scale [F/L²]
    fn stiffness(&self) -> f64;

    /// P, ∂P/∂F, W and σ_zz at the in-plane deformation gradient F.
    ///
    /// # Errors
    /// [`InvertedElement`] when det F is not positive.
    fn respond(&self, deformation: &Matrix2<f64>) -> Result<MaterialResponse, InvertedElement>;
}
