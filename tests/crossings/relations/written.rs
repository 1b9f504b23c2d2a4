//! The same problem written in another way.

use super::led::is_judged_by_energies;
use super::*;

/// A random field is one of the place: elsewhere it is another one.
pub(super) fn has_a_place(draft: &Draft) -> bool {
    draft.is("varying", "random")
}

/// Far from the origin; rings along their axis alone.
pub(super) fn moved(base: &Base) -> Outcome {
    if has_a_place(base.draft) {
        return Outcome::Idle;
    }
    let far = f64::from(1 << 20);
    let by = if base.draft.of("section").starts_with("rings") { [0.0, far] } else { [far, -0.25 * far] };
    base.same(Ways { frame: base.ways.frame.clone().moved(by), ..base.ways.clone() }, SAME, NOTHING)
}

pub(super) fn turns(draft: &Draft) -> bool {
    !draft.of("section").starts_with("rings") && !draft.is("stress", "geostatic") && !has_a_place(draft)
}

pub(super) fn turned(base: &Base) -> Outcome {
    // The error of an increment is that of the component of a displacement, and plates move alike along an axis.
    if !turns(base.draft) || base.draft.is("plate", "alike") || base.draft.has("error_control") {
        return Outcome::Idle;
    }
    let record = base.run(&Ways { frame: base.ways.frame.clone().turned(37.0), ..base.ways.clone() });
    // Bodies on inclined supports are not condensed: on the way to a time of output their increments are not those of the ladder.
    if !base.has_ended_well() || base.draft.has("times") && record.increments != base.record.increments {
        return Outcome::Idle;
    }
    base.as_before(&record, SAME, NOTHING)
}

pub(super) fn turned_square(base: &Base) -> Outcome {
    if !turns(base.draft) {
        return Outcome::Idle;
    }
    base.same(Ways { frame: base.ways.frame.clone().turned(90.0), ..base.ways.clone() }, SAME, NOTHING)
}

pub(super) fn faces_nodes(draft: &Draft) -> bool {
    draft.is("surfaces", "matching") && draft.is("method", "node_to_segment")
}

pub(super) fn mirrored(base: &Base) -> Outcome {
    let axis = usize::from(base.draft.of("section").starts_with("rings"));
    if base.draft.is("stress", "geostatic") && axis == 1 || has_a_place(base.draft) {
        return Outcome::Idle;
    }
    // A node that faces a node is projected on the edge before it or the one after; in a mirror on the other, which is not quite
    // straight on with it.
    if faces_nodes(base.draft) && is_explicit(base.draft) {
        return Outcome::Idle;
    }
    base.same(Ways { frame: base.ways.frame.clone().mirrored(axis), ..base.ways.clone() }, SAME, NOTHING)
}

/// Units that are powers of two apart: no digit may change, so that chatter has no excuse.
pub(super) fn units(base: &Base) -> Outcome {
    let [length, stress, time] = [[10, 0, 0], [0, 20, 0], [0, 0, -10], [-7, 20, 5], [-10, -20, 12]]
        [(hash(base.draft.seed, "units") % 5) as usize]
        .map(|power| 2f64.powi(power));
    base.same(Ways { frame: base.ways.frame.clone().units(length, stress, time), ..base.ways.clone() }, SAME, NOTHING)
}

/// Supports along axes written as inclined ones.
pub(super) fn inclined(base: &Base) -> Outcome {
    if base.draft.is("section", "rings_on_end")
        || base.draft.is("section", "rings_around")
        || base.draft.is("scheme", "quasi_dynamic")
        || base.draft.has("plate")
        || base.draft.is("press", "plate")
    {
        return Outcome::Idle;
    }
    let mut frame = base.ways.frame.clone();
    frame.inclined = true;
    base.same(Ways { frame, ..base.ways.clone() }, SAME, NOTHING)
}

pub(super) fn renamed(base: &Base) -> Outcome {
    base.same(Ways { renamed: true, ..base.ways.clone() }, SAME, NOTHING)
}

pub(super) fn shuffled(base: &Base) -> Outcome {
    // A node that faces a node is projected on the edge before it or the one after, whichever comes first.
    if faces_nodes(base.draft) && is_explicit(base.draft) {
        return Outcome::Idle;
    }
    base.same(Ways { shuffled: true, ..base.ways.clone() }, SAME, NOTHING)
}

/// A motion or load written as a number, a rate, a table or an expression.
pub(super) fn driven(base: &Base) -> Outcome {
    if base.draft.has("until") || base.draft.is("scheme", "quasi_dynamic") || base.draft.is("press", "rotation") {
        return Outcome::Idle;
    }
    let ways = ["number", "rate", "table", "expression"];
    let drawn = ways[(hash(base.draft.seed, "driven") % 4) as usize];
    base.same(Ways { drive: Some(drawn), ..base.ways.clone() }, SAME, NOTHING)
}

/// Supports along both axes, told along a third direction as well.
pub(super) fn told_thrice(base: &Base) -> Outcome {
    let draft = base.draft;
    let idle = draft.has("until")
        || draft.is("scheme", "quasi_dynamic")
        || draft.is("press", "rotation")
        // A node of a plate whose displacements are tied has none along other directions.
        || draft.has("plate")
        || draft.is("press", "plate")
        || draft.of("section").starts_with("rings");
    if idle {
        return Outcome::Idle;
    }
    base.same(Ways { told_thrice: true, drive: Some("expression"), ..base.ways.clone() }, SAME, NOTHING)
}

