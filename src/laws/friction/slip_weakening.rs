use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::sensitivity::{Direction, Inputs, SensitiveLaw, Variation, Variations, variations};
use super::{
    Answer, Description, FrictionLaw, FrictionResponse, FrictionState, LEAST_SLOPE, Sliding, traction_at_yield,
};
use crate::laws::dual::{Dual, Number};
use crate::laws::parameter::{InvalidParameter, require, require_not_negative, require_positive};

/// Parameters of [`SlipWeakening`] as in the case file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct SlipWeakeningParameters {
    /// μ_s: static friction coefficient, μ_s ≥ μ_d [-]
    pub mu_s: f64,
    /// μ_d: friction coefficient after the slip D_c, μ_d > 0 [-]
    pub mu_d: f64,
    /// D_c: slip over which friction falls from μ_s to μ_d, D_c > 0 [L]
    #[serde(rename = "D_c")]
    pub critical_slip: f64,
    /// c: cohesion, the strength at zero pressure of surfaces in contact, c ≥ 0 [F/L²]
    #[serde(default)]
    pub cohesion: f64,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
}

numbers!(SlipWeakeningParameters: "mu_s" mu_s, "mu_d" mu_d, "D_c" critical_slip, "cohesion" cohesion; "alpha_t" alpha_t);

impl SlipWeakeningParameters {
    /// Creates parameters without cohesion, with the default tangential stiffness of the contact.
    pub const fn new(mu_s: f64, mu_d: f64, critical_slip: f64) -> Self {
        Self { mu_s, mu_d, critical_slip, cohesion: 0.0, alpha_t: None }
    }
}

setters! { const law: SlipWeakeningParameters;
    /// Sets the cohesion [F/L²].
    cohesion(cohesion: f64) { law.cohesion = cohesion; }

    /// Sets the tangential stiffness α_t [F/L³].
    alpha_t(alpha_t: f64) { law.alpha_t = Some(alpha_t); }
}

/// Linear slip weakening on an elastic contact, widely used in earthquake simulations.
///
/// ```text
/// q̇ = α_t (v − λ sgn q)                          slip = elastic + plastic
/// |q| ≤ c + μ p,   λ ≥ 0                           sticking, or slipping at the strength
/// μ = max(μ_s − W D, μ_d),   W = (μ_s − μ_d)/D_c      D = ∫ λ dt, in either direction; it does not heal
/// ```
/// An increment slips by the smallest Δλ that reduces the trial |q_tr| = |q₀ + α_t Δu| to the strength,
/// ```text
/// Δλ = (|q_tr| − c − μ₀ p)/(α_t − W p)      if μ stays above μ_d,
/// Δλ = (|q_tr| − c − μ_d p)/α_t              else, and where W p ≥ α_t: friction falls faster than the contact unloads
/// ```
/// There is no time discretization error. The work dissipated is ∫ |q| dλ along linear paths of slip and pressure: elastic up
/// to the strength, then at the strength; where friction decreases faster than the contact unloads, |q| decreases with α_t λ
/// from one strength to the other. The internal variable is D, so that parameters may vary in time. An initial traction above
/// the strength is released by slip in the first increment.
///
/// # Errors
/// Returns [`LawFailure`](super::LawFailure) if the increment or the response is not finite, or Δt is negative.
///
/// Source: Ida (1972), J. Geophys. Res. 77, 3796; Harris et al. (2009), Seismol. Res. Lett. 80, 119 (community benchmark
/// problems).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipWeakening {
    mu_s: f64,
    mu_d: f64,
    /// D_c [L]
    critical_slip: f64,
    /// W [1/L]
    weakening: f64,
    cohesion: f64,
    alpha_t: f64,
}

impl SlipWeakening {
    /// Creates the law from checked parameters; `default_alpha_t` is used if they do not specify `alpha_t`.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] if a parameter is out of range.
    pub fn new(parameters: &SlipWeakeningParameters, default_alpha_t: f64) -> Result<Self, InvalidParameter> {
        let SlipWeakeningParameters { mu_s, mu_d, critical_slip, cohesion, .. } = *parameters;
        let alpha_t = parameters.alpha_t.unwrap_or(default_alpha_t);
        require_positive("mu_d", mu_d)?;
        require(
            "mu_s",
            mu_s,
            mu_s >= mu_d,
            format_args!("it must be finite and not less than \"mu_d\", which is {mu_d}"),
        )?;
        require_positive("D_c", critical_slip)?;
        require_not_negative("cohesion", cohesion)?;
        require_positive("alpha_t", alpha_t)?;
        Ok(Self { mu_s, mu_d, critical_slip, weakening: (mu_s - mu_d) / critical_slip, cohesion, alpha_t })
    }
}

