//! Rate-and-state friction: the law, its increments of first order (`relaxation.rs`) and their error-controlled integration
//! along prescribed paths (`path.rs`, `explicit.rs`).
mod explicit;
mod path;
mod relaxation;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::sensitivity::{Direction, Inputs, SensitiveLaw, Variation, Variations};
use super::{
    Answer, Description, FrictionLaw, FrictionResponse, FrictionState, LEAST_SLOPE, LawFailure, PointLoad, RateLaw,
    Regime, Sliding, States, traction_at_yield,
};
use crate::laws::parameter::{InvalidParameter, require, require_positive};
use path::{PathState, Ramp};
pub use relaxation::StateEvolution;
use relaxation::{Coefficients, Effect, Relaxation, arsinh_of_exp};

/// Parameters of [`RateAndState`] as in the case file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
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
    /// b₂: effect of a second state, of either sign; with `D_c2` [-]
    #[serde(default)]
    pub b_2: Option<f64>,
    /// D_c2: slip over which the second state evolves, D_c2 > 0 [L]
    #[serde(default, rename = "D_c2")]
    pub critical_slip_2: Option<f64>,
    /// θ₂: second state at the start, θ₂ > 0; default D_c2/V₀ [T]
    #[serde(default)]
    pub theta_2: Option<f64>,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
}

impl RateAndStateParameters {
    /// Creates parameters with the ageing law, initially in steady sliding at the reference rate, and the default tangential
    /// stiffness.
    pub const fn new(f_0: f64, reference_rate: f64, a: f64, b: f64, critical_slip: f64) -> Self {
        let evolution = StateEvolution::Ageing;
        let (theta, alpha_t) = (None, None);
        let (b_2, critical_slip_2, theta_2) = (None, None, None);
        Self { f_0, reference_rate, a, b, critical_slip, evolution, theta, b_2, critical_slip_2, theta_2, alpha_t }
    }
}

setters! { const law: RateAndStateParameters;
    /// Sets the evolution law of the state.
    evolution(evolution: StateEvolution) { law.evolution = evolution; }

    /// Sets the initial state θ [T].
    theta(theta: f64) { law.theta = Some(theta); }

    /// Adds a second state, with its effect b₂ and the slip over which it evolves [L].
    second(b_2: f64, critical_slip_2: f64) { law.b_2 = Some(b_2); law.critical_slip_2 = Some(critical_slip_2); }

    /// Sets the initial second state θ₂ [T].
    theta_2(theta_2: f64) { law.theta_2 = Some(theta_2); }

    /// Sets the tangential stiffness α_t [F/L³].
    alpha_t(alpha_t: f64) { law.alpha_t = Some(alpha_t); }
}

numbers!(
    RateAndStateParameters: "f_0" f_0, "V_0" reference_rate, "a" a, "b" b, "D_c" critical_slip;
    "alpha_t" alpha_t, "theta" theta, "b_2" b_2, "D_c2" critical_slip_2, "theta_2" theta_2
);

/// Rate-and-state friction on an elastic contact, regularized: finite at every slip rate V of either sign.
///
/// ```text
/// q̇ = α_t (v − λ sgn q),   V = λ                                    slip = elastic + plastic              (1)
/// |q| = a p arsinh(V/(2 V₀) exp(ψ/a)),   ψ = f₀ + b ln(V₀ θ/D_c)      ≈ p (ψ + a ln(V/V₀))                  (2)
/// θ̇ = 1 − V θ/D_c   or   θ̇ = −(V θ/D_c) ln(V θ/D_c)                                                       (3)
/// ```
/// With a second state θ₂, given by b₂ and D_c2, ψ = f₀ + b ln(V₀ θ/D_c) + b₂ ln(V₀ θ₂/D_c2), and θ₂ evolves by (3) with D_c2.
///
/// The internal variables are θ and, where given, θ₂. V₀ is only the rate to which f₀ refers: with f₀ + (a − b − b₂) ln(V₁/V₀) and V₁ in their place, and
/// the same θ, friction is the same. The observable μ is ψ, the coefficient at V₀, and R = |q|/(ψ p) is 1 at V₀.
///
/// Plastic slip occurs whenever there is traction. A point *slips* where slip outweighs ageing, V θ/D_c ≥ ½ of the first state: in (3), where it
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
/// [prescribed](FrictionLaw::controlled) paths, where increments are linear in slip and pressure, sub-steps hold the error below
/// 1e-6 f₀ p in q, and 1e-6 f₀ in (a + b) ln θ of every state: explicit ones of fifth order where friction follows slowly, else such
/// responses, extrapolated.
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
    /// θ at the start
    initial: States,
    /// Whether they are given, instead of D_c/V₀.
    are_given: States<bool>,
    /// Whether the error of an increment is controlled.
    is_controlled: bool,
}

