//! Steps of an interface whose laws have no slip rate that follows from traction and state: they answer slip with a traction, and
//! radiation damping alone bounds the rate,
//!
//! ```text
//! η V + q = τ,   V = u̇          q answers the slip u since t₀ at pressure p, along its own path                  (1)
//! (p, −τ) = (p, −τ)₀ + Y u + Z (p_w − p_w0) + ẏ (t − t₀)                                                          (2)
//! ```
//! u is all slip, elastic and plastic: the springs of the laws are within them, and Y is that of bodies without tangential springs.
//! Since α_t/η and the curvature of q are rates far above those of interest, a step is implicit. One of first order solves
//!
//! ```text
//! η Δu/Δt + q(Δu, p(Δu)) = τ(Δu)                                                                                  (3)
//! ```
//! by Newton's method with the law's own tangent and the dense Y; steps of h are extrapolated from 1, 2, ... of these:
//!
//! ```text
//! T_j1: h by j steps of (3),   T_j,k+1 = T_jk + (T_jk − T_j−1,k)/(j/(j − k) − 1)
//! e = max over the points of |e_q|/p, |e_μ| and |∂τ/∂u| |e_u|/p          in the coefficient of friction
//! ```
//! Source: Deuflhard (1985), SIAM Review 27, 505; Hairer & Wanner, Solving Ordinary Differential Equations II, IV.9.

use rayon::prelude::*;

use super::slip_equations::{PART, Rates, SlipEquations};
use super::steps::{SAFETY, SHARES, Tried};
use crate::laws::friction::{FrictionResponse, FrictionState, Sliding};
use crate::linear::DenseLu;

/// Rows of the extrapolation.
const MOST_ROWS: usize = 4;

/// Errors of 2, 3 and 4 rows, in tolerances, above which further rows are not sufficient.
const HOPELESS: [f64; MOST_ROWS] = [f64::INFINITY, 1e4, 1e2, 1.0];

/// Residual of (3), as a fraction of the tolerance, at which it is solved.
const SOLVED: f64 = 1e-5;

/// Newton iterations of (3) after which the step is too long.
const MOST_ITERATIONS: usize = 25;

/// Most variables of a law that are extrapolated.
const VARIABLES: usize = 4;

/// Numbers of a point that are extrapolated: u, q, plastic slip, dissipated and radiated energy, variables
const PER_POINT: usize = 5 + VARIABLES;

/// The interface at a time.
#[derive(Clone)]
struct Front {
    /// u since t₀ [L]
    slips: Vec<f64>,
    /// States of the laws
    states: Vec<FrictionState>,
    /// η V [F/L²]
    radiation: Vec<f64>,
    /// Energies radiated since t₀, per area [F/L]
    radiated: Vec<f64>,
}

/// A step of (3) that was not solved, at its worst point.
struct Unsolved(usize);

/// The response of a point, and its residual of (3) [F/L²].
struct Answered {
    response: FrictionResponse,
    residual: f64,
}

/// Integration from one state on.
pub struct Stiff<'a> {
    interface: SlipEquations<'a>,
    tolerance: f64,
    /// t₀ [T]
    start: f64,
    /// t − t₀ [T]
    pub since: f64,
    /// Slips of the last step [L]
    pub last: Vec<f64>,
    now: Front,
    rates: Vec<Rates>,
    /// Names of the variables that count as coefficients of friction, by point
    counted: Vec<[bool; VARIABLES]>,
    /// |∂τ/∂u| [F/L³]
    stiffness: Vec<f64>,
}

impl<'a> Stiff<'a> {
    /// Starts at a time.
    pub fn new(interface: SlipEquations<'a>, start: f64, tolerance: f64) -> Self {
        let n = interface.points.len();
        let states: Vec<FrictionState> = interface.points.iter().map(|(_, _, state)| state.friction.clone()).collect();
        let radiation = interface.points.iter().map(|(_, _, state)| state.radiation).collect();
        let counted = interface.points.iter().map(|(pair, slave, _)| {
            let names = pair.law(slave).law.description().variables;
            std::array::from_fn(|i| names.get(i).is_some_and(|name| ["mu", "R"].contains(name)))
        });
        let counted = counted.collect();
        let stiffness = (0..n).map(|k| interface.by_slip[(n + k) * n + k].abs()).collect();
        let now = Front { slips: vec![0.0; n], states, radiation, radiated: vec![0.0; n] };
        let (since, last, rates) = (0.0, vec![0.0; n], Vec::new());
        let mut one = Self { interface, tolerance, start, since, last, now, rates, counted, stiffness };
        one.rates = one.rates_of(&one.now);
        one
    }

    /// Current rates.
    pub fn now(&self) -> &[Rates] {
        &self.rates
    }

    /// Slips since t₀.
    pub fn slips(&self) -> &[f64] {
        &self.now.slips
    }

