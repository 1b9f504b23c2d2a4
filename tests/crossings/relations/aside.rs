//! What touches nothing changes nothing.

use super::led::is_judged_by_energies;
use super::*;

/// Something that touches nothing, near or far.
pub(super) fn bystander(base: &Base) -> Outcome {
    // The error of an increment is that of all bodies.
    if base.draft.has("plate") && base.draft.is("press", "plate") || base.draft.has("error_control") {
        return Outcome::Idle;
    }
    let far = [1.0, 1e3, 1e5][(hash(base.draft.seed, "far") % 3) as usize];
    let energies = |column: &str| !column.contains('.') && column != "dt" && column != "time" || is_aside(column);
    let record = base.run(&Ways { bystander: true, flight: true, far, ..base.ways.clone() });
    if matches!(record.ended, Ended::Refused(_)) && base.has_ended_well() {
        return Outcome::Broken(Difference::of_end(&record.ended, &base.record.ended));
    }
    // When Newton's method gives up hangs on the norm of all forces, and the judgement at the end on the energies of all bodies.
    if record.increments != base.record.increments || is_judged_by_energies(&record.ended) {
        return Outcome::Idle;
    }
    if !base.has_ended_well() { Outcome::Idle } else { base.as_before(&record, SAME, &energies) }
}

/// A surface that goes on where nothing meets it.
pub(super) fn wide(base: &Base) -> Outcome {
    let draft = base.draft;
    let ends = draft.is("master", "polyline") || draft.is("master", "outline");
    let beside = draft.is("master", "deformable") && !draft.is("scheme", "quasi_dynamic");
    // The error of an increment is that of all bodies.
    if !ends && !beside || draft.has("error_control") {
        return Outcome::Idle;
    }
    // The dashpots of a tool hold its turning by the reach of its own outline.
    if ends && draft.has("tool") && draft.has("stabilize") {
        return Outcome::Idle;
    }
    let wide: &[f64] = if ends { &[10.0, 1e4, 1e150, 5e307] } else { &[10.0, 1e3] };
    let wide = Some(wide[(hash(draft.seed, "wide") % wide.len() as u64) as usize]);
    let record = base.run(&Ways { wide, ..base.ways.clone() });
    // No coordinate is that large; who says so is right.
    if matches!(record.ended, Ended::Refused(_)) && wide > Some(1e6) || !base.has_ended_well() {
        return Outcome::Idle;
    }
    // A point that has parted may face what goes on, where it faced something else or nothing: it has another gap, or one at all.
    let last = base.record.rows.last().map_or(&[][..], |(_, row)| row);
    let gap_of = |column: &str| {
        let (field, point) = column.split_once(" of point ")?;
        let name = format!("{}.gap of point {point}", field.split_once('.')?.0);
        last.iter().find(|entry| *entry.column == *name).map(|entry| entry.value)
    };
    // Gaps are told of the end alone.
    let gone = |entry: &Entry| {
        let way = |(_, row): &(f64, Vec<Entry>)| {
            row.iter().find(|other| other.column == entry.column).map_or(0.0, |other| (other.value - entry.value).abs())
        };
        entry.column.ends_with(".centre_x") && base.record.rows.iter().any(|row| way(row) > GONE)
    };
    if beside && last.iter().any(gone) {
        return Outcome::Idle;
    }
    let is_afar = |column: &str| beside && gap_of(column).is_some_and(|gap| gap == 0.0 || gap > AFAR);
    base.as_before(&record, SAME_BY_BODY, &is_afar)
}

/// Way of a body that may have met what goes on, 0.5 beyond the end of the ground.
const GONE: f64 = 0.4;

/// Gap of a point that has parted.
const AFAR: f64 = 0.01;

/// A free body flies on with the momentum that its springs have left it.
pub(super) fn flight(base: &Base) -> Outcome {
    let draft = base.draft;
    if !is_dynamic(draft.of("scheme"))
        || draft.has("then")
        // What ends with such a step fades over it.
        || model::comes_or_goes(draft)
        || draft.of("section").starts_with("rings")
        || draft.has("rupture")
        || !base.has_ended_well()
    {
        return Outcome::Idle;
    }
    let record = base.run(&Ways { bystander: true, flight: true, ..base.ways.clone() });
    if record.ended != Ended::Complete {
        return Outcome::Idle;
    }
    let name = format!("{}.momentum_x", model::ASIDE[1]);
    let momentum =
        |row: &[Entry]| row.iter().find(|entry| *entry.column == *name).map_or(f64::NAN, |entry| entry.value);
    let free: Vec<f64> = record
        .rows
        .iter()
        .filter(|(time, _)| *time >= model::duration(draft) * (1.0 - 1e-9))
        .map(|(_, row)| momentum(row))
        .collect();
    let most = record.rows.iter().map(|(_, row)| momentum(row).abs()).fold(0.0, f64::max);
    let spread =
        free.iter().copied().fold(f64::NEG_INFINITY, f64::max) - free.iter().copied().fold(f64::INFINITY, f64::min);
    if spread <= SAME * most {
        Outcome::Holds
    } else {
        Outcome::Broken(Difference { share: spread / most, place: name, values: [free[0], free[free.len() - 1]] })
    }
}
