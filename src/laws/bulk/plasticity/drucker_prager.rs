use nalgebra::{Vector3, Vector4};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::elasticity::isotropic;
use super::{
    Elasticity, Elastoplastic, ONE, ROUND_OFF, ReturnDescription, ReturnMap, Returned, THIRD, deviator, double_dot,
    in_axes, within,
};
use crate::laws::bulk::{Answer, CauchyStress, ElasticConstants, Flow, InadmissibleStress, Lame};
use crate::laws::parameter::{InvalidParameter, require, require_not_negative};
use crate::laws::text::{distinct, number};

/// Constants of [`DruckerPrager`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct DruckerPragerParameters {
    /// E: Young's modulus, E > 0 [F/L²]
    #[serde(rename = "E")]
    pub young: f64,
    /// ν: Poisson's ratio, −1 < ν < 0.5 [-]
    #[serde(rename = "nu")]
    pub poisson: f64,
    /// ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    #[serde(default)]
    pub density: f64,
    /// c: cohesion, c ≥ 0, above 0 where phi is 0 [F/L²]
    pub c: f64,
    /// φ: angle of friction, 0 ≤ φ < 90 [degrees]
    pub phi: f64,
    /// ψ: angle of dilation, 0 ≤ ψ ≤ φ [degrees]
    pub psi: f64,
    /// Which tests c and φ are those of
    pub matching: Matching,
    /// Largest mean stress tr τ/3, tension positive; that of the tip of the cone, c cot φ, unless given [F/L²]
    pub tension: Option<f64>,
    /// τ_v: relaxation time of the viscosity by Duvaut and Lions, τ_v ≥ 0; 0 for none [T]
    #[serde(default)]
    pub viscosity: f64,
}

/// How the cone is fitted to Mohr and Coulomb's hexagon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Matching {
    /// The same collapse in plane strain, of associated flow: it needs psi = phi
    PlaneStrain,
    /// The same strength in triaxial compression; in plane strain it is too strong, much so for φ > 25°
    Compression,
}

impl DruckerPragerParameters {
    /// Associated, of a body without mass.
    pub fn new(young: f64, poisson: f64, [c, phi]: [f64; 2], matching: Matching) -> Self {
        Self { young, poisson, density: 0.0, c, phi, psi: phi, matching, tension: None, viscosity: 0.0 }
    }
}

/// Drucker and Prager's law: a cone in the space of stresses.
///
/// ```text
/// f = √J₂ + η p − ξ c ≤ 0,   J₂ = ½ s:s,   p = tr τ/3              tension positive                              (1)
/// dε_p = dγ (s/(2√J₂) + η̄/3 1),   p ≤ p_t                          η̄ as η, with ψ for φ; tension cut-off p_t     (2)
/// plane strain:  η = 3 tan φ/√(9 + 12 tan²φ),             ξ = 3/√(9 + 12 tan²φ),      ψ = φ                       (3)
/// compression:   η = 6 sin φ/(√3 (3 − sin φ)),            ξ = 6 cos φ/(√3 (3 − sin φ))                            (4)
/// ```
/// The return is closed on each part of the surface:
/// ```text
/// cone      Δγ = f_tr/(G + K η η̄),   √J₂ = √J₂,tr − G Δγ,   p = p_tr − K η̄ Δγ                                    (5)
/// cut-off   p = p_t, s = s_tr;   rim   p = p_t, √J₂ = ξ c − η p_t;   tip   p = ξ c/η, s = 0                      (6)
/// ```
/// At the tip nothing resists: a ten-millionth of the elastic stiffness is left in the tangent there.
///
/// Source: de Souza Neto, Perić & Owen (2008), Computational Methods for Plasticity, §8.3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DruckerPrager {
    elastic: Lame,
    /// η
    friction: f64,
    /// η̄
    dilation: f64,
    /// ξ c [F/L²]
    cohesion: f64,
    /// p_t, that of the tip at most [F/L²]
    tension: f64,
    /// c and tan φ as given [F/L², -]
    given: [f64; 2],
}

/// Share of the elastic stiffness that is left in the tangent where there is none.
pub(super) const FLOOR: f64 = 1e-7;

impl DruckerPrager {
    /// The law at large deformations.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn new(given: &DruckerPragerParameters) -> Result<Elastoplastic<Self>, InvalidParameter> {
        let DruckerPragerParameters { young, poisson, density, c, phi, psi, matching, tension, viscosity } = *given;
        let elastic = ElasticConstants { young, poisson, density }.lame()?;
        check_strength(c, phi, psi)?;
        let in_plane = matching == Matching::PlaneStrain;
        let associated = "in plane strain it must be phi: the matching holds for associated flow; take \"matching\": \
                          \"compression\", or mohr_coulomb";
        require("psi", psi, !in_plane || psi == phi, associated)?;
        if let Some(tension) = tension {
            require_not_negative("tension", tension)?;
        }
        let slopes = |angle: f64| {
            let (sin, cos) = angle.to_radians().sin_cos();
            let tan = sin / cos;
            match matching {
                Matching::PlaneStrain => [3.0 * tan, 3.0].map(|part| part / (9.0 + 12.0 * tan * tan).sqrt()),
                Matching::Compression => [6.0 * sin, 6.0 * cos].map(|part| part / (3f64.sqrt() * (3.0 - sin))),
            }
        };
        let [friction, xi] = slopes(phi);
        let [dilation, _] = slopes(psi);
        let tip = if friction > 0.0 { xi * c / friction } else { f64::INFINITY };
        let tension = tension.map_or(tip, |tension| tension.min(tip));
        let given = [c, phi.to_radians().tan()];
        Elastoplastic::new(Self { elastic, friction, dilation, cohesion: xi * c, tension, given }, density, viscosity)
    }

    /// √J₂ of the cone at a mean stress.
    fn radius(&self, mean: f64) -> f64 {
        if self.friction > 0.0 { (self.cohesion - self.friction * mean).max(0.0) } else { self.cohesion }
    }
}

