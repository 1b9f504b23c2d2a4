//! What Newton's method does in an increment, on all equations or on those of the contacts: its settings, and what is recorded of it.

use super::IterationRecord;
use super::contact_iteration::{Acted, Flips};
use super::newton;
use crate::contact::force::ContactState;
use crate::equations::{Assembler, Trial};
use crate::linear::system::Request;
use crate::model::Model;

/// Monitor of the solution of an increment.
pub struct Watch {
    /// Whether it is a new increment
    pub begins: bool,
    /// Whether its start value extrapolates the last one
    extrapolated: bool,
    /// Number of tangents of the present solution
    pub tangents: usize,
    /// Record after each correction of the present solution, without the correction itself
    seen: Vec<IterationRecord>,
    flips: Flips,
    /// Motion of a body that nothing holds
    pub floating: Option<String>,
    /// Contact states if the motion before the increment had gone on
    pub foreseen: Option<Vec<Vec<ContactState>>>,
    /// Aids that acted in the tangent since the last correction
    acted: Acted,
    /// Record of all linear solves
    pub records: Vec<IterationRecord>,
}

impl Watch {
    /// Begins it, at a new increment or not, from an extrapolated start value or not.
    pub fn new(begins: bool, extrapolated: bool) -> Self {
        let (flips, acted) = (Flips::default(), Acted::default());
        let (floating, foreseen, seen, records) = (None, None, Vec::new(), Vec::new());
        Self { begins, extrapolated, tangents: 0, seen, flips, floating, foreseen, acted, records }
    }

    /// Records the state of the equations after their evaluation.
    pub fn note(&mut self, request: Request, assembler: &Assembler, forces: f64, acted: Acted) {
        // The start value extrapolates the last increment; where there is none, the first linear solve predicts the motion.
        let foresight = if self.extrapolated { 0 } else { 1 };
        let predicts = self.begins && self.records.is_empty() && self.tangents == foresight;
        if predicts && request == Request::Residual && self.foreseen.is_none() {
            self.foreseen = Some(assembler.evaluation.contacts.clone());
        }
        if request == Request::Tangent {
            self.acted = acted;
            self.acted.start = usize::from(self.extrapolated && self.records.is_empty() && self.tangents == 0);
            self.tangents += 1;
        } else if self.tangents > 0 && request == Request::Residual {
            let evaluation = &assembler.evaluation;
            self.seen.push(IterationRecord {
                contacts: assembler.contact_counts(),
                flips: self.flips.count(&evaluation.contacts),
                stabilization: evaluation.stabilization / forces.max(f64::MIN_POSITIVE),
                acted: std::mem::take(&mut self.acted),
                ..IterationRecord::default()
            });
        }
    }

    /// Stores the iterations of a solution with the record after each.
    pub fn record(&mut self, iterations: Vec<newton::Iteration>) {
        let mut seen = std::mem::take(&mut self.seen);
        self.tangents = 0;
        // The last state may not have been evaluated.
        seen.resize(iterations.len(), IterationRecord::default());
        let record = |(newton, seen): (newton::Iteration, IterationRecord)| {
            let acted = Acted { downhill: usize::from(newton.searched), ..seen.acted };
            IterationRecord { newton, pass: 1, acted, ..seen }
        };
        self.records.extend(iterations.into_iter().zip(seen).map(record));
    }
}

/// ‖r‖/‖f‖ required of an initial guess [-]
const ROUGHLY: f64 = 1e-2;

/// Required ‖r‖/‖f‖ of every part of a solution, or of an initial guess [-]
pub fn tolerance(model: &Model, stiffening: f64) -> f64 {
    if stiffening < 1.0 { model.newton.tolerance.max(ROUGHLY) } else { model.newton.tolerance }
}

pub fn settings(model: &Model, trial: Trial) -> newton::Settings {
    newton::Settings {
        tolerance: tolerance(model, trial.stiffening),
        max_iterations: model.newton.max_iterations,
        old_tangents: model.aids.old_tangents,
        downhill: model.aids.downhill,
        saddle: model.saddle(),
        gives_up: trial.step.scheme.is_dynamic() && trial.step.shorter(trial.dt, 1).is_some(),
    }
}

/// Whether a step begins, or its stabilization has just ended.
pub fn is_unaided(trial: Trial) -> bool {
    let Trial { old, step, .. } = trial;
    old.last_increment.is_none() || (!step.stabilization.is_empty() && trial.stabilization_left() == 0.0)
}

/// Aids that acted on contact points, with the modified penalties of the trial.
pub fn in_trial(stiffening: f64, acted: Acted) -> Acted {
    Acted { stiffening: usize::from(stiffening > 1.0), softening: usize::from(stiffening < 1.0), ..acted }
}
