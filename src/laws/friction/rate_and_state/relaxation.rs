//! Equation of an increment of rate-and-state friction, its smallest root, and the derivatives there.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::RateAndStateParameters;
use crate::laws::dual::{Dual, Number};
use crate::laws::friction::root::{Argument, Piece, bracketed_root, first_root_bracket};
use crate::laws::friction::sensitivity::Inputs;
use crate::laws::friction::{LEAST_SLOPE, LawFailure, MOST_STATES, States};

/// Evolution of the state θ of rate-and-state friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub enum StateEvolution {
    /// Ageing law, θ̇ = 1 − V θ/D_c: heals in stationary contact
    #[default]
    Ageing,
    /// Slip law, θ̇ = −(V θ/D_c) ln(V θ/D_c): evolves only with slip
    Slip,
}

/// Effect of a state, and the slip over which it evolves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Effect<N = f64> {
    pub b: N,
    pub critical_slip: N,
}

/// Coefficients of the friction law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coefficients<N = f64> {
    pub f_0: N,
    pub reference_rate: N,
    pub a: N,
    /// of the states, as many as `count`
    effects: States<Effect<N>>,
    count: usize,
    pub evolution: StateEvolution,
    pub alpha_t: N,
}

impl Coefficients {
    /// Coefficients of a law with one state, or two.
    pub(super) fn new(parameters: &RateAndStateParameters, alpha_t: f64) -> Self {
        let RateAndStateParameters { f_0, reference_rate, a, b, critical_slip, evolution, .. } = *parameters;
        let first = Effect { b, critical_slip };
        let second = parameters.b_2.zip(parameters.critical_slip_2);
        let effects = [first, second.map_or(first, |(b, critical_slip)| Effect { b, critical_slip })];
        let count = if second.is_some() { 2 } else { 1 };
        Self { f_0, reference_rate, a, effects, count, evolution, alpha_t }
    }

    /// The coefficients with their derivatives along two directions.
    pub(super) fn along(&self, inputs: &Inputs) -> Coefficients<Dual> {
        let of = |name: &str, value: f64| inputs.parameter(name, value);
        let effect = |k: usize| Effect {
            b: of(["b", "b_2"][k], self.effects[k].b),
            critical_slip: of(["D_c", "D_c2"][k], self.effects[k].critical_slip),
        };
        Coefficients {
            f_0: of("f_0", self.f_0),
            reference_rate: of("V_0", self.reference_rate),
            a: of("a", self.a),
            effects: [effect(0), effect(1)],
            count: self.count,
            evolution: self.evolution,
            alpha_t: of("alpha_t", self.alpha_t),
        }
    }

    /// Σ b/D_c of the states that weaken: the largest −dψ/dΔλ at a given rate [1/L]
    pub(super) fn weakening(&self) -> f64 {
        self.effects().iter().map(|Effect { b, critical_slip }| b.max(0.0) / critical_slip).sum()
    }
}

impl<N: Number> Coefficients<N> {
    /// Effects of the states.
    pub(super) fn effects(&self) -> &[Effect<N>] {
        &self.effects[..self.count]
    }

    /// A value of every state; 0 where the law has no further one.
    pub(super) fn each<T: From<f64>>(&self, of: impl Fn(usize, &Effect<N>) -> T) -> States<T> {
        std::array::from_fn(|k| if k < self.count { of(k, &self.effects[k]) } else { 0.0.into() })
    }

    /// ln(V₀ θ/D_c)
    pub(super) fn log_states(&self, theta: States<N>) -> States<N> {
        self.each(|k, effect| (self.reference_rate * theta[k] / effect.critical_slip).ln())
    }

    /// θ from ln(V₀ θ/D_c) [T]
    pub(super) fn theta(&self, log_states: States<N>) -> States<N> {
        self.each(|k, effect| log_states[k].exp() * effect.critical_slip / self.reference_rate)
    }

    /// ψ from ln(V₀ θ/D_c) [-]
    pub(super) fn psi(&self, log_states: States<N>) -> N {
        self.effects().iter().zip(log_states).fold(self.f_0, |psi, (effect, log_state)| psi + effect.b * log_state)
    }
}

/// Relative accuracy of G with respect to |q_tr|.
const PRECISION: f64 = 1e-14;

/// Width of a piece of the bracket of ln Δλ below which two roots cannot be distinguished.
const LEAST_PIECE: f64 = 1e-13;

/// Exponent above which the exponential would overflow.
const MOST_EXPONENT: f64 = 700.0;

