//! Friction whose parameters vary in time: patches that weaken and recover, creep that sets in.

use std::fmt;
use std::sync::Arc;

use nalgebra::Vector2;

use super::error::Checked;
use crate::laws::friction::rate_law::{Loading, RateLaw};
use crate::laws::friction::state::MOST_VARIABLES;
use crate::laws::friction::{Answer, FrictionLaw, FrictionState, LawFailure, Regime, Sliding};
use crate::mesh::shape::gauss;
use crate::model::boundary::Profile;

/// Points of time over which the mean of a rate is taken: exact for polynomials of the fifth order.
const MEAN: usize = 3;

/// Where a state of such a law keeps the time it belongs to, so that it is observed with the parameters of that time.
const TIME: usize = MOST_VARIABLES - 1;

/// The law of a point: from what varies along the slave there, and the α_t that serves where none is given.
pub(super) type LawAt = dyn Fn(&[f64], f64) -> Checked<Box<dyn FrictionLaw>> + Send + Sync;

/// The law of a point whose parameters vary in time.
#[derive(Clone)]
pub(super) struct InTime {
    pub profiles: Arc<Vec<Profile>>,
    pub at: Vector2<f64>,
    pub law: Arc<LawAt>,
    /// α_t of a law that has none of its own [F/L³]
    pub alpha_t: f64,
    /// The law as it is at the start of the run
    pub start: Arc<dyn FrictionLaw>,
}

impl InTime {
    /// The law with the parameters that are the mean of those at some times.
    fn of(&self, times: &[(f64, f64)]) -> Result<Box<dyn FrictionLaw>, LawFailure> {
        let mean = |profile: &Profile| times.iter().map(|&(time, w)| w * profile.value_at(self.at, time)).sum();
        let values: Vec<f64> = self.profiles.iter().map(mean).collect();
        let time = times.last().map_or(0.0, |(time, _)| *time);
        let law = if values.iter().all(|value: &f64| value.is_finite()) {
            (self.law)(&values, self.alpha_t).ok()
        } else {
            None
        };
        law.ok_or(LawFailure::Undefined { time })
    }

    fn at(&self, time: f64) -> Result<Box<dyn FrictionLaw>, LawFailure> {
        self.of(&[(time, 1.0)])
    }
}

impl fmt::Debug for InTime {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "{:?} at the start, varying in time", self.start)
    }
}

impl FrictionLaw for InTime {
    fn initial_state(&self) -> FrictionState {
        self.start.initial_state()
    }

    fn starting_state(&self, pressure: f64, traction: f64) -> FrictionState {
        self.start.starting_state(pressure, traction)
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        self.start.respond(old, sliding)
    }

    fn during(&self, [from, to]: [f64; 2]) -> Result<Option<Box<dyn FrictionLaw>>, LawFailure> {
        let law = if self.start.takes_means() && to > from {
            let times = gauss(MEAN);
            let times: Vec<(f64, f64)> =
                times.iter().map(|&(xi, w)| (from + 0.5 * (1.0 + xi) * (to - from), 0.5 * w)).collect();
            self.of(&times)?
        } else {
            self.at(to)?
        };
        Ok(Some(Box::new(Dated { law, time: to })))
    }

    fn variables(&self) -> &'static [&'static str] {
        self.start.variables()
    }

    fn observables(&self) -> &'static [&'static str] {
        self.start.observables()
    }

    fn observe(&self, name: &str, state: &FrictionState) -> Option<f64> {
        self.at(state.variables[TIME]).ok()?.observe(name, state)
    }

    fn stiffness(&self) -> f64 {
        self.start.stiffness()
    }

    fn is_frictionless(&self) -> bool {
        self.start.is_frictionless()
    }

    fn starting_limit(&self, pressure: f64) -> f64 {
        self.start.starting_limit(pressure)
    }

    fn weakening(&self) -> f64 {
        self.start.weakening()
    }
}

/// A law at a time, whose states remember it.
#[derive(Debug)]
struct Dated {
    law: Box<dyn FrictionLaw>,
    time: f64,
}

impl FrictionLaw for Dated {
    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let mut response = self.law.respond(old, sliding)?;
        response.state.variables[TIME] = self.time;
        Ok(response)
    }

    fn stiffness(&self) -> f64 {
        self.law.stiffness()
    }

    fn rates(&self) -> Option<&dyn RateLaw> {
        self.law.rates().is_some().then_some(self as &dyn RateLaw)
    }
}

impl Dated {
    fn own(&self) -> &dyn RateLaw {
        self.law.rates().expect("asked for only where the law has them")
    }
}

impl RateLaw for Dated {
    fn slip_rate(&self, x: f64, loading: Loading) -> f64 {
        self.own().slip_rate(x, loading)
    }

    fn evolution(&self, x: f64, slip_rate: f64) -> f64 {
        self.own().evolution(x, slip_rate)
    }

    fn evolving(&self, state: &FrictionState) -> f64 {
        self.own().evolving(state)
    }

    fn remember(&self, x: f64, state: FrictionState) -> FrictionState {
        let mut state = self.own().remember(x, state);
        state.variables[TIME] = self.time;
        state
    }

    fn weight(&self) -> f64 {
        self.own().weight()
    }

    fn regime(&self, x: f64, slip_rate: f64) -> Regime {
        self.own().regime(x, slip_rate)
    }
}
