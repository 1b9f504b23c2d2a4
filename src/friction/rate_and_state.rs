use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::root::{Trial, bracketed_root};
use super::{FrictionLaw, FrictionResponse, FrictionState, LawFailure, Sliding, traction_at_yield};
use crate::parameter::{InvalidParameter, require_not_negative, require_positive};

/// Parameters of [`RateAndState`] as the case file writes them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RateAndStateParameters {
    /// f₀: friction coefficient in steady sliding at V₀, f₀ > 0 [-]
    pub f_0: f64,
    /// V₀: reference slip rate, V₀ > 0 [L/T]
    #[serde(rename = "V_0")]
    pub reference_rate: f64,
    /// a: direct effect of the slip rate, a > 0 [-]
    pub a: f64,
    /// b: effect of the state, b ≥ 0; steady sliding weakens with the rate where b > a [-]
    pub b: f64,
    /// D_c: slip over which the state evolves, D_c > 0 [L]
    #[serde(rename = "D_c")]
    pub critical_slip: f64,
    /// How the state evolves
    #[serde(default)]
    pub evolution: StateEvolution,
    /// θ: state at the start, θ > 0; D_c/V₀, steady sliding at V₀, unless given [T]
    #[serde(default)]
    pub theta: Option<f64>,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
}

/// Evolution of the state θ of [`RateAndState`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StateEvolution {
    /// Ageing law, θ̇ = 1 − V θ/D_c: heals at rest
    #[default]
    Ageing,
    /// Slip law, θ̇ = −(V θ/D_c) ln(V θ/D_c): evolves by slip alone
    Slip,
}

/// Rate-and-state friction on an elastic contact, regularized: finite at every slip rate V of either sign.
///
/// ```text
/// q̇ = α_t (v − λ sgn q),   V = λ                                    slip = elastic + plastic              (1)
/// |q| = a p arsinh(V/(2 V₀) exp(ψ/a)),   ψ = f₀ + b ln(V₀ θ/D_c)      ≈ p (ψ + a ln(V/V₀))                  (2)
/// θ̇ = 1 − V θ/D_c   or   θ̇ = −(V θ/D_c) ln(V θ/D_c)                                                       (3)
/// ```
/// The committed coefficient μ is ψ, the coefficient of friction at V₀; so R = |q|/(ψ p) tells how fast a point slips,
/// R = 1 at V₀, and there is plastic slip whenever there is traction.
///
/// An increment takes V = Δλ/Δt as constant, for which (3) is integrated exactly: with x = Δλ/D_c
/// ```text
/// θ₁ = θ₀ e⁻ˣ + Δt (1 − e⁻ˣ)/x                  ageing law                                                   (4)
/// ln θ₁ = e⁻ˣ ln θ₀ + (1 − e⁻ˣ) ln(D_c/V)        slip law                                                    (5)
/// ```
/// and Δλ is the *smallest* root of G(Δλ) = |q_tr| − α_t Δλ − |q|(Δλ) with |q| from (2) at the end of the increment. G is
/// positive at Δλ = 0 and negative at |q_tr|/α_t. Where α_t exceeds the weakening by slip, G falls throughout; else ln Δλ
/// is led up to the first root by bounds of the slope, and never over it. The method is of first order in Δt.
///
/// The work dissipated is ∫ |q| dλ = ½ (q_y + |q|) Δλ with slip at the rate V once the traction, elastic until then, has
/// met at q_y what (2) asks for V; that goes evenly from its value at the start to |q|.
///
/// # Errors
/// [`LawFailure`] when the increment or the answer is not finite, or time goes backwards.
///
/// Source: Dieterich (1979), J. Geophys. Res. 84, 2161; Ruina (1983), J. Geophys. Res. 88, 10359; Rice & Ben-Zion (1996),
/// PNAS 93, 3811 (the regularized form).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateAndState {
    f_0: f64,
    reference_rate: f64,
    a: f64,
    b: f64,
    critical_slip: f64,
    evolution: StateEvolution,
    initial_mu: f64,
    alpha_t: f64,
}

