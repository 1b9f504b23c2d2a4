//! Rate-and-state friction: the law, its increments of first order (`relaxation.rs`) and their error-controlled integration
//! along prescribed paths (`path.rs`).
mod path;
mod relaxation;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::sensitivity::{Direction, Inputs, SensitiveLaw, Variation, variations};
use super::{
    Answer, Description, FrictionLaw, FrictionResponse, FrictionState, LEAST_SLOPE, LawFailure, PointLoad, RateLaw,
    Regime, Sliding, traction_at_yield,
};
use crate::laws::parameter::{InvalidParameter, numbers, require, require_positive};
use path::{PathState, Ramp};
pub use relaxation::StateEvolution;
use relaxation::{Coefficients, Relaxation, arsinh_of_exp};

/// Parameters of [`RateAndState`] as in the case file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct RateAndStateParameters {
    /// f₀: friction coefficient in steady sliding at V₀, f₀ > 0 [-]
    pub f_0: f64,
    /// V₀: reference slip rate, V₀ > 0 [L/T]
    #[serde(rename = "V_0")]
    pub reference_rate: f64,
    /// a: direct effect of the slip rate, a > 0 [-]
    pub a: f64,
    /// b: effect of the state; steady sliding weakens with the rate where b > a, and where b < 0 slip strengthens [-]
    pub b: f64,
    /// D_c: slip over which the state evolves, D_c > 0 [L]
    #[serde(rename = "D_c")]
    pub critical_slip: f64,
    /// Evolution law of the state
    #[serde(default)]
    pub evolution: StateEvolution,
    /// θ: state at the start, θ > 0; default D_c/V₀, steady sliding at V₀ [T]
    #[serde(default)]
    pub theta: Option<f64>,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
}

impl RateAndStateParameters {
    /// Creates parameters with the ageing law, initially in steady sliding at the reference rate, and the default tangential
    /// stiffness.
    pub const fn new(f_0: f64, reference_rate: f64, a: f64, b: f64, critical_slip: f64) -> Self {
        let evolution = StateEvolution::Ageing;
        Self { f_0, reference_rate, a, b, critical_slip, evolution, theta: None, alpha_t: None }
    }

    /// Sets the evolution law of the state.
    pub const fn evolution(self, evolution: StateEvolution) -> Self {
        Self { evolution, ..self }
    }

    /// Sets the initial state θ [T].
    pub const fn theta(self, theta: f64) -> Self {
        Self { theta: Some(theta), ..self }
    }

    /// Sets the tangential stiffness α_t [F/L³].
    pub const fn alpha_t(self, alpha_t: f64) -> Self {
        Self { alpha_t: Some(alpha_t), ..self }
    }
}

numbers!(
    RateAndStateParameters: "f_0" f_0, "V_0" reference_rate, "a" a, "b" b, "D_c" critical_slip; "alpha_t" alpha_t, "theta" theta
);

