use nalgebra::{Matrix4, Vector3, Vector4};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::cam_clay::{CamClay, CamClayParameters, P_C, SHEAR, compressed, invariants};
use super::skeleton::{Skeleton, State, Tensor, values};
use super::{
    Elasticity, Elastoplastic, ReturnDescription, ReturnMap, Returned, deviator, double_dot, in_axes, share_within,
    within,
};
use crate::laws::bulk::{Answer, CauchyStress, InadmissibleStress, MaterialFailure, Slot};
use crate::laws::parameter::{InvalidParameter, ratio, require, require_not_negative, require_positive};
use crate::laws::text::{at_least, number};

/// Constants of [`SysCamClay`]: those of [`CamClay`], rates of loss, and the initial skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct SysCamClayParameters {
    /// λ: slope of the line of normal compression of the remoulded soil, ln v over ln p, or e over ln p where a void ratio e is given,
    /// λ > κ [-]
    pub lambda: f64,
    /// κ: slope of the lines of swelling, as λ, κ > 0 [-]
    pub kappa: f64,
    /// e: void ratio in the middle of the path, which makes slopes of ln v of slopes of e: λ/(1 + e), the specific volume v being 1 + e;
    /// default: λ and κ are slopes of ln v [-]
    #[serde(default)]
    pub e: Option<f64>,
    /// M: q/p at critical state; M or phi, M > 0 [-]
    #[serde(rename = "M", default)]
    pub critical: Option<f64>,
    /// φ: angle of friction at critical state in triaxial compression, M = 6 sin φ/(3 − sin φ), in degrees; M or phi
    #[serde(default)]
    pub phi: Option<f64>,
    /// G: shear modulus, constant; G or nu, G > 0 [F/L²]
    #[serde(rename = "G", default)]
    pub shear: Option<f64>,
    /// ν: Poisson's ratio under the initial stress, which gives every point its constant G there; G or nu, −1 < ν < 0.5 [-]
    #[serde(rename = "nu", default)]
    pub poisson: Option<f64>,
    /// p_c at the start, that of the remoulded soil: with structure it yields in isotropic compression at p_c/R*; p_c or OCR, p_c ≥ p_min
    /// [F/L²]
    #[serde(default)]
    pub p_c: Option<f64>,
    /// Overconsolidation ratio 1/R at the start: size of the yield surface over that of a similar one through the initial stress; p_c or
    /// OCR, OCR ≥ 1 [-]
    #[serde(rename = "OCR", default)]
    pub ratio: Option<f64>,
    /// p_min: pressure below which the stiffness does not fall any more, p_min > 0: far below the pressures of interest [F/L²]
    pub p_min: f64,
    /// ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    #[serde(default)]
    pub density: f64,
    /// τ_v: relaxation time of the viscosity by Duvaut and Lions, τ_v ≥ 0; 0 for none [T]
    #[serde(default)]
    pub viscosity: f64,
    /// m: loss of overconsolidation as it yields, m > 0; default: it is elastic within the yield surface [-]
    #[serde(default)]
    pub m: Option<f64>,
    /// 1/R* at the start: degree of structure, 1 for remoulded soil, ≥ 1 [-]
    #[serde(default = "ratio::<1, 1>")]
    pub structure: f64,
    /// a: loss of structure as it yields, a ≥ 0 [-]
    #[serde(default)]
    pub a: f64,
    /// c_s: share of shear in the loss of structure, the rest being that of compaction, 0 ≤ c_s ≤ 1 [-]
    #[serde(default = "ratio::<1, 1>")]
    pub c_s: f64,
    /// b_r: rotation of the yield surface as it is sheared, b_r ≥ 0 [-]
    #[serde(default)]
    pub b_r: f64,
    /// m_b: limit of the rotation ‖β‖, m_b > 0 where b_r is not 0 [-]
    #[serde(default)]
    pub m_b: f64,
    /// ζ at the start: rotation √(3/2) ‖β‖ of the yield surface towards the initial stress, 0 ≤ ζ < M [-]
    #[serde(default)]
    pub zeta: f64,
}

