use nalgebra::{Vector3, Vector4};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::elasticity::isotropic;
use super::{
    EQUIVALENT, Elasticity, Elastoplastic, ONE, ROUND_OFF, ReturnDescription, ReturnMap, Returned, THIRD, VOLUME,
    deviator, double_dot, within,
};
use crate::laws::bulk::{Answer, CauchyStress, ElasticConstants, InadmissibleStress, Lame, MaterialFailure};
use crate::laws::parameter::{InvalidParameter, require, require_not_negative, require_positive};
use crate::laws::text::distinct;

/// Constants of [`VonMises`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct VonMisesParameters {
    /// E: Young's modulus, E > 0 [F/L²]
    #[serde(rename = "E")]
    pub young: f64,
    /// ν: Poisson's ratio, −1 < ν < 0.5 [-]
    #[serde(rename = "nu")]
    pub poisson: f64,
    /// ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    #[serde(default)]
    pub density: f64,
    /// σ_y: stress in tension at which it begins to yield, σ_y > 0; of clay that is sheared undrained √3 s_u in plane strain [F/L²]
    pub sigma_y: f64,
    /// H: linear isotropic hardening, H ≥ 0: Y = σ_y + H ε̄ + Q (1 − exp(−b ε̄)) [F/L²]
    #[serde(rename = "H", default)]
    pub hardening: f64,
    /// Q: isotropic hardening that saturates (Voce); below 0 the material softens, Q > −σ_y and −Q b < 3 G [F/L²]
    #[serde(rename = "Q", default)]
    pub saturation: f64,
    /// b: how fast it saturates, b > 0 where Q is not 0 [-]
    #[serde(default)]
    pub b: f64,
    /// Back stresses by Armstrong and Frederick, at most 4; none unless given
    #[serde(default)]
    pub back_stresses: Vec<BackStress>,
    /// τ_v: relaxation time of the viscosity by Duvaut and Lions, τ_v ≥ 0; 0 for none [T]
    #[serde(default)]
    pub viscosity: f64,
}

/// A back stress: kinematic hardening, dα = ⅔ C dε_p − γ α dε̄.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BackStress {
    /// C: its modulus in tension at the start, C > 0 [F/L²]
    #[serde(rename = "C")]
    pub modulus: f64,
    /// γ: how it forgets, γ ≥ 0: it saturates at C/γ, and grows without end (Prager) where γ = 0 [-]
    #[serde(default)]
    pub gamma: f64,
}

impl VonMisesParameters {
    /// Perfectly plastic, of a body without mass.
    pub fn new(young: f64, poisson: f64, sigma_y: f64) -> Self {
        let (density, hardening, saturation, b, viscosity) = (0.0, 0.0, 0.0, 0.0, 0.0);
        Self { young, poisson, density, sigma_y, hardening, saturation, b, back_stresses: Vec::new(), viscosity }
    }
}

/// Von Mises' law: metals, and clay that is sheared undrained.
///
/// ```text
/// f = q − Y(ε̄) ≤ 0,   q = √(3/2) ‖s − α‖,   Y = σ_y + H ε̄ + Q (1 − e^(−b ε̄))                                (1)
/// dε_p = N dε̄,   N = (3/2)(s − α)/q                                                associated, isochoric     (2)
/// α = Σ α_k,   dα_k = ⅔ C_k dε_p − γ_k α_k dε̄                                      Armstrong & Frederick     (3)
/// stored Σ 3/(4C_k) α_k:α_k,   dissipation = Y dε̄ + Σ 3γ_k/(2C_k) α_k:α_k dε̄                                (4)
/// ```
/// s is the deviator of τ. What isotropic hardening takes counts as dissipated.
///
/// The return is one scalar equation whatever the number of back stresses, θ_k = 1/(1 + γ_k Δε̄):
/// ```text
/// ζ = s_tr − Σ θ_k α_k,n,   q_ζ − Δε̄ (3G + Σ θ_k C_k) − Y(ε̄_n + Δε̄) = 0,   N = (3/2) ζ/q_ζ                  (5)
/// s = s_tr − 2G Δε̄ N,   α_k = θ_k (α_k,n + ⅔ C_k Δε̄ N)                                                      (6)
/// ```
/// The left of (5) falls with Δε̄ by 3G + Y′ at least, and has one root, which Newton's method finds within a bracket.
///
/// # Errors
/// [`MaterialFailure::NotConverged`] when (5) has not been solved.
///
/// Source: Simo & Hughes (1998), Computational Inelasticity, ch. 3; Armstrong & Frederick (1966), reprinted in Mater. High Temp. 24, 1
/// (2007), doi:10.3184/096034007X207589; Chaboche (1986), Int. J. Plast. 2, 149, doi:10.1016/0749-6419(86)90010-0.
#[derive(Clone, Debug, PartialEq)]
pub struct VonMises {
    elastic: Lame,
    strength: f64,
    hardening: f64,
    saturation: f64,
    b: f64,
    back: Vec<BackStress>,
}

