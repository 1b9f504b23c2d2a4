use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::root::{Trial, bracketed_root};
use super::{
    Answer, FrictionLaw, FrictionResponse, FrictionState, LEAST_SLOPE, LawFailure, Regime, Sliding, traction_at_yield,
};
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
    initial_theta: f64,
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
        Ok(Self { f_0, reference_rate, a, b, critical_slip, evolution, initial_theta: theta, alpha_t })
    }

    /// ln(V₀ θ/D_c) of a committed state.
    fn log_state(&self, state: &FrictionState) -> f64 {
        let [theta, ..] = state.variables;
        (self.reference_rate * theta / self.critical_slip).ln()
    }

    /// θ of a ln(V₀ θ/D_c) [T]
    fn theta(&self, log_state: f64) -> f64 {
        log_state.exp() * self.critical_slip / self.reference_rate
    }

    /// ψ of a ln(V₀ θ/D_c) [-]
    fn psi(&self, log_state: f64) -> f64 {
        self.f_0 + self.b * log_state
    }

    /// Whether slip at the end of an increment outweighs ageing, V θ/D_c ≥ ½.
    fn slips(&self, slip: f64, theta: f64, dt: f64) -> bool {
        slip * theta >= OUTWEIGHS * self.critical_slip * dt
    }
}

/// V θ/D_c from which a point slips.
const OUTWEIGHS: f64 = 0.5;

/// G is right to this share of |q_tr|.
const PRECISION: f64 = 1e-14;

/// Most pieces of the bracket that are examined for the first root; many only where two roots are about to merge.
const MOST_PIECES: usize = 1000;

/// Pieces of the bracket of ln Δλ narrower than this hold roots that cannot be told apart.
const LEAST_PIECE: f64 = 1e-13;

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
    /// Δλ [L]
    slip: f64,
    /// ln Δλ, from that of the largest slip down
    log: f64,
    /// w: |q| = a p arsinh(eʷ)
    log_sinh: f64,
    /// G [F/L²]
    excess: f64,
    /// −∂G/∂Δλ [F/L³]
    slope: f64,
    /// ln(V₀ θ/D_c) at the end
    log_state: f64,
    /// |q| of (2) [F/L²]
    traction: f64,
}