/// Cohesion and angles that make sense together.
pub(super) fn check_strength(c: f64, phi: f64, psi: f64) -> Result<(), InvalidParameter> {
    require("phi", phi, (0.0..90.0).contains(&phi), "it must be 0 or more, and less than 90 degrees")?;
    require("psi", psi, (0.0..=phi).contains(&psi), "it must be between 0 and phi")?;
    require("c", c, c > 0.0 || (c == 0.0 && phi > 0.0), "it must be zero or positive, and positive where phi is 0")
}

impl ReturnMap for DruckerPrager {
    #[inline(always)]
    fn description(&self) -> ReturnDescription<'_> {
        let is_associated = self.friction == self.dilation;
        ReturnDescription {
            flow: if self.dilation > 0.0 { Flow::Dilating } else { Flow::Isochoric },
            is_associated,
            localizes: (!is_associated).then_some("flows otherwise than it yields (psi < phi)"),
            strength: Some(self.given),
            ..ReturnDescription::new("drucker_prager")
        }
    }

    #[inline(always)]
    fn elasticity(&self, _: &[f64]) -> Elasticity {
        Elasticity::Linear(self.elastic)
    }

    fn begin(&self, stress: &CauchyStress, history: &mut [f64]) -> Result<(), InadmissibleStress> {
        within(self, stress, history, || {
            let (s, trace) = deviator(&Vector4::from(stress.components()));
            let root = (0.5 * double_dot(&s, &s)).sqrt();
            let [is, strength] = distinct([root, self.radius(trace / 3.0)]);
            format!(
                "√J₂ is {is} at the mean stress {}, where the cone carries {strength}; raise c or phi, or choose stresses that \
                 differ less (K0 nearer to 1)",
                number(trace / 3.0)
            )
        })
    }

    #[inline(always)]
    fn returned(&self, trial: &Vector3<f64>, _: &Vector4<f64>, history: &mut [f64]) -> Answer<Returned> {
        let Self { elastic, friction, dilation, cohesion, tension, .. } = *self;
        let (shear, bulk) = (elastic.shear, elastic.bulk());
        let mut answer = Returned::elastic(elastic, trial);
        if self.yield_indicator(&answer.stress, history) <= ROUND_OFF * shear {
            return Ok(answer);
        }
        let (s, trace) = deviator(&answer.stress);
        let (mean, root) = (THIRD * trace, (0.5 * double_dot(&s, &s)).sqrt());
        let over_root = if root > 0.0 { 1.0 / root } else { 0.0 };
        let normal = 0.5f64.sqrt() * over_root * s;
        let a = 1.0 / (shear + bulk * friction * dilation);
        let slip = a * (root + friction * mean - cohesion).max(0.0);
        let on_cone = mean - bulk * dilation * slip;
        let (left, mean) = if root - shear * slip >= 0.0 && on_cone <= tension {
            // (5); within the cone nothing is taken off
            let left = 1.0 - shear * slip * over_root;
            let across = 2f64.sqrt() * shear * a * bulk;
            let by_normal = 2.0 * shear * (1.0 - left - shear * a) * normal - across * dilation * ONE;
            answer.tangent = isotropic(bulk * (1.0 - bulk * friction * dilation * a), shear * left)
                + by_normal * normal.transpose()
                - across * friction * normal * ONE.transpose();
            (left, on_cone)
        } else if root < self.radius(tension) {
            answer.tangent = isotropic(FLOOR * bulk, shear);
            (1.0, tension)
        } else {
            let left = self.radius(tension) * over_root;
            answer.tangent =
                isotropic(FLOOR * bulk, (left + FLOOR) * shear) - 2.0 * shear * left * normal * normal.transpose();
            (left, tension)
        };
        answer.stress = left * s + mean * ONE;
        answer.plastic = in_axes(trial) - elastic.strain(&answer.stress);
        Ok(answer)
    }

    #[inline(always)]
    fn yield_indicator(&self, stress: &Vector4<f64>, _: &[f64]) -> f64 {
        let (s, trace) = deviator(stress);
        let (mean, root) = (THIRD * trace, (0.5 * double_dot(&s, &s)).sqrt());
        let cone = root + if self.friction > 0.0 { self.friction * mean } else { 0.0 } - self.cohesion;
        cone.max(mean - self.tension)
    }
}
