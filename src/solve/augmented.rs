//! The augmented Lagrangian: multipliers that leave no more penetration than allowed.

use super::equilibrium::equilibrium;
use super::failure::IncrementFailure;
use super::{IterationRecord, Workspace};
use crate::equations::Trial;
use crate::model::Model;
use crate::model::state::State;

/// Solutions with better and better multipliers before an increment of the augmented Lagrangian is given up.
const MOST_PASSES: usize = 100;

/// A pass that leaves more than this share of the penetration is slow: the next one is stiffer.
const SLOW: f64 = 0.25;

/// How much stiffer.
const STIFFER: f64 = 10.0;

/// α_n is not raised to more than this many times the given one.
const STIFFEST: f64 = 1e4;

/// Equilibrium at the time of a trial; where a contact asks for the augmented Lagrangian, with multipliers that leave no
/// more penetration than allowed: Uzawa's method, with a penalty that is raised for the increment while passes gain little: without that a soft
/// penalty takes passes by the dozen, each of which leaves nearly all of the penetration (switch `stiffening`;
/// `aid_stiffening` is 1 in iterations of a raised one).
///
/// Source of the rule and its factors: Bertsekas (1982), Constrained Optimization and Lagrange Multiplier Methods, 2.2.
pub fn augment(
    model: &Model,
    trial: Trial,
    work: &mut Workspace,
) -> (Vec<IterationRecord>, Result<Vec<f64>, IncrementFailure>) {
    let (mut iterations, mut result) = equilibrium(model, trial, None, work);
    let (mut stiffening, mut before) = (1.0, f64::INFINITY);
    for pass in 1.. {
        let Ok(u) = &result else { break };
        let found = &work.assembler.evaluation.contacts;
        let excess = model.contacts.iter().zip(found).map(|(pair, found)| pair.excess(found)).fold(0.0, f64::max);
        if excess <= 1.0 {
            break;
        }
        if pass == MOST_PASSES {
            result = Err(IncrementFailure::Penetration { passes: pass });
            break;
        }
        if model.aids.stiffening && excess > SLOW * before {
            stiffening = (STIFFER * stiffening).min(STIFFEST);
        }
        before = excess;
        let multiplied = model.contacts.iter().zip(trial.old.contacts.iter().zip(found));
        let contacts = multiplied.map(|(pair, (old, found))| pair.multiplied(old, found)).collect();
        let old = State { contacts, ..trial.old.clone() };
        let (more, again) = equilibrium(model, Trial { old: &old, stiffening, ..trial }, Some(u.clone()), work);
        iterations.extend(more.into_iter().map(|iteration| IterationRecord { pass: pass + 1, ..iteration }));
        result = again;
    }
    (iterations, result)
}