/// Names of the back stresses.
const BACK: [&str; 16] = [
    "back_stress_xx",
    "back_stress_yy",
    "back_stress_zz",
    "back_stress_xy",
    "back_stress_2_xx",
    "back_stress_2_yy",
    "back_stress_2_zz",
    "back_stress_2_xy",
    "back_stress_3_xx",
    "back_stress_3_yy",
    "back_stress_3_zz",
    "back_stress_3_xy",
    "back_stress_4_xx",
    "back_stress_4_yy",
    "back_stress_4_zz",
    "back_stress_4_xy",
];

/// Name of the law in a case.
const NAME: &str = "von_mises";

/// Most iterations for (5).
const ITERATIONS: usize = 60;

/// Tolerance of (5), as a share of the trial stress.
const LEFT: f64 = 1e-14;

impl VonMises {
    /// The law at large deformations.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a constant is out of its range.
    pub fn new(given: &VonMisesParameters) -> Result<Elastoplastic<Self>, InvalidParameter> {
        let VonMisesParameters { young, poisson, density, sigma_y, hardening, saturation, b, .. } = *given;
        let elastic = ElasticConstants { young, poisson, density }.lame()?;
        require_positive("sigma_y", sigma_y)?;
        require_not_negative("H", hardening)?;
        require("Q", saturation, saturation > -sigma_y, "it must be greater than -sigma_y: some strength is left")?;
        require("b", b, b > 0.0 || (b == 0.0 && saturation == 0.0), "it must be positive where Q is not 0")?;
        let softest = "Q b must be greater than -3 G: the material would snap back by itself";
        require("b", b, saturation * b > -3.0 * elastic.shear, softest)?;
        for back in &given.back_stresses {
            require_positive("C", back.modulus)?;
            require_not_negative("gamma", back.gamma)?;
        }
        let count = given.back_stresses.len();
        require("back_stresses", count as f64, count <= BACK.len() / 4, "there may be at most 4")?;
        let law = Self { elastic, strength: sigma_y, hardening, saturation, b, back: given.back_stresses.clone() };
        Elastoplastic::new(law, density, given.viscosity)
    }

    /// Y and dY/dε̄.
    #[inline(always)]
    fn strength(&self, equivalent: f64) -> [f64; 2] {
        if self.saturation == 0.0 {
            return [self.strength + self.hardening * equivalent, self.hardening];
        }
        let decay = (-self.b * equivalent).exp();
        let rest = -(-self.b * equivalent).exp_m1();
        [
            self.strength + self.hardening * equivalent + self.saturation * rest,
            self.hardening + self.saturation * self.b * decay,
        ]
    }

    /// ζ and its change with Δε̄, Σ θ_k C_k and its derivative of Δε̄ Σ θ_k C_k.
    #[inline(always)]
    fn shifted(&self, trial: &Vector4<f64>, back: &[f64], slip: f64) -> Shifted {
        let mut found = Shifted { zeta: *trial, slope: Vector4::zeros(), moduli: 0.0, by_slip: 0.0 };
        for (own, old) in self.back.iter().zip(back.chunks_exact(4)) {
            let theta = 1.0 / (1.0 + own.gamma * slip);
            let old = Vector4::from_column_slice(old);
            found.zeta -= theta * old;
            found.slope += own.gamma * theta * theta * old;
            found.moduli += theta * own.modulus;
            found.by_slip += theta * theta * own.modulus;
        }
        found
    }

    /// Δε̄ of (5).
    #[inline(always)]
    fn slip(&self, trial: &Vector4<f64>, history: &[f64]) -> Answer<f64> {
        let (before, back, stiff) = (EQUIVALENT.value(history), VOLUME.behind(history), 3.0 * self.elastic.shear);
        let largest = equivalent(trial);
        if back.is_empty() && self.saturation == 0.0 {
            // (5) is linear.
            return Ok((largest - self.strength(before)[0]) / (stiff + self.hardening));
        }
        let most = largest + back.chunks_exact(4).map(|old| equivalent(&Vector4::from_column_slice(old))).sum::<f64>();
        let [mut low, mut high] = [0.0, most / stiff];
        let (mut slip, mut rest) = (0.0, 0.0);
        for _ in 0..ITERATIONS {
            let shifted = self.shifted(trial, back, slip);
            let q = equivalent(&shifted.zeta);
            let [strength, hardening] = self.strength(before + slip);
            rest = q - slip * (stiff + shifted.moduli) - strength;
            if rest.abs() <= LEFT * most {
                return Ok(slip);
            }
            if rest > 0.0 {
                low = slip
            } else {
                high = slip
            }
            let next = slip + rest / (stiff + shifted.by_slip + hardening - shifted.turning(q));
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if next == slip {
                return Ok(slip);
            }
            slip = next;
        }
        Err(MaterialFailure::NotConverged { law: NAME, residual: rest / largest })
    }
}

