//! Steps of the differential equations with error control.
//!
//! ```text
//! e = max over the points of w |e_x|  and  |∂τ/∂s| |e_s|/p          both in the coefficient of friction; w = |∂(q/p)/∂x|
//! h ← h × 0.9 (tolerance/e)^⅕                                       within a fifth and five times
//! ```

use super::conduits::Conduits;
use super::slip_equations::{Rates, SlipEquations, with_rates};
use crate::laws::friction::{MOST_STATES, States};
use crate::laws::tableau::{A, C, E, STAGES};

/// Safety factor on the length that the error allows.
pub(super) const SAFETY: f64 = 0.9;

/// Smallest and largest ratio of successive step lengths.
pub(super) const SHARES: [f64; 2] = [0.2, 5.0];

/// An accepted step, or the worst point of a rejected one.
pub enum Tried {
    /// Accepted; ratio of the next length to this one
    Taken(f64),
    /// Rejected: the error was too large or a point had no rate; the worst point with its rates
    Refused { share: f64, worst: usize, rates: Rates },
}

/// Integration from one state on.
pub struct Steps<'a> {
    interface: SlipEquations<'a>,
    /// Water that flows along contacts
    pub conduits: Conduits<'a>,
    /// w of the states, and |∂τ/∂s|/p [-], [1/L]
    weights: Vec<(States, f64)>,
    tolerance: f64,
    /// t₀ [T]
    start: f64,
    /// t − t₀ [T]
    pub since: f64,
    /// Slips since t₀, and states of the laws, the first of all points before the second
    pub z: Vec<f64>,
    /// Slips of the last step [L]
    pub last: Vec<f64>,
    /// Energies dissipated by friction and radiated since t₀, per area [F/L]
    pub works: Vec<[f64; 2]>,
    /// Rates at the stages; the first stage is the present state
    rates: Vec<Vec<Rates>>,
    trial: Vec<f64>,
}

impl<'a> Steps<'a> {
    /// Starts at a time.
    pub fn new(mut interface: SlipEquations<'a>, conduits: Conduits<'a>, start: f64, tolerance: f64) -> Self {
        interface.water = conduits.now();
        let n = interface.points.len();
        let state = |&(pair, slave, state): &(_, _, &crate::contact::force::ContactState)| {
            with_rates(pair, slave, start, |law| law.evolving(&state.friction)).unwrap_or([f64::NAN; MOST_STATES])
        };
        let states: Vec<States> = interface.points.iter().map(state).collect();
        let of_laws = (0..MOST_STATES).flat_map(|i| states.iter().map(move |x| x[i]));
        let z = std::iter::repeat_n(0.0, n).chain(of_laws).collect::<Vec<f64>>();
        let weight = |(k, &(pair, slave, state)): (usize, &(_, _, &crate::contact::force::ContactState))| {
            let of_states = with_rates(pair, slave, start, |law| law.weights()).unwrap_or_default();
            (of_states, interface.by_slip[(n + k) * n + k].abs() / state.friction.pressure)
        };
        let weights = interface.points.iter().enumerate().map(weight).collect();
        let mut rates = vec![Vec::new(); STAGES];
        interface.rates(start, 0.0, &z, &mut rates[0]);
        let (trial, last, works) = (z.clone(), vec![0.0; n], vec![[0.0; 2]; n]);
        Self { interface, conduits, weights, tolerance, start, since: 0.0, z, last, works, rates, trial }
    }

    /// Current rates.
    pub fn now(&self) -> &[Rates] {
        &self.rates[0]
    }

    /// Current p and −τ, minus those at t₀.
    pub fn tractions(&self) -> Vec<f64> {
        self.interface.tractions(self.start + self.since, self.since, &self.z[..self.last.len()])
    }

    /// Tries a step of length `h`.
    pub fn attempt(&mut self, h: f64) -> Tried {
        let n = self.last.len();
        self.conduits.foresee(self.start + self.since, h, &self.z[..n], &self.rates[0]);
        let tried = self.go_through(h);
        // What was foreseen is of a step that is refused, or has come true.
        self.interface.water = self.conduits.now();
        tried
    }

    /// Goes through the stages of a step.
    fn go_through(&mut self, h: f64) -> Tried {
        for stage in 1..STAGES {
            self.advance(A[stage], h);
            let since = self.since + C[stage] * h;
            let mut rates = std::mem::take(&mut self.rates[stage]);
            if !self.conduits.is_empty() {
                self.interface.water = self.conduits.at(stage);
            }
            self.interface.rates(self.start + since, since, &self.trial, &mut rates);
            self.rates[stage] = rates;
            if let Some(worst) = self.rates[stage].iter().position(|rates| !rates.is_good()) {
                return Tried::Refused { share: SHARES[0], worst, rates: self.rates[stage][worst] };
            }
        }
        let (error, worst) = self.error(h);
        let share = (SAFETY * (self.tolerance / error).powf(0.2)).clamp(SHARES[0], SHARES[1]);
        if error > self.tolerance {
            return Tried::Refused { share, worst, rates: self.rates[0][worst] };
        }
        self.accept(h);
        Tried::Taken(share)
    }

    /// z + h Σ a_j k_j.
    fn advance(&mut self, a: &[f64], h: f64) {
        let Self { z, trial, rates, last, .. } = self;
        let n = last.len();
        for k in 0..n {
            let sum =
                |of: &dyn Fn(&Rates) -> f64| a.iter().zip(&*rates).map(|(a, rates)| a * of(&rates[k])).sum::<f64>();
            trial[k] = z[k] + h * sum(&|rates| rates.slip_rate);
            for i in 0..MOST_STATES {
                let at = (1 + i) * n + k;
                trial[at] = z[at] + h * sum(&|rates| rates.evolution[i]);
            }
        }
    }

    /// e, and the point at which it occurs.
    fn error(&self, h: f64) -> (f64, usize) {
        let mut largest = (0.0f64, 0);
        for (k, (of_states, of_slip)) in self.weights.iter().enumerate() {
            let sum =
                |of: &dyn Fn(&Rates) -> f64| E.iter().zip(&self.rates).map(|(e, rates)| e * of(&rates[k])).sum::<f64>();
            let states = of_states.iter().enumerate().map(|(i, of)| of * (h * sum(&|rates| rates.evolution[i])).abs());
            let error = states.fold(of_slip * (h * sum(&|rates| rates.slip_rate)).abs(), f64::max);
            if error > largest.0 {
                largest = (error, k);
            }
        }
        largest
    }

    /// The last stage is the state at the end of the step.
    fn accept(&mut self, h: f64) {
        let Self { z, trial, last, works, rates, .. } = self;
        for (k, (last, work)) in last.iter_mut().zip(works).enumerate() {
            *last = trial[k] - z[k];
            for (b, rates) in A[STAGES - 1].iter().zip(&*rates) {
                let powers = rates[k].powers();
                (0..2).for_each(|i| work[i] += h * b * powers[i]);
            }
        }
        std::mem::swap(z, trial);
        rates.swap(0, STAGES - 1);
        self.since += h;
        let n = self.last.len();
        self.conduits.accept(h, &self.z[..n], &self.rates[0]);
    }
}
