//! A problem on a finer mesh in shorter increments, as `converge` runs it.

use super::written::{has_a_place, turns};
use super::*;

/// Elements and increments halved no time are as they were; halved once, the same problem written in another way has the same answer, and
/// a place that names another node is refused.
pub(super) fn halved(base: &Base) -> Outcome {
    let record = base.run(&Ways { halved: Some(0), ..base.ways.clone() });
    if !base.has_ended_well() || matches!(record.ended, Ended::Refused(_)) {
        return Outcome::Idle;
    }
    let as_it_was = base.as_before(&record, 0.0, NOTHING);
    if matches!(as_it_was, Outcome::Broken(_)) {
        return as_it_was;
    }
    let ways = Ways { halved: Some(1), ..base.ways.clone() };
    let finer = Base { draft: base.draft, record: base.run(&ways), ways: ways.clone() };
    // On the finer mesh there is a node between those that a place aside is nearly as near to.
    let moves_on = base.run(&Ways { bystander: true, halved: Some(1), ..base.ways.clone() }).ended;
    if !matches!(moves_on, Ended::Refused(_)) {
        return Outcome::Broken(Difference::of_end(&moves_on, &base.record.ended));
    }
    let written = match hash(base.draft.seed, "halved") % 3 {
        0 if turns(base.draft) => Ways { frame: ways.frame.clone().turned(90.0), ..ways },
        1 if !has_a_place(base.draft) => Ways { renamed: true, ..ways },
        _ => Ways { frame: ways.frame.clone().units(4.0, 16.0, 0.5), ..ways },
    };
    finer.same(written, SAME, NOTHING)
}