/// Rate-and-state friction on an elastic contact, regularized: finite at every slip rate V of either sign.
///
/// ```text
/// q̇ = α_t (v − λ sgn q),   V = λ                                    slip = elastic + plastic              (1)
/// |q| = a p arsinh(V/(2 V₀) exp(ψ/a)),   ψ = f₀ + b ln(V₀ θ/D_c)      ≈ p (ψ + a ln(V/V₀))                  (2)
/// θ̇ = 1 − V θ/D_c   or   θ̇ = −(V θ/D_c) ln(V θ/D_c)                                                       (3)
/// ```
/// The internal variable is θ. V₀ is only the rate to which f₀ refers: with f₀ + (a − b) ln(V₁/V₀) and V₁ in their place, and
/// the same θ, friction is the same. The observable μ is ψ, the coefficient at V₀, and R = |q|/(ψ p) is 1 at V₀.
///
/// Plastic slip occurs whenever there is traction. A point *slips* where slip outweighs ageing, V θ/D_c ≥ ½: in (3), where it
/// reduces θ by at least half of the increase with time. Steady sliding has V θ/D_c = 1 at every rate, a locked interface
/// almost 0, an accelerating one more than 1.
///
/// In an increment V = Δλ/Δt is taken as constant, for which (3) is integrated exactly: with x = Δλ/D_c
/// ```text
/// θ₁ = θ₀ e⁻ˣ + Δt (1 − e⁻ˣ)/x                  ageing law                                                   (4)
/// ln θ₁ = e⁻ˣ ln θ₀ + (1 − e⁻ˣ) ln(D_c/V)        slip law                                                    (5)
/// ```
/// and Δλ is the *smallest* root of G(Δλ) = |q_tr| − α_t Δλ − |q|(Δλ) with |q| from (2) at the end of the increment. G is
/// positive at Δλ = 0 and negative at |q_tr|/α_t. Where α_t exceeds the weakening with slip, G decreases monotonically;
/// otherwise bounds of its slope isolate the first root. The method is of first order in Δt: increments whose slip is not known to a
/// small fraction of D_c damp an instability away, and are controlled by default ([`Description::critical_slip`]). Along
/// [prescribed](FrictionLaw::controlled) paths, sub-steps of an increment, linear in slip and pressure, are extrapolated from
/// such responses and halved until their error is below 1e-6 f₀ p in q, and 1e-6 f₀ in (a + b) ln θ.
///
/// The work dissipated is ∫ |q| dλ = ½ (q_y + |q|) Δλ with slip at the rate V after the traction, elastic until then, has
/// reached at q_y the strength (2) at V; this varies linearly from its value at the start to |q|.
///
/// # Errors
/// Returns [`LawFailure`](super::LawFailure) if the increment or the response is not finite, or Δt is negative.
///
/// Source: Dieterich (1979), J. Geophys. Res. 84, 2161; Ruina (1983), J. Geophys. Res. 88, 10359; Rice & Ben-Zion (1996),
/// PNAS 93, 3811 (the regularized form).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateAndState {
    coefficients: Coefficients,
    initial_theta: f64,
    /// Whether the initial θ is given, instead of D_c/V₀.
    has_theta: bool,
    /// Whether the error of an increment is controlled.
    is_controlled: bool,
}

impl RateAndState {
    /// Creates the law from checked parameters; `default_alpha_t` is used if they do not specify `alpha_t`.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] if a parameter is out of range.
    pub fn new(parameters: &RateAndStateParameters, default_alpha_t: f64) -> Result<Self, InvalidParameter> {
        let RateAndStateParameters { f_0, reference_rate, a, b, critical_slip, evolution, .. } = *parameters;
        let alpha_t = parameters.alpha_t.unwrap_or(default_alpha_t);
        require_positive("f_0", f_0)?;
        require_positive("V_0", reference_rate)?;
        require_positive("a", a)?;
        require("b", b, true, "it must be finite")?;
        require_positive("D_c", critical_slip)?;
        require_positive("alpha_t", alpha_t)?;
        let theta = parameters.theta.unwrap_or(critical_slip / reference_rate);
        require_positive("theta", theta)?;
        let coefficients = Coefficients { f_0, reference_rate, a, b, critical_slip, evolution, alpha_t };
        Ok(Self { coefficients, initial_theta: theta, has_theta: parameters.theta.is_some(), is_controlled: false })
    }

    /// Whether slip at the end of an increment outweighs ageing, V θ/D_c ≥ ½.
    fn slips(&self, slip: f64, theta: f64, dt: f64) -> bool {
        slip * theta >= OUTWEIGHS * self.coefficients.critical_slip * dt
    }

