//! What must hold between two ways of writing the same problem, or between two problems that become the same.

mod aside;
mod buckled;
mod derivatives;
mod energy;
mod halved;
mod held;
mod led;
mod limits;
mod tangents;
mod told;
mod written;

use crate::features::{Draft, hash};
use crate::frame::Kind;
use crate::mesh::is_quadratic;
use crate::model::{self, Ways, is_dynamic, is_explicit, moves};
use crate::record::{Difference, Ended, Entry, Lead, Record, compare, is_aside, run};

use aside::{bystander, flight, wide};
use buckled::buckled;
use derivatives::derivatives;
use energy::{energies, linear_energies, switched};
use halved::halved;
use held::{absent, dilating, ladder, resultants, slips};
use led::{begun_with, dropped, further, resumed, threads};
use limits::{sides_swapped, slow_dynamics, small_and_finite, stiff_and_augmented};
use tangents::tangents;
use told::{followed, overstressed, watered};
use written::{
    axis_told, body_in_two, driven, inclined, later, mirrored, moved, renamed, shuffled, steps_in_two, told_in_time,
    told_thrice, turned, turned_square, units,
};

/// A relation: its name, and what breaks it, if anything does. Nothing where it does not apply.
pub struct Relation {
    pub name: &'static str,
    /// one of so many models is held to it
    pub rarity: u64,
    pub check: fn(&Base) -> Outcome,
}

/// What came of a relation.
pub enum Outcome {
    /// It says nothing of this model
    Idle,
    Holds,
    Broken(Difference),
}

/// A draft, its plain run, and what perturbations make of it.
pub struct Base<'a> {
    pub draft: &'a Draft,
    pub ways: Ways,
    pub record: Record,
}

impl<'a> Base<'a> {
    pub fn new(draft: &'a Draft) -> Self {
        let ways = Ways::plain(draft);
        let record = run(&model::case(draft, &ways), &ways, Lead::Through);
        Self { draft, ways, record }
    }

    fn run(&self, ways: &Ways) -> Record {
        run(&model::case(self.draft, ways), ways, Lead::Through)
    }

    /// How far the plain run moves when its numbers change in the 12th digit: what round-off can do to this model.
    pub fn sensitivity(&self, skip: &dyn Fn(&str) -> bool) -> f64 {
        let of = |noise| self.moves_by(Ways { noise: Some(noise), ..self.ways.clone() }, skip);
        (1..=NOISES).map(of).fold(0.0, f64::max)
    }

    /// How far the plain run moves when it is run in another way.
    fn moves_by(&self, ways: Ways, skip: &dyn Fn(&str) -> bool) -> f64 {
        let record = self.run(&ways);
        if record.ended == self.record.ended { compare(&self.record, &record, skip).share } else { f64::INFINITY }
    }

    /// The same problem written in another way has the same answer.
    fn same(&self, ways: Ways, tolerance: f64, skip: &dyn Fn(&str) -> bool) -> Outcome {
        if !self.has_ended_well() {
            return Outcome::Idle;
        }
        let record = self.run(&ways);
        self.as_before(&record, tolerance, skip)
    }

    fn as_before(&self, record: &Record, tolerance: f64, skip: &dyn Fn(&str) -> bool) -> Outcome {
        if ended(&record.ended) != ended(&self.record.ended) {
            // What Newton's method does where it does not converge hangs on round-off, and so does whether a shorter increment is found.
            if record.given_up > 0 && self.record.given_up > 0 {
                return Outcome::Idle;
            }
            return self.judged(Difference::of_end(&record.ended, &self.record.ended), skip);
        }
        // How long the next increment is hangs on whole numbers: the iterations of the one before, whether one was rejected, the foot
        // that stands for a point. Where round-off changes one of them (some 1 in 1000 models), the increments are others.
        let is_dt = |column: &str| column != "dt";
        if record.increments != self.record.increments || compare(&self.record, record, &is_dt).share > SAME_UNTIL {
            return Outcome::Idle;
        }
        let difference = compare(&self.record, record, skip);
        let tolerance = if moves(self.draft) { tolerance.max(SAME_IN_MOTION) } else { tolerance };
        let tolerance = if is_explicit(self.draft) { tolerance.max(SAME_EXPLICIT) } else { tolerance };
        let augmented = self.draft.is("normal", "augmented") || self.draft.has("stick");
        let tolerance = if augmented { tolerance.max(SAME_AUGMENTED) } else { tolerance };
        // The lengths of increments follow from estimates, and rates are differences over them.
        let tolerance = if self.draft.has("error_control") { tolerance.max(SAME_IN_MOTION) } else { tolerance };
        let tolerance = if self.draft.has("until") { tolerance.max(SAME_UNTIL) } else { tolerance };
        // What multipliers leave of a pressure decides whether the law is beyond its threshold, where it jumps.
        if difference.share > tolerance && augmented && self.draft.is("friction", "registered") {
            return Outcome::Idle;
        }
        if difference.share <= tolerance { Outcome::Holds } else { self.judged(difference, skip) }
    }

