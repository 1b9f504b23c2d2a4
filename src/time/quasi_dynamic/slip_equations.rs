//! The differential equations of an interface on linear bodies, point by point.
//!
//! ```text
//! ṡ = V,   ẋ = ẋ(V, x)                         s: slip, x: states of the law                                        (1)
//! τ = q(V, x, p) + q_b + η V                    solved for V at every point; q_b = s(Λ) sgn τ: a bond, 0 without one     (2)
//! (p, −τ) = (p, −τ)₀ + Y s + Z (p_w − p_w0) + ẏ (t − t₀)                                                       (3)
//! ```
//! Y, Z: bodies and springs of the contact, ẏ: loading ([`crate::equations::slip_operator`]). The pressure p_w of a fluid is that of the
//! time at which rates are asked for, at every stage of a step.
//!
//! The contact spring α_t, with α_c of a bond in parallel with it, is in series with the slider, its bond and its damper, and these with the bodies.
//! Below its strength s = c_r + (c − c_r) ⟨1 − Λ/D⟩ a bond holds, but for a share of 10⁻¹² of the traction that friction sees.

use rayon::prelude::*;

use crate::contact::{ContactPair, ContactState, SlavePoint};
use crate::laws::friction::{BondState, Cohesion, PointLoad, RateLaw, States};
use crate::mesh::configuration::Configuration;

/// Number of points that one thread takes at a time; no sum depends on their order.
pub(super) const PART: usize = 32;

/// Rates and tractions of a point at a time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rates {
    /// V [L/T]
    pub slip_rate: f64,
    /// ẋ [1/T]
    pub evolution: States,
    /// q of friction and a bond together, p and η V [F/L²]
    pub traction: f64,
    /// q_b [F/L²]
    pub bond: f64,
    /// p [F/L²]
    pub pressure: f64,
    /// η V [F/L²]
    pub radiation: f64,
}

impl Rates {
    /// Whether the point is closed and has a finite slip rate.
    pub fn is_good(&self) -> bool {
        self.pressure > 0.0 && self.slip_rate.is_finite() && self.evolution.iter().all(|rate| rate.is_finite())
    }

    /// Power dissipated by friction, and radiated, per area [F/(L T)].
    pub fn powers(&self) -> [f64; 2] {
        [self.traction * self.slip_rate, self.radiation * self.slip_rate]
    }
}

/// Points of all contacts, starting from one state.
pub struct SlipEquations<'a> {
    /// contact, point and its state at t₀
    pub points: Vec<(&'a ContactPair, &'a SlavePoint, &'a ContactState)>,
    /// Y of (3), row by row
    pub by_slip: &'a [f64],
    /// Z of (3), row by row; empty without a fluid
    pub by_fluid: &'a [f64],
    /// ẏ [F/(L² T)]
    pub loading: &'a [f64],
    /// Reference positions, for p_w
    pub places: Configuration<'a>,
    /// p_w of water that flows at every point, at the time for which rates are asked; empty where none does [F/L²]
    pub water: Vec<f64>,
}

impl SlipEquations<'_> {
    /// All rates at a time after t₀, from the slips since then and the state variables, both in one list; `now` is the run
    /// time.
    pub fn rates(&self, now: f64, since: f64, z: &[f64], rates: &mut Vec<Rates>) {
        let (points, fluid) = (0..self.points.len(), self.fluid(now));
        let all = points.into_par_iter().with_min_len(PART).map(|k| self.point(k, now, since, z, &fluid));
        all.collect_into_vec(rates);
    }

    /// p_w − p_w0 of all points at a time; empty without a fluid.
    fn fluid(&self, now: f64) -> Vec<f64> {
        if self.by_fluid.is_empty() {
            return Vec::new();
        }
        let rise = |(k, (pair, slave, start)): (usize, &(&ContactPair, &SlavePoint, &ContactState))| {
            let flows = pair.conduit.is_some();
            let pressure = if flows { self.water[k] } else { pair.fluid_pressure(slave, &self.places, now) };
            pressure - start.fluid
        };
        self.points.par_iter().enumerate().with_min_len(PART).map(rise).collect()
    }

    /// p and −τ minus those at t₀: one component of one point.
    fn change(&self, row: usize, since: f64, slips: &[f64], fluid: &[f64]) -> f64 {
        let n = slips.len();
        let own = row * n..(row + 1) * n;
        let by_fluid = if fluid.is_empty() { 0.0 } else { dot(&self.by_fluid[own.clone()], fluid) };
        dot(&self.by_slip[own], slips) + self.loading[row] * since + by_fluid
    }

    fn point(&self, k: usize, now: f64, since: f64, z: &[f64], fluid: &[f64]) -> Rates {
        let n = self.points.len();
        let (pair, slave, start) = self.points[k];
        let change = |row: usize| self.change(row, since, &z[..n], fluid);
        let pressure = start.friction.pressure + change(k);
        let traction = start.shear() + start.radiation - change(n + k);
        let free = match strength(pair, slave, start, z[k]) {
            0.0 => traction,
            strength => traction.signum() * (traction.abs() - strength).max(LEAST_FRICTION * traction.abs()),
        };
        let loading = PointLoad { traction: free, pressure, damping: pair.radiation };
        let answer = with_rates(pair, slave, now, |law| {
            let x = std::array::from_fn(|i| z[(1 + i) * n + k]);
            let slip_rate = law.slip_rate(x, loading);
            (slip_rate, law.evolution(x, slip_rate))
        });
        let (slip_rate, evolution) = answer.unwrap_or((f64::NAN, States::default()));
        let radiation = pair.radiation * slip_rate;
        Rates { slip_rate, evolution, traction: traction - radiation, bond: traction - free, pressure, radiation }
    }

    /// p and −τ at t₀ + `since`, minus those at t₀; `now` is the run time.
    pub fn tractions(&self, now: f64, since: f64, slips: &[f64]) -> Vec<f64> {
        let fluid = self.fluid(now);
        (0..2 * slips.len()).map(|row| self.change(row, since, slips, &fluid)).collect()
    }
}

/// Share of the traction that friction sees while a bond holds: laws have no slip rate without traction [-]
const LEAST_FRICTION: f64 = 1e-12;

/// s of a bond in parallel with friction after a slip since t₀; 0 without one [F/L²]
fn strength(pair: &ContactPair, slave: &SlavePoint, start: &ContactState, slip: f64) -> f64 {
    match (&pair.law(slave).cohesion, &start.bond) {
        (Some(Cohesion::Parallel(bond)), Some(state)) => {
            bond.strength_left(&BondState { slip: state.slip + slip.abs(), ..*state })
        }
        _ => 0.0,
    }
}

/// Evaluates the law of a point with its parameters at a time; `None` if they are invalid then.
pub fn with_rates<T>(pair: &ContactPair, slave: &SlavePoint, now: f64, ask: impl Fn(&dyn RateLaw) -> T) -> Option<T> {
    pair.ask_law(slave, [now, now], |law| law.law.rates().map(ask)).ok()?
}

/// Σ a b, vectorized with a fixed order of summation.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let (a_parts, b_parts) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a_parts.remainder().iter().zip(b_parts.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_parts.zip(b_parts) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + rest
}