impl RateAndState {
    /// Creates the law from checked parameters; `default_alpha_t` is used if they do not specify `alpha_t`.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] if a parameter is out of range.
    pub fn new(parameters: &RateAndStateParameters, default_alpha_t: f64) -> Result<Self, InvalidParameter> {
        let RateAndStateParameters { f_0, reference_rate, a, b, critical_slip, .. } = *parameters;
        let RateAndStateParameters { theta, b_2, critical_slip_2, theta_2, .. } = *parameters;
        let alpha_t = parameters.alpha_t.unwrap_or(default_alpha_t);
        require_positive("f_0", f_0)?;
        require_positive("V_0", reference_rate)?;
        require_positive("a", a)?;
        require("b", b, true, "it must be finite")?;
        require_positive("D_c", critical_slip)?;
        require_positive("alpha_t", alpha_t)?;
        if let Some(b_2) = b_2 {
            require("b_2", b_2, true, "it must be finite")?;
            require_positive("D_c2", critical_slip_2.unwrap_or(f64::NAN))?;
        } else if let Some((name, value)) =
            [("D_c2", critical_slip_2), ("theta_2", theta_2)].into_iter().find_map(|(name, value)| Some((name, value?)))
        {
            require(name, value, false, "it belongs to a second state, whose effect b_2 is missing")?;
        }
        let coefficients = Coefficients::new(parameters, alpha_t);
        let given = [theta, theta_2];
        let initial = coefficients.each(|k, effect| given[k].unwrap_or(effect.critical_slip / reference_rate));
        for (name, theta) in ["theta", "theta_2"].into_iter().zip(initial).take(coefficients.effects().len()) {
            require_positive(name, theta)?;
        }
        Ok(Self { coefficients, initial, are_given: given.map(|theta| theta.is_some()), is_controlled: false })
    }

