//! Whether the energies of a run balance, and what to do if they do not.
//!
//! ```text
//! error = initial + external work − (kinetic + strain + contact) − dissipation                  0 if all is resolved
//! ```
//!
//! The error is measured by the most that there was to be stored or dissipated: initial energy and external work.
//!
//! # How much contacts give way
//!
//! An exact contact stores nothing along its normal, and nothing while it sticks. What penalties store there, beside the energy of
//! bodies and contacts at the time when that was largest, tells how far the answer is off by them; as p²/2α_n it falls with the
//! penalty.

use crate::equations::contacts::Springs;
use crate::model::scheme::{Scheme, time_text};
use crate::model::state::State;
use crate::model::{Model, Step};
use serde::{Deserialize, Serialize};

/// Energy error worth a warning, as a fraction of the energy supplied.
const WORTH_TELLING: f64 = 0.01;

/// Errors within this multiple of the work of round-off in the forces are ignored.
const ROUND_OFF: f64 = 100.0;

/// The balance of energies so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Audit {
    /// Largest initial energy + external work [F·L]
    pub supplied: f64,
    /// Error at the last row [F·L]
    error: f64,
    /// Its largest value, and when [F·L, T]
    worst: (f64, f64),
    /// Contribution of every step, and its remedy
    steps: Vec<(String, f64, String)>,
    /// Possible work of round-off in the forces [F·L]
    noise: f64,
    /// How much contacts give way
    pub give: Give,
}

/// How much of the elastic energy of bodies and contacts was in penalties of contacts, when that energy was largest.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Give {
    /// Elastic energy [F·L]
    elastic: f64,
    /// What of it was in penalties [F·L]
    penalties: f64,
}

impl Audit {
    /// Record a row, from the state before it.
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
        let [reach, way] = largest([&old.displacement, &new.displacement]);
        self.noise += round_off(model, new, reach) * way;
    }

    /// Warning at the end of a run, if the energies do not balance.
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

    /// The share of the penalties, if anything was stored [-]
    pub fn share(&self) -> Option<f64> {
        (self.elastic > 0.0).then(|| self.penalties / self.elastic)
    }
}

/// The largest |u₁| and |u₁ − u₀|, what is no number left out. Some at a time: each maximum alone waits for the one before.
fn largest([old, new]: [&[f64]; 2]) -> [f64; 2] {
    const TOGETHER: usize = 8;
    let most = |most: f64, value: f64| if value > most { value } else { most };
    let (mut reach, mut way) = ([0.0; TOGETHER], [0.0; TOGETHER]);
    let ((olds, old_rest), (news, new_rest)) = (old.as_chunks::<TOGETHER>(), new.as_chunks::<TOGETHER>());
    for (old, new) in olds.iter().zip(news) {
        for k in 0..TOGETHER {
            reach[k] = most(reach[k], new[k].abs());
            way[k] = most(way[k], (new[k] - old[k]).abs());
        }
    }
    for (old, new) in old_rest.iter().zip(new_rest) {
        (reach[0], way[0]) = (most(reach[0], new.abs()), most(way[0], (new - old).abs()));
    }
    [reach, way].map(|all| all.into_iter().fold(0.0, f64::max))
}

/// Round-off of the forces on a model whose displacements reach so far [F].
fn round_off(model: &Model, state: &State, reach: f64) -> f64 {
    let reach = model.mesh.diagonal().max(reach);
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