    /// State of the law of a point.
    pub fn state(&self, k: usize) -> &FrictionState {
        &self.now.states[k]
    }

    /// Energy radiated by a point since t₀ [F/L].
    pub fn radiated(&self, k: usize) -> f64 {
        self.now.radiated[k]
    }

    /// Current p and −τ, minus those at t₀.
    pub fn tractions(&self) -> Vec<f64> {
        self.interface.tractions(self.start + self.since, self.since, &self.now.slips)
    }

    fn rates_of(&self, front: &Front) -> Vec<Rates> {
        let of = |k: usize| {
            let (radiation, state) = (front.radiation[k], &front.states[k]);
            let slip_rate = radiation / self.interface.points[k].0.radiation;
            let (traction, pressure) = (state.traction, state.pressure);
            Rates { slip_rate, evolution: Default::default(), traction, bond: 0.0, pressure, radiation }
        };
        (0..front.slips.len()).map(of).collect()
    }

    /// Tries a step of length `h`.
    pub fn attempt(&mut self, h: f64) -> Tried {
        let (mut rows, mut error, mut worst) = (Vec::<Vec<f64>>::new(), f64::INFINITY, 0);
        for j in 1..=MOST_ROWS {
            let front = match self.several(h, j) {
                Ok(front) => front,
                Err(Unsolved(worst)) => {
                    let rates = self.rates[worst];
                    return Tried::Refused { share: SHARES[0], worst, rates };
                }
            };
            let mut entry = flattened(&front);
            let mut row = vec![entry.clone()];
            for (k, above) in rows.iter().enumerate() {
                let factor = 1.0 / (j as f64 / (j - k - 1) as f64 - 1.0);
                let changes: Vec<f64> =
                    entry.iter().zip(above).map(|(entry, above)| (entry - above) * factor).collect();
                (error, worst) = self.error(&changes, &front);
                entry.iter_mut().zip(&changes).for_each(|(entry, change)| *entry += change);
                row.push(entry.clone());
            }
            rows = row;
            if j > 1 && error <= self.tolerance {
                let share = (SAFETY * (self.tolerance / error).powf(1.0 / j as f64)).clamp(SHARES[0], SHARES[1]);
                if let Err(worst) = self.accept(&entry, front, h) {
                    let rates = self.rates[worst];
                    return Tried::Refused { share: SHARES[0], worst, rates };
                }
                return Tried::Taken(share);
            }
            if error > HOPELESS[j - 1] * self.tolerance {
                break;
            }
        }
        let share = (SAFETY * (self.tolerance / error).powf(1.0 / MOST_ROWS as f64)).clamp(SHARES[0], 0.5);
        Tried::Refused { share, worst, rates: self.rates[worst] }
    }

    /// A step by so many steps of first order.
    fn several(&self, h: f64, count: usize) -> Result<Front, Unsolved> {
        let mut front = self.now.clone();
        for i in 0..count {
            let ends = [i, i + 1].map(|i| self.since + h * i as f64 / count as f64);
            front = self.single(&front, ends)?;
        }
        Ok(front)
    }

    /// One step of first order, between two times since t₀.
    fn single(&self, from: &Front, ends: [f64; 2]) -> Result<Front, Unsolved> {
        let n = from.slips.len();
        let dt = ends[1] - ends[0];
        let damping = |k: usize| self.interface.points[k].0.radiation / dt;
        let mut steps: Vec<f64> = (0..n).map(|k| from.radiation[k] / damping(k)).collect();
        for _ in 0..MOST_ITERATIONS {
            let slips: Vec<f64> = from.slips.iter().zip(&steps).map(|(old, step)| old + step).collect();
            let answers = self.answers(from, ends, &steps, &slips)?;
            let size = |k: &usize| answers[*k].residual.abs() / answers[*k].response.state.pressure;
            let Some(worst) = (0..n).max_by(|a, b| size(a).total_cmp(&size(b))) else { return Ok(from.clone()) };
            if size(&worst) <= SOLVED * self.tolerance {
                let radiation: Vec<f64> = (0..n).map(|k| damping(k) * steps[k]).collect();
                let radiated = |k: usize| from.radiated[k] + 0.5 * (from.radiation[k] + radiation[k]) * steps[k];
                let radiated = (0..n).map(radiated).collect();
                let states = answers.into_iter().map(|answer| answer.response.state).collect();
                return Ok(Front { slips, states, radiation, radiated });
            }
            let mut corrections: Vec<f64> = answers.iter().map(|answer| answer.residual).collect();
            let slope = |(k, Answered { response, .. }): (usize, &Answered)| {
                [response.dtraction_dslip + damping(k), response.dtraction_dpressure]
            };
            let slopes: Vec<[f64; 2]> = answers.iter().enumerate().map(slope).collect();
            if self.solve(&slopes, &mut corrections).is_none() || corrections.iter().any(|by| !by.is_finite()) {
                return Err(Unsolved(worst));
            }
            steps.iter_mut().zip(&corrections).for_each(|(step, by)| *step -= by);
        }
        Err(Unsolved((0..n).max_by(|a, b| steps[*a].abs().total_cmp(&steps[*b].abs())).unwrap_or(0)))
    }

