//! Energies balance.

use super::written::SUDDEN;
use super::*;
use crate::features::SLOTS;

/// Energies balance, or the error of their balance falls with the increments at their order. What does not fall is less than what the
/// contacts store: friction acts across the gap of the penalty without a couple, tractions go by the length of now, and points
/// come and go (`src/equations/evaluation.rs`).
pub(super) fn energies(base: &Base) -> Outcome {
    let draft = base.draft;
    // Implicit schemes damp what increments do not resolve, or create energy where contact chatters; the stress of F-bar has no
    // potential.
    let f_bar = ["ground_element", "block_element"].iter().any(|slot| draft.is(slot, "f_bar"));
    if f_bar || draft.has("then") || moves(draft) && !draft.is("scheme", "explicit") {
        return Outcome::Idle;
    }
    // What is out of balance at the beginning of a static step springs to equilibrium, and nothing says what it does on its way.
    let springs =
        !moves(draft) && (draft.has("stress") || draft.has("pores") || draft.has("tractions") || draft.has("spring"));
    if !base.has_ended_well() || draft.has("error_control") || draft.has("until") || springs {
        return Outcome::Idle;
    }
    // Dilatancy holds the surfaces apart, and friction acts across that gap without a couple; an augmented Lagrangian stores nothing that
    // would bound it.
    if draft.has("dilatancy") && draft.is("normal", "augmented") {
        return Outcome::Idle;
    }
    // A law that jumps at a threshold of the pressure lets go at once of what it has strained; a rupture begins from rest under supports
    // that move, and they strike what they hold.
    if !moves(draft) && draft.is("friction", "registered") || draft.has("rupture") {
        return Outcome::Idle;
    }
    // A temperature that jumps where a step begins strains a body that yields along a way that no increment resolves.
    if moves(draft) && draft.is("heat", "by_place") {
        return Outcome::Idle;
    }
    // A point that slides off the end of its master takes its force along, at once.
    let lengths: Vec<f64> = base.record.values("c.contact_length").collect();
    if !moves(draft) && lengths.windows(2).any(|pair| pair[1] < 0.95 * pair[0]) {
        return Outcome::Idle;
    }
    // A support that starts at a velocity strikes what it holds, and loses ½ m v² by it.
    let drive = if moves(draft) { Some("smooth") } else { base.ways.drive };
    let audited = |finer| {
        let record = base.run(&Ways { finer, drive, ..base.ways.clone() });
        // A fluid acts on open points too, and where they strike its force and theirs change at once.
        (record.ended == Ended::Complete).then(|| unexplained(&record, moves(draft) && !draft.has("fluid")))
    };
    let Some(coarse) = audited(1.0) else { return Outcome::Idle };
    // Central differences go to and fro about the energy.
    let balanced = if moves(draft) { IN_MOTION } else { BALANCED };
    if coarse.share <= balanced {
        return Outcome::Holds;
    }
    let (Some(fine), Some(finest)) = (audited(2.0), audited(4.0)) else { return Outcome::Idle };
    // Multipliers store nothing. In finite sliding the gap that they close in the mean along an edge of the mesh is not closed between:
    // what pressures do there falls with the mesh.
    let by_the_mesh = draft.is("normal", "augmented") && !draft.is("sliding", "small");
    let falls = |finer: &Difference| {
        by_the_mesh && finer.share <= BY_THE_MESH
            || finer.share <= balanced
            || finer.share <= 0.6 * fine.share
            || finer.share <= 0.6 * coarse.share
    };
    // A body that only dashpots hold turns far in its first increments: the order of the error shows in much shorter ones.
    if falls(&finest) || audited(64.0).is_some_and(|least| falls(&least)) {
        Outcome::Holds
    } else {
        Outcome::Broken(Difference {
            place: format!("{}; {:.2e} {:.2e} {:.2e}", finest.place, coarse.share, fine.share, finest.share),
            ..finest
        })
    }
}

