//! Isotropic laws: functions of two invariants of F in plane, and of the stretch h = F₃₃ out of it.

use nalgebra::{Matrix2, Vector4};

use super::components::{components, moduli};
use super::{Answer, BulkResponse, cofactor, positive_jacobian};

/// The two invariants in plane, and their derivatives.
///
/// ```text
/// J = λ₁ λ₂ = det F                       ∂J/∂F = cof F                          (1)
/// m = (λ₁ − λ₂)² = F:F − 2J = D:D / 2     ∂m/∂F = 2D,   D = F − cof F            (2)
/// ```
///
/// with the principal stretches λ₁, λ₂. D and J − 1 are small differences of the components of F, so stresses
/// that come from them do not lose digits when the strain is small, and vanish under rotation.
pub(super) struct Invariants {
    /// J
    pub jacobian: f64,
    /// J − 1
    pub volume_strain: f64,
    /// m
    pub distortion: f64,
    cofactor: Matrix2<f64>,
    deviation: Matrix2<f64>,
}

/// W(m, J, h) and its derivatives.
pub(super) struct StrainEnergy {
    pub w: f64,
    pub w_m: f64,
    pub w_j: f64,
    pub w_h: f64,
    pub w_mm: f64,
    pub w_mj: f64,
    pub w_jj: f64,
    pub w_mh: f64,
    pub w_jh: f64,
    pub w_hh: f64,
}

impl Invariants {
    pub(super) fn of(deformation: &Matrix2<f64>) -> Answer<Self> {
        let jacobian = positive_jacobian(deformation)?;
        let displacement_gradient = deformation - Matrix2::identity();
        let volume_strain = displacement_gradient.trace() + displacement_gradient.determinant();
        let cofactor = cofactor(deformation);
        let deviation = deformation - cofactor;
        let distortion = 0.5 * deviation.norm_squared();
        Ok(Self { jacobian, volume_strain, distortion, cofactor, deviation })
    }

    /// ln J, without cancellation near J = 1.
    pub(super) fn ln_jacobian(&self) -> f64 {
        if self.volume_strain.abs() < 0.5 { self.volume_strain.ln_1p() } else { self.jacobian.ln() }
    }

    /// Stress and tangent of the law with energy W(m, J, h), by the chain rule.
    ///
    /// ```text
    /// P = 2 W_m D + W_J cof F,   P₃₃ = W_h                                               (3)
    /// A = 2 W_m ∂D/∂F + W_J ∂cof F/∂F                                                    (4)
    ///     + 4 W_mm D ⊗ D + 2 W_mJ (D ⊗ cof F + cof F ⊗ D) + W_JJ cof F ⊗ cof F
    /// ∂P/∂h = 2 W_mh D + W_Jh cof F,   ∂P₃₃/∂h = W_hh                                    (5)
    /// ```
    #[inline(always)]
    pub(super) fn response(&self, energy: &StrainEnergy) -> BulkResponse {
        let StrainEnergy { w, w_m, w_j, w_h, w_mm, w_mj, w_jj, w_mh, w_jh, w_hh } = *energy;
        let stress = 2.0 * w_m * self.deviation + w_j * self.cofactor;

        let d = Vector4::from_column_slice(self.deviation.as_slice());
        let c = Vector4::from_column_slice(self.cofactor.as_slice());
        let by_d = 4.0 * w_mm * d + 2.0 * w_mj * c;
        let by_c = 2.0 * w_mj * d + w_jj * c;
        let mut tangent = d * by_d.transpose() + c * by_c.transpose();
        // cof is linear in F: (F₁₁, F₂₁, F₁₂, F₂₂) → (F₂₂, −F₁₂, −F₂₁, F₁₁)
        let of_cofactor = w_j - 2.0 * w_m;
        for (i, sign) in [1.0, -1.0, -1.0, 1.0].into_iter().enumerate() {
            tangent[(i, i)] += 2.0 * w_m;
            tangent[(i, 3 - i)] += sign * of_cofactor;
        }
        let coupling = 2.0 * w_mh * d + w_jh * c;
        BulkResponse::new(components(&stress, w_h), moduli(&tangent, &coupling, &coupling, w_hh), w)
    }
}
