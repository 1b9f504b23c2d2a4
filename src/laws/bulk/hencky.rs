use super::components::{ln_stretch, positive_stretch};
use super::isotropic::{Invariants, StrainEnergy};
use super::{Answer, BulkLaw, ElasticConstants, Lame, MaterialDescription, Straining};
use crate::laws::parameter::InvalidParameter;

/// Hencky's law: Kirchhoff stress proportional to the logarithmic strain.
///
/// ```text
/// W = G ‖ln V‖² + λ/2 (ln J h)²,   ‖ln V‖² = (ln λ₁)² + (ln λ₂)² + (ln h)²                               (1)
///   = (λ + G)/2 (ln J)² + G/2 d² + λ ln J ln h + (λ/2 + G) (ln h)²,   d = ln(λ₁/λ₂)                      (2)
/// sinh²(d/2) = x = m / (4J),   m = (λ₁ − λ₂)²                                                            (3)
/// h P₃₃ = λ (ln J + ln h) + 2G ln h                                                                      (4)
/// ```
///
/// with the principal stretches λ₁ ≥ λ₂ in plane, J = λ₁ λ₂, and h = F₃₃ out of it. As a function of x, d² is analytic at x = 0,
///
/// ```text
/// ∂(d²)/∂x  =  4 a,       a = d / sinh d               → 1               (5)
/// ∂²(d²)/∂x² = −8 a² l,   l = (d coth d − 1) / d²      → 1/3             (6)
/// ```
///
/// so equal stretches are no special case: no principal direction is ever needed.
///
/// # Errors
/// [`MaterialFailure::Inverted`](crate::laws::bulk::MaterialFailure::Inverted) when J = det F is not positive and finite.
///
/// Source: Hencky (1928), Z. Techn. Phys. 9, 215; Anand (1979), J. Appl. Mech. 46, 78, doi:10.1115/1.3424532.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hencky {
    lame: Lame,
    density: f64,
}

impl Hencky {
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn new(constants: &ElasticConstants) -> Result<Self, InvalidParameter> {
        Ok(Self { lame: constants.lame()?, density: constants.density })
    }
}

impl BulkLaw for Hencky {
    fn description(&self) -> MaterialDescription<'_> {
        self.lame.description(self.density)
    }

    #[inline(always)]
    fn respond(&self, straining: &Straining, _: &mut [f64]) -> Answer {
        let h = positive_stretch(straining)?;
        let invariants = Invariants::of(&straining.deformation)?;
        let Lame { lambda, shear } = self.lame;
        let (jacobian, ln_j, ln_h) = (invariants.jacobian, invariants.ln_jacobian(), ln_stretch(h));
        let areal = lambda + shear;
        let x = 0.25 * invariants.distortion / jacobian;
        let ShearStrain { d, a, l } = ShearStrain::from_sinh_squared(x);
        let kirchhoff = lambda * (ln_j + ln_h) + 2.0 * shear * ln_h;
        let energy = StrainEnergy {
            w: 0.5 * (areal * ln_j * ln_j + shear * d * d)
                + (lambda * ln_j * ln_h + (0.5 * lambda + shear) * ln_h * ln_h),
            w_m: 0.5 * shear * a / jacobian,
            w_j: (areal * ln_j - 2.0 * shear * a * x) / jacobian + lambda * ln_h / jacobian,
            w_h: kirchhoff / h,
            w_mm: -0.25 * shear * a * a * l / jacobian.powi(2),
            w_mj: shear * (a * a * l * x - 0.5 * a) / jacobian.powi(2),
            w_jj: (areal * (1.0 - ln_j) + 4.0 * shear * (a * x - a * a * l * x * x)) / jacobian.powi(2)
                - lambda * ln_h / jacobian.powi(2),
            w_mh: 0.0,
            w_jh: lambda / (jacobian * h),
            w_hh: (self.lame.constrained_modulus() - kirchhoff) / (h * h),
        };
        Ok(invariants.response(&energy))
    }
}

/// d = ln(λ₁/λ₂) with a and l of (5) and (6).
struct ShearStrain {
    d: f64,
    a: f64,
    l: f64,
}

impl ShearStrain {
    /// The shear strain from x = sinh²(d/2), equation (3).
    fn from_sinh_squared(x: f64) -> Self {
        if x == 0.0 {
            return Self { d: 0.0, a: 1.0, l: 1.0 / 3.0 };
        }
        let d = 2.0 * x.sqrt().asinh();
        let (sinh, cosh) = (2.0 * (x * (1.0 + x)).sqrt(), 1.0 + 2.0 * x);
        // Below 0.1 the closed form of l cancels, and the first term left out of its series is 1e-15 of l.
        let l = if d < 0.1 { langevin_series(d * d) } else { (d * cosh / sinh - 1.0) / (d * d) };
        Self { d, a: d / sinh, l }
    }
}

/// (d coth d − 1) / d² by its Taylor series in d².
fn langevin_series(d2: f64) -> f64 {
    1.0 / 3.0 - d2 * (1.0 / 45.0 - d2 * (2.0 / 945.0 - d2 * (1.0 / 4725.0 - d2 * (2.0 / 93555.0))))
}
