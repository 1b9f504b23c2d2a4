//! Energy balance of a run, and remedies for an energy error.
//!
//! ```text
//! error = initial + external work − (kinetic + strain + contact) − dissipation                  0 if all is resolved
//! ```
//!
//! The error is measured relative to the energy available for storage or dissipation: initial energy and external work.
//!
//! # Energy in contact penalties
//!
//! An exact contact stores no energy along its normal, and none while it sticks. The energy stored in the penalties, relative
//! to the elastic energy of bodies and contacts when that was largest, measures the error of the penalty method; as p²/2α_n it
//! falls with the penalty.

use crate::equations::contacts::Springs;
use crate::model::scheme::{Scheme, time_text};
use crate::model::state::State;
use crate::model::{Model, Step};
use serde::{Deserialize, Serialize};

/// Energy error that causes a warning, as a fraction of the energy supplied.
const WORTH_TELLING: f64 = 0.01;

/// Errors within this multiple of the work of round-off in the forces are ignored.
const ROUND_OFF: f64 = 100.0;

/// Energy balance of the run so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Audit {
    /// Largest initial energy + external work [F·L]
    pub supplied: f64,
    /// Error at the last row [F·L]
    error: f64,
    /// Largest error, and its time [F·L, T]
    worst: (f64, f64),
    /// Error contributed by every step, and its remedy
    steps: Vec<(String, f64, String)>,
    /// Possible work of round-off in the forces [F·L]
    noise: f64,
    /// Energy in the contact penalties
    pub give: Give,
}

/// Fraction of the elastic energy of bodies and contacts that was stored in contact penalties when that energy was largest.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Give {
    /// Elastic energy [F·L]
    elastic: f64,
    /// Part of it in penalties [F·L]
    penalties: f64,
}

impl Audit {
    /// Records a row, given the state before it.
    pub fn record(&mut self, model: &Model, step: &Step, old: &State, new: &State) {
        let error = new.energy.error();
        self.supplied = self.supplied.max(new.energy.supplied());
        if self.steps.last().is_none_or(|(name, ..)| *name != step.name) {
            self.steps.push((step.name.clone(), 0.0, remedy(model, step).into()));
        }
        let increments = self.steps.last_mut().map(|(_, sum, _)| sum);
        increments.into_iter().for_each(|sum| *sum += error - self.error);
        self.error = error;
        if error.abs() > self.worst.0.abs() || error.is_nan() {
            self.worst = (error, new.time);
        }
        self.give.record(model, new);
        let ways = old.displacement.iter().zip(&new.displacement).map(|(old, new)| (new - old).abs());
        self.noise += round_off(model, new) * ways.fold(0.0, f64::max);
    }

    /// Warning at the end of a run if the energies do not balance.
    pub fn concern(&self) -> Option<String> {
        let (worst, time) = self.worst;
        if worst.abs() <= (WORTH_TELLING * self.supplied).max(ROUND_OFF * self.noise) {
            return None;
        }
        let largest = self.steps.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let (name, _, remedy) = largest?;
        let percent = 100.0 * worst.abs() / self.supplied;
        let fate = if worst < 0.0 { "gain" } else { "loss" };
        Some(format!(
            "energy balance violated by t = {}: spurious {fate} of {:.3e}, {percent:.3} % of the {:.3e} supplied \
             (initial energy + external work), mostly in step `{name}`: {remedy}",
            time_text(time),
            worst.abs(),
            self.supplied
        ))
    }
}

impl Give {
    fn record(&mut self, model: &Model, state: &State) {
        let elastic = state.energy.strain + state.energy.contact_elastic;
        if elastic > self.elastic {
            let pairs = model.contacts.iter().zip(&state.contacts);
            self.penalties = pairs.map(|(pair, states)| Springs::of(pair, states).numerical).sum();
            self.elastic = elastic;
        }
    }

    /// Fraction stored in penalties, if any energy was stored [-]
    pub fn share(&self) -> Option<f64> {
        (self.elastic > 0.0).then(|| self.penalties / self.elastic)
    }
}

/// Round-off of the forces on a model [F].
fn round_off(model: &Model, state: &State) -> f64 {
    let reach = state.displacement.iter().fold(model.mesh.diagonal(), |most, u| most.max(u.abs()));
    let contacts = model
        .contacts
        .iter()
        .zip(&state.contacts)
        .flat_map(|(pair, states)| states.iter().map(move |contact| pair.alpha_n * contact.length));
    f64::EPSILON * contacts.fold(model.stiffness(), f64::max) * reach * (model.mesh.nodes.len() as f64).sqrt()
}

/// Remedy for an energy error in a step.
fn remedy(model: &Model, step: &Step) -> &'static str {
    let keeps_all = match step.scheme {
        Scheme::Static => return "take shorter increments (dt.max, dt.min)",
        Scheme::QuasiDynamic { .. } => return "take fewer steps per row of results (quasi_dynamic.every)",
        Scheme::Explicit { .. } => {
            return "lower the safety of the explicit scheme, or give the bodies viscosity (damping.stiffness)";
        }
        Scheme::Newmark { gamma, .. } => gamma == 0.5,
        Scheme::Hht { alpha } => alpha == 0.0,
        Scheme::GeneralizedAlpha { rho_infinity } => rho_infinity == 1.0,
        Scheme::Wilson { .. } => false,
    };
    let rings = !model.contacts.is_empty() && !model.massless.contains(&true);
    match (keeps_all, rings) {
        (true, true) => {
            "impact excites oscillations that the increments do not resolve: make the contact `massless`, take a \
             scheme that damps (hht), or shorter increments (dt.error)"
        }
        (true, false) => {
            "take a scheme that damps frequencies that the increments do not resolve (hht), or shorter increments \
             (dt.error)"
        }
        (false, true) => {
            "frequencies that the increments do not resolve are damped, or excited by impact: take shorter increments \
             (dt.error), or make the contact `massless`"
        }
        (false, false) => {
            "the scheme damps frequencies that the increments do not resolve: take shorter increments (dt.error)"
        }
    }
}
