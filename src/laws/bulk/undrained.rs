//! Bodies whose pores hold a fluid that has no time to flow.

use std::sync::Arc;

use nalgebra::{Matrix2, Vector2, Vector5};

use super::spatial::{components, plane, positive_stretch};
use super::{
    CauchyStress, InadmissibleStress, Material, MaterialDescription, MaterialFailure, MaterialResponse, Spatial,
    Straining, Stretched, positive_jacobian,
};

/// Name of the initial pressure of the fluid among the variables of a law, the first of them.
pub const PORE_PRESSURE: &str = "initial_pore_pressure";

/// Name of what it shows.
const SHOWN: &str = "pore_pressure";

/// A law whose pores hold a fluid that cannot drain: the law answers with the effective stress τ′.
///
/// ```text
/// τ = τ′ − p_w 1,   p_w = p_w0 − (K_w/n) ln J                      J = det F of the whole deformation            (1)
/// W = W′ − p_w0 ln J + ½ (K_w/n) (ln J)²,   P = P′ − p_w F⁻ᵀ                                                     (2)
/// dP = dP′ + (K_w/n) (F⁻ᵀ:dF) F⁻ᵀ + p_w F⁻ᵀ dFᵀ F⁻ᵀ                                                              (3)
/// p_w ≥ p_cav,   W = W′ + w(ln J_cav) − p_cav (ln J − ln J_cav)  there                         cavitation        (4)
/// ```
/// The grains do not change their volume, and n, the porosity, stays as it is: that of small changes of volume, which they are as K_w is
/// large. A [linear](MaterialDescription::is_linear) law has tr ε in place of ln J, and P = σ.
///
/// p_w0 stands among the variables, and the stress that the law begins with is the effective one. Damping is the law's own.
///
/// # Errors
/// [`MaterialFailure::Inverted`] when det F is not positive, and those of the law.
#[derive(Clone, Debug)]
pub struct Undrained {
    law: Arc<dyn Material>,
    /// K_w/n [F/L²]
    modulus: f64,
    /// p_cav [F/L²]
    cavitation: Option<f64>,
    names: Vec<&'static str>,
    shown: Vec<&'static str>,
}

/// The fluid at a point: its pressure, −dp_w/d(ln J) and its energy.
struct Fluid {
    pressure: f64,
    stiffness: f64,
    energy: f64,
}

impl Undrained {
    /// A law with a fluid of the bulk modulus K_w/n per volume of the body, whose pressure is `cavitation` at least [F/L²]; `None` if the
    /// law does not know an out-of-plane stretch, or is linear and cavitates.
    pub fn new(law: impl Into<Arc<dyn Material>>, modulus: f64, cavitation: Option<f64>) -> Option<Self> {
        let law = law.into();
        law.spatial()?;
        let own = law.description();
        if own.is_linear && cavitation.is_some() {
            return None;
        }
        let names = std::iter::once(PORE_PRESSURE).chain(own.variables.iter().copied()).collect();
        let shown = own.shown.iter().copied().chain([SHOWN]).collect();
        Some(Self { law, modulus, cavitation, names, shown })
    }

    /// Returns the straining with the history of the law alone.
    fn inner<'a>(&self, straining: &Straining<'a>) -> Straining<'a> {
        Straining { old: &straining.old[1..], ..*straining }
    }

    /// ln J, of a linear law tr ε.
    fn expansion(&self, straining: &Straining) -> Result<f64, MaterialFailure> {
        let Straining { deformation: f, stretch, .. } = *straining;
        if self.law.description().is_linear {
            return Ok(f.trace() - 2.0 + (stretch - 1.0));
        }
        let jacobian = positive_jacobian(&f)?;
        Ok(super::spatial::ln_stretch(jacobian) + super::spatial::ln_stretch(positive_stretch(straining)?))
    }

    /// (1) and (4), with an initial pressure.
    fn fluid(&self, initial: f64, expansion: f64) -> Fluid {
        let Self { modulus, cavitation, .. } = *self;
        let stored = |expansion: f64| (0.5 * modulus * expansion - initial) * expansion;
        let pressure = initial - modulus * expansion;
        match cavitation.filter(|least| pressure < *least) {
            None => Fluid { pressure, stiffness: modulus, energy: stored(expansion) },
            Some(least) => {
                let at = (initial - least) / modulus;
                Fluid { pressure: least, stiffness: 0.0, energy: stored(at) - least * (expansion - at) }
            }
        }
    }

    /// p_w where the law remembers `straining.old`.
    fn pressure(&self, straining: &Straining) -> Result<f64, MaterialFailure> {
        Ok(self.fluid(straining.old[0], self.expansion(straining)?).pressure)
    }
}