impl RateAndState {
    /// The law with its parameters checked; `default_alpha_t` serves where they give no `alpha_t`.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a parameter is out of its range.
    pub fn new(parameters: &RateAndStateParameters, default_alpha_t: f64) -> Result<Self, InvalidParameter> {
        let RateAndStateParameters { f_0, reference_rate, a, b, critical_slip, evolution, .. } = *parameters;
        let alpha_t = parameters.alpha_t.unwrap_or(default_alpha_t);
        require_positive("f_0", f_0)?;
        require_positive("V_0", reference_rate)?;
        require_positive("a", a)?;
        require_not_negative("b", b)?;
        require_positive("D_c", critical_slip)?;
        require_positive("alpha_t", alpha_t)?;
        let theta = parameters.theta.unwrap_or(critical_slip / reference_rate);
        require_positive("theta", theta)?;
        let initial_mu = f_0 + b * (reference_rate * theta / critical_slip).ln();
        Ok(Self { f_0, reference_rate, a, b, critical_slip, evolution, initial_mu, alpha_t })
    }

    /// ln(V₀ θ/D_c) of a committed ψ; without an effect of the state it does not matter.
    fn log_state(&self, psi: f64) -> f64 {
        if self.b > 0.0 { (psi - self.f_0) / self.b } else { 0.0 }
    }
}

/// G is right to this share of |q_tr|.
const PRECISION: f64 = 1e-14;

/// Most evaluations that lead up to the first root. The way is only long where two roots are about to merge.
const MOST_EVALUATIONS: usize = 500;

/// Exponents above it would overflow.
const MOST_EXPONENT: f64 = 700.0;

/// One increment with a traction to relax: G over Δλ.
struct Relaxation<'a> {
    law: &'a RateAndState,
    /// |q_tr| > 0
    trial: f64,
    pressure: f64,
    /// Δt > 0
    dt: f64,
    /// ln(V₀ θ₀/D_c)
    log_state: f64,
}

/// What an increment comes to if it slips by Δλ.
#[derive(Clone, Copy)]
struct Outcome {
    /// G [F/L²]
    excess: f64,
    /// −∂G/∂Δλ [F/L³]
    slope: f64,
    /// ψ at the end
    psi: f64,
    /// |q| of (2) [F/L²]
    traction: f64,
}

