//! Time integration: velocity and acceleration as functions of displacement, and the time of equilibrium.
//!
//! ```text
//! (1 − α_m) M a₁ + α_m M a₀ + (1 − α_f) F₁ + α_f F₀ = 0          F: internal + contact − external forces     (1)
//! a₁ = (u₁ − u₀ − Δt v₀)/(β Δt²) − (1/(2β) − 1) a₀                                                           (2)
//! v₁ = v₀ + Δt ((1 − γ) a₀ + γ a₁)                                                                           (3)
//! ```
//!
//! | scheme | α_m | α_f | γ | β | order | ρ(∞) |
//! |---|---|---|---|---|---|---|
//! | Newmark | 0 | 0 | given | given | 2 for γ = ½, else 1 | 1 for γ = ½, β = ¼ |
//! | HHT-α | 0 | −α | ½ − α | ¼ (1 − α)² | 2 | (1 + α)/(1 − α) |
//! | generalized-α | (2ρ − 1)/(ρ + 1) | ρ/(ρ + 1) | ½ − α_m + α_f | ¼ (1 − α_m + α_f)² | 2 | ρ |
//! | Wilson-θ | 0 | 0 | ½ | 1/6, over θ Δt | 2 | < 1 |
//! | central differences | 0 | 0 | ½ | 0 | 2 | – |
//!
//! ρ(∞) is the fraction of an unresolved motion, ω Δt → ∞, that remains after each increment.
//!
//! # Wilson-θ
//! The acceleration is linear in time (γ = ½, β = 1/6) and equilibrium is required at t + θ Δt, under the loads of that
//! time; the state there is a trial and is discarded. With a_θ found there,
//! ```text
//! a₁ = a₀ + (a_θ − a₀)/θ                                                                                     (4)
//! ```
//! and (2), (3) over Δt give u₁ and v₁. Loads are extrapolated linearly to t + θ Δt, f_θ = f₀ + θ (f₁ − f₀), and supports by
//! the cubic through their positions at the start, thirds and end of the increment, irrespective of kinks or the end of the
//! step. At t + Δt equilibrium is satisfied only to the order of the scheme. The scheme is stable for every Δt if θ ≥ (1 +
//! √3)/2 = 1.366.
//!
//! # Central differences
//! The velocity-Verlet form permits a change of scheme at any time; M is lumped, F excludes dashpots, which act at t + Δt with
//! the coefficients c on the diagonal:
//! ```text
//! v½ = v₀ + ½ Δt a₀,   u₁ = u₀ + Δt v½                                                                       (7)
//! (M + ½ Δt c) a₁ = −F(u₁) + c (v_driver − v½),   v₁ = v½ + ½ Δt a₁                                          (8)
//! ```
//! The scheme is of second order and stable while ω Δt ≤ 2 for every frequency ω; `explicit/` computes a bound of ω.
//!
//! # Quasi-dynamic steps
//! Without inertia except for radiation damping, an interface on linear bodies is a system of ordinary differential equations;
//! see `time/quasi_dynamic`.
//!
//! # Supports
//! A prescribed dof follows its support instead of (2), which would oscillate after a jerk. Its velocity is that of the
//! support, and
//! ```text
//! a₁ = (v₁ − v₀)/Δt + ½ (ā₁ − ā₀)                                                                            (5)
//! ```
//! with ā the support's acceleration. This is of second order where the motion is smooth; a jump of the velocity, from the
//! previous step or at a kink, is distributed over the increment. In (1) the accelerations of supports are weighted
//! with α_f like the forces: they belong to t, those of free dofs to the time t + (α_m − α_f) Δt, to second order.
//!
//! # Local error
//! With accelerations of the time t + (α_m − α_f) Δt, the displacement of one increment from exact start values is in
//! error by
//! ```text
//! e = C Δt³ u⃛ + O(Δt⁴) ≈ C Δt² (a₁ − a₀),   C = β − 1/6 − ½ (α_f − α_m)                                     (6)
//! ```
//! By (2) this is C/β times the difference between u₁ and the Taylor polynomial u₀ + Δt v₀ + ½ Δt² a₀: a third of it for the
//! trapezoidal rule. An event within an increment, such as slip or an impact, therefore contributes its displacement to the
//! estimate. Wilson-θ has no term (6): its error is of fourth order and requires accelerations at more than two times.
//!
//! Sources: Newmark (1959), J. Eng. Mech. Div. ASCE 85, 67; Wilson, Farhoomand & Bathe (1973), Earthquake Eng. Struct. Dyn.
//! 1, 241; Hilber, Hughes & Taylor (1977), Earthquake Eng. Struct. Dyn. 5, 283; Chung & Hulbert (1993), J. Appl. Mech.
//! 60, 371; Zienkiewicz & Xie (1991), Earthquake Eng. Struct. Dyn. 20, 871 (the estimate for Newmark's scheme).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::laws::parameter::{InvalidParameter, ratio, require};