impl SysCamClayParameters {
    /// Creates the parameters of a remoulded soil with the constants of a [`CamClay`].
    pub const fn new(clay: CamClayParameters) -> Self {
        let CamClayParameters {
            lambda,
            kappa,
            e,
            critical,
            phi,
            shear,
            poisson,
            p_c,
            ratio,
            p_min,
            density,
            viscosity,
        } = clay;
        let (m, a, c_s, structure) = (None, 0.0, 1.0, 1.0);
        let (b_r, m_b, zeta) = (0.0, 0.0, 0.0);
        Self {
            lambda,
            kappa,
            e,
            critical,
            phi,
            shear,
            poisson,
            p_c,
            ratio,
            p_min,
            density,
            viscosity,
            m,
            structure,
            a,
            c_s,
            b_r,
            m_b,
            zeta,
        }
    }

    /// The constants of the remoulded soil.
    pub const fn clay(&self) -> CamClayParameters {
        let Self { lambda, kappa, e, critical, phi, shear, poisson, p_c, ratio, p_min, density, viscosity, .. } = *self;
        CamClayParameters { lambda, kappa, e, critical, phi, shear, poisson, p_c, ratio, p_min, density, viscosity }
    }
}

/// Super/subloading yield-surface modified Cam-clay (SYS Cam-clay): soil with structure, overconsolidation and anisotropy, which it loses
/// as it yields. *Experimental*: see the sources.
///
/// ```text
/// f = q*²/M² + p (p − P) = 0,   q* = √(3/2) ‖s − p β‖,   P = (R/R*) p_c                                            (1)
/// de_p = 3Λ̇ η̂/M²,   dε_v^p = Λ̇ (1 − (η*² + 3 η̂:β)/M²),   η̂ = s/p − β,   η* = √(3/2) ‖η̂‖      associated          (2)
/// dp_c/p_c = dε_v^p/(λ̂ − κ̂)                                              the remoulded soil: CamClay              (3)
/// dR = −(m/D) ln R ‖dε_p‖,   D = (λ̂ − κ̂)/M                               loss of overconsolidation               (4)
/// dR* = (a/D) R* (1 − R*) (c_s √(2/3) ‖de_p‖ + (1 − c_s) dε_v^p)          loss of structure                       (5)
/// dβ = (b_r/D) √(2/3) ‖de_p‖ (m_b η̂ − ‖η̂‖ β)                             rotation                                (6)
/// dissipation = p dε_v^p + s:de_p = Λ̇ P                                                                          (7)
/// ```
/// Three similar surfaces: p_c that of the remoulded soil, p_c/R* the superloading surface, where soil with structure yields in the usual
/// sense, and (R/R*) p_c the subloading surface, which always passes through the stress. R falls with the stress while it is elastic, and
/// rises by (4) where it would rise by elasticity. Without m there is no subloading surface and R is 1 where it yields. At critical
/// state η² = M² + ζ², ζ = √(3/2) ‖β‖. With m absent, R* = 1 and β = 0 it is [`CamClay`]. Elasticity, signs, λ̂ and κ̂ are those of [`CamClay`].
///
/// An increment is elastic up to where P of the stress is least on the way from the committed stress to the trial stress, and plastic from there.
/// Its end has, with Λ = Δγ p and the plastic strains of (2) at the end,
/// ```text
/// ε_v + Δε_v^p = ε_v,tr,   ln p + ln(1 + η*²/M²) = ln P                                                           (8)
/// η̂ ((1 + c)(1 + x) + x m_b/‖η̂‖) = (1 + x) s_tr/p − β_n,   c = 6GΛ/(M² p),   x = (b_r/D) √6 Λ ‖η̂‖²/M²             (9)
/// ```
/// where (3), (4) and (5) are exact for the plastic strains: p_c is exponential, R has a closed form, R* is logistic. So nothing drifts: R and R* stay
/// within 0 and 1. Newton's method finds ε_v and Λ of (8), with ‖η̂‖ of (9) inside of it, or where it fails, as near zero pressure, bisection.
/// Where that fails as well, the way is divided into up to 256 parts. The tangent is that of all parts.
///
/// # Errors
/// [`MaterialFailure::NotConverged`] when (8) has not been solved: a tension that is the same in all directions has no solution.
///
/// Source: Asaoka, Nakano & Noda (2000), Soils Found. 40(2), 99, doi:10.3208/sandf.40.2_99 (R, R*); Asaoka, Noda, Yamada, Kaneda & Nakano (2002),
/// Soils Found. 42(5), 47, doi:10.3208/sandf.42.5_47 (β; (4) by ‖dε_p‖ instead of the shear alone); Hashiguchi & Chen (1998), Int. J. Numer. Anal.
/// Methods Geomech. 22, 197 (rotation). The papers were not at hand: (1) to (6) are the rules as they are known, without the determinant of F in
/// the rates and with the exponents b = c = 1 of (5). github.com/ku-geo/jax-camclay, an independent program, has (1) to (5), with another rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SysCamClay {
    clay: CamClay,
    skeleton: Skeleton,
    /// R* at the start
    structure: f64,
    /// ζ at the start
    zeta: f64,
}

