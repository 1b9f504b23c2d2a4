//! What is unstable is told.

use super::*;

/// A strut aside that is pushed together by less than makes it buckle, and by more: only the second is told. One whose middle is raised a
/// little bends, and is stable however far it is pushed.
pub(super) fn buckled(base: &Base) -> Outcome {
    let draft = base.draft;
    let idle = !draft.is("scheme", "static")
        || draft.has("then")
        || draft.has("rupture")
        || draft.has("stabilize")
        // Beside flowing water, whose tangent is indefinite, eigenvalues are counted only where friction leaves it symmetric.
        || draft.is("pores", "flow")
        || !draft.is("section", "plane_strain")
        || !base.has_ended_well()
        || is_told(&base.record);
    if idle {
        return Outcome::Idle;
    }
    for (times, raised, unstable) in [(0.8, 0.0, false), (1.5, 0.0, true), (FAR, RAISED, false)] {
        let finer = if raised > 0.0 { 4.0 } else { 1.0 };
        let record = base.run(&Ways { strut: Some(times), raised, finer, ..base.ways.clone() });
        if record.ended == Ended::Complete && is_told(&record) != unstable {
            let place = format!("pushed together by {times} of what makes it buckle, warned: {:?}", record.warnings);
            return Outcome::Broken(Difference { share: f64::INFINITY, place, values: [0.0; 2] });
        }
    }
    Outcome::Holds
}

/// So many times what makes it buckle is a tenth of its length.
const FAR: f64 = 48.0;

/// Middle of a strut above its ends, as a share of half of its length.
const RAISED: f64 = 0.005;

fn is_told(record: &Record) -> bool {
    record.warnings.iter().any(|warning| warning.contains("unstable"))
}
