//! A load step, as it is solved.

use super::boundary::{Amplitude, Loads, Span};
use super::damping::Damping;
use super::imposed::Temperature;
use super::scheme::Scheme;
use super::support::{Direction, Motion, Prescribed};
use super::until::Until;

/// How increments are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Increments {
    /// first Δt [T]
    pub initial: f64,
    /// below this a failed increment stops the run [T]
    pub min: f64,
    /// never above this [T]
    pub max: f64,
    /// local error that an increment may make in a displacement or, in a static step, in the slip of a contact point [L]
    pub error: Option<f64>,
}

impl Increments {
    /// The same, but none longer than `longest`: a stabilized step has a last increment after its dashpots have faded.
    pub fn at_most(self, longest: f64) -> Self {
        let Self { initial, min, max, error } = self;
        Self { initial: initial.min(longest), min: min.min(longest), max: max.min(longest), error }
    }
}

/// A step: a time span with its supports, loads, scheme and increments.
#[derive(Clone, Debug, Default)]
pub struct Step {
    /// name, for messages and output
    pub name: String,
    /// time span
    pub span: Span,
    /// scheme
    pub scheme: Scheme,
    /// increments
    pub increments: Increments,
    /// when and how the step goes on explicitly, if it may
    pub rupture: Option<Box<Rupture>>,
    /// prescribed directions, ascending by their dofs
    pub supports: Vec<Prescribed>,
    /// directions that were prescribed in the step before and are free in this static one: their reaction is ramped off
    pub released: Vec<Direction>,
    /// velocities that nodes take when the step begins [L/T]
    pub launch: Vec<(usize, [f64; 2])>,
    /// loads, springs and dashpots
    pub loads: Loads,
    /// temperatures of the bodies that have been given one
    pub temperatures: Vec<Temperature>,
    /// damping of every body
    pub damping: Vec<Damping>,
    /// reaction that ends the step before its time
    pub until: Option<Until>,
    /// c₀ of every dof: dashpots c₀ (1 − share of the step that has passed) that hold bodies until contact does [F T/L]
    pub stabilization: Vec<f64>,
}

impl Step {
    /// The same at other times: all of it that begins with this step or one after it.
    #[must_use]
    pub fn moved(mut self, to: &impl Fn(Span) -> Span) -> Self {
        fn amplitude(of: &mut Amplitude, to: &impl Fn(Span) -> Span) {
            of.span = to(of.span);
            of.before.iter_mut().for_each(|before| amplitude(before, to));
        }
        self.span = to(self.span);
        for support in &mut self.supports {
            match &mut support.motion {
                Motion::Displacement(_, span) => *span = to(*span),
                Motion::Inclined(parts) => parts.iter_mut().for_each(|part| part.span = to(part.span)),
                Motion::Rotation { angle, .. } => amplitude(angle, to),
            }
        }
        self.loads.amplitudes().for_each(|of| amplitude(of, to));
        self.temperatures.iter_mut().for_each(|of| amplitude(&mut of.amplitude, to));
        if let Some(rupture) = &mut self.rupture {
            rupture.explicit = std::mem::take(&mut rupture.explicit).moved(to);
        }
        self
    }

    /// The support that says how a dof moves: its own, or an inclined one of its node.
    pub fn support_at(&self, dof: usize) -> Option<&Prescribed> {
        let find = |dof: usize| self.supports.binary_search_by_key(&dof, |support| support.at.dof).ok();
        let inclined = || find(dof ^ 1).filter(|k| self.supports[*k].at.inclined.is_some());
        find(dof).or_else(inclined).map(|k| &self.supports[k])
    }
}

/// When a static or implicit step turns to explicit increments, and back.
#[derive(Clone, Debug)]
pub struct Rupture {
    /// Slip rate of a contact point above which it does [L/T]
    pub slip_rate: f64,
    /// Time over whose mean no point may slip that fast when it turns back: that of a shear wave across the model [T]
    pub calm: f64,
    /// The step as it goes on explicitly
    pub explicit: Step,
}
