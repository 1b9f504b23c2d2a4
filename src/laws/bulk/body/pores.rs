//! Bodies whose pores hold a fluid that has no time to flow: the law answers with the effective stress τ′.
//!
//! ```text
//! τ = τ′ − p_w 1,   p_w = p_w0 − (K_w/n) ln J                      J = det F of the whole deformation            (1)
//! W = W′ − p_w0 ln J + ½ (K_w/n) (ln J)²,   P = P′ − p_w F⁻ᵀ                                                     (2)
//! dP = dP′ + (K_w/n) (F⁻ᵀ:dF) F⁻ᵀ + p_w F⁻ᵀ dFᵀ F⁻ᵀ                                                              (3)
//! p_w ≥ p_cav,   W = W′ + w(ln J_cav) − p_cav (ln J − ln J_cav)  there                         cavitation        (4)
//! ```
//! The grains do not change their volume, and n, the porosity, stays as it is: that of small changes of volume, which they are as K_w is
//! large. A [linear](MaterialDescription::is_linear) law has tr ε in place of ln J, and P = σ. The stress that the law begins with is the
//! effective one.

use nalgebra::Vector5;

use super::{Names, Slot};
#[cfg(doc)]
use crate::laws::bulk::MaterialDescription;
use crate::laws::bulk::components::{components, ln_stretch, plane, positive_stretch};
use crate::laws::bulk::{Answer, BulkResponse, Straining, cofactor, positive_jacobian};

/// Name of the initial pressure of the fluid among the variables of a law.
pub const PORE_PRESSURE: &str = "initial_pore_pressure";

/// Name of what it shows.
pub(super) const SHOWN: &str = "pore_pressure";

/// A fluid in the pores of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoreFluid {
    /// K_w/n: its bulk modulus per volume of the body [F/L²]
    pub modulus: f64,
    /// p_cav: its least pressure, if there is one [F/L²]
    pub cavitation: Option<f64>,
}

/// The fluid of a body, and its variable.
#[derive(Clone, Debug)]
pub(super) struct Pores {
    fluid: PoreFluid,
    /// p_w0
    initial: Slot<1>,
    linear: bool,
}

/// The fluid at a point: its pressure, −dp_w/d(ln J) and its energy.
pub(super) struct Fluid {
    pub pressure: f64,
    stiffness: f64,
    energy: f64,
}

impl Pores {
    pub fn new(fluid: PoreFluid, linear: bool, names: &mut Names) -> Self {
        Self { fluid, initial: names.slot([PORE_PRESSURE]), linear }
    }

    /// ln J, of a linear law tr ε.
    fn expansion(&self, straining: &Straining) -> Answer<f64> {
        let Straining { deformation: f, stretch, .. } = *straining;
        if self.linear {
            return Ok(f.trace() - 2.0 + (stretch - 1.0));
        }
        let jacobian = positive_jacobian(&f)?;
        Ok(ln_stretch(jacobian) + ln_stretch(positive_stretch(straining)?))
    }

    /// (1) and (4).
    pub fn fluid(&self, straining: &Straining) -> Answer<Fluid> {
        let (PoreFluid { modulus, cavitation }, initial) = (self.fluid, self.initial.value(straining.old));
        let expansion = self.expansion(straining)?;
        let stored = |expansion: f64| (0.5 * modulus * expansion - initial) * expansion;
        let pressure = initial - modulus * expansion;
        Ok(match cavitation.filter(|least| pressure < *least) {
            None => Fluid { pressure, stiffness: modulus, energy: stored(expansion) },
            Some(least) => {
                let at = (initial - least) / modulus;
                Fluid { pressure: least, stiffness: 0.0, energy: stored(at) - least * (expansion - at) }
            }
        })
    }

    /// Adds the fluid to the answer of the law.
    pub fn add(&self, answer: &mut BulkResponse, fluid: &Fluid, straining: &Straining, new: &mut [f64]) {
        self.initial.set(new, self.initial.value(straining.old));
        answer.energy += fluid.energy;
        if self.linear {
            let one = Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0);
            answer.stress -= fluid.pressure * one;
            answer.tangent += fluid.stiffness * one * one.transpose();
            return;
        }
        let Straining { deformation: f, stretch, .. } = *straining;
        let inverse = components(&(cofactor(&f) / f.determinant()), 1.0 / stretch);
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
    }
}
