//! What is unstable is told.

use super::*;

/// A strut aside that is pushed together by less than makes it buckle, and by more: only the second is told.
pub(super) fn buckled(base: &Base) -> Outcome {
    let draft = base.draft;
    let idle = !draft.is("scheme", "static")
        || draft.has("then")
        || draft.has("rupture")
        || draft.has("stabilize")
        || !draft.is("section", "plane_strain")
        || !base.has_ended_well()
        || is_told(&base.record);
    if idle {
        return Outcome::Idle;
    }
    for (times, unstable) in [(0.8, false), (1.5, true)] {
        let record = base.run(&Ways { strut: Some(times), ..base.ways.clone() });
        if record.ended == Ended::Complete && is_told(&record) != unstable {
            let place = format!("pushed together by {times} of what makes it buckle, warned: {:?}", record.warnings);
            return Outcome::Broken(Difference { share: f64::INFINITY, place, values: [0.0; 2] });
        }
    }
    Outcome::Holds
}

fn is_told(record: &Record) -> bool {
    record.warnings.iter().any(|warning| warning.contains("unstable"))
}
