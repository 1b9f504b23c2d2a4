//! Plates: no stress across the plane.

use nalgebra::{Matrix2, Vector4};

use super::spatial::{Spatial, Stretched, plane};
use super::{CauchyStress, Evolution, InvertedElement, Material, MaterialResponse, Straining};

/// A law in plane stress: F₃₃ is what leaves no stress across the plane.
///
/// ```text
/// τ₃₃ = h P₃₃(F, h) = 0,   h = F₃₃                                            solved for ln h               (1)
/// A = ∂P/∂F − (∂P/∂h)(∂P/∂h)ᵀ / (∂P₃₃/∂h)                                     consistent tangent            (2)
/// ```
/// (1) is solved by Newton's method from h = J^(−λ/(λ + 2G)), which is its solution for Hencky's law. Moduli of small strains
/// are those of a plate: the P-wave modulus is E/(1 − ν²) = 4 G (λ + G)/(λ + 2G), so that waves, absorbing sides and penalties are a
/// plate's. The viscous stress is formed with them, too.
///
/// # Errors
/// [`InvertedElement`] when det F is not positive, or no h leaves the plate free of stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneStress<L> {
    law: L,
}

/// Most iterations for (1).
const ITERATIONS: usize = 60;

/// ln h is known to so much; the rest is brought in by the tangent.
const KNOWN: f64 = 1e-13;

impl<L: Spatial> PlaneStress<L> {
    /// A law in plane stress.
    pub fn new(law: L) -> Self {
        Self { law }
    }

    /// h and the answer there.
    fn solved(&self, straining: &Straining, new: &mut [f64]) -> Result<(f64, Stretched), InvertedElement> {
        let jacobian = super::positive_jacobian(&straining.deformation)?;
        let modulus = self.law.p_wave_modulus();
        let mut ln_h = -jacobian.ln() * (modulus - 2.0 * self.law.shear_modulus()) / modulus;
        for _ in 0..ITERATIONS {
            let h = 1.0 + ln_h.exp_m1();
            let answer = self.law.stretched(&Straining { stretch: h, ..*straining }, new)?;
            let stress = h * answer.stress[4];
            let slope = stress + h * h * answer.tangent[(4, 4)];
            if !(slope > 0.0 && slope.is_finite() && answer.tangent[(4, 4)] > 0.0) {
                return Err(InvertedElement { jacobian: jacobian * h });
            }
            let change = -stress / slope;
            if change.abs() <= KNOWN {
                return Ok((h, answer));
            }
            ln_h += change.clamp(-1.0, 1.0);
        }
        Err(InvertedElement { jacobian: jacobian * ln_h.exp() })
    }
}

impl<L: Spatial> Material for PlaneStress<L> {
    fn density(&self) -> f64 {
        self.law.density()
    }

    fn p_wave_modulus(&self) -> f64 {
        let (modulus, shear) = (self.law.p_wave_modulus(), self.law.shear_modulus());
        4.0 * shear * (modulus - shear) / modulus
    }

    fn shear_modulus(&self) -> f64 {
        self.law.shear_modulus()
    }

    fn variables(&self) -> &[&'static str] {
        self.law.variables()
    }

    fn is_symmetric(&self) -> bool {
        self.law.is_symmetric()
    }

    /// The answer at once, of a body that has not been strained before.
    fn respond(&self, deformation: &Matrix2<f64>) -> Result<MaterialResponse, InvertedElement> {
        let old = vec![0.0; self.variables().len()];
        let at_once = Straining { deformation: *deformation, stretch: 1.0, dt: 0.0, old: &old };
        self.evolve(&at_once, &mut old.clone()).map(|evolution| evolution.response)
    }

    fn evolve(&self, straining: &Straining, new: &mut [f64]) -> Result<Evolution, InvertedElement> {
        let (_, Stretched { stress, tangent, energy, dissipation }) = self.solved(straining, new)?;
        let [by_h, of_33]: [Vector4<f64>; 2] =
            [tangent.fixed_view::<4, 1>(0, 4).into(), tangent.fixed_view::<1, 4>(4, 0).transpose()];
        let stiffness = tangent[(4, 4)];
        let rest = by_h * (stress[4] / stiffness);
        let response = MaterialResponse {
            stress: plane(&stress) - Matrix2::new(rest[0], rest[2], rest[1], rest[3]),
            tangent: tangent.fixed_view::<4, 4>(0, 0) - by_h * of_33.transpose() / stiffness,
            energy,
            stress_zz: 0.0,
        };
        Ok(Evolution { response, dissipation })
    }

    fn cauchy_stress(&self, deformation: &Matrix2<f64>, old: &[f64]) -> Result<CauchyStress, InvertedElement> {
        let now = Straining { deformation: *deformation, stretch: 1.0, dt: 0.0, old };
        let (h, answer) = self.solved(&now, &mut old.to_vec())?;
        let sigma = plane(&answer.stress) * deformation.transpose() / (deformation.determinant() * h);
        Ok(CauchyStress { xx: sigma.m11, yy: sigma.m22, zz: 0.0, xy: sigma.m12 })
    }
}