/// One increment with a traction to be relaxed: G as a function of Δλ.
pub(super) struct Relaxation<'a, N = f64> {
    pub law: &'a Coefficients<N>,
    /// |q_tr| > 0
    pub trial: N,
    pub pressure: N,
    /// Δt > 0
    pub dt: f64,
    /// ln(V₀ θ₀/D_c)
    pub log_states: States<N>,
}

/// Result of an increment with the slip Δλ.
#[derive(Clone, Copy)]
pub(super) struct Relaxed<N = f64> {
    /// Δλ [L]
    pub slip: f64,
    /// ln Δλ, relative to that of the largest slip
    log: f64,
    /// w: |q| = a p arsinh(eʷ)
    log_sinh: N,
    /// G [F/L²]
    excess: N,
    /// −∂G/∂Δλ [F/L³]
    pub slope: f64,
    /// ln(V₀ θ/D_c) at the end
    pub log_states: States<N>,
    /// ∂ ln θ/∂Δλ at the end [1/L]
    log_by_slip: States<f64>,
    /// |q| of (2) [F/L²]
    pub traction: N,
}

impl<N: Number> Relaxation<'_, N> {
    /// ln(V₀ θ/D_c) of the states at the end after Δλ, and its derivatives with respect to Δλ.
    pub(super) fn log_states_after(&self, slip: f64) -> (States<N>, States<f64>) {
        let (mut logs, mut by_slip) = ([N::from(0.0); MOST_STATES], [0.0; MOST_STATES]);
        for k in 0..self.law.count {
            (logs[k], by_slip[k]) = self.log_state_after(k, slip);
        }
        (logs, by_slip)
    }

    /// The same of one of them.
    fn log_state_after(&self, k: usize, slip: f64) -> (N, f64) {
        let Coefficients { reference_rate, evolution, .. } = *self.law;
        let (critical_slip, log_state) = (self.law.effects[k].critical_slip, self.log_states[k]);
        let x = N::from(slip) / critical_slip;
        let decay = (N::from(0.0) - x).exp();
        // (1 − e⁻ˣ)/x and its derivative
        let (share, dshare) = {
            let x = x.value();
            let share = if x > 0.0 { -(-x).exp_m1() / x } else { 1.0 };
            (share, if x > 1e-4 { (decay.value() - share) / x } else { -0.5 + x / 3.0 })
        };
        let share = x.map(share, dshare);
        let (log, dlog) = match evolution {
            StateEvolution::Ageing => {
                let time = reference_rate * self.dt / critical_slip;
                let grown = log_state.exp() * decay;
                let state = grown + time * share;
                (state.ln(), (time.value() * dshare - grown.value()) / state.value())
            }
            StateEvolution::Slip if slip == 0.0 => (log_state, 0.0),
            StateEvolution::Slip => {
                let steady = (reference_rate * self.dt).ln() - slip.ln();
                let log = log_state * decay + steady * x * share;
                (log, decay.value() * (steady - log_state).value() - share.value())
            }
        };
        (log, dlog / critical_slip.value())
    }

    /// Traction and state after the slip Δλ.
    pub(super) fn outcome(&self, slip: f64) -> Relaxed<N> {
        let Coefficients { a, reference_rate, alpha_t, .. } = *self.law;
        let (log_states, log_by_slip) = self.log_states_after(slip);
        let psi = self.law.psi(log_states);
        let fastness = N::from(0.5) / (reference_rate * self.dt);
        let w = fastness.ln() + slip.ln() + psi / a;
        let (arsinh, rate) = arsinh_of_exp(w.value());
        let traction = a * self.pressure * w.map(arsinh, rate);
        let direct = if slip > 0.0 { rate / slip } else { (fastness * (psi / a).exp()).value() };
        let weakened: f64 = self.law.effects().iter().zip(log_by_slip).map(|(effect, by)| effect.b.value() * by).sum();
        let by_slip = a.value() * direct + rate * weakened;
        let slope = alpha_t.value() + self.pressure.value() * by_slip;
        let excess = self.trial - alpha_t * slip - traction;
        Relaxed { slip, log: 0.0, log_sinh: w, excess, slope, log_states, log_by_slip, traction }
    }
}