/// Slip that reduces the traction to the strength.
struct Slid {
    /// D at the end [L]
    total: f64,
    /// μ at the end [-]
    mu: f64,
    /// |q| = c + μ p [F/L²]
    strength: f64,
    /// Factor α_t/(α_t − w p), w being the weakening per slip, by which weakening amplifies slip; 1 at μ_d [-]
    softness: f64,
}

impl SlipWeakening {
    /// μ after a slip.
    fn mu_after(&self, slip: f64) -> f64 {
        (self.mu_s - self.weakening * slip).max(self.mu_d)
    }

    /// Slip that reduces an elastic traction to the strength, starting from D; `None` if it is not above.
    fn slide(&self, before: f64, elastic: f64, pressure: f64) -> Option<Slid> {
        let Self { mu_d, weakening, cohesion, alpha_t, .. } = *self;
        let old_mu = self.mu_after(before);
        let excess = elastic - cohesion - old_mu * pressure;
        if excess <= 0.0 {
            return None;
        }
        let net = alpha_t - weakening * pressure;
        let fallen = weakening * excess / net;
        let (mu, softness) = match net > 0.0 && old_mu - fallen > mu_d {
            true => (old_mu - fallen, alpha_t / net.max(LEAST_SLOPE * alpha_t)),
            false => (mu_d, 1.0),
        };
        let strength = cohesion + mu * pressure;
        Some(Slid { total: before + (elastic - strength) / alpha_t, mu, strength, softness })
    }

    /// Mean of |q| over the plastic slip of an increment with this end. An initial excess over the strength is released first.
    fn mean_traction(&self, old: &FrictionState, trial: f64, pressure: f64, end: &Slid) -> f64 {
        let [start, last] = [trial.signum() * old.traction, trial.abs()];
        let (before, way) = (slip_of(old), [old.pressure, pressure]);
        let Some(first) = self.slide(before, start, old.pressure) else {
            return self.mean_on_the_way(self.mu_after(before), [start, last], way, end);
        };
        let (off, slip) = (first.total - before, end.total - before);
        let at_once = 0.5 * (start + first.strength);
        if off >= slip {
            return 0.5 * (start + end.strength);
        }
        let rest = self.mean_on_the_way(first.mu, [first.strength, last - self.alpha_t * off], way, end);
        (off * at_once + (slip - off) * rest) / slip
    }

    /// Mean starting from an initial μ, where the elastic traction and the pressure vary linearly and the former is initially
    /// not above the strength.
    fn mean_on_the_way(&self, old_mu: f64, elastic: [f64; 2], [old_pressure, pressure]: [f64; 2], end: &Slid) -> f64 {
        let Self { mu_d, weakening, cohesion, alpha_t, .. } = *self;
        let strength = |mu: f64, pressure: f64| cohesion + mu * pressure;
        let at_yield = traction_at_yield(elastic, [strength(old_mu, old_pressure), strength(old_mu, pressure)]);
        let at_end = end.strength;
        let slip = (elastic[1] - at_end) / alpha_t;
        // Over the increment the elastic traction increases relative to the strength, at the first μ and at the second; the
        // elapsed fraction of the increment is a quotient of linear functions of λ, whose denominator varies from one to the
        // other.
        let gain = |mu: f64| elastic[1] - elastic[0] - mu * (pressure - old_pressure);
        if old_mu <= mu_d || gain(old_mu) <= 0.0 {
            return 0.5 * (at_yield + at_end);
        }
        let falling = |to: f64, slip: f64, mu: f64| {
            let lag = end_share(gain(mu) / gain(old_mu) - 1.0) - 0.5;
            0.5 * (at_yield + to) + lag * (alpha_t * slip + to - at_yield)
        };
        if end.mu > mu_d {
            return falling(at_end, slip, end.mu);
        }
        let pressure_at_yield = (at_yield - cohesion) / old_mu;
        // Slip until μ_d is reached, the traction there, and the mean of |q| up to it
        let (fallen, level, mean) = if weakening * pressure_at_yield < alpha_t {
            let fallen = (old_mu - mu_d) / weakening;
            let share = (strength(mu_d, old_pressure) + alpha_t * fallen - elastic[0]) / gain(mu_d);
            let level = strength(mu_d, old_pressure + share.clamp(0.0, 1.0) * (pressure - old_pressure));
            (fallen.min(slip), level, falling(level, fallen, mu_d))
        } else {
            let level = strength(mu_d, pressure_at_yield);
            (((at_yield - level) / alpha_t).min(slip), level, 0.5 * (at_yield + level))
        };
        (mean * fallen + 0.5 * (level + at_end) * (slip - fallen)) / slip
    }
}