    /// Responses of all points to their slips in a step, and the residuals of (3).
    fn answers(
        &self,
        from: &Front,
        [before, since]: [f64; 2],
        steps: &[f64],
        slips: &[f64],
    ) -> Result<Vec<Answered>, Unsolved> {
        let (n, now, dt) = (slips.len(), self.start + since, since - before);
        let changes = self.interface.tractions(now, since, slips);
        let ask = |k: usize| -> Option<Answered> {
            let (pair, slave, start) = self.interface.points[k];
            let pressure = start.friction.pressure + changes[k];
            let sliding = Sliding { slip: steps[k], pressure, dt };
            let asked = pair.ask_law(slave, [now - dt, now], |law| law.respond(&from.states[k], sliding));
            let response = asked.and_then(|answer| answer).ok()?;
            let load = start.shear() + start.radiation - changes[n + k];
            let residual = response.state.traction + pair.radiation / dt * steps[k] - load;
            (pressure > 0.0).then_some(Answered { response, residual })
        };
        let answers: Vec<Option<Answered>> = (0..n).into_par_iter().with_min_len(PART).map(ask).collect();
        match answers.iter().position(Option::is_none) {
            Some(worst) => Err(Unsolved(worst)),
            None => Ok(answers.into_iter().flatten().collect()),
        }
    }

    /// Solves with the tangent of (3), ∂q/∂Δu + η/Δt on the diagonal, ∂q/∂p of the pressures, and Y.
    fn solve(&self, slopes: &[[f64; 2]], right: &mut [f64]) -> Option<()> {
        let (n, y) = (slopes.len(), self.interface.by_slip);
        let column = |j: usize| {
            (0..n).map(move |k| {
                let own = if k == j { slopes[k][0] } else { 0.0 };
                own + slopes[k][1] * y[k * n + j] + y[(n + k) * n + j]
            })
        };
        let mut matrix = DenseLu::default();
        matrix.factorize_columns(n, (0..n).flat_map(column).collect()).ok()?;
        matrix.solve_columns(right);
        Some(())
    }

    /// e of changes of the extrapolated numbers, and the point at which it occurs.
    fn error(&self, changes: &[f64], front: &Front) -> (f64, usize) {
        let mut largest = (0.0f64, 0);
        for (k, own) in changes.chunks_exact(PER_POINT).enumerate() {
            let pressure = front.states[k].pressure;
            let of_slip = self.stiffness[k] * own[0].abs() / pressure;
            let of_traction = own[1].abs() / pressure;
            let variables = own[5..].iter().zip(self.counted[k]);
            let of_variables = variables.filter(|(_, counts)| *counts).map(|(change, _)| change.abs());
            let error = of_variables.fold(of_slip.max(of_traction), f64::max);
            if error > largest.0 || error.is_nan() {
                largest = (error, k);
            }
        }
        largest
    }

    /// Accepts the extrapolated numbers; rates are those that balance the tractions. Returns a point that has opened.
    fn accept(&mut self, entry: &[f64], fine: Front, h: f64) -> Result<(), usize> {
        let since = self.since + h;
        let mut front = fine;
        let n = front.slips.len();
        front.slips = entry.chunks_exact(PER_POINT).map(|own| own[0]).collect();
        let changes = self.interface.tractions(self.start + since, since, &front.slips);
        for (k, own) in entry.chunks_exact(PER_POINT).enumerate() {
            let start = self.interface.points[k].2;
            let pressure = start.friction.pressure + changes[k];
            if pressure <= 0.0 {
                return Err(k);
            }
            let before = self.now.states[k].plastic_slip;
            let state = &mut front.states[k];
            state.variables.values_mut().zip(&own[5..]).for_each(|(to, from)| *to = *from);
            (state.traction, state.pressure) = (own[1], pressure);
            (state.plastic_slip, state.plastic_increment, state.dissipation) = (own[2], own[2] - before, own[3]);
            front.radiated[k] = own[4];
            front.radiation[k] = start.shear() + start.radiation - changes[n + k] - own[1];
        }
        self.last = front.slips.iter().zip(&self.now.slips).map(|(new, old)| new - old).collect();
        (self.since, self.now) = (since, front);
        self.rates = self.rates_of(&self.now);
        Ok(())
    }
}

/// The numbers of all points that are extrapolated.
fn flattened(front: &Front) -> Vec<f64> {
    let mut all = Vec::with_capacity(PER_POINT * front.slips.len());
    for (k, state) in front.states.iter().enumerate() {
        all.extend([front.slips[k], state.traction, state.plastic_slip, state.dissipation, front.radiated[k]]);
        all.extend(state.variables.values().take(VARIABLES));
    }
    all
}