/// Time scheme of a step, as the case file names it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Scheme {
    /// Equilibrium without inertia; time only controls loads and the ageing of friction.
    #[default]
    Static,
    /// Newmark; default β = 1/4, γ = 1/2 (the trapezoidal rule).
    Newmark {
        /// β > 0 [-]
        #[serde(default = "ratio::<1, 4>")]
        beta: f64,
        /// γ ≥ 1/2 [-]
        #[serde(default = "ratio::<1, 2>")]
        gamma: f64,
    },
    /// Hilber–Hughes–Taylor: second order, with damping of frequencies that the increments do not resolve.
    Hht {
        /// −1/3 ≤ α ≤ 0; the nearer to −1/3, the more damping [-]
        alpha: f64,
    },
    /// Generalized-α: second order, with the least damping of resolved frequencies among such schemes.
    GeneralizedAlpha {
        /// 0 ≤ ρ∞ ≤ 1: spectral radius at infinite frequency; default 0.8, 1 does not damp [-]
        #[serde(default = "ratio::<4, 5>")]
        rho_infinity: f64,
    },
    /// Central differences: no equations to solve, but increments are limited by the highest frequency of a single
    /// element or contact point.
    Explicit {
        /// 0 < safety ≤ 1: increment as a fraction of the longest stable one; default 0.9 [-]
        #[serde(default = "ratio::<9, 10>")]
        safety: f64,
    },
    /// Quasi-dynamic: no inertia, linear bodies and contacts in small sliding with radiation damping; slip and state of
    /// the interface are integrated with error control, explicitly if all friction laws define a slip rate by
    /// traction and state (rate_and_state, prescribed), else implicitly. For matching nodes, and loads and supports that vary
    /// linearly within the step
    QuasiDynamic {
        /// Error of one step in the friction coefficient, 0 < tolerance < 0.1; default 1e-5 [-]
        #[serde(default = "ratio::<1, 100_000>")]
        tolerance: f64,
        /// Steps per row of results, at least 1; default 10
        #[serde(default = "ten")]
        every: usize,
    },
    /// Wilson-θ: linear acceleration, equilibrium at t + θ Δt.
    Wilson {
        /// 1.37 ≤ θ ≤ 2; default 1.4 [-]
        #[serde(default = "ratio::<7, 5>")]
        theta: f64,
    },
}

fn ten() -> usize {
    10
}

/// Coefficients of a dynamic scheme in the equations above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// Weight of the old inertia force
    pub alpha_m: f64,
    /// Weight of the old internal, contact and external forces
    pub alpha_f: f64,
    /// β
    pub beta: f64,
    /// γ
    pub gamma: f64,
}

/// Kind of the steps of a run, as far as the defaults of penalties and methods depend on it.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// All are static
    Static,
    /// One has inertia, and none takes explicit increments
    Dynamic,
    /// One takes explicit increments, or may
    Explicit,
    /// One is quasi-dynamic: its increments are explicit, between nodes
    QuasiDynamic,
}