/// Weight of the value at the end in the mean of (A + B λ)/(C + D λ) over an interval of λ, the rest being that of the value at
/// the beginning, if the denominator increases by the fraction `z` along the interval; a half if it does not, or if slip would
/// have to stop within it.
///
/// ```text
/// (1 + z)/z (1 − ln(1 + z)/z)
/// ```
fn end_share(z: f64) -> f64 {
    if z <= -1.0 {
        0.5
    } else if z.abs() < 1e-3 {
        (1.0 + z) * (0.5 - z * (1.0 / 3.0 - z * (0.25 - z * (0.2 - z / 6.0))))
    } else {
        (1.0 + z) / z * (1.0 - z.ln_1p() / z)
    }
}

/// D, the internal variable of the law [L]
fn slip_of(state: &FrictionState) -> f64 {
    state.variables[0]
}

impl FrictionLaw for SlipWeakening {
    /// The lowest coefficient is μ_d; cohesion adds to it.
    fn description(&self) -> Description {
        Description {
            stiffness: self.alpha_t,
            stiffness_is_penalty: true,
            variables: &["weakening_slip"],
            observables: Some(&["R", "mu", "structure"]),
            released_above: Some([self.cohesion, self.mu_s]),
            least_coefficient: Some(self.mu_d),
            weakening: self.weakening,
            ..Description::default()
        }
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let alpha_t = self.alpha_t;
        let Sliding { slip, pressure, .. } = sliding.checked()?;
        if pressure <= 0.0 {
            return FrictionResponse::elastic(old.parted(alpha_t), 0.0).checked(alpha_t);
        }
        let trial = old.traction + alpha_t * slip;
        let Some(slid) = self.slide(slip_of(old), trial.abs(), pressure) else {
            return FrictionResponse::elastic(old.stuck(trial, pressure), alpha_t).checked(alpha_t);
        };
        let mean = self.mean_traction(old, trial, pressure, &slid);
        let traction = trial.signum() * slid.strength;
        FrictionResponse {
            state: old.slid(trial, traction, mean, pressure, alpha_t).with_variables([slid.total]),
            dtraction_dslip: alpha_t * (1.0 - slid.softness),
            dtraction_dpressure: trial.signum() * slid.mu * slid.softness,
            ..Default::default()
        }
        .checked(alpha_t)
    }

    fn observe(&self, name: &str, state: &FrictionState) -> Option<f64> {
        let mu = self.mu_after(slip_of(state));
        match name {
            "R" => Some(state.ratio(mu)),
            "mu" => Some(mu),
            "structure" => Some(mu / self.mu_d),
            _ => None,
        }
    }

    fn cohesion(&self) -> f64 {
        self.cohesion
    }

    fn sensitivities(&self) -> Option<&dyn SensitiveLaw> {
        Some(self)
    }
}

impl SensitiveLaw for SlipWeakening {
    fn parameters(&self) -> &'static [&'static str] {
        SlipWeakeningParameters::NUMBERS
    }

    fn start(&self, _: &str) -> Variation {
        Variation::new(0.0, 0.0)
    }

    fn vary(&self, old: &FrictionState, sliding: Sliding, directions: [Direction; 2]) -> Variations {
        let inputs = Inputs::new(old, sliding, directions)?;
        let [mu_s, mu_d, alpha_t] = [("mu_s", self.mu_s), ("mu_d", self.mu_d), ("alpha_t", self.alpha_t)]
            .map(|(name, value)| inputs.parameter(name, value));
        let cohesion = inputs.parameter("cohesion", self.cohesion);
        let weakening = (mu_s - mu_d) / inputs.parameter("D_c", self.critical_slip);
        let (before, trial) = (inputs.variable, inputs.traction + alpha_t * inputs.slip);
        if sliding.pressure <= 0.0 {
            return Ok(variations(0.0.into(), before));
        }
        let Some(slid) = self.slide(before.value, trial.value.abs(), sliding.pressure) else {
            return Ok(variations(trial, before));
        };
        let strength = |total: Dual| {
            let mu = if slid.mu > self.mu_d { mu_s - weakening * total } else { mu_d };
            cohesion + mu * inputs.pressure
        };
        // Excess of the elastic traction at constant D, which is 0 at its root
        let (sign, at_root) = (trial.value.signum(), Dual::from(slid.total));
        let excess = trial * sign - alpha_t * (at_root - before) - strength(at_root);
        let total = excess.map(slid.total, slid.softness / self.alpha_t);
        Ok(variations(strength(total) * sign, total))
    }
}
