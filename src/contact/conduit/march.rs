//! The pressure at the end of an increment: (1) of [`super::channel`] in as many steps as its error asks for.
//!
//! ```text
//! V (S (p₁ − p₀) + w₁ − w₀) = h (Σ T̄/η b/ℓ (p_j − p_i) + V Q + wells − V c (p₁ − p̄))       all at the end of a step: implicit Euler (4)
//! p = 2 p_½½ − p_1,   e = |p_½½ − p_1|          p_1: by one step, p_½½: by two of half the length                       (5)
//! ```
//! (5) is of second order and, as every volume is a linear combination of two that balance, keeps the balance. It undershoots by e at most,
//! which is bounded. The steps end at the corners of wells. Within an increment the surfaces change linearly from what they were to what they
//! are at its end; where they give way to the water, by a known compliance c_w, they follow its pressure:
//!
//! ```text
//! w(t) = w₀ + s (w₁ − w₀ − c_w (p̂₁ − p₀)) + c_w (p(t) − p₀)        p̂₁: pressure by which w₁ was found, s = 0 … 1            (6)
//! ```

use super::channel::{Amounts, Conduit, Gives, Wall};
use super::line::Room;

/// Motion of the walls of a conduit in an increment.
#[derive(Clone, Copy, Debug)]
pub struct WallMotion<'a> {
    /// Start and end [T]
    pub span: [f64; 2],
    /// At every node at the start and at the end
    pub walls: [&'a [Wall]; 2],
    /// Rates at the start, from which the change bends to that at the end; it is linear if not given
    pub rates: Option<&'a [Wall]>,
    /// c_w and p̂₁ of every node; none give way if empty [L³/F], [F/L²]
    pub gives_way: [&'a [f64]; 2],
    /// Ends of the steps that are made, as another run has made them; if not given, as many as the error asks for [T]
    pub steps: Option<&'a [f64]>,
}

impl WallMotion<'_> {
    /// s
    fn share(&self, time: f64) -> f64 {
        let [start, end] = self.span;
        if end > start { (time - start) / (end - start) } else { 1.0 }
    }

    /// The surfaces at a node.
    fn wall(&self, node: usize, share: f64) -> Wall {
        let [from, to] = self.walls.map(|walls| walls[node]);
        let linear = from.combined(1.0 - share, to, share);
        let Some(rates) = self.rates else { return linear };
        // from + r Δt s + (to − from − r Δt) s²
        let way = self.span[1] - self.span[0];
        let bend = share - share * share;
        let straight = to.combined(1.0, from, -1.0);
        linear.combined(1.0, rates[node].combined(way, straight, -1.0), bend)
    }

    fn compliance(&self, node: usize) -> f64 {
        self.gives_way[0].get(node).copied().unwrap_or(0.0)
    }
}

/// Water at the end of an increment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reached {
    /// p of every node [F/L²]
    pub pressure: Vec<f64>,
    /// Volumes in the increment
    pub amounts: Amounts,
    /// Ends of the steps [T]
    pub steps: Vec<f64>,
}

impl Reached {
    /// Takes a step.
    fn take(&mut self, end: f64, Found { pressure, amounts, .. }: Found) {
        self.pressure = pressure;
        self.amounts = self.amounts.combined(1.0, amounts, 1.0);
        self.steps.push(end);
    }
}

/// A pressure that no step was short enough for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooFast {
    /// Time that was reached [T]
    pub time: f64,
    /// Length of the last step [T]
    pub step: f64,
}

/// e that is allowed, over the largest change of the pressure since the start of the run [-]
const TOLERANCE: f64 = 1e-4;

/// e that is round-off, over the largest pressure [-]
const ROUND_OFF: f64 = 1e-12;

/// Most steps of an increment.
const MOST_STEPS: usize = 100_000;

/// Shortest step over the increment: below it a pressure that jumps in time is taken as it is.
const SHORTEST: f64 = 1e-9;

/// Smallest and largest ratio of successive steps, and safety on what the error allows.
const SHARES: [f64; 2] = [0.1, 4.0];
const SAFETY: f64 = 0.8;