/// F⁻ᵀ
fn inverse_transpose(straining: &Straining) -> Vector5<f64> {
    let Straining { deformation: f, stretch, .. } = *straining;
    components(&(super::cofactor(&f) / f.determinant()), 1.0 / stretch)
}

impl Spatial for Undrained {
    fn stretched(&self, straining: &Straining, new: &mut [f64]) -> Result<Stretched, MaterialFailure> {
        let fluid = self.fluid(straining.old[0], self.expansion(straining)?);
        new[0] = straining.old[0];
        let law = self.law.spatial().expect("`new` asks for one");
        let mut answer = law.stretched(&self.inner(straining), &mut new[1..])?;
        answer.energy += fluid.energy;
        if self.law.description().is_linear {
            let one = Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0);
            answer.stress -= fluid.pressure * one;
            answer.tangent += fluid.stiffness * one * one.transpose();
            return Ok(answer);
        }
        let inverse = inverse_transpose(straining);
        answer.stress -= fluid.pressure * inverse;
        answer.tangent += fluid.stiffness * inverse * inverse.transpose();
        // p_w F⁻ᵀ dFᵀ F⁻ᵀ: (iJ, kL) has F⁻ᵀ_iL F⁻ᵀ_kJ
        let in_plane = plane(&inverse);
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            for (k, l) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                answer.tangent[(i + 2 * j, k + 2 * l)] += fluid.pressure * in_plane[(i, l)] * in_plane[(k, j)];
            }
        }
        answer.tangent[(4, 4)] += fluid.pressure * inverse[4] * inverse[4];
        Ok(answer)
    }

    fn viscous(&self, motion: [&Vector5<f64>; 2]) -> Vector5<f64> {
        self.law.spatial().map_or_else(Vector5::zeros, |law| law.viscous(motion))
    }

    fn varied_viscous(&self, motion: [&Vector5<f64>; 2], varied: [&Vector5<f64>; 2]) -> Vector5<f64> {
        self.law.spatial().map_or_else(Vector5::zeros, |law| law.varied_viscous(motion, varied))
    }
}

impl Material for Undrained {
    fn description(&self) -> MaterialDescription<'_> {
        let own = self.law.description();
        MaterialDescription {
            p_wave_modulus: own.p_wave_modulus + self.modulus,
            variables: &self.names,
            shown: &self.shown,
            ..own
        }
    }

    fn initial_state(&self, position: Vector2<f64>, stress: &CauchyStress, variables: &mut [f64]) {
        self.law.initial_state(position, stress, &mut variables[1..]);
    }

    fn spatial(&self) -> Option<&dyn Spatial> {
        Some(self)
    }

    fn at_pressure(&self, pressure: f64) -> Option<Arc<dyn Material>> {
        Some(Arc::new(Self { law: self.law.at_pressure(pressure)?, ..self.clone() }))
    }

    fn admits(&self, stress: &CauchyStress) -> Result<(), InadmissibleStress> {
        self.law.admits(stress)
    }

    fn show(&self, straining: &Straining, values: &mut [f64]) -> Result<(), MaterialFailure> {
        let last = values.len() - 1;
        values[last] = self.pressure(straining)?;
        self.law.show(&self.inner(straining), &mut values[..last])
    }

    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Result<MaterialResponse, MaterialFailure> {
        self.in_plane_strain(straining, new)
    }

    fn viscous_stress(&self, motion: [&Matrix2<f64>; 2]) -> Matrix2<f64> {
        self.law.viscous_stress(motion)
    }

    fn viscous_variation(&self, motion: [&Matrix2<f64>; 2], varied: [&Matrix2<f64>; 2]) -> Matrix2<f64> {
        self.law.viscous_variation(motion, varied)
    }

    fn cauchy_stress(&self, deformation: &Matrix2<f64>, old: &[f64]) -> Result<CauchyStress, MaterialFailure> {
        self.cauchy(&Straining::new(*deformation, old))
    }
}