    /// One increment of first order, with the slip that solves its equation if there is one.
    fn relax(&self, old: &FrictionState, sliding: Sliding) -> Result<(FrictionResponse, Option<f64>), LawFailure> {
        let law = &self.coefficients;
        let alpha_t = law.alpha_t;
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        let trial = old.traction + alpha_t * slip;
        if !trial.is_finite() {
            return Err(LawFailure::Overflow { traction: trial });
        }
        let log_state = law.log_state(old.variables[0]);
        let relaxation = Relaxation { law, trial: trial.abs(), pressure, dt, log_state };
        if dt == 0.0 || pressure <= 0.0 || trial == 0.0 {
            // No slip, for zero time or zero traction.
            let aged = |theta| if dt == 0.0 { theta } else { law.theta(relaxation.log_state_after(0.0).0) };
            let old = old.clone().with_variables([aged(old.variables[0])]);
            if pressure <= 0.0 {
                return Ok((FrictionResponse::elastic(old.parted(alpha_t), 0.0).checked(alpha_t)?, None));
            }
            let softness =
                if dt == 0.0 { 0.0 } else { alpha_t / relaxation.outcome(0.0).slope.max(LEAST_SLOPE * alpha_t) };
            let stuck = FrictionResponse::elastic(old.stuck(trial, pressure), alpha_t * (1.0 - softness));
            return Ok((stuck.checked(alpha_t)?, None));
        }
        let (found, evaluations) = relaxation.solve()?;
        let traction = trial.signum() * found.traction.min(trial.abs());
        // Strength (2) at the start for the slip rate of the increment
        let rate_share = (trial.abs() - traction.abs()) / alpha_t / (2.0 * law.reference_rate * dt);
        let before = law.a * old.pressure * arsinh_of_exp(rate_share.ln() + law.psi(log_state) / law.a).0;
        let elastic = [trial.signum() * old.traction, trial.abs()];
        let mean = 0.5 * (traction_at_yield(elastic, [before, traction.abs()]) + traction.abs());
        let softness = alpha_t / found.slope.max(LEAST_SLOPE * alpha_t);
        let theta = law.theta(found.log_state);
        let state = old.slid(trial, traction, mean, pressure, alpha_t).with_variables([theta]);
        let slips = self.slips(state.plastic_increment.abs(), theta, dt);
        let response = FrictionResponse {
            state: FrictionState { regime: if slips { Regime::Slip } else { Regime::Stick }, ..state },
            dtraction_dslip: alpha_t * (1.0 - softness),
            dtraction_dpressure: traction / pressure * softness,
            evaluations,
            ..Default::default()
        };
        Ok((response.checked(alpha_t)?, Some(found.slip)))
    }
}

/// V θ/D_c above which a point counts as slipping.
const OUTWEIGHS: f64 = 0.5;

/// x = ln(V₀ θ/D_c), ψ = f₀ + b x.
///
/// ```text
/// a p z + 2 V₀ η e^(−ψ/a) sinh z = |τ|,   V = 2 V₀ e^(−ψ/a) sinh z          rising and convex in z = |q|/(a p)
/// ẋ = (V₀ e⁻ˣ − V)/D_c   or   ẋ = −V/D_c (x + ln(V/V₀))
/// ```
impl RateLaw for RateAndState {
    fn slip_rate(&self, x: f64, PointLoad { traction, pressure, damping }: PointLoad) -> f64 {
        let Coefficients { a, reference_rate, .. } = self.coefficients;
        if traction == 0.0 {
            return 0.0;
        }
        let exponent = self.coefficients.psi(x) / a;
        // V divided by |τ|/η, as a function of z, and the fraction of the traction carried by friction
        let log_share = (2.0 * reference_rate * damping / traction.abs()).ln() - exponent;
        let friction = a * pressure / traction.abs();
        let sinh = |z: f64| {
            if z > LARGE { 0.5 * (z + log_share).exp() } else { z.sinh() * log_share.exp() }
        };
        let cosh = |z: f64| {
            if z > LARGE { 0.5 * (z + log_share).exp() } else { z.cosh() * log_share.exp() }
        };
        // Each term alone bounds z from above, from where Newton's method decreases monotonically to the root.
        let mut z = arsinh_of_exp(-log_share).0.min(1.0 / friction);
        for _ in 0..MOST_STEPS {
            let step = (friction * z + sinh(z) - 1.0) / (friction + cosh(z));
            z -= step;
            if step.abs() <= f64::EPSILON * z {
                break;
            }
        }
        let rate = if z > LARGE {
            reference_rate * (z - exponent).exp()
        } else {
            2.0 * reference_rate * z.sinh() * (-exponent).exp()
        };
        traction.signum() * rate
    }

