//! Super/subloading friction: the law, and its parameters in a case.
mod direct;
mod increment;
mod path;
mod peak;
mod with_rate;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::sensitivity::{Direction, Inputs, SensitiveLaw};
use super::{
    Answer, Description, FrictionLaw, FrictionResponse, FrictionState, LEAST_SLOPE, LawFailure, Regime, Sliding,
};
pub use crate::laws::approach::Approach;
use crate::laws::approach::SlidingCurve;
use crate::laws::dual::Dual;
use crate::laws::parameter::{InvalidParameter, ratio, require, require_not_negative, require_positive};
use direct::DirectEffect;
use increment::{ROUND_OFF, SlipEquation, mean_of_steady_slip, mean_traction};
use peak::PeakEvolution;
pub use peak::{Integration, Onset, Rise};

/// Super/subloading friction: slip weakens the interface, stationary contact heals it.
///
/// ```text
/// q̇ = α_t (v − λ sgn q)                               slip = elastic + plastic     (1)
/// Ṙ = U(R) λ,   R = |q|/(μ p),   U = −r ln R           approach to full sliding     (2)
/// μ̇ = −κ (μ/μ_k − 1)^m λ + ξ (1 − μ/μ_s)^n             weakening, recovery          (3)
/// ```
/// λ ≥ 0 is the rate of plastic slip; R decreases freely while λ = 0. With an elastic core R_e, ln R becomes
/// ln (R − R_e)/(1 − R_e); [`Approach`](super::Approach) offers a second U. Units: q, p [F/L²], α_t [F/L³], λ and v [L/T],
/// r and κ [1/L], ξ [1/T], all others [-].
///
/// In an increment slip, pressure and time vary linearly, Δu, p₀ → p, Δt. It is elastic as long as R can only decrease.
/// Plastic slip starts from R_s = max(R₀, R_e), or from R_e where the traction passes 0 or there was no pressure, and Δλ is
/// the *smallest* root of one scalar equation,
/// ```text
/// G(Δλ) = |q_tr| − α_t Δλ − R(Δλ) μ(Δλ) p = 0,   0 < Δλ ≤ |q_tr|/α_t,   q_tr = q₀ + α_t Δu     (4)
/// ```
/// with R from (2) integrated exactly ([`Approach`](super::Approach)). G is positive at the left end and not at the right, so a
/// bracketed search cannot fail. G decreases monotonically, and the root is unique, while α_t exceeds R p |dμ/dΔλ|; where this
/// cannot be guaranteed ([`Description::uniqueness_limit`]), bounds of the slope of G isolate the first root.
///
/// [`Integration`] determines μ of (4). *Backward Euler* takes one step of (3) and of (4) per increment. The *controlled*
/// integration solves (3) for slip and time proportional to each other, which is exact where μ only weakens or only recovers
/// (m = n = 1). The effect of the order of weakening and recovery is bounded for short increments, which need one step
/// (`path.rs`), and otherwise found by repeated halving of the increment, until q, μ p and the mean of q are accurate to the
/// tolerance (same file). The dissipation is ∫ |q| dλ, over a step with R along its curve and μ p linear in ∫ R dλ, or for
/// decreasing |q| with |q| linear in λ; the work of the increment, ∫ q du, is this plus the energy stored in the contact. The
/// tangent is consistent with the computed values; for one step
/// ```text
/// D = α_t + p (U μ + R ∂μ/∂Δλ),   ∂q/∂Δu = α_t (1 − α_t/D),   ∂q/∂p = sgn(q_tr) α_t R μ/D.
/// ```
///
/// # Errors
/// Returns [`LawFailure`](super::LawFailure) if the increment or the response is not finite, or Δt is negative.
///
/// With a direct effect of the rate, a > 0, the strength grows with the rate of plastic slip,
/// ```text
/// |q| = R μ p (1 + a ln(1 + λ/V₀))                                                             (5)
/// ```
/// and R is a variable of its own: it follows (2) while λ > 0, and |q|/(μ p) where |q| does not exceed R μ p, which is unloading.
/// (4) has the factor of (5) at λ = Δλ/Δt, by which a step is of first order and its root more stable; the controlled integration
/// extrapolates such steps until q, μ p, R and the mean of q are accurate to the tolerance. Slip in no time is elastic.
///
/// Source: Yasuike, Toyoda & Noda, eqs 10–20; Toyoda, Yasuike & Noda (2024), Tribology International 191:109080;
/// Ozaki & Hashiguchi (2010), Tribology International 43:2120.
#[derive(Clone, Copy, Debug)]
pub struct SuperSubloading {
    alpha_t: f64,
    initial_mu: f64,
    /// Initial 1/R*₀, if given
    structure: Option<f64>,
    curve: SlidingCurve,
    evolution: PeakEvolution,
    /// Direct effect of the rate, unless a = 0
    direct: Option<DirectEffect>,
    integration: Integration,
    tolerance: f64,
}