/// The axis of rings is held by itself; told by an expression that vanishes there it is held as well.
pub(super) fn axis_told(base: &Base) -> Outcome {
    let draft = base.draft;
    if !draft.is("section", "rings_on_end")
        || draft.is("scheme", "quasi_dynamic")
        || base.ways.frame.place([0.0, 0.0])[0] != 0.0
    {
        return Outcome::Idle;
    }
    base.same(Ways { axis_told: true, ..base.ways.clone() }, SAME, NOTHING)
}

/// Friction whose numbers are expressions of the time that stay the same, but were others at the very start.
pub(super) fn told_in_time(base: &Base) -> Outcome {
    let draft = base.draft;
    // The opening over which a cohesion fades goes by what it is at the start.
    let fades = draft.is("friction", "adhesion") || model::case(draft, &base.ways).to_string().contains("\"cohesion\"");
    if fades || draft.is("friction", "frictionless") || draft.is("friction", "prescribed") || !base.has_ended_well() {
        return Outcome::Idle;
    }
    let record = base.run(&Ways { told_in_time: true, ..base.ways.clone() });
    // How long increments are in which points close hangs on the law, too.
    if record.ended == Ended::Complete && record.given_up != base.record.given_up {
        let same = |noise| base.run(&Ways { noise: Some(noise), ..base.ways.clone() }).given_up == base.record.given_up;
        let place = format!("{} attempts given up, and {} were", record.given_up, base.record.given_up);
        let broken = Outcome::Broken(Difference { share: f64::INFINITY, place, values: [0.0; 2] });
        return if (1..=NOISES).all(same) { broken } else { Outcome::Idle };
    }
    base.as_before(&record, SAME, NOTHING)
}

/// Whether dashpots of the bodies hold the block until contact does; what they hold depends on the bodies and on the step.
pub(super) fn is_stabilized(base: &Base) -> bool {
    model::case(base.draft, &base.ways).to_string().contains("stabilize")
}

/// Every step in two, where increments are as long as they are said to be.
pub(super) fn steps_in_two(base: &Base) -> Outcome {
    let draft = base.draft;
    let idle = is_stabilized(base)
        // What bodies exert that come or go fades over a step.
        || model::comes_or_goes(draft)
        || !base.record.is_even(model::duration(draft))
        || draft.has("until")
        || draft.has("error_control")
        || draft.has("shrink_fit")
        || draft.is("press", "rotation")
        || draft.is("scheme", "quasi_dynamic")
        || draft.has("rupture")
        // Water is integrated by another formula where a step begins.
        || draft.is("pores", "flow")
        || draft.has("plate");
    if idle {
        return Outcome::Idle;
    }
    let record = base.run(&Ways { halves: true, ..base.ways.clone() });
    // A step begins with no motion to go on with: Newton's method may fail there where it does not within a step.
    if !base.has_ended_well() || record.ended == Ended::Complete && !record.is_even(model::duration(draft)) {
        return Outcome::Idle;
    }
    base.as_before(&record, SAME, NOTHING)
}

/// What acts or moves from the start, or says by itself when something happens.
pub(super) const SUDDEN: [&str; 14] = [
    "stress",
    "pores",
    "drainage",
    "tractions",
    "heat",
    "fluid",
    "velocity",
    "shrink_fit",
    "until",
    "rupture",
    "error_control",
    "press",
    "spring",
    "further_parameters",
];

/// Everything later, after a step in which nothing happens: what varies in time varies as much later.
pub(super) fn later(base: &Base) -> Outcome {
    let Some(draft) = base.draft.plainer(&SUDDEN) else { return Outcome::Idle };
    // The state of these laws lives from the start of the run: θ ages, and μ begins with the μ_s of then.
    let varies = draft.is("varying", "in_time") && draft.pick("which varies", &[0.0, 1.0]) == 1.0;
    let lives = draft.is("friction", "rate_and_state") || draft.is("friction", "super_subloading") && varies;
    // Where nothing touches a tool that only dashpots keep from turning, it has no equilibrium without them.
    let turns = draft.is("tool", "free") && draft.has("stabilize");
    if lives || turns || draft.is("friction", "prescribed") || draft.is("scheme", "quasi_dynamic") {
        return Outcome::Idle;
    }
    let base = Base::new(&draft);
    if !base.has_ended_well() {
        return Outcome::Idle;
    }
    let mut record = base.run(&base.ways.clone().later(LATER, &draft));
    if is_judged_by_energies(&record.ended) {
        return Outcome::Idle;
    }
    // The step before takes one increment, explicit ones as many as there is room for.
    let explicit = record.increments.saturating_sub(base.record.increments);
    record.increments -= if draft.is("scheme", "explicit") { explicit } else { 1.min(record.increments) };
    if record.given_up > 0 && base.record.given_up == 0 {
        let place = format!("{} attempts given up, and none was", record.given_up);
        return base.judged(Difference { share: f64::INFINITY, place, values: [0.0; 2] }, NOTHING);
    }
    base.as_before(&record, SAME, NOTHING)
}

/// So many lengths of a stage.
pub(super) const LATER: f64 = 2.0;

/// The block as two bodies that share the nodes between them.
pub(super) fn body_in_two(base: &Base) -> Outcome {
    if is_stabilized(base) || base.draft.is("tractions", "of_bodies") {
        return Outcome::Idle;
    }
    // Stresses and strains are recovered body by body, each from its own elements.
    let recovered =
        |column: &str| column.starts_with("in_block.") && (column.contains("stress") || column.contains("strain"));
    let of_block = |column: &str| column.starts_with("block.") || column.starts_with("half.") || recovered(column);
    base.same(Ways { block_in_two: true, ..base.ways.clone() }, SAME_BY_BODY, &of_block)
}
