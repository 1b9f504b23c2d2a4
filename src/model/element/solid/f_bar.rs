//! F-bar: every point of an element has the mean volume change, and the mean pressure.
//!
//! ```text
//! ln J̄ = ⟨ln J⟩,   F̄ = r F,   r = (J̄/J)^m,   ⟨·⟩ = ∫ · dV/∫ dV,   m = ½ in plane, ⅓ in rings                (4)
//! Π = ∫ [W(F̄) − w₀ ln r] dV,   f = ∂Π/∂u                                               w₀: trace of the initial stress
//! δF̄ = r δF + h F̄,   h = m (⟨n⟩ − n),   n = F⁻ᵀ:δF                                          h: variation of ln r
//! f·δu = ∫ P*:δF dV,   P* = r P̄ + m (⟨v⟩ − v) F⁻ᵀ,   P̄ = P(F̄),   w = P̄:F̄,   v = w − w₀                      (5)
//! δu·K·du = ∫ [δF̄:Ā:dF̄ + P̄:δF̄ dh + δh P̄:dF̄ − w δh dh + m (v − ⟨v⟩) tr(F⁻¹δF F⁻¹dF)] dV,   Ā = A(F̄)       (6)
//! ```
//! In plane strain a trace is that in the plane. By (5) the trace of each point's Kirchhoff stress P* Fᵀ is the mean one, but for that
//! of its initial stress, which acts on the point's own volume change: ground at rest under its weight is in equilibrium
//! on any mesh. (P̄ is the law's answer to F̄, with its memory, whether it has a potential or not.)
//!
//! The forces have a potential where the law has one: the tangent is symmetric then, and the stored energy is their work. With the stress
//! of each point for itself on the actual geometry (de Souza Neto et al. 1996) the forces have none, and where a body dilates
//! as it yields, that is, where the pressures of an element's points differ, work comes from nowhere.
//!
//! Sources: Nagtegaal, Parks & Rice (1974), Comput. Methods Appl. Mech. Eng. 4, 153, doi:10.1016/0045-7825(74)90032-2; Simo, Taylor &
//! Pister (1985), Comput. Methods Appl. Mech. Eng. 51, 177, doi:10.1016/0045-7825(85)90033-7 (mean dilatation and pressure at
//! large deformations); (5) and (6) are derived from (4).

use std::array;

use nalgebra::{Matrix5, Vector2, Vector5};

use super::SolidElement;
use super::ring::{At, inverse_transpose, jacobian};
use crate::laws::bulk::{Answer, BulkResponse, CauchyStress};
use crate::model::element::Formulation;

/// Quadrature points and dofs of the element, a Q4.
const POINTS: usize = 4;
const DOFS: usize = 8;

/// An F-bar element at the current displacements.
pub(super) struct Mean<'a> {
    points: [Now<'a>; POINTS],
    /// m of (4)
    exponent: f64,
    volume: f64,
}

/// A quadrature point of it.
#[derive(Clone, Copy)]
struct Now<'a> {
    at: At<'a>,
    volume: f64,
    /// F⁻ᵀ
    inverse_transpose: Vector5<f64>,
    /// r of (4)
    stretch: f64,
    /// w₀ [F/L²]
    initial: f64,
    /// F̄, whose out-of-plane part is of no account in plane strain
    seen: Vector5<f64>,
}

impl SolidElement {
    /// The element at displacements `u` by (4); `None` unless it is an F-bar element.
    pub(super) fn mean(&self, u: &[Vector2<f64>]) -> Answer<Option<Mean<'_>>> {
        if self.formulation != Formulation::FBar {
            return Ok(None);
        }
        let none = Now {
            at: At::default(),
            volume: 0.0,
            inverse_transpose: Vector5::zeros(),
            stretch: 1.0,
            initial: 0.0,
            seen: Vector5::zeros(),
        };
        let (mut points, mut ln_jacobians) = ([none; POINTS], [0.0; POINTS]);
        for (k, (at, volume)) in self.everywhere().enumerate() {
            let seen = at.deformation(u);
            ln_jacobians[k] = jacobian(&seen)?.ln();
            let initial = self.initial.get(k).copied().unwrap_or_default();
            points[k] = Now { at, volume, inverse_transpose: inverse_transpose(&seen), stretch: 1.0, initial, seen };
        }
        let exponent = if self.hoop.is_some() { 1.0 / 3.0 } else { 0.5 };
        let volume: f64 = points.iter().map(|now| now.volume).sum();
        let mean = points.iter().zip(&ln_jacobians).map(|(now, ln)| now.volume * ln).sum::<f64>() / volume;
        for (now, ln_jacobian) in points.iter_mut().zip(ln_jacobians) {
            now.stretch = (exponent * (mean - ln_jacobian)).exp();
            now.seen *= now.stretch;
        }
        Ok(Some(Mean { points, exponent, volume }))
    }
}

impl SolidElement {
    /// Sets the initial stress at each quadrature point; only F-bar has to know.
    pub fn start_under(&mut self, stresses: impl Iterator<Item = CauchyStress>) {
        if self.formulation == Formulation::FBar {
            let hoop = if self.hoop.is_some() { 1.0 } else { 0.0 };
            self.initial = stresses.map(|stress| stress.xx + stress.yy + hoop * stress.zz).collect();
        }
    }
}