impl SuperSubloading {
    /// Creates the law from checked parameters; `default_alpha_t` is used if they do not specify `alpha_t`.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] if a parameter is out of range.
    pub fn new(parameters: &SuperSubloadingParameters, default_alpha_t: f64) -> Result<Self, InvalidParameter> {
        let SuperSubloadingParameters { mu_s, mu_k, r, kappa, xi, m, n, approach, elastic_core, integration, .. } =
            *parameters;
        let alpha_t = parameters.alpha_t.unwrap_or(default_alpha_t);
        require_positive("mu_k", mu_k)?;
        require(
            "mu_s",
            mu_s,
            mu_s >= mu_k,
            format_args!("it must be finite and not less than \"mu_k\", which is {mu_k}"),
        )?;
        require_positive("alpha_t", alpha_t)?;
        require_positive("r", r)?;
        require_not_negative("kappa", kappa)?;
        require_not_negative("xi", xi)?;
        require_positive("m", m)?;
        require_positive("n", n)?;
        let core_fits = (0.0..1.0).contains(&elastic_core);
        require("elastic_core", elastic_core, core_fits, "it must be zero or positive, and less than 1")?;
        let most = mu_s / mu_k;
        let structure = parameters.structure.unwrap_or(most);
        let structure_fits = (1.0..=most * (1.0 + ROUND_OFF)).contains(&structure);
        require("structure", structure, structure_fits, format_args!("it must lie between 1 and mu_s/mu_k = {most}"))?;
        let tolerance = parameters.tolerance.unwrap_or(1e-6);
        require("tolerance", tolerance, (1e-12..=0.1).contains(&tolerance), "it must lie between 1e-12 and 0.1")?;
        let has_tolerance = integration == Integration::Controlled || parameters.tolerance.is_none();
        require("tolerance", tolerance, has_tolerance, "backward Euler controls no error: leave it out")?;
        Ok(Self {
            alpha_t,
            initial_mu: (mu_k * structure).min(mu_s),
            structure: parameters.structure,
            curve: SlidingCurve::new(approach, elastic_core, r),
            evolution: PeakEvolution::new(mu_s, mu_k, kappa, xi, m, n, integration),
            direct: parameters.direct_effect()?,
            integration,
            tolerance,
        })
    }
}

/// R above which a point counts as slipping: the law has some plastic slip at any load.
pub const SLIPPING: f64 = 0.9;

/// Relative excess of a traction over the strength μ p that cannot result from this law.
const EXCESS: f64 = 1e-12;

impl SuperSubloading {
    /// Reduces a traction above the strength μ p to it, instantaneously and by plastic slip only.
    fn within_strength(&self, old: &FrictionState) -> FrictionState {
        let mu = self.evolution.clamp(mu_of(old));
        let old = FrictionState { plastic_increment: 0.0, ..old.clone() };
        if self.direct.is_some() {
            // Above μ p it slips at a rate instead.
            let ratio = ratio_of(&old);
            return old.with_variables([mu, ratio]);
        }
        let old = old.with_variables([mu]);
        let strength = mu * old.pressure.max(0.0);
        if old.traction.abs() <= strength * (1.0 + EXCESS) {
            return old;
        }
        let mean = 0.5 * (old.traction.abs() + strength);
        old.slid(old.traction, strength.copysign(old.traction), mean, old.pressure, self.alpha_t)
    }

