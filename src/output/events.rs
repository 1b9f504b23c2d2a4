//! Events of slip: what each was, from its onset to its end.
//!
//! An event of a contact begins when a point of it slips faster than the threshold while no other does, and ends when none does.
//! Its points are those that a front has reached in it. Their slip s, traction q and work ∫ |q| ds count from the increment
//! before the event; means are weighted by the lengths that points stand for.
//!
//! ```text
//! stress drop       q before − q after, positive where slip has unloaded
//! fracture energy   ∫ (q − q_min) ds up to where q is least, q_min: what weakening takes beyond sliding at its end
//! released          Δ(external work − strain energy − elastic energy of contacts), of the whole model
//! radiated          released − Δ(dissipation by friction): kinetic energy, and what dampers and absorbing sides took
//! front speed       slope of the distance from where it began over the arrivals, by least squares
//! ```
//!
//! Source of the fracture energy: Palmer & Rice (1973), doi:10.1098/rspa.1973.0040; Tinti et al. (2005),
//! doi:10.1029/2005JB003644, who call it breakdown work.

use serde::{Deserialize, Serialize};

use crate::contact::force::ContactState;
use crate::model::state::State;

/// An event so far, or as it was.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SlipEvent {
    /// Number in its contact, from 1
    pub number: usize,
    /// Time up to which it is known, and whether that is its end
    pub until: f64,
    pub over: bool,
    /// Of the model when it began, and by `until`
    pub energies: [Energies; 2],
    /// What each point did
    pub courses: Vec<Course>,
}

/// What loads and stored energies have given, and what friction took, since the start of the run [F·L].
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Energies {
    pub given: f64,
    pub friction: f64,
}

impl Energies {
    /// By a state.
    pub fn of(state: &State) -> Self {
        let energy = &state.energy;
        let given = energy.external_work - energy.strain - energy.contact_elastic;
        Self { given, friction: energy.friction_dissipation }
    }
}

/// What a point did in an event.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Course {
    /// Plastic slip, traction and work before
    before: Mark,
    /// When |q| was least
    least: Mark,
    /// As last seen
    last: Mark,
    pub peak_rate: f64,
}

/// Plastic slip [L], q [F/L²] and ∫ |q| ds [F/L] of a point.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Mark {
    pub slip: f64,
    traction: f64,
    work: f64,
}

impl Mark {
    /// Of a contact point.
    pub fn of(state: &ContactState) -> Self {
        let friction = &state.friction;
        Self { slip: friction.plastic_slip, traction: friction.traction, work: friction.dissipation }
    }
}

impl SlipEvent {
    /// It begins after the increment before, by whose end points were left with their marks, and the model with its energies.
    pub fn begin(number: usize, marks: impl Iterator<Item = Mark>, (until, energies): (f64, Energies)) -> Self {
        let course = |mark: Mark| Course { before: mark, least: mark, last: mark, peak_rate: 0.0 };
        Self { number, until, over: false, energies: [energies; 2], courses: marks.map(course).collect() }
    }

    /// An increment of it; `over` if none slips any more.
    pub fn go_on(&mut self, state: &State, marks: impl Iterator<Item = (Mark, f64)>, over: bool) {
        for (course, (mark, rate)) in self.courses.iter_mut().zip(marks) {
            if mark.traction.abs() < course.least.traction.abs() && mark.slip != course.before.slip {
                course.least = mark;
            }
            course.last = mark;
            course.peak_rate = course.peak_rate.max(rate.abs());
        }
        (self.until, self.over, self.energies[1]) = (state.time, over, Energies::of(state));
    }
}

impl Course {
    /// Slip so far
    pub fn slip(&self) -> f64 {
        self.last.slip - self.before.slip
    }

    /// Fall of the traction in the direction of slip
    pub fn stress_drop(&self) -> f64 {
        (self.before.traction - self.last.traction) * self.slip().signum()
    }

    /// Work beyond that at the least traction
    pub fn fracture_energy(&self) -> f64 {
        let slip = (self.least.slip - self.before.slip).abs();
        (self.least.work - self.before.work - self.least.traction.abs() * slip).max(0.0)
    }
}
