use nalgebra::{Matrix2, Vector4};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::spatial::{OutOfPlane, Spatial, Stretched, positive_stretch};
use super::{
    ElasticConstants, Lame, Material, MaterialDescription, MaterialFailure, MaterialResponse, NeoHookean, PlaneStress,
    Straining,
};
use crate::laws::parameter::{InvalidParameter, require_positive};

/// Constants of [`Viscoelastic`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct ViscoelasticConstants {
    /// E: Young's modulus that is left when all has relaxed, E > 0 [F/L²]
    #[serde(rename = "E")]
    pub young: f64,
    /// ν: Poisson's ratio of both parts, −1 < ν < 0.5 [-]
    #[serde(rename = "nu")]
    pub poisson: f64,
    /// E₁: Young's modulus of the part that relaxes, E₁ > 0; at once the body has E + E₁ [F/L²]
    #[serde(rename = "E_1")]
    pub relaxing: f64,
    /// τ: relaxation time, τ > 0 [T]
    pub tau: f64,
    /// ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    #[serde(default)]
    pub density: f64,
}

impl ViscoelasticConstants {
    /// Creates the parameters of a body without mass.
    pub const fn new(young: f64, poisson: f64, relaxing: f64, tau: f64) -> Self {
        Self { young, poisson, relaxing, tau, density: 0.0 }
    }

    /// Sets the density [M/L³].
    pub const fn density(self, density: f64) -> Self {
        Self { density, ..self }
    }
}

/// A neo-Hookean body beside one Maxwell arm: the standard linear solid at large rotations.
///
/// ```text
/// P = P_∞(F) + F H,   H = C₁:ε,   C₁:ε = λ₁ tr(ε) 1 + 2 G₁ ε              ε: elastic strain of the arm             (1)
/// ε̇ = Ė − ε/τ,   E = ½ (FᵀF − 1)                                          spring and dashpot in series             (2)
/// W = W_∞(F) + ½ ε:C₁:ε,   dissipation ε:C₁:ε/τ ≥ 0                                                               (3)
/// ```
/// The arm lives in the material frame, so it turns with the body. Strains of the arm may be moderate, as those of Saint
/// Venant and Kirchhoff's law; it relaxes, the body behind it stays neo-Hookean.
///
/// Over an increment E goes evenly to its end, for which (2) is integrated exactly: with x = Δt/τ and φ = (1 − e⁻ˣ)/x
/// ```text
/// ε₁ = e⁻ˣ ε₀ + φ ΔE,   ∂H/∂E = φ C₁                                                                              (4)
/// mean of ε over the increment = φ ε₀ + (1 − φ)/x ΔE,   dissipated = mean(ε):C₁:ΔE − Δ(½ ε:C₁:ε)                  (5)
/// ```
/// A step of strain that is held relaxes by e^(−t/τ), exactly, whatever the increments. Along other paths the error is of
/// second order in Δt. The tangent is symmetric: (1) and (4) follow from a potential of the increment.
///
/// It remembers ε and E, in plane and E₃₃.
///
/// # Errors
/// [`MaterialFailure::Inverted`] when J = det F is not positive and finite.
///
/// Source: Simo & Hughes (1998), Computational Inelasticity, §10.3 (the recurrence); Ferry (1980), Viscoelastic Properties
/// of Polymers (the standard linear solid).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscoelastic {
    behind: NeoHookean,
    arm: Lame,
    tau: f64,
}

impl Viscoelastic {
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn new(constants: &ViscoelasticConstants) -> Result<Self, InvalidParameter> {
        let ViscoelasticConstants { young, poisson, relaxing, tau, density } = *constants;
        let behind = ElasticConstants { young, poisson, density };
        require_positive("E_1", relaxing)?;
        require_positive("tau", tau)?;
        let arm = ElasticConstants { young: relaxing, ..behind };
        Ok(Self { behind: NeoHookean::new(&behind)?, arm: arm.lame()?, tau })
    }
}

/// History: ε of the arm, and E.
const VARIABLES: [&str; 8] =
    ["arm_xx", "arm_yy", "arm_xy", "arm_zz", "strain_xx", "strain_yy", "strain_xy", "strain_zz"];

/// A symmetric strain or stress: in plane, and out of plane.
#[derive(Clone, Copy, Debug)]
struct Tensor {
    plane: Matrix2<f64>,
    zz: f64,
}

impl Tensor {
    /// A tensor from its components xx, yy, xy, zz.
    fn from(components: &[f64]) -> Self {
        let [xx, yy, xy, zz] = [0, 1, 2, 3].map(|k| components[k]);
        Self { plane: Matrix2::new(xx, xy, xy, yy), zz }
    }

    fn components(self) -> [f64; 4] {
        [self.plane.m11, self.plane.m22, self.plane.m12, self.zz]
    }

    fn combined(self, a: f64, other: Self, b: f64) -> Self {
        Self { plane: a * self.plane + b * other.plane, zz: a * self.zz + b * other.zz }
    }