    /// An increment without plastic slip that ends with the strength μ p.
    fn elastic(&self, old: &FrictionState, trial: f64, sliding: Sliding, mu: f64) -> FrictionResponse {
        let stuck = old.stuck(trial, sliding.pressure);
        let ratio = stuck.ratio(mu).min(1.0);
        // Slip in no time leaves R behind.
        let kept = if trial * old.traction < 0.0 { 0.0 } else { self.ratio(old) };
        let ratio = if sliding.dt == 0.0 { ratio.min(kept) } else { ratio };
        FrictionResponse::elastic(self.remembering(stuck, mu, ratio), self.alpha_t)
    }

    /// The state with its internal variables.
    fn remembering(&self, state: FrictionState, mu: f64, ratio: f64) -> FrictionState {
        match self.direct {
            Some(_) => state.with_variables([mu, ratio]),
            None => state.with_variables([mu]),
        }
    }

    /// R of a state: at most |q|/(μ p), and without a direct effect that.
    fn ratio(&self, state: &FrictionState) -> f64 {
        let of_traction = state.ratio(mu_of(state));
        if self.direct.is_some() { of_traction.min(ratio_of(state)) } else { of_traction }
    }

    /// Whether an increment towards the trial traction has no plastic slip. In a rate effect there is some while the traction is above R μ p,
    /// and none in no time.
    fn is_elastic(&self, old: &FrictionState, trial: f64, sliding: Sliding) -> bool {
        let exceeds = || old.ratio(mu_of(old)) > self.ratio(old) * (1.0 + ROUND_OFF);
        match self.direct {
            Some(_) => sliding.dt == 0.0 || falls(old, trial, sliding.pressure) && !exceeds(),
            None => falls(old, trial, sliding.pressure),
        }
    }

    /// One step of the slip equation over the whole increment.
    fn step(&self, old: &FrictionState, trial: f64, sliding: Sliding) -> Answer {
        let Sliding { pressure, dt, .. } = sliding;
        let old_mu = mu_of(old);
        let reversed = trial * old.traction.signum() < 0.0;
        let equation = SlipEquation {
            law: self,
            start: self.curve.start(if reversed { 0.0 } else { self.ratio(old).min(1.0) }),
            trial: trial.abs(),
            pressure,
            old_mu,
            dt,
        };
        let (sticks, start) = equation.start();
        if sticks {
            return Ok(self.elastic(old, trial, sliding, start.peak.mu));
        }
        let (end, evaluations) = equation.solve(start)?;
        let factor = self.direct.map_or(1.0, |direct| direct.factor(end.slip, dt).value);
        let strength = trial.signum() * end.curve_point.ratio * end.peak.mu * factor;
        // Plastic slip starts at the old pressure, or at that where the traction passes 0.
        let passed = if reversed { old.traction / (old.traction - trial) } else { 0.0 };
        let start_pressure = old.pressure + passed * (pressure - old.pressure);
        let strengths = [old_mu * start_pressure, end.peak.mu * pressure].map(|strength| strength * factor);
        let tractions = [if reversed { 0.0 } else { old.traction.abs() }, strength.abs() * pressure];
        let steady = mean_of_steady_slip(&self.curve, [&equation.start, &end.curve_point], strengths);
        let mean = mean_traction(steady, tractions);
        let softness = self.alpha_t / end.slope.max(LEAST_SLOPE * self.alpha_t);
        Ok(FrictionResponse {
            state: self.ruled(self.remembering(
                old.slid(trial, strength * pressure, mean, pressure, self.alpha_t),
                end.peak.mu,
                end.curve_point.ratio,
            )),
            dtraction_dslip: self.alpha_t * (1.0 - softness),
            dtraction_dpressure: strength * softness,
            evaluations,
            ..Default::default()
        })
    }