impl Relaxation<'_> {
    /// ψ at the end after Δλ, and ∂ψ/∂Δλ.
    fn psi(&self, slip: f64) -> (f64, f64) {
        let RateAndState { f_0, b, reference_rate, critical_slip, evolution, .. } = *self.law;
        let x = slip / critical_slip;
        let decay = (-x).exp();
        // (1 − e⁻ˣ)/x and its derivative
        let share = if x > 0.0 { -(-x).exp_m1() / x } else { 1.0 };
        let dshare = if x > 1e-4 { (decay - share) / x } else { -0.5 + x / 3.0 };
        let (log, dlog) = match evolution {
            StateEvolution::Ageing => {
                let time = self.dt * reference_rate / critical_slip;
                let grown = self.log_state.exp() * decay;
                let state = grown + time * share;
                (state.ln(), (time * dshare - grown) / state)
            }
            StateEvolution::Slip if slip == 0.0 => (self.log_state, 0.0),
            StateEvolution::Slip => {
                let steady = (reference_rate * self.dt).ln() - slip.ln();
                let log = self.log_state * decay + steady * x * share;
                (log, decay * (steady - self.log_state) - share)
            }
        };
        (f_0 + b * log, b * dlog / critical_slip)
    }

    fn outcome(&self, slip: f64) -> Outcome {
        let RateAndState { a, reference_rate, alpha_t, .. } = *self.law;
        let (psi, dpsi) = self.psi(slip);
        let fastness = 0.5 / (reference_rate * self.dt);
        let w = slip.ln() + fastness.ln() + psi / a;
        let (arsinh, rate) = arsinh_of_exp(w);
        let traction = a * self.pressure * arsinh;
        let direct = if slip > 0.0 { rate / slip } else { fastness * (psi / a).exp() };
        let slope = alpha_t + self.pressure * (a * direct + rate * dpsi);
        Outcome { excess: self.trial - alpha_t * slip - traction, slope, psi, traction }
    }

    /// Bound of Δλ ∂ψ/∂Δλ for all slips up to this one: healing within the increment, of which the slip law knows some.
    /// With y = V θ₀/D_c it is x ln(1/y), which rises up to y = 1/e.
    fn healing(&self, slip: f64) -> f64 {
        let RateAndState { b, reference_rate, critical_slip, evolution, .. } = *self.law;
        if evolution == StateEvolution::Ageing {
            return 0.0;
        }
        let log_y = slip.ln() - (reference_rate * self.dt).ln() + self.log_state;
        let at = log_y.min(-1.0);
        b * self.dt * reference_rate / critical_slip * -at * (at - self.log_state).min(MOST_EXPONENT).exp()
    }

    /// The same from a slip to e times as much.
    fn healing_from(&self, slip: f64) -> f64 {
        let RateAndState { b, reference_rate, critical_slip, evolution, .. } = *self.law;
        if evolution == StateEvolution::Ageing {
            return 0.0;
        }
        let x = slip / critical_slip;
        let slower = ((reference_rate * self.dt).ln() - slip.ln() - self.log_state).max(0.0);
        // x e⁻ˣ has its maximum at 1.
        let share = if x >= 1.0 { x * (-x).exp() } else { (x * std::f64::consts::E).min((-1.0f64).exp()) };
        b * share * slower
    }

    /// Whether G falls throughout.
    fn is_monotone(&self) -> bool {
        let RateAndState { b, reference_rate, critical_slip, alpha_t, evolution, .. } = *self.law;
        let fastest = match evolution {
            StateEvolution::Ageing => 0.0,
            StateEvolution::Slip => (self.trial / (alpha_t * reference_rate * self.dt)).ln() + self.log_state,
        };
        alpha_t > self.pressure * b / critical_slip * (1.0 + fastest.max(0.0))
    }

    /// A slip that is surely not beyond the first root: neither the contact nor (2) takes more than half of |q_tr|.
    fn least(&self) -> f64 {
        let RateAndState { a, reference_rate, alpha_t, .. } = *self.law;
        let half = 0.5 * self.trial;
        let level = half / (a * self.pressure);
        let log_sinh = if level > 20.0 { level - std::f64::consts::LN_2 } else { level.sinh().ln() };
        let psi = self.psi(0.0).0;
        let reached = |healing: f64| {
            let log = (2.0 * reference_rate * self.dt).ln() - (psi + healing) / a + log_sinh;
            log.min((half / alpha_t).ln())
        };
        // Healing up to a slip rises with the slip: halve towards the largest that still holds.
        let (mut low, mut high) = (f64::MIN_POSITIVE.ln(), reached(0.0));
        while high - low > 1.0 {
            let middle = 0.5 * (low + high);
            let holds = reached(self.healing(middle.exp())) >= middle;
            if holds { low = middle } else { high = middle }
        }
        low.exp()
    }

    /// The smallest root, and the evaluations it took.
    fn solve(&self) -> (Outcome, usize) {
        let alpha_t = self.law.alpha_t;
        let mut evaluations = 0;
        let mut slip = self.least().max(f64::MIN_POSITIVE);
        let mut found = self.outcome(slip);
        let enough = PRECISION * self.trial;
        let most = self.trial / alpha_t;
        if self.is_monotone() {
            // In ln Δλ, by which (2) is nearly linear.
            let bracket = (slip.ln(), most.ln());
            bracketed_root(bracket, bracket.0, |log| {
                evaluations += 1;
                slip = log.exp();
                found = self.outcome(slip);
                let step = found.excess / (found.slope * slip).max(f64::MIN_POSITIVE);
                Trial { value: found.excess, step, done: found.excess.abs() <= enough }
            });
            return (found, evaluations);
        }
        let RateAndState { a, alpha_t, .. } = *self.law;
        let rise = self.pressure * (a + self.healing(most));
        while found.excess > enough && evaluations < MOST_EVALUATIONS {
            // From Δλ to Δλ eᵟ, α_t Δλ grows by the factor eᵟ, and |q| at most by rise δ and by a factor kᵟ, since
            // arsinh is concave. So three δ after which G is not negative, the first two for δ ≤ 1:
            let healing = self.healing_from(slip);
            let loss = alpha_t * slip * std::f64::consts::E + self.pressure * (a + healing);
            let near = (found.excess / loss).min(1.0);
            let early = (self.trial / (self.trial - found.excess)).ln() / (1.0 + healing / a);
            let far = (0.5 * found.excess / rise).min((0.5 * found.excess / (alpha_t * slip)).ln_1p());
            slip = (slip * near.max(early.min(1.0)).max(far).exp()).min(most);
            found = self.outcome(slip);
            evaluations += 1;
        }
        (found, evaluations)
    }
}