    fn evolution(&self, x: f64, slip_rate: f64) -> f64 {
        let Coefficients { reference_rate, critical_slip, evolution, .. } = self.coefficients;
        let rate = slip_rate.abs();
        match evolution {
            StateEvolution::Ageing => (reference_rate * (-x).exp() - rate) / critical_slip,
            StateEvolution::Slip if rate == 0.0 => 0.0,
            StateEvolution::Slip => -rate / critical_slip * (x + (rate / reference_rate).ln()),
        }
    }

    fn evolving(&self, state: &FrictionState) -> f64 {
        self.coefficients.log_state(state.variables[0])
    }

    fn remember(&self, x: f64, state: FrictionState) -> FrictionState {
        state.with_variables([self.coefficients.theta(x)])
    }

    fn weight(&self) -> f64 {
        self.coefficients.b.abs()
    }

    fn regime(&self, x: f64, slip_rate: f64) -> Regime {
        let theta = self.coefficients.theta(x);
        let slips = slip_rate.abs() * theta >= OUTWEIGHS * self.coefficients.critical_slip;
        if slips { Regime::Slip } else { Regime::Stick }
    }
}

/// z above which sinh z equals ½ eᶻ.
const LARGE: f64 = 20.0;

/// Maximum number of Newton steps, never reached because of quadratic convergence.
const MOST_STEPS: usize = 60;

impl FrictionLaw for RateAndState {
    fn description(&self) -> Description {
        Description {
            stiffness: self.coefficients.alpha_t,
            variables: &["theta"],
            observables: Some(&["R", "mu", "theta"]),
            weakening: self.coefficients.b.max(0.0) / self.coefficients.critical_slip,
            // d(|q|/p)/dΔλ ≥ a/Δλ − b/D_c by (2) to (5)
            unique_slip: self.coefficients.a / self.coefficients.b.max(0.0) * self.coefficients.critical_slip,
            critical_slip: Some(self.coefficients.critical_slip),
            ..Description::default()
        }
    }

    fn initial_state(&self, pressure: f64, traction: f64) -> FrictionState {
        FrictionState::default().with_variables([self.initial_theta]).loaded(pressure, traction)
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        if !self.is_controlled || sliding.checked()?.dt == 0.0 {
            return Ok(self.relax(old, sliding)?.0);
        }
        Ramp::new(self, old, Inputs::new(old, sliding, Direction::TANGENT)?).answer()
    }

    fn controlled(&self) -> Option<Box<dyn FrictionLaw>> {
        Some(Box::new(Self { is_controlled: true, ..*self }))
    }

    fn rates(&self) -> Option<&dyn RateLaw> {
        Some(self)
    }

    fn sensitivities(&self) -> Option<&dyn SensitiveLaw> {
        Some(self)
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

impl SensitiveLaw for RateAndState {
    fn parameters(&self) -> &'static [&'static str] {
        RateAndStateParameters::NUMBERS
    }

    fn start(&self, parameter: &str) -> Variation {
        let Coefficients { reference_rate, critical_slip, .. } = self.coefficients;
        let dtheta = match (parameter, self.has_theta) {
            ("theta", true) => 1.0,
            ("D_c", false) => 1.0 / reference_rate,
            ("V_0", false) => -critical_slip / (reference_rate * reference_rate),
            _ => 0.0,
        };
        Variation::new(0.0, dtheta)
    }

    fn vary(
        &self,
        old: &FrictionState,
        sliding: Sliding,
        directions: [Direction; 2],
    ) -> Result<[Variation; 2], LawFailure> {
        let mut ramp = Ramp::new(self, old, Inputs::new(old, sliding, directions)?);
        let PathState { traction, theta, .. } =
            if self.is_controlled && sliding.dt > 0.0 { ramp.end_of_path()? } else { ramp.single()? };
        Ok(variations(traction, theta))
    }
}