impl Scheme {
    /// Whether masses have inertia.
    pub fn is_dynamic(self) -> bool {
        !matches!(self, Self::Static | Self::QuasiDynamic { .. })
    }

    /// Whether it takes central differences.
    pub fn is_explicit(self) -> bool {
        matches!(self, Self::Explicit { .. })
    }

    /// Whether it is quasi-dynamic.
    pub fn is_quasi_dynamic(self) -> bool {
        matches!(self, Self::QuasiDynamic { .. })
    }

    /// Whether increments are explicit, with or without inertia.
    pub fn is_integrated_explicitly(self) -> bool {
        self.is_explicit() || self.is_quasi_dynamic()
    }

    /// Coefficients of the scheme; `None` for statics and central differences.
    pub fn coefficients(self) -> Option<Coefficients> {
        match self {
            Self::Static | Self::Explicit { .. } | Self::QuasiDynamic { .. } => None,
            Self::Newmark { beta, gamma } => Some(Coefficients { alpha_m: 0.0, alpha_f: 0.0, beta, gamma }),
            Self::Hht { alpha } => Some(Coefficients::of_second_order(0.0, -alpha)),
            Self::GeneralizedAlpha { rho_infinity: rho } => {
                Some(Coefficients::of_second_order((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)))
            }
            Self::Wilson { .. } => Some(Coefficients { alpha_m: 0.0, alpha_f: 0.0, beta: 1.0 / 6.0, gamma: 0.5 }),
        }
    }

    /// θ: equilibrium is required at t + θ Δt; 1 except for Wilson-θ.
    pub fn theta(self) -> f64 {
        match self {
            Self::Wilson { theta } => theta,
            _ => 1.0,
        }
    }

    /// Fraction of the longest stable increment used by central differences.
    pub fn safety(self) -> f64 {
        match self {
            Self::Explicit { safety } => safety,
            _ => 1.0,
        }
    }

    /// C of (6); `None` where it vanishes or there is no such term.
    pub fn error_constant(self) -> Option<f64> {
        let Coefficients { alpha_m, alpha_f, beta, .. } = self.coefficients()?;
        let constant = (beta - 1.0 / 6.0 - 0.5 * (alpha_f - alpha_m)).abs();
        (self.theta() == 1.0 && constant > LEAST_ERROR_CONSTANT).then_some(constant)
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] with the one that is out of range.
    pub fn check(self) -> Result<(), InvalidParameter> {
        match self {
            Self::Static => Ok(()),
            Self::Explicit { safety } => {
                let fits = safety > 0.0 && safety <= 1.0;
                require("safety", safety, fits, "it must be above 0 and at most 1, the limit of stability")
            }
            Self::Newmark { beta, gamma } => {
                require("gamma", gamma, gamma >= 0.5, "it must be at least 0.5: less adds energy")?;
                require("beta", beta, beta > 0.0, "it must be positive; 0.25 is the trapezoidal rule")
            }
            Self::Hht { alpha } => {
                let fits = (-1.0 / 3.0..=0.0).contains(&alpha);
                require("alpha", alpha, fits, "it must be between -1/3 and 0; 0 does not damp")
            }
            Self::GeneralizedAlpha { rho_infinity: rho } => {
                let fits = (0.0..=1.0).contains(&rho);
                require("rho_infinity", rho, fits, "it must be between 0 (most damping) and 1 (none)")
            }
            Self::QuasiDynamic { tolerance, every } => {
                let fits = tolerance > 0.0 && tolerance < 0.1;
                require("tolerance", tolerance, fits, "it must be above 0 and below 0.1; 1e-5 is the default")?;
                require("every", every as f64, every > 0, "it must be at least 1")
            }
            Self::Wilson { theta } => {
                let fits = (1.37..=2.0).contains(&theta);
                require("theta", theta, fits, "it must be between 1.37, below which long increments blow up, and 2")
            }
        }
    }
}