    fn dot(&self, other: &Self) -> f64 {
        self.plane.dot(&other.plane) + self.zz * other.zz
    }
}

impl Lame {
    /// λ tr(ε) 1 + 2 G ε
    fn stress(&self, strain: &Tensor) -> Tensor {
        let mean = self.lambda * (strain.plane.trace() + strain.zz);
        Tensor {
            plane: Matrix2::from_diagonal_element(mean) + 2.0 * self.shear * strain.plane,
            zz: mean + 2.0 * self.shear * strain.zz,
        }
    }
}

/// e⁻ˣ, φ = (1 − e⁻ˣ)/x and (1 − φ)/x for x ≥ 0.
fn relaxation(x: f64) -> [f64; 3] {
    let decay = (-x).exp();
    let phi = if x > 0.0 { -(-x).exp_m1() / x } else { 1.0 };
    // The closed form cancels, and the first term left out of the series is x⁵/5040.
    let lag = match x < 1e-2 {
        true => 0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0 - x / 720.0))),
        false => (1.0 - phi) / x,
    };
    [decay, phi, lag]
}

impl Material for Viscoelastic {
    fn description(&self) -> MaterialDescription<'_> {
        let behind = self.behind.description();
        let (modulus, shear) = (self.arm.constrained_modulus(), self.arm.shear);
        MaterialDescription::new(behind.density, behind.p_wave_modulus + modulus, behind.shear_modulus + shear)
            .remembering(&VARIABLES)
    }

    fn plane_stress(&self) -> Option<Box<dyn Material>> {
        Some(Box::new(PlaneStress::new(*self)))
    }

    fn spatial(&self) -> Option<&dyn Spatial> {
        Some(self)
    }

    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Result<MaterialResponse, MaterialFailure> {
        let Straining { deformation: f, stretch, dt, old, .. } = *straining;
        let mut response = self.behind.at_stretch(&f, stretch)?;
        let (arm, before) = (Tensor::from(&old[..4]), Tensor::from(&old[4..]));
        // E by the displacement gradient D, which loses no digits when it is small: sym(D) + ½ DᵀD
        let d = f - Matrix2::identity();
        let plane = 0.5 * (d + d.transpose() + d.transpose() * d);
        let strain = Tensor { plane, zz: 0.5 * (stretch - 1.0) * (stretch + 1.0) };
        let [decay, phi, lag] = relaxation(dt / self.tau);
        let change = strain.combined(1.0, before, -1.0);
        let after = arm.combined(decay, change, phi);
        let stress = self.arm.stress(&after);
        let stored = |arm: &Tensor| 0.5 * arm.dot(&self.arm.stress(arm));
        let work = self.arm.stress(&arm.combined(phi, change, lag)).dot(&change);
        response.dissipation = work - (stored(&after) - stored(&arm));
        new[..4].copy_from_slice(&after.components());
        new[4..].copy_from_slice(&strain.components());

        response.stress += f * stress.plane;
        response.energy += stored(&after);
        response.stress_zz += stretch * stress.zz / f.determinant();
        for column in 0..4 {
            let mut varied = Matrix2::zeros();
            varied[column] = 1.0;
            let strained = f.transpose() * varied;
            let rate = Tensor { plane: 0.5 * phi * (strained + strained.transpose()), zz: 0.0 };
            let by = varied * stress.plane + f * self.arm.stress(&rate).plane;
            let total = response.tangent.column(column) + Vector4::from_column_slice(by.as_slice());
            response.tangent.set_column(column, &total);
        }
        Ok(response)
    }
}

impl Spatial for Viscoelastic {
    /// ```text
    /// P₃₃ = P_∞,₃₃ + h H₃₃,   ∂P/∂h = ∂P_∞/∂h + φ λ₁ h F,   ∂P₃₃/∂h = ∂P_∞,₃₃/∂h + H₃₃ + φ (λ₁ + 2G₁) h²
    /// ```
    fn stretched(&self, straining: &Straining, new: &mut [f64]) -> Result<Stretched, MaterialFailure> {
        let h = positive_stretch(straining)?;
        let MaterialResponse { stress, tangent, energy, dissipation, .. } = self.respond(straining, new)?;
        let behind = Spatial::stretched(&self.behind, straining, &mut [])?;
        let [_, phi, _] = relaxation(straining.dt / self.tau);
        let held = self.arm.stress(&Tensor::from(&new[..4])).zz;
        let f = Vector4::from_column_slice(straining.deformation.as_slice());
        let coupling = behind.tangent.fixed_view::<4, 1>(0, 4) + f * (phi * self.arm.lambda * h);
        let stiffness = behind.tangent[(4, 4)] + held + phi * self.arm.constrained_modulus() * h * h;
        let across = OutOfPlane { stress: behind.stress[4] + h * held, coupling, stiffness };
        Ok(Stretched { dissipation, ..Stretched::new(stress, tangent, across, energy) })
    }
}
