//! A run that is led in another way: left and taken up, tried twice, begun with another.

use super::*;

pub(super) fn to_the_bit(base: &Base, record: &Record) -> Outcome {
    if !base.has_ended_well() {
        return Outcome::Idle;
    }
    let text = |record: &Record| {
        record.tables.iter().map(|table| table.lines().map(str::to_owned).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    if record.ended != base.record.ended {
        return Outcome::Broken(Difference::of_end(&record.ended, &base.record.ended));
    }
    let (was, is) = (text(&base.record), text(record));
    if std::env::var_os("SHOW").is_some() {
        for (a, b) in was.iter().zip(&is) {
            for (x, y) in a.iter().zip(b) {
                if x != y {
                    println!("A {x}\nB {y}");
                }
            }
        }
    }
    if was == is {
        return Outcome::Holds;
    }
    let cells = was.iter().zip(&is).flat_map(|(was, is)| {
        let columns = || was[0].split(',');
        let rows = was.iter().zip(is);
        rows.flat_map(move |(was, is)| columns().zip(was.split(',').zip(is.split(','))).map(move |cells| (was, cells)))
    });
    let place = cells.filter(|(_, (_, (was, is)))| was != is).map(|(row, (column, (was, is)))| {
        let start: Vec<&str> = row.split(',').take(4).collect();
        format!("{column} of {}…: {was} and {is}", start.join(","))
    });
    let place = place.into_iter().next().unwrap_or_else(|| "rows".into());
    let difference = compare(&base.record, record, NOTHING);
    Outcome::Broken(Difference { place: format!("{place}; {}", difference.place), ..difference })
}

pub(super) fn resumed(base: &Base) -> Outcome {
    to_the_bit(base, &run(&model::case(base.draft, &base.ways), &base.ways, Lead::Resumed))
}

pub(super) fn dropped(base: &Base) -> Outcome {
    to_the_bit(base, &run(&model::case(base.draft, &base.ways), &base.ways, Lead::Dropped))
}

pub(super) fn threads(base: &Base) -> Outcome {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
    to_the_bit(base, &pool.install(|| base.run(&base.ways)))
}

/// Whether a penalty, a method, that of a tie as well, or the tractions of an edge are chosen for a case by the schemes of its steps:
/// with fewer steps they may be others, and the command refuses to go on there.
fn is_chosen_by_steps(draft: &Draft) -> bool {
    let by_default = draft.is("normal", "default") || draft.is("method", "chosen") || draft.is("flange", "tied");
    // Mortar has one traction on a quadratic edge, and in explicit runs one at each of its nodes.
    let by_default = by_default || draft.is("method", "mortar") && is_quadratic(draft.of("block_element"));
    let other = ["then", "rupture"].iter().any(|slot| draft.has(slot)) || draft.is("scheme", "quasi_dynamic");
    by_default && other
}

/// The steps after the first as a case that begins with the first.
pub(super) fn begun_with(base: &Base) -> Outcome {
    if !base.has_ended_well() || base.draft.has("times") || is_chosen_by_steps(base.draft) {
        return Outcome::Idle;
    }
    let record = run(&model::case(base.draft, &base.ways), &base.ways, Lead::Begun);
    if base.draft.is("flange", "added") || base.draft.is("bar", "late") {
        return was_there(record);
    }
    if is_judged_by_energies(&record.ended) {
        return Outcome::Idle;
    }
    // It counts its own energies; the turns of bodies begin anew as well.
    let counted = |column: &str| {
        let totals = [
            "friction_dissipation",
            "damping_dissipation",
            "plastic_dissipation",
            "external_work",
            "energy_error",
            "radiated",
        ];
        totals.contains(&column) || column.ends_with("frictional_heat")
    };
    base.as_before(&record, SAME, &counted)
}

/// Whether a run ended as one whose motion gained more energy than was supplied in it, and to all of its bodies.
pub(super) fn is_judged_by_energies(ended: &Ended) -> bool {
    matches!(ended, Ended::Stopped(why) if why.contains("energy balance violated"))
}

/// A body that was there all along cannot come; with it from the start, the run before may stop.
fn was_there(record: Record) -> Outcome {
    match record.ended {
        Ended::Refused(_) => Outcome::Holds,
        Ended::Stopped(_) => Outcome::Idle,
        ended => Outcome::Broken(Difference {
            share: f64::INFINITY,
            place: format!("a body or bar that was there comes, and the run ended {ended:?}"),
            values: [0.0; 2],
        }),
    }
}

/// A finished run that goes on with one step more.
pub(super) fn further(base: &Base) -> Outcome {
    let draft = base.draft;
    if !base.has_ended_well() || draft.has("times") || is_chosen_by_steps(draft) {
        return Outcome::Idle;
    }
    let record = run(&model::case(draft, &base.ways), &base.ways, Lead::Further);
    if (draft.is("flange", "added") || draft.is("bar", "late")) && !draft.has("reversal") {
        return was_there(record);
    }
    if is_judged_by_energies(&record.ended) {
        return Outcome::Idle;
    }
    base.as_before(&record, SAME, NOTHING)
}