impl Conduit {
    /// Pressures at the end of an increment from those at its start.
    ///
    /// # Errors
    /// Returns [`TooFast`] if a pressure is not finite, or steps would have to be too short.
    pub fn march(&self, start: &[f64], motion: &WallMotion) -> Result<Reached, TooFast> {
        let [from, to] = motion.span;
        let mut stops: Vec<f64> = self.corners().filter(|corner| from < *corner && *corner < to).collect();
        stops.push(to);
        stops.sort_by(f64::total_cmp);
        stops.dedup();
        let mut reached = Reached { pressure: start.to_vec(), ..Reached::default() };
        let mut room = Steps::default();
        let (mut time, mut next) = (from, to - from);
        if let Some(steps) = motion.steps {
            for &end in steps {
                let found = self.two_ways(&reached.pressure, start, [time, end], motion, &mut room);
                let step = end - time;
                if !found.error.is_finite() {
                    return Err(TooFast { time, step });
                }
                reached.take(end, found);
                time = end;
            }
            return Ok(reached);
        }
        for stop in stops {
            while time < stop {
                let end = if time + next > stop - SHORTEST * (to - from) { stop } else { time + next };
                let found = self.two_ways(&reached.pressure, start, [time, end], motion, &mut room);
                let error = found.error;
                let share = (SAFETY / error.sqrt()).clamp(SHARES[0], SHARES[1]);
                let is_short = end - time <= SHORTEST * (to - from);
                if error <= 1.0 || is_short && error.is_finite() {
                    reached.take(end, found);
                    next = (share * (end - time)).max(if end == stop { next } else { 0.0 });
                    time = end;
                } else {
                    next = if share.is_finite() { share } else { SHARES[0] } * (end - time);
                }
                if reached.steps.len() > MOST_STEPS || !error.is_finite() && is_short {
                    return Err(TooFast { time, step: next });
                }
            }
        }
        Ok(reached)
    }

    /// (5), with e over what is allowed.
    fn two_ways(&self, from: &[f64], start: &[f64], span: [f64; 2], motion: &WallMotion, room: &mut Steps) -> Found {
        let middle = 0.5 * (span[0] + span[1]);
        let (one, whole) = self.step(from, start, span, motion, room);
        let (half, first) = self.step(from, start, [span[0], middle], motion, room);
        let (two, second) = self.step(&half, start, [middle, span[1]], motion, room);
        let halves = first.combined(1.0, second, 1.0);
        let [mut error, mut scale, mut largest] = [0.0f64; 3];
        for node in 0..from.len() {
            error = nan_max(error, (two[node] - one[node]).abs());
            scale = scale.max((two[node] - self.initial[node]).abs()).max((from[node] - self.initial[node]).abs());
            largest = largest.max(two[node].abs());
        }
        let allowed = TOLERANCE * scale + ROUND_OFF * largest;
        let error = if error == 0.0 { 0.0 } else { error / allowed };
        let pressure = two.iter().zip(&one).map(|(two, one)| 2.0 * two - one).collect();
        let amounts = halves.combined(2.0, whole, -1.0).with_throughput(halves.throughput);
        Found { pressure, amounts, error }
    }

    /// (4) for the change of the pressure, and the volumes in a step. What joins two nodes counts by the difference of their pressures, and a
    /// second solution takes off what round-off has left: so the balance does not feel how well nodes are joined.
    fn step(
        &self,
        from: &[f64],
        start: &[f64],
        span: [f64; 2],
        motion: &WallMotion,
        room: &mut Steps,
    ) -> (Vec<f64>, Amounts) {
        let mut amounts = self.set_up(from, start, span, motion, room);
        let Steps { joints, own_part, diagonal, right, prescribed, way, left, room } = room;
        way.clone_from(right);
        self.line.solve(diagonal, joints, prescribed, way, room);
        self.left_over(way, joints, own_part, right, left);
        for (prescribed, left) in prescribed.iter_mut().zip(&mut *left) {
            // What is left at a prescribed node is what its well gives.
            if prescribed.is_some() {
                amounts.injected -= *left;
                amounts.throughput += left.abs();
                *prescribed = Some(0.0);
            }
        }
        self.line.solve(diagonal, joints, prescribed, left, room);
        let pressure: Vec<f64> = (0..from.len()).map(|node| from[node] + (way[node] + left[node])).collect();
        if let Some(leak) = &self.leak {
            let h = span[1] - span[0];
            for ((length, p), outside) in self.line.lengths().iter().zip(&pressure).zip(&leak.pressure) {
                let out = length * h * leak.coefficient * (p - outside);
                amounts.leaked += out;
                amounts.throughput += out.abs();
            }
        }
        (pressure, amounts)
    }

