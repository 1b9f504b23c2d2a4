//! What stderr is told at the start and at the end of a run.

use std::path::Path;

use crate::model::Model;
use crate::model::scheme::told;
use crate::model::state::Energy;
use crate::output::summary::Summary;
use crate::run::SavedRun;

/// What has been told so far.
pub(super) struct Told {
    /// whether nothing is to be told
    quiet: bool,
    /// warnings so far
    warnings: usize,
}

impl Told {
    /// Before the first increment: warnings and choices, or from where a run goes on. Damage is told in any case.
    pub fn start(model: &Model, damage: Option<&str>, saved: Option<&SavedRun>, quiet: bool) -> Self {
        if let Some(damage) = damage {
            say!("warning: {damage}; the checkpoint before it is taken");
        }
        let warnings = model.warnings();
        match saved.map(|saved| saved.simulation().state()) {
            _ if quiet => {}
            Some(state) => say!("going on from t = {} after {} increments", told(state.time), state.increment),
            None => {
                warnings.iter().for_each(|warning| say!("warning: {warning}"));
                model.choices().iter().for_each(|choice| say!("{choice}"));
            }
        }
        Self { quiet, warnings: warnings.len() }
    }

    /// After the last one.
    pub fn end(&self, summary: &Summary, model: &Model, folder: &Path, supplied: f64) {
        if self.quiet {
            return;
        }
        summary.warnings.iter().skip(self.warnings).for_each(|warning| say!("warning: {warning}"));
        conclude(summary, model, folder, supplied);
    }
}

/// The last lines of a run on stderr.
fn conclude(summary: &Summary, model: &Model, folder: &Path, supplied: f64) {
    let report = &summary.report;
    say!(
        "{} increments, {} cut-backs, {} rejected, {} linear solves of {} dofs in {:.2} s; results in {}",
        report.increments,
        report.cutbacks,
        report.rejected,
        report.newton_iterations,
        model.dofs(),
        report.wall_s.total,
        folder.display()
    );
    if model.steps.iter().any(|step| step.scheme.is_dynamic() || step.rupture.is_some()) {
        audit(&report.energy, supplied);
    }
}

/// Where the energy of a dynamic run came from and went; `supplied` is the most that there was.
fn audit(energy: &Energy, supplied: f64) {
    let share = if supplied > 0.0 { 100.0 * energy.error() / supplied } else { 0.0 };
    say!("energy: {:.6e} at the start, {:.6e} from outside", energy.initial, energy.external_work);
    say!(
        "        {:.6e} kinetic, {:.6e} strain, {:.6e} in contacts",
        energy.kinetic,
        energy.strain,
        energy.contact_elastic
    );
    say!(
        "        {:.6e} taken by friction, {:.6e} by damping, {:.1e} ({share:.4} %) unaccounted for",
        energy.friction_dissipation,
        energy.damping_dissipation,
        energy.error()
    );
}