/// |C| below which the estimate (6) is meaningless: all others of this file have |C| ≥ 1/12.
const LEAST_ERROR_CONSTANT: f64 = 0.01;

impl Coefficients {
    /// γ and β for second order with the strongest damping of unresolved motions for given α_m and α_f.
    fn of_second_order(alpha_m: f64, alpha_f: f64) -> Self {
        let shift = alpha_f - alpha_m;
        Self { alpha_m, alpha_f, beta: 0.25 * (1.0 + shift).powi(2), gamma: 0.5 + shift }
    }
}

/// A dynamic scheme over an increment of length Δt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeIntegration {
    /// Those of the scheme
    pub coefficients: Coefficients,
    /// Δt [T]
    dt: f64,
}

impl TimeIntegration {
    /// That of a scheme; `None` for statics and central differences.
    pub fn new(scheme: Scheme, dt: f64) -> Option<Self> {
        Some(Self { coefficients: scheme.coefficients()?, dt })
    }

    /// ∂a₁/∂u₁ = 1/(β Δt²) [1/T²].
    pub fn dacceleration(&self) -> f64 {
        1.0 / (self.coefficients.beta * self.dt * self.dt)
    }

    /// ∂v₁/∂u₁ = γ/(β Δt) [1/T].
    pub fn dvelocity(&self) -> f64 {
        self.coefficients.gamma / (self.coefficients.beta * self.dt)
    }

    /// (v₁, a₁) of one dof from its displacement increment Δu and (v₀, a₀).
    pub fn rates(&self, increment: f64, v: f64, a: f64) -> (f64, f64) {
        let Self { coefficients: Coefficients { beta, gamma, .. }, dt } = *self;
        let a1 = (increment - dt * v) / (beta * dt * dt) - (0.5 / beta - 1.0) * a;
        (v + dt * ((1.0 - gamma) * a + gamma * a1), a1)
    }

    /// Δu of one dof from (v₀, a₀) and a₁: the inverse of equation (2).
    pub fn increment(&self, v: f64, a: f64, a1: f64) -> f64 {
        let Self { coefficients: Coefficients { beta, .. }, dt } = *self;
        dt * v + dt * dt * ((0.5 - beta) * a + beta * a1)
    }

    /// (v₁, a₁) of a supported dof: [`supported_rates`].
    pub fn supported(&self, places: [f64; 4], v: f64) -> (f64, f64) {
        supported_rates(places, v, self.dt)
    }
}

/// (v₁, a₁) by (5) of a dof with the initial velocity `v`, in an increment in which its support passes through four positions
/// at the start, thirds and end.
pub fn supported_rates(places: [f64; 4], v: f64, dt: f64) -> (f64, f64) {
    let [start, first, second, end] = places;
    let v1 = (11.0 * end - 18.0 * second + 9.0 * first - 2.0 * start) / (2.0 * dt);
    let [a0, a1] = [start_acceleration(places, dt), start_acceleration([end, second, first, start], dt)];
    (v1, (v1 - v) / dt + 0.5 * (a1 - a0))
}

/// Velocity of a support at the start of an increment, from its positions at the start, thirds and end.
pub fn start_velocity([start, first, second, end]: [f64; 4], dt: f64) -> f64 {
    (-11.0 * start + 18.0 * first - 9.0 * second + 2.0 * end) / (2.0 * dt)
}

/// Acceleration of a support at the start of an increment, from its positions at the start, thirds and end.
pub fn start_acceleration([start, first, second, end]: [f64; 4], dt: f64) -> f64 {
    9.0 * (2.0 * start - 5.0 * first + 4.0 * second - end) / (dt * dt)
}

/// A time as printed: twelve digits, without the round-off of a sum of increments.
pub fn time_text(time: f64) -> f64 {
    format!("{time:.11e}").parse().unwrap_or(time)
}