/// ζ of (5) and what else depends on Δε̄.
struct Shifted {
    zeta: Vector4<f64>,
    /// ∂ζ/∂Δε̄
    slope: Vector4<f64>,
    /// Σ θ_k C_k
    moduli: f64,
    /// ∂(Δε̄ Σ θ_k C_k)/∂Δε̄
    by_slip: f64,
}

impl Shifted {
    /// ∂q/∂Δε̄ by ζ alone, N:∂ζ/∂Δε̄
    #[inline(always)]
    fn turning(&self, q: f64) -> f64 {
        if q > 0.0 { 1.5 * double_dot(&self.zeta, &self.slope) / q } else { 0.0 }
    }
}

/// √(3/2) ‖a‖ of a deviator.
#[inline(always)]
fn equivalent(a: &Vector4<f64>) -> f64 {
    (1.5 * double_dot(a, a)).sqrt()
}

impl ReturnMap for VonMises {
    #[inline(always)]
    fn description(&self) -> ReturnDescription<'_> {
        let tensors = self.back.len();
        ReturnDescription {
            // Without a panic, so that it costs nothing where the number of tensors alone is asked.
            history: BACK.get(..4 * tensors).unwrap_or(&BACK),
            tensors,
            localizes: (self.saturation < 0.0).then_some("softens (Q < 0)"),
            in_plates: true,
            strength: Some([self.strength / 3f64.sqrt(), 0.0]),
            ..ReturnDescription::new(NAME)
        }
    }

    #[inline(always)]
    fn elasticity(&self, _: &[f64]) -> Elasticity {
        Elasticity::Linear(self.elastic)
    }

    fn begin(&self, stress: &CauchyStress, history: &mut [f64]) -> Result<(), InadmissibleStress> {
        within(self, stress, history, || {
            let [is, strength] = distinct([stress.von_mises(), self.strength]);
            format!("its von Mises stress is {is}, and sigma_y is {strength}; lower it, or raise sigma_y")
        })
    }

    #[inline(always)]
    fn returned(&self, trial: &Vector3<f64>, _: &Vector4<f64>, history: &mut [f64]) -> Answer<Returned> {
        let Lame { shear, .. } = self.elastic;
        let mut answer = Returned::elastic(self.elastic, trial);
        if self.yield_indicator(&answer.stress, history) <= ROUND_OFF * shear {
            return Ok(answer);
        }
        let (deviator, trace) = deviator(&answer.stress);
        let before = EQUIVALENT.value(history);
        let slip = self.slip(&deviator, history)?;
        let shifted = self.shifted(&deviator, VOLUME.behind(history), slip);
        let q = equivalent(&shifted.zeta);
        let over_q = 1.0 / q;
        let normal = 1.5 * over_q * shifted.zeta;

        // (6), and its derivatives: with ds_tr = 2G dev dε, dΔε̄ = N:ds_tr/M, dN = (3/2 dζ − N (N:dζ))/q
        let [_, hardening] = self.strength(before + slip);
        let turning = double_dot(&normal, &shifted.slope);
        let stiffness = 3.0 * shear + shifted.by_slip + hardening - turning;
        answer.plastic = slip * normal;
        answer.stress = deviator - 2.0 * shear * slip * normal + THIRD * trace * ONE;
        let left = 1.0 - 3.0 * shear * slip * over_q;
        let of_slip = normal + slip * over_q * (1.5 * shifted.slope - turning * normal);
        // The shear of a strain is the tensor's component, which counts twice in N:dε.
        let along = 4.0 * shear * shear * Vector4::new(normal[0], normal[1], normal[2], 2.0 * normal[3]);
        answer.tangent = isotropic(self.elastic.bulk(), shear * left)
            + (slip * over_q * normal - 1.0 / stiffness * of_slip) * along.transpose();
        for (own, back) in self.back.iter().zip(VOLUME.behind_mut(history).chunks_exact_mut(4)) {
            let old = Vector4::from_column_slice(back);
            let new = (old + 2.0 / 3.0 * own.modulus * slip * normal) / (1.0 + own.gamma * slip);
            back.copy_from_slice(new.as_slice());
        }
        Ok(answer)
    }

    #[inline(always)]
    fn yield_indicator(&self, stress: &Vector4<f64>, history: &[f64]) -> f64 {
        let mut beyond = deviator(stress).0;
        VOLUME.behind(history).chunks_exact(4).for_each(|back| beyond -= Vector4::from_column_slice(back));
        equivalent(&beyond) - self.strength(EQUIVALENT.value(history))[0]
    }

    #[inline(always)]
    fn stored(&self, history: &[f64]) -> f64 {
        let own = |(own, back): (&BackStress, &[f64])| {
            let back = Vector4::from_column_slice(back);
            0.75 / own.modulus * double_dot(&back, &back)
        };
        self.back.iter().zip(VOLUME.behind(history).chunks_exact(4)).map(own).sum()
    }
}