    /// ∫ (1/R* − 1) |dλ| over an increment and its derivatives by Δu_t and p, by the steps of the response.
    fn weighed(&self, old: &FrictionState, sliding: Sliding) -> Result<[f64; 3], LawFailure> {
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        if pressure <= 0.0 {
            return Ok([0.0; 3]);
        }
        let (given, old) = (old.plastic_slip, self.within_strength(old));
        let released = (old.plastic_slip - given).abs() * self.evolution.excess(mu_of(&old));
        let trial = old.traction + self.alpha_t * slip;
        if self.is_elastic(&old, trial, sliding) {
            return Ok([released, 0.0, 0.0]);
        }
        let [slip, by_slip, by_pressure] = match self.integration {
            Integration::Controlled => {
                let (mut path, start, _) =
                    self.begin_path(&Inputs::new(&old, sliding, Direction::TANGENT)?, old.pressure);
                path.weighs = true;
                let Dual { value, by } = path.end(&start)?.weighed_slip;
                [value, by[0], by[1]]
            }
            Integration::BackwardEuler => {
                let FrictionResponse { state, dtraction_dslip, dtraction_dpressure, .. } =
                    self.step(&old, trial, sliding)?;
                let (slip, sign) = (state.plastic_increment.abs(), state.plastic_increment.signum());
                let end = self.evolution.after(mu_of(&old), slip, dt);
                let excess = self.evolution.excess(end.mu);
                let rate = sign * (excess + slip * end.slope / self.evolution.mu_k);
                let elastic = [dtraction_dslip / self.alpha_t, dtraction_dpressure / self.alpha_t];
                [slip * excess, rate * (1.0 - elastic[0]), -rate * elastic[1]]
            }
        };
        Ok([released + slip, by_slip, by_pressure])
    }

    /// The state of a closed point with its contact status.
    fn ruled(&self, state: FrictionState) -> FrictionState {
        let slips = state.plastic_increment != 0.0 && self.ratio(&state) >= SLIPPING;
        FrictionState { regime: if slips { Regime::Slip } else { Regime::Stick }, ..state }
    }

    /// An increment in which slip may be plastic, in sub-steps.
    fn follow(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let inputs = Inputs::new(old, sliding, Direction::TANGENT)?;
        let (mut path, start, sign) = self.begin_path(&inputs, old.pressure);
        let end = path.end(&start)?;
        let pressure = sliding.pressure;
        let plastic_slip = sign * end.plastic_slip;
        Ok(FrictionResponse {
            state: self.ruled(FrictionState {
                traction: sign * end.traction.value,
                pressure,
                plastic_slip: old.plastic_slip + plastic_slip,
                plastic_increment: old.plastic_increment + plastic_slip,
                dissipation: old.dissipation + end.work,
                ..self.remembering(old.clone(), end.mu.value, end.ratio.value)
            }),
            dtraction_dslip: sign * end.traction.by[0],
            dtraction_dpressure: sign * end.traction.by[1],
            evaluations: path.evaluations,
            ..Default::default()
        })
    }
}

/// Whether R can only decrease towards the trial traction.
fn falls(old: &FrictionState, trial: f64, pressure: f64) -> bool {
    let ratio_falls = trial.abs() * old.pressure <= old.traction.abs() * pressure * (1.0 + ROUND_OFF);
    trial * old.traction.signum() >= 0.0 && ratio_falls && old.pressure > 0.0
}

/// μ, the internal variable of the law [-]
fn mu_of(state: &FrictionState) -> f64 {
    state.variables[0]
}

/// R, the second internal variable of a law with a direct effect [-]
fn ratio_of(state: &FrictionState) -> f64 {
    state.variables[1].clamp(0.0, 1.0)
}

