//! Elasticity of laws that yield: stress of the elastic strain, by a potential.

use nalgebra::{Matrix4, Vector4};

use super::{ONE, deviator, double_dot};
use crate::laws::bulk::Lame;

/// Relation of stress and elastic strain.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Elasticity {
    /// τ = λ tr(ε) 1 + 2G ε
    Linear(Lame),
    /// Stiffness in proportion to pressure
    Logarithmic(LogarithmicBulk),
}

/// A bulk modulus in proportion to pressure, K = p/κ̂, and a constant shear modulus.
///
/// ```text
/// p = p_m e^(ε_v/κ̂ − 1)  for ε_v ≥ κ̂,   p_m ε_v/κ̂  below,   ε_v = −tr ε                                        (1)
/// τ = −p 1 + 2G dev ε                                                                                           (2)
/// W = κ̂ p − ½ κ̂ p_m + G ‖dev ε‖²,   ½ p_m ε_v²/κ̂ + G ‖dev ε‖²  below                                             (3)
/// ```
/// In (1) ε_v counts from the stress-free state: below the pressure p_m the stiffness is p_m/κ̂ instead of going to nothing. With a
/// constant Poisson's ratio in place of G there is no potential, and a closed loop of strain makes energy.
///
/// Source: Houlsby (1985), Comput. Geotech. 1, 3; Zytynski, Randolph, Nova & Wroth (1978), Int. J. Numer. Anal. Methods Geomech. 2, 87.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogarithmicBulk {
    /// κ̂: slope of −ln J over ln p [-]
    pub kappa: f64,
    /// p_m: pressure below which stiffness stays [F/L²]
    pub floor: f64,
    /// G: shear modulus [F/L²]
    pub shear: f64,
}

impl LogarithmicBulk {
    /// p and K = dp/dε_v of a compression ε_v.
    pub fn pressure(&self, compression: f64) -> [f64; 2] {
        let share = compression / self.kappa;
        let pressure = self.floor * if share > 1.0 { (share - 1.0).exp() } else { share };
        [pressure, self.bulk(pressure)]
    }

    /// K at a pressure.
    pub fn bulk(&self, pressure: f64) -> f64 {
        pressure.max(self.floor) / self.kappa
    }

    /// ε_v at a pressure.
    pub(super) fn compression(&self, pressure: f64) -> f64 {
        let ratio = pressure / self.floor;
        self.kappa * if ratio > 1.0 { 1.0 + ratio.ln() } else { ratio }
    }
}

impl Elasticity {
    /// τ of a strain.
    #[inline(always)]
    pub(super) fn kirchhoff(&self, strain: &Vector4<f64>) -> Vector4<f64> {
        match self {
            Self::Linear(lame) => lame.kirchhoff(strain),
            Self::Logarithmic(law) => {
                let (deviator, trace) = deviator(strain);
                2.0 * law.shear * deviator - law.pressure(-trace)[0] * ONE
            }
        }
    }

    /// The strain of a stress.
    #[inline(always)]
    pub(super) fn strain(&self, stress: &Vector4<f64>) -> Vector4<f64> {
        match self {
            Self::Linear(lame) => lame.strain(stress),
            Self::Logarithmic(law) => {
                let (deviator, trace) = deviator(stress);
                deviator / (2.0 * law.shear) - law.compression(-trace / 3.0) / 3.0 * ONE
            }
        }
    }

    /// ∂τ/∂ε at a strain.
    pub(super) fn stiffness(&self, strain: &Vector4<f64>) -> Matrix4<f64> {
        match self {
            Self::Linear(lame) => lame.stiffness(),
            Self::Logarithmic(law) => isotropic(self.bulk(strain), law.shear),
        }
    }

    /// λ and G under a mean pressure.
    pub(super) fn moduli(&self, pressure: f64) -> Lame {
        match self {
            Self::Linear(lame) => *lame,
            Self::Logarithmic(law) => Lame { lambda: law.bulk(pressure) - 2.0 / 3.0 * law.shear, shear: law.shear },
        }
    }

    /// K at a strain.
    pub(super) fn bulk(&self, strain: &Vector4<f64>) -> f64 {
        match self {
            Self::Linear(lame) => lame.bulk(),
            Self::Logarithmic(law) => law.pressure(-deviator(strain).1)[1],
        }
    }

    /// W of a strain.
    #[inline(always)]
    pub(super) fn stored(&self, strain: &Vector4<f64>) -> f64 {
        match self {
            Self::Linear(lame) => lame.stored(strain),
            Self::Logarithmic(law) => {
                let (deviator, trace) = deviator(strain);
                let [pressure, _] = law.pressure(-trace);
                let of_volume = match pressure > law.floor {
                    true => law.kappa * (pressure - 0.5 * law.floor),
                    false => 0.5 * law.floor * trace * trace / law.kappa,
                };
                of_volume + law.shear * double_dot(&deviator, &deviator)
            }
        }
    }
}

impl Lame {
    /// K = λ + ⅔ G: bulk modulus [F/L²]
    #[inline(always)]
    pub(super) fn bulk(&self) -> f64 {
        self.lambda + 2.0 / 3.0 * self.shear
    }

    /// τ = λ tr(ε) 1 + 2G ε
    #[inline(always)]
    pub(super) fn kirchhoff(&self, strain: &Vector4<f64>) -> Vector4<f64> {
        self.lambda * (strain[0] + strain[1] + strain[2]) * ONE + 2.0 * self.shear * strain
    }

    /// The strain of a stress, ε = dev τ/2G + tr τ/9K.
    #[inline(always)]
    pub(super) fn strain(&self, stress: &Vector4<f64>) -> Vector4<f64> {
        let (deviator, trace) = deviator(stress);
        0.5 / self.shear * deviator + trace / (9.0 * self.bulk()) * ONE
    }

    /// W = λ/2 (tr ε)² + G ε:ε
    #[inline(always)]
    pub(super) fn stored(&self, strain: &Vector4<f64>) -> f64 {
        let trace = strain[0] + strain[1] + strain[2];
        0.5 * self.lambda * trace * trace + self.shear * double_dot(strain, strain)
    }

    /// C = λ 1⊗1 + 2G, written out
    #[inline(always)]
    pub(super) fn stiffness(&self) -> Matrix4<f64> {
        let along = self.lambda + 2.0 * self.shear;
        let mut moduli = Matrix4::from_diagonal(&Vector4::new(along, along, along, 2.0 * self.shear));
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            (moduli[(i, j)], moduli[(j, i)]) = (self.lambda, self.lambda);
        }
        moduli
    }
}

/// K 1⊗1 + 2G dev
#[inline(always)]
pub(super) fn isotropic(bulk: f64, shear: f64) -> Matrix4<f64> {
    Lame { lambda: bulk - 2.0 / 3.0 * shear, shear }.stiffness()
}