/// History of the law itself: that of [`CamClay`], and the skeleton.
const OWN: [&str; 8] = ["p_c", "shear_modulus", "R", "R_star", "beta_xx", "beta_yy", "beta_zz", "beta_xy"];

const RATIO: Slot<1> = Slot::after(SHEAR);
const STRUCTURE: Slot<1> = Slot::after(RATIO);
const ROTATION: Slot<4> = Slot::after(STRUCTURE);

/// Names of the quantities that the law shows.
const SHOWN: [&str; 6] = ["effective_pressure", "deviator_stress", "p_c", "R", "R_star", "zeta"];

/// Numbers of parts of an increment that are tried.
const PARTS: [u32; 5] = [1, 4, 16, 64, 256];

/// Name of the law in a case.
const NAME: &str = "sys_cam_clay";

/// p and s of a stress.
fn split(stress: &Vector4<f64>) -> (f64, Tensor<f64>) {
    let (deviator, trace) = deviator(stress);
    (-trace / 3.0, deviator.into())
}

impl SysCamClay {
    /// The law at large deformations.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn new(given: &SysCamClayParameters) -> Result<Elastoplastic<Self>, InvalidParameter> {
        let SysCamClayParameters { m, structure, a, c_s, b_r, m_b, zeta, .. } = *given;
        let clay = CamClay::checked(&given.clay())?;
        if let Some(m) = m {
            require_positive("m", m)?;
        }
        require("structure", structure, structure >= 1.0, "it must be 1 or more")?;
        require_not_negative("a", a)?;
        require("c_s", c_s, (0.0..=1.0).contains(&c_s), "it must be between 0 and 1")?;
        require_not_negative("b_r", b_r)?;
        require_not_negative("m_b", m_b)?;
        require("m_b", m_b, m_b > 0.0 || b_r == 0.0, "it must be positive where b_r is not 0")?;
        require("zeta", zeta, (0.0..clay.critical).contains(&zeta), "it must be 0 or more and less than M")?;
        let CamClay { plastic, critical, .. } = clay;
        let d = plastic / critical;
        let skeleton = Skeleton {
            plastic,
            critical,
            loosening: m.map(|m| m / d),
            decay: a / d,
            by_shear: c_s,
            turning: b_r / d,
            limit: m_b,
        };
        let law = Self { clay, skeleton, structure: 1.0 / structure, zeta };
        Elastoplastic::new(law, given.density, given.viscosity)
    }

    /// β at the start: along the initial deviator.
    fn initial_rotation(&self, deviator: &Tensor<f64>) -> Tensor<f64> {
        let tensor = Vector4::from(*deviator);
        let size = (1.5 * double_dot(&tensor, &tensor)).sqrt();
        if self.zeta > 0.0 && size > 0.0 { deviator.map(|part| self.zeta / size * part) } else { [0.0; 4] }
    }
}