impl FrictionLaw for SuperSubloading {
    /// The lowest coefficient is μ_k, with R = 1 in continued sliding.
    fn description(&self) -> Description {
        Description {
            stiffness: self.alpha_t,
            variables: if self.direct.is_some() { &["mu", "R"] } else { &["mu"] },
            observables: Some(&["R", "mu", "structure"]),
            // What exceeds it is released by slip at a rate.
            starting_coefficient: self.direct.is_none().then_some(self.initial_mu),
            least_coefficient: Some(self.evolution.mu_k.min(self.evolution.mu_s)),
            full_structure: Some(self.evolution.mu_s / self.evolution.mu_k),
            weakening: self.evolution.weakening(self.evolution.mu_s),
            ..Description::default()
        }
    }

    fn initial_state(&self, pressure: f64, traction: f64) -> FrictionState {
        // R is at most |q|/(μ p), here as well.
        self.remembering(FrictionState::default(), self.initial_mu, 1.0).loaded(pressure, traction)
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        if pressure <= 0.0 {
            let mu = self.evolution.rested(self.evolution.clamp(mu_of(old)), dt);
            let parted = self.remembering(old.parted(self.alpha_t), mu, 0.0);
            return FrictionResponse::elastic(parted, 0.0).checked(self.alpha_t);
        }
        let old = self.within_strength(old);
        let trial = old.traction + self.alpha_t * slip;
        if self.is_elastic(&old, trial, sliding) {
            let mu = self.evolution.rested(mu_of(&old), dt);
            return self.elastic(&old, trial, sliding, mu).checked(self.alpha_t);
        }
        match self.integration {
            Integration::Controlled => self.follow(&old, sliding),
            Integration::BackwardEuler => self.step(&old, trial, sliding),
        }?
        .checked(self.alpha_t)
    }

    fn structured_slip(&self, old: &FrictionState, sliding: Sliding) -> Option<Result<[f64; 3], LawFailure>> {
        Some(self.weighed(old, sliding))
    }

    fn sensitivities(&self) -> Option<&dyn SensitiveLaw> {
        (self.integration == Integration::Controlled).then_some(self as &dyn SensitiveLaw)
    }

    fn observe(&self, name: &str, state: &FrictionState) -> Option<f64> {
        let mu = mu_of(state);
        match name {
            "R" => Some(self.ratio(state)),
            "mu" => Some(mu),
            "structure" => Some(mu / self.evolution.mu_k),
            _ => None,
        }
    }

    fn onset(&self) -> Option<Onset> {
        Some(Onset::of(&self.curve, &self.evolution, self.initial_mu))
    }
}

/// Parameters of [`SuperSubloading`](super::SuperSubloading) as in the case file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct SuperSubloadingParameters {
    /// μ_s: static friction coefficient, μ_s ≥ μ_k [-]
    pub mu_s: f64,
    /// μ_k: kinetic friction coefficient, μ_k > 0 [-]
    pub mu_k: f64,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
    /// r: rate at which R approaches 1 with plastic slip, r > 0 [1/L]
    pub r: f64,
    /// κ: loss of structure with plastic slip, κ ≥ 0 [1/L]
    #[serde(default)]
    pub kappa: f64,
    /// ξ: recovery of structure with time, ξ ≥ 0 [1/T]
    #[serde(default)]
    pub xi: f64,
    /// m: exponent of the loss, m > 0 [-]
    #[serde(default = "ratio::<1, 1>")]
    pub m: f64,
    /// n: exponent of the recovery, n > 0 [-]
    #[serde(default = "ratio::<1, 1>")]
    pub n: f64,
    /// a: direct effect of the rate of plastic slip λ, by which the strength is multiplied by 1 + a ln(1 + λ/V₀), a ≥ 0; none by
    /// default. R is then a state of its own, and steady sliding may strengthen with the rate [-]
    #[serde(default)]
    pub a: f64,
    /// V₀: slip rate from which on the direct effect grows, V₀ > 0; needed with `a` alone [L/T]
    #[serde(default, rename = "V_0")]
    pub reference_rate: Option<f64>,
    /// 1/R*₀: structure at first contact, from 1 (μ = μ_k) to μ_s/μ_k (μ = μ_s, the default) [-]
    #[serde(default)]
    pub structure: Option<f64>,
    /// U(R): approach of R to 1
    #[serde(default)]
    pub approach: Approach,
    /// R_e: elastic core, no plastic slip for R ≤ R_e, 0 ≤ R_e < 1 [-]
    #[serde(default)]
    pub elastic_core: f64,
    /// Integration of an increment
    #[serde(default)]
    pub integration: Integration,
    /// Error tolerance of the controlled integration, as a fraction of μ_s p, from 1e-12 to 0.1; 1e-6 by default [-]
    #[serde(default)]
    pub tolerance: Option<f64>,
}