    /// Sets up (4), without what flows between nodes on the right side; returns the volumes that are known.
    fn set_up(
        &self,
        from: &[f64],
        start: &[f64],
        [t0, t1]: [f64; 2],
        motion: &WallMotion,
        room: &mut Steps,
    ) -> Amounts {
        let (h, n) = (t1 - t0, self.line.count());
        let shares = [t0, t1].map(|time| motion.share(time));
        let Steps { joints, own_part, diagonal, right, prescribed, .. } = room;
        [&mut *joints, &mut *own_part, &mut *right].into_iter().for_each(Vec::clear);
        joints.resize(n, 0.0);
        let mut amounts = Amounts::default();
        let coefficient = self.leak.as_ref().map_or(0.0, |leak| leak.coefficient);
        let mut transmissivity = Vec::with_capacity(n);
        for (node, (length, holds)) in self.line.lengths().iter().zip(&self.holds).enumerate() {
            let [before, after] = shares.map(|share| motion.wall(node, share));
            transmissivity.push(self.transmissivity.at(node, after));
            let (softness, predicted) = (motion.compliance(node), motion.gives_way[1].get(node).copied());
            let foreseen =
                softness * predicted.map_or(0.0, |predicted| predicted - start[node]) * (shares[1] - shares[0]);
            let source = self.source.as_ref().map_or(0.0, |source| h * source(self.line.nodes[node], t1));
            let leaks = self.leak.as_ref().map_or(0.0, |leak| h * coefficient * (leak.pressure[node] - from[node]));
            own_part.push(length * (self.storage + h * coefficient) + holds * softness);
            right.push(length * (source + leaks) + holds * (before.opening - after.opening + foreseen));
            amounts.injected += length * source;
            amounts.throughput += (length * source).abs();
        }
        diagonal.clone_from(own_part);
        for (a, b, joint) in self.line.joints() {
            joints[a] = h * joint * 0.5 * (transmissivity[a] + transmissivity[b]) / self.viscosity;
            diagonal[a] += joints[a];
            diagonal[b] += joints[a];
            let flows = joints[a] * (from[a] - from[b]);
            right[a] -= flows;
            right[b] += flows;
        }
        prescribed.clear();
        prescribed.resize(n, None);
        let middle = 0.5 * (t0 + t1);
        for well in self.wells.iter().filter(|well| well.is_open(middle)) {
            match &well.gives {
                Gives::Pressure(pressure) => prescribed[well.at[0].0] = Some(pressure(t1) - from[well.at[0].0]),
                Gives::Rate(rate) => {
                    let volume = h * rate(t1);
                    well.at.iter().for_each(|&(node, share)| right[node] += share * volume);
                    amounts.injected += volume;
                    amounts.throughput += volume.abs();
                }
            }
        }
        amounts
    }

    /// What (4) leaves after a change of the pressure: at the prescribed nodes less what their wells give.
    fn left_over(&self, way: &[f64], joints: &[f64], own_part: &[f64], right: &[f64], left: &mut Vec<f64>) {
        left.clear();
        left.extend(right.iter().zip(own_part).zip(way).map(|((right, own), way)| right - own * way));
        for (a, b, _) in self.line.joints() {
            let flows = joints[a] * (way[a] - way[b]);
            left[a] -= flows;
            left[b] += flows;
        }
    }
}

/// The larger, or what is no number.
fn nan_max(most: f64, value: f64) -> f64 {
    if value.is_nan() || value > most { value } else { most }
}

/// What (5) has found.
struct Found {
    pressure: Vec<f64>,
    amounts: Amounts,
    error: f64,
}

/// Memory of the steps.
#[derive(Default)]
struct Steps {
    joints: Vec<f64>,
    /// The diagonal without what joins nodes
    own_part: Vec<f64>,
    diagonal: Vec<f64>,
    right: Vec<f64>,
    prescribed: Vec<Option<f64>>,
    /// Change of the pressure, and what it leaves
    way: Vec<f64>,
    left: Vec<f64>,
    room: Room,
}
