//! The tangent is the derivative of the residual.

use fecontact::equations::{Assembler, Trial, supports};
use fecontact::model::Model;

use super::*;
use crate::record::{Solved, increments};

/// Some increments of implicit steps, displaced at random from their ends, so that no contact point is where its equations have a kink:
/// the tangent without predictions is the difference of the residual along random directions that followers take with their leaders. A draw
/// may still meet a kink, so that one of a few must agree.
pub(super) fn tangents(base: &Base) -> Outcome {
    let solved = increments(&model::case(base.draft, &base.ways));
    let implicit: Vec<&Solved> =
        solved.iter().filter(|solved| !solved.step.scheme.is_integrated_explicitly()).collect();
    let every = implicit.len().div_ceil(INCREMENTS).max(1);
    let mut worst = Outcome::Idle;
    for solved in implicit.into_iter().rev().step_by(every) {
        let Some(least) = least_error(solved) else { continue };
        if least.share > SAME_TANGENT {
            return Outcome::Broken(least);
        }
        worst = Outcome::Holds;
    }
    worst
}

/// The least error of a few draws, up to the first that agrees.
fn least_error(solved: &Solved) -> Option<Difference> {
    let mut least: Option<Difference> = None;
    for found in (0..DRAWS).filter_map(|draw| error(solved, draw)) {
        let agrees = found.share <= SAME_TANGENT;
        if least.as_ref().is_none_or(|least| found.share < least.share) {
            least = Some(found);
        }
        if agrees {
            break;
        }
    }
    least
}

/// The largest difference of an equation of forces or of water, relative to its tangent along the directions; none where the equations
/// have no value.
fn error(Solved { model, step, old, new }: &Solved, draw: usize) -> Option<Difference> {
    let trial = Trial::new(old, step, new.time, new.time - old.time).ahead();
    let mut assembler = Assembler::new(model);
    let mut system = assembler.system();
    let away = arbitrary(u64::MAX, draw, model);
    let u: Vec<f64> = new.displacement.iter().zip(&away).map(|(u, away)| u + AWAY * away).collect();
    assembler.tangent(trial, &u, false, &mut system).ok()?;
    let tangent = system.tangent.clone();
    let mut rows = vec![[0.0f64; 2]; u.len()];
    for direction in 0..DIRECTIONS {
        let way = arbitrary(direction, draw, model);
        let mut residual = |share: f64| {
            let there: Vec<f64> = u.iter().zip(&way).map(|(u, way)| u + share * way).collect();
            assembler.residual(trial, &there, &mut system).ok().map(|()| system.residual.clone())
        };
        let [minus_two, minus, plus, plus_two] =
            [residual(-2.0 * STEP)?, residual(-STEP)?, residual(STEP)?, residual(2.0 * STEP)?];
        for (dof, by_tangent) in tangent.multiply(&way).into_iter().enumerate() {
            // Of fourth order: a law's third derivative by the rate of slip is large where it is slow.
            let difference = (8.0 * (plus[dof] - minus[dof]) - (plus_two[dof] - minus_two[dof])) / (12.0 * STEP);
            let [error, size] = &mut rows[dof];
            *error = error.max((difference - by_tangent).abs());
            *size = size.max(by_tangent.abs());
        }
    }
    let fixed = supports::fixed(model, step);
    let shares = rows.iter().enumerate().filter(|(dof, [error, _])| !fixed[*dof] && *error > 0.0);
    let (dof, share) = shares.map(|(dof, [error, size])| (dof, error / size)).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let place = format!("tangent at dof {dof} of {} in step {} at t = {}", u.len(), step.name, new.time);
    Some(Difference { share, place, values: rows[dof] })
}

/// Numbers between −1 and 1, copies of nodes with those of their originals, which alone have columns, and followers with their leaders.
fn arbitrary(which: u64, draw: usize, model: &Model) -> Vec<f64> {
    let seed = which ^ ((draw as u64) << 32);
    let one = |k: usize| 2.0 * (hash(seed, &k.to_string()) >> 11) as f64 / (1u64 << 53) as f64 - 1.0;
    let mut all: Vec<f64> = (0..model.dofs()).map(one).collect();
    model.linkage.spread(&mut all);
    model.ties.spread(2, &mut all);
    all
}

/// So many increments of a run are looked at.
const INCREMENTS: usize = 4;
const DRAWS: usize = 3;
const DIRECTIONS: u64 = 3;

/// Random displacements, in edges of which models have a few: larger than the increments of differences.
const AWAY: f64 = 1e-4;
const STEP: f64 = 1e-7;

/// Largest difference of a row relative to it: differences leave round-off.
const SAME_TANGENT: f64 = 1e-5;
