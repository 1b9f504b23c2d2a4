use nalgebra::{Matrix2, Vector5};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::components::{components, plane};
use super::{Answer, BulkLaw, ElasticConstants, Lame, MaterialDescription, NeoHookean, Slot, Straining};
use crate::laws::parameter::{InvalidParameter, require_positive};

/// Constants of [`Viscoelastic`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
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
}

setters! { const constants: ViscoelasticConstants;
    /// Sets the density [M/L³].
    density(density: f64) { constants.density = density; }
}

/// A neo-Hookean body in parallel with one Maxwell arm: the standard linear solid at large rotations.
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
/// [`MaterialFailure::Inverted`](crate::laws::bulk::MaterialFailure::Inverted) when J = det F is not positive and finite.
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
const ARM: Slot<4> = Slot::FIRST;
const STRAIN: Slot<4> = Slot::after(ARM);

/// A strain from what is remembered of it: xx, yy, xy, zz.
fn remembered([xx, yy, xy, zz]: [f64; 4]) -> Vector5<f64> {
    Vector5::new(xx, xy, xy, yy, zz)
}

/// What is remembered of a strain.
fn kept(strain: &Vector5<f64>) -> [f64; 4] {
    [strain[0], strain[3], strain[2], strain[4]]
}

impl Lame {
    /// λ tr(ε) 1 + 2 G ε
    fn stress(&self, strain: &Vector5<f64>) -> Vector5<f64> {
        let mean = self.lambda * (strain[0] + strain[3] + strain[4]);
        Vector5::new(mean, 0.0, 0.0, mean, mean) + 2.0 * self.shear * strain
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

impl BulkLaw for Viscoelastic {
    fn description(&self) -> MaterialDescription<'_> {
        let behind = self.behind.description();
        let (modulus, shear) = (self.arm.constrained_modulus(), self.arm.shear);
        MaterialDescription::new(behind.density, behind.p_wave_modulus + modulus, behind.shear_modulus + shear)
            .remembering(&VARIABLES)
    }

    /// ```text
    /// ∂P/∂h = ∂P_∞/∂h + φ λ₁ h F,   ∂P₃₃/∂h = ∂P_∞,₃₃/∂h + H₃₃ + φ (λ₁ + 2G₁) h²            h = F₃₃
    /// ```
    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Answer {
        let Straining { deformation: f, stretch: h, dt, old, .. } = *straining;
        let mut response = self.behind.respond(straining, &mut [])?;
        let [arm, before] = [ARM, STRAIN].map(|slot| remembered(*slot.of(old)));
        // E by the displacement gradient D, which loses no digits when it is small: sym(D) + ½ DᵀD
        let d = f - Matrix2::identity();
        let strain = components(&(0.5 * (d + d.transpose() + d.transpose() * d)), 0.5 * (h - 1.0) * (h + 1.0));
        let [decay, phi, lag] = relaxation(dt / self.tau);
        let change = strain - before;
        let after = decay * arm + phi * change;
        let stress = self.arm.stress(&after);
        let stored = |arm: &Vector5<f64>| 0.5 * arm.dot(&self.arm.stress(arm));
        let work = self.arm.stress(&(phi * arm + lag * change)).dot(&change);
        response.dissipation = work - (stored(&after) - stored(&arm));
        *ARM.of_mut(new) = kept(&after);
        *STRAIN.of_mut(new) = kept(&strain);

        response.stress += components(&(f * plane(&stress)), h * stress[4]);
        response.energy += stored(&after);
        for column in 0..4 {
            let mut varied = Matrix2::zeros();
            varied[column] = 1.0;
            let strained = f.transpose() * varied;
            let rate = components(&(0.5 * phi * (strained + strained.transpose())), 0.0);
            let by = varied * plane(&stress) + f * plane(&self.arm.stress(&rate));
            let across = f[column] * (phi * self.arm.lambda * h);
            let total = response.tangent.column(column) + components(&by, across);
            response.tangent.set_column(column, &total);
            response.tangent[(column, 4)] += across;
        }
        response.tangent[(4, 4)] += stress[4];
        response.tangent[(4, 4)] += phi * self.arm.constrained_modulus() * h * h;
        Ok(response)
    }
}