numbers!(SuperSubloadingParameters: "mu_s" mu_s, "mu_k" mu_k, "r" r, "kappa" kappa, "xi" xi, "m" m, "n" n, "elastic_core" elastic_core, "a" a; "alpha_t" alpha_t, "structure" structure, "V_0" reference_rate, "tolerance" tolerance);

impl SuperSubloadingParameters {
    /// Parameters with derivatives of the responses; the last two are those of the direct effect.
    pub(super) const VARYING: &'static [&'static str] =
        &["mu_s", "mu_k", "r", "kappa", "xi", "m", "n", "elastic_core", "alpha_t", "structure", "a", "V_0"];

    /// The direct effect of the rate, unless a = 0.
    fn direct_effect(&self) -> Result<Option<DirectEffect>, InvalidParameter> {
        let Self { a, reference_rate, .. } = *self;
        require_not_negative("a", a)?;
        reference_rate.map_or(Ok(()), |rate| require_positive("V_0", rate))?;
        match reference_rate {
            _ if a == 0.0 => Ok(None),
            Some(reference_rate) => Ok(Some(DirectEffect { a, reference_rate })),
            None => {
                let allowed = "\"V_0\", the slip rate above which it grows, is missing: give it as well".into();
                Err(InvalidParameter { name: "a", value: a, allowed })
            }
        }
    }

    /// Creates parameters without weakening and recovery, with the default tangential stiffness and the defaults of a case.
    pub const fn new(mu_s: f64, mu_k: f64, r: f64) -> Self {
        Self {
            mu_s,
            mu_k,
            alpha_t: None,
            r,
            kappa: 0.0,
            xi: 0.0,
            m: 1.0,
            n: 1.0,
            a: 0.0,
            reference_rate: None,
            structure: None,
            approach: Approach::Logarithmic,
            elastic_core: 0.0,
            integration: Integration::Controlled,
            tolerance: None,
        }
    }
}

setters! { const law: SuperSubloadingParameters;
    /// Sets the rate κ of weakening with slip [1/L].
    kappa(kappa: f64) { law.kappa = kappa; }

    /// Sets the rate ξ of recovery in stationary contact [1/T].
    xi(xi: f64) { law.xi = xi; }

    /// Sets the exponents of weakening and recovery [-].
    exponents(m: f64, n: f64) { law.m = m; law.n = n; }

    /// Sets the direct effect a of the rate of plastic slip [-], and the rate V₀ from which on it grows [L/T].
    rate_effect(a: f64, reference_rate: f64) { law.a = a; law.reference_rate = Some(reference_rate); }

    /// Sets the initial structure 1/R* [-].
    structure(structure: f64) { law.structure = Some(structure); }

    /// Sets the approach to full sliding.
    approach(approach: Approach) { law.approach = approach; }

    /// Sets the elastic core R_e [-].
    elastic_core(elastic_core: f64) { law.elastic_core = elastic_core; }

    /// Sets the integration of an increment.
    integration(integration: Integration) { law.integration = integration; }

    /// Sets the tolerance of the controlled integration [-].
    tolerance(tolerance: f64) { law.tolerance = Some(tolerance); }

    /// Sets the tangential stiffness α_t [F/L³].
    alpha_t(alpha_t: f64) { law.alpha_t = Some(alpha_t); }
}