    /// A difference that round-off can make is none, nor is a small one that the tolerance of Newton's method makes.
    fn judged(&self, difference: Difference, skip: &dyn Fn(&str) -> bool) -> Outcome {
        let by_tolerance =
            || LOOSER * self.moves_by(Ways { looser: LOOSER, ..self.ways.clone() }, skip).min(SAME_BY_TOLERANCE);
        if difference.share <= AMPLIFIED * self.sensitivity(skip) || difference.share <= by_tolerance() {
            Outcome::Idle
        } else {
            Outcome::Broken(difference)
        }
    }

    fn has_ended_well(&self) -> bool {
        self.record.ended == Ended::Complete
    }
}

/// How it ended, without numbers.
fn ended(of: &Ended) -> u8 {
    match of {
        Ended::Complete => 0,
        Ended::Stopped(_) => 1,
        Ended::Refused(_) => 2,
    }
}

/// So many runs with numbers that differ in the 12th digit tell what round-off can do.
const NOISES: u64 = 12;

/// A relation may miss by so many times what a change in the 12th digit of its numbers does: far from the origin positions are rounded in
/// the tenth.
const AMPLIFIED: f64 = 1000.0;

/// What the tolerance of Newton's method does is seen at one so many times as large.
const LOOSER: f64 = 10.0;

/// At most so much of a difference is put down to it, before the factor.
const SAME_BY_TOLERANCE: f64 = 1e-6;

/// What is the same is the same to this share: a hundred times what Newton's method leaves.
const SAME: f64 = 1e-8;

/// In motion to this one: points that close and open in turn add up round-off from increment to increment.
const SAME_IN_MOTION: f64 = 1e-7;

/// Explicit increments are a hundred times as many, and surfaces that just touch are closed or open in one of them by round-off: what
/// slips meanwhile is remembered.
const SAME_EXPLICIT: f64 = 1e-5;

/// The augmented Lagrangian ends at the penetration that is asked for, 1e-9: α_n times that, 2e4 · 1e-9, of pressures near 6.
const SAME_AUGMENTED: f64 = 4e-6;

/// Newton's method ends when every body balances: two bodies may balance at another iteration than one, which a law that has a kink
/// approaches slowly.
const SAME_BY_BODY: f64 = 1e-6;

/// A step that ends with a reaction ends where that is met to 1e-6: its length is as uncertain, and rates are ten times as much.
const SAME_UNTIL: f64 = 1e-5;

pub const RELATIONS: &[Relation] = &[
    Relation { name: "resumed", rarity: 2, check: resumed },
    Relation { name: "dropped", rarity: 2, check: dropped },
    Relation { name: "threads", rarity: 2, check: threads },
    Relation { name: "begun with", rarity: 5, check: begun_with },
    Relation { name: "further", rarity: 5, check: further },
    Relation { name: "bystander", rarity: 3, check: bystander },
    Relation { name: "wide", rarity: 3, check: wide },
    Relation { name: "flight", rarity: 3, check: flight },
    Relation { name: "moved", rarity: 3, check: moved },
    Relation { name: "turned by 37", rarity: 3, check: turned },
    Relation { name: "turned by 90", rarity: 5, check: turned_square },
    Relation { name: "mirrored", rarity: 3, check: mirrored },
    Relation { name: "units", rarity: 3, check: units },
    Relation { name: "inclined", rarity: 4, check: inclined },
    Relation { name: "renamed", rarity: 5, check: renamed },
    Relation { name: "shuffled", rarity: 5, check: shuffled },
    Relation { name: "driven", rarity: 5, check: driven },
    Relation { name: "told thrice", rarity: 5, check: told_thrice },
    Relation { name: "axis told", rarity: 2, check: axis_told },
    Relation { name: "told in time", rarity: 5, check: told_in_time },
    Relation { name: "steps in two", rarity: 3, check: steps_in_two },
    Relation { name: "later", rarity: 4, check: later },
    Relation { name: "body in two", rarity: 5, check: body_in_two },
    Relation { name: "halved", rarity: 24, check: halved },
    Relation { name: "buckled", rarity: 8, check: buckled },
    Relation { name: "derivatives", rarity: 5, check: derivatives },
    Relation { name: "tangents", rarity: 5, check: tangents },
    Relation { name: "energies", rarity: 3, check: energies },
    Relation { name: "linear energies", rarity: 3, check: linear_energies },
    Relation { name: "switched", rarity: 2, check: switched },
    Relation { name: "dilating", rarity: 1, check: dilating },
    Relation { name: "resultants", rarity: 1, check: resultants },
    Relation { name: "small and finite", rarity: 12, check: small_and_finite },
    Relation { name: "slow dynamics", rarity: 12, check: slow_dynamics },
    Relation { name: "stiff and augmented", rarity: 12, check: stiff_and_augmented },
    Relation { name: "sides swapped", rarity: 12, check: sides_swapped },
    Relation { name: "ladder", rarity: 1, check: ladder },
    Relation { name: "slips", rarity: 1, check: slips },
    Relation { name: "absent", rarity: 1, check: absent },
    Relation { name: "overstressed", rarity: 1, check: overstressed },
    Relation { name: "watered", rarity: 8, check: watered },
    Relation { name: "followed", rarity: 1, check: followed },
];

const NOTHING: &dyn Fn(&str) -> bool = &|_| false;