impl Relaxation<'_, Dual> {
    /// Traction and θ after the slip Δλ that solves the equation.
    pub(super) fn end(&self, slip: f64) -> (Dual, States<Dual>) {
        let alpha_t = self.law.alpha_t.value;
        let at = self.outcome(slip);
        let slope = at.slope.max(LEAST_SLOPE * alpha_t);
        let dslip = at.excess.map(0.0, 1.0 / slope);
        let logs = std::array::from_fn(|k| at.log_states[k] + dslip * at.log_by_slip[k]);
        (at.traction + dslip * (slope - alpha_t), self.law.theta(logs))
    }
}

impl Relaxation<'_> {
    /// Bound of the increase of ψ by all slips up to this one, which rises with the slip: healing within the increment, which also occurs in
    /// the slip law. With y = V θ₀/D_c it is b x ln(1/y), which increases up to y = 1/e. Where b < 0, what slip takes from θ
    /// strengthens: by at most |b| x in the ageing law, and |b| x ln y in the slip law.
    fn healing(&self, slip: f64) -> f64 {
        let Coefficients { reference_rate, evolution, .. } = *self.law;
        let of = |(&Effect { b, critical_slip }, log_state): (&Effect, f64)| {
            if b < 0.0 {
                let spent = match evolution {
                    StateEvolution::Ageing => 1.0,
                    StateEvolution::Slip => slip.ln() - (reference_rate * self.dt).ln() + log_state,
                };
                return -b * slip / critical_slip * spent.max(0.0);
            }
            if evolution == StateEvolution::Ageing {
                return 0.0;
            }
            let log_y = slip.ln() - (reference_rate * self.dt).ln() + log_state;
            let at = log_y.min(-1.0);
            b * self.dt * reference_rate / critical_slip * -at * (at - log_state).min(MOST_EXPONENT).exp()
        };
        self.law.effects().iter().zip(self.log_states).map(of).sum()
    }

    /// Bounds of ∂ψ/∂ln Δλ between two slips: from the monotonicity of its parts, and exact if the slips are equal.
    ///
    /// ```text
    /// ageing:  −b (c + g (x − c)),  c = 1 − x/(eˣ − 1),  g = θ₀ e⁻ˣ/θ₁     x, c and x − c rise with x, g falls
    /// slip:    b (x e⁻ˣ ln(D_c/V θ₀) − (1 − e⁻ˣ))                           ln(D_c/V θ₀) falls with x
    /// ```
    /// Where b < 0, the bounds change places; those of two states add up.
    fn effect_bounds(&self, low: f64, high: f64) -> [f64; 2] {
        let of = (0..self.law.count).map(|k| self.effect_bounds_of(k, low, high));
        of.fold([0.0; 2], |[less, more], own| [less + own[0], more + own[1]])
    }

    fn effect_bounds_of(&self, k: usize, low: f64, high: f64) -> [f64; 2] {
        let Coefficients { reference_rate, evolution, .. } = *self.law;
        let (Effect { b, critical_slip }, log_state) = (self.law.effects[k], self.log_states[k]);
        let x = [low / critical_slip, high / critical_slip];
        let time = self.dt * reference_rate / critical_slip;
        let [less, more] = match evolution {
            StateEvolution::Ageing => {
                let fresh = x.map(|x| if x < 1e-4 { 0.5 * x * (1.0 - x / 6.0) } else { 1.0 - x / x.exp_m1() });
                let grown = x.map(|x| {
                    let share = if x > 0.0 { -(-x).exp_m1() / x } else { 1.0 };
                    let old = log_state.exp() * (-x).exp();
                    if old > 0.0 { old / (old + time * share) } else { 0.0 }
                });
                let gone = |at: usize, grown: f64| fresh[at] + grown * (x[at] - fresh[at]).max(0.0);
                [-gone(1, grown[0]), -gone(0, grown[1])]
            }
            StateEvolution::Slip => {
                let slower = [low, high].map(|slip| (reference_rate * self.dt).ln() - slip.ln() - log_state);
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
        if b < 0.0 { [b * more, b * less] } else { [b * less, b * more] }
    }

    /// Bounds of −∂G/∂ln Δλ between two slips.
    fn fall_bounds(&self, low: &Relaxed, high: &Relaxed) -> [f64; 2] {
        let Coefficients { a, alpha_t, .. } = *self.law;
        let [less, more] = self.effect_bounds(low.slip, high.slip).map(|effect| a + effect);
        // w increases with ln Δλ by (a + ∂ψ/∂ln Δλ)/a.
        let way = (high.log - low.log) / a;
        let least = (low.log_sinh + way * less.min(0.0)).max(high.log_sinh - way * more.max(0.0));
        let most = (low.log_sinh + way * more.max(0.0)).min(high.log_sinh - way * less.min(0.0));
        let [slow, fast] = [least, most].map(|w| arsinh_of_exp(w).1);
        [
            alpha_t * low.slip + self.pressure * less * if less > 0.0 { slow } else { fast },
            alpha_t * high.slip + self.pressure * more * if more > 0.0 { fast } else { slow },
        ]
    }

    /// Whether G decreases monotonically.
    fn is_monotone(&self) -> bool {
        let Coefficients { reference_rate, alpha_t, evolution, .. } = *self.law;
        let weakens = |(&Effect { b, critical_slip }, log_state): (&Effect, f64)| match evolution {
            // Slip spends θ, which strengthens; but at first the slip law may heal, which weakens.
            StateEvolution::Ageing if b < 0.0 => 0.0,
            StateEvolution::Slip if b < 0.0 => f64::INFINITY,
            StateEvolution::Ageing => self.pressure * b / critical_slip,
            StateEvolution::Slip => {
                let fastest = (self.trial / (alpha_t * reference_rate * self.dt)).ln() + log_state;
                self.pressure * b / critical_slip * (1.0 + fastest.max(0.0))
            }
        };
        alpha_t > self.law.effects().iter().zip(self.log_states).map(weakens).sum()
    }

    /// A slip certainly not beyond the first root: neither the contact nor (2) takes more than half of |q_tr|.
    fn least(&self) -> f64 {
        let Coefficients { a, reference_rate, alpha_t, .. } = *self.law;
        let half = 0.5 * self.trial;
        let level = half / (a * self.pressure);
        let log_sinh = if level > 20.0 { level - std::f64::consts::LN_2 } else { level.sinh().ln() };
        let psi = self.law.psi(self.log_states_after(0.0).0);
        let reached = |healing: f64| {
            let log = (2.0 * reference_rate * self.dt).ln() - (psi + healing) / a + log_sinh;
            log.min((half / alpha_t).ln())
        };
        // Healing increases with slip: bisection finds the largest slip for which the condition holds.
        let (mut low, mut high) = (f64::MIN_POSITIVE.ln(), reached(0.0));
        while high - low > 1.0 {
            let middle = 0.5 * (low + high);
            let holds = reached(self.healing(middle.exp())) >= middle;
            if holds { low = middle } else { high = middle }
        }
        low.exp()
    }

    /// Smallest root, and the number of evaluations.
    ///
    /// # Errors
    /// Returns [`LawFailure::NotConverged`] if it is not found.
    pub(super) fn solve(&self) -> Result<(Relaxed, usize), LawFailure> {
        let (least, most) = (self.least().max(f64::MIN_POSITIVE), self.trial / self.law.alpha_t);
        let mut evaluations = 0;
        // In the logarithm of Δλ, (2) is nearly linear; it is relative to the largest slip to minimize round-off.
        let mut at = |log: f64| {
            evaluations += 1;
            Relaxed { log, ..self.outcome(most * log.exp()) }
        };
        let mut found = at(least.ln() - most.ln());
        let enough = PRECISION * self.trial;
        if found.excess <= enough {
            return Ok((found, evaluations));
        }
        let bracket = match self.is_monotone() {
            true => Ok([found.log, 0.0]),
            // G changes with the square of the distance from where two roots merge: some dozens of pieces tell whether they have.
            false => {
                let right = at(0.0);
                let piece = |left: &Relaxed, right: &Relaxed| Piece {
                    ends: [left.log, right.log],
                    values: [left.excess, right.excess],
                    fall: self.fall_bounds(left, right),
                    way: right.log - left.log,
                };
                first_root_bracket(found, right, 0.0, LEAST_PIECE, &mut at, piece)
            }
        };
        let Ok(bracket) = bracket else {
            return Err(LawFailure::NotConverged { evaluations, rest: found.excess, trial: self.trial });
        };
        bracketed_root(bracket, bracket[0], |log| {
            found = at(log);
            let step = found.excess / (found.slope * found.slip).max(f64::MIN_POSITIVE);
            Argument { value: found.excess, step, done: found.excess.abs() <= enough }
        });
        Ok((found, evaluations))
    }
}

/// arsinh(eʷ) and its derivative with respect to w, without eʷ where it would overflow.
pub(super) fn arsinh_of_exp(w: f64) -> (f64, f64) {
    if w > 20.0 {
        return (w + std::f64::consts::LN_2, 1.0);
    }
    let sinh = w.exp();
    (sinh.asinh(), sinh / sinh.hypot(1.0))
}