impl Relaxation<'_> {
    /// ln(V₀ θ/D_c) at the end after Δλ, and its derivative by Δλ.
    fn log_state_after(&self, slip: f64) -> (f64, f64) {
        let RateAndState { reference_rate, critical_slip, evolution, .. } = *self.law;
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
        (log, dlog / critical_slip)
    }

    fn outcome(&self, slip: f64) -> Outcome {
        let RateAndState { a, b, reference_rate, alpha_t, .. } = *self.law;
        let (log_state, dlog_state) = self.log_state_after(slip);
        let (psi, dpsi) = (self.law.psi(log_state), b * dlog_state);
        let fastness = 0.5 / (reference_rate * self.dt);
        let w = slip.ln() + fastness.ln() + psi / a;
        let (arsinh, rate) = arsinh_of_exp(w);
        let traction = a * self.pressure * arsinh;
        let direct = if slip > 0.0 { rate / slip } else { fastness * (psi / a).exp() };
        let slope = alpha_t + self.pressure * (a * direct + rate * dpsi);
        let excess = self.trial - alpha_t * slip - traction;
        Outcome { slip, log: 0.0, log_sinh: w, excess, slope, log_state, traction }
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

    /// Bounds of ∂ψ/∂ln Δλ between two slips: from the monotony of its parts, and exact where the slips are the same.
    ///
    /// ```text
    /// ageing:  −b (c + g (x − c)),  c = 1 − x/(eˣ − 1),  g = θ₀ e⁻ˣ/θ₁     x, c and x − c rise with x, g falls
    /// slip:    b (x e⁻ˣ ln(D_c/V θ₀) − (1 − e⁻ˣ))                           ln(D_c/V θ₀) falls with x
    /// ```
    fn effect_bounds(&self, low: f64, high: f64) -> [f64; 2] {
        let RateAndState { b, reference_rate, critical_slip, evolution, .. } = *self.law;
        let x = [low / critical_slip, high / critical_slip];
        let time = self.dt * reference_rate / critical_slip;
        let [less, more] = match evolution {
            StateEvolution::Ageing => {
                let fresh = x.map(|x| if x < 1e-4 { 0.5 * x * (1.0 - x / 6.0) } else { 1.0 - x / x.exp_m1() });
                let grown = x.map(|x| {
                    let share = if x > 0.0 { -(-x).exp_m1() / x } else { 1.0 };
                    let old = self.log_state.exp() * (-x).exp();
                    if old > 0.0 { old / (old + time * share) } else { 0.0 }
                });
                let gone = |at: usize, grown: f64| fresh[at] + grown * (x[at] - fresh[at]).max(0.0);
                [-gone(1, grown[0]), -gone(0, grown[1])]
            }
            StateEvolution::Slip => {
                let slower = [low, high].map(|slip| (reference_rate * self.dt).ln() - slip.ln() - self.log_state);
                let [at_low, at_high] = x.map(|x| x * (-x).exp());
                // x e⁻ˣ has its maximum at 1.
                let most = if x[0] < 1.0 && 1.0 < x[1] { (-1.0f64).exp() } else { at_low.max(at_high) };
                let least = at_low.min(at_high);
                let healed = [
                    slower[1] * if slower[1] > 0.0 { least } else { most },
                    slower[0] * if slower[0] > 0.0 { most } else { least },
                ];
                [healed[0] + (-x[1]).exp_m1(), healed[1] + (-x[0]).exp_m1()]
            }
        };
        [b * less, b * more]
    }

    /// Bounds of −∂G/∂ln Δλ between two slips.
    fn fall_bounds(&self, low: &Outcome, high: &Outcome) -> [f64; 2] {
        let RateAndState { a, alpha_t, .. } = *self.law;
        let [less, more] = self.effect_bounds(low.slip, high.slip).map(|effect| a + effect);
        // w grows with ln Δλ by (a + ∂ψ/∂ln Δλ)/a.
        let way = (high.log - low.log) / a;
        let least = (low.log_sinh + way * less.min(0.0)).max(high.log_sinh - way * more.max(0.0));
        let most = (low.log_sinh + way * more.max(0.0)).min(high.log_sinh - way * less.min(0.0));
        let [slow, fast] = [least, most].map(|w| arsinh_of_exp(w).1);
        [
            alpha_t * low.slip + self.pressure * less * if less > 0.0 { slow } else { fast },
            alpha_t * high.slip + self.pressure * more * if more > 0.0 { fast } else { slow },
        ]
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
        let psi = self.law.psi(self.log_state_after(0.0).0);
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
    ///
    /// # Errors
    /// [`LawFailure::NotConverged`] when it is not found.
    fn solve(&self) -> Result<(Outcome, usize), LawFailure> {
        let (least, most) = (self.least().max(f64::MIN_POSITIVE), self.trial / self.law.alpha_t);
        let mut evaluations = 0;
        // By the logarithm of Δλ, in which (2) is nearly linear; from the largest down, so that round-off is least.
        let mut at = |log: f64| {
            evaluations += 1;
            Outcome { log, ..self.outcome(most * log.exp()) }
        };
        let mut found = at(least.ln() - most.ln());
        let enough = PRECISION * self.trial;
        if found.excess <= enough {
            return Ok((found, evaluations));
        }
        let bracket = if self.is_monotone() { Some((found.log, 0.0)) } else { self.first_root_bracket(found, &mut at) };
        let Some(bracket) = bracket else {
            return Err(LawFailure::NotConverged { evaluations, rest: found.excess, trial: self.trial });
        };
        bracketed_root(bracket, bracket.0, |log| {
            found = at(log);
            let step = found.excess / (found.slope * found.slip).max(f64::MIN_POSITIVE);
            Trial { value: found.excess, step, done: found.excess.abs() <= enough }
        });
        Ok((found, evaluations))
    }

    /// Two logarithms of Δλ that hold that of the smallest root between them, and no other unless they cannot be told
    /// apart; none if it is not to be found.
    ///
    /// Pieces are examined from the left with bounds D₋ ≤ −∂G/∂ln Δλ ≤ D₊ on each: a piece holds one root or none if
    /// D₋ > 0, none if G stays positive between the lines of slope −D₊ from its left end and −D₋ from its right, and is
    /// halved otherwise. G changes with the square of the distance from where two roots merge, so that some dozens of
    /// pieces tell whether they have.
    fn first_root_bracket(&self, mut left: Outcome, at: &mut impl FnMut(f64) -> Outcome) -> Option<(f64, f64)> {
        let mut right = at(0.0);
        for _ in 0..MOST_PIECES {
            let way = right.log - left.log;
            let [least_fall, most_fall] = self.fall_bounds(&left, &right);
            let narrow = way <= LEAST_PIECE * (1.0 + left.log.abs());
            if right.excess <= 0.0 && (least_fall > 0.0 || narrow) {
                return Some((left.log, right.log));
            }
            let crossing_needs = left.excess / most_fall.max(0.0) + right.excess / (-least_fall).max(0.0);
            let rootless = right.excess > 0.0 && (least_fall > 0.0 || crossing_needs > way);
            if rootless || narrow {
                if right.log >= 0.0 {
                    return Some((left.log, 0.0)); // but for round-off G is not positive there
                }
                let next = (right.log + 2.0 * way).min(0.0);
                left = right;
                right = at(next);
            } else {
                right = at(left.log + 0.5 * way);
            }
        }
        None
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
        FrictionState::default().with_variables([self.initial_theta])
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let alpha_t = self.alpha_t;
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        let trial = old.traction + alpha_t * slip;
        let log_state = self.log_state(old);
        let relaxation = Relaxation { law: self, trial: trial.abs(), pressure, dt, log_state };
        if dt == 0.0 || pressure <= 0.0 || trial == 0.0 {
            // No time to slip in, or nothing to slip for.
            let aged = |theta| if dt == 0.0 { theta } else { self.theta(relaxation.log_state_after(0.0).0) };
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
        let rate_share = (trial.abs() - traction.abs()) / alpha_t / (2.0 * self.reference_rate * dt);
        let before = self.a * old.pressure * arsinh_of_exp(rate_share.ln() + self.psi(log_state) / self.a).0;
        let elastic = [trial.signum() * old.traction, trial.abs()];
        let mean = 0.5 * (traction_at_yield(elastic, [before, traction.abs()]) + traction.abs());
        let softness = alpha_t / found.slope.max(LEAST_SLOPE * alpha_t);
        let theta = self.theta(found.log_state);
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
        self.alpha_t
    }

    fn variables(&self) -> &'static [&'static str] {
        &["theta"]
    }

    fn observables(&self) -> &'static [&'static str] {
        &["R", "mu", "theta"]
    }

    fn observe(&self, name: &str, state: &FrictionState) -> Option<f64> {
        let psi = || self.psi(self.log_state(state));
        match name {
            "R" => Some(state.ratio(psi())),
            "mu" => Some(psi()),
            "theta" => Some(state.variables[0]),
            _ => None,
        }
    }
}
