//! Bodies that are stressed before anything moves them, and bodies that expand when they are heated.
//!
//! ```text
//! F = ϑ F_e,   ϑ = 1 + α (T − T₀)                                                                            (1)
//! W = ϑ³ (W_l(F_e) + σ₀:E_e),   E_e = ½ (F_eᵀF_e − 1)                                                        (2)
//! P = ϑ² (P_l(F_e) + F_e σ₀),   ∂P_iJ/∂F_kL = ϑ (∂P_l,iJ/∂F_kL + δ_ik σ₀,JL)                                 (3)
//! −∂W/∂ϑ = (P:F − 3W)/ϑ                                          expansion stress, tr σ at small strains      (4)
//! ```
//! F, P and W are those of the unheated, undeformed body, whose stress is σ₀ as it is given. It turns with the body: σ₀ is a
//! constant second Piola–Kirchhoff stress in addition to that of the law, and δ_ik σ₀ its geometric stiffness. All tensors are those in
//! space, F₃₃ = 1 in plane strain. A [linear](MaterialDescription::is_linear) law adds small strains, and no rotation matters:
//!
//! ```text
//! ε_e = ε − α (T − T₀) 1,   W = W_l(ε_e) + σ₀:ε_e,   σ = σ_l(ε_e) + σ₀,   −∂W/∂ϑ = tr σ                       (5)
//! ```
//! Source: Lu & Pister (1975), Int. J. Solids Struct. 11, 927, doi:10.1016/0020-7683(75)90015-3 (the split of F).

use nalgebra::Matrix2;

use super::{Names, Slot};
#[cfg(doc)]
use crate::laws::bulk::MaterialDescription;
use crate::laws::bulk::components::{components, plane};
use crate::laws::bulk::{Answer, BulkResponse, CauchyStress, MaterialFailure, Straining};

/// Names of the initial stress among the variables of a law.
pub const INITIAL_STRESS: [&str; 4] = ["initial_xx", "initial_yy", "initial_xy", "initial_zz"];

/// Names of T − T₀ and of −∂W/∂ϑ among the variables of a law.
pub const TEMPERATURE: [&str; 2] = ["temperature_rise", "expansion_stress"];

/// ϑ is positive.
pub(super) fn positive(strain: f64) -> Answer<()> {
    let theta = 1.0 + strain;
    if theta > 0.0 { Ok(()) } else { Err(MaterialFailure::Inverted { jacobian: theta }) }
}

/// F_e of a thermal strain.
pub(super) fn elastic<'a>(straining: &Straining<'a>, strain: f64, linear: bool) -> Straining<'a> {
    let Straining { deformation, stretch, .. } = *straining;
    match linear {
        true => Straining {
            deformation: deformation - Matrix2::from_diagonal_element(strain),
            stretch: stretch - strain,
            ..*straining
        },
        false => {
            let theta = 1.0 + strain;
            Straining { deformation: deformation / theta, stretch: stretch / theta, ..*straining }
        }
    }
}

/// An initial stress in addition to that of a law, which stays as it is.
#[derive(Clone, Debug)]
pub(super) struct Imposed {
    /// σ₀: xx, yy, xy, zz [F/L²]
    stress: Slot<4>,
    linear: bool,
}

impl Imposed {
    pub fn new(linear: bool, names: &mut Names) -> Self {
        Self { stress: names.slot(INITIAL_STRESS), linear }
    }

    pub fn begin(&self, stress: &CauchyStress, variables: &mut [f64]) {
        let CauchyStress { xx, yy, zz, xy } = *stress;
        *self.stress.of_mut(variables) = [xx, yy, xy, zz];
    }

    /// Adds its stress, tangent and energy at F_e.
    pub fn add(&self, answer: &mut BulkResponse, elastic: &Straining, old: &[f64], new: &mut [f64]) {
        let [xx, yy, xy, across] = *self.stress.of(old);
        *self.stress.of_mut(new) = [xx, yy, xy, across];
        let in_plane = Matrix2::new(xx, xy, xy, yy);
        let (f, h) = (elastic.deformation, elastic.stretch);
        if self.linear {
            let strain = 0.5 * (f + f.transpose()) - Matrix2::identity();
            answer.energy += in_plane.dot(&strain) + across * (h - 1.0);
            answer.stress += components(&in_plane, across);
            return;
        }
        let d = f - Matrix2::identity();
        let strain = 0.5 * (d + d.transpose() + d.transpose() * d);
        answer.energy += in_plane.dot(&strain) + across * (0.5 * (h - 1.0) * (h + 1.0));
        answer.stress += components(&(f * in_plane), h * across);
        for (j, l, i) in [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter().flat_map(|(j, l)| [(j, l, 0), (j, l, 1)]) {
            answer.tangent[(i + 2 * j, i + 2 * l)] += in_plane[(j, l)];
        }
        answer.tangent[(4, 4)] += across;
    }
}

/// Expansion of a law that is heated.
#[derive(Clone, Debug)]
pub(super) struct Heat {
    /// α [1/Θ]
    expansion: f64,
    /// T − T₀ and −∂W/∂ϑ [Θ], [F/L²]
    slot: Slot<2>,
    linear: bool,
}

impl Heat {
    pub fn new(expansion: f64, linear: bool, names: &mut Names) -> Self {
        Self { expansion, slot: names.slot(TEMPERATURE), linear }
    }

    /// The expansion stress of an initial stress.
    pub fn begin(&self, stress: &CauchyStress, variables: &mut [f64]) {
        self.slot.of_mut(variables)[1] = stress.xx + stress.yy + stress.zz;
    }

    /// α (T − T₀) of some variables.
    pub fn strain(&self, variables: &[f64]) -> f64 {
        self.expansion * self.slot.of(variables)[0]
    }

    /// From the answer at F_e to that at F.
    pub fn expand(&self, answer: &mut BulkResponse, straining: &Straining, new: &mut [f64]) {
        let [theta, before] = [&*new, straining.old].map(|variables| 1.0 + self.strain(variables));
        let [_, expansion_stress] = self.slot.of_mut(new);
        if self.linear {
            *expansion_stress = answer.stress[0] + answer.stress[3] + answer.stress[4];
            return;
        }
        answer.stress *= theta * theta;
        answer.tangent *= theta;
        answer.energy *= theta.powi(3);
        answer.dissipation *= 0.5 * (before.powi(3) + theta.powi(3));
        let work = plane(&answer.stress).dot(&straining.deformation) + answer.stress[4] * straining.stretch;
        *expansion_stress = (work - 3.0 * answer.energy) / theta;
    }
}
