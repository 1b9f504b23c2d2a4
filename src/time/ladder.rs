//! Lengths of increments that are used again and again: where linear bodies are condensed on contacts, what was eliminated
//! for one length serves for all increments of it.
//!
//! ```text
//! Δt = Δt₀ 2^(k/4),  k whole;   Δt₀: the initial increment of the step
//! ```
//!
//! Rounded down by a fifth at most, a tenth in the mean.

use crate::model::{Increments, Step};
use crate::solve::Workspace;

/// 2^(k/4), k = 0 … 3.
const RUNGS: [f64; 4] = [1.0, 1.189_207_115_002_721, std::f64::consts::SQRT_2, 1.681_792_830_507_429];

/// Share of a rung by which rounding may have missed it.
const ROUND_OFF: f64 = 1e-12;

/// Δt of the next attempt in a dynamic step, from what its error or its iterations ask for.
pub fn on_ladder(step: &Step, dt: f64, work: &Workspace) -> f64 {
    let Increments { initial, min, .. } = step.increments;
    let climbs = step.scheme.is_dynamic() && work.condenses(step);
    if climbs { rung(initial, dt).max(min) } else { dt }
}

/// The longest length of the ladder from `first` on that is no longer than `dt`.
fn rung(first: f64, dt: f64) -> f64 {
    let reached = dt * (1.0 + ROUND_OFF);
    if !(first.is_normal() && dt.is_normal() && first > 0.0 && dt > 0.0) {
        return dt;
    }
    let mut octave = first;
    while octave > reached {
        octave *= 0.5;
    }
    while 2.0 * octave <= reached {
        octave *= 2.0;
    }
    RUNGS.iter().map(|rung| rung * octave).rfind(|rung| *rung <= reached).unwrap_or(octave)
}