impl Mean<'_> {
    /// −∫ w₀ ln r dV
    pub fn initial_energy(&self) -> f64 {
        self.points.iter().map(|now| -now.volume * now.initial * now.stretch.ln()).sum()
    }

    /// F̄ at each quadrature point.
    pub fn seen(&self) -> [Vector5<f64>; POINTS] {
        self.points.map(|now| now.seen)
    }

    /// P* of (5) times the volume at each point, given the same of P̄.
    pub fn stresses(&self, given: &[Vector5<f64>; POINTS]) -> [Vector5<f64>; POINTS] {
        let works: [f64; POINTS] = array::from_fn(|k| {
            let now = &self.points[k];
            given[k].dot(&now.seen) - now.volume * now.initial
        });
        let mean = works.iter().sum::<f64>() / self.volume;
        array::from_fn(|k| {
            let now = &self.points[k];
            now.stretch * given[k] + self.exponent * (now.volume * mean - works[k]) * now.inverse_transpose
        })
    }

    /// Force and, on request, tangent by (5) and (6) of a law's answers to F̄, which have no out-of-plane parts in plane strain; returns
    /// the stored and the dissipated energy.
    pub fn respond(
        &self,
        answers: &[BulkResponse; POINTS],
        force: &mut [f64],
        tangent: Option<&mut [f64]>,
    ) -> [f64; 2] {
        let [mut energy, mut dissipated] = [self.initial_energy(), 0.0];
        for (now, answer) in self.points.iter().zip(answers) {
            energy += now.volume * answer.energy;
            dissipated += now.volume * answer.dissipation;
        }
        let stresses = self.stresses(&array::from_fn(|k| self.points[k].volume * answers[k].stress));
        force.fill(0.0);
        self.points.iter().zip(&stresses).for_each(|(now, stress)| now.at.add_force(stress, force));
        if let Some(tangent) = tangent {
            tangent.fill(0.0);
            self.add_tangent(answers, tangent);
        }
        [energy, dissipated]
    }

    /// Tangent (6), column by column. With δF̄ by (4) it is that of moduli of F alone and products of h:
    ///
    /// ```text
    /// δu·K·du = ∫ [δF:M:dF + α dh + δh β + c δh dh] dV,   M_iJkL = r² Ā_iJkL + m (v − ⟨v⟩) F⁻¹_Li F⁻¹_Jk
    /// α = r δF:(Ā:F̄ + P̄),   β = r (F̄:Ā + P̄):dF,   c = F̄:Ā:F̄ + w
    /// ```
    fn add_tangent(&self, answers: &[BulkResponse; POINTS], tangent: &mut [f64]) {
        let share = self.points.map(|now| now.volume / self.volume);
        // n, and ⟨n⟩, of each dof
        let change = self.points.map(|now| now.at.along(&now.inverse_transpose));
        let mean: [f64; DOFS] = array::from_fn(|dof| (0..POINTS).map(|k| share[k] * change[k][dof]).sum());
        let works: [f64; POINTS] = array::from_fn(|k| answers[k].stress.dot(&self.points[k].seen));
        let beyond: [f64; POINTS] = array::from_fn(|k| works[k] - self.points[k].initial);
        let mean_beyond: f64 = (0..POINTS).map(|k| share[k] * beyond[k]).sum();
        for (k, (now, answer)) in self.points.iter().zip(answers).enumerate() {
            let BulkResponse { stress, tangent: moduli, .. } = answer;
            let h: [f64; DOFS] = array::from_fn(|dof| self.exponent * (mean[dof] - change[k][dof]));
            let [by_seen, of_seen] = [moduli * now.seen, moduli.tr_mul(&now.seen)];
            let own = now.volume * (now.seen.dot(&by_seen) + works[k]);
            let size = now.volume * now.stretch;
            let [alpha, beta] = [by_seen, of_seen].map(|with| now.at.along(&(size * (with + stress))));
            let alpha: [f64; DOFS] = array::from_fn(|dof| alpha[dof] + own * h[dof]);
            let moduli = size * now.stretch * moduli
                + now.volume * self.exponent * (beyond[k] - mean_beyond) * now.geometric_moduli();
            for (j, column) in tangent.chunks_exact_mut(DOFS).enumerate() {
                now.at.add_force(&(moduli * now.at.variation(j)), column);
                for (i, entry) in column.iter_mut().enumerate() {
                    *entry += alpha[i] * h[j] + h[i] * beta[j];
                }
            }
        }
    }
}

impl Now<'_> {
    /// F⁻¹_Li F⁻¹_Jk, of which δF:(·):dF = tr(F⁻¹δF F⁻¹dF)
    fn geometric_moduli(&self) -> Matrix5<f64> {
        let t = &self.inverse_transpose;
        let mut moduli = Matrix5::zeros();
        for (row, column) in (0..4).flat_map(|row| (0..4).map(move |column| (row, column))) {
            let [(i, j), (k, l)] = [(row % 2, row / 2), (column % 2, column / 2)];
            moduli[(row, column)] = t[i + 2 * l] * t[k + 2 * j];
        }
        moduli[(4, 4)] = t[4] * t[4];
        moduli
    }
}
