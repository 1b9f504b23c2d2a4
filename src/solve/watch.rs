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
    /// Whether a body may be found that nothing holds: a step begins, or its stabilization has just ended
    pub seeks_floating: bool,
    /// Settings of Newton's method
    pub settings: newton::Settings,
    /// Factor of the penalties
    stiffening: f64,
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
    pub fn new(model: &Model, trial: Trial, begins: bool, extrapolated: bool) -> Self {
        let Trial { old, step, stiffening, .. } = trial;
        let unaided =
            old.last_increment.is_none() || (!step.stabilization.is_empty() && trial.stabilization_left() == 0.0);
        let tolerance = model.newton.tolerance;
        let settings = newton::Settings {
            tolerance: if stiffening < 1.0 { tolerance.max(ROUGHLY) } else { tolerance },
            max_iterations: model.newton.max_iterations,
            old_tangents: model.aids.old_tangents,
            downhill: model.aids.downhill,
            gives_up: step.scheme.is_dynamic() && trial.may_be_shortened(),
        };
        let seeks_floating = begins && unaided;
        let (flips, acted) = (Flips::default(), Acted::default());
        let (tangents, floating, foreseen, seen, records) = (0, None, None, Vec::new(), Vec::new());
        Self {
            begins,
            seeks_floating,
            settings,
            stiffening,
            extrapolated,
            tangents,
            seen,
            flips,
            floating,
            foreseen,
            acted,
            records,
        }
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
            let [stiffening, softening] = [self.stiffening > 1.0, self.stiffening < 1.0].map(usize::from);
            let start = usize::from(self.extrapolated && self.records.is_empty() && self.tangents == 0);
            self.acted = Acted { stiffening, softening, start, ..acted };
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