/// arsinh(eʷ) and its derivative by w, without eʷ where it would overflow.
fn arsinh_of_exp(w: f64) -> (f64, f64) {
    if w > 20.0 {
        return (w + std::f64::consts::LN_2, 1.0);
    }
    let sinh = w.exp();
    (sinh.asinh(), sinh / sinh.hypot(1.0))
}

impl FrictionLaw for RateAndState {
    fn initial_state(&self) -> FrictionState {
        FrictionState { mu: self.initial_mu, ..FrictionState::default() }
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Result<FrictionResponse, LawFailure> {
        let alpha_t = self.alpha_t;
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        let trial = old.traction + alpha_t * slip;
        let relaxation = Relaxation { law: self, trial: trial.abs(), pressure, dt, log_state: self.log_state(old.mu) };
        if dt == 0.0 || pressure <= 0.0 || trial == 0.0 {
            // No time to slip in, or nothing to slip for.
            let mu = if dt == 0.0 { old.mu } else { relaxation.psi(0.0).0 };
            if pressure <= 0.0 {
                return FrictionResponse::elastic(old.parted(mu, alpha_t), 0.0).checked();
            }
            let softness = if dt == 0.0 { 0.0 } else { alpha_t / relaxation.outcome(0.0).slope };
            return FrictionResponse::elastic(old.stuck(trial, pressure, mu), alpha_t * (1.0 - softness)).checked();
        }
        let (found, evaluations) = relaxation.solve();
        let traction = trial.signum() * found.traction.min(trial.abs());
        // What (2) asks at the start for the slip rate of the increment
        let rate_share = (trial.abs() - traction.abs()) / alpha_t / (2.0 * self.reference_rate * dt);
        let before = self.a * old.pressure * arsinh_of_exp(rate_share.ln() + old.mu / self.a).0;
        let elastic = [trial.signum() * old.traction, trial.abs()];
        let mean = 0.5 * (traction_at_yield(elastic, [before, traction.abs()]) + traction.abs());
        let softness = alpha_t / found.slope;
        FrictionResponse {
            state: old.slid(trial, traction, mean, (pressure, found.psi), alpha_t),
            dtraction_dslip: alpha_t * (1.0 - softness),
            dtraction_dpressure: traction / pressure * softness,
            evaluations,
        }
        .checked()
    }

    fn stiffness(&self) -> f64 {
        self.alpha_t
    }

    fn structure(&self, _mu: f64) -> f64 {
        1.0
    }

    fn starting_limit(&self, _pressure: f64) -> f64 {
        f64::INFINITY
    }

    fn uniqueness_limit(&self) -> Option<f64> {
        None
    }
}
