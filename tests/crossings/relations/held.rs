//! What one run has to say of itself.

use super::*;

/// Dilatancy does not keep surfaces apart: what closes without it closes with it.
pub(super) fn dilating(base: &Base) -> Outcome {
    let Some(plainer) = base.draft.with("dilatancy", "no").filter(|_| base.draft.has("dilatancy")) else {
        return Outcome::Idle;
    };
    // A law that jumps at a threshold of the pressure may leave no equilibrium at it, nor may the traction η v of radiation, which does
    // not vanish with the pressure: closed, it slows the slip below what lifts the surfaces into contact, and open, it does not.
    if moves(base.draft) || base.draft.is("friction", "registered") || base.draft.has("radiation") {
        return Outcome::Idle;
    }
    let Ended::Stopped(why) = &base.record.ended else { return Outcome::Holds };
    // A body whose material fails on the way is no contact that does not close, nor is one that is augmented too slowly.
    if why.contains(": element ") || why.contains("augmentations") {
        return Outcome::Idle;
    }
    // Where they close may lie between the shortest increments.
    if !base.record.closed && base.run(&Ways { finer: 64.0, ..base.ways.clone() }).closed {
        return Outcome::Holds;
    }
    let without = Base::new(&plainer);
    if !base.record.closed && without.record.closed && without.has_ended_well() {
        let place = format!("ended {why}, and closes without dilatancy");
        Outcome::Broken(Difference { share: f64::INFINITY, place, values: [0.0; 2] })
    } else {
        Outcome::Idle
    }
}

/// What the contact says it puts on its slave is p and q summed up along it.
pub(super) fn resultants(base: &Base) -> Outcome {
    let draft = base.draft;
    // Along a straight surface that does not turn.
    if !base.has_ended_well()
        || draft.of("section").starts_with("rings")
        || draft.is("master", "itself")
        || draft.is("master", "circle")
    {
        return Outcome::Idle;
    }
    let mut worst = Difference::default();
    for (time, row) in &base.record.rows {
        let of = |name: &str| row.iter().find(|entry| &*entry.column == name).map_or(f64::NAN, |entry| entry.value);
        let [normal, tangential, x, y] =
            ["normal_force", "tangential_force", "force_x", "force_y"].map(|name| of(&format!("c.{name}")).abs());
        let whole = normal.hypot(tangential);
        // A block that is not held may turn, where one hits the ground again and again that is bent by half a right angle, and a block
        // sinks into clay askew.
        let straight = draft.is("press", "displacement")
            && !moves(draft)
            && !draft.is("ground_law", "cam_clay")
            && !draft.is("ground_law", "sys_cam_clay");
        let compared = match straight {
            true => vec![("along", [tangential, x]), ("across", [normal, y])],
            false => vec![("as a whole", [whole, x.hypot(y)])],
        };
        for (name, [told, put]) in compared {
            let share = (told - put).abs() / whole.max(1e-9);
            if share > worst.share && whole > 1e-6 {
                worst = Difference { share, place: format!("c.force, {name}, at t = {time}"), values: [told, put] };
            }
        }
    }
    // Points of a bent surface have directions of their own.
    let bent = if moves(draft) { 0.25 } else { 0.1 };
    if worst.share <= bent { Outcome::Holds } else { Outcome::Broken(worst) }
}

/// Without friction whatever is closed slips.
pub(super) fn slips(base: &Base) -> Outcome {
    let draft = base.draft;
    if !draft.is("friction", "frictionless") || draft.has("bond") || !base.has_ended_well() {
        return Outcome::Idle;
    }
    let closed = |(_, row): &&(f64, Vec<Entry>)| {
        row.iter().any(|entry| &*entry.column == "c.contact_length" && entry.value > 0.0)
    };
    let share = |(time, row): &(f64, Vec<Entry>)| {
        row.iter().find(|entry| &*entry.column == "c.slip_fraction").map(|entry| (*time, entry.value))
    };
    let sticking = base.record.rows.iter().filter(closed).filter_map(share).find(|(_, share)| *share < 1.0 - SAME);
    sticking.map_or(Outcome::Holds, |(time, share)| {
        let place = format!("c.slip_fraction at t = {time}");
        Outcome::Broken(Difference { share: 1.0 - share, place, values: [share, 1.0] })
    })
}

/// Of a body that is absent nothing is told.
pub(super) fn absent(base: &Base) -> Outcome {
    let draft = base.draft;
    if !draft.is("flange", "removed") || !base.has_ended_well() {
        return Outcome::Idle;
    }
    let told_at = |warning: &String| -> Option<f64> {
        let rest = warning.strip_prefix("body `flange`")?.split_once("t = ")?.1;
        rest.split([':', ',']).next()?.parse().ok()
    };
    let told = base
        .record
        .warnings
        .iter()
        .find(|warning| told_at(warning).is_some_and(|time| time > model::duration(draft) * (1.0 + SAME)));
    told.map_or(Outcome::Holds, |told| {
        Outcome::Broken(Difference { share: f64::INFINITY, place: told.clone(), values: [0.0; 2] })
    })
}

/// Increments of dynamic steps under error control are those of the ladder Δt₀ 2^(k/4), but where a stage ends.
pub(super) fn ladder(base: &Base) -> Outcome {
    let draft = base.draft;
    let off = ["times", "interval", "until"].iter().any(|slot| draft.has(slot));
    if !is_dynamic(draft.of("scheme")) || !draft.has("error_control") || off || !base.has_ended_well() {
        return Outcome::Idle;
    }
    let stage = model::duration(draft);
    let first = base.record.values("dt").next().unwrap_or(stage);
    let mut last = 0.0;
    for (time, row) in &base.record.rows {
        let dt = row.iter().find(|entry| &*entry.column == "dt").map_or(f64::NAN, |entry| entry.value);
        // What is left of a stage is shared by its last two increments, and the first of them may have been cut.
        let left = (time / stage - SAME).ceil() * stage - time;
        let from_rung = |length: f64| {
            let rung = 4.0 * (dt / length).log2();
            (rung - rung.round()).abs()
        };
        if left > 1.5 * dt && from_rung(first) > RUNG && from_rung(0.5 * (left + dt)) > RUNG {
            let place = format!("dt at t = {time}, after {last}");
            return Outcome::Broken(Difference { share: from_rung(first), place, values: [dt, first] });
        }
        last = dt;
    }
    Outcome::Holds
}

/// Digits in which lengths of increments are written, as a share of a rung.
const RUNG: f64 = 1e-5;
