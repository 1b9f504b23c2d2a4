use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::relaxation::{Coefficients, Relaxation, StateEvolution, arsinh_of_exp};
use super::yielding::traction_at_yield;
use super::{Answer, FrictionLaw, FrictionResponse, FrictionState, LEAST_SLOPE, Regime, Sliding};
use crate::laws::parameter::{InvalidParameter, require_not_negative, require_positive};

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

/// Rate-and-state friction on an elastic contact, regularized: finite at every slip rate V of either sign.
///
/// ```text
/// q̇ = α_t (v − λ sgn q),   V = λ                                    slip = elastic + plastic              (1)
/// |q| = a p arsinh(V/(2 V₀) exp(ψ/a)),   ψ = f₀ + b ln(V₀ θ/D_c)      ≈ p (ψ + a ln(V/V₀))                  (2)
/// θ̇ = 1 − V θ/D_c   or   θ̇ = −(V θ/D_c) ln(V θ/D_c)                                                       (3)
/// ```
/// The law remembers θ. V₀ only says at which rate f₀ is measured: with f₀ + (a − b) ln(V₁/V₀) and V₁ in their place, and the
/// same θ, friction is the same. The μ that is shown is ψ, the coefficient at V₀, and R = |q|/(ψ p) is 1 at V₀.
///
/// There is plastic slip whenever there is traction. A point *slips* where this outweighs ageing, V θ/D_c ≥ ½: in (3), where
/// it takes from θ half of what time adds, or more. Steady sliding has V θ/D_c = 1 at every rate, a locked interface next
/// to nothing, one that accelerates more than 1.
///
/// An increment takes V = Δλ/Δt as constant, for which (3) is integrated exactly: with x = Δλ/D_c
/// ```text
/// θ₁ = θ₀ e⁻ˣ + Δt (1 − e⁻ˣ)/x                  ageing law                                                   (4)
/// ln θ₁ = e⁻ˣ ln θ₀ + (1 − e⁻ˣ) ln(D_c/V)        slip law                                                    (5)
/// ```
/// and Δλ is the *smallest* root of G(Δλ) = |q_tr| − α_t Δλ − |q|(Δλ) with |q| from (2) at the end of the increment. G is
/// positive at Δλ = 0 and negative at |q_tr|/α_t. Where α_t exceeds the weakening by slip, G falls throughout; else bounds
/// of its slope single out the first root. The method is of first order in Δt.
///
/// The work dissipated is ∫ |q| dλ = ½ (q_y + |q|) Δλ with slip at the rate V once the traction, elastic until then, has
/// met at q_y what (2) asks for V; that goes evenly from its value at the start to |q|.
///
/// # Errors
/// [`LawFailure`](super::LawFailure) when the increment or the answer is not finite, or time goes backwards.
///
/// Source: Dieterich (1979), J. Geophys. Res. 84, 2161; Ruina (1983), J. Geophys. Res. 88, 10359; Rice & Ben-Zion (1996),
/// PNAS 93, 3811 (the regularized form).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateAndState {
    coefficients: Coefficients,
    initial_theta: f64,
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
        let coefficients = Coefficients { f_0, reference_rate, a, b, critical_slip, evolution, alpha_t };
        Ok(Self { coefficients, initial_theta: theta })
    }

    /// Whether slip at the end of an increment outweighs ageing, V θ/D_c ≥ ½.
    fn slips(&self, slip: f64, theta: f64, dt: f64) -> bool {
        slip * theta >= OUTWEIGHS * self.coefficients.critical_slip * dt
    }
}

/// V θ/D_c from which a point slips.
const OUTWEIGHS: f64 = 0.5;

impl FrictionLaw for RateAndState {
    fn initial_state(&self) -> FrictionState {
        FrictionState::default().with_variables([self.initial_theta])
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let law = &self.coefficients;
        let alpha_t = law.alpha_t;
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        let trial = old.traction + alpha_t * slip;
        let log_state = law.log_state(old.variables[0]);
        let relaxation = Relaxation { law, trial: trial.abs(), pressure, dt, log_state };
        if dt == 0.0 || pressure <= 0.0 || trial == 0.0 {
            // No time to slip in, or nothing to slip for.
            let aged = |theta| if dt == 0.0 { theta } else { law.theta(relaxation.log_state_after(0.0).0) };
            let old = old.with_variables([aged(old.variables[0])]);
            if pressure <= 0.0 {
                return FrictionResponse::elastic(old.parted(alpha_t), 0.0).checked(alpha_t);
            }
            let softness =
                if dt == 0.0 { 0.0 } else { alpha_t / relaxation.outcome(0.0).slope.max(LEAST_SLOPE * alpha_t) };
            return FrictionResponse::elastic(old.stuck(trial, pressure), alpha_t * (1.0 - softness)).checked(alpha_t);
        }
        let (found, evaluations) = relaxation.solve()?;
        let traction = trial.signum() * found.traction.min(trial.abs());
        // What (2) asks at the start for the slip rate of the increment
        let rate_share = (trial.abs() - traction.abs()) / alpha_t / (2.0 * law.reference_rate * dt);
        let before = law.a * old.pressure * arsinh_of_exp(rate_share.ln() + law.psi(log_state) / law.a).0;
        let elastic = [trial.signum() * old.traction, trial.abs()];
        let mean = 0.5 * (traction_at_yield(elastic, [before, traction.abs()]) + traction.abs());
        let softness = alpha_t / found.slope.max(LEAST_SLOPE * alpha_t);
        let theta = law.theta(found.log_state);
        let state = old.slid(trial, traction, mean, pressure, alpha_t).with_variables([theta]);
        let slips = self.slips(state.plastic_increment.abs(), theta, dt);
        FrictionResponse {
            state: FrictionState { regime: if slips { Regime::Slip } else { Regime::Stick }, ..state },
            dtraction_dslip: alpha_t * (1.0 - softness),
            dtraction_dpressure: traction / pressure * softness,
            evaluations,
            ..Default::default()
        }
        .checked(alpha_t)
    }

    fn stiffness(&self) -> f64 {
        self.coefficients.alpha_t
    }

    fn variables(&self) -> &'static [&'static str] {
        &["theta"]
    }

    fn observables(&self) -> &'static [&'static str] {
        &["R", "mu", "theta"]
    }

    fn observe(&self, name: &str, state: &FrictionState) -> Option<f64> {
        let psi = || self.coefficients.psi(self.coefficients.log_state(state.variables[0]));
        match name {
            "R" => Some(state.ratio(psi())),
            "mu" => Some(psi()),
            "theta" => Some(state.variables[0]),
            _ => None,
        }
    }
}