impl ReturnMap for SysCamClay {
    fn description(&self) -> ReturnDescription<'_> {
        ReturnDescription {
            history: &OWN,
            tensors: 1,
            shown: &SHOWN,
            flow: self.clay.start.flow(self.structure),
            // Flow is associated, but the skeleton at the end of the increment makes D unsymmetric.
            is_associated: false,
            localizes: match self.structure < 1.0 && self.skeleton.decay > 0.0 {
                true => Some("softens as it loses its structure"),
                false => self.clay.localizes(),
            },
            ..ReturnDescription::new(NAME)
        }
    }

    fn elasticity(&self, history: &[f64]) -> Elasticity {
        self.clay.elasticity(history)
    }

    fn begin(&self, stress: &CauchyStress, history: &mut [f64]) -> Result<(), InadmissibleStress> {
        let tensor = Vector4::from(stress.components());
        let (pressure, deviator) = split(&tensor);
        let rotation = self.initial_rotation(&deviator);
        let size = if pressure > 0.0 { self.skeleton.size(pressure, &deviator, &rotation) } else { 0.0 };
        let p_c = self.clay.initial_p_c(size, self.structure);
        SHEAR.set(history, self.clay.initial_shear(pressure));
        P_C.set(history, p_c);
        RATIO.set(history, (self.structure * size / p_c).min(1.0));
        STRUCTURE.set(history, self.structure);
        *ROTATION.of_mut(history) = rotation;
        compressed(stress)?;
        let [p, q] = invariants(&tensor);
        if self.zeta > 0.0 && q <= 1e-9 * tensor.amax() {
            return Err(InadmissibleStress(
                "is the same in all directions, and `zeta` rotates the yield surface of sys_cam_clay towards its deviator: give a K0, or \
                 leave `zeta` out"
                    .into(),
            ));
        }
        within(self, stress, history, || {
            let [p, q, needed] = [number(p), number(q), at_least(self.structure * size)];
            format!(
                "p = {p} and q = {q} need a p_c of {needed} at least; raise p_c or structure, give OCR in place of p_c, or choose K0 \
                 nearer to 1"
            )
        })
    }

    fn returned(&self, trial: &Vector3<f64>, before: &Vector4<f64>, history: &mut [f64]) -> Answer<Returned> {
        let (elasticity, elastic) = (self.elasticity(history), self.clay.logarithmic(SHEAR.value(history)));
        let old = State {
            strain: elasticity.strain(before).into(),
            rotation: *ROTATION.of(history),
            ratio: RATIO.value(history),
            structure: STRUCTURE.value(history),
            p_c: P_C.value(history),
        };
        let strain = in_axes(trial);
        let mut rest = f64::NAN;
        let followed = PARTS.into_iter().find_map(|parts| {
            let state = self.skeleton.followed(&elastic, &old, &strain.into(), parts);
            state.map_err(|left| rest = left).ok()
        });
        let Some(state) = followed else {
            return Err(MaterialFailure::NotConverged { law: NAME, residual: rest });
        };
        let (pressure, deviator) = elastic.stress(&state.strain);
        let stress: Tensor<_> = std::array::from_fn(|k| if k < 3 { deviator[k] - pressure } else { deviator[k] });
        P_C.set(history, state.p_c.value);
        RATIO.set(history, state.ratio.value.min(1.0));
        STRUCTURE.set(history, state.structure.value);
        *ROTATION.of_mut(history) = values(&state.rotation);
        Ok(Returned {
            stress: values(&stress).into(),
            tangent: Matrix4::from_fn(|row, column| stress[row].by[column]),
            plastic: strain - Vector4::from(values(&state.strain)),
        })
    }

    /// √(q*²/M² + (p − P/2)²) − P/2 with P = p_c/R* of the superloading surface.
    fn yield_indicator(&self, stress: &Vector4<f64>, history: &[f64]) -> f64 {
        let (pressure, deviator) = split(stress);
        let beta = ROTATION.of(history);
        let difference = Vector4::from_fn(|k, _| deviator[k] - pressure * beta[k]);
        let half = 0.5 * P_C.value(history) / STRUCTURE.value(history);
        ((1.5 * double_dot(&difference, &difference)).sqrt() / self.skeleton.critical).hypot(pressure - half) - half
    }

    /// Where P of the stress is least, if there is a subloading surface.
    fn onset(&self, [before, trial]: [&Vector4<f64>; 2], history: &[f64]) -> f64 {
        let ways = [before, trial].map(split);
        match self.skeleton.loosening {
            Some(_) => {
                let [from, to] = &ways;
                self.skeleton.least([from.0, to.0], [&from.1, &to.1], ROTATION.of(history))
            }
            None => share_within(|share| self.yield_indicator(&(before + share * (trial - before)), history)),
        }
    }

    fn show(&self, stress: &Vector4<f64>, history: &[f64], values: &mut [f64]) {
        let [p, q] = invariants(stress);
        let beta = Vector4::from(*ROTATION.of(history));
        let zeta = (1.5 * double_dot(&beta, &beta)).sqrt();
        values.copy_from_slice(&[p, q, P_C.value(history), RATIO.value(history), STRUCTURE.value(history), zeta]);
    }
}