    /// Whether slip at the end of an increment outweighs ageing, V θ/D_c ≥ ½.
    fn slips(&self, slip: f64, theta: f64, dt: f64) -> bool {
        slip * theta >= OUTWEIGHS * self.coefficients.effects()[0].critical_slip * dt
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
        let log_states = law.log_states(thetas(old));
        let relaxation = Relaxation { law, trial: trial.abs(), pressure, dt, log_states };
        if dt == 0.0 || pressure <= 0.0 || trial == 0.0 {
            // No slip, for zero time or zero traction.
            let aged = if dt == 0.0 { thetas(old) } else { law.theta(relaxation.log_states_after(0.0).0) };
            let old = old.clone().with_variables(aged);
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
        let before = law.a * old.pressure * arsinh_of_exp(rate_share.ln() + law.psi(log_states) / law.a).0;
        let elastic = [trial.signum() * old.traction, trial.abs()];
        let mean = 0.5 * (traction_at_yield(elastic, [before, traction.abs()]) + traction.abs());
        let softness = alpha_t / found.slope.max(LEAST_SLOPE * alpha_t);
        let theta = law.theta(found.log_states);
        let state = old.slid(trial, traction, mean, pressure, alpha_t).with_variables(theta);
        let slips = self.slips(state.plastic_increment.abs(), theta[0], dt);
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

/// θ in a state; 0 where the law has no further one.
fn thetas(state: &FrictionState) -> States {
    std::array::from_fn(|k| state.variables[k])
}

/// x = ln(V₀ θ/D_c) of every state, ψ = f₀ + Σ b x.
///
/// ```text
/// a p z + 2 V₀ η e^(−ψ/a) sinh z = |τ|,   V = 2 V₀ e^(−ψ/a) sinh z          rising and convex in z = |q|/(a p)
/// ẋ = (V₀ e⁻ˣ − V)/D_c   or   ẋ = −V/D_c (x + ln(V/V₀))
/// ```
impl RateLaw for RateAndState {
    fn slip_rate(&self, x: States, PointLoad { traction, pressure, damping }: PointLoad) -> f64 {
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

    fn evolution(&self, x: States, slip_rate: f64) -> States {
        let Coefficients { reference_rate, evolution, .. } = self.coefficients;
        let rate = slip_rate.abs();
        self.coefficients.each(|k, Effect { critical_slip, .. }| match evolution {
            StateEvolution::Ageing => (reference_rate * (-x[k]).exp() - rate) / critical_slip,
            StateEvolution::Slip if rate == 0.0 => 0.0,
            StateEvolution::Slip => -rate / critical_slip * (x[k] + (rate / reference_rate).ln()),
        })
    }

    fn evolving(&self, state: &FrictionState) -> States {
        self.coefficients.log_states(thetas(state))
    }

    fn remember(&self, x: States, state: FrictionState) -> FrictionState {
        state.with_variables(self.coefficients.theta(x))
    }

    fn weights(&self) -> States {
        self.coefficients.each(|_, effect| effect.b.abs())
    }

    fn regime(&self, x: States, slip_rate: f64) -> Regime {
        let slips = self.slips(slip_rate.abs(), self.coefficients.theta(x)[0], 1.0);
        if slips { Regime::Slip } else { Regime::Stick }
    }
}

/// z above which sinh z equals ½ eᶻ.
const LARGE: f64 = 20.0;

/// Maximum number of Newton steps, never reached because of quadratic convergence.
const MOST_STEPS: usize = 60;

impl FrictionLaw for RateAndState {
    fn description(&self) -> Description {
        let effects = self.coefficients.effects();
        let lengths = effects.iter().filter(|effect| effect.b != 0.0).map(|effect| effect.critical_slip);
        let weakening = self.coefficients.weakening();
        let names: [&[&str]; 2] = if effects.len() > 1 {
            [&["theta", "theta_2"], &["R", "mu", "theta", "theta_2"]]
        } else {
            [&["theta"], &["R", "mu", "theta"]]
        };
        Description {
            stiffness: self.coefficients.alpha_t,
            variables: names[0],
            observables: Some(names[1]),
            weakening,
            // d(|q|/p)/dΔλ ≥ a/Δλ − Σ b/D_c by (2) to (5)
            unique_slip: self.coefficients.a / weakening,
            critical_slip: Some(lengths.fold(f64::INFINITY, f64::min).min(effects[0].critical_slip)),
            ..Description::default()
        }
    }

    fn initial_state(&self, pressure: f64, traction: f64) -> FrictionState {
        FrictionState::default().with_variables(self.initial).loaded(pressure, traction)
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
        let psi = || self.coefficients.psi(self.coefficients.log_states(thetas(state)));
        match name {
            "R" => Some(state.ratio(psi())),
            "mu" => Some(psi()),
            "theta" => Some(state.variables[0]),
            "theta_2" if self.coefficients.effects().len() > 1 => Some(state.variables[1]),
            _ => None,
        }
    }
}

impl SensitiveLaw for RateAndState {
    fn parameters(&self) -> &'static [&'static str] {
        RateAndStateParameters::NUMBERS
    }

    fn start(&self, parameter: &str) -> Variation {
        let Coefficients { reference_rate, .. } = self.coefficients;
        let by = self.coefficients.each(|k, Effect { critical_slip, .. }| match (parameter, self.are_given[k]) {
            (name, true) if name == ["theta", "theta_2"][k] => 1.0,
            (name, false) if name == ["D_c", "D_c2"][k] => 1.0 / reference_rate,
            ("V_0", false) => -critical_slip / (reference_rate * reference_rate),
            _ => 0.0,
        });
        Variation { traction: 0.0, variables: by.into_iter().collect() }
    }

    fn vary(&self, old: &FrictionState, sliding: Sliding, directions: [Direction; 2]) -> Variations {
        let mut ramp = Ramp::new(self, old, Inputs::new(old, sliding, directions)?);
        let PathState { traction, theta, .. } =
            if self.is_controlled && sliding.dt > 0.0 { ramp.end_of_path()? } else { ramp.single()? };
        Ok([0, 1].map(|along| Variation {
            traction: traction.by[along],
            variables: theta.iter().map(|theta| theta.by[along]).collect(),
        }))
    }
}