/// Where one scheme follows another in motion no energy comes or goes but what the error of an increment explains: the error that the
/// first increment of the new scheme adds falls with its length.
pub(super) fn switched(base: &Base) -> Outcome {
    // What sets in at once shakes at frequencies that implicit increments do not resolve, but damp; friction acts across the gap of
    // dilatancy without a couple, all the while.
    let Some(draft) = base.draft.plainer(&SUDDEN).and_then(|draft| draft.plainer(&["dilatancy"])) else {
        return Outcome::Idle;
    };
    let f_bar = ["ground_element", "block_element"].iter().any(|slot| draft.is(slot, "f_bar"));
    // Statics stops what moves; rings on end are not held along their radius, where a load sets in.
    let idle = !draft.has("then")
        || draft.is("then", "static")
        || draft.is("scheme", "static")
        || draft.is("section", "rings_on_end")
        || f_bar;
    if idle {
        return Outcome::Idle;
    }
    // Multipliers on a surface that has mass gain energy from impacts, the more the shorter the increments.
    if draft.is("normal", "augmented") && !draft.has("massless") {
        return Outcome::Idle;
    }
    let stage = model::duration(&draft);
    let plain = Ways::plain(&draft);
    let error_of = |row: &[Entry]| row.iter().find(|entry| &*entry.column == "energy_error").map(|entry| entry.value);
    let added = |finer| {
        let ways = Ways { finer, drive: Some("through"), ..plain.clone() };
        let mut case = model::case(&draft, &ways);
        // Rows as close as they come by themselves.
        case["output"]["interval"] = serde_json::Value::Null;
        let record = run(&case, &ways, Lead::Through);
        let errors: Vec<(f64, f64)> =
            record.rows.iter().filter_map(|(time, row)| Some((*time, error_of(row)?))).collect();
        let change = errors.iter().position(|&(time, _)| time > stage * (1.0 + 1e-9))?;
        let &[(then, before), (first, after), (second, further)] = errors.get(change.checked_sub(1)?..change + 2)?
        else {
            return None;
        };
        // Tractions that go by the length of now add to the error all the while, and contact that chatters now and then: what comes at
        // the change is beyond that.
        let steady = after - before - (further - after) * (first - then) / (second - first);
        let others =
            [errors.get(change.saturating_sub(4)..change)?, errors.get(change..(change + 4).min(errors.len()))?];
        let rates = others
            .iter()
            .flat_map(|errors| errors.windows(2))
            .map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0));
        let usual = rates.map(f64::abs).fold(0.0, f64::max) * (first - then);
        let is_usual = (after - before).abs() <= usual;
        (record.ended == Ended::Complete).then(|| (steady, steady.abs() / audit(&record).values[1], is_usual))
    };
    let [Some(coarse), Some(fine), Some(finest)] = [1.0, 2.0, 4.0].map(added) else { return Outcome::Idle };
    let falls = |(_, share, is_usual): (f64, f64, bool)| {
        is_usual || share <= SWITCHED || share <= 0.6 * fine.1 || share <= 0.6 * coarse.1
    };
    // Contact that chatters just then does so for less in much shorter increments.
    if falls(finest) || added(16.0).is_some_and(falls) {
        return Outcome::Holds;
    }
    let shares = [coarse, fine, finest].map(|(_, share, _)| format!("{share:.2e}")).join(" ");
    let place = format!("energy_error that the change of schemes adds; {shares}");
    Outcome::Broken(Difference { share: finest.1, place, values: [coarse.0, finest.0] })
}

/// Energies that a change of schemes may add, as a share of the largest: ten times what balances.
pub(super) const SWITCHED: f64 = 1e-6;

/// Share of the largest energy that gaps within an edge account for on meshes of a few elements.
pub(super) const BY_THE_MESH: f64 = 1e-2;

/// Energies that balance to this share of the largest are exact.
pub(super) const BALANCED: f64 = 1e-7;

/// The same in motion.
const IN_MOTION: f64 = 1e-5;

/// The largest error of the energies as a share of the largest of them.
pub(super) fn audit(record: &Record) -> Difference {
    largest_error(record, |_, _, _| true)
}

/// That of the errors that are larger than what the contacts store: in the first row of motion until then, for what is wrong at the start
/// is not theirs.
pub(super) fn unexplained(record: &Record, in_motion: bool) -> Difference {
    let most = record.values("contact_elastic").fold(0.0, f64::max);
    largest_error(record, |error, stored, first| error.abs() > if in_motion && first { stored } else { most })
}

/// The largest error of the energies that counts, by what the contacts have stored until then and whether its row is the first.
pub(super) fn largest_error(record: &Record, counts: impl Fn(f64, f64, bool) -> bool) -> Difference {
    let entries = || record.rows.iter().flat_map(|(time, row)| row.iter().map(move |entry| (time, entry)));
    let is_energy =
        |entry: &Entry| entry.kind == Kind::Energy && &*entry.column != "energy_error" && !entry.column.contains('.');
    let most = entries().filter(|(_, entry)| is_energy(entry)).map(|(_, entry)| entry.value.abs()).fold(0.0, f64::max);
    let of = |row: &[Entry], name: &str| row.iter().find(|entry| &*entry.column == name).map(|entry| entry.value);
    let mut stored = 0.0f64;
    let errors = record.rows.iter().enumerate().filter_map(|(k, (time, row))| {
        stored = stored.max(of(row, "contact_elastic")?);
        let error = of(row, "energy_error")?;
        counts(error, stored, k == 0).then_some((time, error))
    });
    let error = errors.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let Some((time, error)) = error.filter(|_| most > 0.0) else { return Difference::default() };
    Difference { share: error.abs() / most, place: format!("energy_error at t = {time}"), values: [error, most] }
}

/// Slots that a problem may keep in which all is linear but for what closes.
const LINEAR: [&str; 16] = [
    "section",
    "surfaces",
    "method",
    "gauss_points",
    "flange",
    "tip",
    "heat",
    "gravity",
    "plate",
    "periodic",
    "inclined",
    "near",
    "times",
    "reversal",
    "approach",
    "drive",
];

/// Energies of a linear problem that does not open balance to round-off, bodies that come and go and are warm included.
pub(super) fn linear_energies(base: &Base) -> Outcome {
    let others: Vec<&str> = SLOTS.iter().map(|(slot, _)| *slot).filter(|slot| !LINEAR.contains(slot)).collect();
    let linear = base.draft.plainer(&others).and_then(|draft| draft.with("friction", "frictionless"));
    let Some(draft) = linear.and_then(|draft| draft.with("sliding", "small")) else { return Outcome::Idle };
    if model::starts_separated(&draft) {
        return Outcome::Idle;
    }
    let base = Base::new(&draft);
    let lengths: Vec<f64> = base.record.values("c.contact_length").collect();
    let opens = lengths.windows(2).any(|pair| (pair[1] - pair[0]).abs() > 1e-9 * pair[0]);
    if !base.has_ended_well() || opens {
        return Outcome::Idle;
    }
    let error = audit(&base.record);
    if error.share <= BALANCED { Outcome::Holds } else { Outcome::Broken(error) }
}
