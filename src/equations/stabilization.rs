//! Dashpots that stabilize a static step and fade away in it.
//!
//! ```text
//! f = −c₀ (1 − share of the step that has passed) (u − u₀)/Δt
//! ```

use super::dependence::Dependence;
use super::sums::Sums;
use super::trial::Trial;
use crate::model::Step;

/// They fade with time.
pub(super) fn dependence(step: &Step) -> Dependence {
    if step.stabilization.is_empty() { Dependence::Nothing } else { Dependence::Time }
}

/// Subtract their forces, which count as `damping`; returns their norm.
pub(super) fn add(trial: Trial, u: &[f64], damping: &mut [f64], sums: &mut Sums) -> f64 {
    let left = trial.stabilization_left();
    if trial.dt == 0.0 || left == 0.0 {
        return 0.0;
    }
    let mut squares = 0.0;
    for (dof, start) in trial.step.stabilization.iter().enumerate() {
        let coefficient = left * start / trial.dt;
        let pull = -coefficient * (u[dof] - trial.old.displacement[dof]);
        sums.add(dof, -pull);
        damping[dof] += pull;
        squares += pull * pull;
        sums.stiffen(dof / 2, (dof % 2, dof % 2), coefficient);
    }
    squares.sqrt()
}

/// Dissipated in an increment, a part of what all dashpots dissipate: ∫ c v² dt [F·L].
pub fn dissipated(step: &Step, [t0, t1]: [f64; 2], way: impl Fn(usize) -> f64) -> f64 {
    let left = 1.0 - step.span.share(t1);
    let work: f64 = step.stabilization.iter().enumerate().map(|(dof, c)| c * way(dof) * way(dof)).sum();
    if work == 0.0 { 0.0 } else { left * work / (t1 - t0) }
}
