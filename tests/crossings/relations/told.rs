//! What is wrong is told, or refused.

use super::*;

/// Tractions above the strength, from which a static step cannot start, are refused whatever the law.
pub(super) fn overstressed(base: &Base) -> Outcome {
    let draft = base.draft;
    let has_strength =
        ["coulomb", "adhesion", "super_subloading", "slip_weakening"].iter().any(|law| draft.is("friction", law));
    let idle = !draft.is("tractions", "given")
        || !draft.is("scheme", "static")
        || draft.has("rupture")
        || !has_strength
        || !base.has_ended_well();
    if idle {
        return Outcome::Idle;
    }
    let record = base.run(&Ways { overstressed: true, ..base.ways.clone() });
    match record.ended {
        Ended::Refused(_) => Outcome::Holds,
        ended => Outcome::Broken(Difference::of_end(&ended, &base.record.ended)),
    }
}

/// A fluid whose pressure is the round-off of nothing is none. One that is at a corner of the block from the very start, beside which it
/// comes later, is told where the contact starts closed, and one that comes to the corner later is not.
pub(super) fn watered(base: &Base) -> Outcome {
    let draft = base.draft;
    // Where water flows through bodies a contact with a pressure of its own is impervious.
    if draft.has("fluid") || draft.is("pores", "flow") || draft.is("scheme", "quasi_dynamic") || !base.has_ended_well()
    {
        return Outcome::Idle;
    }
    let with = |fluid: &str| Ways { fluid: Some(fluid.into()), ..base.ways.clone() };
    if draft.has("tractions") && draft.is("method", "node_to_segment") {
        for (offset, at_once) in [("", true), ("+1e-9", false)] {
            let from = format!("abs(X-({})){offset}", model::corner(draft));
            let (pace, small) = (0.1 / model::duration(draft), if at_once { 1e-12 } else { 1e-30 });
            let record = base.run(&with(&format!("0.1*erfc(({from})/(2*sqrt({pace}*max(T,0)+{small})))")));
            let told = record.warnings.iter().any(|warning| warning.contains("none next to it"));
            if !matches!(record.ended, Ended::Refused(_)) && told != at_once {
                let place = format!("{from}: warned {:?}", record.warnings);
                return Outcome::Broken(Difference { share: f64::INFINITY, place, values: [0.0; 2] });
            }
        }
    }
    base.same(with("-1e-306"), SAME, NOTHING)
}

/// Slip of friction that increments integrate to first order in time has the error per increment that is predicted, or more is told. What
/// is seen of it is the mean of points that stay closed.
pub(super) fn followed(base: &Base) -> Outcome {
    let draft = base.draft;
    let others = ["then", "rupture", "error_control", "interval"].iter().any(|slot| draft.has(slot));
    let idle = !draft.is("friction", "rate_and_state")
        || others
        || draft.is("varying", "by_part")
        || draft.is("scheme", "quasi_dynamic")
        || is_explicit(draft)
        || !base.has_ended_well();
    if idle || base.record.warnings.iter().any(|warning| warning.contains("is the shortest allowed")) {
        return Outcome::Idle;
    }
    let of = |row: &[Entry], name: &str| {
        row.iter().find(|entry| &*entry.column == name).map_or(f64::NAN, |entry| entry.value)
    };
    for rows in base.record.rows.windows(3) {
        let [slip, dt, length] =
            ["c.mean_slip", "dt", "c.contact_length"].map(|name| [0, 1, 2].map(|k| of(&rows[k].1, name)));
        let rates = [1, 2].map(|k| (slip[k] - slip[k - 1]) / dt[k]);
        let error = 0.5 * dt[2] * (rates[1] - rates[0]).abs();
        let stays = length.iter().all(|now| (now - length[0]).abs() <= SAME * length[0]);
        if stays && error > 1.01 * SLIP {
            let place = format!("error of slip in the increment to t = {}, and what is allowed", rows[2].0);
            return Outcome::Broken(Difference { share: error / SLIP, place, values: [error, SLIP] });
        }
    }
    Outcome::Holds
}

/// 1e-4 of the D_c that is drawn.
const SLIP: f64 = 4e-7;
