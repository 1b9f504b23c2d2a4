//! Bodies in whose pores the pressure of the fluid is given: the law answers with the effective stress, and the total one is in equilibrium.
//!
//! ```text
//! P = P′ − b p J F⁻ᵀ,   σ = σ′ − b p 1                              b: Biot's coefficient, J = det F of the whole deformation   (1)
//! W = W′ − b p (J − 1),   −∂W/∂p = b (J − 1)                        what the pores have opened by                              (2)
//! dP = dP′ − b p d(J F⁻ᵀ)                                           J F⁻ᵀ: the cofactor, linear in F in the plane               (3)
//! ```
//! p acts on the faces as they are now. A [linear](MaterialDescription::is_linear) law has tr ε in place of J − 1, and P = σ. The stress that the
//! law begins with is the effective one.
//!
//! Source: M. A. Biot, General theory of three-dimensional consolidation, J. Appl. Phys. 12 (1941) 155.

use nalgebra::Vector5;

use super::{Names, Slot};
#[cfg(doc)]
use crate::laws::bulk::MaterialDescription;
use crate::laws::bulk::components::components;
use crate::laws::bulk::{BulkResponse, Straining, cofactor};

/// Names of p and of −∂W/∂p among the variables of a law.
pub const GIVEN_PRESSURE: [&str; 2] = ["given_pore_pressure", "pore_opening"];

/// A pressure that is given in the pores of a body.
#[derive(Clone, Debug)]
pub(super) struct Given {
    /// b [-]
    biot: f64,
    /// p and −∂W/∂p [F/L²], [-]
    slot: Slot<2>,
    linear: bool,
}

impl Given {
    pub fn new(biot: f64, linear: bool, names: &mut Names) -> Self {
        Self { biot, slot: names.slot(GIVEN_PRESSURE), linear }
    }

    /// p of some variables.
    pub fn pressure(&self, variables: &[f64]) -> f64 {
        self.slot.of(variables)[0]
    }

    /// Adds the fluid to the answer of the law.
    pub fn add(&self, answer: &mut BulkResponse, straining: &Straining, new: &mut [f64]) {
        let [pressure, opening] = self.slot.of_mut(new);
        let pore_stress = self.biot * *pressure;
        let Straining { deformation: f, stretch: h, .. } = *straining;
        if self.linear {
            *opening = self.biot * (f.trace() - 2.0 + (h - 1.0));
            answer.energy -= *pressure * *opening;
            answer.stress -= pore_stress * Vector5::new(1.0, 0.0, 0.0, 1.0, 1.0);
            return;
        }
        let (area, jacobian) = (cofactor(&f), f.determinant());
        *opening = self.biot * (jacobian * h - 1.0);
        answer.energy -= *pressure * *opening;
        answer.stress -= pore_stress * components(&(area * h), jacobian);
        // ∂cof/∂F of the components (11, 21, 12, 22)
        for (row, column, sign) in [(0, 3, 1.0), (3, 0, 1.0), (1, 2, -1.0), (2, 1, -1.0)] {
            answer.tangent[(row, column)] -= sign * pore_stress * h;
        }
        let across = components(&area, 0.0);
        for k in 0..4 {
            answer.tangent[(k, 4)] -= pore_stress * across[k];
            answer.tangent[(4, k)] -= pore_stress * across[k];
        }
    }
}
